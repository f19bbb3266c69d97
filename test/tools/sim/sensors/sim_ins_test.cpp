// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_ins.h"

#include <cmath>

#include "gtest/gtest.h"
#include "hal/pose_datagram/pose_datagram.h"
#include "hal/vectornav/vectornav.h"
#include "test/tools/sim/vehicle/bus.h"

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

// The WGS 84 ellipsoid's radii of curvature at a latitude, from the equatorial and polar radii.
struct Curvature {
  double north_m;
  double east_m;
};
Curvature CurvatureAt(double latitude_rad) {
  constexpr double kEquatorial_m = 6'378'137.0;
  constexpr double kPolar_m = 6'356'752.314245;
  const double c = kEquatorial_m * std::cos(latitude_rad);
  const double s = kPolar_m * std::sin(latitude_rad);
  const double square_m2 = c * c + s * s;
  return {kEquatorial_m * kEquatorial_m * kPolar_m * kPolar_m / std::pow(square_m2, 1.5),
          kEquatorial_m * kEquatorial_m / std::sqrt(square_m2)};
}

BodyMotion MotionOf(const SimVehicle& vehicle) {
  return MotionOf(vehicle, world::World());
}

TEST(SimIns, TellsWhereTheVehicleIsAndHowItMoves) {
  uint64_t now_ns = 0;
  SimVehicle vehicle = Started(now_ns);
  Drive(vehicle, 60, 80, now_ns, 5.0);
  ASSERT_GT(vehicle.speed_mps(), 1.5);
  ASSERT_GT(vehicle.yaw_rate_radps(), 0.2);
  InsSettings settings;
  const SimIns ins(settings, 0);
  const std::vector<uint8_t> message = ins.Message(123'456'789, MotionOf(vehicle));
  EXPECT_EQ(message.size(), 84u);
  const InsSample sample = Decoded(message);
  EXPECT_EQ(sample.timestamp_ns, 123'456'789u);
  ASSERT_TRUE(sample.has_attitude && sample.has_velocity && sample.has_position);
  const Pose& pose = vehicle.pose();
  const double yaw_rad = settings.north_rad - pose.theta_rad;
  EXPECT_NEAR(std::remainder(static_cast<double>(sample.yaw_rad) - yaw_rad, 2.0 * M_PI), 0.0,
              1.0e-5);
  EXPECT_NEAR(sample.angular_rate.z_radps, -vehicle.yaw_rate_radps(), 1.0e-6) << "z is down";
  EXPECT_NEAR(std::hypot(sample.velocity_ned.north_mps, sample.velocity_ned.east_mps),
              vehicle.speed_mps(), 1.0e-5);
  EXPECT_EQ(sample.status.mode, InsMode::kTracking);
  EXPECT_TRUE(sample.status.gnss_fix);
}

// The same in the two formats, to what each resolves.
TEST(SimIns, TellsTheSameInPoseDatagrams) {
  uint64_t now_ns = 0;
  SimVehicle vehicle = Started(now_ns);
  Drive(vehicle, 60, 80, now_ns, 5.0);
  InsSettings settings;
  settings.errors = Vn300Errors();
  settings.with_acceleration = true;
  const SimIns vectornav(settings, 0);
  settings.format = InsFormat::kPoseDatagram;
  const SimIns pose(settings, 0);
  const InsSample one = Decoded(vectornav.Message(123'456'789, MotionOf(vehicle), 41));
  const std::vector<uint8_t> datagram = pose.Message(123'456'789, MotionOf(vehicle), 41);
  ASSERT_EQ(datagram.size(), pose_datagram::kDatagram_bytes);
  uint32_t sequence = 0;
  InsSample other;
  ASSERT_EQ(pose_datagram::Decode(std::span(datagram).first<pose_datagram::kDatagram_bytes>(),
                                  sequence, other),
            Status::kOk);
  EXPECT_EQ(sequence, 41u);
  EXPECT_EQ(other.timestamp_ns, one.timestamp_ns);
  EXPECT_EQ(other.gps_time_ns, one.gps_time_ns);
  EXPECT_NEAR(other.yaw_rad, one.yaw_rad, 1.0e-6);
  EXPECT_NEAR(other.pitch_rad, one.pitch_rad, 1.0e-6);
  EXPECT_NEAR(other.roll_rad, one.roll_rad, 1.0e-6);
  EXPECT_EQ(other.angular_rate.z_radps, one.angular_rate.z_radps);
  EXPECT_EQ(other.acceleration.x_mps2, one.acceleration.x_mps2);
  EXPECT_EQ(other.velocity_ned.north_mps, one.velocity_ned.north_mps);
  EXPECT_NEAR(static_cast<double>(other.latitude_ndeg - one.latitude_ndeg), 0.0, 1.0);
  EXPECT_NEAR(static_cast<double>(other.longitude_ndeg - one.longitude_ndeg), 0.0, 1.0);
  EXPECT_EQ(other.status.mode, one.status.mode);
  EXPECT_EQ(other.status.gnss_fix, one.status.gnss_fix);
  EXPECT_EQ(other.status.gnss_heading, one.status.gnss_heading);
}

