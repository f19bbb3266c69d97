// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_recordings.h"

#include <algorithm>
#include <filesystem>
#include <variant>

#include "core/base/grid.h"
#include "core/base/math.h"
#include "core/costmap/costmap.h"
#include "port_linux/command_line/command.h"
#include "tools/bench/movingai/movingai.h"
#include "tools/capture/scan_loader.h"

namespace hardpack::command {
namespace {

namespace fs = std::filesystem;

template <typename T>
T OrThrow(MovingaiOr<T> outcome) {
  if (const auto* reason = std::get_if<std::string>(&outcome)) {
    throw CommandFailure(kBadInput, *reason);
  }
  return std::get<T>(std::move(outcome));
}

// The map's first cell lies in the window's first; cells beyond the map are hard.
std::vector<uint8_t> FlagsOf(const MovingaiMap& map) {
  std::vector<uint8_t> flags(static_cast<size_t>(kMapCells), Costmap::kHard | Costmap::kObserved);
  size_t read = 0;
  for (int y = 0; y < map.height_cells; ++y) {
    for (int x = 0; x < map.width_cells; ++x) {
      if (!map.free[read++]) continue;
      flags[static_cast<size_t>(y * kMapSize_cells + x)] = Costmap::kObserved;
    }
  }
  return flags;
}

// The longest problems are similar, so only some of them are taken.
std::vector<BenchQuery> LongestOf(std::vector<MovingaiProblem> problems) {
  constexpr size_t kStride = 7;
  constexpr size_t kMost = 400;  // on a dilated map few of them have a path
  std::stable_sort(problems.begin(), problems.end(),
                   [](const MovingaiProblem& a, const MovingaiProblem& b) {
                     return a.optimum_cells > b.optimum_cells;
                   });
  const Cell origin = GridWindow::CenteredAt({}).origin;
  const auto place = [&origin](Cell cell) {
    return CellCenter({origin.x + cell.x, origin.y + cell.y});
  };
  std::vector<BenchQuery> queries;
  for (size_t i = 0; i < problems.size() && queries.size() < kMost; i += kStride) {
    queries.push_back({.start_m = place(problems[i].start), .goal_m = place(problems[i].goal)});
  }
  return queries;
}

BenchScene MakeMovingai(const std::string& name, const std::string& map_path) {
  const auto map = OrThrow(ReadMovingaiMap(map_path));
  const auto problems = OrThrow(ReadMovingaiScenarios(map_path + ".scen"));
  return {.name = name, .flags = FlagsOf(map), .queries = LongestOf(problems)};
}

struct RellisFiles {
  explicit RellisFiles(const fs::path& folder)
      : capture(folder / "rellis_000104_os1-64_2048x10_legacy_reencoded.pcap"),
        metadata(fs::path(capture).replace_extension(".json")),
        labels(folder / "rellis_000104_labelled.csv") {}
  bool Exist() const { return fs::exists(capture) && fs::exists(metadata) && fs::exists(labels); }

  fs::path capture;
  fs::path metadata;
  fs::path labels;
};

BenchScene MakeRellis(const RellisFiles& files) {
  constexpr float kGoal_m = 25.0f;
  constexpr int kDirections = 24;
  BenchScene scene = {.name = kRellisScene};
  const auto mapper = std::make_shared<Mapper>();
  capture::LidarScanReport report;
  PerceptionParams perception;
  perception.mount.self_min_x_m = -2.7f;  // what the recorded vehicle carries reaches so far back
  Require(capture::LoadLidarScan({.capture_path = files.capture.string(),
                                  .metadata_path = files.metadata.string(),
                                  .labels_path = files.labels.string(),
                                  .perception = perception,
                                  .costmap = {},
                                  .pose = {}},
                                 *mapper, report));
  scene.mapper = mapper;
  for (int direction = 0; direction < kDirections; ++direction) {
    const float angle_rad = WrapAngle(2.0f * kPi * static_cast<float>(direction) / kDirections);
    const SinCosPair way = SinCos(angle_rad);
    scene.queries.push_back({.start_m = {}, .goal_m = {kGoal_m * way.cos, kGoal_m * way.sin}});
  }
  return scene;
}

}  // namespace

std::vector<SceneMaker> RecordedScenes(const std::string& folder) {
  std::vector<SceneMaker> scenes;
  if (folder.empty()) return scenes;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "movingai", error)) {
    const std::string map = entry.path().string();
    if (entry.path().extension() != ".map" || !fs::exists(map + ".scen")) continue;
    const std::string name = entry.path().stem().string();
    scenes.push_back({name, [name, map] { return MakeMovingai(name, map); }});
  }
  std::sort(scenes.begin(), scenes.end(),
            [](const SceneMaker& a, const SceneMaker& b) { return a.name < b.name; });
  const RellisFiles rellis(fs::path(folder) / "rellis");
  if (rellis.Exist()) scenes.push_back({kRellisScene, [rellis] { return MakeRellis(rellis); }});
  return scenes;
}

}  // namespace hardpack::command
