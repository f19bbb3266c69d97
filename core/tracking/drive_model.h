// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// How the wheels follow their commands, and where that takes the vehicle until a command that is
// given now takes effect. It is told every command and every measured wheel speed, and steps in
// kStep_ns whatever the ticks are. It controls nothing (core/tracking/tracking.h does).
//
//   common c = (w_r + w_l) / 2, differential d = (w_r - w_l) / 2, commands u(t) of both
//   c' = clamp((u_c(t - dead) + b_c - c) / lag_c, -slew, slew)
//   d' = clamp(q (L tanh(g u_d(t - dead) / L) + b_d - d) / lag_d, -slew, slew)
//   v = c r ground_per_wheel,  w = d 2 r ground_per_wheel / baseline
//
// The form and its numbers are fits to recordings of a Warthog (docs/vehicle.md, "How it moves").
// What the fit does not know is learned from the measured speeds: b_c, b_d by an observer of the
// speed with a bias, within kMaxBias_radps; q, how much quicker a turn follows than the fit says,
// by normalised least mean squares of what is measured over what the model changed by, within
// kMinQuickness to kMaxQuickness. Without measurements the model goes on by itself.

namespace hardpack {

// Wheel speeds, or commands of them, of both sides by what they do.
struct WheelParts {
  float common_radps = 0.0f;
  float differential_radps = 0.0f;  // positive turns to the left
};

constexpr WheelParts PartsOf(float left_radps, float right_radps) {
  return {0.5f * (right_radps + left_radps), 0.5f * (right_radps - left_radps)};
}

// tanh by its continued fraction to x^7 / x^6, +-1 from where that reaches it; within
// kTanhMaxError. Odd, never beyond +-1. Source: Lambert 1761, as in Abramowitz and Stegun 4.5.70.
inline constexpr float kTanhMaxError = 1.0e-4f;
float Tanh(float x);

// Settled differential speed of a command that lasts, and the command that a settled speed needs.
// The latter beyond kMaxLimitShare of the limit: that of kMaxLimitShare.
inline constexpr float kMaxLimitShare = 0.95f;
float SettledDifferential(const DynamicsParams& params, float command_radps);
float DifferentialCommand(const DynamicsParams& params, float settled_radps);

// Where the vehicle will be, and how fast, when a command that is given now takes effect.
struct DriveState {
  Pose2 pose;
  WheelParts wheels;
  float speed_mps = 0.0f;  // backwards: negative
  float yaw_rate_radps = 0.0f;
};

class DriveModel {
 public:
  static constexpr uint64_t kStep_ns = 10'000'000;
  static constexpr float kStep_s = 0.01f;
  static constexpr int kMaxDeadSteps = 50;  // the longest dead time of the table
  static constexpr int kMaxFeedbackSteps = 20;
  static constexpr int kHistory = 128;  // covers both, and is a power of two
  // A longer pause is a gap: the drives have stopped by themselves, or nobody knows.
  static constexpr int kMaxCatchUpSteps = 20;
  static constexpr float kMaxBias_radps = 2.5f;
  static constexpr float kMinQuickness = 0.75f;
  static constexpr float kMaxQuickness = 2.2f;
  static constexpr float kMaxWheel_radps = 100.0f;  // a report beyond is none

  // At rest. kParameterOutOfRange: odometry or dynamics; `vehicle` was checked before.
  Status Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                   const DynamicsParams& dynamics);

  // To now_ns: the command that was told last was in force since. kOk; kStale: after a gap, the
  // commands of before are forgotten and the wheels taken as measured; kNotStarted;
  // kInvalidArgument: time does not grow, then nothing changes. Wheel speeds are taken once each,
  // by their time; invalid ones, and those that are no number or too old, not at all.
  // Cost: at most kMaxCatchUpSteps steps, and kMaxFeedbackSteps corrections.
  Status Advance(uint64_t now_ns, const WheelFeedback& feedback);

  // Of this tick, until the next.
  void SetCommand(const WheelParts& command);

  // The state of a vehicle that is at `pose` now after the dead time. A pose that is not finite
  // comes back as it is. Cost: kMaxDeadSteps steps with a sine and a cosine at most.
  DriveState Predict(const Pose2& pose) const;

  const WheelParts& wheels() const { return at_[Place(0)]; }  // now
  const WheelParts& bias() const { return bias_; }
  float quickness() const { return quickness_; }
  float DifferentialLag_s() const { return params_.differential_lag_s / quickness_; }
  const DynamicsParams& params() const { return params_; }
  float RimWay_m() const { return rim_m_; }                 // of the vehicle, per radian of common
  float PerTurn() const { return differential_per_turn_; }  // differential speed per yaw rate

 private:
  int Place(int steps_back) const { return (newest_ - steps_back) & (kHistory - 1); }
  WheelParts DelayedCommand(int steps_ahead) const;
  WheelParts Next(const WheelParts& wheels, const WheelParts& command) const;
  void Forget(uint64_t now_ns);
  void StepOnce();
  void TakeFeedback(const WheelFeedback& feedback);
  void Learn(const WheelParts& taken, int back);

  DynamicsParams params_;
  float rim_m_ = 0.0f;
  float differential_per_turn_ = 0.0f;
  int32_t dead_steps_ = 0;   // whole ones ...
  float dead_share_ = 0.0f;  // ... and what is left, of a step
  bool configured_ = false;
  uint64_t at_ns_ = 0;        // of the newest step; 0: none yet
  uint64_t feedback_ns_ = 0;  // taken last
  int32_t newest_ = 0;        // place in both rings
  WheelParts command_;        // in force
  WheelParts bias_;
  float quickness_ = 1.0f;
  WheelParts commands_[kHistory];  // [step]: in force in the step that ended there
  WheelParts at_[kHistory];        // [step]: the wheels at its end
};
static_assert(std::is_trivially_copyable_v<DriveModel>);

}  // namespace hardpack
