// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/drive_model.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/base/validate.h"

namespace hardpack {
namespace {

// The observer: which part of a measured difference is taken at once, and how fast a lasting one
// becomes a bias.
constexpr float kTakenAtOnce = 0.5f;
constexpr float kBiasRate_per_s = 2.0f;
// A bias belongs to what is being driven: without measurements it fades, by half in 0.35 s.
constexpr uint64_t kFreshBias_ns = 100'000'000;
constexpr float kBiasFade = 0.98f;
// The quickness: the steps over which a change is looked at, the change from which on it tells
// something, the part of what it tells that is taken, and at most.
constexpr int kLearnSteps = 2;
constexpr float kLeastChange_radps = 0.05f;
constexpr float kQuicknessRate = 0.08f;
constexpr float kMostLearned = 0.05f;
// What wheels do on this ground: learned so fast, from speeds above these on.
constexpr float kGroundRate_per_s = 0.5f;
constexpr float kLeastModelSpeed_mps = 0.5f;
constexpr float kLeastRate_radps = 0.15f;
// Of the body's motion, which odometry has filtered, this part is taken at once.
constexpr float kBodyTaken = 0.25f;
// Commands below are zero: the drives let go of their integral.
constexpr float kStanding_radps = 0.05f;
constexpr float kLeastLimit_radps = 0.5f;  // however fast it drives, it can turn a little

float Toward(float from, float settled, float lag_s, float step_s) {
  return lag_s <= step_s ? settled : from + (settled - from) * (step_s / lag_s);
}

WheelParts Sum(const WheelParts& a, const WheelParts& b) {
  return {a.common_radps + b.common_radps, a.differential_radps + b.differential_radps};
}

// What a factor of what the body settles at is to be multiplied by, in one step in which the model
// was off by `off` although so much is taken each time: normalised least mean squares.
float Taught(float off, float settled, float lag_s) {
  const float missed = off * kBodyTaken * (lag_s + DriveModel::kStep_s) / DriveModel::kStep_s;
  return 1.0f + kGroundRate_per_s * DriveModel::kStep_s * Clamp(missed / settled, -1.0f, 1.0f);
}

float LimitAt(const DynamicsParams& params, float common_radps) {
  return Max(params.differential_limit_radps - params.differential_limit_slope * Abs(common_radps),
             kLeastLimit_radps);
}

// x^8 of a share; of a huge one that of a large one, so that it stays finite.
float Eighth(float share) {
  const float second = Min(share * share, 1.0e4f);
  const float fourth = second * second;
  return fourth * fourth;
}

float EighthRoot(float value) {
  return Sqrt(Sqrt(Sqrt(value)));
}

}  // namespace

float ReachableDifferential(const DynamicsParams& params, float command_radps, float common_radps) {
  const float limit_radps = LimitAt(params, common_radps);
  const float share = command_radps / limit_radps;
  if (Abs(share) >= 10.0f) return share > 0.0f ? limit_radps : -limit_radps;
  return command_radps / EighthRoot(1.0f + Eighth(share));
}

float DifferentialCommand(const DynamicsParams& params, float reachable_radps, float common_radps) {
  const float limit_radps = LimitAt(params, common_radps);
  const float most_radps = kMaxLimitShare * limit_radps;
  const float wanted_radps = Clamp(reachable_radps, -most_radps, most_radps);
  return wanted_radps / EighthRoot(1.0f - Eighth(wanted_radps / limit_radps));
}

float ScrubOf(const DynamicsParams& params, float differential_radps) {
  const float width2 = params.scrub_width_radps * params.scrub_width_radps;
  return params.scrub_radps * differential_radps /
         Sqrt(differential_radps * differential_radps + width2);
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
  turning_point_m_ = odometry.turning_point_m;
  turning_point_speed_mps_ = odometry.turning_point_speed_mps;
  const float steps = dynamics.dead_time_s / kStep_s;
  dead_steps_ = ClampInt(FloorToInt(steps), 0, kMaxDeadSteps - 1);
  dead_share_ = Clamp(steps - static_cast<float>(dead_steps_), 0.0f, 1.0f);
  command_ = WheelParts{};
  feedback_ns_ = 0;
  speed_ground_ = 1.0f;
  turn_ground_ = 1.0f;
  Forget(0);
  configured_ = true;
  return Status::kOk;
}

void DriveModel::Forget(uint64_t now_ns) {
  at_ns_ = now_ns;
  newest_ = 0;
  bias_radps_ = 0.0f;
  integral_radps_ = 0.0f;
  quickness_ = 1.0f;
  speed_mps_ = 0.0f;
  yaw_rate_radps_ = 0.0f;
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

float DriveModel::TurningPoint_m(float speed_mps) const {
  const float knee_mps = turning_point_speed_mps_;
  return turning_point_m_ * speed_mps / Sqrt(speed_mps * speed_mps + knee_mps * knee_mps);
}

float DriveModel::TurningPointChange_s(float speed_mps) const {
  const float knee2 = turning_point_speed_mps_ * turning_point_speed_mps_;
  const float all2 = speed_mps * speed_mps + knee2;
  return turning_point_m_ * knee2 / (all2 * Sqrt(all2));
}

// Explicit Euler, the pose by the mean of both ends.
void DriveModel::Step(const WheelParts& command, float step_s, DriveState& state) const {
  const float common_radps = state.wheels.common_radps;
  const float differential_radps = state.wheels.differential_radps;
  const float reachable_radps =
      ReachableDifferential(params_, command.differential_radps, common_radps);
  const float common_change =
      Clamp((command.common_radps + bias_radps_ - common_radps) / Max(params_.common_lag_s, step_s),
            -params_.common_slew_radps2, params_.common_slew_radps2);
  const float slew_radps2 = DifferentialSlew_radps2();
  const float pushed_radps = reachable_radps - ScrubOf(params_, differential_radps) +
                             state.integral_radps - differential_radps;
  const float change =
      Clamp(pushed_radps / Max(DifferentialLag_s(), step_s), -slew_radps2, slew_radps2);
  const bool is_to_stand = Abs(command.common_radps) < kStanding_radps &&
                           Abs(command.differential_radps) < kStanding_radps;
  const float integral_change =
      is_to_stand ? -state.integral_radps / Max(params_.differential_lag_s, step_s)
                  : (reachable_radps - differential_radps) / params_.integral_time_s;
  state.integral_radps = Clamp(state.integral_radps + integral_change * step_s, -kMaxIntegral_radps,
                               kMaxIntegral_radps);
  state.wheels = {common_radps + common_change * step_s, differential_radps + change * step_s};
  state.speed_mps = Toward(state.speed_mps, common_radps * RimWay_m(), params_.speed_lag_s, step_s);
  state.yaw_rate_radps =
      Toward(state.yaw_rate_radps, differential_radps / PerTurn(), params_.yaw_rate_lag_s, step_s);
}

DriveState DriveModel::Now() const {
  return {.pose = {},
          .wheels = wheels(),
          .integral_radps = integral_radps_,
          .speed_mps = speed_mps_,
          .yaw_rate_radps = yaw_rate_radps_};
}

void DriveModel::StepOnce() {
  // A report of this tick may lie ahead of the step.
  const bool is_old = at_ns_ > feedback_ns_ && at_ns_ - feedback_ns_ > kFreshBias_ns;
  if (is_old) bias_radps_ *= kBiasFade;
  DriveState state = Now();
  Step(DelayedCommand(1), kStep_s, state);
  newest_ = (newest_ + 1) & (kHistory - 1);
  commands_[newest_] = command_;
  at_[newest_] = state.wheels;
  integral_radps_ = state.integral_radps;
  speed_mps_ = state.speed_mps;
  yaw_rate_radps_ = state.yaw_rate_radps;
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
    bias_radps_ = 0.0f;
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
  bias_radps_ = Clamp(bias_radps_ + kBiasRate_per_s * params_.common_lag_s * taken.common_radps,
                      -kMaxBias_radps, kMaxBias_radps);
  integral_radps_ =
      Clamp(integral_radps_ + kBiasRate_per_s * DifferentialLag_s() * taken.differential_radps,
            -kMaxIntegral_radps, kMaxIntegral_radps);
}

// What the body does differently from the wheels that the model has: of the lag or of the ground.
void DriveModel::TakeBody(const BodyMotion& body) {
  // Also false for what is no number.
  const bool is_motion = body.valid && Abs(body.speed_mps) <= kMaxBody_mps &&
                         Abs(body.yaw_rate_radps) <= kMaxBody_radps;
  if (!is_motion) return;
  const float speed_off_mps = body.speed_mps - speed_mps_;
  const float rate_off_radps = body.yaw_rate_radps - yaw_rate_radps_;
  speed_mps_ += kBodyTaken * speed_off_mps;
  yaw_rate_radps_ += kBodyTaken * rate_off_radps;
  const float turn_radps = wheels().differential_radps / PerTurn();
  const float rim_mps = wheels().common_radps * RimWay_m();
  if (Abs(rim_mps) > kLeastModelSpeed_mps) {
    speed_ground_ = Clamp(speed_ground_ * Taught(speed_off_mps, rim_mps, params_.speed_lag_s),
                          kMinGround, kMaxGround);
  }
  if (Abs(turn_radps) > kLeastRate_radps) {
    turn_ground_ = Clamp(turn_ground_ * Taught(rate_off_radps, turn_radps, params_.yaw_rate_lag_s),
                         kMinGround, kMaxGround);
  }
}

Status DriveModel::Advance(uint64_t now_ns, const WheelFeedback& feedback, const BodyMotion& body) {
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
    speed_mps_ = at_[newest_].common_radps * RimWay_m();
    yaw_rate_radps_ = at_[newest_].differential_radps / PerTurn();
    return Status::kStale;
  }
  TakeFeedback(feedback);
  TakeBody(body);
  return Status::kOk;
}

void DriveModel::SetCommand(const WheelParts& command) {
  command_ = command;
}

void DriveModel::Roll(const WheelParts& command, float step_s, DriveState& state) const {
  const float before_mps = state.speed_mps;
  const float before_radps = state.yaw_rate_radps;
  Step(command, step_s, state);
  const float half_s = 0.5f * step_s;
  const float way_m = half_s * (before_mps + state.speed_mps);
  const float turn_rad = half_s * (before_radps + state.yaw_rate_radps);
  const float left_m = -turn_rad * TurningPoint_m(state.speed_mps);
  const SinCosPair middle = SinCos(state.pose.theta_rad + 0.5f * turn_rad);
  state.pose.x_m += way_m * middle.cos - left_m * middle.sin;
  state.pose.y_m += way_m * middle.sin + left_m * middle.cos;
  state.pose.theta_rad = WrapAngle(state.pose.theta_rad + turn_rad);
}

DriveState DriveModel::StateAt(const Pose2& pose) const {
  DriveState state = Now();
  state.pose = pose;
  return state;
}

WheelParts DriveModel::CommandIn(int steps_ahead) const {
  return steps_ahead <= dead_steps_ + 1 ? DelayedCommand(steps_ahead) : command_;
}

DriveState DriveModel::Predict(const Pose2& pose) const {
  DriveState state = Now();
  state.pose = pose;
  if (!IsFinite(pose)) return state;
  state.pose.theta_rad = WrapAngle(pose.theta_rad);
  HP_LOOP_BOUND(kMaxDeadSteps)
  for (int i = 1; i <= AheadSteps(); ++i) {
    Roll(DelayedCommand(i), kStep_s, state);
  }
  return state;
}

}  // namespace hardpack
