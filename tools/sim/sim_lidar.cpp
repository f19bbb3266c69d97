// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sim_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "nlohmann/json.hpp"

namespace hardpack::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kOriginToBeam_m = 0.012163;  // first-generation OS1
constexpr double kLidarAboveSensor_m = 0.03618;
constexpr uint32_t kTicksPerRevolution = 90112;
constexpr uint64_t kSerialNumber = 992012345678;
constexpr int kBeamColumns = 4;  // of lasers, each with its azimuth

// Near the published angles of an OS1-64: 33.2 degrees in even steps, four columns of beams.
double AltitudeDeg(int beam) {
  return 16.6 - 33.2 * beam / (SimLidar::kBeams - 1);
}
constexpr std::array<double, kBeamColumns> kAzimuth_deg = {3.1, 1.03, -1.03, -3.1};

struct Beam {
  double slope;   // rise over level distance
  double secant;  // slant over level distance
};

const std::array<Beam, SimLidar::kBeams>& Beams() {
  static const auto beams = [] {
    std::array<Beam, SimLidar::kBeams> made = {};
    for (int beam = 0; beam < SimLidar::kBeams; ++beam) {
      const double altitude_rad = AltitudeDeg(beam) * kPi / 180.0;
      made[static_cast<size_t>(beam)] = {std::tan(altitude_rad), 1.0 / std::cos(altitude_rad)};
    }
    return made;
  }();
  return beams;
}

template <typename Unsigned>
void Append(std::vector<uint8_t>& bytes, Unsigned value, size_t size = sizeof(Unsigned)) {
  for (size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<uint8_t>(uint64_t{value} >> (8 * i)));
  }
}

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

uint16_t Signal(uint32_t range_mm) {
  return static_cast<uint16_t>(range_mm == 0 ? 0u : 60000u / (1u + range_mm / 100u));
}

}  // namespace

SimLidar::SimLidar(const LidarSettings& settings, uint64_t start_ns)
    : settings_(settings), random_(settings.seed), start_ns_(start_ns), ranges_mm_(kBeams, 0) {}

void SimLidar::Restart(uint64_t now_ns) {
  start_ns_ = now_ns;
  columns_sent_ = 0;
  frame_id_ = 0;
  settings_.clock_start_ns = 5'000'000'000;
  init_id_ += 0x101;
  packet_.clear();
}

// Of the beam's passing, since the start.
uint64_t SimLidar::ColumnTime_ns(uint64_t column) const {
  const auto per_s = static_cast<uint64_t>(settings_.columns * settings_.revolutions_per_s);
  return column / per_s * 1'000'000'000 + column % per_s * 1'000'000'000 / per_s;
}

void SimLidar::Advance(uint64_t now_ns, const Pose& pose, const FlatWorld& world,
                       std::vector<std::vector<uint8_t>>& packets) {
  while (start_ns_ + ColumnTime_ns(columns_sent_) <= now_ns) {
    const auto id = static_cast<uint16_t>(columns_sent_ % static_cast<uint64_t>(settings_.columns));
    const auto turn =
        static_cast<uint16_t>(columns_sent_ / static_cast<uint64_t>(settings_.columns));
    frame_id_ = turn;
    if (id % kColumnsPerPacket == 0) BeginPacket();
    const uint64_t since_ns = ColumnTime_ns(columns_sent_);
    const double drift_ns = settings_.clock_drift * static_cast<double>(since_ns);
    CastColumn(id, pose, world);
    AppendColumn(
        id, settings_.clock_start_ns + since_ns + static_cast<uint64_t>(std::llround(drift_ns)));
    ++columns_sent_;
    if (columns_sent_ % kColumnsPerPacket != 0) continue;
    EndPacket();
    packets.push_back(packet_);
  }
}

void SimLidar::CastColumn(uint32_t measurement_id, const Pose& pose, const FlatWorld& world) {
  // In the lidar frame the encoder turns clockwise; the sensor frame is half a turn from it.
  const double encoder_rad =
      2.0 * kPi * (1.0 - static_cast<double>(measurement_id) / settings_.columns);
  const double in_world_rad = pose.theta_rad + settings_.yaw_rad + kPi;
  const double c = std::cos(pose.theta_rad);
  const double s = std::sin(pose.theta_rad);
  const double beam_rad = in_world_rad + encoder_rad;
  const Point2 origin = {
      pose.x_m + c * settings_.x_m - s * settings_.y_m + kOriginToBeam_m * std::cos(beam_rad),
      pose.y_m + s * settings_.x_m + c * settings_.y_m + kOriginToBeam_m * std::sin(beam_rad)};
  const double z_m = settings_.z_m + kLidarAboveSensor_m;
  for (size_t column = 0; column < kBeamColumns; ++column) {
    const double heading_rad = beam_rad - kAzimuth_deg[column] * kPi / 180.0;
    FindCrossings(world, origin, {std::cos(heading_rad), std::sin(heading_rad)}, crossings_);
    for (size_t beam = column; beam < kBeams; beam += kBeamColumns) {
      const Beam& one = Beams()[beam];
      const double level_m =
          MeetLevel_m(crossings_, z_m, one.slope, settings_.reach_m / one.secant);
      ranges_mm_[beam] = level_m < 0.0 ? 0 : Noisy_mm(level_m * one.secant + kOriginToBeam_m);
    }
  }
}

