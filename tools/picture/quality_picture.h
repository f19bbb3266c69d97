// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"
#include "tools/picture/canvas.h"

// One problem and the paths of several solvers: on the costmap, and below it their curvature along
// the path.

namespace hardpack::picture {

struct QualityCurve {
  std::string name;
  WorldPath path;
  // F, map and path part of it, largest curvature and rate, limits, length, clearance, angle, time
  std::array<std::string, 10> figures;
};

struct QualityPicture {
  const Costmap* map = nullptr;
  const PlannerParams* params = nullptr;
  PathStart start;
  Vec2 goal_odom;
  std::optional<float> goal_heading_rad;
  std::string title;
  std::vector<QualityCurve> curves;  // at most 6; the first one is the base path
};

Canvas DrawQuality(const QualityPicture& picture);

}  // namespace hardpack::picture
