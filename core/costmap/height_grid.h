// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/grid.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The rolling grid of return heights ([OS] Cost Map Creation; docs/algorithm.md section 1): per
// cell the lowest return of any class, the lowest and highest hard return, the highest soft return,
// whether the ground was observed and its height is known, whether a person was seen, and the
// ageing state of these. It does not decide what an obstacle is. Storage is toroidal, so rolling
// only clears the cells that come in. The map follows the vehicle by whole cells.
//
// Ageing by visibility (ours). Time alone removes nothing. Age visits every cell that the beams of
// one direction cross and that holds an obstacle: the hard one, from its lowest to its highest hard
// return, or otherwise the soft one, from the cell's lowest return to the highest soft one. d is
// the distance of the cell's centre along the direction. A beam's height is taken where it ended
// or, if it got farther, at d.
//
//   sensor o---____
//                  -----_____|____ ____|____   over the top: no evidence
//   highest  - - - - - - - - +---------+
//          -------___________|_________|____   inside, with a return from behind: seen through,
//   middle - - - - - - - - - |         |       and the part above this beam will be removed
//          ------------___o  |         |       ended before the cell: no evidence
//   lowest - - - - - - - - - +----|----+
//                                 d
//
//   It ended here: its return lies farther away than d - kEndsBefore_m (and 0), no farther than
//     d + kBehind_m, and its height is in the interval or outside it by at most the margin, which
//     is kEdge_cm plus d times the mean spacing of the fan's beams.
//   It went through: its return lies farther away than d + kBehind_m.
//   A cell is hit when a beam ended here no lower than kEdge_cm below the interval's middle. Its
//     misses become 0, and it cannot get another in this revolution.
//   A cell is seen through when it is not hit, and a beam went through inside: over the whole cell
//     (d +- 0.1414 m) not below the lowest return and not above the highest less kEdge_cm. Or,
//     if none did and no beam ended here, when one beam that went through was nowhere in the cell
//     above the middle, and another was nowhere below it, with the highest point of the former and
//     the lowest of the latter in the interval or out of it by no more than the margin: a single
//     return has no inside. That is a miss; each revolution counts one at most.
//
// With ageing_revolutions misses the obstacle is cut: its highest return becomes the highest point
// over the cell of the lowest beam inside, or the end of the highest beam that ended here,
// whichever is higher. If no beam was inside, or nothing more than kRest_cm above the lowest is
// left, it is gone. What is left is not a person and has no misses. A cell that has lost its last
// obstacle and whose ground was not observed is unknown again. So an obstacle persists while it is
// occluded, in the blind cone below the lowest beam, entirely above the highest, or out of range.
// With ageing_revolutions of 2 or more it also persists as long as the fans hit it once per
// revolution, however late its returns are filed. With 1, an obstacle that fills so little of its
// cell that beams pass beside it in the same revolution is lost until it is filed again. Filing a
// hard return in the upper half of the hard interval (or, if there is none, a soft one in that of
// the soft interval) clears the misses and blocks those of its revolution too. A lower return does
// not: a root does not keep the ghost of a person who stood on it. Filing alone keeps an obstacle
// that is filed in each revolution, up to ageing_revolutions - 2 revolutions late. A new revolution
// is recognised by its parity against that of the last miss or hit: an obstacle seen through only
// in every second revolution does not age.
//
// Low objects (ours). Anything no higher than growth is an obstacle only if most of its returns are
// firm (core/segmentation). Each block of 2 x 2 cells counts its firm returns, and the evidence
// against: loose ones, and ground from nearby. Counts go up to 15, then both are halved, so new
// looks weigh more. A cut by 0.15 m or more clears them: they belonged to what is gone. They never
// create an obstacle alone: the rule needs hard returns in the cell too, which age as above.
//
// A person's flag persists while returns of a person arrive: each sets a memory of kPersonMemory,
// and each new revolution (also by parity) whose first hard or ground return is not a person's
// takes one off. The ground ages by being seen: in a cell without an obstacle, a ground return of a
// new revolution lets `lowest` rise by at most one centimetre, and not above that return, so that
// the ground follows slow drift of the odometry's height.

