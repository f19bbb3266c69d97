// SPDX-License-Identifier: Apache-2.0
// Drives the mission of `hardpack sim --world WORLD --seed SEED --no-log --json`, and prints what
// that prints: what a cross build has the libraries for. Arguments: world, seed, and the vehicle's
// file. Exit status 2: it could not be driven.
#include <cstdio>
#include <cstdlib>

#include "tools/sim/mission/mission.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

int main(int argc, char** argv) {
  using namespace hardpack;
  if (argc != 4) return 2;
  mission::MissionSettings settings;
  settings.seed = std::strtoull(argv[2], nullptr, 10);
  ReadOutcome outcome = world::MakeScenario(argv[1], settings.seed, settings.scenario);
  if (outcome.ok()) outcome = sim::ReadBody(argv[3], settings.vehicle);
  experiment::RunResult result;
  mission::MissionTrace trace;
  if (outcome.ok()) outcome = mission::RunMission(settings, result, &trace);
  if (!outcome.ok()) {
    std::fprintf(stderr, "%s\n", outcome.message.c_str());
    return 2;
  }
  std::printf("%s\n", ToJson(result).dump().c_str());
  return 0;
}
