// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/astar/astar.h"
#include "core/base/fixed_vector.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"

// Paths in world and in actuator space ([OS] Path Representation; docs/algorithm.md section 3), the
// vehicle model that joins the two, and the conversion of a cell path into the optimizer's seed. It
// does not evaluate a path (core/safety does) and does not bend one (core/optimizer does).

namespace hardpack {

inline constexpr int kMaxPathPoints = 256;

// [n] poses, odom frame. theta_i is the heading of the chord from point i to point i + 1 when the
// step is forward, the opposite when it is in reverse; the last heading is repeated.
using WorldPath = FixedVector<Pose2, kMaxPathPoints>;

// Whether the chord after a point is driven in reverse: against the point's heading. False for the
// last point and for a turn on the spot.
bool IsReversed(const WorldPath& path, int point);

// One step: drive dr_m along the present heading (negative: in reverse), then turn by phi_rad.
// dr_m = 0 with phi_rad != 0 is a turn on the spot.
struct ActuatorStep {
  float phi_rad = 0.0f;  // (-pi, pi]
  float dr_m = 0.0f;
};

// A start pose and [n - 1] steps.
struct ActuatorPath {
  Pose2 start;
  FixedVector<ActuatorStep, kMaxPathPoints - 1> steps;
};

// Curvatures are clamped to this magnitude, so that none overflows.
inline constexpr float kCurvatureCeiling_per_m = 1.0e6f;

constexpr float ClampCurvature(float curvature_per_m) {
  return Max(-kCurvatureCeiling_per_m, Min(curvature_per_m, kCurvatureCeiling_per_m));
}

// A chord shorter than this has no length: its step is a turn on the spot. The optimizer accepts no
// shorter one.
inline constexpr float kLeastChord_m = 1.0e-4f;
constexpr bool HasLength(float chord_m) {
  return Abs(chord_m) >= kLeastChord_m;
}

// Length of path that belongs to the point where two chords meet [m]; both lengths positive.
constexpr float MeanChord(float chord_before_m, float chord_after_m) {
  return 0.5f * chord_before_m + 0.5f * chord_after_m;
}

// Curvature where two chords meet [1/m]: kappa = phi / ds, with ds the mean of both lengths (the
// discretisation of CostOf). 0 if a chord has no length: the vehicle stands there and may turn
// freely.
float CurvatureBetween(float turn_rad, float chord_before_m, float chord_after_m);

// The vehicle model as a type ([OS] Path Representation): how a step moves the vehicle, which step
// joins two poses, and what a change of heading does to the rest of the path. This one is the
// paper's: the plane, heading and distance. Another model is another type with the same functions,
// all static and pure; ToWorld, ToActuator and the optimizer are templates over it.
struct PlanarModel {
  // theta' = wrap(theta + phi); x' = x + cos(theta) dr; y' = y + sin(theta) dr.
  static Pose2 Forward(const Pose2& from, const ActuatorStep& step);
  // phi = wrap(theta' - theta); |dr| = |p' - p|; dr < 0 where the chord points against theta.
  static ActuatorStep Inverse(const Pose2& from, const Pose2& to);
  // The same phi from the chords of two consecutive forward steps, atan2(cross, dot): it needs no
  // headings and is exact for small angles. Only the directions count; 0 if one is (0, 0).
  static float TurnBetween(Vec2 chord, Vec2 next_chord);
  // The new position of `arm`, the vector from a point to a later point of the path, when the
  // heading change at that point grows by an angle with this sine and cosine: the steps after it
  // stay the same, so everything turns rigidly. Equal to Forward over the steps between, without
  // the sum.
  static Vec2 Turned(Vec2 arm, const SinCosPair& turn);
};

// Forward integration of every step: n - 1 steps give n poses. On failure `world` is empty.
// kPathTooShort: no steps; kNotFinite: a number, or a resulting pose, is not finite. Cost: at most
// kMaxPathPoints calls of Model::Forward.
template <typename Model>
Status ToWorld(const ActuatorPath& actuator, WorldPath& world);

// The step between each pose and the next: n poses give n - 1 steps. On failure `actuator` has no
// steps. kPathTooShort: fewer than two points; kNotFinite, as above. Cost: at most kMaxPathPoints
// calls of Model::Inverse.
template <typename Model>
Status ToActuator(const WorldPath& world, ActuatorPath& actuator);

// The heading of a chord driven forward, in (-pi, pi]; 0 for a chord of no length.
float HeadingOf(Vec2 chord);

// Headings from the chords: theta_i = HeadingOf the chord i -> i + 1 (forward driving), the last
// repeated ([OS] eq. heading from path). A chord of no length takes the previous heading; if it is
// the first, the pose keeps its heading.
void SetHeadingsFromChords(WorldPath& path);

// Length of all chords [m].
float LengthOf(const WorldPath& path);

// Walks a finished search's cell path and resamples it uniformly at about params.step_m (the step
// that divides the length evenly; at least kMinPathSteps steps, so that the later stages always
// have enough points), from start_odom (replacing the first cell's centre) to goal_odom if that
// lies in the path's end cell, otherwise to the end cell's centre. Resumable: a unit is one cell of
// the path; it is walked twice, first for its length, then for its points, and a last unit sets the
// headings (SetHeadingsFromChords). At most 2 path_cells + 1 units.
class PathSampler {
 public:
  static constexpr int kMinPathSteps = 3;
  static constexpr float kMinPathLength_m = 0.05f;
  static constexpr float kMinStep_m = 0.05f;
  // A path has at most every cell of the map.
  static constexpr int kMaxUnits = 2 * kMapCells + 1;

