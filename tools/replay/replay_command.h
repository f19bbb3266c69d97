// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CLI/CLI.hpp"

namespace hardpack::command {

// `hardpack replay`: replays a recorded drive; replay.json, replay.png (docs/flight_log.md).
void AddReplayCommand(CLI::App& app);

}  // namespace hardpack::command
