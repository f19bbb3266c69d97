// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Watches the heap of the whole process: from FreezeHeap on nothing may be allocated. A program
// that links port_linux/hardpackd/allocation_guard.cpp gets malloc, calloc, realloc and the aligned
// ones (and so operator new) replaced by ones that pass on to the C library's own and know whether
// they may.

namespace hardpack {

// From now on every allocation, of any thread, is counted; with abort_on_allocation the first one
// ends the process instead, saying so on stderr.
void FreezeHeap(bool abort_on_allocation);

// Allocating is permitted again: the last tick is over.
void ThawHeap();

// Since FreezeHeap; 0 where allocations cannot be seen.
uint64_t AllocationsSinceFrozen();

// False under a sanitizer, which has replaced the functions itself.
bool AllocationsAreWatched();

}  // namespace hardpack
