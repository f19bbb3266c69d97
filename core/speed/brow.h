// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"
#include "core/costmap/terrain.h"
#include "core/path/path.h"

// The brow of a hill on a path: where the ground that the vehicle has climbed ends, as far as it is
// seen. What lies behind it cannot be seen from anywhere before: a vehicle that drives up looks
// over it, and on the top it falls away below the lowest beam.
//
//              o lookout . . . . . . . . .
//           o===o______
//        //            \\ ?
//      //                \\ ? ? hidden          to_m: where the map tells it again, if it does
//    //                    \\ ? ? ____
//   climbed                from_m
//
// A ditch, a pond and lost data are no brow: the first has a far edge that is as high, the others
// are not on top of what was climbed. A ditch right behind a brow is told by a wheel that drops
// (core/safety/ground_watch.h), as in any hidden ground (docs/decisions/0058-brows.md). Ours.

namespace hardpack {

struct Brow {
  static constexpr float kFar_m = 1.0e3f;

  // Along the path, both kFar_m without a brow.
  float from_m = kFar_m;
  float to_m = kFar_m;

  bool Hides(float along_m) const { return along_m >= from_m && along_m <= to_m; }
};

// The chords of a path: [points] each; reversed of the chord after a point.
struct PathChords {
  const float* x_m = nullptr;
  const float* y_m = nullptr;
  const float* along_m = nullptr;
  const bool* reversed = nullptr;
  int points = 0;
};

// Looks along a path, as far as kReach_m or its first stretch in reverse, on tracks beside it: from
// the first stretch of more than max_unseen_m that is not observed, as long as what is seen again
// rises less than the climb that led to it, by kBends in the climb's direction: so it does not
// matter how the path meets a brow or a ditch. With nothing told again, to the end, if that is
// kLeast_m.
class BrowFinder {
 public:
  static constexpr int kTracks = 5;
  static constexpr float kBends = 0.08f;  // rise over run
  static constexpr float kLeast_m = 4.0f;
  static constexpr float kReach_m = 12.0f;
  static constexpr float kStep_m = kCellSize_m;
  // Places, and ends of chords.
  static constexpr int kMaxUnits = static_cast<int>(kReach_m / kStep_m) + kMaxPathPoints + 1;

  // climb: rise over run along odom's axes, Lookouts::climb; (0, 0): no brow, and it is done.
  void Begin(Vec2 climb, float max_unseen_m);

  // One place of the path, on all tracks, aside_m[kTracks] to its left. The same path and the same
  // map each time. Constant cost.
  void Step(const Costmap& map, const Terrain& terrain, const PathChords& path,
            const float* aside_m);
  bool is_done() const { return is_done_; }

  // Once done. Precondition: 0 <= track < kTracks.
  const Brow& brow(int track) const { return tracks_[track].brow; }

 private:
  struct Track {
    Brow brow;
    float seen_m = 0.0f;  // the last of what is observed, and of what is known to be no gap
    bool ends = false;    // a gap that is none behind a brow
  };

  void Look(const Costmap& map, const Terrain& terrain, Cell cell, Track& track);
  void End();

  Track tracks_[kTracks];
  float climb_ = 0.0f;
  Vec2 uphill_;  // its direction, length 1
  float max_unseen_m_ = 0.0f;
  float along_m_ = 0.0f;
  float on_m_ = 0.0f;  // of the chord
  int32_t chord_ = 0;
  bool is_done_ = true;
};
static_assert(std::is_trivially_copyable_v<BrowFinder>);

}  // namespace hardpack
