// SPDX-License-Identifier: Apache-2.0
#include "test/hal/sevcon/bench.h"

// One thing goes wrong while both drives drive. In each case: zero to both in the tick that sees
// it, both disabled after standstill, the fault stays until it is reset, and then they drive again.

namespace hardpack::sevcon {
namespace {

constexpr DriveDemand kReset = {false, true, {}};

class DrivingFault : public ::testing::Test {
 protected:
  void SetUp() override {
    bench.left.SetUp();
    bench.right.SetUp();
    ASSERT_TRUE(bench.BringUp());
    ASSERT_TRUE(bench.Drive(3.0f, 3.0f));
    bench.Run(20, Bench::Wheels(3.0f, 3.0f));
  }

  // Drives on until the left drive has the fault.
  void ExpectFault(DriveFault fault, int max_ticks) {
    int ticks = 0;
    while (bench.FaultOf(Side::kLeft) == DriveFault::kNone && ticks < max_ticks) {
      bench.Tick(Bench::Wheels(3.0f, 3.0f));
      ++ticks;
    }
    EXPECT_EQ(bench.FaultOf(Side::kLeft), fault) << ticks;
    EXPECT_TRUE(bench.ZeroWentToBoth());
    EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kFault);
    EXPECT_FALSE(bench.pair.ready());
    EXPECT_FALSE(bench.pair.enabled());
    EXPECT_EQ(bench.pair.commanded().left_radps, 0.0f);
    EXPECT_EQ(bench.pair.commanded().right_radps, 0.0f);
  }
  // Whatever is asked for.
  void ExpectStop() {
    bench.history.clear();
    EXPECT_TRUE(bench.RunUntil([&] { return !bench.right.enabled; }, Bench::Wheels(3.0f, 3.0f)));
    EXPECT_EQ(bench.right.speed_rpm, 0);
    bench.Run(100, Bench::Wheels(3.0f, 3.0f));
    EXPECT_NE(bench.FaultOf(Side::kLeft), DriveFault::kNone);
    EXPECT_FALSE(bench.right.enabled);
  }
  void ExpectDrivingAgain() {
    bench.Run(300);
    EXPECT_FALSE(bench.pair.ready());
    bench.Tick(kReset);
    EXPECT_TRUE(bench.BringUp());
    EXPECT_TRUE(bench.Drive(3.0f, 3.0f));
  }

  Bench bench;
};

// SR-DRV01
TEST_F(DrivingFault, SilentDrive) {
  bench.left.powered = false;
  ExpectFault(DriveFault::kSilent, 15);  // feedback_timeout_ms
  EXPECT_EQ(bench.pair.health(), Status::kTimedOut);
  EXPECT_FALSE(bench.pair.feedback(bench.now_ns).valid);
  EXPECT_FALSE(bench.pair.standstill());
  ExpectStop();
  bench.left.powered = true;
  bench.left.Reboot(false);
  ExpectDrivingAgain();
}

// SR-DRV01
TEST_F(DrivingFault, MissedHeartbeat) {
  bench.left.no_heartbeat = true;
  ExpectFault(DriveFault::kSilent, 45);  // heartbeat_timeout_ms after the last
  EXPECT_EQ(bench.pair.report(Side::kLeft).heartbeats_missed, 1u);
  ExpectStop();
  bench.left.no_heartbeat = false;
  ExpectDrivingAgain();
}

// SR-DRV01
TEST_F(DrivingFault, MissedProcessData) {
  bench.left.no_reports = true;
  ExpectFault(DriveFault::kSilent, 15);
  ExpectStop();
  bench.left.no_reports = false;
  ExpectDrivingAgain();
}

// It is not heard, but hears: it gets zero until it must have stopped, and is disabled then.
// SR-DRV01
TEST_F(DrivingFault, MissedProcessDataStopsTheDriveThatIsNotHeard) {
  bench.left.no_reports = true;
  ExpectFault(DriveFault::kSilent, 15);
  ASSERT_TRUE(bench.RunUntil([&] { return bench.left.speed_rpm == 0; }));
  EXPECT_TRUE(bench.left.enabled);
  ASSERT_TRUE(bench.RunUntil([&] { return !bench.left.enabled; }, {}, 1000));
}

// SR-DRV02
TEST_F(DrivingFault, Reboot) {
  bench.left.Reboot();
  ExpectFault(DriveFault::kRebooted, 1);
  EXPECT_EQ(bench.pair.report(Side::kLeft).reboots, 1u);
  // What it was enabled for is over: no word that would enable it again, should it be quick.
  EXPECT_EQ(ControlwordOf(*bench.CommandTo(Side::kLeft)), 0);
  bench.history.clear();
  bench.Run(10, Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.CountSent(0x202), 0);  // until its process data have been verified again
  ExpectStop();
  // The bring-up has begun again by itself.
  EXPECT_EQ(bench.left.nmt, 0x05);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kRebooted);
  ExpectDrivingAgain();
}

