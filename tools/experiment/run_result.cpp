// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run_result.h"

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

auto Key(const RunResult& one) {
  return std::tie(one.world, one.planner, one.tracker, one.vehicle, one.seed);
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

void Fill(const nlohmann::json& object, RunResult& result) {
  object.at("world").get_to(result.world);
  object.at("planner").get_to(result.planner);
  object.at("tracker").get_to(result.tracker);
  object.at("vehicle").get_to(result.vehicle);
  object.at("seed").get_to(result.seed);
  object.at("success").get_to(result.success);
  object.at("reason").get_to(result.reason);
  object.at("time_s").get_to(result.time_s);
  object.at("driven_m").get_to(result.driven_m);
  object.at("max_speed_mps").get_to(result.max_speed_mps);
  object.at("clearance_m").get_to(result.clearance_m);
  object.at("person_clearance_m").get_to(result.person_clearance_m);
  object.at("jerk_rms_mps3").get_to(result.jerk_rms_mps3);
  object.at("replans").get_to(result.replans);
  object.at("stops").get_to(result.stops);
  object.at("replayed").get_to(result.replayed);
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
          {"seed", result.seed},
          {"outcome", Name(result.outcome)},
          {"success", result.success},
          {"reason", result.reason},
          {"time_s", result.time_s},
          {"driven_m", result.driven_m},
          {"max_speed_mps", result.max_speed_mps},
          {"clearance_m", result.clearance_m},
          {"person_clearance_m", result.person_clearance_m},
          {"jerk_rms_mps3", result.jerk_rms_mps3},
          {"replans", result.replans},
          {"stops", result.stops},
          {"cross_track_m", ToJson(result.cross_track_m)},
          {"reaction_s", ToJson(result.reaction_s)},
          {"reaction_m", ToJson(result.reaction_m)},
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
        !FromJson(object.at("reaction_s"), result.reaction_s) ||
        !FromJson(object.at("reaction_m"), result.reaction_m)) {
      return Bad("a histogram has other bins");
    }
    const auto hash = object.at("decision_hash").get<std::string>();
    const auto parsed =
        std::from_chars(hash.data(), hash.data() + hash.size(), result.decision_hash, 16);
    if (hash.size() != 16 || parsed.ptr != hash.data() + hash.size()) {
      return Bad("decision_hash is not 16 digits");
    }
  } catch (const nlohmann::json::exception& error) {
    return Bad(error.what());
  }
  return {};
}

ReadOutcome ReadRuns(const std::string& path, std::vector<RunResult>& results) {
  std::ifstream file(path);
  if (!file) return Bad(path + ": cannot be read");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string where = path + ":" + std::to_string(number) + ": ";
    const nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
    if (object.is_discarded()) return Bad(where + "is not JSON");
    RunResult result;
    const ReadOutcome outcome = FromJson(object, result);
    if (!outcome.ok()) return Bad(where + outcome.message);
    const auto same = std::find_if(results.begin(), results.end(), [&](const RunResult& other) {
      return Key(other) == Key(result);
    });
    if (same == results.end()) {
      results.push_back(std::move(result));
    } else if (same->decision_hash != result.decision_hash) {
      return Bad(where + "seed " + std::to_string(result.seed) +
                 " is there twice, with different decisions");
    }
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
