// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/contact.h"

#include <algorithm>
#include <array>

namespace hardpack::world {
namespace {

constexpr double kDrivenOver_m = 0.1;
constexpr double kDrivenUnder_m = 1.5;

// The outline, and points in its frame.
struct Outline {
  double x_m;
  double y_m;
  Turn turn;
  double half_length_m;
  double half_width_m;

  Point2 ToOutline(const Point2& p) const {
    const double dx_m = p.x_m - x_m;
    const double dy_m = p.y_m - y_m;
    return {turn.cos * dx_m + turn.sin * dy_m, turn.cos * dy_m - turn.sin * dx_m};
  }
  Point2 ToWorld(double along_m, double left_m) const {
    return {x_m + turn.cos * along_m - turn.sin * left_m,
            y_m + turn.sin * along_m + turn.cos * left_m};
  }
  // Negative inside.
  double DistanceTo(const Point2& p) const {
    const Point2 local = ToOutline(p);
    const double beyond_x_m = std::abs(local.x_m) - half_length_m;
    const double beyond_y_m = std::abs(local.y_m) - half_width_m;
    if (beyond_x_m <= 0.0 && beyond_y_m <= 0.0) return std::max(beyond_x_m, beyond_y_m);
    const double x = std::max(beyond_x_m, 0.0);
    const double y = std::max(beyond_y_m, 0.0);
    return std::sqrt(x * x + y * y);
  }
  std::array<Point2, 4> Corners() const {
    return {ToWorld(half_length_m, half_width_m), ToWorld(-half_length_m, half_width_m),
            ToWorld(-half_length_m, -half_width_m), ToWorld(half_length_m, -half_width_m)};
  }
};

double DistanceToStretch(const Point2& p, const Point2& from, const Point2& to) {
  const double x_m = to.x_m - from.x_m;
  const double y_m = to.y_m - from.y_m;
  const double share = std::clamp(
      ((p.x_m - from.x_m) * x_m + (p.y_m - from.y_m) * y_m) / (x_m * x_m + y_m * y_m), 0.0, 1.0);
  const double dx_m = p.x_m - from.x_m - share * x_m;
  const double dy_m = p.y_m - from.y_m - share * y_m;
  return std::sqrt(dx_m * dx_m + dy_m * dy_m);
}

// The largest distance by which a line parallel to a side of either separates the two; negative: no
// line does, and one of them must be moved by that distance (separating axes).
double Parted_m(const Outline& outline, std::span<const Side> sides) {
  double parted_m = -Contact::kFar_m;
  for (const Side& side : sides) {
    double nearest_m = 1.0e9;
    for (const Point2& corner : outline.Corners()) {
      nearest_m = std::min(nearest_m,
                           side.normal_x * corner.x_m + side.normal_y * corner.y_m - side.offset_m);
    }
    parted_m = std::max(parted_m, nearest_m);
  }
  double front_m = 1.0e9, back_m = 1.0e9, left_m = 1.0e9, right_m = 1.0e9;
  for (const Side& side : sides) {
    const Point2 local = outline.ToOutline(side.corner);
    front_m = std::min(front_m, local.x_m - outline.half_length_m);
    back_m = std::min(back_m, -local.x_m - outline.half_length_m);
    left_m = std::min(left_m, local.y_m - outline.half_width_m);
    right_m = std::min(right_m, -local.y_m - outline.half_width_m);
  }
  return std::max({parted_m, front_m, back_m, left_m, right_m});
}

double DistanceToPrism(const Outline& outline, std::span<const Side> sides) {
  const double parted_m = Parted_m(outline, sides);
  if (parted_m <= 0.0) return parted_m;
  double distance_m = Contact::kFar_m;
  for (size_t i = 0; i < sides.size(); ++i) {
    distance_m = std::min(distance_m, outline.DistanceTo(sides[i].corner));
    const Point2& next = sides[(i + 1) % sides.size()].corner;
    for (const Point2& corner : outline.Corners()) {
      distance_m = std::min(distance_m, DistanceToStretch(corner, sides[i].corner, next));
    }
  }
  return distance_m;
}

// Of the part of an ellipsoid at the vehicle's height.
double RadiusBetween(const Body& body, double low_m, double high_m) {
  const double half_m = (body.high_m - body.low_m) / 2.0;
  const double middle_m = body.low_m + half_m;
  const double off = (middle_m - std::clamp(middle_m, low_m, high_m)) / half_m;
  return body.radius_m * std::sqrt(std::max(1.0 - off * off, 0.0));
}

double ClearanceOf(const World& world, const Outline& outline, const Body& body, double ground_m) {
  if (body.shape == Shape::kPrism) return DistanceToPrism(outline, world.SidesOf(body));
  double radius_m = body.radius_m;
  if (body.shape == Shape::kEllipsoid) {
    radius_m = RadiusBetween(body, ground_m + kDrivenOver_m, ground_m + kDrivenUnder_m);
  }
  return outline.DistanceTo({body.x_m, body.y_m}) - radius_m;
}

struct Wheels {
  std::array<Point2, 4> places;  // front left, rear left, rear right, front right
  std::array<double, 4> heights_m;
};

Wheels WheelsOf(const World& world, const Outline& outline, const Footprint& footprint) {
  const double along_m = footprint.half_wheelbase_m;
  const double left_m = footprint.half_track_m;
  Wheels wheels = {{outline.ToWorld(along_m, left_m), outline.ToWorld(-along_m, left_m),
                    outline.ToWorld(-along_m, -left_m), outline.ToWorld(along_m, -left_m)},
                   {}};
  for (size_t i = 0; i < 4; ++i) {
    wheels.heights_m[i] = world.GroundHeight_m(wheels.places[i].x_m, wheels.places[i].y_m);
  }
  return wheels;
}

// Around a point ahead_m ahead of the vehicle's position.
Outline OutlineOf(double x_m, double y_m, double yaw_rad, double ahead_m,
                  const Footprint& footprint) {
  const Turn turn = TurnOf(yaw_rad);
  return {x_m + turn.cos * ahead_m, y_m + turn.sin * ahead_m, turn, footprint.length_m / 2.0,
          footprint.width_m / 2.0};
}

struct Plane {
  double middle_m = 0.0;  // its height at the middle of the outline
  double forward = 0.0;   // rise over run
  double left = 0.0;