TEST(SimIns, MovesItsPositionAsItsVelocitySays) {
  uint64_t now_ns = 0;
  SimVehicle vehicle = Started(now_ns);
  Drive(vehicle, 60, 80, now_ns, 5.0);
  const SimIns ins(InsSettings{}, 0);
  const InsSample before = Decoded(ins.Message(now_ns, MotionOf(vehicle)));
  std::vector<CanFrame> sent;
  constexpr double kSeconds = 0.05;
  vehicle.Advance(now_ns + 50'000'000, sent);
  const InsSample after = Decoded(ins.Message(now_ns + 50'000'000, MotionOf(vehicle)));
  constexpr double kLatitude_rad = 46.78 * M_PI / 180.0;
  const Curvature radius = CurvatureAt(kLatitude_rad);
  const double north_mps = static_cast<double>(after.latitude_ndeg - before.latitude_ndeg) *
                           1.0e-9 * radius.north_m * M_PI / 180.0 / kSeconds;
  const double east_mps = static_cast<double>(after.longitude_ndeg - before.longitude_ndeg) *
                          1.0e-9 * radius.east_m * std::cos(kLatitude_rad) * M_PI / 180.0 /
                          kSeconds;
  EXPECT_NEAR(north_mps, (before.velocity_ned.north_mps + after.velocity_ned.north_mps) / 2.0f,
              0.02);
  EXPECT_NEAR(east_mps, (before.velocity_ned.east_mps + after.velocity_ned.east_mps) / 2.0f, 0.02);
}

// 1 km to the east and 1 km to the north: a sphere would be 3 m short.
TEST(SimIns, StandsOnTheEllipsoid) {
  InsSettings settings;
  settings.north_rad = 0.0;  // x north, y west
  const SimIns ins(settings, 0);
  BodyMotion motion;
  motion.pose.position = {1000.0, -1000.0, 5.0};
  const InsSample sample = Decoded(ins.Message(0, motion));
  const double latitude_rad = settings.latitude_deg * M_PI / 180.0;
  const Curvature radius = CurvatureAt(latitude_rad);
  const double north_rad = 1000.0 / (radius.north_m + settings.altitude_m);
  const double latitude_deg = settings.latitude_deg + north_rad * 180.0 / M_PI;
  const double longitude_deg =
      settings.longitude_deg +
      1000.0 / ((radius.east_m + settings.altitude_m) * std::cos(latitude_rad + north_rad)) *
          180.0 / M_PI;
  constexpr double kCentimeter_ndeg = 90.0;
  EXPECT_NEAR(static_cast<double>(sample.latitude_ndeg), latitude_deg * 1.0e9, kCentimeter_ndeg);
  EXPECT_NEAR(static_cast<double>(sample.longitude_ndeg), longitude_deg * 1.0e9, kCentimeter_ndeg);
  EXPECT_NEAR(sample.altitude_m, settings.altitude_m + 5.0, 1.0e-4);
}

