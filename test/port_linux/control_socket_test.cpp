// SPDX-License-Identifier: Apache-2.0
#include "port_linux/control_socket.h"

#include <grp.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tools/allocation_counter/allocation_counter.h"

// Real sockets in a folder of its own. Tests of other users' rights need root, and a user and a
// group that every Debian has.

namespace hardpack {
namespace {

using control::Kind;
using Bytes = std::vector<uint8_t>;

constexpr uid_t kNobody = 65534;
constexpr gid_t kNogroup = 65534;
constexpr char kGroup[] = "games";

Bytes Encoded(Kind kind, uint32_t sequence) {
  Bytes bytes(control::kMaxMessageBytes);
  int size_bytes = 0;
  Status status = Status::kOk;
  if (IsQuestion(kind)) {
    status = Encode(control::Question{kind, sequence, 0}, bytes, size_bytes);
  } else {
    control::OperatorCommand command;
    command.kind = kind;
    command.sequence = sequence;
    status = Encode(command, bytes, size_bytes);
  }
  EXPECT_EQ(status, Status::kOk);
  bytes.resize(static_cast<size_t>(size_bytes));
  return bytes;
}

sockaddr_un AddressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
  return address;
}

// An operator's program.
class Operator {
 public:
  explicit Operator(const std::string& path) {
    socket_.Reset(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0));
    const sockaddr_un address = AddressOf(path);
    connected_ =
        connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }
  bool connected() const { return connected_; }
  int socket_number() const { return socket_.get(); }

  bool Send(const Bytes& bytes) {
    return send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(bytes.size());
  }

  // A whole packet; empty: the connection has ended; -1 as its only byte: nothing is there.
  Bytes Receive() {
    Bytes bytes(control::kMaxMessageBytes);
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    if (size < 0) return {0xff};
    bytes.resize(static_cast<size_t>(size));
    return bytes;
  }

  control::Done ReceiveDone() {
    control::Done done;
    EXPECT_EQ(Decode(Receive(), done), Status::kOk);
    return done;
  }
  bool HasEnded() { return Receive().empty(); }
  bool HasNothing() { return Receive() == Bytes{0xff}; }

 private:
  FileDescriptor socket_;
  bool connected_ = false;
};

class ControlSocketTest : public testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/hardpack_control_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    ASSERT_EQ(chmod(name, 0755), 0);
    path_ = folder_ + "/control.sock";
  }
  void TearDown() override {
    socket_.Close();
    std::filesystem::remove_all(folder_);
  }

  void Open(const std::string& group = "") {
    const OpenOutcome outcome = socket_.Open({path_, group});
    ASSERT_TRUE(outcome.ok()) << outcome.message;
  }

  // The kinds that were given, in order, until `calls` calls in a row gave nothing.
  std::vector<Kind> ReceiveAll(int calls = 3) {
    std::vector<Kind> kinds;
    ControlMessage message;
    for (int empty = 0; empty < calls;) {
      if (socket_.Receive(message)) {
        kinds.push_back(message.header.kind);
        empty = 0;
      } else {
        ++empty;
      }
    }
    return kinds;
  }

  const control::ControlCounters& counters() const { return socket_.counters(); }

  std::string folder_;
  std::string path_;
  ControlSocket socket_;
};

TEST_F(ControlSocketTest, GivesACommandAndAnswersWhoAsked) {
  Open();
  Operator first(path_);
  Operator second(path_);
  ASSERT_TRUE(first.connected() && second.connected());
  ASSERT_TRUE(second.Send(Encoded(Kind::kArm, 77)));
  ControlMessage message;
  EXPECT_FALSE(socket_.Receive(message)) << "a connection is taken before its messages";
  ASSERT_TRUE(socket_.Receive(message));
  EXPECT_EQ(message.header.kind, Kind::kArm);
  EXPECT_EQ(message.header.sequence, 77u);
  EXPECT_EQ(message.user, geteuid());
  EXPECT_EQ(Bytes(message.bytes.begin(), message.bytes.end()), Encoded(Kind::kArm, 77));

  const Bytes answer = {1, 2, 3};
  socket_.Answer(message.client, answer);
  EXPECT_EQ(second.Receive(), answer);
  EXPECT_TRUE(first.HasNothing());
  EXPECT_FALSE(socket_.Receive(message));
  EXPECT_EQ(counters().messages, 1u);
  EXPECT_EQ(counters().connected, 2u);
}

