// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/parameters.h"
#include "core/base/grid.h"
#include "core/base/progress.h"
#include "core/base/status.h"
#include "core/costmap/height_grid.h"

// From heights to costs ([OS] Cost Map Creation; docs/algorithm.md section 1): obstacle rule, then
// for the hard and for the soft layer alike dilation by the planning radius, a cost that grows with
// the depth inside the dilated region and a convex halo outside it, and the sum of both. Lethal is
// a flag beside the cost. Distances are exact Euclidean between cell centres, up to a saturation.

namespace hardpack {

// Costs are fixed point: cost_q8 / 256. (1 + cost) is at most 40.
inline constexpr int kCostOne_q8 = 256;
inline constexpr int kMaxCost_q8 = 39 * kCostOne_q8;

// Distances saturate at the square root of this many squared cells (15.97 cells, 3.19 m).
inline constexpr int kMaxDistance2_cells2 = 255;

// One map, as the search, the optimizer and the check read it. Plain data, row-major along y.
struct Costmap {
  enum Flag : uint8_t {
    kHard = 1,         // holds a hard obstacle
    kSoft = 2,         // holds a soft obstacle and no hard one
    kPerson = 4,       // the hard obstacle is a person
    kObserved = 8,     // holds at least one return
    kLethal = 16,      // inside the dilated hard region: never driven through
    kSoftRegion = 32,  // inside the dilated soft region
  };

  GridWindow window;
  uint16_t cost_q8[kMapCells];        // hard layer + soft layer
  uint8_t flags[kMapCells];           // of Flag
  uint8_t hard_distance2[kMapCells];  // squared distance [cells^2] to the nearest hard cell,
                                      // saturated; 0 in a hard cell
  uint8_t hard_depth2[kMapCells];     // squared distance [cells^2] of a lethal cell to the nearest
                                      // cell that is not, saturated; 0 outside
  bool Lethal(int index) const { return (flags[index] & kLethal) != 0; }

  // Bilinear between the centres of the four nearest cells, as a plain number (not q8). Points off
  // the window take the cost of the nearest cell in it. NaN gives the cost of a corner: callers
  // validate.
  float CostAt(float x_m, float y_m) const;
};

// Checks parameters that depend on one another, beyond the table's ranges: hard + soft cost cannot
// exceed kMaxCost_q8, radii fit the saturation, the clearance is above the obstacle height.
Status CheckCostmapParams(const CostmapParams& params);

// Builds a Costmap from a HeightGrid or from occupancy, resumable. A unit is one row of one pass;
// kUnits units build a map, whatever it holds.
class CostmapBuilder {
 public:
  static constexpr int kPasses = 14;
  static constexpr int kUnits = kPasses * kMapSize_cells;

  // From heights. The window is the grid's at this moment; the grid may be written to and may roll
  // while the build goes on (a cell that has rolled out reads as empty).
  Status Begin(const HeightGrid& heights, const CostmapParams& params);
  Progress Step(const HeightGrid& heights, int units);

  // From given cells (maps from files, tests): call SetCell for any cells between BeginCells and
  // the first StepCells. flags: kHard, kSoft, kPerson, kObserved.
  Status BeginCells(const GridWindow& window, const CostmapParams& params);
  void SetCell(int index, uint8_t flags);
  Progress StepCells(int units);

  // Valid once Step has returned kDone and until the next Begin.
  const Costmap& result() const { return map_; }

 private:
  // Costs by squared distance: [2 layers][inside, outside][squared distance].
  static constexpr int kTable = kMaxDistance2_cells2 + 1;

  Costmap map_;
  CostmapParams params_;
  int32_t row_ = 0;
  int32_t pass_ = 0;
  uint8_t column_distance_[kMapCells];
  uint16_t cost_table_q8_[2][2][kTable];
};
static_assert(sizeof(CostmapBuilder) <= 6 * kMapCells + 4096);

}  // namespace hardpack
