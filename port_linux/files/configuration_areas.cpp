// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/configuration_areas.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>

#include "port_linux/files/area_file.h"
#include "port_linux/files/configuration_keys.h"
#include "port_linux/files/line_words.h"

namespace hardpack {
namespace {

constexpr double kNanodegreesPerDegree = 1.0e9;

template <size_t kNames>
std::optional<int> NamedBy(const toml::node* node, const std::array<const char*, kNames>& names) {
  const auto* text = node != nullptr ? node->as_string() : nullptr;
  if (text == nullptr) return std::nullopt;
  const int index = IndexOfName(names, text->get());
  return index < 0 ? std::nullopt : std::optional(index);
}

std::optional<double> NumberOf(const toml::node* node) {
  if (node == nullptr) return std::nullopt;
  if (const auto* whole = node->as_integer()) return static_cast<double>(whole->get());
  if (const auto* number = node->as_floating_point()) return number->get();
  return std::nullopt;
}

// A number within +-limit, in whole parts.
std::optional<int64_t> Scaled(const toml::node* node, double limit, double parts) {
  const std::optional<double> number = NumberOf(node);
  if (!number || !(std::abs(*number) <= limit)) return std::nullopt;
  return std::llround(*number * parts);
}

// One table. The problem, or nothing.
class AreaTable {
 public:
  AreaTable(const toml::table& table, const std::string& name, const ReportProblem& report)
      : table_(table), name_(name), report_(report) {}

  bool Take(Area& area) {
    area = Area{};
    const auto kind = NamedBy(table_.get("kind"), kAreaKindNames);
    const auto frame = NamedBy(table_.get("frame"), kAreaFrameNames);
    if (!kind) return Refuse("kind", "must be \"keep_out\", \"fence\" or \"speed_zone\"");
    if (!frame) return Refuse("frame", "must be \"odom\" or \"latlon\"");
    area.kind = static_cast<AreaKind>(*kind);
    area.frame = static_cast<AreaFrame>(*frame);
    return HasOnlyKnownKeys() && TakeSpeed(area) && TakeCorners(area);
  }

 private:
  bool Refuse(const char* key, const std::string& text,
              Status status = Status::kInvalidArgument) const {
    const toml::node* node = table_.get(key);
    const size_t line = node != nullptr ? node->source().begin.line : table_.source().begin.line;
    report_(line, status, name_ + "." + key + ": " + text);
    return false;
  }

  bool HasOnlyKnownKeys() const {
    for (const auto& [key, node] : table_) {
      const bool is_known = key.str() == "kind" || key.str() == "frame" ||
                            key.str() == "speed_mps" || key.str() == "corners";
      if (is_known) continue;
      report_(key.source().begin.line, Status::kInvalidArgument,
              name_ + ": an area has kind, frame, speed_mps and corners, and no other key");
      return false;
    }
    return true;
  }

  bool TakeSpeed(Area& area) const {
    const bool is_zone = area.kind == AreaKind::kSpeedZone;
    const toml::node* node = table_.get("speed_mps");
    if (!is_zone && node == nullptr) return true;
    if (!is_zone) return Refuse("speed_mps", "only a speed zone has one");
    const std::optional<double> speed_mps = NumberOf(node);
    if (!speed_mps || !(*speed_mps >= double{kMinZoneSpeed_mps} - 1e-6) ||
        !(*speed_mps <= double{kMaxZoneSpeed_mps})) {
      return Refuse("speed_mps", "must be a number from 0.1 to 15 m/s");
    }
    area.speed_mps = static_cast<float>(*speed_mps);
    return true;
  }

  bool TakeCorners(Area& area) const {
    const toml::node* node = table_.get("corners");
    const toml::array* corners = node != nullptr ? node->as_array() : nullptr;
    if (corners == nullptr) return Refuse("corners", "must be a list of pairs of numbers");
    if (corners->size() > static_cast<size_t>(kMaxAreaCorners)) {
      return Refuse("corners", WordsOfRefusedArea(Status::kCapacityExceeded),
                    Status::kCapacityExceeded);
    }
    for (const toml::node& pair : *corners) {
      const toml::array* numbers = pair.as_array();
      if (numbers == nullptr || numbers->size() != 2 ||
          !TakeCorner(numbers->get(0), numbers->get(1), area)) {
        return Refuse("corners", area.frame == AreaFrame::kEarth
                                     ? "each must be [latitude, longitude], in degrees"
                                     : "each must be [x, y], in metres within 1e5");
      }
    }
    return true;
  }

