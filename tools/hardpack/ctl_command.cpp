// SPDX-License-Identifier: Apache-2.0
#include "tools/hardpack/ctl_command.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nlohmann/json.hpp"
#include "port_linux/configuration.h"
#include "tools/ctl/code_names.h"
#include "tools/ctl/connection.h"
#include "tools/ctl/status_view.h"
#include "tools/ctl/waypoints.h"
#include "tools/hardpack/arguments.h"
#include "tools/hardpack/command.h"

namespace hardpack::command {
namespace {

using control::Kind;

struct CtlOptions {
  std::string socket = ControlConfiguration{}.socket;
  double timeout_s = 2.0;
  bool json = false;

  // status
  bool watch = false;
  bool all = false;
  double interval_s = 1.0;

  // goal, waypoints
  std::vector<std::string> position;
  std::string latitude;
  std::string longitude;
  std::string heading;
  bool relative = false;
  std::string file;

  double every_s = 0.0;  // alive; 0: once
};

volatile std::sig_atomic_t interrupted = 0;

// Ctrl-C ends the wait for an answer or for the next time, and the program then ends as it should.
void CatchInterrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void Sleep(double time_s) {
  const double whole_s = std::floor(time_s);
  const timespec time = {static_cast<time_t>(whole_s), static_cast<long>((time_s - whole_s) * 1e9)};
  if (interrupted == 0) nanosleep(&time, nullptr);
}

// The connection to hardpackd of one run of the command.
void Open(const CtlOptions& options, ctl::Connection& connection) {
  const auto timeout = std::chrono::milliseconds(std::llround(options.timeout_s * 1e3));
  Require(connection.Open(options.socket, timeout));
}

// "lidar_old: no lidar column lately".
std::string WhyRefused(const control::Done& answer) {
  const ctl::CodeName reason = ctl::NameOf(control::FieldKind::kStopReason, answer.reason);
  const bool has_reason = answer.reason != 0;
  const std::string name = has_reason ? reason.name : StatusName(answer.status);
  const std::string words = has_reason ? reason.words : ctl::WordsOf(answer.status);
  return words.empty() ? name : name + ": " + words;
}

nlohmann::ordered_json ToJson(const control::Done& answer) {
  nlohmann::ordered_json json;
  json["done"] = IsUsable(answer.status);
  json["status"] = StatusName(answer.status);
  json["reason"] = ctl::NameOf(control::FieldKind::kStopReason, answer.reason).name;
  if (!IsUsable(answer.status)) json["text"] = "refused: " + WhyRefused(answer);
  return json;
}

void RequireDone(const control::Done& answer) {
  if (!IsUsable(answer.status)) {
    throw CommandFailure(kWorkFailed, "refused: " + WhyRefused(answer));
  }
}

void Command(const CtlOptions& options, control::OperatorCommand& command) {
  ctl::Connection connection;
  Open(options, connection);
  control::Done answer;
  Require(connection.Ask(command, answer));
  if (options.json) std::cout << ToJson(answer).dump() << "\n";
  RequireDone(answer);
  if (!options.json) std::cout << "done\n";
}

void SimpleCommand(const CtlOptions& options, Kind kind) {
  control::OperatorCommand command;
  command.kind = kind;
  Command(options, command);
}

control::Waypoint PositionGoal(const CtlOptions& options) {
  control::Waypoint waypoint;
  waypoint.frame = options.relative ? control::GoalFrame::kBody : control::GoalFrame::kOdom;
  waypoint.position_m = {static_cast<float>(ParseNumber("X", options.position[0])),
                         static_cast<float>(ParseNumber("Y", options.position[1]))};
  return waypoint;
}

control::Waypoint GeodeticGoal(const CtlOptions& options) {
  control::Waypoint waypoint;
  waypoint.frame = control::GoalFrame::kGeodetic;
  Require(ctl::ParseNanodegrees("--lat", options.latitude, control::kMaxLatitude_ndeg,
                                waypoint.latitude_ndeg));
  Require(ctl::ParseNanodegrees("--lon", options.longitude, control::kMaxLongitude_ndeg,
                                waypoint.longitude_ndeg));
  return waypoint;
}

void Goal(const CtlOptions& options) {
  const bool geodetic = !options.latitude.empty() || !options.longitude.empty();
  if (geodetic == !options.position.empty()) {
    throw CommandFailure(kBadInput, "a goal is X Y, or --lat and --lon");
  }
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 1;
  command.waypoint[0] = geodetic ? GeodeticGoal(options) : PositionGoal(options);
  if (!options.heading.empty()) {
    const auto heading_rad = static_cast<float>(ParseNumber("--heading", options.heading));
    if (std::abs(heading_rad) > control::kMaxHeading_rad) {
      throw CommandFailure(kBadInput, "--heading: " + options.heading + " is not within pi");
    }
    command.has_heading = true;
    command.heading_frame = command.waypoint[0].frame;
    command.heading_rad = heading_rad;
  }
  Command(options, command);
}

void Waypoints(const CtlOptions& options) {
  control::OperatorCommand command;
  Require(ctl::ReadWaypoints(options.file, command));
  Command(options, command);
}

// Ends when the answer is no, or the connection: somebody who relies on it has to know.
void Alive(const CtlOptions& options) {
  if (options.every_s <= 0.0) {
    SimpleCommand(options, Kind::kAlive);
    return;
  }
  CatchInterrupt();
  ctl::Connection connection;
  Open(options, connection);
  control::OperatorCommand command;
  command.kind = Kind::kAlive;
  while (interrupted == 0) {
    control::Done answer;
    const ReadOutcome outcome = connection.Ask(command, answer);
    if (interrupted != 0) break;
    Require(outcome);
    RequireDone(answer);
    Sleep(options.every_s);
  }
}

int TerminalWidth() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 100;
}

std::string StatusText(const CtlOptions& options, const control::StatusReport& report,
                       const control::StatusReport* before) {
  if (options.json) return ctl::ToJson(report).dump() + "\n";
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  return ctl::ToText(report, before, {TerminalWidth(), options.all, terminal});
}

// One report after the other: each drawn over the one before on a terminal, one object a line with
// --json. A connection that ends is made again: hardpackd may start anew.
void WatchStatus(const CtlOptions& options) {
  CatchInterrupt();
  const bool redraw = !options.json && isatty(STDOUT_FILENO) == 1;
  ctl::Connection connection;
  Open(options, connection);
  bool connected = true;
  std::optional<control::StatusReport> before;
  while (interrupted == 0) {
    control::StatusReport report;
    ReadOutcome outcome;
    if (!connected) {
      outcome = connection.Open(options.socket,
                                std::chrono::milliseconds(std::llround(options.timeout_s * 1e3)));
    }
    if (outcome.ok()) outcome = connection.AskStatus(report);
    if (interrupted != 0) break;
    connected = outcome.ok();
    if (redraw) std::cout << "\033[H\033[J";
    if (connected) {
      std::cout << StatusText(options, report, before ? &*before : nullptr);
      before = report;
    } else {
      (redraw ? std::cout : std::cerr) << outcome.message << "; trying again\n";
    }
    if (!redraw && !options.json) std::cout << "\n";
    std::cout.flush();
    Sleep(options.interval_s);
  }
}

void Status(const CtlOptions& options) {
  if (options.watch) {
    WatchStatus(options);
    return;
  }
  ctl::Connection connection;
  Open(options, connection);
  control::StatusReport report;
  Require(connection.AskStatus(report));
  std::cout << StatusText(options, report, nullptr);
}

void Parameters(const CtlOptions& options) {
  ctl::Connection connection;
  Open(options, connection);
  std::string toml;
  Require(connection.AskParameters(toml));
  if (options.json) toml = nlohmann::json{{"toml", toml}}.dump() + "\n";
  std::cout << toml;
}

using Options = std::shared_ptr<CtlOptions>;

CLI::App* AddSubcommand(CLI::App& ctl, const char* name, const char* description,
                        const Options& options, std::function<void(const CtlOptions&)> run) {
  CLI::App* command = ctl.add_subcommand(name, description);
  command->fallthrough();  // --socket, --timeout and --json may stand behind it
  command->callback([options, run = std::move(run)] { run(*options); });
  return command;
}

void AddStatus(CLI::App& ctl, const Options& options) {
  CLI::App* status =
      AddSubcommand(ctl, "status",
                    "Show what hardpackd knows of itself. ! marks what is wrong now, * what was\n"
                    "lost or refused since the start. Counters that are 0 are left out.",
                    options, Status);
  status->add_flag("--all", options->all, "Counters that are 0, too");
  CLI::Option* watch = status->add_flag(
      "--watch", options->watch, "Again and again until Ctrl-C; counters say how they have grown");
  status->add_option("--interval", options->interval_s, "Seconds between two (default 1)")
      ->check(CLI::Range(0.05, 3600.0))
      ->needs(watch);
}

void AddGoals(CLI::App& ctl, const Options& options) {
  CLI::App* goal =
      AddSubcommand(ctl, "goal", "Drive there, in the place of all earlier goals.", options, Goal);
  CLI::Option* position =
      goal->add_option("position", options->position, "X Y in metres, in the odom frame")
          ->expected(2);
  CLI::Option* heading =
      goal->add_option("--heading", options->heading, "Heading at the goal, in radians");
  CLI::Option* relative = goal->add_flag(
      "--relative", options->relative,
      "X Y (and the heading) are ahead and to the left of the vehicle, as it stands");
  CLI::Option* latitude = goal->add_option("--lat", options->latitude,
                                           "Latitude, WGS 84, in degrees, at most nine decimals");
  CLI::Option* longitude = goal->add_option("--lon", options->longitude, "Longitude, the same");
  latitude->needs(longitude)->excludes(position)->excludes(heading)->excludes(relative);
  longitude->needs(latitude);

  AddSubcommand(
      ctl, "waypoints",
      "Drive to the waypoints of a file in turn, in the place of all earlier goals.\n"
      "First the word odom, relative or latlon, then a waypoint a line: x y in metres or\n"
      "latitude and longitude in degrees; # begins a comment.",
      options, Waypoints)
      ->add_option("file", options->file, "The file")
      ->required();
}

void AddAlive(CLI::App& ctl, const Options& options) {
  AddSubcommand(ctl, "alive",
                "Say that the operator is there, for hardpackd's safety.operator_timeout_s.",
                options, Alive)
      ->add_option("--every", options->every_s, "Again after so many seconds, until Ctrl-C")
      ->check(CLI::Range(0.01, 3600.0));
}

}  // namespace

