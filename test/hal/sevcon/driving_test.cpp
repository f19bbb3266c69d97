// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "test/hal/sevcon/bench.h"
#include "test/not_finite.h"

namespace hardpack::sevcon {
namespace {

using testing::kInfinity;
using testing::kNaN;
// Of a motor, gear ratio 30.
constexpr float kRpmPerRadps = 30.0f * 60.0f / 6.2831853f;

TEST(Driving, EnablesThroughTheStatesOfTheStandard) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  std::vector<int> words;
  for (int i = 0; i < 50 && !bench.pair.enabled(); ++i) {
    bench.Tick({true, false, {}});
    const CanFrame* command = bench.CommandTo(Side::kLeft);
    ASSERT_NE(command, nullptr);
    if (words.empty() || words.back() != ControlwordOf(*command)) {
      words.push_back(ControlwordOf(*command));
    }
  }
  EXPECT_TRUE(bench.pair.enabled());
  EXPECT_EQ(words, (std::vector<int>{0x06, 0x07, 0x0f}));
  EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kEnabled);
}

// SR-SUP01
TEST(Driving, DoesNotEnableUnasked) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  bench.Run(100, {false, false, {3.0f, 3.0f}});
  EXPECT_FALSE(bench.left.enabled);
  EXPECT_EQ(bench.pair.commanded().left_radps, 0.0f);
  EXPECT_TRUE(bench.pair.standstill());
}

TEST(Driving, CommandsWheelSpeedsWithSignsAndGear) {
  DriveParams params = BenchParams();
  params.right_sign = -1;
  params.max_torque_permille = 700;
  Bench bench(params);
  bench.left.SetUp();
  bench.right.SetUp();
  ASSERT_TRUE(bench.BringUp());
  ASSERT_TRUE(bench.Drive(2.0f, 3.0f));
  bench.Run(100, Bench::Wheels(2.0f, 3.0f));
  EXPECT_EQ(bench.left.target_rpm, std::lround(2.0f * kRpmPerRadps));
  EXPECT_EQ(bench.right.target_rpm, -std::lround(3.0f * kRpmPerRadps));
  EXPECT_NEAR(bench.pair.commanded().left_radps, 2.0f, 0.002f);
  EXPECT_NEAR(bench.pair.commanded().right_radps, 3.0f, 0.002f);
  const WheelFeedback feedback = bench.pair.feedback(bench.now_ns);
  EXPECT_TRUE(feedback.valid);
  EXPECT_NEAR(feedback.left_radps, 2.0f, 0.002f);
  EXPECT_NEAR(feedback.right_radps, 3.0f, 0.002f);
  EXPECT_LE(bench.now_ns - feedback.time_ns, 20'000'000u);
  EXPECT_NEAR(bench.pair.report(Side::kLeft).torque_share, 0.123f, 1e-6f);
  EXPECT_NEAR(bench.pair.report(Side::kRight).torque_share, -0.123f, 1e-6f);
  EXPECT_FALSE(bench.pair.standstill());
  const CanFrame* command = bench.CommandTo(Side::kLeft);
  ASSERT_NE(command, nullptr);
  EXPECT_EQ(command->data[6] | command->data[7] << 8, 700);
}

// SR-CMD02
TEST(Driving, ClampsToTheMotorsLimit) {
  DriveParams params = BenchParams();
  params.max_motor_speed_rpm = 2000.0f;
  Bench bench(params);
  bench.left.SetUp();
  bench.right.SetUp();
  bench.right.objects[{0x6080, 0}].value = 1500;  // its own, lower
  ASSERT_TRUE(bench.BringUp());
  ASSERT_TRUE(bench.Drive(1000.0f, 1000.0f));
  EXPECT_EQ(bench.left.target_rpm, 2000);
  EXPECT_EQ(bench.right.target_rpm, 1500);
  bench.Run(300, Bench::Wheels(-1e30f, -1e30f));
  EXPECT_EQ(bench.left.target_rpm, -2000);
  EXPECT_NEAR(bench.pair.commanded().left_radps, -2000.0f / kRpmPerRadps, 1e-4f);
}

