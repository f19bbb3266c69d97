// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/parameters.h"
#include "core/autonomy/planner.h"
#include "tools/picture/axes.h"
#include "tools/picture/canvas.h"

// plan.png: the costmap in the paper's colours, the base path, the optimized path, start, goal, a
// legend, the plan's key figures and its speed over the distance.

namespace hardpack::picture {

struct PlanPicture {
  const Costmap* map = nullptr;
  const Plan* plan = nullptr;
  const PlannerParams* params = nullptr;
  PlanRequest request;
  std::string title;
  // Shown in the margin, in this order: name, and value with its unit.
  std::vector<std::pair<std::string, std::string>> figures;
};

// The part of the map to show: start, goal and both paths, with a margin [m, odom].
void FindView(const PlanPicture& picture, Range& x, Range& y);

Canvas DrawPlan(const PlanPicture& picture);

// The outline of the vehicle, with a line from its middle to the front.
void DrawVehicle(Canvas& canvas, Axes& axes, const VehicleParams& vehicle, const Pose2& pose,
                 const Colour& fill, const Colour& rim);

}  // namespace hardpack::picture