// Body: nose down by 0.1, left side up by 0.05; the sensor's axes point forward, right, down.
TEST(SimIns, TellsAttitudeAndForceInItsOwnAxes) {
  InsSettings settings;
  settings.with_acceleration = true;
  const SimIns ins(settings, 0);
  BodyMotion motion;
  motion.pose.roll_rad = 0.05;
  motion.pose.pitch_rad = 0.1;
  motion.velocity_mps = {0.0, 0.0, 0.3};
  motion.rate_radps = {0.1, 0.2, 0.3};
  motion.specific_force_mps2 = {0.5, 0.7, 9.8};
  const std::vector<uint8_t> message = ins.Message(0, motion);
  EXPECT_EQ(message.size(), 96u);
  const InsSample sample = Decoded(message);
  EXPECT_NEAR(sample.roll_rad, 0.05, 1.0e-6);
  EXPECT_NEAR(sample.pitch_rad, -0.1, 1.0e-6);
  EXPECT_NEAR(sample.velocity_ned.down_mps, -0.3, 1.0e-6);
  EXPECT_NEAR(sample.angular_rate.x_radps, 0.1, 1.0e-6);
  EXPECT_NEAR(sample.angular_rate.y_radps, -0.2, 1.0e-6);
  EXPECT_NEAR(sample.angular_rate.z_radps, -0.3, 1.0e-6);
  ASSERT_TRUE(sample.has_acceleration);
  EXPECT_NEAR(sample.acceleration.x_mps2, 0.5, 1.0e-6);
  EXPECT_NEAR(sample.acceleration.y_mps2, -0.7, 1.0e-6);
  EXPECT_NEAR(sample.acceleration.z_mps2, -9.8, 1.0e-6);
}

TEST(SimIns, ErrsAsItIsToldTo) {
  InsSettings settings;
  settings.errors = Vn300Errors();
  settings.errors.gyro_bias_radps = {0.0, 0.0, 0.01};
  settings.errors.position_wander_m = 0.0;
  const SimIns ins(settings, 0);
  constexpr int kMessages = 4000;
  double sum = 0.0;
  double squares = 0.0;
  for (uint64_t i = 0; i < kMessages; ++i) {
    const double rate = Decoded(ins.Message(i * 10'000'000, {}, i)).angular_rate.z_radps;
    sum += rate;
    squares += rate * rate;
  }
  const double mean = sum / kMessages;
  const double deviation = std::sqrt(squares / kMessages - mean * mean);
  const double expected = settings.errors.gyro_noise_radps;
  EXPECT_NEAR(mean, 0.01, 4.0 * expected / std::sqrt(kMessages));
  EXPECT_NEAR(deviation, expected, 0.05 * expected);
}

TEST(SimIns, JumpsDriftsAndLosesItsSatellitesWhenTold) {
  SimIns ins(InsSettings{}, 0);
  std::vector<std::vector<uint8_t>> datagrams;
  ins.Advance(1'000'000'000, {}, datagrams);
  ins.settings().errors.jump_north_m = 10.0;
  ins.Advance(1'010'000'000, {}, datagrams);
  ins.settings().errors.drift_north_mps = 0.5;
  ins.Advance(3'010'000'000, {}, datagrams);
  ins.settings().errors.drift_north_mps = 0.0;
  ins.settings().mode = 3;
  ins.Advance(5'010'000'000, {}, datagrams);
  ASSERT_EQ(datagrams.size(), 4u);  // each call's messages in one
  std::vector<InsSample> last;
  for (const auto& datagram : datagrams) {
    ASSERT_EQ(datagram.size() % 84, 0u);
    last.push_back(Decoded({datagram.end() - 84, datagram.end()}));
  }
  const double north_ndeg = 1.0e9 * 180.0 / M_PI / 6'367'000.0;  // a metre
  const auto moved_m = [&](size_t i) {
    return static_cast<double>(last[i].latitude_ndeg - last[0].latitude_ndeg) / north_ndeg;
  };
  EXPECT_NEAR(moved_m(1), 10.0, 0.05);
  EXPECT_NEAR(moved_m(2), 11.0, 0.05);
  EXPECT_NEAR(moved_m(3), 11.0, 0.05) << "what it drifted stays";
  EXPECT_NEAR(last[2].velocity_ned.north_mps, 0.5, 1.0e-6);
  EXPECT_EQ(last[2].status.mode, InsMode::kTracking);
  EXPECT_EQ(last[3].status.mode, InsMode::kGnssLost);
  EXPECT_FALSE(last[3].status.gnss_fix);
}

TEST(SimIns, SendsAMessageADatagramAtItsRate) {
  const SimVehicle vehicle(DefaultVehicle(), 0);
  SimIns ins(InsSettings{}, 0);
  std::vector<std::vector<uint8_t>> datagrams;
  for (uint64_t ms = 0; ms <= 1000; ++ms) ins.Advance(ms * 1'000'000, MotionOf(vehicle), datagrams);
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
    whole.Advance(ms * 1'000'000, MotionOf(vehicle), of_whole);
    cut.Advance(ms * 1'000'000, MotionOf(vehicle), of_cut);
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
