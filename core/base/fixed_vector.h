// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/status.h"

namespace hardpack {

// A sequence of at most kCapacity elements, stored in place. Trivially copyable.
template <typename T, int kCapacity>
class FixedVector {
  static_assert(kCapacity > 0);
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  static constexpr int capacity() { return kCapacity; }
  constexpr int size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr bool full() const { return size_ == kCapacity; }

  // kCapacityExceeded, and nothing changed, when full.
  constexpr Status PushBack(const T& value) {
    if (full()) return Status::kCapacityExceeded;
    elements_[size_++] = value;
    return Status::kOk;
  }

  constexpr void Clear() { size_ = 0; }

  // Keeps the first `size` elements, or appends value-initialised ones. Precondition: 0 <= size <=
  // kCapacity. Cost: the number of elements added.
  constexpr void Resize(int size) {
    HP_ASSERT(size >= 0 && size <= kCapacity);
    HP_LOOP_BOUND(kCapacity)
    for (int i = size_; i < size; ++i) elements_[i] = T{};
    size_ = size;
  }

  // Precondition: 0 <= index < size().
  constexpr T& operator[](int index) {
    HP_ASSERT(index >= 0 && index < size_);
    return elements_[index];
  }
  constexpr const T& operator[](int index) const {
    HP_ASSERT(index >= 0 && index < size_);
    return elements_[index];
  }

  // Precondition: not empty.
  constexpr T& back() { return (*this)[size_ - 1]; }
  constexpr const T& back() const { return (*this)[size_ - 1]; }
  constexpr T* begin() { return elements_; }
  constexpr T* end() { return elements_ + size_; }
  constexpr const T* begin() const { return elements_; }
  constexpr const T* end() const { return elements_ + size_; }

 private:
  T elements_[kCapacity] = {};
  int32_t size_ = 0;
};

}  // namespace hardpack