  static bool TakeCorner(const toml::node* first, const toml::node* second, Area& area) {
    AreaCorner& corner = area.corner[area.corners++];
    if (area.frame == AreaFrame::kEarth) {
      const auto latitude = Scaled(first, 90.0, kNanodegreesPerDegree);
      const auto longitude = Scaled(second, 180.0, kNanodegreesPerDegree);
      corner.latitude_ndeg = latitude.value_or(0);
      corner.longitude_ndeg = longitude.value_or(0);
      return latitude && longitude;
    }
    const auto x_mm = Scaled(first, kMaxAreaPosition_m, kAreaUnitsPerMeter);
    const auto y_mm = Scaled(second, kMaxAreaPosition_m, kAreaUnitsPerMeter);
    corner.x_mm = static_cast<int32_t>(x_mm.value_or(0));
    corner.y_mm = static_cast<int32_t>(y_mm.value_or(0));
    return x_mm && y_mm;
  }

  const toml::table& table_;
  const std::string& name_;
  const ReportProblem& report_;
};

// Exact: as many decimals as there are parts.
std::string Decimal(int64_t value, int64_t parts, int digits) {
  const int64_t magnitude = value < 0 ? -value : value;
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%s%lld.%0*lld", value < 0 ? "-" : "",
                static_cast<long long>(magnitude / parts), digits,
                static_cast<long long>(magnitude % parts));
  return text.data();
}

}  // namespace

void TakeConfiguredAreas(const toml::node& node, AreaList& areas, const ReportProblem& report) {
  const toml::array* tables = node.as_array();
  if (tables == nullptr || !tables->is_homogeneous(toml::node_type::table)) {
    report(node.source().begin.line, Status::kInvalidArgument, "area: expected tables: [[area]]");
    return;
  }
  int number = 0;
  for (const toml::node& element : *tables) {
    const std::string name = "area " + std::to_string(++number);
    const size_t line = element.source().begin.line;
    Area area;
    if (!AreaTable(*element.as_table(), name, report).Take(area)) continue;
    Status status = areas.PushBack(area);
    if (!IsUsable(status)) {
      report(line, status, name + ": there are more than " + std::to_string(kMaxAreas));
      return;
    }
    status = CheckAreas(areas);
    if (IsUsable(status)) continue;
    areas.Resize(areas.size() - 1);
    report(line, status, name + ": " + WordsOfRefusedArea(status));
  }
}

std::string AreasToToml(const AreaList& areas) {
  std::string text;
  for (const Area& area : areas) {
    text.append("\n[[area]]\nkind = \"").append(kAreaKindNames[static_cast<size_t>(area.kind)]);
    text.append("\"\nframe = \"").append(kAreaFrameNames[static_cast<size_t>(area.frame)]);
    text += "\"\n";
    if (area.kind == AreaKind::kSpeedZone) {
      text.append("speed_mps = ").append(NumberText(area.speed_mps)).append("\n");
    }
    text += "corners = [";
    for (int i = 0; i < area.corners; ++i) {
      const AreaCorner& corner = area.corner[i];
      const bool is_on_earth = area.frame == AreaFrame::kEarth;
      const std::string first = is_on_earth ? Decimal(corner.latitude_ndeg, 1'000'000'000, 9)
                                            : Decimal(corner.x_mm, 1000, 3);
      const std::string second = is_on_earth ? Decimal(corner.longitude_ndeg, 1'000'000'000, 9)
                                             : Decimal(corner.y_mm, 1000, 3);
      text.append(i > 0 ? ", [" : "[").append(first).append(", ").append(second).append("]");
    }
    text += "]\n";
  }
  return text;
}

}  // namespace hardpack
