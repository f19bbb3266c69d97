// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/bench_stages.h"

#include <algorithm>
#include <memory>

#include "core/autonomy/planner.h"
#include "tools/hardpack/bench_revolution.h"
#include "tools/hardpack/bench_scenes.h"
#include "tools/hardpack/bench_timing.h"

namespace hardpack::command {
namespace {

constexpr int kAllUnits = 1'000'000;

template <typename StepAll>
void ToEnd(StepAll&& step_all) {
  while (step_all() == Progress::kBusy) {
  }
}

// One scene with the objects of every stage, each with its input from the one before.
class StageChain {
 public:
  explicit StageChain(const BenchScene& scene)
      : scene_(scene), window_(GridWindow::CenteredAt({})) {}

  // Fills in the row, runs the stage to its end, and returns how it ended.
  Status Costmap(BenchRow& row) {
    row.object_bytes = sizeof(CostmapBuilder);
    MeasureRow(
        [this] {
          begun_ = builder_->BeginCells(window_, params_.costmap);
          FillCells(*builder_);
        },
        [this] { ToEnd([this] { return builder_->StepCells(kAllUnits); }); }, row);
    return begun_;
  }

  Status Astar(BenchRow& row) {
    row.object_bytes = sizeof(AstarSearch);
    MeasureRow([] {},
               [this] {
                 begun_ = search_->Begin(map(), params_.astar, scene_.start_m, scene_.goal_m);
                 ToEnd([this] { return search_->Step(map(), kAllUnits); });
               },
               row);
    return search_->result().status;
  }

  Status Sample(BenchRow& row) {
    row.object_bytes = sizeof(PathSampler);
    MeasureRow([] {},
               [this] {
                 begun_ = sampler_->Begin(*search_, params_.path, scene_.start_m, scene_.goal_m);
                 ToEnd([this] { return sampler_->Step(*search_, kAllUnits); });
               },
               row);
    return sampler_->status();
  }

  Status Optimize(BenchRow& row) {
    row.object_bytes = sizeof(Optimizer);
    MeasureRow([] {},
               [this] {
                 begun_ = optimizer_->Begin(map(), params_.optimizer, params_.path,
                                            sampler_->result(), 0.0f, false);
                 ToEnd([this] { return optimizer_->Step(map(), kAllUnits); });
               },
               row);
    return optimizer_->result().status;
  }

  Status Speed(BenchRow& row) {
    row.object_bytes = sizeof(SpeedProfile);
    const Status converted = ToActuator<PlanarModel>(optimizer_->path(), *actuator_);
    if (!IsUsable(converted)) return converted;
    MeasureRow([] {},
               [this] {
                 begun_ =
                     PlanSpeed(params_.speed, params_.vehicle, *actuator_, SpeedRequest{}, *speed_);
               },
               row);
    return begun_;
  }

  Status Check(BenchRow& row) {
    row.object_bytes = sizeof(PathCheck);
    MeasureRow([] {},
               [this] {
                 begun_ =
                     check_->Begin(params_.vehicle, params_.optimizer, optimizer_->path(), 0.0f);
                 ToEnd([this] { return check_->Step(map(), optimizer_->path(), kAllUnits); });
               },
               row);
    return check_->result().status;
  }

  // All of it by the planner, from cells to the checked plan.
  Status Plan(BenchRow& row) {
    row.object_bytes = sizeof(Planner);
    PlanRequest request;
    request.start.pose = {scene_.start_m.x_m, scene_.start_m.y_m, kPi / 4.0f};
    request.goal_odom = scene_.goal_m;
    MeasureRow(
        [this, &request] {
          begun_ = planner_->BeginCells(window_, params_, request);
          FillCells(planner_->costmap_builder());
        },
        [this] { ToEnd([this] { return planner_->StepCells(kAllUnits); }); }, row);
    return planner_->result().status;
  }

 private:
  void FillCells(CostmapBuilder& builder) const {
    for (int i = 0; i < kMapCells; ++i) builder.SetCell(i, scene_.flags[static_cast<size_t>(i)]);
  }
  const hardpack::Costmap& map() const { return builder_->result(); }

