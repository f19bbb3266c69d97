// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/mission_options.h"

#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "port_linux/files/area_file.h"
#include "port_linux/hardpackctl/waypoints.h"
#include "tools/sim/script/script.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::sim {

// config/vehicles, embedded into the program by tools/cmake/embed_text.cmake.
extern const std::string_view kWarthogPaper;
extern const std::string_view kWarthogRecorded;
extern const std::string_view kAckermann;

}  // namespace hardpack::sim

namespace hardpack::command {
namespace {

// By the name of a built-in vehicle or the path of a file.
void ReadNamedVehicle(const std::string& name, sim::UncertainBody& vehicle) {
  if (name.ends_with(".toml")) {
    Require(sim::ReadBody(name, vehicle));
  } else if (name == "warthog_paper") {
    Require(sim::ParseBody(sim::kWarthogPaper, name, vehicle));
  } else if (name == "warthog_recorded") {
    Require(sim::ParseBody(sim::kWarthogRecorded, name, vehicle));
  } else if (name == "ackermann") {
    Require(sim::ParseBody(sim::kAckermann, name, vehicle));
  } else {
    throw CommandFailure(
        kBadInput,
        "--vehicle " + name + ": must be warthog_paper, warthog_recorded, ackermann or FILE.toml");
  }
}

void SetLabels(const std::string& text, mission::MissionSettings& settings) {
  settings.labels.reset();
  if (text == "none") return;
  const double delay_ms = ParseNumber("--labels", text);
  if (delay_ms < 0.0 || delay_ms > 10000.0) {
    throw CommandFailure(kBadInput, "--labels " + text + ": must be 0 to 10000 ms, or none");
  }
  settings.labels.emplace();
  settings.labels->delay_s = delay_ms / 1000.0;
}

// The file's text; a malformed line is reported with the file's name.
std::string ReadScript(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw CommandFailure(kBadInput, path + ": cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  std::vector<sim::ScriptEvent> events;
  Require(sim::ParseScript(text.str(), path, events));
  return text.str();
}

}  // namespace

void AddMissionOptions(CLI::App& command, MissionOptions& options) {
  mission::MissionSettings& mission = options.mission;
  command.add_option("--planner", mission.planner, "optimizer (default) or astar");
  command.add_option("--tracker", mission.tracker, "full (default) or pursuit");
  command.add_option("--vehicle", options.vehicle,
                     "warthog_paper (default), warthog_recorded, ackermann (needs --config "
                     "config/ackermann.toml) or FILE.toml (docs/simulation.md)");
  command.add_flag("!--typical", mission.spread,
                   "Use the typical vehicle instead of one drawn with the seed");
  command.add_option("--labels", options.labels,
                     "Delay of external labels after their returns [ms], or none (default)");
  command.add_option(
      "--script", options.script,
      "File of faults (tools/sim/script/script.h), timed from the acceptance of the goal");
  command.add_option("--areas", options.areas,
                     "File of areas (docs/areas.md), in the world's frame, sent before arming");
  command.add_option("--config", options.configuration, "Configuration (TOML) of the vehicle");
  command.add_option("--max-speed", options.max_speed_mps, "Replaces the configuration's [m/s]");
  command.add_option("--limit", mission.limit_s, "Time limit of the mission [s] (default 120)");
  command.add_option("--lidar-columns", mission.lidar_columns,
                     "Columns per revolution: 512, 1024 (default) or 2048");
  command.add_option("--start", options.scenario.start, "X,Y[,THETA] on a map (default 0,0)");
  command.add_option("--goal", options.scenario.goal, "X,Y on a map");
  command.add_option("--waypoints", options.waypoints,
                     "File of waypoints as of `hardpack ctl waypoints`, `odom`: metres in the\n"
                     "world's frame. Replaces the world's goal");
}

mission::MissionSettings SettingsOf(const MissionOptions& options) {
  mission::MissionSettings settings = options.mission;
  ReadNamedVehicle(options.vehicle, settings.vehicle);
  settings.vehicle_name = options.vehicle;
  SetLabels(options.labels, settings);
  if (!options.areas.empty()) Require(ReadAreas(options.areas, settings.areas));
  if (!options.script.empty()) settings.script = ReadScript(options.script);
  if (!options.configuration.empty()) {
    Require(ReadConfiguration(options.configuration, settings.configuration));
  }
  if (options.max_speed_mps > 0.0) {
    settings.configuration.planner.speed.max_speed_mps = static_cast<float>(options.max_speed_mps);
  }
  return settings;
}

void SetWaypoints(const MissionOptions& options, mission::MissionSettings& settings) {
  if (options.waypoints.empty()) return;
  control::OperatorCommand command;
  Require(ctl::ReadWaypoints(options.waypoints, command));
  settings.waypoints.assign(command.waypoint, command.waypoint + command.waypoints);
  if (settings.waypoints.front().frame != control::GoalFrame::kOdom) {
    throw CommandFailure(kBadInput, options.waypoints + ": the first word must be odom here");
  }
  const Vec2 last = settings.waypoints.back().position_m;
  settings.scenario.goal = {double{last.x_m}, double{last.y_m}};
}

DrivenWay DrivenOf(const mission::MissionSettings& settings, const mission::MissionTrace& trace) {
  DrivenWay driven;
  driven.areas = settings.areas;
  for (const control::Waypoint& waypoint : settings.waypoints) {
    driven.waypoints.push_back({double{waypoint.position_m.x_m}, double{waypoint.position_m.y_m}});
  }
  if (!driven.waypoints.empty()) driven.waypoints.pop_back();  // the goal
  driven.footprint = trace.footprint;
  for (const mission::MissionTrace::Sample& sample : trace.samples) {
    driven.way.push_back({sample.x_m, sample.y_m});
    driven.end_s = sample.t_s;
  }
  for (const mission::MissionTrace::Plan& plan : trace.plans) driven.plans.push_back(plan.path);
  return driven;
}

}  // namespace hardpack::command
