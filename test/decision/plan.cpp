// SPDX-License-Identifier: Apache-2.0
#include "test/decision/plan.h"

#include "core/base/assert.h"
#include "test/decision/map_hash.h"
#include "test/decision/random.h"
#include "test/decision/storage.h"

namespace hardpack::decision {
namespace {

HP_BIG_MEMORY Storage<Planner> g_planner;

// Here, because frames are small.
constexpr PlannerParams kParams;

// Units of one call: no divisor of any stage's total, so that stages end in the middle of a call.
constexpr int kUnits = 997;
// Planning is bounded; a planner that is still busy after this is broken.
constexpr int kMaxCalls = 100000;

void ReportPlan(const Planner& planner, const PlanNames& names, Report& report) {
  DecisionHash costmap;
  AddCostmap(planner.costmap(), costmap);
  report.Add(names.costmap, costmap);
  DecisionHash plan;
  AddToHash(planner.result(), plan);
  report.Add(names.plan, plan);
  PrintStatus(names.plan, planner.result().status);
}

// Rectangles of hard and soft cells, at random places at some distance from the start.
void ScatterBlocks(const GridWindow& window, uint32_t seed, int blocks, CostmapBuilder& builder) {
  Random random(seed);
  for (int i = 0; i < blocks; ++i) {
    const int width = random.Between(1, 14);
    const int height = random.Between(1, 14);
    const int x = random.Between(0, kMapSize_cells - 15);
    const int y = random.Between(0, kMapSize_cells - 15);
    const uint8_t what = random.Between(0, 2) == 0 ? Costmap::kSoft : Costmap::kHard;
    for (int cell = 0; cell < width * height; ++cell) {
      const Cell at{window.origin.x + x + cell % width, window.origin.y + y + cell / width};
      builder.SetCell(window.Index(at), static_cast<uint8_t>(what | Costmap::kObserved));
    }
  }
}

void PlanOnCells(uint32_t seed, int blocks, const PlanRequest& request, const PlanNames& names,
                 Report& report) {
  Planner& planner = g_planner.Construct();
  const GridWindow window =
      GridWindow::CenteredAt({request.start.pose.x_m, request.start.pose.y_m});
  const Status status = planner.BeginCells(window, kParams, request);
  HP_ASSERT(status == Status::kOk);
  ScatterBlocks(window, seed, blocks, planner.costmap_builder());
  int calls = 0;
  while (planner.StepCells(kUnits) == Progress::kBusy) HP_ASSERT(++calls < kMaxCalls);
  ReportPlan(planner, names, report);
}

}  // namespace

void PlanOnMap(const Mapper& mapper, const PlanRequest& request, const PlanNames& names,
               Report& report) {
  Planner& planner = g_planner.Construct();
  const Status status = planner.Begin(mapper, kParams, request);
  HP_ASSERT(status == Status::kOk);
  int calls = 0;
  while (planner.Step(mapper, kUnits) == Progress::kBusy) HP_ASSERT(++calls < kMaxCalls);
  ReportPlan(planner, names, report);
}

void RunCells(Report& report) {
  PlanRequest request;
  request.start.pose = {100.1f, -50.3f, 0.4f};
  request.goal_odom = {136.0f, -18.0f};
  PlanOnCells(0x5eed0020u, 25, request, {"sparse.costmap", "sparse.plan"}, report);
  request.goal_odom = {70.0f, -90.0f};
  request.has_goal_heading = true;
  request.goal_heading_rad = -2.0f;
  PlanOnCells(0x5eed0021u, 60, request, {"medium.costmap", "medium.plan"}, report);
  request.goal_odom = {1000.0f, 400.0f};  // off the map
  request.has_goal_heading = false;
  PlanOnCells(0x5eed0022u, 110, request, {"dense.costmap", "dense.plan"}, report);
  request.goal_odom = {112.0f, -46.0f};
  request.start.speed_mps = 4.0f;
  request.start.curvature_per_m = -0.2f;
  PlanOnCells(0x5eed0023u, 160, request, {"crowded.costmap", "crowded.plan"}, report);
}

}  // namespace hardpack::decision
