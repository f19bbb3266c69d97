// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/costmap.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

constexpr uint8_t kFar2 = kMaxDistance2_cells2;
constexpr uint8_t kFar = 16;  // squared, it is beyond the saturation

constexpr float kCentimetersPerMeter = 100.0f;

// Heights in the cost plane, which is free until the first costs: shifted, so that their order is
// that of unsigned numbers.
uint16_t Biased(int16_t height_cm) {
  return static_cast<uint16_t>(int32_t{height_cm} + 32768);
}
int32_t Unbiased(uint16_t height) {
  return int32_t{height} - 32768;
}

template <typename T>
constexpr T Smaller(T a, T b) {
  return b < a ? b : a;
}

// Replaces each element of a row by the smallest of those at most `half` places away; past the
// row's ends there is nothing.
template <typename T>
void SlideMinimum(T* row, int half) {
  // First the minimum of [x, x + half], doubling the length. In place: an element reads those
  // after it, which are still those of the step before.
  int length = 1;
  HP_LOOP_BOUND(4)
  while (length <= half) {
    const int shift = Smaller(length, half + 1 - length);
    HP_LOOP_BOUND(kMapSize_cells - 1)
    for (int x = 0; x < kMapSize_cells - shift; ++x) row[x] = Smaller(row[x], row[x + shift]);
    length += shift;
  }
  // Then joined with that of [x - half, x]; near the start both begin inside [0, half].
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = kMapSize_cells - 1; x >= half; --x) row[x] = Smaller(row[x], row[x - half]);
  HP_LOOP_BOUND(kMaxGroundWindow_cells / 2)
  for (int x = half - 1; x > 0; --x) row[x] = Smaller(row[x], row[0]);
}
static_assert(kMaxGroundWindow_cells / 2 <= 15, "SlideMinimum's four doublings reach 16");

// What is known of the ground around a cell.
struct Ground {
  int32_t lowest_cm;  // lowest return of any class in the neighbourhood
  bool seen;          // a return classed as ground is among them
};

struct Thresholds {
  int32_t obstacle_cm;
  int32_t clearance_cm;
};

// The paper's rule: everything is measured from the lowest return of the same cell.
uint8_t ObstacleInCell(const HeightGrid::CellHeights& heights, const Thresholds& thresholds) {
  if (heights.highest_hard_cm != HeightGrid::kNone &&
      heights.highest_hard_cm - heights.lowest_cm > thresholds.obstacle_cm) {
    return Costmap::kHard;
  }
  if (heights.highest_soft_cm != HeightGrid::kNone &&
      heights.highest_soft_cm - heights.lowest_cm > thresholds.obstacle_cm) {
    return Costmap::kSoft;
  }
  return 0;
}

// Hard above local ground. Only the lowest and the highest hard return are known; what may lie
// between them counts as being there.
bool HardAboveGround(const HeightGrid::CellHeights& heights, const Ground& ground,
                     const Thresholds& thresholds) {
  if (heights.highest_hard_cm == HeightGrid::kNone) return false;
  const bool overhang = heights.lowest_hard_cm - ground.lowest_cm > thresholds.clearance_cm;
  if (overhang) return false;
  const bool high = heights.highest_hard_cm - ground.lowest_cm > thresholds.obstacle_cm;
  return high || !ground.seen;
}

uint8_t ObstacleAboveGround(const HeightGrid::CellHeights& heights, const Ground& ground,
                            const Thresholds& thresholds) {
  if (HardAboveGround(heights, ground, thresholds)) return Costmap::kHard;
  if (heights.highest_soft_cm != HeightGrid::kNone &&
      heights.highest_soft_cm - ground.lowest_cm > thresholds.obstacle_cm) {
    return Costmap::kSoft;
  }
  return 0;
}

// out[x] = min over |dx| <= 15 of dx^2 + padded[x + dx], saturated. In bytes throughout: what is
// added to is first limited to what can still be added without a carry.
template <int kReach>
void MinimumPlusSquare(const uint8_t* __restrict padded, uint8_t* __restrict out) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) out[x] = padded[x + kReach];
  HP_LOOP_BOUND(kReach)
  for (int dx = 1; dx <= kReach; ++dx) {
    const uint8_t dx2 = static_cast<uint8_t>(dx * dx);
    const uint8_t limit = static_cast<uint8_t>(kFar2 - dx2);
    const uint8_t* left = padded + (kReach - dx);
    const uint8_t* right = padded + (kReach + dx);
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) {
      const uint8_t nearest = Smaller(Smaller(left[x], right[x]), limit);
      out[x] = Smaller(out[x], static_cast<uint8_t>(nearest + dx2));
    }
  }
}

