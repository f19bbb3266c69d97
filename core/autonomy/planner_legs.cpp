// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

// Planner: the base path, joined from one search for each leg of the route.

namespace hardpack {
namespace {

// The optimizer is held to this share of the radius, and has the rest to give way in.
constexpr float kTightShare = 0.5f;
// From a start that is nearer to the first via than this, the leg's direction is the vehicle's own.
constexpr float kLeastFirstLeg_m = 3.0f;

// What is closed around a refused place, and one more for each that was refused before.
constexpr int kRefused_cells = 1;

}  // namespace

// Not inlined: within NextLeg's loop the choice becomes a second way into it, and such a loop has
// no static bound.
[[gnu::noinline]] Vec2 Planner::PlaceAt(int target) const {
  const Route& route = request_.route;
  const bool is_via = target >= 0 && target < route.vias.size();
  return is_via ? route.vias[target].position_odom : request_.goal_odom;
}

void Planner::BeginLeg(Vec2 from_odom) {
  leg_from_ = from_odom;
  stage_ = PlanStage::kSearch;
  plan_.base_status = search_.Begin(costmap(), params_.astar, from_odom, PlaceAt(leg_));
}

void Planner::StepSampler(int units) {
  if (sampler_.Step(search_, units) == Progress::kBusy) return;
  if (leg_ > first_leg_) {
    if (!IsUsable(sampler_.status()) || !AppendLeg()) return EndLegs();
  } else {
    plan_.base_status = Graver(plan_.search.status, sampler_.status());
    if (!IsUsable(plan_.base_status)) return Fail(plan_.base_status);
    plan_.base = sampler_.result();
    sample_status_ = sampler_.status();
  }
  KeepLeg();
  if (!NextLeg()) return EndLegs();
  BeginLeg(PlaceOf(plan_.base.back()));
}

void Planner::KeepLeg() {
  plan_.target = leg_;
  const AstarResult& search = plan_.search;
  Leg& leg = legs_[leg_];
  leg.end_point = plan_.base.size() - 1;
  leg.status = search.status;
  leg.goal_moved = search.goal_moved;
  leg.goal = search.goal;
  leg.end = search.end;
  leg.path_cells = search.path_cells;
  leg.cost = search.cost;
  leg.expansions = search.expansions;
}

// Whether the path may lead on from where it has come to, as far as that place says.
bool Planner::MayLeadOn() const {
  if (plan_.base.full() || sample_status_ != Status::kOk) return false;
  const AstarResult& found = search_.result();
  return !found.partial && !found.goal_outside_map &&
         AreWithin(PlaceOf(plan_.base.back()), PlaceAt(leg_), params_.replan.pass_radius_m);
}

// On to the next place that is more than kHere_m from the path's end: those that are not are
// reached with it. False: there is none, or the path must not lead there.
bool Planner::NextLeg() {
  if (!MayLeadOn()) return false;
  const Vec2 end = PlaceOf(plan_.base.back());
  const Vec2 before = DirectionAtEnd();
  HP_LOOP_BOUND(kMaxVias)
  for (int next = leg_ + 1; next <= request_.route.vias.size(); ++next) {
    leg_ = next;
    const Vec2 behind = Minus(PlaceAt(next), end);
    if (!AreWithin(behind, {}, kHere_m)) {
      return IsGentle(before, behind, params_.optimizer.max_curvature_per_m,
                      params_.replan.pass_radius_m);
    }
    KeepLeg();
  }
  return false;
}

// The present leg's; of the first one, if it is short, the vehicle's.
Vec2 Planner::DirectionAtEnd() const {
  const Vec2 end = PlaceOf(plan_.base.back());
  const Pose2& start = request_.start.pose;
  if (leg_ > first_leg_ || !AreWithin(end, PlaceOf(start), kLeastFirstLeg_m)) {
    return Minus(end, leg_from_);
  }
  const SinCosPair heading = SinCos(start.theta_rad);
  return {heading.cos, heading.sin};
}

// The sampled leg behind the base path, as far as there is room. False: there is none.
bool Planner::AppendLeg() {
  const WorldPath& leg = sampler_.result();
  WorldPath& base = plan_.base;
  if (base.full() || leg.size() < 2) return false;
  sample_status_ = sampler_.status();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < leg.size(); ++k) {
    if (base.full()) {
      sample_status_ = Status::kPathCut;
      break;
    }
    base.Resize(base.size() + 1);
    base.back() = leg[k];
  }
  SetHeadingsFromChords(base);
  const AstarResult& found = search_.result();
  AstarResult& search = plan_.search;
  search.status = Graver(search.status, found.status);
  search.partial = found.partial;
  search.goal_outside_map = found.goal_outside_map;
  search.goal_moved = found.goal_moved;
  search.goal = found.goal;
  search.end = found.end;
  search.path_cells += found.path_cells;
  search.cost += found.cost;
  search.expansions += found.expansions;
  return true;
}

