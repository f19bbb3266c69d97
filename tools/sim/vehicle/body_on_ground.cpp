// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/body_on_ground.h"

#include <algorithm>
#include <cmath>

namespace hardpack::sim {

// What the tyres give across, and the slide that is left.
double BodyOnGround::Across(double need_mps2, double most_mps2) {
  const double tyre_mps2 = std::clamp(need_mps2, -most_mps2, most_mps2);
  slide_mps_ += (tyre_mps2 - need_mps2) * step_s_;
  const double brakes_mps = (most_mps2 - std::abs(tyre_mps2)) * step_s_;
  slide_mps_ -= std::clamp(slide_mps_, -brakes_mps, brakes_mps);
  return tyre_mps2;
}

double BodyOnGround::Crept(double wheels_mps) const {
  return wheels_mps - std::abs(wheels_mps) * chassis_.tyre_slip * load_;
}

double BodyOnGround::Along(double speed_mps, double level_mps, double yaw_rate_radps) {
  if (ground_.holds_everything()) return level_mps;
  const double up_mps2 = kGravity_mps2 * ground_.up_forward;
  const double press_mps2 = kGravity_mps2 * ground_.press;
  const double most_mps2 = ground_.friction * press_mps2;
  const double need_y_mps2 = speed_mps * yaw_rate_radps + kGravity_mps2 * ground_.up_left;
  tyre_y_mps2_ = Across(need_y_mps2, most_mps2);
  const double left_mps2 =
      std::sqrt(std::max(most_mps2 * most_mps2 - tyre_y_mps2_ * tyre_y_mps2_, 0.0));
  const double room_mps2 = std::min(left_mps2, chassis_.drive_mps2);
  const double need_x_mps2 = (level_mps - speed_mps) / step_s_ + up_mps2;
  tyre_x_mps2_ = std::clamp(need_x_mps2, -room_mps2, room_mps2);
  load_ += (tyre_x_mps2_ / most_mps2 - load_) * (step_s_ / kCreepLag_s);
  const double drifts_mps =
      chassis_.side_slip_rad * std::abs(speed_mps) + chassis_.tyre_arm_m * std::abs(yaw_rate_radps);
  slip_left_mps_ =
      slide_mps_ - std::clamp(kGravity_mps2 * ground_.up_left / most_mps2, -1.0, 1.0) * drifts_mps;
  slides_ = std::abs(need_y_mps2) > most_mps2 || std::abs(need_x_mps2) > left_mps2;
  tipping_ = 2.0 * chassis_.mass_height_m / press_mps2 *
             std::max(std::abs(tyre_y_mps2_) / chassis_.track_m,
                      std::abs(tyre_x_mps2_) / chassis_.wheelbase_m);
  return speed_mps + (tyre_x_mps2_ - up_mps2) * step_s_;
}

}  // namespace hardpack::sim
