// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"

#include "config/conflicts.h"
#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/validate.h"
#include "core/kinematics/kinematics.h"

namespace hardpack {
namespace {

// Copied from, since a temporary would not fit on the stack.
constexpr Plan kNoPlan;

Status CheckRequest(const PlanRequest& request) {
  const PathStart& start = request.start;
  const bool finite = IsFinite(start.pose) && IsFinite(start.curvature_per_m) &&
                      IsFinite(start.speed_mps) && IsFinite(request.goal_odom) &&
                      IsFinite(request.near_unknown.lidar_odom) &&
                      (!request.has_goal_heading || IsFinite(request.goal_heading_rad));
  if (!finite) return Status::kNotFinite;
  const bool fits =
      start.speed_mps >= 0.0f && start.speed_mps <= kMaxRequestSpeed_mps &&
      Abs(start.curvature_per_m) <= kCurvatureCeiling_per_m &&
      Max(Abs(start.pose.x_m), Abs(start.pose.y_m)) <= kMaxRequestPosition_m &&
      Abs(start.pose.theta_rad) <= kSinCosMaxAngle_rad && request.near_unknown.reach_m >= 0.0f &&
      request.near_unknown.half_width_m >= 0.0f &&
      (!request.has_goal_heading || Abs(request.goal_heading_rad) <= kSinCosMaxAngle_rad);
  return fits ? CheckRoute(request.route) : Status::kInvalidArgument;
}

}  // namespace

Status CheckPlannerParams(const PlannerParams& params) {
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  return FirstConflict(params).name != nullptr ? Status::kParameterOutOfRange
                                               : CheckCostmapParams(params.costmap);
}

Status Planner::Begin(const Mapper& mapper, const PlannerParams& params,
                      const PlanRequest& request) {
  if (mapper.has_seen()) {
    folded_before_ = mapper.fold_count();
    return BeginOn(mapper.heights(), params, request);
  }
  plan_ = kNoPlan;
  stage_ = PlanStage::kIdle;
  return Started(Status::kNotStarted, PlanStage::kIdle);
}

Status Planner::Begin(const HeightGrid& heights, const PlannerParams& params,
                      const PlanRequest& request) {
  return BeginOn(heights, params, request);
}

Status Planner::BeginOn(const HeightGrid& heights, const PlannerParams& params,
                        const PlanRequest& request) {
  Status status = Prepare(params, request);
  if (IsUsable(status)) status = builder_.Begin(heights, params_.costmap);
  if (IsUsable(status)) builder_.SetLidar(request_.near_unknown);
  pending_slot_ = 0;
  return Started(status, PlanStage::kHeights);
}

Status Planner::BeginCells(const GridWindow& window, const PlannerParams& params,
                           const PlanRequest& request) {
  Status status = Prepare(params, request);
  if (IsUsable(status)) status = builder_.BeginCells(window, params_.costmap);
  if (IsUsable(status)) builder_.SetLidar(request_.near_unknown);
  return Started(status, PlanStage::kCostmap);
}

Status Planner::BeginOnMap(const PlanRequest& request) {
  if (stage_ != PlanStage::kDone) return Status::kNotStarted;
  const Status status = Prepare(params_, request);
  if (!IsUsable(status)) return Started(status, PlanStage::kIdle);
  builder_.ForgetRefused();  // by the plan before
  BeginSearch();
  return Status::kOk;
}

Status Planner::Started(Status status, PlanStage first) {
  if (IsUsable(status)) {
    stage_ = first;
  } else {
    plan_.status = status;
  }
  return status;
}

Status Planner::Prepare(const PlannerParams& params, const PlanRequest& request) {
  stage_ = PlanStage::kIdle;
  plan_ = kNoPlan;
  const Status status = Graver(CheckPlannerParams(params), CheckRequest(request));
  if (!IsUsable(status)) return status;
  params_ = params;
  params_.costmap.planning_radius_m = PlanningRadius(params.costmap, params.vehicle, params.path);
  params_.optimizer.max_curvature_per_m = Min(
      params.optimizer.max_curvature_per_m, kPlannedCurvatureShare * MostCurvature(params.vehicle));
  request_ = request;
  request_.start.pose.theta_rad = WrapAngle(request.start.pose.theta_rad);
  keeps_end_heading_ = false;
  has_goal_heading_ = false;
  lead_.Clear();
  own_start_ = request_.start;
  led_out_ = false;
  is_to_seed_ = false;
  looks_back_ = false;
  moves_ = Moves::kNone;
  from_goal_ = false;
  has_blocked_ = false;
  lead_failure_ = Status::kNotStarted;
  area_ = 0;
  area_row_ = 0;
  return Status::kOk;
}

Progress Planner::Step(const Mapper& mapper, int units, const AreaSet* areas) {
  return Run({&mapper.heights(), &mapper, areas}, units);
}

Progress Planner::Step(const HeightGrid& heights, int units, const AreaSet* areas) {
  return Run({&heights, nullptr, areas}, units);
}

Progress Planner::StepCells(int units, const AreaSet* areas) {
  return Run({nullptr, nullptr, areas}, units);
}

Progress Planner::Run(const Source& source, int units) {
  if (units > 0) StepStage(source, units < kPortion_units ? units : kPortion_units);
  return stage_ == PlanStage::kIdle || stage_ == PlanStage::kDone ? Progress::kDone
                                                                  : Progress::kBusy;
}

void Planner::StepStage(const Source& source, int units) {
  switch (stage_) {
    case PlanStage::kHeights:
      return StepHeights(source, units);
    case PlanStage::kPending:
      return StepPending(source, units);
    case PlanStage::kCostmap:
      return StepCostmap(source, units);
    case PlanStage::kSearch:
      return StepSearch(units);
    case PlanStage::kSample:
      return StepSample(units);
    case PlanStage::kLeadOut:
      return StepLeadOut(units);
    case PlanStage::kManoeuvre:
      return StepManoeuvre(units);
    case PlanStage::kOptimize:
      return StepOptimize(units);
    case PlanStage::kCheck:
      return StepCheck(units);
    case PlanStage::kSpeed:
      return StepSpeed(source, units);
    case PlanStage::kIdle:
    case PlanStage::kDone:
      return;
  }
}

void Planner::StepHeights(const Source& source, int units) {
  HP_ASSERT(source.heights != nullptr);
  if (builder_.StepHeights(*source.heights, units) == Progress::kBusy) return;
  stage_ = source.mapper != nullptr ? PlanStage::kPending : PlanStage::kCostmap;
}

// What is not in the heights that were classed: pending columns, and those folded since, whose
// cells may have been classed before.
void Planner::StepPending(const Source& source, int units) {
  HP_ASSERT(source.mapper != nullptr);
  const int slots = source.mapper->ring().slots();
  HP_LOOP_BOUND(kPortion_units)
  for (int unit = 0; unit < units && pending_slot_ < slots; ++unit, ++pending_slot_) {
    source.mapper->MarkPending(pending_slot_, folded_before_, builder_);
  }
  if (pending_slot_ >= slots) stage_ = PlanStage::kCostmap;
}

void Planner::StepCostmap(const Source& source, int units) {
  if (source.areas != nullptr && area_ < source.areas->size()) {
    CloseAreas(*source.areas, units);
  } else if (builder_.StepCells(units) == Progress::kDone) {
    BeginSearch();
  }
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void Planner::CloseAreas(const AreaSet& areas, int units) {
  int left = units;
  HP_LOOP_BOUND(kPortion_units + kMaxAreas)
  while (area_ < areas.size()) {
    const Area& area = areas[area_];
    RowRange rows;
    const bool closes = area.kind != AreaKind::kSpeedZone && areas.HasPlace(area_);
    if (closes) rows = RowsOf(area, costmap().window);
    const int row = rows.first + area_row_;
    if (row > rows.last) {
      ++area_;
      area_row_ = 0;
      continue;
    }
    if (left <= 0) return;
    builder_.CloseCells(row, ClosedCells(area, costmap().window, row).word);
    ++area_row_;
    --left;
  }
}

void Planner::BeginSearch() {
  from_goal_ = false;
  shortened_ = false;
  cuts_ = 0;
  plan_.base.Clear();
  leg_ = 0;
  const Vec2 start = PlaceOf(request_.start.pose);
  HP_LOOP_BOUND(kMaxVias)
  while (leg_ < request_.route.vias.size() && AreWithin(PlaceAt(leg_), start, kHere_m)) {
    ++leg_;
  }
  first_leg_ = leg_;
  plan_.target = leg_;
  if (IsHere()) return Stay();
  if (request_.lead_out > 0 && BeginLeadOut(Status::kOk)) return;
  BeginLeg(start);
}

void Planner::StepSearch(int units) {
  if (search_.Step(costmap(), kSearchUnits * units) == Progress::kBusy) return;
  if (from_goal_) return EndWay();
  const AstarResult& found = search_.result();
  if (leg_ > first_leg_) {
    if (!IsUsable(found.status) || !IsUsable(BeginSample())) EndLegs();
    return;
  }
  KeepSearch();
  plan_.starts_in_obstacle = plan_.search.start_in_obstacle;
  plan_.base_status = plan_.search.status;
  if (!IsUsable(plan_.base_status)) {
    const bool is_enclosed = plan_.search.start_in_obstacle;
    if (moves_ == Moves::kWay) return BeginFromGoal();
    if (is_enclosed && BeginLeadOut(plan_.base_status)) return;
    return Fail(plan_.base_status);
  }
  plan_.base_status = BeginSample();
  if (!IsUsable(plan_.base_status)) return Fail(plan_.base_status);
}

// Field by field: a compiler may copy the whole in a loop, which has no record.
void Planner::KeepSearch() {
  const AstarResult& found = search_.result();
  AstarResult& kept = plan_.search;
  kept.status = found.status;
  kept.goal_outside_map = found.goal_outside_map;
  kept.goal_moved = found.goal_moved;
  kept.start_in_obstacle = found.start_in_obstacle;
  kept.partial = found.partial;
  kept.start = found.start;
  kept.goal = found.goal;
  kept.end = found.end;
  kept.path_cells = found.path_cells;
  kept.cost = found.cost;
  kept.expansions = found.expansions;
}

Status Planner::BeginSample() {
  const Status status = sampler_.Begin(search_, params_.path, leg_from_, PlaceAt(leg_));
  if (!IsUsable(status)) return status;
  sampled_ = false;
  stage_ = PlanStage::kSample;
  return status;
}

void Planner::StepSample(int units) {
  if (!sampled_) return StepSampler(units);
  if (smoother_.Step(units) == Progress::kBusy) return;
  if (moves_ == Moves::kWay) return EndWay();
  const float heading_rad = request_.start.pose.theta_rad;
  const float base_error_rad = Abs(WrapAngle(heading_rad - BaseHeading(plan_.base)));
  const float smooth_error_rad = Abs(WrapAngle(heading_rad - BaseHeading(smoother_.result())));
  plan_.pivots_first = Max(base_error_rad, smooth_error_rad) > params_.path.max_join_heading_rad;
  if (plan_.pivots_first && !MayPivot()) {
    const Status failure =
        CanPivot(params_.vehicle) ? Status::kPivotBlocked : Status::kNeedsManoeuvre;
    if (BeginLeadOut(failure)) return;
    return Fail(failure);
  }
  is_gentle_ = HasPreferredRate(params_.optimizer);
  BeginSeed();
}

// The way to standstill would be no part of the path, and nothing would check it: a vehicle that
// moves has to stop first.
bool Planner::MayPivot() const {
  return CanPivot(params_.vehicle) && request_.start.speed_mps == 0.0f &&
         PivotIsFree(costmap(), params_.vehicle, params_.path, PlaceOf(request_.start.pose));
}

// The optimizer starts from the smoothed base path unless that costs more than the base path as it
// is: a corner cut may lead closer to an obstacle. One of them may be too far off the start's
// heading to be joined to it.
void Planner::BeginSeed() {
  is_to_seed_ = false;
  const bool base_joins = MakeSeed(plan_.base);
  plan_.cost_before = SeedCost();
  const bool smooth_joins = MakeSeed(smoother_.result());
  const PathCost smooth = SeedCost();
  if (smooth_joins && !base_joins) plan_.cost_before = smooth;
  seed_is_smooth_ = smooth_joins && (!base_joins || smooth.total() <= plan_.cost_before.total());
  if (!seed_is_smooth_) static_cast<void>(MakeSeed(plan_.base));
  plan_.optimizer_status = optimizer_.Begin(costmap(), CostParams(), params_.path, seed_,
                                            StartCurvature(), keeps_end_heading_, Places());
  if (!IsUsable(plan_.optimizer_status)) return Fail(plan_.optimizer_status);
  stage_ = PlanStage::kOptimize;
}

// What the path is optimized for at present.
OptimizerParams Planner::CostParams() const {
  return is_gentle_ ? AtPreferredRate(params_.optimizer) : params_.optimizer;
}

PathCost Planner::SeedCost() const {
  return CostOf(costmap(), CostParams(), seed_, StartCurvature());
}

float Planner::StartCurvature() const {
  return plan_.pivots_first ? 0.0f : request_.start.curvature_per_m;
}

// A base path joined to the heading that the vehicle has, or will have turned to, and where it can
// be to the goal's heading. The start comes last, so that it is exact on a short path too. What
// cannot be joined at the end is turned on the spot there. False: it cannot be joined at the start;
// the seed is empty, which the optimizer reports.
bool Planner::MakeSeed(const WorldPath& base) {
  const float heading_rad =
      plan_.pivots_first ? BaseHeading(smoother_.result()) : request_.start.pose.theta_rad;
  keeps_end_heading_ = false;
  if (has_goal_heading_) {
    const Status end = JoinEnd(base, params_.path, CostParams(), request_.goal_heading_rad, seed_);
    keeps_end_heading_ =
        IsUsable(end) && IsUsable(JoinStart(seed_, params_.path, CostParams(), heading_rad, seed_));
    if (keeps_end_heading_) return true;
  }
  return IsUsable(JoinStart(base, params_.path, CostParams(), heading_rad, seed_));
}

void Planner::StepOptimize(int units) {
  if (is_to_seed_) return BeginSeed();
  if (optimizer_.Step(costmap(), units) == Progress::kBusy) return;
  plan_.optimizer_status = optimizer_.result().status;
  plan_.cost_after = optimizer_.result().after;
  plan_.is_seed = false;
  MakePath(optimizer_.path());
  // Gentle bends may be too wide for a place that the path shall pass.
  if (FirstMissed() >= 0 && is_gentle_) {
    is_gentle_ = false;
    is_to_seed_ = true;  // in the next portion: both at once are too much
    return;
  }
  if (FirstMissed() >= 0) {
    plan_.is_seed = true;
    plan_.cost_after = SeedCost();
    MakePath(seed_);
  }
  BeginCheck();
}

Status Planner::StartCheck() {
  Status status = ToActuator<PlanarModel>(plan_.path, plan_.actuator);
  if (IsUsable(status)) {
    status =
        check_.Begin(params_.vehicle, params_.optimizer, plan_.path, own_start_.curvature_per_m,
                     params_.path.margin_m, looks_across_ ? plan_.lead_points : 0);
  }
  if (IsUsable(status)) stage_ = PlanStage::kCheck;
  return status;
}

void Planner::BeginCheck() {
  const int missed = FirstMissed();
  if (missed >= 0 && Shorten(missed)) return;
  const Status status = IsUsable(plan_.base_status) ? StartCheck() : plan_.base_status;
  if (!IsUsable(status)) Fail(status);
}

void Planner::StepCheck(int units) {
  if (check_.Step(costmap(), plan_.path, units) == Progress::kBusy) return;
  plan_.check = check_.result();
  plan_.check_status = plan_.check.status;
  plan_.starts_in_obstacle = plan_.search.start_in_obstacle || plan_.check.start_overlaps;
  // What it stands in already it does not touch by staying.
  if (plan_.stays && !plan_.pivots_last && plan_.check.start_overlaps) {
    plan_.check_status = Status::kStartInObstacle;
  }
  const bool may_be_another =
      plan_.check_status == Status::kCollision || plan_.check_status == Status::kNeedsManoeuvre;
  if (may_be_another) return TryAgain();
  if (!IsUsable(plan_.check_status)) return Fail(plan_.check_status);
  if (request_.has_unseen_start && lead_.empty() && lead_failure_ != Status::kOk &&
      SweepsUnseen()) {
    if (request_.start.speed_mps > 0.0f) return Fail(Status::kPivotBlocked);
    if (BeginLeadOut(Status::kOk)) return;
  }
  BeginSpeed();
}

void Planner::BeginSpeed() {
  stage_ = PlanStage::kSpeed;
  const GroundAhead ground = LookAtGround(terrain(), costmap().window, params_.speed, plan_.path);
  speed_params_ = OnGround(params_.speed, ground);
  caps_.Begin(costmap().window, speed_params_, params_.vehicle, plan_.path, own_start_.speed_mps,
              {}, nullptr, ground.too_steep_m);
}

void Planner::TryAgain() {
  if (IsHere()) return Fail(Status::kPivotBlocked);
  const Status failure = plan_.check_status;
  NoteBlocked();
  if (MayEndShort()) {
    EndShort();
    return BeginCheck();
  }
  if (is_gentle_) {
    is_gentle_ = false;
    return BeginSeed();
  }
  // First the seed that was optimized, then the base path itself, with no corner cut.
  if (!plan_.is_seed || (seed_is_smooth_ && MakeSeed(plan_.base))) {
    if (plan_.is_seed) seed_is_smooth_ = false;
    plan_.is_seed = true;
    plan_.cost_after = SeedCost();
    MakePath(seed_);
    return BeginCheck();
  }
  if (plan_.pivots_first || !MayPivot()) {
    if (Shorten(first_leg_)) return;
    if (failure == Status::kNeedsManoeuvre && CutBase()) return;
    if (BeginLeadOut(failure)) return;
    if (moves_ == Moves::kNone && LookElsewhere()) return;
    if (CutBase()) return;
    return Fail(failure);
  }
  plan_.pivots_first = true;
  BeginSeed();
}

void Planner::StepSpeed(const Source& source, int units) {
  if (caps_.Step(costmap(), speed_params_, params_.vehicle, plan_.path, units, source.areas) ==
      Progress::kBusy) {
    return;
  }
  caps_.LimitLegs(plan_.path, request_.route, params_.replan.pass_radius_m + kPassSlack_m);
  SpeedRequest request;
  request.start_speed_mps = own_start_.speed_mps;
  request.start_curvature_per_m = own_start_.curvature_per_m;
  plan_.slow_points = SlowPoints();
  request.slow_points = plan_.slow_points;
  plan_.narrow = caps_.narrow();
  request.cap_mps = caps_.cap_mps();
  const Status status =
      PlanSpeed(speed_params_, params_.vehicle, plan_.actuator, request, plan_.speed);
  if (!IsUsable(status)) return Fail(status);
  Finish();
}

void Planner::Finish() {
  plan_.status = Graver(plan_.base_status, Graver(plan_.optimizer_status, plan_.check_status));
  if (plan_.ends_short) plan_.status = Graver(plan_.status, Status::kGoalMoved);
  if (plan_.narrow) plan_.status = Graver(plan_.status, Status::kNarrowGap);
  stage_ = PlanStage::kDone;
}

// A path that was free but swept what nobody has seen is better than none.
void Planner::Fail(Status status) {
  if (moves_ == Moves::kSearch) return RefuseMoves();
  if (!lead_.empty() && LookBack()) return;
  if (lead_.empty() || lead_failure_ != Status::kOk) {
    if (!LookForMoves(status)) End(status);
    return;
  }
  lead_.Clear();
  request_.start = own_start_;
  BeginSearch();
}

void Planner::End(Status status) {
  plan_.status = status;
  stage_ = PlanStage::kDone;
}

}  // namespace hardpack