// SR-CMD03
TEST(Driving, TakesADemandThatIsNotFiniteForZero) {
  for (const float odd : {kNaN, kInfinity, -kInfinity}) {
    Bench bench = Bench::WithDrivesSetUp();
    ASSERT_TRUE(bench.BringUp());
    ASSERT_TRUE(bench.Drive(2.0f, 2.0f));
    bench.Tick(Bench::Wheels(2.0f, odd));
    EXPECT_TRUE(bench.ZeroWentToBoth());
    bench.Tick(Bench::Wheels(odd, 2.0f));
    EXPECT_EQ(bench.pair.commanded().right_radps, 0.0f);
    EXPECT_EQ(bench.pair.health(), Status::kOk);
  }
}

// speed  \                       zero, standstill for a while, disabled: in this order
//         \____________
// enabled ------------|______
TEST(Driving, StopsByZeroStandstillDisabled) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  ASSERT_TRUE(bench.Drive(4.0f, -4.0f));
  bench.Run(50, Bench::Wheels(4.0f, -4.0f));
  bench.Tick({});
  EXPECT_TRUE(bench.ZeroWentToBoth());
  EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kDisabling);
  int still_ticks = 0;
  for (int i = 0; i < 500 && bench.left.enabled; ++i) {
    bench.Tick({});
    still_ticks = bench.left.speed_rpm == 0 && bench.right.speed_rpm == 0 ? still_ticks + 1 : 0;
  }
  EXPECT_FALSE(bench.left.enabled);
  EXPECT_FALSE(bench.right.enabled);
  // disable_delay_s, and a report of what stood still slowly before.
  EXPECT_GE(still_ticks, 30);
  EXPECT_EQ(bench.left.speed_rpm, 0);
  bench.Run(5);
  EXPECT_EQ(bench.StateOf(Side::kLeft), DriveState::kReady);
}

// It is told zero, and turns on: after 5 s its brakes are all that is left.
// SR-DRV06
TEST(Driving, DisablesADriveThatDoesNotStop) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  ASSERT_TRUE(bench.Drive(4.0f, 4.0f));
  bench.left.stuck = true;  // its speed stays what it is
  bench.Run(490, {});
  EXPECT_NE(bench.left.speed_rpm, 0);
  EXPECT_TRUE(bench.left.enabled);
  EXPECT_TRUE(bench.ZeroWentToBoth());
  bench.Run(20, {});
  EXPECT_FALSE(bench.left.enabled);
  EXPECT_FALSE(bench.right.enabled);
}

TEST(Driving, DrivesOnWhenItIsAskedAgainBeforeStandstill) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  ASSERT_TRUE(bench.Drive(4.0f, 4.0f));
  bench.Run(3, {});
  bench.Tick(Bench::Wheels(4.0f, 4.0f));
  EXPECT_TRUE(bench.pair.enabled());
  EXPECT_GT(bench.pair.commanded().left_radps, 3.9f);
}

// SR-DRV06
TEST(Driving, StopsADriveThatItFindsEnabled) {
  Bench bench = Bench::WithDrivesSetUp();
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
    drive->nmt = 0x05;
    drive->ready = drive->switched_on = drive->enabled = true;
    drive->target_rpm = drive->speed_rpm = 400;
  }
  ASSERT_TRUE(bench.RunUntil([&] { return bench.left.target_rpm == 0; }));
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
  // Not before its wheels stand still.
  ASSERT_TRUE(bench.RunUntil([&] { return !bench.left.enabled; }));
  EXPECT_EQ(bench.left.speed_rpm, 0);
  EXPECT_FALSE(bench.right.enabled);
}

TEST(Driving, SendsStopsAndFaultsAtOnceWhereCommandsAreFew) {
  DriveParams params = BenchParams();
  params.command_period_ms = 100;
  for (const bool by_fault : {true, false}) {
    for (int phase = 0; phase < 10; ++phase) {
      Bench bench(params);
      bench.left.SetUp();
      bench.right.SetUp();
      ASSERT_TRUE(bench.BringUp());
      ASSERT_TRUE(bench.Drive(3.0f, 3.0f));
      bench.Run(20 + phase, Bench::Wheels(3.0f, 3.0f));
      if (by_fault) bench.left.SendEmergency(0x3120);
      bench.Tick(by_fault ? Bench::Wheels(3.0f, 3.0f) : DriveDemand{});
      EXPECT_TRUE(bench.ZeroWentToBoth()) << phase;
    }
  }
}

