// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/map_samples.h"

#include <bit>
#include <cstdint>

#include "core/base/loop_bound.h"
#include "core/optimizer/branch_free.h"

namespace hardpack {
namespace {

// Adding this to a number of at most 2^22 rounds it to an integer, which is then in the low bits.
constexpr float kRoundingShift = 12582912.0f;  // 1.5 * 2^23

// Where a block's places lie: the lower left of the four cells around, how far beyond it, and what
// the four cost.
struct Places {
  int32_t index[kSampleBlock];
  float across[kSampleBlock];
  float along[kSampleBlock];
  uint16_t low_left_q8[kSampleBlock];
  uint16_t low_right_q8[kSampleBlock];
  uint16_t high_left_q8[kSampleBlock];
  uint16_t high_right_q8[kSampleBlock];
};

// As in CostAt: cells from the centre of the window's first cell, kept between the centres.
inline float BetweenCenters(float coordinate_m, float origin_cells) {
  constexpr float kLast = kMapSize_cells - 1;
  const float cells = coordinate_m * kCellsPerMeter - origin_cells - 0.5f;
  return branch_free::Smaller(branch_free::NotBelowZero(cells), kLast);
}

// The integer below, by rounding half a cell less (ties to even). Where the number is an integer
// itself that may be the one before, at whose far end the interpolation has the same value; the
// last centre, 511, gives 510.
inline float CellBelow(float cells) {
  return (cells - 0.5f + kRoundingShift) - kRoundingShift;
}

// A loop of `count` and not of kSampleBlock is vectorised, and not unrolled first.
void Locate(const GridWindow& window, const float* x_m, const float* y_m, int count,
            Places& places) {
  constexpr float kRow = kMapSize_cells;
  const float origin_x_cells = static_cast<float>(window.origin.x);
  const float origin_y_cells = static_cast<float>(window.origin.y);
  HP_LOOP_BOUND(kSampleBlock)
  for (int i = 0; i < count; ++i) {
    const float column = BetweenCenters(x_m[i], origin_x_cells);
    const float row = BetweenCenters(y_m[i], origin_y_cells);
    const float left = CellBelow(column);
    const float low = CellBelow(row);
    places.across[i] = column - left;
    places.along[i] = row - low;
    places.index[i] = std::bit_cast<int32_t>(low * kRow + left + kRoundingShift) -
                      std::bit_cast<int32_t>(kRoundingShift);
  }
}

void Fetch(const uint16_t* cost_q8, int count, Places& places) {
  HP_LOOP_BOUND(kSampleBlock)
  for (int i = 0; i < count; ++i) {
    const uint16_t* cell = cost_q8 + places.index[i];
    places.low_left_q8[i] = cell[0];
    places.low_right_q8[i] = cell[1];
    places.high_left_q8[i] = cell[kMapSize_cells];
    places.high_right_q8[i] = cell[kMapSize_cells + 1];
  }
}

void Interpolate(const Places& places, int count, float* costs) {
  constexpr float kOne = 1.0f / kCostOne_q8;
  HP_LOOP_BOUND(kSampleBlock)
  for (int i = 0; i < count; ++i) {
    const float low_left = places.low_left_q8[i];
    const float low_right = places.low_right_q8[i];
    const float high_left = places.high_left_q8[i];
    const float high_right = places.high_right_q8[i];
    const float low = low_left + (low_right - low_left) * places.across[i];
    const float high = high_left + (high_right - high_left) * places.across[i];
    costs[i] = (low + (high - low) * places.along[i]) * kOne;
  }
}

}  // namespace

void SampleCosts(const Costmap& map, const float* x_m, const float* y_m, int points, float* costs) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): Locate writes what is read of it
  Places places;
  HP_LOOP_BOUND(kMaxSamples / kSampleBlock)
  for (int first = 0; first < points; first += kSampleBlock) {
    const int count = points - first < kSampleBlock ? points - first : kSampleBlock;
    Locate(map.window, x_m + first, y_m + first, count, places);
    Fetch(map.cost_q8, count, places);
    Interpolate(places, count, costs + first);
  }
}

}  // namespace hardpack
