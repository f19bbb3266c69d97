// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/areas/area_set.h"
#include "core/base/footprint.h"
#include "core/base/progress.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"
#include "core/path/route.h"
#include "core/people/walker.h"
#include "core/speed/brow.h"
#include "core/speed/hidden_ground.h"
#include "core/speed/speed.h"

// Speed limits from the surroundings along a checked path (docs/algorithm.md sections 6 and 8): at
// each point the speed from which the vehicle can still stop within the rest of the path, since
// nothing beyond its end was checked, and before the end of the observed ground; the lowest speed
// where there is little room; and the caps for people beside it. It does not look for obstacles on
// the path: the check has.
//
//        |<- free ->|<- the front, unseen_margin_m ------->|
//   o====o==========+=====================================#? ? ? ?o   # end of the observed ground
//
// The observed ground ends where, on one of five tracks, no cell has been observed
// (Costmap::kObserved) for more than max_unseen_m. The tracks are the path's own and kAside of the
// width to either side, under the wheels and where they are if the vehicle is beside its path.
// Shorter stretches are gaps left by the lidar's ring spacing and the spacing of directions. The
// search extends beyond the path's end by what is kept free before it: the length ahead of the axle
// plus unseen_margin_m. A path begins at the vehicle, so its first point counts as observed.
//
// In reverse the rear goes first, max_reverse_mps is the most, and what lies behind the place where
// the direction changes is looked at as far as behind a path's end.
//
// Ground that is hidden (core/speed/hidden_ground.h, brow.h) does not end it within the next
// kCreepAhead_m: of such a stretch only the part that is not hidden counts. Where the vehicle's
// front is over a longer one than max_unseen_m, or unseen_margin_m before it, hidden_creep_mps is
// the most. With 0, hidden ground is as any other.
//
// Growth on one of the tracks (Costmap::kGrowth) may hide lower objects: growth_speed_mps at most
// along the chord over it.
//
// There is little room where a hard cell's centre is closer to the centre of one of the discs that
// cover the outline (core/base/footprint.h) than its radius plus half a cell's diagonal plus
// narrow_room_m: min_speed_mps at most there.
//
// A plan's room must cover the possible errors of tracker and odometry there. So the speed is at
// most that at which
//   track_error_m + track_error_s v + track_error_s2 v^2 kappa
// fits into the distance from the discs to the nearest hard cell, less half a cell, with kappa the
// largest curvature of the last kBendBehind_m and the next kBendAhead_m of the path.
//
// People are those that the owner tells of (core/people), or without them the cells of people in
// the map; with more people than kMaxWalkers both. Of somebody who walks at v it counts how late
// they can be at a point of the path, if they set off or turn towards it with kSetsOff_mps2 up to
// person_speed_mps: as late as somebody who walks there at person_speed_mps from
//   way + (person_speed - u)^2 / (2 a),  u = (v towards the point) + doubt, at most person_speed
// away. So whoever walks away is farther off by up to 3.2 m (docs/decisions/0052).
//
// Where the outline touches a speed zone (core/areas), longer by the chord before or after the
// point and kZoneAhead_m at each end, and wider by track_error_m, the zone's speed is the most. So
// the vehicle has slowed down before its front is in the zone, and speeds up when its rear has left
// it.

namespace hardpack {

// What limits the vehicle at a point.
enum class CapCause : uint8_t {
  kPathEnd,       // only the end of the checked path
  kUnseenGround,  // the observed ground ends before it
  kPerson,
  kLittleRoom,
  kGrowth,
  kLegLimit,  // the operator's limit for this leg of the mission
  kSpeedZone,
  kHiddenGround,  // no place has shown it: the vehicle creeps
  kReverse,
  kSteepGround,  // a way down on which it could not stop
};

class SpeedCaps {
 public:
  // path: as passed by the check, at least one point. speed_mps: the vehicle's present speed; the
  // time to pass somebody is computed from it at every point. walkers: null, or at most
  // kMaxWalkers. too_steep_m: along the path, before which it stands (core/speed/ground_ahead.h).
  // Cost: one pass over its points.
  void Begin(const GridWindow& window, const SpeedParams& params, const VehicleParams& vehicle,
             const WorldPath& path, float speed_mps, const Lookouts& lookouts = {},
             const Walkers* walkers = nullptr, float too_steep_m = kFar_m);

