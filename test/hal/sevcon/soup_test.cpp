// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <random>

#include "test/hal/sevcon/bench.h"

// Whatever is on the bus: what Bench checks in every tick holds, nothing is decided at random, and
// once the bus is sound again and the faults are reset, the drives drive.

namespace hardpack::sevcon {
namespace {

CanFrame AnyFrame(std::mt19937& random) {
  constexpr uint32_t kIds[] = {0x000, 0x080, 0x082, 0x083, 0x182, 0x183, 0x202, 0x203,
                               0x582, 0x583, 0x602, 0x603, 0x701, 0x702, 0x703};
  CanFrame frame;
  frame.id = random() % 8 == 0 ? static_cast<uint32_t>(random() % 0x800)
                               : kIds[random() % std::size(kIds)];
  frame.size = static_cast<uint8_t>(random() % 10 == 0 ? random() % 16 : 8);
  if (frame.id >= 0x700) frame.size = static_cast<uint8_t>(random() % 4 == 0 ? random() % 9 : 1);
  frame.extended = random() % 20 == 0;
  frame.remote = random() % 20 == 0;
  for (uint8_t& byte : frame.data) {
    byte = static_cast<uint8_t>(random() % 3 == 0 ? random() % 256 : random() % 8);
  }
  if ((frame.id & 0x780) == 0x180 && random() % 2 == 0) frame.data[0] = 0x37;
  if ((frame.id & 0x780) == 0x580) {
    constexpr int kCommands[] = {0x43, 0x4b, 0x4f, 0x60, 0x80, 0x42};
    constexpr int kIndices[] = {0x1018, 0x1016, 0x5902, 0x5110, 0x6061, 0x1400, 0x1a00, 0x5310};
    const int index = kIndices[random() % std::size(kIndices)];
    frame.data[0] = static_cast<uint8_t>(kCommands[random() % std::size(kCommands)]);
    frame.data[1] = static_cast<uint8_t>(index & 0xff);
    frame.data[2] = static_cast<uint8_t>(index >> 8);
    frame.data[3] = static_cast<uint8_t>(random() % 3);
  }
  return frame;
}

DriveDemand AnyDemand(std::mt19937& random) {
  DriveDemand demand;
  demand.enable = random() % 4 != 0;
  demand.reset_faults = random() % 16 == 0;
  demand.wheels = {static_cast<float>(random() % 100) / 5.0f - 10.0f,
                   static_cast<float>(random() % 100) / 5.0f - 10.0f};
  return demand;
}

// Frames that no drive would send at all: only the checks that hold for any bytes.
// SR-DRV10
TEST(Soup, OfFramesNeverDrivesAgainstAFault) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    DrivePair pair;
    ASSERT_EQ(pair.Configure(BenchParams()), Status::kOk);
    uint64_t now_ns = random();
    for (int tick = 0; tick < 500; ++tick) {
      now_ns += random() % 4 == 0 ? random() % 1'000'000'000 : kTick_ns;
      for (auto i = random() % 6; i > 0; --i) pair.TakeFrame(AnyFrame(random), now_ns);
      CanBatch out;
      pair.Tick(now_ns, AnyDemand(random), out);
      ASSERT_LE(out.size(), DrivePair::kMaxFramesPerTick);
      for (const CanFrame& frame : out) {
        ASSERT_TRUE(IsValid(frame));
        const bool commands = frame.id == 0x202 || frame.id == 0x203;
        if (commands && SpeedOf(frame) != 0) {
          ASSERT_TRUE(pair.enabled());
          ASSERT_TRUE(pair.ready());
          ASSERT_FALSE(pair.foreign_sender());
        }
      }
    }
  }
}

// A bus that loses, doubles and delays frames both ways, drives that reboot and fall silent.
class PoorBus {
 public:
  explicit PoorBus(uint32_t seed, const DriveParams& params = BenchParams())
      : bench(params), random_(seed) {
    bench.left.SetUp();
    bench.right.SetUp();
  }

  void Tick(const DriveDemand& demand, bool poor) {
    for (ScriptedDrive* drive : {&bench.left, &bench.right}) {
      if (poor && random_() % 400 == 0) drive->Reboot(random_() % 2 == 0);
      if (poor && random_() % 400 == 0) drive->powered = !drive->powered;
      if (poor && random_() % 400 == 0) drive->RaiseFault(0x3100);
      if (!poor) drive->powered = true;
      Spoil(drive->outbox, poor);
    }
    if (poor && random_() % 300 == 0) bench.foreign.push_back(AnyFrame(random_));
    bench.Tick(demand);
  }

