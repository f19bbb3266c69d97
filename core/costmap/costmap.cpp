// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/costmap.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/costmap/rows.h"

namespace hardpack {
namespace {

constexpr uint8_t kFar2 = kMaxDistance2_cells2;
constexpr uint8_t kFar = 16;  // squared, it is beyond the saturation

// What a cell holds, as opposed to what its surroundings make of it.
constexpr uint8_t kCellFlags =
    Costmap::kHard | Costmap::kSoft | Costmap::kPerson | Costmap::kObserved;

// What of a cell's flags is given, made to agree: a person is hard, a hard cell is not soft, and an
// obstacle was observed.
uint8_t Consistent(uint8_t flags) {
  uint8_t kept = flags & kCellFlags;
  if ((kept & Costmap::kPerson) != 0) kept |= Costmap::kHard;
  if ((kept & Costmap::kHard) != 0) kept &= static_cast<uint8_t>(~Costmap::kSoft);
  if ((kept & (Costmap::kHard | Costmap::kSoft)) != 0) kept |= Costmap::kObserved;
  return kept;
}

// dx^2 + the smaller of the elements dx to the left and to the right, saturated; in bytes: what is
// added to is first limited to what can still be added without a carry.
inline uint8_t PlusSquare(const uint8_t* center, int dx) {
  const uint8_t dx2 = static_cast<uint8_t>(dx * dx);
  const uint8_t limit = static_cast<uint8_t>(kFar2 - dx2);
  return static_cast<uint8_t>(Smaller(Smaller(center[-dx], center[dx]), limit) + dx2);
}

uint8_t Squared(uint8_t distance) {
  const uint8_t squared = static_cast<uint8_t>(distance * distance);
  return distance < kFar ? squared : kFar2;
}

// out[x] = min over |dx| <= reach of dx^2 + row[x + dx], saturated; the row has margins. Three
// distances a round, because each round reads and writes all of `out`: the reach is rounded up to
// the next multiple of three.
constexpr int kRoundCells = 3;
static_assert(kRowMargin % kRoundCells == 0);

void SmallestPlusSquare(const uint8_t* __restrict row, int reach, uint8_t* __restrict out) {
  CopyRow(row, out);
  HP_LOOP_BOUND(kRowMargin / kRoundCells)
  for (int dx = 1; dx <= reach; dx += kRoundCells) {
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) {
      const uint8_t* center = row + x;
      const uint8_t near = Smaller(PlusSquare(center, dx), PlusSquare(center, dx + 1));
      out[x] = Smaller(out[x], Smaller(near, PlusSquare(center, dx + 2)));
    }
  }
}

// The largest whole number of cells whose square is not above distance2, but at most kRowMargin.
int RootOf(int distance2) {
  int root = 0;
  HP_LOOP_BOUND(kRowMargin)
  while (root < kRowMargin && (root + 1) * (root + 1) <= distance2) ++root;
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
  const float unknown = params.unknown_cost;
  const bool costs_fit = params.hard_edge_cost >= 0.0f && params.hard_slope_per_m >= 0.0f &&
                         params.soft_edge_cost >= 0.0f && params.soft_slope_per_m >= 0.0f &&
                         hard <= kMaxCost && soft <= kMaxCost && Within(unknown, 0.0f, kMaxCost) &&
                         Quantized(hard) + Quantized(soft) + Quantized(unknown) <= kMaxCost_q8;
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
  for (uint8_t& flags : map_.flags) flags = Costmap::kObserved;
  return Status::kOk;
}

Status CostmapBuilder::BeginAgain(const CostmapParams& params) {
  if (!built_) return Status::kNotStarted;
  const Status status = CheckCostmapParams(params);
  if (status != Status::kOk) return status;
  Start(map_.window, params, kHeightPasses);
  HP_LOOP_BOUND(kMapCells)
  for (uint8_t& flags : map_.flags) flags &= kCellFlags;
  return Status::kOk;
}

void CostmapBuilder::Start(const GridWindow& window, const CostmapParams& params, int first_pass) {
  map_.window = window;
  params_ = params;
  built_ = false;
  from_heights_ = first_pass == 0;
  pass_ = first_pass;
  row_ = 0;
  const float radius_cells = params.planning_radius_m * kCellsPerMeter;
  // A centre at the radius belongs to the region, also when the radius in float is a rounding less.
  constexpr float kRounding_cells2 = 0.001f;
  radius2_cells2_ = FloorToInt(radius_cells * radius_cells + kRounding_cells2);
  radius_cells_ = RootOf(radius2_cells2_);
  const int half = params.ground_window_cells / 2;
  block_cells_ = half >= 15 ? 16 : half >= 7 ? 8 : half >= 3 ? 4 : half >= 1 ? 2 : 1;
  static_assert(kReach_cells == kRowMargin);
  FillMargins(padded_ + kReach_cells);
  FillMargins(row_heights_ + kReach_cells);
  FillMargins(row_ground_ + kReach_cells);
  HP_LOOP_BOUND(kNearRows)
  for (auto& row : near_rows_) {
    HP_LOOP_BOUND(kMapSize_cells)
    for (int16_t& height_cm : row) height_cm = HeightGrid::kNone;
  }
}

void CostmapBuilder::SetCell(int index, uint8_t flags) {
  HP_ASSERT(index >= 0 && index < kMapCells);
  HP_ASSERT(!from_heights_ && pass_ == kHeightPasses && row_ == 0);
  map_.flags[index] = Consistent(flags);
}

void CostmapBuilder::Mark(int index, uint8_t flags) {
  HP_ASSERT(index >= 0 && index < kMapCells);
  HP_ASSERT(from_heights_ && pass_ == kHeightPasses && row_ == 0);
  constexpr uint8_t kObstacles = Costmap::kHard | Costmap::kSoft | Costmap::kPerson;
  map_.flags[index] = Consistent(static_cast<uint8_t>(map_.flags[index] | (flags & kObstacles)));
}

Progress CostmapBuilder::Step(const HeightGrid& heights, int units) {
  HP_LOOP_BOUND(kUnits)
  for (int left = units; left > 0 && pass_ < kPasses; --left) {
    if (pass_ < kHeightPasses) {
      HeightUnit(heights);
    } else {
      DistanceUnit();
    }
    EndUnit();
  }
  return pass_ < kPasses ? Progress::kBusy : Progress::kDone;
}

Progress CostmapBuilder::StepHeights(const HeightGrid& heights, int units) {
  HP_LOOP_BOUND(kHeightUnits)
  for (int left = units; left > 0 && pass_ < kHeightPasses; --left) {
    HeightUnit(heights);
    EndUnit();
  }
  return pass_ < kHeightPasses ? Progress::kBusy : Progress::kDone;
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
  built_ = pass_ == kPasses;
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
  if (!dilated) {
    // How far a hard cell is, the map tells as far as it can.
    DistancesToRegion(row, region, hard ? kReach_cells : radius_cells_);
    Dilate(row, hard);
    return;
  }
  if (row_ == 0) FillCosts(hard);
  DistancesToRegion(row, region, halo_reach_cells_);
  DistancesOutOfRegion(row, region, hard ? kReach_cells : depth_reach_cells_);
  if (hard) BeginCosts(row);
  AddCosts(row);
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

// From vertical distances to Euclidean ones: to the region for cells outside (0 inside). Those
// within the reach are exact, others beyond it.
void CostmapBuilder::DistancesToRegion(int row, uint8_t region, int reach_cells) {
  const uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t* distance = plane_ + row * kMapSize_cells;
  uint8_t* padded = padded_ + kReach_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t distance2 = Squared(distance[x]);
    padded[x] = (flags[x] & region) != 0 ? uint8_t{0} : distance2;
  }
  SmallestPlusSquare(padded, reach_cells, to_region2_);
}

// The same out of the region for cells inside (0 outside).
void CostmapBuilder::DistancesOutOfRegion(int row, uint8_t region, int reach_cells) {
  const uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t* distance = plane_ + row * kMapSize_cells;
  uint8_t* padded = padded_ + kReach_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t distance2 = Squared(distance[x]);
    padded[x] = (flags[x] & region) != 0 ? distance2 : uint8_t{0};
  }
  SmallestPlusSquare(padded, reach_cells, out_of_region2_);
}

