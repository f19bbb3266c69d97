// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackctl/status_view.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "hal/onboard/control/status_table.h"
#include "port_linux/hardpackctl/code_names.h"

namespace hardpack::ctl {
namespace {

using control::Age;
using control::Concern;
using control::FieldKind;

constexpr int kColumnWidth = 48;  // mark, name, value and a gap
constexpr int kGapWidth = 2;
// The last field of a device's part: false where the vehicle has no such device.
constexpr std::string_view kPresent = "present";

template <typename... Arguments>
std::string Format(const char* format, Arguments... arguments) {
  char text[64];
  std::snprintf(text, sizeof(text), format, arguments...);
  return text;
}

std::string DurationText(uint64_t time_ns) {
  const double time = static_cast<double>(time_ns);
  if (time_ns < 1000) return Format("%.0f ns", time);
  if (time_ns < 1'000'000) return Format("%.1f us", time * 1e-3);
  if (time_ns < 1'000'000'000) return Format("%.1f ms", time * 1e-6);
  const uint64_t minutes = time_ns / 60'000'000'000;
  if (minutes < 60) return Format("%.2f s", time * 1e-9);
  if (minutes < 48 * 60) return Format("%d h %02d min", int(minutes / 60), int(minutes % 60));
  return Format("%d d %02d h", int(minutes / 1440), int(minutes / 60 % 24));
}

std::string AgeText(const Age& age) {
  const std::string text = age.age_ns == Age::kNever ? "never" : DurationText(age.age_ns);
  return age.limit_ns == 0 ? text : text + " of " + DurationText(age.limit_ns);
}

std::string NanodegreeText(int64_t value_ndeg) {
  // Of uint64_t, in which the magnitude of the least int64_t fits.
  const uint64_t magnitude =
      value_ndeg < 0 ? -static_cast<uint64_t>(value_ndeg) : static_cast<uint64_t>(value_ndeg);
  return Format("%s%llu.%09llu", value_ndeg < 0 ? "-" : "",
                static_cast<unsigned long long>(magnitude / 1'000'000'000),
                static_cast<unsigned long long>(magnitude % 1'000'000'000));
}

template <typename Value>
std::string HexText(Value value) {
  return Format("0x%0*llx", static_cast<int>(2 * sizeof(Value)),
                static_cast<unsigned long long>(value));
}

constexpr bool IsCode(FieldKind kind) {
  return kind >= FieldKind::kMode;
}

struct Row {
  std::string group;
  std::string name;
  std::string value;
  char mark = ' ';
  bool is_loss = false;
  bool is_count = false;
  uint64_t count = 0;
};

// "worst_tick_ns" is shown in a suitable unit.
std::string ShownName(std::string name, FieldKind kind) {
  const std::string unit = kind == FieldKind::kDuration     ? "_ns"
                           : kind == FieldKind::kNanodegree ? "_ndeg"
                                                            : "";
  if (name.ends_with(unit)) name.resize(name.size() - unit.size());
  return name;
}

class RowCollector {
 public:
  void BeginGroup(const char* name) { group_ = name; }

  template <typename Value>
  void operator()(const char* name, FieldKind kind, Concern concern, const Value& value) {
    if constexpr (std::is_same_v<Value, bool>) {
      if (name == kPresent) {
        if (!value) absent_.insert(group_);
        return;
      }
    }
    Row row;
    row.group = group_;
    row.name = ShownName(name, kind);
    row.value = Text(kind, value);
    row.is_loss = concern == Concern::kLoss;
    if constexpr (std::is_unsigned_v<Value> && sizeof(Value) >= 4) {
      row.is_count = kind == FieldKind::kValue;
      row.count = value;
    }
    if (IsProblem(kind, concern, value)) row.mark = '!';
    if (row.is_loss && row.count != 0) row.mark = '*';
    rows_.push_back(row);
  }

  // Without the parts of devices that the vehicle does not have.
  std::vector<Row> TakeRows() {
    std::erase_if(rows_, [this](const Row& row) { return absent_.contains(row.group); });
    return std::move(rows_);
  }

 private:
  template <typename Value>
  static std::string Text(FieldKind kind, const Value& value) {
    if constexpr (std::is_same_v<Value, Age>) {
      return AgeText(value);
    } else if constexpr (std::is_same_v<Value, bool>) {
      return value ? "yes" : "no";
    } else if constexpr (std::is_array_v<Value>) {
      return value;
    } else if constexpr (std::is_same_v<Value, float>) {
      return Format("%.3f", static_cast<double>(value));
    } else if constexpr (std::is_signed_v<Value>) {
      return kind == FieldKind::kNanodegree ? NanodegreeText(value) : std::to_string(value);
    } else {
      if (kind == FieldKind::kDuration) return DurationText(value);
      if (kind == FieldKind::kHex) return HexText(value);
      return IsCode(kind) ? CodeText(kind, value) : std::to_string(value);
    }
  }

  template <typename Value>
  static std::string CodeText(FieldKind kind, Value value) {
    const std::string name = NameOf(kind, static_cast<uint8_t>(value)).name;
    return name == "unknown" ? name + " (" + std::to_string(value) + ")" : name;
  }

  template <typename Value>
  static bool IsProblem(FieldKind kind, Concern concern, const Value& value) {
    if constexpr (std::is_same_v<Value, Age>) {
      return value.limit_ns != 0 && value.age_ns > value.limit_ns;
    } else if constexpr (!std::is_array_v<Value>) {
      if (concern == Concern::kExpected) return value == Value{};
      if (concern != Concern::kProblem) return false;
      if constexpr (sizeof(Value) == 1) {
        if (IsCode(kind)) return NameOf(kind, static_cast<uint8_t>(value)).is_problem;
      }
      return value != Value{};
    } else {
      return false;
    }
  }

  std::string group_;
  std::set<std::string> absent_;
  std::vector<Row> rows_;
};

std::vector<Row> RowsOf(const control::StatusReport& report) {
  RowCollector collector;
  VisitStatus(report, collector);
  return collector.TakeRows();
}

// "*missed_ticks ............ 3 (+1)", as wide as a column.
std::string Cell(const Row& row, uint64_t grown, bool color) {
  const std::string value =
      row.value + (row.is_loss && grown > 0 ? " (+" + std::to_string(grown) + ")" : "");
  const int room = kColumnWidth - kGapWidth - 1 - static_cast<int>(row.name.size() + value.size());
  std::string text =
      row.mark + row.name + std::string(static_cast<size_t>(std::max(1, room)), ' ') + value;
  if (!color || row.mark == ' ') return text;
  return (row.mark == '!' ? "\033[1;31m" : "\033[33m") + text + "\033[0m";
}

void AppendGroup(const std::string& name, const std::vector<std::string>& cells, int columns,
                 std::string& text) {
  text += (text.empty() ? "" : "\n") + name + "\n";
  for (size_t i = 0; i < cells.size(); ++i) {
    const bool ends_line = (i + 1) % static_cast<size_t>(columns) == 0 || i + 1 == cells.size();
    text += cells[i] + (ends_line ? "\n" : std::string(kGapWidth, ' '));
  }
}

class JsonCollector {
 public:
  JsonCollector() : json_(nlohmann::ordered_json::object()) {}

  void BeginGroup(const char* name) {
    group_ = name;
    json_[group_] = nlohmann::ordered_json::object();
  }

  template <typename Value>
  void operator()(const char* name, FieldKind kind, Concern, const Value& value) {
    if constexpr (std::is_same_v<Value, bool>) {
      if (name == kPresent) {
        if (!value) json_.erase(group_);
        return;
      }
    }
    nlohmann::ordered_json& group = json_[group_];
    if constexpr (std::is_same_v<Value, Age>) {
      const std::string age = name;
      group[age + "_ns"] = value.age_ns == Age::kNever ? nlohmann::ordered_json()
                                                       : nlohmann::ordered_json(value.age_ns);
      group[age + "_limit_ns"] =
          value.limit_ns == 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(value.limit_ns);
    } else if constexpr (std::is_array_v<Value>) {
      group[name] = std::string(value);
    } else if constexpr (std::is_same_v<Value, float>) {
      group[name] = Shortest(value);
    } else if constexpr (std::is_same_v<Value, bool>) {
      group[name] = value;
    } else {
      if (IsCode(kind)) {
        group[name] = NameOf(kind, static_cast<uint8_t>(value)).name;
      } else if (kind == FieldKind::kHex) {
        group[name] = HexText(value);
      } else {
        group[name] = value;
      }
    }
  }

  const nlohmann::ordered_json& json() const { return json_; }

 private:
  // The shortest digits that give the same float again, not the 17 of its value as a double.
  static nlohmann::ordered_json Shortest(float value) {
    if (!std::isfinite(value)) return {};
    std::array<char, 32> text = {};
    const auto shortest = std::to_chars(text.data(), text.data() + text.size(), value);
    double number = 0.0;
    std::from_chars(text.data(), shortest.ptr, number);
    return number;
  }

  std::string group_;
  nlohmann::ordered_json json_;
};

}  // namespace

std::string ToText(const control::StatusReport& report, const control::StatusReport* before,
                   const StatusTextOptions& options) {
  const std::vector<Row> rows = RowsOf(report);
  const std::vector<Row> earlier = before != nullptr ? RowsOf(*before) : rows;
  const int columns = std::max(1, (options.width + kGapWidth) / kColumnWidth);
  std::string text;
  std::vector<std::string> cells;
  for (size_t i = 0; i < rows.size(); ++i) {
    const bool is_zero = rows[i].is_count && rows[i].count == 0;
    if (options.all || !is_zero) {
      const uint64_t earlier_count = std::min(earlier[i].count, rows[i].count);
      cells.push_back(Cell(rows[i], rows[i].count - earlier_count, options.color));
    }
    if (i + 1 < rows.size() && rows[i + 1].group == rows[i].group) continue;
    if (!cells.empty()) AppendGroup(rows[i].group, cells, columns, text);
    cells.clear();
  }
  return text;
}

nlohmann::ordered_json ToJson(const control::StatusReport& report) {
  JsonCollector collector;
  VisitStatus(report, collector);
  return collector.json();
}

}  // namespace hardpack::ctl
