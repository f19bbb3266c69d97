// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/terrain.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/costmap/costmap.h"
#include "core/costmap/rows.h"

namespace hardpack {
namespace {

constexpr int16_t kNone = HeightGrid::kNone;
constexpr float kCell_cm = 100.0f * kCellSize_m;
// The determinant of the places' covariance [cells^4] from which on a plane is told: three rows of
// five cells have 1.33, two 0.5.
constexpr float kLeastSpread = 0.8f;

// To the nearest whole number, for numbers of either sign that an int holds: a loop over cells may
// be vectorised.
inline int32_t Nearest(float value) {
  return static_cast<int32_t>(value + (value < 0.0f ? -0.5f : 0.5f));
}

}  // namespace

void Terrain::Begin(const CostmapParams& params) {
  exists_ = params.max_grade > 0.0f && params.obstacle_rule != ObstacleRule::kInCell;
  max_grade_ = params.max_grade;
  free_grade_ = params.free_grade;
  grade_cost_ = params.grade_cost;
  free_roughness_cm_ = params.free_roughness_m * kCentimetersPerMeter;
  roughness_cost_per_cm_ = params.roughness_cost_per_m / kCentimetersPerMeter;
  HP_LOOP_BOUND(kRows)
  for (PaddedRow<int16_t>& row : rows_) {
    FillRow(row.cells(), kNone);
    row.FillMargins();
  }
}

void Terrain::AddRow(const HeightGrid& heights, Cell origin, int row) {
  if (!exists_) return;
  int16_t* cells = rows_[row % kRows].cells();
  if (row < kMapSize_cells) {
    heights.ReadGround({origin.x, origin.y + row}, HeightGrid::HeightRow(cells, kMapSize_cells),
                       seen_);
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) {
      const int16_t height_cm = cells[x];
      cells[x] = (seen_[x] & HeightGrid::kGroundHeightKnown) != 0 ? height_cm : kNone;
    }
  } else {
    FillRow(cells, kNone);
  }
  if (row >= kReach_cells) FitRow(row - kReach_cells);
}

// About the lowest height of each block, so that the sums fit.
void Terrain::FitRow(int row) {
  const int16_t* middle = RowAt(row);
  HP_LOOP_BOUND(kMapSize_cells / kBlock_cells)
  for (int begin = 0; begin < kMapSize_cells; begin += kBlock_cells) {
    int16_t lowest_cm = kNone;
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = begin; x < begin + kBlock_cells; ++x) lowest_cm = Smaller(lowest_cm, middle[x]);
    if (lowest_cm != kNone) {
      SumColumns(begin, row, lowest_cm);
      FitBlock(begin, row);
      continue;
    }
    const int first = row * kMapSize_cells + begin;
    HP_LOOP_BOUND(kBlock_cells)
    for (int cell = first; cell < first + kBlock_cells; ++cell) {
      grade_x_[cell] = 0;
      grade_y_[cell] = 0;
      roughness_[cell] = 0;
      cost_[cell] = 0;
    }
  }
}

void Terrain::SumColumns(int begin, int row, int reference_cm) {
  const int16_t* row_at[kRows];
  HP_LOOP_BOUND(kRows)
  for (int i = 0; i < kRows; ++i) row_at[i] = RowAt(row - kReach_cells + i) + begin - kReach_cells;
  HP_LOOP_BOUND(kColumns)
  for (int x = 0; x < kColumns; ++x) {
    const auto rise = [reference_cm](int16_t height_cm) { return height_cm - reference_cm; };
    // kNone is further than kMaxRise_cm from any height that is stored.
    const auto known = [](int32_t rise_cm) {
      return (rise_cm <= kMaxRise_cm) & (rise_cm >= -kMaxRise_cm) ? 1 : 0;
    };
    const int32_t a = rise(row_at[0][x]);
    const int32_t b = rise(row_at[1][x]);
    const int32_t c = rise(row_at[2][x]);
    const int32_t d = rise(row_at[3][x]);
    const int32_t e = rise(row_at[4][x]);
    const int32_t has_a = known(a);
    const int32_t has_b = known(b);
    const int32_t has_c = known(c);
    const int32_t has_d = known(d);
    const int32_t has_e = known(e);
    const int32_t za = has_a != 0 ? a : 0;
    const int32_t zb = has_b != 0 ? b : 0;
    const int32_t zc = has_c != 0 ? c : 0;
    const int32_t zd = has_d != 0 ? d : 0;
    const int32_t ze = has_e != 0 ? e : 0;
    count_[x] = has_a + has_b + has_c + has_d + has_e;
    y_[x] = 2 * (has_e - has_a) + has_d - has_b;
    yy_[x] = 4 * (has_e + has_a) + has_d + has_b;
    z_[x] = za + zb + zc + zd + ze;
    yz_[x] = 2 * (ze - za) + zd - zb;
    zz_[x] = za * za + zb * zb + zc * zc + zd * zd + ze * ze;
  }
}