// SR-DRV02
TEST_F(DrivingFault, RebootWithoutAWord) {
  bench.left.Reboot(false);
  ExpectFault(DriveFault::kRebooted, 15);  // its heartbeat says that it is pre-operational
  ExpectStop();
  ExpectDrivingAgain();
}

// SR-DRV02
TEST_F(DrivingFault, StoppedByNmt) {
  CanFrame heartbeat;
  heartbeat.id = 0x702;
  heartbeat.size = 1;
  heartbeat.data[0] = 0x04;
  bench.foreign = {heartbeat};
  ExpectFault(DriveFault::kRebooted, 1);
}

// SR-STP04: a drive that somebody has stopped answers no question. It is left alone until the
// operator resets it; then it is made pre-operational, brought up, and drives.
TEST_F(DrivingFault, StoppedByNmtUntilTheOperatorResetsIt) {
  bench.left.nmt = 0x04;
  ExpectFault(DriveFault::kRebooted, 15);
  bench.Run(500);
  EXPECT_EQ(bench.left.nmt, 0x04);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kRebooted);
  bench.Tick(kReset);
  EXPECT_TRUE(bench.BringUp());
  EXPECT_EQ(bench.left.nmt, 0x05);
  EXPECT_TRUE(bench.Drive(3.0f, 3.0f));
}

// The same of drives that are found so: that is a fault, which arming resets.
// SR-STP04
TEST(NmtStop, OfBothDrivesBeforeTheStartIsUndoneByTheReset) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.nmt = 0x04;
  bench.right.nmt = 0x04;
  bench.Run(100);
  EXPECT_FALSE(bench.pair.ready());
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kRebooted);
  bench.Tick(kReset);
  EXPECT_TRUE(bench.BringUp());
  EXPECT_TRUE(bench.Drive(3.0f, 3.0f));
}

// One that stays stopped is told so; the next reset tries again.
// SR-STP04
TEST(NmtStop, ThatCannotBeUndoneIsAFault) {
  Bench bench = Bench::WithDrivesSetUp();
  const auto hold = [&bench](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      bench.left.nmt = 0x04;
      bench.Tick();
    }
  };
  hold(50);
  bench.Tick(kReset);
  hold(300);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStateRefused);
  bench.Tick(kReset);
  EXPECT_TRUE(bench.BringUp());
}

// SR-TIM03: what a drive said longer ago than max_frame_age_ms says nothing of now: it is counted,
// and the drive is silent.
TEST_F(DrivingFault, ReportsThatAreOldByTheirStampAreSilence) {
  bench.age_ns = 60'000'000;
  bench.Run(100, Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.pair.counters().frames_old, 0u);
  const uint64_t came_ns = bench.pair.report(Side::kLeft).wheel_time_ns;
  EXPECT_LE(came_ns + 60'000'000, bench.now_ns);  // as of when it came
  EXPECT_TRUE(bench.pair.enabled());
  bench.age_ns = 400'000'000;
  ExpectFault(DriveFault::kSilent, 15);
  EXPECT_GT(bench.pair.counters().frames_old, 0u);
  ExpectStop();
}

// An old EMCY or boot-up is no less true.
// SR-TIM03
TEST_F(DrivingFault, AnOldEmergencyIsTakenNevertheless) {
  bench.age_ns = 400'000'000;
  bench.left.SendEmergency(0x5000);
  ExpectFault(DriveFault::kEmergency, 1);
}

// SR-TIM04: two reports in a SYNC period are counted, and a fault within 0.25 s.
TEST_F(DrivingFault, ReportsOfTwoSenders) {
  bench.left.doubled = true;
  bench.Tick(Bench::Wheels(3.0f, 3.0f));
  ExpectFault(DriveFault::kDoubleReports, 25);
  EXPECT_GE(bench.pair.report(Side::kLeft).doubled_reports, 9u);
  EXPECT_EQ(bench.pair.report(Side::kRight).doubled_reports, 0u);
  ExpectStop();
  bench.left.doubled = false;
  ExpectDrivingAgain();
}