// Cost of a layer inside the dilated region, s beyond its edge; and outside, s before it. At s = 0
// both are edge_cost.
float InsideCost(float s_m, float edge_cost, float slope_per_m, float planning_radius_m) {
  return edge_cost + slope_per_m * Min(s_m, planning_radius_m);
}
float HaloCost(float s_m, float edge_cost, float halo_m) {
  if (s_m >= halo_m) return 0.0f;
  const float share = 1.0f - s_m / halo_m;
  return edge_cost * share * share;
}

int32_t Quantized(float cost) {
  return RoundToInt(cost * kCostOne_q8);
}

// The layer's costs by squared distance between cell centres: the edge lies half a cell before the
// nearest centre on the other side. Distance 0 is the other side's business.
void FillTables(float edge_cost, float slope_per_m, const CostmapParams& params,
                uint16_t* to_region_q8, uint16_t* out_of_region_q8) {
  to_region_q8[0] = 0;
  out_of_region_q8[0] = 0;
  HP_LOOP_BOUND(kMaxDistance2_cells2)
  for (int distance2 = 1; distance2 <= kMaxDistance2_cells2; ++distance2) {
    const float s_m = (Sqrt(static_cast<float>(distance2)) - 0.5f) * kCellSize_m;
    to_region_q8[distance2] =
        static_cast<uint16_t>(Quantized(HaloCost(s_m, edge_cost, params.halo_m)));
    out_of_region_q8[distance2] = static_cast<uint16_t>(
        Quantized(InsideCost(s_m, edge_cost, slope_per_m, params.planning_radius_m)));
  }
}

constexpr float kMaxCost = static_cast<float>(kMaxCost_q8) / kCostOne_q8;

bool Within(float value, float low, float high) {
  return value >= low && value <= high;
}

}  // namespace

Status CheckCostmapParams(const CostmapParams& params) {
  constexpr float kMaxHeight_m = 327.0f;  // what a HeightGrid can tell apart
  const bool rule_known = params.obstacle_rule == ObstacleRule::kInCell ||
                          params.obstacle_rule == ObstacleRule::kLocalGround;
  const bool heights_fit = Within(params.obstacle_height_m, 0.0f, kMaxHeight_m) &&
                           Within(params.clearance_height_m, 0.0f, kMaxHeight_m) &&
                           params.clearance_height_m > params.obstacle_height_m;
  const bool window_fits = params.ground_window_cells >= 1 &&
                           params.ground_window_cells <= kMaxGroundWindow_cells &&
                           params.ground_window_cells % 2 == 1;
  const bool radii_fit = Within(params.planning_radius_m, 0.0f, kMaxPlanningRadius_m) &&
                         Within(params.halo_m, 0.0f, kMaxHalo_m);
  if (!rule_known || !heights_fit || !window_fits || !radii_fit) {
    return Status::kParameterOutOfRange;
  }

  const float radius_m = params.planning_radius_m;
  const float hard = InsideCost(radius_m, params.hard_edge_cost, params.hard_slope_per_m, radius_m);
  const float soft = InsideCost(radius_m, params.soft_edge_cost, params.soft_slope_per_m, radius_m);
  const bool costs_fit = params.hard_edge_cost >= 0.0f && params.hard_slope_per_m >= 0.0f &&
                         params.soft_edge_cost >= 0.0f && params.soft_slope_per_m >= 0.0f &&
                         IsFinite(params.hard_slope_per_m) && IsFinite(params.soft_slope_per_m) &&
                         hard <= kMaxCost && soft <= kMaxCost &&
                         Quantized(hard) + Quantized(soft) <= kMaxCost_q8;
  return costs_fit ? Status::kOk : Status::kParameterOutOfRange;
}

Status CostmapBuilder::Begin(const HeightGrid& heights, const CostmapParams& params) {
  const Status status = CheckCostmapParams(params);
  if (status != Status::kOk) return status;
  Start(heights.window(), params, 0);
  return Status::kOk;
}

Status CostmapBuilder::BeginCells(const GridWindow& window, const CostmapParams& params) {
  const Status status = CheckCostmapParams(params);
  if (status != Status::kOk) return status;
  Start(window, params, kHeightPasses);
  HP_LOOP_BOUND(kMapCells)
  for (int index = 0; index < kMapCells; ++index) map_.flags[index] = 0;
  return Status::kOk;
}

void CostmapBuilder::Start(const GridWindow& window, const CostmapParams& params, int first_pass) {
  map_.window = window;
  params_ = params;
  pass_ = first_pass;
  row_ = 0;
  const float radius_cells = params.planning_radius_m * kCellsPerMeter;
  radius2_cells2_ = FloorToInt(radius_cells * radius_cells);
  FillTables(params.hard_edge_cost, params.hard_slope_per_m, params, cost_table_q8_[0][0],
             cost_table_q8_[0][1]);
  FillTables(params.soft_edge_cost, params.soft_slope_per_m, params, cost_table_q8_[1][0],
             cost_table_q8_[1][1]);
  HP_LOOP_BOUND(kReach_cells)
  for (int x = 0; x < kReach_cells; ++x) {
    padded_[x] = kFar2;
    padded_[kReach_cells + kMapSize_cells + x] = kFar2;
  }
}

