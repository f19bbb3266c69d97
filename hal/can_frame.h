// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/loop_bound.h"

namespace hardpack {

inline constexpr int kMaxCanData_bytes = 8;
inline constexpr uint32_t kMaxStandardCanId = 0x7ffu;
inline constexpr uint32_t kMaxExtendedCanId = 0x1fffffffu;

// One classic CAN data or remote frame, as it stands on the bus (ISO 11898-1). Error frames, which
// a controller reports but no node sends, are not frames of this type: they are the bus's state.
struct CanFrame {
  uint32_t id = 0;        // 11 bits, or 29 where extended
  bool extended = false;  // 29-bit identifier
  bool remote = false;    // remote transmission request: size says what is asked for, no data
  uint8_t size = 0;       // 0 .. 8 bytes
  uint8_t data[kMaxCanData_bytes] = {};  // [size], the rest 0
  // Our time at which it came off the bus, as far as the receiver tells; 0: it does not. No part of
  // the frame: what compares equal stands on the bus alike.
  uint64_t received_ns = 0;

  constexpr bool operator==(const CanFrame& other) const {
    bool same = id == other.id && extended == other.extended && remote == other.remote &&
                size == other.size;
    HP_LOOP_BOUND(kMaxCanData_bytes)
    for (int i = 0; i < kMaxCanData_bytes; ++i) same = same && data[i] == other.data[i];
    return same;
  }
};
static_assert(std::is_trivially_copyable_v<CanFrame>);

// Whether the identifier fits its kind and the size its array.
constexpr bool IsValid(const CanFrame& frame) {
  return frame.size <= kMaxCanData_bytes &&
         frame.id <= (frame.extended ? kMaxExtendedCanId : kMaxStandardCanId);
}

}  // namespace hardpack
