// SPDX-License-Identifier: Apache-2.0
#include "port_linux/record_ring.h"

#include <algorithm>

namespace hardpack {

RecordRing::RecordRing(size_t capacity_bytes)
    : capacity_bytes_(capacity_bytes), bytes_(new uint8_t[capacity_bytes]()) {}

size_t RecordRing::Free() const {
  const uint64_t used =
      end_.load(std::memory_order_relaxed) - begin_.load(std::memory_order_acquire);
  return capacity_bytes_ - static_cast<size_t>(used);
}

bool RecordRing::Put(std::span<const std::span<const uint8_t>> parts) {
  size_t size = 0;
  for (const std::span<const uint8_t> part : parts) size += part.size();
  if (size > Free()) return false;
  uint64_t at = end_.load(std::memory_order_relaxed);
  for (const std::span<const uint8_t> part : parts) {
    Write(at, part);
    at += part.size();
  }
  end_.store(at, std::memory_order_release);
  return true;
}

void RecordRing::Write(uint64_t at, std::span<const uint8_t> bytes) {
  const auto offset = static_cast<size_t>(at % capacity_bytes_);
  const size_t first = std::min(bytes.size(), capacity_bytes_ - offset);
  std::copy_n(bytes.begin(), first, bytes_.get() + offset);
  std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(first), bytes.end(), bytes_.get());
}

bool RecordRing::StartFile() {
  const uint64_t put = starts_put_.load(std::memory_order_relaxed);
  if (put - starts_taken_.load(std::memory_order_acquire) >= kMaxFileStarts) return false;
  file_starts_[put % kMaxFileStarts] = end_.load(std::memory_order_relaxed);
  // Before the following bytes: a reader that sees them through end_ also sees this.
  starts_put_.store(put + 1, std::memory_order_release);
  return true;
}

std::span<const uint8_t> RecordRing::Peek(uint64_t from, uint64_t to) const {
  const auto offset = static_cast<size_t>(from % capacity_bytes_);
  const auto wanted = static_cast<size_t>(to - from);
  return {bytes_.get() + offset, std::min(wanted, capacity_bytes_ - offset)};
}

void RecordRing::Copy(uint64_t from, std::span<uint8_t> bytes) const {
  const std::span<const uint8_t> first = Peek(from, from + bytes.size());
  std::copy(first.begin(), first.end(), bytes.begin());
  std::copy_n(bytes_.get(), bytes.size() - first.size(),
              bytes.begin() + static_cast<std::ptrdiff_t>(first.size()));
}

bool RecordRing::NextFileStart(uint64_t end, uint64_t& position) const {
  position = end;
  const uint64_t taken = starts_taken_.load(std::memory_order_relaxed);
  if (taken == starts_put_.load(std::memory_order_acquire)) return false;
  const uint64_t start = file_starts_[taken % kMaxFileStarts];
  if (start > end) return false;
  position = start;
  return true;
}

void RecordRing::TakeFileStart() {
  starts_taken_.store(starts_taken_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace hardpack