// Reports that come late, in the next period, are two in one and none in another.
// SR-TIM04
TEST_F(DrivingFault, NoneFromReportsThatComeAPeriodLate) {
  for (int i = 0; i < 100; ++i) {
    bench.left.no_reports = i % 2 == 0;
    bench.left.doubled = i % 2 != 0;
    bench.Run(2, Bench::Wheels(3.0f, 3.0f));
  }
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
}

// SR-DRV02
TEST_F(DrivingFault, EmergencyMessage) {
  bench.left.SendEmergency(0x3120);
  ExpectFault(DriveFault::kEmergency, 1);
  const DriveReport& report = bench.pair.report(Side::kLeft);
  EXPECT_EQ(report.emergency_code, 0x3120);
  EXPECT_EQ(report.emergency_register, 0x01);
  EXPECT_EQ(report.sevcon_fault_id, 0x45c3);
  EXPECT_EQ(report.emergencies, 1u);
  EXPECT_EQ(bench.pair.health(), Status::kDeviceFault);
  ExpectStop();
  ExpectDrivingAgain();
}

TEST_F(DrivingFault, NoneWhereAnEmergencyMessageSaysThatAllIsWell) {
  bench.left.SendEmergency(0);
  bench.Run(10, Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
  EXPECT_TRUE(bench.pair.enabled());
}

// SR-DRV02
TEST_F(DrivingFault, FaultBitOfTheStatusword) {
  bench.left.fault = true;
  bench.left.enabled = false;
  ExpectFault(DriveFault::kStatusFault, 4);
  ExpectStop();
  EXPECT_TRUE(bench.left.fault);  // not reset unasked
  ExpectDrivingAgain();
  EXPECT_FALSE(bench.left.fault);
}

TEST_F(DrivingFault, ThatCannotBeResetStays) {
  bench.left.fault = true;
  bench.left.fault_can_be_reset = false;
  ExpectFault(DriveFault::kStatusFault, 4);
  bench.Run(300);
  bench.Tick(kReset);
  bench.Run(50);
  EXPECT_FALSE(bench.pair.ready());
  bench.Run(100);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStatusFault);
}

TEST_F(DrivingFault, IsResetOnceAnAttemptAndOnlyWhileNothingIsEnabled) {
  bench.left.fault = true;
  ExpectFault(DriveFault::kStatusFault, 4);
  bench.Run(300);
  bench.Run(100, {true, true, {3.0f, 3.0f}});
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStatusFault);
  EXPECT_TRUE(bench.left.fault);
  bench.Tick();
  bench.left.fault_can_be_reset = false;
  bench.Run(300, kReset);  // held: one attempt
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStatusFault);
  bench.left.fault_can_be_reset = true;
  bench.Run(100, kReset);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStatusFault);
  bench.Tick();
  bench.Tick(kReset);
  EXPECT_TRUE(bench.BringUp());
}

// SR-DRV02
TEST_F(DrivingFault, LostEnable) {
  bench.left.enabled = bench.left.switched_on = bench.left.ready = false;
  bench.left.refuses_enable = true;
  ExpectFault(DriveFault::kLostEnable, 4);
  ExpectStop();
  bench.left.refuses_enable = false;
  ExpectDrivingAgain();
}

// SR-DRV02
TEST_F(DrivingFault, OppositeMotion) {
  bench.left.runs_backward = true;
  ExpectFault(DriveFault::kOppositeMotion, 200);
  bench.left.runs_backward = false;
  ExpectStop();
  ExpectDrivingAgain();
}

// A wheel that is turned round turns against its command for a while: no fault.
TEST_F(DrivingFault, NoneWhileAWheelIsTurnedRoundSlowly) {
  bench.left.max_step_rpm = bench.right.max_step_rpm = 5;
  bench.Run(100, Bench::Wheels(3.0f, 3.0f));
  bench.Run(500, Bench::Wheels(-3.0f, -3.0f));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
  EXPECT_NEAR(bench.pair.feedback(bench.now_ns).left_radps, -3.0f, 0.01f);
}

TEST_F(DrivingFault, StuckWhileItIsToTurnRound) {
  bench.Run(100, Bench::Wheels(3.0f, 3.0f));
  bench.left.stuck = true;
  bench.Run(100, Bench::Wheels(-3.0f, -3.0f));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kOppositeMotion);
}

