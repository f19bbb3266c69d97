// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tools/sim/vehicle/vehicle_model_params.h"

// How the wheels of a skid-steered vehicle follow their setpoints. The two sides do not act as two
// independent motors: turning scrubs all tyres sideways, driving straight does not. So the model
// uses the common wheel speed c = (r + l) / 2 and the differential one d = (r - l) / 2, each from
// its own setpoint u after its own dead time:
//
//   c' = clamp((u_c (1 - turn_loss d^2 / (c^2 + d^2)) - c) / tau_c, -slew_c, slew_c)
//   d' = clamp((s - F(d) + i - d) / tau_d, -slew_d, slew_d)
//   s  = u_d / (1 + (u_d / a)^8)^(1/8)      a setpoint beyond a = limit - slope |c| is not reached
//   F  = scrub d / sqrt(d^2 + width^2)      resistance of the tyres
//   i' = (s - d) / integral_time, |i| <= scrub      the drives' integral action
//   |l|, |r| <= wheel_limit
//
// Zero setpoints release i, with tau_d: otherwise a stopping vehicle would keep turning a little
// for seconds. The recording does not show what the drives do then; this is an assumption.
//
// So a turn starts with only the part of the setpoint that exceeds the resistance, and the rest
// builds up slowly, as recorded (docs/simulation.md). Explicit Euler steps. The same calls give the
// same bits on every processor, and mirrored setpoints give exactly mirrored speeds.

namespace hardpack::sim {

struct WheelSpeeds {
  double left_radps = 0.0;
  double right_radps = 0.0;

  double common_radps() const { return 0.5 * (right_radps + left_radps); }
  double differential_radps() const { return 0.5 * (right_radps - left_radps); }

  friend bool operator==(const WheelSpeeds&, const WheelSpeeds&) = default;
};

// A side that is not driven is braked by its spring, and its earlier commands are dropped.
struct WheelSetpoints {
  WheelSpeeds speeds;
  bool left_driven = true;
  bool right_driven = true;
};

// A delayed signal: values at whole steps, linearly interpolated between them.
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
  // At rest. The parameters have passed CheckVehicleModel; step_s > 0, normally 0.001.
  WheelDynamics(const VehicleModelParams& params, double step_s);

  // As if it had turned at `speeds` for a while with the setpoints at `command`.
  void Settle(const WheelSpeeds& speeds, const WheelSpeeds& command);
  // The same, with a known integral.
  void Settle(const WheelSpeeds& speeds, const WheelSpeeds& command, double integral_radps);
  void Step(const WheelSetpoints& setpoints);
  // Sets the wheel speeds, whatever drives them; nothing else changes.
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
