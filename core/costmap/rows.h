// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/grid.h"
#include "core/base/loop_bound.h"

// Rows of the map as arrays, written so that the compiler can vectorise: fixed length, no branches,
// no undeclared overlap. Private to core/costmap.

namespace hardpack {

template <typename T>
constexpr T Smaller(T a, T b) {
  return b < a ? b : a;
}

template <typename T>
void FillRow(T* row, T value) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) row[x] = value;
}

}  // namespace hardpack