// The inner wheel of a hard turn goes on forwards although it is told to turn back: the tyres hold
// it, not its motor. So it may for a while, but not for good.
TEST_F(DrivingFault, NoneWhileATurnCarriesAWheel) {
  for (const float way : {1.0f, -1.0f}) {
    bench.Run(300, Bench::Wheels(way * 3.0f, way * 3.0f));
    bench.left.stuck = true;
    bench.Run(150, Bench::Wheels(way * -3.7f, way * 12.0f));
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone) << way;
    bench.left.stuck = false;
    bench.Run(100, Bench::Wheels(way * -3.7f, way * 12.0f));
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone) << way;
  }
  bench.Run(300, Bench::Wheels(3.0f, 3.0f));
  bench.left.stuck = true;
  bench.Run(400, Bench::Wheels(-3.7f, 12.0f));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kOppositeMotion);
}

// The vehicle slows down in the turn, so that for a moment the wheel is faster than both together
// are to be.
TEST_F(DrivingFault, NoneWhileATurnCarriesAWheelButForAMoment) {
  bench.Run(300, Bench::Wheels(3.0f, 3.0f));
  bench.left.stuck = true;
  bench.Run(150, Bench::Wheels(-3.7f, 12.0f));
  bench.Run(20, Bench::Wheels(-3.7f, 5.0f));
  bench.Run(20, Bench::Wheels(-3.7f, 12.0f));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
  bench.Run(20, Bench::Wheels(-3.7f, 5.0f));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kOppositeMotion);
}

// Turns in which nothing carries the wheel: its own motor drives it the wrong way, faster than both
// sides together are to be; the other side does not pull; or both sides turn wrongly.
// SR-DRV02
TEST_F(DrivingFault, OppositeMotionInATurn) {
  struct Turn {
    float left_radps;
    float right_radps;
    bool right_too;
  };
  for (const Turn& turn :
       {Turn{-6.0f, 8.0f, false}, Turn{-6.0f, 6.0f, false}, Turn{-6.0f, 8.0f, true},
        Turn{6.0f, -8.0f, false}, Turn{-6.0f, -2.0f, false}}) {
    bench.left.runs_backward = true;
    bench.right.runs_backward = turn.right_too;
    bench.Run(80, Bench::Wheels(turn.left_radps, turn.right_radps));
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kOppositeMotion)
        << turn.left_radps << " " << turn.right_radps;
    bench.left.runs_backward = bench.right.runs_backward = false;
    bench.Run(300);
    ExpectDrivingAgain();
  }
}

// SR-DRV04
TEST_F(DrivingFault, ForeignSenders) {
  struct Foreign {
    uint32_t id;
    uint8_t size;
  };
  for (const Foreign& foreign :
       {Foreign{0x000, 2}, Foreign{0x080, 0}, Foreign{0x202, 8}, Foreign{0x203, 8},
        Foreign{0x602, 8}, Foreign{0x603, 8}, Foreign{0x701, 1}, Foreign{0x202, 0}}) {
    ASSERT_TRUE(bench.Drive(3.0f, 3.0f));
    EXPECT_FALSE(bench.pair.foreign_sender());
    const uint32_t before = bench.pair.counters().foreign_frames;
    CanFrame frame;
    frame.id = foreign.id;
    frame.size = foreign.size;
    bench.foreign = {frame};
    ExpectFault(DriveFault::kForeignSender, 1);
    EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kForeignSender);
    EXPECT_TRUE(bench.pair.foreign_sender());
    EXPECT_EQ(bench.pair.health(), Status::kWrongDevice);
    EXPECT_EQ(bench.pair.counters().foreign_frames, before + 1);
    ExpectStop();
    ExpectDrivingAgain();
  }
}

// Its fault can be reset, and the drives enabled, while it is remembered: nothing is driven then.
// SR-DRV04
TEST(ForeignSender, LeavesNothingToDriveOnWhileItIsRemembered) {
  Bench bench = Bench::WithDrivesSetUp();
  CanFrame nmt;
  nmt.id = 0x000;
  nmt.size = 2;
  bench.foreign = {nmt};
  bench.Tick();
  ASSERT_TRUE(bench.pair.foreign_sender());
  bench.Tick(kReset);
  bool was_enabled = false;
  for (bench.Tick(); bench.pair.foreign_sender(); bench.Tick(Bench::Wheels(3.0f, 3.0f))) {
    was_enabled = was_enabled || bench.pair.enabled();
    ASSERT_EQ(bench.pair.commanded().left_radps, 0.0f);
    ASSERT_EQ(bench.pair.commanded().right_radps, 0.0f);
  }
  EXPECT_TRUE(was_enabled);
}

