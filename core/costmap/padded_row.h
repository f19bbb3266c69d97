// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "core/base/grid.h"
#include "core/base/loop_bound.h"

namespace hardpack {

// The sweeps skip parts of a row in blocks of this many cells.
inline constexpr int kRowBlock_cells = 32;
inline constexpr int kRowBlocks = kMapSize_cells / kRowBlock_cells;

// Part of a row, in whole blocks.
struct Columns {
  int begin = 0;
  int end = 0;
};

// The most runs of consecutive blocks; and one bit per block.
inline constexpr int kRuns = kRowBlocks / 2;
inline constexpr unsigned kAllBlocks = 0xffff;

// Takes the first run of consecutive blocks out of a row's `blocks`, which must not be empty.
inline Columns TakeRun(unsigned& blocks) {
  const int first = std::countr_zero(blocks);
  const int last = first + std::countr_one(blocks >> first);
  blocks &= ~0u << last;
  return {first * kRowBlock_cells, last * kRowBlock_cells};
}

// A row that is read to both sides. A margin beyond either end stands for cells off the map.
template <typename T>
class PaddedRow {
 public:
  // At least the largest reach. Row and margins together are whole vectors.
  static constexpr int kMargin = 16;

  // The first cell. Elements -kMargin .. kMapSize_cells + 2 * kMargin - 1 exist.
  T* cells() { return elements_ + kMargin; }
  const T* cells() const { return elements_ + kMargin; }

  // With the type's largest number, which never is the minimum.
  void FillMargins() { FillMargins(std::numeric_limits<T>::max(), std::numeric_limits<T>::max()); }

  void FillMargins(T before, T behind) {
    HP_LOOP_BOUND(kMargin)
    for (int x = 0; x < kMargin; ++x) elements_[x] = before;
    HP_LOOP_BOUND(2 * kMargin)
    for (int x = 0; x < 2 * kMargin; ++x) elements_[kMargin + kMapSize_cells + x] = behind;
  }

 private:
  alignas(16) T elements_[kMapSize_cells + 3 * kMargin] = {};
};

}  // namespace hardpack
