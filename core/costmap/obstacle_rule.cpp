// SPDX-License-Identifier: Apache-2.0
// From heights to the flags of cells: the near and the far ground, and what the rule makes of a
// cell's returns. The far ground is a minimum over a square, found in blocks whose side is a power
// of two: each is the minimum of two blocks of half its side, and a few that overlap make up the
// square.
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/costmap/costmap.h"
#include "core/costmap/rows.h"

namespace hardpack {
namespace {

constexpr float kCentimetersPerMeter = 100.0f;
constexpr int16_t kNone = HeightGrid::kNone;
constexpr int kStrip = HeightGrid::kStripCells;

// kNone is above every height: a minimum passes over it, and no sum below exceeds it.
static_assert(kNone == INT16_MAX);

// row[x] = the smaller of row[x] and row[x + kShift], margins included: from minima over kShift
// cells to minima over twice as many. A constant shift, or the loop would not vectorise.
template <int kShift, typename T>
void DoubleAlongRow(T* row) {
  constexpr int kLast = kMapSize_cells + kRowMargin - kShift;
  HP_LOOP_BOUND(kLast + kRowMargin)
  for (int x = -kRowMargin; x < kLast; ++x) row[x] = Smaller(row[x], row[x + kShift]);
}

// to[x] = the smallest of row[x - half .. x + half]. row has margins, and is spoilt. block: the
// largest power of two up to half + 1.
template <typename T, typename Stored>
void SmallestAlongRow(T* __restrict row, int half, int block, Stored* __restrict to) {
  if (block > 1) DoubleAlongRow<1>(row);
  if (block > 2) DoubleAlongRow<2>(row);
  if (block > 4) DoubleAlongRow<4>(row);
  if (block > 8) DoubleAlongRow<8>(row);
  const T* first = row - half;
  const T* to_center = row - (block - 1);
  const T* last = row + (half - (block - 1));
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    to[x] = static_cast<Stored>(Smaller(Smaller(first[x], to_center[x]), Smaller(row[x], last[x])));
  }
}

// Rows of minima over `block` rows, from plain rows as they come, in place: when the row at `row`
// has come, each row that this completes is made the minimum of two blocks of half the height. So a
// row that has `block` rows from itself on is complete.
template <typename T, typename Stored>
void DoubleAcrossRows(Stored* plane, int row, int block) {
  constexpr int kMostDoublings = 4;
  static_assert((1 << kMostDoublings) <= kMaxGroundWindow_cells / 2 + 1);
  HP_LOOP_BOUND(kMostDoublings)
  for (int shift = 1; shift < block && row - 2 * shift + 1 >= 0; shift *= 2) {
    const Stored* __restrict later = plane + (row - shift + 1) * kMapSize_cells;
    Stored* __restrict earlier = plane + (row - 2 * shift + 1) * kMapSize_cells;
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) {
      earlier[x] =
          static_cast<Stored>(Smaller(static_cast<T>(earlier[x]), static_cast<T>(later[x])));
    }
  }
}

// to[x] = the smallest of the rows row - half .. row + half of a plane of blocks. A block that
// reaches beyond the map is moved onto it, which keeps it within those rows: block <= half + 1.
template <typename T, typename Stored>
void SmallestAcrossRows(const Stored* plane, int row, int half, int block, T* __restrict to) {
  const auto block_from = [plane, block](int start) {
    return plane + ClampInt(start, 0, kMapSize_cells - block) * kMapSize_cells;
  };
  const Stored* first = block_from(row - half);
  const Stored* to_center = block_from(row - (block - 1));
  const Stored* from_center = block_from(row);
  const Stored* last = block_from(row + half - (block - 1));
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const T low = Smaller(static_cast<T>(first[x]), static_cast<T>(to_center[x]));
    const T high = Smaller(static_cast<T>(from_center[x]), static_cast<T>(last[x]));
    to[x] = Smaller(low, high);
  }
}

