// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/area_file.h"

#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "port_linux/files/line_words.h"
#include "port_linux/files/read_file.h"

namespace hardpack {
namespace {

ReadOutcome ParseHead(const std::string& name, const std::vector<std::string>& words, Area& area) {
  const int kind = IndexOfName(kAreaKindNames, words[0]);
  if (kind < 0) {
    return Wrong(name, Quoted(words[0]) + " is not keep_out, fence, speed_zone or a number");
  }
  const int frame = words.size() > 1 ? IndexOfName(kAreaFrameNames, words[1]) : -1;
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
    ReadOutcome outcome = ParseLatitude(name + ": latitude", words[0], corner.latitude_ndeg);
    return outcome.ok() ? ParseLongitude(name + ": longitude", words[1], corner.longitude_ndeg)
                        : outcome;
  }
  double x_m = 0.0;
  double y_m = 0.0;
  ReadOutcome outcome = ParseDecimal(name + ": x", words[0], kMaxAreaPosition_m, x_m);
  if (outcome.ok()) outcome = ParseDecimal(name + ": y", words[1], kMaxAreaPosition_m, y_m);
  corner.x_mm = static_cast<int32_t>(std::lround(x_m * kAreaUnitsPerMeter));
  corner.y_mm = static_cast<int32_t>(std::lround(y_m * kAreaUnitsPerMeter));
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

ReadOutcome ParseAreas(const std::string& text, const std::string& name, AreaList& areas) {
  const auto read = std::make_unique<AreaList>();
  Area area;
  std::string begun;  // name of the line where it begins; empty: none yet
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string here = name + ":" + std::to_string(++number);
    const std::vector<std::string> words = WordsOf(line);
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
