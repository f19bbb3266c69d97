// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/experiment_command.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <thread>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/sim/command/mission_options.h"
#include "tools/sim/command/world_picture.h"
#include "tools/sim/experiment/progress.h"
#include "tools/sim/experiment/shard.h"
#include "tools/sim/experiment/summary.h"
#include "tools/sim/mission/mission_batch.h"

namespace hardpack::command {
namespace {

using experiment::RunResult;
using mission::MissionSettings;
using mission::MissionTrace;

struct ExperimentOptions {
  std::string name;
  std::string out;
  std::string shard = "1/1";
  std::string pictures = "first";
  int64_t runs = 5;
  uint64_t first_seed = 1;
  int jobs = 0;  // 0: as many as there are cores
  bool resume = false;
  bool replay = true;
  bool json = false;
  double required_share = 0.0;
  MissionOptions mission;
};

struct MergeOptions {
  std::vector<std::string> folders;
  std::string out;
  bool json = false;
};

// One run to carry out.
struct Task {
  std::string world;
  uint64_t seed = 0;
  bool is_first = false;  // of its world, in this shard
};

constexpr const char* kRuns = "/runs.jsonl";

std::vector<Task> TasksOf(const ExperimentOptions& options) {
  experiment::Shard shard;
  Require(experiment::ParseShard(options.shard, shard));
  std::vector<std::string> worlds = {options.name};
  if (options.name == "all") worlds = world::WorldNames();
  std::vector<Task> tasks;
  for (const std::string& name : worlds) {
    // An unknown world is reported before the first run.
    static_cast<void>(ScenarioOf(name, options.first_seed, options.mission.scenario));
    bool is_first = true;
    for (int64_t i = 0; i < options.runs; ++i) {
      const uint64_t seed = options.first_seed + static_cast<uint64_t>(i);
      if (!shard.Has(seed)) continue;
      tasks.push_back({name, seed, is_first});
      is_first = false;
    }
  }
  return tasks;
}

// Writes the table and the runs, in an order independent of that in which they ended.
void WriteTable(const std::string& out, const std::vector<RunResult>& results, bool json) {
  Require(experiment::WriteRuns(out + kRuns, results));
  const std::vector<experiment::Row> rows = experiment::Summarise(results);
  nlohmann::ordered_json table;
  table["rows"] = nlohmann::ordered_json::array();
  for (const experiment::Row& row : rows) table["rows"].push_back(ToJson(row));
  WriteText(out + "/table.json", table.dump(1) + "\n");
  const std::string markdown = experiment::ToMarkdown(rows);
  WriteText(out + "/table.md", markdown);
  std::cout << (json ? table.dump() + "\n" : markdown);
}

// The runs of an experiment: those still to do, and their results.
class Experiment {
 public:
  explicit Experiment(const ExperimentOptions& options);
  void Run();
  const std::vector<RunResult>& results() const { return results_; }

 private:
  void TakeUp();
  ReadOutcome Prepare(size_t index, MissionSettings& settings) const;
  ReadOutcome Note(size_t index, const MissionSettings& settings, const RunResult& result,
                   const MissionTrace& trace);
  bool WantsPicture(const Task& task, const RunResult& result) const;

