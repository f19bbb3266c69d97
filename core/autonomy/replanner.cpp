// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/replanner.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/wide_int.h"

namespace hardpack {
namespace {

// How much longer a round may take than the longest of the last ones.
constexpr float kLatencyMargin = 1.5f;
// An owner that paused does not move the anchors out of sight for the next rounds.
constexpr float kLongestRound_s = 3.0f;
// What is kept of the longest round from one to the next: half after eleven.
constexpr float kLatencyFade = 0.9375f;
// Beside what the vehicle drives from tick to tick.
constexpr float kSearchAhead_m = 3.0f;
// A search's cost of one metre at cost 0.

// Copied from, since a temporary would not fit on the stack.
constexpr CommittedPlan kNothingCommitted;

// What was not observed, so far beyond where the lidar sees level ground, is seldom seen on the
// way.
constexpr float kNearBeyondBlind_m = 1.0f;

Status CheckUpdate(const VehicleState& state, const PlanGoal& goal) {
  const bool finite =
      IsFinite(state.pose) && IsFinite(state.curvature_per_m) && IsFinite(state.speed_mps) &&
      IsFinite(state.driven_mps) && IsFinite(state.reaction_s) && IsFinite(state.turn_quickness) &&
      IsFinite(goal.position_odom) && (!goal.has_heading || IsFinite(goal.heading_rad));
  if (!finite) return Status::kNotFinite;
  const bool fits = state.speed_mps >= -Replanner::kStanding_mps &&
                    state.speed_mps <= kMaxRequestSpeed_mps &&
                    Abs(state.curvature_per_m) <= kCurvatureCeiling_per_m &&
                    Max(Abs(state.pose.x_m), Abs(state.pose.y_m)) <= kMaxRequestPosition_m &&
                    Abs(state.pose.theta_rad) <= kSinCosMaxAngle_rad &&
                    (!goal.has_heading || Abs(goal.heading_rad) <= kSinCosMaxAngle_rad) &&
                    goal.number >= static_cast<uint32_t>(goal.route.vias.size());
  return fits ? CheckRoute(goal.route) : Status::kInvalidArgument;
}

}  // namespace

// Exact for the arc: its chord has the mean of both headings and sin(turn / 2) / (turn / 2) of its
// length.
VehicleState PredictAhead(const VehicleState& state, float ahead_s) {
  const float way_m = state.speed_mps * ahead_s;
  const float half_turn_rad = 0.5f * way_m * state.curvature_per_m;
  const float shortened = Abs(half_turn_rad) < 1.0e-3f ? 1.0f : Sin(half_turn_rad) / half_turn_rad;
  const SinCosPair chord = SinCos(state.pose.theta_rad + half_turn_rad);
  VehicleState ahead = state;
  ahead.pose = {state.pose.x_m + way_m * shortened * chord.cos,
                state.pose.y_m + way_m * shortened * chord.sin,
                WrapAngle(state.pose.theta_rad + 2.0f * half_turn_rad)};
  return ahead;
}

Status Replanner::Configure(const PlannerParams& params) {
  const Status status = CheckPlannerParams(params);
  if (!IsUsable(status)) return status;
  params_ = params;
  configured_ = true;
  latency_s_ = params.replan.min_latency_s;
  longest_s_ = 0.0f;
  last_number_ = 0;
  counters_ = ReplanCounters{};
  Forget();
  return Status::kOk;
}

void Replanner::Forget() {
  has_state_ = false;
  now_ns_ = 0;
  committed_ = kNothingCommitted;
  phase_ = Phase::kIdle;
  outcome_ = ReplanOutcome{};
  place_ = PathPlace{};
  off_path_ = false;
}

Status Replanner::Update(uint64_t now_ns, const VehicleState& state, const PlanGoal& goal,
                         const Walkers* walkers) {
  Status status = CheckUpdate(state, goal);
  if (IsUsable(status) && has_state_ && now_ns < now_ns_) status = Status::kInvalidArgument;
  if (!IsUsable(status)) {
    ++counters_.refused;
    return status;
  }
  const float since_s = has_state_ ? SecondsBetween(now_ns_, now_ns) : 0.0f;
  has_state_ = true;
  now_ns_ = now_ns;
  state_ = state;
  state_.pose.theta_rad = WrapAngle(state.pose.theta_rad);
  state_.speed_mps = Max(state.speed_mps, 0.0f);
  goal_ = goal;
  has_walkers_ = walkers != nullptr;
  if (has_walkers_) walkers_ = *walkers;
  Locate(since_s);
  return Status::kOk;
}

bool Replanner::IsAt(int point) const {
  return WayTo(committed_.path, point) - place_.along_m <= kAtPoint_m;
}

// What the vehicle may be beside its path by: the room that there is at its place.
float Replanner::MostCrossTrack() const {
  const ReplanParams& params = params_.replan;
  const int point = place_.point;
  if (point + 1 >= committed_.room_m.size()) return params.max_cross_track_m;
  const float room_m = Min(committed_.room_m[point], committed_.room_m[point + 1]);
  return Clamp(room_m, params.least_cross_track_m, params.max_cross_track_m);
}

// Where the newest state is on the committed path, and whether it is on it at all.
void Replanner::Locate(float since_s) {
  off_path_ = false;
  if (committed_.number == 0) return;
  const WorldPath& path = committed_.path;
  const float search_m = place_.along_m + state_.speed_mps * since_s + kSearchAhead_m;
  place_ = Project(path, state_.pose, Stands(), search_m);
  const float heading_rad = StateAt(committed_, place_.along_m).pose.theta_rad;
  const bool stands_off = Stands() && !IsAt(StandingPoint(path, place_.point));
  const float most_rad = stands_off ? Min(kMaxStandingTurn_rad, params_.path.max_join_heading_rad)
                                    : params_.path.max_join_heading_rad;
  const bool looks_away = Abs(WrapAngle(state_.pose.theta_rad - heading_rad)) > most_rad;
  const float most_m = stands_off ? kMaxStandingOff_m : MostCrossTrack();
  off_path_ =
      place_.cross_track_m > most_m || (looks_away && !TurnsOnTheSpotAt(path, place_.point));
}

Progress Replanner::Step(const Mapper& mapper, int units, const AreaSet* areas) {
  if (phase_ == Phase::kIdle && units > 0 && MayBegin()) {
    Begun(planner_.Begin(mapper, params_, request_));
  }
  return Run([&](int portion) { return planner_.Step(mapper, portion, areas); }, units, areas);
}

Progress Replanner::Step(const HeightGrid& heights, int units, const AreaSet* areas) {
  if (phase_ == Phase::kIdle && units > 0 && MayBegin()) {
    Begun(planner_.Begin(heights, params_, request_));
  }
  return Run([&](int portion) { return planner_.Step(heights, portion, areas); }, units, areas);
}

Status Replanner::BeginCells(const GridWindow& window) {
  phase_ = Phase::kIdle;
  if (!MayBegin()) return Status::kNotStarted;
  const Status status = planner_.BeginCells(window, params_, request_);
  Begun(status);
  return status;
}

Progress Replanner::StepCells(int units, const AreaSet* areas) {
  return Run([&](int portion) { return planner_.StepCells(portion, areas); }, units, areas);
}

template <typename StepPlanner>
Progress Replanner::Run(StepPlanner&& step_planner, int units, const AreaSet* areas) {
  if (units <= 0) return Progress::kBusy;
  HP_LOOP_BOUND(kMaxUnits)
  for (int left = units; left > 0 && phase_ != Phase::kIdle; left -= Planner::kPortion_units) {
    const int portion = left < Planner::kPortion_units ? left : Planner::kPortion_units;
    if (phase_ != Phase::kPlan) {
      StepOwn(portion, areas);
    } else if (step_planner(portion) == Progress::kDone) {
      EndPlan();
    }
  }
  return phase_ == Phase::kIdle ? Progress::kDone : Progress::kBusy;
}

void Replanner::StepOwn(int units, const AreaSet* areas) {
  switch (phase_) {
    case Phase::kCheck:
      return StepCheck(units);
    case Phase::kExtend:
      if (planner_.StepCells(units, areas) == Progress::kDone) Decide();
      return;
    case Phase::kSpeed:
      if (caps_.Step(planner_.costmap(), caps_params_, params_.vehicle, candidate_.path, units,
                     areas, &planner_.terrain()) == Progress::kDone) {
        LimitLegs();
        Publish();
      }
      return;
    case Phase::kIdle:
    case Phase::kPlan:
      return;
  }
}

// By the newest state's vias, of which some may have been passed since the round began.
void Replanner::LimitLegs() {
  const bool is_same = goal_.list == round_goal_.list;
  caps_.LimitLegs(candidate_.path, is_same ? goal_.route : round_goal_.route, PassReach_m());
}

bool Replanner::MayBegin() {
  if (!configured_ || !has_state_) {
    outcome_ = ReplanOutcome{};
    return false;
  }
  round_ = ReplanOutcome{};
  round_goal_ = goal_;
  begun_ns_ = now_ns_;
  rest_.Clear();
  free_until_ = -1;
  extension_point_ = -1;
  ends_short_ = false;
  late_ = false;
  ChooseAnchor();
  return true;
}

// The plan could not begin: there is no map to check anything on.
void Replanner::Begun(Status status) {
  if (IsUsable(status)) {
    phase_ = Phase::kPlan;
    return;
  }
  round_.decision = committed_.number != 0 ? ReplanDecision::kStop : ReplanDecision::kNone;
  round_.status = status;
  round_.plan_status = status;
  outcome_ = round_;
}

bool Replanner::IsBesideUnseen(const Pose2& pose) const {
  const float dx_m = pose.x_m - state_.unseen_start.x_m;
  const float dy_m = pose.y_m - state_.unseen_start.y_m;
  const float reach_m = params_.path.unseen_start_m;
  return state_.has_unseen_start && dx_m * dx_m + dy_m * dy_m < reach_m * reach_m;
}

// passed: vias of the round's goal, from the first one on, that lie before the start.
void Replanner::FillRequest(const PathStart& start, int passed, PlanRequest& request) const {
  request.start = start;
  request.goal_odom = round_goal_.position_odom;
  request.has_goal_heading = round_goal_.has_heading;
  request.goal_heading_rad = round_goal_.heading_rad;
  request.has_unseen_start = IsBesideUnseen(start.pose);
  request.unseen_start = state_.unseen_start;
  request.lead_out = state_.lead_out;
  request.near_unknown = {};
  if (!state_.lookouts.places_odom.empty()) {
    request.near_unknown = {state_.lookouts.places_odom.back(),
                            state_.lookouts.blind_m + kNearBeyondBlind_m,
                            0.5f * params_.vehicle.width_m};
  }
  request.route = RouteBehind(round_goal_.route, passed);
}

void Replanner::ChooseAnchor() {
  anchored_ = false;
  anchor_ = 0;
  left_path_ = off_path_;
  backed_up_ = BacksUp();
  const float speed_mps = Stands() ? 0.0f : state_.speed_mps;
  passed_ = 0;
  FillRequest({state_.pose, state_.curvature_per_m, speed_mps}, passed_, request_);
  if (committed_.number == 0) return;
  if (off_path_) {
    ++counters_.reanchored;
    return;
  }
  const WorldPath& path = committed_.path;
  const int standing = StandingPoint(path, place_.point);
  if (Stands() && (committed_.is_stop || IsAt(standing))) return;
  anchored_ = true;
  anchor_ = PointBehindStretch(standing);
  PathStart start{path[anchor_], 0.0f, 0.0f};
  if (anchor_ != standing) {
    start.curvature_per_m = CurvatureAt(path, anchor_, committed_.start_curvature_per_m);
    start.speed_mps = committed_.speed[anchor_];
  }
  // Of a path that is to be replaced nothing counts as passed.
  if (!GoalHasChanged()) passed_ = ViasPassed(path, round_goal_.route, PassReach_m(), anchor_);
  FillRequest(start, passed_, request_);
}

// The first point that is not reached while the round lasts, neither at the committed speeds nor at
// the present one. The way out of where nobody has seen what there is beside it is kept: a plan
// that bends off it would sweep that, and a vehicle that moves would have to stop for it.
int Replanner::PointBehindStretch(int standing) const {
  const WorldPath& path = committed_.path;
  const float least_along_m = place_.along_m + state_.speed_mps * latency_s_;
  float along_m = place_.along_m;
  float next_along_m = WayTo(path, place_.point);
  float time_s = 0.0f;
  float speed_mps = state_.speed_mps;
  if (IsReversed(path, place_.point)) return standing;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int point = place_.point + 1; point < standing; ++point) {
    next_along_m += committed_.actuator.steps[point - 1].dr_m;
    const float sum_mps = speed_mps + committed_.speed[point];
    // Where both are 0 the vehicle does not get on.
    if (!(sum_mps > 0.0f)) return point;
    time_s += 2.0f * (next_along_m - along_m) / sum_mps;
    const bool is_behind = time_s >= latency_s_ && next_along_m >= least_along_m;
    if (is_behind && !IsBesideUnseen(path[point])) return point;
    along_m = next_along_m;
    speed_mps = committed_.speed[point];
  }
  return standing;
}

