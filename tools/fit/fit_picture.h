// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tools/fit/vehicle_fit.h"
#include "tools/picture/canvas.h"

// Recorded and predicted, over time, for some segments: yaw rate above, forward speed beneath.

namespace hardpack::fit {

inline constexpr size_t kDrawnSegments = 6;

// At most kDrawnSegments, side by side; the recording's dots, the model, and the published first
// order with the stock separation.
picture::Canvas DrawFit(const std::vector<DriveSegment>& segments, const VehicleFit& fit);

// Of the segments in which a wheel is to change its speed by more than 4 rad/s (of all, where those
// are fewer than kDrawnSegments): from that whose yaw rate the model predicts worst to the best
// one, evenly through the order.
std::vector<DriveSegment> FromWorstToBest(const std::vector<DriveSegment>& segments,
                                          const VehicleFit& fit);

}  // namespace hardpack::fit
