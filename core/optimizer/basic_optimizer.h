// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/optimizer/cost_terms.h"
#include "core/optimizer/optimizer.h"
#include "core/optimizer/perturbation.h"

// The members of BasicOptimizer. Include this only to instantiate it over another vehicle model.

namespace hardpack {

template <typename Model>
Status BasicOptimizer<Model>::Begin(const Costmap& map, const OptimizerParams& params,
                                    const PathParams& path_params, const WorldPath& seed,
                                    float start_curvature_per_m, bool keep_end_heading) {
  result_ = OptimizerResult{};
  path_.Clear();
  moved_ = false;
  End(CheckSeed(seed, start_curvature_per_m));
  if (result_.status == Status::kOk) End(CheckOptimizerParams(params, path_params));
  if (result_.status != Status::kOk) return result_.status;
  End(Status::kNotStarted);

  params_ = params;
  wanted_step_m_ = path_params.step_m;
  start_curvature_per_m_ = start_curvature_per_m;
  points_ = seed.size();
  end_points_ = keep_end_heading ? 2 : 1;
  unit_step_rad_ = params.perturbation_rad;
  halvings_ = 0;
  Unsettle(0, kMaxPathPoints - 1);
  path_ = seed;
  SetHeadingsFromChords(path_);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) line_.point[k] = {seed[k].x_m, seed[k].y_m};
  at_ = 0;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (at_ < points_) CostNextPoint(map, line_, points_);
  cost_ = SumOf(line_, points_);
  if (!IsFinite(cost_.total())) {
    path_.Clear();
    End(Status::kNotFinite);
    return result_.status;
  }
  result_.before = cost_;
  result_.after = cost_;
  BeginSweep();
  return Status::kOk;
}

template <typename Model>
void BasicOptimizer<Model>::End(Status status) {
  result_.status = status;
  phase_ = Phase::kIdle;
}

// Costs point at_ of a whole line and moves on; the line's points are costed from first to last.
template <typename Model>
void BasicOptimizer<Model>::CostNextPoint(const Costmap& map, Line& line, int points) {
  const int k = at_++;
  const cost_terms::PointCost cost =
      k == 0 ? cost_terms::WalkFirstPoint(map, line.point[0], line.point[1], start_curvature_per_m_,
                                          walk_)
      : k == points - 1
          ? cost_terms::WalkLastPoint(map, line.point[k], walk_)
          : cost_terms::WalkPoint<Model>(map, params_, line.point[k], line.point[k + 1], walk_);
  line.curvature_per_m[k] = walk_.curvature_per_m;
  line.map_cost[k] = cost.map;
  line.path_cost[k] = cost.path;
}

template <typename Model>
PathCost BasicOptimizer<Model>::SumOf(const Line& line, int points) {
  PathCost sum;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points; ++k) {
    sum.map += line.map_cost[k];
    sum.path += line.path_cost[k];
  }
  return sum;
}

template <typename Model>
Progress BasicOptimizer<Model>::Step(const Costmap& map, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && phase_ != Phase::kIdle; ++unit) DoUnit(map);
  Publish();
  return phase_ == Phase::kIdle ? Progress::kDone : Progress::kBusy;
}

template <typename Model>
void BasicOptimizer<Model>::DoUnit(const Costmap& map) {
  if (phase_ == Phase::kSweep) {
    if (!settled_[at_]) settled_[at_] = !TryPoint(map, at_);
    ++at_;
    if (WindowEnd(at_) - at_ < 2) EndSweep();
  } else if (phase_ == Phase::kSpread) {
    SpreadNextPoint();
    if (at_ < spread_points_) return;
    at_ = 0;
    phase_ = Phase::kSpreadCost;
  } else {
    CostNextPoint(map, candidate_[0], spread_points_);
    if (at_ == spread_points_) EndSpread();
  }
}

template <typename Model>
int BasicOptimizer<Model>::WindowEnd(int pivot) const {
  const int fixed = points_ - end_points_;
  return pivot + params_.window_steps < fixed ? pivot + params_.window_steps : fixed;
}

template <typename Model>
typename BasicOptimizer<Model>::Window BasicOptimizer<Model>::WindowAt(int pivot) const {
  const int end = WindowEnd(pivot);
  // The chord into `end` turns, so the curvature there changes, and the rate of change behind it.
  const int last = end + 1 < points_ - 1 ? end + 1 : points_ - 1;
  Window window = {pivot, end, last, 0.0f};
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = pivot; k <= last; ++k) window.cost += line_.map_cost[k] + line_.path_cost[k];
  return window;
}

