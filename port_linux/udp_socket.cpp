// SPDX-License-Identifier: Apache-2.0
#include "port_linux/udp_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

namespace hardpack {
namespace {

std::string Name(uint32_t address, uint16_t port) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += std::to_string((address >> shift) & 0xffu) + (shift > 0 ? "." : ":");
  }
  return text + std::to_string(port);
}

OpenOutcome Failure(Status status, const std::string& name, const std::string& what) {
  return {status, "UDP " + name + ": " + what, {}};
}

OpenOutcome SystemFailure(const std::string& name, const char* what) {
  const int code = errno;
  const bool permission = code == EACCES || code == EPERM;
  const bool address = code == EADDRNOTAVAIL;
  const Status status = permission ? Status::kNotPermitted
                        : address  ? Status::kInvalidArgument
                                   : Status::kSystemError;
  return Failure(status, name, std::string(what) + " (" + std::strerror(code) + ")");
}

bool SetOption(int socket, int name, int value) {
  return setsockopt(socket, SOL_SOCKET, name, &value, sizeof(value)) == 0;
}

// As setsockopt counts; getsockopt gives twice that (socket(7)).
int GrantedBuffer_bytes(int socket) {
  int twice = 0;
  socklen_t size = sizeof(twice);
  if (getsockopt(socket, SOL_SOCKET, SO_RCVBUF, &twice, &size) != 0) return 0;
  return twice / 2;
}

sockaddr_in ToSocketAddress(uint32_t address, uint16_t port) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(port);
  result.sin_addr.s_addr = htonl(address);
  return result;
}

}  // namespace

UdpSocket::UdpSocket() {
  for (size_t i = 0; i < messages_.size(); ++i) {
    parts_[i] = {buffers_[i].data(), buffers_[i].size()};
    messages_[i].msg_hdr.msg_iov = &parts_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_name = &senders_[i];
    messages_[i].msg_hdr.msg_control = controls_[i].bytes.data();
  }
}

// A buffer beyond the system-wide limit needs CAP_NET_ADMIN.
OpenOutcome UdpSocket::AskForBuffer(const UdpSocketOptions& options, const std::string& name) {
  const int asked = options.receive_buffer_bytes;
  const int before = GrantedBuffer_bytes(socket_.get());
  if (before < asked && !SetOption(socket_.get(), SO_RCVBUFFORCE, asked) &&
      !SetOption(socket_.get(), SO_RCVBUF, asked)) {
    return SystemFailure(name, "no receive buffer");
  }
  const int granted = GrantedBuffer_bytes(socket_.get());
  counters_.receive_buffer_bytes = static_cast<uint64_t>(granted);
  OpenOutcome outcome{
      Status::kOk, "UDP " + name + ": receive buffer " + std::to_string(granted) + " bytes", {}};
  if (granted >= asked) return outcome;
  const std::string less = "receive buffer " + std::to_string(granted) + " of " +
                           std::to_string(asked) + " bytes (sysctl net.core.rmem_max, or " +
                           "CAP_NET_ADMIN)";
  if (options.require_receive_buffer) return Failure(Status::kCapacityExceeded, name, less);
  outcome.warnings.push_back("UDP " + name + ": " + less);
  return outcome;
}

OpenOutcome UdpSocket::Open(const UdpSocketOptions& options) {
  std::string name = Name(options.bind_address, options.port);
  if (options.sender_address == 0) {
    return Failure(Status::kInvalidArgument, name, "the sender's address is not configured");
  }
  if (options.receive_buffer_bytes < 1) {
    return Failure(Status::kInvalidArgument, name, "the receive buffer is smaller than one byte");
  }
  socket_.Reset(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket_.valid()) return SystemFailure(name, "no socket");
  OpenOutcome outcome = AskForBuffer(options, name);
  // Every Linux has these; an emulator of its system calls may not.
  if (outcome.ok() &&
      (!SetOption(socket_.get(), SO_TIMESTAMPNS, 1) || !SetOption(socket_.get(), SO_RXQ_OVFL, 1))) {
    outcome.warnings.push_back(SystemFailure(name, "no time stamps or no loss counter").message);
  }
  sockaddr_in own = ToSocketAddress(options.bind_address, options.port);
  socklen_t size = sizeof(own);
  if (outcome.ok() && (bind(socket_.get(), reinterpret_cast<const sockaddr*>(&own), size) != 0 ||
                       getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&own), &size) != 0)) {
    outcome = SystemFailure(name, "cannot be bound");
  }
  if (!outcome.ok()) {
    socket_.Reset();
    return outcome;
  }
  port_ = ntohs(own.sin_port);
  sender_address_ = options.sender_address;
  sender_port_ = options.sender_port;
  return outcome;
}

void UdpSocket::Take(int index) {
  const mmsghdr& message = messages_[static_cast<size_t>(index)];
  Datagram datagram;
  for (const cmsghdr* control = CMSG_FIRSTHDR(&message.msg_hdr); control != nullptr;
       control =
           CMSG_NXTHDR(const_cast<msghdr*>(&message.msg_hdr), const_cast<cmsghdr*>(control))) {
    if (control->cmsg_level != SOL_SOCKET) continue;
    if (control->cmsg_type == SO_RXQ_OVFL) {
      uint32_t drops = 0;
      std::memcpy(&drops, CMSG_DATA(control), sizeof(drops));
      counters_.lost_in_kernel += drops - kernel_drops_;
      kernel_drops_ = drops;
    } else if (control->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(control), sizeof(stamp));
      datagram.kernel_time_ns = int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec;
    }
  }
  sockaddr_in sender{};
  std::memcpy(&sender, &senders_[static_cast<size_t>(index)], sizeof(sender));
  datagram.sender_address = ntohl(sender.sin_addr.s_addr);
  datagram.sender_port = ntohs(sender.sin_port);
  if (datagram.sender_address != sender_address_ ||
      (sender_port_ != 0 && datagram.sender_port != sender_port_)) {
    ++counters_.foreign;
    return;
  }
  if ((message.msg_hdr.msg_flags & MSG_TRUNC) != 0) {
    ++counters_.oversized;
    return;
  }
  datagram.bytes = {buffers_[static_cast<size_t>(index)].data(), message.msg_len};
  ++counters_.received;
  counters_.received_bytes += message.msg_len;
  datagrams_[static_cast<size_t>(given_++)] = datagram;
}

std::span<const Datagram> UdpSocket::Receive(int max) {
  given_ = 0;
  const int wanted = std::clamp(max, 0, kMaxBatch);
  if (wanted == 0 || !socket_.valid()) return {};
  for (size_t i = 0; i < static_cast<size_t>(wanted); ++i) {
    msghdr& header = messages_[i].msg_hdr;  // the kernel overwrites the lengths
    header.msg_namelen = sizeof(senders_[i]);
    header.msg_controllen = controls_[i].bytes.size();
    header.msg_flags = 0;
  }
  const int got = recvmmsg(socket_.get(), messages_.data(), static_cast<unsigned>(wanted),
                           MSG_DONTWAIT, nullptr);
  if (got < 0) {
    if (errno != EAGAIN && errno != EINTR) ++counters_.system_errors;
    return {};
  }
  for (int i = 0; i < got; ++i) Take(i);
  return {datagrams_.data(), static_cast<size_t>(given_)};
}

}  // namespace hardpack
