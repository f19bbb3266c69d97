// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/odometry.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/units.h"
#include "core/base/validate.h"
#include "core/odometry/ins_attitude.h"

// Odometry: the filter. What the sensors say to it is in measurements.cpp.

namespace hardpack {
namespace {

// To begin with, and where a gate is opened: whatever a vehicle of this kind can do.
constexpr float kAnySpeed_mps = 5.0f;
constexpr float kAnyRate_radps = 3.0f;
// What is not modelled: how else wheels slip sideways, in a metre and in a second.
constexpr float kSideSlip_m = 0.01f;
constexpr float kYawWalk_rad = 1.0e-4f;
constexpr float kStartPosition_m = 1.0e-3f;
constexpr float kStartYaw_rad = 1.0e-4f;
// At rest: how still it stands.
constexpr float kRestSpeed_mps = 1.0e-3f;
constexpr float kRestRate_radps = 1.0e-4f;
// A state beyond these is a sensor's fault, not the vehicle's.
constexpr float kMaxBias_radps = 0.3f;
constexpr float kMinScale = 0.5f;
constexpr float kMaxScale = 1.5f;
constexpr float kMaxBaselineFactor = 2.0f;
constexpr float kMaxSpeed_mps = 50.0f;
constexpr float kMaxRate_radps = 20.0f;

// Not on the stack: it is too large for a frame.
constexpr Odometry kNew;

}  // namespace

Status Odometry::Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                           const InsParams& ins) {
  *this = kNew;
  if (FirstInvalidParameter(odometry) != nullptr || FirstInvalidParameter(ins) != nullptr) {
    return Status::kParameterOutOfRange;
  }
  vehicle_ = vehicle;
  params_ = odometry;
  BodyFromIns(ins, body_from_ins_);
  Start();
  configured_ = true;
  return Status::kOk;
}

// What is learned, as in the parameters; the pose stays.
void Odometry::Start() {
  state_[kStateX] = pose_.position.x_m;
  state_[kStateY] = pose_.position.y_m;
  state_[kStateYaw] = pose_.yaw_rad;
  state_[kStateSpeed] = 0.0f;
  state_[kStateYawRate] = 0.0f;
  state_[kStateGyroBias] = 0.0f;
  state_[kStateWheelScale] = params_.ground_per_wheel;
  state_[kStateBaseline] = vehicle_.skid_baseline_m / params_.ground_per_wheel;
  const OdometryVector sigma = {kStartPosition_m,
                                kStartPosition_m,
                                kStartYaw_rad,
                                kAnySpeed_mps,
                                kAnyRate_radps,
                                params_.gyro_bias_sigma_radps,
                                params_.wheel_scale_sigma,
                                params_.baseline_sigma_m};
  covariance_.Reset(sigma);
}

float Odometry::Sigma(OdometryState state) const {
  return Sqrt(covariance_.At(state, state));
}

float Odometry::Lateness(uint64_t time_ns) const {
  return time_ns < filter_ns_ ? SecondsBetween(time_ns, filter_ns_) : 0.0f;
}

bool Odometry::IsTooLate(uint64_t time_ns) {
  if (time_ns >= filter_ns_) return false;
  if (Lateness(time_ns) > params_.max_lateness_s) {
    ++counters_.too_late;
    return true;
  }
  ++counters_.late;
  return false;
}

bool Odometry::IsGyroFresh(uint64_t now_ns) const {
  return rate_ns_ != 0 && !gyro_sameness_.frozen &&
         (now_ns <= rate_ns_ || SecondsBetween(rate_ns_, now_ns) <= params_.max_rate_age_s);
}

// What came before has been used: nothing goes back in time.
void Odometry::PredictTo(uint64_t time_ns) {
  if (time_ns <= filter_ns_) return;
  const uint64_t before_ns = filter_ns_;
  filter_ns_ = time_ns;
  if (before_ns == 0) return;
  if (time_ns - before_ns > static_cast<uint64_t>(kMaxStep_ns)) {
    Reopen(kStateSpeed);
    Reopen(kStateYawRate);
    return;
  }
  Propagate(SecondsBetween(before_ns, time_ns));
}

float Odometry::TurningPoint_m() const {
  const float speed_mps = state_[kStateSpeed];
  const float knee_mps = params_.turning_point_speed_mps;
  return params_.turning_point_m * speed_mps / Sqrt(speed_mps * speed_mps + knee_mps * knee_mps);
}

bool Odometry::IsDriftTold() const {
  return climb_ns_ != 0 && filter_ns_ <= climb_ns_ + uint64_t{kMaxStep_ns};
}

// Upwards. The body's pitch is positive with its nose down.
float Odometry::Climb_mps() const {
  const float speed_mps = state_[kStateSpeed];
  const float by_pitch_mps = -speed_mps * Sin(pose_.pitch_rad);
  if (!IsDriftTold()) return by_pitch_mps;
  const float apart_mps = kClimbShare * Abs(speed_mps);
  return Clamp(climb_mps_, by_pitch_mps - apart_mps, by_pitch_mps + apart_mps);
}

