// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/optimizer/path_cost.h"
#include "core/path/path.h"
#include "core/path/route.h"

// Another method for the minimum of the paper's F (ours; docs/algorithm.md section 5): all points
// at once, each moved along its normal, by a damped Newton method.
//
// - A point's terms in F depend on at most four consecutive points, so the second derivatives form
//   a band of three to either side, and a step costs one pass of factoring (L D L^T).
// - F has kinks: |u| at 0, f at u_max, where a step limit stays put. Each is rounded off within a
//   width that starts wide, so that far changes are seen, and narrows with each step. F itself,
//   unrounded, decides what is kept: a step that does not lower it is retried shorter, then with
//   more damping. So F never rises, and the result is never worse than the seed.
// - Curvature terms are linearised in the points' offsets, and the map is sampled to both sides of
//   each point; where it is concave it contributes no second derivative. So the matrix stays
//   positive definite except for rounding, and damping repairs that.
// - If the spacing has become uneven, a step's points are respaced along its path, provided F is
//   still lowered. Very uneven points are respaced in any case; until F is as low again, path()
//   stays at its previous result.
//
// It finds a local minimum near its seed, does not evaluate it, and stays on the seed's side of an
// obstacle. It is made for PlanarModel: it knows how chords turn.

namespace hardpack {

// Places that the path shall pass within a radius. For each, the nearest of the free points adds
//   kWeight max(distance - radius, 0)^2
// to what is minimised: not to F, so what is reported does not contain it.
struct PassingPlaces {
  static constexpr float kWeight_per_m2 = 20.0f;
  FixedVector<Vec2, kMaxVias> place_odom;  // finite
  float radius_m = 0.0f;
};

class LateralNewton {
 public:
  static constexpr int kMaxSteps = 200;
  // A step: at most kMaxSolves times its derivatives, a solution and kMaxShares lengths of it, and
  // once with its points respaced.
  static constexpr int kMaxSolves = 4;
  static constexpr int kMaxShares = 3;
  static constexpr int kMaxUnits = kMaxSteps * (kMaxSolves * (2 + kMaxShares) + 2) + 1;

  // As BasicOptimizer::Begin, and past `places`. The seed should pass them.
  Status Begin(const Costmap& map, const OptimizerParams& params, const PathParams& path_params,
               const WorldPath& seed, float start_curvature_per_m, bool keep_end_heading,
               const PassingPlaces& places = {});

  // A unit is one pass over the points: derivatives, a solution, the cost of a step.
  Progress Step(const Costmap& map, int units);

  // Valid once Step has returned kDone (before: once Begin has returned kOk).
  const OptimizerResult& result() const { return result_; }

  // The best path so far; after every Step a complete path from start to end, including headings,
  // with a cost not above the seed's (meanwhile to the rounding of a sum; at the end exactly).
  const WorldPath& path() const { return path_; }

 private:
  // Derive: derivatives of line_. Solve: the step. Try: line_ moved, into the other line.
  enum class Phase : uint8_t { kIdle, kDerive, kSolve, kTry, kSpread, kFinish };

  static constexpr int kRoom = kMaxPathPoints + 8;  // reads go beyond the last point

  // A path and its terms in F. Chord k goes from point k to point k + 1; at point k the chord
  // before it turns into the one after it.
  struct Line {
    int32_t points = 0;
    float x_m[kRoom] = {};
    float y_m[kRoom] = {};
    float chord_x[kRoom] = {};  // of length 1
    float chord_y[kRoom] = {};
    float length_m[kRoom] = {};
    float inverse_length_per_m[kRoom] = {};
    float half_cross[kRoom] = {};  // of the unit chords that meet; 0 at both ends
    float half_dot[kRoom] = {};    // (1 + dot) / 2
    float ds_m[kRoom] = {};
    float inverse_ds_per_m[kRoom] = {};
    float curvature_per_m[kRoom] = {};
    float rate_per_m2[kRoom] = {};
    float map_cost[kRoom] = {};  // per metre
    float path_cost[kRoom] = {};
    int32_t passing_point[kMaxVias] = {};  // of places_
  };