namespace hardpack {

// What the beams of one direction saw, as needed for ageing: a fan of rays in a vertical plane.
struct SightFan {
  Vec3 sensor_odom;
  Vec2 direction_odom;  // level, length 1
  int32_t beams = 0;
  // [beams], any order. How far a beam got: level distance of its return from the sensor [m], of
  // any class; 0 or less for a beam that must not count because it saw nothing. A beam that was
  // fired without a return may be given the farthest level of the others: it then counts as having
  // gone through as far as the direction is known to be clear.
  float level_m[kMaxBeams] = {};
  float slope[kMaxBeams] = {};  // rise of the beam over level distance
  // Slopes of the lowest and highest beam that the sensor has in this direction: with `beams` they
  // give the mean spacing.
  float lowest_slope = 0.0f;
  float highest_slope = 0.0f;
};

class HeightGrid {
 public:
  // Heights are centimetres in the odom frame, rounded to the nearest and saturated to
  // +-kMaxHeight_cm about the sum of the shifts since Reset; kNone: no such return.
  static constexpr int16_t kNone = 32767;
  static constexpr int32_t kMaxHeight_cm = 20000;

  // For ageing, see above. kBehind_m and kEndsBefore_m: a cell reaches 0.14 m from its centre; the
  // returns of a wall scatter behind it.
  static constexpr float kBehind_m = 0.3f;
  static constexpr float kEndsBefore_m = 0.15f;
  static constexpr float kEdge_cm = 3.0f;
  static constexpr int kRest_cm = 5;
  static constexpr int kPersonMemory = 3;
  static constexpr int kMaxAgeingRevolutions = 4;

  struct CellHeights {
    int16_t lowest_cm = kNone;
    int16_t lowest_hard_cm = kNone;
    int16_t highest_hard_cm = kNone;
    int16_t highest_soft_cm = kNone;
    bool ground = false;  // its height is known: a ground return, or bridged between two
    bool person = false;
    bool observed = false;  // the ground was observed, whether its height is known or not
    bool guessed = false;   // its height is bridged or assumed: no ground return came from here
    bool firm = false;      // the low returns around it are firm,
    bool growth = false;    // or growth
  };

  // Contents of a cell's byte about its ground and its hard returns; its other bits are for ageing.
  enum Seen : uint8_t {
    kGroundHeightKnown = 1,
    kPersonMask = 6,         // not 0: a person is among the hard returns
    kGroundFromBeside = 32,  // its height, or if unknown its observed flag
  };

  // Empty, centred at the odom frame's origin. Cost: kMapCells cells cleared.
  HeightGrid();

  // Empties the grid and centres it. kNotFinite: nothing changes. Cost: kMapCells cells cleared.
  Status Reset(Vec2 center_odom);

  // Moves the window so that center_odom lies in its middle cell; cells that come in are empty.
  // kNotFinite: nothing moves. Cost: clears the cells that come in, at most kMapCells.
  Status Recenter(Vec2 center_odom);

  // Files one classed return. revolution: the lidar's revolution counter; only its order within a
  // few revolutions matters. kIgnored returns are not filed and are kOk. Overhead returns must not
  // be filed: the caller knows the local ground (a hard return above the clearance height would
  // join the one below it in the cell). kNotFinite; or kInvalidArgument when the point is off the
  // window or the class is not in ReturnClass: nothing is filed. Cost: constant.
  Status Insert(const Vec3& point_odom, ReturnClass return_class, uint32_t revolution = 0);

  // Counts one low return in its block, as firm or not. Off the window, or not finite: no effect.
  // Constant cost.
  void CountLow(const Vec3& point_odom, bool firm);
  // A ground return came from where low returns were filed: it counts against them if it is as
  // high. Constant cost.
  void DoubtLow(const Vec3& point_odom);

  // Ground observed along the straight line between two of its points, both ends included: every
  // cell that the line crosses and that has no ground yet gets ground at the height of the line's
  // point nearest to the cell's centre (`lowest` stays below it if it is lower). Cells with ground
  // and cells off the window are left alone. kNotFinite; kInvalidArgument: a level length of more
  // than kMaxBridge_m, or beyond 2^22 cells from the origin, where floats do not resolve cells
  // well: nothing is filed. Cost: at most kMaxBridge_cells cells.
  static constexpr float kMaxBridge_m = 40.0f;
  static constexpr int kMaxBridge_cells = 286;  // a line of 200 cells' length crosses 284 borders
  Status BridgeGround(const Vec3& from_odom, const Vec3& to_odom);

