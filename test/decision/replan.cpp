// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/replanner.h"
#include "core/base/assert.h"
#include "test/decision/random.h"
#include "test/decision/report.h"
#include "test/decision/storage.h"

// A drive of some rounds: a path is committed, kept, blocked and replaced, and the goal, which lies
// off the map, comes nearer.

namespace hardpack::decision {
namespace {

HP_BIG_MEMORY Storage<Replanner> g_replanner;
HP_BIG_MEMORY Storage<PlanGoal> g_goal;

constexpr PlannerParams kParams;
constexpr int kRounds = 8;
constexpr int kUnits = 997;  // of one call, see plan.cpp
constexpr int kMaxCalls = 100000;
constexpr float kWayPerRound_m = 2.5f;

void SetBlock(const GridWindow& window, Cell low, int width, int height, CostmapBuilder& builder) {
  for (int cell = 0; cell < width * height; ++cell) {
    const Cell at{low.x + cell % width, low.y + cell / width};
    if (window.Contains(at)) {
      builder.SetCell(window.Index(at), Costmap::kHard | Costmap::kObserved);
    }
  }
}

// One obstacle ahead, as good on either side; from the third round on one on the path; and from the
// sixth a wall further on, whose gap has room for the bare footprint.
void SetWorld(const GridWindow& window, int round, CostmapBuilder& builder) {
  SetBlock(window, {70, -10}, 6, 21, builder);
  if (round >= 2) SetBlock(window, {40, -4}, 4, 7, builder);
  if (round < 5) return;
  SetBlock(window, {140, -405}, 2, 400, builder);
  SetBlock(window, {140, 5}, 2, 400, builder);
}

// One round with the obstacles of its number, to the end of its plan.
void Replan(int round, const VehicleState& state, const PlanGoal& goal, Replanner& replanner) {
  const uint64_t now_ns = 1'000'000'000u + 100'000'000u * static_cast<uint64_t>(round);
  Status status = replanner.Update(now_ns, state, goal);
  HP_ASSERT(status == Status::kOk);
  const GridWindow window = GridWindow::CenteredAt({state.pose.x_m, state.pose.y_m});
  status = replanner.BeginCells(window);
  HP_ASSERT(status == Status::kOk);
  SetWorld(window, round, replanner.costmap_builder());
  int calls = 0;
  while (replanner.StepCells(kUnits) == Progress::kBusy) HP_ASSERT(++calls < kMaxCalls);
}

}  // namespace

void RunReplan(Report& report) {
  Replanner& replanner = g_replanner.Construct();
  const Status status = replanner.Configure(kParams);
  HP_ASSERT(status == Status::kOk);
  Random random(0x5eed0030u);
  VehicleState state;
  state.pose = {0.1f, 0.1f, 0.0f};
  PlanGoal& goal = g_goal.Construct();
  goal.position_odom = {80.0f, 5.0f};
  DecisionHash hash;
  for (int round = 0; round < kRounds; ++round) {
    Replan(round, state, goal, replanner);
    AddToHash(replanner, hash);
    PrintStatus("replan", replanner.outcome().status);
    PrintNumber("replan_reason ", static_cast<uint32_t>(replanner.outcome().reason));
    // Some way along it, and a little beside it.
    const PathState at = StateAt(replanner.committed(), replanner.place().along_m + kWayPerRound_m);
    const float beside_m = 0.01f * static_cast<float>(random.Between(-5, 5));
    state.pose = {at.pose.x_m, at.pose.y_m + beside_m, at.pose.theta_rad};
    state.curvature_per_m = at.curvature_per_m;
    state.speed_mps = at.speed_mps;
  }
  report.Add("replan", hash);
}

}  // namespace hardpack::decision