// to[x] = the lowest of the cells at most two beside it. from has margins.
void LowestBeside(const int16_t* __restrict from, int16_t* __restrict to) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const int16_t beside = Smaller(from[x - 1], from[x + 1]);
    const int16_t beyond = Smaller(from[x - 2], from[x + 2]);
    to[x] = Smaller(from[x], Smaller(beside, beyond));
  }
}

void ClearRow(int16_t* row) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) row[x] = kNone;
}

// The height that is rise_cm above another, at most kNone; kNone above kNone. rise_cm >= 0.
int16_t Raised(int16_t height_cm, int16_t rise_cm) {
  const int16_t highest_cm = static_cast<int16_t>(kNone - rise_cm);
  return static_cast<int16_t>(Smaller(height_cm, highest_cm) + rise_cm);
}

int16_t RoundedCm(float height_m) {
  return static_cast<int16_t>(RoundToInt(height_m * kCentimetersPerMeter));
}

// What a cell's returns are held against.
struct Limits {
  int16_t high_cm;      // an obstacle is higher than this ...
  int16_t overhead_cm;  // ... and does not begin higher than this
  bool ground_seen;     // otherwise every hard return that is not overhead is an obstacle
};

// Only the lowest and the highest hard return are known: whatever may lie between them counts as
// being there. Without branches, so that the time does not depend on the data and the loop
// vectorises; the comparisons mean nothing where there is no such return, and are not looked at
// then.
uint8_t CellFlags(const HeightGrid::Strip& strip, int i, const Limits& limits) {
  const bool any_hard = strip.highest_hard_cm[i] != kNone;
  const bool overhead = strip.lowest_hard_cm[i] > limits.overhead_cm;
  const bool high = strip.highest_hard_cm[i] > limits.high_cm;
  const bool person_seen = strip.person[i] != 0;
  const bool hard = any_hard & !overhead & (high | person_seen | !limits.ground_seen);
  const bool any_soft = strip.highest_soft_cm[i] != kNone;
  const bool high_soft = strip.highest_soft_cm[i] > limits.high_cm;
  const bool soft = any_soft & high_soft & !hard;
  const bool person = hard & person_seen;
  const bool observed = hard | soft | (strip.observed[i] != 0);
  return static_cast<uint8_t>((hard ? Costmap::kHard : 0) | (soft ? Costmap::kSoft : 0) |
                              (person ? Costmap::kPerson : 0) |
                              (observed ? Costmap::kObserved : 0));
}

}  // namespace

void CostmapBuilder::HeightUnit(const HeightGrid& heights) {
  if (pass_ == 0) {
    LoadGround(heights, row_);
  } else {
    ClassifyRow(heights, row_);
  }
}

// The far ground's blocks, along x, and along y as far as rows have come; the near ground as far as
// rows have come.
void CostmapBuilder::LoadGround(const HeightGrid& heights, int row) {
  const int half = params_.ground_window_cells / 2;
  int16_t* lowest = row_heights_ + kReach_cells;
  int16_t* ground = row_ground_ + kReach_cells;
  uint8_t* unseen = padded_ + kReach_cells;
  HP_LOOP_BOUND(kMapSize_cells / kStrip)
  for (int start = 0; start < kMapSize_cells; start += kStrip) {
    heights.Read({map_.window.origin.x + start, map_.window.origin.y + row}, strip_);
    HP_LOOP_BOUND(kStrip)
    for (int i = 0; i < kStrip; ++i) {
      // Read before it is chosen from, or the loop would not vectorise.
      const int16_t lowest_cm = strip_.lowest_cm[i];
      lowest[start + i] = lowest_cm;
      const bool measured = (strip_.ground[i] != 0) & (strip_.guessed[i] == 0);
      ground[start + i] = measured ? lowest_cm : kNone;
      unseen[start + i] = strip_.ground[i] ^ 1;
    }
  }
  LowestBeside(ground, near_rows_[row % kNearRows]);
  FindNearGround(row - kNear_cells);
  // The cost plane is free until the first costs. It holds heights as unsigned numbers of the same
  // bits.
  SmallestAlongRow(lowest, half, block_cells_, map_.cost_q8 + row * kMapSize_cells);
  SmallestAlongRow(unseen, half, block_cells_, plane_ + row * kMapSize_cells);
  FillMargins(lowest);
  FillMargins(unseen);
  DoubleAcrossRows<int16_t>(map_.cost_q8, row, block_cells_);
  DoubleAcrossRows<uint8_t>(plane_, row, block_cells_);
  if (row == kMapSize_cells - 1) EndNearGround();
}

