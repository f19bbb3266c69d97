// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/grid.h"
#include "core/costmap/terrain.h"
#include "tools/picture/axes.h"
#include "tools/picture/canvas.h"

// terrain.png: what the costmap knows of the ground itself (core/costmap/terrain.h). Grade on the
// left, roughness on the right; what is too steep to be driven has the colour of an obstacle.

namespace hardpack::picture {

// The darkest colours: a grade of 0.5, a roughness of 0.1 m.
inline constexpr double kDarkestGrade = 0.5;
inline constexpr double kDarkestRoughness_m = 0.1;

// The terrain of a map with that window, in the ranges shown.
Canvas DrawTerrain(const Terrain& terrain, const GridWindow& window, Range x, Range y,
                   const std::string& title);

// Where a panel is, left 0 and right 1.
Rectangle TerrainPanel(int panel);

}  // namespace hardpack::picture