  Bench bench;

 private:
  void Spoil(std::vector<CanFrame>& frames, bool poor) {
    std::vector<CanFrame> spoilt;
    spoilt.swap(late_);
    for (const CanFrame& frame : frames) {
      const uint32_t fate = poor ? static_cast<uint32_t>(random_() % 12) : 0;
      if (fate == 1) continue;                 // lost
      if (fate == 2) spoilt.push_back(frame);  // twice
      (fate == 3 ? late_ : spoilt).push_back(frame);
    }
    if (poor && spoilt.size() > 1 && random_() % 4 == 0) std::swap(spoilt.front(), spoilt.back());
    frames = spoilt;
  }

  std::mt19937 random_;
  std::vector<CanFrame> late_;
};

// SR-DRV10
TEST(Soup, OfLossAndRebootsIsStoodAndRecoveredFrom) {
  int drove = 0;
  for (uint32_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    PoorBus bus(seed);
    std::mt19937 random(seed + 1000);
    for (int tick = 0; tick < 1500; ++tick) {
      DriveDemand demand = Bench::Wheels(3.0f, -2.0f);
      const bool faulty = bus.bench.FaultOf(Side::kLeft) != DriveFault::kNone ||
                          bus.bench.FaultOf(Side::kRight) != DriveFault::kNone;
      if (faulty && random() % 8 == 0) demand = {false, true, {}};
      const bool was_driving = std::abs(bus.bench.pair.commanded().left_radps) > 1.0f;
      drove += was_driving;
      bus.Tick(demand, true);
      const bool is_faulty = bus.bench.FaultOf(Side::kLeft) != DriveFault::kNone ||
                             bus.bench.FaultOf(Side::kRight) != DriveFault::kNone;
      if (was_driving && is_faulty && !faulty) {
        EXPECT_TRUE(bus.bench.ZeroWentToBoth());
      }
      if (HasFailure()) return;
    }
    for (int tick = 0; tick < 1200; ++tick) bus.Tick({}, false);
    // A bring-up that had failed begins anew, and finds the drive's own fault, which is another.
    for (int resets = 0; resets < 3 && !bus.bench.pair.ready(); ++resets) {
      bus.Tick({false, true, {}}, false);
      for (int tick = 0; tick < 400 && !bus.bench.pair.ready(); ++tick) bus.Tick({}, false);
    }
    ASSERT_TRUE(bus.bench.pair.ready());
    EXPECT_TRUE(bus.bench.Drive(3.0f, 3.0f));
  }
  EXPECT_GT(drove, 1000);  // the soup was not so thick that nothing was tried
}

TEST(Soup, IsDecidedTheSameWayTwiceAndByACopy) {
  for (uint32_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    DrivePair pair;
    ASSERT_EQ(pair.Configure(BenchParams()), Status::kOk);
    std::vector<CanFrame> input;
    std::vector<int> counts;
    std::vector<DriveDemand> demands;
    for (int tick = 0; tick < 400; ++tick) {
      counts.push_back(static_cast<int>(random() % 5));
      for (int i = 0; i < counts.back(); ++i) input.push_back(AnyFrame(random));
      demands.push_back(AnyDemand(random));
    }
    const auto run = [&](DrivePair& runner, int first, int last, size_t next, DecisionHash& hash,
                         std::vector<CanFrame>& sent) {
      for (int tick = first; tick < last; ++tick) {
        const uint64_t now_ns = 4'200'000'000u + static_cast<uint64_t>(tick) * kTick_ns;
        for (int i = 0; i < counts[static_cast<size_t>(tick)]; ++i) {
          runner.TakeFrame(input[next++], now_ns);
        }
        CanBatch out;
        runner.Tick(now_ns, demands[static_cast<size_t>(tick)], out);
        sent.insert(sent.end(), out.begin(), out.end());
        AddToHash(runner, hash);
      }
      return next;
    };
    DecisionHash once, twice;
    std::vector<CanFrame> sent_once, sent_twice;
    run(pair, 0, 400, 0, once, sent_once);
    DrivePair half;
    ASSERT_EQ(half.Configure(BenchParams()), Status::kOk);
    const size_t next = run(half, 0, 200, 0, twice, sent_twice);
    // Its image, as a flight log keeps it.
    std::vector<unsigned char> image(sizeof(DrivePair));
    std::memcpy(image.data(), &half, image.size());
    DrivePair copy;
    std::memcpy(&copy, image.data(), image.size());
    run(copy, 200, 400, next, twice, sent_twice);
    EXPECT_EQ(once.value(), twice.value());
    EXPECT_EQ(sent_once, sent_twice);
  }
}