  // The same cells become observed, but no height is taken: what looks like ground there may turn
  // out to be low growth. Only x and y of the points count. Statuses and cost of BridgeGround.
  Status ObserveGround(const Vec3& from_odom, const Vec3& to_odom);

  // A closer look did not see the ground between two of its points. Between the cells of the two
  // ends, cells that were bridged, assumed or only observed become unknown again: from afar, a
  // ditch narrower than the ring spacing is bridged. Cells with a ground return stay. Statuses and
  // cost of BridgeGround.
  Status ForgetGround(const Vec3& from_odom, const Vec3& to_odom);

  // Treats the ground of all cells whose centre lies within radius_m of a point as observed, in the
  // plane through it that rises by `slope` per metre along x and y, where no ground is known yet,
  // as BridgeGround does. kNotFinite; kInvalidArgument: radius_m is negative or above
  // kMaxAssumed_m. Cost: the cells of the square around it.
  static constexpr int kMaxAssumed_m = 20;
  Status AssumeGround(const Vec3& center_odom, float radius_m, Vec2 slope = {});

  // The same for the ground under a vehicle, in every tick: up to kMaxStanding_m.
  static constexpr int kMaxStanding_m = 1;
  Status StandOnGround(const Vec3& center_odom, float radius_m, Vec2 slope);

  // Ages the cells that the fan's beams crossed. kNotFinite: a number of the fan (except slopes of
  // beams that saw nothing); kInvalidArgument: beams not 0 .. kMaxBeams, a direction whose length
  // is not 1 to 1 %, a sensor off the window, or ageing_revolutions not 1 .. kMaxAgeingRevolutions:
  // nothing ages. Cost: at most kMaxSight_cells cells, of which those with an obstacle that can age
  // look at every beam, at most twice.
  static constexpr int kMaxSight_cells = 2 * kMapSize_cells;
  // Limits the cells tested against fans, until the next call; no limit without it. The others do
  // not change.
  void BeginTick(int aged_cells) { aged_left_ = aged_cells; }
  Status Age(const SightFan& fan, uint32_t revolution, int ageing_revolutions);

  // A person is at a place now: for the next kNoted_ns to 2 kNoted_ns, what is filed in the cells
  // whose centre lies within radius_m of it and that hold nothing hard is theirs, whatever it is
  // told to be: a label may not reach the edge of a body. Not finite, or not 0 to kMaxReleased_m:
  // no effect. Cost: the cells of the square around it.
  static constexpr float kMaxReleased_m = 0.8f;
  static constexpr uint64_t kNoted_ns = 1'000'000'000;
  void NotePerson(Vec2 place_odom, float radius_m);
  // What is hard in the cells whose centre lies within radius_m of a place is a person, as if a
  // return of theirs had been filed there now. Not finite, or not 0 to kMaxReleased_m: no effect.
  // Cost: the cells of the square around it.
  void FlagPerson(Vec2 place_odom, float radius_m);
  // Once a tick. Cost: a bit of each cell, once in kNoted_ns.
  void ForgetNotes(uint64_t now_ns);

  // What a person left behind in the cells whose centre lies within radius_m of a place that they
  // were seen to walk away from is gone: in each cell whose hard obstacle is theirs by NotePerson,
  // or because its first return was a person's. What was there before a person came stays. Not
  // finite, or not 0 to kMaxReleased_m: no effect. Cost: the cells of the square around it.
  void ReleasePerson(Vec2 place_odom, float radius_m);

  // Total of cells walked by BridgeGround, ObserveGround and ForgetGround; it wraps.
  uint32_t crossed_cells() const { return crossed_cells_; }

  // The odometry's height jumped by dz_m: everything filed is converted to the new heights, to the
  // centimetre. kNotFinite; kInvalidArgument: the shift, or the sum of all since Reset, is beyond
  // +-kMaxShift_cm: nothing changes. Cost: constant.
  static constexpr int32_t kMaxShift_cm = 10000;
  Status ShiftHeights(float dz_m);

