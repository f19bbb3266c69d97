// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/odometry/ins_attitude.h"
#include "core/odometry/odometry.h"

// Odometry: what the sensors say, and whether they are to be believed.

namespace hardpack {
namespace {

// Beyond the range of any gyro of such a vehicle's INS (2000 degrees a second).
constexpr float kMaxGyro_radps = 35.0f;
// And no wheel turns faster.
constexpr float kMaxWheel_radps = 500.0f;
constexpr float kMaxGroundSpeed_mps = 100.0f;
// The least cosine of the pitch at which a turn about the vertical is told.
constexpr float kMinCosPitch = 0.5f;
constexpr float kAsideLag_s = 0.5f;
// The INS's speed errors last: more often it says nothing new.
constexpr uint64_t kGroundSpeedPeriod_ns = 200'000'000;
// What one sensor ranges over while another says the same, for that to be frozen, ...
constexpr float kFrozenRate_radps = 0.3f;
constexpr float kFrozenSpeed_mps = 1.0f;
// ... if this share of it leads away: the body follows its wheels late, and comes nearer to what
// they say while they say it.
constexpr float kAwayShare = 0.5f;
// Rims do not change faster (recorded: 99 of 100 slower, REFERENCES.md, DRIVE): more is a glitch,
// which the gate is to keep out.
constexpr float kMaxRimChange_mps2 = 5.1f;
constexpr float kTakenOff = 0.5f;

float Square(float value) {
  return value * value;
}

bool IsRate(float rate_radps) {
  return Abs(rate_radps) <= kMaxGyro_radps;
}

}  // namespace

Status Odometry::TakeIns(const InsSample& sample, uint64_t time_ns) {
  if (!configured_) return Status::kNotStarted;
  const AngularRate& rate = sample.angular_rate;
  const VelocityNed& velocity = sample.velocity_ned;
  const bool attitude_is_fine =
      !sample.has_attitude || (Abs(sample.roll_rad) <= kTwoPi && Abs(sample.pitch_rad) <= kTwoPi &&
                               Abs(sample.yaw_rad) <= kTwoPi);
  if (!attitude_is_fine || (sample.has_angular_rate && !IsFinite(rate)) ||
      (sample.has_velocity && !IsFinite(velocity))) {
    ++counters_.refused;
    return Status::kNotFinite;
  }
  if (sample.has_angular_rate &&
      !(IsRate(rate.x_radps) && IsRate(rate.y_radps) && IsRate(rate.z_radps))) {
    ++counters_.refused;
    return Status::kInvalidArgument;
  }
  // A device or a bridge that says the same again says nothing about now.
  if (IsRepeated(sample)) {
    ++counters_.repeated;
    return Status::kDuplicate;
  }
  if (IsTooLate(time_ns)) return Status::kLate;
  if (sample.has_timestamp) {
    stamp_ = {true, sample.timestamp_ns};
  } else if (sample.has_gps_time) {
    gps_stamp_ = {true, sample.gps_time_ns};
  }
  if (sample.has_attitude && time_ns >= ins_ns_) TakeAttitude(sample);
  if (time_ns > ins_ns_) ins_ns_ = time_ns;
  PredictTo(time_ns);
  if (sample.has_angular_rate) TakeRate(rate, time_ns);
  if (sample.has_attitude && sample.has_velocity) TakeVelocity(sample, time_ns);
  return Status::kOk;
}

// By the device's own clock; or by GPS time, of those that tell no other.
bool Odometry::IsRepeated(const InsSample& sample) const {
  if (sample.has_timestamp) return stamp_.known && sample.timestamp_ns == stamp_.time_ns;
  return sample.has_gps_time && gps_stamp_.known && sample.gps_time_ns == gps_stamp_.time_ns;
}

void Odometry::TakeAttitude(const InsSample& sample) {
  const BodyAttitude attitude = BodyAttitudeOf(sample, body_from_ins_);
  pose_.roll_rad = attitude.roll_rad;
  pose_.pitch_rad = attitude.pitch_rad;
}

// The turn about the vertical, from rates about the body's axes: Euler's kinematic equation.
void Odometry::TakeRate(const AngularRate& rate, uint64_t time_ns) {
  const float(&m)[9] = body_from_ins_;
  const float about_y = m[3] * rate.x_radps + m[4] * rate.y_radps + m[5] * rate.z_radps;
  const float about_z = m[6] * rate.x_radps + m[7] * rate.y_radps + m[8] * rate.z_radps;
  const SinCosPair roll = SinCos(pose_.roll_rad);
  const float cos_pitch = Max(Cos(pose_.pitch_rad), kMinCosPitch);
  const float measured_radps = (roll.sin * about_y + roll.cos * about_z) / cos_pitch;
  const bool was_frozen = gyro_sameness_.frozen;
  const float turn_radps = rim_turn_mps_ / state_[kStateBaseline];
  Follow(gyro_sameness_, {rate.x_radps, rate.z_radps}, time_ns,
         {measured_radps - state_[kStateGyroBias], 0.0f}, {turn_radps, 0.0f});
  if (gyro_sameness_.frozen) {
    if (!was_frozen) {
      ++counters_.gyro_frozen;
      ForgetBaseline();
    }
    return;
  }
  Innovation turn;
  turn.h[kStateYawRate] = 1.0f;
  turn.h[kStateGyroBias] = 1.0f;
  turn.value = measured_radps - state_[kStateYawRate] - state_[kStateGyroBias];
  turn.variance =
      Square(params_.gyro_sigma_radps) + Square(params_.yaw_rate_walk_radps * Lateness(time_ns));
  if (at_rest_) turn.learns = kStateGyroBias;
  if (!CorrectGated(turn, time_ns, kStateYawRate, gyro_gate_, counters_.gyro_rejected)) return;
  rate_radps_ = measured_radps;
  if (time_ns > rate_ns_) rate_ns_ = time_ns;
}

// Only what the INS stands by: its speed drifts without satellites.
void Odometry::TakeVelocity(const InsSample& sample, uint64_t time_ns) {
  const bool is_good = sample.has_status && sample.status.mode == InsMode::kTracking &&
                       sample.status.gnss_fix && !sample.status.gnss_error &&
                       !sample.status.imu_error;
  if (!is_good) return;
  const VelocityNed& velocity = sample.velocity_ned;
  const SinCosPair heading = SinCos(BodyAttitudeOf(sample, body_from_ins_).heading_rad);
  const float measured_mps = velocity.east_mps * heading.cos + velocity.north_mps * heading.sin;
  if (!(Abs(measured_mps) <= kMaxGroundSpeed_mps &&
        Abs(velocity.down_mps) <= kMaxGroundSpeed_mps)) {
    ++counters_.refused;
    return;
  }
  const float left_mps = velocity.north_mps * heading.cos - velocity.east_mps * heading.sin;
  NoteDrift({measured_mps, left_mps}, -velocity.down_mps, time_ns);
  TakeGroundSpeed(measured_mps, time_ns);
}

// What no wheel tells. At rest there is none.
void Odometry::NoteDrift(Vec2 level_mps, float climb_mps, uint64_t time_ns) {
  if (time_ns < climb_ns_) return;
  const bool goes_on = climb_ns_ != 0 && time_ns - climb_ns_ <= uint64_t{kMaxStep_ns} && !at_rest_;
  const float dt_s = goes_on ? SecondsBetween(climb_ns_, time_ns) : 0.0f;
  const float turns_mps = -state_[kStateYawRate] * TurningPoint_m();
  if (!goes_on) {
    aside_mps_ = 0.0f;
    ahead_mps_ = 0.0f;
  }
  const float share = dt_s / (dt_s + kAsideLag_s);
  aside_mps_ += share * (level_mps.y_m - turns_mps - aside_mps_);
  const float wheels_mps = Cos(pose_.pitch_rad) * state_[kStateSpeed];
  ahead_mps_ += share * (level_mps.x_m - wheels_mps - ahead_mps_);
  climb_ns_ = time_ns;
  climb_mps_ = climb_mps;
}

void Odometry::TakeGroundSpeed(float measured_mps, uint64_t time_ns) {
  ground_speed_mps_ = measured_mps;
  const bool is_new =
      ground_speed_ns_ == 0 ||
      (time_ns > ground_speed_ns_ && time_ns - ground_speed_ns_ >= kGroundSpeedPeriod_ns);
  const float speed_mps = state_[kStateSpeed];
  if (!is_new || at_rest_ || Abs(speed_mps) < params_.min_ground_speed_mps) return;
  ground_speed_ns_ = time_ns;
  Innovation over_ground;
  over_ground.h[kStateSpeed] = Cos(pose_.pitch_rad);
  over_ground.value = measured_mps - over_ground.h[kStateSpeed] * speed_mps;
  over_ground.variance =
      Square(params_.ground_speed_sigma_mps) + Square(params_.speed_walk_mps * Lateness(time_ns));
  over_ground.learns = kStateWheelScale;
  CorrectGated(over_ground, time_ns, kStateWheelScale, ground_speed_gate_,
               counters_.ground_speed_rejected);
}

bool Odometry::AreWheelSpeeds(const WheelFeedback& wheels) {
  return Abs(wheels.left_radps) <= kMaxWheel_radps && Abs(wheels.right_radps) <= kMaxWheel_radps;
}

bool Odometry::AreFrozen(const WheelFeedback& wheels) {
  if (wheels.time_ns <= wheels_ns_) return wheel_sameness_.frozen;
  const bool was_frozen = wheel_sameness_.frozen;
  const float rim_m = vehicle_.wheel_radius_m;
  const Moves said = {
      .yaw_rate_radps = rim_m * (wheels.right_radps - wheels.left_radps) / state_[kStateBaseline],
      .speed_mps =
          0.5f * rim_m * (wheels.left_radps + wheels.right_radps) * state_[kStateWheelScale]};
  Follow(wheel_sameness_, {wheels.left_radps, wheels.right_radps}, wheels.time_ns, said,
         {rate_radps_ - state_[kStateGyroBias], ground_speed_mps_});
  if (wheel_sameness_.frozen && !was_frozen) ++counters_.wheels_frozen;
  return wheel_sameness_.frozen;
}

// The rims' speeds, and what they were a while ago: a first-order lag (implicit Euler: stable for
// any step). Wheels slip while they gather speed or lose it: how far they are ahead of themselves
// tells how little they are to be believed.
void Odometry::FollowRims(const WheelFeedback& wheels) {
  const float radius_m = vehicle_.wheel_radius_m;
  rim_mps_ = radius_m * (wheels.left_radps + wheels.right_radps) / 2.0f;
  rim_turn_mps_ = radius_m * (wheels.right_radps - wheels.left_radps);
  const bool follows = rims_ns_ != 0 && wheels.time_ns - rims_ns_ <= uint64_t{kMaxStep_ns};
  const float dt_s = follows ? SecondsBetween(rims_ns_, wheels.time_ns) : 0.0f;
  const float share = follows ? dt_s / (dt_s + params_.wheel_lag_s) : 1.0f;
  past_rim_mps_ += share * (rim_mps_ - past_rim_mps_);
  past_turn_mps_ += share * (rim_turn_mps_ - past_turn_mps_);
  rims_ns_ = wheels.time_ns;
}

// What the wheels may be ahead of the vehicle, having changed by so much, is between nothing (on
// firm ground) and all of the lag (on the loose ground of the fit): half of it is taken off
// the rims' speed, and all of it is its noise.
float Odometry::Gathering(float change_mps) const {
  const float most_mps = kMaxRimChange_mps2 * params_.wheel_lag_s;
  return kTakenOff * params_.wheel_lag_share * Clamp(change_mps, -most_mps, most_mps);
}

// Both numbers of one time: the common speed, then the turn.
void Odometry::TakeWheels(const WheelFeedback& wheels) {
  const uint64_t time_ns = wheels.time_ns;
  if (time_ns <= wheels_ns_) return;
  wheels_ns_ = time_ns;
  if (IsTooLate(time_ns)) return;
  PredictTo(time_ns);
  FollowRims(wheels);
  const float ahead_mps = Gathering(rim_mps_ - past_rim_mps_);
  const float rim_mps = rim_mps_ - ahead_mps;
  const float late_s = Lateness(time_ns);
  const float scale = state_[kStateWheelScale];
  Innovation common;
  common.h[kStateSpeed] = 1.0f / scale;
  common.h[kStateWheelScale] = -state_[kStateSpeed] / (scale * scale);
  common.value = rim_mps - state_[kStateSpeed] / scale;
  common.variance = Square(params_.wheel_sigma_mps) + Square(params_.wheel_slip_share * rim_mps) +
                    Square(params_.wheel_slip_share * rim_turn_mps_) +
                    Square(ahead_mps / kTakenOff) + Square(params_.speed_walk_mps * late_s);
  CorrectGated(common, time_ns, kStateSpeed, wheel_speed_gate_, counters_.wheel_speed_rejected);
  TakeTurn(rim_mps, time_ns);
}

void Odometry::TakeTurn(float rim_mps, uint64_t time_ns) {
  const bool has_gyro = IsGyroFresh(time_ns);
  const float rate_radps = state_[kStateYawRate];
  if (has_gyro && Abs(rate_radps) < params_.min_turn_radps) return;
  const float baseline_m = state_[kStateBaseline];
  const float ahead_mps = Gathering(rim_turn_mps_ - past_turn_mps_);
  Innovation turn;
  turn.h[kStateYawRate] = baseline_m;
  turn.h[kStateBaseline] = rate_radps;
  turn.value = rim_turn_mps_ - ahead_mps - rate_radps * baseline_m;
  turn.variance = 2.0f * Square(params_.wheel_sigma_mps) +
                  Square(params_.wheel_slip_share * rim_mps) +
                  Square(params_.turn_slip_share * rim_turn_mps_) + Square(ahead_mps / kTakenOff) +
                  Square(params_.yaw_rate_walk_radps * baseline_m * Lateness(time_ns));
  if (has_gyro) turn.learns = kStateBaseline;
  CorrectGated(turn, time_ns, has_gyro ? kOdometryStates : kStateYawRate, wheel_turn_gate_,
               counters_.wheel_turn_rejected);
}

void Odometry::JudgeRest(const WheelFeedback& wheels, uint64_t now_ns) {
  const bool wheels_stand = Abs(wheels.left_radps) <= params_.rest_wheel_radps &&
                            Abs(wheels.right_radps) <= params_.rest_wheel_radps;
  const bool is_quiet =
      !IsGyroFresh(now_ns) || Abs(rate_radps_ - state_[kStateGyroBias]) <= params_.rest_rate_radps;
  if (!wheels_stand || !is_quiet) {
    still_ns_ = 0;
    at_rest_ = false;
    return;
  }
  if (still_ns_ == 0) still_ns_ = now_ns;
  at_rest_ = SecondsBetween(still_ns_, now_ns) >= params_.rest_time_s;
  if (at_rest_) HoldStill();
}

void Odometry::Wandering::Begin(float measured, float said) {
  low = high = measured;
  nearest = Abs(measured - said);
  away = 0.0f;
}

void Odometry::Wandering::Add(float measured, float said) {
  low = Min(low, measured);
  high = Max(high, measured);
  const float apart = Abs(measured - said);
  nearest = Min(nearest, apart);
  away = Max(away, apart - nearest);
}

// In windows of frozen_time_s. What is frozen is so until it changes; what says zero, until a
// window in which nothing else moved: the vehicle may have been pushed.
void Odometry::Follow(Sameness& same, const Pair& value, uint64_t time_ns, const Moves& said,
                      const Moves& measured) const {
  const auto leads_away = [](const Wandering& wandering, float least) {
    return wandering.high - wandering.low > least && wandering.away > kAwayShare * least;
  };
  const bool changed = !same.started || value.a != same.value.a || value.b != same.value.b;
  const bool says_zero = value.a == 0.0f && value.b == 0.0f;
  if (changed) same.frozen = false;
  const bool is_over = !changed && time_ns > same.since_ns &&
                       SecondsBetween(same.since_ns, time_ns) >= params_.frozen_time_s;
  if (is_over) {
    const bool moved =
        leads_away(same.radps, kFrozenRate_radps) || leads_away(same.mps, kFrozenSpeed_mps);
    same.frozen = moved || (same.frozen && !says_zero);
  }
  if (changed || is_over) {
    same.started = true;
    same.since_ns = time_ns;
    same.value = value;
    same.radps.Begin(measured.yaw_rate_radps, said.yaw_rate_radps);
    same.mps.Begin(measured.speed_mps, said.speed_mps);
    return;
  }
  same.radps.Add(measured.yaw_rate_radps, said.yaw_rate_radps);
  same.mps.Add(measured.speed_mps, said.speed_mps);
}

}  // namespace hardpack
