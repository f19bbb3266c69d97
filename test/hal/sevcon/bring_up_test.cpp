// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "test/hal/sevcon/bench.h"

namespace hardpack::sevcon {
namespace {

bool IsWrite(const CanFrame& question) {
  return question.data[0] != 0x40;
}
int Writes(const ScriptedDrive& drive) {
  return static_cast<int>(std::count_if(drive.asked.begin(), drive.asked.end(), IsWrite));
}
bool Wrote(const ScriptedDrive& drive, int index) {
  return std::any_of(drive.asked.begin(), drive.asked.end(), [&](const CanFrame& question) {
    return IsWrite(question) && (question.data[1] | question.data[2] << 8) == index;
  });
}
uint32_t ValueOf(ScriptedDrive& drive, int index, int sub) {
  return drive.objects.at({index, sub}).value;
}

TEST(BringUp, WritesNothingToDrivesThatAreSetUp) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(Writes(bench.left), 0);
  EXPECT_EQ(Writes(bench.right), 0);
  EXPECT_EQ(bench.pair.report(Side::kLeft).settings_written, 0u);
  EXPECT_EQ(bench.left.nmt, 0x05);
  EXPECT_EQ(bench.right.nmt, 0x05);
  EXPECT_EQ(bench.pair.health(), Status::kOk);
  EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kReady);
}

TEST(BringUp, NeedsNoBootUpMessageOfADriveThatIsOperationalAlready) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.nmt = bench.right.nmt = 0x05;
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(bench.pair.report(Side::kLeft).reboots, 0u);
}

// SR-DRV03
TEST(BringUp, WritesWhatDiffersReadsItBackAndNothingElse) {
  Bench bench;
  bench.left.needed_access = bench.right.needed_access = 0;
  bench.right.SetUp();
  bench.right.objects[{0x1017, 0}].value = 250;
  ASSERT_TRUE(bench.BringUp());
  for (const int index : {0x1005, 0x1016, 0x1017, 0x5902, 0x6060}) {
    EXPECT_TRUE(Wrote(bench.left, index)) << std::hex << index;
  }
  EXPECT_FALSE(Wrote(bench.left, 0x6083));  // 0: left as it is
  EXPECT_EQ(ValueOf(bench.left, 0x1005, 0), 0x80u);
  EXPECT_EQ(ValueOf(bench.left, 0x1016, 1), 1u << 16 | 300u);
  EXPECT_EQ(ValueOf(bench.left, 0x1017, 0), 100u);
  EXPECT_EQ(ValueOf(bench.left, 0x5902, 0), 2u);
  EXPECT_EQ(ValueOf(bench.left, 0x6061, 0), 3u);
  EXPECT_EQ(ValueOf(bench.left, 0x2800, 0), 0u);
  EXPECT_EQ(bench.pair.report(Side::kLeft).settings_written, 5u);
  EXPECT_EQ(bench.pair.report(Side::kRight).settings_written, 1u);
  EXPECT_EQ(ValueOf(bench.right, 0x1017, 0), 100u);
  for (const int index : {0x1005, 0x1016, 0x5902, 0x6060}) {
    EXPECT_FALSE(Wrote(bench.right, index)) << std::hex << index;
  }
}

TEST(BringUp, LogsInWhereSettingsWantIt) {
  DriveParams params = BenchParams();
  params.login_user = 7;
  params.login_password = 0x4bd0;
  Bench bench(params);
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
    drive->user = 7;
    drive->password = 0x4bd0;
  }
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(ValueOf(bench.left, 0x5000, 1), 4u);
  // The user first: the password is what logs in.
  std::vector<int> order;
  for (const CanFrame& question : bench.left.asked) {
    if (IsWrite(question) && question.data[1] == 0x00 && question.data[2] == 0x50) {
      order.push_back(question.data[3]);
    }
  }
  EXPECT_EQ(order, (std::vector<int>{3, 2}));
}

TEST(BringUp, SaysThatALoginIsRefused) {
  DriveParams params = BenchParams();
  params.login_password = 1;
  Bench bench(params);
  bench.left.password = bench.right.password = 2;
  bench.Run(200);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kLoginRefused);
  EXPECT_FALSE(Wrote(bench.left, 0x5902));
  EXPECT_EQ(bench.pair.health(), Status::kDeviceFault);
}

