// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/bench/bench_scenes.h"

// Scenes of recordings that are not part of the project, in the folder HARDPACK_DATA or --data.

namespace hardpack::command {

// Of a folder with movingai/NAME.map beside movingai/NAME.map.scen, each a scene NAME whose queries
// are the longest problems of the file; and rellis/ with the labelled scan of the paper's vehicle,
// the scene "rellis", with goals at 25 m all around. Only those that exist; an empty name means no
// folder. Making one throws a CommandFailure (bad input) if a file cannot be read.
std::vector<SceneMaker> RecordedScenes(const std::string& folder);

inline constexpr const char* kRellisScene = "rellis";

}  // namespace hardpack::command
