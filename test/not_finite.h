// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace hardpack::testing {

inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace hardpack::testing