// The near ground of a row, from the rows around it, which have all come. The planes of the hard
// distances are free until the layers: one holds the lower bytes, the other the upper ones.
void CostmapBuilder::FindNearGround(int row) {
  if (row < 0) return;
  static_assert(kNearRows == 5);
  uint8_t* lower = map_.hard_distance2 + row * kMapSize_cells;
  uint8_t* upper = map_.hard_depth2 + row * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const int16_t a = Smaller(near_rows_[0][x], near_rows_[1][x]);
    const int16_t b = Smaller(near_rows_[2][x], near_rows_[3][x]);
    const uint16_t bits = static_cast<uint16_t>(Smaller(near_rows_[4][x], Smaller(a, b)));
    lower[x] = static_cast<uint8_t>(bits & 0xff);
    upper[x] = static_cast<uint8_t>(bits >> 8);
  }
}

// The last rows': beyond the map there is no ground.
void CostmapBuilder::EndNearGround() {
  HP_LOOP_BOUND(kNear_cells)
  for (int row = kMapSize_cells; row < kMapSize_cells + kNear_cells; ++row) {
    ClearRow(near_rows_[row % kNearRows]);
    FindNearGround(row - kNear_cells);
  }
}

void CostmapBuilder::ClassifyRow(const HeightGrid& heights, int row) {
  const int half = params_.ground_window_cells / 2;
  SmallestAcrossRows(map_.cost_q8, row, half, block_cells_, row_heights_ + kReach_cells);
  SmallestAcrossRows(plane_, row, half, block_cells_, padded_ + kReach_cells);
  HP_LOOP_BOUND(kMapSize_cells / kStrip)
  for (int start = 0; start < kMapSize_cells; start += kStrip) {
    heights.Read({map_.window.origin.x + start, map_.window.origin.y + row}, strip_);
    ClassifyStrip(row, start);
  }
}

// The obstacle rule in the cells of strip_, which begins at column `start`.
void CostmapBuilder::ClassifyStrip(int row, int start) {
  const bool in_cell = params_.obstacle_rule == ObstacleRule::kInCell;
  const int16_t obstacle_cm = RoundedCm(params_.obstacle_height_m);
  const int16_t clearance_cm = RoundedCm(params_.clearance_height_m);
  const uint8_t* near_lower = map_.hard_distance2 + row * kMapSize_cells + start;
  const uint8_t* near_upper = map_.hard_depth2 + row * kMapSize_cells + start;
  const int16_t* far = row_heights_ + kReach_cells + start;
  const uint8_t* unseen = padded_ + kReach_cells + start;
  uint8_t* flags = map_.flags + row * kMapSize_cells + start;
  HP_LOOP_BOUND(kStrip)
  for (int i = 0; i < kStrip; ++i) {
    // Read before they are chosen from, or the loop would not vectorise.
    const int16_t own_cm = strip_.lowest_cm[i];
    const int16_t around_cm = static_cast<int16_t>(near_lower[i] | near_upper[i] << 8);
    const int16_t in_square_cm = far[i];
    const int16_t near_cm = strip_.ground[i] != 0 ? own_cm : around_cm;
    const int16_t local_cm = near_cm != kNone ? near_cm : in_square_cm;
    const bool ground_seen = in_cell | (unseen[i] == 0);
    const bool no_overhead = in_cell | (strip_.guessed[i] != 0);
    const Limits limits = {Raised(in_cell ? own_cm : local_cm, obstacle_cm),
                           Raised(no_overhead ? kNone : near_cm, clearance_cm), ground_seen};
    flags[i] = CellFlags(strip_, i, limits);
  }
}

}  // namespace hardpack
