// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/report_json.h"

#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "hal/onboard/control/status_table.h"
#include "port_linux/hardpackctl/code_names.h"

namespace hardpack::replay {
namespace {

using control::FieldKind;
using nlohmann::json;

constexpr double kSecond_ns = 1e9;
constexpr double kMicrosecond_ns = 1e3;

template <typename Code>
std::string NameOf(FieldKind kind, Code code) {
  return ctl::NameOf(kind, static_cast<uint8_t>(code)).name;
}

// Rounds to `steps` per unit: 10 keeps one decimal.
double Rounded(double value, double steps) {
  return std::round(value * steps) / steps;
}

std::string TextOfField(std::span<const char> field) {
  return {field.data(), strnlen(field.data(), field.size())};
}

json PoseJson(const Pose2& pose) {
  const auto rounded = [](float value) { return Rounded(double{value}, 1e4); };
  return {{"x_m", rounded(pose.x_m)},
          {"y_m", rounded(pose.y_m)},
          {"theta_rad", rounded(pose.theta_rad)}};
}

json DurationJson(const Durations& durations) {
  const double mean_ns = durations.ticks == 0 ? 0.0
                                              : static_cast<double>(durations.sum_ns) /
                                                    static_cast<double>(durations.ticks);
  return {
      {"mean_us", Rounded(mean_ns / kMicrosecond_ns, 10.0)},
      {"largest_us", Rounded(static_cast<double>(durations.largest_ns) / kMicrosecond_ns, 10.0)},
      {"largest_at_tick", durations.largest_index}};
}

json ModesJson(const Report& report) {
  json modes = json::array();
  const uint64_t start_ns = report.modes.empty() ? 0 : report.modes.front().now_ns;
  for (const ModeChange& change : report.modes) {
    modes.push_back({{"tick", change.index},
                     {"time_s", static_cast<double>(change.now_ns - start_ns) / kSecond_ns},
                     {"mode", NameOf(FieldKind::kMode, change.mode)},
                     {"reason", NameOf(FieldKind::kStopReason, change.reason)}});
  }
  return modes;
}

json PlansJson(const Report& report) {
  json plans = json::array();
  for (const PlanEvent& plan : report.plans) {
    plans.push_back({{"tick", plan.index},
                     {"decision", NameOf(FieldKind::kReplanDecision, plan.outcome.decision)},
                     {"reason", NameOf(FieldKind::kReplanReason, plan.outcome.reason)},
                     {"status", StatusName(plan.outcome.status)},
                     {"new_plan_status", StatusName(plan.outcome.plan_status)},
                     {"path", plan.number},
                     {"pose_odom", PoseJson(plan.pose_odom)}});
  }
  return plans;
}

json BySource(const std::array<int64_t, kInputSources>& counts) {
  return {{"ins", counts[static_cast<size_t>(InputSource::kIns)]},
          {"labels", counts[static_cast<size_t>(InputSource::kLabels)]},
          {"lidar", counts[static_cast<size_t>(InputSource::kLidar)]}};
}

// By the names that an operator sees.
json CountersJson(const LoopCounters& counters) {
  json object = json::object();
  const auto add = [&object](const char* name, FieldKind, control::Concern, uint64_t count) {
    object[name] = count;
  };
  control::VisitLoop(counters, add);
  return object;
}

// Of all columns so far; null: never, or none yet (core/safety/reaction_meter.h).
json ReactionJson(const ReactionMeter& reaction) {
  const auto told = [&](float value) {
    const bool is_known = reaction.columns() > 0 && value < ReactionMeter::kBeyond;
    // To a thousandth, as far as bins tell it.
    return is_known ? json(std::round(1000.0 * double{value}) / 1000.0) : json(nullptr);
  };
  return {{"columns", reaction.columns()},
          {"lost", reaction.lost()},
          {"median_s", told(reaction.Time_s(0.5f))},
          {"p99_s", told(reaction.Time_s(0.99f))},
          {"median_m", told(reaction.Radius_m(0.5f))},
          {"p99_m", told(reaction.Radius_m(0.99f))}};
}

json DifferenceJson(const Report& report) {
  if (!report.difference.found) return nullptr;
  return {{"tick", report.difference.index},
          {"what", report.difference.what},
          {"ticks", report.different_ticks}};
}

}  // namespace

std::string HashText(uint64_t hash) {
  std::array<char, 17> text = {};
  std::snprintf(text.data(), text.size(), "%016" PRIx64, hash);
  return text.data();
}

json ReportToJson(const Report& report, const Pilot& pilot) {
  json object = {{"files", report.files},
                 {"kind", report.is_flight_log ? "flight_log" : "capture"},
                 {"ticks", report.ticks},
                 {"first_tick", report.first_index},
                 {"last_tick", report.last_index},
                 {"decision_hash", HashText(report.decision_hash)},
                 {"frames_in", report.frames_in},
                 {"frames_out", report.frames_out},
                 {"datagrams", BySource(report.datagrams)},
                 {"cut", report.cut},
                 {"modes", ModesJson(report)},
                 {"plans", PlansJson(report)},
                 {"counters", CountersJson(pilot.counters())},
                 {"reaction", ReactionJson(pilot.reaction())},
                 {"durations", {{"replayed", DurationJson(report.replayed)}}}};
  if (report.is_flight_log) {
    object["same"] = report.same();
    object["difference"] = DifferenceJson(report);
    object["not_comparable"] =
        report.not_comparable.empty() ? json(nullptr) : json(report.not_comparable);
    object["from_image"] = report.from_image;
    object["ended"] = report.ended;
    object["durations"]["logged"] = DurationJson(report.logged);
    object["logged_by"] = {{"version", TextOfField(report.version.version)},
                           {"build", TextOfField(report.version.build)},
                           {"processor", TextOfField(report.version.processor)},
                           {"vehicle", TextOfField(report.version.vehicle)},
                           {"run", HashText(report.version.run)}};
  } else {
    object["own_frames"] = report.own_frames;
    object["foreign_datagrams"] = report.foreign_datagrams;
    object["duplicates"] = report.duplicates;
    object["incomplete_datagrams"] = report.incomplete;
  }
  return object;
}

}  // namespace hardpack::replay
