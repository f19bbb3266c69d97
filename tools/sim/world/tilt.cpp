// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/tilt.h"

#include <algorithm>
#include <cmath>

namespace hardpack::world {
namespace {

constexpr double kPiece_m = 1.0;

struct Slope {
  double rise_x;
  double rise_y;

  double At(double x_m, double y_m) const { return rise_x * x_m + rise_y * y_m; }
  double At(const Point2& place) const { return At(place.x_m, place.y_m); }
};

// The part of a convex outline where sign * the slope's height is at most sign * limit_m.
std::vector<Point2> Cut(const std::vector<Point2>& outline, const Slope& slope, double sign,
                        double limit_m) {
  std::vector<Point2> kept;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Point2& from = outline[i];
    const Point2& to = outline[(i + 1) % outline.size()];
    const double over_m = sign * (slope.At(from) - limit_m);
    const double next_over_m = sign * (slope.At(to) - limit_m);
    if (over_m <= 0.0) kept.push_back(from);
    if ((over_m < 0.0 && next_over_m > 0.0) || (over_m > 0.0 && next_over_m < 0.0)) {
      const double share = over_m / (over_m - next_over_m);
      kept.push_back(
          {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)});
    }
  }
  return kept;
}

void AddPieces(const World& from, const Body& body, const Slope& slope, World& to) {
  std::vector<Point2> outline;
  double low_m = 1.0e9;
  double high_m = -1.0e9;
  for (const Side& side : from.SidesOf(body)) {
    outline.push_back(side.corner);
    low_m = std::min(low_m, slope.At(side.corner));
    high_m = std::max(high_m, slope.At(side.corner));
  }
  const double steep = std::sqrt(slope.rise_x * slope.rise_x + slope.rise_y * slope.rise_y);
  const int pieces = std::max(1, static_cast<int>((high_m - low_m) / (steep * kPiece_m)) + 1);
  const double step_m = (high_m - low_m) / pieces;
  for (int piece = 0; piece < pieces; ++piece) {
    const double begin_m = low_m + piece * step_m;
    const std::vector<Point2> part =
        pieces == 1 ? outline
                    : Cut(Cut(outline, slope, -1.0, begin_m), slope, 1.0, begin_m + step_m);
    if (part.size() < 3) continue;
    const double up_m = begin_m + 0.5 * step_m;
    to.AddPrism(part, body.low_m + up_m, body.high_m + up_m, body.material);
  }
}

}  // namespace

void Tilt(double rise_x, double rise_y, Scenario& scenario) {
  if (rise_x == 0.0 && rise_y == 0.0) return;
  const Slope slope = {rise_x, rise_y};
  const World& level = scenario.world;
  World tilted(level.bounds(),
               Terrain(level.bounds(),
                       [&](double x_m, double y_m) {
                         return level.GroundHeight_m(x_m, y_m) + slope.At(x_m, y_m);
                       }),
               level.ground_label());
  for (const Body& body : level.bodies()) {
    const double up_m = slope.At(body.x_m, body.y_m);
    const Point2 middle = {body.x_m, body.y_m};
    switch (body.shape) {
      case Shape::kPrism:
        AddPieces(level, body, slope, tilted);
        break;
      case Shape::kCylinder:
        tilted.AddCylinder(middle, body.radius_m, body.low_m + up_m, body.high_m + up_m,
                           body.material);
        break;
      case Shape::kEllipsoid:
        tilted.AddEllipsoid({body.x_m, body.y_m, 0.5 * (body.low_m + body.high_m) + up_m},
                            body.radius_m, 0.5 * (body.high_m - body.low_m), body.material);
        break;
    }
  }
  for (const Person& person : level.people()) tilted.AddPerson(person);
  for (const Ditch& ditch : level.ditches()) tilted.AddDitch(ditch);
  if (level.has_friction()) tilted.SetFriction(level.friction());
  for (const Patch& patch : level.patches()) tilted.AddPatch(patch);
  scenario.world = std::move(tilted);
}

}  // namespace hardpack::world
