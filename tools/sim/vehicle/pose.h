// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace hardpack::sim {

// A pose in the world's frame: metres, x and y level, anticlockwise.
struct Pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;  // not wrapped
};

}  // namespace hardpack::sim