template <typename Model>
void BasicOptimizer<Model>::BeginSweep() {
  sweep_start_ = line_;
  phase_ = Phase::kSweep;
  at_ = 1;  // the first chord is fixed: point 1 is the first where the path may turn
  if (WindowEnd(at_) - at_ < 2) return End(Status::kOk);
  if (result_.sweeps >= params_.max_sweeps) End(Status::kIterationLimit);
}

// One step of Algorithm 1. False: neither perturbation lowers the cost.
template <typename Model>
bool BasicOptimizer<Model>::TryPoint(const Costmap& map, int pivot) {
  // A smaller decrease than this share of the window's cost may be nothing but rounding.
  constexpr float kLeastGain = 1.0e-6f;
  const Window window = WindowAt(pivot);
  const float useful = window.cost - kLeastGain * window.cost;
  const float left = TryTurn(map, window, unit_step_rad_, useful, candidate_[0]);
  const float to_beat = left < useful ? left : useful;
  const float right = TryTurn(map, window, -unit_step_rad_, to_beat, candidate_[1]);
  int best = right < to_beat ? 1 : 0;
  const float cost = best == 1 ? right : left;
  if (!(cost < useful)) return false;

  const float scaled_rad = Min(unit_step_rad_ * params_.perturbation_scale * (window.cost - cost),
                               params_.max_perturbation_rad);
  if (scaled_rad > unit_step_rad_) {
    const float signed_rad = best == 0 ? scaled_rad : -scaled_rad;
    if (TryTurn(map, window, signed_rad, cost, candidate_[1 - best]) < cost) best = 1 - best;
  }
  Keep(window, candidate_[best]);
  return true;
}

// The window's cost when the heading change at its pivot grows by delta_rad; candidate's points and
// costs are set there. Every term is at least zero, so the sum stops where it reaches `limit`: what
// is returned then is not below it.
template <typename Model>
float BasicOptimizer<Model>::TryTurn(const Costmap& map, const Window& window, float delta_rad,
                                     float limit, Line& candidate) {
  MovePoints(window, delta_rad, candidate);
  const int before = window.pivot - 1;
  const Vec2 chord = Minus(line_.point[window.pivot], line_.point[before]);
  cost_terms::Walk walk = {chord, Length(chord), line_.curvature_per_m[before]};
  float sum = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = window.pivot; k <= window.last && sum < limit; ++k) {
    const cost_terms::PointCost cost =
        k == points_ - 1 ? cost_terms::WalkLastPoint(map, candidate.point[k], walk)
                         : cost_terms::WalkPoint<Model>(map, params_, candidate.point[k],
                                                        candidate.point[k + 1], walk);
    candidate.curvature_per_m[k] = walk.curvature_per_m;
    candidate.map_cost[k] = cost.map;
    candidate.path_cost[k] = cost.path;
    sum += cost.map + cost.path;
  }
  return sum;
}

// Perturb(pivot, delta): the points of the window, and beyond it those that its costs look at.
template <typename Model>
void BasicOptimizer<Model>::MovePoints(const Window& window, float delta_rad,
                                       Line& candidate) const {
  const SinCosPair turn = SinCos(delta_rad);
  const Vec2 pivot = line_.point[window.pivot];
  const float share = 1.0f / static_cast<float>(window.end - window.pivot);
  candidate.point[window.pivot] = pivot;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = window.pivot + 1; k < window.end; ++k) {
    const float weight = 1.0f - perturbation::SCurve(static_cast<float>(k - window.pivot) * share);
    candidate.point[k] = perturbation::PerturbedPoint<Model>(pivot, line_.point[k], turn, weight);
  }
  const int looked_at = window.end + 2 < points_ - 1 ? window.end + 2 : points_ - 1;
  HP_LOOP_BOUND(3)
  for (int k = window.end; k <= looked_at; ++k) candidate.point[k] = line_.point[k];
}

template <typename Model>
void BasicOptimizer<Model>::Keep(const Window& window, const Line& candidate) {
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = window.pivot; k <= window.last; ++k) {
    line_.point[k] = candidate.point[k];
    line_.curvature_per_m[k] = candidate.curvature_per_m[k];
    line_.map_cost[k] = candidate.map_cost[k];
    line_.path_cost[k] = candidate.path_cost[k];
  }
  Unsettle(window.pivot - params_.window_steps - 2, window.last + 1);
  moved_ = true;
  ++result_.perturbations_kept;
}

