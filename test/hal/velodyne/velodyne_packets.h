// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "hal/velodyne/velodyne.h"

// Data packets of a Velodyne as one would send them that turns evenly, byte by byte from the
// maker's description, in double precision.

namespace hardpack::velodyne::test {

// One return: its distance in the sensor's unit, and how strong it is.
struct Raw {
  uint16_t distance = 0;
  uint8_t reflectivity = 0;
};

struct Turning {
  Config config;
  double rate = 1.0;               // of what is set up
  double begin_cdeg = 0.0;         // where the first firing is
  uint64_t begin_us = 10'000'000;  // when that is
  // What laser `row` sees at firing n; `last`: the last return of a sensor with two.
  std::function<Raw(int64_t n, int row, bool last)> sees = [](int64_t, int, bool) {
    return Raw{2500, 40};
  };

  bool is_vlp16() const { return config.model == Model::kVlp16; }
  bool is_dual() const { return config.return_mode == ReturnMode::kDual; }
  int beams() const { return is_vlp16() ? 16 : 32; }
  int firings() const { return (is_vlp16() ? 24 : 12) / (is_dual() ? 2 : 1); }
  // [0.01 degree], not wrapped.
  double Azimuth_cdeg(double firing) const {
    return begin_cdeg + firing * rate * config.rpm * 600.0 * 55.296e-6;
  }
};

inline void Put16(std::vector<uint8_t>& bytes, size_t at, uint32_t value) {
  bytes[at] = static_cast<uint8_t>(value & 0xffu);
  bytes[at + 1] = static_cast<uint8_t>(value >> 8 & 0xffu);
}

inline void PutTime(std::vector<uint8_t>& bytes, uint32_t time_us) {
  Put16(bytes, 1200, time_us & 0xffffu);
  Put16(bytes, 1202, time_us >> 16);
}

inline void PutAzimuth(std::vector<uint8_t>& bytes, size_t block, uint32_t azimuth_cdeg) {
  Put16(bytes, 100 * block + 2, azimuth_cdeg);
}

// The k-th packet.
inline std::vector<uint8_t> PacketOf(const Turning& sensor, int64_t k) {
  std::vector<uint8_t> bytes(1206);
  const int per_block = sensor.is_vlp16() ? 2 : 1;
  for (size_t block = 0; block < 12; ++block) {
    const int64_t group = static_cast<int64_t>(sensor.is_dual() ? block / 2 : block);
    const int64_t first = k * sensor.firings() + group * per_block;
    bytes[100 * block] = 0xff;
    bytes[100 * block + 1] = 0xee;
    const double azimuth_cdeg = sensor.Azimuth_cdeg(static_cast<double>(first));
    PutAzimuth(bytes, block, static_cast<uint32_t>(std::fmod(std::floor(azimuth_cdeg), 36000.0)));
    for (int i = 0; i < 32; ++i) {
      const Raw raw = sensor.sees(first + i / sensor.beams(), i % sensor.beams(), block % 2 == 0);
      const size_t at = 100 * block + 4 + 3 * static_cast<size_t>(i);
      Put16(bytes, at, raw.distance);
      bytes[at + 2] = raw.reflectivity;
    }
  }
  const double since_us = 55.296 * static_cast<double>(k * sensor.firings());
  const auto time_us = sensor.begin_us + static_cast<uint64_t>(since_us);
  PutTime(bytes, static_cast<uint32_t>(time_us % 3'600'000'000u));
  bytes[1204] = static_cast<uint8_t>(sensor.config.return_mode);
  bytes[1205] = sensor.is_vlp16() ? 0x22 : 0x28;
  return bytes;
}

}  // namespace hardpack::velodyne::test
