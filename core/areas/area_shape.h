// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/areas/area.h"
#include "core/base/footprint.h"
#include "core/base/grid.h"
#include "core/base/pose.h"

// A placed area against the map's cells and against the vehicle's outline. In single precision,
// with a margin for its rounding that is always on the safe side: what is within it counts as
// touched. The margin is 0.2 mm for a polygon near the map or the vehicle, and grows to 0.4 m for
// corners 100 km away. The same bits on every target. Ours.

namespace hardpack {

// Cells of one row of the map, one bit each: column 32 w + b is bit b of word w.
struct RowCells {
  uint32_t word[kRowWords] = {};
  constexpr bool Has(int column) const {
    return ((word[column / 32] >> (static_cast<uint32_t>(column) % 32u)) & 1u) != 0;
  }
};

// The rows of a map that an area can close or a zone can touch: those of its box, or all for a
// fence. first > last: none.
struct RowRange {
  int32_t first = 0;
  int32_t last = -1;
};
RowRange RowsOf(const Area& area, const GridWindow& window);

// The cells of a row that an area closes: of a keep-out area those that it touches, also with its
// border only, of a fence those that are not entirely inside it, of a speed zone none. A cell's
// whole square counts. Precondition: 0 <= row < kMapSize_cells. Cost: the edges, and of each edge
// the words that it covers.
RowCells ClosedCells(const Area& area, const GridWindow& window, int row);

// Whether the vehicle's outline at a pose, longer by ends_m at each end and wider by flanks_m at
// each side, touches the polygon: its border or what lies inside. Precondition: the pose is finite.
// Cost: one pass over the corners.
bool IsTouched(const Area& area, const Footprint& footprint, const Pose2& pose, float ends_m,
               float flanks_m);

// Whether the outline is where this area forbids it: touches a keep-out area, or is not entirely
// inside a fence. A speed zone forbids nothing. Precondition and cost as above.
bool IsBreached(const Area& area, const Footprint& footprint, const Pose2& pose);

// The same for a single point, as for a goal: without a margin, exact for the point to the nearest
// millimetre.
bool Forbids(const Area& area, Vec2 place_odom);

}  // namespace hardpack
