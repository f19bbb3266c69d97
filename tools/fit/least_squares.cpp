// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/least_squares.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hardpack::fit {
namespace {

using Vector = std::vector<double>;

double CostOf(const Vector& residuals) {
  double sum = 0.0;
  for (const double residual : residuals) sum += residual * residual;
  return 0.5 * sum;
}

// Normal equations in units of each variable's step: [n x n] row-major, and [n].
struct Normal {
  Vector matrix;
  Vector gradient;
};

// Solves a positive definite system by Cholesky's decomposition; false when it is not definite.
bool Solve(Vector matrix, const Vector& right, Vector& x) {
  const size_t n = right.size();
  for (size_t i = 0; i < n; ++i) {
    for (size_t j = 0; j <= i; ++j) {
      double sum = matrix[i * n + j];
      for (size_t k = 0; k < j; ++k) sum -= matrix[i * n + k] * matrix[j * n + k];
      if (i != j) {
        matrix[i * n + j] = sum / matrix[j * n + j];
      } else if (sum > 0.0) {
        matrix[i * n + i] = std::sqrt(sum);
      } else {
        return false;
      }
    }
  }
  x = right;
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = 0; k < i; ++k) x[i] -= matrix[i * n + k] * x[k];
    x[i] /= matrix[i * n + i];
  }
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; ++k) x[i] -= matrix[k * n + i] * x[k];
    x[i] /= matrix[i * n + i];
  }
  return true;
}

class Search {
 public:
  Search(const Residuals& residuals, const std::vector<Variable>& variables)
      : residuals_(residuals), variables_(variables) {
    for (const Variable& variable : variables) {
      best_.x.push_back(std::clamp(variable.start, variable.low, variable.high));
    }
    best_.cost = CostOf(Evaluate(best_.x));
  }

  // False when nothing is left to gain.
  bool Improve() {
    constexpr int kTrials = 8;
    constexpr double kEnough = 1.0e-6;
    const Normal normal = NormalEquations();
    for (int trial = 0; trial < kTrials; ++trial) {
      const Vector x = Trial(normal);
      const double cost = CostOf(Evaluate(x));
      if (cost < best_.cost) {
        const bool goes_on = best_.cost - cost > kEnough * best_.cost;
        best_.x = x;
        best_.cost = cost;
        damping_ = std::max(0.2 * damping_, 1.0e-9);
        return goes_on;
      }
      damping_ *= 5.0;
    }
    return false;
  }

  const LeastSquares& best() const { return best_; }

 private:
  Vector Evaluate(const Vector& x) {
    Vector residuals;
    residuals_(x, residuals);
    ++best_.evaluations;
    return residuals;
  }

  Normal NormalEquations() {
    const size_t n = variables_.size();
    const Vector here = Evaluate(best_.x);
    std::vector<Vector> columns(n);
    for (size_t i = 0; i < n; ++i) {
      Vector x = best_.x;
      x[i] = std::min(best_.x[i] + variables_[i].step, variables_[i].high);
      columns[i] = Evaluate(x);
      const double high = x[i];
      x[i] = std::max(best_.x[i] - variables_[i].step, variables_[i].low);
      const Vector below = Evaluate(x);
      const double scale = variables_[i].step / (high - x[i]);
      for (size_t k = 0; k < here.size(); ++k) columns[i][k] = (columns[i][k] - below[k]) * scale;
    }
    Normal normal{Vector(n * n, 0.0), Vector(n, 0.0)};
    for (size_t i = 0; i < n; ++i) {
      for (size_t k = 0; k < here.size(); ++k) normal.gradient[i] += columns[i][k] * here[k];
      for (size_t j = 0; j <= i; ++j) {
        double sum = 0.0;
        for (size_t k = 0; k < here.size(); ++k) sum += columns[i][k] * columns[j][k];
        normal.matrix[i * n + j] = sum;
        normal.matrix[j * n + i] = sum;
      }
    }
    return normal;
  }

  Vector Trial(const Normal& normal) const {
    const size_t n = variables_.size();
    Vector matrix = normal.matrix;
    Vector right(n);
    for (size_t i = 0; i < n; ++i) {
      matrix[i * n + i] += damping_ * normal.matrix[i * n + i] + 1.0e-12;
      right[i] = -normal.gradient[i];
    }
    Vector change(n, 0.0);
    Vector x = best_.x;
    if (!Solve(std::move(matrix), right, change)) return x;
    for (size_t i = 0; i < n; ++i) {
      x[i] =
          std::clamp(x[i] + change[i] * variables_[i].step, variables_[i].low, variables_[i].high);
    }
    return x;
  }

  const Residuals& residuals_;
  const std::vector<Variable>& variables_;
  LeastSquares best_;
  double damping_ = 1.0e-2;
};

}  // namespace

LeastSquares Minimize(const Residuals& residuals, const std::vector<Variable>& variables,
                      int max_iterations) {
  Search search(residuals, variables);
  for (int i = 0; i < max_iterations; ++i) {
    if (!search.Improve()) break;
  }
  return search.best();
}

}  // namespace hardpack::fit
