// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Models how the wheels follow their commands and the body its wheels, and where this takes the
// vehicle until a command given now takes effect. It is given every command, every measured wheel
// speed and the body's motion, and runs in steps of kStep_ns, independent of the ticks. It controls
// nothing (core/tracking/tracking.h does).
//
//   common c = (w_r + w_l) / 2, differential d = (w_r - w_l) / 2, commands u(t - dead) of both
//   c' = clamp((u_c + b_c - c) / lag_c, -slew_c, slew_c)
//   d' = clamp(q (s - F(d) + i - d) / lag_d, -q slew_d, q slew_d)
//   s  = u_d / (1 + (u_d / a)^8)^(1/8), a = limit - slope |c|
//   F  = scrub d / sqrt(d^2 + width^2)                      loss by tyre scrub
//   i' = (s - d) / integral_time                            the drives' compensation of it
//   v' = (k_v r ground_per_wheel c - v) / speed_lag,  w' = (k_w d / per_turn - w) / yaw_rate_lag
//   v_y = -w t v / sqrt(v^2 + v_t^2)                        it turns about a point ahead
//
// The form and its numbers are fitted to recordings of a Warthog (docs/simulation.md, "The
// vehicle"). What the fit does not cover is learned: b_c and i by an observer of the wheel speed
// with a bias, within kMaxBias_radps and kMaxIntegral_radps; q, how much quicker a turn follows
// than in the fit, and k_v and k_w, the effect of wheel rotation on this ground, by normalised
// least mean squares of measurement against model, within their limits below. Without measurements
// the model runs open loop.

namespace hardpack {

// Wheel speeds or wheel commands of both sides, split into their common and differential parts.
struct WheelParts {
  float common_radps = 0.0f;
  float differential_radps = 0.0f;  // positive turns to the left
};

constexpr WheelParts PartsOf(float left_radps, float right_radps) {
  return {0.5f * (right_radps + left_radps), 0.5f * (right_radps - left_radps)};
}

// The differential that the drives reach for a command while the common part is common_radps, and
// the command that a differential needs. The latter, beyond kMaxLimitShare of the limit, is that
// for kMaxLimitShare, 1.09 times the limit. Odd in the differential part.
inline constexpr float kMaxLimitShare = 0.95f;
float ReachableDifferential(const DynamicsParams& params, float command_radps, float common_radps);
float DifferentialCommand(const DynamicsParams& params, float reachable_radps, float common_radps);
// F above.
float ScrubOf(const DynamicsParams& params, float differential_radps);

// The body's motion, from odometry.
struct BodyMotion {
  bool valid = false;
  float speed_mps = 0.0f;
  float yaw_rate_radps = 0.0f;
};

// The predicted position and speed when a command given now takes effect.
struct DriveState {
  Pose2 pose;
  WheelParts wheels;
  float integral_radps = 0.0f;  // i
  float speed_mps = 0.0f;       // of the body; backwards: negative
  float yaw_rate_radps = 0.0f;  // of the body
};

class DriveModel {
 public:
  static constexpr uint64_t kStep_ns = 10'000'000;
  static constexpr float kStep_s = 0.01f;
  static constexpr int kMaxDeadSteps = 50;  // the longest dead time of the table
  static constexpr int kMaxFeedbackSteps = 20;
  static constexpr int kHistory = 128;  // covers both, and is a power of two
  // A longer pause is a gap: the drives have stopped on their own, or their state is unknown.
  static constexpr int kMaxCatchUpSteps = 20;
  static constexpr float kMaxBias_radps = 2.5f;
  static constexpr float kMaxIntegral_radps = 4.0f;
  static constexpr float kMinQuickness = 0.5f;
  static constexpr float kMaxQuickness = 2.5f;
  static constexpr float kMinGround = 0.7f;  // of k_v and k_w
  static constexpr float kMaxGround = 1.3f;
  static constexpr float kMaxWheel_radps = 100.0f;  // reports beyond are ignored
  static constexpr float kMaxBody_mps = 50.0f;      // the same
  static constexpr float kMaxBody_radps = 20.0f;

  // At rest. kParameterOutOfRange: odometry or dynamics; `vehicle` was checked before.
  Status Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                   const DynamicsParams& dynamics);

