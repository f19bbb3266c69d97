// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/footprint.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"
#include "core/safety/outline.h"

// The final check of a plan before it may be driven (docs/algorithm.md section 5, end): at full
// resolution, with the vehicle's outline itself (core/safety/outline.h), against the hard cells
// themselves. It trusts nothing that the planner computed except the map. It ignores soft obstacles
// and costs, and everything beyond the map's edge, which the outline may overhang although the
// path's points must stay on the map.
//
// The area swept between two tested poses is covered: along a chord the outline moves along its own
// length, so it sweeps nothing beyond the two poses; in a turn, or on a chord that is not along the
// heading, the required distance grows by half of the displacement of any of its points.
//
// A start that is closer to something than the margin, or in it, may be left, and nothing else.
// Until the outline is clear for the first time:
// - what it overlaps at the start it may overlap by no more than there plus kDeeperTolerance_m;
// - from anything that it does not overlap there, it keeps a distance: straight ahead of the front
//   and behind the rear, the margin or the distance at the start; beside the flanks, the distance
//   at the start to the nearest of all. Less kDeeperTolerance_m, or half of the distance at the
//   start.
//
// On the first chords a cell may overlap the line of a flank, by kAcross_m at most: the whole cell
// is hard here, but the motion sweep (core/safety/motion_sweep.h) knows where in it the object
// stands, and stops for that. Not so a cell that an area closes: it is closed as a whole, and such
// a cell may not be overlapped deeper than at the start either.

namespace hardpack {

inline constexpr float kClearanceReach_m = 2.0f;

struct PathCheckResult {
  // kOk; kNeedsManoeuvre: the path turns on the spot, or bends more than the vehicle can, and is
  // not examined further; kLimitExceeded; kNarrowGap: it begins closer to something than the
  // margin, without touching it; kStartInObstacle: it begins in something and drives out of it;
  // kCollision: it touches something, comes closer to it than the margin in any other way, or
  // leaves the map; kNotStarted while busy.
  Status status = Status::kNotStarted;
  // Least distance from the outline to a hard cell's square [m], including between the tested
  // poses; negative: overlap, by how far either would have to be moved. Saturates at
  // kClearanceReach_m. A lower bound while it leaves its start.
  float smallest_clearance_m = kClearanceReach_m;
  // Least distance from the axle's centre to a hard cell's centre [m]; saturates too.
  float smallest_hard_distance_m = kClearanceReach_m;
  int32_t smallest_clearance_point = 0;
  // The first point at which, or on the chord after which, it collides; -1 if it does not, or
  // collides only because it never gets clear of the start.
  int32_t collision_point = -1;
  // Points from the start until the outline is clear of everything closer than the margin, or until
  // it collides; 0 if it is clear from the start.
  int32_t overlap_points = 0;
  float curvature_excess_per_m = 0.0f;        // largest |kappa| - max, 0 when within
  float curvature_rate_excess_per_m2 = 0.0f;  // the same for |kappa'|
  float largest_curvature_per_m = 0.0f;
  int32_t sharpest_point = -1;  // where that is; -1: it bends nowhere
  float largest_curvature_rate_per_m2 = 0.0f;
  bool leaves_map = false;      // a point of the path is off the map
  bool start_overlaps = false;  // the outline overlaps or touches a hard cell at the start
};

class PathCheck {
 public:
  // path: poses of the path, including pivots (two points at one place). margin_m: distance that
  // the outline must keep. across_chords: on this many chords from the start, and for
  // kMaxAcrossPoses poses, cells may overlap a flank's line. kPathTooShort: fewer than two points;
  // kNotFinite; kParameterOutOfRange: an outline beyond Outline's limits or with the axle outside
  // of it, a margin beyond kMaxMargin_m, or a negative one. result().status says the same. Cost:
  // one pass over the points.
  Status Begin(const VehicleParams& vehicle, const OptimizerParams& limits, const WorldPath& path,
               float start_curvature_per_m, float margin_m, int across_chords = 0);