// Pivots first .. last look at something that has changed, so they are worth another try.
template <typename Model>
void BasicOptimizer<Model>::Unsettle(int first, int last) {
  const int from = ClampInt(first, 0, kMaxPathPoints - 1);
  const int to = ClampInt(last, 0, kMaxPathPoints - 1);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = from; k <= to; ++k) settled_[k] = false;
}

// The points' costs are what a walk over the whole path would find, so their sum is exact: nothing
// has drifted. Only that sum's rounding could still make a sweep of tiny gains look like a rise.
template <typename Model>
void BasicOptimizer<Model>::EndSweep() {
  ++result_.sweeps;
  result_.after = SumOf(line_, points_);
  if (!(result_.after.total() < cost_.total())) {
    line_ = sweep_start_;
    result_.after = cost_;
    Unsettle(0, kMaxPathPoints - 1);
    moved_ = true;
  }
  if (!BeginSpread()) JudgeSweep();
}

// Perturbations stretch some steps and shorten others. Points spread evenly again cover the map
// evenly and have curvatures that mean what they say. False: they are even enough.
template <typename Model>
bool BasicOptimizer<Model>::BeginSpread() {
  constexpr float kEvenShare = 0.02f;
  const int end = points_ - end_points_;
  float length_m = 0.0f;
  float shortest_m = cost_terms::kShortestChord_m;
  float longest_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 1; k < end; ++k) {
    const float chord_m = Length(Minus(line_.point[k + 1], line_.point[k]));
    length_m += chord_m;
    longest_m = Max(longest_m, chord_m);
    shortest_m = k == 1 ? chord_m : Min(shortest_m, chord_m);
  }
  if (!(shortest_m >= cost_terms::kShortestChord_m)) return false;
  const int steps =
      ClampInt(RoundToInt(length_m / wanted_step_m_), 2, kMaxPathPoints - 1 - end_points_);
  spread_step_m_ = length_m / static_cast<float>(steps);
  if (steps == end - 1 && longest_m - shortest_m <= kEvenShare * spread_step_m_) return false;

  spread_points_ = steps + 1 + end_points_;
  spread_chord_ = 1;
  spread_along_m_ = 0.0f;
  at_ = 0;
  phase_ = Phase::kSpread;
  return true;
}

// A new point on the cubic through the four points around its place, by the length of the chords
// between them. Chords instead would cut every bend, and the curvature at each would be noise.
template <typename Model>
void BasicOptimizer<Model>::SpreadNextPoint() {
  const int k = at_++;
  const int kept_behind = spread_points_ - end_points_;
  if (k < 2) {
    candidate_[0].point[k] = line_.point[k];
    return;
  }
  if (k >= kept_behind) {
    candidate_[0].point[k] = line_.point[points_ - spread_points_ + k];
    return;
  }
  spread_along_m_ += spread_step_m_;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (spread_chord_ + 1 < points_ - end_points_) {
    const float chord_m = Length(Minus(line_.point[spread_chord_ + 1], line_.point[spread_chord_]));
    if (spread_along_m_ < chord_m) break;
    spread_along_m_ -= chord_m;
    ++spread_chord_;
  }
  const int first = ClampInt(spread_chord_ - 1, 0, points_ - 4);
  candidate_[0].point[k] =
      perturbation::CubicThrough(&line_.point[first], spread_chord_ - first, spread_along_m_);
}

template <typename Model>
void BasicOptimizer<Model>::EndSpread() {
  const PathCost spread = SumOf(candidate_[0], spread_points_);
  if (spread.total() <= result_.after.total()) {
    line_ = candidate_[0];
    points_ = spread_points_;
    result_.after = spread;
    Unsettle(0, kMaxPathPoints - 1);
    moved_ = true;
    ++result_.spreads_kept;
  }
  JudgeSweep();
}

template <typename Model>
void BasicOptimizer<Model>::JudgeSweep() {
  const float gain = cost_.total() - result_.after.total();
  const bool stalled = gain <= params_.min_relative_decrease * cost_.total();
  cost_ = result_.after;
  if (stalled && halvings_ == kMaxHalvings) return End(Status::kOk);
  if (stalled) {
    ++halvings_;
    unit_step_rad_ *= 0.5f;
    Unsettle(0, kMaxPathPoints - 1);
  }
  BeginSweep();
}

template <typename Model>
void BasicOptimizer<Model>::Publish() {
  if (!moved_) return;
  moved_ = false;
  path_.Resize(points_);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < points_; ++k) {
    path_[k].x_m = line_.point[k].x_m;
    path_[k].y_m = line_.point[k].y_m;
  }
  SetHeadingsFromChords(path_);
}

}  // namespace hardpack
