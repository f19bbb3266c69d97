// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "core/base/saturate.h"
#include "core/base/status.h"
#include "core/base/validate.h"

// Sets parameters to numbers typed or read from a file.

namespace hardpack {

// Sets one parameter of a group to a typed or read value, integers exactly. kNotFinite;
// kParameterOutOfRange: outside the entry's range, or a fraction for a count. On failure the group
// is unchanged. Does not compare it with others: FirstInvalidParameter does.
template <typename Group>
constexpr Status SetParameter(const ParameterEntry<Group>& entry, double value, Group& group) {
  if (!(value - value == 0.0)) return Status::kNotFinite;
  if (entry.number != nullptr) {
    constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());
    if (value < -kLargest || value > kLargest) return Status::kParameterOutOfRange;
    // As a float: a limit of 0.1f accepts a typed 0.1, although that double is the smaller of the
    // two.
    const float number = static_cast<float>(value);
    if (number < entry.low || number > entry.high) return Status::kParameterOutOfRange;
    group.*entry.number = number;
    return Status::kOk;
  }
  // The limits of the range are int32_t, so values between them can be cast.
  if (value < static_cast<double>(RoundToInt(entry.low)) ||
      value > static_cast<double>(RoundToInt(entry.high))) {
    return Status::kParameterOutOfRange;
  }
  const int32_t whole = static_cast<int32_t>(value);
  if (static_cast<double>(whole) != value) return Status::kParameterOutOfRange;
  if (entry.whole != nullptr) {
    group.*entry.whole = whole;
  } else {
    group.*entry.rule = static_cast<ObstacleRule>(whole);
  }
  return Status::kOk;
}

}  // namespace hardpack
