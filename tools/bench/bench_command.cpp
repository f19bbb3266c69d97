// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_command.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "port_linux/command_line/command.h"
#include "port_linux/files/nearest_name.h"
#include "tools/allocation_counter/allocation_counter.h"
#include "tools/bench/bench_acceptance.h"
#include "tools/bench/bench_movingai.h"
#include "tools/bench/bench_peers.h"
#include "tools/bench/bench_recordings.h"
#include "tools/bench/bench_report.h"
#include "tools/bench/bench_scenes.h"
#include "tools/bench/bench_stages.h"
#include "tools/bench/quality/quality_command.h"

namespace hardpack::command {
namespace {

struct BenchOptions {
  std::vector<std::string> stages;
  std::vector<std::string> scenes;
  std::string data;
  bool json = false;
  bool markdown = false;
};

// option: what the user gave the name for. Does nothing when it is one of them.
void CheckName(const std::string& option, const std::string& what, const std::string& name,
               const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  const std::string nearest = NearestName(name, names);
  throw CommandFailure(kBadInput, option + ": there is no " + what + " '" + name + "'" +
                                      (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

// Those of this project, and of the recordings that are there. A folder that was named has some.
std::vector<SceneMaker> AllScenes(const BenchOptions& options, std::string& data) {
  std::vector<SceneMaker> scenes = BuiltInScenes();
  const char* const environment = std::getenv("HARDPACK_DATA");
  data = !options.data.empty() || environment == nullptr ? options.data : environment;
  const std::vector<SceneMaker> recorded = RecordedScenes(data);
  if (recorded.empty() && !options.data.empty()) {
    throw CommandFailure(kBadInput,
                         "--data: " + options.data + " has neither movingai/*.map nor rellis/");
  }
  if (recorded.empty()) data.clear();
  scenes.insert(scenes.end(), recorded.begin(), recorded.end());
  return scenes;
}

// Those named, or all.
std::vector<SceneMaker> ChosenScenes(const BenchOptions& options, std::string& data) {
  std::vector<SceneMaker> scenes = AllScenes(options, data);
  if (options.scenes.empty()) return scenes;
  std::vector<std::string> names;
  for (const SceneMaker& scene : scenes) names.push_back(scene.name);
  for (const std::string& name : options.scenes) CheckName("--scene", "scene", name, names);
  std::erase_if(scenes, [&options](const SceneMaker& scene) {
    const auto& chosen = options.scenes;
    return std::find(chosen.begin(), chosen.end(), scene.name) == chosen.end();
  });
  return scenes;
}

// A run takes minutes, so its progress is shown.
void ShowScene(const std::string& name) {
  if (isatty(STDERR_FILENO) == 1) std::cerr << "\r\033[Kmeasuring on " << name << std::flush;
}

void ClearShown() {
  if (isatty(STDERR_FILENO) == 1) std::cerr << "\r\033[K" << std::flush;
}

void RunBench(const BenchOptions& options) {
  if (options.json && options.markdown) {
    throw CommandFailure(kBadInput, "give only one of --json and --markdown");
  }
  for (const std::string& stage : options.stages) {
    CheckName("STAGE", "stage", stage, BenchStageNames());
  }
  BenchReport report;
  const std::vector<SceneMaker> scenes = ChosenScenes(options, report.data);
  report.peers = PeerNames();
  report.rows =
      MeasureStages(options.stages.empty() ? BenchStageNames() : options.stages, scenes, ShowScene);
  ClearShown();
  report.acceptance = JudgeRows(report.rows, AllocationsAreCounted());
  if (options.json) {
    std::cout << ReportToJson(report).dump() << "\n";
  } else if (options.markdown) {
    PrintMarkdown(report);
  } else {
    PrintReport(report);
  }
  for (const BenchRow& row : report.rows) {
    if (row.allocations == 0) continue;
    throw CommandFailure(kWorkFailed, row.stage + " on " + row.scene + " allocated memory");
  }
}

std::string Joined(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) joined += (joined.empty() ? "" : ", ") + name;
  return joined;
}

std::string SceneHelp() {
  std::vector<std::string> names;
  for (const SceneMaker& scene : BuiltInScenes()) names.push_back(scene.name);
  return "Only this scene; may be repeated: " + Joined(names) +
         "; with recordings also the names of the movingai maps, and " + kRellisScene;
}

}  // namespace

void AddBenchCommand(CLI::App& app) {
  CLI::App* bench = app.add_subcommand(
      "bench",
      "Measure each stage, and a full replanning cycle, on built-in maps and recordings: median,\n"
      "p99 and worst processor time, size of the stage's object, and heap allocations during the\n"
      "measured calls (exit code 1 if there are any). OpenCV, Boost.Graph and Ceres, where this\n"
      "build has them, run alternately with it on the same input. Then print each promised\n"
      "figure beside the measured one. The whole takes about two minutes.");
  const auto options = std::make_shared<BenchOptions>();
  bench->add_option("STAGE", options->stages, Joined(BenchStageNames()) + "; default: all");
  bench->add_option("--scene", options->scenes, SceneHelp())->allow_extra_args(false);
  bench->add_option("--data", options->data,
                    "Folder of recordings, with movingai/*.map and rellis/ (default: environment "
                    "variable HARDPACK_DATA)");
  bench->add_flag("--json", options->json, "Print one JSON object on stdout");
  bench->add_flag("--markdown", options->markdown, "Print two tables: stages and promises");
  AddMovingaiCommand(*bench);
  AddQualityCommand(*bench);
  bench->callback([options, bench] {
    if (bench->get_subcommands().empty()) RunBench(*options);
  });
}

}  // namespace hardpack::command
