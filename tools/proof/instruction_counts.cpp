// SPDX-License-Identifier: Apache-2.0
// Runs each stage of planning once, in a function of its own that callgrind collects for:
// tools/proof/check_instructions.py runs it so and reads the counts. Prints the compiler, the
// processor, and then the stage and the scene of each run, in the order of the runs.

#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "core/costmap/costmap.h"
#include "tools/bench/bench_chain.h"
#include "tools/bench/bench_scenes.h"

// Callgrind is told this name. The empty statement keeps the call from becoming a jump, which would
// leave the function too early.
extern "C" [[gnu::noinline]] void CountedRun(const std::function<void()>& run) {
  run();
  asm volatile("" ::: "memory");
}

namespace {

using hardpack::command::SceneMaker;
using hardpack::command::StageChain;

// The first run is not counted: the search clears its nodes in the first of many queries only.
void Count(const char* stage, const std::string& scene, const std::function<void()>& run) {
  run();
  CountedRun(run);
  std::printf("%s %s\n", stage, scene.c_str());
}

void CountStages(const SceneMaker& maker) {
  StageChain chain(maker.make());
  const auto& query = chain.path_query();
  hardpack::OptimizerParams paper = chain.params().optimizer;
  paper.method = hardpack::OptimizerParams::kPaperDescent;
  const auto count = [&maker](const char* stage, const std::function<void()>& run) {
    Count(stage, maker.name, run);
  };
  count("costmap", [&] { static_cast<void>(chain.BuildCostmap()); });
  count("astar", [&] { static_cast<void>(chain.Search(query)); });
  count("sample", [&] { static_cast<void>(chain.Sample()); });
  count("optimizer", [&] { static_cast<void>(chain.Optimize(chain.params().optimizer)); });
  count("paper", [&] { static_cast<void>(chain.Optimize(paper)); });
  count("speed", [&] { static_cast<void>(chain.Speed()); });
  count("check", [&] { static_cast<void>(chain.Check()); });
  count("replan", [&] { static_cast<void>(chain.Replan(query)); });
}

// One ground return in each cell, of hills 20 to 30 m long with a grade of up to 0.32.
std::unique_ptr<hardpack::HeightGrid> RollingHeights() {
  auto heights = std::make_unique<hardpack::HeightGrid>();
  const hardpack::GridWindow window = heights->window();
  for (int index = 0; index < hardpack::kMapCells; ++index) {
    const hardpack::Vec2 place = hardpack::CellCenter(window.FromIndex(index));
    const float height_m = std::sin(0.3f * place.x_m) + 0.5f * std::sin(0.2f * place.y_m);
    static_cast<void>(
        heights->Insert({place.x_m, place.y_m, height_m}, hardpack::ReturnClass::kGround));
  }
  return heights;
}

// A map from heights, with the terrain layer and without.
void CountHeights() {
  const auto heights = RollingHeights();
  const auto builder = std::make_unique<hardpack::CostmapBuilder>();
  hardpack::CostmapParams params;
  const auto build = [&] {
    static_cast<void>(builder->Begin(*heights, params));
    static_cast<void>(builder->Step(*heights, hardpack::CostmapBuilder::kUnits));
  };
  Count("heights", "rolling", build);
  params.max_grade = 0.0f;
  Count("heights", "rolling_without_terrain", build);
}

}  // namespace

int main() {
  std::printf("compiler %s\nprocessor %s\n", HARDPACK_COMPILER, HARDPACK_PROCESSOR);
  try {
    for (const SceneMaker& maker : hardpack::command::BuiltInScenes()) {
      if (maker.name == "random_40" || maker.name == "forest" || maker.name == "maze") {
        CountStages(maker);
      }
    }
    CountHeights();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "instruction_counts: %s\n", error.what());
    return 1;
  }
  return 0;
}