// SR-OPR03
TEST_F(ControlSocketTest, GivesOneMessageACallAndTakesClientsInTurn) {
  Open();
  Operator busy(path_);
  Operator other(path_);
  for (uint32_t i = 0; i < 5; ++i) ASSERT_TRUE(busy.Send(Encoded(Kind::kAlive, i)));
  ASSERT_TRUE(other.Send(Encoded(Kind::kEmergencyStop, 9)));
  ControlMessage message;
  EXPECT_FALSE(socket_.Receive(message));
  std::vector<Kind> kinds;
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(socket_.Receive(message));
    kinds.push_back(message.header.kind);
  }
  EXPECT_NE(std::find(kinds.begin(), kinds.end(), Kind::kEmergencyStop), kinds.end())
      << "a busy client keeps another's emergency stop out";
  EXPECT_EQ(ReceiveAll().size(), 4u);
}

// SR-OPR02
TEST_F(ControlSocketTest, AnswersWhatIsNoMessageAndCountsIt) {
  Open();
  Operator client(path_);
  Bytes version = Encoded(Kind::kArm, 5);
  version[4] = 99;
  Bytes kind = Encoded(Kind::kArm, 6);
  kind[5] = 99;
  Bytes answer(14);
  int size_bytes = 0;
  ASSERT_EQ(Encode(control::Done{7, Status::kOk, 0}, answer, size_bytes), Status::kOk);
  const struct {
    Bytes bytes;
    Status status;
    uint32_t sequence;
  } cases[] = {
      {{1, 2, 3}, Status::kTruncated, 0},
      {Bytes(64, 'x'), Status::kWrongPacketType, 0},
      {version, Status::kUnsupported, 0},
      {kind, Status::kInvalidArgument, 6},
      {answer, Status::kWrongPacketType, 7},
      {Bytes(control::kMaxMessageBytes + 1, 'x'), Status::kOversized, 0},
  };
  uint64_t malformed = 0;
  for (const auto& sent : cases) {
    SCOPED_TRACE(StatusName(sent.status));
    ASSERT_TRUE(client.Send(sent.bytes));
    EXPECT_TRUE(ReceiveAll().empty());
    const control::Done done = client.ReceiveDone();
    EXPECT_EQ(done.status, sent.status);
    EXPECT_EQ(done.sequence, sent.sequence);
    EXPECT_EQ(counters().malformed, ++malformed);
  }
  ASSERT_TRUE(client.Send(Encoded(Kind::kGetStatus, 8)));
  EXPECT_EQ(ReceiveAll(), std::vector<Kind>{Kind::kGetStatus}) << "it may go on";
}

TEST_F(ControlSocketTest, DescriptorsSentAlongAreNotTaken) {
  Open();
  Operator client(path_);
  Bytes bytes = Encoded(Kind::kArm, 1);
  iovec part = {bytes.data(), bytes.size()};
  alignas(cmsghdr) char space[CMSG_SPACE(sizeof(int))] = {};
  msghdr packet{};
  packet.msg_iov = &part;
  packet.msg_iovlen = 1;
  packet.msg_control = space;
  packet.msg_controllen = sizeof(space);
  cmsghdr* head = CMSG_FIRSTHDR(&packet);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof(int));
  const int number = client.socket_number();
  std::memcpy(CMSG_DATA(head), &number, sizeof(number));
  const auto open_files = [] {
    int count = 0;
    for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) {
      ++count;
    }
    return count;
  };
  ControlMessage message;
  EXPECT_FALSE(socket_.Receive(message));
  const int before = open_files();
  ASSERT_GT(sendmsg(number, &packet, 0), 0);
  EXPECT_TRUE(ReceiveAll().empty());
  EXPECT_EQ(open_files(), before);
  EXPECT_EQ(counters().malformed, 1u);
}

TEST_F(ControlSocketTest, WhoHasGoneGetsNoAnswerNorDoesHisSuccessor) {
  Open();
  auto gone = std::make_unique<Operator>(path_);
  ASSERT_TRUE(gone->Send(Encoded(Kind::kStop, 1)));
  ControlMessage message;
  EXPECT_FALSE(socket_.Receive(message));
  ASSERT_TRUE(socket_.Receive(message)) << "what was said before leaving counts";
  gone.reset();
  ControlMessage later;
  EXPECT_FALSE(socket_.Receive(later));
  EXPECT_EQ(counters().connected, 0u);
  Operator next(path_);
  EXPECT_FALSE(socket_.Receive(later));
  EXPECT_EQ(counters().connected, 1u);
  const Bytes answer = {1};
  socket_.Answer(message.client, answer);
  EXPECT_TRUE(next.HasNothing());
}

