// SPDX-License-Identifier: Apache-2.0
#include "core/optimizer/lateral_newton.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/optimizer/perturbation.h"

namespace hardpack {
namespace {

// The kinks' width, as a share of the limits: the first, the last, and each step's of the one
// before.
constexpr float kFirstWidth = 0.4f;
constexpr float kLastWidth = 0.005f;
constexpr float kNarrowing = 0.6f;

// Damping is added to the second derivatives, caution to the kinks' (see Kink). Both rise where
// none of a step's lengths lowers F, and fall where its full length does.
constexpr float kFirstDamping = 0.01f;
constexpr float kLeastDamping = 1.0e-6f;
constexpr float kDampingRise = 8.0f;
constexpr float kDampingFall = 0.3f;
constexpr float kLeastCaution = 0.1f;
constexpr float kCautionRise = 3.0f;
constexpr float kCautionFall = 0.3f;

// No point moves further at once; a step tried in vain is tried again, shorter by this share.
constexpr float kLongestMove_m = 1.0f;
constexpr float kShorterShare = 0.4f;

// Points are spread with a step where their chords differ by more than this share of the wanted
// one; where they still differ by more than the second share, whatever it costs, a few times,
// unless too few steps are left to make up for it. The kinks are then at least so wide again.
constexpr float kEvenShare = 0.05f;
constexpr float kFarUnevenShare = 0.3f;
constexpr int kMaxForcedSpreads = 3;
constexpr int kStepsAfterSpread = 5;
constexpr float kSpreadWidth = 0.05f;

// Once the kinks are narrow, a step that gains no more than this share of F is the last.
constexpr float kLeastGain = 3.0e-4f;

// Shares of F are of what turning by so much costs at least. On open ground F falls towards 0, and
// there is a share of it left to gain long after nothing is left of it that counts.
constexpr float kLeastTurning_rad = 1.0f;

}  // namespace

Status LateralNewton::Begin(const Costmap& map, const OptimizerParams& params,
                            const PathParams& path_params, const WorldPath& seed,
                            float start_curvature_per_m, bool keep_end_heading,
                            const PassingPlaces& places) {
  result_ = OptimizerResult{};
  path_.Clear();
  moved_ = false;
  End(CheckSeed(seed, start_curvature_per_m));
  if (result_.status == Status::kOk) End(CheckOptimizerParams(params, path_params));
  if (result_.status != Status::kOk) return result_.status;
  result_.before = CostOf(map, params, seed, start_curvature_per_m);
  if (!IsFinite(result_.before.total())) End(Status::kNotFinite);
  if (result_.status != Status::kOk) return result_.status;

  End(Status::kNotStarted);
  result_.after = result_.before;
  params_ = params;
  places_ = places;
  wanted_step_m_ = path_params.step_m;
  start_curvature_per_m_ = start_curvature_per_m;
  end_points_ = keep_end_heading ? 2 : 1;
  seed_ = seed;
  path_ = seed;
  SetHeadingsFromChords(path_);
  line().points = seed.size();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < seed.size(); ++k) {
    line().x_m[k] = seed[k].x_m;
    line().y_m[k] = seed[k].y_m;
  }
  cost_ = CostOfLine(map, line());
  best_cost_ = cost_;
  forced_spreads_ = 0;
  width_share_ = kFirstWidth;
  damping_ = kFirstDamping;
  caution_ = 0.0f;
  NextStep();
  return Status::kOk;
}

void LateralNewton::End(Status status) {
  result_.status = status;
  phase_ = Phase::kIdle;
}

Progress LateralNewton::Step(const Costmap& map, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && phase_ != Phase::kIdle; ++unit) DoUnit(map);
  Publish();
  return phase_ == Phase::kIdle ? Progress::kDone : Progress::kBusy;
}

