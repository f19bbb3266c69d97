// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/optimizer/optimizer.h"
#include "core/safety/path_check.h"
#include "tools/bench/quality/quality_problems.h"

// The solvers whose path quality is compared, each from the same seed on the same map, one after
// the other in every round, so that disturbances of the machine affect all of them.

namespace hardpack::command {

enum class SolverId : uint8_t {
  kAstar,           // the unchanged base path, which the optimizers improve
  kPaper,           // the paper's solver, default parameters
  kPaperConverged,  // the same, until a sweep gains almost nothing
  kOurs,            // the lateral Newton descent, default parameters
  kCeresSquares,    // Ceres as least squares, and ...
  kCeresLines,      // ... by line search: only if it is installed
};

struct SolverName {
  SolverId id;
  std::string key;   // in JSON
  std::string text;  // in tables and pictures
};

// Those that this build has, in the order of SolverId.
const std::vector<SolverName>& Solvers();

struct QualityMeasures {
  PathCost cost;                         // F
  float largest_curvature_per_m = 0.0f;  // of PathCheckResult, as the next
  float largest_curvature_rate_per_m2 = 0.0f;
  bool keeps_limits = false;  // both, within PathCheck's tolerance
  float length_m = 0.0f;
  float clearance_m = 0.0f;  // of the footprint to the nearest hard cell, at most 2 m
  float angle_per_m = 0.0f;  // [rad/m] sum of |phi| over the length
  bool collides = false;     // by PathCheck
  int points = 0;
};

QualityMeasures Measure(const Costmap& map, const PlannerParams& params, const WorldPath& path,
                        float start_curvature_per_m);

struct QualityRun {
  bool usable = false;  // there is a path; a solver that fails leaves the seed
  WorldPath path;
  QualityMeasures measures;
  double median_us = 0.0;   // of processor time, over the rounds
  int64_t allocations = 0;  // on the heap, in one run
};

// Solves problems, `rounds` times each.
class QualityBench {
 public:
  QualityBench(const PlannerParams& params, int rounds);

  // One run for each of Solvers(). `maker` holds the problem's seed. Time of A* alone: search,
  // sampling and joining, which all others need first.
  std::vector<QualityRun> Solve(const QualityProblem& problem, SeedMaker& maker);

 private:
  bool Run(SolverId id, const QualityProblem& problem, SeedMaker& maker, WorldPath& path);
  bool Optimize(const OptimizerParams& optimizer, const QualityProblem& problem,
                const SeedMaker& maker, WorldPath& path);

  PlannerParams params_;
  int rounds_;
  std::unique_ptr<Optimizer> optimizer_ = std::make_unique<Optimizer>();
};

}  // namespace hardpack::command
