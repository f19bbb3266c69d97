// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "hal/datagram_socket.h"

namespace hardpack::fakes {

// A DatagramSocket that receives what Deliver puts into its buffer. The bytes that Receive gives
// are overwritten by the next Receive, so that a use of stale ones shows.
class MemoryDatagramSocket final : public DatagramSocket {
 public:
  // Only datagrams of sender_address are given, and of sender_port unless that is 0.
  MemoryDatagramSocket(uint32_t sender_address, uint16_t sender_port,
                       size_t buffer_bytes = size_t{8} * 1024 * 1024)
      : sender_address_(sender_address), sender_port_(sender_port), buffer_bytes_(buffer_bytes) {
    counters_.receive_buffer_bytes = buffer_bytes;
  }

  // A datagram comes in; what does not fit the buffer is lost.
  void Deliver(std::span<const uint8_t> bytes, uint32_t address, uint16_t port,
               int64_t kernel_time_ns = 0) {
    if (waiting_bytes_ + bytes.size() > buffer_bytes_) {
      ++lost_;
      return;
    }
    waiting_bytes_ += bytes.size();
    waiting_.push_back({{bytes.begin(), bytes.end()}, address, port, kernel_time_ns, lost_});
  }
  // From the configured sender.
  void Deliver(std::span<const uint8_t> bytes) {
    Deliver(bytes, sender_address_, sender_port_ != 0 ? sender_port_ : uint16_t{49152});
  }

  // The next Receive fails, and finds nothing.
  void FailOnce() { fails_ = true; }

  std::span<const Datagram> Receive(int max) override {
    given_ = 0;
    for (std::vector<uint8_t>& bytes : taken_) std::fill(bytes.begin(), bytes.end(), uint8_t{0xdd});
    if (fails_) {
      fails_ = false;
      ++counters_.system_errors;
      return {};
    }
    const int wanted = std::clamp(max, 0, kMaxBatch);
    for (int i = 0; i < wanted && !waiting_.empty(); ++i) TakeNext();
    return {given_datagrams_.data(), static_cast<size_t>(given_)};
  }

  const DatagramCounters& counters() const override { return counters_; }

 private:
  struct Waiting {
    std::vector<uint8_t> bytes;
    uint32_t address;
    uint16_t port;
    int64_t kernel_time_ns;
    uint64_t lost_before;
  };

  void TakeNext() {
    Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= next.bytes.size();
    counters_.lost_in_kernel = next.lost_before;
    if (next.address != sender_address_ || (sender_port_ != 0 && next.port != sender_port_)) {
      ++counters_.foreign;
    } else if (next.bytes.size() > static_cast<size_t>(kMaxDatagram_bytes)) {
      ++counters_.oversized;
    } else {
      const size_t slot = static_cast<size_t>(given_++);
      ++counters_.received;
      counters_.received_bytes += next.bytes.size();
      taken_[slot] = std::move(next.bytes);
      given_datagrams_[slot] = {next.kernel_time_ns, next.address, next.port, taken_[slot]};
    }
  }

  uint32_t sender_address_;
  uint16_t sender_port_;
  size_t buffer_bytes_;
  size_t waiting_bytes_ = 0;
  uint64_t lost_ = 0;
  bool fails_ = false;
  std::deque<Waiting> waiting_;
  DatagramCounters counters_;
  int given_ = 0;
  std::array<Datagram, kMaxBatch> given_datagrams_;
  std::array<std::vector<uint8_t>, kMaxBatch> taken_;
};

}  // namespace hardpack::fakes
