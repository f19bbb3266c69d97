// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "hal/ouster/ouster.h"

// Which lidar is simulated, and how good it is: the manufacturer's data, and settings.

namespace hardpack::sim {

enum class LidarModel : uint8_t {
  kOuster,  // OS1-64
  kVlp16,   // Velodyne VLP-16
  kVlp32c,  // Velodyne VLP-32C
};

constexpr bool IsVelodyne(LidarModel model) {
  return model != LidarModel::kOuster;
}

enum class LidarProfile : uint8_t {  // of an Ouster's packets
  kLegacy,                           // first generation, no header; firmware 1.13
  kRng19,                            // RNG19_RFL8_SIG16_NIR16 with header and CRC; firmware 3.2
};

// Directions of a sensor's beams, in the order in which it sends them, and when each fires.
struct LidarBeams {
  static constexpr int kMost = 64;

  int count = kMost;
  std::array<double, kMost> altitude_deg = {};
  std::array<double, kMost> azimuth_deg = {};  // clockwise from the head's direction
  std::array<double, kMost> above_m = {};      // height at the head's axis, from the origin
  // After the first beam of its column; never less than for the previous beam.
  std::array<uint64_t, kMost> fires_after_ns = {};
  double origin_to_beam_m = 0.012163;  // first-generation OS1
  double lidar_above_sensor_m = 0.03618;

  // Close to the published angles of an OS1-64: 33.2 degrees in equal steps, four columns of beams.
  static LidarBeams Default();
  // Those of a real sensor with 64 beams.
  static LidarBeams Of(const ouster::Metadata& metadata);
  // As published, the same for all sensors of a model; for an Ouster Default().
  static LidarBeams Of(LidarModel model);
};

struct LidarSettings {
  LidarModel model = LidarModel::kOuster;
  LidarProfile profile = LidarProfile::kLegacy;  // of an Ouster
  LidarBeams beams = LidarBeams::Default();      // of an Ouster; a Velodyne has those of its model
  int columns = 1024;                            // of an Ouster's revolution: 512, 1024 or 2048
  int revolutions_per_s = 10;
  // For a Velodyne, whose motor follows no clock: the largest relative wander of its rate.
  double turn_wander = 0.003;
  // Position of the sensor frame's origin in the body frame. With a yaw of 0 an Ouster's x axis
  // points ahead; for a Velodyne it is the y axis, at azimuth 0, and x points right.
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 1.284;
  double yaw_rad = 0.0;  // pi: the sensor faces backward
  // An additional, unmeasured rotation about the body's axes.
  double off_roll_rad = 0.0;
  double off_pitch_rad = 0.0;
  double reach_m = 110.0;
  double noise_m = 0.004;       // standard deviation of a range,
  double noise_per_m = 0.0;     // plus this for each metre of range
  double drop_out_share = 0.0;  // of the returns, at random
  // The sensor's clock when the simulation starts; a Velodyne sends the time past its hour.
  uint64_t clock_start_ns = 17'000'000'000;
  double clock_drift = 0.0;  // of that clock, in seconds per second
  uint32_t seed = 1;
};

// An ideal sensor: its full range, no return lost, and 4 mm of noise.
LidarSettings CleanLidar(LidarModel model);
// An Ouster: 1 cm nearby and 3 cm at 50 m. A Velodyne: 1.2 cm everywhere; its published 3 cm is two
// and a half times that. One return in a hundred is lost.
LidarSettings NoisyLidar(LidarModel model = LidarModel::kOuster);

// The data of a column, by beam.
struct LidarReturns {
  std::array<uint32_t, LidarBeams::kMost> ranges_mm = {};  // 0: nothing came back
  std::array<uint8_t, LidarBeams::kMost> reflectivities = {};
  std::array<bool, LidarBeams::kMost> is_faint = {};  // returned by a drop or by dust
};

}  // namespace hardpack::sim
