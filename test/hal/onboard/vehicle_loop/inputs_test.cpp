// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/vectornav/encode.h"
#include "hal/vectornav/stream_parser.h"
#include "hal/vectornav/vectornav.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// Inputs that only look fresh, ticks that are missed, and memory that is not empty.

namespace hardpack {
namespace {

using control::GoalFrame;
using control::Kind;
using testing::ClosedLoop;

// SR-ODO03
TEST(VehicleLoopInputs, AnInsThatRepeatsItselfIsASilentOne) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.repeats_ins = true;
  ASSERT_TRUE(drive.Until(1.0, [&] { return drive.mode() == Mode::kSafeStop; }));
  EXPECT_EQ(drive.reason(), StopReason::kInsOld);
  EXPECT_FALSE(drive.loop().odometry().uses_ins_rate());
}

// The INS's bytes of a tick as what they say, and that as a $VNINS line.
std::vector<uint8_t> AsLine(std::span<const uint8_t> binary) {
  vectornav::StreamParser parser;
  InsSample sample;
  parser.Feed(binary);
  EXPECT_EQ(parser.Next(sample), Status::kOk);
  std::vector<uint8_t> line(vectornav::kMaxAsciiBytes);
  size_t size_bytes = 0;
  EXPECT_EQ(vectornav::EncodeAscii(sample, line, size_bytes), Status::kOk);
  line.resize(size_bytes);
  return line;
}

// A line has no time since the device's start.
// SR-ODO03
TEST(VehicleLoopInputs, LinesOfAnInsThatRepeatThemselvesAreSilence) {
  ClosedLoop drive;
  std::vector<uint8_t> line;
  drive.adds = [&](std::vector<TickDatagram>& datagrams) {
    for (TickDatagram& datagram : datagrams) {
      if (datagram.source != InputSource::kIns) continue;
      if (!drive.repeats_ins) line = AsLine(datagram.bytes);
      datagram.bytes = line;
    }
  };
  drive.DriveTo(60.0f, 0.0f);
  drive.repeats_ins = true;
  ASSERT_TRUE(drive.Until(1.0, [&] { return drive.mode() == Mode::kSafeStop; }));
  EXPECT_EQ(drive.reason(), StopReason::kInsOld);
  EXPECT_GT(drive.loop().odometry().counters().repeated, 10u);
}

// A second kind of message, without a rate, 20 times a second beside one that has it.
// SR-CMD04
TEST(VehicleLoopInputs, AMessageWithoutARateDoesNotHideAWrongTurn) {
  ClosedLoop drive;
  int tick = 0;
  std::vector<uint8_t> turning(vectornav::kMaxBinaryBytes);
  std::vector<uint8_t> line;
  drive.DriveTo(60.0f, 0.0f);
  drive.adds = [&](std::vector<TickDatagram>& datagrams) {
    for (size_t i = 0; i < datagrams.size(); ++i) {
      if (datagrams[i].source != InputSource::kIns) continue;
      line = AsLine(datagrams[i].bytes);
      InsSample sample = drive.loop().newest_ins();
      sample.has_timestamp = sample.has_angular_rate = true;
      sample.has_gps_time = false;
      sample.timestamp_ns = drive.now_ns();
      sample.angular_rate = {0.0f, 0.0f, 1.5f};
      size_t size_bytes = 0;
      turning.resize(vectornav::kMaxBinaryBytes);
      ASSERT_EQ(vectornav::EncodeBinary(sample, turning, size_bytes), Status::kOk);
      turning.resize(size_bytes);
      datagrams[i].bytes = turning;
      if (++tick % 5 == 0) {
        datagrams.insert(datagrams.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                         {InputSource::kIns, line});
      }
      return;
    }
  };
  ASSERT_TRUE(drive.Until(2.0, [&] { return drive.mode() == Mode::kFault; }));
  EXPECT_EQ(drive.reason(), StopReason::kWrongTurn);
}

// Nobody knows where the vehicle went meanwhile: it stops, and does not go on by itself.
// SR-ODO01
TEST(VehicleLoopInputs, APauseOfTheTicksWhileDrivingStopsForGood) {
  for (const int missed : {25, 100}) {
    ClosedLoop drive;
    drive.DriveTo(60.0f, 0.0f);
    const uint64_t plans = drive.loop().replanner().committed().number;
    ASSERT_GT(plans, 0u);
    drive.Miss(missed);
    drive.Ticks(1);
    EXPECT_NE(drive.mode(), Mode::kDriving) << missed;
    EXPECT_EQ(drive.loop().drives().commanded().left_radps, 0.0f);
    EXPECT_EQ(drive.loop().counters().missed_ticks, static_cast<uint64_t>(missed));
    // Found by the first wheel speeds that count again, which is once both drives are heard.
    EXPECT_TRUE(drive.Until(1.0, [&] { return drive.loop().counters().odometry_gaps == 1; }));
    EXPECT_TRUE(drive.Until(5.0, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }));
    drive.Ticks(200);
    EXPECT_EQ(drive.loop().goals(), 0);
    EXPECT_LT(std::fabs(drive.Speed_mps()), 0.02);
  }
}

