// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "hal/labels/labels.h"
#include "hal/ouster/ouster.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// What is looked after besides planning, in the closed loop.

namespace hardpack {
namespace {

using control::Kind;
using testing::ClosedLoop;

std::string BoxAt(double x_m, double y_m, double size_m, double height_m) {
  return "at 0 box " + std::to_string(x_m) + " " + std::to_string(y_m) + " " +
         std::to_string(size_m) + " " + std::to_string(height_m);
}

bool IsCommandedToMove(ClosedLoop& drive) {
  const WheelCommand told = drive.loop().drives().commanded();
  return told.left_radps != 0.0f || told.right_radps != 0.0f;
}

//   [>] ------->      |wall|
// It brakes in the tick of the first return, long before a plan knows.
// SR-COR01
TEST(VehicleLoopSafety, AWallThatAppearsBrakesInTheTickOfItsFirstReturn) {
  ClosedLoop drive;
  drive.DriveTo(40.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 3.0; }));
  const double x_m = drive.Pose().x_m + 6.5;
  drive.Act(BoxAt(x_m + 1.5, 0.0, 3.0, 1.5));
  const uint32_t plan = drive.loop().replanner().committed().number;
  ASSERT_TRUE(drive.Until(0.3, [&] { return drive.loop().corridor().has_obstacle(); }));
  EXPECT_EQ(drive.loop().replanner().committed().number, plan);
  EXPECT_EQ(drive.mode(), Mode::kDriving);
  EXPECT_EQ(drive.reason(), StopReason::kObstacle);
  EXPECT_NE(drive.loop().permission().motion, Motion::kFollow);
  ASSERT_TRUE(drive.Until(30.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_FALSE(drive.vehicle().collided());
  EXPECT_NEAR(drive.Pose().x_m, 40.0, 0.7);
}

// SR-COR01
TEST(VehicleLoopSafety, SomethingAtOneMetreIsZeroAtOnce) {
  ClosedLoop drive;
  drive.DriveTo(40.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  // Its near side is 1 m ahead of the front.
  drive.Act(BoxAt(drive.Pose().x_m + 0.76 + 1.0 + 0.25, 0.0, 0.5, 1.7));
  ASSERT_TRUE(drive.Until(0.3, [&] { return drive.loop().corridor().has_obstacle(); }));
  EXPECT_EQ(drive.loop().permission().motion, Motion::kZero);
  EXPECT_FALSE(IsCommandedToMove(drive));
  ASSERT_TRUE(
      drive.Until(5.0, [&] { return std::fabs(drive.Speed_mps()) <= Replanner::kStanding_mps; }));
}

// Beside the way and behind the vehicle nothing brakes.
TEST(VehicleLoopSafety, WhatStandsBesideTheWayOrBehindDoesNotBrake) {
  ClosedLoop drive;
  drive.DriveTo(30.0f, 0.0f);
  drive.Act(BoxAt(drive.Pose().x_m + 8.0, 2.6, 1.0, 1.5));
  drive.Act(BoxAt(drive.Pose().x_m - 4.0, 0.0, 1.0, 1.5));
  drive.Act("at 0 lidar-duplicate on");  // and everything comes twice
  bool has_braked = false;
  ASSERT_TRUE(drive.Until(30.0, [&] {
    has_braked = has_braked || drive.reason() == StopReason::kObstacle;
    return drive.mode() == Mode::kArmed;
  }));
  EXPECT_FALSE(has_braked);
  EXPECT_NEAR(drive.Pose().x_m, 30.0, 0.7);
}

//   ____________
//  |            |
//  |  [>]       |        goal
//  |____________|
// A room around it, and then it is gone.
// SR-PLN02, SR-SUP11
TEST(VehicleLoopSafety, SaysThatThereIsNoWayAndGoesOnWhenThereIsOne) {
  ClosedLoop drive;
  drive.DriveTo(40.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Pose().x_m > 3.0; }));
  const world::World before = drive.vehicle().world();
  const double x_m = drive.Pose().x_m;
  for (double y_m = -7.0; y_m <= 7.0; y_m += 1.0) {
    drive.Act(BoxAt(x_m + 9.5, y_m, 1.0, 1.5));
    drive.Act(BoxAt(x_m - 7.0, y_m, 1.0, 1.5));
  }
  for (double along_m = -7.0; along_m <= 10.0; along_m += 1.0) {
    drive.Act(BoxAt(x_m + along_m, 7.0, 1.0, 1.5));
    drive.Act(BoxAt(x_m + along_m, -7.0, 1.0, 1.5));
  }
  ASSERT_TRUE(drive.Until(15.0, [&] {
    return std::fabs(drive.Speed_mps()) < 0.01 && drive.reason() == StopReason::kNoWay;
  })) << static_cast<int>(drive.reason());
  EXPECT_EQ(drive.mode(), Mode::kDriving);
  EXPECT_FALSE(drive.vehicle().collided());
  EXPECT_EQ(drive.loop().goals(), 1);
  const uint64_t since_ns = drive.loop().permission().reason_since_ns;
  drive.Ticks(100);
  EXPECT_EQ(drive.reason(), StopReason::kNoWay);
  EXPECT_EQ(drive.loop().permission().reason_since_ns, since_ns);
  EXPECT_FALSE(IsCommandedToMove(drive));
  drive.vehicle().world() = before;
  ASSERT_TRUE(drive.Until(60.0, [&] { return drive.mode() == Mode::kArmed; }))
      << static_cast<int>(drive.reason());
  EXPECT_NEAR(drive.Pose().x_m, 40.0, 0.7);
  EXPECT_FALSE(drive.vehicle().collided());
}

// SR-SUP11
TEST(VehicleLoopSafety, SaysThatTheGoalLiesInAnObstacle) {
  ClosedLoop drive("at 0 box 14 0 1 1.5");
  VehicleConfig config = drive.config();
  config.planner.astar.move_goal_out_of_obstacle = 0;
  ASSERT_EQ(drive.loop().Configure(config), Status::kOk);
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(13.6f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.reason() == StopReason::kGoalInObstacle; }))
      << static_cast<int>(drive.reason());
  EXPECT_FALSE(drive.vehicle().collided());
}

