// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/configuration.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "config/conflicts.h"
#include "core/base/validate.h"
#include "hal/sevcon/bus_load.h"
#include "hal/sevcon/sevcon.h"
#include "port_linux/files/configuration_areas.h"
#include "port_linux/files/configuration_keys.h"
#include "port_linux/files/nearest_name.h"
#include "port_linux/files/read_file.h"
#include "port_linux/files/set_parameter.h"
#include "port_linux/files/toml_lines.h"
#include "port_linux/files/toml_parser.h"
#include "port_linux/files/vehicle_types.h"

namespace hardpack {
namespace {

constexpr size_t kMaxQuoted = 60;          // most letters of a file quoted in a message
constexpr size_t kMaxNameToCompare = 100;  // longer texts are not mistyped names

struct Problem {
  size_t line = 0;  // 0: the file as a whole
  Status status = Status::kInvalidArgument;
  std::string text;
  std::string unknown;  // empty, or the name for which to suggest a known one
};

// Printable and short.
std::string Shown(std::string_view text) {
  std::string shown(text.substr(0, kMaxQuoted));
  for (char& letter : shown) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return text.size() > kMaxQuoted ? shown + "..." : shown;
}

std::string Shown(const toml::node& node) {
  if (const auto* text = node.as_string()) return '"' + Shown(text->get()) + '"';
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* is_on = node.as_boolean()) return is_on->get() ? "true" : "false";
  if (const auto* number = node.as_floating_point()) {
    std::array<char, 32> digits;
    const auto [end, error] =
        std::to_chars(digits.data(), digits.data() + digits.size(), number->get());
    return error == std::errc{} ? std::string(digits.data(), end) : "a number";
  }
  if (node.is_table()) return "a table";
  return node.is_array() ? "a list" : "a date or time";
}

size_t LineOf(const toml::node& node) {
  return node.source().begin.line;
}
size_t LineOf(const toml::key& key) {
  return key.source().begin.line;
}

// A number through the one check of port_linux/files/set_parameter.h.
struct Checked {
  float number = 0.0f;
  int32_t whole = 0;
};
Status Check(const ConfigurationKey& key, double value, int32_t Checked::*member,
             Checked& checked) {
  return SetParameter(MakeEntry("", "", member, key.low, key.high, ""), value, checked);
}
Status Check(const ConfigurationKey& key, double value, float Checked::*member, Checked& checked) {
  return SetParameter(MakeEntry("", "", member, key.low, key.high, ""), value, checked);
}

Status SetNumber(const ConfigurationKey& key, double value) {
  Checked checked;
  if (auto* const* number = std::get_if<float*>(&key.value)) {
    const Status status = Check(key, value, &Checked::number, checked);
    if (IsUsable(status)) **number = checked.number;
    return status;
  }
  const Status status = Check(key, value, &Checked::whole, checked);
  if (!IsUsable(status)) return status;
  if (auto* const* whole = std::get_if<int32_t*>(&key.value)) {
    **whole = checked.whole;
  } else if (auto* const* rule = std::get_if<ObstacleRule*>(&key.value)) {
    **rule = static_cast<ObstacleRule>(checked.whole);
  } else {
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

Status SetText(const ConfigurationKey& key, const std::string& text) {
  if (auto* const* address = std::get_if<Ipv4Address*>(&key.value)) {
    return ParseIpv4(text, **address) ? Status::kOk : Status::kInvalidArgument;
  }
  auto* const* target = std::get_if<std::string*>(&key.value);
  if (target == nullptr) return Status::kInvalidArgument;
  const float letters = static_cast<float>(text.size());
  if (letters < key.low || letters > key.high) return Status::kParameterOutOfRange;
  const bool is_plain = std::none_of(
      text.begin(), text.end(), [](unsigned char byte) { return byte < 0x20 || byte == 0x7f; });
  if (!is_plain) return Status::kInvalidArgument;
  **target = text;
  return Status::kOk;
}

Status SetValue(const ConfigurationKey& key, const toml::node& node) {
  if (const auto* whole = node.as_integer()) {
    return SetNumber(key, static_cast<double>(whole->get()));
  }
  if (const auto* number = node.as_floating_point()) return SetNumber(key, number->get());
  if (const auto* text = node.as_string()) return SetText(key, text->get());
  auto* const* is_on = std::get_if<bool*>(&key.value);
  if (is_on == nullptr || !node.is_boolean()) return Status::kInvalidArgument;
  **is_on = node.as_boolean()->get();
  return Status::kOk;
}

std::optional<ReturnClass> ClassNamed(const toml::node& node) {
  const auto* text = node.as_string();
  if (text == nullptr) return std::nullopt;
  const auto known = std::find(kReturnClassNames.begin(), kReturnClassNames.end(), text->get());
  if (known == kReturnClassNames.end()) return std::nullopt;
  return static_cast<ReturnClass>(std::distance(kReturnClassNames.begin(), known));
}

// "19"; no sign, no leading zero: a code has one name.
std::optional<size_t> LabelCode(std::string_view text) {
  size_t code = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), code);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  if (code >= kLabelCodes || std::to_string(code) != text) return std::nullopt;
  return code;
}

// What replaces a key of former versions; null: it never was one.
const char* InsteadOf(const std::string& full_name) {
  constexpr const char* kOutline =
      "it follows from vehicle.length_m, vehicle.width_m and vehicle.axle_offset_m";
  for (const char* former : {"vehicle.footprint_disc_radius_m", "vehicle.footprint_disc_offset_m",
                             "vehicle.pivot_radius_m"}) {
    if (full_name == former) return kOutline;
  }
  return nullptr;
}

// Reads a parsed file into a configuration and collects its errors.
class Intake {
 public:
  explicit Intake(Configuration& configuration)
      : configuration_(configuration), keys_(KeysOf(configuration)) {
    for (size_t i = 0; i < keys_.size(); ++i) key_index_[keys_[i].full_name] = i;
    found_.resize(keys_.size());
  }

