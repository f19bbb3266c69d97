// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/lidar.h"

#include "core/base/saturate.h"

namespace hardpack::ouster {

LidarLayout Lidar::LayoutOf(const Metadata& metadata) {
  const auto beams = static_cast<size_t>(ClampInt(metadata.beams, 0, kMaxBeams));
  const std::span<const float> altitude_deg(metadata.beam_altitude_deg);
  const std::span<const float> azimuth_deg(metadata.beam_azimuth_deg);
  return {.altitude_deg = altitude_deg.first(beams),
          .azimuth_deg = azimuth_deg.first(beams),
          .columns_per_revolution = metadata.columns_per_frame,
          .origin_to_beam_m = metadata.lidar_origin_to_beam_origin_m,
          .sensor_from_lidar = metadata.sensor_from_lidar,
          .window = {.columns_per_datagram = metadata.columns_per_packet,
                     .first = metadata.column_window_first,
                     .last = metadata.column_window_last}};
}

int32_t Lidar::MostColumnsPerSecond(const Metadata& metadata) {
  constexpr int32_t kFastest = 20;
  constexpr int32_t kMost = 2048 * 10;
  const int32_t columns_per_s = metadata.columns_per_frame * kFastest;
  return columns_per_s < kMost ? columns_per_s : kMost;
}

}  // namespace hardpack::ouster