void CostmapBuilder::SetCell(int index, uint8_t flags) {
  HP_ASSERT(index >= 0 && index < kMapCells);
  HP_ASSERT(pass_ == kHeightPasses && row_ == 0);
  uint8_t kept = flags & (Costmap::kHard | Costmap::kSoft | Costmap::kPerson | Costmap::kObserved);
  if ((kept & Costmap::kPerson) != 0) kept |= Costmap::kHard;
  if ((kept & Costmap::kHard) != 0) kept &= static_cast<uint8_t>(~Costmap::kSoft);
  map_.flags[index] = kept;
}

Progress CostmapBuilder::Step(const HeightGrid& heights, int units) {
  HP_LOOP_BOUND(kUnits)
  for (int left = units; left > 0 && pass_ < kPasses; --left) {
    if (pass_ == 0) {
      LoadGround(heights);
    } else if (pass_ == 1) {
      ClassifyRow(heights);
    } else {
      DistanceUnit();
    }
    EndUnit();
  }
  return pass_ < kPasses ? Progress::kBusy : Progress::kDone;
}

Progress CostmapBuilder::StepCells(int units) {
  HP_ASSERT(pass_ >= kHeightPasses);
  HP_LOOP_BOUND(kCellUnits)
  for (int left = units; left > 0 && pass_ < kPasses; --left) {
    DistanceUnit();
    EndUnit();
  }
  return pass_ < kPasses ? Progress::kBusy : Progress::kDone;
}

void CostmapBuilder::EndUnit() {
  if (++row_ < kMapSize_cells) return;
  row_ = 0;
  ++pass_;
}

// First half of the neighbourhood's lowest return and of whether ground was seen in it: along x.
void CostmapBuilder::LoadGround(const HeightGrid& heights) {
  uint16_t* lowest = map_.cost_q8 + row_ * kMapSize_cells;
  uint8_t* unseen = plane_ + row_ * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const HeightGrid::CellHeights cell =
        heights.At({map_.window.origin.x + x, map_.window.origin.y + row_});
    lowest[x] = Biased(cell.lowest_cm);
    unseen[x] = cell.ground ? 0 : 1;
  }
  SlideMinimum(lowest, params_.ground_window_cells / 2);
  SlideMinimum(unseen, params_.ground_window_cells / 2);
}

// Second half: along y; and the obstacle rule.
void CostmapBuilder::ClassifyRow(const HeightGrid& heights) {
  constexpr int kStrip = 64;  // a strip of minima fits the stack, and its loops vectorise
  const int half = params_.ground_window_cells / 2;
  const int first = ClampInt(row_ - half, 0, kMapSize_cells - 1);
  const int last = ClampInt(row_ + half, 0, kMapSize_cells - 1);
  const Thresholds thresholds = {RoundToInt(params_.obstacle_height_m * kCentimetersPerMeter),
                                 RoundToInt(params_.clearance_height_m * kCentimetersPerMeter)};
  HP_LOOP_BOUND(kMapSize_cells / kStrip)
  for (int x = 0; x < kMapSize_cells; x += kStrip) {
    uint16_t lowest[kStrip];
    uint8_t unseen[kStrip];
    HP_LOOP_BOUND(kStrip)
    for (int i = 0; i < kStrip; ++i) {
      lowest[i] = UINT16_MAX;
      unseen[i] = 1;
    }
    HP_LOOP_BOUND(kMaxGroundWindow_cells)
    for (int y = first; y <= last; ++y) {
      const uint16_t* lowest_row = map_.cost_q8 + y * kMapSize_cells + x;
      const uint8_t* unseen_row = plane_ + y * kMapSize_cells + x;
      HP_LOOP_BOUND(kStrip)
      for (int i = 0; i < kStrip; ++i) {
        lowest[i] = Smaller(lowest[i], lowest_row[i]);
        unseen[i] = Smaller(unseen[i], unseen_row[i]);
      }
    }
    HP_LOOP_BOUND(kStrip)
    for (int i = 0; i < kStrip; ++i) {
      const HeightGrid::CellHeights cell =
          heights.At({map_.window.origin.x + x + i, map_.window.origin.y + row_});
      const Ground ground = {Unbiased(lowest[i]), unseen[i] == 0};
      uint8_t flags = params_.obstacle_rule == ObstacleRule::kInCell
                          ? ObstacleInCell(cell, thresholds)
                          : ObstacleAboveGround(cell, ground, thresholds);
      if (cell.person && (flags & Costmap::kHard) != 0) flags |= Costmap::kPerson;
      if (cell.lowest_cm != HeightGrid::kNone) flags |= Costmap::kObserved;
      map_.flags[row_ * kMapSize_cells + x + i] = flags;
    }
  }
}

