// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_velodyne_packets.h"

#include <cmath>

#include "tools/sim/sensors/little_endian.h"

namespace hardpack::sim {
namespace {

constexpr uint8_t kStrongest = 0x37;

uint32_t UnitOf_mm(LidarModel model) {
  return model == LidarModel::kVlp16 ? 2 : 4;
}

uint8_t ProductOf(LidarModel model) {
  return model == LidarModel::kVlp16 ? 0x22 : 0x28;
}

int LasersOf(LidarModel model) {
  return model == LidarModel::kVlp16 ? 16 : 32;
}

// A clock that was set back to before its zero shows the end of the previous hour.
uint32_t PastTheHour_us(uint64_t stamp_ns) {
  constexpr int64_t kHour_ns = 3'600'000'000'000;
  const int64_t past_ns = static_cast<int64_t>(stamp_ns) % kHour_ns;
  return static_cast<uint32_t>((past_ns < 0 ? past_ns + kHour_ns : past_ns) / 1000);
}

uint16_t Azimuth_cdeg(double turns) {
  return static_cast<uint16_t>(std::lround(36000.0 * turns) % 36000);
}

// 0: none, or farther than a number of 16 bits says.
uint16_t Distance(uint32_t range_mm, uint32_t unit_mm) {
  const uint32_t units = (range_mm + unit_mm / 2) / unit_mm;
  return units > 0xffff ? uint16_t{0} : static_cast<uint16_t>(units);
}

}  // namespace

VelodynePackets::VelodynePackets(LidarModel model) : model_(model) {}

void VelodynePackets::Restart() {
  returns_ = 0;
  bytes_.clear();
}

bool VelodynePackets::Append(double azimuth_turns, uint64_t stamp_ns, const LidarReturns& returns) {
  if (returns_ == 0) {
    bytes_.clear();
    first_us_ = PastTheHour_us(stamp_ns);
  }
  if (returns_ % kReturnsPerBlock == 0) {
    Put(bytes_, uint16_t{0xeeff});
    Put(bytes_, Azimuth_cdeg(azimuth_turns));
  }
  const int lasers = LasersOf(model_);
  for (size_t laser = 0; laser < static_cast<size_t>(lasers); ++laser) {
    const uint16_t distance = Distance(returns.ranges_mm[laser], UnitOf_mm(model_));
    Put(bytes_, distance);
    Put(bytes_, distance == 0 ? uint8_t{0} : returns.reflectivities[laser]);
  }
  returns_ += lasers;
  if (returns_ < kBlocks * kReturnsPerBlock) return false;
  returns_ = 0;
  Put(bytes_, first_us_);
  Put(bytes_, kStrongest);
  Put(bytes_, ProductOf(model_));
  return true;
}

}  // namespace hardpack::sim
