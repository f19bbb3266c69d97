// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/named_worlds.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "tools/sim/world/back_out.h"
#include "tools/sim/world/blind.h"
#include "tools/sim/world/corner.h"
#include "tools/sim/world/features.h"
#include "tools/sim/world/height_net.h"
#include "tools/sim/world/low_world.h"
#include "tools/sim/world/slopes.h"
#include "tools/sim/world/thicket.h"
#include "tools/sim/world/tight_start.h"
#include "tools/sim/world/tilt.h"

namespace hardpack::world {
namespace {

// For worlds whose ground is not level.
constexpr Bounds kBounds = {-30.0, -50.0, 90.0, 50.0};

// Obstacles that cannot be driven around extend to here on both sides, beyond any map.
constexpr double kWallEnd_m = 70.0;

// Rough ground: the sum of two nets of random heights, each joined smoothly, up to amplitude_m
// either way; even where the vehicle starts.
class Roughness {
 public:
  Roughness(uint64_t seed, double amplitude_m)
      : key_(KeyOf(seed, Stream::kWorld)), amplitude_m_(amplitude_m) {}

  double At(double x_m, double y_m) const {
    const double height_m = 0.8 * HeightNet(key_, 1, x_m / 9.0, y_m / 9.0) +
                            0.2 * HeightNet(key_, 2, x_m / 2.3, y_m / 2.3);
    const double from_start_m = std::sqrt(x_m * x_m + y_m * y_m);
    return amplitude_m_ * height_m * std::clamp((from_start_m - 2.0) / 6.0, 0.0, 1.0);
  }

