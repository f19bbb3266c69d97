// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/ceres_smoother.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/optimizer/cost_terms.h"
#include "tools/bench/peers/moved_path.h"
#include "tools/bench/peers/rounded_cost.h"

namespace hardpack::peers {
namespace {

// The widths of the rounding of |u|, and the floor that keeps the slope of the map term's root
// finite. Larger ones need fewer steps, but deviate more from F; these gave the lowest F after 100
// iterations.
constexpr double kRoundedTurn_rad = 3e-3;
constexpr double kRoundedStep_per_m = 3e-2;
constexpr double kRoundedExcess = 1e-2;
constexpr double kMapFloor_m = 1e-3;
constexpr double kTrustRegionRadius = 1e6;

constexpr int kFirstFree = MovedPath::kFirstFree;
constexpr int kMinPoints = 4;

size_t Count(int count) {
  return static_cast<size_t>(count);
}

// The factors of F's five kinds of terms, each with the size below which |u| is rounded.
struct Rounding {
  double weight;
  double rounded;

  // weight (sqrt(u^2 + e^2) - e)
  double Of(double u) const { return weight * (Size(u * u) - rounded); }
  double Size(double u2) const { return std::sqrt(u2 + rounded * rounded); }
};

struct Roundings {
  explicit Roundings(const OptimizerParams& params)
      : turn{params.curvature_alpha, kRoundedTurn_rad},
        turn_excess{params.curvature_beta - params.curvature_alpha, kRoundedExcess},
        step{params.curvature_rate_alpha, kRoundedStep_per_m},
        step_excess{params.curvature_rate_beta - params.curvature_rate_alpha, kRoundedExcess} {}

  Rounding turn;
  Rounding turn_excess;
  Rounding step;
  Rounding step_excess;
};

// --- least squares
// --------------------------------------------------------------------------------

// A rounded |u| as a loss of the squared residual. Ceres halves it.
class RoundedLoss : public ceres::LossFunction {
 public:
  explicit RoundedLoss(Rounding rounding) : rounding_(rounding) {}
  void Evaluate(double squared, double out[3]) const override {
    const double size = rounding_.Size(squared);
    out[0] = 2.0 * rounding_.weight * (size - rounding_.rounded);
    out[1] = rounding_.weight / size;
    out[2] = -0.5 * out[1] / (size * size);
  }

 private:
  Rounding rounding_;
};

// Hands on a number that RoundedCost has found, and its derivatives by the offsets of `blocks` free
// points. first: index into Term::by of the first of them; normals: theirs.
class TermResidual : public ceres::CostFunction {
 public:
  TermResidual(const Term& term, int first, int blocks, const double* normals)
      : term_(term), by_(term.by + first), normals_(normals), blocks_(blocks) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(Count(blocks), 1);
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    residuals[0] = value();
    Differentiate(1.0, jacobians);
    return true;
  }

 protected:
  double value() const { return term_.value; }
  void Differentiate(double scale, double** jacobians) const {
    if (jacobians == nullptr) return;
    for (int i = 0; i < blocks_; ++i) {
      if (jacobians[i] == nullptr) continue;
      *jacobians[i] = scale * (by_[2 * i] * normals_[2 * i] + by_[2 * i + 1] * normals_[2 * i + 1]);
    }
  }

 private:
  const Term& term_;
  const double* by_;
  const double* normals_;
  int blocks_;
};

// Half its square is the map's term and a constant.
class MapResidual : public TermResidual {
 public:
  using TermResidual::TermResidual;

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    residuals[0] = std::sqrt(2.0 * (value() + kMapFloor_m));
    Differentiate(1.0 / residuals[0], jacobians);
    return true;
  }
};

// Finds all terms at once before Ceres asks for the residuals one by one.
class AllTerms : public ceres::EvaluationCallback {
 public:
  AllTerms(MovedPath& path, RoundedCost& cost) : path_(path), cost_(cost) {}
  void PrepareForEvaluation(bool jacobians, bool) override {
    path_.Place();
    cost_.Find(path_.positions_m(), jacobians);
  }

 private:
  MovedPath& path_;
  RoundedCost& cost_;
};

class LeastSquares {
 public:
  LeastSquares(const Costmap& map, const OptimizerParams& params, float start_curvature_per_m,
               MovedPath& path);
  ceres::Problem& problem() { return problem_; }

  // Half the sum of squares minus the rounded F without the map terms of fixed points.
  double constant() const { return map_terms_ * kMapFloor_m; }

 private:
  static ceres::Problem::Options Options(ceres::EvaluationCallback* callback) {
    ceres::Problem::Options options;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    options.evaluation_callback = callback;
    return options;
  }

