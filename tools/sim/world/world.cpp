// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/world.h"

#include <algorithm>

namespace hardpack::world {
namespace {

// In the sensor's 16-bit units; grass and leaves reflect much, wet bark little.
uint8_t ReflectivityOf(Label label) {
  switch (label) {
    case Label::kGrass:
      return 45;
    case Label::kBush:
      return 50;
    case Label::kTree:
    case Label::kLog:
      return 25;
    case Label::kDirt:
      return 20;
    case Label::kVehicle:
      return 80;
    default:
      return 40;
  }
}

int CellOf(double offset_m, double cell_m, int count) {
  return static_cast<int>(std::clamp(offset_m / cell_m, 0.0, count - 1.0));
}

bool HasSize(const Body& body) {
  constexpr double kFar_m = 1.0e6;
  return std::abs(body.x_m) < kFar_m && std::abs(body.y_m) < kFar_m && body.radius_m > 0.0 &&
         body.radius_m < kFar_m && body.low_m > -kFar_m && body.low_m < body.high_m &&
         body.high_m < kFar_m;
}

}  // namespace

Point2 Person::At(double time_s) const {
  const double first_s = places.front().time_s;
  const double period_s = places.back().time_s - first_s;
  double at_s = time_s;
  if (repeats && period_s > 0.0) {
    at_s -= std::floor((time_s - first_s) / period_s) * period_s;
  }
  if (!(at_s > first_s)) return {places.front().x_m, places.front().y_m};
  for (size_t i = 1; i < places.size(); ++i) {
    const Place& from = places[i - 1];
    const Place& to = places[i];
    if (at_s >= to.time_s) continue;
    const double share = (at_s - from.time_s) / (to.time_s - from.time_s);
    return {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)};
  }
  return {places.back().x_m, places.back().y_m};
}

double Ditch::Depth_m(double x_m, double y_m) const {
  const double along_x_m = to.x_m - from.x_m;
  const double along_y_m = to.y_m - from.y_m;
  const double length_m = std::sqrt(along_x_m * along_x_m + along_y_m * along_y_m);
  const double dx_m = x_m - from.x_m;
  const double dy_m = y_m - from.y_m;
  const double along_m = (dx_m * along_x_m + dy_m * along_y_m) / length_m;
  const double across_m = std::abs(dx_m * along_y_m - dy_m * along_x_m) / length_m;
  const double bank_m = 2.0 * half_width_m / 3.0;
  const double inside_m =
      std::min({half_width_m - across_m, along_m + bank_m, length_m + bank_m - along_m});
  return depth_m * std::clamp(inside_m / bank_m, 0.0, 1.0);
}

World::World(const Bounds& bounds, Terrain terrain, Label ground)
    : bounds_(bounds),
      terrain_(std::move(terrain)),
      ground_label_(ground),
      columns_(static_cast<int>((bounds.high_x_m - bounds.low_x_m) / kCell_m) + 1),
      rows_(static_cast<int>((bounds.high_y_m - bounds.low_y_m) / kCell_m) + 1),
      top_m_(terrain_.flat() ? 0.0 : -kInfinite) {
  cells_.resize(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  if (terrain_.flat()) return;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const double x_m = bounds_.low_x_m + column * kCell_m;
      const double y_m = bounds_.low_y_m + row * kCell_m;
      SquareCell& cell = cells_[static_cast<size_t>(row * columns_ + column)];
      double low_m = 0.0;
      terrain_.Extremes_m(x_m, y_m, x_m + kCell_m, y_m + kCell_m, low_m, cell.ground_high_m);
      cell.top_m = cell.ground_high_m;
      top_m_ = std::max(top_m_, cell.top_m);
    }
  }
  ground_top_m_ = top_m_;
}

void World::AddBox(Point2 middle, double heading_rad, double length_m, double width_m, double low_m,
                   double high_m, const Material& material) {
  const Turn turn = TurnOf(heading_rad);
  std::vector<Point2> corners;
  for (const auto& [u, v] : {Point2{1, -1}, {1, 1}, {-1, 1}, {-1, -1}}) {
    const double along_m = u * length_m / 2.0;
    const double left_m = v * width_m / 2.0;
    corners.push_back({middle.x_m + turn.cos * along_m - turn.sin * left_m,
                       middle.y_m + turn.sin * along_m + turn.cos * left_m});
  }
  AddPrism(corners, low_m, high_m, material);
}

