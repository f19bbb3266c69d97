// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackctl/ctl_command.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "port_linux/files/area_file.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/line_words.h"
#include "port_linux/hardpackctl/code_names.h"
#include "port_linux/hardpackctl/connection.h"
#include "port_linux/hardpackctl/status_view.h"
#include "port_linux/hardpackctl/waypoints.h"

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
  std::string speed;
  bool relative = false;
  std::string file;

  // areas
  std::string area_file;
  bool clear = false;
};

volatile std::sig_atomic_t interrupted = 0;

// Ctrl-C ends the wait for an answer or for the next update, and the program then ends normally.
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
  Require(ParseLatitude("--lat", options.latitude, waypoint.latitude_ndeg));
  Require(ParseLongitude("--lon", options.longitude, waypoint.longitude_ndeg));
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
  if (!options.speed.empty()) {
    Require(ctl::ParseLegSpeed("--speed", options.speed, command.waypoint[0].speed_dmps));
  }
  Command(options, command);
}

void Waypoints(const CtlOptions& options) {
  control::OperatorCommand command;
  Require(ctl::ReadWaypoints(options.file, command));
  Command(options, command);
}

// One after the other, and all that the vehicle is to have. Until the last one is taken it does not
// drive.
void Areas(const CtlOptions& options) {
  if (options.clear != options.area_file.empty()) {
    throw CommandFailure(kBadInput, "areas needs a file or --clear");
  }
  if (options.clear) return SimpleCommand(options, Kind::kClearAreas);
  const auto areas = std::make_unique<AreaList>();
  Require(ReadAreas(options.area_file, *areas));
  ctl::Connection connection;
  Open(options, connection);
  control::OperatorCommand command;
  command.kind = Kind::kArea;
  command.area_count = areas->size();
  control::Done answer;
  for (int i = 0; i < areas->size() && IsUsable(answer.status); ++i) {
    command.area_index = i;
    command.area = (*areas)[i];
    Require(connection.Ask(command, answer));
  }
  if (options.json) std::cout << ToJson(answer).dump() << "\n";
  if (!IsUsable(answer.status)) {
    throw CommandFailure(kWorkFailed, "area " + std::to_string(command.area_index + 1) +
                                          " was refused: " + WhyRefused(answer));
  }
  if (!options.json) std::cout << "done\n";
}

// Almost certainly different from the numbers of all earlier programs; not 0.
uint32_t FirstPress() {
  std::random_device random;
  return std::max(1u, random() & 0x7fffffffu);
}

// Shows that the caller is present, once. A program that repeats it does not prove an operator.
void Alive(const CtlOptions& options) {
  control::OperatorCommand command;
  command.kind = Kind::kAlive;
  command.press = FirstPress();
  Command(options, command);
}

// Makes the terminal deliver each key at once without echo; restores it at the end.
class KeysOfTerminal {
 public:
  KeysOfTerminal() {
    if (isatty(STDIN_FILENO) != 1 || tcgetattr(STDIN_FILENO, &before_) != 0) {
      throw CommandFailure(kBadInput, "drive needs a terminal, where somebody presses keys");
    }
    termios raw = before_;
    raw.c_lflag &= static_cast<tcflag_t>(~(ICANON | ECHO));
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSAFLUSH, &raw);
  }
  ~KeysOfTerminal() { tcsetattr(STDIN_FILENO, TCSAFLUSH, &before_); }
  KeysOfTerminal(const KeysOfTerminal&) = delete;
  KeysOfTerminal& operator=(const KeysOfTerminal&) = delete;

  // The last key pressed since the last call; earlier ones are dropped. No key if none was pressed
  // within the time. False: the terminal is gone.
  bool Next(std::optional<char>& key, int wait_ms) {
    key.reset();
    pollfd ready{STDIN_FILENO, POLLIN, 0};
    if (poll(&ready, 1, wait_ms) <= 0) return true;
    if ((ready.revents & POLLIN) == 0) return false;
    std::array<char, 256> keys;
    const ssize_t got = read(STDIN_FILENO, keys.data(), keys.size());
    if (got <= 0) return false;
    key = keys[static_cast<size_t>(got) - 1];
    for (ssize_t i = 0; i < got; ++i) {
      if (keys[static_cast<size_t>(i)] == 'e') key = 'e';  // whatever followed it
    }
    return true;
  }

 private:
  termios before_{};
};

Kind MeaningOf(char key) {
  if (key == 'e') return Kind::kEmergencyStop;
  return key == 's' ? Kind::kStop : Kind::kAlive;
}

