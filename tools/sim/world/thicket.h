// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/sim/world/named_worlds.h"

// The world `thicket`: a field of cylinders and boxes, 14 m wide and 30 m long, between two walls,
// so that the only way to the goal leads through it. A cellular automaton places them (random
// cells, then a few rounds in which a cell with many full neighbours fills and one with few
// empties), as in the benchmark BARN (REFERENCES.md); one field is sparse, another barely passable.

namespace hardpack::world {

// The field: cells as wide as twice a cylinder's radius.
struct ThicketField {
  static constexpr int kColumns = 62;  // along x
  static constexpr int kRows = 29;     // along y
  static constexpr double kCell_m = 0.48;
  static constexpr double kBegin_m = 3.0;      // x of its near edge
  static constexpr double kHalfWidth_m = 7.0;  // y of the walls' inner faces
};

// Each field has a path from the start to the goal that keeps at least this far from everything.
inline constexpr double kThicketHalfGap_m = 1.2;

void MakeThicket(uint64_t seed, Scenario& scenario);

}  // namespace hardpack::world
