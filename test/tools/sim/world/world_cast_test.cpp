// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gtest/gtest.h"
#include "tools/sim/world/features.h"
#include "tools/sim/world/world.h"

// Rays against ranges worked out by hand.

namespace hardpack::world {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Material kStone = {Label::kRubble, Matter::kSolid, 1.0};

Vector Normalized(Vector v) {
  const double length = std::sqrt(v.x_m * v.x_m + v.y_m * v.y_m + v.z_m * v.z_m);
  return {v.x_m / length, v.y_m / length, v.z_m / length};
}

Hit CastFrom(const World& world, Vector origin, Vector direction, double time_s = 0.0,
             double max_range_m = 110.0, uint64_t key = 0) {
  return world.Cast(Ray{origin, Normalized(direction), max_range_m, key}, time_s);
}

// The range, negative for nothing.
double Range(const World& world, Vector origin, Vector direction) {
  return CastFrom(world, origin, direction).range_m;
}

TEST(Cast, MeetsLevelGround) {
  const World world;
  EXPECT_DOUBLE_EQ(Range(world, {0, 0, 2}, {0, 0, -1}), 2.0);
  EXPECT_NEAR(Range(world, {3, 4, 1}, {1, 0, -0.1}), std::sqrt(101.0), 1.0e-12);
  EXPECT_EQ(CastFrom(world, {0, 0, 1}, {1, 0, -1}).label, Label::kGrass);
  EXPECT_LT(Range(world, {0, 0, 1}, {1, 0, 0}), 0.0) << "level";
  EXPECT_LT(Range(world, {0, 0, 1}, {1, 0, 0.1}), 0.0) << "upward";
  EXPECT_LT(Range(world, {0, 0, 1.2}, {1, 0, -0.01}), 0.0) << "beyond the reach";
  EXPECT_EQ(Range(world, {0, 0, -0.1}, {1, 0, 0}), 0.0) << "from below it";
}

TEST(Cast, MeetsGroundThatRises) {
  // A ramp of 1 in 5 from x = 10 on.
  const World world(
      {}, Terrain({}, [](double x_m, double) { return x_m > 10.0 ? 0.2 * (x_m - 10.0) : 0.0; }));
  EXPECT_NEAR(Range(world, {0, 0, 1}, {1, 0, 0}), 15.0, 1.0e-6);
  EXPECT_NEAR(Range(world, {0, 7.3, 0.6}, {1, 0, 0}), 13.0, 1.0e-6);
  EXPECT_NEAR(Range(world, {20, 0, 7}, {0, 0, -1}), 5.0, 1.0e-6);
  EXPECT_NEAR(Range(world, {30, 0, 5}, {-1, 0, 0}), -1.0, 1.0e-6) << "along it, away from it";
  EXPECT_NEAR(world.GroundHeight_m(15.1, 3.0), 1.02, 1.0e-6);
  const Vector normal = world.GroundAt(15.1, 3.0).normal;
  EXPECT_NEAR(-normal.x_m / normal.z_m, 0.2, 1.0e-6);
  EXPECT_NEAR(normal.y_m, 0.0, 1.0e-9);
}

TEST(Cast, MeetsGroundWhereAStepwiseSearchDoes) {
  const World world({}, Terrain({}, [](double x_m, double y_m) {
                      return 0.4 * std::sin(0.7 * x_m) * std::cos(0.5 * y_m);
                    }));
  int compared = 0;
  for (int i = 0; i < 400; ++i) {
    const double angle_rad = 0.1 * i;
    const Vector direction =
        Normalized({std::cos(angle_rad), std::sin(angle_rad), -0.03 - 0.0007 * i});
    const Vector origin = {0.3, -0.2, 1.3};
    double expected_m = -1.0;
    for (double t = 0.0; t < 60.0 && expected_m < 0.0; t += 0.001) {
      const double z_m = origin.z_m + t * direction.z_m;
      const double x_m = origin.x_m + t * direction.x_m;
      if (z_m <= world.GroundHeight_m(x_m, origin.y_m + t * direction.y_m)) expected_m = t;
    }
    const double range_m = Range(world, origin, direction);
    if (expected_m < 0.0) continue;
    ++compared;
    // A top that is only just touched may be missed by either.
    const double above_m = origin.z_m + range_m * direction.z_m -
                           world.GroundHeight_m(origin.x_m + range_m * direction.x_m,
                                                origin.y_m + range_m * direction.y_m);
    EXPECT_NEAR(above_m, 0.0, 0.002) << i;
    EXPECT_NEAR(range_m, expected_m, 0.02) << i;
  }
  EXPECT_GT(compared, 300);
}

//   y
//   |    +--+
//   +----|  |---> x     box 2 x 2 x 1 m, middle at (6, 0)
//        +--+
TEST(Cast, MeetsABoxOnEachSide) {
  World world;
  world.AddBox({6.0, 0.0}, 0.0, 2.0, 2.0, 0.0, 1.0, kStone);
  EXPECT_NEAR(Range(world, {0, 0, 0.5}, {1, 0, 0}), 5.0, 1.0e-12);
  EXPECT_NEAR(Range(world, {0, 0.999, 0.5}, {1, 0, 0}), 5.0, 1.0e-12) << "grazing";
  EXPECT_LT(Range(world, {0, 1.001, 0.5}, {1, 0, 0}), 0.0) << "beside";
  EXPECT_NEAR(Range(world, {10, 0, 0.5}, {-1, 0, 0}), 3.0, 1.0e-12);
  EXPECT_NEAR(Range(world, {6, 5, 0.5}, {0, -1, 0}), 4.0, 1.0e-12);
  EXPECT_NEAR(Range(world, {6, 0, 3}, {0, 0, -1}), 2.0, 1.0e-12) << "the lid";
  EXPECT_NEAR(Range(world, {0, 0, 2}, {5.5, 0, -1}), std::sqrt(5.5 * 5.5 + 1.0), 1.0e-12);
  EXPECT_NEAR(Range(world, {0, 0, 0.5}, {5, 0.9, 0}), std::sqrt(25.81), 1.0e-12);
  EXPECT_EQ(Range(world, {6, 0, 0.5}, {1, 0, 0}), 0.0) << "from inside";
  EXPECT_LT(Range(world, {0, 0, 1.01}, {1, 0, 0}), 0.0) << "above it";
  EXPECT_LT(Range(world, {0, 0, 0.5}, {-1, 0, 0}), 0.0) << "behind";
  EXPECT_EQ(CastFrom(world, {0, 0, 0.5}, {1, 0, 0}).label, Label::kRubble);
}

TEST(Cast, MeetsATurnedBox) {
  World world;
  world.AddBox({6.0, 0.0}, M_PI / 4.0, 2.0, 2.0, 0.0, 1.0, kStone);
  EXPECT_NEAR(Range(world, {0, 0, 0.5}, {1, 0, 0}), 6.0 - std::sqrt(2.0), 1.0e-9);
  EXPECT_NEAR(Range(world, {0, 1.0, 0.5}, {1, 0, 0}), 7.0 - std::sqrt(2.0), 1.0e-9);
}

TEST(Cast, MeetsACylinder) {
  World world;
  world.AddCylinder({5.0, 0.0}, 1.0, 0.0, 2.0, kStone);
  EXPECT_NEAR(Range(world, {0, 0, 1}, {1, 0, 0}), 4.0, 1.0e-12);
  EXPECT_NEAR(Range(world, {0, 0.6, 1}, {1, 0, 0}), 4.2, 1.0e-12);
  EXPECT_LT(Range(world, {0, 1.0001, 1}, {1, 0, 0}), 0.0);
  EXPECT_NEAR(Range(world, {0, 0.99999, 1}, {1, 0, 0}), 5.0, 0.005) << "grazing";
  EXPECT_NEAR(Range(world, {5.5, 0, 5}, {0, 0, -1}), 3.0, 1.0e-12) << "along its axis";
  EXPECT_NEAR(Range(world, {6.5, 0, 5}, {0, 0, -1}), 5.0, 1.0e-12) << "beside it, the ground";
  EXPECT_EQ(Range(world, {5.2, 0, 1}, {1, 0, 0}), 0.0) << "from inside";
}

TEST(Cast, MeetsAnEllipsoid) {
  World world;
  world.AddEllipsoid({5.0, 0.0, 1.0}, 2.0, 0.5, kStone);
  EXPECT_NEAR(Range(world, {0, 0, 1}, {1, 0, 0}), 3.0, 1.0e-12);
  EXPECT_NEAR(Range(world, {5, 0, 3}, {0, 0, -1}), 1.5, 1.0e-12);
  EXPECT_NEAR(Range(world, {0, 0, 1.3}, {1, 0, 0}), 5.0 - 2.0 * 0.8, 1.0e-12);
  EXPECT_LT(Range(world, {0, 0, 1.501}, {1, 0, 0}), 0.0);
  EXPECT_EQ(Range(world, {5, 0, 1}, {0, 1, 0}), 0.0) << "from inside";
}

TEST(Cast, MeetsTheNearestOfMany) {
  World world;
  for (int i = 0; i < 200; ++i) {
    world.AddCylinder({4.0 + 0.31 * i, 0.01 * i}, 0.2, 0.0, 0.02 * i, kStone);
  }
  for (int i = 1; i < 200; ++i) {
    const double z_m = 0.02 * i - 0.01;
    const double range_m = Range(world, {0, 0.01 * i, z_m}, {1, 0, 0});
    EXPECT_NEAR(range_m, 4.0 + 0.31 * i - 0.2, 0.001) << i;
  }
}

// The nearest of upright cylinders and level ground, each met by itself.
double NearestOf(const std::vector<Body>& bodies, const Vector& o, const Vector& d,
                 double reach_m) {
  double nearest_m = d.z_m < 0.0 ? -o.z_m / d.z_m : 1.0e9;
  for (const Body& body : bodies) {
    const double x_m = o.x_m - body.x_m;
    const double y_m = o.y_m - body.y_m;
    const double a = d.x_m * d.x_m + d.y_m * d.y_m;
    const double b = x_m * d.x_m + y_m * d.y_m;
    const double c = x_m * x_m + y_m * y_m - body.radius_m * body.radius_m;
    if (b * b < a * c) continue;
    const double root = std::sqrt(b * b - a * c);
    const double low_m = (body.low_m - o.z_m) / d.z_m;
    const double high_m = (body.high_m - o.z_m) / d.z_m;
    const double enter_m = std::max({0.0, (-b - root) / a, std::min(low_m, high_m)});
    const double leave_m = std::min((-b + root) / a, std::max(low_m, high_m));
    if (enter_m <= leave_m) nearest_m = std::min(nearest_m, enter_m);
  }
  return nearest_m <= reach_m ? nearest_m : -1.0;
}

// Few bodies far apart, so that most of the way is leapt over, and many.
TEST(Cast, MissesNothingOnItsWay) {
  for (const int count : {1, 5, 40, 600}) {
    Draws draws(11, static_cast<uint64_t>(count));
    World world({-60.0, -60.0, 60.0, 60.0});
    for (int i = 0; i < count; ++i) {
      world.AddCylinder({draws.Uniform(-55.0, 55.0), draws.Uniform(-55.0, 55.0)},
                        draws.Uniform(0.05, 1.5), draws.Uniform(-0.5, 1.0), draws.Uniform(1.1, 4.0),
                        kStone);
    }
    int met = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector origin = {draws.Uniform(-50.0, 50.0), draws.Uniform(-50.0, 50.0),
                             draws.Uniform(0.2, 3.0)};
      // Some exactly along an axis of the cells.
      const Turn level =
          i % 10 == 0 ? TurnOf(i / 10 % 4 * kPi / 2.0) : TurnOf(draws.Uniform(-kPi, kPi));
      const Vector direction = Normalized({level.cos, level.sin, draws.Uniform(-0.1, 0.1)});
      double expected_m = NearestOf(world.bodies(), origin, direction, 110.0);
      const double x_m = origin.x_m + expected_m * direction.x_m;
      const double y_m = origin.y_m + expected_m * direction.y_m;
      if (std::max(std::abs(x_m), std::abs(y_m)) > 60.0) expected_m = -1.0;  // ground beyond
      const double range_m = Range(world, origin, direction);
      ASSERT_NEAR(range_m, expected_m, 1.0e-9) << count << " bodies, ray " << i;
      met += range_m >= 0.0 ? 1 : 0;
    }
    EXPECT_GT(met, 1000);
  }
}

