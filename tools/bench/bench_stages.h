// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/bench/bench_row.h"
#include "tools/bench/bench_scenes.h"

// Measures the stages one by one, and a whole replanning, on each scene; and beside each stage the
// other libraries that do the same.

namespace hardpack::command {

// The names that MeasureStages knows, in the order of the data's walk. "optimizer" is the method of
// the parameters' defaults, "paper" the paper's own; "replan" is everything from heights to a
// checked plan with its speeds.
const std::vector<std::string>& BenchStageNames();

// What the stages before planning are measured on.
inline constexpr const char* kRevolutionScene = "revolution";

// Every scene for each of the stages named; decode, column and once more costmap besides on one
// recorded revolution. A stage that has no input on a scene, because there is no path, is left out.
// Rows in the order of the stages. begin_scene is told the name of each scene before it is made.
std::vector<BenchRow> MeasureStages(const std::vector<std::string>& stages,
                                    const std::vector<SceneMaker>& scenes,
                                    const std::function<void(const std::string&)>& begin_scene);

}  // namespace hardpack::command
