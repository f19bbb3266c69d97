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
// whether the ground was observed and its height is known, and whether a person was seen; and what
// has become of them since. It does not decide what an obstacle is. Storage is toroidal, so rolling
// only clears what comes in. The map follows the vehicle by whole cells.
//
// Ageing by visibility (ours). Time alone removes nothing. Age looks at every cell that the beams
// of one direction cross and that holds an obstacle: the hard one, from its lowest to its highest
// hard return, or where there is none the soft one, from the cell's lowest return to the highest
// soft one. d is how far the cell's middle lies along the direction; a beam's height is taken where
// it ended or, where it got further, at d.
//
//   sensor o---____
//                  -----_____|____ ____|____   over the top: says nothing
//   highest  - - - - - - - - +---------+
//          -------___________|_________|____   inside, and came back from behind: seen through,
//   middle - - - - - - - - - |         |       and what lies above this beam is what will go
//          ------------___o  |         |       ended before the cell: says nothing
//   lowest - - - - - - - - - +----|----+
//                                 d
//
//   It ended here: its return lies further away than d - kEndsBefore_m (and 0), not further than
//     d + kBehind_m, and its height in the interval or out of it by no more than the margin, which
//     is kEdge_cm and d times the mean spacing of the fan's beams.
//   It went through: its return lies further away than d + kBehind_m.
//   A cell is hit when a beam ended here not lower than kEdge_cm below the interval's middle. Its
//     misses are 0, and it can have none any more in this revolution.
//   A cell is seen through when it is not hit, and a beam went through inside: over all of the cell
//     (d +- 0.1414 m) not below the lowest return and not above the highest less kEdge_cm. Or,
//     where none did, when no beam ended here, one went through that was nowhere in the cell above
//     the middle, and one that was nowhere below it; the highest point of the former and the lowest
//     of the latter in the interval or out of it by no more than the margin: a single return has no
//     inside. That is a miss; each revolution counts one at most.
//
// With ageing_revolutions misses the obstacle is cut: its highest return is from now on where the
// lowest of the beams inside was highest over the cell, or where the highest beam ended here if
// that is higher. With no beam inside, or nothing left that is higher than kRest_cm above the
// lowest, it is gone. What is left is no person and has no misses. A cell that has lost its last
// obstacle and whose ground was not observed is unknown again.
// So an obstacle lasts while it is occluded, in the blind cone below the lowest beam, as a whole
// above the highest, or out of range. With ageing_revolutions of 2 or more it also lasts as long as
// the fans hit it once in each revolution, however late its returns are filed. With 1, what fills
// its cell so little that beams pass beside it in the same revolution is lost until it is filed
// again.
// Filing a hard return in the upper half of the hard interval (or, where there is none, a soft one
// in the soft interval's) makes the misses 0 and ends the misses of its revolution too. One below
// does not: a root does not keep the ghost of a person who stood on it. Filing alone keeps an
// obstacle that is filed for each revolution, by up to ageing_revolutions - 2 revolutions late.
// Whether a revolution is a new one is told by its parity against that of the last miss or hit:
// what is seen through in every second revolution only does not age.
//
// Low things (ours). What stands no higher than growth does is an obstacle only when most of its
// returns are firm (core/segmentation). Each block of 2 x 2 cells counts those that were, and those
// that spoke against it: loose ones, and ground from nearby. Counts go up to 15; then both are
// halved: new looks count more. A cut by 0.15 m or more makes them 0: they were of what has gone.
// They make no obstacle alone: the rule wants hard returns in the cell too, which age as above.
//
// A person's flag lasts while returns of a person come: each sets a memory of kPersonMemory, and
// each new revolution (by parity too) whose first hard or ground return is not a person's takes one
// off.
// The ground ages by being seen: in a cell without an obstacle, a ground return of a new revolution
// lets `lowest` rise by at most one centimetre, and not above that return, so that the ground
// follows a slow drift of the odometry's height.

namespace hardpack {

// What the beams of one direction saw, as far as ageing needs it: a fan of rays in a vertical
// plane.
struct SightFan {
  Vec3 sensor_odom;
  Vec2 direction_odom;  // level, length 1
  int32_t beams = 0;
  // [beams], any order. How far a beam got: level distance of its return from the sensor [m], of
  // whatever class; 0 or less for a beam that must not count: it saw nothing. A beam that was fired
  // and came back from nowhere may be given the furthest level of the others: then it counts as
  // having gone through as far as the direction is known not to be blocked.
  float level_m[kMaxBeams] = {};
  float slope[kMaxBeams] = {};  // rise of the beam over level distance
  // Slopes of the lowest and highest beam that the sensor has in this direction: with `beams` they
  // tell the mean spacing.
  float lowest_slope = 0.0f;
  float highest_slope = 0.0f;
};

class HeightGrid {
 public:
  // Heights are centimetres in the odom frame, rounded to the nearest and saturated to
  // +-kMaxHeight_cm about the sum of the shifts since Reset; kNone: no such return.
  static constexpr int16_t kNone = 32767;
  static constexpr int32_t kMaxHeight_cm = 20000;

