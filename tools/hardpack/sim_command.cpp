// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/sim_command.h"

#include <chrono>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>

#include "tools/hardpack/arguments.h"
#include "tools/hardpack/command.h"
#include "tools/hardpack/wire_options.h"
#include "tools/hardpack/world_picture.h"
#include "tools/mission/mission.h"
#include "tools/sim/vehicle_model_file.h"

namespace hardpack::command {
namespace {

using experiment::RunResult;
using mission::MissionSettings;
using mission::MissionTrace;

struct SimOptions {
  std::string world = "gap";
  std::string out;
  std::string configuration;
  std::string vehicle = "warthog_paper";
  bool log = true;
  bool json = false;
  double max_speed_mps = 0.0;
  std::string script;
  WireOptions wire;
  MissionSettings mission;
};

std::string Seconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", seconds);
  return text;
}

DrivenWay DrivenOf(const MissionTrace& trace) {
  DrivenWay driven;
  for (const MissionTrace::Sample& sample : trace.samples) {
    driven.way.push_back({sample.x_m, sample.y_m});
    driven.end_s = sample.t_s;
  }
  for (const MissionTrace::Plan& plan : trace.plans) driven.plans.push_back(plan.path);
  return driven;
}

void WriteOutputs(const SimOptions& options, const MissionSettings& settings,
                  const nlohmann::ordered_json& result, const MissionTrace& trace) {
  WriteText(options.out + "/run.json", result.dump(1) + "\n");
  Require(DrawWorld(settings.scenario, settings.seed, {}, DrivenOf(trace))
              .WritePng(options.out + "/sim.png"));
  std::string events;
  for (const MissionTrace::Event& event : trace.events) {
    events += Seconds(event.t_s) + "  " + event.text + "\n";
  }
  WriteText(options.out + "/events.txt", events);
}

// A name is a file of config/vehicles, anything else a path.
std::string VehiclePath(const std::string& name) {
  if (name.ends_with(".toml")) return name;
  return std::string(HARDPACK_VEHICLES) + "/" + name + ".toml";
}

std::string ReadScript(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw CommandFailure(kBadInput, path + ": cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

MissionSettings SettingsOf(const SimOptions& options) {
  MissionSettings settings = options.mission;
  Require(sim::ReadVehicle(VehiclePath(options.vehicle), settings.vehicle));
  settings.vehicle_name = options.vehicle;
  Require(world::MakeScenario(options.world, settings.seed, settings.scenario));
  if (!options.configuration.empty()) {
    Require(ReadConfiguration(options.configuration, settings.configuration));
  }
  if (options.max_speed_mps > 0.0) {
    settings.configuration.planner.speed.max_speed_mps = static_cast<float>(options.max_speed_mps);
  }
  if (!options.script.empty()) settings.script = ReadScript(options.script);
  if (options.log && !options.out.empty()) settings.log = options.out + "/run.pcap";
  return settings;
}

void RunSim(const SimOptions& options) {
  const MissionSettings settings = SettingsOf(options);
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
  nlohmann::ordered_json json = ToJson(result);
  if (options.wire.on) json["wire"] = ToJson(report, settings.lidar_columns);
  if (!options.out.empty()) WriteOutputs(options, settings, json, trace);
  if (options.json) std::cout << json.dump() << "\n";
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
      "process, faster than real time; with --wire against a hardpackd that runs besides. Exit\n"
      "code 1 when the mission did not end as it should, or real time was not kept.");
  const auto options = std::make_shared<SimOptions>();
  sim->add_option("--world", options->world, "World, see `hardpack world` (default gap)");
  sim->add_option("--seed", options->mission.seed, "Of world, vehicle and noise (default 1)");
  sim->add_option("--planner", options->mission.planner, "optimizer (default) or astar");
  sim->add_option("--tracker", options->mission.tracker, "full (default) or pursuit");
  sim->add_option("--vehicle", options->vehicle,
                  "warthog_paper (default), warthog_recorded, or FILE.toml (docs/simulation.md)");
  sim->add_flag("!--typical", options->mission.spread,
                "The typical vehicle instead of one drawn by the seed");
  sim->add_option("--config", options->configuration, "Configuration (TOML) of the vehicle");
  sim->add_option("--max-speed", options->max_speed_mps, "Instead of the configuration's [m/s]");
  sim->add_option("--limit", options->mission.limit_s, "On the mission's time [s] (default 120)");
  sim->add_option("--lidar-columns", options->mission.lidar_columns,
                  "A revolution: 512, 1024 (default) or 2048");
  sim->add_option(
      "--script", options->script,
      "File of what goes wrong (tools/sim/script.h), at times from the goal's acceptance");
  sim->add_option("--out", options->out,
                  "Folder for run.json, events.txt, sim.png and the flight log run.pcap");
  sim->add_flag("!--no-log", options->log, "No flight log");
  sim->add_flag("--json", options->json, "Print run.json as one line on standard output");
  AddWireOptions(*sim, options->wire);
  sim->callback([options, sim] {
    RequireFitting(*sim, options->wire);
    RunSim(*options);
  });
}

}  // namespace hardpack::command
