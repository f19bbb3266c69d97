// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace hardpack::command {

// Heap allocations of this process so far: malloc, calloc, realloc and the aligned ones, and so
// operator new, which calls them. The command replaces these functions by ones that count and pass
// on to the C library's own. Always 0 under a sanitizer, which has replaced them itself.
int64_t AllocationCount();

// False under a sanitizer.
bool AllocationsAreCounted();

}  // namespace hardpack::command
