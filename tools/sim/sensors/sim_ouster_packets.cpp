// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_ouster_packets.h"

#include <array>
#include <cmath>

#include "nlohmann/json.hpp"
#include "tools/sim/sensors/little_endian.h"

namespace hardpack::sim {
namespace {

constexpr size_t kBeams = LidarBeams::kMost;
constexpr uint32_t kTicksPerRevolution = 90112;
constexpr uint64_t kSerialNumber = 992012345678;

// CRC-64 as in the footer: reflected, started from and inverted with ones.
uint64_t Crc64(const std::vector<uint8_t>& bytes) {
  static const auto table = [] {
    std::array<uint64_t, 256> made = {};
    for (size_t byte = 0; byte < made.size(); ++byte) {
      uint64_t crc = byte;
      for (int bit = 0; bit < 8; ++bit) {
        crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xC96C5795D7870F42u : 0u);
      }
      made[byte] = crc;
    }
    return made;
  }();
  uint64_t crc = ~uint64_t{0};
  for (const uint8_t byte : bytes) crc = crc >> 8 ^ table[(crc ^ byte) & 0xffu];
  return ~crc;
}

// Drops and dust return a fiftieth of the light of a surface.
uint16_t Signal(uint32_t range_mm, bool is_faint) {
  const uint32_t of_surface = range_mm == 0 ? 0u : 60000u / (1u + range_mm / 100u);
  return static_cast<uint16_t>(is_faint ? of_surface / 50u : of_surface);
}

}  // namespace

OusterPackets::OusterPackets(const LidarSettings& settings)
    : legacy_(settings.profile == LidarProfile::kLegacy),
      columns_(static_cast<uint32_t>(settings.columns)) {}

void OusterPackets::Restart() {
  init_id_ += 0x101;
  bytes_.clear();
}

bool OusterPackets::Append(const Column& column, const LidarReturns& returns) {
  if (column.measurement_id % kColumns == 0) Begin(column.frame_id);
  AppendColumn(column, returns);
  if (column.measurement_id % kColumns != kColumns - 1) return false;
  if (legacy_) return true;
  bytes_.resize(bytes_.size() + 24);
  Put(bytes_, Crc64(bytes_));
  return true;
}

void OusterPackets::Begin(uint16_t frame_id) {
  bytes_.clear();
  if (legacy_) return;
  Put(bytes_, uint16_t{1});  // a lidar packet
  Put(bytes_, frame_id);
  Put(bytes_, init_id_, 3);
  Put(bytes_, kSerialNumber, 5);
  bytes_.resize(32);
}

void OusterPackets::AppendColumn(const Column& column, const LidarReturns& returns) {
  Put(bytes_, column.stamp_ns);
  Put(bytes_, column.measurement_id);
  if (legacy_) {
    Put(bytes_, column.frame_id);
    Put(bytes_, kTicksPerRevolution / columns_ * column.measurement_id);
  } else {
    Put(bytes_, uint16_t{column.is_valid ? uint16_t{1} : uint16_t{0}});
  }
  for (size_t beam = 0; beam < kBeams; ++beam) {
    Put(bytes_, returns.ranges_mm[beam]);
    Put(bytes_, uint16_t{returns.reflectivities[beam]});
    Put(bytes_, Signal(returns.ranges_mm[beam], returns.is_faint[beam]));
    Put(bytes_, uint16_t{300});  // near infrared
    Put(bytes_, uint16_t{0});
  }
  if (legacy_) Put(bytes_, column.is_valid ? uint32_t{0xffffffff} : uint32_t{0});
}

std::string OusterPackets::MetadataJson(const LidarSettings& settings) const {
  nlohmann::json altitudes = nlohmann::json::array();
  nlohmann::json azimuths = nlohmann::json::array();
  nlohmann::json shifts = nlohmann::json::array();
  for (size_t beam = 0; beam < kBeams; ++beam) {
    const double azimuth_deg = settings.beams.azimuth_deg[beam];
    altitudes.push_back(settings.beams.altitude_deg[beam]);
    azimuths.push_back(azimuth_deg);
    shifts.push_back(std::lround(azimuth_deg * settings.columns / 360.0));
  }
  nlohmann::json metadata = {
      {"_note", "a simulated sensor"},
      {"prod_line", "OS-1-64"},
      {"prod_sn", std::to_string(kSerialNumber)},
      {"build_rev", legacy_ ? "v1.13.0" : "v3.2.0"},
      {"lidar_mode",
       std::to_string(settings.columns) + "x" + std::to_string(settings.revolutions_per_s)},
      {"beam_altitude_angles", altitudes},
      {"beam_azimuth_angles", azimuths},
      {"lidar_origin_to_beam_origin_mm", settings.beams.origin_to_beam_m * 1000.0},
      {"lidar_to_sensor_transform",
       {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, settings.beams.lidar_above_sensor_m * 1000.0, 0, 0, 0,
        1}},
      {"data_format",
       {{"columns_per_frame", settings.columns},
        {"columns_per_packet", kColumns},
        {"pixels_per_column", kBeams},
        {"pixel_shift_by_row", shifts}}}};
  if (!legacy_) {
    metadata["initialization_id"] = init_id_;
    metadata["data_format"]["udp_profile_lidar"] = "RNG19_RFL8_SIG16_NIR16";
  }
  return metadata.dump(1) + "\n";
}

}  // namespace hardpack::sim
