// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"
#include "nlohmann/json.hpp"
#include "tools/sim/mission/wire_mission.h"

// `hardpack sim --wire`: the options of the coupling over real sockets, and what it reports.

namespace hardpack::command {

struct WireOptions {
  bool on = false;
  mission::WireMissionSettings settings;  // but for `mission`
};

void AddWireOptions(CLI::App& sim, WireOptions& options);

// Throws a CommandFailure where an option is about hardpackd, which nobody tells of it.
void RequireFitting(const CLI::App& sim, const WireOptions& options);

// The same mission over the wire; SIGINT and SIGTERM end it, with the vehicle at rest. Throws a
// CommandFailure where hardpackd does not get as far as to drive.
void RunOverWire(const WireOptions& options, const mission::MissionSettings& mission,
                 experiment::RunResult& result, mission::MissionTrace& trace,
                 mission::WireReport& report);

// "wire" of run.json.
nlohmann::ordered_json ToJson(const mission::WireReport& report, int lidar_columns);

// Throws a CommandFailure where the simulation was too late to be what it stands for.
void RequireRealTime(const mission::WireReport& report);

}  // namespace hardpack::command
