// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/mission_batch.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

namespace hardpack::mission {
namespace {

class Batch {
 public:
  explicit Batch(const MissionBatch& batch) : batch_(batch) {}

  ReadOutcome Run() {
    std::vector<std::thread> threads;
    const auto jobs = static_cast<size_t>(std::max(batch_.jobs, 1));
    for (size_t i = 0; i < std::min(jobs, batch_.missions); ++i) {
      threads.emplace_back([this, i] { Work(i); });
    }
    for (std::thread& thread : threads) thread.join();
    return outcome_;
  }

 private:
  // The next mission's index; false: there is none.
  bool Take(size_t& index) {
    const std::lock_guard lock(mutex_);
    if (!outcome_.ok() || next_ >= batch_.missions) return false;
    index = next_++;
    return true;
  }

  void Work(size_t worker) {
    size_t index = 0;
    while (Take(index)) {
      ReadOutcome outcome;
      try {
        outcome = RunOne(worker, index);
      } catch (const std::exception& error) {
        outcome = {Status::kInvalidArgument, error.what()};
      }
      const std::lock_guard lock(mutex_);
      if (!outcome.ok() && outcome_.ok()) outcome_ = outcome;
    }
  }

  ReadOutcome RunOne(size_t worker, size_t index) {
    MissionSettings settings;
    ReadOutcome outcome = batch_.prepare(index, settings);
    if (!outcome.ok()) return outcome;
    if (!batch_.log_folder.empty()) {
      settings.log = batch_.log_folder + "/worker_" + std::to_string(worker) + ".pcap";
    }
    experiment::RunResult result;
    MissionTrace trace;
    outcome = RunMission(settings, result, batch_.with_traces ? &trace : nullptr);
    if (outcome.ok() && !settings.log.empty()) outcome = Replay(settings, result);
    if (!outcome.ok()) return outcome;
    const std::lock_guard lock(mutex_);
    if (!outcome_.ok()) return {};
    return batch_.finished(index, settings, result, trace);
  }

  ReadOutcome Replay(const MissionSettings& settings, experiment::RunResult& result) const {
    std::string difference;
    ReadOutcome outcome = ReplaysTheSame(settings.log, result.decision_hash, difference);
    if (!outcome.ok()) return outcome;
    result.replayed = difference.empty();
    std::error_code error;
    if (result.replayed) {
      std::filesystem::remove(settings.log, error);
    } else {
      std::filesystem::rename(
          settings.log,
          batch_.log_folder + "/" + result.world + "_" + std::to_string(result.seed) + ".pcap",
          error);
    }
    if (error) return {Status::kInvalidArgument, settings.log + ": " + error.message()};
    return {};
  }

  const MissionBatch& batch_;
  std::mutex mutex_;
  size_t next_ = 0;
  ReadOutcome outcome_;
};

}  // namespace

ReadOutcome RunBatch(const MissionBatch& batch) {
  return Batch(batch).Run();
}

}  // namespace hardpack::mission