  // At the position of a body, at most as far from the outline as the body reaches: on a slope a
  // low body may lie below the ground under the vehicle's middle.
  double HeightNear_m(const Outline& outline, const Body& body) const {
    const Point2 local = outline.ToOutline({body.x_m, body.y_m});
    const auto nearest = [&body](double at_m, double half_m) {
      return std::clamp(at_m, -half_m - body.radius_m, half_m + body.radius_m);
    };
    return middle_m + forward * nearest(local.x_m, outline.half_length_m) +
           left * nearest(local.y_m, outline.half_width_m);
  }
};

Plane PlaneThrough(const Wheels& wheels, const Footprint& footprint) {
  const auto& h = wheels.heights_m;
  const double forward = (h[0] - h[1] - h[2] + h[3]) / (4.0 * footprint.half_wheelbase_m);
  return {(h[0] + h[1] + h[2] + h[3]) / 4.0 + forward * (footprint.middle_m - footprint.wheels_m),
          forward, (h[0] + h[1] - h[2] - h[3]) / (4.0 * footprint.half_track_m)};
}

Wheels WheelsAt(const World& world, double x_m, double y_m, double yaw_rad,
                const Footprint& footprint) {
  return WheelsOf(world, OutlineOf(x_m, y_m, yaw_rad, footprint.wheels_m, footprint), footprint);
}

// The highest ground between the wheels, against the underside above the plane.
double BellyClearance_m(const World& world, const Outline& around_wheels, const Plane& plane,
                        const Footprint& footprint) {
  constexpr int kSteps = 4;  // to either side of the middle
  double least_m = Contact::kFar_m;
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int k = -kSteps; k <= kSteps; ++k) {
      const double along_m = footprint.half_wheelbase_m * i / kSteps;
      const double left_m = footprint.half_track_m * k / kSteps;
      const Point2 place = around_wheels.ToWorld(along_m, left_m);
      const double under_m = plane.middle_m + plane.left * left_m +
                             plane.forward * (along_m + footprint.wheels_m - footprint.middle_m) +
                             footprint.clearance_m;
      least_m = std::min(least_m, under_m - world.GroundHeight_m(place.x_m, place.y_m));
    }
  }
  return least_m;
}

}  // namespace

