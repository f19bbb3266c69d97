// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_lidar.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "nlohmann/json.hpp"

namespace hardpack::sim {
namespace {

using world::kPi;
using world::Turn;
using world::TurnOf;
using world::Vector;

constexpr uint32_t kTicksPerRevolution = 90112;
constexpr uint64_t kSerialNumber = 992012345678;

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

// Drops and dust send back a fiftieth of what a surface does.
uint16_t Signal(uint32_t range_mm, bool is_faint) {
  const uint32_t of_surface = range_mm == 0 ? 0u : 60000u / (1u + range_mm / 100u);
  return static_cast<uint16_t>(is_faint ? of_surface / 50u : of_surface);
}

}  // namespace

LidarBeams LidarBeams::Default() {
  constexpr double kAzimuth_deg[] = {3.1, 1.03, -1.03, -3.1};
  LidarBeams beams;
  for (size_t beam = 0; beam < kCount; ++beam) {
    beams.altitude_deg[beam] = 16.6 - 33.2 * static_cast<double>(beam) / (kCount - 1);
    beams.azimuth_deg[beam] = kAzimuth_deg[beam % std::size(kAzimuth_deg)];
  }
  return beams;
}

LidarBeams LidarBeams::Of(const ouster::Metadata& metadata) {
  LidarBeams beams;
  for (size_t beam = 0; beam < kCount; ++beam) {
    beams.altitude_deg[beam] = double{metadata.beam_altitude_deg[beam]};
    beams.azimuth_deg[beam] = double{metadata.beam_azimuth_deg[beam]};
  }
  beams.origin_to_beam_m = double{metadata.lidar_origin_to_beam_origin_m};
  beams.lidar_above_sensor_m = double{metadata.sensor_from_lidar.translation.z_m};
  return beams;
}

LidarSettings NoisyLidar() {
  LidarSettings settings;
  settings.noise_m = 0.01;
  settings.noise_per_m = 0.0004;
  settings.drop_out_share = 0.01;
  return settings;
}

SimLidar::SimLidar(const LidarSettings& settings, uint64_t start_ns)
    : settings_(settings),
      foliage_key_(world::KeyOf(settings.seed, world::Stream::kFoliage)),
      range_key_(world::KeyOf(settings.seed, world::Stream::kRange)),
      drop_out_key_(world::KeyOf(settings.seed, world::Stream::kDropOut)),
      rain_key_(world::KeyOf(settings.seed, world::Stream::kRain)),
      dust_key_(world::KeyOf(settings.seed, world::Stream::kDust)),
      first_start_ns_(start_ns),
      start_ns_(start_ns) {
  for (size_t beam = 0; beam < kBeams; ++beam) {
    const Turn altitude = TurnOf(settings_.beams.altitude_deg[beam] * kPi / 180.0);
    const Turn azimuth = TurnOf(-settings_.beams.azimuth_deg[beam] * kPi / 180.0);
    beams_[beam] = {altitude.cos * azimuth.cos, altitude.cos * azimuth.sin, altitude.sin};
  }
}

void SimLidar::Restart(uint64_t now_ns) {
  start_ns_ = now_ns;
  columns_sent_ = 0;
  frame_id_ = 0;
  settings_.clock_start_ns = 5'000'000'000;
  init_id_ += 0x101;
  packet_.clear();
}

void SimLidar::JumpClock(int64_t jump_ns) {
  // Unsigned, as the stamps are: a jump to before their zero wraps around as theirs would.
  settings_.clock_start_ns += static_cast<uint64_t>(jump_ns);
}

// Of the beam's passing, since the start.
uint64_t SimLidar::ColumnTime_ns(uint64_t column) const {
  const auto per_s = static_cast<uint64_t>(settings_.columns * settings_.revolutions_per_s);
  return column / per_s * 1'000'000'000 + column % per_s * 1'000'000'000 / per_s;
}

void SimLidar::Advance(uint64_t now_ns, const world::BodyPose& pose, const world::World& world,
                       std::vector<std::vector<uint8_t>>& packets, std::vector<CastColumn>* truth) {
  while (start_ns_ + ColumnTime_ns(columns_sent_) <= now_ns) {
    const auto id = static_cast<uint16_t>(columns_sent_ % static_cast<uint64_t>(settings_.columns));
    const auto turn =
        static_cast<uint16_t>(columns_sent_ / static_cast<uint64_t>(settings_.columns));
    frame_id_ = turn;
    if (id % kColumnsPerPacket == 0) BeginPacket();
    const uint64_t since_ns = ColumnTime_ns(columns_sent_);
    const uint64_t time_ns = start_ns_ + since_ns;
    const double drift_ns = settings_.clock_drift * static_cast<double>(since_ns);
    const uint64_t stamp_ns =
        settings_.clock_start_ns + since_ns + static_cast<uint64_t>(std::llround(drift_ns));
    CastOne(id, PoseAt(time_ns, now_ns, pose), world,
            static_cast<double>(time_ns - first_start_ns_) * 1.0e-9);
    if (weather_.dust_permille > 0) Dust(id);
    if (weather_.rain_permille > 0) Rain();
    Spoil(id);
    AppendColumn(id, stamp_ns);
    if (truth != nullptr) truth->push_back({time_ns, stamp_ns, frame_id_, id, labels_});
    ++columns_sent_;
    ++columns_cast_;
    if (columns_sent_ % kColumnsPerPacket != 0) continue;
    EndPacket();
    if (!loses_packet_) packets.push_back(packet_);
  }
  has_pose_ = true;
  pose_ns_ = now_ns;
  pose_ = pose;
}

world::BodyPose SimLidar::PoseAt(uint64_t time_ns, uint64_t now_ns,
                                 const world::BodyPose& pose) const {
  if (!has_pose_ || time_ns >= now_ns || time_ns < pose_ns_) return pose;
  const double left =
      static_cast<double>(now_ns - time_ns) / static_cast<double>(now_ns - pose_ns_);
  const auto between = [left](double from, double to) { return to - left * (to - from); };
  const auto turned = [left](double from, double to) {
    return to - left * world::Wrapped(to - from);
  };
  return {{between(pose_.position.x_m, pose.position.x_m),
           between(pose_.position.y_m, pose.position.y_m),
           between(pose_.position.z_m, pose.position.z_m)},
          turned(pose_.roll_rad, pose.roll_rad),
          turned(pose_.pitch_rad, pose.pitch_rad),
          turned(pose_.yaw_rad, pose.yaw_rad)};
}

void SimLidar::CastOne(uint32_t measurement_id, const world::BodyPose& pose,
                       const world::World& world, double time_s) {
  // In the lidar frame the encoder turns clockwise; the sensor frame is half a turn from it.
  const Turn encoder =
      TurnOf(2.0 * kPi * (1.0 - static_cast<double>(measurement_id) / settings_.columns) + kPi +
             settings_.yaw_rad + faults_.turned_yaw_rad);
  const world::Rotation to_world =
      world::Rotation::FromAngles(pose.roll_rad, pose.pitch_rad, pose.yaw_rad);
  const bool is_tilted = faults_.turned_pitch_rad != 0.0 || faults_.turned_roll_rad != 0.0;
  const world::Rotation tilt =
      world::Rotation::FromAngles(faults_.turned_roll_rad, faults_.turned_pitch_rad, 0.0);
  const double n_m = settings_.beams.origin_to_beam_m;
  const Vector offset =
      to_world.Apply({settings_.x_m + n_m * encoder.cos, settings_.y_m + n_m * encoder.sin,
                      settings_.z_m + settings_.beams.lidar_above_sensor_m});
  world::Ray ray;
  ray.origin = {pose.position.x_m + offset.x_m, pose.position.y_m + offset.y_m,
                pose.position.z_m + offset.z_m};
  ray.max_range_m = settings_.reach_m;
  // People of these worlds walk on through a vehicle that stands. Where nobody can be, over the
  // middle of the vehicle, nobody is seen.
  constexpr double kOverVehicle_m = 0.75;
  std::vector<world::Body> people = world.PeopleAt(time_s);
  std::erase_if(people, [&ray](const world::Body& body) {
    const double dx_m = body.x_m - ray.origin.x_m;
    const double dy_m = body.y_m - ray.origin.y_m;
    return dx_m * dx_m + dy_m * dy_m < kOverVehicle_m * kOverVehicle_m;
  });
  const world::Rotation off =
      world::Rotation::FromAngles(settings_.off_roll_rad, settings_.off_pitch_rad, 0.0);
  for (size_t beam = 0; beam < kBeams; ++beam) {
    const uint64_t index = columns_cast_ * kBeams + beam;
    const Vector& d = beams_[beam];
    Vector along = {encoder.cos * d.x_m - encoder.sin * d.y_m,
                    encoder.sin * d.x_m + encoder.cos * d.y_m, d.z_m};
    if (is_tilted) along = tilt.Apply(along);
    ray.direction = to_world.Apply(off.Apply(along));
    ray.key = world::DrawBits(foliage_key_, index);
    const world::Hit hit = world.Cast(ray, people);
    ranges_mm_[beam] = hit.any() ? Measured_mm(hit.range_m + n_m, index) : 0;
    const bool returned = ranges_mm_[beam] != 0;
    reflectivities_[beam] = returned ? hit.reflectivity : uint8_t{0};
    is_faint_[beam] = false;
    labels_[beam] = returned ? static_cast<uint8_t>(hit.label) : uint8_t{0};
  }
}

// 0: it did not come back.
uint32_t SimLidar::Measured_mm(double range_m, uint64_t index) const {
  if (settings_.drop_out_share > 0.0 &&
      world::DrawUniform(drop_out_key_, index) < settings_.drop_out_share) {
    return 0;
  }
  const double sigma_m = settings_.noise_m + settings_.noise_per_m * range_m;
  double measured_m = range_m;
  if (sigma_m > 0.0) measured_m += sigma_m * world::DrawNormal(range_key_, index);
  return static_cast<uint32_t>(std::lround(1000.0 * std::max(measured_m, 0.1)));
}

// The beam's ray meets a drop or a grain in front of what it would have met: at `share` of the way
// between the nearest and the farthest place that there is for it. What a segmentation computer
// says of it stays that of what is behind: its picture shows the world through rain and dust.
void SimLidar::SeeInAir(size_t beam, double nearest_m, double farthest_m, double share) {
  const double free_m = ranges_mm_[beam] == 0 ? farthest_m : 0.001 * ranges_mm_[beam];
  const double last_m = std::min(farthest_m, free_m);
  if (last_m <= nearest_m) return;
  const double range_m = nearest_m + share * (last_m - nearest_m);
  ranges_mm_[beam] = static_cast<uint32_t>(std::lround(1000.0 * range_m));
  reflectivities_[beam] = 1;
  is_faint_[beam] = true;
}

void SimLidar::Rain() {
  const double seen_share = 0.001 * weather_.rain_permille;
  for (size_t beam = 0; beam < kBeams; ++beam) {
    const uint64_t index = 2 * (columns_cast_ * kBeams + beam);
    const double drawn = world::DrawUniform(rain_key_, index);
    if (drawn < seen_share) {
      SeeInAir(beam, LidarWeather::kRainNearest_m, LidarWeather::kRainFarthest_m,
               world::DrawUniform(rain_key_, index + 1));
    } else if (drawn > 1.0 - LidarWeather::kRainLost) {
      ranges_mm_[beam] = 0;
      reflectivities_[beam] = 0;
      is_faint_[beam] = false;
      labels_[beam] = 0;
    }
  }
}

void SimLidar::Dust(uint32_t measurement_id) {
  if (!LooksBetween(measurement_id, weather_.dust_from_deg, weather_.dust_to_deg)) return;
  for (size_t beam = 0; beam < kBeams; ++beam) {
    const uint64_t index = 2 * (columns_cast_ * kBeams + beam);
    if (world::DrawUniform(dust_key_, index) >= 0.001 * weather_.dust_permille) continue;
    SeeInAir(beam, LidarWeather::kDustNearest_m, weather_.dust_range_m,
             world::DrawUniform(dust_key_, index + 1));
  }
}

bool SimLidar::IsInSector(uint32_t measurement_id) const {
  return faults_.sector != SectorFault::kNone &&
         LooksBetween(measurement_id, faults_.from_deg, faults_.to_deg);
}

// By where it looks at the level, the turn of its mount left out. A whole turn is everywhere.
bool SimLidar::LooksBetween(uint32_t measurement_id, double from_deg, double to_deg) const {
  if (to_deg - from_deg >= 360.0) return true;
  const double turns = 1.5 - static_cast<double>(measurement_id) / settings_.columns;
  const double angle_deg = 360.0 * turns + settings_.yaw_rad * 180.0 / kPi;
  const auto wrapped = [](double deg) { return deg - 360.0 * std::floor(deg / 360.0); };
  return wrapped(angle_deg - from_deg) <= wrapped(to_deg - from_deg);
}

// The column under way, as a sensor with these faults says it.
void SimLidar::Spoil(uint32_t measurement_id) {
  said_.resize(static_cast<size_t>(settings_.columns));
  Returns& said = said_[measurement_id];
  if (faults_.frozen) {
    ranges_mm_ = said.ranges_mm;
    reflectivities_ = said.reflectivities;
    is_faint_ = said.is_faint;
  } else {
    said = {ranges_mm_, reflectivities_, is_faint_};
  }
  if (!IsInSector(measurement_id)) return;
  if (faults_.sector == SectorFault::kLost) loses_packet_ = true;
  if (faults_.sector == SectorFault::kDark) {
    ranges_mm_.fill(0);
    reflectivities_.fill(0);
  }
  if (faults_.sector == SectorFault::kCovered) {
    constexpr uint32_t kWindow_mm = 60;
    for (size_t beam = 0; beam < kBeams; ++beam) {
      const uint64_t index = columns_cast_ * kBeams + beam;
      ranges_mm_[beam] = kWindow_mm + static_cast<uint32_t>(world::DrawBits(range_key_, index) % 9);
    }
  }
}

void SimLidar::BeginPacket() {
  packet_.clear();
  loses_packet_ = false;
  if (settings_.profile == LidarProfile::kLegacy) return;
  Append(packet_, uint16_t{1});  // a lidar packet
  Append(packet_, frame_id_);
  Append(packet_, init_id_, 3);
  Append(packet_, kSerialNumber, 5);
  packet_.resize(32);
}

void SimLidar::AppendColumn(uint16_t measurement_id, uint64_t time_ns) {
  const bool legacy = settings_.profile == LidarProfile::kLegacy;
  const bool is_valid = faults_.sector != SectorFault::kInvalid || !IsInSector(measurement_id);
  Append(packet_, time_ns);
  Append(packet_, measurement_id);
  if (legacy) {
    Append(packet_, frame_id_);
    Append(packet_,
           kTicksPerRevolution / static_cast<uint32_t>(settings_.columns) * measurement_id);
  } else {
    Append(packet_, uint16_t{is_valid ? uint16_t{1} : uint16_t{0}});
  }
  for (size_t beam = 0; beam < kBeams; ++beam) {
    Append(packet_, ranges_mm_[beam]);
    Append(packet_, uint16_t{reflectivities_[beam]});
    Append(packet_, Signal(ranges_mm_[beam], is_faint_[beam]));
    Append(packet_, uint16_t{300});  // near infrared
    Append(packet_, uint16_t{0});
  }
  if (legacy) Append(packet_, is_valid ? uint32_t{0xffffffff} : uint32_t{0});
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
  for (size_t beam = 0; beam < kBeams; ++beam) {
    const double azimuth_deg = settings_.beams.azimuth_deg[beam];
    altitudes.push_back(settings_.beams.altitude_deg[beam]);
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
      {"lidar_origin_to_beam_origin_mm", settings_.beams.origin_to_beam_m * 1000.0},
      {"lidar_to_sensor_transform",
       {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, settings_.beams.lidar_above_sensor_m * 1000.0, 0, 0, 0,
        1}},
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
