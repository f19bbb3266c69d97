// SPDX-License-Identifier: Apache-2.0
// From heights to the flags of cells: the near and the far ground, and what the rule makes of a
// cell's returns. Rows are loaded one after the other, and classed kLag_cells later. The far ground
// is a minimum over a square, found in blocks whose side is a power of two: each is the minimum of
// two blocks of half its side, and two to four that overlap make up the square. All heights are as
// the grid stores them: only their differences matter.
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/costmap/costmap.h"
#include "core/costmap/padded_row.h"
#include "core/costmap/rows.h"

namespace hardpack {
namespace {

constexpr int16_t kNoHeight = HeightGrid::kNone;
constexpr int kMargin = PaddedRow<int16_t>::kMargin;

// kNoHeight is above every height: a minimum passes over it, and no sum below exceeds it.
static_assert(kNoHeight == INT16_MAX);

// Heights that a ground return measured, and 1 where the ground's height is known, else 0.
void SplitGround(const int16_t* __restrict lowest_cm, const uint8_t* __restrict seen,
                 int16_t* __restrict ground_cm, uint8_t* __restrict known) {
  constexpr uint8_t kKnown = HeightGrid::kGroundHeightKnown;
  constexpr uint8_t kHeight = kKnown | HeightGrid::kGroundFromBeside;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    // Read before it is chosen from, or the loop would not vectorise.
    const int16_t height_cm = lowest_cm[x];
    ground_cm[x] = (seen[x] & kHeight) == kKnown ? height_cm : kNoHeight;
    known[x] = seen[x] & kKnown;
  }
}

template <typename T>
inline T SmallestOf(T a, T b, T c, T d) {
  return Smaller(Smaller(a, b), Smaller(c, d));
}

// to[x] = the smallest of row[x], row[x + kStep], .. row[x + 3 * kStep], margins included.
template <int kStep, typename T>
void SmallestOfFour(const T* __restrict row, T* __restrict to) {
  static_assert(3 * kStep <= kMargin);
  constexpr int kCells = kMapSize_cells + 2 * kMargin;
  const T* first = row - kMargin;
  T* __restrict first_to = to - kMargin;
  HP_LOOP_BOUND(kCells)
  for (int x = 0; x < kCells; ++x) {
    first_to[x] =
        SmallestOf(first[x], first[x + kStep], first[x + 2 * kStep], first[x + 3 * kStep]);
  }
}

// to[x] = the smallest of row[x - half .. x + half] for the cover of half. The row and its copy are
// spoilt.
template <typename T, typename Stored, typename Cover>
void SmallestAlongRow(PaddedRow<T>& padded, PaddedRow<T>& copy, const Cover& cover,
                      Stored* __restrict to) {
  padded.FillMargins();
  if (cover.cells > 1) SmallestOfFour<1>(padded.cells(), copy.cells());
  if (cover.cells > 4) SmallestOfFour<4>(copy.cells(), padded.cells());
  const T* row = cover.cells == 4 ? copy.cells() : padded.cells();
  const T* a = row + cover.from[0];
  const T* b = row + cover.from[1];
  const T* c = row + cover.from[2];
  const T* d = row + cover.from[3];
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    to[x] = static_cast<Stored>(SmallestOf(a[x], b[x], c[x], d[x]));
  }
}

inline int16_t Signed(uint16_t bits) {
  return static_cast<int16_t>(bits);
}

// Row `row` of a plane in which rows come and go; those before the map's are there, too.
template <typename T>
T* RowOf(T* ring, int row) {
  constexpr unsigned kMask = CostmapBuilder::kRingRows - 1;
  static_assert((CostmapBuilder::kRingRows & kMask) == 0);
  return ring + static_cast<int>(static_cast<unsigned>(row) & kMask) * kMapSize_cells;
}

// The smallest of four rows, kStep rows apart, as one row.
template <int kStep>
void SmallestOfRows(const uint16_t* ring, int row, uint16_t* __restrict to) {
  const uint16_t* a = RowOf(ring, row);
  const uint16_t* b = RowOf(ring, row + kStep);
  const uint16_t* c = RowOf(ring, row + 2 * kStep);
  const uint16_t* d = RowOf(ring, row + 3 * kStep);
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    to[x] =
        static_cast<uint16_t>(SmallestOf(Signed(a[x]), Signed(b[x]), Signed(c[x]), Signed(d[x])));
  }
}

