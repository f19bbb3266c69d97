// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/drive_model.h"

#include "config/validate.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

// The observer: which part of a measured difference is taken at once, and how fast a lasting one
// becomes a bias.
constexpr float kTakenAtOnce = 0.5f;
constexpr float kBiasRate_radps = 2.0f;
// A bias belongs to what is being driven: without measurements it fades, by half in 0.35 s.
constexpr uint64_t kFreshBias_ns = 100'000'000;
constexpr float kBiasFade = 0.98f;
// The quickness: the steps over which a change is looked at, the change from which on it tells
// something, the part of what it tells that is taken, and at most.
constexpr int kLearnSteps = 2;
constexpr float kLeastChange_radps = 0.05f;
constexpr float kQuicknessRate = 0.08f;
constexpr float kMostLearned = 0.05f;
// From here on the continued fraction is above 1.
constexpr float kTanhEnd = 4.97f;
constexpr int kNewtonSteps = 5;

float Toward(float from_radps, float settled_radps, float lag_s, float slew_radps2) {
  const float rate = Clamp((settled_radps - from_radps) / lag_s, -slew_radps2, slew_radps2);
  return from_radps + rate * DriveModel::kStep_s;
}

WheelParts Sum(const WheelParts& a, const WheelParts& b) {
  return {a.common_radps + b.common_radps, a.differential_radps + b.differential_radps};
}

}  // namespace

float Tanh(float x) {
  if (Abs(x) >= kTanhEnd) return x > 0.0f ? 1.0f : -1.0f;
  const float x2 = x * x;
  const float over = x * (135135.0f + x2 * (17325.0f + x2 * (378.0f + x2)));
  const float under = 135135.0f + x2 * (62370.0f + x2 * (3150.0f + x2 * 28.0f));
  return Clamp(over / under, -1.0f, 1.0f);
}

float SettledDifferential(const DynamicsParams& params, float command_radps) {
  const float limit_radps = params.differential_limit_radps;
  return limit_radps * Tanh(params.differential_gain * command_radps / limit_radps);
}

// Newton's steps from below: tanh is concave there, so they never pass the root.
float DifferentialCommand(const DynamicsParams& params, float settled_radps) {
  const float limit_radps = params.differential_limit_radps;
  const float share = Min(Abs(settled_radps) / limit_radps, kMaxLimitShare);
  float x = share;
  HP_LOOP_BOUND(kNewtonSteps)
  for (int i = 0; i < kNewtonSteps; ++i) {
    const float reached = Tanh(x);
    x += (share - reached) / (1.0f - reached * reached);
  }
  const float command_radps = x * limit_radps / params.differential_gain;
  return settled_radps < 0.0f ? -command_radps : command_radps;
}

Status DriveModel::Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                             const DynamicsParams& dynamics) {
  configured_ = false;
  if (FirstInvalidParameter(odometry) != nullptr || FirstInvalidParameter(dynamics) != nullptr) {
    return Status::kParameterOutOfRange;
  }
  params_ = dynamics;
  rim_m_ = vehicle.wheel_radius_m * odometry.ground_per_wheel;
  differential_per_turn_ = vehicle.skid_baseline_m / (2.0f * rim_m_);
  const float steps = dynamics.dead_time_s / kStep_s;
  dead_steps_ = ClampInt(FloorToInt(steps), 0, kMaxDeadSteps - 1);
  dead_share_ = Clamp(steps - static_cast<float>(dead_steps_), 0.0f, 1.0f);
  command_ = WheelParts{};
  feedback_ns_ = 0;
  Forget(0);
  configured_ = true;
  return Status::kOk;
}

void DriveModel::Forget(uint64_t now_ns) {
  at_ns_ = now_ns;
  newest_ = 0;
  bias_ = WheelParts{};
  quickness_ = 1.0f;
  HP_LOOP_BOUND(kHistory)
  for (WheelParts& command : commands_) command = WheelParts{};
  HP_LOOP_BOUND(kHistory)
  for (WheelParts& wheels : at_) wheels = WheelParts{};
}

// The command that is in force at the drives in the step that ends steps_ahead after the newest,
// 1 to dead_steps_ + 1: a mean of the two that share it.
WheelParts DriveModel::DelayedCommand(int steps_ahead) const {
  const int back = dead_steps_ - steps_ahead;
  const WheelParts& later = back >= 0 ? commands_[Place(back)] : command_;
  const WheelParts& earlier = commands_[Place(back + 1)];
  const float share = dead_share_;
  return {
      later.common_radps + share * (earlier.common_radps - later.common_radps),
      later.differential_radps + share * (earlier.differential_radps - later.differential_radps)};
}

WheelParts DriveModel::Next(const WheelParts& wheels, const WheelParts& command) const {
  const float settled_radps = SettledDifferential(params_, command.differential_radps);
  return {Toward(wheels.common_radps, command.common_radps + bias_.common_radps,
                 params_.common_lag_s, params_.slew_radps2),
          Toward(wheels.differential_radps, settled_radps + bias_.differential_radps,
                 DifferentialLag_s(), params_.slew_radps2)};
}

void DriveModel::StepOnce() {
  if (at_ns_ - feedback_ns_ > kFreshBias_ns) {
    bias_ = {kBiasFade * bias_.common_radps, kBiasFade * bias_.differential_radps};
  }
  const WheelParts next = Next(wheels(), DelayedCommand(1));
  newest_ = (newest_ + 1) & (kHistory - 1);
  commands_[newest_] = command_;
  at_[newest_] = next;
  at_ns_ += kStep_ns;
}

