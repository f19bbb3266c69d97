// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/wire/real_time.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <utility>

#include "nlohmann/json.hpp"
#include "tools/sim/script/script.h"

namespace hardpack::wire {

using sim::ScriptedVehicle;

ReadOutcome RealTime::Senders::Open(const std::string& from, const std::string& to,
                                    const std::string& foreign_address) {
  if (to.empty()) return {};
  Endpoint source;
  Endpoint destination;
  for (const ReadOutcome& outcome :
       {ParseEndpoint(from, source), ParseEndpoint(to, destination), own.Open(source, destination),
        foreign.Open({foreign_address, source.port}, destination)}) {
    if (!outcome.ok()) return outcome;
  }
  open = true;
  return {};
}

ReadOutcome RealTime::Open(const Settings& settings) {
  if (!settings.can.empty()) {
    const ReadOutcome outcome = can_.Open(settings.can);
    if (!outcome.ok()) return outcome;
  }
  turn_ns_ = static_cast<uint64_t>(settings.turn_ms) * ScriptedVehicle::kStep_ns;
  if (settings.interactive) lines_.Open(STDIN_FILENO);
  if (!settings.trace.empty()) {
    trace_.open(settings.trace);
    if (!trace_) return {Status::kInvalidArgument, settings.trace + ": cannot be written"};
  }
  const std::pair<std::string, std::string> ways[sim::kSensors] = {
      {settings.lidar_from, settings.lidar_to},
      {settings.ins_from, settings.ins_to},
      {settings.labels_from, settings.labels_to}};
  for (size_t i = 0; i < sim::kSensors; ++i) {
    const ReadOutcome outcome =
        senders_[i].Open(ways[i].first, ways[i].second, settings.foreign_address);
    if (!outcome.ok()) return outcome;
  }
  return {};
}

void RealTime::Begin(const ScriptedVehicle& vehicle) {
  start_ns_ = vehicle.now_ns();
  next_watch_ns_ = start_ns_ + kWatch_ns;
  if (!trace_.is_open()) return;
  trace_ << nlohmann::ordered_json{{"t", 0}, {"event", "start"}, {"monotonic_ns", start_ns_}}
         << '\n';
}

void RealTime::Turn(ScriptedVehicle& vehicle) {
  const uint64_t now_ns = Now_ns();
  NoteLateness(vehicle, now_ns);
  TakeLines(vehicle);
  frames_.clear();
  out_ = sim::Outgoing();
  if (can_.descriptor() >= 0) can_.Receive(frames_);
  for (const ReceivedFrame& one : frames_) {
    const uint64_t time_ns = std::clamp(one.time_ns, vehicle.now_ns(), now_ns);
    if (watcher_) AdvanceTo(vehicle, time_ns);
    vehicle.TakeFrame(one.frame, std::max(time_ns, vehicle.now_ns()));
  }
  AdvanceTo(vehicle, now_ns);
  Send(out_);
  Wait(vehicle.now_ns() + turn_ns_);
}

double RealTime::Since_s(const ScriptedVehicle& vehicle) const {
  return static_cast<double>(vehicle.now_ns() - start_ns_) / 1.0e9;
}

void RealTime::NoteLateness(const ScriptedVehicle& vehicle, uint64_t now_ns) {
  const uint64_t late_ns = now_ns - vehicle.now_ns();
  lateness_.worst_ns = std::max(lateness_.worst_ns, late_ns);
  worst_ever_ns_ = std::max(worst_ever_ns_, late_ns);
  if (late_ns < kLate_ns) return;
  ++lateness_.events;
  if (!trace_.is_open()) return;
  trace_ << nlohmann::ordered_json{{"t", Since_s(vehicle)},
                                   {"event", "late"},
                                   {"ms", late_ns / 1'000'000}}
         << '\n';
}

void RealTime::TakeLines(ScriptedVehicle& vehicle) {
  std::string line;
  while (lines_.Next(line)) {
    std::vector<sim::ScriptEvent> events;
    const ReadOutcome outcome = sim::ParseScriptLine("at 0 " + line, events);
    if (!outcome.ok()) std::cerr << outcome.message << std::endl;
    for (const sim::ScriptEvent& event : events) vehicle.Act(event);
  }
}

void RealTime::AdvanceTo(ScriptedVehicle& vehicle, uint64_t time_ns) {
  for (; watcher_ && next_watch_ns_ <= time_ns; next_watch_ns_ += kWatch_ns) {
    vehicle.Advance(next_watch_ns_, out_);
    watcher_();
  }
  vehicle.Advance(time_ns, out_);
}

void RealTime::Send(const sim::Outgoing& out) {
  if (can_.descriptor() >= 0) {
    for (const CanFrame& frame : out.frames) can_.Send(frame);
    for (const sim::BusError& error : out.bus_errors) can_.Send(error);
  }
  for (const sim::SensorDatagram& datagram : out.datagrams) {
    Senders& senders = senders_[static_cast<size_t>(datagram.sensor)];
    if (senders.open) (datagram.foreign ? senders.foreign : senders.own).Send(datagram.bytes);
  }
  if (!trace_.is_open() || out.trace.empty()) return;
  for (const std::string& line : out.trace) trace_ << line << '\n';
  trace_.flush();  // for who watches it grow
}

// Until then; in turns of one step until a frame comes, if that is earlier.
void RealTime::Wait(uint64_t until_ns) const {
  const uint64_t now_ns = Now_ns();
  const uint64_t left_ns = until_ns > now_ns ? until_ns - now_ns : 0;
  const timespec left = {0, static_cast<long>(std::min(left_ns, turn_ns_))};
  pollfd can = {can_.descriptor(), POLLIN, 0};
  ppoll(&can, turn_ns_ == ScriptedVehicle::kStep_ns ? 1 : 0, &left, nullptr);
}

std::string RealTime::Summary(const ScriptedVehicle& vehicle) const {
  auto summary = nlohmann::ordered_json::parse(vehicle.Summary());
  summary["can"] = {{"received", can_.received}, {"sent", can_.sent}, {"failed", can_.failed}};
  const char* const names[] = {"lidar", "ins", "labels"};
  for (size_t i = 0; i < sim::kSensors; ++i) {
    summary[names[i]] = {{"sent", senders_[i].own.sent},
                         {"foreign", senders_[i].foreign.sent},
                         {"failed", senders_[i].own.failed + senders_[i].foreign.failed}};
  }
  summary["worst_lag_ms"] = static_cast<double>(worst_ever_ns_ / 1000) / 1000.0;
  return summary.dump();
}

}  // namespace hardpack::wire
