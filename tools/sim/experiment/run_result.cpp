// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/run_result.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <tuple>

namespace hardpack::experiment {
namespace {

constexpr const char* kNames[] = {"reached", "said",   "stuck", "time_out",
                                  "contact", "person", "fault"};
static_assert(std::size(kNames) == kOutcomes);

auto RowKey(const RunResult& one) {
  return std::tie(one.world, one.planner, one.tracker, one.vehicle, one.labels,
                  one.max_speed_set_mps);
}
auto Key(const RunResult& one) {
  return std::tuple_cat(RowKey(one), std::tie(one.seed));
}

// Only bins that are not empty: [bin, count].
nlohmann::json ToJson(const Histogram& histogram) {
  nlohmann::json bins = nlohmann::json::array();
  for (size_t i = 0; i < histogram.counts().size(); ++i) {
    if (histogram.counts()[i] > 0) bins.push_back({i, histogram.counts()[i]});
  }
  return {{"width", histogram.width()}, {"bins", bins}, {"beyond", histogram.beyond()}};
}

bool FromJson(const nlohmann::json& object, Histogram& histogram) {
  if (object.at("width").get<double>() != histogram.width()) return false;
  for (const nlohmann::json& bin : object.at("bins")) {
    const auto index = bin.at(0).get<size_t>();
    if (index >= histogram.counts().size()) return false;
    histogram.Add((static_cast<double>(index) + 0.5) * histogram.width(), bin.at(1).get<int64_t>());
  }
  histogram.Add(INFINITY, object.at("beyond").get<int64_t>());
  return true;
}

std::string HashText(uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

ReadOutcome Bad(const std::string& message) {
  return {Status::kInvalidArgument, message};
}

nlohmann::ordered_json ToJson(const WayResult& way) {
  return {{"off_base_m", way.off_base_m},
          {"cross_track_m", way.cross_track_m},
          {"overshoots", way.overshoots},
          {"recovery_s", way.recovery_s},
          {"recovered", way.recovered},
          {"side_switches", way.side_switches},
          {"replans_beside", way.replans_beside},
          {"off_middle_m", way.off_middle_m ? nlohmann::json(*way.off_middle_m) : nullptr}};
}

void Fill(const nlohmann::json& object, WayResult& way) {
  object.at("off_base_m").get_to(way.off_base_m);
  object.at("cross_track_m").get_to(way.cross_track_m);
  object.at("overshoots").get_to(way.overshoots);
  object.at("recovery_s").get_to(way.recovery_s);
  object.at("recovered").get_to(way.recovered);
  object.at("side_switches").get_to(way.side_switches);
  object.at("replans_beside").get_to(way.replans_beside);
  const nlohmann::json& off_middle_m = object.at("off_middle_m");
  if (!off_middle_m.is_null()) way.off_middle_m = off_middle_m.get<double>();
}

// 16 digits of base 16.
bool FromText(const nlohmann::json& text, uint64_t& hash) {
  const auto digits = text.get<std::string>();
  const auto parsed = std::from_chars(digits.data(), digits.data() + digits.size(), hash, 16);
  return digits.size() == 16 && parsed.ptr == digits.data() + digits.size();
}

void Fill(const nlohmann::json& object, RunResult& result) {
  object.at("world").get_to(result.world);
  object.at("planner").get_to(result.planner);
  object.at("tracker").get_to(result.tracker);
  object.at("vehicle").get_to(result.vehicle);
  object.at("labels").get_to(result.labels);
  object.at("max_speed_set_mps").get_to(result.max_speed_set_mps);
  object.at("seed").get_to(result.seed);
  object.at("success").get_to(result.success);
  object.at("reason").get_to(result.reason);
  if (object.contains("reasons")) object.at("reasons").get_to(result.reasons);
  object.at("time_s").get_to(result.time_s);
  object.at("driven_m").get_to(result.driven_m);
  object.at("max_speed_mps").get_to(result.max_speed_mps);
  object.at("clearance_m").get_to(result.clearance_m);
  object.at("person_clearance_m").get_to(result.person_clearance_m);
  object.at("jerk_rms_mps3").get_to(result.jerk_rms_mps3);
  object.at("replans").get_to(result.replans);
  object.at("stops").get_to(result.stops);
  object.at("odometry_off_m").get_to(result.odometry_off_m);
  object.at("replayed").get_to(result.replayed);
  Fill(object.at("way"), result.way);
}

}  // namespace

const char* Name(Outcome outcome) {
  return kNames[static_cast<size_t>(outcome)];
}

nlohmann::ordered_json ToJson(const RunResult& result) {
  return {{"world", result.world},
          {"planner", result.planner},
          {"tracker", result.tracker},
          {"vehicle", result.vehicle},
          {"labels", result.labels},
          {"max_speed_set_mps", result.max_speed_set_mps},
          {"settings", HashText(result.settings)},
          {"seed", result.seed},
          {"outcome", Name(result.outcome)},
          {"success", result.success},
          {"reason", result.reason},
          {"reasons", result.reasons},
          {"time_s", result.time_s},
          {"driven_m", result.driven_m},
          {"max_speed_mps", result.max_speed_mps},
          {"clearance_m", result.clearance_m},
          {"person_clearance_m", result.person_clearance_m},
          {"jerk_rms_mps3", result.jerk_rms_mps3},
          {"replans", result.replans},
          {"stops", result.stops},
          {"cross_track_m", ToJson(result.cross_track_m)},
          {"odometry_off_m", result.odometry_off_m},
          {"vertical_mps2", ToJson(result.vertical_mps2)},
          {"reaction_s", ToJson(result.reaction_s)},
          {"reaction_fast_s", ToJson(result.reaction_fast_s)},
          {"reaction_m", ToJson(result.reaction_m)},
          {"way", ToJson(result.way)},
          {"decision_hash", HashText(result.decision_hash)},
          {"replayed", result.replayed}};
}

ReadOutcome FromJson(const nlohmann::json& object, RunResult& result) {
  result = RunResult();
  try {
    Fill(object, result);
    const auto outcome = object.at("outcome").get<std::string>();
    const auto* const found = std::find(std::begin(kNames), std::end(kNames), outcome);
    if (found == std::end(kNames)) return Bad("there is no outcome '" + outcome + "'");
    result.outcome = static_cast<Outcome>(found - std::begin(kNames));
    if (!FromJson(object.at("cross_track_m"), result.cross_track_m) ||
        (object.contains("vertical_mps2") &&
         !FromJson(object.at("vertical_mps2"), result.vertical_mps2)) ||
        !FromJson(object.at("reaction_s"), result.reaction_s) ||
        !FromJson(object.at("reaction_fast_s"), result.reaction_fast_s) ||
        !FromJson(object.at("reaction_m"), result.reaction_m)) {
      return Bad("a histogram has different bins");
    }
    if (!FromText(object.at("decision_hash"), result.decision_hash)) {
      return Bad("decision_hash is not 16 digits");
    }
    if (!FromText(object.at("settings"), result.settings)) {
      return Bad("settings is not 16 digits");
    }
  } catch (const nlohmann::json::exception& error) {
    return Bad(error.what());
  }
  return {};
}

bool IsSameRow(const RunResult& one, const RunResult& other) {
  return RowKey(one) == RowKey(other);
}

namespace {

// Adds it unless it is already present.
ReadOutcome AddRun(RunResult&& result, std::vector<RunResult>& results) {
  const std::string seed = "seed " + std::to_string(result.seed);
  for (const RunResult& other : results) {
    if (!IsSameRow(other, result)) continue;
    if (other.settings != result.settings) {
      return Bad(seed + " was run with other settings than seed " + std::to_string(other.seed) +
                 " (" + HashText(result.settings) + ", not " + HashText(other.settings) + ")");
    }
    if (other.seed != result.seed) continue;
    if (other.decision_hash == result.decision_hash) return {};
    return Bad(seed + " appears twice, with different decisions");
  }
  results.push_back(std::move(result));
  return {};
}

}  // namespace

ReadOutcome ReadRuns(const std::string& path, std::vector<RunResult>& results) {
  std::ifstream file(path);
  if (!file) return Bad(path + ": cannot be read");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string where = path + ":" + std::to_string(number) + ": ";
    const bool is_cut = file.eof();
    const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
    if (object.is_discarded() && is_cut) return {};
    if (object.is_discarded()) return Bad(where + "is not JSON");
    RunResult result;
    ReadOutcome outcome = FromJson(object, result);
    if (outcome.ok()) outcome = AddRun(std::move(result), results);
    if (!outcome.ok()) return Bad(where + outcome.message);
  }
  return {};
}

ReadOutcome WriteRuns(const std::string& path, std::vector<RunResult> results) {
  std::sort(results.begin(), results.end(),
            [](const RunResult& a, const RunResult& b) { return Key(a) < Key(b); });
  std::ofstream file(path);
  for (const RunResult& result : results) file << ToJson(result).dump() << '\n';
  if (!file.flush()) return Bad(path + ": cannot be written");
  return {};
}

}  // namespace hardpack::experiment
