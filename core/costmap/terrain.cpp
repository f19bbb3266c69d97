// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/terrain.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/costmap/costmap.h"
#include "core/costmap/rows.h"

namespace hardpack {
namespace {

constexpr int16_t kNone = HeightGrid::kNone;
constexpr float kCell_cm = 100.0f * kCellSize_m;
// The determinant of the places' covariance from which on a plane is told, 4 / 5 cells^4: three
// rows of five cells have 1.33, two have 0.5.
constexpr float kLeastSpread = 4.0f;
constexpr float kSpreadOf = 5.0f;

// To the nearest whole number, for numbers of either sign that an int holds: a loop over cells may
// be vectorised.
inline int32_t Nearest(float value) {
  return static_cast<int32_t>(value + (value < 0.0f ? -0.5f : 0.5f));
}

void KeepKnown(const uint8_t* __restrict seen, int16_t* __restrict cells) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const int16_t height_cm = cells[x];
    cells[x] = (seen[x] & HeightGrid::kGroundHeightKnown) != 0 ? height_cm : kNone;
  }
}

inline int32_t Flagged(bool is) {
  return static_cast<int32_t>(is);
}

// Exact for what is not above Terrain::kMaxRise_cm. Processors without a product of whole numbers
// for several lanes have one of floats.
inline float SquaredExactly(int32_t value) {
  const auto exact = static_cast<float>(value);
  return exact * exact;
}

// What steepness and roughness cost.
struct Prices {
  float free_grade;
  float grade_cost;
  float free_roughness_cm;
  float roughness_cost_per_cm;
  float max_grade;
};

// Of some cells: the planes' slopes [cm per cell], the deviation from them, and 1 where there is
// one, else 0, as bytes. Arguments, as the compiler need not ask then whether they overlap.
template <int kCells>
[[gnu::noinline]] void Tell(const Prices& prices, const float* __restrict a,
                            const float* __restrict b, const float* __restrict deviation_cm,
                            const int32_t* __restrict told, const float* __restrict doubt,
                            int8_t* __restrict to_x, int8_t* __restrict to_y,
                            uint8_t* __restrict to_roughness, uint8_t* __restrict to_cost) {
  const Prices is = prices;
  HP_LOOP_BOUND(kCells)
  for (int x = 0; x < kCells; ++x) {
    const float roughness_cm = deviation_cm[x];
    const float grade_x = a[x] / kCell_cm;
    const float grade_y = b[x] / kCell_cm;
    const float grade = SqrtUnchecked(grade_x * grade_x + grade_y * grade_y);
    const float cost = is.grade_cost * Max(grade - is.free_grade, 0.0f) +
                       is.roughness_cost_per_cm * Max(roughness_cm - is.free_roughness_cm, 0.0f);
    const int32_t rough = 1 + Nearest(Terrain::kStepsPerCm * roughness_cm);
    const int32_t steps =
        ClampInt(Nearest(Terrain::kStepsPerCost * cost), 0, Terrain::kMostCost_steps);
    // kTooSteep has all bits.
    const int32_t steep = Flagged(grade > is.max_grade + doubt[x]);
    to_x[x] = static_cast<int8_t>(ClampInt(Nearest(Terrain::kStepsPerGrade * grade_x), -127, 127));
    to_y[x] = static_cast<int8_t>(ClampInt(Nearest(Terrain::kStepsPerGrade * grade_y), -127, 127));
    to_roughness[x] = static_cast<uint8_t>(told[x] * ClampInt(rough, 0, 255));
    to_cost[x] = static_cast<uint8_t>(steps | -steep);
  }
}

// Of columns over Terrain::kRows rows, with y counted from the middle one and z from a reference.
struct ColumnSums {
  const float* count;
  const float* y;
  const float* yy;
  const float* z;
  const float* yz;
  const int32_t* zz;
};

