// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/progress.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"
#include "core/speed/speed.h"

// What the surroundings allow along a path that has been checked (docs/algorithm.md sections 6 and
// 8): at each point the speed from which the vehicle can still stop within the rest of the path,
// since nothing beyond its end was checked, and the caps for the people beside it. It does not look
// for obstacles on the path: the check has.

namespace hardpack {

class SpeedCaps {
 public:
  // path: as the check has passed it, at least one point. Cost: one pass over its points.
  void Begin(const GridWindow& window, const SpeedParams& params, const VehicleParams& vehicle,
             const WorldPath& path);

  // A unit is one row of the map searched for people (each goes to every point where the path
  // passes it), or one point whose nearest person caps the points before it. At most kMaxUnits
  // units.
  static constexpr int kMaxUnits = kMapSize_cells + kMaxPathPoints;
  Progress Step(const Costmap& map, const SpeedParams& params, const VehicleParams& vehicle,
                const WorldPath& path, int units);

  // [n] m/s, valid once Step has returned kDone.
  std::span<const float> cap_mps() const { return {cap_mps_, static_cast<size_t>(points_)}; }

 private:
  void SearchRow(const Costmap& map, const WorldPath& path);
  void FilePerson(Vec2 person_odom, const WorldPath& path);
  void CapForPersonAt(int point, const SpeedParams& params, const VehicleParams& vehicle);

  float along_m_[kMaxPathPoints] = {};  // way from the start
  float cap_mps_[kMaxPathPoints] = {};
  float person2_m2_[kMaxPathPoints] = {};  // squared, to the nearest person filed with the point
  float reach_m_ = 0.0f;                   // people further from the path cap nothing
  int32_t points_ = 0;
  Cell low_;  // the part of the map that is searched
  Cell high_;
  int32_t row_ = 0;    // next, up to high_.y
  int32_t point_ = 0;  // next
};
static_assert(std::is_trivially_copyable_v<SpeedCaps>);

}  // namespace hardpack