  // Of ageing, see above. kBehind_m and kEndsBefore_m: a cell reaches 0.14 m from its middle;
  // behind it a wall's returns scatter.
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
    bool firm = false;      // what is low around it is firm,
    bool growth = false;    // or growth
  };

  // What a cell's byte tells of its ground and its hard returns; its other bits are for ageing.
  enum Seen : uint8_t {
    kGroundHeightKnown = 1,
    kPersonMask = 6,         // not 0: a person is among the hard returns
    kGroundFromBeside = 32,  // its height, or without one that it was observed
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

  // Counts one return of something low, in its block: that it is firm, or that it is not. Off the
  // window, or not finite: nothing. Constant cost.
  void CountLow(const Vec3& point_odom, bool firm);
  // A ground return came from where low things were filed: it speaks against them if it is as high.
  // Constant cost.
  void DoubtLow(const Vec3& point_odom);

  // Ground observed along the straight line between two points of it, both ends included: every
  // cell that the line crosses and that has no ground yet gets ground at the height of the line's
  // point nearest to the cell's middle (`lowest` stays below it where it is); one that has is left
  // alone, as is what is off the window. kNotFinite; kInvalidArgument: longer over ground than
  // kMaxBridge_m, or beyond 2^22 cells from the origin, where floats do not tell cells apart well:
  // nothing is filed. Cost: at most kMaxBridge_cells cells.
  static constexpr float kMaxBridge_m = 40.0f;
  static constexpr int kMaxBridge_cells = 286;  // a line of 200 cells' length crosses 284 borders
  Status BridgeGround(const Vec3& from_odom, const Vec3& to_odom);

  // The same cells are observed, but no height is taken: what looks like ground there may turn out
  // to be low growth. Only x and y of the points count. Statuses and cost of BridgeGround.
  Status ObserveGround(const Vec3& from_odom, const Vec3& to_odom);

  // A nearer look did not see the ground between two points of it. Between the cells of the two
  // ends, what was bridged, assumed or only observed is unknown again: a ditch that is narrower
  // than the rings' spacing is bridged from afar. Where a ground return came from stays. Statuses
  // and cost of BridgeGround.
  Status ForgetGround(const Vec3& from_odom, const Vec3& to_odom);

  // Takes the ground of all cells whose centre lies within radius_m of a point as observed, in the
  // plane through it that rises by `slope` a metre along x and y, where no ground is known yet, as
  // BridgeGround does. kNotFinite;
  // kInvalidArgument: radius_m is negative or above kMaxAssumed_m. Cost: the cells of the square
  // around it.
  static constexpr int kMaxAssumed_m = 20;
  Status AssumeGround(const Vec3& center_odom, float radius_m, Vec2 slope = {});

  // The same for the ground under a vehicle, in every tick: up to kMaxStanding_m.
  static constexpr int kMaxStanding_m = 1;
  Status StandOnGround(const Vec3& center_odom, float radius_m, Vec2 slope);

  // Lets the cells age that the fan's beams crossed. kNotFinite: a number of the fan (slopes of
  // beams that saw nothing excepted); kInvalidArgument: beams not 0 .. kMaxBeams, a direction that
  // has not length 1 to 1 %, a sensor off the window, or ageing_revolutions not 1 ..
  // kMaxAgeingRevolutions: nothing ages. Cost: at most kMaxSight_cells cells, of which those with
  // an obstacle that can age look at every beam, at most twice.
  static constexpr int kMaxSight_cells = 2 * kMapSize_cells;
  // From now on no more than so many cells are held against a fan, until the next call; without it
  // there is no limit. The others stay as they are.
  void BeginTick(int aged_cells) { aged_left_ = aged_cells; }
  Status Age(const SightFan& fan, uint32_t revolution, int ageing_revolutions);

  // Cells that BridgeGround, ObserveGround and ForgetGround have walked, counted on; it wraps.
  uint32_t crossed_cells() const { return crossed_cells_; }

