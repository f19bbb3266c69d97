// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/walk.h"

#include <algorithm>
#include <cmath>

namespace hardpack::world {
namespace {

constexpr double kAround_mps = 1.2;  // along the vehicle

double LengthOf(Point2 v) {
  return std::sqrt(v.x_m * v.x_m + v.y_m * v.y_m);
}

Point2 Minus(Point2 a, Point2 b) {
  return {a.x_m - b.x_m, a.y_m - b.y_m};
}

// The outline of the vehicle, longer and wider by keep_m on each side, in its own frame: its
// middle, x forward.
class KeptOut {
 public:
  KeptOut(const Bystander& vehicle, double keep_m)
      : turn_(TurnOf(vehicle.yaw_rad)),
        half_length_m_(0.5 * vehicle.footprint.length_m + keep_m),
        half_width_m_(0.5 * vehicle.footprint.width_m + keep_m),
        middle_{vehicle.place.x_m + vehicle.footprint.middle_m * turn_.cos,
                vehicle.place.y_m + vehicle.footprint.middle_m * turn_.sin} {}

  Point2 Inward(Point2 world) const {
    const Point2 arm = Minus(world, middle_);
    return {arm.x_m * turn_.cos + arm.y_m * turn_.sin, arm.y_m * turn_.cos - arm.x_m * turn_.sin};
  }
  Point2 Outward(Point2 body) const {
    return {middle_.x_m + body.x_m * turn_.cos - body.y_m * turn_.sin,
            middle_.y_m + body.x_m * turn_.sin + body.y_m * turn_.cos};
  }

  // How deep within a point is; not positive outside.
  double Depth_m(Point2 body) const {
    const Point2 off = OffBy(body);
    return -std::max(off.x_m, off.y_m);
  }

  // The direction along the nearest side by which `body` comes round to `wanted`; zero: it waits.
  // Round the rear as a rule, so that nobody walks out before the front.
  Point2 Around(Point2 body, Point2 wanted) const {
    const Point2 off = OffBy(body);
    const Point2 wanted_off = OffBy(wanted);
    if (off.y_m >= off.x_m) return {AlongFlank(body, wanted, wanted_off), 0.0};
    if (Depth_m(wanted) > 0.0) return {};
    const bool is_on_this_side = wanted_off.x_m > 0.0 && wanted.x_m * body.x_m > 0.0;
    if (is_on_this_side) return {0.0, wanted.y_m < body.y_m ? -1.0 : 1.0};
    const double flank_m = wanted_off.y_m > 0.0 ? wanted.y_m : body.y_m;
    return {0.0, flank_m < 0.0 ? -1.0 : 1.0};
  }

 private:
  Point2 OffBy(Point2 body) const {
    return {std::abs(body.x_m) - half_length_m_, std::abs(body.y_m) - half_width_m_};
  }
  double AlongFlank(Point2 body, Point2 wanted, Point2 wanted_off) const {
    if (wanted_off.x_m > 0.0) return wanted.x_m < 0.0 ? -1.0 : 1.0;
    const bool is_on_this_side = wanted_off.y_m > 0.0 && wanted.y_m * body.y_m > 0.0;
    return is_on_this_side && wanted.x_m > body.x_m ? 1.0 : -1.0;
  }

  Turn turn_;
  double half_length_m_;
  double half_width_m_;
  Point2 middle_;
};

// Where a person gets to in one step, in the frame of the outline.
Point2 StepTo(Point2 wanted, Point2 from, double step_s, bool may_go_round, const KeptOut& kept) {
  const Point2 way = Minus(wanted, from);
  const double share = kHurry_mps * step_s / std::max(LengthOf(way), kHurry_mps * step_s);
  const Point2 straight =
      share < 1.0 ? Point2{from.x_m + share * way.x_m, from.y_m + share * way.y_m} : wanted;
  if (kept.Depth_m(straight) <= std::max(kept.Depth_m(from), 0.0)) return straight;
  if (!may_go_round) return from;
  const Point2 along = kept.Around(from, wanted);
  const double step_m = kAround_mps * step_s;
  return {from.x_m + step_m * along.x_m, from.y_m + step_m * along.y_m};
}

}  // namespace

void LetPeopleWalk(World& world, double time_s, double step_s, const Bystander& vehicle) {
  if (world.people().empty()) return;
  const double before_s = time_s - step_s;
  for (size_t i = 0; i < world.people().size(); ++i) {
    const Person& person = world.people()[i];
    const KeptOut kept(vehicle, person.radius_m + kKeptFromVehicle_m);
    const Point2 wanted = kept.Inward(person.At(time_s));
    const Point2 from = kept.Inward(world.PersonAt(i, before_s));
    const Point2 to = StepTo(wanted, from, step_s, vehicle.stands, kept);
    // Exactly on the way, so that a walk without a vehicle near is the same as without any.
    const bool is_on_way = to.x_m == wanted.x_m && to.y_m == wanted.y_m;
    world.SetDetour(i, is_on_way ? Point2{} : Minus(kept.Outward(to), person.At(time_s)));
  }
}

}  // namespace hardpack::world
