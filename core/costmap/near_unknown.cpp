// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/near_unknown.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/costmap/costmap.h"

namespace hardpack {
namespace {

constexpr int kWords = 2;
constexpr int kWordBits = 32;
static_assert(kWords * kWordBits == NearUnknown::kSide_cells);

// So many cells to either side of the middle are within a circle, in a row so far away; -1: none.
int HalfChord(int radius2_cells2, int rows_away) {
  const int left2 = radius2_cells2 - rows_away * rows_away;
  return left2 < 0 ? -1 : FloorToInt(Sqrt(static_cast<float>(left2)));
}

int Squared(float length_m, int most_cells) {
  const float cells = Min(length_m * kCellsPerMeter, static_cast<float>(most_cells));
  return FloorToInt(cells * cells);
}

// Bits from `low` to `high` of 0 to 63, none if there are none.
uint64_t Bits(int low, int high) {
  const int from = ClampInt(low, 0, NearUnknown::kSide_cells);
  const int to = ClampInt(high + 1, 0, NearUnknown::kSide_cells);
  if (from >= to) return 0;
  return ~uint64_t{0} >> (NearUnknown::kSide_cells - (to - from)) << from;
}

uint64_t Widened(uint64_t bits, int cells) {
  HP_LOOP_BOUND(NearUnknown::kMostWidth_cells)
  for (int k = 0; k < cells; ++k) bits |= bits << 1 | bits >> 1;
  return bits;
}

}  // namespace

void NearUnknown::Begin(const GridWindow& window, const NearUnknownParams& params) {
  const Cell lidar = CellAt(params.lidar_odom);
  const Cell nearest = window.Nearest(lidar);
  constexpr int kLastFirst = kMapSize_cells - kSide_cells;
  lidar_row_ = nearest.y - window.origin.y;
  lidar_column_ = nearest.x - window.origin.x;
  first_row_ = ClampInt(lidar_row_ - kSide_cells / 2, 0, kLastFirst);
  first_column_ = ClampInt(lidar_column_ - kSide_cells / 2, 0, kLastFirst);
  const bool is_on_map = window.Contains(lidar) && params.reach_m > 0.0f;
  reach2_cells2_ = is_on_map ? Squared(params.reach_m, kMostReach_cells) : -1;
  const int width2_cells2 = Squared(params.half_width_m, kMostWidth_cells);
  int half = HalfChord(width2_cells2, 0);
  rows_away_ = 0;
  HP_LOOP_BOUND(kMostWidth_cells)
  while (rows_away_ < kMostWidth_cells && HalfChord(width2_cells2, rows_away_ + 1) >= 0) {
    const int next = HalfChord(width2_cells2, rows_away_ + 1);
    widen_[rows_away_] = static_cast<int8_t>(half - next);
    half = next;
    ++rows_away_;
  }
  widen_[rows_away_] = static_cast<int8_t>(half);
}

void NearUnknown::Look(const uint8_t* flags, const uint8_t* hard_distance2, int row) {
  if (!Covers(row)) return;
  const int half = HalfChord(reach2_cells2_, row - lidar_row_);
  const int middle = lidar_column_ - first_column_;
  const uint8_t* cells = flags + first_column_;
  const uint8_t* distance2 = hard_distance2 + first_column_;
  uint32_t unknown[kWords] = {};
  HP_LOOP_BOUND(kWords)
  for (int word = 0; word < kWords; ++word) {
    uint32_t bits = 0;
    HP_LOOP_BOUND(kWordBits)
    for (int bit = kWordBits - 1; bit >= 0; --bit) {
      const int x = word * kWordBits + bit;
      const bool is_dear =
          ((cells[x] & Costmap::kObserved) == 0) & (distance2[x] < kMaxDistance2_cells2);
      bits = bits << 1 | static_cast<uint32_t>(is_dear);
    }
    unknown[word] = bits;
  }
  const uint64_t all = uint64_t{unknown[1]} << kWordBits | unknown[0];
  unknown_[row - first_row_] = half < 0 ? 0 : all & Bits(middle - half, middle + half);
}

void NearUnknown::AddCost(int row, uint16_t cost_q8, uint16_t* costs_q8) const {
  if (!Covers(row)) return;
  // From the row itself outwards: what is near is widened again with what is farther.
  uint64_t all = 0;
  HP_LOOP_BOUND_INNER(kMostWidth_cells + 1, kMostWidth_cells)
  for (int away = 0; away <= rows_away_; ++away) {
    if (Covers(row - away)) all |= unknown_[row - away - first_row_];
    if (Covers(row + away)) all |= unknown_[row + away - first_row_];
    all = Widened(all, widen_[away]);
  }
  if (all == 0) return;
  uint16_t* costs = costs_q8 + first_column_;
  HP_LOOP_BOUND(kWords)
  for (int word = 0; word < kWords; ++word) {
    const uint32_t bits = static_cast<uint32_t>(all >> (word * kWordBits));
    HP_LOOP_BOUND(kWordBits)
    for (int bit = 0; bit < kWordBits; ++bit) {
      const uint32_t more = (bits >> bit & 1u) * cost_q8;
      costs[word * kWordBits + bit] = static_cast<uint16_t>(costs[word * kWordBits + bit] + more);
    }
  }
}

}  // namespace hardpack
