// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/loop_bound.h"
#include "core/costmap/costmap.h"
#include "core/costmap/padded_row.h"
#include "core/costmap/rows.h"
#include "core/costmap/square_sums.h"

// What the sweeps do with a row (sweeps.cpp), by whole blocks: each is whole vectors, so there is
// no code for a rest. Private to core/costmap.

namespace hardpack {

inline constexpr uint8_t kFar = 16;  // squared, it is beyond the saturation
inline constexpr uint8_t kNoEdge = kFar - 1;

// Fills the blocks of a row that are not among these.
inline void FillOutside(unsigned blocks, uint8_t value, uint8_t* row) {
  unsigned left = ~blocks & kAllBlocks;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) {
    const Columns columns = TakeRun(left);
    HP_LOOP_BOUND(kRowBlocks)
    for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
      HP_LOOP_BOUND(kRowBlock_cells)
      for (int x = begin; x < begin + kRowBlock_cells; ++x) row[x] = value;
    }
  }
}

// 0 where a row has a flag, else one more than in the row before.
inline uint8_t FromFlag(uint8_t flags, uint8_t flag, uint8_t before) {
  const uint8_t further = Smaller(static_cast<uint8_t>(before + 1), kFar);
  return (flags & flag) != 0 ? uint8_t{0} : further;
}

// 0 where one of two rows has a flag and the other has not, else one more than in the row before.
inline uint8_t FromEdge(int changes, uint8_t flag, uint8_t before) {
  const uint8_t further = Smaller(static_cast<uint8_t>(before + 1), kNoEdge);
  return (changes & flag) == 0 ? further : uint8_t{0};
}

// Vertical distances to the cells of either kind, so far among the rows that have come. hard and
// soft hold the row before, and then this one. Returns all flags that these kCells cells have.
template <int kCells>
uint8_t SweepFrom(const uint8_t* __restrict flags, uint8_t* __restrict hard,
                  uint8_t* __restrict soft, uint8_t* __restrict hard_plane,
                  uint8_t* __restrict soft_plane) {
  uint8_t all = 0;
  HP_LOOP_BOUND(kCells)
  for (int x = 0; x < kCells; ++x) {
    hard[x] = FromFlag(flags[x], Costmap::kHard, hard[x]);
    soft[x] = FromFlag(flags[x], Costmap::kSoft, soft[x]);
    hard_plane[x] = hard[x];
    soft_plane[x] = soft[x];
    all = static_cast<uint8_t>(all | flags[x]);
  }
  return all;
}

// The smaller of these and of those the other way; of the hard ones the squares.
inline void SweepBack(const uint8_t* __restrict hard_plane, const uint8_t* __restrict soft_plane,
                      Columns columns, uint8_t* __restrict hard, uint8_t* __restrict soft,
                      uint8_t* __restrict hard2) {
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const uint8_t distance = Smaller(hard_plane[x], static_cast<uint8_t>(hard[x] + 1));
      hard[x] = distance;
      hard2[x] = Squared(distance);
      soft[x] = Smaller(soft_plane[x], static_cast<uint8_t>(soft[x] + 1));
    }
  }
}

// What of the disc's half chord is used up to reach the nearest soft cell along the row, in the
// blocks. steps: a copy, or what is written could be among them, and nothing would be done several
// at a time.
template <int kReach>
[[gnu::always_inline]] inline void ReachAlongRow(const uint8_t* soft, const ChordSteps steps,
                                                 unsigned blocks, uint8_t* used) {
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (blocks != 0) SmallestPlusSteps<kReach>(soft, steps, TakeRun(blocks), used);
}

// Adds the regions to flags, from squared distances to hard cells and from what of the disc's half
// chord was used up to reach soft ones.
inline void FlagRegions(const uint8_t* __restrict hard2, uint8_t radius2,
                        const uint8_t* __restrict soft, uint8_t chord, Columns columns,
                        uint8_t* __restrict flags) {
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const int lethal = hard2[x] <= radius2 ? Costmap::kLethal : 0;
      const int region = soft[x] <= chord ? Costmap::kSoftRegion : 0;
      flags[x] = static_cast<uint8_t>(flags[x] | lethal | region);
    }
  }
}

