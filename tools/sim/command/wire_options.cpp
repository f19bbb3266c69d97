// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/wire_options.h"

#include <csignal>
#include <string>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"

namespace hardpack::command {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void CatchInterrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

double Milliseconds(uint64_t time_ns) {
  return static_cast<double>(time_ns / 1000) / 1000.0;
}

}  // namespace

void AddWireOptions(CLI::App& sim, WireOptions& options) {
  mission::WireMissionSettings& settings = options.settings;
  CLI::Option* wire =
      sim.add_flag("--wire", options.on,
                   "Run in real time over UDP and SocketCAN against a hardpackd that you start\n"
                   "separately, before or after; only hardpackd writes a flight log");
  const auto add = [&](const char* name, auto& value, const char* description) {
    return sim.add_option(name, value, description)->needs(wire);
  };
  wire->needs(add("--can", settings.wire.can, "SocketCAN interface of the drives; required"));
  add("--control", settings.control,
      "hardpackd's control socket (default /run/hardpack/control.sock)");
  add("--write-config", settings.write_configuration,
      "FILE.toml to write for hardpackd: --config, adapted to the simulated vehicle.\n"
      "The lidar's metadata is written to FILE.lidar.json; logs go to the folder flight beside it");
  add("--wait", settings.wait_s, "Time to wait until hardpackd is armed [s] (default 60)")
      ->check(CLI::Range(0.0, 3600.0));
  const auto port = CLI::Range(1, 65535);
  add("--lidar-port", settings.lidar_port, "hardpackd's port on 127.0.0.1 (default 7502)")
      ->check(port);
  add("--ins-port", settings.ins_port, "The same (default 7600)")->check(port);
  add("--turn-ms", settings.wire.turn_ms,
      "Period of polling the sockets, 1 (default) to 20; more where system calls are slow")
      ->check(CLI::Range(1, 20));
  add("--trace", settings.wire.trace, "File of JSON lines that record what the vehicle did");
}

void RequireFitting(const CLI::App& sim, const WireOptions& options) {
  if (!options.on || !options.settings.write_configuration.empty()) return;
  for (const char* name : {"--config", "--planner", "--tracker", "--max-speed"}) {
    if (sim.count(name) == 0) continue;
    throw CommandFailure(kBadInput, std::string(name) +
                                        ": with --wire, hardpackd needs it: add"
                                        " --write-config, and start hardpackd with that file");
  }
}

void RunOverWire(const WireOptions& options, const mission::MissionSettings& mission,
                 experiment::RunResult& result, mission::MissionTrace& trace,
                 mission::WireReport& report) {
  mission::WireMissionSettings settings = options.settings;
  settings.mission = mission;
  CatchInterrupt();
  settings.interrupted = [] { return interrupted != 0; };
  const ReadOutcome outcome = mission::RunWireMission(settings, result, &trace, report);
  // Ended by a signal or refused by hardpackd, not an error of the command line.
  if (outcome.status == Status::kAborted) throw CommandFailure(kWorkFailed, outcome.message);
  Require(outcome);
}

nlohmann::ordered_json ToJson(const mission::WireReport& report, int lidar_columns) {
  const control::ProgramPart& program = report.status.program;
  const control::SafetyPart& safety = report.status.safety;
  return {{"late_events", report.lateness.events},
          {"worst_late_ms", Milliseconds(report.lateness.worst_ns)},
          {"lidar_columns", lidar_columns},
          {"status_reports", report.reports},
          {"hardpackd",
           {{"version", program.version},
            {"ticks", program.tick_index},
            {"missed_ticks", program.missed_ticks},
            {"worst_tick_ms", Milliseconds(program.worst_tick_ns)},
            {"heap_allocations", program.heap_allocations},
            {"reaction_median_s", JsonNumber(safety.reaction_median_s)},
            {"reaction_p99_s", JsonNumber(safety.reaction_p99_s)},
            {"reaction_median_m", JsonNumber(safety.reaction_median_m)},
            {"reaction_p99_m", JsonNumber(safety.reaction_p99_m)}}}};
}

void RequireRealTime(const mission::WireReport& report) {
  if (report.lateness.events == 0) return;
  const auto worst_ms = static_cast<uint64_t>(Milliseconds(report.lateness.worst_ns));
  throw CommandFailure(kWorkFailed,
                       "the simulation did not keep real time: it was late by 50 ms "
                       "or more " +
                           std::to_string(report.lateness.events) + " times, by " +
                           std::to_string(worst_ms) +
                           " ms at worst; use fewer --lidar-columns or a less busy "
                           "computer");
}

}  // namespace hardpack::command
