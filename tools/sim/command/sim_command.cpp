// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/sim_command.h"

#include <chrono>
#include <iostream>
#include <memory>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/sim/command/mission_options.h"
#include "tools/sim/command/wire_options.h"
#include "tools/sim/command/world_picture.h"
#include "tools/sim/mission/mission.h"
#include "tools/sim/mission/page.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::command {
namespace {

using experiment::RunResult;
using mission::MissionSettings;
using mission::MissionTrace;

struct SimOptions {
  std::string world = "gap";
  std::string out;
  bool log = true;
  bool replay = false;
  bool json = false;
  WireOptions wire;
  MissionOptions mission;
};

std::string Seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", seconds);
  return text;
}

void WriteOutputs(const SimOptions& options, const MissionSettings& settings,
                  const nlohmann::ordered_json& json, const RunResult& result,
                  const MissionTrace& trace) {
  WriteText(options.out + "/run.json", json.dump(1) + "\n");
  Require(DrawWorld(settings.scenario, settings.seed, {}, DrivenOf(settings, trace))
              .WritePng(options.out + "/sim.png"));
  std::string events;
  for (const MissionTrace::Event& event : trace.events) {
    events += Seconds(event.t_s) + "  " + event.text + "\n";
  }
  WriteText(options.out + "/events.txt", events);
  WriteText(options.out + "/page.html",
            mission::PageOf(mission::PageData(settings, result, trace)));
}

MissionSettings SettingsOf(const SimOptions& options) {
  MissionSettings settings = SettingsOf(options.mission);
  settings.scenario = ScenarioOf(options.world, settings.seed, options.mission.scenario);
  SetWaypoints(options.mission, settings);
  if (options.log && !options.out.empty()) settings.log = options.out + "/run.pcap";
  return settings;
}

void RunSim(const SimOptions& options) {
  const MissionSettings settings = SettingsOf(options);
  if (options.replay && (settings.log.empty() || options.wire.on)) {
    throw CommandFailure(kBadInput,
                         "--replay needs --out and a flight log, which --wire does not write");
  }
  if (!options.out.empty()) MakeOutputFolder(options.out);
  RunResult result;
  MissionTrace trace;
  mission::WireReport report;
  const auto begin = std::chrono::steady_clock::now();
  if (options.wire.on) {
    RunOverWire(options.wire, settings, result, trace, report);
  } else {
    Require(mission::RunMission(settings, result, &trace));
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::string difference;
  if (options.replay) {
    Require(mission::ReplaysTheSame(settings.log, result.decision_hash, difference));
    result.replayed = difference.empty();
  }
  nlohmann::ordered_json json = ToJson(result);
  if (options.wire.on) json["wire"] = ToJson(report, settings.lidar_columns);
  if (!options.out.empty()) WriteOutputs(options, settings, json, result, trace);
  if (options.json) std::cout << json.dump() << "\n";
  if (!difference.empty()) {
    throw CommandFailure(kWorkFailed, "the log does not replay: " + difference);
  }
  if (options.wire.on) RequireRealTime(report);
  if (!result.success) {
    throw CommandFailure(kWorkFailed, std::string(experiment::Name(result.outcome)) + " after " +
                                          Seconds(result.time_s) + ", reason " + result.reason);
  }
  if (!options.json) {
    std::cout << "ok: " << experiment::Name(result.outcome) << " after " << Seconds(result.time_s)
              << (options.wire.on ? "" : ", computed in " + Seconds(took.count())) << "\n";
  }
}

}  // namespace

void AddSimCommand(CLI::App& app) {
  CLI::App* sim = app.add_subcommand(
      "sim",
      "Drive one mission in a simulated world: the onboard program's loop and a vehicle in one\n"
      "process, faster than real time; with --wire, against a separate hardpackd. Exit code 1 if\n"
      "the mission did not end as it should or the simulation did not keep real time.");
  const auto options = std::make_shared<SimOptions>();
  sim->add_option("--world", options->world,
                  "World (see `hardpack world`) or map.yaml (default gap)");
  sim->add_option("--seed", options->mission.mission.seed,
                  "Seed of world, vehicle and noise (default 1)");
  AddMissionOptions(*sim, options->mission);
  sim->add_option("--out", options->out,
                  "Folder for page.html, which shows the mission in a browser, run.json,\n"
                  "events.txt, sim.png and the flight log run.pcap");
  sim->add_flag("!--no-log", options->log, "Write no flight log");
  sim->add_flag("--replay", options->replay,
                "Replay the log afterwards and check that every tick decides the same");
  sim->add_flag("--json", options->json, "Print run.json as one line on standard output");
  AddWireOptions(*sim, options->wire);
  sim->callback([options, sim] {
    RequireFitting(*sim, options->wire);
    RunSim(*options);
  });
}

}  // namespace hardpack::command
