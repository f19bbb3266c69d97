// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/optimizer/branch_free.h"
#include "core/optimizer/cost_terms.h"
#include "core/optimizer/lateral_newton.h"
#include "core/optimizer/map_samples.h"

// What a Newton step is made from: F of a line, its derivatives, and the band's solution. Each pass
// is over arrays, so that it is vectorised.

namespace hardpack {
namespace {

// The limit of the rounded terms lies before the real one, so that what is rounded off does not
// exceed it.
constexpr float kLimitShare = 0.99f;

// Half a cell to either side of a point the map is sampled for its derivatives.
constexpr float kSample_m = 0.5f * kCellSize_m;

// The angle of half_cross / half_dot, doubled: the turn between unit chords whose cross product and
// 1 + dot product, both halved, these are. |turn| up to 135 degrees to 1e-6, from there on roughly:
// only where a path folds back. No branch, so that it is vectorised.
float TurnOf(float half_cross, float half_dot) {
  constexpr float kTanPiOver8 = 0.41421356f;
  constexpr float kHalfTurn = 1.0e-7f;  // no division by zero where the path folds back
  const float y = branch_free::Magnitude(half_cross);
  const float x = branch_free::NotBelowZero(half_dot) + kHalfTurn;
  // Beyond: atan(y / x) = pi / 4 + atan((y - x) / (y + x)).
  const bool beyond = y > kTanPiOver8 * x;
  const float ratio = (y - branch_free::KeptIf(beyond, x)) / (x + branch_free::KeptIf(beyond, y));
  const float s = ratio * ratio;
  // atan(r) / r interpolated on [0, tan(pi / 8)].
  const float series =
      -0.33333331f + s * (0.19999540f + s * (-0.14263956f + s * (0.10743731f - s * 0.0645192f)));
  const float angle = branch_free::KeptIf(beyond, 0.25f * kPi) + (ratio + ratio * s * series);
  return branch_free::WithSignOf(half_cross, 2.0f * angle);
}

float TermOf(float value, float alpha, float beta, float max) {
  const float size = Abs(value);
  return alpha * size + (beta - alpha) * Max(size - max, 0.0f);
}

}  // namespace

// F of a line but for the rounding, and all that its derivatives need. Not a number where a chord
// is shorter than a seed's may be: what comes behind would take it for a turn on the spot.
float LateralNewton::CostOfLine(const Costmap& map, Line& line) const {
  MeasureChords(line);
  MeasureCurvatures(line);
  const int points = line.points;
  SampleCosts(map, line.x_m, line.y_m, points, line.map_cost);
  const OptimizerParams params = params_;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points; ++k) {
    line.path_cost[k] = TermOf(line.curvature_per_m[k], params.curvature_alpha,
                               params.curvature_beta, params.max_curvature_per_m) +
                        TermOf(line.rate_per_m2[k], params.curvature_rate_alpha,
                               params.curvature_rate_beta, params.max_curvature_rate_per_m2);
  }
  line.path_cost[0] = 0.0f;
  line.path_cost[points - 1] = 0.0f;
  float cost = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points; ++k) cost += line.ds_m[k] * (line.map_cost[k] + line.path_cost[k]);
  if (!places_.place_odom.empty()) cost += CostOfPlaces(line);
  float shortest_m = line.length_m[0];
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k + 1 < points; ++k) shortest_m = Min(shortest_m, line.length_m[k]);
  return shortest_m >= cost_terms::kShortestChord_m ? cost
                                                    : std::numeric_limits<float>::quiet_NaN();
}

