// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_report.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "tools/allocation_counter/allocation_counter.h"
#include "tools/bench/bench_text.h"

namespace hardpack::command {
namespace {

using nlohmann::json;

std::string SceneName(const BenchRow& row) {
  return row.dilated ? row.scene : row.scene + " *";
}

// The rest of a row: the peers, and figures that only some stages have.
std::string Remarks(const BenchRow& row) {
  std::string remarks;
  const auto add = [&remarks](const std::string& remark) {
    remarks += (remarks.empty() ? "" : "; ") + remark;
  };
  for (const PeerFigure& peer : row.peers) {
    std::string figures =
        Format("%s %.0f us = x %.1f", peer.name.c_str(), peer.median_us, peer.ratio);
    if (peer.path_cost > 0.0) figures += Format(", F %.1f", peer.path_cost);
    add(figures);
  }
  if (row.path_cost > 0.0) add(Format("F %.1f", row.path_cost));
  if (row.expansions > 0.0) {
    add(Format("%.0f expansions of %.1f ns", row.expansions, row.ns_per_expansion));
  }
  if (row.points > 0) add(Format("%d points", row.points));
  return remarks;
}

void PrintRows(const std::vector<BenchRow>& rows) {
  std::printf("%-9s %-17s %11s %11s %11s %5s %8s %6s  %-16s %s\n", "stage", "scene", "median [us]",
              "p99 [us]", "worst [us]", "runs", "sizeof", "allocs", "ended", "beside it");
  for (const BenchRow& row : rows) {
    std::printf("%-9s %-17s %11.1f %11.1f %11.1f %5d %8zu %6lld  %-16s %s\n", row.stage.c_str(),
                SceneName(row).c_str(), row.median_us, row.p99_us, row.worst_us, row.repetitions,
                row.object_bytes, static_cast<long long>(row.allocations), StatusName(row.status),
                Remarks(row).c_str());
  }
  const bool all_dilated =
      std::all_of(rows.begin(), rows.end(), [](const BenchRow& row) { return row.dilated; });
  if (!all_dilated) {
    std::printf("* too narrow for the vehicle: obstacles have their halo, but are not dilated\n");
  }
}

const char* Verdict(const Acceptance& acceptance) {
  if (!acceptance.met.has_value()) return "-";
  return *acceptance.met ? "yes" : "NO";
}

// Least and largest of a stage's figures over its scenes.
struct Range {
  double least = 0.0;
  double most = 0.0;
  bool empty = true;

  void Take(double value) {
    least = empty ? value : std::min(least, value);
    most = empty ? value : std::max(most, value);
    empty = false;
  }
  std::string Text() const {
    const auto number = [](double value) {
      return value < 100.0 ? Format("%.1f", value) : Format("%.0f", value);
    };
    return number(least) == number(most) ? number(least) : number(least) + " - " + number(most);
  }
};

void PrintStageLine(const std::string& stage, const std::vector<BenchRow>& rows) {
  Range median;
  Range p99;
  Range worst;
  std::map<std::string, Range> ratios;
  int scenes = 0;
  for (const BenchRow& row : rows) {
    if (row.stage != stage) continue;
    ++scenes;
    median.Take(row.median_us);
    p99.Take(row.p99_us);
    worst.Take(row.worst_us);
    for (const PeerFigure& peer : row.peers) ratios[peer.name].Take(peer.ratio);
  }
  std::string beside;
  for (const auto& [name, ratio] : ratios) {
    beside += (beside.empty() ? "" : ", ") + name + " x " + ratio.Text();
  }
  std::printf("| %s | %d | %s | %s | %s | %s |\n", stage.c_str(), scenes, median.Text().c_str(),
              p99.Text().c_str(), worst.Text().c_str(), beside.c_str());
}

json PeersToJson(const BenchRow& row) {
  json peers = json::array();
  for (const PeerFigure& peer : row.peers) {
    peers.push_back({{"name", peer.name},
                     {"median_us", peer.median_us},
                     {"repetitions", peer.repetitions},
                     {"ratio", peer.ratio}});
    if (peer.path_cost > 0.0) peers.back()["path_cost"] = peer.path_cost;
  }
  return peers;
}

json RowToJson(const BenchRow& row) {
  json object = {{"stage", row.stage},
                 {"scene", row.scene},
                 {"dilated", row.dilated},
                 {"status", StatusName(row.status)},
                 {"median_us", row.median_us},
                 {"p99_us", row.p99_us},
                 {"worst_us", row.worst_us},
                 {"repetitions", row.repetitions},
                 {"object_bytes", row.object_bytes},
                 {"allocations", row.allocations},
                 {"peers", PeersToJson(row)}};
  if (row.queries > 0) object["queries"] = row.queries;
  if (row.expansions > 0.0) object["expansions"] = row.expansions;
  if (row.expansions > 0.0) object["ns_per_expansion"] = row.ns_per_expansion;
  if (row.points > 0) object["points"] = row.points;
  if (row.path_cost > 0.0) object["path_cost"] = row.path_cost;
  return object;
}

}  // namespace

void PrintReport(const BenchReport& report) {
  PrintRows(report.rows);
  std::string peers;
  for (const std::string& peer : report.peers) peers += (peers.empty() ? "" : ", ") + peer;
  std::printf("\nother libraries: %s; recordings: %s\n",
              peers.empty() ? "none (tools/check.sh --deps-bench)" : peers.c_str(),
              report.data.empty() ? "none (--data DIR)" : report.data.c_str());
  std::printf("\npromised and measured\n");
  for (const Acceptance& acceptance : report.acceptance) {
    std::printf("%-3s %s: %s\n", Verdict(acceptance), acceptance.promise.c_str(),
                acceptance.measured.c_str());
  }
}

void PrintMarkdown(const BenchReport& report) {
  std::printf("| stage | scenes | median [us] | p99 [us] | worst [us] | others, times as long |\n");
  std::printf("|---|---:|---:|---:|---:|---|\n");
  std::string last;
  for (const BenchRow& row : report.rows) {
    if (row.stage != last) PrintStageLine(row.stage, report.rows);
    last = row.stage;
  }
  std::printf("\n| promised | measured | met |\n|---|---|---|\n");
  for (const Acceptance& acceptance : report.acceptance) {
    std::printf("| %s | %s | %s |\n", acceptance.promise.c_str(), acceptance.measured.c_str(),
                Verdict(acceptance));
  }
}

json ReportToJson(const BenchReport& report) {
  json rows = json::array();
  for (const BenchRow& row : report.rows) rows.push_back(RowToJson(row));
  json acceptance = json::array();
  for (const Acceptance& one : report.acceptance) {
    acceptance.push_back({{"promise", one.promise},
                          {"measured", one.measured},
                          {"met", one.met.has_value() ? json(*one.met) : json(nullptr)}});
  }
  return {{"version", HARDPACK_VERSION},
          {"compiler", __VERSION__},
          {"clock", "processor time of the thread"},
          {"allocations_counted", AllocationsAreCounted()},
          {"data", report.data.empty() ? json(nullptr) : json(report.data)},
          {"peers", report.peers},
          {"rows", rows},
          {"acceptance", acceptance}};
}

}  // namespace hardpack::command