 private:
  uint64_t key_;
  double amplitude_m_;
};

bool IsNear(const Point2& a, const Point2& b, double distance_m) {
  const double x_m = a.x_m - b.x_m;
  const double y_m = a.y_m - b.y_m;
  return x_m * x_m + y_m * y_m < distance_m * distance_m;
}

void MakeOpen(uint64_t /*seed*/, Scenario& scenario) {
  scenario.description = "Level ground, nothing on it.";
  scenario.goal = {40.0, 0.0};
}

void MakeGap(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "The way leads through a gap of 2.2 m between a fence and a boat on its trailer.";
  scenario.world =
      World(kBounds, Terrain(kBounds, [rough = Roughness(seed, 0.08)](double x_m, double y_m) {
              return rough.At(x_m, y_m);
            }));
  scenario.goal = {42.0, 0.0};
  World& world = scenario.world;
  Draws draws(seed, 1);
  const Passage gap = GapOf(seed);
  const double side = gap.fence.y_m > gap.boat.y_m ? 1.0 : -1.0;  // of the fence
  AddFence(world, gap.fence, {gap.fence.x_m + draws.Uniform(-1.0, 1.0), side * kWallEnd_m});
  // The boat lies across the way, its stern at the gap; behind its bow the fence continues.
  const double middle_y_m = gap.boat.y_m - side * kBoatLength_m / 2.0;
  AddBoat(world, {gap.boat.x_m, middle_y_m}, -side * kPi / 2.0);
  AddFence(world, {gap.boat.x_m, gap.boat.y_m - side * (kBoatLength_m + 0.4)},
           {gap.boat.x_m + draws.Uniform(-1.0, 1.0), -side * kWallEnd_m});
  for (const double x_m : {9.0, 29.0, 34.0}) {
    AddTree(world, {x_m + draws.Uniform(-1.5, 1.5), draws.Uniform(7.0, 14.0)}, 0.2, 1.8);
    AddTree(world, {x_m + draws.Uniform(-1.5, 1.5), draws.Uniform(-14.0, -7.0)}, 0.25, 2.0);
    AddBush(world, {x_m + draws.Uniform(-3.0, 3.0), draws.UniformOnEitherSide(5.0, 9.0)}, 0.8, 1.0);
  }
}

void MakeRockPile(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "The goal lies behind a large rock pile: boulders, with growth all around them.";
  scenario.world =
      World(kBounds, Terrain(kBounds, [rough = Roughness(seed, 0.1)](double x_m, double y_m) {
              return rough.At(x_m, y_m);
            }));
  scenario.goal = {40.0, 0.0};
  Draws draws(seed, 1);
  const double core_m = draws.Uniform(3.6, 4.4);
  const Point2 middle = {20.0, draws.Uniform(-1.2, 1.2)};
  AddRockPile(scenario.world, middle, core_m, core_m + 2.0, draws.Uniform(1.9, 2.4), draws);
  scenario.around = {middle, core_m + 2.0, core_m};
  for (int i = 0; i < 6; ++i) {
    const double height_m = draws.Uniform(0.6, 1.2);
    const double radius_m = draws.Uniform(0.6, 1.2);
    const Point2 place = {draws.Uniform(8.0, 36.0), draws.UniformOnEitherSide(10.0, 18.0)};
    AddBush(scenario.world, place, radius_m, height_m);
  }
}

void MakeHill(uint64_t seed, Scenario& scenario) {
  scenario.description = "A large steep hill in otherwise empty ground.";
  Draws draws(seed, 1);
  const Point2 middle = {22.0, draws.Uniform(-1.5, 1.5)};
  const double height_m = draws.Uniform(4.6, 5.4);
  const double radius_m = draws.Uniform(9.0, 10.0);
  const Roughness rough(seed, 0.1);
  scenario.world = World(kBounds, Terrain(kBounds, [=](double x_m, double y_m) {
                           const double dx_m = x_m - middle.x_m;
                           const double dy_m = (y_m - middle.y_m) / 1.15;
                           const double square =
                               (dx_m * dx_m + dy_m * dy_m) / (radius_m * radius_m);
                           const double bump = square < 1.0 ? 1.0 - square : 0.0;
                           return rough.At(x_m, y_m) + height_m * bump * bump;
                         }));
  scenario.goal = {44.0, 0.0};
  scenario.around = {middle, radius_m};
}

void MakeForest(uint64_t seed, Scenario& scenario) {
  scenario.description = "Trees and bushes on rough ground; at least 3 m between two trunks.";
  scenario.world =
      World(kBounds, Terrain(kBounds, [rough = Roughness(seed, 0.35)](double x_m, double y_m) {
              return rough.At(x_m, y_m);
            }));
  scenario.goal = {50.0, 0.0};
  constexpr double kFreeEnd_m = 4.0;
  constexpr double kTrunksApart_m = 3.3;
  Draws draws(seed, 1);
  std::vector<Point2> trees;
  const auto is_free = [&](const Point2& place) {
    return !IsNear(place, {}, kFreeEnd_m) && !IsNear(place, scenario.goal, kFreeEnd_m);
  };
  constexpr int kTries = 420;
  for (int i = 0; i < kTries; ++i) {
    const Point2 place = {draws.Uniform(-25.0, 80.0), draws.Uniform(-42.0, 42.0)};
    const double trunk_m = draws.Uniform(0.10, 0.32);
    const double crown_m = draws.Uniform(1.2, 2.6);
    const bool alone = std::none_of(trees.begin(), trees.end(), [&](const Point2& tree) {
      return IsNear(place, tree, kTrunksApart_m);
    });
    if (!alone || !is_free(place)) continue;
    trees.push_back(place);
    AddTree(scenario.world, place, trunk_m, crown_m);
  }
  constexpr int kBushes = 110;
  for (int i = 0; i < kBushes; ++i) {
    const Point2 place = {draws.Uniform(-25.0, 80.0), draws.Uniform(-42.0, 42.0)};
    const double radius_m = draws.Uniform(0.4, 1.1);
    const double height_m = draws.Uniform(0.5, 1.4);
    if (is_free(place)) AddBush(scenario.world, place, radius_m, height_m);
  }
}

void MakeCorridor(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "Between two walls, with a pillar in the middle: left and right are the same.";
  scenario.goal = {40.0, 0.0};
  Draws draws(seed, 1);
  const double half_width_m = draws.Uniform(4.0, 4.6);
  const double pillar_m = draws.Uniform(16.0, 22.0);
  for (const double side : {-1.0, 1.0}) {
    AddBoxOnGround(scenario.world, {21.0, side * (half_width_m + 0.2)}, 0.0, 54.0, 0.4, 2.5, kWall);
  }
  constexpr double kPillar_m = 1.2;
  AddBoxOnGround(scenario.world, {pillar_m, 0.0}, 0.0, kPillar_m, kPillar_m, 2.0, kWall);
  scenario.around = {{pillar_m, 0.0}, kPillar_m / 2.0};
  scenario.corridor_half_width_m = half_width_m;
}

void MakeCrossing(uint64_t seed, Scenario& scenario) {
  scenario.description = "People cross the way, to and fro, at 0.7 to 2 m/s; trees beside it.";
  scenario.goal = {45.0, 0.0};
  Draws draws(seed, 1);
  constexpr int kPeople = 6;
  for (int i = 0; i < kPeople; ++i) {
    const double x_m = 10.0 + 5.5 * i + draws.Uniform(-2.0, 2.0);
    const double to_x_m = x_m + draws.Uniform(-3.0, 3.0);
    const double from_y_m = draws.UniformOnEitherSide(5.0, 9.0);
    const double to_y_m = -from_y_m * draws.Uniform(0.8, 1.2);
    const double way_x_m = to_x_m - x_m;
    const double way_y_m = to_y_m - from_y_m;
    const double walk_s =
        std::sqrt(way_x_m * way_x_m + way_y_m * way_y_m) / draws.Uniform(0.7, 2.0);
    const double begin_s = -draws.Uniform(0.0, 2.0 * walk_s);
    const double rest_s = draws.Uniform(0.5, 3.0);
    Person person;
    person.repeats = true;
    person.places = {{begin_s, x_m, from_y_m},
                     {begin_s + walk_s, to_x_m, to_y_m},
                     {begin_s + walk_s + rest_s, to_x_m, to_y_m},
                     {begin_s + 2.0 * walk_s + rest_s, x_m, from_y_m},
                     {begin_s + 2.0 * (walk_s + rest_s), x_m, from_y_m}};
    scenario.world.AddPerson(person);
  }
  for (int i = 0; i < 8; ++i) {
    AddTree(scenario.world, {draws.Uniform(-5.0, 45.0), draws.UniformOnEitherSide(11.0, 16.0)}, 0.2,
            1.6);
  }
}

void MakeDeadEnd(uint64_t seed, Scenario& scenario) {
  scenario.description =
      "Two yards with walls all around; a screen hides that there is no way out.";
  scenario.goal = {38.0, 0.0};
  Draws draws(seed, 1);
  const double half_width_m = draws.Uniform(4.5, 5.5);
  const double end_m = draws.Uniform(22.0, 25.0);
  const double begin_m = draws.Uniform(9.0, 11.0);
  const double middle_y_m = draws.Uniform(-1.0, 1.0);
  for (const double side : {-1.0, 1.0}) {
    AddBoxOnGround(scenario.world, {(begin_m + end_m) / 2.0, middle_y_m + side * half_width_m}, 0.0,
                   end_m - begin_m, 0.3, 2.0, kWall);
  }
  const auto add_across = [&](double x_m, double from_y_m, double to_y_m) {
    AddBoxOnGround(scenario.world, {x_m, (from_y_m + to_y_m) / 2.0}, kPi / 2.0, to_y_m - from_y_m,
                   0.3, 2.0, kWall);
  };
  add_across(end_m, middle_y_m - half_width_m - 0.15, middle_y_m + half_width_m + 0.15);
  const double screen_m = begin_m + 0.6 * (end_m - begin_m);
  add_across(screen_m, middle_y_m - 2.0, middle_y_m + 2.0);
  // The yard of the start.
  constexpr double kBack_m = -15.0;
  constexpr double kSide_m = 25.0;
  add_across(begin_m, -kSide_m, middle_y_m - half_width_m);
  add_across(begin_m, middle_y_m + half_width_m, kSide_m);
  add_across(kBack_m, -kSide_m, kSide_m);
  for (const double side : {-1.0, 1.0}) {
    AddBoxOnGround(scenario.world, {(kBack_m + begin_m) / 2.0, side * kSide_m}, 0.0,
                   begin_m - kBack_m + 0.3, 0.3, 2.0, kWall);
  }
}

void MakeDitch(uint64_t seed, Scenario& scenario) {
  scenario.description = "A ditch across the way; one end of it can be driven around.";
  scenario.goal = {36.0, 0.0};
  Draws draws(seed, 1);
  const double side = draws.Sign();
  const double x_m = draws.Uniform(16.0, 20.0);
  const Ditch ditch = {{x_m, side * draws.Uniform(7.0, 10.0)},
                       {x_m + draws.Uniform(-2.0, 2.0), -side * 60.0},
                       draws.Uniform(1.2, 1.6),
                       draws.Uniform(0.9, 1.2)};
  const Roughness rough(seed, 0.06);
  scenario.world =
      World(kBounds, Terrain(kBounds, [&](double place_x_m, double place_y_m) {
              return rough.At(place_x_m, place_y_m) - ditch.Depth_m(place_x_m, place_y_m);
            }));
  scenario.world.AddDitch(ditch);
}

struct Maker {
  const char* name;
  void (*make)(uint64_t seed, Scenario& scenario);
};
constexpr Maker kMakers[] = {
    {"gap", MakeGap},
    {"rock_pile", MakeRockPile},
    {"hill", MakeHill},
    {"forest", MakeForest},
    {"corridor", MakeCorridor},
    {"crossing", MakeCrossing},
    {"dead_end", MakeDeadEnd},
    {"ditch", MakeDitch},
    {"open", MakeOpen},
    {"thicket", MakeThicket},
    {"tight_start", MakeTightStart},
    {"low", MakeLow},
    {"low_bare", MakeLowBare},
    {"back_out", MakeBackOut},
    {"corner", MakeCorner},
    {"corner_ditch", MakeCornerDitch},
};

}  // namespace

Passage GapOf(uint64_t seed) {
  Draws draws(seed, 2);
  const double side = draws.Sign();
  const double x_m = draws.Uniform(19.0, 22.0);
  const double middle_y_m = draws.UniformOnEitherSide(1.0, 3.5);
  return {{x_m, middle_y_m + side * kGapWidth_m / 2.0},
          {x_m, middle_y_m - side * kGapWidth_m / 2.0}};
}

const std::vector<std::string>& WorldNames() {
  static const auto names = [] {
    std::vector<std::string> made;
    made.reserve(std::size(kMakers));
    for (const Maker& maker : kMakers) made.emplace_back(maker.name);
    return made;
  }();
  return names;
}

std::string_view BaseName(std::string_view name) {
  return name.substr(0, name.find(':'));
}

namespace {

// Without a tilt. False: there is no such world.
bool Make(std::string_view base, uint64_t seed, std::optional<double> angle_deg,
          Scenario& scenario) {
  for (const Maker& maker : kMakers) {
    if (base != maker.name) continue;
    scenario = Scenario{};
    scenario.name = maker.name;
    maker.make(seed, scenario);
    return true;
  }
  return MakeSlope(base, seed, angle_deg, scenario) || MakeBlind(base, seed, scenario);
}

bool IsSlope(std::string_view base) {
  const std::vector<std::string>& slopes = SlopeNames();
  return std::find(slopes.begin(), slopes.end(), base) != slopes.end();
}

// In a direction drawn by the seed.
void TiltBy(double angle_deg, uint64_t seed, Scenario& scenario) {
  Draws draws(seed, 4);
  const Turn tilt = TurnOf(angle_deg * kPi / 180.0);
  const Turn towards = TurnOf(draws.Uniform(-kPi, kPi));
  const double steep = tilt.sin / tilt.cos;
  GiveFriction(seed, scenario.world);
  Tilt(steep * towards.cos, steep * towards.sin, scenario);
}

ReadOutcome NoSuchWorld(std::string_view name) {
  std::string message = "there is no world '" + std::string(name) + "'; worlds: ";
  const char* between = "";
  for (const std::vector<std::string>& names : {WorldNames(), BlindNames(), SlopeNames()}) {
    for (const std::string& known : names) {
      message += between + known;
      between = ", ";
    }
  }
  return {Status::kInvalidArgument, message};
}

}  // namespace

ReadOutcome MakeScenario(std::string_view name, uint64_t seed, Scenario& scenario) {
  const std::string_view base = BaseName(name);
  const bool is_slope = IsSlope(base);
  std::optional<double> angle_deg;
  if (base.size() < name.size()) {
    const char* end = name.data() + name.size();
    double value_deg = -1.0;
    const auto read = std::from_chars(name.data() + base.size() + 1, end, value_deg);
    const double most_deg = is_slope ? kMaxSteepness_deg : kMaxTilt_deg;
    if (read.ec != std::errc() || read.ptr != end || !(value_deg >= 0.0 && value_deg <= most_deg)) {
      return {Status::kInvalidArgument, "world '" + std::string(name) +
                                            "': the angle after the colon is in degrees, 0 to " +
                                            std::to_string(static_cast<int>(most_deg))};
    }
    angle_deg = value_deg;
  }
  if (!Make(base, seed, angle_deg, scenario)) return NoSuchWorld(name);
  if (angle_deg && !is_slope) TiltBy(*angle_deg, seed, scenario);
  scenario.name = name;
  scenario.start = StandingPose(scenario.world, 0.0, 0.0, 0.0);
  return {};
}

}  // namespace hardpack::world
