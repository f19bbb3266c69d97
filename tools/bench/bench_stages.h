// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/bench/bench_row.h"
#include "tools/bench/bench_scenes.h"

// Measures each stage, and a complete replanning, on each scene, together with other libraries that
// do the same.

namespace hardpack::command {

// The names that MeasureStages knows, in the order of the data flow. "optimizer" is the default
// method, "paper" the paper's own; "replan" is everything from heights to a checked plan with its
// speeds.
const std::vector<std::string>& BenchStageNames();

// The input of the stages before planning.
inline constexpr const char* kRevolutionScene = "revolution";

// Measures each named stage on every scene; decode, column and costmap also on one recorded
// revolution. A stage without input on a scene, because there is no path, is left out. Rows are in
// the order of the stages. begin_scene gets the name of each scene before the scene is made.
std::vector<BenchRow> MeasureStages(const std::vector<std::string>& stages,
                                    const std::vector<SceneMaker>& scenes,
                                    const std::function<void(const std::string&)>& begin_scene);

}  // namespace hardpack::command