// In order: a place's point lies behind that of the place before.
float LateralNewton::CostOfPlaces(Line& line) const {
  const int last = line.points - 1 - end_points_;
  int from = 2;
  float cost = 0.0f;
  HP_LOOP_BOUND(kMaxVias)
  for (int i = 0; i < places_.place_odom.size(); ++i) {
    const Vec2 place = places_.place_odom[i];
    int nearest = -1;
    float least2_m2 = 0.0f;
    HP_LOOP_BOUND(kMaxPathPoints)
    for (int k = from; k <= last; ++k) {
      const float dx_m = line.x_m[k] - place.x_m;
      const float dy_m = line.y_m[k] - place.y_m;
      const float distance2_m2 = dx_m * dx_m + dy_m * dy_m;
      if (nearest >= 0 && distance2_m2 >= least2_m2) continue;
      nearest = k;
      least2_m2 = distance2_m2;
    }
    line.passing_point[i] = nearest;
    if (nearest < 0) break;
    const float excess_m = Max(SqrtUnchecked(least2_m2) - places_.radius_m, 0.0f);
    cost += PassingPlaces::kWeight_per_m2 * excess_m * excess_m;
    from = nearest;
  }
  return cost;
}

// Along the points' normals. The second derivative without the part that is negative inside.
void LateralNewton::DerivePlaces() {
  const Line& line = this->line();
  HP_LOOP_BOUND(kMaxVias)
  for (int i = 0; i < places_.place_odom.size(); ++i) {
    const int k = line.passing_point[i];
    if (k < 0) return;
    const float dx_m = line.x_m[k] - places_.place_odom[i].x_m;
    const float dy_m = line.y_m[k] - places_.place_odom[i].y_m;
    const float distance_m = SqrtUnchecked(dx_m * dx_m + dy_m * dy_m);
    if (distance_m <= places_.radius_m) continue;
    const float normal_x = -0.5f * (line.chord_y[k - 1] + line.chord_y[k]);
    const float normal_y = 0.5f * (line.chord_x[k - 1] + line.chord_x[k]);
    const float away = (dx_m * normal_x + dy_m * normal_y) / distance_m;
    const float twice = 2.0f * PassingPlaces::kWeight_per_m2;
    step_m_[k] += twice * (distance_m - places_.radius_m) * away;
    band_[0][k] += twice * away * away;
  }
}

void LateralNewton::MeasureChords(Line& line) {
  const int chords = line.points - 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < chords; ++k) {
    const float dx = line.x_m[k + 1] - line.x_m[k];
    const float dy = line.y_m[k + 1] - line.y_m[k];
    const float length_m = SqrtUnchecked(dx * dx + dy * dy);
    const float inverse_per_m = 1.0f / length_m;
    line.length_m[k] = length_m;
    line.inverse_length_per_m[k] = inverse_per_m;
    line.chord_x[k] = dx * inverse_per_m;
    line.chord_y[k] = dy * inverse_per_m;
  }
}

void LateralNewton::MeasureCurvatures(Line& line) const {
  const int last = line.points - 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < last; ++k) {
    const float cross =
        line.chord_x[k - 1] * line.chord_y[k] - line.chord_y[k - 1] * line.chord_x[k];
    const float dot = line.chord_x[k - 1] * line.chord_x[k] + line.chord_y[k - 1] * line.chord_y[k];
    const float ds_m = 0.5f * (line.length_m[k - 1] + line.length_m[k]);
    const float inverse_per_m = 1.0f / ds_m;
    line.half_cross[k] = 0.5f * cross;
    line.half_dot[k] = 0.5f + 0.5f * dot;
    line.ds_m[k] = ds_m;
    line.inverse_ds_per_m[k] = inverse_per_m;
    line.curvature_per_m[k] = TurnOf(0.5f * cross, 0.5f + 0.5f * dot) * inverse_per_m;
  }
  line.curvature_per_m[0] = start_curvature_per_m_;
  line.half_cross[0] = 0.0f;
  line.half_cross[last] = 0.0f;
  line.half_dot[0] = 1.0f;
  line.half_dot[last] = 1.0f;
  line.ds_m[0] = 0.5f * line.length_m[0];
  line.ds_m[last] = 0.5f * line.length_m[last - 1];
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < last; ++k) {
    line.rate_per_m2[k] =
        (line.curvature_per_m[k] - line.curvature_per_m[k - 1]) * line.inverse_ds_per_m[k];
  }
}

