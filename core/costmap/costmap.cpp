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

// What a cell holds, as opposed to what its surroundings make of it.
constexpr uint8_t kCellFlags =
    Costmap::kHard | Costmap::kSoft | Costmap::kPerson | Costmap::kObserved;

// Heights in the cost plane, which is free until the first costs: shifted, so that their order is
// that of unsigned numbers.
uint16_t Biased(int16_t height_cm) {
  return static_cast<uint16_t>(int32_t{height_cm} + 32768);
}
int32_t Unbiased(uint16_t height) {
  return int32_t{height} - 32768;
}

constexpr int kStrip = HeightGrid::kStripCells;

template <typename T>
constexpr T Smaller(T a, T b) {
  return b < a ? b : a;
}

// smallest[x] = min(smallest[x], a[x], b[x]) along a row. a and b may overlap.
template <typename T>
void KeepSmallest(const T* __restrict a, const T* __restrict b, T* __restrict smallest) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    smallest[x] = Smaller(smallest[x], Smaller(a[x], b[x]));
  }
}

template <typename T>
void CopyRow(const T* __restrict from, T* __restrict to) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) to[x] = from[x];
}

// to[x] = the smallest of from[x - half .. x + half]; `from` has a margin of `half` on either side.
template <typename T>
void SmallestAlongRow(const T* from, int half, T* to) {
  CopyRow(from, to);
  HP_LOOP_BOUND(kMaxGroundWindow_cells / 2)
  for (int dx = 1; dx <= half; ++dx) KeepSmallest(from - dx, from + dx, to);
}

// to[x] = the smallest of plane[x, row - half .. row + half]. A row beyond the map is replaced by
// the map's last, which is in the neighbourhood anyway.
template <typename T>
void SmallestAcrossRows(const T* plane, int row, int half, T* to) {
  CopyRow(plane + row * kMapSize_cells, to);
  HP_LOOP_BOUND(kMaxGroundWindow_cells / 2)
  for (int dy = 1; dy <= half; ++dy) {
    const int low = ClampInt(row - dy, 0, kMapSize_cells - 1);
    const int high = ClampInt(row + dy, 0, kMapSize_cells - 1);
    KeepSmallest(plane + low * kMapSize_cells, plane + high * kMapSize_cells, to);
  }
}

// What a cell's returns are held against.
struct Reference {
  int32_t ground_cm;
  int32_t obstacle_cm;   // an obstacle is higher than this above the ground ...
  int32_t clearance_cm;  // ... and does not begin higher than this above it
  bool ground_seen;      // otherwise every hard return that is not overhead is an obstacle
};

// The flags of one cell of a strip: kHard, kSoft or neither, kPerson, kObserved. Only the lowest
// and the highest hard return are known: whatever may lie between them counts as being there.
// Without branches, so that the time does not depend on the data and the loop vectorises; the
// differences mean nothing where there is no such return, and are not looked at then.
uint8_t CellFlags(const HeightGrid::Strip& strip, int i, const Reference& reference) {
  const int32_t ground_cm = reference.ground_cm;
  const bool any_hard = strip.highest_hard_cm[i] != HeightGrid::kNone;
  const bool overhead = strip.lowest_hard_cm[i] - ground_cm > reference.clearance_cm;
  const bool high = strip.highest_hard_cm[i] - ground_cm > reference.obstacle_cm;
  const bool person_seen = strip.person[i] != 0;
  const bool hard = any_hard & !overhead & (high | person_seen | !reference.ground_seen);
  const bool any_soft = strip.highest_soft_cm[i] != HeightGrid::kNone;
  const bool high_soft = strip.highest_soft_cm[i] - ground_cm > reference.obstacle_cm;
  const bool soft = any_soft & high_soft & !hard;
  const bool person = hard & person_seen;
  const bool observed = strip.lowest_cm[i] != HeightGrid::kNone;
  return static_cast<uint8_t>((hard ? Costmap::kHard : 0) | (soft ? Costmap::kSoft : 0) |
                              (person ? Costmap::kPerson : 0) |
                              (observed ? Costmap::kObserved : 0));
}

// dx^2 + the smaller of the elements dx to the left and to the right, saturated; in bytes: what is
// added to is first limited to what can still be added without a carry.
inline uint8_t PlusSquare(const uint8_t* center, int dx) {
  const uint8_t dx2 = static_cast<uint8_t>(dx * dx);
  const uint8_t limit = static_cast<uint8_t>(kFar2 - dx2);
  return static_cast<uint8_t>(Smaller(Smaller(center[-dx], center[dx]), limit) + dx2);
}

