// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "hal/can_bus.h"
#include "hal/clock.h"
#include "hal/datagram_socket.h"
#include "hal/onboard/control/operator_link.h"
#include "hal/onboard/control/status_report.h"
#include "hal/onboard/flight_log/flight_log.h"
#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "hal/recorder.h"
#include "hal/watchdog.h"

// The small loop that joins the interfaces to a vehicle's tick: waits for the next period, collects
// input, ticks, sends, answers, records. A port implements the interfaces and calls Next; tests run
// it on fakes. Nothing in it blocks except the wait for the next period, and nothing allocates.

namespace hardpack {

// Everything that the loop talks to. Not owned; null where allowed, if there is none.
struct OnboardDevices {
  Clock* clock = nullptr;
  CanBus* can = nullptr;
  DatagramSocket* ins = nullptr;     // may be null
  DatagramSocket* labels = nullptr;  // may be null
  DatagramSocket* lidar = nullptr;
  Recorder* recorder = nullptr;                 // may be null
  flight_log::FlightLog* flight_log = nullptr;  // may be null
  Watchdog* watchdog = nullptr;                 // may be null
  OperatorLink* control = nullptr;              // may be null
};

struct RunOptions {
  int32_t period_ms = 10;              // 1 .. kMaxDivisor (core/base/wide_int.h)
  uint64_t frame_age_ns = 20'000'000;  // a frame not on the bus by then is not sent
  // Longest time for the vehicle to come to rest, and the drives to be disabled, at the end.
  uint64_t max_stop_ns = 10'000'000'000;
  std::span<const char> version;        // for status
  std::span<const uint8_t> parameters;  // the configuration as TOML, for `hardpack ctl params`
  bool realtime_scheduled = false;      // for status
  bool memory_locked = false;
  uint64_t (*allocations)() = nullptr;  // since the first tick, for status
};

class RunLoop {
 public:
  RunLoop(AnyVehicle& vehicle, const OnboardDevices& devices, const RunOptions& options);

  // Drops earlier data in the sensors' sockets. Once, before the first Next.
  void Begin();

  // Waits for the next period and ticks; a late tick is skipped and counted, not caught up. From
  // the first call with `is_to_end` on, it brings the vehicle to rest and disables the drives;
  // meanwhile questions are answered, an emergency stop is obeyed, and commands that would make the
  // vehicle drive are refused. False: this is done, or RunOptions::max_stop_ns is over; call
  // nothing more.
  //
  //   run_loop.Begin();
  //   while (run_loop.Next(stop)) {
  //   }
  bool Next(bool is_to_end);

  // One tick at now_ns; `skipped` were missed before it. For tests; Next calls it.
  void Tick(uint64_t now_ns, uint64_t skipped);

  // The operator's status report, as of the last tick.
  void Report(control::StatusReport& report) const;

  uint64_t index() const { return index_; }

 private:
  uint64_t NoteLateness(uint64_t late_ns);
  bool IsOff() const;
  void TakeFrames();
  void TakeDatagrams(DatagramSocket* socket, InputSource source, int max);
  void TakeMessage();
  void TakeCommand();
  void Answer(int size_bytes);
  void AnswerStatus();
  void AnswerParameters();
  void AnswerCommand();
  int SendFrames();
  void NoteDuration(uint64_t now_ns);

  AnyVehicle& vehicle_;
  OnboardDevices devices_;
  RunOptions options_;

  uint64_t first_ns_ = 0;
  uint64_t due_ns_ = 0;   // the next tick
  uint64_t ends_ns_ = 0;  // at the latest, once ending
  uint64_t index_ = 0;
  bool ending_ = false;  // the next ticks' command is our disarm, unless an emergency stop
  control::ProgramPart program_;

  // Data of one tick.
  TickInput input_;
  TickOutput output_;
  int32_t frame_count_ = 0;
  int32_t datagram_count_ = 0;
  CanFrame frames_[CanBus::kMaxFramesPerTick];
  uint64_t full_since_ns_[kInputSources] = {};  // batches full since; 0: the last was not full
  TickDatagram datagrams_[TickLimits::kMaxDatagramsPerTick];
  flight_log::Arrival arrivals_[TickLimits::kMaxDatagramsPerTick];
  bool has_command_ = false;
  ControlMessage message_;
  control::OperatorCommand disarm_;  // our own, to end
  uint8_t disarm_bytes_[control::kMaxMessageBytes] = {};
  control::StatusReport report_;
  uint8_t answer_[control::kMaxMessageBytes] = {};
};

}  // namespace hardpack