  // A term of point k that depends on the points from `from` to k + 1.
  template <typename Residual>
  void Add(const Term& term, int k, int from, ceres::LossFunction* loss);

  MovedPath& path_;
  RoundedCost cost_;
  AllTerms all_terms_;
  RoundedLoss turn_;
  RoundedLoss turn_excess_;
  RoundedLoss step_;
  RoundedLoss step_excess_;
  double map_terms_ = 0.0;
  ceres::Problem problem_;
};

LeastSquares::LeastSquares(const Costmap& map, const OptimizerParams& params,
                           float start_curvature_per_m, MovedPath& path)
    : path_(path),
      cost_(map, params, path.points(), start_curvature_per_m),
      all_terms_(path, cost_),
      turn_(Roundings(params).turn),
      turn_excess_(Roundings(params).turn_excess),
      step_(Roundings(params).step),
      step_excess_(Roundings(params).step_excess),
      problem_(Options(&all_terms_)) {
  for (int k = kFirstFree; k < path_.free_end(); ++k) {
    problem_.AddParameterBlock(path_.offsets_m() + k, 1);
  }
  const int last = path_.points() - 1;
  for (int k = 1; k < last; ++k) {
    const PointTerms& terms = cost_.at(k);
    Add<TermResidual>(terms.turn, k, k - 1, &turn_);
    Add<TermResidual>(terms.turn_excess, k, k - 1, &turn_excess_);
    Add<TermResidual>(terms.step, k, k - 2, &step_);
    Add<TermResidual>(terms.step_excess, k, k - 2, &step_excess_);
  }
  const int others = problem_.NumResidualBlocks();
  for (int k = 1; k <= last; ++k) Add<MapResidual>(cost_.at(k).map, k, k - 1, nullptr);
  map_terms_ = problem_.NumResidualBlocks() - others;
}

template <typename Residual>
void LeastSquares::Add(const Term& term, int k, int from, ceres::LossFunction* loss) {
  const int first = std::max(from, kFirstFree);
  const int blocks = std::min(k + 2, path_.free_end()) - first;
  if (blocks <= 0) return;
  double* offsets[4] = {};
  for (int i = 0; i < blocks; ++i) offsets[i] = path_.offsets_m() + first + i;
  problem_.AddResidualBlock(
      new Residual(term, 2 * (first - k + 2), blocks, path_.normals() + 2 * first), loss, offsets,
      blocks);
}

// --- one function
// ---------------------------------------------------------------------------------

class WholeCost : public ceres::FirstOrderFunction {
 public:
  WholeCost(const Costmap& map, const OptimizerParams& params, float start_curvature_per_m,
            MovedPath& path)
      : path_(path),
        cost_(map, params, path.points(), start_curvature_per_m),
        roundings_(params),
        by_(Count(2 * path.points() + 4)) {}

  int NumParameters() const override { return path_.free_points(); }
  bool Evaluate(const double* offsets, double* value, double* gradient) const override;

 private:
  // Adds one term of point k to the derivatives, and returns its share of F.
  double Add(const Term& term, int k, Rounding rounding) const {
    AddSlope(term, k, rounding.weight * term.value / rounding.Size(term.value * term.value));
    return rounding.Of(term.value);
  }
  void AddSlope(const Term& term, int k, double factor) const {
    double* const by = by_.data() + 2 * (k - 1);
    for (int i = 0; i < 8; ++i) by[i] += factor * term.by[i];
  }

  // Ceres calls a constant function; all of this is scratch of one call.
  MovedPath& path_;
  mutable RoundedCost cost_;
  Roundings roundings_;
  mutable std::vector<double> by_;  // [points + 2, x 2], of points -1 to points
};

bool WholeCost::Evaluate(const double* offsets, double* value, double* gradient) const {
  std::copy(offsets, offsets + NumParameters(), path_.offsets_m() + kFirstFree);
  path_.Place();
  cost_.Find(path_.positions_m(), gradient != nullptr);
  std::fill(by_.begin(), by_.end(), 0.0);
  const int last = path_.points() - 1;
  double sum = cost_.first_map_term();
  for (int k = 1; k < last; ++k) {
    const PointTerms& terms = cost_.at(k);
    sum += terms.map.value + Add(terms.turn, k, roundings_.turn) +
           Add(terms.turn_excess, k, roundings_.turn_excess) + Add(terms.step, k, roundings_.step) +
           Add(terms.step_excess, k, roundings_.step_excess);
    AddSlope(terms.map, k, 1.0);
  }
  sum += cost_.at(last).map.value;
  AddSlope(cost_.at(last).map, last, 1.0);
  *value = sum;
  if (gradient == nullptr) return true;
  for (int k = kFirstFree; k < path_.free_end(); ++k) {
    const double* const by = by_.data() + 2 * (k + 1);
    const double* const normal = path_.normals() + 2 * k;
    gradient[k - kFirstFree] = by[0] * normal[0] + by[1] * normal[1];
  }
  return true;
}

