// SPDX-License-Identifier: Apache-2.0
// A board of one's own: the interfaces of hal, implemented for it, and hardpack's run loop on them.
// This board has a timer, one CAN controller and a socket for the lidar; nothing is connected. It
// runs for a second, is told to end, and ends once its drives are off.
#include "hal/onboard/run_loop/run_loop.h"
#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "hal/onboard/vehicle_loop/vehicles.h"

#include <cstdio>

using namespace hardpack;

// --- the board ---------------------------------------------------------------------------------

class BoardClock final : public Clock {
 public:
  uint64_t Now_ns() override { return now_ns_; }  // yours: a free-running timer
  void SleepUntil(uint64_t time_ns) override {    // yours: wait for interrupt, until it is so late
    if (time_ns > now_ns_) now_ns_ = time_ns;
  }

 private:
  uint64_t now_ns_ = 1'000'000'000;
};

// A controller whose frames go out at once. One that takes its time keeps what waits, and drops it
// when its deadline has passed.
class BoardCan final : public CanBus {
 public:
  void Advance(uint64_t now_ns) override { now_ns_ = now_ns; }
  Status Send(const CanFrame& frame, uint64_t deadline_ns) override {
    const Status status = !IsValid(frame)          ? Status::kInvalidArgument
                          : deadline_ns <= now_ns_ ? Status::kExpired
                                                   : Status::kOk;
    if (status != Status::kOk) {
      ++counters_.refused;
      return status;
    }
    ++counters_.accepted;  // yours: write it to a mailbox of the controller
    ++counters_.confirmed;
    return Status::kOk;
  }
  Status Receive(CanFrame&) override { return Status::kEmpty; }  // yours: what an interrupt queued
  CanBusState state() const override { return CanBusState::kActive; }
  const CanBusCounters& counters() const override { return counters_; }

 private:
  uint64_t now_ns_ = 0;
  CanBusCounters counters_;
};

class BoardSocket final : public DatagramSocket {
 public:
  std::span<const Datagram> Receive(int) override { return {}; }  // yours: what the stack holds
  const DatagramCounters& counters() const override { return counters_; }

 private:
  DatagramCounters counters_;
};

class BoardWatchdog final : public Watchdog {
 public:
  void Ready() override {}  // yours: start the timer circuit
  void Feed(uint64_t) override { ++fed_; }
  void Stopping() override {}
  uint64_t fed() const override { return fed_; }

 private:
  uint64_t fed_ = 0;
};

// --- the program -------------------------------------------------------------------------------

static VehicleOf<Warthog> vehicle;  // 8 MiB
static BoardClock board_clock;
static BoardCan can;
static BoardSocket lidar;
static BoardWatchdog watchdog;

static Status Describe() {
  static BasicVehicleConfig<Warthog> config;
  config.onboard.drive.left_sign = 1;
  config.onboard.drive.right_sign = -1;
  config.onboard.drive.gear_ratio = 17.3f;
  ouster::Metadata& sensor = config.lidar;
  sensor.beams = 64;
  sensor.columns_per_frame = 1024;
  sensor.columns_per_packet = 16;
  sensor.column_window_last = 1023;
  for (int beam = 0; beam < 64; ++beam) {
    sensor.beam_altitude_deg[beam] = 16.6f - 33.2f * static_cast<float>(beam) / 63.0f;
  }
  return vehicle.loop().Configure(config);
}

// docs/your_board.md: from here
int main() {
  const Status described = Describe();
  if (!IsUsable(described)) {
    std::printf("%s\n", StatusName(described));
    return 1;
  }
  OnboardDevices devices;
  devices.clock = &board_clock;
  devices.can = &can;
  devices.lidar = &lidar;
  devices.watchdog = &watchdog;
  static RunLoop run_loop(vehicle, devices, RunOptions{});
  run_loop.Begin();
  const uint64_t is_told_to_end_ns = board_clock.Now_ns() + 1'000'000'000;
  while (run_loop.Next(board_clock.Now_ns() >= is_told_to_end_ns)) {
  }
  // docs/your_board.md: to here
  const bool has_ended_off = vehicle.DrivesAreOff();
  std::printf("%s: %llu ticks, %s, drives %s\n", vehicle.type(),
              static_cast<unsigned long long>(run_loop.index()),
              can.counters().accepted > 0 ? "frames sent" : "nothing sent",
              has_ended_off ? "off" : "not off");
  return has_ended_off && watchdog.fed() > 0 ? 0 : 1;
}
