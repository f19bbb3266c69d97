// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "hal/can_frame.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

// A tape: the ticks of a flight log as a processor without an operating system can take them. The
// host writes it from a log (write_tape.cpp), which holds the configuration as text. Structures go
// as they lie in memory, which both processors agree in: the sizes are asserted on both, and a
// field in another place would decide otherwise.
//
//   TapeHead  VehicleConfig  { TapeTick  { TapeDatagram  bytes }  CanFrame in...  command
//                              CanFrame out... }

namespace hardpack {

inline constexpr uint64_t kTapeMagic = 0x31455041544b5048u;  // "HPKTAPE1"

struct TapeHead {
  uint64_t magic = kTapeMagic;
  uint32_t config_bytes = sizeof(VehicleConfig);
  uint32_t ticks = 0;
};

// What Tick is to be given, and what it is to decide.
struct TapeTick {
  uint64_t index = 0;
  uint64_t now_ns = 0;
  uint64_t decision_hash = 0;
  uint16_t bus = 0;     // CanBusState
  uint16_t status = 0;  // of Tick
  uint16_t datagrams = 0;
  uint16_t frames_in = 0;
  uint16_t frames_out = 0;
  uint16_t command_bytes = 0;
  uint32_t payload_bytes = 0;  // of everything behind this
};

struct TapeDatagram {
  uint32_t source = 0;  // InputSource
  uint32_t bytes = 0;
};

// A datagram is at most so large, and a tick then at most:
inline constexpr size_t kMaxTapeDatagram_bytes = 65507;
inline constexpr size_t kMaxTapePayload_bytes =
    VehicleLoop::kMaxDatagramsPerTick * (sizeof(TapeDatagram) + kMaxTapeDatagram_bytes) +
    (CanBus::kMaxFramesPerTick + kMaxFramesOut) * sizeof(CanFrame) + control::kMaxMessageBytes;

static_assert(sizeof(TapeHead) == 16 && sizeof(TapeTick) == 40 && sizeof(TapeDatagram) == 8);
static_assert(sizeof(CanFrame) == 24);
static_assert(sizeof(VehicleConfig) == 52616);
static_assert(std::is_trivially_copyable_v<VehicleConfig>);

}  // namespace hardpack
