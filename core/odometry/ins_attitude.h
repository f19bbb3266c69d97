// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/onboard_parameters.h"
#include "core/measurements/measurements.h"

// From the INS's frames (NED, z down) to ours (east, north, up and body: docs/frames.md).

namespace hardpack {

// The rotation INS -> body, [3 x 3], row-major. The INS's own frame has z down: half a turn about x
// precedes the mounting rotation.
void BodyFromIns(const InsParams& ins, float (&body_from_ins)[9]);

// The attitude of the body.
struct BodyAttitude {
  float roll_rad = 0.0f;
  float pitch_rad = 0.0f;
  float heading_rad = 0.0f;  // (-pi, pi], of its x axis from true east, anticlockwise
};

// Precondition: the sample has an attitude with angles within kSinCosMaxAngle_rad. Constant cost.
BodyAttitude BodyAttitudeOf(const InsSample& sample, const float (&body_from_ins)[9]);

}  // namespace hardpack
