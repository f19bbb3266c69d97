// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tools/sim/sensors/lidar_settings.h"

// How the head of a lidar turns: when each of its columns begins, and where it looks then. An
// Ouster's columns are at equal angles, with the same number in each revolution. A Velodyne fires a
// sequence every 55.296 us, wherever its head is; its rate wanders, so no two revolutions have
// their sequences at the same angles.

namespace hardpack::sim {

class LidarHead {
 public:
  static constexpr uint64_t kSequence_ns = 55'296;

  explicit LidarHead(const LidarSettings& settings);

  // Time from the start to the first laser of a column; columns are counted from the start.
  uint64_t Since_ns(uint64_t column) const;
  // Where the head looks, after_ns after the column began: anticlockwise from the body's x axis,
  // without the sensor's yaw. In turns as the column begins.
  double Angle_rad(uint64_t column, uint64_t after_ns) const;
  double Turns(uint64_t column) const;
  // For a Velodyne: turns of the head clockwise from the sensor's y axis, in [0, 1).
  double Azimuth_turns(uint64_t since_ns) const;
  // The number of parts of a revolution, and which part a column is.
  int places() const;
  int Place(uint64_t column) const;

 private:
  // The wander of the rate is the sum of two slow waves.
  struct Wave {
    double period_s = 1.0;
    double phase_rad = 0.0;
  };

  LidarModel model_;
  uint64_t columns_;
  uint64_t revolutions_per_s_;
  double wander_;
  std::array<Wave, 2> waves_;
};

}  // namespace hardpack::sim
