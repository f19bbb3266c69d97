// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/costmap.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// What a cell holds, as opposed to what its surroundings make of it.
constexpr uint8_t kCellFlags = Costmap::kHard | Costmap::kSoft | Costmap::kPerson |
                               Costmap::kObserved | Costmap::kGrowth | Costmap::kClosed;

// What of a cell's flags is given, made to agree: a person is hard, a hard cell is not soft, and an
// obstacle was observed.
uint8_t Consistent(uint8_t flags) {
  uint8_t kept = flags & kCellFlags;
  if ((kept & Costmap::kPerson) != 0) kept |= Costmap::kHard;
  if ((kept & Costmap::kHard) != 0) {
    kept &= static_cast<uint8_t>(~(Costmap::kSoft | Costmap::kGrowth));
  }
  if ((kept & (Costmap::kHard | Costmap::kSoft)) != 0) kept |= Costmap::kObserved;
  return kept;
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
  constexpr float kMaxTerrainCost = 1000.0f;
  const bool rule_known = params.obstacle_rule == ObstacleRule::kInCell ||
                          params.obstacle_rule == ObstacleRule::kLocalGround;
  const bool heights_fit = Within(params.obstacle_height_m, 0.0f, kMaxHeight_m) &&
                           Within(params.growth_height_m, 0.0f, kMaxHeight_m) &&
                           Within(params.clearance_height_m, 0.0f, kMaxHeight_m) &&
                           params.growth_height_m >= params.obstacle_height_m &&
                           params.clearance_height_m > params.growth_height_m;
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
  const float near = params.near_unknown_cost;
  const bool costs_fit = params.hard_edge_cost >= 0.0f && params.hard_slope_per_m >= 0.0f &&
                         params.soft_edge_cost >= 0.0f && params.soft_slope_per_m >= 0.0f &&
                         hard <= kMaxCost && soft <= kMaxCost && Within(unknown, 0.0f, kMaxCost) &&
                         Within(near, 0.0f, kMaxCost) &&
                         Quantized(hard) + Quantized(soft) + Quantized(unknown) <= kMaxCost_q8;
  const bool terrain_fits = Within(params.max_grade, 0.0f, Terrain::kMaxGrade) &&
                            Within(params.free_grade, 0.0f, Terrain::kMaxGrade) &&
                            Within(params.grade_cost, 0.0f, kMaxTerrainCost) &&
                            Within(params.free_roughness_m, 0.0f, kMaxHeight_m) &&
                            Within(params.roughness_cost_per_m, 0.0f, kMaxTerrainCost);
  if (!terrain_fits) return Status::kParameterOutOfRange;
  return costs_fit ? Status::kOk : Status::kParameterOutOfRange;
}

Status CostmapBuilder::Begin(const HeightGrid& heights, const CostmapParams& params) {
  const Status status = CheckCostmapParams(params);
  if (status != Status::kOk) return status;
  Start(heights.window(), params, Pass::kHeights);
  return Status::kOk;
}

void CostmapBuilder::SetLidar(const NearUnknownParams& params) {
  HP_ASSERT(row_ == 0 && (pass_ == Pass::kHeights || pass_ == Pass::kObstacles));
  near_.Begin(map_.window, params);
}

Status CostmapBuilder::BeginCells(const GridWindow& window, const CostmapParams& params) {
  const Status status = CheckCostmapParams(params);
  if (status != Status::kOk) return status;
  Start(window, params, Pass::kObstacles);
  HP_LOOP_BOUND(kMapCells)
  for (uint8_t& flags : map_.flags) flags = Costmap::kObserved;
  return Status::kOk;
}

