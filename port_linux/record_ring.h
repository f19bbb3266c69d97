// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

// The bytes on their way from the thread of the ticks to the one that writes them: a bounded queue
// without locks, for one thread that puts and one that takes. Putting is all or nothing and never
// waits. Positions count bytes since the start and do not come round.
//
// Also hands over at which positions a new file begins.

namespace hardpack {

class RecordRing {
 public:
  static constexpr size_t kMaxFileStarts = 16;  // that have not been taken yet

  // Allocates the room and touches all of it, so that no page of it is missing later.
  explicit RecordRing(size_t capacity_bytes);

  size_t capacity_bytes() const { return capacity_bytes_; }

  // --- For the thread that puts.

  // Bytes that fit now, at least.
  size_t Free() const;
  // The parts one after another, all of them or, when they do not fit, none.
  bool Put(std::span<const std::span<const uint8_t>> parts);
  // What is put from now on belongs to a new file. False when too many wait to be taken.
  bool StartFile();

  // --- For the thread that takes.

  // Position behind the last byte that was put.
  uint64_t End() const { return end_.load(std::memory_order_acquire); }
  // Position of the first byte that has not been given back.
  uint64_t Begin() const { return begin_.load(std::memory_order_relaxed); }
  // What stands at a position, as far as it stands in one piece. Precondition: Begin() <= from <=
  // to <= End().
  std::span<const uint8_t> Peek(uint64_t from, uint64_t to) const;
  // Copies what may stand in two pieces. Precondition: as Peek's, for bytes.size() from `from`.
  void Copy(uint64_t from, std::span<uint8_t> bytes) const;
  // Gives the room before a position back.
  void Release(uint64_t to) { begin_.store(to, std::memory_order_release); }
  // The next position at which a file starts, if it is not beyond `end`, a value of End(). Else
  // `end` itself and false.
  bool NextFileStart(uint64_t end, uint64_t& position) const;
  void TakeFileStart();

 private:
  void Write(uint64_t at, std::span<const uint8_t> bytes);

  size_t capacity_bytes_;
  std::unique_ptr<uint8_t[]> bytes_;  // [capacity_bytes_]
  std::array<uint64_t, kMaxFileStarts> file_starts_ = {};
  // Apart, so that the two threads do not pull one cache line to and fro.
  alignas(64) std::atomic<uint64_t> end_ = 0;
  std::atomic<uint64_t> starts_put_ = 0;
  alignas(64) std::atomic<uint64_t> begin_ = 0;
  std::atomic<uint64_t> starts_taken_ = 0;
};

}  // namespace hardpack
