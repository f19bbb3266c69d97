// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "hal/onboard/flight_log/flight_log.h"
#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "port_linux/chosen_vehicle.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/read_outcome.h"
#include "tools/sim/mission/capture_file.h"
#include "tools/sim/script/scripted_vehicle.h"

// The onboard program's vehicle loop and a simulated vehicle in lock step in one process, with 100
// ticks per simulated second, as fast as possible. Everything the vehicle has sent by a tick is
// that tick's input, and the vehicle receives the tick's output immediately. The same settings give
// the same decisions, bit for bit, and the log can be replayed (`hardpack replay`).

namespace hardpack::mission {

struct LockStepSettings {
  sim::ScriptedVehicleSettings vehicle;
  std::vector<sim::ScriptEvent> script;
  Configuration configuration;  // the drives' numbers are taken from `vehicle`
  std::string log;              // path of the flight log; empty: none is written
};

// Sets the drive parameters of the onboard program for the vehicle.
void DescribeDrives(const sim::VehicleSettings& vehicle, DriveParams& drive);

class LockStep {
 public:
  static constexpr uint64_t kTick_ns = 10'000'000;
  static constexpr uint64_t kStart_ns = 100'000'000'000;  // of both clocks

  // Failures: a configuration that does not pass its own checks, a log that cannot be written.
  // Call once.
  ReadOutcome Start(const LockStepSettings& settings);

  // One tick, with or without an operator's command.
  Status Tick(std::span<const uint8_t> command = {});
  // A tick with that command; the answer is in output().
  Status Say(const control::OperatorCommand& command);

  // Writes the log's end.
  ReadOutcome End();

  const AnyVehicle& onboard() const { return *onboard_->get(); }
  const Pilot& pilot() const { return onboard_->get()->pilot(); }
  sim::ScriptedVehicle& vehicle() { return *vehicle_; }
  const sim::ScriptedVehicle& vehicle() const { return *vehicle_; }
  const world::World& world() const { return vehicle_->world(); }
  const TickOutput& output() const { return output_; }
  const std::vector<std::string>& trace() const { return sent_.trace; }  // of the last tick
  const Configuration& configuration() const { return configuration_; }
  double time_s() const { return static_cast<double>(now_ns_ - kStart_ns) * 1.0e-9; }

 private:
  ReadOutcome StartLog(const std::string& path);
  void CollectDatagrams();

  Configuration configuration_;
  std::string configuration_text_;
  std::string metadata_;
  std::unique_ptr<sim::ScriptedVehicle> vehicle_;
  std::unique_ptr<ChosenVehicle> onboard_;
  CaptureFile file_;
  std::unique_ptr<flight_log::FlightLog> log_;
  uint64_t now_ns_ = kStart_ns;
  uint64_t index_ = 0;
  uint32_t sequence_ = 0;
  sim::Outgoing sent_;
  // For each source, the input not taken by any tick yet, and the input of the last tick.
  std::deque<std::vector<uint8_t>> waiting_[kInputSources];
  std::vector<std::vector<uint8_t>> taken_;
  std::vector<TickDatagram> datagrams_;
  TickOutput output_;
};

}  // namespace hardpack::mission