// SR-DRV05
TEST(Driving, BelievesNoReportBeforeItsMappingIsVerified) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.nmt = bench.right.nmt = 0x05;
  bench.left.speed_rpm = bench.right.speed_rpm = 300;
  bench.left.stuck = bench.right.stuck = true;
  bench.left.objects[{0x1a00, 2}].value = 0x60690020;  // another speed
  bench.Run(100);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kWrongMapping);
  EXPECT_EQ(bench.pair.report(Side::kLeft).wheel_radps, 0.0f);
  EXPECT_NE(bench.pair.report(Side::kRight).wheel_radps, 0.0f);
  EXPECT_FALSE(bench.pair.feedback(bench.now_ns).valid);
}

TEST(Driving, WaitsForTheFirstReportAndTheFirstHeartbeat) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.objects[{0x1800, 2}].value = 4;  // each 80 ms
  bench.left.no_heartbeat = true;
  ASSERT_TRUE(bench.BringUp());
  bench.Run(15);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kNone);
  bench.Run(20);
  EXPECT_EQ(bench.FaultOf(Side::kLeft), DriveFault::kSilent);
}

// SR-DRV09
TEST(Driving, KeepsTheTimesOfWhatItSendsAgainAndAgain) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  bench.history.clear();
  bench.Run(1000);  // 10 s
  EXPECT_NEAR(bench.CountSent(0x080), 500, 1);
  EXPECT_NEAR(bench.CountSent(0x701), 100, 1);
  EXPECT_NEAR(bench.CountSent(0x202), 1000, 1);
  EXPECT_NEAR(bench.CountSent(0x602), 40, 1);
  for (const CanFrame& frame : bench.history) {
    EXPECT_TRUE(frame.id != 0x701 || frame.data[0] == 0x05);
  }
}

// SR-DRV09
TEST(Driving, KeepsThemWhenTicksJitterAndAfterAPause) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  bench.history.clear();
  for (int i = 0; i < 1000; ++i) {
    CanBatch out;
    const uint64_t jitter_ns = i % 3 == 0 ? 0u : (i % 3 == 1 ? 2'500'000u : 1'000'000u);
    bench.pair.Tick(bench.now_ns + static_cast<uint64_t>(i) * kTick_ns + jitter_ns, {}, out);
    bench.history.insert(bench.history.end(), out.begin(), out.end());
  }
  EXPECT_NEAR(bench.CountSent(0x080), 500, 2);
  bench.history.clear();
  bench.now_ns += 60'000'000'000;
  bench.Run(100);
  EXPECT_NEAR(bench.CountSent(0x080), 50, 2);  // nothing is caught up
}

TEST(Driving, LeavesSyncToAnotherNodeWhereItIsToldSo) {
  DriveParams params = BenchParams();
  params.sync_period_ms = 0;
  Bench bench(params);
  for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
    drive->SetUp();
    drive->objects[{0x1005, 0}].value = 0x40000080;
  }
  CanFrame sync;
  sync.id = 0x080;
  for (int i = 0; i < 300; ++i) {
    bench.left.Take(sync, bench.now_ns);
    bench.right.Take(sync, bench.now_ns);
    bench.foreign = {sync};
    bench.Tick();
  }
  EXPECT_TRUE(bench.pair.ready());
  EXPECT_EQ(bench.CountSent(0x080), 0);
  EXPECT_FALSE(bench.pair.foreign_sender());
}

TEST(Driving, ReadsTheSupplyWithASignedCurrent) {
  Bench bench = Bench::WithDrivesSetUp();
  ASSERT_TRUE(bench.BringUp());
  EXPECT_FALSE(bench.pair.report(Side::kLeft).has_supply);
  bench.Run(150);
  const DriveReport& report = bench.pair.report(Side::kLeft);
  EXPECT_TRUE(report.has_supply);
  EXPECT_EQ(report.battery_V, 50.0f);
  EXPECT_EQ(report.battery_A, -10.0f);
  EXPECT_EQ(report.capacitor_V, 49.0f);
  EXPECT_EQ(report.heatsink_degC, -20);
}

