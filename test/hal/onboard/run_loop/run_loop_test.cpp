// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/run_loop/run_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "test/fakes/memory_datagram_socket.h"
#include "test/fakes/memory_operator_link.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// The run loop of a simulated vehicle: what it drops, and how it ends.

namespace hardpack {
namespace {

using control::Kind;
using testing::ClosedLoop;

// The vehicle's bus, sensors and time: sleeping lets it move on.
class SimulatedDevices final : public Clock, public CanBus {
 public:
  explicit SimulatedDevices(ClosedLoop& drive) : drive_(drive), now_ns_(drive.now_ns()) {}

  uint64_t Now_ns() override { return now_ns_; }
  void SleepUntil(uint64_t time_ns) override {
    if (on_sleep) on_sleep();
    if (time_ns > now_ns_) now_ns_ = time_ns;
    now_ns_ += std::exchange(late_ns, 0);
  }
  uint64_t late_ns = 0;            // that the next sleep ends
  std::function<void()> on_sleep;  // before each
  void Advance(uint64_t now_ns) override {
    sim::Outgoing out;
    drive_.vehicle().Advance(now_ns, out);
    frames_.insert(frames_.end(), out.frames.begin(), out.frames.end());
  }
  Status Send(const CanFrame& frame, uint64_t /*deadline_ns*/) override {
    drive_.vehicle().TakeFrame(frame, now_ns_);
    return Status::kOk;
  }
  Status Receive(CanFrame& frame) override {
    if (frames_.empty()) return Status::kEmpty;
    frame = frames_.front();
    frames_.pop_front();
    return Status::kOk;
  }
  CanBusState state() const override { return CanBusState::kActive; }
  const CanBusCounters& counters() const override { return counters_; }

 private:
  ClosedLoop& drive_;
  uint64_t now_ns_;
  std::deque<CanFrame> frames_;
  CanBusCounters counters_;
};

class NothingComes final : public DatagramSocket {
 public:
  std::span<const Datagram> Receive(int /*max*/) override { return {}; }
  const DatagramCounters& counters() const override { return counters_; }