// How many cells of a column are known when one row comes and one goes; 1 where none is, else 0.
void CountColumns(const uint8_t* __restrict comes, const uint8_t* __restrict goes,
                  uint8_t* __restrict count, uint8_t* __restrict none) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t now = static_cast<uint8_t>(count[x] + comes[x] - goes[x]);
    count[x] = now;
    none[x] = now == 0 ? 1 : 0;
  }
}

// to[x] = the lowest of the cells at most two beside it. from has margins.
void LowestBeside(const int16_t* __restrict from, uint16_t* __restrict to) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const int16_t beside = Smaller(from[x - 1], from[x + 1]);
    const int16_t beyond = Smaller(from[x - 2], from[x + 2]);
    to[x] = static_cast<uint16_t>(Smaller(from[x], Smaller(beside, beyond)));
  }
}

// The height that is rise_cm above another, at most kNoHeight; kNoHeight above kNoHeight.
// Precondition: rise_cm >= 0.
inline int16_t Raised(int16_t height_cm, int16_t rise_cm) {
  const int16_t highest_cm = static_cast<int16_t>(kNoHeight - rise_cm);
  return static_cast<int16_t>(Smaller(height_cm, highest_cm) + rise_cm);
}

int16_t RoundedCm(float height_m) {
  return static_cast<int16_t>(InCentimeters(height_m));
}

}  // namespace

CostmapBuilder::Cover CostmapBuilder::CoverOf(int half) {
  const int cells = half <= 1 ? 1 : half <= 7 ? 4 : 16;
  const int first = -half;
  const int last = half - (cells - 1);
  const int second = Smaller(first + cells, last);
  return {cells, {first, second, Smaller(second + cells, last), last}};
}

// Rows before the first one: no heights, no ground.
void CostmapBuilder::StartHeights() {
  cover_ = CoverOf(params_.ground_window_cells / 2);
  HP_LOOP_BOUND(kRingRows)
  for (int row = -kRingRows; row < 0; ++row) LoadNoRow(row);
  FillRow(known_count_, uint8_t{0});
}

void CostmapBuilder::HeightUnit(const HeightGrid& heights) {
  if (row_ < Terrain::kUnits) {
    terrain_.AddRow(heights, map_.window.origin, row_);
  } else {
    ClassUnit(heights, row_ - Terrain::kUnits);
  }
}

// Loads a row, and classes the one kLag_cells before it.
void CostmapBuilder::ClassUnit(const HeightGrid& heights, int loaded) {
  if (loaded < kMapSize_cells) {
    LoadRow(heights, loaded);
  } else {
    LoadNoRow(loaded);
  }
  // Blocks of rows that are now complete.
  if (cover_.cells > 1) SmallestOfRows<1>(ring(0), loaded - 3, RowOf(ring(1), loaded - 3));
  if (cover_.cells > 4) SmallestOfRows<4>(ring(1), loaded - 15, RowOf(ring(2), loaded - 15));
  // The columns of the square around the row that is classed next.
  const int row = loaded - kLag_cells;
  const int half = params_.ground_window_cells / 2;
  CountColumns(RowOf(known_ring(), row + half), RowOf(known_ring(), row - half - 1), known_count_,
               padded_[0].cells());
  if (row >= 0) ClassifyRow(heights, row);
}

void CostmapBuilder::LoadRow(const HeightGrid& heights, int row) {
  const Cell first = {map_.window.origin.x, map_.window.origin.y + row};
  heights.ReadGround(first, HeightGrid::HeightRow(lowest_.cells(), kMapSize_cells), seen_);
  SplitGround(lowest_.cells(), seen_, ground_.cells(), RowOf(known_ring(), row));
  ground_.FillMargins();
  LowestBeside(ground_.cells(), RowOf(near_ring(), row));
  SmallestAlongRow(lowest_, ground_, cover_, RowOf(ring(0), row));
}