// out[x] = min over |dx| <= kReach of dx^2 + row[x + dx], saturated; the row has a margin of kReach
// on either side. Three distances a round, because each round reads and writes all of `out`.
template <int kReach>
void SmallestPlusSquare(const uint8_t* __restrict row, uint8_t* __restrict out) {
  static_assert(kReach % 3 == 0);
  CopyRow(row, out);
  HP_LOOP_BOUND(kReach / 3)
  for (int dx = 1; dx <= kReach; dx += 3) {
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) {
      const uint8_t* center = row + x;
      const uint8_t near = Smaller(PlusSquare(center, dx), PlusSquare(center, dx + 1));
      out[x] = Smaller(out[x], Smaller(near, PlusSquare(center, dx + 2)));
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
  pass_ = first_pass;
  row_ = 0;
  const float radius_cells = params.planning_radius_m * kCellsPerMeter;
  // A centre at the radius belongs to the region, also when the radius in float is a rounding less.
  constexpr float kRounding_cells2 = 0.001f;
  radius2_cells2_ = FloorToInt(radius_cells * radius_cells + kRounding_cells2);
  HP_LOOP_BOUND(kReach_cells)
  for (int x = 0; x < kReach_cells; ++x) {
    padded_[x] = kFar2;
    padded_[kReach_cells + kMapSize_cells + x] = kFar2;
    row_heights_[x] = UINT16_MAX;
    row_heights_[kReach_cells + kMapSize_cells + x] = UINT16_MAX;
  }
}

void CostmapBuilder::SetCell(int index, uint8_t flags) {
  HP_ASSERT(index >= 0 && index < kMapCells);
  HP_ASSERT(pass_ == kHeightPasses && row_ == 0);
  uint8_t kept = flags & kCellFlags;
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
  built_ = pass_ == kPasses;
}

// First half of the neighbourhood's lowest return and of whether ground was seen in it: along x.
void CostmapBuilder::LoadGround(const HeightGrid& heights) {
  const int half = params_.ground_window_cells / 2;
  uint16_t* lowest = row_heights_ + kReach_cells;
  uint8_t* unseen = padded_ + kReach_cells;
  HP_LOOP_BOUND(kMapSize_cells / kStrip)
  for (int start = 0; start < kMapSize_cells; start += kStrip) {
    heights.Read({map_.window.origin.x + start, map_.window.origin.y + row_}, strip_);
    HP_LOOP_BOUND(kStrip)
    for (int i = 0; i < kStrip; ++i) {
      lowest[start + i] = Biased(strip_.lowest_cm[i]);
      unseen[start + i] = strip_.ground[i] ^ 1;
    }
  }
  SmallestAlongRow(lowest, half, map_.cost_q8 + row_ * kMapSize_cells);
  SmallestAlongRow(unseen, half, plane_ + row_ * kMapSize_cells);
}

// Second half: along y; and the obstacle rule.
void CostmapBuilder::ClassifyRow(const HeightGrid& heights) {
  const int half = params_.ground_window_cells / 2;
  uint16_t* lowest = row_heights_ + kReach_cells;
  uint8_t* unseen = padded_ + kReach_cells;
  SmallestAcrossRows(map_.cost_q8, row_, half, lowest);
  SmallestAcrossRows(plane_, row_, half, unseen);

  const bool in_cell = params_.obstacle_rule == ObstacleRule::kInCell;
  const int32_t obstacle_cm = RoundToInt(params_.obstacle_height_m * kCentimetersPerMeter);
  const int32_t clearance_cm =
      in_cell ? INT32_MAX : RoundToInt(params_.clearance_height_m * kCentimetersPerMeter);
  uint8_t* flags = map_.flags + row_ * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells / kStrip)
  for (int start = 0; start < kMapSize_cells; start += kStrip) {
    heights.Read({map_.window.origin.x + start, map_.window.origin.y + row_}, strip_);
    HP_LOOP_BOUND(kStrip)
    for (int i = 0; i < kStrip; ++i) {
      const int32_t ground_cm = in_cell ? strip_.lowest_cm[i] : Unbiased(lowest[start + i]);
      const bool ground_seen = in_cell | (unseen[start + i] == 0);
      flags[start + i] = CellFlags(strip_, i, {ground_cm, obstacle_cm, clearance_cm, ground_seen});
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
    if (row_ == 0) FillCosts(hard);
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
  SmallestPlusSquare<kReach_cells>(padded, to_region2_);
  if (!inside) return;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    const uint8_t squared =
        distance[x] < kFar ? static_cast<uint8_t>(distance[x] * distance[x]) : kFar2;
    padded[x] = (flags[x] & region) != 0 ? squared : uint8_t{0};
  }
  SmallestPlusSquare<kReach_cells>(padded, out_of_region2_);
}

void CostmapBuilder::Dilate(int row, bool hard) {
  uint8_t* flags = map_.flags + row * kMapSize_cells;
  const uint8_t dilated = hard ? Costmap::kLethal : Costmap::kSoftRegion;
  const int32_t radius2_cells2 = radius2_cells2_;
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
}

void CostmapBuilder::AddCosts(int row, bool hard) {
  uint16_t* cost_q8 = map_.cost_q8 + row * kMapSize_cells;
  // The hard layer comes first and takes the place of the heights.
  const uint16_t keep = hard ? 0 : UINT16_MAX;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) {
    // One of the two distances is 0, and so is its cost.
    const int layer_q8 = halo_q8_[to_region2_[x]] + depth_q8_[out_of_region2_[x]];
    cost_q8[x] = static_cast<uint16_t>((cost_q8[x] & keep) + layer_q8);
  }
  if (!hard) return;
  uint8_t* hard_depth2 = map_.hard_depth2 + row * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells)
  for (int x = 0; x < kMapSize_cells; ++x) hard_depth2[x] = out_of_region2_[x];
}

}  // namespace hardpack
