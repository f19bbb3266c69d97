// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/stop_motion.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

constexpr float kRest_mps = 0.03f;
constexpr float kRest_radps = 0.03f;
// A turn moves the outline's corners, which are about so far from the middle.
constexpr float kCorner_m = 1.1f;
// What it is off by grows for so long; from then on it has stopped changing, or slows down. What
// the speed is off by lies aside by what the heading turns through meanwhile, 0.5 rad; what the
// turn is off by moves the front's corners ahead by their lever, 0.7 m, and aside.
constexpr float kOff_s = 0.5f;
constexpr float kAsideOfSpeed = 0.5f;
constexpr float kAlongOfTurn_m = 0.7f;
constexpr float kLeastSpacing_m = 0.08f;
// Of all poses so many lie along a stop of about the expected length; the others are in reserve.
constexpr float kSpacedPoses = 36.0f;
// How fast the tracker brings the wheels' turn to what it wants (core/tracking/tracking.h).
constexpr float kTurnGain_per_s = 4.0f;

bool IsAtRest(const DriveState& state) {
  return Abs(state.speed_mps) < kRest_mps && Abs(state.yaw_rate_radps) < kRest_radps;
}

// What a stop may take, roughly: for the spacing alone.
float ExpectedWay(const DriveModel& model, const DriveState& state, const StopWay& way) {
  const DynamicsParams& drives = model.params();
  const float speed_mps = Max(Abs(state.speed_mps), Abs(way.reference_mps));
  const float lags_s = drives.dead_time_s + drives.common_lag_s + drives.speed_lag_s;
  const float brake_mps2 = Max(way.deceleration_mps2, 0.1f);
  return speed_mps * lags_s + speed_mps * speed_mps / (2.0f * brake_mps2) +
         kCorner_m * Abs(state.yaw_rate_radps);
}

float CurvatureAt(const StopWay& way, float along_m) {
  const float place =
      Clamp(along_m / StopWay::kStep_m, 0.0f, static_cast<float>(StopWay::kCurvatures - 1));
  const int before = ClampInt(FloorToInt(place), 0, StopWay::kCurvatures - 2);
  const float share = place - static_cast<float>(before);
  const float from = way.curvature_per_m[before];
  return from + share * (way.curvature_per_m[before + 1] - from);
}

// As the tracker brakes: the common part leads by its lags, the differential part goes to what the
// path's curvature asks for.
WheelParts BrakeCommand(const DriveModel& model, const StopWay& way, float braked_s, float along_m,
                        const DriveState& state) {
  const DynamicsParams& drives = model.params();
  const float led_s = braked_s + drives.common_lag_s + drives.speed_lag_s;
  const float left_mps = Max(Abs(way.reference_mps) - way.deceleration_mps2 * led_s, 0.0f);
  const float told_mps = way.reference_mps < 0.0f ? -left_mps : left_mps;
  const float turn_radps = state.speed_mps * CurvatureAt(way, along_m) * model.PerTurn();
  const float at_radps = state.wheels.differential_radps;
  const float slew_radps2 = model.DifferentialSlew_radps2();
  const float change = Clamp(kTurnGain_per_s * (turn_radps - at_radps), -slew_radps2, slew_radps2);
  const float reachable_radps = at_radps + ScrubOf(drives, at_radps) - state.integral_radps +
                                model.DifferentialLag_s() * change;
  return {.common_radps = told_mps / model.RimWay_m() - model.common_bias_radps(),
          .differential_radps =
              DifferentialCommand(drives, reachable_radps, state.wheels.common_radps)};
}

// What steered wheels are set to when a stop begins, as far as the motion tells.
float HeldCurvature(const DriveState& state, float largest_per_m) {
  const bool rolls = Abs(state.speed_mps) >= kRest_mps;
  return rolls ? Clamp(state.yaw_rate_radps / state.speed_mps, -largest_per_m, largest_per_m)
               : 0.0f;
}

void TurnAlong(const DriveModel& model, float curvature_per_m, DriveState& state) {
  state.yaw_rate_radps = curvature_per_m * state.speed_mps;
  state.wheels.differential_radps = state.yaw_rate_radps * model.PerTurn();
}

// Keeps a pose where the vehicle has moved far enough since the last one that was kept.
class PoseKeeper {
 public:
  PoseKeeper(float spacing_m, const MotionError& error, SweptMotion& motion)
      : spacing_m_(spacing_m),
        along_mps_(error.speed_mps + kAlongOfTurn_m * error.yaw_rate_radps),
        aside_mps_(kAsideOfSpeed * error.speed_mps + kCorner_m * error.yaw_rate_radps),
        motion_(motion) {}
  void Add(const DriveState& state, float moved_m, float step_s) {
    since_m_ += moved_m;
    ahead_s_ = Min(ahead_s_ + step_s, kOff_s);
    if (since_m_ < spacing_m_ || motion_.size() + 1 >= kMaxSweptPoses) return;
    Keep(state);
  }
  void Keep(const DriveState& state) {
    since_m_ = 0.0f;
    motion_.Resize(motion_.size() + 1);
    motion_.back() = {state.pose, state.speed_mps, along_mps_ * ahead_s_, aside_mps_ * ahead_s_};
  }

 private:
  float spacing_m_;
  float along_mps_;  // what it is off by grows by so much
  float aside_mps_;
  SweptMotion& motion_;
  float ahead_s_ = 0.0f;
  float since_m_ = 0.0f;
};

}  // namespace

void RollOutStop(const DriveModel& model, const Pose2& pose, const StopWay& way, StopKind kind,
                 SweptMotion& motion) {
  motion.Clear();
  DriveState state = model.StateAt(pose);
  const float spacing_m = Max(ExpectedWay(model, state, way) / kSpacedPoses, kLeastSpacing_m);
  PoseKeeper keeper(spacing_m, way.error, motion);
  keeper.Keep(state);
  float along_m = 0.0f;
  const auto roll = [&](const WheelParts& command, float step_s) {
    model.Roll(command, step_s, state);
    const float way_m = Abs(state.speed_mps) * step_s;
    along_m += way_m;
    keeper.Add(state, way_m + kCorner_m * Abs(state.yaw_rate_radps) * step_s, step_s);
  };
  HP_LOOP_BOUND(DriveModel::kMaxDeadSteps + 1)
  for (int step = 1; step <= model.dead_steps() + 1; ++step) {
    roll(model.CommandIn(step), DriveModel::kStep_s);
  }
  const bool holds = kind == StopKind::kZero && way.held_curvature_per_m > 0.0f;
  const float held_per_m = holds ? HeldCurvature(state, way.held_curvature_per_m) : 0.0f;
  HP_LOOP_BOUND(kMaxStopSteps)
  for (int step = 0; step < kMaxStopSteps && !IsAtRest(state); ++step) {
    if (holds) TurnAlong(model, held_per_m, state);
    const float braked_s = kStopStep_s * static_cast<float>(step);
    roll(
        kind == StopKind::kZero ? WheelParts{} : BrakeCommand(model, way, braked_s, along_m, state),
        kStopStep_s);
  }
  keeper.Keep(state);
}

}  // namespace hardpack
