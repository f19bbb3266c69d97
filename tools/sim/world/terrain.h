// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "tools/sim/world/portable_math.h"

// The ground: a height for each corner of a grid, with bilinear interpolation, and the border's
// height beyond it. Built once from a formula.

namespace hardpack::world {

// The extent of a world: rays that leave it hit nothing.
struct Bounds {
  double low_x_m = -110.0;
  double low_y_m = -110.0;
  double high_x_m = 170.0;
  double high_y_m = 110.0;
};

struct Ground {
  double height_m = 0.0;
  Vector normal = {0.0, 0.0, 1.0};  // length 1, upward
};

class Terrain {
 public:
  static constexpr double kStep_m = 0.25;

  // Level ground at height 0.
  Terrain() = default;
  // The formula is evaluated at the corners only.
  Terrain(const Bounds& bounds, const std::function<double(double x_m, double y_m)>& height_m);

  bool flat() const { return heights_m_.empty(); }
  double Height_m(double x_m, double y_m) const;
  Ground At(double x_m, double y_m) const;
  // Lowest and highest ground within a rectangle.
  void Extremes_m(double low_x_m, double low_y_m, double high_x_m, double high_y_m, double& low_m,
                  double& high_m) const;

 private:
  struct Place {  // of a point in its grid cell
    size_t corner = 0;
    double across = 0.0;  // shares, 0 .. 1
    double up = 0.0;
  };
  Place PlaceOf(double x_m, double y_m) const;

  double low_x_m_ = 0.0;
  double low_y_m_ = 0.0;
  int columns_ = 0;  // of corners
  int rows_ = 0;
  std::vector<float> heights_m_;  // [rows x columns]
};

}  // namespace hardpack::world