// One that beats once a second is there all the time; one that has gone is not.
// SR-DRV04
TEST_F(DrivingFault, ForeignSenderUntilItHasBeenQuiet) {
  CanFrame heartbeat;
  heartbeat.id = 0x701;
  heartbeat.size = 1;
  for (int beat = 0; beat < 5; ++beat) {
    bench.foreign = {heartbeat};
    for (int tick = 0; tick < 100; ++tick) {
      bench.Tick();
      ASSERT_TRUE(bench.pair.foreign_sender()) << beat << " " << tick;
    }
  }
  bench.Run(99);
  EXPECT_TRUE(bench.pair.foreign_sender());
  bench.Run(2);
  EXPECT_FALSE(bench.pair.foreign_sender());
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kForeignSender);  // until it is reset
  EXPECT_EQ(bench.pair.health(), Status::kWrongDevice);
  ExpectDrivingAgain();
}

TEST_F(DrivingFault, NoneFromOthersOnTheBus) {
  const uint32_t taken = bench.pair.counters().frames_taken;
  for (uint32_t id = 1; id <= 0x7ff; ++id) {
    if (id == 0x080 || id == 0x202 || id == 0x203 || id == 0x602 || id == 0x603 || id == 0x701) {
      continue;  // ours
    }
    if ((id & 0x7f) == 2 || (id & 0x7f) == 3) continue;  // the drives'
    CanFrame frame;
    frame.id = id;
    frame.size = 8;
    bench.foreign.push_back(frame);
  }
  CanFrame extended;
  extended.id = 0x202;
  extended.extended = true;
  bench.foreign.push_back(extended);
  const size_t others = bench.foreign.size();
  bench.Tick(Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.pair.counters().frames_ignored, others);
  EXPECT_TRUE(bench.pair.enabled());
  EXPECT_GE(bench.pair.counters().frames_taken, taken);
}

// SR-INP04
TEST_F(DrivingFault, NoneFromFramesCutShort) {
  for (const uint32_t id : {0x082u, 0x182u, 0x582u, 0x702u, 0x703u, 0x183u}) {
    for (uint8_t size = 0; size <= 8; ++size) {
      CanFrame frame;
      frame.id = id;
      frame.size = size;
      frame.data[0] = 0x99;
      const bool whole = size == 8 && id != 0x702 && id != 0x703;
      if (!whole) bench.foreign.push_back(frame);
      frame.remote = true;
      bench.foreign.push_back(frame);
    }
  }
  const size_t bad = bench.foreign.size();
  bench.Tick(Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.pair.counters().frames_malformed, bad);
  EXPECT_TRUE(bench.pair.enabled());
}

// SR-INP04
TEST_F(DrivingFault, SpeedThatCannotBeIsNoReport) {
  bench.left.stuck = true;
  bench.left.speed_rpm = 20001;
  ExpectFault(DriveFault::kSilent, 15);
  EXPECT_GT(bench.pair.counters().frames_malformed, 0u);
}

// SR-DRV02
TEST_F(DrivingFault, OfBothAtOnce) {
  bench.left.SendEmergency(0x3120);
  bench.right.Reboot();
  ExpectFault(DriveFault::kEmergency, 1);
  EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kRebooted);
  ExpectDrivingAgain();
}

TEST(Fault, OfADriveThatCannotBeEnabled) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  bench.right.refuses_enable = true;
  bench.Run(290, Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kNone);
  bench.Run(20, Bench::Wheels(3.0f, 3.0f));
  EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kStateRefused);
  bench.Run(100);
  EXPECT_FALSE(bench.left.enabled);
}

// Our computer dies: the drives' own time-out stops them.
TEST(Fault, OfOursStopsTheDrives) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  ASSERT_TRUE(bench.Drive(3.0f, 3.0f));
  for (int i = 0; i < 30; ++i) {
    bench.now_ns += kTick_ns;
    bench.left.Step(bench.now_ns);
  }
  EXPECT_FALSE(bench.left.Enabled());
}

TEST(Fault, OfADriveIsKnownBeforeItIsReady) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.fault = bench.right.fault = true;
  bench.left.objects[{0x1800, 2}].value = 4;  // reports late
  for (int i = 0; i < 200; ++i) {
    bench.Tick();
    EXPECT_FALSE(bench.pair.ready()) << i;
  }
}

TEST(Fault, ThatStandsAtStartWaitsForItsReset) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.fault = true;
  bench.Run(100);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStatusFault);
  bench.Tick(kReset);
  EXPECT_TRUE(bench.BringUp());
}

}  // namespace
}  // namespace hardpack::sevcon
