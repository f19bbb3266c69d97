// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/scene/recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "nlohmann/json.hpp"

namespace hardpack::scene {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kOriginToBeam_m = 0.012163;  // first-generation OS1
constexpr double kLidarAboveSensor_m = 0.03618;
constexpr double kSensorHeight_m = 1.284;
constexpr double kReach_m = 110.0;
constexpr double kRangeNoise_m = 0.015;
constexpr double kLostShare = 0.005;
constexpr uint32_t kTicksPerRevolution = 90112;
constexpr uint64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr uint64_t kRevolution_ns = 100'000'000;
constexpr uint16_t kFrame = 42;
constexpr int kPackets = kColumns / kColumnsPerPacket;
constexpr int kPacketsAround = 6;  // of the revolutions before and after
constexpr uint16_t kLidarPort = 7502;
constexpr uint16_t kImuPort = 7503;

// Near the published angles of an OS1-64: 33.2 degrees in even steps, four columns of beams.
double AltitudeDeg(int beam) {
  return 16.6 - 33.2 * beam / (kBeams - 1);
}
double AzimuthDeg(int beam) {
  static constexpr std::array<double, 4> kOffsets = {3.1, 1.03, -1.03, -3.1};
  return kOffsets[static_cast<size_t>(beam % 4)];
}

// Random numbers that are the same everywhere: only the engine of the standard is.
class Chance {
 public:
  explicit Chance(uint32_t seed) : engine_(seed) {}
  double Uniform() { return (static_cast<double>(engine_()) + 0.5) / 4294967296.0; }
  double Normal() {  // Box and Muller
    const double radius = std::sqrt(-2.0 * std::log(Uniform()));
    return radius * std::cos(2.0 * kPi * Uniform());
  }