  const BenchScene& scene_;
  GridWindow window_;
  PlannerParams params_;
  Status begun_ = Status::kOk;
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  std::unique_ptr<AstarSearch> search_ = std::make_unique<AstarSearch>();
  std::unique_ptr<PathSampler> sampler_ = std::make_unique<PathSampler>();
  std::unique_ptr<Optimizer> optimizer_ = std::make_unique<Optimizer>();
  std::unique_ptr<ActuatorPath> actuator_ = std::make_unique<ActuatorPath>();
  std::unique_ptr<SpeedProfile> speed_ = std::make_unique<SpeedProfile>();
  std::unique_ptr<PathCheck> check_ = std::make_unique<PathCheck>();
  std::unique_ptr<Planner> planner_ = std::make_unique<Planner>();
};

struct ChainStage {
  const char* name;
  Status (StageChain::*measure)(BenchRow&);
  bool feeds_the_next;  // a failure here leaves the following stages without input
};

constexpr ChainStage kChain[] = {
    {"costmap", &StageChain::Costmap, true}, {"astar", &StageChain::Astar, true},
    {"sample", &StageChain::Sample, true},   {"optimizer", &StageChain::Optimize, true},
    {"speed", &StageChain::Speed, false},    {"check", &StageChain::Check, false}};

bool Wanted(const std::vector<std::string>& stages, const std::string& name) {
  return std::find(stages.begin(), stages.end(), name) != stages.end();
}

// A stage that is only needed by a later one is run as well, but not reported.
void MeasureScene(const BenchScene& scene, const std::vector<std::string>& stages,
                  std::vector<BenchRow>& rows) {
  StageChain chain(scene);
  const auto report = [&](const char* name, Status (StageChain::*measure)(BenchRow&)) {
    BenchRow row;
    row.stage = name;
    row.scene = scene.name;
    row.status = (chain.*measure)(row);
    if (Wanted(stages, name)) rows.push_back(row);
    return row.status;
  };
  const auto last = std::find_if(std::rbegin(kChain), std::rend(kChain),
                                 [&](const ChainStage& s) { return Wanted(stages, s.name); });
  for (auto stage = std::begin(kChain); stage != last.base(); ++stage) {
    const Status status = report(stage->name, stage->measure);
    if (stage->feeds_the_next && !IsUsable(status)) break;
  }
  if (Wanted(stages, "plan")) (void)report("plan", &StageChain::Plan);
}

void MeasureRevolution(const std::vector<std::string>& stages, std::vector<BenchRow>& rows) {
  struct Measure {
    const char* stage;
    BenchRow (RevolutionBench::*run)();
  };
  constexpr Measure kMeasures[] = {{"decode", &RevolutionBench::Decode},
                                   {"column", &RevolutionBench::ColumnByGeometry},
                                   {"column", &RevolutionBench::ColumnWithLabels},
                                   {"costmap", &RevolutionBench::Costmap}};
  const bool any = std::any_of(std::begin(kMeasures), std::end(kMeasures),
                               [&](const Measure& one) { return Wanted(stages, one.stage); });
  if (!any) return;
  RevolutionBench bench;
  for (const Measure& one : kMeasures) {
    if (Wanted(stages, one.stage)) rows.push_back((bench.*one.run)());
  }
}

}  // namespace

const std::vector<std::string>& BenchStageNames() {
  static const std::vector<std::string> names = {
      "decode", "column", "costmap", "astar", "sample", "optimizer", "speed", "check", "plan"};
  return names;
}

std::vector<BenchRow> MeasureStages(const std::vector<std::string>& stages) {
  std::vector<BenchRow> rows;
  MeasureRevolution(stages, rows);
  const bool any_of_planning = std::any_of(stages.begin(), stages.end(), [](const auto& name) {
    return name != "decode" && name != "column";
  });
  if (!any_of_planning) return rows;
  for (const BenchScene& scene : MakeBenchScenes()) MeasureScene(scene, stages, rows);
  std::stable_sort(rows.begin(), rows.end(), [](const BenchRow& a, const BenchRow& b) {
    const auto& names = BenchStageNames();
    return std::find(names.begin(), names.end(), a.stage) <
           std::find(names.begin(), names.end(), b.stage);
  });
  return rows;
}

}  // namespace hardpack::command