// The planes about kCells cells: slopes [cm per cell], the deviation from them, 1 where there is
// one, else 0, and two standard deviations of the grade. Not inlined: together the frames are too
// large. Each sum is of as many columns as rows.
template <int kCells>
[[gnu::noinline]] void Fit(const ColumnSums& is, const int16_t* __restrict middle,
                           float* __restrict to_a, float* __restrict to_b,
                           float* __restrict to_deviation_cm, int32_t* __restrict to_told,
                           float* __restrict to_doubt) {
  const auto sum = [](const auto* from) { return from[0] + from[1] + from[2] + from[3] + from[4]; };
  const auto moment = [](const float* from) {
    return 2.0f * (from[4] - from[0]) + from[3] - from[1];
  };
  const auto second = [](const float* from) {
    return 4.0f * (from[4] + from[0]) + from[3] + from[1];
  };
  HP_LOOP_BOUND(kCells)
  for (int x = 0; x < kCells; ++x) {
    const float n = sum(is.count + x);
    const float sx = moment(is.count + x);
    const float sy = sum(is.y + x);
    const float sz = sum(is.z + x);
    const float cxx = n * second(is.count + x) - sx * sx;
    const float cyy = n * sum(is.yy + x) - sy * sy;
    const float cxy = n * moment(is.y + x) - sx * sy;
    const float cxz = n * moment(is.z + x) - sx * sz;
    const float cyz = n * sum(is.yz + x) - sy * sz;
    const auto whole_n = static_cast<int32_t>(n);
    const auto whole_sz = static_cast<int32_t>(sz);
    const auto czz = static_cast<float>(whole_n * sum(is.zz + x) - whole_sz * whole_sz);
    const float det = cxx * cyy - cxy * cxy;
    const float n2 = n * n;
    // As a factor: a loop with conditions would not vectorise.
    const int32_t height_cm = middle[x];
    const int32_t told = Flagged(height_cm != kNone) & Flagged(n >= Terrain::kLeastCells) &
                         Flagged(kSpreadOf * det >= kLeastSpread * n2 * n2);
    const float share = static_cast<float>(told) / (det + static_cast<float>(Flagged(det == 0.0f)));
    const float a = share * (cxz * cyy - cyz * cxy);
    const float b = share * (cyz * cxx - cxz * cxy);
    // Not below 0 but for rounding.
    const float variance =
        Abs(czz - a * cxz - b * cyz) / (n2 + static_cast<float>(Flagged(n2 == 0.0f)));
    constexpr float kNoise_cm2 = Terrain::kNoise_cm * Terrain::kNoise_cm;
    const float spread = (cxx + cyy) * n * share;
    to_a[x] = a;
    to_b[x] = b;
    to_deviation_cm[x] = static_cast<float>(told) * SqrtUnchecked(variance);
    to_told[x] = told;
    to_doubt[x] = 2.0f / kCell_cm * SqrtUnchecked((variance + kNoise_cm2) * spread);
  }
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

void Terrain::AddRow(const HeightGrid& heights, Cell origin, int unit) {
  if (!exists_) return;
  const int row = kFirst - kReach_cells + unit;
  int16_t* cells = rows_[row % kRows].cells();
  heights.ReadGround({origin.x, origin.y + row}, HeightGrid::HeightRow(cells, kMapSize_cells),
                     seen_);
  KeepKnown(seen_, cells);
  if (IsNear(row - kReach_cells)) FitRow(row - kReach_cells);
}

// About the lowest height of each block, so that the sums fit.
void Terrain::FitRow(int row) {
  // The largest of the whole numbers: n times a sum of squares, and the square of a sum. And of
  // those in single precision: a column's sum of squares, and n times a moment or two such.
  static_assert(int64_t{kRows} * kRows * kRows * kRows * kMaxRise_cm * kMaxRise_cm <= INT32_MAX);
  static_assert(kRows * kMaxRise_cm * kMaxRise_cm < 1 << 24);
  static_assert(2 * kRows * kRows * kRows * kRows * kReach_cells * kMaxRise_cm < 1 << 24);
  const int16_t* middle = RowAt(row) + kFirst;
  HP_LOOP_BOUND(kSide_cells / kBlock_cells)
  for (int begin = 0; begin < kSide_cells; begin += kBlock_cells) {
    int16_t lowest_cm = kNone;
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = begin; x < begin + kBlock_cells; ++x) lowest_cm = Smaller(lowest_cm, middle[x]);
    if (lowest_cm != kNone) {
      SumColumns(kFirst + begin, row, lowest_cm);
      Fit<kBlock_cells>({count_, y_, yy_, z_, yz_, zz_}, middle + begin, a_ + begin, b_ + begin,
                        deviation_cm_ + begin, told_ + begin, doubt_ + begin);
      continue;
    }
    HP_LOOP_BOUND(kBlock_cells)
    for (int x = begin; x < begin + kBlock_cells; ++x) {
      a_[x] = 0.0f;
      b_[x] = 0.0f;
      deviation_cm_[x] = 0.0f;
      told_[x] = 0;
      doubt_[x] = 0.0f;
    }
  }
  const Prices prices = {free_grade_, grade_cost_, free_roughness_cm_, roughness_cost_per_cm_,
                         max_grade_};
  const int cell = (row - kFirst) * kSide_cells;
  Tell<kSide_cells>(prices, a_, b_, deviation_cm_, told_, doubt_, grade_x_ + cell, grade_y_ + cell,
                    roughness_ + cell, cost_ + cell);
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
      return Flagged(rise_cm <= kMaxRise_cm) & Flagged(rise_cm >= -kMaxRise_cm);
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
    const int32_t za = a & -has_a;
    const int32_t zb = b & -has_b;
    const int32_t zc = c & -has_c;
    const int32_t zd = d & -has_d;
    const int32_t ze = e & -has_e;
    count_[x] = static_cast<float>(has_a + has_b + has_c + has_d + has_e);
    y_[x] = static_cast<float>(2 * (has_e - has_a) + has_d - has_b);
    yy_[x] = static_cast<float>(4 * (has_e + has_a) + has_d + has_b);
    z_[x] = static_cast<float>(za + zb + zc + zd + ze);
    yz_[x] = static_cast<float>(2 * (ze - za) + zd - zb);
    zz_[x] = static_cast<int32_t>(SquaredExactly(za) + SquaredExactly(zb) + SquaredExactly(zc) +
                                  SquaredExactly(zd) + SquaredExactly(ze));
  }
}