// Four exact distance transforms: hard cells, lethal region, soft cells, soft region. Each is a
// sweep towards larger y and one back; the way back finishes a row at once.
void CostmapBuilder::DistanceUnit() {
  static constexpr uint8_t kRegions[] = {Costmap::kHard, Costmap::kLethal, Costmap::kSoft,
                                         Costmap::kSoftRegion};
  const int sweep = pass_ - kHeightPasses;
  const uint8_t region = kRegions[sweep / 2];
  const bool hard = sweep < 4;
  const bool dilated = sweep / 2 % 2 == 1;
  if (sweep % 2 == 0) {
    SweepUp(row_, region);
    return;
  }
  const int row = kMapSize_cells - 1 - row_;
  SweepDown(row, region);
  DistancesAlongRow(row, region, dilated);
  if (dilated) {
    AddCosts(row, hard);
  } else {
    Dilate(row, hard);
  }
}

// Vertical distance to the nearest cell on the other side of the region's edge, so far among the
// rows below: 1 beside the edge, one more with every row. Off the map there is no edge.
void CostmapBuilder::SweepUp(int row, uint8_t region) {
  uint8_t* distance = plane_ + row * kMapSize_cells;
  if (row == 0) {
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) distance[x] = kFar;
    return;
  }
  const uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t* flags_below = flags - kMapSize_cells;
  const uint8_t* distance_below = distance - kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const bool same_side = ((flags[x] ^ flags_below[x]) & region) == 0;
    const uint8_t further = Smaller(static_cast<uint8_t>(distance_below[x] + 1), kFar);
    distance[x] = same_side ? further : uint8_t{1};
  }
}

// The same among the rows above, and the smaller of both.
void CostmapBuilder::SweepDown(int row, uint8_t region) {
  if (row == kMapSize_cells - 1) return;
  uint8_t* distance = plane_ + row * kMapSize_cells;
  const uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t* flags_above = flags + kMapSize_cells;
  const uint8_t* distance_above = distance + kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const bool same_side = ((flags[x] ^ flags_above[x]) & region) == 0;
    const uint8_t further = static_cast<uint8_t>(distance_above[x] + 1);
    distance[x] = Smaller(distance[x], same_side ? further : uint8_t{1});
  }
}

// From vertical distances to Euclidean ones: to the region for cells outside (0 inside); with
// `inside` also out of it for cells inside (0 outside).
void CostmapBuilder::DistancesAlongRow(int row, uint8_t region, bool inside) {
  const uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t* distance = plane_ + row * kMapSize_cells;
  uint8_t* padded = padded_ + kReach_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t squared =
        distance[x] < kFar ? static_cast<uint8_t>(distance[x] * distance[x]) : kFar2;
    padded[x] = (flags[x] & region) != 0 ? uint8_t{0} : squared;
  }
  MinimumPlusSquare<kReach_cells>(padded_, to_region2_);
  if (!inside) return;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t squared =
        distance[x] < kFar ? static_cast<uint8_t>(distance[x] * distance[x]) : kFar2;
    padded[x] = (flags[x] & region) != 0 ? squared : uint8_t{0};
  }
  MinimumPlusSquare<kReach_cells>(padded_, out_of_region2_);
}

void CostmapBuilder::Dilate(int row, bool hard) {
  uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t dilated = hard ? Costmap::kLethal : Costmap::kSoftRegion;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    flags[x] = static_cast<uint8_t>(flags[x] | (to_region2_[x] <= radius2_cells2_ ? dilated : 0));
  }
  if (!hard) return;
  uint8_t* hard_distance2 = map_.hard_distance2 + row * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) hard_distance2[x] = to_region2_[x];
}

void CostmapBuilder::AddCosts(int row, bool hard) {
  const uint16_t(&table_q8)[2][kTable] = cost_table_q8_[hard ? 0 : 1];
  uint16_t* cost_q8 = map_.cost_q8 + row * kMapSize_cells;
  // The hard layer comes first and takes the place of the heights.
  const uint16_t keep = hard ? 0 : UINT16_MAX;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    // One of the two distances is 0, and so is its cost.
    const int layer_q8 = table_q8[0][to_region2_[x]] + table_q8[1][out_of_region2_[x]];
    cost_q8[x] = static_cast<uint16_t>((cost_q8[x] & keep) + layer_q8);
  }
  if (!hard) return;
  uint8_t* hard_depth2 = map_.hard_depth2 + row * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) hard_depth2[x] = out_of_region2_[x];
}

}  // namespace hardpack
