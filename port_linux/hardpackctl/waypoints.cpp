// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackctl/waypoints.h"

#include <algorithm>
#include <charconv>
#include <sstream>
#include <vector>

#include "port_linux/files/line_words.h"
#include "port_linux/files/read_file.h"

namespace hardpack::ctl {
namespace {

using control::GoalFrame;

ReadOutcome ParseMeters(const std::string& name, std::string_view text, float& value_m) {
  double value = 0.0;
  ReadOutcome outcome = ParseDecimal(name, text, double{control::kMaxPosition_m}, value);
  value_m = static_cast<float>(value);
  return outcome;
}

ReadOutcome ParseHeader(const std::string& name, const std::vector<std::string>& words,
                        GoalFrame& frame) {
  const std::string& word = words.front();
  if (words.size() == 1 && (word == "odom" || word == "relative" || word == "latlon")) {
    frame = word == "odom"       ? GoalFrame::kOdom
            : word == "relative" ? GoalFrame::kBody
                                 : GoalFrame::kGeodetic;
    return {};
  }
  return Wrong(name, "the first word must be odom, relative or latlon");
}

// stop, stop=SECONDS or speed=M/S.
ReadOutcome ParseOption(const std::string& name, std::string_view word,
                        control::Waypoint& waypoint) {
  if (word.starts_with("speed=")) return ParseLegSpeed(name, word.substr(6), waypoint.speed_dmps);
  if (word == "stop") {
    waypoint.stops = true;
    return {};
  }
  if (!word.starts_with("stop=")) {
    return Wrong(name, Quoted(word) + " is not stop, stop=SECONDS or speed=M/S");
  }
  const std::string_view text = word.substr(5);
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, waypoint.hold_s);
  if (error != std::errc{} || end != last || waypoint.hold_s == 0) {
    return Wrong(name, Quoted(word) + ": a stop takes 1 to 255 whole seconds");
  }
  waypoint.stops = true;
  return {};
}

ReadOutcome ParseWaypoint(const std::string& name, const std::vector<std::string>& words,
                          GoalFrame frame, control::Waypoint& waypoint) {
  const bool geodetic = frame == GoalFrame::kGeodetic;
  waypoint = {};
  waypoint.frame = frame;
  if (words.size() < 2) {
    return Wrong(name, geodetic ? "expected latitude and longitude" : "expected x and y");
  }
  for (size_t i = 2; i < words.size(); ++i) {
    ReadOutcome outcome = ParseOption(name, words[i], waypoint);
    if (!outcome.ok()) return outcome;
  }
  if (geodetic) {
    ReadOutcome outcome = ParseLatitude(name + ": latitude", words[0], waypoint.latitude_ndeg);
    return outcome.ok() ? ParseLongitude(name + ": longitude", words[1], waypoint.longitude_ndeg)
                        : outcome;
  }
  ReadOutcome outcome = ParseMeters(name + ": x", words[0], waypoint.position_m.x_m);
  return outcome.ok() ? ParseMeters(name + ": y", words[1], waypoint.position_m.y_m) : outcome;
}

}  // namespace

ReadOutcome ParseLegSpeed(const std::string& name, std::string_view text, uint8_t& speed_dmps) {
  const size_t point = std::min(text.find('.'), text.size());
  const std::string_view whole = text.substr(0, point);
  const std::string_view tenths = text.substr(std::min(point + 1, text.size()));
  const bool has_form = !whole.empty() && AreDigits(whole) && AreDigits(tenths) &&
                        tenths.size() == (point < text.size() ? 1 : 0);
  const std::string scaled = std::string(whole) + (tenths.empty() ? "0" : std::string(tenths));
  const char* last = scaled.data() + scaled.size();
  uint8_t value = 0;
  const auto [end, error] = std::from_chars(scaled.data(), last, value);
  if (!has_form || error != std::errc{} || end != last || value == 0) {
    return Wrong(name, Quoted(text) + " is not a speed of 0.1 to 25.5 m/s with one decimal");
  }
  speed_dmps = value;
  return {};
}

ReadOutcome ReadWaypoints(const std::string& path, control::OperatorCommand& command) {
  std::string text;
  ReadOutcome read = ReadFile(path, kMaxWaypointsFileBytes, text);
  if (!read.ok()) return read;
  command = control::OperatorCommand{};
  command.kind = control::Kind::kGoal;
  bool has_frame = false;
  GoalFrame frame = GoalFrame::kOdom;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string name = path + ":" + std::to_string(++number);
    const std::vector<std::string> words = WordsOf(line);
    if (words.empty()) continue;
    if (!has_frame) {
      ReadOutcome header = ParseHeader(name, words, frame);
      if (!header.ok()) return header;
      has_frame = true;
      continue;
    }
    if (command.waypoints == control::kMaxWaypoints) {
      return {Status::kCapacityExceeded,
              name + ": more than " + std::to_string(control::kMaxWaypoints) + " waypoints"};
    }
    ReadOutcome outcome = ParseWaypoint(name, words, frame, command.waypoint[command.waypoints]);
    if (!outcome.ok()) return outcome;
    ++command.waypoints;
  }
  if (command.waypoints == 0) return Wrong(path + ":" + std::to_string(number), "no waypoint");
  if (command.waypoint[command.waypoints - 1].hold_s > 0) {
    return Wrong(path, "the last waypoint has nothing to wait for: stop takes no seconds there");
  }
  return {};
}

}  // namespace hardpack::ctl