  void TakeFile(const toml::table& file);
  void CheckRequired();
  void CheckTogether();

  bool is_good() const { return problems_.empty(); }
  ReadOutcome Outcome(std::string_view name);

 private:
  struct Found {
    size_t line = 0;  // 0: the file does not set it
    bool is_bad = false;
    bool is_placeholder = false;
  };

  void TakeGroup(const std::string& group, const toml::table& table);
  void TakeValue(size_t index, const toml::node& node);
  void TakeClasses(const toml::node& node);
  bool IsGroup(std::string_view group) const;
  std::string Suggestion(const std::string& unknown) const;
  void CheckDrives();
  void CheckConflicts();
  void CheckVehicle();
  void CheckVelodyne();
  void CheckPorts();
  void Add(size_t line, Status status, std::string text, std::string unknown = {}) {
    problems_.push_back({line, status, std::move(text), std::move(unknown)});
  }
  size_t LineOfKey(const std::string& full_name) const {
    return found_[key_index_.at(full_name)].line;
  }

  Configuration& configuration_;
  std::vector<ConfigurationKey> keys_;
  std::map<std::string, size_t, std::less<>> key_index_;
  std::vector<Found> found_;  // [key]
  std::vector<Problem> problems_;
};

bool Intake::IsGroup(std::string_view group) const {
  return std::any_of(keys_.begin(), keys_.end(),
                     [group](const ConfigurationKey& key) { return key.group() == group; });
}

void Intake::TakeFile(const toml::table& file) {
  for (const auto& [key, node] : file) {
    const std::string group(key.str());
    const toml::table* table = node.as_table();
    if (group == "area") {
      TakeConfiguredAreas(node, configuration_.areas,
                          [this](size_t line, Status status, std::string text) {
                            Add(line, status, std::move(text));
                          });
    } else if (IsGroup(group) && table != nullptr) {
      TakeGroup(group, *table);
    } else if (IsGroup(group)) {
      std::string text = group;
      text.append(": is ").append(Shown(node)).append(", expected a table: [");
      Add(LineOf(key), Status::kInvalidArgument, text.append(group).append("]"));
    } else if (table != nullptr) {
      Add(LineOf(key), Status::kInvalidArgument, '[' + Shown(group) + "]: unknown table", group);
    } else {
      Add(LineOf(key), Status::kInvalidArgument, Shown(group) + ": is not in a table", group);
    }
  }
}

void Intake::TakeGroup(const std::string& group, const toml::table& table) {
  for (const auto& [key, node] : table) {
    const std::string full_name = group + "." + std::string(key.str());
    const auto known = key_index_.find(full_name);
    if (known != key_index_.end()) {
      found_[known->second].line = LineOf(key);
      TakeValue(known->second, node);
    } else if (full_name == "labels.classes") {
      TakeClasses(node);
    } else if (const char* instead = InsteadOf(full_name)) {
      Add(LineOf(key), Status::kInvalidArgument, full_name + ": is no longer a key: " + instead);
    } else {
      Add(LineOf(key), Status::kInvalidArgument, Shown(full_name) + ": unknown key", full_name);
    }
  }
}

void Intake::TakeValue(size_t index, const toml::node& node) {
  const ConfigurationKey& key = keys_[index];
  const auto* text = node.as_string();
  if (text != nullptr && text->get() == kPlaceholder) {
    // CheckRequired says why it is needed, if it is.
    found_[index].is_placeholder =
        std::any_of(RequiredKeys().begin(), RequiredKeys().end(),
                    [&key](const RequiredKey& row) { return row.full_name == key.full_name; });
    if (found_[index].is_placeholder) return;
  }
  const Status status = SetValue(key, node);
  if (IsUsable(status)) return;
  found_[index].is_bad = true;
  Add(LineOf(node), status, key.full_name + ": " + Shown(node) + " is not " + ExpectedOf(key));
}

void Intake::TakeClasses(const toml::node& node) {
  const toml::table* classes = node.as_table();
  if (classes == nullptr) {
    Add(LineOf(node), Status::kInvalidArgument,
        "labels.classes: is " + Shown(node) + ", expected a table: [labels.classes]");
    return;
  }
  // "default" applies to the codes that are not listed, so it comes first.
  if (const toml::node* other = classes->get("default")) {
    if (const auto meaning = ClassNamed(*other)) {
      for (ReturnClass& entry : configuration_.labels.class_of) entry = *meaning;
    }
  }
  for (const auto& [key, value] : *classes) {
    const std::string full_name = "labels.classes." + Shown(key.str());
    const auto code = LabelCode(key.str());
    const auto meaning = ClassNamed(value);
    if (!code && key.str() != "default") {
      Add(LineOf(key), Status::kInvalidArgument,
          full_name + ": is neither a code from 0 to 255 nor \"default\"");
    } else if (!meaning) {
      Add(LineOf(value), Status::kInvalidArgument,
          full_name + ": " + Shown(value) +
              " is not \"ignored\", \"ground\", \"soft\", \"hard\" or \"person\"");
    } else if (code) {
      configuration_.labels.class_of[*code] = *meaning;
    }
  }
}

void Intake::CheckRequired() {
  for (const RequiredKey& row : RequiredKeys()) {
    const size_t index = key_index_.at(std::string(row.full_name));
    const Found& found = found_[index];
    const bool is_there = found.line != 0 && !found.is_placeholder && !IsUnset(keys_[index]);
    if (found.is_bad || is_there || !row.is_needed(configuration_)) continue;
    Add(found.line, Status::kInvalidArgument,
        std::string(row.full_name) + ": must be set: " + std::string(row.why));
  }
}

void Intake::CheckTogether() {
  for (size_t i = 0; i < keys_.size(); ++i) {
    const ConfigurationKey& key = keys_[i];
    if (key.not_above.empty() || found_[i].is_bad) continue;
    const size_t other = key_index_.at(key.not_above);
    if (found_[other].is_bad) continue;
    const auto as_number = [](const ConfigurationKey& one) {
      auto* const* whole = std::get_if<int32_t*>(&one.value);
      return whole != nullptr ? static_cast<double>(**whole)
                              : static_cast<double>(*std::get<float*>(one.value));
    };
    if (as_number(key) <= as_number(keys_[other])) continue;
    Add(std::max(found_[i].line, found_[other].line), Status::kInvalidArgument,
        key.full_name + ": " + ValueText(key) + " is above " + key.not_above + ", which is " +
            ValueText(keys_[other]));
  }
  if (!is_good()) return;
  CheckConflicts();
  if (configuration_.can.interface.find_first_of("/ ") != std::string::npos) {
    Add(LineOfKey("can.interface"), Status::kInvalidArgument,
        "can.interface: the name of an interface contains no / or blank");
  }
  CheckDrives();
  CheckVehicle();
  CheckVelodyne();
  CheckPorts();
}

void Intake::CheckDrives() {
  if (!DevicesOf(configuration_.vehicle_type).sevcon) return;
  const DriveParams& drive = configuration_.onboard.drive;
  const Status status = sevcon::DrivePair().Configure(drive);
  if (IsUsable(status)) return;
  if (status == Status::kCapacityExceeded) {
    Add(LineOfKey("drive.max_bus_load_percent"), Status::kInvalidArgument,
        "drive.max_bus_load_percent: is " + std::to_string(drive.max_bus_load_percent) +
            ", but the frames sent and requested at these periods take " +
            std::to_string(sevcon::BusLoad_percent(drive)) + " % of the bus");
    return;
  }
  for (const char* sign : {"drive.left_sign", "drive.right_sign"}) {
    const ConfigurationKey& key = keys_[key_index_.at(sign)];
    const int32_t value = *std::get<int32_t*>(key.value);
    if (value == 1 || value == -1) continue;
    Add(LineOfKey(sign), Status::kInvalidArgument,
        std::string(sign) + ": must be 1 or -1, not " + ValueText(key));
  }
}

// Names both keys and the condition, at the line of the later key.
void Intake::CheckConflicts() {
  const auto take = [this](const ParameterConflict& conflict) {
    const size_t one = key_index_.at(conflict.name);
    const size_t other = key_index_.at(conflict.other);
    Add(std::max(found_[one].line, found_[other].line), Status::kInvalidArgument,
        keys_[one].full_name + ": " + ValueText(keys_[one]) + " conflicts with " +
            keys_[other].full_name + ", which is " + ValueText(keys_[other]) + ": it must be " +
            conflict.rule);
  };
  const Configuration& read = configuration_;
  if (read.planner.costmap.ground_window_cells % 2 == 0) {
    Add(LineOfKey("costmap.ground_window_cells"), Status::kInvalidArgument,
        "costmap.ground_window_cells: must be odd, not " +
            std::to_string(read.planner.costmap.ground_window_cells));
  }
  ForEachConflict(read.planner, take);
  ForEachConflict(read.planner.vehicle, read.perception, take);
  ForEachConflict(read.planner.costmap, read.perception.segmentation, take);
  ForEachConflict(read.planner, read.onboard, take);
  ForEachConflict(read.onboard.drive, take);
  ForEachConflict(read.onboard.twist_drive, read.planner.vehicle, take);
}

void Intake::CheckVehicle() {
  const std::string& type = configuration_.vehicle_type;
  const std::vector<std::string_view> types = VehicleTypes();
  if (std::find(types.begin(), types.end(), type) != types.end()) return;
  std::string text = "vehicle.type: must be one of";
  for (const std::string_view known : types) text.append(" ").append(known);
  text.append(", not \"").append(Shown(type)).append("\"");
  Add(LineOfKey("vehicle.type"), Status::kInvalidArgument, text);
}

void Intake::CheckVelodyne() {
  const VelodyneConfiguration& read = configuration_.velodyne;
  velodyne::Config config;
  if (!IsUsable(ToConfig({read.model, "dual", read.rpm}, config))) {
    Add(LineOfKey("velodyne.model"), Status::kInvalidArgument,
        "velodyne.model: must be vlp16 or vlp32c, not \"" + Shown(read.model) + '"');
  }
  if (!IsUsable(ToConfig({"vlp16", read.returns, read.rpm}, config))) {
    Add(LineOfKey("velodyne.returns"), Status::kInvalidArgument,
        "velodyne.returns: must be strongest, last or dual, not \"" + Shown(read.returns) + '"');
  }
  if (read.rpm % velodyne::kRpmStep != 0) {
    Add(LineOfKey("velodyne.rpm"), Status::kInvalidArgument,
        "velodyne.rpm: must be a multiple of 60, not " + std::to_string(read.rpm));
  }
}

void Intake::CheckPorts() {
  const bool has_labels = configuration_.perception.mapping.use_labels != 0;
  const std::array<std::pair<std::string, int32_t>, 3> ports = {
      {{"lidar.port", configuration_.lidar.port},
       {"ins.port", configuration_.ins.port},
       {"labels.port", has_labels ? configuration_.label_source.port : 0}}};
  for (size_t i = 0; i < ports.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (ports[i].second == 0 || ports[i].second != ports[j].second) continue;
      Add(LineOfKey(ports[i].first), Status::kInvalidArgument,
          ports[i].first + ": is the same as " + ports[j].first + ": each sensor needs its own");
    }
  }
}