TEST(Cast, MakesNothingOfARayThatIsNone) {
  World world;
  world.AddBox({6.0, 0.0}, 0.0, 2.0, 2.0, 0.0, 1.0, kStone);
  const auto nothing = [&world](const Vector& origin, const Vector& direction, double reach_m) {
    return !world.Cast(Ray{origin, direction, reach_m, 0}, 0.0).any();
  };
  EXPECT_FALSE(nothing({0, 0, 0.5}, {1, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {kNaN, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {1, kNaN, 0}, 50.0));
  EXPECT_TRUE(nothing({0, kNaN, 0.5}, {1, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 0, kNaN}, {1, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {0, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {2, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {1, 0, 0}, kNaN));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {1, 0, 0}, -1.0));
  EXPECT_TRUE(nothing({0, 0, 0.5}, {1, 0, 0}, 4.9));
  EXPECT_TRUE(nothing({1.0e300, 0, 0.5}, {1, 0, 0}, 50.0));
  EXPECT_TRUE(nothing({0, 5000.0, 0.5}, {1, 0, 0}, 50.0)) << "outside the bounds";
}

TEST(World, LeavesOutBodiesThatAreNone) {
  World world;
  world.AddBox({kNaN, 0.0}, 0.0, 1.0, 1.0, 0.0, 1.0, kStone);
  world.AddBox({1.0, 0.0}, 0.0, 0.0, 0.0, 0.0, 1.0, kStone);
  world.AddBox({1.0, 0.0}, 0.0, 1.0, 1.0, 1.0, 1.0, kStone);
  world.AddCylinder({1.0e300, 0.0}, 1.0, 0.0, 1.0, kStone);
  world.AddCylinder({1.0, 0.0}, 1.0, kNaN, 1.0, kStone);
  world.AddEllipsoid({0.0, kNaN, 0.0}, 1.0, 1.0, kStone);
  world.AddEllipsoid({0.0, 0.0, 0.0}, -1.0, 1.0, kStone);
  EXPECT_TRUE(world.bodies().empty());
  EXPECT_FALSE(CastFrom(world, {0, 0, 0.5}, {1, 0, 0}).any());
}

TEST(Terrain, HasAHeightEverywhere) {
  const World world({-10.0, -10.0, 10.0, 10.0},
                    Terrain({-10.0, -10.0, 10.0, 10.0}, [](double x_m, double) { return x_m; }));
  EXPECT_NEAR(world.GroundHeight_m(50.0, 0.0), 10.25, 0.26) << "the border's, beyond it";
  EXPECT_NEAR(world.GroundHeight_m(-1.0e300, 0.0), -10.0, 1.0e-6);
  EXPECT_TRUE(std::isfinite(world.GroundHeight_m(kNaN, kNaN)));
}

TEST(Cast, ComesInFromOutsideTheBounds) {
  World world({-10.0, -10.0, 10.0, 10.0});
  world.AddBox({6.0, 0.0}, 0.0, 2.0, 2.0, 0.0, 1.0, kStone);
  EXPECT_NEAR(Range(world, {-30, 0, 0.5}, {1, 0, 0}), 35.0, 1.0e-12);
  EXPECT_NEAR(Range(world, {6, 0, 40}, {0, 0, -1}), 39.0, 1.0e-12);
}

// exp(-seen * way) of the rays pass, and those that do not end evenly along the way.
TEST(Cast, PassesLeavesAsOftenAsTheirDensitySays) {
  World world;
  world.AddBox({6.0, 0.0}, 0.0, 2.0, 2.0, 0.0, 1.0, {Label::kBush, Matter::kFoliage, 0.8});
  constexpr int kRays = 20'000;
  int passed = 0;
  int first_half = 0;
  for (uint64_t key = 0; key < kRays; ++key) {
    const Hit hit = CastFrom(world, {0, 0, 0.5}, {1, 0, 0}, 0.0, 50.0, Mixed(key));
    passed += hit.any() ? 0 : 1;
    if (!hit.any()) continue;
    EXPECT_GE(hit.range_m, 5.0);
    EXPECT_LE(hit.range_m, 7.0);
    first_half += hit.range_m < 6.0 ? 1 : 0;
  }
  EXPECT_NEAR(passed, kRays * std::exp(-1.6), 300.0);
  EXPECT_NEAR(first_half, kRays * (1.0 - std::exp(-0.8)), 300.0);
}

TEST(Cast, MeetsAPartOfTheMesh) {
  World world;
  world.AddBox({5.0, 0.0}, 0.0, 0.02, 4.0, 0.0, 1.3, kWireMesh);
  world.AddBox({8.0, 0.0}, 0.0, 0.2, 4.0, 0.0, 1.3, kStone);
  constexpr int kRays = 20'000;
  int on_mesh = 0;
  for (uint64_t key = 0; key < kRays; ++key) {
    const Hit hit = CastFrom(world, {0, 0, 0.5}, {1, 0, 0}, 0.0, 50.0, Mixed(key));
    const bool is_mesh = hit.label == Label::kFence;
    on_mesh += is_mesh ? 1 : 0;
    EXPECT_NEAR(hit.range_m, is_mesh ? 4.99 : 7.9, 1.0e-9) << "and what is behind it";
  }
  EXPECT_NEAR(on_mesh, kRays * kWireMesh.seen, 300.0);
}

TEST(Person, IsWhereTheTimeSays) {
  Person person;
  person.places = {{2.0, 0.0, 0.0}, {4.0, 2.0, 0.0}, {5.0, 2.0, 4.0}};
  EXPECT_EQ(person.At(-1.0).x_m, 0.0);
  EXPECT_NEAR(person.At(3.0).x_m, 1.0, 1.0e-12);
  EXPECT_NEAR(person.At(4.25).y_m, 1.0, 1.0e-12);
  EXPECT_EQ(person.At(1.0e6).y_m, 4.0);
  person.repeats = true;
  EXPECT_NEAR(person.At(6.0).x_m, 1.0, 1.0e-12);
  EXPECT_NEAR(person.At(2.0 + 300.0 + 1.0).x_m, 1.0, 1.0e-9);
  EXPECT_NEAR(person.At(0.0).x_m, 1.0, 1.0e-12) << "before the first, as it repeats";
}

TEST(Cast, SeesPeopleWhereTheyAreThen) {
  World world;
  Person person;
  person.places = {{0.0, 10.0, -2.0}, {4.0, 10.0, 2.0}};
  world.AddPerson(person);
  const auto range_m = [&world](double time_s) {
    return CastFrom(world, {0, 0, 1}, {1, 0, 0}, time_s).range_m;
  };
  EXPECT_LT(range_m(0.0), 0.0);
  EXPECT_NEAR(range_m(2.0), 9.75, 1.0e-9);
  EXPECT_NEAR(range_m(2.15), 10.0 - 0.2, 1.0e-9);  // 0.15 m off the middle of 0.25 m radius
  EXPECT_LT(range_m(3.0), 0.0);
  EXPECT_EQ(CastFrom(world, {0, 0, 1}, {1, 0, 0}, 2.0).label, Label::kPerson);
}

}  // namespace
}  // namespace hardpack::world
