// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "tools/sim/sensors/sim_lidar.h"

// A segmentation computer beside the lidar: labels each return, sometimes wrongly and always with a
// delay, in the datagrams of docs/label_datagram.md (hal/labels writes them).

namespace hardpack::sim {

struct LabelSettings {
  double accuracy = 1.0;  // share of returns labelled correctly; the others get another class
  double delay_s = 0.06;  // from a datagram's last column to its sending
  int columns = 16;       // per datagram, 1 .. 64
  uint32_t seed = 1;
  // Faults: every return gets this label; and returns of one class get that of another. 0: off.
  uint8_t all_are = 0;
  uint8_t mistaken = 0;
  uint8_t mistaken_for = 0;
};

class SimLabels {
 public:
  explicit SimLabels(const LabelSettings& settings) : settings_(settings) {}

  // Takes the columns cast since the previous call, in order, and appends the datagrams sent up to
  // now_ns. A datagram ends early at the end of the lidar's frame.
  void Advance(uint64_t now_ns, const std::vector<CastColumn>& columns,
               std::vector<std::vector<uint8_t>>& datagrams);

  LabelSettings& settings() { return settings_; }

 private:
  struct Waiting {
    uint64_t send_ns;
    std::vector<uint8_t> bytes;
  };

  void Send();
  uint8_t Named(uint8_t label, uint64_t index) const;

  LabelSettings settings_;
  std::vector<CastColumn> columns_;  // of the next datagram
  std::deque<Waiting> waiting_;
  uint32_t sequence_ = 0;
  uint64_t returns_ = 0;  // ever: counts the random numbers
};

}  // namespace hardpack::sim
