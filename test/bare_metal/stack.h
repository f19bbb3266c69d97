// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack::bare_metal {

// The stack is painted before main; what has lost its paint has been used.
inline constexpr uint32_t kStackPaint = 0x57ac57acu;
uint32_t stack_size_bytes();
uint32_t stack_peak_bytes();

}  // namespace hardpack::bare_metal
