// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/wire_mission.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

#include "tools/sim/mission/lock_step.h"
#include "tools/sim/mission/observer.h"
#include "tools/sim/mission/wire_operator.h"
#include "tools/sim/script/script.h"

namespace hardpack::mission {
namespace {

using experiment::Outcome;
using experiment::RunResult;
using Phase = WireOperator::Phase;

constexpr double kWireRest_mps = 0.03;
constexpr double kRestLimit_s = 15.0;

std::string OnLoopback(int port) {
  return "127.0.0.1:" + std::to_string(port);
}

ReadOutcome WriteFile(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  if (file.flush()) return {};
  return {Status::kInvalidArgument, path.string() + ": cannot be written"};
}

// Writes the configuration that connects hardpackd to the simulated vehicle.
ReadOutcome WriteConfiguration(const WireMissionSettings& settings,
                               const sim::ScriptedVehicleSettings& vehicle,
                               Configuration configuration) {
  const std::filesystem::path path = std::filesystem::absolute(settings.write_configuration);
  std::filesystem::path metadata = path;
  metadata.replace_extension("lidar.json");
  const Ipv4Address loopback = {0x7f000001u};
  DescribeDrives(vehicle.vehicle, configuration.onboard.drive);
  configuration.onboard.safety.operator_timeout_s = 0.0f;  // nobody sits beside a simulation
  configuration.lidar.address = loopback;
  configuration.lidar.port = settings.lidar_port;
  configuration.lidar.metadata = metadata.string();
  configuration.ins.address = loopback;
  configuration.ins.port = settings.ins_port;
  if (vehicle.labels) {
    configuration.label_source.address = loopback;
    configuration.label_source.port = settings.label_port;
  }
  if (!settings.wire.can.empty()) configuration.can.interface = settings.wire.can;
  configuration.control.socket = settings.control;
  // A developer's computer may not permit larger socket buffers, or have space for many logs.
  configuration.lidar.require_receive_buffer = false;
  configuration.ins.require_receive_buffer = false;
  configuration.label_source.require_receive_buffer = false;
  configuration.log.min_free_mb = 0;
  if (configuration.log.directory == LogConfiguration{}.directory) {
    configuration.log.directory = (path.parent_path() / "flight").string();
  }
  const std::string text = ToToml(configuration);
  Configuration read;
  ReadOutcome outcome = ParseConfiguration(text, path.string(), read);
  if (!outcome.ok()) return outcome;
  outcome = WriteFile(path, text);
  if (!outcome.ok()) return outcome;
  return WriteFile(metadata, sim::SimLidar(vehicle.lidar, 0).MetadataJson());
}

// One run, between the clock's turns and the operator's thread.
class WireRun {
 public:
  WireRun(const WireMissionSettings& settings, RunResult& result, MissionTrace* trace)
      : settings_(settings), result_(result), trace_(trace) {}

  ReadOutcome Open();
  ReadOutcome Drive();
  WireReport Report() const;

 private:
  bool Interrupted() const { return settings_.interrupted && settings_.interrupted(); }
  double Time_s() const { return static_cast<double>(vehicle_->now_ns() - start_ns_) * 1.0e-9; }
  Moment Now() const;
  void Watch();
  void Mission();
  void ComeToRest();

