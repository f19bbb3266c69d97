// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/math.h"
#include "core/base/status.h"

// Checks that decoding and encoding messages share. Private to hal/onboard/control.

namespace hardpack::control {

inline Status CheckSize(size_t bytes, size_t expected) {
  if (bytes < expected) return Status::kTruncated;
  return bytes > expected ? Status::kOversized : Status::kOk;
}

inline Status CheckWithin(float value, float limit) {
  if (!IsFinite(value)) return Status::kNotFinite;
  return Abs(value) <= limit ? Status::kOk : Status::kInvalidArgument;
}

inline Status CheckWithin(int64_t value, int64_t limit) {
  return value >= -limit && value <= limit ? Status::kOk : Status::kInvalidArgument;
}

// The first that is not kOk.
inline Status Both(Status first, Status second) {
  return first != Status::kOk ? first : second;
}

}  // namespace hardpack::control