  // A unit is one pose: the chord after a point is divided evenly into pieces of at most half a
  // cell, and the turn at a point into pieces that move no point of the outline farther than a
  // quarter of a cell. The first pose that is clear of the start takes two units, as do clear poses
  // where cells may overlap a flank. kMaxUnits units end any check. Cost of a unit: a search along
  // the rows of (Outline::kMaxSpan_cells)^2 cells and of (2 kMiddleReach_cells + 1)^2, or while it
  // leaves its start, or where cells may overlap, kMaxNearCells cells.
  Progress Step(const Costmap& map, const WorldPath& path, int units);

  const PathCheckResult& result() const { return result_; }

  static constexpr float kLimitTolerance = 0.01f;     // of the limit itself
  static constexpr float kDeeperTolerance_m = 0.05f;  // a quarter of a cell
  // Of the flank: what a straight way may sweep by its own errors.
  static constexpr float kBesideFlank_m = 0.02f;
  static constexpr float kAcross_m = kCellSize_m - kBesideFlank_m;
  static constexpr int kMaxAcrossPoses = 512;  // 51 m, straight on
  static constexpr float kMaxMargin_m = 0.5f;
  static constexpr int kMiddleReach_cells = 11;  // kClearanceReach_m, and one more
  static constexpr int kMaxNearCells = 256;      // at the start; more of them cannot be left

  // A chord within the map is at most its diagonal long, 512 sqrt(2) cells; a longer one is not
  // divided further, since it ends (or began) off the map.
  static constexpr int kMaxChordSamples = 1450;
  // Half a turn of the farthest corner, 6.33 m from an axle at one end, plus one.
  static constexpr int kMaxTurnSamples = 400;
  static constexpr int kMaxUnits =
      kMaxPathPoints * (kMaxChordSamples + kMaxTurnSamples) + 1 + kMaxAcrossPoses;

 private:
  enum class Phase : uint8_t { kTurn, kChord, kDone };

  void JudgeShape(const WorldPath& path, float start_curvature_per_m);
  bool CanDrive(const VehicleParams& vehicle, const WorldPath& path) const;
  void StepOnce(const Costmap& map, const WorldPath& path);
  void EnterNext(const WorldPath& path);
  bool MayLieAcross() const { return point_ < across_chords_ && across_left_ > 0; }
  bool JudgePose(const Costmap& map, const Pose2& pose);
  void JudgeClear(const Costmap& map, const Pose2& pose, const Outline& outline);
  void JudgeMiddle(const Costmap& map, const Pose2& pose);
  void LeaveStart(const Costmap& map, const Outline& outline);
  void LeaveCell(const Outline& outline, int32_t x, int32_t y, uint32_t flags);
  float LeastLeft(const CellApart& now, const CellApart& at_start, uint32_t flags) const;
  void NoteClearance(float clearance_cells);
  void Collide();
  void Finish(const WorldPath& path);

  PathCheckResult result_;
  Footprint footprint_;
  OptimizerParams limits_;
  float margin_cells_ = 0.0f;
  int32_t across_chords_ = 0;
  int32_t across_left_ = kMaxAcrossPoses;
  Phase phase_ = Phase::kDone;
  int32_t point_ = 0;      // being turned at, or whose chord is being driven
  int32_t sample_ = 0;     // tested so far in this phase
  int32_t samples_ = 0;    // of this phase
  float turn_rad_ = 0.0f;  // of this phase
  float between_cells_ =
      0.0f;  // half of what a point of the outline moves by from sample to sample
  float nearest_cells_ = 0.0f;      // outline to a hard square, over all poses so far
  float middle2_cells2_ = 0.0f;     // axle's centre to a hard cell's centre
  bool was_clear_ = false;          // of the start
  bool is_clear_ = false;           // the same, and this pose must not touch anything
  bool has_start_ = false;          // the first pose was tested
  Outline start_;                   // the first pose's
  float start_least_cells_ = 0.0f;  // to the nearest that it does not overlap
  // For the pose being tested while it leaves its start.
  int32_t near_left_ = 0;
  float least_cells_ = 0.0f;         // to the nearest of all
  float asked_cells_ = 0.0f;         // from what it is clear of
  float least_across_cells_ = 0.0f;  // what is no less aside may overlap the line of a flank
};
static_assert(std::is_trivially_copyable_v<PathCheck>);

}  // namespace hardpack
