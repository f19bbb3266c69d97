// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"

#include <cstdio>

using namespace hardpack;

static Planner planner;  // 4 MiB that live here and nowhere else: nothing is allocated

int main() {
  PlanRequest request;
  request.start.pose = {.x_m = 0.0f, .y_m = 0.0f, .theta_rad = 0.0f};
  request.goal_odom = {.x_m = 20.0f, .y_m = 0.0f};

  const GridWindow window = GridWindow::CenteredAt({0.0f, 0.0f});
  if (planner.BeginCells(window, PlannerParams{}, request) != Status::kOk) return 1;
  for (int y = -20; y < 20; ++y) {  // a wall 10 m ahead, 8 m wide
    planner.costmap_builder().SetCell(window.Index({50, y}), Costmap::kHard | Costmap::kObserved);
  }
  while (planner.StepCells(1000) == Progress::kBusy) {  // on board: a few units in every tick
  }

  const Plan& plan = planner.result();
  std::printf("%s: %d points, %.1f m\n", StatusName(plan.status), plan.path.size(),
              LengthOf(plan.path));
  return IsUsable(plan.status) ? 0 : 1;
}
