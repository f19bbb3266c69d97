// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "core/base/grid.h"
#include "core/base/loop_bound.h"

// Rows of the map as arrays, written so that the compiler can use vectors: fixed length, no
// branches, nothing that overlaps without saying so. Private to core/costmap.

namespace hardpack {

// Rows that are looked at to both sides have this margin at either end. It stands for what lies
// beyond the map and holds the type's largest number, which is no minimum.
inline constexpr int kRowMargin = 15;

template <typename T>
constexpr T Smaller(T a, T b) {
  return b < a ? b : a;
}

template <typename T>
void CopyRow(const T* __restrict from, T* __restrict to) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) to[x] = from[x];
}

// Makes both margins what they are to be. row points at the first cell, behind the margin.
template <typename T>
void FillMargins(T* row) {
  HP_LOOP_BOUND(kRowMargin)
  for (int x = 0; x < kRowMargin; ++x) {
    row[x - kRowMargin] = std::numeric_limits<T>::max();
    row[x + kMapSize_cells] = std::numeric_limits<T>::max();
  }
}

}  // namespace hardpack
