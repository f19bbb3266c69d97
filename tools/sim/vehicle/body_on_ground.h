// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

// A vehicle's body on ground that is not level and does not hold everything: what its tyres can do
// about gravity, and what they cannot. Per unit of mass, with s the sine of the grade ahead (uphill
// positive), q that of the grade to the left, p the share of the weight that presses on the ground,
// mu the friction, v and w the body's speed and yaw rate:
//
//   across, to the left:  need_y = v w + g q,             tyre_y = clamp(need_y, +-mu g p)
//   along:                need_x = (v* - v) / step + g s, tyre_x = clamp(need_x, +-room)
//                         room = min(sqrt((mu g p)^2 - tyre_y^2), drive_mps2)
//   v' = tyre_x - g s
//
// v* is the speed that the wheels would give it in that step on level ground that holds
// (vehicle_model.h, steered_model.h). What tyre_y lacks makes the body slide sideways; what is left
// of mu g p brakes that. Tyres also creep under a load: along, they lose tyre_slip of the wheels'
// speed at full load; across, a rolling vehicle drifts by side_slip_rad of its speed, and one that
// turns on the spot, whose tyres slide anyway, by the load's share of the speed at which they do.
//
// The tyres' loads say when it tips, as if nothing moved (docs/simulation.md): with the centre
// of mass at height h over a track B, at |tyre_y| h = g p B / 2; along likewise with the wheelbase.
//
// Explicit Euler steps; the same calls give the same bits on every processor.

namespace hardpack::sim {

inline constexpr double kGravity_mps2 = 9.80665;

// Under a vehicle. The default is level ground that holds whatever the wheels ask for: there
// nothing of this file applies.
struct GroundUnder {
  double friction = 0.0;    // mu; 0: everything holds
  double up_forward = 0.0;  // s
  double up_left = 0.0;     // q
  double press = 1.0;       // p

  bool holds_everything() const { return friction <= 0.0; }
  // What is left of a way along the ground, seen from above.
  double LevelForward() const { return std::sqrt(1.0 - up_forward * up_forward); }
  double LevelLeft() const { return std::sqrt(1.0 - up_left * up_left); }
};

// Estimates for a Warthog without a payload; Clearpath states none of the first five.
struct ChassisParams {
  double mass_height_m = 0.45;
  double drive_mps2 = 7.0;  // the drives' largest force, per unit of mass
  double tyre_slip = 0.06;
  double side_slip_rad = 0.1;
  double tyre_arm_m = 0.36;  // from the middle to the tyres' sliding in a turn on the spot, mean
  double wheelbase_m = 0.92;
  double track_m = 1.12;
};

class BodyOnGround {
 public:
  // Not sliding. step_s > 0.
  BodyOnGround(const ChassisParams& chassis, double step_s) : chassis_(chassis), step_s_(step_s) {}

  void SetGround(const GroundUnder& ground) { ground_ = ground; }
  const GroundUnder& ground() const { return ground_; }

  // What is left of the speed of wheels that drive or brake as they lately did: a tyre takes
  // kCreepLag_s to give way.
  static constexpr double kCreepLag_s = 0.1;
  double Crept(double wheels_mps) const;
  // The body's speed after a step: v* is level_mps.
  double Along(double speed_mps, double level_mps, double yaw_rate_radps);

  // To the left, beyond what a level turn does. After Along.
  double slip_left_mps() const { return slip_left_mps_; }
  // The tyres' force per unit of mass, along and to the left.
  double tyre_x_mps2() const { return tyre_x_mps2_; }
  double tyre_y_mps2() const { return tyre_y_mps2_; }
  // Share of the load at which wheels lift off, sideways or along, whichever is more.
  double tipping() const { return tipping_; }
  // Whether the tyres give all that friction allows.
  bool slides() const { return slides_; }

 private:
  double Across(double need_mps2, double most_mps2);

  ChassisParams chassis_;
  double step_s_;
  GroundUnder ground_;
  double slide_mps_ = 0.0;  // to the left
  double slip_left_mps_ = 0.0;
  double tyre_x_mps2_ = 0.0;
  double tyre_y_mps2_ = 0.0;
  double load_ = 0.0;  // along, the share of what the ground holds, after kCreepLag_s
  double tipping_ = 0.0;
  bool slides_ = false;
};

}  // namespace hardpack::sim