TEST(Driving, DrivesOnWithoutTheSupply) {
  Bench bench = Bench::WithDrivesSetUp();
  bench.left.unanswered = {0x5100};
  bench.right.aborts = {{0x5100, 0x08000000}};
  ASSERT_TRUE(bench.BringUp());
  bench.Run(300);
  EXPECT_TRUE(bench.pair.ready());
  EXPECT_FALSE(bench.pair.report(Side::kLeft).has_supply);
  EXPECT_GT(bench.pair.report(Side::kLeft).sdo_timeouts, 0u);
  EXPECT_GT(bench.pair.report(Side::kRight).sdo_aborts, 0u);
  EXPECT_EQ(bench.pair.report(Side::kRight).sdo_abort_reason, 99);
}

TEST(Driving, HashesWhatWasDecided) {
  Bench a = Bench::WithDrivesSetUp();
  Bench b = Bench::WithDrivesSetUp();
  DecisionHash hash_a, hash_b;
  for (int i = 0; i < 100; ++i) {
    a.Tick();
    b.Tick();
    AddToHash(a.pair, hash_a);
    AddToHash(b.pair, hash_b);
  }
  EXPECT_EQ(hash_a.value(), hash_b.value());
  b.left.Reboot();
  b.Tick();
  a.Tick();
  AddToHash(a.pair, hash_a);
  AddToHash(b.pair, hash_b);
  EXPECT_NE(hash_a.value(), hash_b.value());
}

// SR-DRV09
TEST(Configure, RefusesWhatDoesNotFitTogether) {
  const auto status_of = [](auto change) {
    DriveParams params = BenchParams();
    change(params);
    DrivePair pair;
    const Status status = pair.Configure(params);
    CanBatch out;
    pair.Tick(1, {}, out);
    EXPECT_EQ(out.empty(), status != Status::kOk);
    return status;
  };
  EXPECT_EQ(status_of([](DriveParams&) {}), Status::kOk);
  EXPECT_EQ(status_of([](DriveParams& p) { p.left_node = 3; }), Status::kInvalidArgument);
  EXPECT_EQ(status_of([](DriveParams& p) { p.master_node = 2; }), Status::kInvalidArgument);
  EXPECT_EQ(status_of([](DriveParams& p) { p.left_sign = 0; }), Status::kInvalidArgument);
  EXPECT_EQ(status_of([](DriveParams& p) { p.heartbeat_timeout_ms = 100; }),
            Status::kInvalidArgument);
  EXPECT_EQ(status_of([](DriveParams& p) {
              p.command_period_ms = 100;
              p.command_timeout_ms = 100;
            }),
            Status::kInvalidArgument);
  EXPECT_EQ(status_of([](DriveParams& p) {
              p.sync_period_ms = 100;
              p.feedback_timeout_ms = 100;
            }),
            Status::kInvalidArgument);
  EXPECT_EQ(status_of([](DriveParams& p) { p.left_node = 128; }), Status::kParameterOutOfRange);
  EXPECT_EQ(status_of([](DriveParams& p) { p.gear_ratio = kNaN; }), Status::kParameterOutOfRange);
  EXPECT_EQ(status_of([](DriveParams& p) { p.bit_rate_kbps = 50; }), Status::kCapacityExceeded);
}

// Commands 2 x 100/s and reports 2 x 50/s of 8 bytes (135 bits at worst), SYNC 50/s of none (55),
// heartbeats 3 x 10/s of one (65), questions and answers 2 x 2 x 4/s of 8.
// SR-DRV09
TEST(Configure, ComputesTheLoadOfTheBus) {
  DriveParams params = BenchParams();
  params.bit_rate_kbps = 250;
  DrivePair pair;
  ASSERT_EQ(pair.Configure(params), Status::kOk);
  const double bits_per_s = 135.0 * (200 + 100 + 16) + 55.0 * 50 + 65.0 * 30;
  EXPECT_GE(pair.bus_load_percent(), bits_per_s / 250e3 * 100);
  EXPECT_LE(pair.bus_load_percent(), bits_per_s / 250e3 * 100 + 2);
}

}  // namespace
}  // namespace hardpack::sevcon
