// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tools/sim/world/world.h"

// World: rays. Cell by cell along the ray (Amanatides and Woo, REFERENCES.md); where no body is
// near and the ground is below, many cells in one step.

namespace hardpack::world {
namespace {

// Narrows a ray's way to low <= origin + t * direction <= high.
bool Narrow(double origin, double direction, double low, double high, double& from, double& to) {
  if (std::abs(direction) < 1.0e-12) return origin >= low && origin <= high;
  const double one = (low - origin) / direction;
  const double other = (high - origin) / direction;
  from = std::max(from, std::min(one, other));
  to = std::min(to, std::max(one, other));
  return from <= to;
}

// And to a t^2 + 2 b t + c <= 0.
bool NarrowToRoots(double a, double b, double c, double& from, double& to) {
  if (a < 1.0e-18) return c <= 0.0;
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return false;
  const double root = std::sqrt(discriminant);
  from = std::max(from, (-b - root) / a);
  to = std::min(to, (-b + root) / a);
  return from <= to;
}

bool NarrowTo(const Bounds& bounds, const Ray& ray, double& from, double& to) {
  return Narrow(ray.origin.x_m, ray.direction.x_m, bounds.low_x_m, bounds.high_x_m, from, to) &&
         Narrow(ray.origin.y_m, ray.direction.y_m, bounds.low_y_m, bounds.high_y_m, from, to);
}

bool IsUsable(const Ray& ray) {
  const Vector& d = ray.direction;
  const double square = d.x_m * d.x_m + d.y_m * d.y_m + d.z_m * d.z_m;
  const bool placed = std::abs(ray.origin.x_m) < 1.0e9 && std::abs(ray.origin.y_m) < 1.0e9 &&
                      std::abs(ray.origin.z_m) < 1.0e9;
  return placed && std::abs(square - 1.0) < 2.0e-3 && ray.max_range_m > 0.0;
}

// The distances at which a ray passes from cell to cell along one axis.
struct Steps {
  int index = 0;
  int step = 0;
  int end = 0;  // the first index that is outside
  double next_m = kInfinite;
  double each_m = kInfinite;
  double per_m = 0.0;