// Each sum is of kRows columns.
void Terrain::FitBlock(int begin, int row) {
  // The largest of the whole numbers: n times a sum of squares, and the square of a sum.
  static_assert(kRows * kRows * kRows * kRows * kMaxRise_cm * kMaxRise_cm <= INT32_MAX);
  const int16_t* middle = RowAt(row) + begin;
  const int first = row * kMapSize_cells + begin;
  int8_t* __restrict to_x = grade_x_ + first;
  int8_t* __restrict to_y = grade_y_ + first;
  uint8_t* __restrict to_roughness = roughness_ + first;
  uint8_t* __restrict to_cost = cost_ + first;
  const auto sum = [](const int32_t* from) {
    return from[0] + from[1] + from[2] + from[3] + from[4];
  };
  const auto moment = [](const int32_t* from) {
    return 2 * (from[4] - from[0]) + from[3] - from[1];
  };
  const auto second = [](const int32_t* from) {
    return 4 * (from[4] + from[0]) + from[3] + from[1];
  };
  HP_LOOP_BOUND(kBlock_cells)
  for (int x = 0; x < kBlock_cells; ++x) {
    const int32_t n = sum(count_ + x);
    const int32_t sx = moment(count_ + x);
    const int32_t sy = sum(y_ + x);
    const int32_t sz = sum(z_ + x);
    const auto cxx = static_cast<float>(n * second(count_ + x) - sx * sx);
    const auto cyy = static_cast<float>(n * sum(yy_ + x) - sy * sy);
    const auto cxy = static_cast<float>(n * moment(y_ + x) - sx * sy);
    const auto cxz = static_cast<float>(n * moment(z_ + x) - sx * sz);
    const auto cyz = static_cast<float>(n * sum(yz_ + x) - sy * sz);
    const auto czz = static_cast<float>(n * sum(zz_ + x) - sz * sz);
    const float det = cxx * cyy - cxy * cxy;
    const float n2 = static_cast<float>(n * n);
    const bool is_told =
        (middle[x] != kNone) & (n >= kLeastCells) & (det >= kLeastSpread * n2 * n2);
    const float share = is_told ? 1.0f / det : 0.0f;
    const float a = share * (cxz * cyy - cyz * cxy);  // cm per cell
    const float b = share * (cyz * cxx - cxz * cxy);
    const float variance = Max(czz - a * cxz - b * cyz, 0.0f) / Max(n2, 1.0f);
    const float roughness_cm = is_told ? SqrtUnchecked(variance) : 0.0f;
    const float grade_x = a / kCell_cm;
    const float grade_y = b / kCell_cm;
    const float grade = SqrtUnchecked(grade_x * grade_x + grade_y * grade_y);
    const float cost = grade_cost_ * Max(grade - free_grade_, 0.0f) +
                       roughness_cost_per_cm_ * Max(roughness_cm - free_roughness_cm_, 0.0f);
    to_x[x] = static_cast<int8_t>(Nearest(kStepsPerGrade * Clamp(grade_x, -kMaxGrade, kMaxGrade)));
    to_y[x] = static_cast<int8_t>(Nearest(kStepsPerGrade * Clamp(grade_y, -kMaxGrade, kMaxGrade)));
    const int32_t rough =
        1 + Nearest(Min(roughness_cm * (kStepsPerMetre / kCentimetersPerMeter), 254.0f));
    to_roughness[x] = static_cast<uint8_t>(is_told ? rough : 0);
    const int32_t steps = Nearest(kStepsPerCost * Min(cost, kMaxCost));
    to_cost[x] = static_cast<uint8_t>(grade > max_grade_ ? int32_t{kTooSteep} : steps);
  }
}

void Terrain::Flag(int row, uint8_t* flags) const {
  if (!exists_) return;
  const uint8_t* __restrict cost = cost_ + row * kMapSize_cells;
  constexpr uint8_t kNotHard = static_cast<uint8_t>(~(Costmap::kSoft | Costmap::kGrowth));
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t hard = static_cast<uint8_t>((flags[x] & kNotHard) | Costmap::kHard);
    flags[x] = cost[x] == kTooSteep ? hard : flags[x];
  }
}

void Terrain::AddCost(int row, uint16_t* costs_q8) const {
  if (!exists_) return;
  const uint8_t* __restrict cost = cost_ + row * kMapSize_cells;
  constexpr int kPerStep_q8 = kCostOne_q8 / static_cast<int>(kStepsPerCost);
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const int more_q8 = cost[x] == kTooSteep ? 0 : cost[x] * kPerStep_q8;
    costs_q8[x] = static_cast<uint16_t>(costs_q8[x] + more_q8);
  }
}

Terrain::Ground Terrain::At(int index) const {
  if (!exists_ || roughness_[index] == 0) return {};
  return {true, static_cast<float>(grade_x_[index]) / kStepsPerGrade,
          static_cast<float>(grade_y_[index]) / kStepsPerGrade,
          static_cast<float>(roughness_[index] - 1) / kStepsPerMetre, cost_[index] == kTooSteep};
}

}  // namespace hardpack