void AddCtlCommand(CLI::App& app) {
  const auto options = std::make_shared<CtlOptions>();
  CLI::App* ctl = app.add_subcommand("ctl", "Talk to hardpackd, the onboard program.");
  ctl->require_subcommand(1);
  ctl->footer(
      "Exit codes: 0 done; 1 refused, with the reason; 2 bad usage, or hardpackd cannot be\n"
      "reached.");
  ctl->add_option("--socket", options->socket,
                  "The control socket (default " + options->socket + ")");
  ctl->add_option("--timeout", options->timeout_s, "Seconds to wait for an answer (default 2)")
      ->check(CLI::Range(0.01, 3600.0));
  ctl->add_flag("--json", options->json, "Print one JSON object");

  AddStatus(*ctl, options);
  const auto add_simple = [&](const char* name, const char* description, Kind kind) {
    AddSubcommand(*ctl, name, description, options,
                  [kind](const CtlOptions& chosen) { SimpleCommand(chosen, kind); });
  };
  add_simple("arm", "Let the vehicle drive, once it has a goal.", Kind::kArm);
  add_simple("disarm", "Stop, then switch the drives off.", Kind::kDisarm);
  add_simple("stop", "Come to rest along the path and drop the goals; stays armed.", Kind::kStop);
  add_simple("estop", "Zero speed at once; only disarming leaves it.", Kind::kEmergencyStop);
  AddGoals(*ctl, options);
  AddAlive(*ctl, options);
  AddSubcommand(*ctl, "params", "Print the configuration that hardpackd runs with, as TOML.",
                options, Parameters);
}

}  // namespace hardpack::command