uint32_t SimLidar::Noisy_mm(double range_m) {
  double noise_m = 0.0;
  if (settings_.noise_m > 0.0) {
    const auto bits = static_cast<uint32_t>(random_());
    const double sum = static_cast<double>(bits >> 16) + static_cast<double>(bits & 0xffffu);
    noise_m = settings_.noise_m * (sum / 65535.0 - 1.0);
  }
  return static_cast<uint32_t>(std::lround(1000.0 * std::max(range_m + noise_m, 0.1)));
}

void SimLidar::BeginPacket() {
  packet_.clear();
  if (settings_.profile == LidarProfile::kLegacy) return;
  Append(packet_, uint16_t{1});  // a lidar packet
  Append(packet_, frame_id_);
  Append(packet_, init_id_, 3);
  Append(packet_, kSerialNumber, 5);
  packet_.resize(32);
}

void SimLidar::AppendColumn(uint16_t measurement_id, uint64_t time_ns) {
  const bool legacy = settings_.profile == LidarProfile::kLegacy;
  Append(packet_, time_ns);
  Append(packet_, measurement_id);
  if (legacy) {
    Append(packet_, frame_id_);
    Append(packet_,
           kTicksPerRevolution / static_cast<uint32_t>(settings_.columns) * measurement_id);
  } else {
    Append(packet_, uint16_t{1});  // valid
  }
  for (const uint32_t range_mm : ranges_mm_) {
    Append(packet_, range_mm);
    Append(packet_, uint16_t{40});  // reflectivity
    Append(packet_, Signal(range_mm));
    Append(packet_, uint16_t{300});  // near infrared
    Append(packet_, uint16_t{0});
  }
  if (legacy) Append(packet_, uint32_t{0xffffffff});
}

void SimLidar::EndPacket() {
  if (settings_.profile == LidarProfile::kLegacy) return;
  packet_.resize(packet_.size() + 24);
  Append(packet_, Crc64(packet_));
}

std::string SimLidar::MetadataJson() const {
  const bool legacy = settings_.profile == LidarProfile::kLegacy;
  nlohmann::json altitudes = nlohmann::json::array();
  nlohmann::json azimuths = nlohmann::json::array();
  nlohmann::json shifts = nlohmann::json::array();
  for (int beam = 0; beam < kBeams; ++beam) {
    const double azimuth_deg = kAzimuth_deg[static_cast<size_t>(beam % kBeamColumns)];
    altitudes.push_back(AltitudeDeg(beam));
    azimuths.push_back(azimuth_deg);
    shifts.push_back(std::lround(azimuth_deg * settings_.columns / 360.0));
  }
  nlohmann::json metadata = {
      {"_note", "a simulated sensor"},
      {"prod_line", "OS-1-64"},
      {"prod_sn", std::to_string(kSerialNumber)},
      {"build_rev", legacy ? "v1.13.0" : "v3.2.0"},
      {"lidar_mode",
       std::to_string(settings_.columns) + "x" + std::to_string(settings_.revolutions_per_s)},
      {"beam_altitude_angles", altitudes},
      {"beam_azimuth_angles", azimuths},
      {"lidar_origin_to_beam_origin_mm", kOriginToBeam_m * 1000.0},
      {"lidar_to_sensor_transform",
       {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, kLidarAboveSensor_m * 1000.0, 0, 0, 0, 1}},
      {"data_format",
       {{"columns_per_frame", settings_.columns},
        {"columns_per_packet", kColumnsPerPacket},
        {"pixels_per_column", kBeams},
        {"pixel_shift_by_row", shifts}}}};
  if (!legacy) {
    metadata["initialization_id"] = init_id_;
    metadata["data_format"]["udp_profile_lidar"] = "RNG19_RFL8_SIG16_NIR16";
  }
  return metadata.dump(1) + "\n";
}

}  // namespace hardpack::sim