void DriveModel::TakeFeedback(const WheelFeedback& feedback) {
  const bool is_new = feedback.valid && feedback.time_ns > feedback_ns_;
  // Also false for what is no number.
  const bool is_speed =
      Abs(feedback.left_radps) <= kMaxWheel_radps && Abs(feedback.right_radps) <= kMaxWheel_radps;
  if (!is_new || !is_speed) return;
  const bool is_ahead = feedback.time_ns >= at_ns_;
  const float age_s = is_ahead ? 0.0f : SecondsBetween(feedback.time_ns, at_ns_);
  const int back = RoundToInt(Min(age_s / kStep_s, static_cast<float>(kHistory)));
  if (back > kMaxFeedbackSteps) return;
  feedback_ns_ = feedback.time_ns;
  const WheelParts measured = PartsOf(feedback.left_radps, feedback.right_radps);
  const WheelParts& then = at_[Place(back)];
  const WheelParts taken = {kTakenAtOnce * (measured.common_radps - then.common_radps),
                            kTakenAtOnce * (measured.differential_radps - then.differential_radps)};
  Learn(taken, back);
  HP_LOOP_BOUND(kMaxFeedbackSteps + 1)
  for (int i = 0; i <= back; ++i) at_[Place(i)] = Sum(at_[Place(i)], taken);
}

// From what a measurement of `back` steps ago differs from the model by.
void DriveModel::Learn(const WheelParts& taken, int back) {
  // What wheels do that are told nothing (pushed, or rolling out under a brake) says nothing.
  const WheelParts& told = commands_[Place(back)];
  if (told.common_radps == 0.0f && told.differential_radps == 0.0f) {
    bias_ = WheelParts{};
    return;
  }
  const float changed_radps =
      at_[Place(back)].differential_radps - at_[Place(back + kLearnSteps)].differential_radps;
  const float share = taken.differential_radps * changed_radps /
                      (changed_radps * changed_radps + kLeastChange_radps * kLeastChange_radps);
  quickness_ =
      Clamp(quickness_ * (1.0f + Clamp(kQuicknessRate * share, -kMostLearned, kMostLearned)),
            kMinQuickness, kMaxQuickness);
  // A bias that is off by one makes a difference of step / lag / kTakenAtOnce at each measurement.
  bias_.common_radps =
      Clamp(bias_.common_radps + kBiasRate_radps * params_.common_lag_s * taken.common_radps,
            -kMaxBias_radps, kMaxBias_radps);
  bias_.differential_radps = Clamp(
      bias_.differential_radps + kBiasRate_radps * DifferentialLag_s() * taken.differential_radps,
      -kMaxBias_radps, kMaxBias_radps);
}

Status DriveModel::Advance(uint64_t now_ns, const WheelFeedback& feedback) {
  if (!configured_) return Status::kNotStarted;
  if (at_ns_ != 0 && now_ns < at_ns_) return Status::kInvalidArgument;
  HP_LOOP_BOUND(kMaxCatchUpSteps)
  for (int i = 0; i < kMaxCatchUpSteps && now_ns - at_ns_ >= kStep_ns; ++i) StepOnce();
  const bool is_gap = now_ns - at_ns_ >= kStep_ns;
  if (is_gap) {
    Forget(now_ns);
    const bool is_speed = feedback.valid && Abs(feedback.left_radps) <= kMaxWheel_radps &&
                          Abs(feedback.right_radps) <= kMaxWheel_radps;
    if (is_speed) at_[newest_] = PartsOf(feedback.left_radps, feedback.right_radps);
    feedback_ns_ = feedback.time_ns;
    return Status::kStale;
  }
  TakeFeedback(feedback);
  return Status::kOk;
}

void DriveModel::SetCommand(const WheelParts& command) {
  command_ = command;
}

DriveState DriveModel::Predict(const Pose2& pose) const {
  DriveState state;
  state.pose = pose;
  state.wheels = wheels();
  if (!IsFinite(pose.x_m) || !IsFinite(pose.y_m) || !IsFinite(pose.theta_rad)) return state;
  state.pose.theta_rad = WrapAngle(pose.theta_rad);
  HP_LOOP_BOUND(kMaxDeadSteps)
  for (int i = 1; i <= dead_steps_ + (dead_share_ > 0.5f ? 1 : 0); ++i) {
    const WheelParts next = Next(state.wheels, DelayedCommand(i));
    const float half = 0.5f * kStep_s;
    const float way_m = half * rim_m_ * (state.wheels.common_radps + next.common_radps);
    const float turn_rad =
        half * (state.wheels.differential_radps + next.differential_radps) / differential_per_turn_;
    const SinCosPair middle = SinCos(state.pose.theta_rad + 0.5f * turn_rad);
    state.pose.x_m += way_m * middle.cos;
    state.pose.y_m += way_m * middle.sin;
    state.pose.theta_rad = WrapAngle(state.pose.theta_rad + turn_rad);
    state.wheels = next;
  }
  state.speed_mps = state.wheels.common_radps * rim_m_;
  state.yaw_rate_radps = state.wheels.differential_radps / differential_per_turn_;
  return state;
}

}  // namespace hardpack
