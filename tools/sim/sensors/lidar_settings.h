// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "hal/ouster/ouster.h"

// Which lidar is simulated, and how good it is: what its maker says of it, and what is set.

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

// Where the beams of a sensor point, in the order in which it sends them, and when each fires.
struct LidarBeams {
  static constexpr int kMost = 64;

  int count = kMost;
  std::array<double, kMost> altitude_deg = {};
  std::array<double, kMost> azimuth_deg = {};  // clockwise from where the head looks
  std::array<double, kMost> above_m = {};      // where it leaves the head's axis, from the origin
  // The first of its column; never less than the beam before.
  std::array<uint64_t, kMost> fires_after_ns = {};
  double origin_to_beam_m = 0.012163;  // first-generation OS1
  double lidar_above_sensor_m = 0.03618;

  // Near the published angles of an OS1-64: 33.2 degrees in even steps, four columns of beams.
  static LidarBeams Default();
  // Those of a sensor that exists, of 64 beams.
  static LidarBeams Of(const ouster::Metadata& metadata);
  // As published, the same for all sensors of a model; of an Ouster Default().
  static LidarBeams Of(LidarModel model);
};

struct LidarSettings {
  LidarModel model = LidarModel::kOuster;
  LidarProfile profile = LidarProfile::kLegacy;  // of an Ouster
  LidarBeams beams = LidarBeams::Default();      // of an Ouster; a Velodyne has those of its model
  int columns = 1024;                            // of an Ouster's revolution: 512, 1024 or 2048
  int revolutions_per_s = 10;
  // Of a Velodyne, whose motor follows no clock: by so much of itself its rate wanders at most.
  double turn_wander = 0.003;
  // Of the sensor frame's origin in the body frame. With a yaw of 0 an Ouster's x axis looks ahead;
  // of a Velodyne it is the y axis, where its azimuth is 0, and x is to the right.
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 1.284;
  double yaw_rad = 0.0;  // pi: the sensor looks backward
  // How it is turned besides, about the body's axes: what nobody has measured.
  double off_roll_rad = 0.0;
  double off_pitch_rad = 0.0;
  double reach_m = 110.0;
  double noise_m = 0.004;       // standard deviation of a range,
  double noise_per_m = 0.0;     // and this more for each metre of it
  double drop_out_share = 0.0;  // of the returns, at random
  // The sensor's clock when the simulation starts; a Velodyne says how far it is past its hour.
  uint64_t clock_start_ns = 17'000'000'000;
  double clock_drift = 0.0;  // of that clock, a second a second
  uint32_t seed = 1;
};

// As good as its maker could wish: its reach, no return lost, and 4 mm of noise.
LidarSettings CleanLidar(LidarModel model);
// An Ouster: 1 cm near by and 3 cm at 50 m. A Velodyne: 1.2 cm everywhere, of which its published
// 3 cm is two and a half. A return in a hundred is lost.
LidarSettings NoisyLidar(LidarModel model = LidarModel::kOuster);

// What a column says, by its beams.
struct LidarReturns {
  std::array<uint32_t, LidarBeams::kMost> ranges_mm = {};  // 0: nothing came back
  std::array<uint8_t, LidarBeams::kMost> reflectivities = {};
  std::array<bool, LidarBeams::kMost> is_faint = {};  // it came from a drop or from dust
};

}  // namespace hardpack::sim
