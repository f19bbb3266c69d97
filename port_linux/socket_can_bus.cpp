// SPDX-License-Identifier: Apache-2.0
#include "port_linux/socket_can_bus.h"

#include <linux/can/error.h>
#include <linux/can/raw.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace hardpack {
namespace {

// Byte 1 of an error frame of class CAN_ERR_CRTL.
constexpr uint8_t kPassiveBits = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
constexpr uint8_t kWarningBits = CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;

OpenOutcome Failure(Status status, const std::string& interface, const std::string& what) {
  return {status, interface + ": " + what, {}};
}

can_frame ToWire(const CanFrame& frame) {
  can_frame wire{};
  wire.can_id = frame.id;
  if (frame.extended) wire.can_id |= CAN_EFF_FLAG;
  if (frame.remote) wire.can_id |= CAN_RTR_FLAG;
  wire.len = frame.size;
  if (!frame.remote) std::copy_n(frame.data, frame.size, wire.data);
  return wire;
}

// False: no bus can carry it. A virtual bus forwards whatever a program writes to it.
bool FromWire(const canfd_frame& wire, unsigned size, CanFrame& frame) {
  if (size != CAN_MTU || wire.len > CAN_MAX_DLEN) return false;
  frame = {};
  frame.extended = (wire.can_id & CAN_EFF_FLAG) != 0;
  frame.remote = (wire.can_id & CAN_RTR_FLAG) != 0;
  frame.id = wire.can_id & CAN_EFF_MASK;
  frame.size = wire.len;
  if (!frame.remote) std::copy_n(wire.data, wire.len, frame.data);
  return IsValid(frame);
}

int64_t Nanoseconds(const timespec& time) {
  constexpr int64_t kNanosecondsPerSecond = 1'000'000'000;
  return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
}

int64_t TimeOf(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return Nanoseconds(now);
}

std::string Describe(const std::string& interface, const LinkInfo& info) {
  if (info.bit_rate_bps == 0) return interface + ": no bit rate reported (a virtual bus?)";
  return interface + ": " + std::to_string(info.bit_rate_bps) + " bit/s, sample point " +
         std::to_string(info.sample_point_permille) + " per mille, restart-ms " +
         std::to_string(info.restart_ms);
}

}  // namespace

SocketCanBus::SocketCanBus() {
  for (size_t i = 0; i < messages_.size(); ++i) {
    parts_[i] = {&wires_[i], sizeof(wires_[i])};
    messages_[i].msg_hdr.msg_iov = &parts_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = controls_[i].bytes.data();
  }
}