// To the left. On a bank that falls to the left, the left side is down: the roll is negative.
float Odometry::Slide_mps() const {
  if (!IsDriftTold()) return 0.0f;
  const float falls_left = -kSlideShare * Sin(pose_.roll_rad);
  const float most_mps =
      falls_left * (Abs(state_[kStateSpeed]) + kTurnArm_m * Abs(state_[kStateYawRate]));
  return Clamp(aside_mps_, Min(most_mps, 0.0f), Max(most_mps, 0.0f));
}

// Forward. Of either sign, so that noise adds nothing.
float Odometry::Creep_mps() const {
  const float steep = Max(Abs(Sin(pose_.pitch_rad)) - kLevelPitch, 0.0f);
  if (!IsDriftTold() || !(steep > 0.0f)) return 0.0f;
  const float most_mps = kSlideShare * steep * Abs(state_[kStateSpeed]);
  return Clamp(ahead_mps_, -most_mps, most_mps);
}

// Equations of odometry.h. Without wheel speeds for too long, and at rest, the pose is held.
void Odometry::Propagate(float dt_s) {
  const bool moves =
      !at_rest_ && moved_ns_ != 0 && filter_ns_ <= moved_ns_ + static_cast<uint64_t>(kMaxStep_ns);
  const float speed_mps = state_[kStateSpeed];
  const float rate_radps = state_[kStateYawRate];
  OdometryTransition step;
  if (moves) {
    const float level_s = Cos(pose_.pitch_rad) * dt_s;
    const SinCosPair middle = SinCos(state_[kStateYaw] + rate_radps * dt_s / 2.0f);
    const float aside_m = -level_s * TurningPoint_m();  // for each rad/s
    step.x_by_speed = level_s * middle.cos;
    step.y_by_speed = level_s * middle.sin;
    const float left_m = rate_radps * aside_m + Slide_mps() * dt_s;
    const float ahead_m = Creep_mps() * dt_s;
    const float dx_m = speed_mps * step.x_by_speed + ahead_m * middle.cos - left_m * middle.sin;
    const float dy_m = speed_mps * step.y_by_speed + ahead_m * middle.sin + left_m * middle.cos;
    step.x_by_yaw = -dy_m;
    step.y_by_yaw = dx_m;
    step.x_by_rate = -dy_m * dt_s / 2.0f - aside_m * middle.sin;
    step.y_by_rate = dx_m * dt_s / 2.0f + aside_m * middle.cos;
    step.yaw_by_rate = dt_s;
    state_[kStateX] += dx_m;
    state_[kStateY] += dy_m;
    state_[kStateYaw] = WrapAngle(state_[kStateYaw] + rate_radps * dt_s);
    pose_.position.z_m += Climb_mps() * dt_s;
    driven_m_ += Abs(speed_mps) * dt_s;
  }
  const auto walked = [dt_s](float per_s) { return per_s * per_s * dt_s; };
  const float drives = Abs(speed_mps) > params_.min_ground_speed_mps ? 1.0f : 0.0f;
  const float turns = Abs(rate_radps) > params_.min_turn_radps ? 1.0f : 0.0f;
  const float slip_m2 = moves ? kSideSlip_m * kSideSlip_m * Abs(speed_mps) * dt_s : 0.0f;
  const OdometryVector noise = {slip_m2,
                                slip_m2,
                                moves ? walked(kYawWalk_rad) : 0.0f,
                                walked(params_.speed_walk_mps),
                                walked(params_.yaw_rate_walk_radps),
                                walked(params_.gyro_bias_walk_radps),
                                drives * walked(params_.wheel_scale_walk),
                                turns * walked(params_.baseline_walk_m)};
  covariance_.Predict(step, noise);
}

void Odometry::Reopen(OdometryState state) {
  OdometryVector noise = {};
  float any = kAnySpeed_mps;
  if (state == kStateYawRate) any = kAnyRate_radps;
  if (state == kStateWheelScale) any = params_.wheel_scale_sigma;
  noise[state] = any * any;
  covariance_.Predict({}, noise);
}

// What a gyro that was frozen has taught.
void Odometry::ForgetBaseline() {
  state_[kStateBaseline] = vehicle_.skid_baseline_m / params_.ground_per_wheel;
  OdometryVector noise = {};
  noise[kStateBaseline] = params_.baseline_sigma_m * params_.baseline_sigma_m;
  covariance_.Predict({}, noise);
}

void Odometry::Correct(const Innovation& innovation) {
  OdometryVector gain;
  const float variance = covariance_.VarianceOf(innovation.h) + innovation.variance;
  covariance_.Update(innovation.h, innovation.variance, gain);
  // The pose goes by the speeds alone: what is learned of a bias or a scale after a long way would
  // make it jump. And each of what is learned has one teacher.
  OdometryVector held = {};
  HP_LOOP_BOUND(kOdometryStates)
  for (int i = 0; i < kOdometryStates; ++i) {
    if (i == kStateSpeed || i == kStateYawRate || i == innovation.learns) {
      state_[i] += gain[i] * innovation.value;
    } else {
      held[i] = gain[i];
    }
  }
  covariance_.Add(held, variance);
  KeepInRange();
}

