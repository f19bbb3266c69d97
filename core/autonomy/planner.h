// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/astar/astar.h"
#include "core/base/decision_hash.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/costmap/height_grid.h"
#include "core/optimizer/optimizer.h"
#include "core/path/path.h"
#include "core/safety/path_check.h"
#include "core/speed/speed.h"

// The planning half of the chain: heights (or cells), costmap, base path, actuator path, optimized
// path, speeds, check. Resumable by units; owns every stage; the one place in core that sees them
// all. A start more than 60 degrees off begins with a turn on the spot.

namespace hardpack {

struct PlanRequest {
  PathStart start;
  Vec2 goal_odom;
  bool has_goal_heading = false;
  float goal_heading_rad = 0.0f;
};

// What is planned: everything that plan.json, the tracker and the decision hash need.
struct Plan {
  Status status = Status::kNotStarted;  // the gravest of the stages'; usable only if checked free
  Status base_status = Status::kNotStarted;
  Status optimizer_status = Status::kNotStarted;
  Status check_status = Status::kNotStarted;
  bool pivots_first = false;
  bool narrow = false;
  WorldPath base;         // resampled base path
  WorldPath path;         // [n] poses; with pivots_first the first two share their place
  ActuatorPath actuator;  // [n - 1] steps
  SpeedProfile speed;     // [n]
  PathCost cost_before;   // of the seed: the base path, joined
  PathCost cost_after;
  PathCheckResult check;
  AstarResult search;
};

enum class PlanStage : uint8_t {
  kIdle,
  kCostmap,
  kSearch,
  kSample,
  kOptimize,
  kSpeed,
  kCheck,
  kDone
};

class Planner {
 public:
  // kParameterOutOfRange, kNotFinite: nothing is started.
  Status Begin(const HeightGrid& heights, const PlannerParams& params, const PlanRequest& request);

  // The same on given cells: between BeginCells and the first StepCells, call
  // costmap_builder().SetCell.
  Status BeginCells(const GridWindow& window, const PlannerParams& params,
                    const PlanRequest& request);

  Progress Step(const HeightGrid& heights, int units);
  Progress StepCells(int units);

  PlanStage stage() const { return stage_; }
  const Plan& result() const { return plan_; }
  const Costmap& costmap() const { return builder_.result(); }
  CostmapBuilder& costmap_builder() { return builder_; }

 private:
  PlanStage stage_ = PlanStage::kIdle;
  PlannerParams params_;
  PlanRequest request_;
  Plan plan_;
  CostmapBuilder builder_;
  AstarSearch search_;
  PathSampler sampler_;
  Optimizer optimizer_;
  PathCheck check_;
};

// Planning as a whole: heights, costs, search, paths.
inline constexpr int kPlanningBudget_bytes = 6 * 1024 * 1024;
static_assert(sizeof(Planner) + sizeof(HeightGrid) <= kPlanningBudget_bytes);

// Adds every decision of a plan, field by field.
void AddToHash(const Plan& plan, DecisionHash& hash);

}  // namespace hardpack
