// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackd/allocation_guard.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HP_WATCH_ALLOCATIONS 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define HP_WATCH_ALLOCATIONS 0
#endif
#endif
#ifndef HP_WATCH_ALLOCATIONS
#define HP_WATCH_ALLOCATIONS 1
#endif

namespace {

std::atomic<bool> frozen = false;
std::atomic<bool> aborts = false;
std::atomic<uint64_t> allocations = 0;

}  // namespace

#if HP_WATCH_ALLOCATIONS
namespace {

void NoteAllocation() {
  if (!frozen.load(std::memory_order_relaxed)) return;
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (!aborts.load(std::memory_order_relaxed)) return;
  constexpr char kText[] = "hardpackd: heap allocation after the first tick\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kText, sizeof(kText) - 1);
  std::abort();
}

}  // namespace

// A static program already contains the C library's malloc under its own name: there the linker's
// --wrap inserts these. In a dynamic program these have the name itself and are found first.
#if defined(HP_WRAPPED_MALLOC)
#define HP_OURS(name) __wrap_##name
#define HP_THEIRS(name) __real_##name
#else
#define HP_OURS(name) name
#define HP_THEIRS(name) __libc_##name
#endif

extern "C" {
void* HP_THEIRS(malloc)(size_t size);
void* HP_THEIRS(calloc)(size_t count, size_t size);
void* HP_THEIRS(realloc)(void* block, size_t size);
void* HP_THEIRS(memalign)(size_t alignment, size_t size);

void* HP_OURS(malloc)(size_t size) {
  NoteAllocation();
  return HP_THEIRS(malloc)(size);
}

void* HP_OURS(calloc)(size_t count, size_t size) {
  NoteAllocation();
  return HP_THEIRS(calloc)(count, size);
}

void* HP_OURS(realloc)(void* block, size_t size) {
  NoteAllocation();
  return HP_THEIRS(realloc)(block, size);
}

void* HP_OURS(memalign)(size_t alignment, size_t size) {
  NoteAllocation();
  return HP_THEIRS(memalign)(alignment, size);
}

void* HP_OURS(aligned_alloc)(size_t alignment, size_t size) {
  NoteAllocation();
  return HP_THEIRS(memalign)(alignment, size);
}

int HP_OURS(posix_memalign)(void** block, size_t alignment, size_t size) {
  NoteAllocation();
  *block = HP_THEIRS(memalign)(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
}  // extern "C"
#endif

namespace hardpack {

void FreezeHeap(bool abort_on_allocation) {
  allocations.store(0, std::memory_order_relaxed);
  aborts.store(abort_on_allocation, std::memory_order_relaxed);
  frozen.store(true, std::memory_order_relaxed);
}

void ThawHeap() {
  frozen.store(false, std::memory_order_relaxed);
}

uint64_t AllocationsSinceFrozen() {
  return allocations.load(std::memory_order_relaxed);
}

bool AllocationsAreWatched() {
  return HP_WATCH_ALLOCATIONS != 0;
}

}  // namespace hardpack
