// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack::decision {

// Marsaglia's xorshift32 (Xorshift RNGs, 2003): integers only, so the same numbers everywhere.
class Random {
 public:
  // Precondition: seed != 0.
  explicit Random(uint32_t seed) : state_(seed) {}

  uint32_t Next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 17;
    state_ ^= state_ << 5;
    return state_;
  }

  // Uniform enough in [low, high].
  int32_t Between(int32_t low, int32_t high) {
    return low + static_cast<int32_t>(Next() % static_cast<uint32_t>(high - low + 1));
  }

  // [low, high] in steps of 1/1024 of the range.
  float RealBetween(float low, float high) {
    return low + (high - low) * (static_cast<float>(Next() % 1025u) / 1024.0f);
  }

 private:
  uint32_t state_;
};

}  // namespace hardpack::decision
