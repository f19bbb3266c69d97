// SPDX-License-Identifier: Apache-2.0
// From the flags of cells to costs: exact distance transforms of the obstacles, and of the regions
// dilated from them, of both layers. Each is a sweep over the rows and one back, which give
// vertical distances, and the smallest sum of squares along the row. The way back over the
// obstacles finishes a row at once and is the first sweep over the regions.
//
//   kObstacles, up   vertical distance to the obstacle cells, so far among the rows below
//   kRegions, down   the same among all rows; hard_distance2 and the regions; vertical distance to
//                    the regions' edges, so far among the rows above
//   kCosts, up       the same among all rows; distances from the regions' edges; depth and cost
//
// Blocks of cells that lie too far from every obstacle of a layer are left out: what they hold is
// filled in.
#include "core/base/loop_bound.h"
#include "core/base/saturate.h"
#include "core/costmap/costmap.h"
#include "core/costmap/padded_row.h"
#include "core/costmap/rows.h"
#include "core/costmap/square_sums.h"
#include "core/costmap/sweep_rows.h"

namespace hardpack {
namespace {

// Costs in one round: a loop over single cells takes as many instructions again to count them.
constexpr int kAtOnce = 8;

// The largest whole number of cells whose square is not above distance2, but at most 15.
int RootOf(int distance2) {
  constexpr int kMost = 15;
  int root = 0;
  HP_LOOP_BOUND(kMost)
  while (root < kMost && Square(root + 1) <= distance2) ++root;
  return root;
}

// From how many cells on a layer's costs by squared distance do not change any more. A distance
// that lies beyond need not be exact, as long as it is not found too short.
int ReachOf(const uint16_t* costs_q8) {
  int last_change2 = 0;
  HP_LOOP_BOUND(kMaxDistance2_cells2)
  for (int distance2 = 1; distance2 <= kMaxDistance2_cells2; ++distance2) {
    if (costs_q8[distance2] != costs_q8[kMaxDistance2_cells2]) last_change2 = distance2;
  }
  return RootOf(last_change2);
}

}  // namespace

// A cell belongs to the dilated region when the vertical distance, dx beside it, is at most the
// disc's half chord there. Told by differences: how much more than at dx is left at dx + 1.
void CostmapBuilder::FillChord() {
  radius_cells_ = RootOf(radius2_cells2_);
  int chord = radius_cells_;
  HP_LOOP_BOUND(kReach_cells)
  for (int dx = 0; dx < kReach_cells; ++dx) {
    const int left2 = radius2_cells2_ - Square(dx + 1);
    const int next = left2 < 0 ? -1 : RootOf(left2);
    chord_steps_.of[dx] = static_cast<uint8_t>(chord - next);
    chord = next;
  }
}

void CostmapBuilder::CellUnit() {
  if (pass_ == Pass::kObstacles) {
    SweepObstacles(row_);
  } else if (pass_ == Pass::kRegions) {
    FindRegions(kMapSize_cells - 1 - row_);
  } else if (pass_ == Pass::kCosts) {
    FindCosts(row_);
  } else {
    AddTerrain(row_);
  }
}

void CostmapBuilder::AddTerrain(int unit) {
  if (!from_heights_) return;
  const int first = unit * kTerrain_rows;
  HP_LOOP_BOUND(kTerrain_rows)
  for (int row = first; row < first + kTerrain_rows; ++row) {
    terrain_.AddCost(row, map_.cost_q8 + row * kMapSize_cells);
  }
}

// In which of a row's blocks something may lie within reach_cells of an obstacle: those with one in
// the rows so near, and those beside them.
CostmapBuilder::Blocks CostmapBuilder::NearObstacles(int row, int reach_cells) const {
  static_assert(kRowBlock_cells >= 2 * kReach_cells);
  const int first = ClampInt(row - reach_cells, 0, kMapSize_cells - 1) / kGroup_rows;
  const int last = ClampInt(row + reach_cells, 0, kMapSize_cells - 1) / kGroup_rows;
  unsigned hard = 0;
  unsigned soft = 0;
  HP_LOOP_BOUND(4 * kReach_cells / kGroup_rows + 2)
  for (int group = first; group <= last; ++group) {
    hard |= group_blocks_[group].hard;
    soft |= group_blocks_[group].soft;
  }
  return {static_cast<uint16_t>(hard | hard << 1 | hard >> 1),
          static_cast<uint16_t>(soft | soft << 1 | soft >> 1)};
}

void CostmapBuilder::SweepObstacles(int row) {
  static_assert(kLayers * kDistances2 == kMapSize_cells);
  FillCost(row);  // spread over this pass
  if (row == 0) {
    FillRow(hard_row_, kFar);
    FillRow(soft_row_.cells(), kFar);
    HP_LOOP_BOUND(kPaddedRows)
    for (auto& padded : padded_) padded.FillMargins();
  }
  const int begin = row * kMapSize_cells;
  unsigned hard_blocks = 0;
  unsigned soft_blocks = 0;
  HP_LOOP_BOUND(kRowBlocks)
  for (int block = 0; block < kRowBlocks; ++block) {
    const int x = block * kRowBlock_cells;
    const int cell = begin + x;
    const unsigned all =
        SweepFrom<kRowBlock_cells>(map_.flags + cell, hard_row_ + x, soft_row_.cells() + x,
                                   map_.hard_distance2 + cell, plane_ + cell);
    hard_blocks |= ((all & Costmap::kHard) != 0 ? 1u : 0u) << block;
    soft_blocks |= ((all & Costmap::kSoft) != 0 ? 1u : 0u) << block;
  }
  Blocks& blocks = group_blocks_[row / kGroup_rows];
  if (row % kGroup_rows == 0) blocks = {};
  blocks.hard = static_cast<uint16_t>(blocks.hard | hard_blocks);
  blocks.soft = static_cast<uint16_t>(blocks.soft | soft_blocks);
}

// What lies beyond the reach of every obstacle is filled in, here and below: farther than counts.
void CostmapBuilder::FindRegions(int row) {
  const int begin = row * kMapSize_cells;
  uint8_t* soft = soft_row_.cells();
  uint8_t* a = padded_[0].cells();
  uint8_t* b = padded_[1].cells();
  uint8_t* hard2 = map_.hard_distance2 + begin;
  if (row == kMapSize_cells - 1) {
    FillRow(hard_row_, kFar);
    FillRow(soft, kFar);
  }
  const Blocks near = NearObstacles(row, kReach_cells);
  unsigned left = near.hard | near.soft;
  FillOutside(left, kFar, hard_row_);
  FillOutside(left, kFar, soft);
  FillOutside(left, kFar2, a);
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) SweepBack(hard2, plane_ + begin, TakeRun(left), hard_row_, soft, a);