void CostmapBuilder::Start(const GridWindow& window, const CostmapParams& params, Pass first) {
  refused_ = 0;
  near_.Begin(window, {});
  map_.window = window;
  params_ = params;
  from_heights_ = first == Pass::kHeights;
  pass_ = first;
  row_ = 0;
  near_cost_q8_ = static_cast<uint16_t>(Quantized(params.near_unknown_cost));
  const float radius_cells = params.planning_radius_m * kCellsPerMeter;
  // A centre at the radius belongs to the region, also when the radius in float is a rounding less.
  constexpr float kRounding_cells2 = 0.001f;
  radius2_cells2_ = FloorToInt(radius_cells * radius_cells + kRounding_cells2);
  FillChord();
  lowest_.FillMargins();
  ground_.FillMargins();
  soft_row_.FillMargins();
  HP_LOOP_BOUND(kPaddedRows)
  for (auto& row : padded_) row.FillMargins();
  if (from_heights_) {
    terrain_.Begin(params);
    StartHeights();
  }
}

void CostmapBuilder::SetCell(int index, uint8_t flags) {
  HP_ASSERT(index >= 0 && index < kMapCells);
  HP_ASSERT(!from_heights_ && pass_ == Pass::kObstacles && row_ == 0);
  map_.flags[index] =
      Consistent(static_cast<uint8_t>(flags & ~(Costmap::kGrowth | Costmap::kClosed)));
}

void CostmapBuilder::Mark(int index, uint8_t flags) {
  HP_ASSERT(index >= 0 && index < kMapCells);
  HP_ASSERT(from_heights_ && pass_ == Pass::kObstacles && row_ == 0);
  constexpr uint8_t kObstacles = Costmap::kHard | Costmap::kSoft | Costmap::kPerson;
  map_.flags[index] = Consistent(static_cast<uint8_t>(map_.flags[index] | (flags & kObstacles)));
}

void CostmapBuilder::CloseCells(int row, std::span<const uint32_t, kRowWords> closed) {
  HP_ASSERT(row >= 0 && row < kMapSize_cells);
  HP_ASSERT(pass_ == Pass::kObstacles && row_ == 0);
  constexpr uint32_t kWordBits = 32;
  uint8_t* flags = &map_.flags[row * kMapSize_cells];
  HP_LOOP_BOUND(kRowWords)
  for (const uint32_t word : closed) {
    HP_LOOP_BOUND(kWordBits)
    for (uint32_t bit = 0; bit < kWordBits; ++bit) {
      constexpr uint8_t kMarks = Costmap::kHard | Costmap::kClosed;
      const auto marks = static_cast<uint8_t>(((word >> bit) & 1u) * kMarks);
      flags[bit] = Consistent(flags[bit] | marks);
    }
    flags += kWordBits;
  }
}

// As deep as can be: the way out of where the vehicle starts does not lead through them either.
void CostmapBuilder::Refuse(Cell middle, int radius_cells) {
  HP_ASSERT(pass_ == Pass::kDone && radius_cells >= 0 && radius_cells <= kMaxRefused_cells);
  HP_ASSERT(refused_ < kMaxRefused);
  constexpr uint8_t kDeepest2_cells2 = 255;
  uint8_t* saved = plane_ + refused_ * kSavedBytes;
  const auto close = [this, &saved](int index, bool is_within) {
    saved[0] = map_.flags[index];
    saved[1] = map_.hard_depth2[index];
    saved += 2;
    if (!is_within) return;
    map_.flags[index] = static_cast<uint8_t>(map_.flags[index] | Costmap::kLethal);
    map_.hard_depth2[index] = kDeepest2_cells2;
  };
  ForRefused(middle, radius_cells, close);
  refused_middle_[refused_] = middle;
  refused_cells_[refused_] = radius_cells;
  ++refused_;
}

// The last first: what one of them saved may be what another had closed.
void CostmapBuilder::ForgetRefused() {
  HP_LOOP_BOUND(kMaxRefused)
  while (refused_ > 0) {
    --refused_;
    const uint8_t* saved = plane_ + refused_ * kSavedBytes;
    const auto open = [this, &saved](int index, bool) {
      map_.flags[index] = saved[0];
      map_.hard_depth2[index] = saved[1];
      saved += 2;
    };
    ForRefused(refused_middle_[refused_], refused_cells_[refused_], open);
  }
}

