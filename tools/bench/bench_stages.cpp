// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_stages.h"

#include <algorithm>

#include "tools/bench/bench_chain.h"
#include "tools/bench/bench_peers.h"
#include "tools/bench/bench_revolution.h"
#include "tools/bench/bench_timing.h"

namespace hardpack::command {
namespace {

bool Wanted(const std::vector<std::string>& stages, const std::string& name) {
  return std::find(stages.begin(), stages.end(), name) != stages.end();
}

std::vector<PeerRun*> Pointers(const PeerRuns& peers) {
  std::vector<PeerRun*> pointers;
  for (const auto& peer : peers) pointers.push_back(peer.get());
  return pointers;
}

// The most severe status of a stage; statuses are numbered by severity.
void Worsen(Status status, Status& gravest) {
  if (gravest < status) gravest = status;
}

// The stages of one scene, each into the row that it is given.
class SceneBench {
 public:
  explicit SceneBench(const BenchScene& scene) : name_(scene.name), chain_(scene) {}

  const StageChain& chain() const { return chain_; }

  void Costmap(BenchRow& row) {
    row.object_bytes = sizeof(CostmapBuilder);
    const PeerRuns peers = DistancePeers(chain_);
    MeasureRow(
        {.run = [&] { Worsen(chain_.BuildCostmap(), row.status); }, .peers = Pointers(peers)}, row);
  }

  void Astar(BenchRow& row) {
    row.object_bytes = sizeof(AstarSearch);
    const PeerRuns peers = SearchPeers(chain_, name_);
    const auto& queries = chain_.queries();
    std::vector<double> expansions(queries.size());
    size_t next = 0;
    const std::vector<double> medians_us =
        MeasureRow({.run =
                        [&] {
                          const size_t query = next++ % queries.size();
                          Worsen(chain_.Search(queries[query]), row.status);
                          expansions[query] = chain_.search_result().expansions;
                        },
                    .inputs = static_cast<int>(queries.size()),
                    .peers = Pointers(peers)},
                   row);
    double total_us = 0.0;
    double total = 0.0;
    for (size_t query = 0; query < queries.size(); ++query) {
      total_us += medians_us[query];
      total += expansions[query];
    }
    row.queries = static_cast<int>(queries.size());
    row.expansions = total / static_cast<double>(queries.size());
    row.ns_per_expansion = total_us * 1000.0 / total;
  }

  void Sample(BenchRow& row) {
    row.object_bytes = sizeof(PathSampler);
    static_cast<void>(chain_.Search(chain_.path_query()));
    MeasureRow({.run = [&] { Worsen(chain_.Sample(), row.status); }}, row);
  }

  void Optimize(BenchRow& row) {
    const PeerRuns peers = OptimizerPeers(chain_);
    OptimizeWith(chain_.params().optimizer, peers, row);
  }

  void Paper(BenchRow& row) {
    OptimizerParams params = chain_.params().optimizer;
    params.method = OptimizerParams::kPaperDescent;
    OptimizeWith(params, {}, row);
  }

  void Speed(BenchRow& row) {
    row.object_bytes = sizeof(SpeedProfile);
    row.points = chain_.path().size();
    MeasureRow({.run = [&] { Worsen(chain_.Speed(), row.status); }, .runs_at_once = 16}, row);
  }

  void Check(BenchRow& row) {
    row.object_bytes = sizeof(PathCheck);
    row.points = chain_.path().size();
    MeasureRow({.run = [&] { Worsen(chain_.Check(), row.status); }}, row);
  }

  void Replan(BenchRow& row) {
    row.object_bytes = sizeof(Planner);
    const auto& queries = chain_.replan_queries();
    row.queries = static_cast<int>(queries.size());
    size_t next = 0;
    MeasureRow({.run = [&] { Worsen(chain_.Replan(queries[next++ % queries.size()]), row.status); },
                .inputs = row.queries},
               row);
  }

 private:
  void OptimizeWith(const OptimizerParams& params, const PeerRuns& peers, BenchRow& row) {
    row.object_bytes = sizeof(Optimizer);
    row.points = chain_.seed().size();
    MeasureRow(
        {.run = [&] { Worsen(chain_.Optimize(params), row.status); }, .peers = Pointers(peers)},
        row);
    row.path_cost = double{chain_.optimizer_result().after.total()};
  }

  std::string name_;
  StageChain chain_;
};

struct SceneStage {
  const char* name;
  void (SceneBench::*measure)(BenchRow&);
  bool needs_path;
};

constexpr SceneStage kSceneStages[] = {
    {"costmap", &SceneBench::Costmap, false}, {"astar", &SceneBench::Astar, true},
    {"sample", &SceneBench::Sample, true},    {"optimizer", &SceneBench::Optimize, true},
    {"paper", &SceneBench::Paper, true},      {"speed", &SceneBench::Speed, true},
    {"check", &SceneBench::Check, true},      {"replan", &SceneBench::Replan, false}};

void MeasureScene(const SceneMaker& maker, const std::vector<std::string>& stages,
                  std::vector<BenchRow>& rows) {
  SceneBench bench(maker.make());
  for (const SceneStage& stage : kSceneStages) {
    if (!Wanted(stages, stage.name)) continue;
    if (stage.needs_path && !bench.chain().has_path()) continue;
    BenchRow row;
    row.stage = stage.name;
    row.scene = maker.name;
    row.dilated = bench.chain().dilated();
    (bench.*stage.measure)(row);
    rows.push_back(row);
  }
}

struct RevolutionStage {
  const char* name;
  BenchRow (RevolutionBench::*run)();
};

constexpr RevolutionStage kRevolutionStages[] = {{"decode", &RevolutionBench::Decode},
                                                 {"column", &RevolutionBench::ColumnByGeometry},
                                                 {"column", &RevolutionBench::ColumnWithLabels},
                                                 {"costmap", &RevolutionBench::Costmap}};

void MeasureRevolution(const std::vector<std::string>& stages, std::vector<BenchRow>& rows) {
  RevolutionBench bench;
  for (const RevolutionStage& stage : kRevolutionStages) {
    if (Wanted(stages, stage.name)) rows.push_back((bench.*stage.run)());
  }
}

}  // namespace

const std::vector<std::string>& BenchStageNames() {
  static const std::vector<std::string> names = {"decode", "column",    "costmap", "astar",
                                                 "sample", "optimizer", "paper",   "speed",
                                                 "check",  "replan"};
  return names;
}

std::vector<BenchRow> MeasureStages(const std::vector<std::string>& stages,
                                    const std::vector<SceneMaker>& scenes,
                                    const std::function<void(const std::string&)>& begin_scene) {
  std::vector<BenchRow> rows;
  const auto any_of = [&stages](const auto& table) {
    return std::any_of(std::begin(table), std::end(table),
                       [&stages](const auto& stage) { return Wanted(stages, stage.name); });
  };
  if (any_of(kRevolutionStages)) {
    begin_scene(kRevolutionScene);
    MeasureRevolution(stages, rows);
  }
  for (const SceneMaker& scene : scenes) {
    if (!any_of(kSceneStages)) break;
    begin_scene(scene.name);
    MeasureScene(scene, stages, rows);
  }
  std::stable_sort(rows.begin(), rows.end(), [](const BenchRow& a, const BenchRow& b) {
    const auto& names = BenchStageNames();
    return std::find(names.begin(), names.end(), a.stage) <
           std::find(names.begin(), names.end(), b.stage);
  });
  return rows;
}

}  // namespace hardpack::command
