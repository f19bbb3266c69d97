// SPDX-License-Identifier: Apache-2.0
#include "tools/allocation_counter/allocation_counter.h"

#include <atomic>
#include <cerrno>
#include <cstddef>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HP_COUNT_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define HP_COUNT_ALLOCATIONS 0
#endif
#endif
#ifndef HP_COUNT_ALLOCATIONS
#define HP_COUNT_ALLOCATIONS 1
#endif

namespace {

std::atomic<int64_t> allocation_count = 0;

}  // namespace

#if HP_COUNT_ALLOCATIONS
// The C library's own functions under the names that it keeps for this purpose.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  allocation_count.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

void* calloc(size_t count, size_t size) {
  allocation_count.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}

void* realloc(void* block, size_t size) {
  allocation_count.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(block, size);
}

void* aligned_alloc(size_t alignment, size_t size) {
  allocation_count.fetch_add(1, std::memory_order_relaxed);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, size_t alignment, size_t size) {
  allocation_count.fetch_add(1, std::memory_order_relaxed);
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
}  // extern "C"
#endif

namespace hardpack::command {

int64_t AllocationCount() {
  return allocation_count.load(std::memory_order_relaxed);
}

bool AllocationsAreCounted() {
  return HP_COUNT_ALLOCATIONS != 0;
}

}  // namespace hardpack::command
