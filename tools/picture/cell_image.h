// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>

#include "core/base/grid.h"
#include "core/costmap/costmap.h"
#include "tools/picture/axes.h"
#include "tools/picture/canvas.h"

// Draws the cells of a grid as squares of one colour each, at their position in a plot.

namespace hardpack::picture {

// colour_of(index): row-major index of the window. Only cells in the plot's range are queried.
void DrawCells(Canvas& canvas, const Axes& axes, const GridWindow& window,
               const std::function<Colour(int)>& colour_of);

// A costmap in the paper's colours (palette.h).
void DrawCostmap(Canvas& canvas, const Axes& axes, const Costmap& map);

// A row of coloured patches, each with its text, from a place to the right.
struct Patch {
  const char* text;
  Colour colour;
};
void DrawPatches(Canvas& canvas, double left_px, double top_px, std::span<const Patch> patches);

// The scale of CostColour beside a panel: from 0 up to `most`, and what it is of.
void DrawCostScale(Canvas& canvas, const Rectangle& panel, const std::string& most,
                   const std::string& what);

// A bar of a round number of metres in the lower left corner of the plot.
void DrawScaleBar(Canvas& canvas, const Axes& axes);

}  // namespace hardpack::picture
