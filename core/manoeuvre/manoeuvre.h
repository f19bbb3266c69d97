// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/astar/astar.h"
#include "core/base/footprint.h"
#include "core/base/pose.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "core/path/path.h"

// A way out in several moves: a bounded search over position, heading and direction, for a vehicle
// that stands where neither a path nor a lead-out begins (three-point turns, out of a parking
// space, around a corner tighter than it can steer). It ends where the rest can be planned as ever.
//
// States. From the start, along its heading, the vehicle drives chords of one length c, forward or
// in reverse. Between two chords in the same direction it turns by one of kHeadings-th of a circle
// to either side, or not; where it changes direction it stands, and does not turn. c is such that
// such a turn is the sharpest that it may drive, turn = curvature * c, and at least kLeastChord_m.
// So at each state it is at the end of a chord, along its heading, and may stop there.
//
//         1           c = 0.26 m, 1/64 of a circle: a radius of 2.7 m
//   [>]---o---o      at each: straight on, left, right; or back, along the same line
//          \   \2
//
// Of the states in one bin (kBin of a chord along x and y, one heading, one direction) only the
// cheapest is kept. A bin is as small as what a move gains in a tight place: coarser ones lose the
// way out of a parking space. Most are never reached; those that are stand in a hash table.
//
// Costs are whole numbers: kForward for a chord, kReverse for one in reverse, kChange more where
// the direction changes. The outline itself is held against the hard cells, at the end of each
// chord, and at and halfway through each turn; it keeps a margin, or within kNearStart_m of a start
// that is closer to something, half of what it has there, in quarters.
//
// The search is A* with a bucket queue. Its heuristic, the chords that are left to the nearest
// place and heading where it may end, is consistent; it counts kHeuristicWeight times, so that few
// states are searched: the way found costs at most that many times the least over this graph
// (weighted A*, REFERENCES.md, [Pohl1970]). What is not the cheapest in its bin is lost, so a way
// in continuous space may be cheaper still. Ours; the binning is that of hybrid A* (REFERENCES.md,
// [Dolgov2008]).
//
// Where it may end. Beside the way that was searched for points (at most kReach_m from it), at or
// beyond its point `first`, outside the region that the search never enters: where the vehicle
// could turn on the spot, or along the way's direction, to kAligned_rad. Without such a way,
// anywhere that a search from the goal gets to. Whether a path leads on from there only its planner
// knows. If none does, RefuseFound and LeadBeyond continue the search behind it.

namespace hardpack {

class Manoeuvre {
 public:
  static constexpr int kHeadings = 64;
  static constexpr float kLeastChord_m = 0.2f;
  static constexpr float kMostChord_m = 0.75f;  // a radius of 7.6 m; with more it does not search
  static constexpr int kReach_chords = 28;      // of the square searched, to each side of the start
  static constexpr int kMaxStates = 32767;
  static constexpr int kMaxWayPoints = 64;
  static constexpr int kForward = 4;
  static constexpr int kReverse = 6;
  static constexpr int kChange = 12;
  static constexpr uint32_t kHeuristicWeight = 2;
  static constexpr int kMaxCost = 480;                        // 120 chords forward
  static constexpr int kMaxPoints = kMaxCost / kForward + 1;  // a change adds one, and costs more
  static_assert(kChange >= kForward);
  static constexpr int kMaxRefused = 8;
  static constexpr float kReach_m = 1.2f;
  static constexpr float kAligned_rad = 0.35f;
  static constexpr float kNearStart_m = 2.0f;
  // In a turn PathCheck asks for more: half of what a corner moves by between its poses, which are
  // twice as many as here.
  static constexpr float kTurnMargin_m = 0.04f;
  static constexpr int kSlotBits = 17;
  static constexpr int kSlots = 1 << kSlotBits;  // of the hash table: four times the states
  static constexpr int kClear_slots = 2048;      // in a unit
  static constexpr int kMaxProbes = 64;  // for the slot of a state; hardly ever more than ten
  static constexpr int kMotions = 4;
  static constexpr int kMaxUnits = kSlots / kClear_slots + kMaxStates * (1 + kMotions) + 1;

  // start: where the vehicle stands, odom, its heading in (-pi, pi]. way: points that the search
  // found, or empty; the first kMaxWayPoints of them count. kOk; kParameterOutOfRange: a chord
  // longer than kMostChord_m; kStartOutsideMap; kStartInObstacle: the outline touches something.
  // result as status(). Cost: constant.
  Status Begin(const Costmap& map, const VehicleParams& vehicle, const PathParams& params,
               float max_curvature_per_m, const Pose2& start, const WorldPath& way);

  // A unit is kClear_slots slots cleared, a state taken from the open set, or a chord from
  // it tried. At most kMaxUnits, whatever is refused.
  // from_goal: without a way, a search that began at the goal, done; with one it is not asked.
  Progress Step(const Costmap& map, const AstarSearch& from_goal, int units);

