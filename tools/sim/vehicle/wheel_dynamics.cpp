// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/wheel_dynamics.h"

#include <algorithm>
#include <cmath>

namespace hardpack::sim {
namespace {

constexpr double kStanding_radps = 0.05;   // setpoints below are zero
constexpr double kLeastLimit_radps = 0.1;  // however fast it drives, it can turn a little

double Slowed(double speed_radps, double change_radps) {
  return speed_radps - std::copysign(std::min(change_radps, std::abs(speed_radps)), speed_radps);
}

}  // namespace

DelayLine::DelayLine(double delay_s, double step_s) {
  constexpr double kNextTo = 1.0e-9;  // 0.15 / 0.001 is not quite 150
  const double steps = delay_s / step_s + kNextTo;
  const auto whole = static_cast<size_t>(steps);
  const double rest = steps - static_cast<double>(whole);
  fraction_ = rest < 2.0 * kNextTo ? 0.0 : rest;
  values_.assign(whole + 2, 0.0);
}

double DelayLine::Step(double value) {
  const size_t newest = next_;
  values_[newest] = value;
  next_ = (next_ + 1) % values_.size();
  // The ring holds `whole` + 2 values: the oldest and the second oldest lie about the delay.
  const double older = values_[next_];
  const double newer = values_[(next_ + 1) % values_.size()];
  return newer + fraction_ * (older - newer);
}

void DelayLine::Fill(double value) {
  std::fill(values_.begin(), values_.end(), value);
}

WheelDynamics::WheelDynamics(const VehicleModelParams& params, double step_s)
    : params_(params),
      step_s_(step_s),
      common_setpoint_(params.dead_time_common_s, step_s),
      differential_setpoint_(params.dead_time_differential_s, step_s) {}

double WheelDynamics::Reachable_radps(double differential_radps, double common_radps) const {
  const double limit_radps = std::max(
      params_.differential_limit_radps - params_.differential_limit_slope * std::abs(common_radps),
      kLeastLimit_radps);
  const double share = differential_radps / limit_radps;
  const double second = share * share;
  const double eighth = second * second * second * second;
  return differential_radps / std::sqrt(std::sqrt(std::sqrt(1.0 + eighth)));
}

double WheelDynamics::Scrub_radps(double differential_radps) const {
  return params_.scrub_radps * differential_radps /
         std::sqrt(differential_radps * differential_radps +
                   params_.scrub_width_radps * params_.scrub_width_radps);
}

void WheelDynamics::Settle(const WheelSpeeds& speeds, const WheelSpeeds& command) {
  const double differential_radps = speeds.differential_radps();
  const double reachable_radps =
      Reachable_radps(command.differential_radps(), speeds.common_radps());
  Settle(speeds, command, Scrub_radps(differential_radps) + differential_radps - reachable_radps);
}

void WheelDynamics::Settle(const WheelSpeeds& speeds, const WheelSpeeds& command,
                           double integral_radps) {
  speeds_ = speeds;
  common_setpoint_.Fill(command.common_radps());
  differential_setpoint_.Fill(command.differential_radps());
  integral_radps_ = std::clamp(integral_radps, -params_.scrub_radps, params_.scrub_radps);
}

void WheelDynamics::Step(const WheelSetpoints& setpoints) {
  const WheelSpeeds before = speeds_;
  const double common_radps = common_setpoint_.Step(setpoints.speeds.common_radps());
  const double differential_radps =
      differential_setpoint_.Step(setpoints.speeds.differential_radps());
  Drive(common_radps, differential_radps);
  if (!setpoints.left_driven || !setpoints.right_driven) Brake(setpoints, before);
}

void WheelDynamics::Drive(double common_setpoint_radps, double differential_setpoint_radps) {
  const double common_radps = speeds_.common_radps();
  const double differential_radps = speeds_.differential_radps();
  const double turning = differential_radps * differential_radps;
  const double all = turning + common_radps * common_radps;
  const double kept = all > 0.0 ? 1.0 - params_.common_turn_loss * (turning / all) : 1.0;
  const double common_change_radps2 =
      std::clamp((kept * common_setpoint_radps - common_radps) / params_.time_constant_common_s,
                 -params_.slew_common_radps2, params_.slew_common_radps2);
  const double reachable_radps = Reachable_radps(differential_setpoint_radps, common_radps);
  const double error_radps = reachable_radps - differential_radps;
  const double differential_change_radps2 =
      std::clamp((error_radps - Scrub_radps(differential_radps) + integral_radps_) /
                     params_.time_constant_differential_s,
                 -params_.slew_differential_radps2, params_.slew_differential_radps2);
  const bool is_to_stand = std::abs(common_setpoint_radps) < kStanding_radps &&
                           std::abs(differential_setpoint_radps) < kStanding_radps;
  const double integral_change_radps2 =
      is_to_stand ? -integral_radps_ / params_.time_constant_differential_s
                  : error_radps / params_.integral_time_s;
  integral_radps_ = std::clamp(integral_radps_ + integral_change_radps2 * step_s_,
                               -params_.scrub_radps, params_.scrub_radps);
  const double new_common_radps = common_radps + common_change_radps2 * step_s_;
  const double new_differential_radps = differential_radps + differential_change_radps2 * step_s_;
  const double limit_radps = params_.wheel_limit_radps;
  speeds_.left_radps =
      std::clamp(new_common_radps - new_differential_radps, -limit_radps, limit_radps);
  speeds_.right_radps =
      std::clamp(new_common_radps + new_differential_radps, -limit_radps, limit_radps);
}

void WheelDynamics::Brake(const WheelSetpoints& setpoints, const WheelSpeeds& before) {
  const double change_radps = params_.brake_radps2 * step_s_;
  if (!setpoints.left_driven) speeds_.left_radps = Slowed(before.left_radps, change_radps);
  if (!setpoints.right_driven) speeds_.right_radps = Slowed(before.right_radps, change_radps);
  integral_radps_ = 0.0;
  if (setpoints.left_driven || setpoints.right_driven) return;
  common_setpoint_.Fill(0.0);
  differential_setpoint_.Fill(0.0);
}

}  // namespace hardpack::sim