void LateralNewton::Derive(const Costmap& map) {
  DeriveMap(map);
  DeriveCurvatures();
  Assemble();
  phase_ = Phase::kSolve;
}

// A point's normal is half the sum of the unit chords that meet there, turned to the left: not of
// length 1 where the path bends, and all that is derived by offsets along it is right nevertheless.
void LateralNewton::DeriveMap(const Costmap& map) {
  const Line& line = this->line();
  const int last = line.points - 1;
  constexpr float kHalfInverse = 0.5f / kSample_m;
  constexpr float kInverse2 = 1.0f / (kSample_m * kSample_m);
  Line& aside = trial();
  HP_LOOP_BOUND(2)
  for (int side = 0; side < 2; ++side) {
    const float half_m = side == 0 ? 0.5f * kSample_m : -0.5f * kSample_m;
    HP_LOOP_BOUND(kMaxPathPoints)
    for (int k = 1; k < last; ++k) {
      aside.x_m[k] = line.x_m[k] - half_m * (line.chord_y[k - 1] + line.chord_y[k]);
      aside.y_m[k] = line.y_m[k] + half_m * (line.chord_x[k - 1] + line.chord_x[k]);
    }
    SampleCosts(map, aside.x_m, aside.y_m, last, side == 0 ? aside.map_cost : aside.path_cost);
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < last; ++k) {
    const float left = aside.map_cost[k];
    const float right = aside.path_cost[k];
    const float here = line.map_cost[k];
    map_slope_[k] = (left - right) * kHalfInverse;
    map_bend_[k] = branch_free::NotBelowZero((left - here) + (right - here)) * kInverse2;
  }
}

// With e the offsets, w = half_dot, s = half_cross and l the lengths of the chords:
//   d turn_k = w_{k-1} e_{k-1} / l_{k-1} - w_k e_k (1 / l_{k-1} + 1 / l_k) + w_{k+1} e_{k+1} / l_k
//   d ds_k   = -(s_{k-1} e_{k-1} + 2 s_k e_k + s_{k+1} e_{k+1}) / 2
//   d kappa_k = (d turn_k - kappa_k d ds_k) / ds_k
//   d kappa'_k = (d kappa_k - d kappa_{k-1} - kappa'_k d ds_k) / ds_k
void LateralNewton::DeriveCurvatures() {
  const Line& line = this->line();
  const int last = line.points - 1;
  // None at the ends; and what an earlier, longer path left behind them may be no number.
  HP_LOOP_BOUND(3)
  for (auto& row : by_offset_) {
    row[0] = 0.0f;
    row[last] = 0.0f;
  }
  HP_LOOP_BOUND(4)
  for (auto& row : rate_by_offset_) {
    row[last] = 0.0f;
    row[last + 1] = 0.0f;
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < last; ++k) {
    const float before_per_m = line.inverse_length_per_m[k - 1];
    const float behind_per_m = line.inverse_length_per_m[k];
    const float curvature_per_m = line.curvature_per_m[k];
    const float inverse_per_m = line.inverse_ds_per_m[k];
    by_offset_[0][k] =
        (line.half_dot[k - 1] * before_per_m + 0.5f * curvature_per_m * line.half_cross[k - 1]) *
        inverse_per_m;
    by_offset_[1][k] =
        (curvature_per_m * line.half_cross[k] - line.half_dot[k] * (before_per_m + behind_per_m)) *
        inverse_per_m;
    by_offset_[2][k] =
        (line.half_dot[k + 1] * behind_per_m + 0.5f * curvature_per_m * line.half_cross[k + 1]) *
        inverse_per_m;
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < last; ++k) {
    const float inverse_per_m = line.inverse_ds_per_m[k];
    const float rate_per_m2 = line.rate_per_m2[k];
    rate_by_offset_[0][k] = -by_offset_[0][k - 1] * inverse_per_m;
    rate_by_offset_[1][k] =
        (by_offset_[0][k] - by_offset_[1][k - 1] + 0.5f * rate_per_m2 * line.half_cross[k - 1]) *
        inverse_per_m;
    rate_by_offset_[2][k] =
        (by_offset_[1][k] - by_offset_[2][k - 1] + rate_per_m2 * line.half_cross[k]) *
        inverse_per_m;
    rate_by_offset_[3][k] =
        (by_offset_[2][k] + 0.5f * rate_per_m2 * line.half_cross[k + 1]) * inverse_per_m;
  }
  const float curvature_max = params_.max_curvature_per_m;
  const float rate_max = params_.max_curvature_rate_per_m2;
  const Kink curvature = {params_.curvature_alpha, params_.curvature_beta - params_.curvature_alpha,
                          kLimitShare * curvature_max, width_share_ * curvature_max, caution_};
  const Kink rate = {params_.curvature_rate_alpha,
                     params_.curvature_rate_beta - params_.curvature_rate_alpha,
                     kLimitShare * rate_max, width_share_ * rate_max, caution_};
  DeriveTerm(curvature, line.curvature_per_m, line.ds_m, line.points, slope_, bend_);
  DeriveTerm(rate, line.rate_per_m2, line.ds_m, line.points, rate_slope_, rate_bend_);
}

