// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/lidar_head.h"

#include <algorithm>
#include <cmath>

#include "tools/sim/world/portable_math.h"

namespace hardpack::sim {

using world::kPi;

LidarHead::LidarHead(const LidarSettings& settings)
    : model_(settings.model),
      columns_(static_cast<uint64_t>(settings.columns)),
      revolutions_per_s_(static_cast<uint64_t>(settings.revolutions_per_s)),
      wander_(settings.turn_wander) {
  const uint64_t key = world::KeyOf(settings.seed, world::Stream::kHead);
  const auto drawn = [key](uint64_t index) { return world::DrawUniform(key, index); };
  waves_ = {
      {{1.5 + 1.5 * drawn(0), 2.0 * kPi * drawn(1)}, {5.0 + 5.0 * drawn(2), 2.0 * kPi * drawn(3)}}};
}

uint64_t LidarHead::Since_ns(uint64_t column) const {
  if (IsVelodyne(model_)) return column * kSequence_ns;
  const uint64_t per_s = columns_ * revolutions_per_s_;
  return column / per_s * 1'000'000'000 + column % per_s * 1'000'000'000 / per_s;
}

// The integral of the rate, f (1 + wander (sin a + sin b) / 2).
double LidarHead::Azimuth_turns(uint64_t since_ns) const {
  const double since_s = 1.0e-9 * static_cast<double>(since_ns);
  double wandered_s = 0.0;
  for (const Wave& wave : waves_) {
    const double waves = since_s / wave.period_s;
    const double now_rad = 2.0 * kPi * (waves - std::floor(waves)) + wave.phase_rad;
    const double cosines = world::TurnOf(wave.phase_rad).cos - world::TurnOf(now_rad).cos;
    wandered_s += 0.5 * wave.period_s / (2.0 * kPi) * cosines;
  }
  const double turns = static_cast<double>(revolutions_per_s_) * (since_s + wander_ * wandered_s);
  return turns - std::floor(turns);
}

double LidarHead::Angle_rad(uint64_t column, uint64_t after_ns) const {
  if (IsVelodyne(model_)) return -2.0 * kPi * Azimuth_turns(Since_ns(column) + after_ns);
  // In the lidar frame the encoder turns clockwise; the sensor frame is half a turn from it.
  return 2.0 * kPi * (1.0 - static_cast<double>(Place(column)) / static_cast<double>(columns_)) +
         kPi;
}

double LidarHead::Turns(uint64_t column) const {
  if (IsVelodyne(model_)) return -Azimuth_turns(Since_ns(column));
  return 1.5 - static_cast<double>(Place(column)) / static_cast<double>(columns_);
}

int LidarHead::places() const {
  if (!IsVelodyne(model_)) return static_cast<int>(columns_);
  return static_cast<int>(1'000'000'000 / (kSequence_ns * revolutions_per_s_));
}

int LidarHead::Place(uint64_t column) const {
  if (!IsVelodyne(model_)) return static_cast<int>(column % columns_);
  const double place = Azimuth_turns(Since_ns(column)) * places();
  return std::min(static_cast<int>(place), places() - 1);
}

}  // namespace hardpack::sim
