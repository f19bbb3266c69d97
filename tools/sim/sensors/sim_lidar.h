// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/ouster/ouster.h"
#include "tools/sim/world/contact.h"
#include "tools/sim/world/world.h"

// An Ouster OS1-64 on the moving vehicle's roof, as its datagrams: each column is cast from the
// place where the vehicle is when the beam passes. The same settings, poses and times give the same
// bytes on every machine (tools/sim/world/portable_math.h). Packet layouts and geometry are written
// anew from the maker's description (REFERENCES.md), so that they test the library's instead of
// repeating it.

namespace hardpack::sim {

enum class LidarProfile : uint8_t {
  kLegacy,  // first generation, no header; firmware 1.13
  kRng19,   // RNG19_RFL8_SIG16_NIR16 with header and CRC; firmware 3.2
};

// Where the beams of a sensor point, row 0 first as it sends them.
struct LidarBeams {
  static constexpr int kCount = 64;

  std::array<double, kCount> altitude_deg = {};
  std::array<double, kCount> azimuth_deg = {};
  double origin_to_beam_m = 0.012163;  // first-generation OS1
  double lidar_above_sensor_m = 0.03618;

  // Near the published angles of an OS1-64: 33.2 degrees in even steps, four columns of beams.
  static LidarBeams Default();
  // Those of a sensor that exists, of 64 beams.
  static LidarBeams Of(const ouster::Metadata& metadata);
};

struct LidarSettings {
  LidarProfile profile = LidarProfile::kLegacy;
  LidarBeams beams = LidarBeams::Default();
  int columns = 1024;  // a revolution: 512, 1024 or 2048
  int revolutions_per_s = 10;
  double x_m = 0.0;  // of the sensor frame's origin in the body frame
  double y_m = 0.0;
  double z_m = 1.284;
  double yaw_rad = 0.0;  // pi: the sensor looks backward
  // How it is turned besides, about the body's axes: what nobody has measured.
  double off_roll_rad = 0.0;
  double off_pitch_rad = 0.0;
  double reach_m = 110.0;
  double noise_m = 0.004;                    // standard deviation of a range,
  double noise_per_m = 0.0;                  // and this more for each metre of it
  double drop_out_share = 0.0;               // of the returns, at random
  uint64_t clock_start_ns = 17'000'000'000;  // the sensor's clock when the simulation starts
  double clock_drift = 0.0;                  // of that clock, a second a second
  uint32_t seed = 1;
};

// 1 cm near by and 3 cm at 50 m, a return in a hundred lost.
LidarSettings NoisyLidar();

// What is wrong with the sensor, from now on.
enum class SectorFault : uint8_t {
  kNone,
  kLost,     // packets with a column of the sector are not sent
  kInvalid,  // its columns are marked as such, by what they say of themselves
  kDark,     // nothing comes back: a cover that swallows the light
  kCovered,  // everything comes back from the window
};

struct LidarFaults {
  SectorFault sector = SectorFault::kNone;
  // From one direction of the body frame anticlockwise to the other, ahead is 0.
  double from_deg = 0.0;
  double to_deg = 0.0;
  bool frozen = false;  // each column says again what it said in the revolution before
  // Of its mount, besides what the settings say, about its own axes.
  double turned_yaw_rad = 0.0;
  double turned_pitch_rad = 0.0;
  double turned_roll_rad = 0.0;
};

// What hangs in the air, from now on. Each return of each revolution is drawn by itself: a drop or
// a grain of dust is where it was seen once and nowhere later. What is drawn has no part in the
// other random numbers, so that without weather the bytes are the same as if there were no such
// thing.
struct LidarWeather {
  // Of the rays, in all directions: so many see a drop instead of what is behind it, and while it
  // rains kRainLost of the returns besides do not come back.
  int rain_permille = 0;
  // A cloud that moves with the vehicle, from one direction of the body frame anticlockwise to the
  // other, at all heights, from kDustNearest_m to so far away: of its rays so many see dust.
  int dust_permille = 0;
  double dust_from_deg = 0.0;
  double dust_to_deg = 0.0;
  double dust_range_m = 0.0;

