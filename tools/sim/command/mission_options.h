// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "CLI/CLI.hpp"
#include "tools/sim/command/scenario_argument.h"
#include "tools/sim/command/world_picture.h"
#include "tools/sim/mission/mission.h"

// Mission options of `hardpack sim` and `hardpack experiment`.

namespace hardpack::command {

struct MissionOptions {
  std::string vehicle = "warthog_paper";
  std::string configuration;
  std::string labels = "none";
  std::string script;          // path; empty: nothing goes wrong
  std::string waypoints;       // path; empty: to the world's goal
  std::string areas;           // path; empty: none
  double max_speed_mps = 0.0;  // 0: the configuration's
  ScenarioOptions scenario;
  mission::MissionSettings mission;
};

// `options` outlives the command.
void AddMissionOptions(CLI::App& command, MissionOptions& options);

// Reads the files; sets everything but world and seed. Throws a CommandFailure (bad input).
mission::MissionSettings SettingsOf(const MissionOptions& options);

// The waypoints of the options' file, if they name one; the scenario's goal then is the last of
// them. Throws a CommandFailure (bad input).
void SetWaypoints(const MissionOptions& options, mission::MissionSettings& settings);

// What a picture shows of a mission.
DrivenWay DrivenOf(const mission::MissionSettings& settings, const mission::MissionTrace& trace);

}  // namespace hardpack::command
