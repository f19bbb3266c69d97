// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/sim/sensors/lidar_head.h"
#include "tools/sim/sensors/lidar_settings.h"
#include "tools/sim/sensors/sim_ouster_packets.h"
#include "tools/sim/sensors/sim_velodyne_packets.h"
#include "tools/sim/world/contact.h"
#include "tools/sim/world/world.h"

// A lidar on the moving vehicle's roof, as its datagrams: an Ouster OS1-64, or a Velodyne VLP-16 or
// VLP-32C. Each beam is cast from the place where the vehicle is when it fires: all beams of an
// Ouster's column at once, those of a Velodyne's sequence one after another while the head turns
// on. The same settings, poses and times give the same bytes on every machine
// (tools/sim/world/portable_math.h). The geometry is written anew from the makers' descriptions
// (REFERENCES.md), so that it tests the library's instead of repeating it. A column here is what an
// Ouster calls so, and a Velodyne's firing sequence.

namespace hardpack::sim {

// What is wrong with the sensor, from now on.
enum class SectorFault : uint8_t {
  kNone,
  kLost,     // packets with a column of the sector are not sent
  kInvalid,  // its columns are marked as such, by what they say of themselves; a Velodyne's say
             // nothing of themselves: kDark
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

// What a column of an Ouster met in truth, for SimLabels.
struct CastColumn {
  uint64_t time_ns = 0;        // of ours
  uint64_t lidar_time_ns = 0;  // as the sensor stamped it
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  std::array<uint8_t, LidarBeams::kMost> labels = {};  // 0 where nothing came back
};

class SimLidar {
 public:
  static constexpr int kBeams = LidarBeams::kMost;  // of an Ouster
  static constexpr int kColumnsPerPacket = OusterPackets::kColumns;

  SimLidar(const LidarSettings& settings, uint64_t start_ns);

  // Casts the columns whose last beam fired up to now_ns, and appends the packets that became
  // whole. The vehicle moves evenly from the pose of the call before to `pose`, where it is at
  // now_ns. People are where they are so many seconds after the start. truth: the columns of an
  // Ouster that were cast are appended to it; a Velodyne's are not, as no labels go with them.
  void Advance(uint64_t now_ns, const world::BodyPose& pose, const world::World& world,
               std::vector<std::vector<uint8_t>>& packets,
               std::vector<CastColumn>* truth = nullptr);

  // As after a loss of power: its clock and its count of frames begin anew; an Ouster has another
  // init id, and a Velodyne's clock knows no hour and begins at 0.
  void Restart(uint64_t now_ns);
  // Its clock goes on from another time, and everything else as before.
  void JumpClock(int64_t jump_ns);

  LidarFaults& faults() { return faults_; }
  LidarWeather& weather() { return weather_; }

  // What describes the sensor to the onboard program: an Ouster's metadata. Empty for a Velodyne,
  // whose packets name its model.
  std::string MetadataJson() const;
  const LidarSettings& settings() const { return settings_; }

 private:
  // Where the head is when a beam fires, and how it stands.
  struct Stand {
    world::Turn encoder;
    world::Rotation to_world;
    world::Vector origin;
  };

  size_t Beams() const { return static_cast<size_t>(settings_.beams.count); }
  uint64_t StampOf_ns(uint64_t since_ns) const;
  world::BodyPose PoseAt(uint64_t time_ns, uint64_t now_ns, const world::BodyPose& pose) const;
  Stand StandOf(size_t beam, uint64_t now_ns, const world::BodyPose& pose) const;
  void CastColumnUnderWay(uint64_t now_ns, const world::BodyPose& pose, const world::World& world);
  bool SendColumnUnderWay(uint64_t stamp_ns);
  OusterPackets::Column NameOfColumn(uint64_t stamp_ns) const;
  bool IsInSector() const;
  bool LooksBetween(double from_deg, double to_deg) const;
  void Rain();
  void Dust();
  void SeeInAir(size_t beam, double nearest_m, double farthest_m, double share);
  void Freeze();
  void Spoil();
  uint32_t Measured_mm(double range_m, uint64_t index) const;

  LidarSettings settings_;
  LidarFaults faults_;
  LidarWeather weather_;
  LidarHead head_;
  OusterPackets ouster_;
  VelodynePackets velodyne_;
  std::vector<LidarReturns> said_;  // by each place of the head, the last time
  bool loses_packet_ = false;       // the one under way
  uint64_t foliage_key_;            // of the random numbers
  uint64_t range_key_;
  uint64_t drop_out_key_;
  uint64_t rain_key_;
  uint64_t dust_key_;
  std::array<world::Vector, kBeams> beams_;  // directions where the head looks along x
  uint64_t first_start_ns_;
  uint64_t start_ns_;
  uint64_t columns_sent_ = 0;  // since start_ns_
  uint64_t columns_cast_ = 0;  // ever: counts the random numbers
  bool has_pose_ = false;
  uint64_t pose_ns_ = 0;
  world::BodyPose pose_;  // of the call before
  // Of the column under way, which is the one after those that were sent.
  LidarReturns returns_;
  std::array<uint8_t, kBeams> labels_ = {};
};

}  // namespace hardpack::sim
