// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "hal/can_batch.h"
#include "hal/can_bus.h"
#include "hal/onboard/pilot/pilot.h"

// Input and output of a tick, for any vehicle. Types only.

namespace hardpack {

struct TickDatagram {
  InputSource source = InputSource::kIns;
  std::span<const uint8_t> bytes;
};

struct TickInput {
  uint64_t index = 0;   // of the tick; a gap: missed ticks
  uint64_t now_ns = 0;  // our clock, read once: everything in this input counts as received now
  CanBusState bus = CanBusState::kDown;
  std::span<const TickDatagram> datagrams;  // at most kMaxDatagramsPerTick
  std::span<const CanFrame> frames;         // at most CanBus::kMaxFramesPerTick, in order
  std::span<const uint8_t> command;         // one control message from a permitted sender, or empty
};

struct TickOutput : CommandAnswer {
  CanBatch frames;  // to send, in order
};

// Limits of a tick per source, for any vehicle.
struct TickLimits {
  static constexpr int kMaxDatagramsPerTick = 32;
  // Of these, the port takes at most this many from the INS and of labels, so that none can block
  // the others: as many labels as the fastest lidar needs. The lidar gets the rest.
  static constexpr int kMaxInsDatagrams = 6;
  static constexpr int kMaxLabelDatagrams = 13;
  // For a datagram of the INS: more than a second of its messages.
  static constexpr int kMaxInsDatagram_bytes = 4096;
  static constexpr int kMaxInsFeeds = 4;
  // For all datagrams of a tick: a quarter of a second of the fastest INS. The rest waits.
  static constexpr int kMaxInsMessages = 64;
};

}  // namespace hardpack
