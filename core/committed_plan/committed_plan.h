// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/decision_hash.h"
#include "core/base/fixed_vector.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/path/path.h"
#include "core/path/route.h"
#include "core/speed/ground_ahead.h"
#include "core/speed/speed.h"

// The plan being driven: where on it a vehicle is, and what it specifies at each place. It does not
// evaluate or change itself (core/autonomy/replanner.h does). Not part of the paper; for paths and
// speeds see docs/algorithm.md sections 3 and 6.

namespace hardpack {

// The target of planning.
struct PlanGoal {
  Vec2 position_odom;
  bool has_heading = false;
  float heading_rad = 0.0f;  // ignored otherwise
  Route route = {};          // the way to it
  // Of an owner that drives to one place after another: the goal's number, from 0; the vias have
  // the numbers before it. Places of different lists are different, whatever their numbers: `list`
  // changes with each new one. Both are looked at only if there are vias.
  uint32_t number = 0;
  uint32_t list = 0;
};

// The place of a goal's way with this index: a via, which then is the goal of its own, or the goal
// itself if there are no more. What remains of the route leads there.
PlanGoal PlaceOfGoal(const PlanGoal& goal, int target);

// Whether all places that two goals' ways have in common are at most tolerance_m apart, and the
// first goal is one of the second one's places or lies beyond them. False for different lists.
// Where neither has vias this is not the question. Cost: the vias.
bool AreOfOneWay(const PlanGoal& earlier, const PlanGoal& later, float tolerance_m);

// A place on a path of n points: on the chord from `point` to the next one.
struct PathPlace {
  int32_t point = 0;           // 0 to n - 2
  float share = 0.0f;          // of that chord, 0 to 1
  float along_m = 0.0f;        // from the path's first point
  float cross_track_m = 0.0f;  // distance to the projected point, never negative
};

// The state that a path specifies at one place.
struct PathState {
  Pose2 pose;  // odom; the heading is the vehicle's, in reverse too
  // Of the heading over the distance in its own direction: a path has the same in reverse.
  float curvature_per_m = 0.0f;
  float speed_mps = 0.0f;  // a magnitude
  bool reverse = false;    // driven in reverse
};

// It begins at most two chords behind the vehicle's position at publication, and ends at rest
// within checked ground. Steps forward or in reverse, and turns on the spot. Where the direction of
// driving changes there is one, if only of 0 rad: the vehicle has to stand there.
struct CommittedPlan {
  uint32_t number = 0;  // of the path, incremented for a new one; 0: there is no plan
  Status status = Status::kNotStarted;  // of its planning: usable, with any restriction
  WorldPath path;                       // [n], n >= 2 where number is not 0
  ActuatorPath actuator;                // [n - 1]
  SpeedProfile speed;                   // [n]; [0] holds at and before start_along_m
  float start_along_m = 0.0f;           // the vehicle's place at publication
  float start_curvature_per_m = 0.0f;   // at path[0], which has no incoming chord any more ...
  float start_turn_rad = 0.0f;          // ... and its turn
  FixedVector<float, kMaxPathPoints> room_m;  // [n] beside the footprint, see SpeedCaps::room_m
  int32_t slow_points = 0;                    // first points driven slowly, out of an obstacle
  // The first of these, which lead out of a place without room to turn (core/autonomy/lead_out.h).
  int32_t lead_points = 0;
  GroundAhead ground;         // along it, which its speeds are for
  bool narrow = false;        // has a place with little room, driven at min_speed_mps there
  bool creeps = false;        // over hidden ground (SpeedCaps), at the vehicle's place
  bool is_stop = false;       // cut short to come to rest: it has no goal
  bool reaches_goal = false;  // its end is the goal itself
  PlanGoal goal;              // that it was planned for
  uint64_t checked_ns = 0;    // when the plan began whose map was used for the check
};
static_assert(std::is_trivially_copyable_v<CommittedPlan>);

// Whether the chord after a point has no length: a turn on the spot. False for the last point.
bool TurnsOnTheSpotAt(const WorldPath& path, int point);

// The first point from `point` on where the vehicle must stand: a turn on the spot or the end.
// Precondition: 0 <= point < size. Cost: one pass.
int StandingPoint(const WorldPath& path, int point);

// The first point after `point` that the plan reaches at rest, otherwise `last`; the vehicle's
// position at publication and points before it do not count. Precondition: 0 <= point < last <
// size. Cost: one pass.
int RestPoint(const CommittedPlan& plan, int point, int last);

// The first point still needed by a vehicle on the chord after `point`: one point earlier, because
// the next projection may be slightly further back, but none before a turn on the spot.
int FirstKept(const WorldPath& path, int point);

// Distance along the path from its first point to a point [m]. Cost: one pass.
float WayTo(const WorldPath& path, int point);

// Turn from the chord before a point to the one after it; `at_start` for the first point, 0 for the
// last and where a chord has no length. Constant cost.
float TurnAt(const WorldPath& path, int point, float at_start_rad);

// Curvature where the chords before and after a point meet; `at_start` for the first, 0 for the
// last. Constant cost.
float CurvatureAt(const WorldPath& path, int point, float at_start_per_m);

// The nearest place of the path within search_m along it from its first point, and not beyond a
// turn on the spot that is still to be made. Such a turn counts as made if the vehicle stands at
// its place and has the heading that follows it (to kTurnDone_rad), or if it is one of 0 rad. A
// path that begins with a turn not made yet gives its first point. Precondition: at least two
// points. Cost: one pass.
inline constexpr float kTurnDone_rad = 0.1f;
inline constexpr float kAtPoint_m = 0.3f;
PathPlace Project(const WorldPath& path, const Pose2& pose, bool stands, float search_m);

// Position on the chords. The heading turns evenly from the middle of one chord to the middle of
// the next, the curvature changes linearly between points, and the speed follows constant
// acceleration. So all four are continuous along the path, except at turns on the spot, where the
// following chord applies. along_m is clamped to the path. All zero without a plan. Cost: one pass.
PathState StateAt(const CommittedPlan& plan, float along_m);

// Curvature along the path from along_m on, every step_m, as in PathState: 0 from the first place
// on where the vehicle stands, and without a plan. Precondition: step_m > 0. Cost: one pass over
// the path and the results.
void CurvaturesFrom(const CommittedPlan& plan, float along_m, float step_m,
                    std::span<float> curvature_per_m);

// Adds the decisions: every field except the goal, the steps (which follow from the path), the room
// and checked_ns.
void AddToHash(const CommittedPlan& plan, DecisionHash& hash);

}  // namespace hardpack
