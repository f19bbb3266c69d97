// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/path/route.h"
#include "hal/onboard/pilot/pilot.h"

// Pilot: from one waypoint to the next, and what the operator says about that.

namespace hardpack {
namespace {

// Shorter ways have no direction.
constexpr float kLeastWay_m = 0.3f;
// Two directions whose sum is shorter are opposite: what lies between them is no direction.
constexpr float kLeastSum = 0.2f;

struct Way {
  Vec2 direction;  // of length 1, or 0 where the way is too short to have one
  float length_m = 0.0f;
};

Way WayBetween(Vec2 from, Vec2 to) {
  const Vec2 way = {to.x_m - from.x_m, to.y_m - from.y_m};
  const float length_m = Sqrt(way.x_m * way.x_m + way.y_m * way.y_m);
  if (!(length_m > kLeastWay_m)) return {{}, length_m};
  return {{way.x_m / length_m, way.y_m / length_m}, length_m};
}

}  // namespace

// Where a new goal would be taken; otherwise refused for what keeps the vehicle from driving.
Status Pilot::TakeMissionCommand(StopReason& refusal) {
  const Mode mode = supervisor_.mode();
  if (mode != Mode::kArmed && mode != Mode::kDriving) {
    const StopReason reason = supervisor_.reason();
    refusal = reason == StopReason::kNone ? StopReason::kOperator : reason;
    return Status::kNotPermitted;
  }
  const bool resumes = command_.kind == control::Kind::kResume;
  if (!on_mission_ && !(resumes && may_resume())) {
    refusal = StopReason::kNoMission;
    return Status::kNotPermitted;
  }
  if (resumes) return Resume();
  if (command_.kind == control::Kind::kPause) {
    paused_ = true;
    return Status::kOk;
  }
  if (goal_index_ + 1 >= goals_.size()) {
    refusal = StopReason::kLastWaypoint;
    return Status::kNotPermitted;
  }
  Skip();
  return Status::kOk;
}

// Of the waypoints that are left, as for a new goal. kStale: one on earth, and nobody knows where
// that is; kGoalForbidden: one where an area forbids it by now.
Status Pilot::CheckResume() const {
  HP_LOOP_BOUND(control::kMaxWaypoints)
  for (int i = goal_index_; i < goals_.size(); ++i) {
    Goal goal = goals_[i];
    const bool is_lost = goal.is_on_earth && map_from_odom_.status() != MapStatus::kTracking;
    if (is_lost && !on_mission_) return Status::kStale;
    FollowEarth(goal);
    if (!areas_.Permits(goal.position_odom)) return Status::kGoalForbidden;
  }
  return Status::kOk;
}

Status Pilot::Resume() {
  if (on_mission_ && !paused_) return Status::kOk;
  const Status status = CheckResume();
  if (!IsUsable(status)) return status;
  if (!on_mission_) {
    on_mission_ = true;
    wishes_.go = true;
    BeginLeg();
  }
  paused_ = false;
  return Status::kOk;
}

// The path by the waypoint is not that of the mission any more.
void Pilot::Skip() {
  ++goal_index_;
  ++goals_list_;
  BeginLeg();
}

// The goals themselves stay, for a resume.
void Pilot::DropGoals() {
  if (on_mission_) replanner_.Forget();
  on_mission_ = false;
  paused_ = false;
  held_at_ns_ = 0;
  if (may_resume_) return;
  goals_.Clear();
  goal_index_ = 0;
}

void Pilot::BeginLeg() {
  const Vec3& here = odometry_.pose().position;
  leg_start_odom_ = {here.x_m, here.y_m};
  held_at_ns_ = 0;
}

// What is driven to stays where it is on earth, as far as anyone knows where that is.
void Pilot::FollowEarth() {
  if (!on_mission_) return;
  HP_LOOP_BOUND(kMaxVias + 1)
  for (int i = goal_index_; i < goals_.size() && i <= goal_index_ + kMaxVias; ++i) {
    FollowEarth(goals_[i]);
  }
}

void Pilot::FollowEarth(Goal& goal) const {
  Vec2 place_odom;
  if (!goal.is_on_earth) return;
  if (!IsUsable(map_from_odom_.ToOdom(goal.latitude_ndeg, goal.longitude_ndeg, place_odom))) return;
  const float dx_m = place_odom.x_m - goal.position_odom.x_m;
  const float dy_m = place_odom.y_m - goal.position_odom.y_m;
  if (Sqrt(dx_m * dx_m + dy_m * dy_m) > kGoalFollows_m) goal.position_odom = place_odom;
}

// On to the next waypoint where this one was passed, or stood at for as long as it says; the last
// one is to be stopped at. A path that ends at a waypoint to be passed, since it cannot lead on
// there, ends at rest.
void Pilot::AdvanceGoal(const DriveFeedback& drives) {
  if (!on_mission_ || goal_index_ + 1 >= goals_.size()) return;
  const bool is_done =
      IsPassed(goal_index_)
          ? HasPassed(goal_index_) || (IsAtEndFor(goals_[goal_index_]) && drives.standstill)
          : HasStoodAt(drives);
  if (!is_done) return;
  ++goal_index_;
  BeginLeg();
}

// Whether the path leads on behind a waypoint, and the vehicle is where it does.
bool Pilot::IsPathBehind(int index) const {
  const CommittedPlan& plan = replanner_.committed();
  const auto number = static_cast<uint32_t>(index);
  if (!HasPlan() || plan.goal.list != goals_list_ || plan.goal.number <= number) return false;
  const float reach_m = config_.planner.replan.pass_radius_m + kPassSlack_m;
  const int at = PassingPoint(plan.path, 0, goals_[index].position_odom, reach_m);
  return at >= 0 && at <= replanner_.place().point;
}

// Near it, and beyond the line through it that halves the angle between the way to it and the way
// on; or where the path leads on from it, which may turn there.
bool Pilot::HasPassed(int index) const {
  const Vec3& position = odometry_.pose().position;
  const Vec2 here = {position.x_m, position.y_m};
  const Vec2 place = goals_[index].position_odom;
  const float reach_m = config_.planner.replan.pass_radius_m + kPassSlack_m;
  if (!(WayBetween(place, here).length_m <= reach_m)) return false;
  if (IsPathBehind(index)) return true;
  const Vec2 before = WayBetween(leg_start_odom_, place).direction;
  const Vec2 behind = WayBetween(place, goals_[index + 1].position_odom).direction;
  Vec2 across = {before.x_m + behind.x_m, before.y_m + behind.y_m};
  if (Sqrt(across.x_m * across.x_m + across.y_m * across.y_m) < kLeastSum) across = before;
  return across.x_m * (here.x_m - place.x_m) + across.y_m * (here.y_m - place.y_m) >= 0.0f;
}

// The time to hold begins when the vehicle has come to rest there.
bool Pilot::HasStoodAt(const DriveFeedback& drives) {
  const Goal& goal = goals_[goal_index_];
  if (held_at_ns_ == 0) {
    if (!drives.standstill || !IsAtEndFor(goal)) return false;
    held_at_ns_ = now_ns_;
  }
  return SecondsBetween(held_at_ns_, now_ns_) >= static_cast<float>(goal.hold_s);
}

// The next waypoint that the vehicle comes to rest at, or the one at which it has been looked far
// enough ahead; those before it are passed.
PlanGoal Pilot::WantedGoal() const {
  PlanGoal wanted;
  float way_m = 0.0f;
  int last = goal_index_;
  HP_LOOP_BOUND(kMaxVias)
  while (IsPassed(last) && way_m < kRouteAhead_m && !wanted.route.vias.full()) {
    static_cast<void>(
        wanted.route.vias.PushBack({goals_[last].position_odom, goals_[last].speed_mps}));
    ++last;
    way_m += WayBetween(goals_[last - 1].position_odom, goals_[last].position_odom).length_m;
  }
  const Goal& goal = goals_[last];
  wanted.position_odom = goal.position_odom;
  wanted.has_heading = goal.has_heading;
  wanted.heading_rad = goal.heading_rad;
  wanted.route.goal_speed_mps = goal.speed_mps;
  wanted.number = static_cast<uint32_t>(last);
  wanted.list = goals_list_;
  return wanted;
}

}  // namespace hardpack
