// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/scripted_vehicle.h"

#include <algorithm>

#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "test/tools/sim/vehicle/bus.h"
#include "tools/sim/script/script.h"

namespace hardpack::sim {
namespace {

using test::MakeFrame;

std::vector<ScriptEvent> Script(const std::string& text) {
  std::vector<ScriptEvent> script;
  const ReadOutcome outcome = ParseScript(text, "script", script);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return script;
}

ScriptedVehicleSettings Small() {
  ScriptedVehicleSettings settings;
  settings.lidar.columns = 512;
  settings.world = LaneWorld();
  return settings;
}

Outgoing RunFor(ScriptedVehicle& vehicle, double seconds, int step_ms = 5) {
  Outgoing out;
  const uint64_t end_ns = vehicle.now_ns() + static_cast<uint64_t>(seconds * 1.0e9 + 0.5);
  while (vehicle.now_ns() < end_ns) {
    vehicle.Advance(vehicle.now_ns() + static_cast<uint64_t>(step_ms) * 1'000'000u, out);
  }
  return out;
}

size_t Count(const Outgoing& out, Sensor sensor) {
  return static_cast<size_t>(
      std::count_if(out.datagrams.begin(), out.datagrams.end(),
                    [sensor](const SensorDatagram& one) { return one.sensor == sensor; }));
}

constexpr uint64_t kStart_ns = 77'000'000'123;

TEST(Script, SaysWhereALineIsWrong) {
  for (const char* line : {"at 1 nothing",
                           "1 quit",
                           "at -1 quit",
                           "at x quit",
                           "at 1 drive-silent up on",
                           "at 1 drive-silent left",
                           "at 1 drive-silent left maybe",
                           "at 1 emcy left 0x10000",
                           "at 1 can-frame 181#0",
                           "at 1 can-frame 181#00 0.1",
                           "at 1 can-frame 20000000#00",
                           "at 1 can-frame 181#000000000000000000",
                           "at 1 object left 0x1018 2",
                           "at 1 lidar-loss 1001",
                           "at 1 nmt left sleeping",
                           "at 1 box 1 2 0 1",
                           "at 1 quit now",
                           "at 1 world moon",
                           "at 1 world gap x",
                           "at 1 ins-jump 1",
                           "at 1 lidar-delay -5",
                           "at 1 lidar-reorder 256",
                           "at 1 lidar-clock 1000001",
                           "at"}) {
    std::vector<ScriptEvent> script;
    const ReadOutcome outcome =
        ParseScript(std::string("# fine\nat 0 quit\n") + line, "a.txt", script);
    EXPECT_FALSE(outcome.ok()) << line;
    EXPECT_TRUE(outcome.message.starts_with("a.txt:3: ")) << outcome.message;
  }
}

TEST(Script, KnowsEveryCommandThatItsPageNames) {
  const auto script = Script(R"(
    # a comment
    at 0.5 drive-silent left on     # and another
    at 1 heartbeat both off
    at 1 process-data right off
    at 1 reboot left
    at 1 reboot left quiet
    at 1 key both off
    at 1 emcy left 0x3220 5 0x45c1
    at 1 fault right 0x2310
    at 1 sdo-abort left 0x1018 0x06060000
    at 1 sdo-silent left 0x1018 on
    at 1 sdo-keep both 0x1017 off
    at 1 object left 0x1a00 1 0x606c0020
    at 1 mode-refused both on
    at 1 lose-enable left
    at 1 nmt right pre-operational
    at 1 opposite left on
    at 1 blocked left off
    at 1 frozen left on
    at 1 speed-offset left -30
    at 1 can-frame 182#0102 0.1 5
    at 1 can-frame 1fffffff#
    at 1 bus-error bus-off
    at 1 lidar off
    at 1 ins on
    at 1 lidar-foreign on
    at 1 ins-duplicate on
    at 1 lidar-garbage off
    at 1 ins-loss 30
    at 1 lidar-restart
    at 1 ins-cut 37
    at 1 ins-mode 1
    at 1 box 10 0 1.5 1
    at 1 ins-jump 3.5 -2
    at 1 ins-drift 0.1 0
    at 1 labels off
    at 1 lidar-delay 200
    at 1 ins-reorder 4
    at 1 lidar-delay-growth 12
    at 1 ins-delay-growth 12
    at 1 traction 0
    at 1 lidar-clock -500
    at 1 world gap 3
    at 1 world open
    at 1 quit
  )");
  EXPECT_EQ(script.size(), 44u);
  EXPECT_EQ(script[0].text, "at 0.5 drive-silent left on");
  ScriptedVehicle vehicle(Small(), script, kStart_ns);
  RunFor(vehicle, 1.2);
  EXPECT_TRUE(vehicle.quit());
}

TEST(ScriptedVehicle, IsTheSameInSmallAndInLargeSteps) {
  const std::string script = "at 0.3 lidar-loss 100\nat 0.4 ins-cut 20\nat 0.5 lidar-garbage on\n";
  ScriptedVehicle fine(Small(), Script(script), kStart_ns);
  ScriptedVehicle coarse(Small(), Script(script), kStart_ns);
  const Outgoing a = RunFor(fine, 1.0, 1);
  const Outgoing b = RunFor(coarse, 1.0, 20);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.trace, b.trace);
  ASSERT_EQ(a.datagrams.size(), b.datagrams.size());
  for (size_t i = 0; i < a.datagrams.size(); ++i) {
    ASSERT_EQ(a.datagrams[i].bytes, b.datagrams[i].bytes);
  }
}

TEST(ScriptedVehicle, HasEventsAtTheirTimeInAnyOrderOfLines) {
  ScriptedVehicle vehicle(Small(), Script("at 0.6 ins on\nat 0.2 ins off\n"), kStart_ns);
  EXPECT_NEAR(static_cast<double>(Count(RunFor(vehicle, 0.2), Sensor::kIns)), 20.0, 1.0);
  EXPECT_EQ(Count(RunFor(vehicle, 0.39), Sensor::kIns), 0u);
  EXPECT_GT(Count(RunFor(vehicle, 0.2), Sensor::kIns), 17u);
}

TEST(ScriptedVehicle, SpoilsItsDatagramsAsTold) {
  const auto run = [](const std::string& line) {
    ScriptedVehicle vehicle(Small(), Script("at 0 " + line), kStart_ns);
    return RunFor(vehicle, 1.0);
  };
  const size_t usual = Count(run("ins on"), Sensor::kLidar);
  EXPECT_NEAR(static_cast<double>(usual), 320.0, 2.0);
  EXPECT_EQ(Count(run("lidar off"), Sensor::kLidar), 0u);
  EXPECT_EQ(Count(run("lidar-duplicate on"), Sensor::kLidar), 2 * usual);
  EXPECT_EQ(Count(run("lidar-garbage on"), Sensor::kLidar), 2 * usual);
  EXPECT_NEAR(static_cast<double>(Count(run("lidar-loss 500"), Sensor::kLidar)),
              static_cast<double>(usual) / 2.0, 40.0);
  for (const SensorDatagram& datagram : run("lidar-foreign on").datagrams) {
    EXPECT_EQ(datagram.foreign, datagram.sensor == Sensor::kLidar);
  }
}

std::vector<std::vector<uint8_t>> BytesOf(const Outgoing& out, Sensor sensor) {
  std::vector<std::vector<uint8_t>> bytes;
  for (const SensorDatagram& one : out.datagrams) {
    if (one.sensor == sensor) bytes.push_back(one.bytes);
  }
  return bytes;
}

// By 100 ms in each second: what is sent in 1 s comes in 1.1.
TEST(ScriptedVehicle, DelaysItsDatagramsByMoreAndMore) {
  ScriptedVehicle usual(Small(), {}, kStart_ns);
  ScriptedVehicle delayed(Small(), Script("at 0 lidar-delay-growth 100"), kStart_ns);
  const auto all = BytesOf(RunFor(usual, 2.0), Sensor::kLidar);
  const auto some = BytesOf(RunFor(delayed, 2.0), Sensor::kLidar);
  EXPECT_NEAR(static_cast<double>(some.size()), static_cast<double>(all.size()) / 1.1, 4.0);
  EXPECT_TRUE(std::equal(some.begin(), some.end(), all.begin()));
  EXPECT_NEAR(delayed.faults(Sensor::kLidar).delay_s, 0.2, 0.002);
}

TEST(ScriptedVehicle, DelaysItsDatagramsInTheirOrder) {
  ScriptedVehicle usual(Small(), {}, kStart_ns);
  ScriptedVehicle delayed(Small(), Script("at 0 lidar-delay 200\nat 0.5 lidar-delay 0"), kStart_ns);
  const auto all = BytesOf(RunFor(usual, 1.0), Sensor::kLidar);
  EXPECT_EQ(Count(RunFor(delayed, 0.2), Sensor::kLidar), 0u);
  const auto late = BytesOf(RunFor(delayed, 0.3), Sensor::kLidar);
  EXPECT_NEAR(static_cast<double>(late.size()), 0.3 * 320.0, 1.0);
  // What was under way comes before what is not delayed any more.
  auto rest = late;
  for (auto& bytes : BytesOf(RunFor(delayed, 0.5), Sensor::kLidar)) rest.push_back(bytes);
  EXPECT_EQ(rest, all);
}

TEST(ScriptedVehicle, ReordersItsDatagramsAndLosesNone) {
  ScriptedVehicle usual(Small(), {}, kStart_ns);
  ScriptedVehicle mixed(Small(), Script("at 0 ins-reorder 4\nat 0.8 ins-reorder 0"), kStart_ns);
  auto in_order = BytesOf(RunFor(usual, 1.0), Sensor::kIns);
  auto drawn = BytesOf(RunFor(mixed, 1.0), Sensor::kIns);
  EXPECT_NE(drawn, in_order);
  // Nothing gets further than its group.
  for (size_t i = 0; i < 40; ++i) {
    const auto at = std::find(in_order.begin(), in_order.end(), drawn[i]) - in_order.begin();
    EXPECT_EQ(static_cast<size_t>(at) / 4, i / 4) << i;
  }
  std::sort(in_order.begin(), in_order.end());
  std::sort(drawn.begin(), drawn.end());
  EXPECT_EQ(drawn, in_order);
}

TEST(ScriptedVehicle, HasALidarWhoseClockJumps) {
  const auto stamp_ns = [](const std::vector<uint8_t>& legacy) {
    uint64_t stamp = 0;
    for (int byte = 7; byte >= 0; --byte) stamp = stamp << 8 | legacy[static_cast<size_t>(byte)];
    return static_cast<int64_t>(stamp);
  };
  ScriptedVehicle usual(Small(), {}, kStart_ns);
  ScriptedVehicle jumped(Small(), Script("at 0.1 lidar-clock -300\nat 0.5 lidar-clock 1000"),
                         kStart_ns);
  const auto before = BytesOf(RunFor(usual, 1.0), Sensor::kLidar);
  const auto after = BytesOf(RunFor(jumped, 1.0), Sensor::kLidar);
  ASSERT_EQ(before.size(), after.size());
  const auto ahead_ms = [&](size_t i) {
    return (stamp_ns(after[i]) - stamp_ns(before[i])) / 1'000'000;
  };
  EXPECT_EQ(ahead_ms(10), 0);
  EXPECT_EQ(ahead_ms(100), -300);
  EXPECT_EQ(ahead_ms(300), 700);
}

TEST(ScriptedVehicle, NamesWhatItsLidarSees) {
  ScriptedVehicleSettings settings = Small();
  ScriptedVehicle without(settings, {}, kStart_ns);
  EXPECT_EQ(Count(RunFor(without, 0.5), Sensor::kLabels), 0u);
  settings.labels.emplace();
  ScriptedVehicle with(settings, Script("at 0.5 labels off"), kStart_ns);
  const Outgoing out = RunFor(with, 0.5);
  // 512 columns a revolution, 16 a datagram, ten revolutions a second, 60 ms late.
  EXPECT_NEAR(static_cast<double>(Count(out, Sensor::kLabels)), 0.44 * 320.0, 2.0);
  EXPECT_EQ(Count(RunFor(with, 0.5), Sensor::kLabels), 0u);
}

TEST(ScriptedVehicle, StandsInAnotherWorldWhenTold) {
  ScriptedVehicleSettings settings = Small();
  settings.world = world::World();
  ScriptedVehicle vehicle(settings, Script("at 0.2 world corridor\nat 0.4 box 0 0 1 1"), kStart_ns);
  RunFor(vehicle, 0.1);
  EXPECT_TRUE(vehicle.world().bodies().empty());
  RunFor(vehicle, 0.2);
  EXPECT_EQ(vehicle.world().bodies().size(), 3u);
  EXPECT_FALSE(vehicle.collided());
  RunFor(vehicle, 0.2);
  EXPECT_TRUE(vehicle.collided());
}

TEST(ScriptedVehicle, SendsFramesOfANodeThatShouldNotBe) {
  ScriptedVehicle vehicle(Small(), Script("at 0.5 can-frame 202#0f00 0.1 3"), kStart_ns);
  const Outgoing out = RunFor(vehicle, 1.0);
  EXPECT_EQ(std::count(out.frames.begin(), out.frames.end(), MakeFrame(0x202, {0x0f, 0})), 3);
}

TEST(ScriptedVehicle, ReportsErrorsOfTheBusAsItsControllerWould) {
  ScriptedVehicle vehicle(Small(), Script("at 0.1 bus-error bus-off"), kStart_ns);
  const Outgoing out = RunFor(vehicle, 0.2);
  ASSERT_EQ(out.bus_errors.size(), 1u);
  EXPECT_EQ(out.bus_errors[0].error_class, 0x40u);
}

TEST(ScriptedVehicle, AnswersAFrameWithoutWaitingForAStep) {
  ScriptedVehicle vehicle(Small(), {}, kStart_ns);
  RunFor(vehicle, 0.5);
  Outgoing out;
  const uint64_t now_ns = vehicle.now_ns() + 300'000;  // between two steps
  vehicle.TakeFrame(MakeFrame(0x602, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0}), now_ns);
  vehicle.Advance(now_ns, out);
  ASSERT_EQ(out.frames.size(), 1u);
  EXPECT_EQ(out.frames[0], MakeFrame(0x582, {0x43, 0x18, 0x10, 1, 0x1e, 0, 0, 0}));
}

