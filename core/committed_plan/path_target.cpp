// SPDX-License-Identifier: Apache-2.0
#include "core/committed_plan/path_target.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// Over this way, and over this time at speed, the changes of curvature and speed are taken.
constexpr float kSpan_m = 0.15f;
constexpr float kSpan_s = 0.1f;
// Braking begins as gently as the mean over so much time to come allows.
constexpr float kEase_s = 0.25f;

// So far before a place where the vehicle has to stand the path is still what leads there: behind
// it may look anywhere.
constexpr float kBeforeStanding_m = 0.001f;

// The first point behind `point` where the direction of driving changes or the vehicle has to stand
// for another reason.
int EndOfDirection(const WorldPath& path, int point, bool reverse) {
  const int standing = StandingPoint(path, point);
  int end = point;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (end < standing && IsReversed(path, end) == reverse) ++end;
  return end;
}

float Reach(const PathFollower& follower, const TrackingParams& params) {
  return Max(params.min_lookahead_m, Abs(follower.speed_mps) * params.lookahead_s);
}

Pose2 Ahead(Pose2 pose, float way_m) {
  const SinCosPair heading = SinCos(pose.theta_rad);
  pose.x_m += way_m * heading.cos;
  pose.y_m += way_m * heading.sin;
  return pose;
}

// What the path's speed changes by, in the direction of driving, from from_mps on.
template <typename StateAhead>
float AccelerationAhead(const StateAhead& state_at, float from_mps, float speed_mps) {
  const auto over = [&](float way_m) {
    const float to_mps = state_at(kStartWay_m + way_m).speed_mps;
    return (to_mps * to_mps - from_mps * from_mps) / (2.0f * way_m);
  };
  return Min(over(kSpan_m), over(Max(kSpan_m, kEase_s * Abs(speed_mps))));
}

// At a turn on the spot that has to wait until the vehicle stands: straight on to rest, whatever
// heading the path has behind it.
void RollOut(const PathFollower& follower, const TrackingParams& params, TrackingInput& target) {
  target.path = follower.pose;
  target.speed_limit_mps = 0.0f;
  target.aim.pose = Ahead(follower.pose, Reach(follower, params));
}

}  // namespace

Status PathTarget(const CommittedPlan& plan, const PathFollower& follower,
                  const TrackingParams& params, TrackingInput& target) {
  target = TrackingInput{};
  target.pose = follower.pose;
  const WorldPath& path = plan.path;
  const int point = follower.place.point;
  const bool is_on_path =
      path.size() >= 2 && plan.speed.size() == path.size() && point >= 0 && point + 1 < path.size();
  if (!is_on_path) return Status::kPathTooShort;
  const float along_m = follower.place.along_m;
  const bool turns_here = TurnsOnTheSpotAt(path, point);
  const bool reverse = !turns_here && IsReversed(path, point);
  const int standing =
      turns_here ? point : RestPoint(plan, point, EndOfDirection(path, point, reverse));
  target.reverse = reverse;
  const float standing_m = WayTo(path, standing);
  target.left_m = Max(standing_m - along_m, 0.0f);
  if (TurnsOnTheSpotAt(path, standing) && target.left_m <= kAtPoint_m && follower.stands) {
    target.turn = true;
    target.aim.pose = path[standing + 1];
    target.path = follower.pose;
    return Status::kOk;
  }
  if (turns_here) {
    RollOut(follower, params, target);
    return Status::kOk;
  }
  const float last_m = Max(standing_m - kBeforeStanding_m, 0.0f);
  const auto state_at = [&](float ahead_m) {
    return StateAt(plan, Min(along_m + Min(ahead_m, target.left_m), last_m));
  };
  const PathState here = state_at(0.0f);
  const PathState start = state_at(kStartWay_m);
  target.path = here.pose;
  target.turn_curvature_per_m = state_at(follower.turn_ahead_m).curvature_per_m;
  const PathState wheels = state_at(follower.wheel_ahead_m);
  target.wheel_curvature_per_m = wheels.curvature_per_m;
  target.speed_limit_mps = target.left_m <= kStartWay_m ? 0.0f : start.speed_mps;

  const float span_m = kSpan_m + kSpan_s * Abs(follower.speed_mps);
  const float ahead_m = Min(span_m, target.left_m - follower.wheel_ahead_m);
  if (ahead_m > kStartWay_m) {
    const PathState ahead = state_at(follower.wheel_ahead_m + ahead_m);
    const float bend_per_m = ahead.curvature_per_m - wheels.curvature_per_m;
    target.curvature_rate_per_m2 = (reverse ? -bend_per_m : bend_per_m) / ahead_m;
  }
  if (Min(span_m, target.left_m) > kStartWay_m) {
    target.acceleration_mps2 = AccelerationAhead(state_at, start.speed_mps, follower.speed_mps);
  }

  // Beyond the end the path goes on straight, or the last stretch would be aimed at a point beside
  // the vehicle.
  const float reach_m = Reach(follower, params);
  const float beyond_m = Max(reach_m - target.left_m, 0.0f);
  target.aim.pose = Ahead(state_at(reach_m).pose, reverse ? -beyond_m : beyond_m);
  return Status::kOk;
}

}  // namespace hardpack