  // A kind of term of F: a |u| up to u_max, b more beyond it, and its rounding.
  struct Kink {
    float alpha;
    float steeper;  // beta - alpha
    float max;
    float width;
    float caution;  // 0: a second derivative as of a rounded kink; 1: of a parabola above it
  };

  void DoUnit(const Costmap& map);
  void End(Status status);

  float CostOfLine(const Costmap& map, Line& line) const;
  static void MeasureChords(Line& line);
  void MeasureCurvatures(Line& line) const;

  void Derive(const Costmap& map);
  void DeriveMap(const Costmap& map);
  void DeriveCurvatures();
  static void DeriveTerm(const Kink& kink, const float* value, const float* ds_m, int points,
                         float* slope, float* bend);
  void Assemble();
  float CostOfPlaces(Line& line) const;
  void DerivePlaces();

  void Solve();
  bool Factor();
  void Substitute();
  void Damp();
  void MovePoints();
  bool Uneven(float share) const;
  void SpreadTrial();
  void TryStep(const Costmap& map);
  void KeepTrial(float cost);
  void EndStep();
  void SpreadLine(const Costmap& map);
  void NextStep();

  void Finish(const Costmap& map);
  void Publish();

  Line& line() { return lines_[at_]; }
  const Line& line() const { return lines_[at_]; }
  Line& trial() { return lines_[1 - at_]; }
  int last_free() const { return line().points - 1 - end_points_; }

  OptimizerParams params_;
  PassingPlaces places_;
  OptimizerResult result_;
  WorldPath path_;
  WorldPath seed_;
  Phase phase_ = Phase::kIdle;
  bool moved_ = false;  // line() has changed since it was last published to path_
  float wanted_step_m_ = 0.0f;
  float start_curvature_per_m_ = 0.0f;
  int32_t end_points_ = 0;  // fixed points: the last, or the last two

  int32_t at_ = 0;  // index of the path's line; the other is the trial
  Line lines_[2];
  float cost_ = 0.0f;       // of line(): F up to rounding
  float best_cost_ = 0.0f;  // of the path published or to be published
  int32_t forced_spreads_ = 0;
  float cost_before_ = 0.0f;  // the same before this step
  float width_share_ = 0.0f;  // of the kinks, relative to their limits
  float damping_ = 0.0f;
  float caution_ = 0.0f;
  float share_ = 0.0f;    // of the step being tried
  int32_t shares_ = 0;    // tried of this solution
  int32_t solves_ = 0;    // of this step
  bool spreads_ = false;  // the points are respaced when the step is tried
  bool settled_ = false;  // the last step gained next to nothing

  // For the map term along the normals: first and second derivative.
  float map_slope_[kRoom] = {};
  float map_bend_[kRoom] = {};
  // Derivatives of curvature k by the offsets of points k - 1 .. k + 1, and of its rate by those of
  // k - 2 .. k + 1.
  float by_offset_[3][kRoom] = {};
  float rate_by_offset_[4][kRoom] = {};
  // For their terms: first and second derivative, times ds.
  float slope_[kRoom] = {};
  float bend_[kRoom] = {};
  float rate_slope_[kRoom] = {};
  float rate_bend_[kRoom] = {};
  // For F: the band of second derivatives [distance from the diagonal].
  float band_[4][kRoom] = {};
  // L's rows (by distance from the diagonal) and 1 / D.
  float lower_[3][kRoom] = {};
  float inverse_pivot_[kRoom] = {};
  // F's gradient by the offsets; solving turns it into the step.
  float step_m_[kRoom] = {};
  float spread_x_m_[kRoom] = {};
  float spread_y_m_[kRoom] = {};
};
static_assert(std::is_trivially_copyable_v<LateralNewton>);
static_assert(sizeof(LateralNewton) <= 60 * 1024);

}  // namespace hardpack
