// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/bench/bench_row.h"

// Measures the time of a stage and of other libraries beside it. The clock is the thread's own
// processor time: on a shared machine, time spent waiting for a processor says nothing about the
// stage.

namespace hardpack::command {

struct PeerRun {
  std::string name;
  std::function<void()> run;  // on the next input in turn
  double path_cost = 0.0;     // of the last run; optimizers only
};

struct Measurement {
  std::function<void()> prepare = [] {};  // not measured, before each run
  std::function<void()> run;
  int runs_at_once = 1;  // more than 1 for short runs; prepared once
  int inputs = 1;        // used in turn from run to run
  std::vector<PeerRun*> peers = {};
};

inline constexpr double kBudget_us = 0.4e6;  // of measured time, for a row with its peers
inline constexpr int kRunsARound = 4;        // of the stage; then each peer once
inline constexpr int kLeastRounds = 5;
inline constexpr int kMostRounds = 500;

// Runs the stage and its peers in turn until the budget is spent, and fills in the row's times,
// repetitions, allocations (of the stage only) and peers. First, each input is run once to warm the
// caches, which is not counted. Returns the median time of each input [us].
std::vector<double> MeasureRow(const Measurement& what, BenchRow& row);

}  // namespace hardpack::command
