// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/base/progress.h"
#include "core/base/saturate.h"
#include "core/base/status.h"
#include "core/costmap/height_grid.h"
#include "core/costmap/near_unknown.h"
#include "core/costmap/padded_row.h"
#include "core/costmap/terrain.h"

// From heights to costs ([OS] Cost Map Creation; docs/algorithm.md section 1): obstacle rule; then,
// for the hard and the soft layer alike, dilation by the planning radius, a cost that grows with
// the depth inside the dilated region and a convex halo outside it; and the sum of both. Lethal is
// a flag next to the cost. Distances are exact Euclidean between cell centres, up to a saturation.
// Only cells of the map count: beyond its border there is neither an obstacle nor a way out.
//
// The obstacle rule kLocalGround (ours). The lowest and the highest hard return of a cell are
// known. `near ground`: the cell's own lowest return if its ground height is known, otherwise the
// lowest in those of the 5 x 5 cells around it that have a ground return. `far ground`: the lowest
// return of any class in the square of ground_window_cells around the cell. `ground` is the near
// ground if it exists, otherwise the far ground.
//   no hard return                                          not hard
//   near ground known and the cell's own not guessed,
//   lowest hard - near ground > clearance_height            not hard: overhead only
//   highest hard - ground > growth_height                   hard; includes a trunk under its crown,
//                                                           and anything between low and high
//   the low returns here are firm (HeightGrid)              hard: a rock, a log, a kerb, a wire
//   a person among the hard returns                         hard, standing or lying
//   no observed ground in the square                        hard: its height is unknown
//   the ground itself is too steep (core/costmap/terrain.h) hard
//   otherwise                                               not hard: grass, a root
// Low returns were compared with the ground line of their own direction, so a slope is not low. A
// cell that is not hard is soft if highest soft - ground > growth_height, and free otherwise; free
// or soft, it is growth if most of its low returns are not firm. On a slope the ground of the
// square lies below the ground under the cell by up to slope x half the square, so errors are on
// the safe side; near ground is off by two cells at most. A cell is observed if its ground was, or
// if it is hard or soft; any other cell is unknown, and unknown_cost is added to its cost;
// near_unknown_cost where the outline would cover such a cell near the lidar.
//
// The rule kInCell ([OS]): `ground` is the lowest return of the same cell, and nothing is overhead;
// a person is hard in this rule too (ours).

namespace hardpack {

// Costs are fixed point: cost_q8 / 256. (1 + cost) is at most 40 but for near_unknown_cost, which
// comes on top; to the search what is dearer costs 40.
inline constexpr int kCostOne_q8 = 256;
inline constexpr int kMaxCost_q8 = 39 * kCostOne_q8;

// Distances saturate at the square root of this many squared cells (15.97 cells, 3.19 m).
inline constexpr int kMaxDistance2_cells2 = 255;

// Limits on CostmapParams, so that every relevant distance is below the saturation.
inline constexpr float kMaxPlanningRadius_m = 3.0f;
inline constexpr float kMaxHalo_m = 3.0f;
inline constexpr int kMaxGroundWindow_cells = 31;

// One map, as read by the search, the optimizer and the check. Plain data, row-major along y.
struct Costmap {
  enum Flag : uint8_t {
    kHard = 1,         // holds a hard obstacle
    kSoft = 2,         // holds a soft obstacle and no hard one
    kPerson = 4,       // the hard obstacle is a person
    kObserved = 8,     // the ground was observed, or it holds an obstacle; otherwise unknown
    kLethal = 16,      // inside the dilated hard region: never driven through
    kSoftRegion = 32,  // inside the dilated soft region
    kGrowth = 64,      // low growth, not hard: lower objects may hide in it
    kClosed = 128,     // hard because an area closes it, whatever stands in it
  };

  GridWindow window;
  uint16_t cost_q8[kMapCells];        // hard layer + soft layer + unknown (both)
  uint8_t flags[kMapCells];           // of Flag
  uint8_t hard_distance2[kMapCells];  // squared distance [cells^2] to the nearest hard cell,
                                      // saturated; 0 in a hard cell
  uint8_t hard_depth2[kMapCells];     // squared distance [cells^2] of a lethal cell to the nearest
                                      // cell that is not, saturated; 0 outside
  bool Lethal(int index) const { return (flags[index] & kLethal) != 0; }