// The ramps are the plan's, in metres per second squared, however late a tick is.
// SR-PGM03
TEST(VehicleLoopInputs, AFewMissedTicksDoNotStretchTheRamps) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  const float before_mps = drive.loop().tracking().speed_mps;
  const float limit_mps2 = drive.config().planner.speed.max_deceleration_mps2;
  drive.Miss(4);
  drive.Ticks(1);
  ASSERT_EQ(drive.loop().permission().motion, Motion::kStopAlong);
  EXPECT_NEAR(before_mps - drive.loop().tracking().speed_mps, 0.05f * limit_mps2, 0.01f);
}

// However long the drives' own time-out is.
// SR-SUP05
TEST(VehicleLoopInputs, WheelSpeedsAreAsOldAsTheyAre) {
  ClosedLoop drive;
  const auto config = std::make_unique<VehicleConfig>(drive.config());
  config->onboard.drive.feedback_timeout_ms = 500;
  ASSERT_EQ(drive.loop().Configure(*config), Status::kOk);
  drive.DriveTo(60.0f, 0.0f);
  drive.Act("at 0 process-data left off");
  drive.Ticks(15);
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  EXPECT_EQ(drive.reason(), StopReason::kOdometryOld);
}

// Wheels that turned while nobody was told: what was mapped before has no place any more.
// SR-ODO01
TEST(VehicleLoopInputs, WheelSpeedsThatComeBackAfterASilenceAreAGap) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.Act("at 0 process-data left off");
  ASSERT_TRUE(drive.Until(2.0, [&] { return drive.mode() == Mode::kFault; }));
  drive.Ticks(200);
  EXPECT_EQ(drive.loop().counters().odometry_gaps, 0u);
  drive.Act("at 0 process-data left on");
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.loop().drives().standstill(); }));
  drive.Ticks(1);
  EXPECT_EQ(drive.loop().counters().odometry_gaps, 1u);
}

