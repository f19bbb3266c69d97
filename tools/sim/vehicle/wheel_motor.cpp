// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/wheel_motor.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hardpack::sim {

WheelMotor::WheelMotor(const MotorModel& model, double step_s)
    : model_(model),
      step_s_(step_s),
      delayed_radps_(static_cast<size_t>(std::lround(model.dead_time_s / step_s)), 0.0) {}

void WheelMotor::Step(bool driven, double target_radps) {
  const double before_radps = speed_radps_;
  if (!driven) {
    std::fill(delayed_radps_.begin(), delayed_radps_.end(), 0.0);
    const double change_radps = std::min(model_.brake_radps2 * step_s_, std::abs(speed_radps_));
    speed_radps_ -= std::copysign(change_radps, speed_radps_);
  } else {
    double demand_radps = target_radps;
    if (!delayed_radps_.empty()) {
      std::swap(demand_radps, delayed_radps_[oldest_]);
      oldest_ = (oldest_ + 1) % delayed_radps_.size();
    }
    const double change_radps2 = std::clamp((demand_radps - speed_radps_) / model_.time_constant_s,
                                            -model_.slew_radps2, model_.slew_radps2);
    speed_radps_ =
        std::clamp(speed_radps_ + change_radps2 * step_s_, -model_.limit_radps, model_.limit_radps);
  }
  acceleration_radps2_ = (speed_radps_ - before_radps) / step_s_;
}

}  // namespace hardpack::sim
