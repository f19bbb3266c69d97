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

// The datagrams of a lidar on the moving vehicle's roof: an Ouster OS1-64, or a Velodyne VLP-16 or
// VLP-32C. Each beam is cast from the vehicle's pose at the time it fires: all beams of an Ouster's
// column at once, those of a Velodyne's sequence one after another while the head turns. The same
// settings, poses and times give the same bytes on every machine (tools/sim/world/portable_math.h).
// The geometry is written independently from the manufacturers' descriptions (REFERENCES.md), so
// that it tests the library's code instead of repeating it. A column here is an Ouster's column or
// a Velodyne's firing sequence.

namespace hardpack::sim {

// Faults of the sensor, from now on.
enum class SectorFault : uint8_t {
  kNone,
  kLost,     // packets with a column of the sector are not sent
  kInvalid,  // its columns are marked as invalid; a Velodyne's columns cannot be marked: as kDark
  kDark,     // nothing comes back: a cover that absorbs the light
  kCovered,  // everything comes back from the window
};

struct LidarFaults {
  SectorFault sector = SectorFault::kNone;
  // From one direction of the body frame anticlockwise to another; ahead is 0.
  double from_deg = 0.0;
  double to_deg = 0.0;
  bool frozen = false;  // each column repeats its data from the previous revolution
  // Rotation of its mount about its own axes, in addition to the settings.
  double turned_yaw_rad = 0.0;
  double turned_pitch_rad = 0.0;
  double turned_roll_rad = 0.0;
};

// Rain and dust, from now on. Each return of each revolution is drawn independently: a drop or a
// grain of dust is seen once and not again at the same place. These draws are independent of the
// other random numbers, so that without weather the bytes do not change.
struct LidarWeather {
  // Share of the rays, in all directions, that hit a drop instead of what is behind it; while it
  // rains, kRainLost of the other returns are lost.
  int rain_permille = 0;
  // A cloud that moves with the vehicle, from one direction of the body frame anticlockwise to
  // another, at all heights, from kDustNearest_m to a given range: share of its rays that hit dust.
  int dust_permille = 0;
  double dust_from_deg = 0.0;
  double dust_to_deg = 0.0;
  double dust_range_m = 0.0;

  static constexpr double kRainNearest_m = 1.0;
  static constexpr double kRainFarthest_m = 12.0;  // the light of drops beyond is too faint
  static constexpr double kRainLost = 0.03;
  static constexpr double kDustNearest_m = 1.5;
};

// What a column of an Ouster truly hit, for SimLabels.
struct CastColumn {
  uint64_t time_ns = 0;        // our clock
  uint64_t lidar_time_ns = 0;  // as the sensor stamped it
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  std::array<uint8_t, LidarBeams::kMost> labels = {};  // 0 if nothing came back
};

class SimLidar {
 public:
  static constexpr int kBeams = LidarBeams::kMost;  // of an Ouster
  static constexpr int kColumnsPerPacket = OusterPackets::kColumns;

  SimLidar(const LidarSettings& settings, uint64_t start_ns);

  // Casts the columns whose last beam fired up to now_ns, and appends the packets completed. The
  // vehicle moves uniformly from the pose of the previous call to `pose`, which holds at now_ns.
  // People are placed by the time in seconds since the start. truth: the cast columns of an Ouster
  // are appended to it; a Velodyne's are not, because it has no labels.
  void Advance(uint64_t now_ns, const world::BodyPose& pose, const world::World& world,
               std::vector<std::vector<uint8_t>>& packets,
               std::vector<CastColumn>* truth = nullptr);

  // As after a loss of power: its clock and its frame count restart; an Ouster gets another init
  // id, and a Velodyne's clock does not know the hour and starts at 0.
  void Restart(uint64_t now_ns);
  // Its clock continues from another time; everything else is unchanged.
  void JumpClock(int64_t jump_ns);

  LidarFaults& faults() { return faults_; }
  LidarWeather& weather() { return weather_; }

  // The sensor's description for the onboard program: an Ouster's metadata. Empty for a Velodyne,
  // whose packets contain its model.
  std::string MetadataJson() const;
  const LidarSettings& settings() const { return settings_; }

 private:
  // Position and orientation of the head when a beam fires.
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
  std::vector<LidarReturns> said_;  // for each place of the head, the last data
  bool loses_packet_ = false;       // the current one
  uint64_t foliage_key_;            // for the random numbers
  uint64_t range_key_;
  uint64_t drop_out_key_;
  uint64_t rain_key_;
  uint64_t dust_key_;
  std::array<world::Vector, kBeams> beams_;  // directions when the head looks along x
  uint64_t first_start_ns_;
  uint64_t start_ns_;
  uint64_t columns_sent_ = 0;  // since start_ns_
  uint64_t columns_cast_ = 0;  // ever: counts the random numbers
  bool has_pose_ = false;
  uint64_t pose_ns_ = 0;
  world::BodyPose pose_;  // of the previous call
  // Of the current column, the one after those that were sent.
  LidarReturns returns_;
  std::array<uint8_t, kBeams> labels_ = {};
};

}  // namespace hardpack::sim
