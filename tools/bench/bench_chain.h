// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/autonomy/planner.h"
#include "core/costmap/height_grid.h"
#include "tools/bench/bench_scenes.h"

// The stages of planning on one scene, each ready to run any number of times: its input exists from
// the start. Used for measuring times and for counting instructions.

namespace hardpack::command {

class StageChain {
 public:
  static constexpr size_t kMostQueries = 8;
  static constexpr int kPathPoints = 200;  // of the path that is optimized, timed and checked

  // Builds the costmap, selects the scene's first kMostQueries queries that have a path from a free
  // cell to a free cell, and runs each stage once. Obstacles are dilated by the vehicle's planning
  // radius; if that leaves no query, they are not dilated (`dilated` is then false): in a comb 7
  // cells wide the search still has work to do, because the halo gives each path its weight.
  // Throws a CommandFailure if the heights do not reproduce the scene's cells.
  explicit StageChain(const BenchScene& scene);

  // From Begin to the end; returns the final status.
  Status BuildCostmap();  // from heights, pending columns of the mapper included
  Status Search(const BenchQuery& query);
  Status Sample();  // of the last Search
  Status Optimize(const OptimizerParams& optimizer);
  Status Speed();
  Status Check();
  Status Replan(const BenchQuery& query);  // a complete planning, by the planner

  const std::vector<BenchQuery>& queries() const { return queries_; }
  // The same, or the scene's first one if there are none: finding no path takes time, too.
  const std::vector<BenchQuery>& replan_queries() const { return replan_queries_; }
  bool has_path() const { return path_.size() > 1; }
  // The query whose path is optimized, timed and checked: the first one with kPathPoints points, or
  // otherwise the one with the most. Precondition: has_path().
  const BenchQuery& path_query() const { return path_query_; }

  bool dilated() const { return dilated_; }
  const PlannerParams& params() const { return params_; }
  const hardpack::Costmap& map() const { return builder_->result(); }
  const AstarResult& search_result() const { return search_->result(); }
  const WorldPath& seed() const { return seed_; }  // as made by the planner, cut to kPathPoints
  const OptimizerResult& optimizer_result() const { return optimizer_->result(); }
  const WorldPath& path() const { return path_; }  // optimized
  const SpeedProfile& speed() const { return *speed_; }

 private:
  void FillHeights(const BenchScene& scene);
  void CheckCells(const BenchScene& scene) const;
  void ChooseQueries(const BenchScene& scene);
  void MakeSeed();
  const HeightGrid& heights() const;

  std::shared_ptr<const Mapper> mapper_;  // or none, then ...
  std::unique_ptr<HeightGrid> heights_;   // ... these
  PlannerParams params_;
  bool dilated_ = true;
  std::vector<BenchQuery> queries_;
  std::vector<BenchQuery> replan_queries_;
  BenchQuery path_query_;
  BenchQuery searched_;  // by the last Search
  WorldPath seed_;
  WorldPath path_;
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  std::unique_ptr<AstarSearch> search_ = std::make_unique<AstarSearch>();
  std::unique_ptr<PathSampler> sampler_ = std::make_unique<PathSampler>();
  std::unique_ptr<Optimizer> optimizer_ = std::make_unique<Optimizer>();
  std::unique_ptr<ActuatorPath> actuator_ = std::make_unique<ActuatorPath>();
  std::unique_ptr<SpeedProfile> speed_ = std::make_unique<SpeedProfile>();
  std::unique_ptr<PathCheck> check_ = std::make_unique<PathCheck>();
  std::unique_ptr<Planner> planner_ = std::make_unique<Planner>();
};

}  // namespace hardpack::command