  // Bilinear between the centres of the four nearest cells, as a plain number (not q8). Points off
  // the window, and points beyond its outermost centres, take the cost at the nearest place between
  // centres. NaN gives the cost of a corner or of a border: callers validate. Odom frame.
  float CostAt(float x_m, float y_m) const;
};
static_assert(std::is_trivially_copyable_v<Costmap>);

// Checks parameters that depend on each other, beyond the table's ranges, and everything that the
// build relies on: every number finite and none negative; hard + soft + unknown cost at most
// kMaxCost_q8, and near_unknown_cost; planning radius and halo at most 3 m, which is below the
// saturation; clearance above obstacle height; the ground window odd, 1 to 31 cells. kOk or
// kParameterOutOfRange.
Status CheckCostmapParams(const CostmapParams& params);

// How much more of a disc's half chord is left at dx than at dx + 1, in cells.
struct ChordSteps {
  static constexpr int kMost = 15;
  uint8_t of[kMost] = {};
};

// Builds a Costmap from a HeightGrid or from occupancy, resumable. A unit is one row of one pass;
// kUnits units build a map from heights, kCellUnits from cells, for any content. The time of a unit
// is bounded by the work on a row; it is less where blocks of the row have no return that could be
// an obstacle, are far from every obstacle, or are entirely close to one. Any split of the units
// gives the same map.
class CostmapBuilder {
 public:
  // From heights, first the terrain is fitted. Then a row is classed once the rows that its ground
  // may come from have been loaded.
  static constexpr int kLag_cells = kMaxGroundWindow_cells / 2;
  static constexpr int kHeightUnits = Terrain::kUnits + kMapSize_cells + kLag_cells;
  // Then three sweeps, upwards, back, and upwards again; and the terrain's costs, several rows at a
  // time.
  static constexpr int kSweeps = 3;
  static constexpr int kTerrain_rows = 8;
  static constexpr int kTerrainUnits = kMapSize_cells / kTerrain_rows;
  static constexpr int kCellUnits = kSweeps * kMapSize_cells + kTerrainUnits;
  static constexpr int kUnits = kHeightUnits + kCellUnits;

  // Rows kept around the one being classed.
  static constexpr int kRingRows = 32;
  static_assert(kRingRows > 2 * kLag_cells);

  // From heights. Uses the grid's window at this moment; the grid may be written to and may roll
  // during the build (a cell that has rolled out reads as empty). kParameterOutOfRange: nothing
  // changes.
  Status Begin(const HeightGrid& heights, const CostmapParams& params);

  // Does at most `units` units; none if units <= 0. Returns kDone at once if nothing was begun.
  // Precondition: the build was not begun by BeginCells.
  Progress Step(const HeightGrid& heights, int units);

  // Only the first part: until the cells are classed. Then Mark may be called, and StepCells does
  // the rest.
  Progress StepHeights(const HeightGrid& heights, int units);

  // Adds an obstacle to a classed cell, for returns that are not in the heights yet: kHard, kSoft,
  // kPerson; others are ignored. A hard cell stays hard. Precondition: StepHeights has returned
  // kDone and StepCells has not been called, 0 <= index < kMapCells. Cost: constant.
  void Mark(int index, uint8_t flags);

  // Closes cells of a row that a person forbids, whatever is in them: they become hard and
  // observed, and a person in them stays one. closed: one bit per column, column 32 w + b is bit b
  // of word w; kMapSize_cells bits. Precondition: StepCells has not been called, and StepHeights
  // has returned kDone or BeginCells was called; 0 <= row < kMapSize_cells. Cost: constant.
  void CloseCells(int row, std::span<const uint32_t, kRowWords> closed);

  // Where the lidar is, for near_unknown_cost; without it nothing is near. Precondition: finite,
  // and Begin or BeginCells was called, and no Step since. Cost: constant.
  void SetLidar(const NearUnknownParams& params);

  // From given cells (maps from files, tests): call SetCell for any cells between BeginCells and
  // the first StepCells; cells not set are free and observed. kParameterOutOfRange: nothing
  // changes. Cost: kMapCells bytes written.
  Status BeginCells(const GridWindow& window, const CostmapParams& params);

  // flags: kHard, kSoft, kPerson, kObserved; others are ignored. A person is hard, and a hard cell
  // is not soft. Preconditions: 0 <= index < kMapCells; between BeginCells and StepCells.
  void SetCell(int index, uint8_t flags);

  // As Step. Precondition: the build was begun by BeginCells, or StepHeights is done.
  Progress StepCells(int units);