TEST(BringUp, ReportsTheReasonOfAGenericAbort) {
  Bench bench;  // no login configured: the drive refuses the setting
  bench.Run(200);
  const DriveReport& report = bench.pair.report(Side::kLeft);
  EXPECT_EQ(report.fault, DriveFault::kSdoAbort);
  EXPECT_EQ(report.sdo_abort_code, 0x08000000u);
  EXPECT_EQ(report.sdo_abort_reason, 8);  // access level too low
  EXPECT_EQ(report.sdo_index, 0x2800);
  EXPECT_FALSE(bench.pair.ready());
}

// SR-DRV05
TEST(BringUp, NeverWritesToAWrongDevice) {
  for (const bool vendor : {true, false}) {
    DriveParams params = BenchParams();
    params.product_code = 0x07055037;
    Bench bench(params);
    bench.left.needed_access = bench.right.needed_access = 0;
    bench.left.objects[{0x1018, vendor ? 1 : 2}].value = 0x1f;
    bench.Run(300);
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kWrongIdentity);
    EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kFault);
    EXPECT_EQ(bench.pair.report(Side::kLeft).sdo_index, 0x1018);
    EXPECT_EQ(Writes(bench.left), 0);
    EXPECT_EQ(bench.left.nmt, 0x7f);
    EXPECT_EQ(bench.CountSent(0x202), 0);
    EXPECT_EQ(bench.pair.health(), Status::kWrongDevice);
    EXPECT_FALSE(bench.pair.ready());
  }
}

TEST(BringUp, TakesAnyIdentityWhereNoneIsAskedFor) {
  DriveParams params = BenchParams();
  params.vendor_id = 0;
  Bench bench(params);
  bench.left.SetUp();
  bench.right.SetUp();
  bench.left.objects[{0x1018, 1}].value = 0x77;
  EXPECT_TRUE(bench.BringUp());
}

// SR-DRV05
TEST(BringUp, RefusesEveryWrongPartOfTheProcessData) {
  struct Wrong {
    int index, sub;
    uint32_t value;
  };
  const Wrong wrongs[] = {
      {0x1400, 1, 0x80000202},  // not in use
      {0x1400, 1, 0x302},       // another identifier
      {0x1400, 1, 0x20000202},  // 29 bits
      {0x1400, 2, 1},           // waits for a SYNC
      {0x1600, 0, 2},          {0x1600, 1, 0x60400020}, {0x1600, 2, 0x60710010},
      {0x1600, 3, 0x60710010}, {0x1800, 1, 0xc0000182}, {0x1800, 1, 0x183},
      {0x1800, 2, 0},    // at changes, on SYNC
      {0x1800, 2, 5},    // each fifth SYNC: no sooner than it is late
      {0x1800, 2, 253},  // only when asked
      {0x1800, 2, 255},  // at its own time, which is not set (1800h:5)
      {0x1a00, 0, 4},          {0x1a00, 1, 0x60400010}, {0x1a00, 2, 0x606b0020},
      {0x1a00, 3, 0x60780010},
  };
  for (const Wrong& wrong : wrongs) {
    Bench bench = Bench::WithDrivesSetUp();
    bench.left.objects[{wrong.index, wrong.sub}].value = wrong.value;
    bench.Run(100);
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kWrongMapping)
        << std::hex << wrong.index << ":" << wrong.sub << " = " << wrong.value;
    EXPECT_EQ(bench.CountSent(0x202), 0);
    EXPECT_EQ(bench.left.nmt, 0x7f);
    EXPECT_EQ(Writes(bench.left), 0);
    EXPECT_EQ(bench.pair.health(), Status::kWrongDevice);
  }
}

TEST(BringUp, TakesReportsByTheDrivesOwnTimer) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.objects[{0x1800, 2}].value = 255;
  bench.left.objects[{0x1800, 5}].value = 20;
  EXPECT_TRUE(bench.BringUp());
}

