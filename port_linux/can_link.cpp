// SPDX-License-Identifier: Apache-2.0
#include "port_linux/can_link.h"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/if.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>

namespace hardpack {
namespace {

// The sequence numbers of requests: those below are used once each at start-up; each restart uses
// the next two from kFirstRestart, for down and up.
constexpr uint32_t kQuery = 1;
constexpr uint32_t kPermission = 2;
constexpr uint32_t kFirstRestart = 4;
constexpr int kPatience_ms = 2000;

OpenOutcome Failure(Status status, const std::string& name, const std::string& what) {
  return {status, name + ": " + what, {}};
}

}  // namespace

CanLink::~CanLink() {
  if (!thread_.joinable()) return;
  Ask(kStopBit);
  thread_.join();
}

OpenOutcome CanLink::Open(const std::string& name) {
  if (name.empty() || name.size() > kMaxLinkName) {
    return Failure(Status::kInterfaceDown, name, "no such interface");
  }
  name_ = name;
  netlink_.Reset(socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, NETLINK_ROUTE));
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = RTMGRP_LINK;
  query_ = LinkQuery(kQuery, name);
  sequence_ = kQuery;
  int code = 0;
  if (!netlink_.valid() ||
      bind(netlink_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      send(netlink_.get(), query_.data(), query_.size(), 0) < 0) {
    code = errno;
    return Failure(Status::kSystemError, name, std::string("rtnetlink: ") + std::strerror(code));
  }
  if (!WaitForAnswer(kQuery, code)) {
    return Failure(Status::kTimedOut, name, "the kernel does not answer");
  }
  if (code == ENODEV) return Failure(Status::kInterfaceDown, name, "no such interface");
  if (code != 0) return Failure(Status::kSystemError, name, std::strerror(code));
  if (!info_.is_can) return Failure(Status::kUnsupported, name, "not a CAN interface");
  return {};
}

bool CanLink::AskPermission() {
  sequence_ = kPermission;
  const LinkRequest request = SetLinkFlags(kPermission, info_.index, 0, 0);
  int code = 0;
  return send(netlink_.get(), request.bytes, sizeof(request.bytes), 0) >= 0 &&
         WaitForAnswer(kPermission, code) && code == 0;
}

void CanLink::Watch(int can_socket) {
  can_socket_ = can_socket;
  bound_ = true;
  bound_index_ = info_.index;
  sequence_ = kFirstRestart;
  // Signals go to the tick's thread.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { Work(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_setname_np(thread_.native_handle(), "can-link");
}

// Runs in the thread. The result of a call is the kernel's answer, or bound_index_.
void CanLink::Work() {
  while (true) {
    work_.wait(0);
    const uint32_t work = work_.exchange(0);
    if ((work & kStopBit) != 0) return;
    const int index = index_;
    if ((work & kRestartBit) != 0) {
      const uint32_t sequence = restart_sequence_;
      const LinkRequest down = SetLinkFlags(sequence, index, 0, IFF_UP);
      const LinkRequest up = SetLinkFlags(sequence + 1, index, IFF_UP, IFF_UP);
      const bool down_asked = send(netlink_.get(), down.bytes, sizeof(down.bytes), 0) >= 0;
      const bool up_asked = send(netlink_.get(), up.bytes, sizeof(up.bytes), 0) >= 0;
      if (!down_asked || !up_asked) failed_sequence_ = sequence;
    }
    if ((work & kBindBit) != 0) {
      // The filters went with the old interface.
      const can_filter all{};
      sockaddr_can address{};
      address.can_family = AF_CAN;
      address.can_ifindex = index;
      if (setsockopt(can_socket_, SOL_CAN_RAW, CAN_RAW_FILTER, &all, sizeof(all)) == 0 &&
          bind(can_socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
        bound_index_ = index;
      }
    }
    if ((work & kQueryBit) != 0) send(netlink_.get(), query_.data(), query_.size(), 0);
  }
}

void CanLink::Ask(uint32_t work) {
  work_.fetch_or(work);
  work_.notify_one();
}

bool CanLink::WaitForAnswer(uint32_t sequence, int& code) {
  answer_ = -1;
  for (int attempt = 0; attempt < 1000; ++attempt) {
    pollfd ready{netlink_.get(), POLLIN, 0};
    if (poll(&ready, 1, kPatience_ms) == 0) return false;
    while (answer_ < 0 && ReceiveOnce()) {
    }
    if (answer_ >= 0 && sequence_ == sequence) {
      code = answer_;
      return true;
    }
  }
  return false;
}

// False: nothing more to receive now.
bool CanLink::ReceiveOnce() {
  const ssize_t got = recv(netlink_.get(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
  if (got < 0) {
    // ENOBUFS: notifications were lost, so the known state may be wrong: query it, once the thread
    // exists.
    if (errno != ENOBUFS) return false;
    if (restart_ == Restart::kRunning) restart_ = Restart::kDone;
    if (thread_.joinable()) Ask(kQueryBit);
    return true;
  }
  std::span<const uint8_t> bytes(buffer_.data(), static_cast<size_t>(got));
  for (NetlinkMessage message; NextNetlinkMessage(bytes, message);) TakeMessage(message);
  return true;
}

void CanLink::Poll() {
  for (int i = 0; i < kMaxMessages && ReceiveOnce(); ++i) {
  }
  if (restart_ == Restart::kRunning && failed_sequence_ == sequence_) restart_ = Restart::kRefused;
  if (present_ && !bound_ && bound_index_ == info_.index) bound_ = true;
}

void CanLink::TakeMessage(const NetlinkMessage& message) {
  LinkInfo link;
  int code = 0;
  if (message.type == RTM_NEWLINK || message.type == RTM_DELLINK) {
    if (!ParseLink(message.payload, link)) return;
    // The answer to a query by name shows a new index whose notification was lost.
    if (message.sequence == kQuery && present_ && link.index != info_.index) Leave();
    TakeLink(message.type, link);
    if (message.sequence == kQuery && answer_ < 0) answer_ = 0;
  } else if (message.type == NLMSG_ERROR && ParseAcknowledgement(message.payload, code)) {
    TakeAnswer(message.sequence, code);
  }
}

void CanLink::TakeLink(uint16_t type, const LinkInfo& link) {
  if (present_ ? link.index != info_.index : name_ != std::string_view(link.name)) return;
  if (type == RTM_DELLINK) {
    Leave();
    return;
  }
  const bool was_up = up();
  const bool is_new = !present_;
  present_ = true;
  info_ = link;
  if (was_up && !up() && restart_ != Restart::kRunning) ++downs_;
  if (is_new && thread_.joinable()) {
    index_ = link.index;
    Ask(kBindBit);
  }
}

// The interface is gone, and its index will not return.
void CanLink::Leave() {
  if (up()) ++downs_;
  present_ = false;
  bound_ = false;
}

void CanLink::TakeAnswer(uint32_t sequence, int code) {
  if (sequence < kFirstRestart) {
    if (sequence == sequence_) answer_ = code;
    if (sequence == kQuery && code == ENODEV) Leave();
    return;
  }
  if (restart_ != Restart::kRunning) return;
  if (sequence == sequence_) down_answer_ = code;
  if (sequence == sequence_ + 1) {
    restart_ = down_answer_ == 0 && code == 0 ? Restart::kDone : Restart::kRefused;
  }
}

void CanLink::BeginRestart() {
  sequence_ += 2;
  down_answer_ = 0;
  restart_ = Restart::kRunning;
  restart_sequence_ = sequence_;
  index_ = info_.index;
  Ask(kRestartBit);
}

}  // namespace hardpack
