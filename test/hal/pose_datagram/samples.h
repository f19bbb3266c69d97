// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "hal/pose_datagram/pose_datagram.h"

namespace hardpack::pose_datagram {

// The example of docs/pose_datagram.md.
inline InsSample Example() {
  InsSample sample;
  sample.has_timestamp = true;
  sample.timestamp_ns = 1'234'567'890'123;
  sample.has_gps_time = true;
  sample.gps_time_ns = 1'443'000'000'000'000'000;
  sample.has_position = true;
  sample.latitude_ndeg = 30'618'000'000;
  sample.longitude_ndeg = -96'336'000'000;
  sample.altitude_m = 99.5f;
  sample.has_velocity = true;
  sample.velocity_ned = {1.0f, -2.0f, 0.5f};
  sample.has_attitude = true;
  sample.roll_rad = 0.25f;
  sample.pitch_rad = -0.5f;
  sample.yaw_rad = 1.5f;
  sample.has_angular_rate = true;
  sample.angular_rate = {0.125f, 0.0f, -0.75f};
  sample.has_acceleration = true;
  sample.acceleration = {0.0f, 0.5f, -9.75f};
  sample.has_status = true;
  sample.status.mode = InsMode::kTracking;
  sample.status.gnss_fix = true;
  sample.status.gnss_heading = true;
  sample.status.gnss_compass = true;
  sample.status.word = 0x61;
  sample.has_attitude_uncertainty = true;
  sample.attitude_uncertainty_rad = 0.0625f;
  sample.has_position_uncertainty = true;
  sample.position_uncertainty_m = 1.25f;
  sample.has_velocity_uncertainty = true;
  sample.velocity_uncertainty_mps = 0.03125f;
  return sample;
}

inline std::vector<uint8_t> Encoded(const InsSample& sample, uint32_t sequence) {
  std::array<uint8_t, kDatagram_bytes> bytes = {};
  EXPECT_EQ(Encode(sample, sequence, bytes), Status::kOk);
  return {bytes.begin(), bytes.end()};
}

}  // namespace hardpack::pose_datagram
