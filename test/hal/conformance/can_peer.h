// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

#include "hal/can_frame.h"
#include "port_linux/file_descriptor.h"

namespace hardpack {

// Another program on a SocketCAN interface: a raw socket, as blunt as the kernel lets it be.
class CanPeer {
 public:
  // `priority` as for SO_PRIORITY: the class of the queueing discipline that its frames take.
  explicit CanPeer(const char* interface, int priority = 0)
      : socket_(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
    const int on = 1;
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface));
    ready_ = socket_.valid() && address.can_ifindex != 0 &&
             setsockopt(socket_.get(), SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) == 0 &&
             bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    (void)setsockopt(socket_.get(), SOL_SOCKET, SO_PRIORITY, &priority, sizeof(priority));
  }

  bool ready() const { return ready_; }

  template <typename Wire>
  bool Write(const Wire& wire) {
    ssize_t written = 0;
    do {  // that the interface went down before is told once
      written = send(socket_.get(), &wire, sizeof(wire), 0);
    } while (written < 0 && errno == ENETDOWN && ++retries_ < 1000);
    retries_ = 0;
    return written == sizeof(wire);
  }

  bool Send(const CanFrame& frame) {
    can_frame wire{};
    wire.can_id =
        frame.id | (frame.extended ? CAN_EFF_FLAG : 0) | (frame.remote ? CAN_RTR_FLAG : 0);
    wire.len = frame.size;
    std::copy(frame.data, frame.data + frame.size, wire.data);
    return Write(wire);
  }

  // The next data or remote frame of another program.
  bool Receive(CanFrame& frame) {
    can_frame wire{};
    ssize_t got = 0;
    do {  // that the interface went down is told once
      got = recv(socket_.get(), &wire, sizeof(wire), 0);
    } while (got < 0 && (errno == ENETDOWN || errno == ENODEV));
    if (got != sizeof(wire)) return false;
    frame = {};
    frame.extended = (wire.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = (wire.can_id & CAN_RTR_FLAG) != 0;
    frame.id = wire.can_id & CAN_EFF_MASK;
    frame.size = wire.len;
    std::copy(wire.data, wire.data + wire.len, frame.data);
    return true;
  }

  // An error frame, as a driver would give it.
  bool SendError(uint32_t classes, uint8_t controller = 0) {
    can_frame wire{};
    wire.can_id = CAN_ERR_FLAG | classes;
    wire.len = CAN_ERR_DLC;
    wire.data[1] = controller;
    return Write(wire);
  }

 private:
  FileDescriptor socket_;
  int retries_ = 0;
  bool ready_ = false;
};

}  // namespace hardpack