void CostmapBuilder::LoadNoRow(int row) {
  FillRow(RowOf(ring(0), row), static_cast<uint16_t>(kNoHeight));
  FillRow(RowOf(ring(1), row), static_cast<uint16_t>(kNoHeight));
  FillRow(RowOf(near_ring(), row), static_cast<uint16_t>(kNoHeight));
  FillRow(RowOf(known_ring(), row), uint8_t{0});
}

void CostmapBuilder::ClassifyRow(const HeightGrid& heights, int row) {
  const Cell first = {map_.window.origin.x, map_.window.origin.y + row};
  heights.ReadGround(first, HeightGrid::HeightRow(lowest_.cells(), kMapSize_cells), seen_);
  heights.ReadObstacles(first, lowest_hard_, highest_hard_, highest_soft_);
  FindReturns();
  ReadLow(heights, first);
  if (params_.obstacle_rule == ObstacleRule::kInCell) {
    FindLimitsInCell();
  } else {
    SmallestAlongRow(padded_[0], padded_[1], cover_, no_ground_row());
    FindLimits(row);
  }
  FlagRow(row);
  terrain_.Flag(row, map_.flags + row * kMapSize_cells);
}

// Where no cell of a block has a hard or a soft return, there is no obstacle.
void CostmapBuilder::FindReturns() {
  HP_LOOP_BOUND(kBlocks)
  for (int block = 0; block < kBlocks; ++block) {
    const int16_t* hard = highest_hard_ + block * kBlock_cells;
    const int16_t* soft = highest_soft_ + block * kBlock_cells;
    int16_t lowest = kNoHeight;
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = 0; x < kBlock_cells; ++x) lowest = Smaller(lowest, Smaller(hard[x], soft[x]));
    any_returns_[block] = lowest != kNoHeight;
  }
}

// The paper's rule knows no low things.
void CostmapBuilder::ReadLow(const HeightGrid& heights, Cell first) {
  static_assert(kBlock_cells <= HeightGrid::kMostLow_cells);
  const bool is_told = params_.obstacle_rule != ObstacleRule::kInCell;
  HP_LOOP_BOUND(kBlocks)
  for (int block = 0; block < kBlocks; ++block) {
    if (!any_returns_[block]) continue;
    const int begin = block * kBlock_cells;
    if (is_told) {
      heights.ReadLow({first.x + begin, first.y}, kBlock_cells, low_ + begin);
      continue;
    }
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = begin; x < begin + kBlock_cells; ++x) low_[x] = 0;
  }
}

// What a row's returns are held against: an obstacle is higher than high_, and begins lower than
// overhead_, which is below no return at all.
void CostmapBuilder::FindLimits(int row) {
  const int16_t obstacle_cm = RoundedCm(params_.growth_height_m);
  const int16_t overhead_cm = static_cast<int16_t>(RoundedCm(params_.clearance_height_m) + 1);
  constexpr uint8_t kKnown = HeightGrid::kGroundHeightKnown;
  constexpr uint8_t kGuessed = HeightGrid::kGroundHeightKnown | HeightGrid::kGroundFromBeside;
  const uint16_t* far = ring(cover_.cells > 4 ? 2 : cover_.cells > 1 ? 1 : 0);
  const uint16_t* far_a = RowOf(far, row + cover_.from[0]);
  const uint16_t* far_b = RowOf(far, row + cover_.from[1]);
  const uint16_t* far_c = RowOf(far, row + cover_.from[2]);
  const uint16_t* far_d = RowOf(far, row + cover_.from[3]);
  const uint16_t* near_a = RowOf(near_ring(), row - 2);
  const uint16_t* near_b = RowOf(near_ring(), row - 1);
  const uint16_t* near_c = RowOf(near_ring(), row);
  const uint16_t* near_d = RowOf(near_ring(), row + 1);
  const uint16_t* near_e = RowOf(near_ring(), row + 2);
  const int16_t* __restrict lowest = lowest_.cells();
  const uint8_t* __restrict seen = seen_;
  int16_t* __restrict high = high_;
  int16_t* __restrict overhead = overhead_;
  HP_LOOP_BOUND(kBlocks)
  for (int block = 0; block < kBlocks; ++block) {
    if (!any_returns_[block]) continue;
    const int begin = block * kBlock_cells;
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = begin; x < begin + kBlock_cells; ++x) {
      const int16_t in_square_cm =
          SmallestOf(Signed(far_a[x]), Signed(far_b[x]), Signed(far_c[x]), Signed(far_d[x]));
      const int16_t around_cm = Smaller(
          Signed(near_e[x]),
          SmallestOf(Signed(near_a[x]), Signed(near_b[x]), Signed(near_c[x]), Signed(near_d[x])));
      // Read before it is chosen from, or the loop would not vectorise.
      const int16_t own_cm = lowest[x];
      const int16_t near_cm = (seen[x] & kKnown) != 0 ? own_cm : around_cm;
      const int16_t local_cm = near_cm != kNoHeight ? near_cm : in_square_cm;
      const int16_t begin_cm = Raised(near_cm, overhead_cm);
      high[x] = Raised(local_cm, obstacle_cm);
      overhead[x] = (seen[x] & kGuessed) == kGuessed ? kNoHeight : begin_cm;
    }
  }
}