void LateralNewton::DoUnit(const Costmap& map) {
  switch (phase_) {
    case Phase::kIdle:
      return;
    case Phase::kDerive:
      return Derive(map);
    case Phase::kSolve:
      return Solve();
    case Phase::kTry:
      return TryStep(map);
    case Phase::kSpread:
      return SpreadLine(map);
    case Phase::kFinish:
      return Finish(map);
  }
}

void LateralNewton::Solve() {
  ++solves_;
  if (!Factor()) return Damp();
  Substitute();
  const int last = last_free();
  float longest_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= last; ++k) longest_m = Max(longest_m, Abs(step_m_[k]));
  share_ = longest_m > kLongestMove_m ? kLongestMove_m / longest_m : 1.0f;
  shares_ = 0;
  spreads_ = solves_ == 1 && Uneven(kEvenShare);
  phase_ = Phase::kTry;
}

// Not so far: the derivatives once more, with more damping and more caution.
void LateralNewton::Damp() {
  damping_ = kDampingRise * damping_ + kFirstDamping;
  caution_ = Min(kCautionRise * caution_ + kLeastCaution, 1.0f);
  phase_ = Phase::kDerive;
  if (solves_ == kMaxSolves) EndStep();
}

void LateralNewton::MovePoints() {
  const Line& from = line();
  Line& to = trial();
  const int points = from.points;
  to.points = points;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points; ++k) {
    to.x_m[k] = from.x_m[k];
    to.y_m[k] = from.y_m[k];
  }
  const int last = last_free();
  const float half_share = 0.5f * share_;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= last; ++k) {
    const float move_m = half_share * step_m_[k];
    to.x_m[k] -= move_m * (from.chord_y[k - 1] + from.chord_y[k]);
    to.y_m[k] += move_m * (from.chord_x[k - 1] + from.chord_x[k]);
  }
}

void LateralNewton::TryStep(const Costmap& map) {
  MovePoints();
  if (spreads_) SpreadTrial();
  const float cost = CostOfLine(map, trial());
  if (cost < cost_) return KeepTrial(cost);
  if (spreads_) {
    spreads_ = false;
    return;
  }
  share_ *= kShorterShare;
  if (++shares_ == kMaxShares) Damp();
}

void LateralNewton::KeepTrial(float cost) {
  at_ = 1 - at_;
  cost_ = cost;
  if (cost < best_cost_) {
    best_cost_ = cost;
    moved_ = true;
  }
  ++result_.perturbations_kept;
  if (spreads_) ++result_.spreads_kept;
  if (shares_ == 0) {
    damping_ = Max(kDampingFall * damping_, kLeastDamping);
    caution_ *= kCautionFall;
  }
  EndStep();
}

// A step that could not be spread may leave the points very uneven.
void LateralNewton::EndStep() {
  ++result_.sweeps;
  const bool soon_over = result_.sweeps + kStepsAfterSpread > params_.max_newton_steps;
  if (!spreads_ && !soon_over && forced_spreads_ < kMaxForcedSpreads && Uneven(kFarUnevenShare)) {
    phase_ = Phase::kSpread;
    return;
  }
  NextStep();
}

// Spreads the line whatever it costs: the steps behind will bring the cost down again, or the path
// published before is the result.
void LateralNewton::SpreadLine(const Costmap& map) {
  Publish();
  share_ = 0.0f;
  MovePoints();
  SpreadTrial();
  const float cost = CostOfLine(map, trial());
  ++forced_spreads_;
  if (!IsFinite(cost)) return NextStep();
  at_ = 1 - at_;
  cost_ = cost;
  width_share_ = Max(width_share_, kSpreadWidth);
  caution_ = 0.0f;
  cost_before_ = cost_;
  solves_ = 0;
  phase_ = Phase::kDerive;
}

