// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/loop_bound.h"

namespace hardpack {

inline constexpr int kMaxCanData_bytes = 8;
inline constexpr uint32_t kMaxStandardCanId = 0x7ffu;
inline constexpr uint32_t kMaxExtendedCanId = 0x1fffffffu;

// One classic CAN data or remote frame, as on the bus (ISO 11898-1). Error frames, which a
// controller reports but no node sends, are not frames of this type: they are part of the bus's
// state.
struct CanFrame {
  uint32_t id = 0;        // 11 bits, or 29 where extended
  bool extended = false;  // 29-bit identifier
  bool remote = false;    // remote transmission request: size is the requested one, no data
  uint8_t size = 0;       // 0 .. 8 bytes
  uint8_t data[kMaxCanData_bytes] = {};  // [size], the rest 0
  // Time of arrival from the bus on our clock, if the receiver reports it; 0: unknown. Not part of
  // the frame: equal frames are identical on the bus.
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

// Whether the identifier fits its kind and the size fits its array.
constexpr bool IsValid(const CanFrame& frame) {
  return frame.size <= kMaxCanData_bytes &&
         frame.id <= (frame.extended ? kMaxExtendedCanId : kMaxStandardCanId);
}

}  // namespace hardpack
