// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/costmap/height_grid.h"

// Who walks, told without labels: something as wide as a person, with nothing beside it, that now
// stands where a moment ago the ground was seen and nothing stood
// (docs/decisions/0052-where-people-will-be.md). It does not see who stands still, who walks beside
// something, or who walks slower than kMoved_m in kMemory_ns. Ours.
//
//   what a revolution sees of it, by its columns' nearest returns:
//      wall ________ . . . . ________        more than kBeside_m nearer than what is beside it,
//                     o o o                  no wider than kWidest_m
//
//   from look to look: O . . x x x           O: where it was first seen, with the cells around;
//                      |<-->| kMoved_m       x: a look at it where those were free. kSureLooks of
//                                            them in a row, each of another revolution, the
//                                            last one kGoesOn_m from the first: it moves
//
// What moves does so until it was not seen for kUnseen_ns.

namespace hardpack {

class MovingBodies {
 public:
  static constexpr int kMost = 32;
  static constexpr float kBeside_m = 0.4f;
  static constexpr float kWidest_m = 1.1f;
  static constexpr float kMoved_m = 0.5f;
  static constexpr int kSureLooks = 3;
  static constexpr uint64_t kLooksApart_ns = 40'000'000;  // a lidar takes 50 ms or more to turn
  static constexpr float kGoesOn_m = 0.1f;
  static constexpr float kLeft_m = 0.25f;            // around where it was first seen, for ...
  static constexpr uint64_t kLeft_ns = 110'000'000;  // ... a revolution, nothing is seen any more
  static constexpr float kFastest_mps = 3.0f;
  static constexpr uint64_t kUnseen_ns = 250'000'000;
  static constexpr uint64_t kMemory_ns = 2'000'000'000;

  // Forgets everything.
  void Reset();

  // The next column, in the order in which the lidar turns: its nearest hard return, at now_ns,
  // which must not fall. True: a body ends before it, body_odom is the middle of its returns. Not
  // finite: as a column without any. Cost: kMost distances.
  bool Column(bool has_return, Vec2 nearest_odom, float distance_m, uint64_t now_ns,
              Vec2& body_odom);

  // A body seen at now_ns, which must not fall. True: it moves. here_odom: the vehicle; the
  // farthest from it is forgotten if there are more than kMost. Cost: kMost distances and
  // kAround_cells squared cells.
  bool Look(Vec2 body_odom, uint64_t now_ns, Vec2 here_odom, const HeightGrid& heights);

  int size() const { return bodies_.size(); }

 private:
  static constexpr int kReach_cells = 6;
  static constexpr int kAround_cells = 2 * kReach_cells + 1;

  // The cells around a place: one bit each, whether the ground was seen there and nothing hard.
  struct FreeCells {
    Cell middle;
    uint16_t rows[kAround_cells] = {};
    bool Has(Vec2 place_odom) const;
  };

  struct Body {
    Vec2 place_odom;
    uint64_t seen_ns = 0;
    Vec2 origin_odom;
    uint64_t origin_ns = 0;
    uint64_t origin_seen_ns = 0;  // the last return from there
    FreeCells around_origin;
    int32_t moved_looks = 0;  // in a row, the first of them ...
    Vec2 moved_odom;          // ... here, ...
    uint64_t moved_ns = 0;    // ... and the last of them then
    bool moves = false;
  };

  // What is being seen, column by column.
  struct Run {
    int32_t columns = 0;
    bool stands_out = false;  // what was before it is farther away
    Vec2 low_odom;
    Vec2 high_odom;
    Vec2 sum_odom;
    Vec2 last_odom;
    float last_m = 0.0f;
  };

  bool EndRun(float next_m, Vec2& body_odom) const;
  int BodyOf(Vec2 place_odom, uint64_t now_ns) const;
  void Begin(Vec2 place_odom, uint64_t now_ns, Vec2 here_odom, const HeightGrid& heights);
  static void Remember(Vec2 place_odom, uint64_t now_ns, const HeightGrid& heights, Body& body);

  FixedVector<Body, kMost> bodies_;
  Run run_;
  float before_m_ = 0.0f;  // the column before it
};
static_assert(std::is_trivially_copyable_v<MovingBodies>);

}  // namespace hardpack
