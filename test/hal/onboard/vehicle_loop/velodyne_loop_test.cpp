// SPDX-License-Identifier: Apache-2.0
// A vehicle with a lidar that measures its azimuths, through the whole tick: nothing of a healthy
// one is lost, and it is not blind.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "hal/onboard/vehicle_loop/vehicle_loop_tick.h"
#include "hal/velodyne/beams.h"
#include "hal/velodyne/lidar.h"
#include "test/hal/velodyne/velodyne_packets.h"

namespace hardpack {
namespace {

struct VelodyneVehicle {
  static constexpr const char* kType = "velodyne_vehicle";
  using Lidar = velodyne::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = sevcon::DrivePair;
};
static_assert(VehicleType<VelodyneVehicle>);
using Loop = BasicVehicleLoop<VelodyneVehicle>;

constexpr double kSensor_m = 1.284;

// Level ground, with a little noise.
velodyne::test::Raw Ground(int64_t firing, int row) {
  const double altitude_rad =
      static_cast<double>(velodyne::kVlp16Altitude_deg[static_cast<size_t>(row)]) * M_PI / 180.0;
  if (altitude_rad > -0.01) return {};
  const double units = 500.0 * kSensor_m / -std::sin(altitude_rad);
  return {static_cast<uint16_t>(units + static_cast<double>((firing * 7 + row * 13) % 11)), 10};
}

TEST(VelodyneLoop, AHealthySensorIsNeitherBlindNorLossy) {
  const auto loop = std::make_unique<Loop>();
  const auto config = std::make_unique<Loop::Config>();
  config->lidar = {velodyne::Model::kVlp16, velodyne::ReturnMode::kStrongest, 600};
  // Its beams are 2 degrees apart.
  EXPECT_EQ(loop->Configure(*config), Status::kParameterOutOfRange);
  config->planner.speed.assured_height_m = 0.5f;
  ASSERT_EQ(loop->Configure(*config), Status::kOk);

  velodyne::test::Turning sensor{.config = config->lidar};
  sensor.sees = [](int64_t firing, int row, bool) { return Ground(firing, row); };
  constexpr int kTicks = 200;
  const double packet_us = 24 * 55.296;
  int64_t sent = 0;
  uint64_t now_ns = 1'000'000'000;
  for (int tick = 1; tick <= kTicks; ++tick) {
    now_ns += 10'000'000;
    std::vector<std::vector<uint8_t>> packets;
    for (; static_cast<double>(sent + 1) * packet_us < tick * 1.0e4; ++sent) {
      packets.push_back(velodyne::test::PacketOf(sensor, sent));
    }
    std::vector<TickDatagram> datagrams;
    for (const std::vector<uint8_t>& packet : packets) {
      datagrams.push_back({InputSource::kLidar, packet});
    }
    TickInput input;
    input.index = static_cast<uint64_t>(tick);
    input.now_ns = now_ns;
    input.datagrams = datagrams;
    TickOutput output;
    ASSERT_EQ(loop->Tick(input, output), Status::kOk);
  }
  const Mapper& mapper = loop->mapper();
  const ScanCounters& counters = mapper.ring().counters();
  EXPECT_EQ(counters.columns + mapper.counters().columns_without_pose,
            static_cast<uint32_t>(sent) * 24u);
  EXPECT_LT(mapper.counters().columns_without_pose, 300u);  // before the first poses
  EXPECT_EQ(counters.duplicates + counters.bad_columns + mapper.counters().columns_over_limit, 0u);
  const SightWatch& sight = loop->sight();
  EXPECT_EQ(sight.OldSectors(now_ns, 0.21f), 0);
  EXPECT_EQ(sight.covered_sectors() + sight.frozen_sectors(), 0);
  EXPECT_NEAR(static_cast<double>(sight.revolution_ns()), 1.0e8, 6.0e6);
  for (int part = 0; part < SightWatch::kShown; ++part) {
    EXPECT_GE(sight.SharesOf(part, now_ns).columns_permille, 970) << part;
    EXPECT_GE(sight.SharesOf(part, now_ns).returns_permille, 990) << part;
  }
}

}  // namespace
}  // namespace hardpack
