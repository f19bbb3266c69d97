// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"

#include "config/validate.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// An end heading further off than this is turned to on the spot.
constexpr float kGoalHeadingTolerance_rad = 0.05f;

// What a cell is, as opposed to what its surroundings make of it.
constexpr uint8_t kCellFlags =
    Costmap::kHard | Costmap::kSoft | Costmap::kPerson | Costmap::kObserved;
static_assert(kCellFlags < 16, "two cells to a byte");

// Copied from, since a temporary would not fit on the stack.
constexpr Plan kNoPlan;

// Statuses are numbered by gravity.
Status Graver(Status a, Status b) {
  return a < b ? b : a;
}

float NarrowRadius(const VehicleParams& vehicle) {
  return vehicle.footprint_disc_radius_m + 0.5f * kCellDiagonal_m;
}

Vec2 PlaceOf(const Pose2& pose) {
  return {pose.x_m, pose.y_m};
}

// Each by itself, and those of the costmap together. What else must go together the stages say when
// they begin.
Status CheckParams(const PlannerParams& params) {
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  return CheckCostmapParams(params.costmap);
}

Status CheckRequest(const PlanRequest& request) {
  const PathStart& start = request.start;
  const bool finite = IsFinite(start.pose) && IsFinite(start.curvature_per_m) &&
                      IsFinite(start.speed_mps) && IsFinite(request.goal_odom.x_m) &&
                      IsFinite(request.goal_odom.y_m) &&
                      (!request.has_goal_heading || IsFinite(request.goal_heading_rad));
  if (!finite) return Status::kNotFinite;
  const bool fits = start.speed_mps >= 0.0f && start.speed_mps <= kMaxRequestSpeed_mps &&
                    Abs(start.curvature_per_m) <= kCurvatureCeiling_per_m;
  return fits ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace

Status Planner::Begin(const HeightGrid& heights, const PlannerParams& params,
                      const PlanRequest& request) {
  Status status = Prepare(params, request);
  if (IsUsable(status)) status = builder_.Begin(heights, params.costmap);
  return Started(status);
}

Status Planner::BeginCells(const GridWindow& window, const PlannerParams& params,
                           const PlanRequest& request) {
  Status status = Prepare(params, request);
  if (IsUsable(status)) status = builder_.BeginCells(window, params.costmap);
  return Started(status);
}

Status Planner::Started(Status status) {
  if (IsUsable(status)) {
    stage_ = PlanStage::kCostmap;
  } else {
    plan_.status = status;
  }
  return status;
}

Status Planner::Prepare(const PlannerParams& params, const PlanRequest& request) {
  stage_ = PlanStage::kIdle;
  plan_ = kNoPlan;
  const Status status = Graver(CheckParams(params), CheckRequest(request));
  if (!IsUsable(status)) return status;
  params_ = params;
  request_ = request;
  request_.start.pose.theta_rad = WrapAngle(request.start.pose.theta_rad);
  map_phase_ = MapPhase::kBuild;
  map_row_ = 0;
  keeps_end_heading_ = false;
  has_goal_heading_ = false;
  return Status::kOk;
}

Progress Planner::Step(const HeightGrid& heights, int units) {
  return Run(&heights, units);
}

Progress Planner::StepCells(int units) {
  return Run(nullptr, units);
}

Progress Planner::Run(const HeightGrid* heights, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int left = units; left > 0; left -= kPortion_units) {
    if (stage_ == PlanStage::kIdle || stage_ == PlanStage::kDone) break;
    StepStage(heights, left < kPortion_units ? left : kPortion_units);
  }
  return stage_ == PlanStage::kIdle || stage_ == PlanStage::kDone ? Progress::kDone
                                                                  : Progress::kBusy;
}

