// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/tracking.h"

#include "core/base/math.h"
#include "core/base/validate.h"
#include "core/kinematics/kinematics.h"

namespace hardpack {
namespace {

// s^2 + 1.6 p s + p^2: damped by 0.8
constexpr float kDamping = 1.6f;
// No nearer than this is a point a direction to aim at.
constexpr float kMinAim_m = 0.05f;
// Below this speed the way back to the path is not looked for: the vehicle hardly moves.
constexpr float kLeastSpeed_mps = 0.2f;
// A lasting error of the yaw rate keeps the vehicle no further off its path than this.
constexpr float kLearnWithin_m = 0.25f;
constexpr float kLeastCurvatureSpeed_mps = 0.5f;
// A turn on the spot ends here.
constexpr float kTurned_rad = 0.02f;
constexpr float kTurnedRate_radps = 0.05f;
constexpr float kPivotBrake_radps2 = 0.8f;
// Of what the wheels can change by, the body is asked for no more: the rest corrects.
constexpr float kMaxAskedShare = 0.9f;
constexpr float kLeastTurn_radps = 0.3f;
// So far off the path the speed begins to be lowered, and is half as high. A vehicle farther off
// has drives that turn it less than the model says.
constexpr float kSlowFrom_m = 0.12f;
constexpr float kSlowHalf_m = 0.3f;
constexpr float kLeastShare = 0.3f;
// A turn that is more than the drives have costs the speed this much in a second, and it comes back
// more slowly.
constexpr float kGiveWay_per_s = 1.0f;
constexpr float kComeBack_per_s = 0.4f;

bool IsFiniteInput(const TrackingInput& input) {
  return IsFinite(input.pose) && IsFinite(input.aim.pose) && IsFinite(input.path) &&
         IsFinite(input.speed_limit_mps) && IsFinite(input.acceleration_mps2) &&
         IsFinite(input.turn_curvature_per_m) && IsFinite(input.wheel_curvature_per_m) &&
         IsFinite(input.curvature_rate_per_m2) && IsFinite(input.left_m) &&
         IsFinite(input.deceleration_mps2);
}

float Limited(float value, float most) {
  return Clamp(value, -most, most);
}

}  // namespace

Status Tracker::Configure(const VehicleParams& vehicle, const SpeedParams& speed,
                          const OdometryParams& odometry, const DynamicsParams& dynamics,
                          const TrackingParams& tracking) {
  configured_ = false;
  if (FirstInvalidParameter(tracking) != nullptr) return Status::kParameterOutOfRange;
  const Status status = model_.Configure(vehicle, odometry, dynamics);
  if (!IsUsable(status)) return status;
  vehicle_ = vehicle;
  limits_ = speed;
  params_ = tracking;
  predicted_ = DriveState{};
  error_.Reset();
  TrackingOutput output;
  Zero(output);
  configured_ = true;
  return Status::kOk;
}

Status Tracker::Predict(uint64_t now_ns, const Pose2& pose, const WheelFeedback& wheels,
                        const BodyMotion& body) {
  const Status status = model_.Advance(now_ns, wheels, body);
  predicted_ = model_.Predict(pose);
  if (status == Status::kStale) error_.Reset();
  error_.Advance(now_ns, model_.Ahead_ns(), predicted_, body);
  return status;
}

Status Tracker::Follow(const TrackingInput& input, float dt_s, TrackingOutput& output) {
  return Drive(input, false, dt_s, output);
}

Status Tracker::StopAlong(const TrackingInput& input, float dt_s, TrackingOutput& output) {
  return Drive(input, true, dt_s, output);
}

void Tracker::Zero(TrackingOutput& output) {
  speed_mps_ = 0.0f;
  reverse_ = false;
  curvature_per_m_ = 0.0f;
  integral_radps_ = 0.0f;
  give_way_ = 1.0f;
  saturated_ = false;
  output = TrackingOutput{};
  Mix(WheelParts{}, output);
}

float Tracker::EndTime_s() const {
  return kEndLags * (model_.params().common_lag_s + model_.params().speed_lag_s);
}

float Tracker::TurnAhead_m() const {
  return Abs(model_.TurningPoint_m(predicted_.speed_mps));
}

float Tracker::WheelAhead_m() const {
  return TurnAhead_m() + model_.params().yaw_rate_lag_s * Abs(predicted_.speed_mps);
}

float Tracker::EndSpeed(float left_m, float max_deceleration_mps2) const {
  if (!(left_m > 0.0f)) return 0.0f;
  const float time_s = EndTime_s();
  const float brake_mps2 = kEndBrakeShare * max_deceleration_mps2;
  const float rolling_m = brake_mps2 * time_s * time_s;
  if (left_m <= rolling_m) return left_m / time_s;
  return Sqrt(2.0f * brake_mps2 * (left_m - 0.5f * rolling_m));
}

Status Tracker::Drive(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output) {
  if (!configured_ || !IsFiniteInput(input) || !IsFinite(dt_s) || dt_s <= 0.0f) {
    Zero(output);
    return configured_ ? Status::kNotFinite : Status::kNotStarted;
  }
  if (input.turn && !CanPivot(vehicle_)) {  // SR-PLN06
    Zero(output);
    return Status::kNeedsManoeuvre;
  }
  if (input.turn) {
    if (stops) {
      Zero(output);
    } else {
      TurnOnTheSpot(input, dt_s, output);
    }
    return Status::kOk;
  }
  if (StillTurns()) {
    output = TrackingOutput{};
    Command(WheelParts{}, dt_s, output);
    return Status::kOk;
  }
  const bool turns_back = input.reverse != reverse_ && speed_mps_ > 0.0f;
  if (!turns_back) reverse_ = input.reverse;
  return DriveAlong(input, stops || turns_back, dt_s, output);
}

bool Tracker::StillTurns() const {
  return speed_mps_ <= 0.0f && Abs(predicted_.speed_mps) < kEndSpeed_mps &&
         Abs(predicted_.yaw_rate_radps) > kStillTurns_radps;
}

// In the direction of the reference.
Status Tracker::DriveAlong(const TrackingInput& input, bool stops, float dt_s,
                           TrackingOutput& output) {
  if (params_.method == TrackingParams::kPurePursuit) {
    PursueAim(input, stops, dt_s, output);
    return Status::kOk;
  }
  const float dx_m = input.pose.x_m - input.path.x_m;
  const float dy_m = input.pose.y_m - input.path.y_m;
  const float limit_m = params_.max_cross_track_m;
  const bool is_off = dx_m * dx_m + dy_m * dy_m > limit_m * limit_m;
  FollowPath(input, stops || is_off, dt_s, output);
  return is_off ? Status::kOffPath : Status::kOk;
}

// Arc through the vehicle's pose, along its heading, and the point aimed at:
//   kappa = 2 y / (x^2 + y^2), of that point in the body frame
float Tracker::CurvatureTo(const TrackingInput& input) const {
  const SinCosPair heading = SinCos(input.pose.theta_rad);
  const float dx_m = input.aim.pose.x_m - input.pose.x_m;
  const float dy_m = input.aim.pose.y_m - input.pose.y_m;
  const float ahead_m = heading.cos * dx_m + heading.sin * dy_m;
  const float left_m = heading.cos * dy_m - heading.sin * dx_m;
  const float distance2_m2 = ahead_m * ahead_m + left_m * left_m;
  const bool is_ahead = reverse_ ? ahead_m <= -kMinAim_m : ahead_m >= kMinAim_m;
  if (!is_ahead) return 0.0f;  // at the end of the path, or past it
  return 2.0f * left_m / distance2_m2;
}

// Pure pursuit: the speed is that of the path within the ramps, and every wheel is taken to have
// the speed that it is told.
void Tracker::PursueAim(const TrackingInput& input, bool stops, float dt_s,
                        TrackingOutput& output) {
  const float limit_mps = stops ? 0.0f : Clamp(input.speed_limit_mps, 0.0f, limits_.max_speed_mps);
  speed_mps_ = Clamp(limit_mps, speed_mps_ - limits_.max_deceleration_mps2 * dt_s,
                     speed_mps_ + limits_.max_acceleration_mps2 * dt_s);
  curvature_per_m_ = CurvatureTo(input);
  output.speed_mps = reverse_ ? -speed_mps_ : speed_mps_;
  output.yaw_rate_radps = Limited(output.speed_mps * curvature_per_m_, limits_.max_yaw_rate_radps);
  output.curvature_per_m = curvature_per_m_;
  Mix({output.speed_mps / model_.RimWay_m(), output.yaw_rate_radps * model_.PerTurn()}, output);
}

// Moves the reference on and returns its change [m/s^2], in the direction of driving.
float Tracker::Reference(const TrackingInput& input, float off_m, bool stops, float dt_s) {
  const float brake_mps2 = limits_.max_deceleration_mps2;
  const float held_mps2 =
      input.deceleration_mps2 > 0.0f ? Min(input.deceleration_mps2, brake_mps2) : brake_mps2;
  const float end_mps = EndSpeed(input.left_m, held_mps2);
  const float slow = Max(
      1.0f - 0.5f * Max(Abs(off_m) - kSlowFrom_m, 0.0f) / (kSlowHalf_m - kSlowFrom_m), kLeastShare);
  float wanted_mps =
      Min(slow, give_way_) * Clamp(input.speed_limit_mps, 0.0f, limits_.max_speed_mps);
  float change_mps2 = input.acceleration_mps2;
  if (end_mps <= wanted_mps) {
    wanted_mps = end_mps;
    change_mps2 = -Min(kEndBrakeShare * held_mps2, end_mps / EndTime_s());
  }
  change_mps2 = Clamp(change_mps2 + kRampGain_per_s * (wanted_mps - speed_mps_), -brake_mps2,
                      limits_.max_acceleration_mps2);
  if (stops || wanted_mps < kEndSpeed_mps) change_mps2 = -brake_mps2;
  const float driven_mps = reverse_ ? -predicted_.speed_mps : predicted_.speed_mps;
  if (speed_mps_ > Max(driven_mps, 0.0f) + kMaxLead_mps) change_mps2 = Min(change_mps2, 0.0f);
  const float before_mps = speed_mps_;
  speed_mps_ = Max(speed_mps_ + change_mps2 * dt_s, 0.0f);
  return speed_mps_ > 0.0f ? change_mps2 : Max(change_mps2, -before_mps / dt_s);
}

// The change of the wheels' turn, as one of a yaw rate, that brings the body to w_d with the inner
// pair of poles: z_r, z_r' what the path asks of the wheels, w_r of the body.
float Tracker::WheelsChange(const Turn& turn) const {
  const float lag_s = model_.params().yaw_rate_lag_s;
  const Gains gains = GainsAt(turn.pole_radps);
  const float wheels_radps = predicted_.wheels.differential_radps / model_.PerTurn();
  const float body_radps = predicted_.yaw_rate_radps;
  const float ahead_radps =
      (wheels_radps - turn.path_wheels_radps) - (body_radps - turn.path_radps);
  return turn.path_change_radps2 + (1.0f / lag_s - gains.jerk_per_s) * ahead_radps -
         lag_s * gains.rate_per_s2 * (body_radps - turn.wanted_radps);
}

// (s^2 + 1.6 p s + p^2)(s^2 + 1.6 q s + q^2)
Tracker::Gains Tracker::GainsAt(float pole_radps) const {
  const float p = pole_radps;
  const float q = params_.turn_bandwidth_radps;
  const float pq = p * q;
  return {.jerk_per_s = kDamping * (p + q),
          .rate_per_s2 = p * p + kDamping * kDamping * pq + q * q,
          .heading_per_s3 = kDamping * pq * (p + q),
          .place_per_s4 = pq * pq};
}

// What yaw rate the path and the feedback want of the body, and what the path asks of the wheels.
Tracker::Turn Tracker::TurnFor(const TrackingInput& input, const Errors& errors, float change_mps2,
                               float dt_s) {
  const float speed_mps = predicted_.speed_mps;
  const float magnitude_mps = Abs(speed_mps);
  const float point_m = model_.TurningPoint_m(speed_mps);
  const float heading_rad = errors.heading_rad - point_m * input.turn_curvature_per_m;
  const float off_m = errors.cross_track_m + point_m * heading_rad;
  Turn turn;
  turn.pole_radps = Min(params_.bandwidth_radps, magnitude_mps / params_.settle_way_m);
  const Gains gains = GainsAt(turn.pole_radps);
  const float towards_mps = Max(magnitude_mps, kLeastSpeed_mps);
  float back_rad = 0.0f;
  if (turn.pole_radps > 0.0f) {
    back_rad =
        Limited(gains.place_per_s4 / gains.heading_per_s3 * off_m / towards_mps, kMaxReturn_rad);
  }
  if (reverse_) back_rad = -back_rad;
  const float feedback_radps = gains.heading_per_s3 / gains.rate_per_s2 * (heading_rad + back_rad);
  // The faster it becomes, the further ahead of its middle it turns: so it has to turn in.
  const float turn_in = model_.TurningPointChange_s(speed_mps) * change_mps2;
  turn.path_radps = (speed_mps + turn_in) * input.turn_curvature_per_m;
  turn.path_wheels_radps = (speed_mps + turn_in) * input.wheel_curvature_per_m;
  turn.path_change_radps2 = change_mps2 * input.wheel_curvature_per_m +
                            speed_mps * speed_mps * input.curvature_rate_per_m2;
  const float asked_radps = turn.path_radps - feedback_radps - integral_radps_;
  turn.wanted_radps = Limited(asked_radps, MostTurn_radps());
  // What is not done does not teach anything, nor does the way back from far off.
  const bool is_done = !saturated_ && turn.wanted_radps == asked_radps;
  if (is_done && magnitude_mps > kLeastCurvatureSpeed_mps && Abs(off_m) < kLearnWithin_m) {
    integral_radps_ = Limited(integral_radps_ + params_.integral_rate_per_s * feedback_radps * dt_s,
                              kMaxIntegral_radps);
  }
  return turn;
}

// Whether a differential command is about all that the drives can do.
bool Tracker::IsAtLimit(float command_radps) const {
  const DynamicsParams& drives = model_.params();
  const float limit_radps = drives.differential_limit_radps -
                            drives.differential_limit_slope * Abs(predicted_.wheels.common_radps);
  return Abs(command_radps) > kMaxLimitShare * limit_radps;
}

// What the drives can hold against the tyres.
float Tracker::MostTurn_radps() const {
  const DynamicsParams& drives = model_.params();
  const float reach_radps =
      kMaxLimitShare * (drives.differential_limit_radps -
                        drives.differential_limit_slope * Abs(predicted_.wheels.common_radps)) -
      0.5f * drives.scrub_radps;
  return Clamp(reach_radps / model_.PerTurn(), kLeastTurn_radps, limits_.max_yaw_rate_radps);
}

void Tracker::FollowPath(const TrackingInput& input, bool stops, float dt_s,
                         TrackingOutput& output) {
  const float direction = reverse_ ? -1.0f : 1.0f;
  const SinCosPair heading = SinCos(input.path.theta_rad);
  const Errors errors = {.cross_track_m = heading.cos * (input.pose.y_m - input.path.y_m) -
                                          heading.sin * (input.pose.x_m - input.path.x_m),
                         .heading_rad = WrapAngle(input.pose.theta_rad - input.path.theta_rad)};
  const float reference_change_mps2 =
      direction * Reference(input, errors.cross_track_m, stops, dt_s);
  const float speed_mps = direction * speed_mps_;
  const float change_mps2 =
      reference_change_mps2 + params_.speed_gain_per_s * (speed_mps - predicted_.speed_mps);
  const Turn turn = TurnFor(input, errors, reference_change_mps2, dt_s);

  const bool stands = speed_mps_ <= 0.0f && Abs(predicted_.speed_mps) < kEndSpeed_mps;
  WheelParts command;
  if (!stands) {
    const float common_radps = CommonCommand(change_mps2, reference_change_mps2);
    // Never against the direction of driving: what rolls rolls out.
    command.common_radps = direction * Max(direction * common_radps, 0.0f);
    command.differential_radps = DifferentialCommandFor(turn);
  }
  const bool is_at_limit = !stands && IsAtLimit(command.differential_radps);
  give_way_ = Clamp(give_way_ + dt_s * (is_at_limit ? -kGiveWay_per_s : kComeBack_per_s),
                    kLeastShare, 1.0f);
  curvature_per_m_ =
      Abs(predicted_.speed_mps) > kLeastCurvatureSpeed_mps
          ? Limited(predicted_.yaw_rate_radps / predicted_.speed_mps, 1.0f / kMinAim_m)
          : 0.0f;
  output.speed_mps = speed_mps;
  output.yaw_rate_radps = stands ? 0.0f : turn.wanted_radps;
  output.curvature_per_m = curvature_per_m_;
  Command(command, dt_s, output);
}

// The heading's error sets the yaw rate, no faster than it can be braked again, and the lags are
// undone as they are along a path.
void Tracker::TurnOnTheSpot(const TrackingInput& input, float dt_s, TrackingOutput& output) {
  curvature_per_m_ = 0.0f;
  integral_radps_ = 0.0f;
  output = TrackingOutput{};
  // What is left of its speed where the turn begins goes first, at the ramp.
  speed_mps_ = Max(speed_mps_ - limits_.max_deceleration_mps2 * dt_s, 0.0f);
  if (speed_mps_ > 0.0f) {
    output.speed_mps = reverse_ ? -speed_mps_ : speed_mps_;
    Command({output.speed_mps / model_.RimWay_m(), 0.0f}, dt_s, output);
    return;
  }
  const float error_rad = WrapAngle(input.aim.pose.theta_rad - input.pose.theta_rad);
  const float gain_per_s = params_.heading_gain_per_s;
  if (params_.method == TrackingParams::kPurePursuit) {
    output.yaw_rate_radps = Limited(gain_per_s * error_rad, params_.max_pivot_rate_radps);
    Mix({0.0f, output.yaw_rate_radps * model_.PerTurn()}, output);
    return;
  }
  const float rate_radps = predicted_.yaw_rate_radps;
  if (Abs(error_rad) < kTurned_rad && Abs(rate_radps) < kTurnedRate_radps) {
    Command(WheelParts{}, dt_s, output);
    return;
  }
  // gain |error| up to where that would brake harder than kPivotBrake, then the parabola.
  const float linear_rad = kPivotBrake_radps2 / (gain_per_s * gain_per_s);
  const float far_rad = Max(Abs(error_rad) - 0.5f * linear_rad, 0.0f);
  const float braked_radps = Abs(error_rad) <= linear_rad
                                 ? gain_per_s * Abs(error_rad)
                                 : Sqrt(2.0f * kPivotBrake_radps2 * far_rad);
  const float most_radps = Min(braked_radps, params_.max_pivot_rate_radps);
  Turn turn;
  turn.wanted_radps = error_rad < 0.0f ? -most_radps : most_radps;
  if (braked_radps <= params_.max_pivot_rate_radps) {
    turn.path_change_radps2 = -Limited(gain_per_s * rate_radps, kPivotBrake_radps2);
  }
  turn.path_radps = turn.wanted_radps;
  turn.path_wheels_radps =
      turn.wanted_radps + model_.params().yaw_rate_lag_s * turn.path_change_radps2;
  output.yaw_rate_radps = turn.wanted_radps;
  Command({0.0f, DifferentialCommandFor(turn)}, dt_s, output);
}

// The command whose lags give the body this change, at the predicted speed; the reference's change
// lasts, what corrects it does not. Where the body hardly lags behind its wheels, these correct it
// within the time that they need themselves.
float Tracker::CommonCommand(float change_mps2, float reference_change_mps2) const {
  const DynamicsParams& drives = model_.params();
  const float per_rim = 1.0f / model_.RimWay_m();
  const float most_mps2 = kMaxAskedShare * drives.common_slew_radps2 * model_.RimWay_m();
  const float correcting_s = Max(drives.speed_lag_s, 1.0f / params_.wheel_gain_per_s);
  const float ahead_mps =
      drives.speed_lag_s * Limited(change_mps2, most_mps2) +
      (correcting_s - drives.speed_lag_s) * Limited(change_mps2 - reference_change_mps2, most_mps2);
  const float wanted_radps = (predicted_.speed_mps + ahead_mps) * per_rim;
  const float change =
      Limited(reference_change_mps2 * per_rim +
                  params_.wheel_gain_per_s * (wanted_radps - predicted_.wheels.common_radps),
              drives.common_slew_radps2);
  return predicted_.wheels.common_radps + drives.common_lag_s * change - model_.common_bias_radps();
}

float Tracker::DifferentialCommandFor(const Turn& turn) const {
  const DynamicsParams& drives = model_.params();
  const WheelParts& wheels = predicted_.wheels;
  const float change =
      Limited(WheelsChange(turn) * model_.PerTurn(), model_.DifferentialSlew_radps2());
  const float reachable_radps = wheels.differential_radps +
                                ScrubOf(drives, wheels.differential_radps) -
                                predicted_.integral_radps + model_.DifferentialLag_s() * change;
  return DifferentialCommand(drives, reachable_radps, wheels.common_radps);
}

// No faster than it may change; then what the wheels can do.
void Tracker::Command(WheelParts command, float dt_s, TrackingOutput& output) {
  const float most = kMaxCommandChange_radps2 * dt_s;
  const auto step = [most](float from, float to) { return Clamp(to, from - most, from + most); };
  Mix({step(command_.common_radps, command.common_radps),
       step(command_.differential_radps, command.differential_radps)},
      output);
}

// The differential part that goes with the common one, told or turned at already: where the wheels
// are steered, none that is beyond the largest curvature,
//   kappa = w / v = (2 r d / b) / (r c),  b the distance of the sides that the drives reckon with
float Tracker::Drivable(const WheelParts& command) const {
  if (CanPivot(vehicle_)) return command.differential_radps;
  const float common_radps = Max(Abs(command.common_radps), Abs(predicted_.wheels.common_radps));
  const float most_radps = 0.5f * vehicle_.skid_baseline_m * MostCurvature(vehicle_) * common_radps;
  return Limited(command.differential_radps, most_radps);
}

// The turn keeps the vehicle on its path, so it comes first: the speed gets what is left.
void Tracker::Mix(WheelParts command, TrackingOutput& output) {
  const float most_radps = vehicle_.max_wheel_speed_radps;
  command_.differential_radps = Limited(command.differential_radps, most_radps);
  command_.common_radps =
      Limited(command.common_radps, most_radps - Abs(command_.differential_radps));
  command_.differential_radps = Drivable(command_);
  saturated_ = Abs(command.differential_radps) > Abs(command_.differential_radps);
  output.wheels = {.left_radps = command_.common_radps - command_.differential_radps,
                   .right_radps = command_.common_radps + command_.differential_radps};
  model_.SetCommand(command_);
}

}  // namespace hardpack