void CostmapBuilder::Dilate(int row, bool hard) {
  uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t dilated = hard ? Costmap::kLethal : Costmap::kSoftRegion;
  const uint8_t radius2_cells2 = static_cast<uint8_t>(radius2_cells2_);
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    flags[x] = static_cast<uint8_t>(flags[x] | (to_region2_[x] <= radius2_cells2 ? dilated : 0));
  }
  if (!hard) return;
  uint8_t* hard_distance2 = map_.hard_distance2 + row * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) hard_distance2[x] = to_region2_[x];
}

// A layer's costs by squared distance between cell centres: the edge lies half a cell before the
// nearest centre on the other side. Distance 0 is the other side's business.
void CostmapBuilder::FillCosts(bool hard) {
  const float edge_cost = hard ? params_.hard_edge_cost : params_.soft_edge_cost;
  const float slope_per_m = hard ? params_.hard_slope_per_m : params_.soft_slope_per_m;
  halo_q8_[0] = 0;
  depth_q8_[0] = 0;
  HP_LOOP_BOUND(kMaxDistance2_cells2)
  for (int distance2 = 1; distance2 <= kMaxDistance2_cells2; ++distance2) {
    const float s_m = (Sqrt(static_cast<float>(distance2)) - 0.5f) * kCellSize_m;
    const float halo = HaloCost(s_m, edge_cost, params_.halo_m);
    const float inside = InsideCost(s_m, edge_cost, slope_per_m, params_.planning_radius_m);
    halo_q8_[distance2] = static_cast<uint16_t>(Quantized(halo));
    depth_q8_[distance2] = static_cast<uint16_t>(Quantized(inside));
  }
  halo_reach_cells_ = ReachOf(halo_q8_);
  depth_reach_cells_ = ReachOf(depth_q8_);
}

// What a cell costs before the layers. Takes the place of the heights.
void CostmapBuilder::BeginCosts(int row) {
  const uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t* out_of_region2 = out_of_region2_;
  uint16_t* cost_q8 = map_.cost_q8 + row * kMapSize_cells;
  uint8_t* hard_depth2 = map_.hard_depth2 + row * kMapSize_cells;
  const uint16_t unknown_q8 = static_cast<uint16_t>(Quantized(params_.unknown_cost));
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    cost_q8[x] = (flags[x] & Costmap::kObserved) != 0 ? uint16_t{0} : unknown_q8;
    hard_depth2[x] = out_of_region2[x];
  }
}

void CostmapBuilder::AddCosts(int row) {
  uint16_t* cost_q8 = map_.cost_q8 + row * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    // One of the two distances is 0, and so is its cost.
    const int layer_q8 = halo_q8_[to_region2_[x]] + depth_q8_[out_of_region2_[x]];
    cost_q8[x] = static_cast<uint16_t>(cost_q8[x] + layer_q8);
  }
}

}  // namespace hardpack
