// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/fit/vehicle_fit.h"
#include "tools/picture/canvas.h"

// Recorded and predicted motion over time, for some segments: yaw rate above, forward speed below.

namespace hardpack::fit {

inline constexpr size_t kDrawnSegments = 6;

// At most kDrawnSegments, side by side; the recording's dots, the model, and the published first
// order with the stock separation.
picture::Canvas DrawFit(const std::vector<DriveSegment>& segments, const VehicleFit& fit);

// Selected from the segments in which a wheel is commanded to change its speed by more than 4 rad/s
// (from all, if those are fewer than kDrawnSegments): evenly spaced in the order from the worst to
// the best predicted yaw rate.
std::vector<DriveSegment> FromWorstToBest(const std::vector<DriveSegment>& segments,
                                          const VehicleFit& fit);

}  // namespace hardpack::fit