// SR-CMD04
TEST(VehicleLoopSafety, AVehicleThatIsToldToMoveAndDoesNotIsAFault) {
  ClosedLoop drive;
  drive.DriveTo(40.0f, 0.0f);
  drive.Act("at 0 blocked both on");
  ASSERT_TRUE(drive.Until(15.0, [&] { return drive.mode() == Mode::kFault; }));
  EXPECT_EQ(drive.reason(), StopReason::kStuck);
  EXPECT_FALSE(IsCommandedToMove(drive));
  ASSERT_TRUE(drive.Until(5.0, [&] { return !drive.loop().drives().enabled(); }));
  drive.Act("at 0 blocked both off");
  ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  EXPECT_EQ(drive.mode(), Mode::kStandby);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Say(Kind::kArm) == Status::kOk; }));
}

// SR-STP05: wheels that spin while the vehicle stands: told and stopped within 1.3 s, by the INS.
TEST(VehicleLoopSafety, WheelsThatSpinInPlaceAreAFault) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 3.0; }));
  drive.Act("at 0 traction 0");
  ASSERT_TRUE(drive.Until(1.3, [&] { return drive.mode() == Mode::kFault; }));
  EXPECT_EQ(drive.reason(), StopReason::kWheelSpin);
  EXPECT_FALSE(IsCommandedToMove(drive));
  drive.Act("at 0 traction 1000");
  ASSERT_TRUE(drive.Until(5.0, [&] { return !drive.loop().drives().enabled(); }));
  ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Say(Kind::kArm) == Status::kOk; }));
}

