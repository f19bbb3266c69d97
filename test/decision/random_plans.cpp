// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/autonomy/planner.h"
#include "core/base/assert.h"
#include "test/decision/map_hash.h"
#include "test/decision/random.h"
#include "test/decision/random_scenes.h"
#include "test/decision/storage.h"
#include "test/decision/vary.h"

// Plans from anywhere to anywhere on maps of random shapes, with random parameters.

namespace hardpack::decision {
namespace {

HP_BIG_MEMORY Storage<Planner> g_planner;

constexpr int kGroups = 8;
constexpr int kPlans = 40;  // of a group
constexpr int kUnits = 4099;
constexpr int kMaxCalls = 100000;

// A rectangle, a ring of walls with a gap, or a comb.
bool IsInShape(int kind, Cell at, Cell size) {
  switch (kind) {
    case 0:
      return true;
    case 1:
      return (at.x == 0 || at.y == 0 || at.x == size.x - 1 || at.y == size.y - 1) &&
             !(at.x == 0 && at.y > size.y / 3 && at.y < size.y / 3 + 8);
    default:
      return at.x % 12 < 2 && at.y < size.y - 6;
  }
}

void DrawShape(Random& random, const GridWindow& window, CostmapBuilder& builder) {
  constexpr uint8_t kFlags[] = {Costmap::kHard | Costmap::kObserved,
                                Costmap::kHard | Costmap::kObserved,
                                Costmap::kSoft | Costmap::kObserved,
                                Costmap::kObserved,
                                0,
                                Costmap::kHard | Costmap::kPerson | Costmap::kObserved};
  const uint8_t flags = kFlags[random.Between(0, 5)];
  const int kind = std::max(random.Between(-3, 2), 0);
  const int most = kind == 0 ? 16 : 60;
  const Cell size{random.Between(1, most), random.Between(1, most)};
  const Cell low{random.Between(0, kMapSize_cells - 1), random.Between(0, kMapSize_cells - 1)};
  for (int cell = 0; cell < size.x * size.y; ++cell) {
    const Cell in{cell % size.x, cell / size.x};
    const Cell at{window.origin.x + low.x + in.x, window.origin.y + low.y + in.y};
    if (window.Contains(at) && IsInShape(kind, in, size)) {
      builder.SetCell(window.Index(at), flags);
    }
  }
}

void Draw(Random& random, const GridWindow& window, CostmapBuilder& builder) {
  const uint8_t ground = random.Between(0, 3) == 0 ? uint8_t{0} : uint8_t{Costmap::kObserved};
  for (int index = 0; index < kMapCells; ++index) builder.SetCell(index, ground);
  const int shapes = random.Between(0, 220);
  for (int i = 0; i < shapes; ++i) DrawShape(random, window, builder);
}

PlanRequest AnyRequest(Random& random) {
  PlanRequest request;
  request.start.pose = {random.RealBetween(-30.0f, 30.0f), random.RealBetween(-30.0f, 30.0f),
                        random.RealBetween(-3.2f, 3.2f)};
  const bool moves = random.Between(0, 1) == 0;
  request.start.speed_mps = moves ? random.RealBetween(0.0f, 5.0f) : 0.0f;
  request.start.curvature_per_m = moves ? random.RealBetween(-0.3f, 0.3f) : 0.0f;
  const float reach_m = random.Between(0, 7) == 0 ? 100.0f : 35.0f;
  request.goal_odom = {request.start.pose.x_m + random.RealBetween(-reach_m, reach_m),
                       request.start.pose.y_m + random.RealBetween(-reach_m, reach_m)};
  request.has_goal_heading = random.Between(0, 3) == 0;
  request.goal_heading_rad = random.RealBetween(-3.2f, 3.2f);
  return request;
}

// Whether it came to a path.
bool PlanOnce(Random& random, DecisionHash& hash) {
  static PlannerParams params;
  params = {};
  Vary(random, 12, params);
  if (random.Between(0, 3) == 0) params.optimizer.method = 0;
  const PlanRequest request = AnyRequest(random);
  Planner& planner = g_planner.Construct();
  const GridWindow window =
      GridWindow::CenteredAt({request.start.pose.x_m, request.start.pose.y_m});
  const Status begun = planner.BeginCells(window, params, request);
  hash.AddU8(static_cast<uint8_t>(begun));
  if (!IsUsable(begun)) return false;
  Draw(random, window, planner.costmap_builder());
  int calls = 0;
  while (planner.StepCells(kUnits) == Progress::kBusy) HP_ASSERT(++calls < kMaxCalls);
  AddCostmap(planner.costmap(), hash);
  AddToHash(planner.result(), hash);
  return IsUsable(planner.result().status);
}

}  // namespace

void RunRandomPlans(Report& report) {
  uint32_t usable = 0;
  for (int group = 0; group < kGroups; ++group) {
    Random random(0x5eed0100u + static_cast<uint32_t>(group));
    DecisionHash hash;
    for (int i = 0; i < kPlans; ++i) usable += PlanOnce(random, hash) ? 1 : 0;
    report.Add("random.plans", hash);
  }
  PrintNumber("random.plans usable", usable);
}

}  // namespace hardpack::decision
