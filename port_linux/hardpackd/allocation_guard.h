// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Watches the heap of the whole process: after FreezeHeap nothing may be allocated. A program that
// links port_linux/hardpackd/allocation_guard.cpp gets malloc, calloc, realloc and the aligned ones
// (and so operator new) replaced by versions that forward to the C library and know whether
// allocating is allowed.

namespace hardpack {

// From now on every allocation, by any thread, is counted; with abort_on_allocation the first one
// ends the process instead, with a message on stderr.
void FreezeHeap(bool abort_on_allocation);

// Allocating is allowed again: the last tick is over.
void ThawHeap();

// Since FreezeHeap; 0 if allocations cannot be observed.
uint64_t AllocationsSinceFrozen();

// False under a sanitizer, which has replaced the functions itself.
bool AllocationsAreWatched();

}  // namespace hardpack
