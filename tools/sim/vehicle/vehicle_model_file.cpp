// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/vehicle_model_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "port_linux/files/nearest_name.h"
#include "port_linux/files/read_file.h"
#include "port_linux/files/toml_lines.h"
#include "port_linux/files/toml_parser.h"

namespace hardpack::sim {
namespace {

// The table of a kind of vehicle.
template <typename Params>
constexpr std::string_view kTable = "vehicle_model";
template <>
constexpr std::string_view kTable<SteeredModelParams> = "steered_model";

// Printable and short.
std::string Shown(std::string_view text) {
  constexpr size_t kMaxShown = 60;
  std::string shown(text.substr(0, kMaxShown));
  for (char& letter : shown) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return shown;
}

template <typename Params>
const ModelParameter<Params>* ParameterNamed(std::string_view name) {
  for (const ModelParameter<Params>& parameter : ParametersOf<Params>()) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

template <typename Params>
std::string Suggestion(const std::string& unknown) {
  std::vector<std::string> names;
  for (const auto& parameter : ParametersOf<Params>()) names.push_back(parameter.name);
  const std::string nearest = NearestName(unknown, names);
  return nearest.empty() ? "" : ", did you mean " + nearest + "?";
}

template <typename Params>
class Intake {
 public:
  explicit Intake(std::string name) : name_(std::move(name)) {}

  void TakeFile(const toml::table& file);
  const Uncertain<Params>& vehicle() const { return vehicle_; }
  const ReadOutcome& outcome() const { return outcome_; }

 private:
  void Add(size_t line, Status status, const std::string& text);
  using Parameter = ModelParameter<Params>;

  void TakeParameter(const Parameter& parameter, const toml::node& node);
  void TakeNumber(const Parameter& parameter, const toml::node& node, bool is_deviation);

  std::string name_;
  Uncertain<Params> vehicle_;
  ReadOutcome outcome_;
};

template <typename Params>
void Intake<Params>::Add(size_t line, Status status, const std::string& text) {
  if (outcome_.ok()) {
    outcome_.status = status;
  } else {
    outcome_.message += '\n';
  }
  outcome_.message += name_;
  if (line > 0) outcome_.message.append(":").append(std::to_string(line));
  outcome_.message.append(": ").append(text);
}

template <typename Params>
void Intake<Params>::TakeNumber(const Parameter& parameter, const toml::node& node,
                                bool is_deviation) {
  const std::string name = std::string(parameter.name) + (is_deviation ? ".deviation" : "");
  const size_t line = node.source().begin.line;
  if (!node.is_number()) {
    Add(line, Status::kInvalidArgument, name + ": is not a number");
    return;
  }
  const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get())
                                         : node.as_floating_point()->get();
  if (!std::isfinite(value)) {
    Add(line, Status::kNotFinite, name + ": is not a finite number");
    return;
  }
  const double low = is_deviation ? 0.0 : parameter.low;
  const double high = is_deviation ? parameter.high - parameter.low : parameter.high;
  if (value < low || value > high) {
    Add(line, Status::kParameterOutOfRange,
        name + ": " + NumberText(value) + " is not from " + NumberText(low) + " to " +
            NumberText(high));
    return;
  }
  Params& target = is_deviation ? vehicle_.deviation : vehicle_.typical;
  target.*parameter.value = value;
}

template <typename Params>
void Intake<Params>::TakeParameter(const Parameter& parameter, const toml::node& node) {
  const toml::table* both = node.as_table();
  if (both == nullptr) {
    TakeNumber(parameter, node, false);
    return;
  }
  for (const auto& [key, value] : *both) {
    if (key.str() == "value" || key.str() == "deviation") {
      TakeNumber(parameter, value, key.str() == "deviation");
      continue;
    }
    Add(key.source().begin.line, Status::kInvalidArgument,
        std::string(parameter.name) + "." + Shown(key.str()) +
            ": unknown key; the keys are value and deviation");
  }
  if (!both->contains("value")) {
    Add(node.source().begin.line, Status::kInvalidArgument,
        std::string(parameter.name) + ": has no value");
  }
}

template <typename Params>
void Intake<Params>::TakeFile(const toml::table& file) {
  for (const auto& [key, node] : file) {
    if (key.str() == kTable<Params> && node.is_table()) continue;
    Add(key.source().begin.line, Status::kInvalidArgument,
        Shown(key.str()) + ": the only table is [" + std::string(kTable<Params>) + "]");
  }
  const toml::node* node = file.get(kTable<Params>);
  const toml::table* table = node != nullptr ? node->as_table() : nullptr;
  if (table == nullptr) {
    Add(0, Status::kInvalidArgument, "has no table [" + std::string(kTable<Params>) + "]");
    return;
  }
  std::set<std::string_view> found;
  for (const auto& [key, value] : *table) {
    const Parameter* parameter = ParameterNamed<Params>(key.str());
    if (parameter == nullptr) {
      const std::string unknown = Shown(key.str());
      Add(key.source().begin.line, Status::kInvalidArgument,
          unknown + ": unknown key" + Suggestion<Params>(unknown));
      continue;
    }
    found.insert(parameter->name);
    TakeParameter(*parameter, value);
  }
  for (const Parameter& parameter : ParametersOf<Params>()) {
    if (found.contains(parameter.name)) continue;
    Add(0, Status::kInvalidArgument, std::string(parameter.name) + ": must be set");
  }
}

template <typename Params>
ReadOutcome Take(const toml::table& file, const std::string& name, Uncertain<Params>& vehicle) {
  Intake<Params> intake(name);
  intake.TakeFile(file);
  if (intake.outcome().ok()) vehicle = intake.vehicle();
  return intake.outcome();
}

// The file's tables into take(table).
template <typename TakeTable>
ReadOutcome Parse(std::string_view toml, const std::string& name, TakeTable&& take) {
  if (toml.size() > kMaxVehicleFileBytes) {
    return {Status::kOversized,
            name + ": larger than " + std::to_string(kMaxVehicleFileBytes) + " bytes"};
  }
  ReadOutcome lines = CheckTomlLines(toml, name);
  if (!lines.ok()) return lines;
  const toml::parse_result parsed = toml::parse(toml);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    return {Status::kInvalidArgument, name + ":" + std::to_string(error.source().begin.line) +
                                          ": " + Shown(error.description())};
  }
  return take(parsed.table());
}

template <typename Params>
std::string ToToml(const Uncertain<Params>& vehicle, const std::string& comment) {
  std::string text = "# SPDX-License-Identifier: Apache-2.0\n";
  for (size_t from = 0; from < comment.size();) {
    const size_t end = std::min(comment.find('\n', from), comment.size());
    text += end > from ? "# " + comment.substr(from, end - from) + "\n" : "#\n";
    from = end + 1;
  }
  text += "\n[" + std::string(kTable<Params>) + "]\n";
  for (const ModelParameter<Params>& parameter : ParametersOf<Params>()) {
    const double value = vehicle.typical.*parameter.value;
    const double deviation = vehicle.deviation.*parameter.value;
    text += std::string("# ") + parameter.description + "; " + NumberText(parameter.low) + " to " +
            NumberText(parameter.high) + "\n" + parameter.name + " = ";
    text += deviation == 0.0 ? NumberText(value)
                             : "{ value = " + NumberText(value) +
                                   ", deviation = " + NumberText(deviation) + " }";
    text += "\n";
  }
  return text;
}

}  // namespace