  // The odometry's height jumped by dz_m: everything that was filed is told in the new heights, to
  // the centimetre. kNotFinite; kInvalidArgument: the shift, or the sum of all since Reset, is
  // beyond +-kMaxShift_cm: nothing changes. Cost: constant.
  static constexpr int32_t kMaxShift_cm = 10000;
  Status ShiftHeights(float dz_m);

  const GridWindow& window() const { return window_; }

  // Empty for a cell off the window. Cost: constant.
  CellHeights At(Cell cell) const;

  // What is added to heights as they are stored to tell them, see ShiftHeights.
  int32_t datum_cm() const { return datum_cm_; }

  // The cells first.x .. first.x + kMapSize_cells - 1 of row first.y, as arrays, so that loops over
  // them vectorise. Heights are as stored, kNone included: they compare with one another, also
  // across a shift. Cells off the window are empty. seen: of Seen. Precondition: first.x <=
  // INT32_MAX - kMapSize_cells. Cost: kMapSize_cells cells copied.
  using HeightRow = std::span<int16_t, kMapSize_cells>;
  using SeenRow = std::span<uint8_t, kMapSize_cells>;
  void ReadGround(Cell first, HeightRow lowest_cm, SeenRow seen) const;
  void ReadObstacles(Cell first, HeightRow lowest_hard_cm, HeightRow highest_hard_cm,
                     HeightRow highest_soft_cm) const;
  // What is low in so many cells of a row, at most kMostLow_cells: kFirmLow, kGrowth or 0 each;
  // what has left the window may be told as it was.
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

  // One fan as its cells see it.
  struct Sight {
    Vec2 direction;                 // of length 1 to rounding
    float z_cm = 0.0f;              // the sensor's, above the stored heights' zero
    float spacing_cm_per_m = 0.0f;  // of the beams, by level distance
    bool odd = false;               // the revolution
    int ageing_revolutions = 0;
  };
  // A cell's obstacle, in stored heights, and where its middle is along the fan.
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

  // The storage place of a cell of the plane; the cells of one window all have different ones.
  static constexpr int Slot(Cell cell) {
    constexpr uint32_t kMask = kMapSize_cells - 1;
    return static_cast<int>((static_cast<uint32_t>(cell.y) & kMask) * kMapSize_cells +
                            (static_cast<uint32_t>(cell.x) & kMask));
  }

  // Of a row of a plane of stored cells, the part that lies in the window, see ReadGround.
  // The counts of a cell's block: firm in the high half of the byte, against it in the low one.
  static constexpr int kBlocks = kMapSize_cells / 2;
  static constexpr int BlockSlot(Cell cell) {
    constexpr uint32_t kMask = kBlocks - 1;
    return static_cast<int>(((static_cast<uint32_t>(cell.y) >> 1) & kMask) * kBlocks +
                            ((static_cast<uint32_t>(cell.x) >> 1) & kMask));
  }
  static constexpr int kCountOne = 16;  // of what is firm
  static constexpr int kMostCount = 15;
  // So many firm returns, and twice as many as spoke against them, are a low thing. So many against
  // it are growth.
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

  // Empties so many rows, or their part of so many columns, from offset (dx, dy) to the window's
  // origin on.
  void ClearRows(int dy, int rows);
  void ClearColumns(int dx, int columns, int dy, int rows);

  int16_t Stored(float z_m) const;
  int16_t Told(int16_t stored_cm) const;
  // Inline: the sight lines ask it of every cell.
  bool HasObstacle(int slot) const {
    return ((highest_hard_cm_[slot] ^ kNone) | (highest_soft_cm_[slot] ^ kNone)) != 0;
  }
  bool IsNewlyFiled(int slot, bool odd);
  void FileGround(int slot, int16_t height_cm, bool odd);
  void FileHard(int slot, int16_t height_cm, bool odd, bool person);
  void FileSoft(int slot, int16_t height_cm, bool odd);
  // What is done to the cells that a line crosses.
  enum class Crossing : uint8_t { kBridge, kObserve, kForget };
  Status CrossCells(const Vec3& from_odom, const Vec3& to_odom, Crossing crossing);
  void ForgetCell(int slot);
  bool NeedsNone(Cell cell, int known) const;
  void TakeAsGround(Cell cell, float z_m);
  // No misses, and none any more in this revolution.
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
};
static_assert((kMapSize_cells & (kMapSize_cells - 1)) == 0);
static_assert(sizeof(HeightGrid) <= 9 * kMapCells + kMapCells / 4 + 64);
static_assert(std::is_trivially_copyable_v<HeightGrid>);

}  // namespace hardpack