  static constexpr double kRainNearest_m = 1.0;
  static constexpr double kRainFarthest_m = 12.0;  // the light of drops beyond is too faint
  static constexpr double kRainLost = 0.03;
  static constexpr double kDustNearest_m = 1.5;
};

// What a column met in truth, for SimLabels.
struct CastColumn {
  uint64_t time_ns = 0;        // of ours
  uint64_t lidar_time_ns = 0;  // as the sensor stamped it
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  std::array<uint8_t, LidarBeams::kCount> labels = {};  // 0 where nothing came back
};

class SimLidar {
 public:
  static constexpr int kBeams = LidarBeams::kCount;
  static constexpr int kColumnsPerPacket = 16;

  SimLidar(const LidarSettings& settings, uint64_t start_ns);

  // Casts the columns that passed up to now_ns, and appends the packets that became whole. The
  // vehicle moves evenly from the pose of the call before to `pose`, where it is at now_ns. People
  // are where they are so many seconds after the start. truth: the columns that were cast are
  // appended to it.
  void Advance(uint64_t now_ns, const world::BodyPose& pose, const world::World& world,
               std::vector<std::vector<uint8_t>>& packets,
               std::vector<CastColumn>* truth = nullptr);

  // As after a loss of power: its clock and its frame count begin anew, with another init id.
  void Restart(uint64_t now_ns);
  // Its clock goes on from another time, and everything else as before.
  void JumpClock(int64_t jump_ns);

  LidarFaults& faults() { return faults_; }
  LidarWeather& weather() { return weather_; }

  std::string MetadataJson() const;
  const LidarSettings& settings() const { return settings_; }

 private:
  uint64_t ColumnTime_ns(uint64_t column) const;
  world::BodyPose PoseAt(uint64_t time_ns, uint64_t now_ns, const world::BodyPose& pose) const;
  void CastOne(uint32_t measurement_id, const world::BodyPose& pose, const world::World& world,
               double time_s);
  void AppendColumn(uint16_t measurement_id, uint64_t time_ns);
  bool IsInSector(uint32_t measurement_id) const;
  bool LooksBetween(uint32_t measurement_id, double from_deg, double to_deg) const;
  void Rain();
  void Dust(uint32_t measurement_id);
  void SeeInAir(size_t beam, double nearest_m, double farthest_m, double share);
  void Spoil(uint32_t measurement_id);
  void BeginPacket();
  void EndPacket();
  uint32_t Measured_mm(double range_m, uint64_t index) const;

  // What a column says.
  struct Returns {
    std::array<uint32_t, kBeams> ranges_mm = {};
    std::array<uint8_t, kBeams> reflectivities = {};
    std::array<bool, kBeams> is_faint = {};
  };

  LidarSettings settings_;
  LidarFaults faults_;
  LidarWeather weather_;
  std::vector<Returns> said_;  // by each column, the last time
  bool loses_packet_ = false;  // the one under way
  uint64_t foliage_key_;       // of the random numbers
  uint64_t range_key_;
  uint64_t drop_out_key_;
  uint64_t rain_key_;
  uint64_t dust_key_;
  std::array<world::Vector, kBeams> beams_;  // directions in the lidar frame, encoder at 0
  uint64_t first_start_ns_;
  uint64_t start_ns_;
  uint32_t init_id_ = 0x00abcd;
  uint64_t columns_sent_ = 0;  // since start_ns_
  uint64_t columns_cast_ = 0;  // ever: counts the random numbers
  uint16_t frame_id_ = 0;
  bool has_pose_ = false;
  uint64_t pose_ns_ = 0;
  world::BodyPose pose_;  // of the call before
  std::vector<uint8_t> packet_;
  // Of the column under way.
  std::array<uint32_t, kBeams> ranges_mm_ = {};
  std::array<uint8_t, kBeams> reflectivities_ = {};
  std::array<bool, kBeams> is_faint_ = {};  // it came from a drop or from dust
  std::array<uint8_t, kBeams> labels_ = {};
};

}  // namespace hardpack::sim