// A goal in latitude and longitude: where the satellites were wrong for so long that they are
// believed, it moves in odom, slowly, and odom does not move.
TEST(VehicleLoopInputs, AGoalOnEarthFollowsTheMap) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  const InsSample ins = drive.loop().newest_ins();
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 1;
  command.waypoint[0].frame = GoalFrame::kGeodetic;
  // 300 m to the north: it is never reached here, and near enough for the heading not to matter.
  command.waypoint[0].latitude_ndeg = ins.latitude_ndeg + 2'700'000;
  command.waypoint[0].longitude_ndeg = ins.longitude_ndeg;
  ASSERT_EQ(drive.Say(command), Status::kOk);
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_EQ(drive.loop().map_from_odom().status(), MapStatus::kTracking);
  ASSERT_EQ(drive.Say(command), Status::kOk);
  const Vec2 before = drive.loop().goal_odom();
  EXPECT_NEAR(std::hypot(before.x_m, before.y_m), 300.1, 1.0);
  const double latitude_deg = drive.vehicle().ins().settings().latitude_deg;
  drive.vehicle().ins().settings().latitude_deg = latitude_deg + 12.0 / 111'195.0;
  const StampedPose pose = drive.loop().odometry().pose();
  drive.Ticks(1);
  const StampedPose& after = drive.loop().odometry().pose();
  EXPECT_LT(
      std::hypot(after.position.x_m - pose.position.x_m, after.position.y_m - pose.position.y_m),
      0.05);
  drive.Ticks(300);
  EXPECT_EQ(drive.loop().map_from_odom().status(), MapStatus::kRejecting);
  const Vec2 kept = drive.loop().goal_odom();
  EXPECT_NEAR(std::hypot(kept.x_m - before.x_m, kept.y_m - before.y_m), 0.0, 0.3);
  drive.Ticks(700);
  EXPECT_EQ(drive.loop().map_from_odom().counters().relocations, 1u);
  const Vec2 moved = drive.loop().goal_odom();
  const double way_m = std::hypot(moved.x_m - kept.x_m, moved.y_m - kept.y_m);
  EXPECT_GT(way_m, 0.5);
  EXPECT_LT(way_m, 7.0 * 0.2 + 0.3);
}

// SR-DET06
TEST(VehicleLoopInputs, DecidesTheSameInWhateverMemoryItIsMade) {
  uint64_t hash[2] = {};
  for (int i = 0; i < 2; ++i) {
    ClosedLoop drive("at 0 box 8 0 1.5 1.5", sim::LaneWorld(), i == 0 ? 0x00 : 0xff);
    drive.DriveTo(14.0f, 0.0f);
    drive.Ticks(300);
    ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
    drive.Ticks(50);
    hash[i] = drive.loop().decision_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

// A lidar that starts anew in standby is taken as it is then; two that send by turns are not taken
// for one that starts anew with every packet.
// SR-INP01
TEST(VehicleLoopInputs, ALidarStartsAnewOnceInATick) {
  ClosedLoop drive("", sim::LaneWorld(), 0xa5, sim::LidarProfile::kRng19);  // it tells its start
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.mode() == Mode::kStandby; }));
  std::vector<uint8_t> newest;
  drive.adds = [&](std::vector<TickDatagram>& datagrams) {
    for (const TickDatagram& datagram : datagrams) {
      if (datagram.source != InputSource::kLidar) continue;
      newest.assign(datagram.bytes.begin(), datagram.bytes.end());
    }
  };
  drive.Ticks(20);
  const std::vector<uint8_t> first = newest;
  drive.Act("at 0 lidar-restart");
  drive.Ticks(20);
  const std::vector<uint8_t> second = newest;
  drive.Act("at 0 lidar-restart");
  drive.Ticks(20);
  ASSERT_EQ(drive.loop().counters().lidar_restarts, 2u);
  drive.adds = [&](std::vector<TickDatagram>& datagrams) {
    datagrams.push_back({InputSource::kLidar, first});
    datagrams.push_back({InputSource::kLidar, second});
  };
  for (uint64_t tick = 1; tick <= 3; ++tick) {
    drive.Ticks(1);
    EXPECT_EQ(drive.loop().counters().lidar_restarts, 2u + tick);
  }
}

// SR-DET06
TEST(VehicleLoopInputs, ConfiguredAnewItIsAsNew) {
  uint64_t hash[2] = {};
  ClosedLoop used;
  used.DriveTo(14.0f, 0.0f);
  for (int i = 0; i < 2; ++i) {
    ClosedLoop drive;
    if (i == 1) {
      // What has driven, in the place of what is new.
      std::memcpy(static_cast<void*>(&drive.loop()), &used.loop(), sizeof(VehicleLoop));
      ASSERT_EQ(drive.loop().Configure(drive.config()), Status::kOk);
    }
    drive.DriveTo(14.0f, 0.0f);
    drive.Ticks(100);
    hash[i] = drive.loop().decision_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

}  // namespace
}  // namespace hardpack