void Planner::StepStage(const HeightGrid* heights, int units) {
  switch (stage_) {
    case PlanStage::kCostmap:
      return StepCostmap(heights, units);
    case PlanStage::kSearch:
      return StepSearch(units);
    case PlanStage::kSample:
      return StepSample(units);
    case PlanStage::kOptimize:
      return StepOptimize(units);
    case PlanStage::kCheck:
      return StepCheck(units);
    case PlanStage::kSpeed:
      return StepSpeed(units);
    case PlanStage::kIdle:
    case PlanStage::kDone:
      return;
  }
}

// The narrow try keeps the cells and builds anew from them: the grid may have moved on meanwhile.
void Planner::StepCostmap(const HeightGrid* heights, int units) {
  switch (map_phase_) {
    case MapPhase::kBuild: {
      const Progress progress =
          heights != nullptr ? builder_.Step(*heights, units) : builder_.StepCells(units);
      if (progress == Progress::kDone) BeginSearch();
      return;
    }
    case MapPhase::kKeep:
      HP_LOOP_BOUND(kPortion_units)
      for (int unit = 0; unit < units && map_phase_ == MapPhase::kKeep; ++unit) KeepRow();
      return;
    case MapPhase::kRestore:
      HP_LOOP_BOUND(kPortion_units)
      for (int unit = 0; unit < units && map_phase_ == MapPhase::kRestore; ++unit) RestoreRow();
      return;
    case MapPhase::kRebuild:
      if (builder_.StepCells(units) == Progress::kDone) BeginSearch();
      return;
  }
}

void Planner::KeepRow() {
  const int first = map_row_ * kMapSize_cells;
  const uint8_t* flags = costmap().flags + first;
  HP_LOOP_BOUND(kMapSize_cells / 2)
  for (int i = 0; i < kMapSize_cells / 2; ++i) {
    kept_flags_[first / 2 + i] =
        static_cast<uint8_t>((flags[2 * i] & kCellFlags) | (flags[2 * i + 1] & kCellFlags) << 4);
  }
  if (++map_row_ < kMapSize_cells) return;
  CostmapParams narrow = params_.costmap;
  narrow.planning_radius_m = NarrowRadius(params_.vehicle);
  const Status status = builder_.BeginCells(costmap().window, narrow);
  if (!IsUsable(status)) return Fail(status);
  map_row_ = 0;
  map_phase_ = MapPhase::kRestore;
}

void Planner::RestoreRow() {
  const int first = map_row_ * kMapSize_cells;
  HP_LOOP_BOUND(kMapSize_cells / 2)
  for (int i = 0; i < kMapSize_cells / 2; ++i) {
    const uint8_t two = kept_flags_[first / 2 + i];
    builder_.SetCell(first + 2 * i, two & kCellFlags);
    builder_.SetCell(first + 2 * i + 1, two >> 4);
  }
  if (++map_row_ == kMapSize_cells) map_phase_ = MapPhase::kRebuild;
}

void Planner::BeginSearch() {
  stage_ = PlanStage::kSearch;
  plan_.base_status =
      search_.Begin(costmap(), params_.astar, PlaceOf(request_.start.pose), request_.goal_odom);
}

void Planner::StepSearch(int units) {
  if (search_.Step(costmap(), units) == Progress::kBusy) return;
  plan_.search = search_.result();
  plan_.base_status = plan_.search.status;
  if (MayTryNarrow()) {
    plan_.narrow = true;
    stage_ = PlanStage::kCostmap;
    map_phase_ = MapPhase::kKeep;
    return;
  }
  if (!IsUsable(plan_.base_status)) return Fail(plan_.base_status);
  plan_.base_status =
      sampler_.Begin(search_, params_.path, PlaceOf(request_.start.pose), request_.goal_odom);
  if (!IsUsable(plan_.base_status)) return Fail(plan_.base_status);
  stage_ = PlanStage::kSample;
}

bool Planner::MayTryNarrow() const {
  const bool closed =
      plan_.base_status == Status::kNoPath || plan_.base_status == Status::kStartEnclosed;
  return closed && !plan_.narrow &&
         NarrowRadius(params_.vehicle) < params_.costmap.planning_radius_m;
}

