// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_timing.h"

#include <algorithm>
#include <ctime>
#include <numeric>

#include "tools/allocation_counter/allocation_counter.h"

namespace hardpack::command {
namespace {

double ThreadTime_us() {
  std::timespec time = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1.0e6 + static_cast<double>(time.tv_nsec) * 1.0e-3;
}

template <typename Run>
double TimeOf(Run&& run, int times) {
  const double before_us = ThreadTime_us();
  for (int i = 0; i < times; ++i) run();
  return (ThreadTime_us() - before_us) / times;
}

// Of at least one time; sorts them.
double AtShare(std::vector<double>& times_us, double share) {
  std::sort(times_us.begin(), times_us.end());
  return times_us[static_cast<size_t>(share * static_cast<double>(times_us.size() - 1) + 0.5)];
}

// The times of a stage by its inputs, and of each peer. The memory is allocated beforehand.
class Samples {
 public:
  explicit Samples(const Measurement& what)
      : of_input_(static_cast<size_t>(what.inputs)), of_peer_(what.peers.size()) {
    for (auto& times : of_input_) times.reserve(kMostRounds * kRunsARound);
  }

  void AddRun(double time_us) { of_input_[runs_++ % of_input_.size()].push_back(time_us); }
  void AddPeerRun(size_t peer, double time_us) { of_peer_[peer].push_back(time_us); }

  std::vector<double> Fill(const Measurement& what, BenchRow& row) {
    std::vector<double> all;
    std::vector<double> medians;
    for (auto& times : of_input_) {
      all.insert(all.end(), times.begin(), times.end());
      medians.push_back(AtShare(times, 0.5));
    }
    row.repetitions = static_cast<int>(all.size());
    row.median_us = AtShare(all, 0.5);
    row.p99_us = AtShare(all, 0.99);
    row.worst_us = all.back();
    const double sum_us = std::accumulate(medians.begin(), medians.end(), 0.0);
    for (size_t peer = 0; peer < of_peer_.size(); ++peer) {
      const double ratio = PeerSum_us(of_peer_[peer]) / sum_us;
      const int repetitions = static_cast<int>(of_peer_[peer].size());
      row.peers.push_back({what.peers[peer]->name, AtShare(of_peer_[peer], 0.5), repetitions,
                           what.peers[peer]->path_cost, ratio});
    }
    return medians;
  }

 private:
  // The medians of the inputs, which took turns, added up. There are at least as many times.
  double PeerSum_us(const std::vector<double>& times_us) const {
    double sum_us = 0.0;
    for (size_t input = 0; input < of_input_.size(); ++input) {
      std::vector<double> of_this;
      for (size_t i = input; i < times_us.size(); i += of_input_.size()) {
        of_this.push_back(times_us[i]);
      }
      sum_us += AtShare(of_this, 0.5);
    }
    return sum_us;
  }

  size_t runs_ = 0;
  std::vector<std::vector<double>> of_input_;
  std::vector<std::vector<double>> of_peer_;
};

}  // namespace

std::vector<double> MeasureRow(const Measurement& what, BenchRow& row) {
  Samples samples(what);
  for (int input = 0; input < what.inputs; ++input) {
    what.prepare();
    what.run();
    for (PeerRun* peer : what.peers) peer->run();
  }
  const int least_rounds = std::max(kLeastRounds, what.inputs);
  double spent_us = 0.0;
  for (int round = 0; round < kMostRounds; ++round) {
    if (round >= least_rounds && spent_us >= kBudget_us) break;
    for (int i = 0; i < kRunsARound; ++i) {
      what.prepare();
      const int64_t allocations_before = AllocationCount();
      const double time_us = TimeOf(what.run, what.runs_at_once);
      row.allocations += AllocationCount() - allocations_before;
      samples.AddRun(time_us);
      spent_us += time_us * what.runs_at_once;
    }
    for (size_t peer = 0; peer < what.peers.size(); ++peer) {
      const double time_us = TimeOf(what.peers[peer]->run, 1);
      samples.AddPeerRun(peer, time_us);
      spent_us += time_us;
    }
  }
  return samples.Fill(what, row);
}

}  // namespace hardpack::command