  left = near.hard;
  FillOutside(left, kFar2, hard2);
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) SmallestPlusSquare(a, TakeRun(left), hard2);

  near_.Look(map_.flags + begin, hard2, row);

  left = near.soft;
  FillOutside(left, kFar2, b);
  if (radius_cells_ <= 5) {
    ReachAlongRow<5>(soft, chord_steps_, left, b);
  } else if (radius_cells_ <= 10) {
    ReachAlongRow<10>(soft, chord_steps_, left, b);
  } else {
    ReachAlongRow<15>(soft, chord_steps_, left, b);
  }

  left = near.hard | near.soft;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) {
    FlagRegions(hard2, static_cast<uint8_t>(radius2_cells2_), b,
                static_cast<uint8_t>(radius_cells_), TakeRun(left), map_.flags + begin);
  }
  SweepEdges(row);
}

// Vertical distances to the regions' edges among the rows that have come.
void CostmapBuilder::SweepEdges(int row) {
  const bool first = row == kMapSize_cells - 1;
  const int begin = row * kMapSize_cells;
  // Beyond the last row there is no edge: as if that row went on.
  const uint8_t* flags = map_.flags + begin;
  uint8_t* a = padded_[0].cells();
  if (first) FillRow(a, kNoEdge);
  const uint8_t* hard_above = first ? a : map_.hard_depth2 + begin + kMapSize_cells;
  const uint8_t* soft_above = first ? a : plane_ + begin + kMapSize_cells;
  const Blocks near = NearObstacles(row, kReach_cells + radius_cells_);
  unsigned left = near.hard | near.soft;
  FillOutside(left, kNoEdge, map_.hard_depth2 + begin);
  FillOutside(left, kNoEdge, plane_ + begin);
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) {
    SweepEdgesFrom({flags, first ? flags : flags + kMapSize_cells}, hard_above, soft_above,
                   TakeRun(left), map_.hard_depth2 + begin, plane_ + begin);
  }
}