// SR-TIM01: a lidar whose delay grows by 12 ms in a second. Data 0.9 s old were taken for 0.03 s
// old; now their age is what it is, and the vehicle stops before the box that appears meanwhile.
TEST(VehicleLoopSafety, ALidarDelayThatGrowsStopsTheVehicle) {
  ClosedLoop drive("", world::World());
  drive.DriveTo(90.0f, 0.0f);
  drive.Act("at 0 lidar-delay-growth 12");
  double worst_s = 0.0;
  ASSERT_TRUE(drive.Until(40.0, [&] {
    const double told_s = 1.0e-9 * static_cast<double>(drive.now_ns() - drive.loop().lidar_ns());
    const double delay_s = drive.vehicle().faults(sim::Sensor::kLidar).delay_s;
    worst_s = std::max(worst_s, delay_s - told_s);
    if (drive.mode() == Mode::kArmed) static_cast<void>(drive.Goal(90.0f, 0.0f));
    return drive.mode() == Mode::kSafeStop;
  }));
  EXPECT_EQ(drive.reason(), StopReason::kLidarOld);
  EXPECT_LT(worst_s, 0.05);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.mode() == Mode::kArmed; }));
  drive.Act("at 0 box " + std::to_string(drive.Pose().x_m + 6.0) + " 0 2 1.5");
  ASSERT_EQ(drive.Goal(20.0f, 0.0f, control::GoalFrame::kBody), Status::kOk);
  drive.Ticks(500);
  EXPECT_EQ(drive.reason(), StopReason::kLidarOld);
  EXPECT_FALSE(drive.vehicle().collided());
}

// SR-TIM01: the same of the INS: no yaw rate of a second ago steers the vehicle.
TEST(VehicleLoopSafety, AnInsDelayThatGrowsStopsTheVehicle) {
  ClosedLoop drive("", world::World());
  drive.DriveTo(90.0f, 0.0f);
  drive.Act("at 0 ins-delay-growth 12");
  ASSERT_TRUE(drive.Until(40.0, [&] {
    if (drive.mode() == Mode::kArmed) static_cast<void>(drive.Goal(90.0f, 0.0f));
    return drive.mode() == Mode::kSafeStop;
  }));
  EXPECT_EQ(drive.reason(), StopReason::kInsOld);
  EXPECT_LT(drive.vehicle().faults(sim::Sensor::kIns).delay_s, 0.3);
}

// SR-TIM03: the bus carries 80 frames a tick, the program takes 60: a backlog grows, and what it
// takes is older and older. Reports of 0.4 s ago were taken for new; now they are dropped by their
// stamps, and the vehicle stops while they are not yet 0.2 s old.
TEST(VehicleLoopSafety, ABacklogOfCanFramesIsNotTakenForNew) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  std::deque<CanFrame> waiting;
  uint64_t oldest_taken_ns = 0;
  drive.carries = [&](std::vector<CanFrame>& frames, uint64_t now_ns) {
    constexpr size_t kCarried = 80;
    constexpr size_t kTaken = 60;
    CanFrame other;
    other.id = 0x555;
    while (frames.size() < kCarried) frames.insert(frames.begin(), other);
    for (CanFrame& frame : frames) {
      frame.received_ns = now_ns - 1'000'000;
      waiting.push_back(frame);
    }
    frames.assign(waiting.begin(), waiting.begin() + kTaken);
    waiting.erase(waiting.begin(), waiting.begin() + kTaken);
    oldest_taken_ns = now_ns - frames.front().received_ns;
  };
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() != Mode::kDriving; }));
  EXPECT_TRUE(drive.mode() == Mode::kFault || drive.mode() == Mode::kSafeStop);
  EXPECT_LT(oldest_taken_ns, 250'000'000u);
  ASSERT_TRUE(drive.Until(1.0, [&] { return drive.mode() == Mode::kFault; }));
  EXPECT_EQ(drive.reason(), StopReason::kDrives);
  ASSERT_TRUE(drive.Until(5.0, [&] { return std::fabs(drive.Speed_mps()) < 0.01; }));
  EXPECT_GT(drive.loop().drives().counters().frames_old, 100u);
}

