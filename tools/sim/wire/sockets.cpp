// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/wire/sockets.h"

#include <arpa/inet.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <utility>

namespace hardpack::wire {
namespace {

ReadOutcome Failure(const std::string& what) {
  return {Status::kSystemError, what + ": " + std::strerror(errno)};
}

ReadOutcome ToAddress(const Endpoint& endpoint, sockaddr_in& address) {
  address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  if (inet_pton(AF_INET, endpoint.address.c_str(), &address.sin_addr) == 1) return {};
  return {Status::kInvalidArgument, endpoint.address + ": no IPv4 address"};
}

uint64_t ToNanoseconds(const timespec& time) {
  return static_cast<uint64_t>(time.tv_sec) * 1'000'000'000u + static_cast<uint64_t>(time.tv_nsec);
}

uint64_t ClockNow_ns(clockid_t clock) {
  timespec now = {};
  clock_gettime(clock, &now);
  return ToNanoseconds(now);
}

// Of the wall clock; 0: the kernel did not say.
uint64_t KernelTime_ns(msghdr& message) {
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec time = {};
    std::memcpy(&time, CMSG_DATA(part), sizeof(time));
    return ToNanoseconds(time);
  }
  return 0;
}

}  // namespace

uint64_t Now_ns() {
  return ClockNow_ns(CLOCK_MONOTONIC);
}

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

FileDescriptor::~FileDescriptor() {
  if (descriptor_ >= 0) close(descriptor_);
}

ReadOutcome VehicleCan::Open(const std::string& interface) {
  socket_ = FileDescriptor(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (socket_.get() < 0) return Failure(interface);
  sockaddr_can address = {};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0) return Failure(interface);
  if (bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return Failure(interface);
  }
  constexpr int kOn = 1;
  if (setsockopt(socket_.get(), SOL_SOCKET, SO_TIMESTAMPNS, &kOn, sizeof(kOn)) != 0) {
    return Failure(interface);
  }
  return {};
}

void VehicleCan::Receive(std::vector<ReceivedFrame>& frames) {
  const int64_t wall_ahead_ns = static_cast<int64_t>(ClockNow_ns(CLOCK_REALTIME) - Now_ns());
  can_frame raw = {};
  alignas(cmsghdr) char control[CMSG_SPACE(sizeof(timespec))];
  while (true) {
    iovec part = {&raw, sizeof(raw)};
    msghdr message = {};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control;
    message.msg_controllen = sizeof(control);
    if (recvmsg(socket_.get(), &message, 0) != static_cast<ssize_t>(sizeof(raw))) return;
    ++received;
    if ((raw.can_id & CAN_ERR_FLAG) != 0 || raw.can_dlc > kMaxCanData_bytes) continue;
    ReceivedFrame one;
    CanFrame& frame = one.frame;
    frame.extended = (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.id = raw.can_id & (frame.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.size = raw.can_dlc;
    if (!frame.remote) std::copy_n(raw.data, frame.size, frame.data);
    const uint64_t wall_ns = KernelTime_ns(message);
    one.time_ns = wall_ns == 0 ? Now_ns() : wall_ns - static_cast<uint64_t>(wall_ahead_ns);
    frames.push_back(one);
  }
}

void VehicleCan::Send(const CanFrame& frame) {
  can_frame raw = {};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0u) | (frame.remote ? CAN_RTR_FLAG : 0u);
  raw.can_dlc = frame.size;
  std::copy_n(frame.data, frame.size, raw.data);
  Write(&raw, sizeof(raw));
}

void VehicleCan::Send(const sim::BusError& error) {
  can_frame raw = {};
  raw.can_id = CAN_ERR_FLAG | error.error_class;
  raw.can_dlc = CAN_MAX_DLEN;
  raw.data[1] = error.controller;
  Write(&raw, sizeof(raw));
}

void VehicleCan::Write(const void* frame, size_t bytes) {
  if (write(socket_.get(), frame, bytes) == static_cast<ssize_t>(bytes)) {
    ++sent;
  } else {
    ++failed;  // the interface is down, say: a bus has no memory
  }
}

ReadOutcome ParseEndpoint(const std::string& text, Endpoint& endpoint) {
  const size_t colon = text.find(':');
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
  if (error != std::errc() || end != port.data() + port.size()) {
    return {Status::kInvalidArgument, text + ": expected ADDRESS:PORT"};
  }
  endpoint.address = text.substr(0, colon);
  sockaddr_in address = {};
  return ToAddress(endpoint, address);
}

ReadOutcome DatagramSender::Open(const Endpoint& from, const Endpoint& to) {
  const std::string name = from.address + " to " + to.address;
  socket_ = FileDescriptor(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  sockaddr_in source = {};
  sockaddr_in destination = {};
  for (const ReadOutcome& outcome : {ToAddress(from, source), ToAddress(to, destination)}) {
    if (!outcome.ok()) return outcome;
  }
  const auto* source_address = reinterpret_cast<const sockaddr*>(&source);
  const auto* destination_address = reinterpret_cast<const sockaddr*>(&destination);
  constexpr int kBuffer_bytes = 1 << 20;
  if (socket_.get() < 0 ||
      setsockopt(socket_.get(), SOL_SOCKET, SO_SNDBUF, &kBuffer_bytes, sizeof(kBuffer_bytes)) !=
          0 ||
      bind(socket_.get(), source_address, sizeof(source)) != 0 ||
      connect(socket_.get(), destination_address, sizeof(destination)) != 0) {
    return Failure(name);
  }
  return {};
}

void DatagramSender::Send(std::span<const uint8_t> bytes) {
  ssize_t result = send(socket_.get(), bytes.data(), bytes.size(), 0);
  // Nobody received an earlier one: the kernel reports that once, and sends nothing.
  if (result < 0 && errno == ECONNREFUSED) {
    result = send(socket_.get(), bytes.data(), bytes.size(), 0);
  }
  if (result == static_cast<ssize_t>(bytes.size())) {
    ++sent;
  } else {
    ++failed;
  }
}

}  // namespace hardpack::wire
