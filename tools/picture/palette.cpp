// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/costmap/costmap.h"

namespace hardpack::picture {
namespace {

// From this cost on ground is as green as it gets; the hard layer's edge has 6 by default.
constexpr double kFullGreenCost = 6.0;

}  // namespace

Colour CellColour(uint8_t flags, uint16_t cost_q8) {
  const bool observed = (flags & Costmap::kObserved) != 0;
  if ((flags & Costmap::kPerson) != 0) return kPerson;
  if ((flags & Costmap::kHard) != 0) return observed ? kHard : kOffMap;
  if ((flags & Costmap::kSoft) != 0) return observed ? kSoft : kNotObserved;
  if ((flags & Costmap::kLethal) != 0) return kClosed;
  // Its cost is that of not having been seen, mostly, and would look like rough ground.
  if (!observed) return kNotObserved;
  const double cost = static_cast<double>(cost_q8) / kCostOne_q8;
  if (cost <= 0.0) return kFree;
  // The square root lets the halo's thin end be seen.
  return Mix(kFree, kRough, std::sqrt(std::min(cost / kFullGreenCost, 1.0)));
}

Colour CostColour(double share) {
  // White over straw, orange and red to near black.
  static constexpr std::array<Colour, 6> kStops = {
      Colour{0.97, 0.97, 0.95}, Colour{0.99, 0.88, 0.60}, Colour{0.98, 0.65, 0.30},
      Colour{0.85, 0.32, 0.20}, Colour{0.52, 0.10, 0.22}, Colour{0.14, 0.03, 0.12}};
  const double position = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const size_t index = std::min(static_cast<size_t>(position), kStops.size() - 2);
  return Mix(kStops[index], kStops[index + 1], position - static_cast<double>(index));
}

}  // namespace hardpack::picture
