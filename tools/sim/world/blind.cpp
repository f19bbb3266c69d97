// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/world/blind.h"

#include <array>
#include <cstdio>

#include "tools/sim/world/features.h"

namespace hardpack::world {
namespace {

struct Fault {
  const char* name;
  const char* event;  // of the script: two angles, or a sign, are put into it
  bool has_sector;
};
constexpr std::array<Fault, 7> kFaults = {{{"blind", "", false},
                                           {"blind_lost", "lidar-blind %.1f %.1f lost", true},
                                           {"blind_invalid", "lidar-blind %.1f %.1f invalid", true},
                                           {"blind_dark", "lidar-blind %.1f %.1f dark", true},
                                           {"blind_covered", "lidar-blind %.1f %.1f covered", true},
                                           {"blind_frozen", "lidar-frozen on", false},
                                           {"blind_turned", "lidar-turned 0 %.1f %.1f", false}}};

template <typename... Values>
std::string Text(const char* format, Values... values) {
  char text[96];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

// Ground that is not even, trees and bushes beside the way: something to be seen on both sides.
void MakeGround(uint64_t seed, Scenario& scenario) {
  Draws draws(seed, 11);
  for (int i = 0; i < 12; ++i) {
    const double x_m = 6.0 * i + draws.Uniform(-2.0, 2.0);
    AddTree(scenario.world, {x_m, draws.UniformOnEitherSide(8.0, 14.0)}, 0.2, 1.6);
    const Point2 bush = {x_m + draws.Uniform(-3.0, 3.0), draws.UniformOnEitherSide(6.5, 11.0)};
    AddBush(scenario.world, bush, draws.Uniform(0.5, 1.0), draws.Uniform(0.6, 1.2));
  }
  scenario.goal = {70.0, 0.0};
}

}  // namespace

std::vector<std::string> BlindNames() {
  std::vector<std::string> names;
  for (const Fault& fault : kFaults) names.emplace_back(fault.name);
  return names;
}

bool MakeBlind(std::string_view name, uint64_t seed, Scenario& scenario) {
  for (const Fault& fault : kFaults) {
    if (name != fault.name) continue;
    scenario = Scenario{};
    scenario.name = fault.name;
    scenario.description = "The lidar goes blind at speed, and a box appears ahead.";
    MakeGround(seed, scenario);
    Draws draws(seed, 12);
    const double at_s = draws.Uniform(3.0, 5.0);
    const double appears_s = at_s + draws.Uniform(0.2, 0.6);
    const double ahead_m = draws.Uniform(20.0, 23.0);
    const double left_m = draws.Uniform(-0.6, 0.6);
    const double size_m = draws.Uniform(0.8, 2.0);
    const double height_m = draws.Uniform(0.9, 1.8);
    const double from_deg = -draws.Uniform(25.0, 60.0);
    const double to_deg = draws.Uniform(25.0, 60.0);
    const double pitch_deg = draws.UniformOnEitherSide(5.0, 12.0);
    const double roll_deg = draws.UniformOnEitherSide(0.0, 6.0);
    if (fault.event[0] != '\0') {
      const double first = fault.has_sector ? from_deg : pitch_deg;
      const double second = fault.has_sector ? to_deg : roll_deg;
      scenario.script = Text("at %.2f ", at_s) + Text(fault.event, first, second) + "\n";
    }
    scenario.script += Text("at %.2f box-ahead %.2f %.2f %.2f %.2f\n", appears_s, ahead_m, left_m,
                            size_m, height_m);
    return true;
  }
  return false;
}

}  // namespace hardpack::world