void World::AddPrism(std::span<const Point2> corners, double low_m, double high_m,
                     const Material& material) {
  Body body = {.shape = Shape::kPrism, .low_m = low_m, .high_m = high_m, .material = material};
  body.first_side = static_cast<uint32_t>(sides_.size());
  body.sides = static_cast<uint32_t>(corners.size());
  for (const Point2& corner : corners) {
    body.x_m += corner.x_m / static_cast<double>(corners.size());
    body.y_m += corner.y_m / static_cast<double>(corners.size());
  }
  Point2 reach;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Point2& from = corners[i];
    const Point2& to = corners[(i + 1) % corners.size()];
    const double dx_m = to.x_m - from.x_m;
    const double dy_m = to.y_m - from.y_m;
    const double length_m = std::sqrt(dx_m * dx_m + dy_m * dy_m);
    Side side = {from, dy_m / length_m, -dx_m / length_m};
    side.offset_m = side.normal_x * from.x_m + side.normal_y * from.y_m;
    sides_.push_back(side);
    const double x_m = from.x_m - body.x_m;
    const double y_m = from.y_m - body.y_m;
    body.radius_m = std::max(body.radius_m, std::sqrt(x_m * x_m + y_m * y_m));
    reach = {std::max(reach.x_m, std::abs(x_m)), std::max(reach.y_m, std::abs(y_m))};
  }
  AddBody(body, reach);
}

void World::AddCylinder(Point2 middle, double radius_m, double low_m, double high_m,
                        const Material& material) {
  AddBody({Shape::kCylinder, middle.x_m, middle.y_m, radius_m, low_m, high_m, material},
          {radius_m, radius_m});
}

void World::AddEllipsoid(const Vector& middle, double radius_m, double half_height_m,
                         const Material& material) {
  AddBody({Shape::kEllipsoid, middle.x_m, middle.y_m, radius_m, middle.z_m - half_height_m,
           middle.z_m + half_height_m, material},
          {radius_m, radius_m});
}

void World::AddBody(const Body& body, Point2 reach) {
  if (!HasSize(body)) return;
  const auto index = static_cast<uint32_t>(bodies_.size());
  bodies_.push_back(body);
  top_m_ = std::max(top_m_, body.high_m);
  const double x_m = body.x_m - bounds_.low_x_m;
  const double y_m = body.y_m - bounds_.low_y_m;
  constexpr double kRounding_m = 1.0e-6;
  const double reach_x_m = reach.x_m + kRounding_m;
  const double reach_y_m = reach.y_m + kRounding_m;
  const Bounds place = {body.x_m - reach_x_m, body.y_m - reach_y_m, body.x_m + reach_x_m,
                        body.y_m + reach_y_m};
  furnished_ = index == 0 ? place
                          : Bounds{std::min(furnished_.low_x_m, place.low_x_m),
                                   std::min(furnished_.low_y_m, place.low_y_m),
                                   std::max(furnished_.high_x_m, place.high_x_m),
                                   std::max(furnished_.high_y_m, place.high_y_m)};
  const int first_row = CellOf(y_m - reach_y_m, kCell_m, rows_);
  const int last_row = CellOf(y_m + reach_y_m, kCell_m, rows_);
  const int first_column = CellOf(x_m - reach_x_m, kCell_m, columns_);
  const int last_column = CellOf(x_m + reach_x_m, kCell_m, columns_);
  TellDistances(first_column, last_column, first_row, last_row);
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      SquareCell& cell = cells_[static_cast<size_t>(row * columns_ + column)];
      cell.bodies.push_back(index);
      cell.top_m = std::max(cell.top_m, body.high_m);
    }
  }
}

// A body was added to these cells.
void World::TellDistances(int first_column, int last_column, int first_row, int last_row) {
  const int end_row = std::min(last_row + kFarCells, rows_);
  const int end_column = std::min(last_column + kFarCells, columns_);
  for (int row = std::max(first_row - kFarCells + 1, 0); row < end_row; ++row) {
    const int rows_off = std::max({first_row - row, row - last_row, 0});
    for (int column = std::max(first_column - kFarCells + 1, 0); column < end_column; ++column) {
      const int columns_off = std::max({first_column - column, column - last_column, 0});
      int32_t& to_body = cells_[static_cast<size_t>(row * columns_ + column)].to_body;
      to_body = std::min(to_body, std::max(rows_off, columns_off));
    }
  }
}

double World::FrictionAt(double x_m, double y_m) const {
  if (!has_friction()) return 0.0;
  double friction = friction_;
  for (const Patch& patch : patches_) {
    const double dx_m = x_m - patch.middle.x_m;
    const double dy_m = y_m - patch.middle.y_m;
    if (dx_m * dx_m + dy_m * dy_m < patch.radius_m * patch.radius_m) friction = patch.friction;
  }
  return friction;
}

Point2 World::PersonAt(size_t person, double time_s) const {
  const Point2 place = people_[person].At(time_s);
  return {place.x_m + detours_[person].x_m, place.y_m + detours_[person].y_m};
}

std::vector<Body> World::PeopleAt(double time_s) const {
  std::vector<Body> bodies;
  for (size_t i = 0; i < people_.size(); ++i) {
    const Person& person = people_[i];
    const Point2 place = PersonAt(i, time_s);
    const double ground_m = GroundHeight_m(place.x_m, place.y_m);
    bodies.push_back({Shape::kCylinder,
                      place.x_m,
                      place.y_m,
                      person.radius_m,
                      ground_m,
                      ground_m + person.height_m,
                      {Label::kPerson, Matter::kSolid, 1.0}});
  }
  return bodies;
}

Hit World::HitAt(double range_m, Label label) const {
  return {range_m, label, ReflectivityOf(label)};
}

}  // namespace hardpack::world
