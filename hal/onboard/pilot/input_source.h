// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack {

// Source of a datagram, in the order in which a tick must be given them.
enum class InputSource : uint8_t { kIns = 0, kLabels = 1, kLidar = 2 };
inline constexpr int kInputSources = 3;

}  // namespace hardpack