void Replanner::EndPlan() {
  KeepFresh();
  if (committed_.number == 0) return Decide();
  BeginCheck();
}

// The place that the planner's result leads to; passed: as its request had it.
PlanGoal Replanner::PlannedGoal(int passed) const {
  return PlaceOfGoal(round_goal_, passed + planner_.result().target);
}

void Replanner::KeepFresh() {
  const Plan& plan = planner_.result();
  fresh_.status = plan.status;
  fresh_.path.Clear();
  round_.plan_status = plan.status;
  if (!IsUsable(plan.status)) return;
  fresh_.path = plan.path;
  fresh_.slow_points = plan.slow_points;
  fresh_.lead_points = plan.lead_points;
  fresh_.search_end = plan.search.end;
  fresh_.goal = PlannedGoal(passed_);
  const Vec2 place_odom = fresh_.goal.position_odom;
  const bool in_end_cell = CellAt(place_odom) == plan.search.end;
  fresh_.end_odom = in_end_cell ? place_odom : CellCenter(plan.search.end);
  fresh_.way_cost = ToFloat(static_cast<uint64_t>(plan.search.cost)) / kWayCostPerMeter;
}

// From the projection of this moment on: the rest as the vehicle will drive it.
void Replanner::BeginCheck() {
  const WorldPath& path = committed_.path;
  dropped_ = FirstKept(path, place_.point);
  rest_.Clear();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int point = dropped_; point < path.size(); ++point) {
    rest_.Resize(rest_.size() + 1);
    rest_.back() = path[point];
  }
  if (TurnsOnTheSpotAt(rest_, 0)) rest_[0].theta_rad = state_.pose.theta_rad;
  rest_curvature_per_m_ = CurvatureAt(path, dropped_, committed_.start_curvature_per_m);
  rest_turn_rad_ = TurnAt(path, dropped_, committed_.start_turn_rad);
  late_ = anchored_ && place_.along_m > WayTo(path, anchor_);
  const Status status =
      check_.Begin(params_.vehicle, params_.optimizer, rest_, rest_curvature_per_m_,
                   params_.path.kept_margin_m, committed_.lead_points - dropped_);
  if (!IsUsable(status)) return Decide();
  phase_ = Phase::kCheck;
}

