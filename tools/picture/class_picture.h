// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/autonomy/mapper.h"
#include "core/base/pose.h"
#include "core/costmap/costmap.h"
#include "tools/picture/canvas.h"

// classes.png: one revolution of the lidar as classified by the vehicle. At the top its returns
// from above, over the observed ground; below them the range image, all around the vehicle. One
// colour per class in both (docs/algorithm.md section 8).

namespace hardpack::picture {

struct SeenReturn {
  Vec2 place_odom;
  float azimuth_rad = 0.0f;  // from the sensor, anticlockwise from where the vehicle points
  int beam = 0;              // 0 is the lowest
  ReturnClass return_class = ReturnClass::kIgnored;
  bool self = false;  // the vehicle itself, or out of the usable range
};

struct ClassPicture {
  const Costmap* map = nullptr;  // of the observed ground
  VehicleParams vehicle;
  Pose2 pose;       // of the vehicle
  int beams = 1;    // of the sensor
  int columns = 1;  // directions of a revolution
  std::vector<SeenReturn> returns;
  std::string title;  // the number of returns is added
};

// All returns in the mapper's ring, which holds one revolution, taken by a standing vehicle.
std::vector<SeenReturn> ReturnsOf(const Mapper& mapper, const Pose2& pose);

Canvas DrawClasses(const ClassPicture& picture);

// Water blue: returns ignored as rain, dust or void. The other classes are in palette.h.
inline constexpr Colour kIgnoredReturn = {0.15, 0.60, 0.78};
// Returns from the vehicle itself.
inline constexpr Colour kSelfReturn = {0.35, 0.35, 0.38};
// Background where ground was observed, and where a beam did not return.
inline constexpr Colour kObservedGround = {0.97, 0.97, 0.95};
inline constexpr Colour kNoReturn = {1.0, 1.0, 1.0};
// The layout of the picture [px]; beams of the range image are whole pixels high.
inline constexpr Rectangle kClassesFromAbove = {78.0, 92.0, 1024.0, 1024.0};
inline constexpr double kClassesReach_m = 30.0;  // from the vehicle to the view's edges
Rectangle RangeImageArea(int beams);

}  // namespace hardpack::picture