  const GridWindow& window() const { return window_; }

  // Empty for a cell off the window. Cost: constant.
  CellHeights At(Cell cell) const;
  // Its ground was observed, and nothing hard is on it. Cost: constant.
  bool IsFree(Cell cell) const {
    if (!window_.Contains(cell)) return false;
    const int slot = Slot(cell);
    return (seen_[slot] & (kGroundHeightKnown | kGroundFromBeside)) != 0 &&
           highest_hard_cm_[slot] == kNone;
  }

  // The offset from stored to reported heights, see ShiftHeights.
  int32_t datum_cm() const { return datum_cm_; }

  // The cells first.x .. first.x + kMapSize_cells - 1 of row first.y, as arrays, so that loops over
  // them vectorise. Heights are as stored, including kNone: they are comparable with each other,
  // also across a shift. Cells off the window are empty. seen: of Seen. Precondition: first.x <=
  // INT32_MAX - kMapSize_cells. Cost: kMapSize_cells cells copied.
  using HeightRow = std::span<int16_t, kMapSize_cells>;
  using SeenRow = std::span<uint8_t, kMapSize_cells>;
  void ReadGround(Cell first, HeightRow lowest_cm, SeenRow seen) const;
  void ReadObstacles(Cell first, HeightRow lowest_hard_cm, HeightRow highest_hard_cm,
                     HeightRow highest_soft_cm) const;
  // Low returns in so many cells of a row, at most kMostLow_cells: kFirmLow, kGrowth or 0 each;
  // cells that have left the window may give stale values.
  static constexpr int kMostLow_cells = 64;
  static constexpr uint8_t kFirmLow = 1;
  static constexpr uint8_t kGrowth = 2;
  void ReadLow(Cell first, int cells, uint8_t* low) const;

 private:
  // The rest of a cell's byte: the memory of a person in units, misses, and the parity of two
  // revolutions: of the last miss or hit, and of the last return that was filed (ground returns
  // where there is no obstacle, hard ones).
  enum SeenForAgeing : uint8_t {
    kPersonOne = 2,
    kMissOne = 8,
    kMissMask = (kMaxAgeingRevolutions - 1) * kMissOne,
    kSightOdd = 64,
    kFiledOdd = 128,
  };
  static_assert(kPersonMask == kPersonMemory * kPersonOne);

  // One fan as seen by its cells.
  struct Sight {
    Vec2 direction;                 // of length 1 to rounding
    float z_cm = 0.0f;              // the sensor's, above the stored heights' zero
    float spacing_cm_per_m = 0.0f;  // of the beams, by level distance
    bool odd = false;               // the revolution
    int ageing_revolutions = 0;
  };
  // A cell's obstacle, in stored heights, and the position of its centre along the fan.
  struct Target {
    float lowest_cm;
    float highest_cm;
    float distance_m;
    float margin_cm;
  };
  struct Evidence {
    bool hit;
    bool ended;   // a beam ended here
    bool inside;  // a beam went through inside
    bool around;  // one below the middle, one above it
  };

  // The storage index of a cell of the plane; all cells of one window have different ones.
  static constexpr int Slot(Cell cell) {
    constexpr uint32_t kMask = kMapSize_cells - 1;
    return static_cast<int>((static_cast<uint32_t>(cell.y) & kMask) * kMapSize_cells +
                            (static_cast<uint32_t>(cell.x) & kMask));
  }

  // The part of a row of stored cells that lies in the window, see ReadGround. The counts of a
  // cell's block: firm in the high half of the byte, against it in the low one.
  static constexpr int kBlocks = kMapSize_cells / 2;
  static constexpr int BlockSlot(Cell cell) {
    constexpr uint32_t kMask = kBlocks - 1;
    return static_cast<int>(((static_cast<uint32_t>(cell.y) >> 1) & kMask) * kBlocks +
                            ((static_cast<uint32_t>(cell.x) >> 1) & kMask));
  }
  static constexpr int kCountOne = 16;  // of what is firm
  static constexpr int kMostCount = 15;
  // This many firm returns, and twice as many as those against, are a low object. This many against
  // are growth.
  static constexpr int kLeastFirm = 6;
  static constexpr int kLeastGrowth = 3;
  static constexpr bool IsFirm(int counts) {
    const int firm = counts / kCountOne;
    return (firm >= kLeastFirm) & (firm >= 2 * (counts % kCountOne));
  }
  static constexpr bool IsGrowth(int counts) {
    return !IsFirm(counts) && counts % kCountOne >= kLeastGrowth;
  }
  void Count(int block, bool firm);

