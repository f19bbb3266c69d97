// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/astar/astar.h"
#include "core/base/fixed_vector.h"
#include "core/base/pose.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"

// Paths in world and in actuator space ([OS] Path Representation; docs/algorithm.md section 3), the
// vehicle model that joins the two, and the way from a cell path to the optimizer's seed.

namespace hardpack {

inline constexpr int kMaxPathPoints = 256;

// [n] poses, odom frame. theta_i is the heading of the chord from point i to point i + 1 when the
// step is forward, the opposite when it is in reverse; the last heading is repeated.
using WorldPath = FixedVector<Pose2, kMaxPathPoints>;

// One step: drive dr_m along the present heading (negative: in reverse), then turn by phi_rad.
// dr_m = 0 with phi_rad != 0 is a turn on the spot.
struct ActuatorStep {
  float phi_rad = 0.0f;
  float dr_m = 0.0f;
};

// A start pose and [n - 1] steps.
struct ActuatorPath {
  Pose2 start;
  FixedVector<ActuatorStep, kMaxPathPoints - 1> steps;
};

// The vehicle model that path, optimizer and check are given: how a step moves the vehicle, and
// which step joins two poses. This one is the paper's: the plane, heading and distance.
// Another model is another type with the same two functions.
struct PlanarModel {
  // theta' = theta + phi; x' = x + cos(theta) dr; y' = y + sin(theta) dr.
  static Pose2 Forward(const Pose2& from, const ActuatorStep& step);
  // phi = wrap(theta' - theta); |dr| = |p' - p|; dr < 0 where the chord points against theta.
  static ActuatorStep Inverse(const Pose2& from, const Pose2& to);
};

// Forward integration of every step. Both at most kMaxPathPoints points.
// kPathTooShort: no steps; kNotFinite: a number is not.
template <typename Model>
Status ToWorld(const ActuatorPath& actuator, WorldPath& world);

// kPathTooShort: fewer than two points; kNotFinite.
template <typename Model>
Status ToActuator(const WorldPath& world, ActuatorPath& actuator);

// Headings from the chords: theta_i = atan2 of the chord i -> i + 1 (forward driving), the last
// repeated. A chord of no length takes the heading before it.
void SetHeadingsFromChords(WorldPath& path);

// Length of all chords [m].
float LengthOf(const WorldPath& path);

// Walks a finished search's cell path and resamples it uniformly at about params.step_m (the step
// that divides the length evenly), from start_odom (replacing the first cell's centre) to goal_odom
// when that lies in the path's end cell, else to the end cell's centre. Resumable: a unit is one
// cell. Headings by SetHeadingsFromChords.
class PathSampler {
 public:
  // kNotStarted when the search has no path.
  Status Begin(const AstarSearch& search, const PathParams& params, Vec2 start_odom,
               Vec2 goal_odom);
  Progress Step(const AstarSearch& search, const GridWindow& window, int units);

  // kOk; kPathCut: longer than kMaxPathPoints points, cut there; kPathTooShort: the goal is where
  // the start is.
  Status status() const { return status_; }
  const WorldPath& result() const { return path_; }

 private:
  Status status_ = Status::kNotStarted;
  WorldPath path_;
  // The implementer's state.
};

// The start of the drive: how the vehicle's pose is joined to the base path.
struct PathStart {
  Pose2 pose;  // odom
  float curvature_per_m = 0.0f;
  float speed_mps = 0.0f;
};

// The heading of the base path near its start: of the chord to the point about 1 m along it.
float BaseHeading(const WorldPath& base);

// Whether a circle of vehicle.pivot_radius_m + params.pivot_margin_m around the position is free of
// hard cells (person cells included; cells off the map count as not free).
bool PivotIsFree(const Costmap& map, const VehicleParams& vehicle, const PathParams& params,
                 Vec2 position_odom);

}  // namespace hardpack