void Planner::StepSample(int units) {
  if (sampler_.Step(search_, units) == Progress::kBusy) return;
  plan_.base_status = Graver(plan_.search.status, sampler_.status());
  if (!IsUsable(plan_.base_status)) return Fail(plan_.base_status);
  plan_.base = sampler_.result();
  has_goal_heading_ = request_.has_goal_heading && !plan_.search.partial &&
                      !plan_.search.goal_outside_map && sampler_.status() == Status::kOk;
  const float error_rad = WrapAngle(request_.start.pose.theta_rad - BaseHeading(plan_.base));
  plan_.pivots_first = Abs(error_rad) > params_.path.max_join_heading_rad;
  if (plan_.pivots_first &&
      !PivotIsFree(costmap(), params_.vehicle, params_.path, PlaceOf(request_.start.pose))) {
    return Fail(Status::kPivotBlocked);
  }
  BeginSeed();
}

void Planner::BeginSeed() {
  MakeSeed();
  const float curvature_per_m = plan_.pivots_first ? 0.0f : request_.start.curvature_per_m;
  plan_.optimizer_status = optimizer_.Begin(costmap(), params_.optimizer, params_.path, seed_,
                                            curvature_per_m, keeps_end_heading_);
  if (!IsUsable(plan_.optimizer_status)) return Fail(plan_.optimizer_status);
  stage_ = PlanStage::kOptimize;
}

// The base path joined to the heading that the vehicle has, or will have turned to, and where it
// can be to the goal's heading. The start comes last, so that it is exact on a short path too. What
// cannot be joined at the end is turned on the spot there.
void Planner::MakeSeed() {
  const float heading_rad =
      plan_.pivots_first ? BaseHeading(plan_.base) : request_.start.pose.theta_rad;
  if (has_goal_heading_) {
    const Status end =
        JoinEnd(plan_.base, params_.path, params_.optimizer, request_.goal_heading_rad, seed_);
    keeps_end_heading_ = IsUsable(end) && IsUsable(JoinStart(seed_, params_.path, params_.optimizer,
                                                             heading_rad, seed_));
    if (keeps_end_heading_) return;
  }
  // A failure leaves the seed empty, which the optimizer reports.
  static_cast<void>(JoinStart(plan_.base, params_.path, params_.optimizer, heading_rad, seed_));
}

void Planner::StepOptimize(int units) {
  if (optimizer_.Step(costmap(), units) == Progress::kBusy) return;
  plan_.optimizer_status = optimizer_.result().status;
  plan_.cost_before = optimizer_.result().before;
  plan_.cost_after = optimizer_.result().after;
  plan_.is_seed = false;
  MakePath(optimizer_.path());
  BeginCheck();
}

// `driven` with the turns on the spot before and behind it.
void Planner::MakePath(const WorldPath& driven) {
  WorldPath& path = plan_.path;
  path.Clear();
  plan_.ends_short = false;
  if (plan_.pivots_first) {
    path.Resize(1);
    path[0] = {driven[0].x_m, driven[0].y_m, request_.start.pose.theta_rad};
  }
  const int room = WorldPath::capacity() - path.size();
  const int kept = driven.size() < room ? driven.size() : room;
  if (kept < driven.size()) plan_.base_status = Graver(plan_.base_status, Status::kPathCut);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < kept; ++k) {
    path.Resize(path.size() + 1);
    path.back() = driven[k];
  }
  const float end_error_rad = WrapAngle(request_.goal_heading_rad - path.back().theta_rad);
  plan_.pivots_last = has_goal_heading_ && kept == driven.size() && !path.full() &&
                      Abs(end_error_rad) > kGoalHeadingTolerance_rad;
  if (plan_.pivots_last) {
    path.Resize(path.size() + 1);
    path.back() = {driven.back().x_m, driven.back().y_m, WrapAngle(request_.goal_heading_rad)};
  }
}