// Vertical distances to the regions' edges, on either side of them, less 1. Off the map there is no
// edge.
struct EdgeRows {
  const uint8_t* flags;
  const uint8_t* flags_before;
};
inline void SweepEdgesFrom(const EdgeRows& rows, const uint8_t* __restrict hard_before,
                           const uint8_t* __restrict soft_before, Columns columns,
                           uint8_t* __restrict hard, uint8_t* __restrict soft) {
  const uint8_t* __restrict flags = rows.flags;
  const uint8_t* __restrict flags_before = rows.flags_before;
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const int changes = flags[x] ^ flags_before[x];
      hard[x] = FromEdge(changes, Costmap::kLethal, hard_before[x]);
      soft[x] = FromEdge(changes, Costmap::kSoftRegion, soft_before[x]);
    }
  }
}

// The smaller of these, and of those the other way, and their squares. Inlined, as below: the runs
// of a row share its blocks, which a static bound of a function by itself could not tell.
[[gnu::always_inline]] inline void SweepEdgesBack(const EdgeRows& rows, uint8_t flag,
                                                  const uint8_t* __restrict plane, Columns columns,
                                                  uint8_t* __restrict distance,
                                                  uint8_t* __restrict squared) {
  const uint8_t* __restrict flags = rows.flags;
  const uint8_t* __restrict flags_before = rows.flags_before;
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const int changes = flags[x] ^ flags_before[x];
      const uint8_t further = static_cast<uint8_t>(distance[x] + 1);
      const uint8_t here = (changes & flag) == 0 ? further : uint8_t{0};
      const uint8_t nearer = Smaller(plane[x], here);
      distance[x] = nearer;
      squared[x] = Squared(static_cast<uint8_t>(nearer + 1));
    }
  }
}

// What a region's edge along x, and vertical distances one cell beside, tell of the distance: to[x]
// = 1 where a cell beside lies on the other side, else min over |dx| <= 1 of squared[x + dx] +
// dx^2. Flags and squares have margins.
[[gnu::always_inline]] inline void StepFromEdges(const uint8_t* __restrict flags, uint8_t region,
                                                 const uint8_t* __restrict squared, Columns columns,
                                                 uint8_t* __restrict to) {
  constexpr uint8_t kLimit = kFar2 - 1;
  HP_LOOP_BOUND(kRowBlocks)
  for (int begin = columns.begin; begin < columns.end; begin += kRowBlock_cells) {
    HP_LOOP_BOUND(kRowBlock_cells)
    for (int x = begin; x < begin + kRowBlock_cells; ++x) {
      const int changes = (flags[x] ^ flags[x - 1]) | (flags[x] ^ flags[x + 1]);
      const uint8_t beside = Smaller(Smaller(squared[x - 1], squared[x + 1]), kLimit);
      const uint8_t nearest = Smaller(squared[x], static_cast<uint8_t>(beside + 1));
      to[x] = (changes & region) == 0 ? nearest : uint8_t{1};
    }
  }
}

// Where in the tables of costs cells are looked up, see CostmapBuilder::AddCosts.
template <int kCells>
inline void HardEntries(const uint8_t* __restrict flags, const uint8_t* __restrict distance2,
                        uint16_t* __restrict entries) {
  static_assert(Costmap::kLethal << 4 == 256 && Costmap::kObserved << 6 == 512);
  HP_LOOP_BOUND(kCells)
  for (int x = 0; x < kCells; ++x) {
    const uint16_t cell = flags[x];
    const int inside = cell << 4 & 256;
    const int observed = cell << 6 & 512;
    entries[x] = static_cast<uint16_t>(distance2[x] | inside | observed);
  }
}

template <int kCells>
inline void SoftEntries(const uint8_t* __restrict flags, const uint8_t* __restrict distance2,
                        uint16_t* __restrict entries) {
  static_assert(Costmap::kSoftRegion << 3 == 256);
  HP_LOOP_BOUND(kCells)
  for (int x = 0; x < kCells; ++x) {
    const uint16_t cell = flags[x];
    entries[x] = static_cast<uint16_t>(distance2[x] | (cell << 3 & 256));
  }
}

inline void KeepInside(const uint8_t* __restrict flags, const uint8_t* __restrict distance2,
                       uint8_t* __restrict depth2) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t inside2 = distance2[x];
    depth2[x] = (flags[x] & Costmap::kLethal) != 0 ? inside2 : uint8_t{0};
  }
}

inline void CopyRow(const uint8_t* __restrict from, uint8_t* __restrict to) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) to[x] = from[x];
}

}  // namespace hardpack