void LateralNewton::NextStep() {
  phase_ = Phase::kDerive;
  solves_ = 0;
  const float gain = cost_before_ - cost_;
  const float whole = Max(cost_before_, kLeastTurning_rad * params_.curvature_alpha);
  const bool any = result_.sweeps > 0;
  const bool narrow = width_share_ <= kLastWidth;
  settled_ = last_free() < 2 || (any && narrow && gain <= params_.min_relative_decrease * whole);
  if (last_free() < 2 || result_.sweeps >= params_.max_newton_steps ||
      (any && narrow && gain <= kLeastGain * whole)) {
    phase_ = Phase::kFinish;
  }
  if (any) width_share_ = Max(kNarrowing * width_share_, kLastWidth);
  cost_before_ = cost_;
}

bool LateralNewton::Uneven(float share) const {
  const Line& line = this->line();
  const int end = line.points - end_points_;
  float shortest_m = line.length_m[1];
  float longest_m = line.length_m[1];
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < end; ++k) {
    shortest_m = Min(shortest_m, line.length_m[k]);
    longest_m = Max(longest_m, line.length_m[k]);
  }
  return longest_m - shortest_m > share * wanted_step_m_;
}

// As BasicOptimizer spreads a line: new points on the cubics through the four old ones around.
void LateralNewton::SpreadTrial() {
  Line& line = trial();
  MeasureChords(line);
  const int end = line.points - end_points_;
  float length_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < end; ++k) length_m += line.length_m[k];
  const int steps =
      ClampInt(RoundToInt(length_m / wanted_step_m_), 2, kMaxPathPoints - 1 - end_points_);
  const float step_m = length_m / static_cast<float>(steps);
  int chord = 1;
  float along_m = 0.0f;
  HP_LOOP_BOUND_INNER(kMaxPathPoints, 4 * kMaxPathPoints)
  for (int k = 2; k <= steps; ++k) {
    along_m += step_m;
    HP_LOOP_BOUND(kMaxPathPoints)
    while (chord + 1 < end && along_m >= line.length_m[chord]) along_m -= line.length_m[chord++];
    const int first = ClampInt(chord - 1, 0, line.points - 4);
    Vec2 around[4];
    HP_LOOP_BOUND(4)
    for (int i = 0; i < 4; ++i) around[i] = {line.x_m[first + i], line.y_m[first + i]};
    const Vec2 point = perturbation::CubicThrough(around, chord - first, along_m);
    spread_x_m_[k] = point.x_m;
    spread_y_m_[k] = point.y_m;
  }
  // The last points first: they may come to lie where others were.
  Vec2 kept[2];
  HP_LOOP_BOUND(2)
  for (int i = 0; i < end_points_; ++i) kept[i] = {line.x_m[end + i], line.y_m[end + i]};
  line.points = steps + 1 + end_points_;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 2; k <= steps; ++k) {
    line.x_m[k] = spread_x_m_[k];
    line.y_m[k] = spread_y_m_[k];
  }
  HP_LOOP_BOUND(2)
  for (int i = 0; i < end_points_; ++i) {
    line.x_m[steps + 1 + i] = kept[i].x_m;
    line.y_m[steps + 1 + i] = kept[i].y_m;
  }
}

// F as CostOf has it. By its rounding it may lie above that of the seed, where next to
// nothing was gained.
void LateralNewton::Finish(const Costmap& map) {
  Publish();
  result_.after = CostOf(map, params_, path_, start_curvature_per_m_);
  if (!(result_.after.total() <= result_.before.total())) {
    path_ = seed_;
    SetHeadingsFromChords(path_);
    result_.after = result_.before;
  }
  End(settled_ ? Status::kOk : Status::kIterationLimit);
}

void LateralNewton::Publish() {
  if (!moved_) return;
  moved_ = false;
  const Line& line = this->line();
  path_.Resize(line.points);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < line.points; ++k) {
    path_[k].x_m = line.x_m[k];
    path_[k].y_m = line.y_m[k];
  }
  SetHeadingsFromChords(path_);
}

}  // namespace hardpack