// SR-STP04: somebody stops a drive by NMT while the vehicle drives. It stops; and once the operator
// arms anew, the drive is brought back without a power cycle.
TEST(VehicleLoopSafety, ADriveThatWasStoppedByNmtIsBroughtBackByArming) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.Act("at 0 can-frame 000#0203");
  ASSERT_TRUE(drive.Until(1.0, [&] { return drive.mode() == Mode::kFault; }));
  ASSERT_TRUE(drive.Until(8.0, [&] { return std::fabs(drive.Speed_mps()) < 0.01; }));
  drive.Ticks(300);
  EXPECT_EQ(drive.vehicle().vehicle().drive(sim::Side::kRight).nmt_state(),
            sim::NmtState::kStopped);
  ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  int asked = 0;
  ASSERT_TRUE(drive.Until(20.0, [&] {
    if (asked++ % 200 == 0) return drive.Say(Kind::kArm) == Status::kOk;
    return false;
  }));
  EXPECT_LE(asked, 401);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.loop().drives().enabled(); }));
  ASSERT_EQ(drive.Goal(5.0f, 0.0f, control::GoalFrame::kBody), Status::kOk);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 1.0; }));
}

// SR-CMD04
TEST(VehicleLoopSafety, WheelsThatTurnUnaskedAreAFault) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  // 3 m/s, as the drives report it.
  const double motor_rpm =
      3.0 / (0.3 * 0.962) * 60.0 / (2.0 * M_PI) * double{drive.config().onboard.drive.gear_ratio};
  drive.Act("at 0 speed-offset both " + std::to_string(static_cast<int>(motor_rpm)));
  ASSERT_TRUE(drive.Until(3.0, [&] { return drive.mode() == Mode::kFault; }));
  EXPECT_EQ(drive.reason(), StopReason::kRunaway);
}

// Wheels that report 300 m/s are taken for wheels that report nothing: the odometry does not jump,
// the vehicle stops, and can be sent on.
// SR-INP04
TEST(VehicleLoopSafety, DrivesAgainAfterWheelSpeedsThatNoVehicleHas) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  const double motor_rpm =
      300.0 / (0.3 * 0.962) * 60.0 / (2.0 * M_PI) * double{drive.config().onboard.drive.gear_ratio};
  drive.Act("at 0 speed-offset both " + std::to_string(static_cast<int>(motor_rpm)));
  ASSERT_TRUE(drive.Until(0.2, [&] { return drive.mode() == Mode::kSafeStop; }));
  EXPECT_EQ(drive.reason(), StopReason::kOdometryOld);
  drive.Ticks(50);
  EXPECT_NEAR(drive.loop().odometry().pose().position.x_m, drive.Pose().x_m, 1.0);
  drive.Act("at 0 speed-offset both 0");
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_EQ(drive.loop().goals(), 0);
  ASSERT_EQ(drive.Goal(10.0f, 0.0f, control::GoalFrame::kBody), Status::kOk);
  const double x_m = drive.Pose().x_m;
  ASSERT_TRUE(drive.Until(30.0, [&] { return drive.Pose().x_m > x_m + 8.0; }))
      << static_cast<int>(drive.reason());
}

