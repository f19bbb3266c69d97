// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/scene/world.h"

// What an Ouster OS1-64 (first generation, LEGACY profile, 1024 x 10) on the vehicle's roof would
// send in a World: its datagrams, its metadata and the class of every return. Geometry and packet
// layout are written independently from the manufacturer's description (docs/algorithm.md,
// REFERENCES.md), in double precision, so that they test the library's code instead of repeating
// it.

namespace hardpack::scene {

inline constexpr int kBeams = 64;
inline constexpr int kColumns = 1024;
inline constexpr int kColumnsPerPacket = 16;

struct Datagram {
  uint64_t time_ns = 0;  // when it was sent
  uint16_t port = 0;     // 7502 lidar, 7503 IMU
  std::vector<uint8_t> payload;
};

struct Recording {
  std::vector<Datagram> datagrams;  // part of a revolution, a whole one, part of the next; and IMU
  std::string metadata_json;
  std::string labels_csv;  // for the whole revolution
};

// Ranges have 1.5 cm of noise, and 0.5 % of the returns are lost; both depend on the seed.
Recording Record(const World& world, uint32_t seed);

// Writes folder/scan.pcap (Ethernet; a lidar datagram is nine IPv4 fragments), scan.json and
// labels.csv. kInvalidArgument, naming the file, if one cannot be written.
ReadOutcome WriteRecording(const Recording& recording, const std::string& folder);

}  // namespace hardpack::scene
