// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/loop_bound.h"
#include "core/costmap/costmap.h"
#include "core/costmap/padded_row.h"
#include "core/costmap/rows.h"

// For every cell, the smallest sum of a neighbouring element in its row and the squared distance to
// it: the second half of an exact distance transform. Private to core/costmap.

namespace hardpack {

inline constexpr uint8_t kFar2 = kMaxDistance2_cells2;

// Of a block.
inline uint8_t LargestOf(const uint8_t* cells) {
  uint8_t largest = 0;
  HP_LOOP_BOUND(kRowBlock_cells)
  for (int x = 0; x < kRowBlock_cells; ++x) largest = cells[x] > largest ? cells[x] : largest;
  return largest;
}

constexpr int Square(int x) {
  return x * x;
}

// For 0 .. 16. 16 * 16 is 0 in a byte; minus one it is 255.
inline uint8_t Squared(uint8_t distance) {
  return static_cast<uint8_t>(distance * distance - (distance >> 4));
}

// The smaller of the elements dx to the left and to the right.
template <int kDx>
inline uint8_t Beside(const uint8_t* center) {
  return Smaller(center[-kDx], center[kDx]);
}

// min over kDx <= |dx| <= kLast of center[dx] + (kBefore + dx)^2 - (kBefore + kDx)^2, limited so
// that (kBefore + kDx)^2 - kBefore^2 can be added without a carry. From the outside to the inside,
// which takes one limit for all.
template <int kBefore, int kDx, int kLast>
inline uint8_t SmallestBeside(const uint8_t* center) {
  if constexpr (kDx == kLast) {
    constexpr uint8_t kLimit = kFar2 - (Square(kBefore + kLast) - Square(kBefore));
    return Smaller(Beside<kDx>(center), kLimit);
  } else {
    constexpr int kStep = Square(kBefore + kDx + 1) - Square(kBefore + kDx);
    const int further = SmallestBeside<kBefore, kDx + 1, kLast>(center) + kStep;
    return Smaller(Beside<kDx>(center), static_cast<uint8_t>(further));
  }
}

// to[x] = min over |dx| <= kReach of row[x + dx] + (kBefore + |dx|)^2 - kBefore^2, saturated; the
// row has margins. Once with kBefore = 0, or several times, each after the other's reach, it is
// min over dx of row[x + dx] + dx^2. Of a block.
template <int kBefore, int kReach>
inline void SmallestPlusSquare(const uint8_t* __restrict row, int begin, uint8_t* __restrict to) {
  constexpr int kStep = Square(kBefore + 1) - Square(kBefore);
  HP_LOOP_BOUND(kRowBlock_cells)
  for (int x = begin; x < begin + kRowBlock_cells; ++x) {
    const int beside = SmallestBeside<kBefore, 1, kReach>(row + x) + kStep;
    to[x] = Smaller(row[x], static_cast<uint8_t>(beside));
  }
}

template <int kBefore, int kReach>
inline void SmallestPlusSquare(const uint8_t* __restrict row, Columns columns,
                               uint8_t* __restrict to) {
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    SmallestPlusSquare<kBefore, kReach>(row, begin, to);
  }
}

// The same with kBefore = 0 and kReach = 15, blockwise in two parts: where no result of the first
// one is above what the next dx would add, the rest is left out.
inline void SmallestPlusSquare(const uint8_t* __restrict row, Columns columns,
                               uint8_t* __restrict to) {
  constexpr int kFirst = 5;
  constexpr int kNext2 = Square(kFirst + 1);
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    SmallestPlusSquare<0, kFirst>(row, begin, to);
    if (LargestOf(to + begin) <= kNext2) continue;
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const int further = SmallestBeside<0, kFirst + 1, 15>(row + x) + kNext2;
      to[x] = Smaller(to[x], static_cast<uint8_t>(further));
    }
  }
}

// As above, where what is added from one dx to the next is given.
template <int kDx, int kLast>
inline uint8_t SmallestBeside(const uint8_t* center, const uint8_t* steps) {
  if constexpr (kDx == kLast) {
    return Beside<kDx>(center);
  } else {
    const int further = SmallestBeside<kDx + 1, kLast>(center, steps) + steps[kDx];
    return Smaller(Beside<kDx>(center), static_cast<uint8_t>(further));
  }
}

// Inlined, so that the static bound sees the runs of a row as parts of it.
template <int kReach>
[[gnu::always_inline]] inline void SmallestPlusSteps(const uint8_t* __restrict row,
                                                     const ChordSteps& steps, Columns columns,
                                                     uint8_t* __restrict to) {
  // By blocks, of which every one is whole vectors: no code for a rest, and half the stack.
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const int beside = SmallestBeside<1, kReach>(row + x, steps.of) + steps.of[0];
      to[x] = Smaller(row[x], static_cast<uint8_t>(beside));
    }
  }
}

}  // namespace hardpack