  Steps(double offset_m, double direction, double from_m, double cell_m, int count) {
    index = std::clamp(static_cast<int>((offset_m + from_m * direction) / cell_m), 0, count - 1);
    if (std::abs(direction) < 1.0e-12) return;
    step = direction > 0.0 ? 1 : -1;
    end = direction > 0.0 ? count : -1;
    const double slowness = 1.0 / direction;
    each_m = cell_m * std::abs(slowness);
    per_m = std::abs(direction) / cell_m;
    next_m = ((index + (direction > 0.0 ? 1 : 0)) * cell_m - offset_m) * slowness;
  }
  bool Advance() {
    index += step;
    next_m += each_m;
    return index != end;
  }
  // The distance after that many cells.
  double After(int cells) const { return next_m + (cells - 1) * each_m; }
  void AdvanceBy(int cells) {
    if (cells == 0) return;
    index += cells * step;
    next_m += cells * each_m;
  }
  int CellsBefore(double distance_m) const {
    return distance_m < next_m ? 0 : 1 + static_cast<int>((distance_m - next_m) * per_m);
  }
  bool IsInside() const { return step == 0 || (step > 0 ? index < end : index > end); }
};

}  // namespace

Hit World::Cast(const Ray& ray, std::span<const Body> people) const {
  Hit hit;
  if (!IsUsable(ray)) return hit;
  Way way = {0.0, ray.max_range_m};
  if (!IsWithin(ray, way)) return hit;
  hit.range_m = kInfinite;
  if (terrain_.flat()) {
    const double dz = ray.direction.z_m;
    const double ground_m =
        ray.origin.z_m <= 0.0 ? 0.0 : (dz < 0.0 ? -ray.origin.z_m / dz : kInfinite);
    if (ground_m <= way.to_m && ground_m >= way.from_m) {
      hit = HitAt(ground_m, ground_label_);
      way.to_m = ground_m;
    }
  }
  for (size_t i = 0; i < people.size(); ++i) {
    MeetBody(ray, people[i], bodies_.size() + i, hit);
  }
  // Level ground has been tested already: only the bodies are left.
  if (!terrain_.flat() || (!bodies_.empty() && NarrowTo(furnished_, ray, way.from_m, way.to_m))) {
    Walk(ray, way, hit);
  }
  return hit.range_m <= ray.max_range_m ? hit : Hit{};
}

bool World::IsWithin(const Ray& ray, Way& way) const {
  if (!NarrowTo(bounds_, ray, way.from_m, way.to_m)) return false;
  // Nothing is above the top; people are far below the top of most worlds, but not of all.
  constexpr double kPerson_m = 3.0;
  const double top_m = top_m_ + (people_.empty() ? 0.0 : kPerson_m);
  if (ray.direction.z_m > 0.0) {
    way.to_m = std::min(way.to_m, (top_m - ray.origin.z_m) / ray.direction.z_m);
  } else if (ray.origin.z_m > top_m && ray.direction.z_m < 0.0) {
    way.from_m = std::max(way.from_m, (top_m - ray.origin.z_m) / ray.direction.z_m);
  } else if (ray.origin.z_m > top_m) {
    return false;
  }
  return way.from_m <= way.to_m;
}

void World::Walk(const Ray& ray, Way way, Hit& hit) const {
  Steps x(ray.origin.x_m - bounds_.low_x_m, ray.direction.x_m, way.from_m, kCell_m, columns_);
  Steps y(ray.origin.y_m - bounds_.low_y_m, ray.direction.y_m, way.from_m, kCell_m, rows_);
  double in_m = way.from_m;
  while (in_m <= way.to_m) {
    const double out_m = std::min({x.next_m, y.next_m, way.to_m});
    const SquareCell& cell = cells_[static_cast<size_t>(y.index * columns_ + x.index)];
    // A leap pays off from two cells on.
    if (cell.to_body > 1) {
      const double leap_m = std::min({x.After(cell.to_body), y.After(cell.to_body), way.to_m});
      const double lowest_m =
          ray.origin.z_m + (ray.direction.z_m < 0.0 ? leap_m : in_m) * ray.direction.z_m;
      if (terrain_.flat() || lowest_m > ground_top_m_) {
        if (leap_m >= way.to_m) return;
        x.AdvanceBy(x.CellsBefore(leap_m));
        y.AdvanceBy(y.CellsBefore(leap_m));
        if (!x.IsInside() || !y.IsInside()) return;
        in_m = leap_m;
        continue;
      }
    }
    const double low_m =
        ray.origin.z_m + (ray.direction.z_m < 0.0 ? out_m : in_m) * ray.direction.z_m;
    if (low_m <= cell.top_m) {
      MeetBodies(ray, cell, low_m, hit);
      if (!terrain_.flat() && low_m <= cell.ground_high_m)
        MeetGround(ray, cell, {in_m, out_m}, hit);
      if (hit.range_m <= out_m) return;
    }
    if (out_m >= way.to_m) return;
    in_m = out_m;
    if (!(x.next_m <= y.next_m ? x.Advance() : y.Advance())) return;
  }
}

void World::MeetBodies(const Ray& ray, const SquareCell& cell, double low_m, Hit& hit) const {
  for (const uint32_t index : cell.bodies) {
    const Body& body = bodies_[index];
    if (low_m <= body.high_m) MeetBody(ray, body, index, hit);
  }
}

void World::MeetBody(const Ray& ray, const Body& body, uint64_t index, Hit& hit) const {
  Way way = {0.0, std::min(hit.range_m, ray.max_range_m)};
  if (!Crosses(ray, body, way)) return;
  double range_m = way.from_m;
  if (body.material.matter == Matter::kMesh) {
    if (DrawUniform(ray.key, index) >= body.material.seen) return;
  } else if (body.material.matter == Matter::kFoliage) {
    range_m -= Log(1.0 - DrawUniform(ray.key, index)) / body.material.seen;
    if (range_m > way.to_m) return;
  }
  if (range_m < hit.range_m) hit = HitAt(range_m, body.material.label);
}

bool World::Crosses(const Ray& ray, const Body& body, Way& way) const {
  const Vector& o = ray.origin;
  const Vector& d = ray.direction;
  const double x_m = o.x_m - body.x_m;
  const double y_m = o.y_m - body.y_m;
  const double level = d.x_m * d.x_m + d.y_m * d.y_m;
  const double along = x_m * d.x_m + y_m * d.y_m;
  const double outside_m2 = x_m * x_m + y_m * y_m - body.radius_m * body.radius_m;
  // Most rays pass beside it: no division is needed to tell that.
  if (along * along - level * outside_m2 < 0.0) return false;
  if (!Narrow(o.z_m, d.z_m, body.low_m, body.high_m, way.from_m, way.to_m)) return false;
  if (body.shape == Shape::kEllipsoid) {
    const double half_height_m = (body.high_m - body.low_m) / 2.0;
    const double scale = body.radius_m / half_height_m;
    const double z_m = (o.z_m - body.low_m - half_height_m) * scale;
    const double dz = d.z_m * scale;
    return NarrowToRoots(level + dz * dz, along + z_m * dz, outside_m2 + z_m * z_m, way.from_m,
                         way.to_m);
  }
  if (!NarrowToRoots(level, along, outside_m2, way.from_m, way.to_m)) return false;
  if (body.shape == Shape::kCylinder) return true;
  for (const Side& side : SidesOf(body)) {
    const double approach = side.normal_x * d.x_m + side.normal_y * d.y_m;
    const double inside_m = side.offset_m - side.normal_x * o.x_m - side.normal_y * o.y_m;
    if (std::abs(approach) < 1.0e-12) {
      if (inside_m < 0.0) return false;
    } else if (approach > 0.0) {
      way.to_m = std::min(way.to_m, inside_m / approach);
    } else {
      way.from_m = std::max(way.from_m, inside_m / approach);
    }
  }
  return way.from_m <= way.to_m;
}

// Along the ray within one cell, in steps of at most the terrain's grid; then refined.
void World::MeetGround(const Ray& ray, const SquareCell& cell, Way way, Hit& hit) const {
  const Vector& o = ray.origin;
  const Vector& d = ray.direction;
  const auto above_m = [&](double t) {
    return o.z_m + t * d.z_m - terrain_.Height_m(o.x_m + t * d.x_m, o.y_m + t * d.y_m);
  };
  if (d.z_m < 0.0) way.from_m = std::max(way.from_m, (cell.ground_high_m - o.z_m) / d.z_m);
  way.to_m = std::min(way.to_m, hit.range_m);
  if (way.from_m > way.to_m) return;
  const double level_m = std::sqrt(d.x_m * d.x_m + d.y_m * d.y_m) * (way.to_m - way.from_m);
  const int steps = static_cast<int>(level_m / Terrain::kStep_m) + 1;
  double near_m = way.from_m;
  double above_near_m = above_m(near_m);
  for (int i = 1; i <= steps && above_near_m > 0.0; ++i) {
    double far_m = way.from_m + (way.to_m - way.from_m) * i / steps;
    double above_far_m = above_m(far_m);
    if (above_far_m > 0.0) {
      near_m = far_m;
      above_near_m = above_far_m;
      continue;
    }
    // False position; between two of its corners the ground is at most a parabola.
    constexpr int kRefinements = 3;
    for (int k = 0; k < kRefinements; ++k) {
      const double middle_m =
          near_m + (far_m - near_m) * above_near_m / (above_near_m - above_far_m);
      const double above_middle_m = above_m(middle_m);
      (above_middle_m > 0.0 ? near_m : far_m) = middle_m;
      (above_middle_m > 0.0 ? above_near_m : above_far_m) = above_middle_m;
    }
    near_m += (far_m - near_m) * above_near_m / (above_near_m - above_far_m);
    above_near_m = 0.0;
  }
  if (above_near_m <= 0.0 && near_m < hit.range_m) hit = HitAt(near_m, ground_label_);
}

}  // namespace hardpack::world
