// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sim_ins.h"

#include <cmath>

#include "gtest/gtest.h"
#include "hal/vectornav/vectornav.h"
#include "test/tools/sim/bus.h"

// The messages read with the library's own codec.

namespace hardpack::sim {
namespace {

using test::MakeFrame;

// Both drives up and turning their wheels by so many rpm (gear 1), for some seconds.
void Drive(SimVehicle& vehicle, int left_rpm, int right_rpm, uint64_t& now_ns, double seconds) {
  std::vector<CanFrame> sent;
  for (int i = 0; i < static_cast<int>(100 * seconds); ++i) {
    const int control = i < 10 ? 6 : i < 20 ? 7 : 15;
    for (const auto& [id, rpm] : {std::pair{0x202u, left_rpm}, {0x203u, right_rpm}}) {
      vehicle.TakeFrame(MakeFrame(id, {control, 0, rpm & 0xff, rpm >> 8 & 0xff, rpm >> 16 & 0xff,
                                       rpm >> 24 & 0xff, 0xe8, 3}),
                        now_ns);
    }
    now_ns += 10'000'000;
    vehicle.Advance(now_ns, sent);
  }
}

SimVehicle Started(uint64_t& now_ns) {
  SimVehicle vehicle(DefaultVehicle(), 0);
  std::vector<CanFrame> sent;
  now_ns = 400'000'000;
  vehicle.Advance(now_ns, sent);
  vehicle.TakeFrame(MakeFrame(0, {1, 0}), now_ns);
  for (const Side side : kBothSides) vehicle.drive(side).SetObject(0x6080, 0, 6000);
  return vehicle;
}

InsSample Decoded(const std::vector<uint8_t>& message) {
  InsSample sample;
  EXPECT_EQ(vectornav::DecodeBinary(message, sample), hardpack::Status::kOk);
  return sample;
}

TEST(SimIns, TellsWhereTheVehicleIsAndHowItMoves) {
  uint64_t now_ns = 0;
  SimVehicle vehicle = Started(now_ns);
  Drive(vehicle, 60, 80, now_ns, 5.0);
  ASSERT_GT(vehicle.speed_mps(), 1.5);
  ASSERT_GT(vehicle.yaw_rate_radps(), 0.2);
  InsSettings settings;
  const SimIns ins(settings, 0);
  const std::vector<uint8_t> message = ins.Message(123'456'789, vehicle);
  EXPECT_EQ(message.size(), 84u);
  const InsSample sample = Decoded(message);
  EXPECT_EQ(sample.timestamp_ns, 123'456'789u);
  ASSERT_TRUE(sample.has_attitude && sample.has_velocity && sample.has_position);
  const Pose& pose = vehicle.pose();
  const double yaw_rad = settings.north_rad - pose.theta_rad;
  EXPECT_NEAR(std::remainder(static_cast<double>(sample.yaw_rad) - yaw_rad, 2.0 * M_PI), 0.0,
              1.0e-5);
  EXPECT_NEAR(sample.angular_rate_radps.z_m, -vehicle.yaw_rate_radps(), 1.0e-6) << "z is down";
  EXPECT_NEAR(std::hypot(sample.velocity_ned_mps.x_m, sample.velocity_ned_mps.y_m),
              vehicle.speed_mps(), 1.0e-5);
  EXPECT_EQ(sample.status.mode, InsMode::kTracking);
  EXPECT_TRUE(sample.status.gnss_fix);
}

TEST(SimIns, MovesItsPositionAsItsVelocitySays) {
  uint64_t now_ns = 0;
  SimVehicle vehicle = Started(now_ns);
  Drive(vehicle, 60, 80, now_ns, 5.0);
  const SimIns ins(InsSettings{}, 0);
  const InsSample before = Decoded(ins.Message(now_ns, vehicle));
  std::vector<CanFrame> sent;
  constexpr double kSeconds = 0.05;
  vehicle.Advance(now_ns + 50'000'000, sent);
  const InsSample after = Decoded(ins.Message(now_ns + 50'000'000, vehicle));
  constexpr double kMetersPerDegree = 6'371'000.0 * M_PI / 180.0;
  const double north_mps = static_cast<double>(after.latitude_ndeg - before.latitude_ndeg) *
                           1.0e-9 * kMetersPerDegree / kSeconds;
  const double east_mps = static_cast<double>(after.longitude_ndeg - before.longitude_ndeg) *
                          1.0e-9 * kMetersPerDegree * std::cos(46.78 * M_PI / 180.0) / kSeconds;
  EXPECT_NEAR(north_mps, (before.velocity_ned_mps.x_m + after.velocity_ned_mps.x_m) / 2.0f, 0.02);
  EXPECT_NEAR(east_mps, (before.velocity_ned_mps.y_m + after.velocity_ned_mps.y_m) / 2.0f, 0.02);
}

TEST(SimIns, SendsAMessageADatagramAtItsRate) {
  const SimVehicle vehicle(DefaultVehicle(), 0);
  SimIns ins(InsSettings{}, 0);
  std::vector<std::vector<uint8_t>> datagrams;
  for (uint64_t ms = 0; ms <= 1000; ++ms) ins.Advance(ms * 1'000'000, vehicle, datagrams);
  ASSERT_EQ(datagrams.size(), 100u);
  for (const auto& datagram : datagrams) Decoded(datagram);
}

TEST(SimIns, LosesNoByteWhereItsStreamIsCut) {
  const SimVehicle vehicle(DefaultVehicle(), 0);
  InsSettings settings;
  SimIns whole(settings, 0);
  settings.cut_bytes = 37;
  SimIns cut(settings, 0);
  std::vector<std::vector<uint8_t>> of_whole;
  std::vector<std::vector<uint8_t>> of_cut;
  for (uint64_t ms = 0; ms <= 1000; ++ms) {
    whole.Advance(ms * 1'000'000, vehicle, of_whole);
    cut.Advance(ms * 1'000'000, vehicle, of_cut);
  }
  std::vector<uint8_t> expected;
  for (const auto& datagram : of_whole) {
    expected.insert(expected.end(), datagram.begin(), datagram.end());
  }
  std::vector<uint8_t> stream;
  for (const auto& datagram : of_cut) {
    EXPECT_LE(datagram.size(), 37u);
    stream.insert(stream.end(), datagram.begin(), datagram.end());
  }
  ASSERT_LE(stream.size(), expected.size());
  EXPECT_GT(stream.size() + 37, expected.size());
  expected.resize(stream.size());
  EXPECT_EQ(stream, expected);
}

TEST(SimVehicle, TurnsLeftWhenTheRightWheelsAreFaster) {
  uint64_t now_ns = 0;
  SimVehicle vehicle = Started(now_ns);
  Drive(vehicle, 40, 60, now_ns, 3.0);
  EXPECT_GT(vehicle.pose().theta_rad, 0.1);
  EXPECT_GT(vehicle.pose().y_m, 0.0);
  const double wheel_radps = 60.0 * 2.0 * M_PI / 60.0;
  EXPECT_NEAR(vehicle.drive(Side::kRight).wheel_radps(), wheel_radps, 0.1);
}

}  // namespace
}  // namespace hardpack::sim