  // A unit is one of the walkers, one place looked at for a brow (core/speed/brow.h), one place on
  // a chord looked at for unobserved ground, on its tracks up to the first where there is some, one
  // row of the map searched for people (each of their cells goes to every point where the path
  // passes it), or kMaxPersonCells of their cells in it, or one point whose nearest person caps the
  // points before it, or one point in one speed zone. At most kMaxUnits units. areas, terrain:
  // null: none.
  static constexpr int kMaxPersonCells = 32;
  // Of a chord; on a longer one than 3.2 m they are farther apart than half a cell.
  static constexpr int kMaxSamples = 32;
  static constexpr int kTracks = BrowFinder::kTracks;
  static constexpr int kMaxUnits = kMaxWalkers + BrowFinder::kMaxUnits +
                                   kMapSize_cells * (kMapSize_cells / kMaxPersonCells + 1) +
                                   (1 + kTracks * kMaxSamples + kMaxAreas) * kMaxPathPoints;
  Progress Step(const Costmap& map, const SpeedParams& params, const VehicleParams& vehicle,
                const WorldPath& path, int units, const AreaSet* areas = nullptr,
                const Terrain* terrain = nullptr);

  // Once done: beyond the first place from `point` on where the vehicle must stand, it does not
  // drive any farther, whatever is allowed there. Before the vehicle has come to rest, nobody can
  // know when it will continue. Cost: one pass.
  void StandFrom(int point);

  // Once done: on each leg of the route its limit, up to the point behind the one where the path
  // passes the leg's end within reach_m. Behind a via that the path does not pass, the limit of the
  // leg to it stays. Cost: one pass for each via.
  void LimitLegs(const WorldPath& path, const Route& route, float reach_m);

  // [n] m/s, valid once Step has returned kDone.
  std::span<const float> cap_mps() const { return {cap_mps_, static_cast<size_t>(points_)}; }
  // For the cap at a point, 0 .. n - 1; valid with it.
  CapCause cause(int point) const { return cause_[point]; }
  // Whether there is little room anywhere.
  bool narrow() const { return narrow_; }
  // From the discs at a point to the nearest hard cell, less half a cell [m]; at most kFarRoom_m,
  // not below 0. Valid with cap_mps().
  float room_m(int point) const { return room_m_[point]; }
  static constexpr float kFarRoom_m = 10.0f;
  static constexpr float kBendBehind_m = 1.5f;
  static constexpr float kBendAhead_m = 0.5f;
  // What the vehicle may still be too fast for after its speed was lowered, by the drives' lag.
  static constexpr float kZoneAhead_m = 0.5f;
  // Farther away hidden ground ends the observed ground: until the vehicle is there, it may be
  // seen.
  static constexpr float kCreepAhead_m = 8.0f;
  // Distance along the path to the end of the observed ground; kFar_m if that is not on it.
  float observed_m() const { return observed_m_; }
  static constexpr float kFar_m = 1.0e3f;        // farther than any two points of a map
  static constexpr float kStanding_mps = 0.05f;  // a lower cap means to stand

 private:
  static constexpr float kAside[kTracks] = {-0.6f, -0.4f, 0.0f, 0.4f, 0.6f};  // of the width

  // What is at one place of the path, on the tracks.
  struct Look {
    bool grows = false;
    bool is_hidden = false;   // a stretch of hidden ground, longer than max_unseen_m, reaches here
    float hidden_m = kFar_m;  // where it begins, along the path
  };