// 254: event-driven as the maker has it; 255: as the device profile has it.
TEST(BringUp, TakesCommandsThatAreInForceAtOnceOfBothKinds) {
  for (const uint32_t type : {254u, 255u}) {
    Bench bench = Bench::WithDrivesSetUp();
    bench.left.objects[{0x1400, 2}].value = type;
    EXPECT_TRUE(bench.BringUp()) << type;
  }
}

// SR-DRV05
TEST(BringUp, RefusesAnotherModeThanTheOneAskedFor) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.right.objects[{0x6061, 0}].value = 4;
  bench.Run(100);
  EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kWrongMode);
  EXPECT_FALSE(bench.pair.ready());
}

// SR-DRV03
TEST(BringUp, RefusesASettingThatDoesNotReadBack) {
  Bench bench;
  bench.left.needed_access = bench.right.needed_access = 0;
  bench.left.kept = {0x5902};
  bench.Run(200);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kReadBack);
  EXPECT_EQ(bench.pair.report(Side::kLeft).sdo_index, 0x5902);
}

TEST(BringUp, SaysWhichQuestionIsNotAnswered) {
  for (const int index : {0x1016, 0x1400, 0x1a00, 0x6061}) {
    Bench bench = Bench::WithDrivesSetUp();
    bench.left.unanswered = {index};
    bench.Run(200);
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kSdoTimeout) << std::hex << index;
    EXPECT_EQ(bench.pair.report(Side::kLeft).sdo_index, index);
    EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kNone);
    EXPECT_FALSE(bench.pair.ready());
  }
}

TEST(BringUp, SaysWhichQuestionIsRefused) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.right.aborts = {{0x1017, 0x06010001}};
  bench.Run(200);
  EXPECT_EQ(bench.FaultOf(Side::kRight), DriveFault::kSdoAbort);
  EXPECT_EQ(bench.pair.report(Side::kRight).sdo_abort_code, 0x06010001u);
  EXPECT_EQ(bench.pair.report(Side::kRight).sdo_index, 0x1017);
}

// "No such object" is fine of what a drive need not have, and of nothing else.
// SR-DRV05
TEST(BringUp, DoesNotDoWithoutTheProcessData) {
  for (const int index : {0x1018, 0x1017, 0x1400, 0x1600, 0x1800, 0x1a00, 0x6061}) {
    for (const uint32_t code : {0x06020000u, 0x06090011u}) {
      Bench bench = Bench::WithDrivesSetUp();
      bench.left.aborts = {{index, code}};
      bench.Run(200);
      EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kSdoAbort) << std::hex << index;
      EXPECT_EQ(bench.pair.report(Side::kLeft).sdo_abort_code, code);
      EXPECT_EQ(bench.pair.report(Side::kLeft).sdo_index, index);
      EXPECT_FALSE(bench.pair.ready());
    }
  }
}

TEST(BringUp, DoesWithoutWhatADriveNeedNotHave) {
  Bench bench;
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
    drive->needed_access = 0;
    for (const int index : {0x1005, 0x2800, 0x6080}) drive->objects.erase({index, 0});
  }
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(ValueOf(bench.left, 0x5902, 0), 2u);
  EXPECT_EQ(bench.pair.report(Side::kLeft).sdo_abort_code, 0u);
}

// SR-DRV03
TEST(BringUp, SetsTheCommandTimeOutOfADriveThatHasOne) {
  Bench bench;
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) drive->needed_access = 0;
  bench.left.Set(0x1400, 5, 2, 0, true);
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(ValueOf(bench.left, 0x1400, 5), 200u);
}

TEST(BringUp, LeavesTheWatchOverOtherNodesAlone) {
  Bench bench;
  bench.left.needed_access = bench.right.needed_access = 0;
  bench.left.objects[{0x1016, 1}].value = 5u << 16 | 700u;
  bench.right.objects[{0x1016, 1}].value = 5u << 16 | 700u;
  bench.right.objects[{0x1016, 2}].value = 1u << 16 | 900u;  // us, but too slow
  ASSERT_TRUE(bench.BringUp());
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
    EXPECT_EQ(ValueOf(*drive, 0x1016, 1), 5u << 16 | 700u);
    EXPECT_EQ(ValueOf(*drive, 0x1016, 2), 1u << 16 | 300u);
  }
}