double FrictionUnder(const World& world, double x_m, double y_m, double yaw_rad,
                     const Footprint& footprint) {
  double friction = 0.0;
  for (const Point2& wheel : WheelsAt(world, x_m, y_m, yaw_rad, footprint).places) {
    friction += 0.25 * world.FrictionAt(wheel.x_m, wheel.y_m);
  }
  return friction;
}

BodyPose StandingPose(const World& world, double x_m, double y_m, double yaw_rad,
                      const Footprint& footprint) {
  const Wheels wheels = WheelsAt(world, x_m, y_m, yaw_rad, footprint);
  const Plane plane = PlaneThrough(wheels, footprint);
  const double height_m = plane.middle_m - plane.forward * footprint.middle_m;
  const double pitch_rad = -Angle(plane.forward, 1.0);
  const double level = std::sqrt(1.0 + plane.forward * plane.forward);
  return {{x_m, y_m, height_m}, Angle(plane.left, level), pitch_rad, yaw_rad};
}

Contact ContactOf(const World& world, double x_m, double y_m, double yaw_rad, double time_s,
                  const Footprint& footprint) {
  Contact contact;
  const Outline outline = OutlineOf(x_m, y_m, yaw_rad, footprint.middle_m, footprint);
  const Wheels wheels = WheelsAt(world, x_m, y_m, yaw_rad, footprint);
  const Plane plane = PlaneThrough(wheels, footprint);
  contact.slope = std::sqrt(plane.forward * plane.forward + plane.left * plane.left);
  for (const Point2& wheel : wheels.places) {
    const Vector normal = world.GroundAt(wheel.x_m, wheel.y_m).normal;
    const double level = std::sqrt(normal.x_m * normal.x_m + normal.y_m * normal.y_m);
    contact.under_wheel = std::max(contact.under_wheel, level / normal.z_m);
    for (const Ditch& ditch : world.ditches()) {
      contact.in_ditch |= ditch.Depth_m(wheel.x_m, wheel.y_m) >= ditch.depth_m / 2.0;
    }
  }
  if (world.has_friction()) {
    contact.belly_m = BellyClearance_m(
        world, OutlineOf(x_m, y_m, yaw_rad, footprint.wheels_m, footprint), plane, footprint);
  }
  const double reach_m = outline.half_length_m + outline.half_width_m;
  for (const Body& body : world.bodies()) {
    const double ground_m = plane.HeightNear_m(outline, body);
    double& nearest_m =
        body.material.matter == Matter::kFoliage ? contact.foliage_m : contact.hard_m;
    const double beyond_m = nearest_m + body.radius_m + reach_m;
    const double dx_m = body.x_m - outline.x_m;
    const double dy_m = body.y_m - outline.y_m;
    const bool is_near = dx_m * dx_m + dy_m * dy_m < beyond_m * beyond_m;
    const bool is_in_way =
        body.high_m >= ground_m + kDrivenOver_m && body.low_m <= ground_m + kDrivenUnder_m;
    if (!is_near || !is_in_way) continue;
    nearest_m = std::min(nearest_m, ClearanceOf(world, outline, body, ground_m));
  }
  for (const Body& person : world.PeopleAt(time_s)) {
    contact.person_m =
        std::min(contact.person_m, ClearanceOf(world, outline, person, plane.middle_m));
  }
  return contact;
}

}  // namespace hardpack::world
