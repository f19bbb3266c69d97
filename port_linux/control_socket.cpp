// SPDX-License-Identifier: Apache-2.0
#include "port_linux/control_socket.h"

#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

namespace hardpack {
namespace {

// Limit of the answers that a client has not read yet, as the kernel counts: about ten of the
// largest.
constexpr int kSendBuffer_bytes = 64 * 1024;
constexpr int kBacklog = ControlSocket::kMaxClients;
constexpr size_t kMaxGroupEntryBytes = 64 * 1024;

OpenOutcome Failure(Status status, const std::string& path, const std::string& what) {
  return {status, "control socket " + path + ": " + what, {}};
}

OpenOutcome SystemFailure(const std::string& path, const char* what) {
  const int code = errno;
  const bool permission = code == EACCES || code == EPERM || code == EROFS;
  return Failure(permission ? Status::kNotPermitted : Status::kSystemError, path,
                 std::string(what) + " (" + std::strerror(code) + ")");
}

sockaddr_un AddressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), address.sun_path);
  return address;
}

bool FindGroup(const std::string& name, gid_t& id) {
  std::vector<char> text(kMaxGroupEntryBytes);
  group entry{};
  group* found = nullptr;
  if (getgrnam_r(name.c_str(), &entry, text.data(), text.size(), &found) != 0) return false;
  if (found != nullptr) id = found->gr_gid;
  return found != nullptr;
}

}  // namespace

OpenOutcome ControlSocket::Open(const ControlSocketOptions& options) {
  if (options.path.empty() || options.path.size() >= sizeof(sockaddr_un::sun_path)) {
    return Failure(Status::kInvalidArgument, options.path,
                   "the path must have 1 to " + std::to_string(sizeof(sockaddr_un::sun_path) - 1) +
                       " characters");
  }
  owner_ = geteuid();
  OpenOutcome outcome = Lock(options.path);
  if (outcome.ok()) outcome = RemoveStale(options.path);
  if (outcome.ok()) outcome = Bind(options.path, options.group);
  if (!outcome.ok()) Close();
  return outcome;
}