TEST(BringUp, WaitsForStandstillBeforeItConfigures) {
  Bench bench;
  bench.left.needed_access = bench.right.needed_access = 0;
  bench.left.nmt = 0x05;
  bench.left.speed_rpm = 600;
  bench.left.stuck = true;
  bench.Run(500);
  EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kConfiguring);
  EXPECT_EQ(Writes(bench.left), 0);
  EXPECT_EQ(bench.left.nmt, 0x05);
  bench.left.stuck = false;
  EXPECT_TRUE(bench.BringUp());
}

TEST(BringUp, UndoesAConfigurationThatWasBrokenOff) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.needed_access = 0;
  bench.left.objects[{0x2800, 0}].value = 1;
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(ValueOf(bench.left, 0x2800, 0), 0u);
}

TEST(BringUp, SaysThatADriveDoesNotStart) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.refuses_start = true;
  bench.Run(300);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kStateRefused);
}

TEST(BringUp, StartsOnlyItsOwnNodes) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  int starts = 0;
  for (const CanFrame& frame : bench.history) {
    if (frame.id != 0) continue;
    ++starts;
    EXPECT_EQ(frame.size, 2);
    EXPECT_TRUE(frame.data[1] == 2 || frame.data[1] == 3);
  }
  EXPECT_GE(starts, 2);
}

TEST(BringUp, WaitsForASilentDriveAndAsksItNoMoreThanOneQuestionAtATime) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.powered = false;
  bench.Run(300);
  EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kSilent);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
  EXPECT_EQ(bench.pair.health(), Status::kTimedOut);
  EXPECT_LE(bench.CountSent(0x602), 31);  // one in sdo_timeout_ms
  EXPECT_EQ(bench.CountSent(0x202), 0);
  bench.left.powered = true;
  EXPECT_TRUE(bench.BringUp());
}

TEST(BringUp, WaitsForADriveThatFallsSilentInItsMiddle) {
  for (int at = 3; at < 25; at += 5) {
    Bench bench = Bench::WithDrivesSetUp();
    bench.Run(at);
    bench.left.powered = false;
    bench.Run(200);
    EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kSilent) << at;
    EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone) << at;
    bench.left.powered = true;
    bench.left.Reboot(false);
    EXPECT_TRUE(bench.BringUp()) << at;
  }
}

TEST(BringUp, WritesTheAccelerationWhereItIsSet) {
  DriveParams params = BenchParams();
  params.motor_acceleration_rpmps = 2500.0f;
  Bench bench(params);
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
    drive->SetUp();
    drive->needed_access = 0;
  }
  ASSERT_TRUE(bench.BringUp());
  EXPECT_EQ(ValueOf(bench.left, 0x6083, 0), 2500u);
  EXPECT_EQ(bench.pair.report(Side::kLeft).settings_written, 1u);
}

TEST(BringUp, StandsABootUpInItsMiddle) {
  for (int at = 2; at < 160; ++at) {
    SCOPED_TRACE(at);
    DriveParams params = BenchParams();
    params.motor_acceleration_rpmps = at % 2 == 0 ? 0.0f : 32767.0f;  // one question more
    Bench bench(params);
    bench.left.needed_access = bench.right.needed_access = 0;
    bench.Run(at / 2);
    bench.left.Reboot();
    ASSERT_TRUE(bench.RunUntil([&] { return bench.left.nmt == 0x05; }));
    bench.Run(50);
    if (bench.FaultOf(Side::kLeft) != DriveFault::kNone) {
      // It was ready by then.
      EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kRebooted);
    } else {
      EXPECT_TRUE(bench.BringUp());
    }
  }
}

TEST(BringUp, BeginsAnewWithTheResetOfItsFault) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.objects[{0x6061, 0}].value = 4;
  bench.Run(100);
  ASSERT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kWrongMode);
  bench.left.objects[{0x6061, 0}].value = 3;
  bench.Run(100);
  EXPECT_FALSE(bench.pair.ready());
  bench.Tick({false, true, {}});
  EXPECT_TRUE(bench.BringUp());
}

}  // namespace
}  // namespace hardpack::sevcon
