// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "tools/sim/sim_vehicle.h"

// A VN-300 on the vehicle, x forward and z down: binary messages FA 01 EB 10 (TimeStartup, TimeGps,
// YawPitchRoll, AngularRate, PosLla, VelNed, InsStatus; 84 bytes), through a bridge from its serial
// line to UDP that cuts the stream where its buffer is full. Bytes from the maker's description
// (REFERENCES.md), independent of hal/vectornav.

namespace hardpack::sim {

struct InsSettings {
  int messages_per_s = 100;
  // Of the world's x axis from north, clockwise: so that no frame is another's by chance.
  double north_rad = 0.6;
  double latitude_deg = 46.78;  // of the world's origin
  double longitude_deg = -71.28;
  double altitude_m = 98.0;
  uint8_t mode = 2;  // InsStatus: 0 not tracking, 1 aligning, 2 tracking, 3 satellites lost
  // 0: a message a datagram. Else the bridge's datagrams have 1 .. this many bytes, at random.
  int cut_bytes = 0;
  uint32_t seed = 1;
};

class SimIns {
 public:
  SimIns(const InsSettings& settings, uint64_t start_ns);

  // Appends the datagrams that were sent up to now_ns.
  void Advance(uint64_t now_ns, const SimVehicle& vehicle,
               std::vector<std::vector<uint8_t>>& datagrams);

  InsSettings& settings() { return settings_; }
  // As of `vehicle`, at a time since the sensor's start.
  std::vector<uint8_t> Message(uint64_t since_start_ns, const SimVehicle& vehicle) const;

 private:
  InsSettings settings_;
  std::mt19937 random_;
  uint64_t start_ns_;
  uint64_t sent_ = 0;            // messages
  std::vector<uint8_t> buffer_;  // of the bridge
  size_t next_cut_bytes_ = 0;
};

}  // namespace hardpack::sim
