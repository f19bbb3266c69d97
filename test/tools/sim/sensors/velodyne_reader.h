// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/sim/sensors/sim_lidar.h"

// A Velodyne's packets taken apart by the offsets of its manual, for tests of the simulated one:
// with nothing of the library's own reader and nothing of what wrote them.

namespace hardpack::sim::velodyne {

using Bytes = std::vector<uint8_t>;

inline uint32_t At(const Bytes& packet, size_t offset, size_t size) {
  uint32_t value = 0;
  for (size_t i = 0; i < size; ++i) value |= uint32_t{packet.at(offset + i)} << (8 * i);
  return value;
}

inline uint32_t Azimuth_cdeg(const Bytes& packet, size_t block) {
  return At(packet, 100 * block + 2, 2);
}

inline uint32_t Distance(const Bytes& packet, size_t block, size_t point) {
  return At(packet, 100 * block + 4 + 3 * point, 2);
}

inline uint32_t Reflectivity(const Bytes& packet, size_t block, size_t point) {
  return At(packet, 100 * block + 4 + 3 * point + 2, 1);
}

inline uint32_t Time_us(const Bytes& packet) {
  return At(packet, 1200, 4);
}

// What is in the manuals of each model.
struct Facts {
  size_t lasers;
  uint32_t unit_mm;
  uint32_t product;
  double packet_us;
  std::vector<double> altitude_deg;
  std::vector<double> offset_deg;  // clockwise
  std::vector<double> above_mm;
  double FiresAfter_us(size_t laser) const {
    return 2.304 * static_cast<double>(lasers == 16 ? laser : laser / 2);
  }
};

inline Facts FactsOf(LidarModel model) {
  if (model == LidarModel::kVlp16) {
    return {
        16,
        2,
        0x22,
        24 * 55.296,
        {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15},
        std::vector<double>(16, 0.0),
        {11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1, 5.1, -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2}};
  }
  return {32,
          4,
          0x28,
          12 * 55.296,
          {-25.0,  -1.0,   -1.667, -15.639, -11.31, 0.0,    -0.667, -8.843, -7.254, 0.333,  -0.333,
           -6.148, -5.333, 1.333,  0.667,   -4.0,   -4.667, 1.667,  1.0,    -3.667, -3.333, 3.333,
           2.333,  -2.667, -3.0,   7.0,     4.667,  -2.333, -2.0,   15.0,   10.333, -1.333},
          {1.4, -4.2, 1.4, -1.4, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 4.2, -1.4,
           1.4, -4.2, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4, 1.4, -1.4, 1.4, -4.2, 4.2, -1.4, 1.4, -1.4},
          std::vector<double>(32, 0.0)};
}

// A firing sequence of a packet.
struct Sequence {
  double azimuth_deg = 0.0;  // of its first laser; of a block's second sequence nearly
  double time_us = 0.0;
  std::vector<uint32_t> distances;  // by laser, in the model's unit
  std::vector<uint32_t> reflectivities;

  // Degrees from ahead anticlockwise, in (-180, 180].
  double Ahead_deg() const { return azimuth_deg >= 180.0 ? 360.0 - azimuth_deg : -azimuth_deg; }
};

inline std::vector<Sequence> SequencesOf(const std::vector<Bytes>& packets, const Facts& facts) {
  std::vector<Sequence> sequences;
  const size_t in_block = 32 / facts.lasers;
  for (const Bytes& packet : packets) {
    for (size_t i = 0; i < 12 * in_block; ++i) {
      Sequence sequence;
      const double turned_deg = 0.199 * static_cast<double>(i % in_block);
      sequence.azimuth_deg = 0.01 * Azimuth_cdeg(packet, i / in_block) + turned_deg;
      if (sequence.azimuth_deg >= 360.0) sequence.azimuth_deg -= 360.0;
      sequence.time_us = Time_us(packet) + 55.296 * static_cast<double>(i);
      for (size_t laser = 0; laser < facts.lasers; ++laser) {
        const size_t point = i % in_block * facts.lasers + laser;
        sequence.distances.push_back(Distance(packet, i / in_block, point));
        sequence.reflectivities.push_back(Reflectivity(packet, i / in_block, point));
      }
      sequences.push_back(sequence);
    }
  }
  return sequences;
}

}  // namespace hardpack::sim::velodyne