TEST_F(ControlSocketTest, AClientThatDoesNotTakeItsAnswersIsDropped) {
  Open();
  Operator slow(path_);
  Operator other(path_);
  const Bytes answer(control::kMaxMessageBytes, 7);
  ControlMessage message;
  int answered = 0;
  for (; answered < 1000 && counters().dropped_slow == 0; ++answered) {
    if (!slow.Send(Encoded(Kind::kGetParameters, 1))) break;
    while (!socket_.Receive(message)) {
    }
    socket_.Answer(message.client, answer);
  }
  EXPECT_EQ(counters().dropped_slow, 1u);
  EXPECT_GT(answered, 5) << "a whole configuration fits";
  EXPECT_LT(answered, 200);
  EXPECT_EQ(counters().connected, 1u);
  ASSERT_TRUE(other.Send(Encoded(Kind::kStop, 2)));
  EXPECT_EQ(ReceiveAll(), std::vector<Kind>{Kind::kStop});
}

// SR-DET01
TEST_F(ControlSocketTest, AllocatesNothingOnceItIsOpen) {
  Open();
  Operator client(path_);
  Operator other(path_);
  const Bytes bytes[] = {Encoded(Kind::kArm, 1), Bytes(40, 'x'), Encoded(Kind::kGetStatus, 2)};
  for (const Bytes& sent : bytes) ASSERT_TRUE(client.Send(sent));
  const Bytes answer(2000, 7);
  const int64_t before = command::AllocationCount();
  int given = 0;
  for (int call = 0; call < 10; ++call) {
    ControlMessage message;
    if (!socket_.Receive(message)) continue;
    ++given;
    socket_.Answer(message.client, answer);
  }
  socket_.Close();
  EXPECT_EQ(command::AllocationCount(), before);
  EXPECT_EQ(given, 2);
  if (!command::AllocationsAreCounted()) GTEST_SKIP() << "a sanitizer owns the allocator";
}

// SR-OPR03
TEST_F(ControlSocketTest, ANinthWhoMayCommandGetsThePlaceOfTheMostSilent) {
  Open();
  std::vector<std::unique_ptr<Operator>> clients;
  for (int i = 0; i < ControlSocket::kMaxClients; ++i) {
    clients.push_back(std::make_unique<Operator>(path_));
    ReceiveAll();
  }
  EXPECT_EQ(counters().connected, 8u);
  ASSERT_TRUE(clients[0]->Send(Encoded(Kind::kAlive, 1)));
  EXPECT_EQ(ReceiveAll().size(), 1u);

  Operator ninth(path_);
  ASSERT_TRUE(ninth.Send(Encoded(Kind::kEmergencyStop, 2)));
  EXPECT_EQ(ReceiveAll(), std::vector<Kind>{Kind::kEmergencyStop});
  EXPECT_EQ(counters().connected, 8u);
  EXPECT_EQ(counters().displaced, 1u);
  EXPECT_TRUE(clients[0]->HasNothing()) << "it spoke just before";
  EXPECT_TRUE(clients[1]->HasEnded());
  EXPECT_TRUE(clients[2]->HasNothing());
}