void Terrain::Flag(int row, uint8_t* __restrict flags) const {
  if (!exists_ || !IsNear(row)) return;
  const uint8_t* __restrict cost = cost_ + (row - kFirst) * kSide_cells;
  constexpr uint8_t kNotHard = static_cast<uint8_t>(~(Costmap::kSoft | Costmap::kGrowth));
  HP_LOOP_BOUND(kSide_cells)
  for (int x = 0; x < kSide_cells; ++x) {
    const uint8_t flag = flags[kFirst + x];
    const uint8_t hard = static_cast<uint8_t>((flag & kNotHard) | Costmap::kHard);
    flags[kFirst + x] = cost[x] == kTooSteep ? hard : flag;
  }
}

void Terrain::AddCost(int row, uint16_t* __restrict costs_q8) const {
  if (!exists_ || !IsNear(row)) return;
  const uint8_t* __restrict cost = cost_ + (row - kFirst) * kSide_cells;
  constexpr int kPerStep_q8 = kCostOne_q8 / static_cast<int>(kStepsPerCost);
  HP_LOOP_BOUND(kSide_cells)
  for (int x = 0; x < kSide_cells; ++x) {
    costs_q8[kFirst + x] = static_cast<uint16_t>(costs_q8[kFirst + x] + cost[x] * kPerStep_q8);
  }
}

Terrain::Ground Terrain::At(int index) const {
  const int row = index / kMapSize_cells;
  const int column = index % kMapSize_cells;
  if (!exists_ || !IsNear(row) || !IsNear(column)) return {};
  const int cell = (row - kFirst) * kSide_cells + column - kFirst;
  if (roughness_[cell] == 0) return {};
  return {true, static_cast<float>(grade_x_[cell]) / kStepsPerGrade,
          static_cast<float>(grade_y_[cell]) / kStepsPerGrade,
          FromCentimeters(1) * static_cast<float>(roughness_[cell] - 1) / kStepsPerCm,
          cost_[cell] == kTooSteep};
}

}  // namespace hardpack
