// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/astar/astar.h"
#include "tools/bench/movingai/movingai.h"

namespace hardpack {
namespace {

// Rounding sqrt(2) to 99 / 70 may let the search choose a path that is up to 0.005 % longer; the
// listed lengths themselves were found in single precision.
constexpr double kTolerance = 1.0e-3;
constexpr double kSqrt2 = 1.4142135623730951;

// The searches of one file and their results.
class Run {
 public:
  explicit Run(const MovingaiMap& map)
      : map_(map), costmap_(std::make_unique<Costmap>()), search_(std::make_unique<AstarSearch>()) {
    FillMovingaiCostmap(map, *costmap_);
  }

  void Solve(const MovingaiProblem& problem);
  MovingaiReport Report();

 private:
  bool Free(Cell cell) const;
  // Length of the path found; its error, if any.
  std::string WalkPath(double& length_cells) const;
  std::string Judge(const MovingaiProblem& problem);

  const MovingaiMap& map_;
  std::unique_ptr<Costmap> costmap_;
  std::unique_ptr<AstarSearch> search_;
  MovingaiReport report_;
  std::vector<int64_t> times_ns_;
};

bool Run::Free(Cell cell) const {
  if (cell.x < 0 || cell.x >= map_.width_cells || cell.y < 0 || cell.y >= map_.height_cells) {
    return false;
  }
  return map_.free[static_cast<size_t>(cell.y * map_.width_cells + cell.x)];
}

std::string Run::WalkPath(double& length_cells) const {
  const AstarResult& result = search_->result();
  Cell cell = result.start;
  length_cells = 0.0;
  for (int steps = 1; steps < result.path_cells; ++steps) {
    const Cell next = search_->Next(cell);
    const bool is_step = std::abs(next.x - cell.x) <= 1 && std::abs(next.y - cell.y) <= 1;
    if (!is_step || !Free(next)) return "the path jumps or enters a blocked cell";
    // For a straight step these two are its own ends.
    if (!Free({next.x, cell.y}) || !Free({cell.x, next.y})) return "the path cuts a corner";
    const bool diagonal = next.x != cell.x && next.y != cell.y;
    length_cells += diagonal ? kSqrt2 : 1.0;
    cell = next;
  }
  return cell == result.end ? "" : "the path does not lead to its end";
}

// Checks a finished search. The error, or empty.
std::string Run::Judge(const MovingaiProblem& problem) {
  const AstarResult& result = search_->result();
  if (result.status != Status::kOk) return StatusName(result.status);
  if (result.start != problem.start || result.end != problem.goal) {
    return "the path does not join start and goal";
  }
  double length_cells = 0.0;
  std::string fault = WalkPath(length_cells);
  if (!fault.empty()) return fault;
  ++report_.solved;
  const double error_cells = std::abs(length_cells - problem.optimum_cells);
  if (problem.optimum_cells > 0.0) {
    report_.largest_relative_error =
        std::max(report_.largest_relative_error, error_cells / problem.optimum_cells);
  }
  if (error_cells <= kTolerance * problem.optimum_cells + problem.rounding_cells) return "";
  char text[80];
  std::snprintf(text, sizeof(text), "length %.5f, listed %.5f", length_cells,
                problem.optimum_cells);
  return text;
}

void Run::Solve(const MovingaiProblem& problem) {
  const auto begin = std::chrono::steady_clock::now();
  const Status begun =
      search_->Begin(*costmap_, AstarParams{}, CellCenter(problem.start), CellCenter(problem.goal));
  if (begun == Status::kOk) {
    static_cast<void>(search_->Step(*costmap_, AstarSearch::kMaxUnits));
  }
  const auto end = std::chrono::steady_clock::now();
  times_ns_.push_back(std::chrono::nanoseconds(end - begin).count());
  ++report_.problems;
  report_.expansions += search_->result().expansions;
  const std::string fault = Judge(problem);
  if (fault.empty()) return;
  ++report_.mismatches;
  if (report_.first_mismatch.empty()) {
    report_.first_mismatch = "line " + std::to_string(problem.line) + ": " + fault;
  }
}

MovingaiReport Run::Report() {
  std::sort(times_ns_.begin(), times_ns_.end());
  for (const int64_t time_ns : times_ns_) report_.total_ns += time_ns;
  report_.median_ns = times_ns_[times_ns_.size() / 2];
  report_.worst_ns = times_ns_.back();
  return report_;
}

bool IsFor(const MovingaiMap& map, const MovingaiProblem& problem) {
  return problem.map_width_cells == map.width_cells && problem.map_height_cells == map.height_cells;
}

}  // namespace

void FillMovingaiCostmap(const MovingaiMap& map, Costmap& costmap) {
  costmap.window.origin = {0, 0};
  std::memset(costmap.cost_q8, 0, sizeof(costmap.cost_q8));
  std::memset(costmap.flags, Costmap::kHard | Costmap::kLethal, sizeof(costmap.flags));
  std::memset(costmap.hard_distance2, 0, sizeof(costmap.hard_distance2));
  std::memset(costmap.hard_depth2, 0, sizeof(costmap.hard_depth2));
  size_t read = 0;
  for (int y = 0; y < map.height_cells; ++y) {
    for (int x = 0; x < map.width_cells; ++x) {
      if (map.free[read++]) costmap.flags[costmap.window.Index({x, y})] = 0;
    }
  }
}

MovingaiOr<MovingaiReport> RunMovingai(const std::string& map_path, const std::string& scen_path,
                                       int stride) {
  const auto map = ReadMovingaiMap(map_path);
  if (const auto* error = std::get_if<std::string>(&map)) return *error;
  const auto scenarios = ReadMovingaiScenarios(scen_path);
  if (const auto* error = std::get_if<std::string>(&scenarios)) return *error;
  const auto& problems = std::get<std::vector<MovingaiProblem>>(scenarios);
  Run run(std::get<MovingaiMap>(map));
  for (size_t i = 0; i < problems.size(); i += static_cast<size_t>(stride)) {
    if (!IsFor(std::get<MovingaiMap>(map), problems[i])) {
      std::string complaint = scen_path;
      complaint += ':';
      complaint += std::to_string(problems[i].line);
      complaint += ": the problem is for a map of another size than ";
      complaint += map_path;
      return complaint;
    }
    run.Solve(problems[i]);
  }
  return run.Report();
}

}  // namespace hardpack
