// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/footprint.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/progress.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"

// The lead-out of a place without room to turn: along the present heading, straight or gently
// curved, until the vehicle could turn on the spot. The rest of the path is planned from there. It
// ignores the path to the goal (core/astar handles that). Ours.
//
//      ################
//     [ > ]- - - - - - - - -(o)        straight on; arcs of kBends to both sides, where a straight
//                          /            way is blocked or longer by more than what a bend costs
//                         v
//
// A vehicle that cannot turn on the spot (core/kinematics) turns while driving instead: along a
// feasible arc, of kBendShares of its largest curvature, until the goal is roughly ahead and the
// search may begin there: not in the region that it never enters.
//
// All of these in reverse too, if asked for: the rear goes first, and a bend of the same sign turns
// the vehicle the other way.
//
// The check is coarse: a hard cell counts by its centre, which must not lie deeper in the outline
// than at the start plus kCellTolerance_m. Whether a lead-out may be driven is decided by the check
// (core/safety/path_check.h), as for any other path; if not, RefuseFound looks for the next one.

namespace hardpack {

class LeadOut {
 public:
  static constexpr float kStep_m = 0.1f;
  static constexpr int kStepsPerPoint = 3;  // between two points of the result
  static constexpr float kMaxLength_m = 12.0f;
  // The same in reverse, and for a vehicle that cannot turn on the spot: more than half a circle of
  // 7 m.
  static constexpr float kLongStep_m = 0.2f;
  static constexpr float kMaxLongLength_m = 24.0f;
  static constexpr float kFirstChord_m = 0.1f;  // of the result, at most
  static constexpr int kMaxPoses = 121;
  static constexpr float kBends_per_m[] = {0.0f, 0.08f, -0.08f, 0.2f, -0.2f, 0.4f, -0.4f};
  static constexpr int kBends = sizeof(kBends_per_m) / sizeof(kBends_per_m[0]);
  static constexpr float kBendShares[kBends] = {0.0f, 0.5f, -0.5f, 0.75f, -0.75f, 1.0f, -1.0f};
  // The goal counts as ahead: within this angle a path can be joined easily.
  static constexpr float kAhead_rad = 0.5f;
  static constexpr int kMaxUnits = kBends * kMaxPoses;
  static constexpr float kBendCost_m2 = 4.0f;  // distance equivalent of a bend, per curvature
  static constexpr float kCellTolerance_m = 0.06f;
  static constexpr int kMaxSide_cells = 64;

  // The ways to be looked at.
  struct Ways {
    bool reverse = false;
    float least_m = 0.0f;       // their length ...
    float longest_m = 0.0f;     // ... forward, a vehicle that cannot turn on the spot ignores this
    int32_t first_bend = 0;     // those of kBends from this ...
    int32_t end_bend = kBends;  // ... to before this one
  };

  // A vehicle that can turn on the spot ignores goal_odom. Preconditions: finite, 0 <= first_bend
  // <= end_bend <= kBends.
  void Begin(const VehicleParams& vehicle, const PathParams& params, const Pose2& start,
             Vec2 goal_odom, const Ways& ways);

  // A unit is one pose of one lead-out. At most kMaxUnits.
  Progress Step(const Costmap& map, int units);

  // Once one is found: searches again, excluding its bend. At most kBends times.
  void RefuseFound();

  // Once done: whether there is one. It is the shortest, including the cost of bends; its first
  // point is the start, its last where the vehicle may turn. Its headings are those of its chords.
  bool found() const { return best_bend_ >= 0; }
  // Of the lead-out found, where what follows it begins: in reverse the vehicle stands there, and
  // may steer before it drives on.
  float curvature_per_m() const { return found() && !reverse_ ? Bend(best_bend_) : 0.0f; }
  void Poses(WorldPath& path) const;

 private:
  float Bend(int bend) const;  // [1/m]
  float Cost_m(int bend) const;
  bool IsOut(const Costmap& map, const Pose2& pose) const;
  Pose2 PoseAt(int bend, float along_m) const;
  bool Touches(const Costmap& map, const Pose2& pose) const;
  float Depth(const Pose2& pose, const SinCosPair& heading, Vec2 point_odom) const;
  void EndBend();

  Footprint footprint_;
  VehicleParams vehicle_;
  PathParams params_;
  Pose2 start_;
  Vec2 goal_odom_;
  bool can_pivot_ = true;
  bool reverse_ = false;
  float most_curvature_per_m_ = 0.0f;
  float step_m_ = kStep_m;
  float least_m_ = 0.0f;
  float longest_m_ = 0.0f;
  int32_t reach_cells_ = 0;
  int32_t first_bend_ = 0;
  int32_t bends_ = 0;
  uint32_t refused_ = 0;  // one bit per bend
  int32_t bend_ = 0;      // being searched, ...
  int32_t pose_ = 0;      // ... its next pose
  int32_t best_bend_ = -1;
  float best_m_ = 0.0f;
  float best_cost_m_ = 0.0f;
};
static_assert(std::is_trivially_copyable_v<LeadOut>);

}  // namespace hardpack