void CostmapBuilder::FindCosts(int row) {
  const int begin = row * kMapSize_cells;
  uint8_t* row_flags = row_flags_.cells();
  if (row == 0) {
    FillRow(hard_row_, kNoEdge);
    FillRow(soft_row_.cells(), kNoEdge);
    const int halo = ReachOf(soft_cost_q8_);
    const int inside = ReachOf(soft_cost_q8_ + kDistances2);
    soft_reach_cells_ = halo > inside ? halo : inside;
  }
  CopyRow(map_.flags + begin, row_flags);
  row_flags[-1] = row_flags[0];
  row_flags[kMapSize_cells] = row_flags[kMapSize_cells - 1];

  // No further than this from an obstacle is a cell whose distance to the region is not saturated.
  const Blocks near = NearObstacles(row, kReach_cells + radius_cells_);
  const uint8_t* hard2 = HardDistances(row, near.hard);
  const uint8_t* soft2 = SoftDistances(row, near.soft);
  KeepInside(row_flags, hard2, map_.hard_depth2 + begin);
  HP_LOOP_BOUND(kRowBlocks)
  for (int block = 0; block < kRowBlocks; ++block) {
    const int x = block * kRowBlock_cells;
    if ((near.soft >> block & 1) != 0) {
      AddCosts(row, x, hard2 + x, soft2 + x);
    } else if ((near.hard >> block & 1) != 0) {
      AddHardCosts(row, x, hard2 + x);
    } else {
      AddUnknown(row, x);
    }
  }
  near_.AddCost(row, near_cost_q8_, map_.cost_q8 + begin);
}

// Squared distances to the edge of the lethal region, from either side. The edge keeps the two
// sides apart by itself: beside it the distance is 1, and what comes from the other side is more.
// So one pass gives the distances of both sides.
const uint8_t* CostmapBuilder::HardDistances(int row, unsigned blocks) {
  const int begin = row * kMapSize_cells;
  const uint8_t* flags = map_.flags + begin;
  const EdgeRows rows = {flags, row == 0 ? flags : flags - kMapSize_cells};
  uint8_t* a = padded_[0].cells();
  uint8_t* b = padded_[1].cells();
  FillOutside(blocks, kNoEdge, hard_row_);
  FillOutside(blocks, kFar2, a);
  FillOutside(blocks, kFar2, b);
  unsigned left = blocks;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) {
    const Columns columns = TakeRun(left);
    SweepEdgesBack(rows, Costmap::kLethal, map_.hard_depth2 + begin, columns, hard_row_, a);
    StepFromEdges(row_flags_.cells(), Costmap::kLethal, a, columns, b);
    SmallestPlusSquare<1, 7>(b, columns, a);
  }
  // Runs lie further apart than either looks.
  left = blocks;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) SmallestPlusSquare<8, 7>(a, TakeRun(left), b);
  return b;
}