  void BeginToLook(const Lookouts& lookouts);
  void LookForBrows(const Costmap& map, const Terrain& terrain, const VehicleParams& vehicle);
  void LookAlong(const Costmap& map, const VehicleParams& vehicle, const WorldPath& path);
  void SlowDownIn(int point);
  void CreepOver(float from_m, float to_m);
  void EndChord();
  void EndOverhang();
  bool HasOverhang(int chord) const;
  float LeadingEdge_m(int point) const {
    return reversed_[point] ? -footprint_.rear_m : footprint_.front_m;
  }
  float TrailingEdge_m(int point) const {
    return reversed_[point] ? footprint_.front_m : -footprint_.rear_m;
  }
  float AheadOf_m(int point) const { return LeadingEdge_m(point) + unseen_margin_m_; }
  bool LookAt(const Costmap& map, Vec2 place, Vec2 aside, float along_m, float step_m);
  void LookAtUnseen(bool is_hidden, float along_m, float step_m);
  bool IsHiddenAt(const Costmap& map, Cell cell, float along_m) const;
  void Lower(int point, float cap_mps, CapCause cause);
  void LimitBetween(int first, int last, float most_mps);
  int NearestHard2(const Costmap& map, const Pose2& pose) const;
  float RoomFor(int hard2_cells2) const;
  void FindBends(const WorldPath& path);
  float BendAt(int point) const;
  bool SearchRow(const Costmap& map);
  bool SkipToZone(const AreaSet* areas);
  void CapInZone(const AreaSet& areas, const SpeedParams& params, const WorldPath& path);
  void FilePerson(Vec2 person_odom);
  void FileWalker(const Walker& walker, const SpeedParams& params);
  void CapForPersonAt(int point, const SpeedParams& params, const VehicleParams& vehicle);

  float x_m_[kMaxPathPoints] = {};  // the path's points, odom frame
  float y_m_[kMaxPathPoints] = {};
  float along_m_[kMaxPathPoints] = {};  // distance from the start
  float cap_mps_[kMaxPathPoints] = {};
  float person2_m2_[kMaxPathPoints] = {};  // squared, to the nearest person filed with the point
  // For one person, to the points; padded at both ends with the first and the last.
  float distance2_m2_[kMaxPathPoints + 2] = {};
  float late_m_[kMaxPathPoints + 2] = {};  // for a walker
  Footprint footprint_;
  float reach_m_ = 0.0f;                   // people farther from the path are ignored
  float bend_per_m_[kMaxPathPoints] = {};  // magnitude of the curvature
  float room_m_[kMaxPathPoints] = {};
  CapCause cause_[kMaxPathPoints] = {};
  bool reversed_[kMaxPathPoints] = {};  // the chord after a point, or the last one before it
  float speed_mps_ = 0.0f;
  int32_t points_ = 0;
  int32_t chord_ = 0;        // looked along now; the one after the last is beyond the path, as is
                             // one without length behind a stretch in reverse
  int32_t sample_ = 0;       // places of it that were looked at
  int32_t track_ = 0;        // next, at the one after them
  Look look_;                // at that one, so far
  float observed_m_ = 0.0f;  // distance to the end of the observed ground
  float too_steep_m_ = kFar_m;
  BrowFinder brows_;
  float max_unseen_m_ = 0.0f;
  float growth_speed_mps_ = 0.0f;
  float unseen_margin_m_ = 0.0f;
  float max_reverse_mps_ = 0.0f;
  float room2_cells2_ = 0.0f;  // squared distance of a hard cell that leaves little room
  bool narrow_ = false;
  float seen_m_[kTracks] = {};  // for each track, distance to the last observed cell
  // The same, farther by what of the stretch behind it is hidden.
  float gap_from_m_[kTracks] = {};
  Lookouts lookouts_;
  float hidden_creep_mps_ = 0.0f;
  Walkers walkers_;
  bool uses_cells_ = true;  // of people: all of them may not be among the walkers
  int32_t walker_ = 0;      // next
  Cell low_;                // the part of the map to be searched
  Cell high_;
  int32_t row_ = 0;         // next, up to high_.y
  int32_t column_ = 0;      // next in it
  int32_t zone_ = 0;        // next, of the areas
  int32_t zone_point_ = 0;  // next in it
  int32_t point_ = 0;       // next
};
static_assert(std::is_trivially_copyable_v<SpeedCaps>);

}  // namespace hardpack
