// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The rolling grid of return heights ([OS] Cost Map Creation; docs/algorithm.md section 1): per
// cell the lowest return of any class, the lowest and highest hard return, the highest soft return,
// whether ground was observed and whether a person was seen; and what has become of them since. It
// does not decide what an obstacle is. Storage is toroidal, so rolling only clears what comes in.
// The map follows the vehicle by whole cells.
//
// Ageing by visibility (ours). Time alone removes nothing. A cell ages when beams that came back
// from further away went through the height range in which its obstacle was seen: once in each
// revolution at most, and a return that supports the obstacle's upper half makes it young again.
// After ageing_revolutions such revolutions what lies above the lowest of these beams is removed,
// and with nothing left of the obstacle the obstacle. So an obstacle lasts while it is occluded, in
// the blind cone below the lowest beam or above the highest, or out of range. The counter is the
// hard obstacle's while there is one, else the soft one's. A person's flag lasts while returns of a
// person come, and fades with kPersonMemory revolutions of other returns in the cell.
// The ground ages by being seen: in a cell without an obstacle, a ground return of a new revolution
// lets `lowest` rise by at most one centimetre before it is taken into account, so that the ground
// follows a slow drift of the odometry's height.

namespace hardpack {

// What the beams of one direction saw, as far as ageing needs it: a fan of rays in a vertical
// plane.
struct SightFan {
  Vec3 sensor_odom;
  Vec2 direction_odom;  // level, length 1
  int32_t beams = 0;
  // [beams], any order. How far a beam got: level distance of its return from the sensor [m]; 0 for
  // a beam without a return or one that must not count: it saw nothing.
  float level_m[kMaxBeams] = {};
  float slope[kMaxBeams] = {};  // rise of the beam over level distance
  // Slopes of the lowest and highest beam that the sensor has in this direction.
  float lowest_slope = 0.0f;
  float highest_slope = 0.0f;
};

class HeightGrid {
 public:
  // Heights are centimetres in the odom frame, rounded to the nearest and saturated to
  // +-kMaxHeight_cm; kNone: no such return.
  static constexpr int16_t kNone = 32767;
  static constexpr int32_t kMaxHeight_cm = 20000;

  // Beams are judged by the beam spacing of real lidars; a beam goes through a cell when it came
  // back from so far behind the cell's middle.
  static constexpr float kBehind_m = 0.3f;
  static constexpr int kPersonMemory = 3;
  static constexpr int kMaxAgeingRevolutions = 7;

  struct CellHeights {
    int16_t lowest_cm = kNone;
    int16_t lowest_hard_cm = kNone;
    int16_t highest_hard_cm = kNone;
    int16_t highest_soft_cm = kNone;
    bool ground = false;  // the ground was observed: a ground return, or bridged between two
    bool person = false;
  };

  // Cells side by side along x, as arrays, so that loops over them vectorise.
  static constexpr int kStripCells = 32;
  struct Strip {
    int16_t lowest_cm[kStripCells];
    int16_t lowest_hard_cm[kStripCells];
    int16_t highest_hard_cm[kStripCells];
    int16_t highest_soft_cm[kStripCells];
    uint8_t ground[kStripCells];  // 0 or 1
    uint8_t person[kStripCells];  // 0 or 1
  };

  // Empty, centred at the odom frame's origin. Cost: kMapCells cells cleared.
  HeightGrid();

  // Empties the grid and centres it. kNotFinite: nothing changes. Cost: kMapCells cells cleared.
  Status Reset(Vec2 center_odom);

  // Moves the window so that center_odom lies in its middle cell; cells that come in are empty.
  // kNotFinite: nothing moves. Cost: the cells that come in, at most kMapCells, cleared.
  Status Recenter(Vec2 center_odom);

  // Files one classed return. revolution: the lidar's revolution counter; only its order within a
  // few revolutions matters. kIgnored returns are not filed and are kOk. What hangs over the way is
  // not to be filed: the caller knows the local ground (a hard return above the clearance height
  // would join the one below it in the cell). kNotFinite; or kInvalidArgument when the point is off
  // the window or the class is none of ReturnClass: nothing is filed. Cost: constant.
  Status Insert(const Vec3& point_odom, ReturnClass return_class, uint32_t revolution = 0);

  // Ground observed along the straight line between two points of it, both ends included: every
  // cell on the way that has no ground yet gets the height of the line there; one that has is left
  // alone, as is what is off the window. kNotFinite: nothing is filed; kInvalidArgument: longer
  // than kMaxBridge_m. Cost: at most kMaxBridge_cells cells.
  static constexpr float kMaxBridge_m = 40.0f;
  static constexpr int kMaxBridge_cells = 402;
  Status BridgeGround(const Vec3& from_odom, const Vec3& to_odom);

  // Takes the ground of all cells whose centre lies within radius_m of a point as observed, at that
  // point's height, where nothing is known of it. kNotFinite; kInvalidArgument: radius_m is
  // negative or above 50. Cost: (2 radius + 1)^2 cells, at most kMapCells.
  Status AssumeGround(const Vec3& center_odom, float radius_m);

  // Lets the cells age that the fan's beams went through. kNotFinite: a number of the fan (beams
  // without a return excepted); kInvalidArgument: beams not 0 .. kMaxBeams, a direction that has
  // not length 1 to 1 %, or ageing_revolutions not 1 .. kMaxAgeingRevolutions: nothing ages. Cost:
  // at most kMapSize_cells cells, of which those with an obstacle look at every beam.
  Status Age(const SightFan& fan, uint32_t revolution, int ageing_revolutions);

  // The odometry's height jumped by dz_m: everything that was filed is told in the new heights.
  // kNotFinite; kInvalidArgument: beyond +-100 m: nothing changes. Cost: constant.
  Status ShiftHeights(float dz_m);

  const GridWindow& window() const { return window_; }

  // Empty for a cell off the window. Cost: constant.
  CellHeights At(Cell cell) const;

  // The cells first.x .. first.x + kStripCells - 1 of row first.y, each as At gives it.
  // Precondition: first.x <= INT32_MAX - kStripCells. Cost: constant.
  void Read(Cell first, Strip& strip) const;

 private:
  // A cell's byte: ground 1 bit, person's memory 2 bits, misses 3 bits, the revolution (mod 4) of
  // its last event 2 bits.

  // The storage place of a cell of the plane; the cells of one window all have different ones.
  static constexpr int Slot(Cell cell) {
    constexpr uint32_t kMask = kMapSize_cells - 1;
    return static_cast<int>((static_cast<uint32_t>(cell.y) & kMask) * kMapSize_cells +
                            (static_cast<uint32_t>(cell.x) & kMask));
  }

  // Empties width x height cells, their lowest corner at offset (dx, dy) from the window's origin.
  void Clear(int dx, int dy, int width, int height);

  GridWindow window_;
  int32_t datum_cm_ = 0;  // what is added to the stored heights
  int16_t lowest_cm_[kMapCells];
  int16_t lowest_hard_cm_[kMapCells];
  int16_t highest_hard_cm_[kMapCells];
  int16_t highest_soft_cm_[kMapCells];
  uint8_t seen_[kMapCells];
};
static_assert((kMapSize_cells & (kMapSize_cells - 1)) == 0);
static_assert(sizeof(HeightGrid) <= 9 * kMapCells + 64);
static_assert(std::is_trivially_copyable_v<HeightGrid>);

}  // namespace hardpack