// Of every tick of a whole drive: nothing but zero unless the mode permits it, and nothing beyond
// the limits.
// SR-CMD01
TEST(VehicleLoopSafety, NothingButZeroLeavesUnlessTheModePermits) {
  ClosedLoop drive;
  WheelCommand before;
  int moved = 0;
  const auto judge = [&] {
    const WheelCommand told = drive.loop().drives().commanded();
    const Mode mode = drive.mode();
    const bool is_zero = told.left_radps == 0.0f && told.right_radps == 0.0f;
    EXPECT_TRUE(is_zero || mode == Mode::kDriving || mode == Mode::kSafeStop);
    if (!is_zero) {
      ++moved;
      EXPECT_LE(std::fabs(told.left_radps - before.left_radps), 2.001f);
      EXPECT_LE(std::fabs(told.right_radps - before.right_radps), 2.001f);
    }
    before = told;
    return false;
  };
  drive.Until(1.0, judge);
  drive.BringUpAndArm();
  drive.Until(0.5, judge);
  ASSERT_EQ(drive.Goal(12.0f, 3.0f), Status::kOk);
  drive.Until(4.0, judge);
  ASSERT_EQ(drive.Say(Kind::kStop), Status::kOk);
  drive.Until(4.0, judge);
  ASSERT_EQ(drive.Goal(12.0f, 3.0f), Status::kOk);
  drive.Until(3.0, judge);
  ASSERT_EQ(drive.Say(Kind::kEmergencyStop), Status::kOk);
  drive.Until(3.0, judge);
  EXPECT_GT(moved, 200);
  EXPECT_EQ(drive.loop().gate().counters().not_finite, 0u);
  EXPECT_EQ(drive.loop().gate().counters().above_change, 0u);
}

// Around the place where a map begins the ground counts as observed, and nobody has seen it: who
// arms the vehicle says that it is clear. A map that begins anew, behind a gap, is not driven on
// before it was armed there.
// SR-STA03
TEST(VehicleLoopSafety, AMapThatBeginsAnewIsNotDrivenOnBeforeSomebodyHasArmedItThere) {
  for (const bool drives_before : {false, true}) {
    for (const int missed : {21, 25, 100}) {
      ClosedLoop drive;
      drive.BringUpAndArm();
      if (drives_before) {
        ASSERT_EQ(drive.Goal(60.0f, 0.0f), Status::kOk);
        ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 1.0; }));
      }
      drive.Miss(missed);
      ASSERT_TRUE(drive.Until(2.0, [&] { return drive.loop().counters().odometry_gaps == 1; }));
      ASSERT_TRUE(drive.Until(8.0, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }));
      const Vec3 here = drive.loop().odometry().pose().position;
      static_cast<void>(drive.Goal(here.x_m + 20.0f, here.y_m));
      drive.Ticks(300);
      EXPECT_LT(std::fabs(drive.Speed_mps()), 0.02) << missed << ' ' << drives_before;
      EXPECT_NE(drive.mode(), Mode::kDriving);
      static_cast<void>(drive.Say(Kind::kDisarm));
      for (int tries = 0; tries < 5 && drive.Say(Kind::kArm) != Status::kOk; ++tries) {
        drive.Ticks(200);
      }
      ASSERT_TRUE(drive.Until(5.0, [&] { return drive.loop().drives().enabled(); }))
          << static_cast<int>(drive.mode()) << ' ' << static_cast<int>(drive.reason());
      const Vec3 armed = drive.loop().odometry().pose().position;
      ASSERT_EQ(drive.Goal(armed.x_m + 20.0f, armed.y_m), Status::kOk);
      EXPECT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 1.0; }));
    }
  }
}

//  [>]==????????-------
// Nobody has told it of the ground in the lidar's blind cone.
// SR-SPD02
TEST(VehicleLoopSafety, StopsAtTheEndOfTheObservedGroundAndSaysSo) {
  ClosedLoop drive;
  VehicleConfig config = drive.config();
  config.perception.mapping.start_ground_radius_m = 2.0f;
  ASSERT_EQ(drive.loop().Configure(config), Status::kOk);
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(30.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(30.0, [&] {
    return drive.reason() == StopReason::kUnseenGround && std::fabs(drive.Speed_mps()) < 0.02;
  })) << static_cast<int>(drive.reason());
  EXPECT_GT(drive.Pose().x_m, 0.3);
  EXPECT_LT(drive.Pose().x_m + 0.76 + config.planner.speed.unseen_margin_m, 2.2);
  EXPECT_EQ(drive.mode(), Mode::kDriving);
  const double x_m = drive.Pose().x_m;
  drive.Ticks(300);
  EXPECT_NEAR(drive.Pose().x_m, x_m, 0.1);
  EXPECT_EQ(drive.reason(), StopReason::kUnseenGround);
}

