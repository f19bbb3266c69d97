// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/kinematics/kinematics.h"
#include "hal/onboard/pilot/pilot.h"

// Pilot: where the vehicle goes until it is at rest, rolled out in every tick from its actual
// state and held against what stands around it; and what nobody has seen where it starts.

namespace hardpack {
namespace {

// What it does below these is no motion.
constexpr float kMoves_mps = 0.02f;
constexpr float kMoves_radps = 0.02f;
constexpr float kCreeps_mps = 0.3f;
// So far ahead the way is looked at before it is set out on, at about so many poses, with the
// margin of about this speed.
constexpr float kFirstWay_m = 1.2f;
constexpr int kFirstPoses = 12;
constexpr float kFirstSpeed_mps = 0.2f;
// So long it stands after somebody was lost from sight beside it: who comes nearer still is where
// no beam falls, or taken for the vehicle itself.
constexpr uint64_t kPersonBeside_ns = 2'000'000'000;
// Somebody can reach the vehicle whose surface is within 0.5 m of what a turn on the spot sweeps:
// the middle of what is seen of them is no more than half a body farther away.
constexpr float kBeside_m = 0.75f;

bool MayMove(Mode mode) {
  return mode == Mode::kDriving || mode == Mode::kSafeStop;
}

}  // namespace

void Pilot::ConfigureSweep() {
  sweep_.Configure(FootprintOf(config_.planner.vehicle), config_.onboard.safety.sweep_margin_m);
  sweep_advice_ = WayAhead::kClear;
  swept_plan_ = 0;
  comes_to_rest_ = false;
  ways_out_.Reset();
  has_start_ = false;
}

// At rest nothing is swept, so the way that is about to be driven is looked at instead: else each
// beginning of a motion would bring the vehicle a little nearer. A vehicle that creeps is brought
// to rest, for the same reason: each tick in which it may go on would.
WayAhead Pilot::JudgeSweep() {
  if (!MayMove(permission_.mode)) {
    comes_to_rest_ = false;
    ways_out_.NotHeld();
    return WayAhead::kClear;
  }
  const DriveModel& model = tracker_.model();
  const bool stands = Abs(model.speed_mps()) < kMoves_mps && tracker_.speed_mps() <= 0.0f &&
                      Abs(model.yaw_rate_radps()) < kMoves_radps;
  if (stands) {
    comes_to_rest_ = false;
    return JudgeSettingOut();
  }
  ways_out_.Reset();
  const WayAhead advice = JudgeStop();
  if (advice != WayAhead::kClear) {
    swept_plan_ = replanner_.committed().number;
    comes_to_rest_ = Abs(model.speed_mps()) < kCreeps_mps;
  }
  return comes_to_rest_ ? WayAhead::kTooNear : advice;
}

// Either stop will do, as long as there is one: so this brakes in the last tick in which it can. Of
// two that touch the one that does so more slowly.
WayAhead Pilot::JudgeStop() {
  const DriveModel& model = tracker_.model();
  const StampedPose& here = odometry_.pose();
  const Pose2 pose = {here.position.x_m, here.position.y_m, here.yaw_rad};
  StopWay way;
  way.error = tracker_.prediction_error();
  const VehicleParams& vehicle = config_.planner.vehicle;
  way.held_curvature_per_m = CanPivot(vehicle) ? 0.0f : MostCurvature(vehicle);
  RollOutStop(model, pose, way, StopKind::kZero, swept_);
  const SweepResult zero = sweep_.Try({swept_.begin(), static_cast<size_t>(swept_.size())});
  if (zero.clear) return WayAhead::kClear;
  if (replanner_.committed().number == 0) return WayAhead::kTooNear;
  way.reference_mps = tracker_.reverse() ? -tracker_.speed_mps() : tracker_.speed_mps();
  way.deceleration_mps2 = speed_on_ground_.max_deceleration_mps2;
  CurvaturesFrom(replanner_.committed(), replanner_.place().along_m, StopWay::kStep_m,
                 way.curvature_per_m);
  RollOutStop(model, pose, way, StopKind::kAlong, swept_);
  const SweepResult along = sweep_.Try({swept_.begin(), static_cast<size_t>(swept_.size())});
  if (along.clear) return WayAhead::kClear;
  return along.impact_mps < zero.impact_mps ? WayAhead::kObstacle : WayAhead::kTooNear;
}

// Where it would touch, or has just stopped for that, it waits for another plan, and has one made
// from where it stands.
WayAhead Pilot::JudgeSettingOut() {
  const CommittedPlan& plan = replanner_.committed();
  if (permission_.mode != Mode::kDriving || plan.number == 0) {
    ways_out_.NotHeld();
    return WayAhead::kClear;
  }
  const StampedPose& at = odometry_.pose();
  if (people_.IsAnyoneWithin({at.position.x_m, at.position.y_m},
                             sweep_.footprint().pivot_radius_m + kBeside_m, now_ns_,
                             kPersonBeside_ns)) {
    ways_out_.NotHeld();
    return WayAhead::kObstacle;
  }
  LayFirstWay();
  const bool clear = plan.number != swept_plan_ &&
                     sweep_.Try({swept_.begin(), static_cast<size_t>(swept_.size())}).clear;
  if (clear) {
    ways_out_.NotHeld();
    return WayAhead::kClear;
  }
  if (ways_out_.Held(now_ns_)) replanner_.Forget();
  return WayAhead::kObstacle;
}

// From where the vehicle is: the turn on the spot that is due, or the next stretch of its path.
void Pilot::LayFirstWay() {
  const CommittedPlan& plan = replanner_.committed();
  const StampedPose& here = odometry_.pose();
  const Pose2 pose = {here.position.x_m, here.position.y_m, here.yaw_rad};
  swept_.Clear();
  static_cast<void>(swept_.PushBack({pose, 0.0f}));
  const PathPlace& place = replanner_.place();
  const int standing = StandingPoint(plan.path, place.point);
  const float left_m = WayTo(plan.path, standing) - place.along_m;
  const bool turns = TurnsOnTheSpotAt(plan.path, standing) && left_m <= kAtPoint_m;
  const float turn_rad =
      turns ? WrapAngle(plan.path[standing + 1].theta_rad - pose.theta_rad) : 0.0f;
  HP_LOOP_BOUND(kFirstPoses)
  for (int k = 1; k <= kFirstPoses; ++k) {
    const float share = static_cast<float>(k) / static_cast<float>(kFirstPoses);
    Pose2 next = pose;
    if (turns) {
      next.theta_rad = WrapAngle(pose.theta_rad + share * turn_rad);
    } else {
      next = hardpack::StateAt(plan, place.along_m + Min(share * kFirstWay_m, left_m)).pose;
    }
    static_cast<void>(swept_.PushBack({next, kFirstSpeed_mps}));
  }
}

// Near the place where the map began nothing beside the vehicle has been seen yet.
void Pilot::FillUnseenStart(VehicleState& state) const {
  const Vec3& here = odometry_.pose().position;
  const float dx_m = here.x_m - start_odom_.x_m;
  const float dy_m = here.y_m - start_odom_.y_m;
  const float reach_m = config_.planner.path.unseen_start_m;
  state.has_unseen_start = has_start_ && dx_m * dx_m + dy_m * dy_m < reach_m * reach_m;
  state.unseen_start = start_odom_;
  state.lead_out = ways_out_.preferred();
}

bool Pilot::IsOnLeadOut() const {
  const CommittedPlan& plan = replanner_.committed();
  return plan.number != 0 && replanner_.place().point < plan.lead_points;
}

}  // namespace hardpack