// The same for the soft region, as far as its costs change.
const uint8_t* CostmapBuilder::SoftDistances(int row, unsigned blocks) {
  const int begin = row * kMapSize_cells;
  const uint8_t* flags = map_.flags + begin;
  const EdgeRows rows = {flags, row == 0 ? flags : flags - kMapSize_cells};
  uint8_t* a = padded_[0].cells();
  uint8_t* c = padded_[2].cells();
  FillOutside(blocks, kNoEdge, soft_row_.cells());
  FillOutside(blocks, kFar2, a);
  FillOutside(blocks, kFar2, c);
  const bool two_steps = soft_reach_cells_ > 5 && soft_reach_cells_ <= 10;
  unsigned left = blocks;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) {
    const Columns columns = TakeRun(left);
    SweepEdgesBack(rows, Costmap::kSoftRegion, plane_ + begin, columns, soft_row_.cells(), c);
    StepFromEdges(row_flags_.cells(), Costmap::kSoftRegion, c, columns, a);
    SmallestPlusSquare<1, 4>(a, columns, c);
  }
  left = soft_reach_cells_ > 5 ? blocks : 0;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) SmallestPlusSquare<5, 5>(c, TakeRun(left), a);
  left = soft_reach_cells_ > 10 ? blocks : 0;
  HP_LOOP_BOUND_INNER(kRuns, kRowBlocks)
  while (left != 0) SmallestPlusSquare<10, 5>(a, TakeRun(left), c);
  return two_steps ? a : c;
}

// Costs of a block. A cost is looked up by the squared distance, and by the side of the edge on
// which it is (and whether the ground is known) as the upper byte.
void CostmapBuilder::AddCosts(int row, int begin, const uint8_t* hard2, const uint8_t* soft2) {
  uint16_t hard[kRowBlock_cells];
  uint16_t soft[kRowBlock_cells];
  const uint8_t* flags = row_flags_.cells() + begin;
  HardEntries<kRowBlock_cells>(flags, hard2, hard);
  SoftEntries<kRowBlock_cells>(flags, soft2, soft);
  HP_LOOP_BOUND(kRowBlock_cells / kAtOnce)
  for (int i = 0; i < kRowBlock_cells; i += kAtOnce) {
    uint16_t* to = map_.cost_q8 + row * kMapSize_cells + begin + i;
    to[0] = CostOf(hard[i], soft[i]);
    to[1] = CostOf(hard[i + 1], soft[i + 1]);
    to[2] = CostOf(hard[i + 2], soft[i + 2]);
    to[3] = CostOf(hard[i + 3], soft[i + 3]);
    to[4] = CostOf(hard[i + 4], soft[i + 4]);
    to[5] = CostOf(hard[i + 5], soft[i + 5]);
    to[6] = CostOf(hard[i + 6], soft[i + 6]);
    to[7] = CostOf(hard[i + 7], soft[i + 7]);
  }
}

// The same far from the soft layer.
void CostmapBuilder::AddHardCosts(int row, int begin, const uint8_t* hard2) {
  uint16_t hard[kRowBlock_cells];
  HardEntries<kRowBlock_cells>(row_flags_.cells() + begin, hard2, hard);
  HP_LOOP_BOUND(kRowBlock_cells / kAtOnce)
  for (int i = 0; i < kRowBlock_cells; i += kAtOnce) {
    uint16_t* to = map_.cost_q8 + row * kMapSize_cells + begin + i;
    to[0] = hard_cost_q8_[hard[i]];
    to[1] = hard_cost_q8_[hard[i + 1]];
    to[2] = hard_cost_q8_[hard[i + 2]];
    to[3] = hard_cost_q8_[hard[i + 3]];
    to[4] = hard_cost_q8_[hard[i + 4]];
    to[5] = hard_cost_q8_[hard[i + 5]];
    to[6] = hard_cost_q8_[hard[i + 6]];
    to[7] = hard_cost_q8_[hard[i + 7]];
  }
}

// The same far from either layer.
void CostmapBuilder::AddUnknown(int row, int begin) {
  const uint16_t unknown_q8 = hard_cost_q8_[kMaxDistance2_cells2];
  const uint8_t* __restrict flags = row_flags_.cells() + begin;
  uint16_t* __restrict to = map_.cost_q8 + row * kMapSize_cells + begin;
  HP_LOOP_BOUND(kRowBlock_cells)
  for (int x = 0; x < kRowBlock_cells; ++x) {
    // Without a branch, so that it stays one loop.
    const int is_unknown = ((flags[x] & Costmap::kObserved) != 0) - 1;
    to[x] = static_cast<uint16_t>(unknown_q8 & is_unknown);
  }
}

}  // namespace hardpack