// Says as a segmentation computer would, a tick late, what the lidar sees in a level world: what
// ends before the ground is a person.
class PeopleLabels {
 public:
  explicit PeopleLabels(const VehicleConfig& config) : lidar_(config.lidar) {}

  // What it said of the packets before goes with those of this tick.
  void Exchange(std::vector<TickDatagram>& datagrams) {
    sent_.swap(next_);
    next_.clear();
    for (const TickDatagram& datagram : datagrams) {
      if (datagram.source == InputSource::kLidar) Look(datagram.bytes);
    }
    for (const std::vector<uint8_t>& datagram : sent_) {
      datagrams.push_back({InputSource::kLabels, datagram});
    }
  }

 private:
  void Look(std::span<const uint8_t> packet) {
    ouster::PacketLayout layout;
    ASSERT_TRUE(IsUsable(ouster::MakeLayout(lidar_, layout)));
    labels::Header header;
    header.beams = static_cast<uint8_t>(lidar_.beams);
    header.columns = static_cast<uint16_t>(layout.columns_per_packet);
    std::vector<uint8_t> codes;
    for (int i = 0; i < layout.columns_per_packet; ++i) {
      ASSERT_TRUE(IsUsable(ouster::DecodeColumn(layout, packet, i, column_)));
      if (i == 0) header.frame_id = column_.frame_id;
      if (i == 0) header.first_measurement = column_.measurement_id;
      for (int row = 0; row < lidar_.beams; ++row) codes.push_back(CodeOf(row));
    }
    std::vector<uint8_t> datagram(labels::kMaxDatagramBytes);
    int size_bytes = 0;
    ASSERT_EQ(labels::Encode(header, codes, datagram, size_bytes), Status::kOk);
    datagram.resize(static_cast<size_t>(size_bytes));
    next_.push_back(datagram);
  }
  uint8_t CodeOf(int row) const {
    constexpr uint8_t kGrass = 3;
    constexpr uint8_t kPerson = 17;
    const double range_m = column_.range_mm[row] * 1e-3;
    const double height_m =
        1.284 + range_m * std::sin(double{lidar_.beam_altitude_deg[row]} * M_PI / 180.0);
    return height_m > 0.3 ? kPerson : kGrass;
  }

  ouster::Metadata lidar_;
  LidarColumn column_;
  std::vector<std::vector<uint8_t>> sent_;
  std::vector<std::vector<uint8_t>> next_;
};

// An empty world, in which whatever comes to stand is labelled a person.
struct AmongPeople {
  ClosedLoop drive;
  PeopleLabels people{drive.config()};

  explicit AmongPeople(world::World world = world::World()) : drive("", std::move(world)) {
    VehicleConfig config = drive.config();
    config.perception.mapping.use_labels = 1;
    EXPECT_EQ(drive.loop().Configure(config), Status::kOk);
    drive.adds = [this](std::vector<TickDatagram>& datagrams) { people.Exchange(datagrams); };
  }
};

//      P           the way is free, and somebody stands within reach of the vehicle: it does not
//   [>] ------->   set out until they have been away for 2 s
// SR-MOV05
TEST(VehicleLoopSafety, DoesNotSetOutWhileSomebodyStandsBesideIt) {
  AmongPeople among;
  ClosedLoop& drive = among.drive;
  drive.BringUpAndArm();
  drive.Act(BoxAt(-0.2, 1.3, 0.3, 1.7));
  drive.Ticks(30);
  ASSERT_EQ(drive.Goal(25.0f, 0.0f), Status::kOk);
  double fastest_mps = 0.0;
  drive.Until(4.0, [&] {
    fastest_mps = std::max(fastest_mps, std::fabs(drive.Speed_mps()));
    return false;
  });
  EXPECT_LT(fastest_mps, 0.05);
  drive.vehicle().world() = world::World();
  EXPECT_FALSE(drive.Until(1.8, [&] { return drive.Speed_mps() > 0.05; })) << "for a while yet";
  EXPECT_TRUE(drive.Until(3.0, [&] { return drive.Speed_mps() > 0.5; }));
}

