// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_ins.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace hardpack::sim {
namespace {

using world::kPi;
using world::Turn;
using world::TurnOf;
using world::Vector;

constexpr double kSemiMajorAxis_m = 6'378'137.0;  // WGS 84 (REFERENCES.md)
constexpr double kEccentricitySquared = 6.69437999014e-3;
constexpr uint64_t kDrawsPerMessage = 16;
constexpr uint64_t kGpsStart_ns = 1'400'000'000'000'000'000;

void Append(std::vector<uint8_t>& bytes, uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}
void AppendFloat(std::vector<uint8_t>& bytes, double value) {
  Append(bytes, std::bit_cast<uint32_t>(static_cast<float>(value)), 4);
}
void AppendDouble(std::vector<uint8_t>& bytes, double value) {
  Append(bytes, std::bit_cast<uint64_t>(value), 8);
}

// CCITT, highest bit first, from zero.
uint16_t Crc16(const std::vector<uint8_t>& bytes, size_t from) {
  uint32_t crc = 0;
  for (size_t i = from; i < bytes.size(); ++i) {
    crc ^= uint32_t{bytes[i]} << 8;
    for (int bit = 0; bit < 8; ++bit) crc = crc << 1 ^ ((crc & 0x8000u) != 0 ? 0x11021u : 0u);
  }
  return static_cast<uint16_t>(crc);
}

// CRC-32 of ISO/IEC 8802-3, lowest bit first.
uint32_t Crc32(const std::vector<uint8_t>& bytes) {
  uint32_t crc = 0xffffffffu;
  for (const uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

void AppendVector(std::vector<uint8_t>& bytes, const Vector& vector) {
  AppendFloat(bytes, vector.x_m);
  AppendFloat(bytes, vector.y_m);
  AppendFloat(bytes, vector.z_m);
}

constexpr double kLeastUncertainty = 1.0e-3;  // of one that makes no errors

}  // namespace

InsErrors Vn300Errors() {
  constexpr double kRadPerDeg = kPi / 180.0;
  InsErrors errors;
  errors.gyro_bias_radps = {2.0e-5, -1.5e-5, 2.4e-5};
  errors.accel_bias_mps2 = {4.0e-4, -3.0e-4, 4.0e-4};
  errors.gyro_noise_radps = 0.0035 * kRadPerDeg * 10.0;
  errors.accel_noise_mps2 = 0.14e-3 * kGravity_mps2 * 10.0;
  errors.yaw_bias_rad = 0.2 * kRadPerDeg;
  errors.attitude_noise_rad = 0.03 * kRadPerDeg;
  errors.velocity_noise_mps = 0.05;
  errors.position_wander_m = 1.0;
  return errors;
}

BodyMotion MotionOf(const SimVehicle& vehicle, const world::World& world) {
  const Pose& at = vehicle.pose();
  return MotionAt(vehicle,
                  world::StandingPose(world, at.x_m, at.y_m, at.theta_rad, vehicle.footprint()));
}

BodyMotion MotionAt(const SimVehicle& vehicle, const world::BodyPose& pose) {
  BodyMotion motion;
  motion.pose = pose;
  const auto to_world =
      world::Rotation::FromAngles(motion.pose.roll_rad, motion.pose.pitch_rad, motion.pose.yaw_rad);
  const auto to_body = [&m = to_world.m](const Vector& v) {
    return Vector{m[0] * v.x_m + m[3] * v.y_m + m[6] * v.z_m,
                  m[1] * v.x_m + m[4] * v.y_m + m[7] * v.z_m,
                  m[2] * v.x_m + m[5] * v.y_m + m[8] * v.z_m};
  };
  const double speed_mps = vehicle.speed_mps();
  const double rate_radps = vehicle.yaw_rate_radps();
  const BodyOnGround* body = vehicle.body();
  const bool is_on_ground = body != nullptr && !body->ground().holds_everything();
  motion.velocity_mps =
      to_world.Apply({speed_mps, is_on_ground ? body->slip_left_mps() : 0.0, 0.0});
  motion.rate_radps = to_body({0.0, 0.0, rate_radps});
  motion.specific_force_mps2 = to_body({0.0, 0.0, kGravity_mps2});
  if (is_on_ground) {  // what its tyres push with is all that an accelerometer feels
    motion.specific_force_mps2.x_m = body->tyre_x_mps2();
    motion.specific_force_mps2.y_m = body->tyre_y_mps2();
    return motion;
  }
  motion.specific_force_mps2.y_m += speed_mps * rate_radps;  // towards the middle of the turn
  return motion;
}

SimIns::SimIns(const InsSettings& settings, uint64_t start_ns)
    : settings_(settings), start_ns_(start_ns) {}

void SimIns::Advance(uint64_t now_ns, const BodyMotion& motion,
                     std::vector<std::vector<uint8_t>>& datagrams) {
  const auto per_s = static_cast<uint64_t>(settings_.messages_per_s);
  while (start_ns_ + (sent_ + 1) * 1'000'000'000 / per_s <= now_ns) {
    ++sent_;
    drifted_north_m_ += settings_.errors.drift_north_mps / settings_.messages_per_s;
    drifted_east_m_ += settings_.errors.drift_east_mps / settings_.messages_per_s;
    const std::vector<uint8_t> message = Message(sent_ * 1'000'000'000 / per_s, motion, sent_);
    buffer_.insert(buffer_.end(), message.begin(), message.end());
  }
  if (settings_.cut_bytes == 0) {
    if (!buffer_.empty()) datagrams.push_back(buffer_);
    buffer_.clear();
    return;
  }
  const uint64_t key = ~world::KeyOf(settings_.seed, world::Stream::kIns);
  while (true) {
    if (next_cut_bytes_ == 0) {
      next_cut_bytes_ =
          1 + world::DrawBits(key, ++cuts_) % static_cast<uint64_t>(settings_.cut_bytes);
    }
    if (buffer_.size() < next_cut_bytes_) return;
    const auto end = buffer_.begin() + static_cast<ptrdiff_t>(next_cut_bytes_);
    datagrams.emplace_back(buffer_.begin(), end);
    buffer_.erase(buffer_.begin(), end);
    next_cut_bytes_ = 0;
  }
}

double SimIns::Noise(uint64_t index, uint64_t what) const {
  return world::DrawNormal(world::KeyOf(settings_.seed, world::Stream::kIns),
                           index * kDrawsPerMessage + what);
}

// From one number to the next in 20 s, smoothly.
double SimIns::Wander(uint64_t since_start_ns, uint64_t what) const {
  constexpr uint64_t kBetween_ns = 20'000'000'000;
  const uint64_t key = world::Mixed(world::KeyOf(settings_.seed, world::Stream::kIns) + 1);
  const uint64_t index = since_start_ns / kBetween_ns * kDrawsPerMessage + what;
  const double u =
      static_cast<double>(since_start_ns % kBetween_ns) / static_cast<double>(kBetween_ns);
  const double share = u * u * (3.0 - 2.0 * u);
  return (1.0 - share) * world::DrawNormal(key, index) +
         share * world::DrawNormal(key, index + kDrawsPerMessage);
}

std::vector<uint8_t> SimIns::Message(uint64_t since_start_ns, const BodyMotion& motion,
                                     uint64_t index) const {
  const Measured measured = Measure(since_start_ns, motion, index);
  return settings_.format == InsFormat::kPoseDatagram
             ? PoseDatagram(measured, static_cast<uint32_t>(index))
             : VectorNavMessage(measured);
}

SimIns::Measured SimIns::Measure(uint64_t since_start_ns, const BodyMotion& motion,
                                 uint64_t index) const {
  const InsErrors& errors = settings_.errors;
  // The world's x axis from north, clockwise; north, east and yaw are clockwise, the world is not.
  const Turn north = TurnOf(settings_.north_rad);
  const auto to_north = [&](const Vector& v) { return north.cos * v.x_m + north.sin * v.y_m; };
  const auto to_east = [&](const Vector& v) { return north.sin * v.x_m - north.cos * v.y_m; };
  Measured measured;
  measured.since_start_ns = since_start_ns;
  MeasureAttitude(motion, index, measured);
  const Vector& rate = motion.rate_radps;
  const Vector& gyro = errors.gyro_bias_radps;
  const double noise_radps = errors.gyro_noise_radps;
  measured.rate_radps = {rate.x_m + gyro.x_m + noise_radps * Noise(index, 3),
                         -rate.y_m + gyro.y_m + noise_radps * Noise(index, 4),
                         -rate.z_m + gyro.z_m + noise_radps * Noise(index, 5)};
  MeasurePosition(motion, since_start_ns, measured);
  const Vector& velocity = motion.velocity_mps;
  const double noise_mps = errors.velocity_noise_mps;
  measured.velocity_ned_mps = {
      to_north(velocity) + errors.drift_north_mps + noise_mps * Noise(index, 6),
      to_east(velocity) + errors.drift_east_mps + noise_mps * Noise(index, 7),
      -velocity.z_m + noise_mps * Noise(index, 8)};
  const Vector& force = motion.specific_force_mps2;
  const Vector& bias = errors.accel_bias_mps2;
  const double noise_mps2 = errors.accel_noise_mps2;
  measured.force_mps2 = {force.x_m + bias.x_m + noise_mps2 * Noise(index, 9),
                         -force.y_m + bias.y_m + noise_mps2 * Noise(index, 10),
                         -force.z_m + bias.z_m + noise_mps2 * Noise(index, 11)};
  return measured;
}

std::vector<uint8_t> SimIns::VectorNavMessage(const Measured& measured) const {
  std::vector<uint8_t> bytes = {0xfa, 0x01, 0xeb,
                                static_cast<uint8_t>(settings_.with_acceleration ? 0x11 : 0x10)};
  Append(bytes, measured.since_start_ns, 8);
  Append(bytes, kGpsStart_ns + measured.since_start_ns, 8);
  for (const double angle_rad : {measured.yaw_rad, measured.pitch_rad, measured.roll_rad}) {
    AppendFloat(bytes, angle_rad * 180.0 / kPi);
  }
  AppendVector(bytes, measured.rate_radps);
  AppendDouble(bytes, measured.latitude_deg);
  AppendDouble(bytes, measured.longitude_deg);
  AppendDouble(bytes, measured.altitude_m);
  AppendVector(bytes, measured.velocity_ned_mps);
  if (settings_.with_acceleration) AppendVector(bytes, measured.force_mps2);
  const uint32_t fix = settings_.mode == 2 ? 0x304u : 0u;  // satellites, and heading by them
  Append(bytes, fix | settings_.mode, 2);
  const uint16_t crc = Crc16(bytes, 1);
  bytes.push_back(static_cast<uint8_t>(crc >> 8));
  bytes.push_back(static_cast<uint8_t>(crc));
  return bytes;
}

// docs/pose_datagram.md.
std::vector<uint8_t> SimIns::PoseDatagram(const Measured& measured, uint32_t sequence) const {
  constexpr uint8_t kVersion = 1;
  constexpr uint8_t kAllGroups = 0xff;
  constexpr double kNanodegrees = 1.0e9;
  // A fix, and a heading by two antennas whose direction is known.
  const auto status = static_cast<uint8_t>(settings_.mode == 2 ? 0x61 : 0);
  std::vector<uint8_t> bytes = {'H', 'P', 'P', 'D', kVersion, kAllGroups, settings_.mode, status};
  Append(bytes, sequence, 4);
  Append(bytes, 0, 4);
  Append(bytes, measured.since_start_ns, 8);
  Append(bytes, kGpsStart_ns + measured.since_start_ns, 8);
  for (const double angle_deg : {measured.latitude_deg, measured.longitude_deg}) {
    Append(bytes, static_cast<uint64_t>(std::llround(angle_deg * kNanodegrees)), 8);
  }
  AppendFloat(bytes, measured.altitude_m);
  AppendVector(bytes, measured.velocity_ned_mps);
  for (const double angle_rad : {measured.roll_rad, measured.pitch_rad, measured.yaw_rad}) {
    AppendFloat(bytes, angle_rad);
  }
  AppendVector(bytes, measured.rate_radps);
  AppendVector(bytes, measured.force_mps2);
  AppendFloat(bytes, std::max(settings_.errors.attitude_noise_rad, kLeastUncertainty));
  AppendFloat(bytes, std::max(settings_.errors.position_wander_m, kLeastUncertainty));
  AppendFloat(bytes, std::max(settings_.errors.velocity_noise_mps, kLeastUncertainty));
  Append(bytes, Crc32(bytes), 4);
  return bytes;
}

// Pitch is nose up here and nose down in the body frame; roll is the same about either x axis.
void SimIns::MeasureAttitude(const BodyMotion& motion, uint64_t index, Measured& measured) const {
  const double noise_rad = settings_.errors.attitude_noise_rad;
  measured.yaw_rad = world::Wrapped(settings_.north_rad - motion.pose.yaw_rad +
                                    settings_.errors.yaw_bias_rad + noise_rad * Noise(index, 0));
  measured.pitch_rad = world::Wrapped(-motion.pose.pitch_rad + noise_rad * Noise(index, 1));
  measured.roll_rad = world::Wrapped(motion.pose.roll_rad + noise_rad * Noise(index, 2));
}

// On the ellipsoid: radii of curvature of the meridian and across it at the world's origin.
void SimIns::MeasurePosition(const BodyMotion& motion, uint64_t since_start_ns,
                             Measured& measured) const {
  const InsErrors& errors = settings_.errors;
  const Turn north = TurnOf(settings_.north_rad);
  const Vector& place = motion.pose.position;
  const double wander_m = errors.position_wander_m;
  const double north_m = north.cos * place.x_m + north.sin * place.y_m + errors.jump_north_m +
                         drifted_north_m_ + wander_m * Wander(since_start_ns, 0);
  const double east_m = north.sin * place.x_m - north.cos * place.y_m + errors.jump_east_m +
                        drifted_east_m_ + wander_m * Wander(since_start_ns, 1);
  const double sine = TurnOf(settings_.latitude_deg * kPi / 180.0).sin;
  const double square = 1.0 - kEccentricitySquared * sine * sine;
  const double across_m = kSemiMajorAxis_m / std::sqrt(square) + settings_.altitude_m;
  const double meridian_m =
      kSemiMajorAxis_m * (1.0 - kEccentricitySquared) / (square * std::sqrt(square)) +
      settings_.altitude_m;
  const double latitude_deg = settings_.latitude_deg + north_m / meridian_m * 180.0 / kPi;
  const double cosine = TurnOf(latitude_deg * kPi / 180.0).cos;
  measured.latitude_deg = latitude_deg;
  measured.longitude_deg = settings_.longitude_deg + east_m / (across_m * cosine) * 180.0 / kPi;
  measured.altitude_m = settings_.altitude_m + place.z_m + wander_m * Wander(since_start_ns, 2);
}

}  // namespace hardpack::sim
