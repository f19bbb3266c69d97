// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/rounded_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace hardpack::peers {
namespace {

// The indices of the points k - 1, k and k + 1 in Term::by.
constexpr int kBefore = 2;
constexpr int kHere = 4;
constexpr int kAfter = 6;

// max(0, |a| - limit b), the part of |a| beyond a limit.
void FindExcess(const Term& a, double limit, const Term& b, bool derivatives, Term& excess) {
  const double beyond = std::abs(a.value) - limit * b.value;
  excess.value = std::max(0.0, beyond);
  if (!derivatives) return;
  const double sign = a.value < 0.0 ? -1.0 : 1.0;
  for (int i = 0; i < 8; ++i) excess.by[i] = beyond > 0.0 ? sign * a.by[i] - limit * b.by[i] : 0.0;
}

}  // namespace

RoundedCost::RoundedCost(const Costmap& map, const OptimizerParams& params, int points,
                         float start_curvature_per_m)
    : map_(map),
      params_(params),
      points_(points),
      start_curvature_per_m_(start_curvature_per_m),
      terms_(static_cast<size_t>(points)) {}

void RoundedCost::Find(const double* points, bool derivatives) {
  const auto chord_from = [points](int k) {
    const double x = points[2 * k + 2] - points[2 * k];
    const double y = points[2 * k + 3] - points[2 * k + 1];
    return Chord{x, y, std::sqrt(x * x + y * y)};
  };
  Chord in = chord_from(0);
  first_map_term_ = 0.5 * in.length * SampleAt(points[0], points[1]).cost;
  Corner corners[2];
  corners[0].curvature.value = start_curvature_per_m_;
  for (int k = 1; k < points_ - 1; ++k) {
    PointTerms& terms = terms_[static_cast<size_t>(k)];
    Corner& corner = corners[k % 2];
    const Chord out = chord_from(k);
    FindCorner(in, out, derivatives, corner, terms);
    FindMapTerm(SampleAt(points[2 * k], points[2 * k + 1]), corner.ds, derivatives, terms.map);
    FindStep(corners[1 - k % 2], corner, derivatives, terms);
    in = out;
  }
  const int last = points_ - 1;
  Term ds;
  ds.value = 0.5 * in.length;
  ds.by[kHere] = 0.5 * in.x / in.length;
  ds.by[kHere + 1] = 0.5 * in.y / in.length;
  ds.by[kBefore] = -ds.by[kHere];
  ds.by[kBefore + 1] = -ds.by[kHere + 1];
  FindMapTerm(SampleAt(points[2 * last], points[2 * last + 1]), ds, derivatives,
              terms_[static_cast<size_t>(last)].map);
}

// As Costmap::CostAt, with its slope; beyond the outermost centres it has none.
RoundedCost::Sample RoundedCost::SampleAt(double x_m, double y_m) const {
  constexpr double kLast = kMapSize_cells - 1;
  const double u = x_m * kCellsPerMeter - map_.window.origin.x - 0.5;
  const double v = y_m * kCellsPerMeter - map_.window.origin.y - 0.5;
  const double column = u > 0.0 ? std::min(u, kLast) : 0.0;
  const double row = v > 0.0 ? std::min(v, kLast) : 0.0;
  const int x = std::min(static_cast<int>(column), kMapSize_cells - 2);
  const int y = std::min(static_cast<int>(row), kMapSize_cells - 2);
  const double across = column - x;
  const double along = row - y;
  const uint16_t* const low = map_.cost_q8 + y * kMapSize_cells + x;
  const uint16_t* const high = low + kMapSize_cells;
  const double low_slope = low[1] - low[0];
  const double high_slope = high[1] - high[0];
  const double low_q8 = low[0] + low_slope * across;
  const double high_q8 = high[0] + high_slope * across;
  constexpr double kOne = 1.0 / kCostOne_q8;
  const double x_slope = low_slope + (high_slope - low_slope) * along;
  const double y_slope = high_q8 - low_q8;
  return {(low_q8 + y_slope * along) * kOne,
          {u == column ? x_slope * kOne * kCellsPerMeter : 0.0,
           v == row ? y_slope * kOne * kCellsPerMeter : 0.0}};
}

void RoundedCost::FindCorner(const Chord& in, const Chord& out, bool derivatives, Corner& corner,
                             PointTerms& terms) const {
  Term& turn = terms.turn;
  turn.value = std::atan2(in.x * out.y - in.y * out.x, in.x * out.x + in.y * out.y);
  corner.ds.value = 0.5 * (in.length + out.length);
  corner.curvature.value = turn.value / corner.ds.value;
  if (derivatives) {
    // The turn is out's direction less in's; a direction turns by what crosses it over its length.
    const double in2 = 1.0 / (in.length * in.length);
    const double out2 = 1.0 / (out.length * out.length);
    const double in_by[2] = {in.y * in2, -in.x * in2};  // of minus the direction
    const double out_by[2] = {-out.y * out2, out.x * out2};
    const double in_unit[2] = {0.5 * in.x / in.length, 0.5 * in.y / in.length};
    const double out_unit[2] = {0.5 * out.x / out.length, 0.5 * out.y / out.length};
    for (int i = 0; i < 2; ++i) {
      turn.by[kBefore + i] = -in_by[i];
      turn.by[kHere + i] = in_by[i] - out_by[i];
      turn.by[kAfter + i] = out_by[i];
      corner.ds.by[kBefore + i] = -in_unit[i];
      corner.ds.by[kHere + i] = in_unit[i] - out_unit[i];
      corner.ds.by[kAfter + i] = out_unit[i];
    }
    const double per_ds = 1.0 / corner.ds.value;
    for (int i = kBefore; i < 8; ++i) {
      corner.curvature.by[i] = (turn.by[i] - corner.curvature.value * corner.ds.by[i]) * per_ds;
    }
  }
  FindExcess(turn, params_.max_curvature_per_m, corner.ds, derivatives, terms.turn_excess);
}

void RoundedCost::FindMapTerm(const Sample& sample, const Term& ds, bool derivatives,
                              Term& term) const {
  term.value = ds.value * sample.cost;
  if (!derivatives) return;
  for (int i = kBefore; i < 8; ++i) term.by[i] = ds.by[i] * sample.cost;
  term.by[kHere] += ds.value * sample.by[0];
  term.by[kHere + 1] += ds.value * sample.by[1];
}

// `before` is the corner at the point before, or at the first point the vehicle's own curvature,
// which depends on nothing.
void RoundedCost::FindStep(const Corner& before, const Corner& corner, bool derivatives,
                           PointTerms& terms) const {
  terms.step.value = corner.curvature.value - before.curvature.value;
  if (derivatives) {
    for (int i = 0; i < 8; ++i) {
      const double of_before = i + 2 < 8 ? before.curvature.by[i + 2] : 0.0;
      terms.step.by[i] = corner.curvature.by[i] - of_before;
    }
  }
  FindExcess(terms.step, params_.max_curvature_rate_per_m2, corner.ds, derivatives,
             terms.step_excess);
}

}  // namespace hardpack::peers