  // Makes all cells within radius_cells of one lethal, although nothing stands in them: for a place
  // where no path can be driven as the search found it. Precondition: Step has returned kDone, 0 <=
  // radius_cells <= kMaxRefused_cells, and fewer than kMaxRefused places are refused. Cost:
  // constant.
  static constexpr int kMaxRefused_cells = 8;
  static constexpr int kMaxRefused = 4;
  void Refuse(Cell middle, int radius_cells);

  // The map as it was before any place was refused. Cost: constant.
  void ForgetRefused();

  // Valid once Step has returned kDone and until the next Begin.
  const Costmap& result() const { return map_; }
  // Of a build from heights, once they are done; else there is none.
  const Terrain& terrain() const { return terrain_; }

 private:
  // The largest integer whose square is not saturated.
  static constexpr int kReach_cells = ChordSteps::kMost;
  static_assert(kReach_cells <= PaddedRow<uint8_t>::kMargin);
  static constexpr int kBlock_cells = 64;  // of a row, classed together
  static constexpr int kBlocks = kMapSize_cells / kBlock_cells;
  static constexpr int kGroup_rows = 4;  // for which the blocks with obstacles are known
  static constexpr int kLayers = 2;
  static constexpr int kPaddedRows = 3;
  static constexpr int kDistances2 = kMaxDistance2_cells2 + 1;

  // Blocks of `cells` cells, 1, 4 or 16, that together cover -half .. half of a row.
  struct Cover {
    int32_t cells;
    int32_t from[4];
  };
  static Cover CoverOf(int half);

  // Those of a row's blocks that are near an obstacle of either layer, one bit each.
  struct Blocks {
    uint16_t hard;
    uint16_t soft;
  };
  static_assert(kRowBlocks == 16);

  enum class Pass : uint8_t { kHeights, kObstacles, kRegions, kCosts, kTerrain, kDone };

  static constexpr int kRefusedSide_cells = 2 * kMaxRefused_cells + 1;
  static constexpr int kSavedBytes = 2 * kRefusedSide_cells * kRefusedSide_cells;
  static_assert(kMaxRefused * kSavedBytes <= kMapCells);

  template <typename Function>
  void ForRefused(Cell middle, int radius_cells, const Function& function);
  void Start(const GridWindow& window, const CostmapParams& params, Pass first);
  void EndUnit();
  int UnitsOfPass() const;
  void AddTerrain(int unit);
  void HeightUnit(const HeightGrid& heights);
  void StartHeights();
  void ClassUnit(const HeightGrid& heights, int row);
  void LoadRow(const HeightGrid& heights, int row);
  void LoadNoRow(int row);
  void ClassifyRow(const HeightGrid& heights, int row);
  void FindReturns();
  void FindLimits(int row);
  void FindLimitsInCell();
  void ReadLow(const HeightGrid& heights, Cell first);
  void FlagRow(int row);
  void CellUnit();
  Blocks NearObstacles(int row, int reach_cells) const;
  void SweepObstacles(int row);
  void FindRegions(int row);
  void SweepEdges(int row);
  void FindCosts(int row);
  const uint8_t* HardDistances(int row, unsigned blocks);
  const uint8_t* SoftDistances(int row, unsigned blocks);
  void AddCosts(int row, int begin, const uint8_t* hard2, const uint8_t* soft2);
  void AddHardCosts(int row, int begin, const uint8_t* hard2);
  void AddUnknown(int row, int begin);
  uint16_t CostOf(uint16_t hard, uint16_t soft) const {
    return static_cast<uint16_t>(hard_cost_q8_[hard] + soft_cost_q8_[soft]);
  }
  void FillCost(int entry);
  void FillChord();

  // Scratch while classing, in planes that are free until the first sweep: kRingRows rows each.
  // Heights as unsigned numbers with the same bits. For the far ground the smallest along x, over
  // one row, over 4 and over 16 from this one on; the lowest measured ground in five cells along x;
  // 1 where the ground's height is known, otherwise 0.
  static constexpr int kRing = kRingRows * kMapSize_cells;
  uint16_t* ring(int level) { return map_.cost_q8 + level * kRing; }
  uint16_t* near_ring() { return map_.cost_q8 + 3 * kRing; }
  uint8_t* known_ring() { return plane_; }
  // Of one row, 1 where no cell of the far ground's square is known, otherwise 0.
  uint8_t* no_ground_row() { return padded_[2].cells(); }