// SR-STP02: eight who have all sent something, and a ninth who comes: every message that was
// accepted is given, whoever has to go.
TEST_F(ControlSocketTest, WhatWasAcceptedIsNotLostToANewerClient) {
  Open();
  std::vector<std::unique_ptr<Operator>> clients;
  for (int i = 0; i < ControlSocket::kMaxClients; ++i) {
    clients.push_back(std::make_unique<Operator>(path_));
    ReceiveAll();
  }
  for (const auto& client : clients) {
    for (uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(client->Send(Encoded(Kind::kAlive, i)));
  }
  ASSERT_TRUE(clients[7]->Send(Encoded(Kind::kStop, 9)));
  Operator ninth(path_);
  ASSERT_TRUE(ninth.Send(Encoded(Kind::kEmergencyStop, 2)));
  Operator tenth(path_);
  ASSERT_TRUE(tenth.Send(Encoded(Kind::kDisarm, 2)));
  std::vector<Kind> given;
  for (int call = 0; call < 60; ++call) {
    ControlMessage message;
    if (socket_.Receive(message)) given.push_back(message.header.kind);
  }
  const auto count = [&given](Kind kind) { return std::count(given.begin(), given.end(), kind); };
  EXPECT_EQ(count(Kind::kAlive), 24);
  EXPECT_EQ(count(Kind::kStop), 1);
  EXPECT_EQ(count(Kind::kEmergencyStop), 1);
  EXPECT_EQ(count(Kind::kDisarm), 1);
  EXPECT_EQ(counters().connected, 8u);
  EXPECT_EQ(counters().displaced, 2u);
}

// SR-OPR01
TEST_F(ControlSocketTest, TheFileIsTheOwnersAndTheGroupsAlone) {
  Open();
  struct stat found {};
  ASSERT_EQ(stat(path_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 07777u, 0600u) << "no group";
  socket_.Close();
  EXPECT_NE(stat(path_.c_str(), &found), 0) << "removed";

  const group* entry = geteuid() == 0 ? getgrnam(kGroup) : getgrgid(getegid());
  if (entry == nullptr) GTEST_SKIP() << "no group to give it to";
  const gid_t id = entry->gr_gid;
  ControlSocket with_group;
  const OpenOutcome outcome = with_group.Open({path_, entry->gr_name});
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  ASSERT_EQ(stat(path_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 07777u, 0660u);
  EXPECT_EQ(found.st_gid, id);
}

// SR-OPR06
TEST_F(ControlSocketTest, ASecondInstanceIsToldSoAndDisturbsNothing) {
  Open();
  Operator client(path_);
  ReceiveAll();
  {
    ControlSocket second;
    const OpenOutcome outcome = second.Open({path_, ""});
    EXPECT_EQ(outcome.status, Status::kSystemError);
    EXPECT_NE(outcome.message.find("another instance is running"), std::string::npos)
        << outcome.message;
    EXPECT_NE(outcome.message.find(path_), std::string::npos);
  }
  ASSERT_TRUE(client.Send(Encoded(Kind::kStop, 1)));
  EXPECT_EQ(ReceiveAll(), std::vector<Kind>{Kind::kStop});
  EXPECT_EQ(counters().connected, 1u);
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(ControlSocketTest, AFileThatADeadInstanceLeftIsReplaced) {
  const pid_t child = fork();
  if (child == 0) {
    ControlSocket dying;
    _exit(dying.Open({path_, ""}).ok() && raise(SIGKILL) == 0 ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_TRUE(std::filesystem::exists(path_));
  Open();
  EXPECT_TRUE(Operator(path_).connected());
}

TEST_F(ControlSocketTest, AnotherProgramsSocketOrFileIsLeftAlone) {
  const FileDescriptor other(socket(AF_UNIX, SOCK_STREAM, 0));
  const sockaddr_un address = AddressOf(path_);
  ASSERT_EQ(bind(other.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ASSERT_EQ(listen(other.get(), 1), 0);
  OpenOutcome outcome = socket_.Open({path_, ""});
  EXPECT_EQ(outcome.status, Status::kSystemError);
  EXPECT_NE(outcome.message.find("another program"), std::string::npos) << outcome.message;
  EXPECT_TRUE(std::filesystem::exists(path_));

  path_ = folder_ + "/text";
  std::ofstream(path_) << "precious\n";
  outcome = socket_.Open({path_, ""});
  EXPECT_EQ(outcome.status, Status::kInvalidArgument) << outcome.message;
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(ControlSocketTest, ASocketThatTookItsPlaceIsNotRemoved) {
  Open();
  ASSERT_EQ(unlink(path_.c_str()), 0);
  const FileDescriptor other(socket(AF_UNIX, SOCK_SEQPACKET, 0));
  const sockaddr_un address = AddressOf(path_);
  ASSERT_EQ(bind(other.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  socket_.Close();
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(ControlSocketTest, WhatCannotBeIsRefusedInOneLine) {
  const struct {
    ControlSocketOptions options;
    Status status;
    const char* part;
  } cases[] = {
      {{"", ""}, Status::kInvalidArgument, "path"},
      {{folder_ + "/" + std::string(120, 'x'), ""}, Status::kInvalidArgument, "107"},
      {{path_, "no_such_group_here"}, Status::kInvalidArgument, "no_such_group_here"},
      {{folder_ + "/absent/control.sock", ""}, Status::kSystemError, "absent"},
  };
  for (const auto& bad : cases) {
    ControlSocket socket;
    const OpenOutcome outcome = socket.Open(bad.options);
    EXPECT_EQ(outcome.status, bad.status) << outcome.message;
    EXPECT_NE(outcome.message.find(bad.part), std::string::npos) << outcome.message;
    EXPECT_EQ(outcome.message.find('\n'), std::string::npos);
    ControlMessage message;
    EXPECT_FALSE(socket.Receive(message));
  }
  EXPECT_FALSE(std::filesystem::exists(path_));
}

// Another user, as a process of its own: connects, commands, asks. The result is what it was told.
enum Told : int { kNothing = 10, kNotConnected, kCommandRefused, kCommandGiven };

class ForeignUser : public ControlSocketTest {
 protected:
  void SetUp() override {
    ControlSocketTest::SetUp();
    if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
    const group* entry = getgrnam(kGroup);
    if (entry == nullptr) GTEST_SKIP() << "no group " << kGroup;
    group_ = entry->gr_gid;
  }

  // Sends a command and a question; serves until the process has ended.
  int CommandAs(gid_t primary, const std::vector<gid_t>& others) {
    const pid_t child = fork();
    if (child == 0) {
      if (setgroups(others.size(), others.data()) != 0 || setgid(primary) != 0 ||
          setuid(kNobody) != 0) {
        _exit(kNothing);
      }
      Operator client(path_);
      if (!client.connected()) _exit(kNotConnected);
      if (!client.Send(Encoded(Kind::kArm, 3))) _exit(kNothing);
      pollfd polled = {client.socket_number(), POLLIN, 0};
      if (poll(&polled, 1, 5000) != 1) _exit(kNothing);
      control::Done done;
      if (Decode(client.Receive(), done) != Status::kOk || done.sequence != 3) _exit(kNothing);
      if (!client.Send(Encoded(Kind::kGetStatus, 4))) _exit(kNothing);
      poll(&polled, 1, 5000);
      if (client.Receive() != Bytes{42}) _exit(kNothing);
      _exit(done.status == Status::kNotPermitted ? kCommandRefused : kCommandGiven);
    }
    ControlMessage message;
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (!socket_.Receive(message)) {
        usleep(500);
        continue;
      }
      Bytes answer = {42};
      if (IsCommand(message.header.kind)) {
        EXPECT_EQ(message.user, kNobody);
        answer.resize(64);
        int size_bytes = 0;
        EXPECT_EQ(
            Encode(control::Done{message.header.sequence, Status::kOk, 0}, answer, size_bytes),
            Status::kOk);
        answer.resize(static_cast<size_t>(size_bytes));
      }
      socket_.Answer(message.client, answer);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  gid_t group_ = 0;
};

// SR-OPR01
TEST_F(ForeignUser, DoesNotGetIn) {
  Open(kGroup);
  EXPECT_EQ(CommandAs(kNogroup, {}), kNotConnected);
  EXPECT_EQ(counters().clients, 0u);
}

// SR-OPR01
TEST_F(ForeignUser, MayCommandAsAMemberOfTheGroup) {
  Open(kGroup);
  EXPECT_EQ(CommandAs(kNogroup, {group_}), kCommandGiven);
  EXPECT_EQ(CommandAs(group_, {}), kCommandGiven);
  EXPECT_EQ(CommandAs(kNogroup, {1, 2, group_, 4}), kCommandGiven);
  EXPECT_EQ(counters().not_permitted, 0u);
}

// The second lock: somebody has opened the first.
// SR-OPR01
TEST_F(ForeignUser, MayAskButNotCommandWhereTheFileLetsThemIn) {
  Open(kGroup);
  ASSERT_EQ(chmod(path_.c_str(), 0666), 0);
  EXPECT_EQ(CommandAs(kNogroup, {1, 2}), kCommandRefused);
  EXPECT_EQ(counters().not_permitted, 1u);
  EXPECT_EQ(counters().messages, 1u) << "the question";
}

// SR-OPR01
TEST_F(ForeignUser, MayNotCommandWhereThereIsNoGroup) {
  Open();
  EXPECT_EQ(CommandAs(kNogroup, {group_}), kNotConnected);
  ASSERT_EQ(chmod(path_.c_str(), 0666), 0);
  EXPECT_EQ(CommandAs(group_, {0, group_}), kCommandRefused);
}

TEST_F(ForeignUser, IsTurnedAwayWhereThereIsNoPlace) {
  Open(kGroup);
  ASSERT_EQ(chmod(path_.c_str(), 0666), 0);
  std::vector<std::unique_ptr<Operator>> clients;
  for (int i = 0; i < ControlSocket::kMaxClients; ++i) {
    clients.push_back(std::make_unique<Operator>(path_));
  }
  ReceiveAll();
  ASSERT_EQ(counters().connected, 8u);
  EXPECT_EQ(CommandAs(kNogroup, {}), kNothing);
  EXPECT_EQ(counters().turned_away, 1u);
  EXPECT_EQ(counters().displaced, 0u);
  EXPECT_EQ(CommandAs(kNogroup, {group_}), kCommandGiven);
  EXPECT_EQ(counters().displaced, 1u);
}

}  // namespace
}  // namespace hardpack
