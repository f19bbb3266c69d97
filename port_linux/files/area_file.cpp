// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/area_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "port_linux/files/read_file.h"

namespace hardpack {
namespace {

constexpr size_t kFractionDigits = 9;
constexpr int64_t kMaxLatitude_ndeg = 90'000'000'000;
constexpr int64_t kMaxLongitude_ndeg = 180'000'000'000;

ReadOutcome Wrong(const std::string& name, const std::string& what) {
  return {Status::kInvalidArgument, name + ": " + what};
}

std::string Quoted(std::string_view text) {
  // Not with operator+: GCC 12 warns of overlaps there (its bug 105329).
  std::string quoted(1, '\'');
  quoted.append(text);
  quoted.push_back('\'');
  return quoted;
}

bool AreDigits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

// A finite number within +-limit.
ReadOutcome ParseDecimal(const std::string& name, std::string_view text, double limit,
                         double& value) {
  const char* first = text.data();
  const char* last = first + text.size();
  if (first != last && *first == '+') ++first;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc{} || end != last) return Wrong(name, Quoted(text) + " is not a number");
  if (std::isfinite(value) && std::abs(value) <= limit) return {};
  return Wrong(name, Quoted(text) + " is out of range");
}

// The words of a line, without its comment.
std::vector<std::string> Words(std::string line) {
  line.resize(std::min(line.size(), line.find('#')));
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

template <size_t kNames>
int IndexOf(const std::array<const char*, kNames>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(std::distance(names.begin(), found));
}

ReadOutcome ParseHead(const std::string& name, const std::vector<std::string>& words, Area& area) {
  const int kind = IndexOf(kAreaKindNames, words[0]);
  if (kind < 0) {
    return Wrong(name, Quoted(words[0]) + " is not keep_out, fence, speed_zone or a number");
  }
  const int frame = words.size() > 1 ? IndexOf(kAreaFrameNames, words[1]) : -1;
  if (frame < 0) return Wrong(name, "the second word must be odom or latlon");
  area = Area{};
  area.kind = static_cast<AreaKind>(kind);
  area.frame = static_cast<AreaFrame>(frame);
  const bool is_zone = area.kind == AreaKind::kSpeedZone;
  if (words.size() != (is_zone ? 3u : 2u)) {
    return Wrong(name, is_zone ? "a speed zone has a speed in m/s, and nothing else"
                               : "only a speed zone has a speed");
  }
  if (!is_zone) return {};
  double speed_mps = 0.0;
  ReadOutcome outcome = ParseDecimal(name, words[2], double{kMaxZoneSpeed_mps}, speed_mps);
  area.speed_mps = static_cast<float>(speed_mps);
  return outcome;
}

ReadOutcome ParseCorner(const std::string& name, const std::vector<std::string>& words,
                        Area& area) {
  if (area.corners == kMaxAreaCorners) {
    return {Status::kCapacityExceeded,
            name + ": more than " + std::to_string(kMaxAreaCorners) + " corners"};
  }
  const bool is_on_earth = area.frame == AreaFrame::kEarth;
  if (words.size() != 2) {
    return Wrong(name, is_on_earth ? "expected latitude and longitude" : "expected x and y");
  }
  AreaCorner& corner = area.corner[area.corners++];
  if (is_on_earth) {
    ReadOutcome outcome =
        ParseNanodegrees(name + ": latitude", words[0], kMaxLatitude_ndeg, corner.latitude_ndeg);
    return outcome.ok() ? ParseNanodegrees(name + ": longitude", words[1], kMaxLongitude_ndeg,
                                           corner.longitude_ndeg)
                        : outcome;
  }
  constexpr double kMost_m = kMaxAreaPosition_mm / 1000;
  double x_m = 0.0;
  double y_m = 0.0;
  ReadOutcome outcome = ParseDecimal(name + ": x", words[0], kMost_m, x_m);
  if (outcome.ok()) outcome = ParseDecimal(name + ": y", words[1], kMost_m, y_m);
  corner.x_mm = static_cast<int32_t>(std::lround(x_m * 1000.0));
  corner.y_mm = static_cast<int32_t>(std::lround(y_m * 1000.0));
  return outcome;
}

bool IsNumber(const std::string& word) {
  return word.find_first_of("0123456789") != std::string::npos;
}

// An area that is complete, at the line where it begins.
ReadOutcome Append(const std::string& name, const Area& area, AreaList& areas) {
  if (!IsUsable(areas.PushBack(area))) {
    return {Status::kCapacityExceeded,
            name + ": more than " + std::to_string(kMaxAreas) + " areas"};
  }
  const Status status = CheckAreas(areas);
  return IsUsable(status) ? ReadOutcome{}
                          : ReadOutcome{status, name + ": " + WordsOfRefusedArea(status)};
}

}  // namespace

std::string WordsOfRefusedArea(Status status) {
  switch (status) {
    case Status::kAreaNotSimple:
      return "its border touches or crosses itself";
    case Status::kAreaTooSmall:
      return "it is smaller than a cell of the map (0.04 m^2)";
    case Status::kSecondFence:
      return "there is a fence already";
    case Status::kNotFinite:
      return "a number is not finite";
    case Status::kCapacityExceeded:
      return "it has more than " + std::to_string(kMaxAreaCorners) + " corners";
    default:
      return "it needs three corners, each within 100 km of the origin or of the first corner, and "
             "a speed zone 0.1 to 15 m/s";
  }
}

ReadOutcome ParseNanodegrees(const std::string& name, std::string_view text, int64_t limit_ndeg,
                             int64_t& value_ndeg) {
  std::string_view digits = text;
  const bool negative = digits.starts_with('-');
  if (negative || digits.starts_with('+')) digits.remove_prefix(1);
  const size_t point = std::min(digits.find('.'), digits.size());
  const std::string_view whole = digits.substr(0, point);
  const std::string_view fraction = digits.substr(std::min(point + 1, digits.size()));
  if (whole.empty() || !AreDigits(whole) || !AreDigits(fraction) ||
      (point < digits.size() && fraction.empty())) {
    return Wrong(name, Quoted(text) + " is not a number of degrees such as -96.338912345");
  }
  if (fraction.size() > kFractionDigits) {
    return Wrong(name, Quoted(text) + " has more than nine decimals");
  }
  std::string scaled = std::string(whole) + std::string(fraction);
  scaled.append(kFractionDigits - fraction.size(), '0');
  int64_t magnitude_ndeg = 0;
  const auto [end, error] =
      std::from_chars(scaled.data(), scaled.data() + scaled.size(), magnitude_ndeg);
  if (error != std::errc{} || magnitude_ndeg > limit_ndeg) {
    return Wrong(name, Quoted(text) + " is not within " +
                           std::to_string(limit_ndeg / 1'000'000'000) + " degrees");
  }
  value_ndeg = negative ? -magnitude_ndeg : magnitude_ndeg;
  return {};
}

ReadOutcome ParseAreas(const std::string& text, const std::string& name, AreaList& areas) {
  const auto read = std::make_unique<AreaList>();
  Area area;
  std::string begun;  // name of the line where it begins; empty: none yet
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string here = name + ":" + std::to_string(++number);
    const std::vector<std::string> words = Words(line);
    if (words.empty()) continue;
    ReadOutcome outcome;
    if (IsNumber(words[0]) && begun.empty()) {
      outcome = Wrong(here, "the first word must be keep_out, fence or speed_zone");
    } else if (IsNumber(words[0])) {
      outcome = ParseCorner(here, words, area);
    } else {
      if (!begun.empty()) outcome = Append(begun, area, *read);
      if (outcome.ok()) outcome = ParseHead(here, words, area);
      begun = here;
    }
    if (!outcome.ok()) return outcome;
  }
  if (begun.empty()) return Wrong(name + ":" + std::to_string(number), "no area");
  ReadOutcome outcome = Append(begun, area, *read);
  if (outcome.ok()) areas = *read;
  return outcome;
}

ReadOutcome ReadAreas(const std::string& path, AreaList& areas) {
  std::string text;
  const ReadOutcome outcome = ReadFile(path, kMaxAreaFileBytes, text);
  return outcome.ok() ? ParseAreas(text, path, areas) : outcome;
}

}  // namespace hardpack
