// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/parameter_list.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "config/conflicts.h"
#include "core/base/validate.h"
#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "port_linux/files/configuration_keys.h"
#include "port_linux/files/nearest_name.h"
#include "port_linux/files/set_parameter.h"

namespace hardpack::command {
namespace {

// Calls visit(entry, group) for every parameter.
template <typename ParametersType, typename Visit>
void ForEachParameter(ParametersType& parameters, Visit&& visit) {
  const auto visit_table = [&visit](auto& group, const auto& table) {
    for (const auto& entry : table) visit(entry, group);
  };
  VisitParameters(parameters.planner, visit_table);
  VisitParameters(parameters.perception, visit_table);
}

std::vector<std::string> AllNames() {
  std::vector<std::string> names;
  const Parameters parameters;
  ForEachParameter(parameters,
                   [&names](const auto& entry, const auto&) { names.push_back(entry.full_name); });
  return names;
}

constexpr std::string_view kLabelPrefix = "labels.";

void SetLabelFromText(const std::string& name, const std::string& text, LabelTable& table) {
  const double code = ParseNumber("--param " + name, name.substr(kLabelPrefix.size()));
  if (!(code >= 0.0 && code < kLabelCodes) || code != static_cast<int>(code)) {
    throw CommandFailure(kBadInput, "--param " + name + ": a label code must be 0 .. 255");
  }
  const auto known = std::find(kReturnClassNames.begin(), kReturnClassNames.end(), text);
  if (known == kReturnClassNames.end()) {
    throw CommandFailure(kBadInput, "--param " + name + ": '" + text +
                                        "' is not ignored, ground, soft, hard or person");
  }
  table.class_of[static_cast<size_t>(code)] =
      static_cast<ReturnClass>(std::distance(kReturnClassNames.begin(), known));
}

void SetFromText(const std::string& assignment, Parameters& parameters) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw CommandFailure(kBadInput, "--param: '" + assignment + "' is not GROUP.NAME=VALUE");
  }
  const std::string name = assignment.substr(0, equals);
  const std::string text = assignment.substr(equals + 1);
  if (name.starts_with(kLabelPrefix)) return SetLabelFromText(name, text, parameters.labels);
  bool found = false;
  ForEachParameter(parameters, [&](const auto& entry, auto& group) {
    if (entry.full_name != name) return;
    found = true;
    const double value = ParseNumber("--param " + name, text);
    if (IsUsable(SetParameter(entry, value, group))) return;
    std::ostringstream reason;
    reason << "--param " << name << ": " << text << " is not "
           << (entry.number == nullptr ? "a whole number " : "") << "within " << entry.low << " .. "
           << entry.high;
    throw CommandFailure(kBadInput, reason.str());
  });
  if (found) return;
  const std::string nearest = NearestName(name, AllNames());
  throw CommandFailure(kBadInput, "--param: there is no parameter '" + name + "'" +
                                      (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

void Refuse(const ParameterConflict& conflict) {
  throw CommandFailure(kBadInput, "--param " + std::string(conflict.name) + ": conflicts with " +
                                      conflict.other + ": it must be " + conflict.rule);
}

}  // namespace

void SetParameters(const std::vector<std::string>& assignments, Parameters& parameters) {
  for (const std::string& assignment : assignments) SetFromText(assignment, parameters);
  // Each is within its own range; check the conditions on pairs.
  const auto check_order = [](auto& group, const auto& table) {
    for (const auto& entry : table) {
      if (IsInOrder(entry, group)) continue;
      for (const auto& other : table) {
        if (other.number != entry.not_above) continue;
        Refuse({entry.full_name, other.full_name, "no greater"});
      }
    }
  };
  VisitParameters(parameters.planner, check_order);
  VisitParameters(parameters.perception, check_order);
  ForEachConflict(parameters.planner, Refuse);
  ForEachConflict(parameters.planner.vehicle, parameters.perception, Refuse);
}

nlohmann::json ParametersToJson(const Parameters& parameters) {
  nlohmann::json groups;
  ForEachParameter(parameters, [&groups](const auto& entry, const auto& group) {
    const std::string full_name = entry.full_name;
    nlohmann::json& value = groups[full_name.substr(0, full_name.find('.'))][entry.name];
    if (entry.number != nullptr) {
      value = JsonNumber(group.*entry.number);
    } else {
      value = entry.GetWhole(group);
    }
  });
  for (int code = 0; code < kLabelCodes; ++code) {
    const ReturnClass meaning = parameters.labels.class_of[code];
    if (meaning == ReturnClass::kHard) continue;
    groups["labels"][kReturnClassNames[static_cast<size_t>(meaning)]].push_back(code);
  }
  return groups;
}

}  // namespace hardpack::command
