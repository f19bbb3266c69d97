// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tools/picture/canvas.h"

// The colours of the paper's figures ([OS] Experimental Results): grey free, green rough ground,
// bright orange hard and dark orange soft obstacles; base path red, optimized path blue, goal pink.

namespace hardpack::picture {

inline constexpr Colour kFree = {0.76, 0.76, 0.76};
inline constexpr Colour kNotObserved = {0.80, 0.87, 0.97};
inline constexpr Colour kOffMap = {0.35, 0.35, 0.38};
inline constexpr Colour kRough = {0.55, 0.74, 0.45};   // at the edge of the dilated region
inline constexpr Colour kClosed = {0.33, 0.55, 0.27};  // lethal: inside the dilated hard region
inline constexpr Colour kHard = {1.00, 0.60, 0.05};
inline constexpr Colour kSoft = {0.70, 0.36, 0.00};
inline constexpr Colour kPerson = {0.80, 0.10, 0.75};
inline constexpr Colour kBasePath = {0.85, 0.05, 0.05};
inline constexpr Colour kOptimizedPath = {0.05, 0.20, 0.90};
inline constexpr Colour kDriven = {1.00, 0.90, 0.10};
inline constexpr Colour kGoal = {1.00, 0.35, 0.70};
inline constexpr Colour kVehicle = {0.05, 0.05, 0.05};
inline constexpr Colour kUnperturbed = {0.10, 0.60, 0.15};
inline constexpr Colour kInk = {0.10, 0.10, 0.10};
inline constexpr Colour kFaintInk = {0.42, 0.42, 0.42};
inline constexpr Colour kGridLine = {0.90, 0.90, 0.90};

// The colour of one cell of a costmap: obstacles first, then the lethal region, then green that
// fades to grey with the cost; unobserved cells have their own colour. flags: Costmap::Flag.
Colour CellColour(uint8_t flags, uint16_t cost_q8);

// A sequential scale for costs: light for 0, dark for 1.
Colour CostColour(double share);

}  // namespace hardpack::picture