// Ends on a refusal or a lost connection: the operator, who relies on it, must know.
void Drive(const CtlOptions& options) {
  CatchInterrupt();
  ctl::Connection connection;
  Open(options, connection);
  KeysOfTerminal keys;
  std::cout << "Press or hold any key while you watch the vehicle; s: stop, e: emergency stop, "
               "q: quit\n"
            << std::flush;
  constexpr int kWait_ms = 50;
  control::OperatorCommand command;
  command.press = FirstPress();
  while (interrupted == 0) {
    std::optional<char> key;
    if (!keys.Next(key, kWait_ms)) return;
    if (!key) continue;
    if (*key == 'q') return;
    command.kind = MeaningOf(*key);
    command.press = command.press == UINT32_MAX ? 1 : command.press + 1;
    control::Done answer;
    const ReadOutcome outcome = connection.Ask(command, answer);
    if (interrupted != 0) return;
    Require(outcome);
    RequireDone(answer);
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

// Prints one report after the other: on a terminal over the previous one, with --json one object
// per line. Reconnects after a lost connection: hardpackd may be restarted.
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
  command->fallthrough();  // --socket, --timeout and --json may follow it
  command->callback([options, run = std::move(run)] { run(*options); });
  return command;
}

void AddStatus(CLI::App& ctl, const Options& options) {
  CLI::App* status =
      AddSubcommand(ctl, "status",
                    "Show the state of hardpackd. ! marks what is wrong now, * what has been lost\n"
                    "or refused since the start. Counters that are 0 are omitted.",
                    options, Status);
  status->add_flag("--all", options->all, "Include counters that are 0");
  CLI::Option* watch =
      status->add_flag("--watch", options->watch,
                       "Repeat until Ctrl-C; loss counters show how much they have grown");
  status->add_option("--interval", options->interval_s, "Seconds between updates (default 1)")
      ->check(CLI::Range(0.05, 3600.0))
      ->needs(watch);
}

void AddGoals(CLI::App& ctl, const Options& options) {
  CLI::App* goal =
      AddSubcommand(ctl, "goal", "Drive to a goal; replaces all earlier goals.", options, Goal);
  CLI::Option* position =
      goal->add_option("position", options->position, "X Y in metres, in the odom frame")
          ->expected(2);
  CLI::Option* heading =
      goal->add_option("--heading", options->heading, "Heading at the goal, in radians");
  goal->add_option("--speed", options->speed, "Drive there at most so fast, in m/s");
  CLI::Option* relative =
      goal->add_flag("--relative", options->relative,
                     "X Y (and the heading) are relative to the vehicle: ahead and to the left");
  CLI::Option* latitude = goal->add_option("--lat", options->latitude,
                                           "Latitude, WGS 84, in degrees, at most nine decimals");
  CLI::Option* longitude = goal->add_option("--lon", options->longitude, "Longitude, likewise");
  latitude->needs(longitude)->excludes(position)->excludes(heading)->excludes(relative);
  longitude->needs(latitude);

  AddSubcommand(
      ctl, "waypoints",
      "Drive to the waypoints of a file in order; replaces all earlier goals.\n"
      "First the word odom, relative or latlon, then one waypoint per line: x y in metres or\n"
      "latitude and longitude in degrees; # begins a comment. The vehicle passes all but the "
      "last.\n"
      "Behind the numbers: stop or stop=SECONDS (it comes to rest there, and waits), speed=M/S\n"
      "(the limit on the way there).",
      options, Waypoints)
      ->add_option("file", options->file, "The file")
      ->required();
}

void AddAreas(CLI::App& ctl, const Options& options) {
  CLI::App* areas = AddSubcommand(
      ctl, "areas",
      "Give the vehicle the areas of a file, which replace those given before. It must stand.\n"
      "Each begins with a line: keep_out, fence or speed_zone, then odom or latlon, then for a\n"
      "speed zone the speed in m/s. The corners follow, one per line: x y in metres or latitude\n"
      "and longitude in degrees; # begins a comment.",
      options, Areas);
  CLI::Option* file = areas->add_option("file", options->area_file, "The file");
  areas->add_flag("--clear", options->clear, "Remove all areas but the configured ones")
      ->excludes(file);
}

void AddPresence(CLI::App& ctl, const Options& options) {
  AddSubcommand(
      ctl, "drive",
      "Stay with the vehicle: every key pressed at this terminal shows that the operator\n"
      "is present. Without one for safety.operator_timeout_s the vehicle stops.",
      options, Drive);
  AddSubcommand(ctl, "alive", "Report once that the operator is present, as a key in `drive` does.",
                options, Alive);
}

}  // namespace

void AddCtlCommands(CLI::App& app) {
  const auto options = std::make_shared<CtlOptions>();
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done; 1 refused, with the reason; 2 bad usage, or hardpackd cannot be\n"
      "reached.");
  app.add_option("--socket", options->socket,
                 "The control socket (default " + options->socket + ")");
  app.add_option("--timeout", options->timeout_s, "Seconds to wait for an answer (default 2)")
      ->check(CLI::Range(0.01, 3600.0));
  app.add_flag("--json", options->json, "Print one JSON object");

  AddStatus(app, options);
  const auto add_simple = [&](const char* name, const char* description, Kind kind) {
    AddSubcommand(app, name, description, options,
                  [kind](const CtlOptions& chosen) { SimpleCommand(chosen, kind); });
  };
  add_simple("arm", "Let the vehicle drive, once it has a goal.", Kind::kArm);
  add_simple("disarm", "Stop, then switch the drives off.", Kind::kDisarm);
  add_simple("stop", "Stop along the path and drop the goals; stays armed.", Kind::kStop);
  add_simple("pause", "Stop along the path and keep the goals.", Kind::kPause);
  add_simple("resume", "Drive on to the goals, after a pause or a stop that has ended.",
             Kind::kResume);
  add_simple("skip", "Leave out the present waypoint; the last one cannot be left out.",
             Kind::kSkip);
  add_simple("estop", "Zero speed at once; only disarm leaves this mode.", Kind::kEmergencyStop);
  AddGoals(app, options);
  AddAreas(app, options);
  AddPresence(app, options);
  AddSubcommand(app, "params", "Print the configuration in use, as TOML.", options, Parameters);
}

}  // namespace hardpack::command
