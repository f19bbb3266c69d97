// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/kinematics/kinematics.h"

// Planner: the path as it is driven, from its parts.

namespace hardpack {

// Before all that is driven: its last point is the first of what follows.
void Planner::BeginPath() {
  plan_.lead_points = lead_.empty() ? 0 : lead_.size() - 1;
  plan_.path.Clear();
  plan_.path.Resize(plan_.lead_points);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < plan_.lead_points; ++k) plan_.path[k] = lead_[k];
}

bool Planner::EndsReverse() const {
  return lead_.size() >= 2 && IsReversed(lead_, lead_.size() - 2);
}

// `driven` with the way out of the start before it, and the turns on the spot before and behind.
// What does not fit is cut at the end.
void Planner::MakePath(const WorldPath& driven) {
  WorldPath& path = plan_.path;
  BeginPath();
  plan_.ends_short = false;
  plan_.base_status = Graver(plan_.search.status, sample_status_);
  // Behind a way out in reverse the vehicle has to stand, if only to drive on forward.
  if (plan_.pivots_first || EndsReverse()) {
    path.Resize(path.size() + 1);
    path.back() = {driven[0].x_m, driven[0].y_m, request_.start.pose.theta_rad};
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
  const bool must_turn =
      has_goal_heading_ && kept == driven.size() && Abs(end_error_rad) > kGoalHeading_rad;
  if (must_turn && !CanPivot(params_.vehicle)) {
    plan_.base_status = Status::kNeedsManoeuvre;
    return;
  }
  plan_.pivots_last = must_turn && !path.full();
  if (must_turn && path.full()) plan_.base_status = Graver(plan_.base_status, Status::kPathCut);
  if (plan_.pivots_last) {
    path.Resize(path.size() + 1);
    path.back() = {driven.back().x_m, driven.back().y_m, WrapAngle(request_.goal_heading_rad)};
  }
}

bool Planner::MayEndShort() const {
  const int kept = plan_.check.collision_point;
  if (plan_.ends_short || kept < plan_.lead_points + 2) return false;
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

// The stretch from a start in an obstacle to the first point that is clear of it, which is within
// it still; the footprint's own overlap may last longer than the middle's.
int Planner::SlowPoints() const {
  if (!lead_.empty()) {
    // Straight on from where nothing was seen to be near is no slow way.
    const bool is_tight = lead_failure_ != Status::kOk || request_.lead_out > 0;
    const int overlap = plan_.check.overlap_points;
    return is_tight && overlap < plan_.lead_points ? plan_.lead_points : overlap;
  }
  if (!plan_.search.start_in_obstacle) return plan_.check.overlap_points;
  const Costmap& map = costmap();
  int clear = 0;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (clear < plan_.path.size() &&
         map.Lethal(map.window.Index(CellAt({plan_.path[clear].x_m, plan_.path[clear].y_m})))) {
    ++clear;
  }
  return clear + 1 < plan_.check.overlap_points ? plan_.check.overlap_points : clear + 1;
}

// Only of a vehicle that stands, and has no via to drive to: another one has to be brought to rest
// first.
bool Planner::IsHere() const {
  if (first_leg_ < request_.route.vias.size()) return false;
  return request_.start.speed_mps == 0.0f &&
         AreWithin(request_.goal_odom, PlaceOf(request_.start.pose), kHere_m);
}

void Planner::Stay() {
  const Pose2& here = request_.start.pose;
  const float turn_rad =
      request_.has_goal_heading ? WrapAngle(request_.goal_heading_rad - here.theta_rad) : 0.0f;
  plan_.stays = lead_.empty();
  plan_.pivots_last = Abs(turn_rad) > kGoalHeading_rad;
  if (plan_.pivots_last && !CanPivot(params_.vehicle)) return End(Status::kNeedsManoeuvre);
  plan_.base.Resize(2);
  plan_.base[0] = here;
  plan_.base[1] = here;
  if (plan_.pivots_last) plan_.base[1].theta_rad = WrapAngle(request_.goal_heading_rad);
  BeginPath();
  plan_.path.Resize(plan_.lead_points + 2);
  plan_.path[plan_.lead_points] = plan_.base[0];
  plan_.path[plan_.lead_points + 1] = plan_.base[1];
  plan_.search.status = Status::kOk;
  plan_.search.end = CellAt(request_.goal_odom);
  plan_.base_status = Status::kOk;
  plan_.optimizer_status = Status::kOk;
  const Status status = StartCheck();
  if (!IsUsable(status)) End(status);  // and does not search once more, which could end here again
}

}  // namespace hardpack
