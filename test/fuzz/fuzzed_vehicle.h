// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "hal/sevcon/process_data.h"
#include "hal/twist_drive/twist_frames.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/fuzz/mapper_script.h"
#include "tools/sim/script/scripted_vehicle.h"

// The vehicle whose tick is fuzzed, HP_FUZZED_VEHICLE, and what its devices say of themselves: by
// overload, so that a vehicle with another device does not compile before it has one here.

namespace hardpack {

using FuzzedVehicle = HP_FUZZED_VEHICLE;
using FuzzedLoop = BasicVehicleLoop<FuzzedVehicle>;
using FuzzedConfig = FuzzedLoop::Config;

// Beginnings of messages that were looked at, as far as that left a count.
inline uint64_t LooksOf(const vectornav::StreamParser& ins) {
  const auto& c = ins.counters();
  return c.binary_messages + c.ascii_messages + c.bad_checksum + c.unsupported;
}
inline uint64_t LooksOf(const pose_datagram::Receiver& ins) {
  const auto& c = ins.counters();
  return c.samples + c.refused + c.repeated + c.bad_crc;
}

// Datagrams that were judged.
inline uint64_t PacketsOf(const ouster::Lidar& lidar) {
  const ouster::PacketCounters& c = lidar.monitor().counters();
  return c.accepted + c.wrong_size + c.wrong_type + c.bad_crc + c.wrong_sensor + c.not_resumed +
         c.before_start + c.duplicates;
}
inline uint64_t PacketsOf(const velodyne::Lidar& lidar) {
  const velodyne::PacketCounters& c = lidar.counters();
  return c.accepted + c.wrong_size + c.wrong_type + c.wrong_sensor + c.wrong_mode + c.bad_azimuth +
         c.bad_time + c.wrong_rate + c.not_resumed + c.duplicates;
}

inline uint32_t FramesOf(const sevcon::DrivePair& drives) {
  const sevcon::PairCounters& c = drives.counters();
  return c.frames_taken + c.frames_ignored + c.frames_malformed + c.foreign_frames;
}
inline uint32_t FramesOf(const twist_drive::TwistDrive& drive) {
  const twist_drive::Counters& c = drive.counters();
  return c.frames_taken + c.frames_ignored + c.frames_malformed + c.frames_repeated +
         c.foreign_frames;
}

inline constexpr int kMostDriveFrames = std::is_same_v<FuzzedVehicle::Drives, sevcon::DrivePair>
                                            ? sevcon::DrivePair::kMaxFramesPerTick
                                            : 1;

inline bool IsToldZero(const sevcon::DrivePair& drives) {
  return drives.commanded().left_radps == 0.0f && drives.commanded().right_radps == 0.0f;
}
inline bool IsToldZero(const twist_drive::TwistDrive& drive) {
  return drive.commanded().speed == 0 && drive.commanded().turn == 0;
}

// The speeds that a frame commands, as its receiver reads it.
struct ToldSpeeds {
  int frames[2] = {0, 0};  // of the left and the right drive; of a motion controller in both
  bool is_zero = true;
};

// 60FFh, the motor's turns a minute, little-endian at 2 (hal/sevcon/process_data.h): within the
// wheels' limits, and what the gate has passed but for rounding.
inline void TakeTold(const CanFrame& frame, const PilotConfig& config, const WheelCommand& passed,
                     const sevcon::DrivePair& /*drives*/, ToldSpeeds& told) {
  const DriveParams& drive = config.onboard.drive;
  const bool is_left = frame.id == 0x200u + static_cast<uint32_t>(drive.left_node);
  const bool is_right = frame.id == 0x200u + static_cast<uint32_t>(drive.right_node);
  if (!is_left && !is_right) return;
  ++told.frames[is_left ? 0 : 1];
  Require(frame.size == 8 && !frame.remote);
  uint32_t bits = 0;
  for (int i = 0; i < 4; ++i) bits |= static_cast<uint32_t>(frame.data[2 + i]) << (8 * i);
  const auto rpm = static_cast<int32_t>(bits);
  if (rpm == 0) return;
  told.is_zero = false;
  const double radps_per_rpm =
      2.0 * 3.14159265358979 / 60.0 / static_cast<double>(drive.gear_ratio);
  const int32_t sign = is_left ? drive.left_sign : drive.right_sign;
  const double wheel_radps = rpm * static_cast<double>(sign) * radps_per_rpm;
  const double rounding = 0.502 * radps_per_rpm;
  const float most_radps = config.planner.vehicle.max_wheel_speed_radps;
  Require(std::abs(wheel_radps) <= static_cast<double>(most_radps) + rounding);
  const float passed_radps = is_left ? passed.left_radps : passed.right_radps;
  Require(std::abs(wheel_radps - static_cast<double>(passed_radps)) <= rounding);
}
// A speed and a yaw rate: the same of the body's motion.
inline void TakeTold(const CanFrame& frame, const PilotConfig& config, const WheelCommand& passed,
                     const twist_drive::TwistDrive& /*drive*/, ToldSpeeds& told) {
  Require(frame.id == static_cast<uint32_t>(config.onboard.twist_drive.command_id));
  twist_drive::Command command;
  Require(IsUsable(twist_drive::Decode(frame, command)));
  ++told.frames[0];
  ++told.frames[1];
  if (command.speed == 0 && command.turn == 0) return;
  told.is_zero = false;
  const VehicleParams& vehicle = config.planner.vehicle;
  const float radius_m = vehicle.wheel_radius_m;
  const float speed_mps = 0.5f * radius_m * (passed.left_radps + passed.right_radps);
  const float turn_radps =
      radius_m * (passed.right_radps - passed.left_radps) / vehicle.skid_baseline_m;
  Require(std::abs(static_cast<float>(command.speed) - 1000.0f * speed_mps) <= 0.51f);
  Require(std::abs(static_cast<float>(command.turn) - 1000.0f * turn_radps) <= 0.51f);
}

// Whether the wheels stand, by what the drives reported last.
inline bool Stand(const sevcon::DrivePair& drives, const PilotConfig& config, uint64_t now_ns) {
  const WheelFeedback wheels = drives.feedback(now_ns);
  const DriveParams& drive = config.onboard.drive;
  const uint64_t most_ns = static_cast<uint64_t>(drive.feedback_timeout_ms) * 1'000'000u + 1000u;
  const bool is_new = wheels.time_ns != 0 && now_ns - std::min(wheels.time_ns, now_ns) <= most_ns;
  return is_new && std::abs(wheels.left_radps) <= drive.standstill_radps &&
         std::abs(wheels.right_radps) <= drive.standstill_radps;
}
inline bool Stand(const twist_drive::TwistDrive& drive, const PilotConfig& /*config*/,
                  uint64_t now_ns) {
  return drive.State(now_ns).standstill;
}

// The simulated vehicle that goes with it.
inline void DescribeFuzzed(sim::ScriptedVehicleSettings& settings) {
  if constexpr (std::is_same_v<FuzzedVehicle::Drives, twist_drive::TwistDrive>) {
    settings.vehicle.controller.emplace();
  } else {
    settings.vehicle.right.sign = -1;  // the motors face each other
  }
  if constexpr (std::is_same_v<FuzzedVehicle::Ins, pose_datagram::Receiver>) {
    settings.ins.format = sim::InsFormat::kPoseDatagram;
  }
  if constexpr (std::is_same_v<FuzzedVehicle::Lidar, velodyne::Lidar>) {
    settings.lidar = sim::CleanLidar(sim::LidarModel::kVlp16);
  } else {
    settings.lidar.columns = 512;
  }
}
inline void DescribeLidar(const sim::SimLidar& lidar, ouster::Metadata& config) {
  Require(ouster::ParseMetadata(lidar.MetadataJson(), "fuzz", config).ok());
}
inline void DescribeLidar(const sim::SimLidar& /*lidar*/, velodyne::Config& config) {
  config = {};
}

}  // namespace hardpack