void CostmapBuilder::FindLimitsInCell() {
  const int16_t obstacle_cm = RoundedCm(params_.growth_height_m);
  const int16_t* __restrict lowest = lowest_.cells();
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) high_[x] = Raised(lowest[x], obstacle_cm);
  FillRow(overhead_, kNoHeight);
  FillRow(no_ground_row(), uint8_t{0});
}

// The obstacle rule. Only the lowest and the highest hard return are known: whatever may lie
// between them counts as being there. Without branches, so that the time does not depend on the
// data and the loop vectorises.
void CostmapBuilder::FlagRow(int row) {
  const int16_t* __restrict lowest_hard = lowest_hard_;
  const int16_t* __restrict highest_hard = highest_hard_;
  const int16_t* __restrict highest_soft = highest_soft_;
  const int16_t* __restrict high = high_;
  const int16_t* __restrict overhead = overhead_;
  const uint8_t* __restrict seen = seen_;
  const uint8_t* __restrict no_ground = no_ground_row();
  const uint8_t* __restrict low = low_;
  uint8_t* __restrict flags = map_.flags + row * kMapSize_cells;
  constexpr uint8_t kSeen = HeightGrid::kGroundHeightKnown | HeightGrid::kGroundFromBeside;
  HP_LOOP_BOUND(kBlocks)
  for (int block = 0; block < kBlocks; ++block) {
    const int begin = block * kBlock_cells;
    if (!any_returns_[block]) {
      HP_LOOP_BOUND(kBlock_cells)
      for (int x = begin; x < begin + kBlock_cells; ++x) {
        flags[x] = (seen[x] & kSeen) != 0 ? Costmap::kObserved : 0;
      }
      continue;
    }
    // Nothing else's memory: else the compiler would have to ask whether it overlaps what is read,
    // with a slow loop for when it does.
    uint8_t made[kBlock_cells];
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = begin; x < begin + kBlock_cells; ++x) {
      const uint8_t person_seen = seen[x] & HeightGrid::kPersonMask;
      const bool hard = (lowest_hard[x] < overhead[x]) &
                        ((highest_hard[x] > high[x]) | ((person_seen | no_ground[x]) != 0) |
                         ((low[x] == HeightGrid::kFirmLow) & (highest_hard[x] != kNoHeight)));
      const bool soft = (highest_soft[x] > high[x]) & (highest_soft[x] != kNoHeight) & !hard;
      const bool returned = (highest_hard[x] != kNoHeight) | (highest_soft[x] != kNoHeight);
      const bool growth = (low[x] == HeightGrid::kGrowth) & returned & !hard;
      const bool observed = hard | soft | growth | ((seen[x] & kSeen) != 0);
      made[x - begin] = static_cast<uint8_t>(
          (hard ? Costmap::kHard : 0) | (soft ? Costmap::kSoft : 0) |
          ((hard & (person_seen != 0)) ? Costmap::kPerson : 0) | (growth ? Costmap::kGrowth : 0) |
          (observed ? Costmap::kObserved : 0));
    }
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = 0; x < kBlock_cells; ++x) flags[begin + x] = made[x];
  }
}

}  // namespace hardpack