//   [>]  |   somebody walks past right before the vehicle, where their legs are below the lowest
//   beam
// SR-PER11
TEST(VehicleLoopSafety, NothingStaysOfSomebodyWhoWalkedPast) {
  world::World world;
  world::Person person;
  person.places = {{12.0, 2.6, -6.0}, {21.0, 2.6, 6.0}};
  world.AddPerson(person);
  AmongPeople among(std::move(world));
  ClosedLoop& drive = among.drive;
  const auto hard_cells = [&] {
    int cells = 0;
    for (float x_m = 1.7f; x_m < 3.6f; x_m += 0.2f) {
      for (float y_m = -3.0f; y_m < 3.0f; y_m += 0.2f) {
        const HeightGrid& heights = drive.loop().mapper().heights();
        if (heights.At(CellAt({x_m, y_m})).highest_hard_cm != HeightGrid::kNone) ++cells;
      }
    }
    return cells;
  };
  drive.BringUpAndArm();
  int most = 0;
  drive.Until(26.0, [&] {
    most = std::max(most, hard_cells());
    return false;
  });
  EXPECT_GT(most, 10);
  EXPECT_EQ(hard_cells(), 0);
}

//   [>] ------------------- P    as far away as they may walk towards it while it stops, people are
//   planned for
// SR-SPD03
TEST(VehicleLoopSafety, PlansForPeopleAsFarAsTheyMatter) {
  AmongPeople among;
  ClosedLoop& drive = among.drive;
  drive.BringUpAndArm();
  drive.Act(BoxAt(18.5, 0.0, 0.5, 1.7));
  drive.Ticks(100);
  ASSERT_EQ(drive.Goal(30.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(2.0, [&] { return drive.loop().replanner().committed().number > 0; }));
  drive.Ticks(5);
  const CommittedPlan& plan = drive.loop().replanner().committed();
  float slowest_mps = 10.0f;
  for (int k = 0; k < plan.path.size(); ++k) {
    const bool is_before = plan.path[k].x_m > 13.0f && plan.path[k].x_m < 17.0f;
    if (is_before) slowest_mps = std::min(slowest_mps, plan.speed[k]);
  }
  EXPECT_LE(slowest_mps, drive.config().planner.speed.person_creep_mps + 0.01f);
}

//                P   without labels: who stands is an obstacle, who walks is a person, also while
//   [>]          |   they stand afterwards, and nothing sets out beside them
// SR-PER13
TEST(VehicleLoopSafety, WhoWalksIsAPersonWithoutLabels) {
  world::World world;
  world::Person person;
  person.places = {{0.0, 1.5, -6.0}, {16.0, 1.5, -6.0}, {22.0, 1.5, -1.0}};
  world.AddPerson(person);
  ClosedLoop drive("", std::move(world));
  const auto has_person = [&] {
    for (float y_m = -6.7f; y_m < 1.0f; y_m += 0.2f) {
      for (float x_m = 0.9f; x_m < 2.1f; x_m += 0.2f) {
        if (drive.loop().mapper().heights().At(CellAt({x_m, y_m})).person) return true;
      }
    }
    return false;
  };
  const uint64_t start_ns = drive.now_ns();
  const auto until = [&](double time_s, auto&& happens) {
    return drive.Until(time_s - 1e-9 * static_cast<double>(drive.now_ns() - start_ns), happens);
  };
  drive.BringUpAndArm();
  EXPECT_FALSE(until(15.0, has_person)) << "who stands";
  EXPECT_TRUE(until(18.0, has_person)) << "who walks";
  until(23.0, [] { return false; });
  ASSERT_EQ(drive.Goal(25.0f, 0.0f), Status::kOk);
  double fastest_mps = 0.0;
  drive.Until(4.0, [&] {
    fastest_mps = std::max(fastest_mps, std::fabs(drive.Speed_mps()));
    return false;
  });
  EXPECT_LT(fastest_mps, 0.05) << "somebody stands beside it";
  EXPECT_TRUE(has_person());
}

//   [>] ------->   P
// Where the map has just begun it turns off beside the person once it stands, and creeps by; on the
// way it stands for as long as the person does.
// SR-SPD03
TEST(VehicleLoopSafety, StopsForAPersonAndGoesOnWhenTheWayIsFree) {
  for (const double from_m : {0.0, 5.0}) {
    SCOPED_TRACE(from_m);
    AmongPeople among;
    ClosedLoop& drive = among.drive;
    drive.DriveTo(25.0f, 0.0f);
    ASSERT_TRUE(
        drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0 && drive.Pose().x_m > from_m; }));
    const double x_m = drive.Pose().x_m + 5.0;
    drive.Act(BoxAt(x_m, 0.0, 0.5, 1.7));
    ASSERT_TRUE(drive.Until(0.4, [&] { return drive.reason() == StopReason::kPerson; }))
        << static_cast<int>(drive.reason());
    EXPECT_TRUE(drive.loop().corridor().is_person());
    ASSERT_TRUE(
        drive.Until(0.1, [&] { return drive.loop().permission().motion == Motion::kZero; }));
    EXPECT_EQ(drive.reason(), StopReason::kPerson);
    ASSERT_TRUE(
        drive.Until(8.0, [&] { return std::fabs(drive.Speed_mps()) <= Replanner::kStanding_mps; }));
    EXPECT_EQ(drive.reason(), StopReason::kPerson);
    EXPECT_LT(drive.Pose().x_m, x_m - 1.5);
    double fastest_mps = 0.0;
    drive.Until(3.0, [&] {
      fastest_mps = std::max(fastest_mps, std::fabs(drive.Speed_mps()));
      return false;
    });
    EXPECT_LT(drive.Pose().x_m, x_m - 1.0);
    EXPECT_LT(fastest_mps, 0.25);
    if (from_m > 0.0) {
      EXPECT_EQ(drive.reason(), StopReason::kPerson);
    }
    EXPECT_FALSE(drive.vehicle().collided());
    drive.vehicle().world() = world::World();
    ASSERT_TRUE(drive.Until(60.0, [&] { return drive.mode() == Mode::kArmed; }))
        << static_cast<int>(drive.reason());
    EXPECT_NEAR(drive.Pose().x_m, 25.0, 0.7);
  }
}

