// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

// The bytes on their way from the tick thread to the writing thread: a bounded lock-free queue for
// one producer and one consumer. Putting is all or nothing and never waits. Positions count bytes
// since the start and do not wrap.
//
// Also passes on the positions at which new files begin.

namespace hardpack {

class RecordRing {
 public:
  static constexpr size_t kMaxFileStarts = 16;  // not yet taken

  // Allocates the buffer and touches all of it, so that no page is missing later.
  explicit RecordRing(size_t capacity_bytes);

  size_t capacity_bytes() const { return capacity_bytes_; }

  // --- For the producer.

  // Bytes that fit now, at least.
  size_t Free() const;
  // Adds the parts in order, all of them or, if they do not fit, none.
  bool Put(std::span<const std::span<const uint8_t>> parts);
  // Bytes added from now on belong to a new file. False if too many are waiting to be taken.
  bool StartFile();

  // --- For the consumer.

  // Position after the last byte added.
  uint64_t End() const { return end_.load(std::memory_order_acquire); }
  // Position of the first byte not released.
  uint64_t Begin() const { return begin_.load(std::memory_order_relaxed); }
  // The bytes at a position, as far as they are contiguous. Precondition: Begin() <= from <= to <=
  // End().
  std::span<const uint8_t> Peek(uint64_t from, uint64_t to) const;
  // Copies bytes that may be in two pieces. Precondition: as Peek's, for bytes.size() from `from`.
  void Copy(uint64_t from, std::span<uint8_t> bytes) const;
  // Releases the bytes before a position.
  void Release(uint64_t to) { begin_.store(to, std::memory_order_release); }
  // The next position at which a file starts, if it is not beyond `end`, a value of End().
  // Otherwise `end` itself and false.
  bool NextFileStart(uint64_t end, uint64_t& position) const;
  void TakeFileStart();

 private:
  void Write(uint64_t at, std::span<const uint8_t> bytes);

  size_t capacity_bytes_;
  std::unique_ptr<uint8_t[]> bytes_;  // [capacity_bytes_]
  std::array<uint64_t, kMaxFileStarts> file_starts_ = {};
  // On separate cache lines, to avoid false sharing.
  alignas(64) std::atomic<uint64_t> end_ = 0;
  std::atomic<uint64_t> starts_put_ = 0;
  alignas(64) std::atomic<uint64_t> begin_ = 0;
  std::atomic<uint64_t> starts_taken_ = 0;
};

}  // namespace hardpack