void Replanner::StepCheck(int units) {
  if (check_.Step(planner_.costmap(), rest_, units) == Progress::kBusy) return;
  // The pose at which it collides is not free, the chord that leads there is driven up to it.
  free_until_ = IsUsable(check_.result().status)
                    ? rest_.size() - 1
                    : ClampInt(check_.result().collision_point - 1, -1, rest_.size() - 1);
  extension_point_ = ExtensionPoint();
  if (extension_point_ < 0) return Decide();
  BeginExtension();
}

void Replanner::BeginExtension() {
  PathStart start{rest_[extension_point_], 0.0f, 0.0f};
  start.curvature_per_m = CurvatureAt(rest_, extension_point_, rest_curvature_per_m_);
  start.speed_mps = committed_.speed[dropped_ + extension_point_];
  passed_before_extension_ =
      ViasPassed(committed_.path, round_goal_.route, PassReach_m(), dropped_ + extension_point_);
  PlanRequest request;
  FillRequest(start, passed_before_extension_, request);
  if (IsUsable(planner_.BeginOnMap(request))) {
    phase_ = Phase::kExtend;
  } else {
    extension_point_ = -1;
    Decide();
  }
}

// How far along a path that it was on when the round began the vehicle may be by now.
float Replanner::ReachOfRound() const {
  const float took_s = SecondsBetween(begun_ns_, now_ns_);
  return kSearchAhead_m + took_s * Max(state_.speed_mps, params_.speed.max_speed_mps);
}

void Replanner::EndRound() {
  phase_ = Phase::kIdle;
  round_.anchored = anchored_;
  round_.late = late_;
  outcome_ = round_;
  ++counters_.plans;
  if (late_) ++counters_.late;
  if (!IsUsable(outcome_.plan_status)) ++counters_.failed;
  switch (outcome_.decision) {
    case ReplanDecision::kKept:
      ++counters_.kept;
      break;
    case ReplanDecision::kExtended:
      ++counters_.extended;
      break;
    case ReplanDecision::kStop:
      ++counters_.stopped;
      break;
    case ReplanDecision::kReplaced:
      ++counters_.replaced[static_cast<int>(outcome_.reason)];
      break;
    case ReplanDecision::kNone:
      break;
  }
  const float took_s = Min(SecondsBetween(begun_ns_, now_ns_), kLongestRound_s);
  longest_s_ = Max(took_s, kLatencyFade * longest_s_);
  latency_s_ = Max(params_.replan.min_latency_s, kLatencyMargin * longest_s_);
}

}  // namespace hardpack