  // kNotStarted while busy; kOk: found; kNoPath: all that it can get to has been searched, within
  // the square and kMaxCost; kCapacityExceeded: kMaxStates or kMaxProbes were not enough; or why
  // Begin failed.
  Status status() const { return status_; }

  // The way found. Its first point is the start, its last has the last chord's heading; where the
  // direction changes two points share a place. Cleared if none is found.
  void Poses(WorldPath& path) const;
  int cost() const { return status_ == Status::kOk ? nodes_[found_].cost : 0; }
  bool has_way() const { return way_points_ > 0; }
  int states() const { return used_nodes_; }

  // Goes on behind a way found, which is not to be ended near its last pose again (kRefused_chords
  // and kRefused_headings). The same states are never searched twice. kMaxRefused times, then it is
  // done: kNoPath.
  void RefuseFound();
  static constexpr int kRefused_chords = 2;
  static constexpr int kRefused_headings = 3;

  // Raises `first`, which is 0 at the beginning, to behind the point of the way that is nearest to
  // a place: there the rest could not be driven. By more than `beyond_m`. No effect if that is no
  // further than it is.
  void LeadBeyond(Vec2 place_odom, float beyond_m);

 private:
  // Of a chord's length; a bin is 0.4 of it, and a chord ends in another one.
  static constexpr int kUnitsPerChord = 1024;
  static constexpr int kBin = 410;
  static constexpr int kReach_units = kReach_chords * kUnitsPerChord;
  static constexpr int kSide_bins = 2 * kReach_units / kBin + 1;
  static constexpr uint32_t kBuckets = 1024;  // of cost and weighted heuristic
  static constexpr uint32_t kWordBits = 32;
  static constexpr uint32_t kBucketWords = kBuckets / kWordBits;
  static constexpr uint16_t kNone = 0;  // no node; their numbers begin with 1

  struct Node {
    int16_t x = 0;  // in units, along and across the start's heading
    int16_t y = 0;
    uint8_t heading = 0;  // of the chord that ends here, from the start's, anticlockwise
    uint8_t reverse = 0;  // the direction of that chord
    uint16_t parent = kNone;
    uint16_t cost = 0;
    uint16_t next = kNone;  // in its bucket
  };
  static_assert(sizeof(Node) == 12);

  enum class Phase : uint8_t { kDone, kClear, kTake, kChords };

  void KeepWay(const WorldPath& way);
  uint32_t CostLeft(const Node& node) const;
  void FillTurnsLeft();
  void DoUnit(const Costmap& map, const AstarSearch& from_goal);
  void ClearSlots();
  void Take(const Costmap& map, const AstarSearch& from_goal);
  void TryChord(const Costmap& map);
  bool IsFree(const Costmap& map, const Pose2& pose, float more_m = 0.0f) const;
  bool IsSweptFree(const Costmap& map, const Node& from, const Node& to) const;
  bool MayEnd(const Costmap& map, const AstarSearch& from_goal, const Node& node) const;
  bool IsRefused(const Node& node) const;
  int NearestOfWay(Vec2 place_odom) const;
  Pose2 PoseOf(const Node& node) const;
  static uint32_t BinOf(const Node& node);
  int32_t SlotOf(const Node& node) const;
  bool Changes(const Node& node) const;
  uint32_t BucketOf(const Node& node) const;
  void Push(const Node& node, int32_t slot);
  void End(Status status);

  Status status_ = Status::kNotStarted;
  Phase phase_ = Phase::kDone;
  Footprint footprint_;
  VehicleParams vehicle_;
  PathParams params_;
  Pose2 start_;
  SinCosPair start_heading_ = {};
  float chord_m_ = 0.0f;
  float margin_m_ = 0.0f;
  float near_margin_m_ = 0.0f;  // within kNearStart_m of the start
  bool can_pivot_ = false;
  int32_t way_points_ = 0;
  int32_t first_ = 0;
  int32_t first_led_ = 0;  // of it when the search began: the heuristic's
  int32_t cleared_ = 0;    // slots
  int32_t used_nodes_ = 0;
  int32_t refused_ = 0;
  int32_t motion_ = 0;  // next from taken_
  uint16_t taken_ = kNone;
  uint16_t found_ = kNone;
  uint32_t used_[kBucketWords] = {};  // a bit for each bucket that is not empty
  uint16_t head_[kBuckets] = {};
  uint8_t turns_left_[kHeadings] = {};  // to the nearest heading at which it may end
  int16_t chord_x_[kHeadings] = {};
  int16_t chord_y_[kHeadings] = {};
  Pose2 way_[kMaxWayPoints] = {};
  uint16_t refused_ends_[kMaxRefused] = {};
  uint16_t slots_[kSlots] = {};  // the cheapest node of a bin
  Node nodes_[kMaxStates + 1];
};
static_assert(std::is_trivially_copyable_v<Manoeuvre>);
static_assert(sizeof(Manoeuvre) <= 2 * Manoeuvre::kSlots + 12 * Manoeuvre::kMaxStates + 8192);

}  // namespace hardpack