std::string Intake::Suggestion(const std::string& unknown) const {
  if (unknown.size() > kMaxNameToCompare) return {};
  const std::string name = unknown.substr(unknown.find('.') + 1);
  const bool is_group = name.size() == unknown.size();
  std::vector<std::string> names;
  for (const ConfigurationKey& key : keys_) {
    names.push_back(is_group ? key.group() : key.full_name);
    // The right name in the wrong table, or in none.
    if (key.name() == name) return ", did you mean " + key.full_name + "?";
  }
  const std::string nearest = NearestName(unknown, names);
  if (nearest.empty()) return {};
  return ", did you mean " + (is_group ? "[" + nearest + "]" : nearest) + "?";
}

ReadOutcome Intake::Outcome(std::string_view name) {
  if (problems_.empty()) return {};
  // In the order of the file; problems without a line come last, as 0 - 1 is the largest number.
  std::stable_sort(problems_.begin(), problems_.end(),
                   [](const Problem& a, const Problem& b) { return a.line - 1 < b.line - 1; });
  ReadOutcome outcome{problems_.front().status, {}};
  const size_t shown = std::min<size_t>(problems_.size(), kMaxConfigurationProblems);
  for (size_t i = 0; i < shown; ++i) {
    const Problem& problem = problems_[i];
    if (i > 0) outcome.message += '\n';
    outcome.message += name;
    if (problem.line > 0) outcome.message.append(":").append(std::to_string(problem.line));
    outcome.message.append(": ").append(problem.text);
    if (!problem.unknown.empty()) outcome.message += Suggestion(problem.unknown);
  }
  if (shown < problems_.size()) {
    outcome.message += '\n';
    outcome.message += name;
    outcome.message += ": and " + std::to_string(problems_.size() - shown) + " more";
  }
  return outcome;
}

}  // namespace

