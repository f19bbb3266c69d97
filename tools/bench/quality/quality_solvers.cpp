// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_solvers.h"

#include <time.h>

#include <algorithm>

#include "core/base/math.h"
#include "tools/allocation_counter/allocation_counter.h"
#ifdef HARDPACK_HAS_CERES
#include "tools/bench/peers/ceres_smoother.h"
#endif

namespace hardpack::command {
namespace {

constexpr int kAllUnits = 1'000'000;

OptimizerParams WithMethod(const PlannerParams& params, int32_t method) {
  OptimizerParams optimizer = params.optimizer;
  optimizer.method = method;
  return optimizer;
}

OptimizerParams PaperParams(const PlannerParams& params) {
  return WithMethod(params, OptimizerParams::kPaperDescent);
}

OptimizerParams OurParams(const PlannerParams& params) {
  return WithMethod(params, OptimizerParams::kLateralNewton);
}

// Until a sweep gains less than rounding makes of a sum, or the descent has no more sweeps.
OptimizerParams ConvergedPaperParams(const PlannerParams& params) {
  OptimizerParams converged = PaperParams(params);
  converged.max_sweeps = Optimizer::kMaxSweeps;
  converged.min_relative_decrease = 1.0e-5f;
  return converged;
}

float SumOfAngles(const WorldPath& path) {
  ActuatorPath actuator;
  if (!IsUsable(ToActuator<PlanarModel>(path, actuator))) return 0.0f;
  float sum_rad = 0.0f;
  for (const ActuatorStep& step : actuator.steps) sum_rad += Abs(step.phi_rad);
  return sum_rad;
}

// The processor time of this thread. On a shared machine, wall clock time would include that of
// other programs, and more of it for a long run than for one that fits into a time slice.
double ProcessorTime_us() {
  timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1.0e6 * static_cast<double>(time.tv_sec) + 1.0e-3 * static_cast<double>(time.tv_nsec);
}

double MedianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

#ifdef HARDPACK_HAS_CERES
bool RunCeres(peers::CeresMethod method, const OptimizerParams& optimizer,
              const QualityProblem& problem, const SeedMaker& maker, WorldPath& path) {
  // As nav2's constrained smoother; L-BFGS takes more of its steps, which are cheaper, to converge.
  const int most_iterations = method == peers::CeresMethod::kTrustRegion ? 100 : 1000;
  const peers::CeresResult result = peers::Smooth(
      method, maker.map(), optimizer, maker.result().seed, problem.start.curvature_per_m,
      maker.result().keeps_end_heading, most_iterations);
  path = result.path;
  return result.usable;
}
#endif

}  // namespace

const std::vector<SolverName>& Solvers() {
  static const std::vector<SolverName> solvers = {
      {SolverId::kAstar, "astar", "A* alone"},
      {SolverId::kPaper, "paper", "paper"},
      {SolverId::kPaperConverged, "paper_converged", "paper, converged"},
      {SolverId::kOurs, "hardpack", "hardpack"},
#ifdef HARDPACK_HAS_CERES
      {SolverId::kCeresSquares, "ceres_least_squares", "Ceres, least squares"},
      {SolverId::kCeresLines, "ceres_line_search", "Ceres, L-BFGS"},
#endif
  };
  return solvers;
}

QualityMeasures Measure(const Costmap& map, const PlannerParams& params, const WorldPath& path,
                        float start_curvature_per_m) {
  QualityMeasures measures;
  measures.cost = CostOf(map, params.optimizer, path, start_curvature_per_m);
  measures.points = path.size();
  measures.length_m = LengthOf(path);
  if (measures.length_m > 0.0f) measures.angle_per_m = SumOfAngles(path) / measures.length_m;
  PathCheck check;
  if (!IsUsable(check.Begin(params.vehicle, params.optimizer, path, start_curvature_per_m, 0.0f))) {
    return measures;
  }
  while (check.Step(map, path, kAllUnits) == Progress::kBusy) {
  }
  const PathCheckResult& result = check.result();
  const OptimizerParams& limits = params.optimizer;
  measures.largest_curvature_per_m = result.largest_curvature_per_m;
  measures.largest_curvature_rate_per_m2 = result.largest_curvature_rate_per_m2;
  measures.keeps_limits =
      result.curvature_excess_per_m <= PathCheck::kLimitTolerance * limits.max_curvature_per_m &&
      result.curvature_rate_excess_per_m2 <=
          PathCheck::kLimitTolerance * limits.max_curvature_rate_per_m2;
  measures.clearance_m = result.smallest_clearance_m;
  measures.collides = result.status == Status::kCollision;
  return measures;
}

QualityBench::QualityBench(const PlannerParams& params, int rounds)
    : params_(params), rounds_(rounds) {}

std::vector<QualityRun> QualityBench::Solve(const QualityProblem& problem, SeedMaker& maker) {
  std::vector<QualityRun> runs(Solvers().size());
  std::vector<std::vector<double>> times_us(runs.size());
  for (int round = 0; round < rounds_; ++round) {
    for (size_t i = 0; i < runs.size(); ++i) {
      QualityRun& run = runs[i];
      const int64_t allocations_before = AllocationCount();
      const double before_us = ProcessorTime_us();
      run.usable = Run(Solvers()[i].id, problem, maker, run.path);
      const double after_us = ProcessorTime_us();
      run.allocations = AllocationCount() - allocations_before;
      times_us[i].push_back(after_us - before_us);
    }
  }
  for (size_t i = 0; i < runs.size(); ++i) {
    runs[i].median_us = MedianOf(times_us[i]);
    runs[i].measures = Measure(maker.map(), params_, runs[i].path, problem.start.curvature_per_m);
  }
  return runs;
}

bool QualityBench::Run(SolverId id, const QualityProblem& problem, SeedMaker& maker,
                       WorldPath& path) {
  switch (id) {
    case SolverId::kAstar:
      maker.RepeatBase(problem);
      path = maker.result().base;
      return true;
    case SolverId::kPaper:
      return Optimize(PaperParams(params_), problem, maker, path);
    case SolverId::kPaperConverged:
      return Optimize(ConvergedPaperParams(params_), problem, maker, path);
    case SolverId::kOurs:
      return Optimize(OurParams(params_), problem, maker, path);
#ifdef HARDPACK_HAS_CERES
    case SolverId::kCeresSquares:
      return RunCeres(peers::CeresMethod::kTrustRegion, params_.optimizer, problem, maker, path);
    case SolverId::kCeresLines:
      return RunCeres(peers::CeresMethod::kLineSearch, params_.optimizer, problem, maker, path);
#else
    case SolverId::kCeresSquares:
    case SolverId::kCeresLines:
      break;
#endif
  }
  return false;
}

bool QualityBench::Optimize(const OptimizerParams& optimizer, const QualityProblem& problem,
                            const SeedMaker& maker, WorldPath& path) {
  const QualitySeed& seed = maker.result();
  const Status begun = optimizer_->Begin(maker.map(), optimizer, params_.path, seed.seed,
                                         problem.start.curvature_per_m, seed.keeps_end_heading);
  if (!IsUsable(begun)) {
    path = seed.seed;
    return false;
  }
  while (optimizer_->Step(maker.map(), kAllUnits) == Progress::kBusy) {
  }
  path = optimizer_->path();
  return true;
}

}  // namespace hardpack::command
