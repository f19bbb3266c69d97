// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/path/path.h"

// Whether a newly filed return is in the way of the committed path: the test that does not wait for
// a map or a plan (docs/algorithm.md section 8; docs/safety.md). It does not classify returns
// (core/autonomy/mapper.h does) and does not brake (core/safety/supervisor.h does). Ours.
//
//         _______________________________________
//        /   r            r = half the width + margin, along the path's own chords
//   [>]=+===============+=========.
//        \______________ \         \    a turn on the spot is a disc
//                       \__\_________\  ...
//
// The corridor begins at the vehicle's centre: anything behind that is not in the way. It ends
// where the path does, rounded, or at the reach. Of the returns inside, the first along the path
// counts.
//
// A plan was made on a map begun some ticks ago, and its corridor is a new one: returns filed since
// then must be tested against it too. So their cells are remembered for a while around the vehicle,
// and Build tests them by the cell's square, as the check of the plan (core/safety/path_check.h)
// does.

namespace hardpack {

// What the path ahead permits, given the distance of the first return in the corridor.
enum class WayAhead : uint8_t {
  kClear,     // no return, or the vehicle can stop before it with its reaction time to spare
  kObstacle,  // it must brake now
  kTooNear,   // its deceleration limits are no longer enough
};

struct CorridorSize {
  float half_width_m = 0.0f;
  float pivot_radius_m = 0.0f;  // of a turn on the spot
  float reach_m = 0.0f;         // along the path from the vehicle's middle
};

class Corridor {
 public:
  static constexpr int kMaxChords = 64;
  static constexpr int kSide = 64;           // of the coarse grid over the corridor
  static constexpr int kRecent_cells = 128;  // side of the remembered square: 25.6 m
  // Least number of ticks for which a cell is remembered: longer than a plan may be old.
  static constexpr uint32_t kMemory_ticks = 1000;
  // The first obstacle counts as a person if one was seen within this distance beyond its first
  // return.
  static constexpr float kSamePerson_m = 0.5f;
  static constexpr float kMaxHalfWidth_m = 5.0f;
  static constexpr float kMaxReach_m = 500.0f;
  static constexpr int kMaxTests = 65536;
  static constexpr int kMaxMarked_rows = 2048;

  // No corridor, and nothing remembered.
  void Reset();

  // No path, so nothing is in its way. Remembered returns stay.
  void Clear();

  // Once a tick, before its returns are filed. A vehicle position that is not finite changes
  // nothing. Cost: one row of the memory.
  void Advance(Vec2 vehicle_odom, uint32_t tick);

  // Builds the corridor of a path from along_m on, and tests the returns filed after tick `since`
  // against it. kPathTooShort: fewer than two points; kNotFinite; kInvalidArgument: a size negative
  // or beyond its maximum: then there is no corridor. Chords of the path shorter than a 62nd of the
  // reach are merged. Cost: one pass over the path; the coarse grid, of which at most
  // kMaxMarked_rows rows are marked (beyond that, all of it belongs to every chord); the memory,
  // kRecent_cells^2 cells, of which those filed since that lie in the grid are tested, with
  // kMaxTests chords in total.
  Status Build(const WorldPath& path, float along_m, const CorridorSize& size, uint32_t since);

  // An obstacle return, filed in the tick of the last Advance. True if it is in the corridor; a
  // return that is not finite is not. Cost: the chords whose corridor reaches into its cell of the
  // coarse grid, at most kMaxChords; from one Advance to the next kMaxTests of them. Returns beyond
  // that are not tested but assumed to be in the corridor, at its beginning.
  bool File(Vec2 point_odom, bool is_person);

  // For a vehicle at along_m of the path that drives at speed_mps and was commanded to drive at
  // commanded_mps, both magnitudes in the direction of the path there; reverse: against its
  // heading. gap: from the edge that goes first to the first return in the corridor;
  //   clear     if gap > StoppingDistance (core/speed/speed.h) of the greater of the two,
  //   too near  if gap < v t_lag + v_c t_dead + v_c^2 / (2 a), the distance of a stop begun now.
  // A number that is not finite: kTooNear, if there is a return. Constant cost.
  WayAhead Ahead(const SpeedParams& speed, const VehicleParams& vehicle, float along_m,
                 float speed_mps, float commanded_mps, bool reverse = false) const;

  bool has_obstacle() const { return has_obstacle_; }
  bool is_person() const { return has_obstacle_ && is_person_; }
  // Distance along the path from its first point. Precondition: has_obstacle().
  float obstacle_along_m() const { return obstacle_along_m_; }
  bool has_corridor() const { return chords_ > 0; }

 private:
  struct Chord {
    Vec2 from;
    Vec2 direction;  // length 1; (0, 0) for a turn on the spot
    float length_m = 0.0f;
    float along_m = 0.0f;
    float radius_m = 0.0f;
  };

  void Walk(const WorldPath& path, float along_m, const CorridorSize& size);
  void Add(Vec2 from, Vec2 to, float along_m, float radius_m);
  void LayGrid();
  bool Mark(int chord, int& rows);
  void MarkAll();
  void TestRecent(uint32_t since);
  void TestCell(Cell cell, bool is_person);
  bool MayTest(int chords);
  int GridIndex(Vec2 point_odom) const;
  void Take(float along_m, bool is_person);
  void Remember(Vec2 point_odom, bool is_person);
  static uint32_t Tag(Cell cell);

  // Bits 0-19 the tick, 20 set, 21 a person, 22-31 which of the cells that share the slot; 0:
  // empty.
  static constexpr uint32_t kTickMask = 0xfffffu;
  static constexpr uint32_t kUsedBit = 0x100000u;
  static constexpr uint32_t kPersonBit = 0x200000u;

  uint32_t tick_ = 0;
  Cell vehicle_;
  bool has_vehicle_ = false;
  int32_t tests_left_ = kMaxTests;
  int32_t chords_ = 0;
  bool has_obstacle_ = false;
  bool is_person_ = false;
  float obstacle_along_m_ = 0.0f;
  Vec2 origin_;  // of the coarse grid
  Vec2 low_;     // of the box around the corridor
  Vec2 high_;
  float cells_per_m_ = 0.0f;
  Chord chord_[kMaxChords];
  // The first and the last of the chords that reach into a cell: last < first if none does.
  uint8_t first_[kSide * kSide] = {};
  uint8_t last_[kSide * kSide] = {};
  uint32_t recent_[kRecent_cells * kRecent_cells] = {};
};
static_assert(std::is_trivially_copyable_v<Corridor>);
static_assert(sizeof(Corridor) <= 80 * 1024);

}  // namespace hardpack