ReadOutcome ParseConfiguration(std::string_view toml, std::string_view name,
                               Configuration& configuration) {
  const std::string file(name);
  if (toml.size() > kMaxConfigurationBytes) {
    return {Status::kOversized,
            file + ": larger than " + std::to_string(kMaxConfigurationBytes) + " bytes"};
  }
  ReadOutcome lines = CheckTomlLines(toml, file);
  if (!lines.ok()) return lines;
  const toml::parse_result parsed = toml::parse(toml);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    constexpr size_t kMaxDescription = 300;
    std::string description(error.description().substr(0, kMaxDescription));
    for (char& letter : description) {
      if (letter < ' ' || letter > '~') letter = '?';
    }
    return {Status::kInvalidArgument,
            file + ":" + std::to_string(error.source().begin.line) + ": " + description};
  }
  Configuration read;
  Intake intake(read);
  intake.TakeFile(parsed.table());
  intake.CheckRequired();
  intake.CheckTogether();
  if (intake.is_good()) configuration = std::move(read);
  return intake.Outcome(name);
}

ReadOutcome ReadConfiguration(const std::string& path, Configuration& configuration) {
  std::string text;
  const ReadOutcome outcome = ReadFile(path, kMaxConfigurationBytes, text);
  return outcome.ok() ? ParseConfiguration(text, path, configuration) : outcome;
}

}  // namespace hardpack
