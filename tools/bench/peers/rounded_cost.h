// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "config/parameters.h"
#include "core/costmap/costmap.h"

// The terms of F (core/optimizer/optimizer.h) in double precision with their analytic derivatives,
// separated so that a solver for smooth functions can combine them: with
//   ds f(kappa)  = alpha  |phi|         + (beta  - alpha)  max(0, |phi|         - kappa_max  ds)
//   ds f(kappa') = alpha' |delta kappa| + (beta' - alpha') max(0, |delta kappa| - kappa'_max ds)
// F is a sum of positive weights times the magnitudes of five numbers per point: ds cost, the turn
// phi, its excess, the change of curvature, its excess.

namespace hardpack::peers {

// A number and its derivative by x and y of four points of the path.
struct Term {
  double value = 0.0;
  double by[8] = {};
};

// The terms at one point k; `by` of points k - 2, k - 1, k, k + 1.
struct PointTerms {
  Term map;  // ds cost [m]
  Term turn;
  Term turn_excess;
  Term step;  // of the curvature, kappa_k - kappa_{k-1}
  Term step_excess;
};

class RoundedCost {
 public:
  // For a path with that many points.
  RoundedCost(const Costmap& map, const OptimizerParams& params, int points,
              float start_curvature_per_m);

  // Computes the terms of the path through `points` ([points x 2], x and y) from its point 1 on;
  // without derivatives unless requested. The last point has only a map term.
  void Find(const double* points, bool derivatives);

  int points() const { return points_; }
  const PointTerms& at(int k) const { return terms_[static_cast<size_t>(k)]; }

  // ds_0 cost(p_0), which no free point changes.
  double first_map_term() const { return first_map_term_; }

 private:
  struct Sample {
    double cost;
    double by[2];
  };
  struct Chord {
    double x;
    double y;
    double length;
  };
  // A turn's curvature; `by` of points k - 2 .. k + 1, as in PointTerms.
  struct Corner {
    Term ds;
    Term curvature;
  };

  Sample SampleAt(double x_m, double y_m) const;
  void FindCorner(const Chord& in, const Chord& out, bool derivatives, Corner& corner,
                  PointTerms& terms) const;
  void FindMapTerm(const Sample& sample, const Term& ds, bool derivatives, Term& term) const;
  void FindStep(const Corner& before, const Corner& corner, bool derivatives,
                PointTerms& terms) const;

  const Costmap& map_;
  const OptimizerParams& params_;
  int points_;
  double start_curvature_per_m_;
  double first_map_term_ = 0.0;
  std::vector<PointTerms> terms_;
};

}  // namespace hardpack::peers
