// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/lock_step.h"

#include <algorithm>

namespace hardpack::mission {
namespace {

// Most items of each source in a tick, as in the port.
constexpr int kMostPerTick[kInputSources] = {
    TickLimits::kMaxInsDatagrams, TickLimits::kMaxLabelDatagrams, TickLimits::kMaxDatagramsPerTick};
constexpr int64_t kWallClockOffset_ns = 1'795'000'000'000'000'000;
constexpr uint32_t kVehicleAddress = 0x0a000001u;  // 10.0.0.1: nothing is sent there
constexpr uint32_t kSensorAddress[kInputSources] = {0x0a000006u, 0x0a000007u, 0x0a000005u};

InputSource SourceOf(sim::Sensor sensor) {
  switch (sensor) {
    case sim::Sensor::kIns:
      return InputSource::kIns;
    case sim::Sensor::kLabels:
      return InputSource::kLabels;
    case sim::Sensor::kLidar:
      break;
  }
  return InputSource::kLidar;
}

std::span<const uint8_t> BytesOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace

void DescribeDrives(const sim::VehicleSettings& vehicle, DriveParams& drive) {
  drive.left_sign = vehicle.left.sign;
  drive.right_sign = vehicle.right.sign;
  drive.gear_ratio = static_cast<float>(vehicle.left.gear_ratio);
  drive.login_user = vehicle.left.login_user;
  drive.login_password = vehicle.left.login_password;
}

ReadOutcome LockStep::Start(const LockStepSettings& settings) {
  vehicle_ = std::make_unique<sim::ScriptedVehicle>(settings.vehicle, settings.script, now_ns_);
  metadata_ = vehicle_->lidar().MetadataJson();
  // Through text and back, as the onboard program and a replay of the log read it.
  Configuration told = settings.configuration;
  DescribeDrives(settings.vehicle.vehicle, told.onboard.drive);
  told.onboard.safety.operator_timeout_s = 0.0f;  // nobody sits beside a simulation
  told.lidar.address = {kSensorAddress[static_cast<size_t>(InputSource::kLidar)]};
  told.lidar.metadata = "simulated.json";
  told.ins.address = {kSensorAddress[static_cast<size_t>(InputSource::kIns)]};
  told.ins.port = 7520;
  if (settings.vehicle.labels) {
    told.label_source.address = {kSensorAddress[static_cast<size_t>(InputSource::kLabels)]};
  }
  configuration_text_ = ToToml(told);
  ReadOutcome outcome = ParseConfiguration(configuration_text_, "simulation", configuration_);
  if (!outcome.ok()) return outcome;
  const auto lidars = std::make_unique<LidarConfigs>();
  outcome = ParseLidar(configuration_, metadata_, "simulation", *lidars);
  if (!outcome.ok()) return outcome;
  onboard_ = std::make_unique<ChosenVehicle>();
  outcome = onboard_->Configure(configuration_, *lidars);
  if (!outcome.ok()) return {outcome.status, "simulation: " + outcome.message};
  return settings.log.empty() ? ReadOutcome() : StartLog(settings.log);
}

ReadOutcome LockStep::StartLog(const std::string& path) {
  const ReadOutcome outcome = file_.Open(path);
  if (!outcome.ok()) return outcome;
  log_ = std::make_unique<flight_log::FlightLog>(file_, std::span<uint8_t>());
  flight_log::FlightLogSetup setup;
  const AnyVehicle& onboard = *onboard_->get();
  setup.version.state_layout = onboard.state_layout();
  onboard.CopyType(setup.version.vehicle);
  setup.configuration = BytesOf(configuration_text_);
  setup.lidar_metadata = BytesOf(metadata_);
  const uint16_t ports[kInputSources] = {static_cast<uint16_t>(configuration_.ins.port),
                                         static_cast<uint16_t>(configuration_.label_source.port),
                                         static_cast<uint16_t>(configuration_.lidar.port)};
  for (size_t i = 0; i < kInputSources; ++i) {
    setup.sender[i] = {kSensorAddress[i], ports[i]};
    setup.receiver[i] = {kVehicleAddress, ports[i]};
  }
  setup.wall_clock_offset_ns = kWallClockOffset_ns;
  const Status status = log_->Start(setup);
  if (!IsUsable(status)) return {status, path + ": " + StatusName(status)};
  return {};
}

void LockStep::CollectDatagrams() {
  for (sim::SensorDatagram& datagram : sent_.datagrams) {
    if (datagram.foreign) continue;  // the port takes none of them
    waiting_[static_cast<size_t>(SourceOf(datagram.sensor))].push_back(std::move(datagram.bytes));
  }
  taken_.clear();
  datagrams_.clear();
  size_t room = TickLimits::kMaxDatagramsPerTick;
  for (size_t i = 0; i < kInputSources; ++i) {
    size_t left = std::min(room, static_cast<size_t>(kMostPerTick[i]));
    for (; left > 0 && !waiting_[i].empty(); --left, --room) {
      taken_.push_back(std::move(waiting_[i].front()));
      waiting_[i].pop_front();
      datagrams_.push_back({static_cast<InputSource>(i), taken_.back()});
    }
  }
}

Status LockStep::Tick(std::span<const uint8_t> command) {
  now_ns_ += kTick_ns;
  sent_ = sim::Outgoing();
  vehicle_->Advance(now_ns_, sent_);
  CollectDatagrams();
  TickInput input;
  input.index = ++index_;
  input.now_ns = now_ns_;
  input.bus = CanBusState::kActive;
  input.datagrams = datagrams_;
  const size_t frames = std::min<size_t>(sent_.frames.size(), CanBus::kMaxFramesPerTick);
  input.frames = std::span(sent_.frames).first(frames);
  input.command = command;
  AnyVehicle& onboard = *onboard_->get();
  if (log_) log_->BeginTick(input, {}, onboard.state());
  const Status status = onboard.Tick(input, output_);
  if (log_) log_->EndTick({index_, status, pilot().decision_hash(), 0, 0}, output_);
  for (const CanFrame& frame : output_.frames) vehicle_->TakeFrame(frame, now_ns_);
  return status;
}

Status LockStep::Say(const control::OperatorCommand& command) {
  control::OperatorCommand numbered = command;
  numbered.sequence = ++sequence_;
  uint8_t bytes[control::kMaxMessageBytes];
  int size_bytes = 0;
  const Status status = control::Encode(numbered, bytes, size_bytes);
  if (!IsUsable(status)) return status;
  return Tick(std::span(bytes).first(static_cast<size_t>(size_bytes)));
}

ReadOutcome LockStep::End() {
  if (!log_) return {};
  log_->End();
  return file_.Close();
}

}  // namespace hardpack::mission