TEST(ScriptedVehicle, TracesWhatItsDrivesDo) {
  ScriptedVehicle vehicle(Small(), Script("at 0.5 fault left 0x2310 3 0x4e01\n"), kStart_ns);
  bool booted = false;
  bool emergency = false;
  bool fault = false;
  int samples = 0;
  for (const std::string& line : RunFor(vehicle, 1.0).trace) {
    const auto entry = nlohmann::json::parse(line);
    const std::string event = entry.value("event", "sample");
    samples += event == "sample";
    booted |= event == "boot-up" && entry["side"] == "right";
    emergency |= event == "emcy" && entry["code"] == 0x2310 && entry["fault_id"] == 0x4e01;
    fault |= event == "state" && entry["side"] == "left" && entry["to"] == "fault";
    if (event == "sample") {
      for (const char* key : {"t", "x", "y", "theta", "v", "w"}) ASSERT_TRUE(entry.contains(key));
      for (const char* key : {"wheel", "command", "nmt", "state", "rpdos"}) {
        ASSERT_TRUE(entry["left"].contains(key)) << key;
      }
    }
  }
  EXPECT_TRUE(booted && emergency && fault);
  EXPECT_NEAR(samples, 50, 1);
  EXPECT_NEAR(nlohmann::json::parse(vehicle.Summary())["seconds"].get<double>(), 1.0, 0.001);
}

}  // namespace
}  // namespace hardpack::sim