  Costmap map_ = {};
  CostmapParams params_;
  bool from_heights_ = false;  // the present build
  Pass pass_ = Pass::kDone;
  int32_t row_ = 0;             // of the pass, from its beginning
  int32_t radius2_cells2_ = 0;  // of the dilation
  int32_t radius_cells_ = 0;    // the largest integer within it
  Cover cover_ = {};            // of the far ground's square
  NearUnknown near_;
  Terrain terrain_;
  int32_t refused_ = 0;
  Cell refused_middle_[kMaxRefused] = {};
  int32_t refused_cells_[kMaxRefused] = {};
  // Scratch, [kMapSize_cells x kMapSize_cells] row-major. Once the map is built: flags and depths
  // of refused cells, as they were.
  uint8_t plane_[kMapCells] = {};

  // Scratch of one row, while classing.
  PaddedRow<int16_t> lowest_;
  PaddedRow<int16_t> ground_;  // where it was measured
  alignas(16) uint8_t known_count_[kMapSize_cells] = {};
  alignas(16) uint8_t seen_[kMapSize_cells] = {};
  alignas(16) int16_t high_[kMapSize_cells] = {};
  alignas(16) int16_t overhead_[kMapSize_cells] = {};
  alignas(16) int16_t lowest_hard_[kMapSize_cells] = {};
  alignas(16) int16_t highest_hard_[kMapSize_cells] = {};
  alignas(16) int16_t highest_soft_[kMapSize_cells] = {};
  alignas(16) uint8_t low_[kMapSize_cells] = {};

  // Scratch of one row for the sweeps: vertical distances by layer, and rows that are read to both
  // sides.
  alignas(16) uint8_t hard_row_[kMapSize_cells] = {};
  PaddedRow<uint8_t> soft_row_;
  PaddedRow<uint8_t> padded_[kPaddedRows];
  PaddedRow<uint8_t> row_flags_;
  Blocks group_blocks_[kMapSize_cells / kGroup_rows] = {};  // those that hold an obstacle
  bool any_returns_[kBlocks] = {};                          // of a row's blocks, while classing
  ChordSteps chord_steps_;                                  // see FillChord
  // The layers' costs by squared distance: outside the region, then inside. For the hard layer,
  // first for unknown ground, including its cost, then for observed ground.
  uint16_t hard_cost_q8_[4 * kDistances2] = {};
  uint16_t soft_cost_q8_[2 * kDistances2] = {};
  uint16_t near_cost_q8_ = 0;
  int32_t soft_reach_cells_ = 0;  // its costs are constant from this distance on
};
static_assert(sizeof(CostmapBuilder) <= 6 * kMapCells + 17 * 1024 + sizeof(Terrain));
static_assert(std::is_trivially_copyable_v<CostmapBuilder>);

// Inline: the optimizer calls it millions of times per second.
inline float Costmap::CostAt(float x_m, float y_m) const {
  constexpr float kLast = kMapSize_cells - 1;
  // In cells, from the centre of the window's first cell. The first difference is between close
  // numbers, so it is exact where the map is.
  const float u = x_m * kCellsPerMeter - static_cast<float>(window.origin.x) - 0.5f;
  const float v = y_m * kCellsPerMeter - static_cast<float>(window.origin.y) - 0.5f;
  // Comparisons with NaN are false, so NaN becomes 0 here.
  const float column = u > 0.0f ? (u < kLast ? u : kLast) : 0.0f;
  const float row = v > 0.0f ? (v < kLast ? v : kLast) : 0.0f;
  const int32_t column_floor = FloorToInt(column);
  const int32_t row_floor = FloorToInt(row);
  // The last centre belongs to the last pair.
  const int32_t x = column_floor < kMapSize_cells - 2 ? column_floor : kMapSize_cells - 2;
  const int32_t y = row_floor < kMapSize_cells - 2 ? row_floor : kMapSize_cells - 2;
  const float across = column - static_cast<float>(x);
  const float along = row - static_cast<float>(y);

  const uint16_t* low = cost_q8 + y * kMapSize_cells + x;
  const uint16_t* high = low + kMapSize_cells;
  const float low_left_q8 = low[0];
  const float low_right_q8 = low[1];
  const float high_left_q8 = high[0];
  const float high_right_q8 = high[1];
  const float low_q8 = low_left_q8 + (low_right_q8 - low_left_q8) * across;
  const float high_q8 = high_left_q8 + (high_right_q8 - high_left_q8) * across;
  constexpr float kOne = 1.0f / kCostOne_q8;
  return (low_q8 + (high_q8 - low_q8) * along) * kOne;
}

}  // namespace hardpack