// |v| is rounded off to sqrt(v^2 + width^2), at 0 and at the limit. Its second derivative is taken
// between the true one, width^2 / size^3, which is blind to a kink that the step will cross, and
// 1 / size, which is that of the parabola that touches |v| at v and -v, and too careful.
void LateralNewton::DeriveTerm(const Kink& kink, const float* value, const float* ds_m, int points,
                               float* slope, float* bend) {
  const float width2 = kink.width * kink.width;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < points - 1; ++k) {
    const float size = Abs(value[k]);
    const float excess = size - kink.max;
    const float inverse = 1.0f / SqrtUnchecked(size * size + width2);
    const float inverse_excess = 1.0f / SqrtUnchecked(excess * excess + width2);
    const float steeper = 0.5f * kink.steeper;
    const float rise = kink.alpha * size * inverse + steeper * (1.0f + excess * inverse_excess);
    slope[k] = ds_m[k] * (value[k] < 0.0f ? -rise : rise);
    bend[k] = ds_m[k] * (kink.alpha * (kink.width + kink.caution * size) * inverse * inverse +
                         steeper * (kink.width + kink.caution * Abs(excess)) * inverse_excess *
                             inverse_excess);
  }
  slope[0] = 0.0f;
  bend[0] = 0.0f;
  HP_LOOP_BOUND(3)
  for (int k = points - 1; k < points + 2; ++k) {
    slope[k] = 0.0f;
    bend[k] = 0.0f;
  }
}