ReadOutcome ParseVehicle(std::string_view toml, const std::string& name,
                         UncertainVehicle& vehicle) {
  return Parse(toml, name, [&](const toml::table& file) { return Take(file, name, vehicle); });
}

ReadOutcome ParseBody(std::string_view toml, const std::string& name, UncertainBody& vehicle) {
  return Parse(toml, name, [&](const toml::table& file) {
    const auto take = [&](auto one) {
      ReadOutcome outcome = Take(file, name, one);
      if (outcome.ok()) vehicle = one;
      return outcome;
    };
    if (file.contains(kTable<SteeredModelParams>)) return take(UncertainSteered());
    return take(UncertainVehicle());
  });
}

ReadOutcome ReadVehicle(const std::string& path, UncertainVehicle& vehicle) {
  std::string text;
  const ReadOutcome outcome = ReadFile(path, kMaxVehicleFileBytes, text);
  return outcome.ok() ? ParseVehicle(text, path, vehicle) : outcome;
}

ReadOutcome ReadBody(const std::string& path, UncertainBody& vehicle) {
  std::string text;
  const ReadOutcome outcome = ReadFile(path, kMaxVehicleFileBytes, text);
  return outcome.ok() ? ParseBody(text, path, vehicle) : outcome;
}

std::string VehicleToToml(const UncertainVehicle& vehicle, const std::string& comment) {
  return ToToml(vehicle, comment);
}

std::string VehicleToToml(const UncertainBody& vehicle, const std::string& comment) {
  return std::visit([&](const auto& one) { return ToToml(one, comment); }, vehicle);
}

std::string NumberText(double value) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  std::string text(digits.data(), error == std::errc{} ? end : digits.data());
  const bool is_whole = text.find_first_of(".en") == std::string::npos;
  return is_whole ? text + ".0" : text;
}

}  // namespace hardpack::sim