void Planner::EndLegs() {
  plan_.base_status = Graver(plan_.search.status, sample_status_);
  has_goal_heading_ = request_.has_goal_heading && plan_.target == request_.route.vias.size() &&
                      !plan_.search.partial && !plan_.search.goal_outside_map &&
                      !plan_.search.goal_moved && sample_status_ == Status::kOk;
  BeginSmoothing();
}

void Planner::BeginSmoothing() {
  const Status status = smoother_.Begin(plan_.base, params_.path.smoothing_passes);
  if (!IsUsable(status)) return Fail(status);
  sampled_ = true;
  stage_ = PlanStage::kSample;
}

// The path ends at an earlier one of its places; the second time, at the first of them. False: it
// has only one, or does already.
bool Planner::Shorten(int target) {
  const int last = shortened_ ? first_leg_ : target;
  if (last >= plan_.target) return false;
  shortened_ = true;
  plan_.target = last;
  const Leg& leg = legs_[last];
  plan_.base.Resize(leg.end_point + 1);
  SetHeadingsFromChords(plan_.base);
  // A leg that led on was neither cut nor off the map.
  plan_.search.status = leg.status;
  plan_.search.partial = false;
  plan_.search.goal_outside_map = false;
  plan_.search.goal_moved = leg.goal_moved;
  plan_.search.goal = leg.goal;
  plan_.search.end = leg.end;
  plan_.search.path_cells = leg.path_cells;
  plan_.search.cost = leg.cost;
  plan_.search.expansions = leg.expansions;
  sample_status_ = Status::kOk;
  EndLegs();
  return true;
}

// The first of the places which the path leads on behind that it does not pass; -1: none.
int Planner::FirstMissed() const {
  int from = 0;
  HP_LOOP_BOUND(kMaxVias)
  for (int i = first_leg_; i < plan_.target; ++i) {
    from = PassingPoint(plan_.path, from, PlaceAt(i), params_.replan.pass_radius_m);
    if (from < 0) return i;
  }
  return -1;
}

// Where the base path passes them, which is beside a via in an obstacle.
PassingPlaces Planner::Places() const {
  PassingPlaces places;
  places.radius_m = kTightShare * params_.replan.pass_radius_m;
  HP_LOOP_BOUND(kMaxVias)
  for (int i = first_leg_; i < plan_.target; ++i) {
    static_cast<void>(places.place_odom.PushBack(PlaceOf(plan_.base[legs_[i].end_point])));
  }
  return places;
}

// By the place of the last attempt, which is the base path itself. A larger one each time: what
// holds a path may be wider than where it touches. False: it may not be looked for, and nothing has
// changed.
bool Planner::LookElsewhere() {
  const int point = plan_.check.collision_point;
  if (plan_.refusals == kMaxRefusals || point < 0 || plan_.check.leaves_map) return false;
  const Vec2 place = PlaceOf(plan_.path[point]);
  const bool is_near = AreWithin(place, PlaceOf(request_.start.pose), kNearRefusal_m) ||
                       AreWithin(place, PlaceAt(plan_.target), kNearRefusal_m);
  if (is_near) return false;
  if (plan_.refusals == 0) first_refused_odom_ = place;
  ++plan_.refusals;
  builder_.Refuse(CellAt(place), kRefused_cells + plan_.refusals);
  BeginSearch();
  return true;
}

}  // namespace hardpack
