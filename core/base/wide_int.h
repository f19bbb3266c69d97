// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/assert.h"

// Operations on 64-bit integers that 32-bit processors would do in a library routine with unbounded
// loops; here in a fixed number of their own instructions.

namespace hardpack {

struct Division {
  int64_t quotient;
  int32_t remainder;  // in [0, divisor)
};

inline constexpr int32_t kMaxDivisor = 65535;

// Long division in digits of 16 bits. Precondition: dividend >= 0, 1 <= divisor <= kMaxDivisor.
// Cost: four 32-bit divisions.
constexpr Division Divide(int64_t dividend, int32_t divisor) {
  HP_ASSERT(dividend >= 0 && divisor >= 1 && divisor <= kMaxDivisor);
  const auto by = static_cast<uint32_t>(divisor);
  const auto high = static_cast<uint32_t>(static_cast<uint64_t>(dividend) >> 32u);
  const auto low = static_cast<uint32_t>(static_cast<uint64_t>(dividend) & 0xffffffffu);
  const uint32_t quotient_high = high / by;
  // Each is below divisor * 2^16, so its quotient is below 2^16.
  const uint32_t upper = ((high % by) << 16u) | (low >> 16u);
  const uint32_t lower = ((upper % by) << 16u) | (low & 0xffffu);
  const uint64_t quotient_low = (upper / by) << 16u | lower / by;
  return {static_cast<int64_t>(static_cast<uint64_t>(quotient_high) << 32u | quotient_low),
          static_cast<int32_t>(lower % by)};
}

// The value as a float: exact below 2^24, otherwise with a relative error below 2^-22.
constexpr float ToFloat(uint64_t value) {
  constexpr float kTwoTo32 = 4294967296.0f;
  return static_cast<float>(static_cast<uint32_t>(value >> 32u)) * kTwoTo32 +
         static_cast<float>(static_cast<uint32_t>(value & 0xffffffffu));
}

}  // namespace hardpack
