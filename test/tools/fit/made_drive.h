// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/fit/drive_record.h"

// A recording that the model itself drove, as the real one was made: runs of segments of 2 s at
// 20 Hz, setpoints held for three segments, wheel speeds that are taken anew but four times a
// second, a pose ten times a second.

namespace hardpack::fit {

struct MadeDrive {
  int runs = 8;
  uint64_t seed = 1;
  double wheel_noise_radps = 0.0;
  double position_noise_m = 0.0;
  double yaw_noise_rad = 0.0;
  double wheel_age_s = 0.025;
  double pose_age_s = 0.05;
};

std::string MakeDriveCsv(const sim::VehicleModelParams& params, const MadeDrive& settings);

}  // namespace hardpack::fit
