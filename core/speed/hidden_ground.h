// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/grid.h"
#include "core/costmap/costmap.h"

// Why ground has not been observed: because it lay in a shadow wherever the lidar has looked from,
// or although a place could show it. The first may be crept over; the second is a ditch, a drop or
// missing data, and may not (docs/decisions/0047-hidden-ground.md). Ours.
//
//   o lookout      [####]. . . . a shadow: the line meets a hard cell
//   |  blind_m  |
//   o           |------------- ? in view, and nothing came back: a gap
//
// Only hard cells cast shadows: ground behind growth or soft things counts as in view (behind
// a brow: core/speed/brow.h), and so does what a mask of the lidar hides. Nor is ground hidden that
// was always too near to be seen, as around the start. Each of these makes a place a gap that is
// none, never the reverse.

namespace hardpack {

// Where the lidar has looked from lately: at most kMost places, about kApart_m from each other, the
// last one where it is now.
struct Lookouts {
  static constexpr int kMost = 12;
  static constexpr float kApart_m = 1.0f;
  // A lookout shows nothing that is farther away: its rings may be too far apart there.
  static constexpr float kReach_m = 10.0f;

  FixedVector<Vec2, kMost> places_odom;  // oldest first
  FixedVector<float, kMost> heights_m;   // of the vehicle there, odom
  // No beam meets level ground that is nearer to the lidar than this.
  float blind_m = 0.0f;

  // The lidar is at place_odom now, and the vehicle at height_m. The oldest place goes when there
  // are too many. Precondition: finite. Cost: kMost.
  void Add(Vec2 place_odom, float height_m);
  void Clear();

  // The steepest way up over two places, and its direction: rise over run along odom's axes, where
  // the vehicle has climbed by kClimbed_m on the way of the kMost places; it is remembered for
  // kKept more. (0, 0): it has not.
  static constexpr float kClimbed_m = 0.8f;
  static constexpr int32_t kKept = 16;
  Vec2 climb;
  int32_t since_climb = 0;  // places
};

// Whether a cell lies in the shadow of a hard cell for at least one lookout, and none could show
// its ground. Cells off the window cast no shadow. Cost: kMost lines of kReach_m.
bool IsHidden(const Costmap& map, const Lookouts& lookouts, Cell cell);

}  // namespace hardpack
