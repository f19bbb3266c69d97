// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/astar/astar.h"
#include "core/costmap/costmap.h"
#include "core/optimizer/optimizer.h"
#include "core/path/path.h"
#include "core/path/path_smoother.h"

// The problems on which path quality is measured: generated from a seed, the same on every machine.

namespace hardpack::command {

struct QualityProblem {
  int number = 0;  // from 1
  std::string kind;
  std::vector<uint8_t> flags;  // [kMapCells] of Costmap::Flag
  PathStart start;
  Vec2 goal_odom;
  bool has_goal_heading = false;
  float goal_heading_rad = 0.0f;
};

// The input of an optimizer.
struct QualitySeed {
  WorldPath base;  // A* alone: sampled, and joined to the start's (and the goal's) heading
  WorldPath seed;  // with which the planner starts its optimizer
  bool keeps_end_heading = false;
};

// The stages before the optimizer, in the planner's order: costmap, search, sampling, smoothing,
// joining.
class SeedMaker {
 public:
  explicit SeedMaker(const PlannerParams& params) : params_(params) {}

  // Only kOk means that there is a seed, of a path from the start to the goal that needs no turn on
  // the spot and no narrower map; otherwise the reason (kPivotBlocked if it needs a turn).
  Status Make(const QualityProblem& problem);

  // The following refer to the last Make. Repeats the search, with sampling and joining: the work
  // of A* alone.
  void RepeatBase(const QualityProblem& problem);
  const Costmap& map() const { return builder_->result(); }
  const QualitySeed& result() const { return result_; }

 private:
  void BuildMap(const QualityProblem& problem);
  Status FindBase(const QualityProblem& problem);
  bool Join(const QualityProblem& problem, const WorldPath& base, WorldPath& seed,
            bool& keeps_end_heading) const;

  PlannerParams params_;
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  std::unique_ptr<AstarSearch> search_ = std::make_unique<AstarSearch>();
  std::unique_ptr<PathSampler> sampler_ = std::make_unique<PathSampler>();
  std::unique_ptr<PathSmoother> smoother_ = std::make_unique<PathSmoother>();
  QualitySeed result_;
};

// Problem `number` (from 1) of a seed; its seed path is left in `maker`. The kinds of ground
// alternate. Three of five are about 200 points long, the others about 100. Start headings are up
// to 60 degrees off; one in four starts on a bend, one in five has a goal heading. Nothing if none
// of 200 draws can be planned.
std::optional<QualityProblem> MakeQualityProblem(uint32_t seed, int number, SeedMaker& maker);

}  // namespace hardpack::command