 private:
  DatagramCounters counters_;
};

// The least that a run loop needs.
OnboardDevices DevicesOf(SimulatedDevices& simulated, DatagramSocket& lidar) {
  OnboardDevices devices;
  devices.clock = &simulated;
  devices.can = &simulated;
  devices.lidar = &lidar;
  return devices;
}

void RunToTheEnd(RunLoop& run_loop) {
  run_loop.Begin();
  while (run_loop.Next(true)) {
  }
}

// Told to end at once. Returns after how much simulated time it had ended.
double EndAfter_s(ClosedLoop& drive) {
  SimulatedDevices simulated(drive);
  NothingComes lidar;
  OnboardDevices devices = DevicesOf(simulated, lidar);
  const auto run_loop = std::make_unique<RunLoop>(drive.onboard(), devices, RunOptions{});
  const uint64_t begin_ns = simulated.Now_ns();
  simulated.SleepUntil(begin_ns + ClosedLoop::kTick_ns);
  run_loop->Tick(simulated.Now_ns(), drive.loop().index());  // its count goes on from there
  RunToTheEnd(*run_loop);
  return static_cast<double>(simulated.Now_ns() - begin_ns) * 1e-9;
}

void ExpectOff(ClosedLoop& drive) {
  EXPECT_LT(std::fabs(drive.Speed_mps()), 0.05);
  for (const sim::Side side : {sim::Side::kLeft, sim::Side::kRight}) {
    EXPECT_NE(drive.vehicle().vehicle().drive(side).power_state(), sim::PowerState::kEnabled);
  }
}

// They are counted, and not caught up: the next one is due at the next whole period.
TEST(RunLoop, SkipsTheTicksThatItIsTooLateFor) {
  for (const int32_t period_ms : {5, 10, 100}) {
    ClosedLoop drive;
    SimulatedDevices simulated(drive);
    NothingComes lidar;
    OnboardDevices devices = DevicesOf(simulated, lidar);
    RunOptions options;
    options.period_ms = period_ms;
    const auto run_loop = std::make_unique<RunLoop>(drive.onboard(), devices, options);
    const auto period_ns = static_cast<uint64_t>(period_ms) * 1'000'000u;
    const uint64_t begin_ns = simulated.Now_ns();
    run_loop->Begin();
    uint64_t due_ns = begin_ns + period_ns;
    uint64_t missed = 0;
    for (const uint64_t late_ns : {uint64_t{0}, period_ns - 1, period_ns, 2 * period_ns + 1,
                                   uint64_t{10'000'000'000u}, uint64_t{0}}) {
      simulated.late_ns = late_ns;
      ASSERT_TRUE(run_loop->Next(false));
      EXPECT_EQ(simulated.Now_ns(), due_ns + late_ns);
      missed += late_ns / period_ns;
      due_ns += (late_ns / period_ns + 1) * period_ns;
    }
    control::StatusReport report;
    run_loop->Report(report);
    EXPECT_EQ(report.program.missed_ticks, missed) << period_ms;
    EXPECT_EQ(report.program.worst_late_ns, 10'000'000'000u);
    EXPECT_EQ(run_loop->index(), 6u + missed);
  }
}

// It would be taken for having come just now.
// SR-INP06
TEST(RunLoop, DropsWhatCameBeforeTheFirstTick) {
  ClosedLoop drive;
  SimulatedDevices simulated(drive);
  fakes::MemoryDatagramSocket ins(0x7f000001u, 0);
  fakes::MemoryDatagramSocket labels(0x7f000001u, 0);
  fakes::MemoryDatagramSocket lidar(0x7f000001u, 0);
  const std::vector<uint8_t> bytes(100, 0xfa);
  for (fakes::MemoryDatagramSocket* socket : {&ins, &labels, &lidar}) {
    for (int i = 0; i < 2 * DatagramSocket::kMaxBatch + 1; ++i) socket->Deliver(bytes);
  }
  OnboardDevices devices = DevicesOf(simulated, lidar);
  devices.ins = &ins;
  devices.labels = &labels;
  const auto run_loop = std::make_unique<RunLoop>(drive.onboard(), devices, RunOptions{});
  RunToTheEnd(*run_loop);
  EXPECT_GT(drive.loop().counters().ticks, 0u);
  for (const uint64_t datagrams : drive.loop().counters().datagrams) EXPECT_EQ(datagrams, 0u);
}

// Ticks in which so many datagrams of one sensor come in.
struct Flood {
  ClosedLoop drive;
  SimulatedDevices simulated{drive};
  fakes::MemoryDatagramSocket ins{0x7f000001u, 0};
  fakes::MemoryDatagramSocket lidar{0x7f000001u, 0};
  OnboardDevices devices = DevicesOf(simulated, lidar);
  std::unique_ptr<RunLoop> run_loop;
  control::StatusReport report;

  Flood() {
    devices.ins = &ins;
    run_loop = std::make_unique<RunLoop>(drive.onboard(), devices, RunOptions{});
  }
  void Tick(fakes::MemoryDatagramSocket& socket, int datagrams) {
    const std::vector<uint8_t> bytes(100, 0xfa);
    for (int i = 0; i < datagrams; ++i) socket.Deliver(bytes);
    simulated.SleepUntil(simulated.Now_ns() + ClosedLoop::kTick_ns);
    run_loop->Tick(simulated.Now_ns(), 0);
    run_loop->Report(report);
  }
  uint64_t Taken(InputSource source) {
    return drive.loop().counters().datagrams[static_cast<size_t>(source)];
  }
};

// More than a tick takes, tick for tick: what waits would come later and later, and look new.
// SR-INP06
TEST(RunLoop, DropsWhatWaitsForLong) {
  Flood flood;
  constexpr int kTicks = 1000;
  constexpr uint64_t kEach = VehicleLoop::kMaxInsDatagrams + 1;
  uint64_t most_waiting = 0;
  for (uint64_t tick = 1; tick <= kTicks; ++tick) {
    flood.Tick(flood.ins, static_cast<int>(kEach));
    const uint64_t waiting =
        tick * kEach - flood.Taken(InputSource::kIns) - flood.report.program.dropped_datagrams;
    most_waiting = std::max(most_waiting, waiting);
  }
  EXPECT_LE(most_waiting, 11u);  // one more each tick, for 0.1 s
  EXPECT_GT(flood.report.program.dropped_datagrams, 0u);
  EXPECT_GT(flood.Taken(InputSource::kIns), kTicks * (kEach - 1) * 8 / 10);
}

// So does what others send, which is not given on.
// SR-INP06
TEST(RunLoop, DropsWhatWaitsBehindForeignDatagrams) {
  Flood flood;
  const std::vector<uint8_t> bytes(100, 0xfa);
  for (int tick = 0; tick < 100; ++tick) {
    for (int i = 0; i < 50; ++i) flood.lidar.Deliver(bytes, 0x0a000099u, 7502);
    flood.Tick(flood.lidar, 1);
  }
  EXPECT_GT(flood.report.program.dropped_datagrams, 0u);
  // The last of them came within the last 0.1 s and a tick.
  EXPECT_GE(flood.Taken(InputSource::kLidar) + flood.report.program.dropped_datagrams, 89u);
}

// A burst, as after a late tick, is made up for and nothing of it dropped.
// SR-INP06
TEST(RunLoop, MakesUpForABurst) {
  Flood flood;
  flood.Tick(flood.lidar, 150);
  for (int tick = 0; tick < 50; ++tick) flood.Tick(flood.lidar, 6);
  EXPECT_EQ(flood.report.program.dropped_datagrams, 0u);
  EXPECT_EQ(flood.Taken(InputSource::kLidar), 150u + 50u * 6u);
}

// SR-PGM01
TEST(RunLoop, EndsFromDrivingAtRestWithTheDrivesOff) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  EXPECT_LT(EndAfter_s(drive), 9.0);
  ExpectOff(drive);
}

// SR-PGM01
TEST(RunLoop, EndsFromAnEmergencyStopThatStillRollsAtRestWithTheDrivesOff) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  ASSERT_EQ(drive.Say(Kind::kEmergencyStop), Status::kOk);
  ASSERT_GT(drive.Speed_mps(), 1.5);
  EXPECT_LT(EndAfter_s(drive), 9.0);
  ExpectOff(drive);
}

std::vector<uint8_t> Encoded(Kind kind) {
  control::OperatorCommand command;
  command.kind = kind;
  std::vector<uint8_t> bytes(control::kMaxMessageBytes);
  int size_bytes = 0;
  EXPECT_EQ(control::Encode(command, bytes, size_bytes), Status::kOk);
  bytes.resize(static_cast<size_t>(size_bytes));
  return bytes;
}

// kEmpty: nothing more was answered.
Status NextAnswer(fakes::MemoryOperatorLink& link, size_t client) {
  const std::vector<uint8_t> bytes = link.Read(client);
  control::Done done;
  return control::Decode(bytes, done) == Status::kOk ? done.status : Status::kEmpty;
}

// SR-STP01: an emergency stop 0.1 s after it was told to end, at 3 m/s: it is read, obeyed and
// answered; what would make the vehicle drive is refused.
TEST(RunLoop, ObeysAnEmergencyStopWhileItEnds) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 3.0; }));
  fakes::MemoryOperatorLink link;
  const size_t client = link.Connect();
  SimulatedDevices simulated(drive);
  NothingComes lidar;
  OnboardDevices devices = DevicesOf(simulated, lidar);
  devices.control = &link;
  const auto run_loop = std::make_unique<RunLoop>(drive.onboard(), devices, RunOptions{});
  simulated.SleepUntil(simulated.Now_ns() + ClosedLoop::kTick_ns);
  run_loop->Tick(simulated.Now_ns(), drive.loop().index());
  const std::map<int, Kind> said = {{8, Kind::kArm}, {9, Kind::kStop}, {10, Kind::kEmergencyStop}};
  int tick = 0;
  std::map<int, Motion> motions;
  simulated.on_sleep = [&] {
    motions[tick] = drive.loop().permission().motion;
    const auto found = said.find(++tick);
    if (found != said.end()) link.Say(client, Encoded(found->second));
  };
  const double x_m = drive.Pose().x_m;
  RunToTheEnd(*run_loop);
  EXPECT_EQ(motions[9], Motion::kStopAlong);
  EXPECT_EQ(motions[10], Motion::kOff);  // zero at once
  EXPECT_EQ(NextAnswer(link, client), Status::kNotPermitted);
  EXPECT_EQ(NextAnswer(link, client), Status::kOk);
  EXPECT_EQ(NextAnswer(link, client), Status::kOk);
  EXPECT_EQ(NextAnswer(link, client), Status::kEmpty);
  EXPECT_EQ(drive.loop().supervisor().last_stop(), StopReason::kEmergency);
  ExpectOff(drive);
  EXPECT_LT(drive.Pose().x_m - x_m, 3.0);
}

// SR-PGM01
TEST(RunLoop, EndsArmedWithTheDrivesOffAndStandbyAtOnce) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  EXPECT_LT(EndAfter_s(drive), 2.0);
  ExpectOff(drive);
  EXPECT_LT(EndAfter_s(drive), 0.1);
}

// Nobody to wait for: but not for ever either.
// SR-PGM01
TEST(RunLoop, EndsThoughTheDrivesAreSilent) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.Act("at 0 key both off");
  const double after_s = EndAfter_s(drive);
  EXPECT_LT(after_s, 7.0);
  EXPECT_GT(after_s, 1.0);
}

}  // namespace
}  // namespace hardpack