// It would brake for what plans are free to pass.
// SR-CFG02
TEST(VehicleLoopSafety, RefusesACorridorWiderThanWhatPlansAreCheckedFor) {
  ClosedLoop drive;
  VehicleConfig config = drive.config();
  config.onboard.safety.corridor_margin_m = 0.2f;
  EXPECT_EQ(drive.loop().Configure(config), Status::kParameterOutOfRange);
  config.onboard.safety.corridor_margin_m = 0.0f;
  EXPECT_EQ(drive.loop().Configure(config), Status::kOk);
}

TEST(VehicleLoopSafety, MeasuresItsReactionWhileItDrives) {
  ClosedLoop drive;
  drive.DriveTo(20.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  const ReactionMeter& reaction = drive.loop().reaction();
  EXPECT_GT(reaction.columns(), 2000u);
  EXPECT_EQ(reaction.lost(), 0u);
  EXPECT_GT(reaction.Time_s(0.5f), 0.01f);
  EXPECT_LT(reaction.Time_s(0.99f), 1.0f);
  EXPECT_LT(reaction.Radius_m(0.99f), 3.0f);
  RecordProperty("median_ms", static_cast<int>(1000.0f * reaction.Time_s(0.5f)));
  RecordProperty("p99_ms", static_cast<int>(1000.0f * reaction.Time_s(0.99f)));
}

}  // namespace
}  // namespace hardpack
