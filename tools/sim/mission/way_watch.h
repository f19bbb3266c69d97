// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/autonomy/planner.h"
#include "tools/sim/experiment/run_result.h"
#include "tools/sim/world/named_worlds.h"

// Measures of the path for the experiments: how far a plan was bent from its base path, on which
// side it passes the obstacle in the middle, whether an overshoot was corrected, how close to the
// middle of a corridor the vehicle drove. Frame: the world's.

namespace hardpack::mission {

// Distance from a point to the nearest chord of a path; infinite if there is none.
double DistanceToPath_m(world::Point2 point, std::span<const world::Point2> path);

// The same, but with the path extended in a straight line beyond its ends.
double CrossTrack_m(world::Point2 point, std::span<const world::Point2> path);

// The largest distance of a point of the plan's path from its base path [m]; 0 if either is
// missing.
double OffBase_m(const Plan& plan);

class WayWatch {
 public:
  // An overshoot begins further than this from the committed path, and ends below the second limit.
  static constexpr double kOvershoot_m = 0.2;
  static constexpr double kRecovered_m = 0.1;

  // Both must outlive it.
  WayWatch(const world::Scenario& scenario, experiment::WayResult& result);

  // A path was committed while the vehicle was at `here`; is_replan: it replaced another.
  void Committed(std::span<const world::Point2> path, world::Point2 here, bool is_replan);
  // The vehicle is at `here`.
  void Moved(world::Point2 here);
  // The vehicle follows a path, at this distance from it.
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
