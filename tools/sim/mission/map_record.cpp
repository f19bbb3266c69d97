// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/map_record.h"

#include <algorithm>

#include "tools/sim/mission/frame.h"

namespace hardpack::mission {
namespace {

// The cost from which a cell visibly slows or bends a path.
constexpr int kCostly_q8 = kCostOne_q8 / 2;

MapCell KindOf(uint8_t flags, uint16_t cost_q8) {
  if ((flags & Costmap::kPerson) != 0) return MapCell::kPerson;
  if ((flags & Costmap::kHard) != 0) return MapCell::kHard;
  if ((flags & Costmap::kSoft) != 0) return MapCell::kSoft;
  if ((flags & Costmap::kLethal) != 0) return MapCell::kLethal;
  if ((flags & Costmap::kObserved) == 0) return MapCell::kUnknown;
  return cost_q8 >= kCostly_q8 ? MapCell::kCostly : MapCell::kFree;
}

struct Part {
  int left = kMapSize_cells;
  int right = -1;
  int low = kMapSize_cells;
  int high = -1;
};

Part KnownPart(const Costmap& map) {
  Part part;
  for (int index = 0; index < kMapCells; ++index) {
    if (KindOf(map.flags[index], map.cost_q8[index]) == MapCell::kUnknown) continue;
    part.left = std::min(part.left, index % kMapSize_cells);
    part.right = std::max(part.right, index % kMapSize_cells);
    part.low = std::min(part.low, index / kMapSize_cells);
    part.high = std::max(part.high, index / kMapSize_cells);
  }
  return part;
}

MapRecord RecordOf(const Pilot& pilot, const sim::Pose& pose, double t_s) {
  const Costmap& map = pilot.replanner().planner().costmap();
  const Part part = KnownPart(map);
  const StampedPose& odom = pilot.odometry().pose();
  const Vec2 corner = {
      static_cast<float>(map.window.origin.x + part.left) * kCellSize_m,
      static_cast<float>(map.window.origin.y + part.low) * kCellSize_m,
  };
  const world::Point2 place = WorldFromOdom(pose, odom).ToWorld(corner);
  MapRecord record;
  record.t_s = t_s;
  record.x_m = place.x_m;
  record.y_m = place.y_m;
  record.yaw_rad = pose.theta_rad - double{odom.yaw_rad};
  record.columns = std::max(0, part.right - part.left + 1);
  record.rows = std::max(0, part.high - part.low + 1);
  for (int row = part.low; row <= part.high; ++row) {
    for (int column = part.left; column <= part.right; ++column) {
      const int index = row * kMapSize_cells + column;
      record.cells.push_back(KindOf(map.flags[index], map.cost_q8[index]));
    }
  }
  return record;
}

}  // namespace

void MapRecorder::Watch(const Pilot& pilot, const sim::Pose& pose, double t_s,
                        std::vector<MapRecord>& maps) {
  // Between two rounds the map is complete: that of the plan judged last.
  const uint64_t plans = pilot.counters().plans;
  const bool is_whole = plans != plans_ && !pilot.replanner().busy();
  plans_ = plans;
  if (!is_whole || t_s < next_s_) return;
  maps.push_back(RecordOf(pilot, pose, t_s));
  if (maps.size() > kMost) {
    size_t kept = 0;
    for (size_t i = 0; i < maps.size(); i += 2) maps[kept++] = std::move(maps[i]);
    maps.resize(kept);
    period_s_ *= 2.0;
  }
  next_s_ = maps.back().t_s + period_s_;
}

}  // namespace hardpack::mission
