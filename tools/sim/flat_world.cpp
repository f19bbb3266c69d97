// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/flat_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hardpack::sim {
namespace {

constexpr double kFar_m = 1.0e9;

// Narrows [enter, leave] to where origin + t * direction lies within low .. high.
bool Narrow(double origin, double direction, double low, double high, Crossing& crossing) {
  if (std::abs(direction) < 1.0e-12) return origin >= low && origin <= high;
  double first = (low - origin) / direction;
  double second = (high - origin) / direction;
  if (first > second) std::swap(first, second);
  crossing.enter_m = std::max(crossing.enter_m, first);
  crossing.leave_m = std::min(crossing.leave_m, second);
  return crossing.enter_m < crossing.leave_m;
}

}  // namespace

void FindCrossings(const FlatWorld& world, const Point2& origin, const Point2& direction,
                   std::vector<Crossing>& crossings) {
  crossings.clear();
  for (const scene::Box& box : world.boxes) {
    Crossing crossing = {0.0, kFar_m, box.low[2], box.high[2]};
    if (Narrow(origin.x_m, direction.x_m, box.low[0], box.high[0], crossing) &&
        Narrow(origin.y_m, direction.y_m, box.low[1], box.high[1], crossing)) {
      crossings.push_back(crossing);
    }
  }
  for (const scene::Cylinder& cylinder : world.cylinders) {
    const double x_m = cylinder.x_m - origin.x_m;
    const double y_m = cylinder.y_m - origin.y_m;
    const double along_m = x_m * direction.x_m + y_m * direction.y_m;
    const double across_m = x_m * direction.y_m - y_m * direction.x_m;
    const double square_m2 = cylinder.radius_m * cylinder.radius_m - across_m * across_m;
    if (square_m2 <= 0.0) continue;
    const double half_m = std::sqrt(square_m2);
    if (along_m + half_m <= 0.0) continue;
    crossings.push_back(
        {std::max(along_m - half_m, 0.0), along_m + half_m, cylinder.low_m, cylinder.high_m});
  }
}

double MeetLevel_m(const std::vector<Crossing>& crossings, double origin_z_m, double slope,
                   double reach_m) {
  double nearest_m = slope < 0.0 ? -origin_z_m / slope : kFar_m;
  for (const Crossing& crossing : crossings) {
    double enter_m = crossing.enter_m;
    const double z_m = origin_z_m + enter_m * slope;
    // Over it or under it: it may come down on its top or rise to its bottom.
    if (z_m > crossing.high_m) {
      if (slope >= 0.0) continue;
      enter_m = (crossing.high_m - origin_z_m) / slope;
    } else if (z_m < crossing.low_m) {
      if (slope <= 0.0) continue;
      enter_m = (crossing.low_m - origin_z_m) / slope;
    }
    if (enter_m < crossing.leave_m) nearest_m = std::min(nearest_m, enter_m);
  }
  return nearest_m <= reach_m ? nearest_m : -1.0;
}

bool Collides(const FlatWorld& world, const Point2& center, double heading_rad,
              double half_length_m, double half_width_m) {
  constexpr double kClearance_m = 0.1;
  const double c = std::cos(heading_rad);
  const double s = std::sin(heading_rad);
  const auto inside = [&](double x_m, double y_m, double margin_m) {
    const double dx_m = x_m - center.x_m;
    const double dy_m = y_m - center.y_m;
    return std::abs(c * dx_m + s * dy_m) <= half_length_m + margin_m &&
           std::abs(c * dy_m - s * dx_m) <= half_width_m + margin_m;
  };
  constexpr std::array<double, 5> kAlong = {-1.0, -0.5, 0.0, 0.5, 1.0};
  for (const scene::Box& box : world.boxes) {
    if (box.high[2] < kClearance_m) continue;
    for (const double u : kAlong) {
      for (const double v : kAlong) {
        const Point2 on_box = {(box.low[0] + box.high[0] + u * (box.high[0] - box.low[0])) / 2.0,
                               (box.low[1] + box.high[1] + v * (box.high[1] - box.low[1])) / 2.0};
        const Point2 on_vehicle = {center.x_m + u * c * half_length_m - v * s * half_width_m,
                                   center.y_m + u * s * half_length_m + v * c * half_width_m};
        if (inside(on_box.x_m, on_box.y_m, 0.0)) return true;
        if (on_vehicle.x_m >= box.low[0] && on_vehicle.x_m <= box.high[0] &&
            on_vehicle.y_m >= box.low[1] && on_vehicle.y_m <= box.high[1]) {
          return true;
        }
      }
    }
  }
  for (const scene::Cylinder& cylinder : world.cylinders) {
    if (cylinder.high_m >= kClearance_m && inside(cylinder.x_m, cylinder.y_m, cylinder.radius_m)) {
      return true;
    }
  }
  return false;
}

}  // namespace hardpack::sim
