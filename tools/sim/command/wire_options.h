// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"
#include "nlohmann/json.hpp"
#include "tools/sim/mission/wire_mission.h"

// `hardpack sim --wire`: the options of the coupling over real sockets, and what it reports.

namespace hardpack::command {

struct WireOptions {
  bool on = false;
  mission::WireMissionSettings settings;  // except `mission`
};

void AddWireOptions(CLI::App& sim, WireOptions& options);

// Throws a CommandFailure if an option concerns hardpackd, which does not receive it.
void RequireFitting(const CLI::App& sim, const WireOptions& options);

// The same mission over the wire; SIGINT and SIGTERM end it, with the vehicle at rest. Throws a
// CommandFailure if hardpackd does not get as far as driving.
void RunOverWire(const WireOptions& options, const mission::MissionSettings& mission,
                 experiment::RunResult& result, mission::MissionTrace& trace,
                 mission::WireReport& report);

// The "wire" object of run.json.
nlohmann::ordered_json ToJson(const mission::WireReport& report, int lidar_columns);

// Throws a CommandFailure if the simulation was too late to be valid.
void RequireRealTime(const mission::WireReport& report);

}  // namespace hardpack::command
