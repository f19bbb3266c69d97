// SPDX-License-Identifier: Apache-2.0
// A vehicle on real sockets, in real time: drives on a SocketCAN interface, a lidar and an INS by
// UDP, with a script of what goes wrong (tools/sim/script.h). Writes what happened as JSON lines.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "CLI/CLI.hpp"
#include "nlohmann/json.hpp"
#include "test/onboard/line_reader.h"
#include "test/onboard/scripted_vehicle_sockets.h"
#include "tools/sim/script.h"
#include "tools/sim/scripted_vehicle.h"
#include "tools/world/named_worlds.h"

namespace hardpack::sim {
namespace {

volatile std::sig_atomic_t stop_requested = 0;
void RequestStop(int /*signal*/) {
  stop_requested = 1;
}

struct Options {
  std::string can;
  std::string lidar_from = "127.0.0.1:17502";
  std::string lidar_to = "127.0.0.1:7502";
  std::string ins_from = "127.0.0.1:17600";
  std::string ins_to = "127.0.0.1:7600";
  std::string foreign_address = "127.0.0.2";
  double seconds = 0.0;
  std::string script;
  std::vector<std::string> at;
  std::string trace;
  std::string metadata;
  std::string world = "lane";
  uint32_t world_seed = 1;
  std::string labels_from = "127.0.0.1:17503";
  std::string labels_to;
  std::string profile = "legacy";
  std::string login;
  bool interactive = false;
  int turn_ms = 1;
  ScriptedVehicleSettings settings;
};

void AddOptions(CLI::App& app, Options& options) {
  app.add_option("--can", options.can, "SocketCAN interface; without it no drives are heard");
  app.add_option("--lidar-from", options.lidar_from, "ADDRESS:PORT that the lidar sends from");
  app.add_option("--lidar-to", options.lidar_to, "and to; empty: it sends nothing");
  app.add_option("--ins-from", options.ins_from, "ADDRESS:PORT that the INS sends from");
  app.add_option("--ins-to", options.ins_to, "and to; empty: it sends nothing");
  app.add_option("--labels-from", options.labels_from,
                 "ADDRESS:PORT that the segmentation computer sends from");
  app.add_option("--labels-to", options.labels_to, "and to; without it there is none");
  app.add_option("--foreign-address", options.foreign_address,
                 "where lidar-foreign and ins-foreign come from");
  app.add_option("--seconds", options.seconds, "ends after so long; 0: at SIGTERM or quit");
  app.add_option("--script", options.script, "file of events (tools/sim/script.h)");
  app.add_option("--at", options.at, "one event, as \"5.0 drive-silent left on\"; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("--interactive", options.interactive,
               "events without a time from standard input, each as its line comes");
  app.add_option("--turn-ms", options.turn_ms,
                 "between two looks at the sockets, not to be woken by each frame; 1: by each. The "
                 "simulation's steps stay 1 ms, and frames count from when they came")
      ->check(CLI::Range(1, 20));
  app.add_option("--trace", options.trace, "file of JSON lines of what happened");
  app.add_option("--trace-period", options.settings.trace_period_s, "between two samples [s]");
  app.add_option("--metadata", options.metadata, "file to write the lidar's metadata to");
  std::vector<std::string> worlds = world::WorldNames();
  worlds.emplace_back("lane");
  app.add_option("--world", options.world, "lane, or one of tools/world/named_worlds.h")
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
  if (!options.labels_to.empty()) options.settings.labels.emplace();
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

// A sensor's datagrams, from its own address and from the foreign one.
struct SensorSenders {
  DatagramSender own;
  DatagramSender foreign;
  bool open = false;

  ReadOutcome Open(const std::string& from, const std::string& to,
                   const std::string& foreign_address) {
    if (to.empty()) return {};
    Endpoint source;
    Endpoint destination;
    for (const ReadOutcome& outcome : {ParseEndpoint(from, source), ParseEndpoint(to, destination),
                                       own.Open(source, destination),
                                       foreign.Open({foreign_address, source.port}, destination)}) {
      if (!outcome.ok()) return outcome;
    }
    open = true;
    return {};
  }
};

class RealTime {
 public:
  ReadOutcome Open(const Options& options) {
    if (!options.can.empty()) {
      const ReadOutcome outcome = can_.Open(options.can);
      if (!outcome.ok()) return outcome;
    }
    turn_ns_ = static_cast<uint64_t>(options.turn_ms) * ScriptedVehicle::kStep_ns;
    if (options.interactive) lines_.Open(STDIN_FILENO);
    if (!options.trace.empty()) {
      trace_.open(options.trace);
      if (!trace_) return {Status::kInvalidArgument, options.trace + ": cannot be written"};
    }
    const ReadOutcome lidar =
        senders_[0].Open(options.lidar_from, options.lidar_to, options.foreign_address);
    if (!lidar.ok()) return lidar;
    const ReadOutcome ins =
        senders_[1].Open(options.ins_from, options.ins_to, options.foreign_address);
    if (!ins.ok()) return ins;
    return senders_[2].Open(options.labels_from, options.labels_to, options.foreign_address);
  }

  void Run(ScriptedVehicle& vehicle, double seconds) {
    start_ns_ = vehicle.now_ns();
    if (trace_.is_open()) {
      trace_ << nlohmann::ordered_json{{"t", 0}, {"event", "start"}, {"monotonic_ns", start_ns_}}
             << '\n';
    }
    const auto length_ns = static_cast<uint64_t>(seconds * 1.0e9);
    while (stop_requested == 0 && !vehicle.quit()) {
      const uint64_t now_ns = Now_ns();
      if (length_ns > 0 && now_ns - start_ns_ >= length_ns) return;
      NoteLag(vehicle, now_ns);
      TakeLines(vehicle);
      Step(vehicle, now_ns);
      Wait(vehicle.now_ns() + turn_ns_);
    }
  }

  std::string Summary(const ScriptedVehicle& vehicle) const {
    auto summary = nlohmann::ordered_json::parse(vehicle.Summary());
    summary["can"] = {{"received", can_.received}, {"sent", can_.sent}, {"failed", can_.failed}};
    const char* const names[] = {"lidar", "ins", "labels"};
    for (size_t i = 0; i < kSensors; ++i) {
      summary[names[i]] = {{"sent", senders_[i].own.sent},
                           {"foreign", senders_[i].foreign.sent},
                           {"failed", senders_[i].own.failed + senders_[i].foreign.failed}};
    }
    summary["worst_lag_ms"] = static_cast<double>(worst_lag_ns_ / 1000) / 1000.0;
    return summary.dump();
  }

 private:
  // The shortest time that anybody here waits for somebody else is 100 ms.
  static constexpr uint64_t kLate_ns = 50'000'000;

  void NoteLag(const ScriptedVehicle& vehicle, uint64_t now_ns) {
    const uint64_t lag_ns = now_ns - vehicle.now_ns();
    worst_lag_ns_ = std::max(worst_lag_ns_, lag_ns);
    if (lag_ns < kLate_ns || !trace_.is_open()) return;
    const double t_s = static_cast<double>(vehicle.now_ns() - start_ns_) / 1.0e9;
    trace_ << nlohmann::ordered_json{{"t", t_s}, {"event", "late"}, {"ms", lag_ns / 1'000'000}}
           << '\n';
  }

  void TakeLines(ScriptedVehicle& vehicle) {
    std::string line;
    while (lines_.Next(line)) {
      std::vector<ScriptEvent> events;
      const ReadOutcome outcome = ParseScriptLine("at 0 " + line, events);
      if (!outcome.ok()) std::cerr << outcome.message << std::endl;
      for (const ScriptEvent& event : events) {
        event.act(vehicle);
        const double t_s = static_cast<double>(vehicle.now_ns() - start_ns_) / 1.0e9;
        trace_ << nlohmann::ordered_json{{"t", t_s}, {"event", "script"}, {"line", line}} << '\n';
      }
    }
  }

  void Step(ScriptedVehicle& vehicle, uint64_t now_ns) {
    frames_.clear();
    if (can_.descriptor() >= 0) can_.Receive(frames_);
    for (const ReceivedFrame& one : frames_) {
      vehicle.TakeFrame(one.frame, std::clamp(one.time_ns, vehicle.now_ns(), now_ns));
    }
    Outgoing out;
    vehicle.Advance(now_ns, out);
    if (can_.descriptor() >= 0) {
      for (const CanFrame& frame : out.frames) can_.Send(frame);
      for (const BusError& error : out.bus_errors) can_.Send(error);
    }
    for (const SensorDatagram& datagram : out.datagrams) {
      SensorSenders& senders = senders_[static_cast<size_t>(datagram.sensor)];
      if (senders.open) (datagram.foreign ? senders.foreign : senders.own).Send(datagram.bytes);
    }
    if (trace_.is_open()) {
      for (const std::string& line : out.trace) trace_ << line << '\n';
      if (!out.trace.empty()) trace_.flush();  // for who watches it grow
    }
  }

  // Until then; in turns of one step until a frame comes, if that is earlier.
  void Wait(uint64_t until_ns) const {
    const uint64_t now_ns = Now_ns();
    const uint64_t left_ns = until_ns > now_ns ? until_ns - now_ns : 0;
    const timespec left = {0, static_cast<long>(std::min(left_ns, turn_ns_))};
    pollfd can = {can_.descriptor(), POLLIN, 0};
    ppoll(&can, turn_ns_ == ScriptedVehicle::kStep_ns ? 1 : 0, &left, nullptr);
  }

  LineReader lines_;
  VehicleCan can_;
  SensorSenders senders_[kSensors];
  std::ofstream trace_;
  std::vector<ReceivedFrame> frames_;
  uint64_t start_ns_ = 0;
  uint64_t turn_ns_ = ScriptedVehicle::kStep_ns;
  uint64_t worst_lag_ns_ = 0;
};

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
  RealTime real_time;
  for (const ReadOutcome& outcome :
       {Complete(options), ReadScript(options, script), real_time.Open(options)}) {
    if (!outcome.ok()) return Fail(outcome);
  }
  std::signal(SIGTERM, RequestStop);
  std::signal(SIGINT, RequestStop);
  ScriptedVehicle vehicle(options.settings, std::move(script), Now_ns());
  if (!options.metadata.empty()) {
    std::ofstream metadata(options.metadata);
    metadata << vehicle.lidar().MetadataJson();
    if (!metadata.flush()) {
      return Fail({Status::kInvalidArgument, options.metadata + ": cannot be written"});
    }
  }
  std::cout << "ready" << std::endl;
  real_time.Run(vehicle, options.seconds);
  std::cout << real_time.Summary(vehicle) << std::endl;
  return 0;
}

}  // namespace
}  // namespace hardpack::sim

int main(int argc, char** argv) {
  return hardpack::sim::Main(argc, argv);
}
