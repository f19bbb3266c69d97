// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "config/parameters.h"
#include "core/base/status.h"
#include "core/costmap/costmap.h"
#include "tools/picture/axes.h"
#include "tools/picture/canvas.h"

// costmap.png: the six panels of the paper's costmap figure ([OS] Cost Map Creation): input, both
// layers dilated, the costs of both, and their sum.

namespace hardpack::picture {

// Shows the part of the map within x and y [m, odom]. The costs of one layer come from a costmap
// built from that layer's obstacles alone, with the same parameters.
Canvas DrawCostPanels(const Costmap& map, const CostmapParams& params, Range x, Range y,
                      const std::string& title);

}  // namespace hardpack::picture
