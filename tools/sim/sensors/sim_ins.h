// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tools/sim/vehicle/sim_vehicle.h"
#include "tools/sim/world/contact.h"

// A VN-300 on the vehicle, x forward and z down: binary messages FA 01 EB 10 (TimeStartup, TimeGps,
// YawPitchRoll, AngularRate, PosLla, VelNed, InsStatus; 84 bytes), or FA 01 EB 11 with the
// acceleration too (96 bytes), through a bridge from its serial line to UDP that cuts the stream
// where its buffer is full. Or the same as pose datagrams, from a program that reads it. Bytes from
// the descriptions (REFERENCES.md, docs/pose_datagram.md), independent of hal. Positions on the WGS
// 84 ellipsoid. The same settings, motions and times give the same bytes on every machine
// (tools/sim/world/portable_math.h).

namespace hardpack::sim {

// Its errors; none by default. One standard deviation each, drawn anew for each message; the
// position error wanders over 20 s instead, as that of satellites does.
struct InsErrors {
  world::Vector gyro_bias_radps;  // in the sensor's axes: forward, right, down
  world::Vector accel_bias_mps2;
  double gyro_noise_radps = 0.0;
  double accel_noise_mps2 = 0.0;
  double yaw_bias_rad = 0.0;
  double attitude_noise_rad = 0.0;
  double velocity_noise_mps = 0.0;
  double position_wander_m = 0.0;
  // A position jump, and one that grows: may be changed at run time.
  double jump_north_m = 0.0;
  double jump_east_m = 0.0;
  double drift_north_mps = 0.0;
  double drift_east_mps = 0.0;
};

// Of the order stated for a VN-300 with two antennas and satellites in view; the numbers are ours:
// 0.03 deg of attitude, 0.2 deg of heading, 0.05 m/s, 1 m of position, biases of 5 deg/h for
// gyroscopes and 0.04 mg for accelerometers, with the noise of 0.0035 deg/s and 0.14 mg per root
// hertz at 100 Hz.
InsErrors Vn300Errors();

enum class InsFormat : uint8_t {
  kVectorNav,
  kPoseDatagram,  // docs/pose_datagram.md, one per message
};

struct InsSettings {
  InsFormat format = InsFormat::kVectorNav;
  int messages_per_s = 100;
  // Direction of the world's x axis, clockwise from north: so that no two frames coincide by
  // chance.
  double north_rad = 0.6;
  double latitude_deg = 46.78;  // of the world's origin
  double longitude_deg = -71.28;
  double altitude_m = 98.0;
  uint8_t mode = 2;  // InsStatus: 0 not tracking, 1 aligning, 2 tracking, 3 satellites lost
  // 0: one message per datagram. Otherwise the bridge's datagrams have 1 .. this many random bytes.
  int cut_bytes = 0;
  bool with_acceleration = false;
  InsErrors errors;
  uint32_t seed = 1;
};

// The true motion of the body. Body frame: x forward, y left, z up.
struct BodyMotion {
  world::BodyPose pose;                                     // in the world
  world::Vector velocity_mps;                               // in the world
  world::Vector rate_radps;                                 // about the body's axes
  world::Vector specific_force_mps2 = {0.0, 0.0, 9.80665};  // along them; +9.81 upward at rest
};

// The motion of a vehicle whose wheels stand on the world's ground.
BodyMotion MotionOf(const SimVehicle& vehicle, const world::World& world);
// Of one whose body has that pose.
BodyMotion MotionAt(const SimVehicle& vehicle, const world::BodyPose& pose);

class SimIns {
 public:
  SimIns(const InsSettings& settings, uint64_t start_ns);

  // Appends the datagrams sent up to now_ns.
  void Advance(uint64_t now_ns, const BodyMotion& motion,
               std::vector<std::vector<uint8_t>>& datagrams);

  InsSettings& settings() { return settings_; }
  // A message for `motion`, at a time since the sensor's start. index: of the message, for its
  // noise.
  std::vector<uint8_t> Message(uint64_t since_start_ns, const BodyMotion& motion,
                               uint64_t index = 0) const;

 private:
  // The contents of a message, in the sensor's axes: forward, right, down.
  struct Measured {
    uint64_t since_start_ns = 0;
    double yaw_rad = 0.0;
    double pitch_rad = 0.0;
    double roll_rad = 0.0;
    world::Vector rate_radps;
    world::Vector force_mps2;
    world::Vector velocity_ned_mps;
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double altitude_m = 0.0;
  };

  Measured Measure(uint64_t since_start_ns, const BodyMotion& motion, uint64_t index) const;
  std::vector<uint8_t> VectorNavMessage(const Measured& measured) const;
  std::vector<uint8_t> PoseDatagram(const Measured& measured, uint32_t sequence) const;
  double Noise(uint64_t index, uint64_t what) const;
  double Wander(uint64_t since_start_ns, uint64_t what) const;
  void MeasureAttitude(const BodyMotion& motion, uint64_t index, Measured& measured) const;
  void MeasurePosition(const BodyMotion& motion, uint64_t since_start_ns, Measured& measured) const;

  InsSettings settings_;
  uint64_t start_ns_;
  uint64_t sent_ = 0;            // messages
  std::vector<uint8_t> buffer_;  // of the bridge
  size_t next_cut_bytes_ = 0;
  uint64_t cuts_ = 0;
  double drifted_north_m_ = 0.0;
  double drifted_east_m_ = 0.0;
};

}  // namespace hardpack::sim
