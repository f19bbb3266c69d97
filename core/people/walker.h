// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/fixed_vector.h"
#include "core/base/pose.h"

// Somebody near the vehicle, and how they move as far as that is known.

namespace hardpack {

struct Walker {
  Vec2 place_odom;    // the middle of what was seen of them
  Vec2 velocity_mps;  // odom
  // In any direction, they may be faster than that by so much.
  float doubt_mps = 0.0f;
};

inline constexpr int kMaxWalkers = 32;
using Walkers = FixedVector<Walker, kMaxWalkers>;

}  // namespace hardpack