  // Advances to now_ns, with the last given command in force. kOk; kStale: after a gap, earlier
  // commands are dropped and the wheels set as measured; kNotStarted; kInvalidArgument: time does
  // not increase, and nothing changes. Wheel speeds are used once each, by their time; invalid
  // ones, and those that are not finite or too old, not at all; the body's motion is that of
  // now_ns. Cost: at most kMaxCatchUpSteps steps and kMaxFeedbackSteps corrections.
  Status Advance(uint64_t now_ns, const WheelFeedback& feedback, const BodyMotion& body);

  // The command of this tick, until the next.
  void SetCommand(const WheelParts& command);

  // One step from any state, with a command in force at the drives: for rolling out a motion.
  // Preconditions: finite, 0 < step_s <= 0.05. Constant cost.
  void Roll(const WheelParts& command, float step_s, DriveState& state) const;
  // The present state of a vehicle at `pose`.
  DriveState StateAt(const Pose2& pose) const;
  // The command in force at the drives in the step that ends this many steps from now, if the last
  // command stays in force. Precondition: steps_ahead >= 1.
  WheelParts CommandIn(int steps_ahead) const;
  int dead_steps() const { return dead_steps_; }

  // The state after the dead time of a vehicle that is at `pose` now. A pose that is not finite is
  // returned unchanged. Cost: at most kMaxDeadSteps steps with a sine and a cosine each.
  DriveState Predict(const Pose2& pose) const;

  // How far this lies ahead of now, in whole steps.
  uint64_t Ahead_ns() const { return static_cast<uint64_t>(AheadSteps()) * kStep_ns; }

  const WheelParts& wheels() const { return at_[Place(0)]; }  // now
  float speed_mps() const { return speed_mps_; }              // of the body, now
  float yaw_rate_radps() const { return yaw_rate_radps_; }
  float common_bias_radps() const { return bias_radps_; }
  float integral_radps() const { return integral_radps_; }
  float quickness() const { return quickness_; }
  float DifferentialLag_s() const { return params_.differential_lag_s / quickness_; }
  float DifferentialSlew_radps2() const { return params_.differential_slew_radps2 * quickness_; }
  const DynamicsParams& params() const { return params_; }
  float RimWay_m() const { return rim_m_ * speed_ground_; }  // of the vehicle, per radian of common
  float PerTurn() const {
    return differential_per_turn_ / turn_ground_;
  }  // differential speed
     // per yaw rate
  // How far ahead of the vehicle's centre it turns; negative in reverse.
  float TurningPoint_m(float speed_mps) const;
  float TurningPointChange_s(float speed_mps) const;  // its derivative by the speed

 private:
  int Place(int steps_back) const { return (newest_ - steps_back) & (kHistory - 1); }
  int AheadSteps() const { return dead_steps_ + (dead_share_ > 0.5f ? 1 : 0); }
  WheelParts DelayedCommand(int steps_ahead) const;
  void Step(const WheelParts& command, float step_s, DriveState& state) const;
  DriveState Now() const;
  void Forget(uint64_t now_ns);
  void StepOnce();
  void TakeFeedback(const WheelFeedback& feedback);
  void TakeBody(const BodyMotion& body);
  void Learn(const WheelParts& taken, int back);

  DynamicsParams params_;
  float rim_m_ = 0.0f;
  float differential_per_turn_ = 0.0f;
  float turning_point_m_ = 0.0f;
  float turning_point_speed_mps_ = 1.0f;
  int32_t dead_steps_ = 0;   // whole steps ...
  float dead_share_ = 0.0f;  // ... and the remaining fraction of a step
  bool configured_ = false;
  uint64_t at_ns_ = 0;        // of the newest step; 0: none yet
  uint64_t feedback_ns_ = 0;  // last used
  int32_t newest_ = 0;        // place in both rings
  WheelParts command_;        // in force
  float bias_radps_ = 0.0f;   // of the common part
  float integral_radps_ = 0.0f;
  float quickness_ = 1.0f;
  float speed_mps_ = 0.0f;
  float yaw_rate_radps_ = 0.0f;
  float speed_ground_ = 1.0f;
  float turn_ground_ = 1.0f;
  WheelParts commands_[kHistory];  // [step]: in force in the step that ended there
  WheelParts at_[kHistory];        // [step]: the wheels at its end
};
static_assert(std::is_trivially_copyable_v<DriveModel>);

}  // namespace hardpack
