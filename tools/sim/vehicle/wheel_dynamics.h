// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tools/sim/vehicle/vehicle_model_params.h"

// How the wheels of a skid-steered vehicle follow their setpoints. The two sides are not two equal
// motors: turning scrubs all tyres sideways, driving straight does not, so what is modelled is the
// common wheel speed c = (r + l) / 2 and the differential one d = (r - l) / 2, each from its own
// setpoint u after its own dead time:
//
//   c' = clamp((u_c (1 - turn_loss d^2 / (c^2 + d^2)) - c) / tau_c, -slew_c, slew_c)
//   d' = clamp((s - F(d) + i - d) / tau_d, -slew_d, slew_d)
//   s  = u_d / (1 + (u_d / a)^8)^(1/8)      a setpoint beyond a = limit - slope |c| is not reached
//   F  = scrub d / sqrt(d^2 + width^2)      resistance of the tyres
//   i' = (s - d) / integral_time, |i| <= scrub      the drives' integral action
//   |l|, |r| <= wheel_limit
//
// Setpoints of zero let go of i, with tau_d: a vehicle that is to stand would else go on turning a
// little for seconds. Nothing recorded shows what the drives do then; this is a choice.
//
// So a turn starts with what the setpoint exceeds the resistance by, and creeps to the rest of it:
// this is what was recorded (docs/simulation.md). Explicit Euler steps. The same calls give the
// same bits on every processor, and mirrored setpoints give mirrored speeds, exactly.

namespace hardpack::sim {

struct WheelSpeeds {
  double left_radps = 0.0;
  double right_radps = 0.0;

  double common_radps() const { return 0.5 * (right_radps + left_radps); }
  double differential_radps() const { return 0.5 * (right_radps - left_radps); }

  friend bool operator==(const WheelSpeeds&, const WheelSpeeds&) = default;
};

// A side that is not driven is braked by its spring, and what was commanded is forgotten.
struct WheelSetpoints {
  WheelSpeeds speeds;
  bool left_driven = true;
  bool right_driven = true;
};

// A signal some time ago: of the values at whole steps, straight lines between them.
class DelayLine {
 public:
  DelayLine(double delay_s, double step_s);

  // The value `delay` before this one.
  double Step(double value);
  void Fill(double value);

 private:
  std::vector<double> values_;  // a ring, the oldest at next_
  size_t next_ = 0;
  double fraction_ = 0.0;  // of a step, beyond the whole ones
};

class WheelDynamics {
 public:
  // Standing. The parameters have passed CheckVehicleModel; step_s > 0, 0.001 as a rule.
  WheelDynamics(const VehicleModelParams& params, double step_s);

  // As if it had turned at `speeds` for a while with the setpoints at `command`.
  void Settle(const WheelSpeeds& speeds, const WheelSpeeds& command);
  // The same, but the integral is known.
  void Settle(const WheelSpeeds& speeds, const WheelSpeeds& command, double integral_radps);
  void Step(const WheelSetpoints& setpoints);
  // The wheels turn so, whatever drives them; all else stays.
  void Force(const WheelSpeeds& speeds) { speeds_ = speeds; }

  const WheelSpeeds& speeds() const { return speeds_; }
  double integral_radps() const { return integral_radps_; }

 private:
  double Reachable_radps(double differential_radps, double common_radps) const;
  double Scrub_radps(double differential_radps) const;
  void Drive(double common_setpoint_radps, double differential_setpoint_radps);
  void Brake(const WheelSetpoints& setpoints, const WheelSpeeds& before);

  VehicleModelParams params_;
  double step_s_;
  DelayLine common_setpoint_;
  DelayLine differential_setpoint_;
  double integral_radps_ = 0.0;
  WheelSpeeds speeds_;
};

}  // namespace hardpack::sim