  const WireMissionSettings& settings_;
  RunResult& result_;
  MissionTrace* trace_;
  std::vector<sim::ScriptEvent> script_;
  size_t next_event_ = 0;
  wire::RealTime real_time_;
  std::unique_ptr<sim::ScriptedVehicle> vehicle_;
  std::unique_ptr<WireOperator> operator_;
  std::unique_ptr<Observer> observer_;
  WireOperator::Said said_;
  wire::Lateness lateness_;
  uint64_t start_ns_ = 0;
  double goal_s_ = 0.0;
};

ReadOutcome WireRun::Open() {
  sim::ScriptedVehicleSettings vehicle;
  Configuration configuration;
  ReadOutcome outcome = DescribeMission(settings_.mission, vehicle, configuration);
  if (!outcome.ok()) return outcome;
  outcome = sim::ParseScript(settings_.mission.scenario.script + settings_.mission.script, "script",
                             script_);
  if (!outcome.ok()) return outcome;
  if (!settings_.write_configuration.empty()) {
    outcome = WriteConfiguration(settings_, vehicle, configuration);
    if (!outcome.ok()) return outcome;
  }
  wire::Settings wire = settings_.wire;
  wire.lidar_to = OnLoopback(settings_.lidar_port);
  wire.ins_to = OnLoopback(settings_.ins_port);
  if (vehicle.labels) wire.labels_to = OnLoopback(settings_.label_port);
  outcome = real_time_.Open(wire);
  if (!outcome.ok()) return outcome;
  if (wire.trace.empty()) vehicle.trace_period_s = 0.0;
  operator_ =
      std::make_unique<WireOperator>(settings_.control, settings_.wait_s, vehicle.vehicle.start,
                                     settings_.mission.scenario.goal, settings_.mission.waypoints);
  start_ns_ = wire::Now_ns();
  vehicle_ =
      std::make_unique<sim::ScriptedVehicle>(vehicle, std::vector<sim::ScriptEvent>(), start_ns_);
  return {};
}

Moment WireRun::Now() const {
  const control::StatusReport& status = said_.status;
  Moment now;
  now.time_s = Time_s();
  now.vehicle = vehicle_.get();
  now.mode = static_cast<Mode>(status.vehicle.mode);
  now.reason = static_cast<StopReason>(status.vehicle.stop_reason);
  now.goals = status.goal.goals;
  now.plan = status.plan.number;
  now.commanded_mps = double{status.vehicle.commanded_speed_mps};
  now.commanded_yaw_radps = double{status.vehicle.commanded_yaw_rate_radps};
  now.reaction_m = double{status.safety.reaction_median_m};
  return now;
}

void WireRun::Watch() {
  said_ = operator_->said();
  for (; next_event_ < script_.size() && script_[next_event_].at_s <= Time_s() - goal_s_;
       ++next_event_) {
    vehicle_->Act(script_[next_event_]);
  }
  if (!observer_->ended()) observer_->Watch(Now());
}

// From the goal's acceptance on.
void WireRun::Mission() {
  goal_s_ = Time_s();
  observer_ = std::make_unique<Observer>(settings_.mission.scenario, result_, trace_, goal_s_);
  real_time_.ForgetLateness();
  real_time_.Watch([this] { Watch(); });
  while (!observer_->ended() && said_.phase == Phase::kDriving && !Interrupted() &&
         Time_s() - goal_s_ < settings_.mission.limit_s) {
    real_time_.Turn(*vehicle_);
  }
  if (!observer_->ended() && said_.phase == Phase::kLost) {
    result_.outcome = Outcome::kFault;
    result_.reason = "hardpackd is gone";
  }
}

// The vehicle is not left enabled, and contact on its way to rest still counts.
void WireRun::ComeToRest() {
  real_time_.Watch([this] {
    said_ = operator_->said();
    observer_->WatchRest(Now());
  });
  operator_->Leave();
  const double until_s = Time_s() + kRestLimit_s;
  const auto rests = [this] { return std::fabs(vehicle_->vehicle().speed_mps()) < kWireRest_mps; };
  while ((said_.phase != Phase::kLeft || !rests()) && Time_s() < until_s) {
    real_time_.Turn(*vehicle_);
  }
}

ReadOutcome WireRun::Drive() {
  real_time_.Begin(*vehicle_);
  operator_->Start();
  while (said_.phase == Phase::kWaiting && !Interrupted()) {
    real_time_.Turn(*vehicle_);
    said_ = operator_->said();
  }
  if (said_.phase == Phase::kRefused) return {Status::kAborted, said_.message};
  if (said_.phase == Phase::kWaiting) return {Status::kAborted, "interrupted"};
  Mission();
  lateness_ = real_time_.lateness();
  ComeToRest();
  observer_->Finish(said_.status.program.decision_hash);
  result_.driven_m = vehicle_->vehicle().driven_m();
  result_.success = result_.outcome == WantedOutcome(settings_.mission.scenario.name);
  return {};
}

WireReport WireRun::Report() const {
  return {lateness_, said_.reports, said_.status};
}

}  // namespace

ReadOutcome RunWireMission(const WireMissionSettings& settings, RunResult& result,
                           MissionTrace* trace, WireReport& report) {
  result = ResultOf(settings.mission);
  WireRun run(settings, result, trace);
  ReadOutcome outcome = run.Open();
  if (outcome.ok()) outcome = run.Drive();
  report = run.Report();
  return outcome;
}

}  // namespace hardpack::mission