// --------------------------------------------------------------------------------------------------

bool IsUsableSeed(const WorldPath& seed, float start_curvature_per_m) {
  if (seed.size() < kMinPoints || !IsFinite(start_curvature_per_m)) return false;
  if (!IsFinite(seed[0])) return false;
  for (int k = 1; k < seed.size(); ++k) {
    const Vec2 chord = {seed[k].x_m - seed[k - 1].x_m, seed[k].y_m - seed[k - 1].y_m};
    const float length_m = Length(chord);
    if (!IsFinite(length_m) || length_m < cost_terms::kShortestChord_m) return false;
  }
  return true;
}

template <typename Summary>
void Report(const Summary& summary, CeresResult& result) {
  result.usable = summary.IsSolutionUsable();
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.iterations = static_cast<int32_t>(summary.iterations.size()) - 1;
}

void SolveSquares(ceres::Problem& problem, int max_iterations, CeresResult& result) {
  ceres::Solver::Options options;
  options.max_num_iterations = max_iterations;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.initial_trust_region_radius = kTrustRegionRadius;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Report(summary, result);
}

void SolveWhole(const ceres::GradientProblem& problem, int max_iterations, MovedPath& path,
                CeresResult& result) {
  ceres::GradientProblemSolver::Options options;
  options.max_num_iterations = max_iterations;
  options.logging_type = ceres::SILENT;
  std::vector<double> offsets(Count(problem.NumParameters()), 0.0);
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, offsets.data(), &summary);
  std::copy(offsets.begin(), offsets.end(), path.offsets_m() + kFirstFree);
  Report(summary, result);
}

// Keeps a solution, evenly spread if that lowers F: points crowd on the inside of a bend, where the
// turns between them are lost in single precision.
void Keep(const Costmap& map, const OptimizerParams& params, const MovedPath& moved,
          float start_curvature_per_m, bool keep_end_heading, CeresResult& result) {
  moved.CopyTo(result.path);
  result.after = CostOf(map, params, result.path, start_curvature_per_m);
  const WorldPath spread = Spread(result.path, keep_end_heading);
  const PathCost spread_cost = CostOf(map, params, spread, start_curvature_per_m);
  if (spread_cost.total() < result.after.total()) {
    result.path = spread;
    result.after = spread_cost;
  }
}

}  // namespace

CeresResult Smooth(CeresMethod method, const Costmap& map, const OptimizerParams& params,
                   const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading,
                   int max_iterations) {
  CeresResult result;
  result.path = seed;
  if (!IsUsableSeed(seed, start_curvature_per_m)) return result;
  result.before = CostOf(map, params, seed, start_curvature_per_m);
  result.after = result.before;
  MovedPath path(seed, keep_end_heading);
  if (path.free_points() <= 0) return result;
  if (method == CeresMethod::kTrustRegion) {
    LeastSquares squares(map, params, start_curvature_per_m, path);
    SolveSquares(squares.problem(), max_iterations, result);
  } else {
    const ceres::GradientProblem problem(new WholeCost(map, params, start_curvature_per_m, path));
    SolveWhole(problem, max_iterations, path, result);
  }
  if (!result.usable) return result;
  path.Place();
  Keep(map, params, path, start_curvature_per_m, keep_end_heading, result);
  return result;
}

CeresObjective ObjectiveOf(CeresMethod method, const Costmap& map, const OptimizerParams& params,
                           const WorldPath& seed, float start_curvature_per_m,
                           bool keep_end_heading, std::span<const double> offsets_m) {
  CeresObjective objective;
  if (!IsUsableSeed(seed, start_curvature_per_m)) return objective;
  MovedPath path(seed, keep_end_heading);
  if (path.free_points() <= 0 || offsets_m.size() != Count(path.free_points())) return objective;
  objective.gradient_per_m.resize(offsets_m.size());
  if (method == CeresMethod::kLineSearch) {
    const WholeCost whole(map, params, start_curvature_per_m, path);
    whole.Evaluate(offsets_m.data(), &objective.value, objective.gradient_per_m.data());
    return objective;
  }
  std::copy(offsets_m.begin(), offsets_m.end(), path.offsets_m() + kFirstFree);
  LeastSquares squares(map, params, start_curvature_per_m, path);
  squares.problem().Evaluate({}, &objective.value, nullptr, &objective.gradient_per_m, nullptr);
  objective.value -= squares.constant();
  return objective;
}

}  // namespace hardpack::peers