// What is rejected again and again for gate_open_s is taken: `opened` is what it may have changed;
// where nothing may have it stays out.
bool Odometry::CorrectGated(const Innovation& innovation, uint64_t time_ns, OdometryState opened,
                            Gate& gate, uint32_t& rejected) {
  const float expected = covariance_.VarianceOf(innovation.h) + innovation.variance;
  const float limit = params_.gate_sigma * params_.gate_sigma * expected;
  // What overflows is not within it either.
  if (!(IsFinite(limit) && innovation.value * innovation.value <= limit)) {
    if (gate.closed_ns == 0) gate.closed_ns = time_ns;
    const bool persists = opened != kOdometryStates && time_ns > gate.closed_ns &&
                          SecondsBetween(gate.closed_ns, time_ns) > params_.gate_open_s;
    if (!persists) {
      ++rejected;
      return false;
    }
    ++counters_.reopened;
    Reopen(opened);
  }
  gate.closed_ns = 0;
  Correct(innovation);
  return true;
}

// Whatever is measured, no state leaves what it can be, and none is ever anything but a number.
void Odometry::KeepInRange() {
  bool is_finite = true;
  HP_LOOP_BOUND(kOdometryStates)
  for (int i = 0; i < kOdometryStates; ++i) is_finite = is_finite && IsFinite(state_[i]);
  if (!is_finite) {
    ++counters_.restarts;
    Start();
    return;
  }
  const float baseline_m = vehicle_.skid_baseline_m / params_.ground_per_wheel;
  state_[kStateYaw] = WrapAngle(state_[kStateYaw]);
  state_[kStateSpeed] = Clamp(state_[kStateSpeed], -kMaxSpeed_mps, kMaxSpeed_mps);
  state_[kStateYawRate] = Clamp(state_[kStateYawRate], -kMaxRate_radps, kMaxRate_radps);
  state_[kStateGyroBias] = Clamp(state_[kStateGyroBias], -kMaxBias_radps, kMaxBias_radps);
  state_[kStateWheelScale] = Clamp(state_[kStateWheelScale], kMinScale, kMaxScale);
  state_[kStateBaseline] = Clamp(state_[kStateBaseline], baseline_m / kMaxBaselineFactor,
                                 baseline_m * kMaxBaselineFactor);
}

// At rest nothing moves: what the gyro says then is its bias.
void Odometry::HoldStill() {
  Innovation speed = {.value = -state_[kStateSpeed], .variance = kRestSpeed_mps * kRestSpeed_mps};
  speed.h[kStateSpeed] = 1.0f;
  Correct(speed);
  Innovation rate = {.value = -state_[kStateYawRate],
                     .variance = kRestRate_radps * kRestRate_radps,
                     .learns = kStateGyroBias};
  rate.h[kStateYawRate] = 1.0f;
  Correct(rate);
  state_[kStateSpeed] = 0.0f;
  state_[kStateYawRate] = 0.0f;
}

Status Odometry::Advance(uint64_t now_ns, const WheelFeedback& wheels) {
  if (!configured_) return Status::kNotStarted;
  if (pose_.time_ns != 0 && now_ns <= pose_.time_ns) return Status::kInvalidArgument;
  const bool are_fine = AreWheelSpeeds(wheels);
  if (wheels.valid && !are_fine) ++counters_.refused;
  const bool moves = wheels.valid && are_fine && !AreFrozen(wheels);
  if (moves) {
    const bool is_gap = moved_ns_ != 0 && now_ns > moved_ns_ &&
                        now_ns - moved_ns_ > static_cast<uint64_t>(kMaxStep_ns);
    if (is_gap) {
      ++gaps_;
      at_rest_ = false;
      still_ns_ = 0;
      wheel_sameness_ = {};
      // Nothing is carried on until here; how fast it is now the wheels are about to tell.
      PredictTo(now_ns);
      Reopen(kStateSpeed);
      Reopen(kStateYawRate);
    }
    TakeWheels(wheels);
    moved_ns_ = now_ns;
  }
  PredictTo(now_ns);
  uses_gyro_ = IsGyroFresh(now_ns);
  if (moves) JudgeRest(wheels, now_ns);
  const bool is_lost = moved_ns_ == 0 || now_ns - moved_ns_ > static_cast<uint64_t>(kMaxStep_ns);
  if (is_lost) {
    state_[kStateSpeed] = 0.0f;
    state_[kStateYawRate] = 0.0f;
  }
  pose_.time_ns = now_ns;
  pose_.position.x_m = state_[kStateX];
  pose_.position.y_m = state_[kStateY];
  if (pose_.position.z_m > kMaxHeight_m) pose_.position.z_m -= kMaxHeight_m;
  if (pose_.position.z_m < -kMaxHeight_m) pose_.position.z_m += kMaxHeight_m;
  pose_.yaw_rad = state_[kStateYaw];
  if (moves) return Status::kOk;
  return are_fine ? Status::kStale : Status::kNotFinite;
}

}  // namespace hardpack
