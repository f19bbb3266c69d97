// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/lidar_settings.h"

#include <iterator>

namespace hardpack::sim {
namespace {

constexpr uint64_t kFiring_ns = 2304;  // from one laser, or pair of lasers, to the next

// Of each laser of a VLP-16, in the order in which they fire: altitude, and how far above the
// origin its beam crosses the axis, as all of them meet in the lens (63-9243, table 9-1).
struct Vlp16Laser {
  double altitude_deg;
  double above_mm;
};
constexpr Vlp16Laser kVlp16[] = {
    {-15, 11.2}, {1, -0.7}, {-13, 9.7}, {3, -2.2},  {-11, 8.1}, {5, -3.7},  {-9, 6.6}, {7, -5.1},
    {-7, 5.1},   {9, -6.6}, {-5, 3.7},  {11, -8.1}, {-3, 2.2},  {13, -9.7}, {-1, 0.7}, {15, -11.2}};

// Of each laser of a VLP-32C: altitude, and azimuth from the middle, clockwise (63-9325, tables 9-2
// and 9-6).
struct Vlp32cLaser {
  double altitude_deg;
  double azimuth_deg;
};
constexpr Vlp32cLaser kVlp32c[] = {
    {-25.0, 1.4},  {-1.0, -4.2},   {-1.667, 1.4}, {-15.639, -1.4}, {-11.31, 1.4}, {0.0, -1.4},
    {-0.667, 4.2}, {-8.843, -1.4}, {-7.254, 1.4}, {0.333, -4.2},   {-0.333, 1.4}, {-6.148, -1.4},
    {-5.333, 4.2}, {1.333, -1.4},  {0.667, 4.2},  {-4.0, -1.4},    {-4.667, 1.4}, {1.667, -4.2},
    {1.0, 1.4},    {-3.667, -4.2}, {-3.333, 4.2}, {3.333, -1.4},   {2.333, 1.4},  {-2.667, -1.4},
    {-3.0, 1.4},   {7.0, -1.4},    {4.667, 1.4},  {-2.333, -4.2},  {-2.0, 4.2},   {15.0, -1.4},
    {10.333, 1.4}, {-1.333, -1.4}};

LidarBeams OfVelodyne(LidarModel model) {
  LidarBeams beams;
  beams.origin_to_beam_m = 0.0;
  beams.lidar_above_sensor_m = 0.0;
  if (model == LidarModel::kVlp16) {
    beams.count = static_cast<int>(std::size(kVlp16));
    for (size_t beam = 0; beam < std::size(kVlp16); ++beam) {
      beams.altitude_deg[beam] = kVlp16[beam].altitude_deg;
      beams.above_m[beam] = 0.001 * kVlp16[beam].above_mm;
      beams.fires_after_ns[beam] = kFiring_ns * beam;
    }
    return beams;
  }
  beams.count = static_cast<int>(std::size(kVlp32c));
  for (size_t beam = 0; beam < std::size(kVlp32c); ++beam) {
    beams.altitude_deg[beam] = kVlp32c[beam].altitude_deg;
    beams.azimuth_deg[beam] = kVlp32c[beam].azimuth_deg;
    beams.fires_after_ns[beam] = kFiring_ns * (beam / 2);  // in pairs
  }
  return beams;
}

}  // namespace

LidarBeams LidarBeams::Default() {
  constexpr double kAzimuth_deg[] = {3.1, 1.03, -1.03, -3.1};
  LidarBeams beams;
  for (size_t beam = 0; beam < kMost; ++beam) {
    beams.altitude_deg[beam] = 16.6 - 33.2 * static_cast<double>(beam) / (kMost - 1);
    beams.azimuth_deg[beam] = kAzimuth_deg[beam % std::size(kAzimuth_deg)];
  }
  return beams;
}

LidarBeams LidarBeams::Of(const ouster::Metadata& metadata) {
  LidarBeams beams;
  for (size_t beam = 0; beam < kMost; ++beam) {
    beams.altitude_deg[beam] = double{metadata.beam_altitude_deg[beam]};
    beams.azimuth_deg[beam] = double{metadata.beam_azimuth_deg[beam]};
  }
  beams.origin_to_beam_m = double{metadata.lidar_origin_to_beam_origin_m};
  beams.lidar_above_sensor_m = double{metadata.sensor_from_lidar.translation.z_m};
  return beams;
}

LidarBeams LidarBeams::Of(LidarModel model) {
  return IsVelodyne(model) ? OfVelodyne(model) : Default();
}

LidarSettings CleanLidar(LidarModel model) {
  LidarSettings settings;
  settings.model = model;
  settings.beams = LidarBeams::Of(model);
  if (model == LidarModel::kVlp16) settings.reach_m = 100.0;
  if (model == LidarModel::kVlp32c) settings.reach_m = 200.0;
  return settings;
}

LidarSettings NoisyLidar(LidarModel model) {
  LidarSettings settings = CleanLidar(model);
  settings.noise_m = IsVelodyne(model) ? 0.012 : 0.01;
  settings.noise_per_m = IsVelodyne(model) ? 0.0 : 0.0004;
  settings.drop_out_share = 0.01;
  return settings;
}

}  // namespace hardpack::sim
