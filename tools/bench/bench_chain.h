// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/autonomy/planner.h"
#include "core/costmap/height_grid.h"
#include "tools/bench/bench_scenes.h"

// The stages of planning on one scene, each ready to be run again and again: what it works on is
// there from the start. For measuring times and for counting instructions alike.

namespace hardpack::command {

class StageChain {
 public:
  static constexpr size_t kMostQueries = 8;
  static constexpr int kPathPoints = 200;  // of the path that is optimized, timed and checked

  // Builds the costmap, chooses the scene's first kMostQueries queries that have a way from free
  // cell to free cell, and runs each stage once. Obstacles are dilated by the vehicle's planning
  // radius; where that leaves no query, by nothing (`dilated` is false then): in a comb 7 cells
  // wide the search still has something to do, as the halo gives each way its weight.
  // Throws a CommandFailure when the heights do not give the scene's cells.
  explicit StageChain(const BenchScene& scene);

  // From Begin to the end; how it ended.
  Status BuildCostmap();  // from heights, pending columns of the mapper included
  Status Search(const BenchQuery& query);
  Status Sample();  // of the last Search
  Status Optimize(const OptimizerParams& optimizer);
  Status Speed();
  Status Check();
  Status Replan(const BenchQuery& query);  // the whole of it, by the planner

  const std::vector<BenchQuery>& queries() const { return queries_; }
  // The same, or where there is none the scene's first: to find no way takes its time too.
  const std::vector<BenchQuery>& replan_queries() const { return replan_queries_; }
  bool has_path() const { return path_.size() > 1; }
  // Whose path is optimized, timed and checked: the first one with kPathPoints points, or else the
  // one with most. Precondition: has_path().
  const BenchQuery& path_query() const { return path_query_; }

  bool dilated() const { return dilated_; }
  const PlannerParams& params() const { return params_; }
  const hardpack::Costmap& map() const { return builder_->result(); }
  const AstarResult& search_result() const { return search_->result(); }
  const WorldPath& seed() const { return seed_; }  // as the planner makes one, cut to kPathPoints
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
