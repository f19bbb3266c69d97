// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/can_frame.h"
#include "port_linux/files/read_outcome.h"
#include "tools/sim/script/scripted_vehicle.h"

// Sockets for a simulated vehicle, implemented separately in a few lines: a mistake in port_linux
// must not be hidden by the same mistake here.

namespace hardpack::wire {

class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(FileDescriptor&& other) noexcept : descriptor_(other.descriptor_) {
    other.descriptor_ = -1;
  }
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;
  ~FileDescriptor();

  int get() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

struct ReceivedFrame {
  CanFrame frame;
  uint64_t time_ns = 0;  // CLOCK_MONOTONIC, when the kernel received it
};

// CLOCK_MONOTONIC.
uint64_t Now_ns();

// A raw CAN socket. Frames have their time of arrival, so that a drive's time-out does not expire
// because this process was scheduled late.
class VehicleCan {
 public:
  ReadOutcome Open(const std::string& interface);

  int descriptor() const { return socket_.get(); }
  // All frames received; error frames and everything but classic frames are ignored.
  void Receive(std::vector<ReceivedFrame>& frames);
  void Send(const CanFrame& frame);
  void Send(const sim::BusError& error);

  uint64_t received = 0;
  uint64_t sent = 0;
  uint64_t failed = 0;  // to send

 private:
  void Write(const void* frame, size_t bytes);

  FileDescriptor socket_;
};

// "127.0.0.1:7502"; port 0: any.
struct Endpoint {
  std::string address;
  uint16_t port = 0;
};
ReadOutcome ParseEndpoint(const std::string& text, Endpoint& endpoint);

// Sends datagrams from one address and port to another.
class DatagramSender {
 public:
  ReadOutcome Open(const Endpoint& from, const Endpoint& to);
  void Send(std::span<const uint8_t> bytes);

  uint64_t sent = 0;
  uint64_t failed = 0;

 private:
  FileDescriptor socket_;
};

}  // namespace hardpack::wire