// Each curvature adds slope_ times its derivatives to the gradient, and bend_ times their products
// to the band; its rate too. Gathered by point, so that it is vectorised.
void LateralNewton::Assemble() {
  const Line& line = this->line();
  const int last = last_free();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= last; ++k) {
    const float before = line.map_cost[k - 1] + line.path_cost[k - 1];
    const float here = line.map_cost[k] + line.path_cost[k];
    const float behind = line.map_cost[k + 1] + line.path_cost[k + 1];
    step_m_[k] =
        line.ds_m[k] * map_slope_[k] - 0.5f * line.half_cross[k] * (before + 2.0f * here + behind);
    band_[0][k] = line.ds_m[k] * map_bend_[k];
  }
  const auto& j = by_offset_;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= last; ++k) {
    const float before = bend_[k - 1] * j[2][k - 1];
    const float here = bend_[k] * j[1][k];
    step_m_[k] += slope_[k - 1] * j[2][k - 1] + slope_[k] * j[1][k] + slope_[k + 1] * j[0][k + 1];
    band_[0][k] += before * j[2][k - 1] + here * j[1][k] + bend_[k + 1] * j[0][k + 1] * j[0][k + 1];
    band_[1][k] = before * j[1][k - 1] + here * j[0][k];
    band_[2][k] = before * j[0][k - 1];
  }
  const auto& q = rate_by_offset_;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= last; ++k) {
    const float before = rate_bend_[k - 1] * q[3][k - 1];
    const float here = rate_bend_[k] * q[2][k];
    const float behind = rate_bend_[k + 1] * q[1][k + 1];
    step_m_[k] += rate_slope_[k - 1] * q[3][k - 1] + rate_slope_[k] * q[2][k] +
                  rate_slope_[k + 1] * q[1][k + 1] + rate_slope_[k + 2] * q[0][k + 2];
    band_[0][k] += before * q[3][k - 1] + here * q[2][k] + behind * q[1][k + 1] +
                   rate_bend_[k + 2] * q[0][k + 2] * q[0][k + 2];
    band_[1][k] += before * q[2][k - 1] + here * q[1][k] + behind * q[0][k + 1];
    band_[2][k] += before * q[1][k - 1] + here * q[0][k];
    band_[3][k] = before * q[0][k - 1];
  }
  DerivePlaces();
}

// L D L^T = band + damping, and step = L^-1 (-gradient). False: rounding, or a map that is no
// number, leaves a pivot that is not positive.
bool LateralNewton::Factor() {
  const int last = last_free();
  // Rows before the first count as far away.
  HP_LOOP_BOUND(2)
  for (int k = 0; k < 2; ++k) {
    lower_[0][k] = 0.0f;
    lower_[1][k] = 0.0f;
    inverse_pivot_[k] = 0.0f;
    step_m_[k] = 0.0f;
  }
  band_[1][2] = 0.0f;
  band_[2][2] = 0.0f;
  band_[2][3] = 0.0f;
  band_[3][2] = 0.0f;
  band_[3][3] = 0.0f;
  band_[3][4] = 0.0f;
  bool positive = true;
  float inverse_3 = 0.0f;  // of the pivot three rows before ...
  float step_3_m = 0.0f;   // ... and of the step there
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= last; ++k) {
    const float u3 = band_[3][k];
    const float u2 = band_[2][k] - u3 * lower_[0][k - 2];
    const float u1 = band_[1][k] - u3 * lower_[1][k - 1] - u2 * lower_[0][k - 1];
    const float l3 = u3 * inverse_3;
    const float l2 = u2 * inverse_pivot_[k - 2];
    const float l1 = u1 * inverse_pivot_[k - 1];
    const float pivot = band_[0][k] + damping_ - u3 * l3 - u2 * l2 - u1 * l1;
    positive = positive && pivot > 0.0f;
    inverse_pivot_[k] = 1.0f / pivot;
    lower_[0][k] = l1;
    lower_[1][k] = l2;
    lower_[2][k] = l3;
    step_m_[k] = -step_m_[k] - l1 * step_m_[k - 1] - l2 * step_m_[k - 2] - l3 * step_3_m;
    inverse_3 = inverse_pivot_[k - 2];
    step_3_m = step_m_[k - 2];
  }
  return positive;
}

// D L^T step = what Factor left in step.
void LateralNewton::Substitute() {
  const int last = last_free();
  HP_LOOP_BOUND(3)
  for (int k = last + 1; k < last + 4; ++k) {
    step_m_[k] = 0.0f;
    lower_[0][k] = 0.0f;
    lower_[1][k] = 0.0f;
    lower_[2][k] = 0.0f;
  }
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = last; k >= 2; --k) {
    step_m_[k] = step_m_[k] * inverse_pivot_[k] - lower_[2][k + 3] * step_m_[k + 3] -
                 lower_[1][k + 2] * step_m_[k + 2] - lower_[0][k + 1] * step_m_[k + 1];
  }
}

}  // namespace hardpack
