// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/base/grid.h"
#include "core/base/pose.h"

// Synthetic ground between a start and a goal: the obstacles that a path must avoid. The same on
// every machine: integers of a standard generator, and no function of the C library.

namespace hardpack::command {

// A sequence of numbers that depends only on the seed and the stream.
class Draw {
 public:
  Draw(uint32_t seed, uint32_t stream);

  float Uniform(float low, float high);
  bool OneIn(int count);

 private:
  std::mt19937 engine_;
};

// The line from start to goal as a frame: its origin is the start, x points to the goal, y left.
struct Way {
  Vec2 start_odom;
  float direction_rad = 0.0f;
  float length_m = 0.0f;

  Vec2 ToOdom(Vec2 point_way) const;
};

// Cells of a 512 x 512 map around the origin, for drawing in the frame of such a line. Anything off
// the map is ignored.
class Terrain {
 public:
  explicit Terrain(const Way& way);

  // Every cell whose centre is no further from the straight piece than the radius, and those that
  // the piece's ends lie in. flag: kHard or kSoft; 0: the cells become free and observed.
  void Stroke(Vec2 from_way, Vec2 to_way, float radius_m, uint8_t flag);
  void Disc(Vec2 centre_way, float radius_m, uint8_t flag) {
    Stroke(centre_way, centre_way, radius_m, flag);
  }
  // A rectangle of twice the half sides; angle_rad from the way's x.
  void Box(Vec2 centre_way, float half_length_m, float half_width_m, float angle_rad, uint8_t flag);
  // The free cells of a disc become unobserved.
  void Unobserved(Vec2 centre_way, float radius_m);

  const Way& way() const { return way_; }
  // [kMapCells] of Costmap::Flag
  const std::vector<uint8_t>& flags() const { return flags_; }

 private:
  template <typename Change>
  void ForCellsWithin(Vec2 centre_odom, float reach_m, Change&& change);

  Way way_;
  GridWindow window_;
  std::vector<uint8_t> flags_;
};

// A kind of ground: its name, and the function that draws it.
struct TerrainKind {
  const char* name;
  // Draws on the ground and returns the goal, in the line's frame.
  Vec2 (*draw)(Draw& random, Terrain& terrain);
};

// All kinds, in the order in which the problems alternate.
const std::vector<TerrainKind>& TerrainKinds();

}  // namespace hardpack::command