OpenOutcome SocketCanBus::OpenSocket(const std::string& interface,
                                     const SocketCanOptions& options) {
  FileDescriptor opened(socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (!opened.valid()) {
    const int code = errno;
    if (code == EPERM || code == EACCES) {
      return Failure(Status::kNotPermitted, interface, "no permission to open a CAN socket");
    }
    return Failure(Status::kUnsupported, interface,
                   std::string("no CAN socket (") + std::strerror(code) + "; modprobe can_raw)");
  }
  const auto set = [&opened](int level, int name, const auto& value) {
    return setsockopt(opened.get(), level, name, &value, sizeof(value)) == 0;
  };
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  const int on = 1;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = link_.info().index;
  if (!set(SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) ||
      !set(SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, on) || !set(SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on) ||
      !set(SOL_SOCKET, SO_RXQ_OVFL, on) || !set(SOL_SOCKET, SO_TIMESTAMPNS, on) ||
      bind(opened.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const int code = errno;
    return Failure(Status::kSystemError, interface,
                   std::string("CAN socket: ") + std::strerror(code));
  }
  OpenOutcome outcome{Status::kOk, Describe(interface, link_.info()), {}};
  int granted = 0;
  socklen_t size = sizeof(granted);
  if (!set(SOL_SOCKET, SO_RCVBUFFORCE, options.receive_buffer_bytes)) {
    (void)set(SOL_SOCKET, SO_RCVBUF, options.receive_buffer_bytes);
  }
  getsockopt(opened.get(), SOL_SOCKET, SO_RCVBUF, &granted, &size);
  if (granted / 2 < options.receive_buffer_bytes) {  // the kernel doubles it (socket(7))
    outcome.warnings.push_back(interface + ": receive buffer " + std::to_string(granted / 2) +
                               " of " + std::to_string(options.receive_buffer_bytes) +
                               " bytes (sysctl net.core.rmem_max, or CAP_NET_ADMIN)");
  }
  socket_ = std::move(opened);
  return outcome;
}

OpenOutcome SocketCanBus::Open(const std::string& interface, const SocketCanOptions& options) {
  if (OpenOutcome outcome = link_.Open(interface); !outcome.ok()) return outcome;
  const LinkInfo& info = link_.info();
  if (options.bit_rate_bps != 0 && info.bit_rate_bps != 0 &&
      options.bit_rate_bps != info.bit_rate_bps) {
    return Failure(Status::kWrongDevice, interface,
                   std::to_string(info.bit_rate_bps) + " bit/s, configured are " +
                       std::to_string(options.bit_rate_bps));
  }
  OpenOutcome outcome = OpenSocket(interface, options);
  if (!outcome.ok()) return outcome;
  if (options.restart) {
    may_restart_ = link_.AskPermission();
    if (!may_restart_) {
      outcome.warnings.push_back(interface + ": may not be restarted after bus-off, and up to " +
                                 std::to_string(kMaxUnconfirmed) +
                                 " old frames may go out after it (needs CAP_NET_ADMIN)");
    }
  }
  if (!info.up) {
    outcome.warnings.push_back(interface + ": is down (ip link set " + interface + " up)");
  }
  link_.Watch(socket_.get());
  return outcome;
}

CanBusState SocketCanBus::state() const {
  if (bus_off_) return CanBusState::kBusOff;
  // Our own restart to drop old frames is not an outage: new frames wait for it.
  if (!link_.usable() && !restarting_) return CanBusState::kDown;
  return error_state_;
}

Status SocketCanBus::Refuse(Status status) {
  ++counters_.refused;
  return status;
}

void SocketCanBus::Expire(int frames) {
  counters_.expired += static_cast<uint64_t>(frames);
}

void SocketCanBus::DropAll() {
  Expire(queue_.DropWaiting());
  Expire(queue_.ForgetUnconfirmed());
  stale_counted_ = false;
}

void SocketCanBus::Advance(uint64_t now_ns) {
  now_ns_ = std::max(now_ns_, now_ns);
  if (!socket_.valid()) return;
  const bool all_read = Read();
  FollowLink();
  FollowRestart();
  Expire(queue_.DropExpired(now_ns_));
  // An echo that has not been read yet is not missing.
  if (all_read) DropStale();
  if (!IsUsable(HandOver())) Expire(1);
}

Status SocketCanBus::Send(const CanFrame& frame, uint64_t deadline_ns) {
  if (!IsValid(frame)) return Refuse(Status::kInvalidArgument);
  const CanBusState now = state();
  if (now == CanBusState::kBusOff) return Refuse(Status::kBusOff);
  if (now == CanBusState::kDown) return Refuse(Status::kInterfaceDown);
  if (deadline_ns <= now_ns_) return Refuse(Status::kExpired);
  if (!IsUsable(queue_.Add(frame, deadline_ns))) return Refuse(Status::kCapacityExceeded);
  ++counters_.accepted;
  if (const Status status = HandOver(); !IsUsable(status)) {
    --counters_.accepted;
    return Refuse(status);
  }
  return Status::kOk;
}

// kSystemError: the newest frame was refused, and dropped.
Status SocketCanBus::HandOver() {
  if (restarting_ || !link_.usable() || now_ns_ < silent_until_ns_) return Status::kOk;
  Status status = Status::kOk;
  while (queue_.CanHandOver()) {
    const can_frame wire = ToWire(queue_.next());
    if (send(socket_.get(), &wire, sizeof(wire), MSG_DONTWAIT) == sizeof(wire)) {
      queue_.HandedOver();
      continue;
    }
    // The kernel's queue is full, or the interface is going down: the frame waits.
    const bool waits = errno == EAGAIN || errno == ENOBUFS || errno == ENETDOWN || errno == ENXIO ||
                       errno == ENODEV || errno == EINTR;
    if (waits) break;
    ++counters_.system_errors;
    queue_.DropNext();
    if (queue_.waiting() == 0) {
      status = Status::kSystemError;
    } else {
      Expire(1);
    }
  }
  return status;
}

Status SocketCanBus::Receive(CanFrame& frame) {
  if (received_count_ == 0) return Status::kEmpty;
  frame = received_[static_cast<size_t>(received_first_)];
  received_first_ = (received_first_ + 1) % kMaxFramesPerTick;
  --received_count_;
  ++counters_.received;
  return Status::kOk;
}

// True: nothing is left to read.
bool SocketCanBus::Read() {
  wall_minus_ours_ns_ = TimeOf(CLOCK_REALTIME) - TimeOf(CLOCK_MONOTONIC);
  int reads = 0;
  while (reads < kMaxReads && received_count_ < kMaxFramesPerTick) {
    const int wanted = std::min(kBatch, kMaxFramesPerTick - received_count_);
    for (size_t i = 0; i < static_cast<size_t>(wanted); ++i) {
      msghdr& header = messages_[i].msg_hdr;  // the kernel overwrites the lengths
      header.msg_controllen = controls_[i].bytes.size();
      header.msg_flags = 0;
    }
    const int got = recvmmsg(socket_.get(), messages_.data(), static_cast<unsigned>(wanted),
                             MSG_DONTWAIT, nullptr);
    ++reads;
    if (got < 0) {
      if (errno == EAGAIN) return true;
      // The kernel reports once, by the next call, that it went down; the remaining frames are
      // kept.
      if (errno == ENETDOWN || errno == ENODEV) continue;
      ++counters_.system_errors;
      return false;
    }
    reads += got - 1;
    for (size_t i = 0; i < static_cast<size_t>(got); ++i) {
      const uint64_t received_ns = TakeControl(messages_[i].msg_hdr);
      TakeFrame(wires_[i], messages_[i].msg_len, messages_[i].msg_hdr.msg_flags, received_ns);
    }
    if (got < wanted) return true;
  }
  return false;
}

// The control data of a frame. Returns its stamp, by our clock; 0: it has none. If the wall clock
// is set between stamp and reading, the frames waiting at that moment look too old or too new.
uint64_t SocketCanBus::TakeControl(const msghdr& header) {
  uint64_t received_ns = 0;
  for (const cmsghdr* control = CMSG_FIRSTHDR(&header); control != nullptr;
       control = CMSG_NXTHDR(const_cast<msghdr*>(&header), const_cast<cmsghdr*>(control))) {
    if (control->cmsg_level != SOL_SOCKET) continue;
    if (control->cmsg_type == SO_RXQ_OVFL) {
      uint32_t drops = 0;
      std::memcpy(&drops, CMSG_DATA(control), sizeof(drops));
      TakeLosses(drops);
    } else if (control->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(control), sizeof(stamp));
      const int64_t ours_ns = Nanoseconds(stamp) - wall_minus_ours_ns_;
      received_ns = ours_ns > 0 ? std::min(static_cast<uint64_t>(ours_ns), now_ns_) : 0;
    }
  }
  return received_ns;
}

void SocketCanBus::TakeLosses(uint32_t drops) {
  if (drops == kernel_drops_) return;
  counters_.lost += drops - kernel_drops_;
  kernel_drops_ = drops;
  (void)queue_.ForgetUnconfirmed();
}

void SocketCanBus::TakeFrame(const canfd_frame& wire, unsigned size, int flags,
                             uint64_t received_ns) {
  if ((wire.can_id & CAN_ERR_FLAG) != 0) {
    TakeErrorFrame(wire);
    return;
  }
  CanFrame frame;
  if (!FromWire(wire, size, frame)) {
    ++counters_.malformed;
    return;
  }
  if ((flags & MSG_CONFIRM) != 0) {
    if (!queue_.Confirm(frame)) return;  // from before a restart or a loss
    ++counters_.confirmed;
    silence_ns_ = kFirstSilence_ns;
    stale_counted_ = false;
    return;
  }
  frame.received_ns = received_ns;
  received_[static_cast<size_t>((received_first_ + received_count_) % kMaxFramesPerTick)] = frame;
  ++received_count_;
}

void SocketCanBus::TakeErrorFrame(const canfd_frame& wire) {
  ++counters_.error_frames;
  if ((wire.can_id & CAN_ERR_CRTL) != 0) {
    const uint8_t bits = wire.data[1];
    if ((bits & CAN_ERR_CRTL_RX_OVERFLOW) != 0) ++counters_.lost;
    if ((bits & kPassiveBits) != 0) {
      error_state_ = CanBusState::kPassive;
    } else if ((bits & kWarningBits) != 0) {
      error_state_ = CanBusState::kWarning;
    } else if ((bits & CAN_ERR_CRTL_ACTIVE) != 0) {
      error_state_ = CanBusState::kActive;
    }
  }
  if ((wire.can_id & CAN_ERR_BUSOFF) != 0) EnterBusOff();
  // Restarted by the kernel or another program. Our own restart ends with the silence after it.
  if ((wire.can_id & CAN_ERR_RESTARTED) != 0 && bus_off_ && !may_restart_) {
    bus_off_ = false;
    error_state_ = CanBusState::kActive;
  }
}

void SocketCanBus::EnterBusOff() {
  if (bus_off_ && !restarted_) return;  // reported twice
  ++counters_.bus_offs;
  bus_off_ = true;
  kernel_said_bus_off_ = false;
  restarted_ = false;
  DropAll();
  if (may_restart_) {
    if (!restarting_) BeginRestart();
  } else {
    ++counters_.system_errors;
  }
}

void SocketCanBus::BeginRestart() {
  restarting_ = true;
  silent_until_ns_ = now_ns_ + silence_ns_;
  silence_ns_ = std::min(2 * silence_ns_, kLastSilence_ns);
  link_.BeginRestart();
}

void SocketCanBus::FollowLink() {
  link_.Poll();
  if (link_.downs() != downs_seen_) {
    counters_.went_down += link_.downs() - downs_seen_;
    downs_seen_ = link_.downs();
    bus_off_ = false;
    error_state_ = CanBusState::kActive;
    DropAll();
  }
  if (restarting_) return;
  if (link_.bus_off()) {
    EnterBusOff();
    kernel_said_bus_off_ = true;
  } else if (kernel_said_bus_off_ && bus_off_ && !may_restart_) {
    bus_off_ = false;
    error_state_ = CanBusState::kActive;
  }
  if (!link_.present()) bus_off_ = false;
  if (!link_.usable()) DropAll();
}

void SocketCanBus::FollowRestart() {
  if (restarting_ && link_.restart() != CanLink::Restart::kRunning) {
    restarting_ = false;
    error_state_ = CanBusState::kActive;
    Expire(queue_.ForgetUnconfirmed());
    const bool done = link_.restart() == CanLink::Restart::kDone;
    (done ? counters_.restarts : counters_.system_errors) += 1;
    restarted_ = done;
    owes_up_ = !done;
  }
  if (link_.usable() || !link_.present()) owes_up_ = false;
  if (restarting_ || now_ns_ < silent_until_ns_) return;
  if (bus_off_ && restarted_) {
    bus_off_ = false;
  } else if (may_restart_ && (bus_off_ || owes_up_)) {
    BeginRestart();
  }
}

void SocketCanBus::DropStale() {
  if (restarting_ || !queue_.IsStale(now_ns_)) return;
  if (may_restart_) {
    Expire(queue_.ForgetUnconfirmed());
    BeginRestart();
  } else if (!stale_counted_) {
    stale_counted_ = true;
    ++counters_.system_errors;
  }
}

}  // namespace hardpack
