// SPDX-License-Identifier: Apache-2.0
// A vehicle on real sockets, in real time: drives on a SocketCAN interface, a lidar and an INS by
// UDP, with a script of what goes wrong (tools/sim/script/script.h). Writes what happened as JSON
// lines.
#include <csignal>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "tools/sim/script/script.h"
#include "tools/sim/script/scripted_vehicle.h"
#include "tools/sim/wire/real_time.h"
#include "tools/sim/world/named_worlds.h"

namespace hardpack::sim {
namespace {

volatile std::sig_atomic_t stop_requested = 0;
void RequestStop(int /*signal*/) {
  stop_requested = 1;
}

struct Options {
  wire::Settings wire;
  double seconds = 0.0;
  std::string script;
  std::vector<std::string> at;
  std::string metadata;
  std::string world = "lane";
  uint32_t world_seed = 1;
  std::string profile = "legacy";
  std::string login;
  ScriptedVehicleSettings settings;
};

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("--can", options.wire.can, "SocketCAN interface; without it no drives are heard");
  app.add_option("--lidar-from", options.wire.lidar_from, "ADDRESS:PORT that the lidar sends from");
  app.add_option("--lidar-to", options.wire.lidar_to, "and to; empty: it sends nothing");
  app.add_option("--ins-from", options.wire.ins_from, "ADDRESS:PORT that the INS sends from");
  app.add_option("--ins-to", options.wire.ins_to, "and to; empty: it sends nothing");
  app.add_option("--labels-from", options.wire.labels_from,
                 "ADDRESS:PORT that the segmentation computer sends from");
  app.add_option("--labels-to", options.wire.labels_to, "and to; without it there is none");
  app.add_option("--foreign-address", options.wire.foreign_address,
                 "where lidar-foreign and ins-foreign come from");
  app.add_option("--seconds", options.seconds, "ends after so long; 0: at SIGTERM or quit");
  app.add_option("--script", options.script, "file of events (tools/sim/script/script.h)");
  app.add_option("--at", options.at, "one event, as \"5.0 drive-silent left on\"; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("--interactive", options.wire.interactive,
               "events without a time from standard input, each as its line comes");
  app.add_option("--turn-ms", options.wire.turn_ms,
                 "between two looks at the sockets, not to be woken by each frame; 1: by each. The "
                 "simulation's steps stay 1 ms, and frames count from when they came")
      ->check(CLI::Range(1, 20));
  app.add_option("--trace", options.wire.trace, "file of JSON lines of what happened");
  app.add_option("--trace-period", options.settings.trace_period_s, "between two samples [s]");
  app.add_option("--metadata", options.metadata, "file to write the lidar's metadata to");
  std::vector<std::string> worlds = world::WorldNames();
  worlds.emplace_back("lane");
  app.add_option("--world", options.world, "lane, or one of tools/sim/world/named_worlds.h")
      ->check(CLI::IsMember(worlds));
  app.add_option("--world-seed", options.world_seed, "its variations (1)");
  app.add_option("--lidar-profile", options.profile, "legacy or rng19")
      ->check(CLI::IsMember({"legacy", "rng19"}));
  app.add_option("--lidar-columns", options.settings.lidar.columns, "a revolution")
      ->check(CLI::IsMember({512, 1024, 2048}));
  app.add_option("--lidar-rate", options.settings.lidar.revolutions_per_s, "revolutions a second")
      ->check(CLI::Range(1, 20));
  app.add_option("--lidar-yaw", options.settings.lidar.yaw_rad, "of the sensor on the vehicle");
  app.add_option("--ins-rate", options.settings.ins.messages_per_s, "messages a second")
      ->check(CLI::Range(1, 400));
  app.add_option("--ins-cut", options.settings.ins.cut_bytes,
                 "datagrams of 1 to so many bytes; 0: one a message");
}

void AddDriveOptions(CLI::App& app, Options& options) {
  DriveSettings& left = options.settings.vehicle.left;
  DriveSettings& right = options.settings.vehicle.right;
  app.add_option("--left-node", left.identity.node);
  app.add_option("--right-node", right.identity.node);
  app.add_option("--left-sign", left.sign)->check(CLI::IsMember({1, -1}));
  app.add_option("--right-sign", right.sign)->check(CLI::IsMember({1, -1}));
  app.add_option("--gear-ratio", left.gear_ratio, "motor turns per wheel turn");
  app.add_option("--login", options.login,
                 "USER:PASSWORD of the drives, decimal; 1:4660 unless told");
  app.add_option("--rpdo-timeout", left.rpdo_timeout_s,
                 "of the drives, where 5902h switches it on [s]");
  app.add_flag("--rpdo-event-timer", left.has_rpdo_event_timer,
               "the drives have 1400h:5, and it is that time");
  app.add_option("--max-wheel-speed", left.motor.limit_radps, "[rad/s]");
}

ReadOutcome ReadScript(const Options& options, std::vector<ScriptEvent>& script) {
  if (!options.script.empty()) {
    std::ifstream file(options.script);
    if (!file) return {Status::kInvalidArgument, options.script + ": cannot be read"};
    std::ostringstream text;
    text << file.rdbuf();
    const ReadOutcome outcome = ParseScript(text.str(), options.script, script);
    if (!outcome.ok()) return outcome;
  }
  for (const std::string& line : options.at) {
    const ReadOutcome outcome = ParseScriptLine("at " + line, script);
    if (!outcome.ok()) return outcome;
  }
  return {};
}

ReadOutcome Complete(Options& options) {
  DriveSettings& left = options.settings.vehicle.left;
  if (!options.login.empty()) {
    char colon = 0;
    std::istringstream in(options.login);
    if (!(in >> left.login_user >> colon >> left.login_password) || colon != ':') {
      return {Status::kInvalidArgument, "--login: expected USER:PASSWORD"};
    }
  }
  DriveSettings right = left;
  right.identity = options.settings.vehicle.right.identity;
  right.sign = options.settings.vehicle.right.sign;
  options.settings.vehicle.right = right;
  if (!options.wire.labels_to.empty()) options.settings.labels.emplace();
  if (options.world == "lane") {
    options.settings.world = LaneWorld();
  } else {
    world::Scenario scenario;
    const ReadOutcome outcome = world::MakeScenario(options.world, options.world_seed, scenario);
    if (!outcome.ok()) return outcome;
    options.settings.world = std::move(scenario.world);
  }
  if (options.profile == "rng19") options.settings.lidar.profile = LidarProfile::kRng19;
  return {};
}

// Until it is told to end, or the script's end.
void Run(wire::RealTime& real_time, ScriptedVehicle& vehicle, double seconds) {
  const uint64_t start_ns = vehicle.now_ns();
  const auto length_ns = static_cast<uint64_t>(seconds * 1.0e9);
  real_time.Begin(vehicle);
  while (stop_requested == 0 && !vehicle.quit()) {
    if (length_ns > 0 && vehicle.now_ns() - start_ns >= length_ns) return;
    real_time.Turn(vehicle);
  }
}

int Fail(const ReadOutcome& outcome) {
  std::cerr << "scripted_vehicle: " << outcome.message << '\n';
  return 2;
}

int Main(int argc, char** argv) {
  CLI::App app(
      "A simulated vehicle on real sockets: drives by CAN, lidar and INS by UDP.\n"
      "Prints \"ready\" when it runs and one JSON object at the end.");
  Options options;
  AddOptions(app, options);
  AddDriveOptions(app, options);
  CLI11_PARSE(app, argc, argv);
  std::vector<ScriptEvent> script;
  wire::RealTime real_time;
  for (const ReadOutcome& outcome :
       {Complete(options), ReadScript(options, script), real_time.Open(options.wire)}) {
    if (!outcome.ok()) return Fail(outcome);
  }
  std::signal(SIGTERM, RequestStop);
  std::signal(SIGINT, RequestStop);
  ScriptedVehicle vehicle(options.settings, std::move(script), wire::Now_ns());
  if (!options.metadata.empty()) {
    std::ofstream metadata(options.metadata);
    metadata << vehicle.lidar().MetadataJson();
    if (!metadata.flush()) {
      return Fail({Status::kInvalidArgument, options.metadata + ": cannot be written"});
    }
  }
  std::cout << "ready" << std::endl;
  Run(real_time, vehicle, options.seconds);
  std::cout << real_time.Summary(vehicle) << std::endl;
  return 0;
}

}  // namespace
}  // namespace hardpack::sim

int main(int argc, char** argv) {
  return hardpack::sim::Main(argc, argv);
}