  const ExperimentOptions& options_;
  MissionSettings settings_;
  std::vector<Task> tasks_;
  std::vector<RunResult> results_;
  std::ofstream runs_;
  int64_t failed_ = 0;
  std::unique_ptr<experiment::Progress> progress_;
};

Experiment::Experiment(const ExperimentOptions& options)
    : options_(options), settings_(SettingsOf(options.mission)), tasks_(TasksOf(options)) {
  MakeOutputFolder(options.out);
  if (options.pictures != "none") MakeOutputFolder(options.out + "/pictures");
  TakeUp();
  // The earlier runs, without a truncated line; then one line per run is appended.
  Require(experiment::WriteRuns(options.out + kRuns, results_));
  runs_.open(options.out + kRuns, std::ios::app);
}

// Skips the runs of earlier invocations.
void Experiment::TakeUp() {
  const std::string path = options_.out + kRuns;
  if (!std::filesystem::exists(path)) return;
  if (!options_.resume) {
    throw CommandFailure(kBadInput, path + ": already exists; --resume continues it");
  }
  Require(experiment::ReadRuns(path, results_));
  const uint64_t digest = mission::DigestOf(settings_);
  for (const RunResult& result : results_) {
    RunResult wanted = result;
    wanted.planner = settings_.planner;
    wanted.tracker = settings_.tracker;
    wanted.vehicle = settings_.vehicle_name;
    wanted.labels = mission::LabelsName(settings_.labels);
    wanted.max_speed_set_mps = double{settings_.configuration.planner.speed.max_speed_mps};
    if (!experiment::IsSameRow(result, wanted) || result.settings != digest) {
      throw CommandFailure(kBadInput, path + ": was made with other options");
    }
    std::erase_if(tasks_, [&](const Task& task) {
      return task.world == result.world && task.seed == result.seed;
    });
  }
}

ReadOutcome Experiment::Prepare(size_t index, MissionSettings& settings) const {
  const Task& task = tasks_[index];
  settings = settings_;
  settings.seed = task.seed;
  settings.scenario = ScenarioOf(task.world, task.seed, options_.mission.scenario);
  SetWaypoints(options_.mission, settings);
  return {};
}

bool Experiment::WantsPicture(const Task& task, const RunResult& result) const {
  if (options_.pictures == "all") return true;
  if (options_.pictures == "failed") return !result.success;
  return options_.pictures == "first" && task.is_first;
}

ReadOutcome Experiment::Note(size_t index, const MissionSettings& settings, const RunResult& result,
                             const MissionTrace& trace) {
  runs_ << ToJson(result).dump() + "\n" << std::flush;
  if (!runs_) {
    return {Status::kInvalidArgument, options_.out + kRuns + ": cannot be written"};
  }
  results_.push_back(result);
  failed_ += result.success ? 0 : 1;
  progress_->Show(static_cast<int64_t>(index) + 1, failed_);
  if (!WantsPicture(tasks_[index], result)) return {};
  const std::string name = std::filesystem::path(result.world).stem().string();
  return DrawWorld(settings.scenario, settings.seed, {}, DrivenOf(settings, trace))
      .WritePng(options_.out + "/pictures/" + name + "_" + std::to_string(settings.seed) + ".png");
}

void Experiment::Run() {
  progress_ =
      std::make_unique<experiment::Progress>(options_.name, static_cast<int64_t>(tasks_.size()));
  mission::MissionBatch batch;
  batch.missions = tasks_.size();
  batch.jobs =
      options_.jobs > 0 ? options_.jobs : static_cast<int>(std::thread::hardware_concurrency());
  if (options_.replay) batch.log_folder = options_.out;
  batch.with_traces = options_.pictures != "none";
  batch.prepare = [this](size_t index, MissionSettings& settings) {
    return Prepare(index, settings);
  };
  batch.finished = [this](size_t index, const MissionSettings& settings, const RunResult& result,
                          const MissionTrace& trace) {
    return Note(index, settings, result, trace);
  };
  const ReadOutcome outcome = mission::RunBatch(batch);
  progress_.reset();
  Require(outcome);
  runs_.close();
}

// Fails, for exit code 1, if a log does not replay or too few runs succeeded.
void RequireResults(const ExperimentOptions& options, const std::vector<RunResult>& results) {
  for (const RunResult& result : results) {
    if (options.replay && !result.replayed) {
      throw CommandFailure(kWorkFailed, result.world + ", seed " + std::to_string(result.seed) +
                                            ": its log does not replay to the same decisions");
    }
  }
  for (const experiment::Row& row : experiment::Summarise(results)) {
    if (row.success_share() >= options.required_share) continue;
    throw CommandFailure(kWorkFailed, row.world + ": " + std::to_string(row.successes) + " of " +
                                          std::to_string(row.runs) +
                                          " runs succeeded, fewer than --require-success");
  }
}

void RunExperiment(const ExperimentOptions& options) {
  if (options.name.empty())
    throw CommandFailure(kBadInput, "NAME is required: a world (see --help)");
  if (options.out.empty()) throw CommandFailure(kBadInput, "--out is required");
  if (options.runs < 1 || options.runs > 1000000) {
    throw CommandFailure(kBadInput, "--runs: 1 to 1000000");
  }
  if (options.jobs < 0 || options.jobs > 1024) throw CommandFailure(kBadInput, "--jobs: 1 to 1024");
  Experiment experiment(options);
  experiment.Run();
  WriteTable(options.out, experiment.results(), options.json);
  RequireResults(options, experiment.results());
}

void Merge(const MergeOptions& options) {
  std::vector<RunResult> results;
  for (const std::string& folder : options.folders) {
    Require(experiment::ReadRuns(folder + kRuns, results));
  }
  MakeOutputFolder(options.out);
  WriteTable(options.out, results, options.json);
}

void AddMergeCommand(CLI::App& experiment) {
  CLI::App* merge = experiment.add_subcommand(
      "merge", "Merge the runs of several folders: write runs.jsonl, table.json, table.md.");
  const auto options = std::make_shared<MergeOptions>();
  merge->add_option("DIR", options->folders, "Folders of experiments")->required();
  merge->add_option("--out", options->out, "Folder to write to; created if missing")->required();
  merge->add_flag("--json", options->json, "Print table.json as one line on standard output");
  merge->callback([options] { Merge(*options); });
}

}  // namespace

void AddExperimentCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "experiment",
      "Drive missions in a simulated world with many seeds. Writes runs.jsonl with one line per\n"
      "run as it ends, table.json, table.md and pictures. Worlds: see `hardpack world`, or `all`.\n"
      "A failed mission is a result. Exit code 1 if --require-success is not met or a run's log\n"
      "does not replay. `hardpack sim` with the same options repeats one of the runs.\n"
      "On several machines, or in several processes:\n"
      "  parallel hardpack experiment gap --runs 100 --shard {}/8 --out out/{} ::: {1..8}\n"
      "  hardpack experiment merge out/* --out merged");
  const auto options = std::make_shared<ExperimentOptions>();
  command->add_option("NAME", options->name, "World, map.yaml with --start and --goal, or all");
  command->add_option("--runs", options->runs,
                      "Runs of each world, with consecutive seeds (default 5)");
  command->add_option("--first-seed", options->first_seed, "Seed of the first run (default 1)");
  command->add_option("--out", options->out, "Folder to write to; created if missing");
  command->add_flag("--resume", options->resume, "Continue an experiment in that folder");
  command->add_option("--jobs", options->jobs,
                      "Runs in parallel (default: number of cores); does not affect the results");
  command->add_option("--shard", options->shard, "K/N: only the K-th of N parts of the seeds");
  command
      ->add_option("--require-success", options->required_share,
                   "Exit code 1 if a smaller share of a world's runs succeeds (0 to 1)")
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("!--no-replay", options->replay,
                    "Do not write each run's log, replay it and compare");
  command
      ->add_option("--pictures", options->pictures,
                   "Runs to draw: all, failed, first (default) or none")
      ->check(CLI::IsMember({"all", "failed", "first", "none"}));
  command->add_flag("--json", options->json, "Print table.json as one line on standard output");
  AddMissionOptions(*command, options->mission);
  AddMergeCommand(*command);
  command->callback([options, command] {
    if (command->get_subcommands().empty()) RunExperiment(*options);
  });
}

}  // namespace hardpack::command