void Planner::BeginCheck() {
  Status status = ToActuator<PlanarModel>(plan_.path, plan_.actuator);
  if (IsUsable(status)) {
    status = check_.Begin(params_.vehicle, params_.optimizer, plan_.path,
                          request_.start.curvature_per_m);
  }
  if (!IsUsable(status)) return Fail(status);
  stage_ = PlanStage::kCheck;
}

void Planner::StepCheck(int units) {
  if (check_.Step(costmap(), plan_.path, units) == Progress::kBusy) return;
  plan_.check = check_.result();
  plan_.check_status = plan_.check.status;
  if (plan_.check_status == Status::kCollision) return TryAgain();
  if (!IsUsable(plan_.check_status)) return Fail(plan_.check_status);
  stage_ = PlanStage::kSpeed;
  caps_.Begin(costmap().window, params_.speed, params_.vehicle, plan_.path);
}

bool Planner::MayEndShort() const {
  const int kept = plan_.check.collision_point;
  if (plan_.ends_short || kept < 2) return false;
  float rest_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = kept; k < plan_.actuator.steps.size(); ++k) {
    rest_m += Abs(plan_.actuator.steps[k].dr_m);
  }
  return rest_m <= kMaxShort_m;
}

// The point that the collision was met at stays, but without the turn towards what lies behind it.
void Planner::EndShort() {
  WorldPath& path = plan_.path;
  path.Resize(plan_.check.collision_point + 1);
  if (!HasLength(plan_.actuator.steps[path.size() - 2].dr_m)) path.Resize(path.size() - 1);
  path.back().theta_rad = path[path.size() - 2].theta_rad;
  plan_.pivots_last = false;
  plan_.ends_short = true;
}

void Planner::TryAgain() {
  if (MayEndShort()) {
    EndShort();
    return BeginCheck();
  }
  if (!plan_.is_seed) {
    plan_.is_seed = true;
    plan_.cost_after = plan_.cost_before;
    MakePath(seed_);
    return BeginCheck();
  }
  const bool may_turn =
      !plan_.pivots_first && request_.start.speed_mps == 0.0f &&
      PivotIsFree(costmap(), params_.vehicle, params_.path, PlaceOf(request_.start.pose));
  if (!may_turn) return Fail(Status::kCollision);
  plan_.pivots_first = true;
  BeginSeed();
}

void Planner::StepSpeed(int units) {
  if (caps_.Step(costmap(), params_.speed, params_.vehicle, plan_.path, units) == Progress::kBusy) {
    return;
  }
  SpeedRequest request;
  request.start_speed_mps = request_.start.speed_mps;
  request.start_curvature_per_m = request_.start.curvature_per_m;
  request.slow_points = SlowPoints();
  request.narrow = plan_.narrow;
  request.cap_mps = caps_.cap_mps();
  const Status status =
      PlanSpeed(params_.speed, params_.vehicle, plan_.actuator, request, plan_.speed);
  if (!IsUsable(status)) return Fail(status);
  Finish();
}

// The stretch from a start in an obstacle to the first point that is clear of it, which is within
// it still; the footprint's own overlap may last longer than the middle's.
int Planner::SlowPoints() const {
  if (!plan_.search.start_in_obstacle) return plan_.check.overlap_points;
  const Costmap& map = costmap();
  int clear = 0;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (clear < plan_.path.size() &&
         map.Lethal(map.window.Index(CellAt(PlaceOf(plan_.path[clear]))))) {
    ++clear;
  }
  return clear + 1 < plan_.check.overlap_points ? plan_.check.overlap_points : clear + 1;
}

void Planner::Finish() {
  plan_.status = Graver(plan_.base_status, Graver(plan_.optimizer_status, plan_.check_status));
  if (plan_.ends_short) plan_.status = Graver(plan_.status, Status::kGoalMoved);
  if (plan_.narrow) plan_.status = Graver(plan_.status, Status::kNarrowGap);
  stage_ = PlanStage::kDone;
}

void Planner::Fail(Status status) {
  plan_.status = status;
  stage_ = PlanStage::kDone;
}

}  // namespace hardpack
