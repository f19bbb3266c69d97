// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/assert.h"
#include "core/base/fixed_vector.h"
#include "core/base/status.h"
#include "hal/can_frame.h"

namespace hardpack {

// The frames that one tick may send.
inline constexpr int kMaxFramesOut = 32;
using CanBatch = FixedVector<CanFrame, kMaxFramesOut>;

// Precondition: there is room.
inline void Push(CanBatch& out, const CanFrame& frame) {
  const Status pushed = out.PushBack(frame);
  HP_ASSERT(pushed == Status::kOk);
}

}  // namespace hardpack
