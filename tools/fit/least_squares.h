// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

// Small nonlinear least squares with bounds: Levenberg (1944), Marquardt (1963), with the Jacobian
// by central differences of the residuals. For tens of variables; the number of steps is bounded.

namespace hardpack::fit {

struct Variable {
  double start = 0.0;
  double low = 0.0;
  double high = 1.0;
  double step = 1.0e-3;  // of the differences; also the scale of a small change
};

// Fills `residuals`; their number is the same for every x.
using Residuals = std::function<void(const std::vector<double>& x, std::vector<double>& residuals)>;

struct LeastSquares {
  std::vector<double> x;
  double cost = 0.0;  // half the sum of squares
  int evaluations = 0;
};

// At most max_iterations Jacobians, each followed by at most 8 trials; ends earlier if the cost
// falls by less than 1e-6 of itself. The cost never exceeds that of the start.
LeastSquares Minimize(const Residuals& residuals, const std::vector<Variable>& variables,
                      int max_iterations);

}  // namespace hardpack::fit