// The cells of the square around it that are on the map, and whether they are within the circle.
template <typename Function>
void CostmapBuilder::ForRefused(Cell middle, int radius_cells, const Function& function) {
  HP_LOOP_BOUND(kRefusedSide_cells)
  for (int dy = -radius_cells; dy <= radius_cells; ++dy) {
    HP_LOOP_BOUND(kRefusedSide_cells)
    for (int dx = -radius_cells; dx <= radius_cells; ++dx) {
      const Cell cell = {middle.x + dx, middle.y + dy};
      if (!map_.window.Contains(cell)) continue;
      function(map_.window.Index(cell), dx * dx + dy * dy <= radius_cells * radius_cells);
    }
  }
}

Progress CostmapBuilder::Step(const HeightGrid& heights, int units) {
  HP_LOOP_BOUND(kUnits)
  for (int left = units; left > 0 && pass_ != Pass::kDone; --left) {
    if (pass_ == Pass::kHeights) {
      HeightUnit(heights);
    } else {
      CellUnit();
    }
    EndUnit();
  }
  return pass_ == Pass::kDone ? Progress::kDone : Progress::kBusy;
}

Progress CostmapBuilder::StepHeights(const HeightGrid& heights, int units) {
  HP_LOOP_BOUND(kHeightUnits)
  for (int left = units; left > 0 && pass_ == Pass::kHeights; --left) {
    HeightUnit(heights);
    EndUnit();
  }
  return pass_ == Pass::kHeights ? Progress::kBusy : Progress::kDone;
}

Progress CostmapBuilder::StepCells(int units) {
  HP_ASSERT(pass_ != Pass::kHeights);
  HP_LOOP_BOUND(kCellUnits)
  for (int left = units; left > 0 && pass_ != Pass::kDone; --left) {
    CellUnit();
    EndUnit();
  }
  return pass_ == Pass::kDone ? Progress::kDone : Progress::kBusy;
}

int CostmapBuilder::UnitsOfPass() const {
  if (pass_ == Pass::kHeights) return kHeightUnits;
  return pass_ == Pass::kTerrain ? kTerrainUnits : kMapSize_cells;
}

void CostmapBuilder::EndUnit() {
  if (++row_ < UnitsOfPass()) return;
  row_ = 0;
  pass_ = static_cast<Pass>(static_cast<int>(pass_) + 1);
}

// The layers' costs by squared distance between cell centres: the edge lies half a cell before the
// nearest centre on the other side. One squared distance of one layer; kLayers * kDistances2
// entries.
void CostmapBuilder::FillCost(int entry) {
  const bool hard = entry < kDistances2;
  const int distance2 = entry % kDistances2;
  const float edge_cost = hard ? params_.hard_edge_cost : params_.soft_edge_cost;
  const float slope_per_m = hard ? params_.hard_slope_per_m : params_.soft_slope_per_m;
  // No cell has the distance 0, for which a halo of next to nothing would be divided by.
  const float s_m = Max((Sqrt(static_cast<float>(distance2)) - 0.5f) * kCellSize_m, 0.0f);
  const float halo = HaloCost(s_m, edge_cost, params_.halo_m);
  const float inside = InsideCost(s_m, edge_cost, slope_per_m, params_.planning_radius_m);
  const int halo_q8 = Quantized(halo);
  const int inside_q8 = Quantized(inside);
  if (!hard) {
    soft_cost_q8_[distance2] = static_cast<uint16_t>(halo_q8);
    soft_cost_q8_[kDistances2 + distance2] = static_cast<uint16_t>(inside_q8);
    return;
  }
  const int unknown_q8 = Quantized(params_.unknown_cost);
  hard_cost_q8_[distance2] = static_cast<uint16_t>(halo_q8 + unknown_q8);
  hard_cost_q8_[kDistances2 + distance2] = static_cast<uint16_t>(inside_q8 + unknown_q8);
  hard_cost_q8_[2 * kDistances2 + distance2] = static_cast<uint16_t>(halo_q8);
  hard_cost_q8_[3 * kDistances2 + distance2] = static_cast<uint16_t>(inside_q8);
}

}  // namespace hardpack
