// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack::cortex_m7 {

// The stack is painted before main; what has lost its paint has been used.
uint32_t stack_size_bytes();
uint32_t stack_peak_bytes();

}  // namespace hardpack::cortex_m7