  // kNotStarted: the search has no path; kNotFinite; kParameterOutOfRange: params.step_m below
  // kMinStep_m.
  Status Begin(const AstarSearch& search, const PathParams& params, Vec2 start_odom,
               Vec2 goal_odom);

  // Pass the same search, unchanged.
  Progress Step(const AstarSearch& search, int units);

  // Before the end: kNotStarted, or why Begin failed. After it: kOk; kPathCut: longer than
  // kMaxPathPoints points, cut there; kPathTooShort: shorter than kMinPathLength_m, i.e. the goal
  // is at the start.
  Status status() const { return status_; }
  const WorldPath& result() const { return path_; }

 private:
  enum class Phase : uint8_t { kIdle, kLength, kPoints, kHeadings };

  void BeginWalk();
  Vec2 NextVertex(const AstarSearch& search);
  void AddLength(const AstarSearch& search);
  void ChooseStep();
  void AddPoints(const AstarSearch& search);
  void DoUnit(const AstarSearch& search);
  void End(Status status);

  Status status_ = Status::kNotStarted;
  Phase phase_ = Phase::kIdle;
  WorldPath path_;
  float wanted_step_m_ = 0.0f;
  Vec2 start_;        // odom
  Vec2 end_;          // odom
  Cell first_cell_;   // of the search's path
  int32_t legs_ = 0;  // straight pieces of the polyline start_, cell centres, end_

  // The walk: at `vertex_`, in `cell_`, after `leg_` legs.
  Vec2 vertex_;
  Cell cell_;
  int32_t leg_ = 0;

  float length_m_ = 0.0f;      // of the legs walked for the length
  int32_t points_ = 0;         // of the result, including its end
  bool cut_ = false;           // the result's end is not end_
  float step_m_ = 0.0f;        // chosen: divides the length
  float until_next_m_ = 0.0f;  // from vertex_ along the polyline to the next point
};
static_assert(std::is_trivially_copyable_v<PathSampler>);

// The start of the drive: how the vehicle's pose is joined to the base path.
struct PathStart {
  Pose2 pose;  // odom
  float curvature_per_m = 0.0f;
  float speed_mps = 0.0f;
};

// The heading of the base path near its start: of the chord from its first point to the first point
// at least 1 m along it (the last, if it is shorter); 0 with fewer than two points.
float BaseHeading(const WorldPath& base);

// Dilation radius of obstacles for the search [m]: costmap.planning_radius_m; or half the width
// plus the margin of new plans plus half a cell's diagonal, if that is more: the axle's path along
// an obstacle's side then leaves room for the outline.
float PlanningRadius(const CostmapParams& costmap, const VehicleParams& vehicle,
                     const PathParams& params);

// Whether a circle of the vehicle's pivot radius (core/base/footprint.h) plus params.pivot_margin_m
// around the position is free: no hard or person cell's square reaches into it, and all of it is on
// the map. A circle of more than kMaxPivotCircle_m, or one that is not finite, counts as not free.
// Cost: its cells.
inline constexpr float kMaxPivotCircle_m = 7.0f;
bool PivotIsFree(const Costmap& map, const VehicleParams& vehicle, const PathParams& params,
                 Vec2 position_odom);

template <typename Model>
Status ToWorld(const ActuatorPath& actuator, WorldPath& world) {
  world.Clear();
  const int steps = actuator.steps.size();
  if (steps == 0) return Status::kPathTooShort;
  Pose2 pose = actuator.start;
  if (!IsFinite(pose)) return Status::kNotFinite;
  world.Resize(steps + 1);
  world[0] = pose;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int i = 0; i < steps; ++i) {
    const ActuatorStep& step = actuator.steps[i];
    pose = Model::Forward(pose, step);
    if (!IsFinite(step.phi_rad) || !IsFinite(step.dr_m) || !IsFinite(pose)) {
      world.Clear();
      return Status::kNotFinite;
    }
    world[i + 1] = pose;
  }
  return Status::kOk;
}

template <typename Model>
Status ToActuator(const WorldPath& world, ActuatorPath& actuator) {
  actuator.steps.Clear();
  const int points = world.size();
  if (points < 2) return Status::kPathTooShort;
  if (!IsFinite(world[0])) return Status::kNotFinite;
  actuator.start = world[0];
  actuator.steps.Resize(points - 1);
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int i = 0; i < points - 1; ++i) {
    const ActuatorStep step = Model::Inverse(world[i], world[i + 1]);
    if (!IsFinite(world[i + 1]) || !IsFinite(step.phi_rad) || !IsFinite(step.dr_m)) {
      actuator.steps.Clear();
      return Status::kNotFinite;
    }
    actuator.steps[i] = step;
  }
  return Status::kOk;
}

}  // namespace hardpack
