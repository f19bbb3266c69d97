// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/fixed_vector.h"
#include "hal/can_frame.h"

namespace hardpack {

// The frames that one tick may send.
inline constexpr int kMaxFramesOut = 32;
using CanBatch = FixedVector<CanFrame, kMaxFramesOut>;

}  // namespace hardpack
