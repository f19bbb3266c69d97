// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

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
  bool operator==(const CanFrame&) const = default;
};
static_assert(std::is_trivially_copyable_v<CanFrame>);

// Whether the identifier fits its kind and the size its array.
constexpr bool IsValid(const CanFrame& frame) {
  return frame.size <= kMaxCanData_bytes &&
         frame.id <= (frame.extended ? kMaxExtendedCanId : kMaxStandardCanId);
}

}  // namespace hardpack
