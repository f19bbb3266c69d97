// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"

// The last judge of a plan before it may be driven (docs/algorithm.md section 5, end): at full
// resolution, with the footprint's discs, against the hard cells themselves. It trusts nothing that
// the planner computed but the map. Soft obstacles and costs are not its business; nor is what lies
// beyond the map's edge, which the footprint may overhang while the path's points may not leave it.

namespace hardpack {

inline constexpr float kClearanceReach_m = 2.0f;

struct PathCheckResult {
  // kOk; kLimitExceeded; kStartInObstacle: the footprint overlaps a hard cell at the start and
  // drives out of it without going deeper (by more than kDeeperTolerance_m); kCollision: it
  // overlaps one in any other way, or the path leaves the map; kNotStarted while busy.
  Status status = Status::kNotStarted;
  // Least distance from the footprint's discs to a hard cell's square [m]; negative: overlap depth
  // (at most a disc's radius). Saturates at kClearanceReach_m.
  float smallest_clearance_m = kClearanceReach_m;
  // Least distance from the vehicle's middle to a hard cell's centre [m]; saturates too.
  float smallest_hard_distance_m = kClearanceReach_m;
  int32_t smallest_clearance_point = 0;
  // The first point at which, or on the chord behind which, it collides; -1 when it does not, or
  // only does because it never gets clear of the start.
  int32_t collision_point = -1;
  // Points from the start on until the footprint is, and stays, clear, or until it collides; 0 when
  // it is clear until then.
  int32_t overlap_points = 0;
  float curvature_excess_per_m = 0.0f;        // largest |kappa| - max, 0 when within
  float curvature_rate_excess_per_m2 = 0.0f;  // the same for |kappa'|
  float largest_curvature_per_m = 0.0f;
  float largest_curvature_rate_per_m2 = 0.0f;
  bool leaves_map = false;  // a point of the path is off the map
};

class PathCheck {
 public:
  // path: poses of the path, pivots included (two points at one place). kPathTooShort: fewer than
  // two points; kNotFinite; kParameterOutOfRange: a footprint beyond kMaxFootprint_m, or negative.
  // result().status says the same. Cost: one pass over the points.
  Status Begin(const VehicleParams& vehicle, const OptimizerParams& limits, const WorldPath& path,
               float start_curvature_per_m);

  // A unit is one pose: the chord behind a point is cut evenly into pieces of at most half a cell,
  // and the turn at a point into pieces that move no disc further than that. On the way from sample
  // to sample a disc's centre is never further than a quarter of a cell from one of them. kMaxUnits
  // units end any check. Cost of a unit: at most three scans of (2 kMaxScan_cells + 1)^2 cells.
  Progress Step(const Costmap& map, const WorldPath& path, int units);

  const PathCheckResult& result() const { return result_; }

  static constexpr float kLimitTolerance = 0.01f;     // of the limit itself
  static constexpr float kDeeperTolerance_m = 0.05f;  // a quarter of a cell
  static constexpr float kMaxFootprint_m = 2.5f;      // largest disc radius, and disc offset
  static constexpr int kMaxScan_cells = 24;           // reach and radius, in cells, and one more

  // A chord within the map is at most its diagonal long, 512 sqrt(2) cells; a longer one is cut
  // into no more pieces, since it ends (or began) off the map.
  static constexpr int kMaxChordSamples = 1450;
  static constexpr int kMaxTurnSamples = 80;  // pi kMaxFootprint_m / half a cell, and one more
  static constexpr int kMaxUnits = kMaxPathPoints * (kMaxChordSamples + kMaxTurnSamples);

 private:
  enum class Phase : uint8_t { kTurn, kChord, kDone };

  void JudgeShape(const WorldPath& path, float start_curvature_per_m);
  void StepOnce(const Costmap& map, const WorldPath& path);
  void EnterNext(const WorldPath& path);
  void JudgePose(const Costmap& map, const Pose2& pose);
  // One disc's overlap with what it stands in at the start.
  struct DiscOverlap {
    float deepest_m = 0.0f;       // the clearance below which the overlap has become deeper
    bool overlapped = false;      // some pose so far did
    bool overlaps = false;        // the last pose did
    bool has_been_clear = false;  // some pose so far was
  };
  void JudgeOverlap(float clearance_m, DiscOverlap& disc);
  void Collide();
  void Finish(const WorldPath& path);

  PathCheckResult result_;
  VehicleParams vehicle_;
  OptimizerParams limits_;
  Phase phase_ = Phase::kDone;
  int32_t point_ = 0;             // the one being turned at, or whose chord is being driven
  int32_t sample_ = 0;            // judged so far in this phase
  int32_t samples_ = 0;           // of this phase
  float turn_rad_ = 0.0f;         // of this phase
  float nearest2_cells2_ = 0.0f;  // of a disc's centre to a hard square, over all poses so far
  float middle2_cells2_ = 0.0f;   // of the vehicle's middle to a hard cell's centre
  DiscOverlap front_;
  DiscOverlap rear_;
};
static_assert(std::is_trivially_copyable_v<PathCheck>);

}  // namespace hardpack