void AddReport(const DrivePair& pair, DecisionHash& hash) {
  AddToHash(pair, hash);
  for (const Side side : {Side::kLeft, Side::kRight}) {
    const DriveReport& report = pair.report(side);
    for (const uint32_t value :
         {uint32_t{report.emergency_code}, uint32_t{report.emergency_register},
          uint32_t{report.sevcon_fault_id}, report.sdo_abort_code, uint32_t{report.sdo_index},
          uint32_t{report.sdo_subindex}, uint32_t{report.sdo_abort_reason}, report.emergencies,
          report.reboots, report.sdo_timeouts, report.sdo_aborts, report.sdo_ignored,
          report.settings_written, report.heartbeats_missed, uint32_t{report.has_supply}}) {
      hash.AddU32(value);
    }
    hash.AddI32(report.heatsink_degC);
    for (const float value : {report.wheel_radps, report.torque_share, report.battery_V,
                              report.battery_A, report.capacitor_V}) {
      hash.AddFloat(value);
    }
  }
}

DriveParams AnyParams(std::mt19937& random) {
  DriveParams params = BenchParams();
  params.gear_ratio = static_cast<float>(5 + random() % 60);
  params.left_sign = random() % 2 == 0 ? 1 : -1;
  params.command_period_ms = static_cast<int32_t>(10 + random() % 5 * 10);
  params.sync_period_ms = static_cast<int32_t>(random() % 4 * 20);
  params.max_motor_speed_rpm = static_cast<float>(500 + random() % 5000);
  params.motor_acceleration_rpmps = random() % 2 == 0 ? 0.0f : 4000.0f;
  params.max_torque_permille = static_cast<int32_t>(300 + random() % 700);
  params.feedback_timeout_ms = static_cast<int32_t>(60 + random() % 200);
  params.sdo_retries = static_cast<int32_t>(random() % 5);
  params.disable_delay_s = static_cast<float>(random() % 10) * 0.1f;
  return params;
}

// Drives and frames on a poor bus, with random parameters and demands: every frame that was sent
// and all that was told, as they were when they were last changed on purpose.
TEST(Soup, IsDecidedAsRecorded) {
  DecisionHash hash;
  int ready = 0;
  for (uint32_t seed = 100; seed < 140; ++seed) {
    std::mt19937 random(seed);
    const DriveParams params = AnyParams(random);
    DrivePair pair;
    const Status taken = pair.Configure(params);
    hash.AddU8(static_cast<uint8_t>(taken));
    if (!IsUsable(taken)) continue;
    PoorBus bus(seed, params);
    DriveDemand demand = AnyDemand(random);
    for (int tick = 0; tick < 900; ++tick) {
      if (random() % 50 == 0) demand = AnyDemand(random);
      if (!bus.bench.pair.ready()) demand = {false, random() % 64 == 0, {}};
      bus.Tick(demand, tick % 450 > 150);
      ready += bus.bench.pair.ready();
      for (const CanFrame& frame : bus.bench.sent) {
        hash.AddU32(frame.id);
        for (int i = 0; i < frame.size; ++i) hash.AddU8(frame.data[i]);
      }
      AddReport(bus.bench.pair, hash);
    }
  }
  EXPECT_GT(ready, 3000);
  EXPECT_EQ(hash.value(), 0x5f36ad6a4acd0ed7u) << "0x" << std::hex << hash.value() << "u";
}

// Runs across 2^32 ns and 2^32 ms, and long.
TEST(Soup, OfTimeIsNothing) {
  for (const uint64_t start_ns : {uint64_t{0}, (uint64_t{1} << 32) - 2'000'000'000,
                                  (uint64_t{1} << 32) * 1'000'000 - 2'000'000'000}) {
    Bench bench = Bench::WithDrivesSetUp();
    bench.now_ns = start_ns;
    ASSERT_TRUE(bench.BringUp());
    ASSERT_TRUE(bench.Drive(2.0f, 2.0f));
    bench.Run(1000, Bench::Wheels(2.0f, 2.0f));
    EXPECT_TRUE(bench.pair.enabled());
  }
}

}  // namespace
}  // namespace hardpack::sevcon