  template <typename T>
  void CopyRow(const T* plane, Cell first, T empty, std::span<T, kMapSize_cells> row) const;

  // Clears rows, or part of their columns, starting at offset (dx, dy) from the window's origin.
  void ClearRows(int dy, int rows);
  void ClearColumns(int dx, int columns, int dy, int rows);

  int16_t Stored(float z_m) const;
  int16_t Told(int16_t stored_cm) const;
  // Inline: the sight lines call it for every cell.
  bool HasObstacle(int slot) const {
    return ((highest_hard_cm_[slot] ^ kNone) | (highest_soft_cm_[slot] ^ kNone)) != 0;
  }
  bool IsNewlyFiled(int slot, bool odd);
  void FileGround(int slot, int16_t height_cm, bool odd);
  void FileHard(int slot, int16_t height_cm, bool odd, bool person);
  struct BitPlane {
    uint32_t words[kMapCells / 32];
    bool Has(int slot) const { return (words[slot / 32] >> (slot % 32) & 1u) != 0; }
    void Set(int slot, bool value) {
      const uint32_t bit = 1u << (slot % 32);
      uint32_t& word = words[slot / 32];
      word = value ? word | bit : word & ~bit;
    }
  };
  void ClearNotes();
  void ShiftNotes();
  template <typename Act>
  void AroundPerson(Vec2 place_odom, float radius_m, Act&& act);
  void ReleaseCell(int slot);
  void FileSoft(int slot, int16_t height_cm, bool odd);
  // The operation on the cells that a line crosses.
  enum class Crossing : uint8_t { kBridge, kObserve, kForget };
  Status CrossCells(const Vec3& from_odom, const Vec3& to_odom, Crossing crossing);
  void ForgetCell(int slot);
  bool NeedsNone(Cell cell, int known) const;
  void TakeAsGround(Cell cell, float z_m);
  // Clears the misses and blocks further ones in this revolution.
  void MakeYoung(int slot, bool odd) {
    seen_[slot] =
        static_cast<uint8_t>((seen_[slot] & ~(kMissMask | kSightOdd)) | (odd ? kSightOdd : 0));
  }
  template <int kMost_m>
  Status AssumeAround(const Vec3& center_odom, float radius_m, Vec2 slope);
  bool CanAge(int slot, const Sight& sight) const;
  void AgeCell(Cell cell, const SightFan& fan, const Sight& sight);
  static Evidence Look(const SightFan& fan, const Sight& sight, const Target& target);
  static float Cut_cm(const SightFan& fan, const Sight& sight, const Target& target);
  void CutDown(int slot, bool hard, float cut_cm);

  GridWindow window_;
  uint32_t crossed_cells_ = 0;
  int32_t aged_left_ = INT32_MAX;
  int32_t datum_cm_ = 0;  // what is added to the stored heights, +-kMaxShift_cm
  // Stored heights, [kMapSize_cells x kMapSize_cells] by Slot.
  int16_t lowest_cm_[kMapCells];
  int16_t lowest_hard_cm_[kMapCells];
  int16_t highest_hard_cm_[kMapCells];
  int16_t highest_soft_cm_[kMapCells];
  uint8_t seen_[kMapCells];
  uint8_t low_[kBlocks * kBlocks];  // by BlockSlot
  // One bit a cell, by Slot: whether a person was noted there in this stretch of kNoted_ns, and in
  // the one before.
  BitPlane noted_[2];
  uint64_t noted_since_ns_ = 0;  // this stretch
  BitPlane began_with_person_;   // of a cell with a hard obstacle
};
static_assert((kMapSize_cells & (kMapSize_cells - 1)) == 0);
static_assert(sizeof(HeightGrid) <= 9 * kMapCells + kMapCells / 4 + 3 * kMapCells / 8 + 64);
static_assert(std::is_trivially_copyable_v<HeightGrid>);

}  // namespace hardpack
