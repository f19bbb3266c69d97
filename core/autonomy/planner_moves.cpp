// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/kinematics/kinematics.h"

// Planner: the way out in several moves, where everything else has failed.

namespace hardpack {
namespace {

// So far beyond the place where the rest touched do the moves lead.
constexpr float kBeyondBlocked_m = 1.0f;
constexpr float kNearEnd_m = 2.0f;

// A path that is cut ends so far before what holds it up; it is not cut to less than this beyond
// what the vehicle needs to stop.
constexpr float kMovesShare = 0.99f;
constexpr float kCutBefore_m = 4.0f;
constexpr float kLeastCut_m = 1.0f;

float Distance2(const Pose2& from, const Pose2& to) {
  const float dx_m = to.x_m - from.x_m;
  const float dy_m = to.y_m - from.y_m;
  return dx_m * dx_m + dy_m * dy_m;
}

}  // namespace

// Where the search finds no way, the outline itself may fit. And where cells were closed that the
// check had refused, what is left may have none.
bool Planner::MayMove(Status failure) const {
  return failure == Status::kPivotBlocked || failure == Status::kNeedsManoeuvre ||
         failure == Status::kCollision || failure == Status::kStartEnclosed ||
         failure == Status::kNoPath;
}

// Once in a plan, by a vehicle that stands and may reverse. A way is searched from where it stands
// first, which tells where to lead to, on the map as it is without refusals. False: nothing has
// changed.
bool Planner::LookForMoves(Status failure) {
  const bool may = moves_ == Moves::kNone && own_start_.speed_mps == 0.0f &&
                   request_.lead_out == 0 && params_.path.reverse_out_m > 0.0f && MayMove(failure);
  if (!may) return false;
  moves_ = Moves::kDue;
  moves_refused_ = 0;
  led_out_ = true;
  looks_back_ = true;
  looks_across_ = false;
  lead_failure_ = failure;
  lead_.Clear();
  request_.start = own_start_;
  stage_ = PlanStage::kManoeuvre;
  return true;
}

// Where the path, optimized for the final limits, touches something or bends too sharply: it tells
// where moves have to lead beyond, and where a path that is cut has to end before.
void Planner::NoteBlocked() {
  if (is_gentle_ || plan_.is_seed) return;
  const int point = plan_.check_status == Status::kNeedsManoeuvre ? plan_.check.sharpest_point
                                                                  : plan_.check.collision_point;
  has_blocked_ = point > plan_.lead_points && point < plan_.path.size();
  if (has_blocked_) blocked_odom_ = PlaceOf(plan_.path[point]);
}

// What cannot be driven is far ahead: the path ends before it, and what to do there is seen better
// from there. False: it is too near, or none is known.
bool Planner::CutBase() {
  if (!has_blocked_ || cuts_ == kMaxCuts) return false;
  const float speed_mps = request_.start.speed_mps;
  const float stop_m = 0.5f * speed_mps * speed_mps / params_.speed.max_deceleration_mps2;
  WorldPath& base = plan_.base;
  float along_m = 0.0f;
  int last = -1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < base.size(); ++k) {
    if (AreWithin(PlaceOf(base[k]), blocked_odom_, kCutBefore_m)) break;
    along_m += Sqrt(Distance2(base[k - 1], base[k]));
    last = k;
  }
  if (last == base.size() - 1 || along_m < stop_m + kLeastCut_m) return false;
  ++cuts_;
  has_blocked_ = false;
  plan_.target = first_leg_;
  HP_LOOP_BOUND(kMaxVias)
  while (legs_[plan_.target].end_point < last) ++plan_.target;
  base.Resize(last + 1);
  SetHeadingsFromChords(base);
  sample_status_ = Status::kPathCut;
  EndLegs();
  return true;
}

// Slowly driven moves may take all that the vehicle has, but for rounding.
float Planner::SharpestCurvature() const {
  return CanPivot(params_.vehicle) ? params_.optimizer.max_curvature_per_m
                                   : kMovesShare * MostCurvature(params_.vehicle);
}

void Planner::BeginWay() {
  if (plan_.refusals > 0) {
    builder_.ForgetRefused();
    has_blocked_ = true;
    blocked_odom_ = first_refused_odom_;
  }
  moves_ = Moves::kWay;
  BeginSearch();
}

// Once it is known, or that there is none.
void Planner::EndWay() {
  if (moves_ == Moves::kWay) moves_ = Moves::kBegin;
  stage_ = PlanStage::kManoeuvre;
}

// No search leads from the vehicle to the goal, or to where it begins: where would one from the
// goal get to?
void Planner::BeginFromGoal() {
  const Cell goal = costmap().window.Nearest(CellAt(PlaceAt(first_leg_)));
  const Status status =
      search_.Begin(costmap(), params_.astar, CellCenter(goal), PlaceOf(own_start_.pose));
  if (!IsUsable(status)) return End(lead_failure_);
  plan_.base.Clear();
  from_goal_ = true;
  stage_ = PlanStage::kSearch;
}

// With the way, or without one.
bool Planner::BeginManoeuvre() {
  moves_ = Moves::kSearch;
  const Status status = manoeuvre_.Begin(costmap(), params_.vehicle, params_.path,
                                         SharpestCurvature(), own_start_.pose, plan_.base);
  if (!IsUsable(status)) return false;
  if (has_blocked_) manoeuvre_.LeadBeyond(blocked_odom_, kBeyondBlocked_m);
  has_blocked_ = false;
  return true;
}

void Planner::StepManoeuvre(int units) {
  if (moves_ == Moves::kDue) return BeginWay();
  if (moves_ == Moves::kBegin) {
    if (!BeginManoeuvre()) End(lead_failure_);
    return;
  }
  if (lead_.empty()) {
    if (manoeuvre_.Step(costmap(), search_, units) == Progress::kBusy) return;
    if (manoeuvre_.status() != Status::kOk) return End(lead_failure_);
    manoeuvre_.Poses(lead_);
    const Status status = check_.Begin(params_.vehicle, params_.optimizer, lead_,
                                       own_start_.curvature_per_m, params_.path.margin_m, 0);
    if (!IsUsable(status)) RefuseMoves();
    return;
  }
  if (check_.Step(costmap(), lead_, units) == Progress::kBusy) return;
  if (!IsUsable(check_.result().status)) return RefuseMoves();
  request_.start = {lead_.back(), 0.0f, 0.0f};
  BeginSearch();
}

// The rest from their end cannot be driven, or they cannot: others, past the place where it was.
void Planner::RefuseMoves() {
  ++moves_refused_;
  if (moves_refused_ == kMaxMoves || lead_.empty()) return End(lead_failure_);
  // Near their end it is how the rest begins there that cannot be driven.
  const bool is_beyond =
      has_blocked_ && !AreWithin(blocked_odom_, PlaceOf(lead_.back()), kNearEnd_m);
  if (is_beyond) manoeuvre_.LeadBeyond(blocked_odom_, kBeyondBlocked_m);
  has_blocked_ = false;
  manoeuvre_.RefuseFound();
  lead_.Clear();
  if (!manoeuvre_.has_way()) return BeginFromGoal();
  stage_ = PlanStage::kManoeuvre;
}

}  // namespace hardpack