// The lock distinguishes a running instance from a leftover file without a race: the kernel
// releases it when the process ends. The file stays: if it were removed, two could hold "the" lock.
OpenOutcome ControlSocket::Lock(const std::string& path) {
  const std::string name = path + ".lock";
  lock_.Reset(open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
  if (!lock_.valid()) return SystemFailure(path, "its lock cannot be created");
  if (flock(lock_.get(), LOCK_EX | LOCK_NB) == 0) return {};
  if (errno != EWOULDBLOCK) return SystemFailure(path, "its lock cannot be taken");
  lock_.Reset();
  return Failure(Status::kSystemError, path, "another instance is running");
}

OpenOutcome ControlSocket::RemoveStale(const std::string& path) {
  struct stat found {};
  if (lstat(path.c_str(), &found) != 0) {
    return errno == ENOENT ? OpenOutcome{} : SystemFailure(path, "cannot be examined");
  }
  if (!S_ISSOCK(found.st_mode)) {
    return Failure(Status::kInvalidArgument, path, "exists and is not a socket");
  }
  const FileDescriptor probe(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const sockaddr_un address = AddressOf(path);
  // Any answer except "connection refused" means that somebody listens: on another type of socket,
  // or too busy.
  if (!probe.valid() ||
      connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0 ||
      errno != ECONNREFUSED) {
    return Failure(Status::kSystemError, path, "in use by another program");
  }
  return unlink(path.c_str()) == 0 ? OpenOutcome{} : SystemFailure(path, "cannot be replaced");
}

// Before listen nobody can connect, whatever the file's mode is by then.
OpenOutcome ControlSocket::Bind(const std::string& path, const std::string& group) {
  has_group_ = !group.empty();
  if (has_group_ && !FindGroup(group, group_)) {
    return Failure(Status::kInvalidArgument, path, "there is no group '" + group + "'");
  }
  socket_.Reset(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const sockaddr_un address = AddressOf(path);
  if (!socket_.valid() ||
      bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return SystemFailure(path, "cannot be created");
  }
  struct stat made {};
  if (lstat(path.c_str(), &made) != 0) return SystemFailure(path, "cannot be examined");
  path_ = path;
  device_ = made.st_dev;
  inode_ = made.st_ino;
  if (has_group_ && lchown(path.c_str(), static_cast<uid_t>(-1), group_) != 0) {
    return SystemFailure(path, ("cannot be given to group '" + group + "'").c_str());
  }
  if (chmod(path.c_str(), has_group_ ? 0660 : 0600) != 0 || listen(socket_.get(), kBacklog) != 0) {
    return SystemFailure(path, "cannot be opened to others");
  }
  return {Status::kOk, "control socket " + path + (has_group_ ? ", group " + group : ""), {}};
}

bool ControlSocket::Receive(ControlMessage& message) {
  ++calls_;
  if (!socket_.valid()) return false;
  for (size_t i = 0; i < clients_.size(); ++i) {
    polled_[i] = {clients_[i].socket.get(), POLLIN, 0};  // negative: left out
  }
  polled_[kMaxClients] = {socket_.get(), POLLIN, 0};
  if (poll(polled_.data(), polled_.size(), 0) <= 0) return false;
  const int first = next_place_;
  bool given = false;
  for (int i = 0; i < kMaxClients && !given; ++i) {
    const int place = (first + i) % kMaxClients;
    if (polled_[static_cast<size_t>(place)].revents == 0) continue;
    next_place_ = (place + 1) % kMaxClients;
    given = TakeFrom(place, message);
  }
  if (polled_[kMaxClients].revents != 0 || waits_.socket.valid()) Accept();
  return given;
}

// At most kMaxClients a call, so that a flood of connections takes a bounded time.
void ControlSocket::Accept() {
  if (waits_.socket.valid() && !Seat(waits_)) return;
  for (int i = 0; i < kMaxClients; ++i) {
    FileDescriptor accepted(accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!accepted.valid()) {
      if (errno != EAGAIN && errno != EINTR && errno != ECONNABORTED) ++counters_.system_errors;
      return;
    }
    Client client;
    client.user = UINT32_MAX;  // where the kernel does not tell
    client.may_command = MayCommand(accepted.get(), client.user);
    client.socket = std::move(accepted);
    if (Seat(client)) continue;
    if (client.may_command) {
      waits_ = std::move(client);
      return;
    }
    ++counters_.turned_away;
  }
}

// False: there is no place for it now.
bool ControlSocket::Seat(Client& client) {
  const int place = PlaceFor(client.may_command);
  if (place < 0) return false;
  setsockopt(client.socket.get(), SOL_SOCKET, SO_SNDBUF, &kSendBuffer_bytes,
             sizeof(kSendBuffer_bytes));
  client.number = ++last_number_;
  client.last_call = calls_;
  clients_[static_cast<size_t>(place)] = std::move(client);
  ++counters_.clients;
  ++counters_.connected;
  return true;
}

bool ControlSocket::MayCommand(int socket, uint32_t& user) {
  ucred peer{};
  socklen_t size = sizeof(peer);
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    ++counters_.system_errors;
    return false;
  }
  user = peer.uid;
  if (peer.uid == 0 || peer.uid == owner_) return true;
  if (!has_group_) return false;
  if (peer.gid == group_) return true;
  size = sizeof(groups_);
  if (getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups_.data(), &size) != 0) {
    ++counters_.system_errors;
    return false;
  }
  const auto end = groups_.begin() + static_cast<std::ptrdiff_t>(size / sizeof(gid_t));
  return std::find(groups_.begin(), end, group_) != end;
}

// Forgotten connections must not block an emergency stop: if no place is free, a client that may
// command gets the place of the one that has been silent for longest, once the messages of that one
// have been taken. Until then no other client is dismissed.
int ControlSocket::PlaceFor(bool may_command) {
  int longest = 0;
  bool one_leaves = false;
  for (int place = 0; place < kMaxClients; ++place) {
    const Client& client = clients_[static_cast<size_t>(place)];
    if (!client.socket.valid()) return place;
    one_leaves = one_leaves || client.leaves;
    if (client.last_call < clients_[static_cast<size_t>(longest)].last_call) longest = place;
  }
  if (!may_command || one_leaves) return -1;
  ++counters_.displaced;
  return Dismiss(longest) ? longest : -1;
}

// Messages that it has already sent are not lost: first it is kept from sending more, then its
// socket is checked for pending ones. True: there were none, and the place is free.
bool ControlSocket::Dismiss(int place) {
  Client& client = clients_[static_cast<size_t>(place)];
  shutdown(client.socket.get(), SHUT_RD);
  uint8_t byte = 0;
  client.leaves = recv(client.socket.get(), &byte, sizeof(byte), MSG_PEEK | MSG_DONTWAIT) > 0;
  if (!client.leaves) Drop(place);
  return !client.leaves;
}

void ControlSocket::Drop(int place) {
  Client& client = clients_[static_cast<size_t>(place)];
  if (!client.socket.valid()) return;
  client.socket.Reset();
  client.leaves = false;
  --counters_.connected;
}

// Whether it had a message to deliver.
bool ControlSocket::TakeFrom(int place, ControlMessage& message) {
  Client& client = clients_[static_cast<size_t>(place)];
  iovec part = {buffer_.data(), buffer_.size()};
  msghdr packet{};
  packet.msg_iov = &part;
  packet.msg_iovlen = 1;
  const ssize_t received = recvmsg(client.socket.get(), &packet, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (received < 0 && (errno == EAGAIN || errno == EINTR)) return false;
  // The end of the connection, or an empty packet, which looks the same.
  if (received <= 0) {
    Drop(place);
    return false;
  }
  client.last_call = calls_;
  const std::span<const uint8_t> bytes(buffer_.data(), static_cast<size_t>(received));
  control::Header header;
  Status status = ReadHeader(bytes, header);
  if ((packet.msg_flags & MSG_TRUNC) != 0) status = Status::kOversized;
  if (IsUsable(status) && IsAnswer(header.kind)) status = Status::kWrongPacketType;
  // The message carries descriptors or credentials, which our programs never send.
  if ((packet.msg_flags & MSG_CTRUNC) != 0) status = Status::kInvalidArgument;
  if (!IsUsable(status)) {
    ++counters_.malformed;
    AnswerDone(place, header.sequence, status);
    return false;
  }
  if (IsCommand(header.kind) && !client.may_command) {
    ++counters_.not_permitted;
    AnswerDone(place, header.sequence, Status::kNotPermitted);
    return false;
  }
  ++counters_.messages;
  message = {{place, client.number}, client.user, header, bytes};
  return true;
}

void ControlSocket::AnswerDone(int place, uint32_t sequence, Status status) {
  std::array<uint8_t, 32> bytes{};
  int size_bytes = 0;
  if (!IsUsable(Encode(control::Done{sequence, status, 0}, bytes, size_bytes))) return;
  Answer({place, clients_[static_cast<size_t>(place)].number},
         std::span(bytes).first(static_cast<size_t>(size_bytes)));
}

void ControlSocket::Answer(const ControlClient& client, std::span<const uint8_t> bytes) {
  if (client.place < 0 || client.place >= kMaxClients) return;
  const Client& asked = clients_[static_cast<size_t>(client.place)];
  if (!asked.socket.valid() || asked.number != client.number) return;
  const ssize_t sent =
      send(asked.socket.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent == static_cast<ssize_t>(bytes.size())) return;
  // EPIPE, ECONNRESET: it left without waiting for the answer, as it may.
  if (errno == EAGAIN || errno == ENOBUFS) {
    ++counters_.dropped_slow;
  } else if (errno != EPIPE && errno != ECONNRESET) {
    ++counters_.system_errors;
  }
  Drop(client.place);
}

void ControlSocket::Close() {
  for (int place = 0; place < kMaxClients; ++place) Drop(place);
  waits_.socket.Reset();
  struct stat found {};
  if (!path_.empty() && lstat(path_.c_str(), &found) == 0 && found.st_dev == device_ &&
      found.st_ino == inode_) {
    unlink(path_.c_str());
  }
  path_.clear();
  socket_.Reset();
  lock_.Reset();
}

}  // namespace hardpack
