// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/onboard/pilot/pilot.h"
#include "tools/sim/vehicle/pose.h"

// The vehicle's costmap at a few times during a mission, for pictures.

namespace hardpack::mission {

enum class MapCell : uint8_t { kUnknown, kFree, kCostly, kLethal, kSoft, kHard, kPerson };
inline constexpr int kMapCellKinds = 7;

// The observed part of a costmap, placed in the world by the odometry at that time.
struct MapRecord {
  double t_s = 0.0;
  double x_m = 0.0;  // corner of the first cell, in the world
  double y_m = 0.0;
  double yaw_rad = 0.0;  // of its rows, in the world
  int columns = 0;
  int rows = 0;
  std::vector<MapCell> cells;  // [rows x columns], rows along its y
};

// Keeps at most kMost maps, spread evenly over the mission, however long it lasts.
class MapRecorder {
 public:
  static constexpr size_t kMost = 40;
  static constexpr double kShortest_s = 0.5;

  // Once a tick.
  void Watch(const Pilot& pilot, const sim::Pose& pose, double t_s, std::vector<MapRecord>& maps);

 private:
  uint64_t plans_ = 0;
  double period_s_ = kShortest_s;
  double next_s_ = 0.0;
};

}  // namespace hardpack::mission
