// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/autonomy/planner.h"
#include "tools/sim/experiment/run_result.h"
#include "tools/sim/world/named_worlds.h"

// What the worlds of the experiments are to show of the way: how far a plan was bent from its base
// path, on which side it leads around the thing in the middle, whether an overshoot was corrected,
// how near to the middle of a corridor it was driven. Frame: the world's.

namespace hardpack::mission {

// Of a point to a path: the distance to its nearest chord; infinite where there is none.
double DistanceToPath_m(world::Point2 point, std::span<const world::Point2> path);

// How far beside it: the same, but the path goes on straight behind its ends.
double CrossTrack_m(world::Point2 point, std::span<const world::Point2> path);

// The largest distance of a point of the plan's path from its base path [m]; 0 without one of both.
double OffBase_m(const Plan& plan);

class WayWatch {
 public:
  // An overshoot is further from the committed path than this, and is over below the other.
  static constexpr double kOvershoot_m = 0.2;
  static constexpr double kRecovered_m = 0.1;

  // Both outlive it.
  WayWatch(const world::Scenario& scenario, experiment::WayResult& result);

  // A path was committed while the vehicle was at `here`; is_replan: it took the place of another.
  void Committed(std::span<const world::Point2> path, world::Point2 here, bool is_replan);
  // The vehicle is at `here`.
  void Moved(world::Point2 here);
  // It follows a path, and is so far beside it.
  void Followed(double t_s, double cross_track_m);

 private:
  enum class PassingSide { kNone, kLeft, kRight };

  struct Place {  // seen from the landmark's middle: towards the goal, and to the left of that
    double along_m = 0.0;
    double left_m = 0.0;
  };
  Place PlaceOf(world::Point2 point) const;
  PassingSide SideOf(std::span<const world::Point2> path) const;

  const world::Scenario& scenario_;
  experiment::WayResult& result_;
  double forward_x_ = 1.0;  // from start to goal, length 1
  double forward_y_ = 0.0;
  PassingSide side_ = PassingSide::kNone;
  double overshot_since_s_ = 0.0;
};

}  // namespace hardpack::mission