 private:
  std::mt19937 engine_;
};

struct Return {
  uint32_t range_mm = 0;  // 0: none
  Label label = kVoid;
  Vector point_sensor = {};  // of the range as sent
};

using Revolution = std::vector<Return>;  // [kColumns x kBeams]

size_t At(int column, int beam) {
  return static_cast<size_t>(column * kBeams + beam);
}

// Beam origin and direction in the lidar frame: the maker's range-to-XYZ, taken apart.
struct Ray {
  Vector origin;
  Vector direction;
};

Ray RayInLidar(int column, int beam) {
  const double encoder_rad = 2.0 * kPi * (1.0 - static_cast<double>(column) / kColumns);
  const double angle_rad = encoder_rad - AzimuthDeg(beam) * kPi / 180.0;
  const double altitude_rad = AltitudeDeg(beam) * kPi / 180.0;
  return {{kOriginToBeam_m * std::cos(encoder_rad), kOriginToBeam_m * std::sin(encoder_rad), 0.0},
          {std::cos(angle_rad) * std::cos(altitude_rad),
           std::sin(angle_rad) * std::cos(altitude_rad), std::sin(altitude_rad)}};
}

// The sensor frame looks ahead; the lidar frame is turned against it by half a turn.
Vector SensorFromLidar(const Vector& lidar) {
  return {-lidar[0], -lidar[1], lidar[2]};
}

Return CastReturn(const World& world, int column, int beam, Chance& chance) {
  const Ray ray = RayInLidar(column, beam);
  Vector origin = SensorFromLidar(ray.origin);
  origin[2] += kLidarAboveSensor_m + kSensorHeight_m;
  const Vector direction = SensorFromLidar(ray.direction);
  const double luck = chance.Uniform();
  const double noise_m = kRangeNoise_m * chance.Normal();
  const bool lost = chance.Uniform() < kLostShare;
  const auto hit = world.Cast(origin, direction, kReach_m, luck);
  if (!hit || lost) return {};
  const double range_m = std::max(hit->distance_m + noise_m + kOriginToBeam_m, 0.1);
  Return result;
  result.range_mm = static_cast<uint32_t>(std::lround(range_m * 1000.0));
  result.label = hit->label;
  const double along_m = result.range_mm / 1000.0 - kOriginToBeam_m;
  for (size_t axis = 0; axis < 3; ++axis) {
    result.point_sensor[axis] = origin[axis] + along_m * direction[axis];
  }
  result.point_sensor[2] -= kSensorHeight_m;
  return result;
}

template <typename Unsigned>
void Append(std::vector<uint8_t>& bytes, Unsigned value) {
  for (size_t i = 0; i < sizeof(value); ++i) {
    bytes.push_back(static_cast<uint8_t>(uint64_t{value} >> (8 * i)));
  }
}

// LEGACY: 16 columns of timestamp, measurement id, frame id, encoder, 64 pixels of 12 B, status.
std::vector<uint8_t> LidarPacket(const Revolution& revolution, int packet, uint16_t frame,
                                 uint64_t revolution_start_ns) {
  std::vector<uint8_t> bytes;
  for (int i = 0; i < kColumnsPerPacket; ++i) {
    const int column = packet * kColumnsPerPacket + i;
    const auto id = static_cast<uint16_t>(column);
    Append(bytes, revolution_start_ns + kRevolution_ns * id / kColumns);
    Append(bytes, id);
    Append(bytes, frame);
    Append(bytes, kTicksPerRevolution / kColumns * id);
    for (int beam = 0; beam < kBeams; ++beam) {
      const Return& one = revolution[At(column, beam)];
      Append(bytes, one.range_mm);
      Append(bytes, uint16_t{40});  // reflectivity
      Append(bytes,
             static_cast<uint16_t>(one.range_mm == 0 ? 0u : 60000u / (1u + one.range_mm / 100u)));
      Append(bytes, uint16_t{300});  // near infrared
      Append(bytes, uint16_t{0});
    }
    Append(bytes, uint32_t{0xffffffff});
  }
  return bytes;
}

// Three stamps, then acceleration [g] and angular rate [deg/s]: at rest.
std::vector<uint8_t> ImuPacket(uint64_t time_ns) {
  std::vector<uint8_t> bytes;
  for (int i = 0; i < 3; ++i) Append(bytes, time_ns);
  for (const uint32_t float_bits : {0u, 0u, 0x3f800000u, 0u, 0u, 0u}) Append(bytes, float_bits);
  return bytes;
}

std::vector<Datagram> Datagrams(const Revolution& revolution) {
  std::vector<Datagram> datagrams;
  for (int i = -kPacketsAround; i < kPackets + kPacketsAround; ++i) {
    const int turns = i < 0 ? -1 : i / kPackets;
    const int packet = i - turns * kPackets;
    const uint64_t start_ns = kStart_ns + kRevolution_ns * static_cast<uint64_t>(turns + 1);
    const uint64_t time_ns =
        start_ns + kRevolution_ns * static_cast<uint64_t>(packet + 1) / kPackets;
    const auto frame = static_cast<uint16_t>(kFrame + turns);
    datagrams.push_back({time_ns, kLidarPort, LidarPacket(revolution, packet, frame, start_ns)});
    constexpr int kPacketsPerImu = 6;
    if (packet % kPacketsPerImu == 0) {
      datagrams.push_back({time_ns + 20'000, kImuPort, ImuPacket(time_ns)});
    }
  }
  return datagrams;
}

std::string MetadataJson() {
  nlohmann::json altitudes = nlohmann::json::array();
  nlohmann::json azimuths = nlohmann::json::array();
  nlohmann::json shifts = nlohmann::json::array();
  for (int beam = 0; beam < kBeams; ++beam) {
    altitudes.push_back(std::round(AltitudeDeg(beam) * 1.0e6) / 1.0e6);
    azimuths.push_back(AzimuthDeg(beam));
    shifts.push_back(std::lround(AzimuthDeg(beam) * kColumns / 360.0));
  }
  const nlohmann::json metadata = {
      {"_note", "a made-up sensor in a made-up world (hardpack scene)"},
      {"prod_line", "OS-1-64"},
      {"prod_sn", "000000000000"},
      {"build_rev", "v1.13.0"},
      {"lidar_mode", "1024x10"},
      {"beam_altitude_angles", altitudes},
      {"beam_azimuth_angles", azimuths},
      {"lidar_origin_to_beam_origin_mm", kOriginToBeam_m * 1000.0},
      {"lidar_to_sensor_transform",
       {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, kLidarAboveSensor_m * 1000.0, 0, 0, 0, 1}},
      {"data_format",
       {{"columns_per_frame", kColumns},
        {"columns_per_packet", kColumnsPerPacket},
        {"pixels_per_column", kBeams},
        {"pixel_shift_by_row", shifts}}}};
  return metadata.dump(1) + "\n";
}

std::string LabelsCsv(const Revolution& revolution) {
  std::string csv =
      "x_fwd_m,y_left_m,z_up_m(os1_sensor frame),ring,meas_id,range_mm,reflectivity,signal,"
      "near_ir,label\n";
  for (int column = 0; column < kColumns; ++column) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const Return& one = revolution[At(column, beam)];
      if (one.range_mm == 0) continue;
      std::array<char, 128> line = {};
      std::snprintf(line.data(), line.size(), "%.3f,%.3f,%.3f,%d,%d,%u,40,0,300,%d\n",
                    one.point_sensor[0], one.point_sensor[1], one.point_sensor[2], beam, column,
                    one.range_mm, static_cast<int>(one.label));
      csv += line.data();
    }
  }
  return csv;
}

}  // namespace

Recording Record(const World& world, uint32_t seed) {
  Chance chance(seed);
  Revolution revolution(static_cast<size_t>(kColumns * kBeams));
  for (int column = 0; column < kColumns; ++column) {
    for (int beam = 0; beam < kBeams; ++beam) {
      revolution[At(column, beam)] = CastReturn(world, column, beam, chance);
    }
  }
  return {Datagrams(revolution), MetadataJson(), LabelsCsv(revolution)};
}

}  // namespace hardpack::scene
