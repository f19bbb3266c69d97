// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tools/sim/flat_world.h"
#include "tools/sim/sim_vehicle.h"

// An Ouster OS1-64 on the moving vehicle's roof, as its datagrams: each column is cast from the
// place where the vehicle is when the beam passes. Packet layouts and geometry are written anew
// from the maker's description (REFERENCES.md), so that they test the library's instead of
// repeating it.

namespace hardpack::sim {

enum class LidarProfile : uint8_t {
  kLegacy,  // first generation, no header; firmware 1.13
  kRng19,   // RNG19_RFL8_SIG16_NIR16 with header and CRC; firmware 3.2
};

struct LidarSettings {
  LidarProfile profile = LidarProfile::kLegacy;
  int columns = 1024;  // a revolution: 512, 1024 or 2048
  int revolutions_per_s = 10;
  double x_m = 0.0;  // of the sensor frame's origin in the body frame
  double y_m = 0.0;
  double z_m = 1.284;
  double yaw_rad = 0.0;  // pi: the sensor looks backward
  double reach_m = 110.0;
  double noise_m = 0.01;                     // of a range: triangular, up to this either way
  uint64_t clock_start_ns = 17'000'000'000;  // the sensor's clock when the simulation starts
  double clock_drift = 0.0;                  // of that clock, a second a second
  uint32_t seed = 1;
};

class SimLidar {
 public:
  static constexpr int kBeams = 64;
  static constexpr int kColumnsPerPacket = 16;

  SimLidar(const LidarSettings& settings, uint64_t start_ns);

  // Casts the columns that passed up to now_ns from `pose`, and appends the packets that became
  // whole. To be called every millisecond, or the pose is an old one's.
  void Advance(uint64_t now_ns, const Pose& pose, const FlatWorld& world,
               std::vector<std::vector<uint8_t>>& packets);

  // As after a loss of power: its clock and its frame count begin anew, with another init id.
  void Restart(uint64_t now_ns);

  std::string MetadataJson() const;
  const LidarSettings& settings() const { return settings_; }

 private:
  uint64_t ColumnTime_ns(uint64_t column) const;
  void CastColumn(uint32_t measurement_id, const Pose& pose, const FlatWorld& world);
  void AppendColumn(uint16_t measurement_id, uint64_t time_ns);
  void BeginPacket();
  void EndPacket();
  uint32_t Noisy_mm(double range_m);

  LidarSettings settings_;
  std::mt19937 random_;
  uint64_t start_ns_;
  uint32_t init_id_ = 0x00abcd;
  uint64_t columns_sent_ = 0;  // since start_ns_
  uint16_t frame_id_ = 0;
  std::vector<uint8_t> packet_;
  std::vector<uint32_t> ranges_mm_;  // [kBeams], of the column under way
  std::vector<Crossing> crossings_;
};

}  // namespace hardpack::sim
