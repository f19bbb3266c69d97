// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/fit_command.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/fit/fit_picture.h"
#include "tools/fit/fit_report.h"

namespace hardpack::command {
namespace {

struct FitOptions {
  std::string drive;
  std::string out;
  uint64_t seed = 1;
  double held_out = 0.3;
  bool json = false;
};

void WriteFiles(const FitOptions& options, const fit::FitReport& report,
                const std::vector<fit::DriveSegment>& segments) {
  MakeOutputFolder(options.out);
  WriteText(options.out + "/fit.json", fit::FitReportToJson(report).dump(2) + "\n");
  WriteText(options.out + "/fit.md", fit::FitReportToMarkdown(report));
  WriteText(options.out + "/warthog_recorded.toml",
            fit::FittedVehicleToml(report, fit::kRecordedWheelLimit_radps,
                                   "The Warthog as it was recorded: its wheels stop at 13.4 rad/s, "
                                   "3.8 m/s over ground."));
  WriteText(
      options.out + "/warthog_paper.toml",
      fit::FittedVehicleToml(report, fit::kPaperWheelLimit_radps,
                             "The Warthog of the paper's experiments: as it was recorded, but "
                             "for its wheels' limit,\n17.5 rad/s, which gives the paper's "
                             "5 m/s over ground."));
  const fit::Split split = fit::SplitByRun(segments, options.held_out, options.seed);
  const std::vector<fit::DriveSegment> shown = fit::FromWorstToBest(split.held_out, report.fit);
  Require(fit::DrawFit(shown, report.fit).WritePng(options.out + "/fit.png"));
}

void RunFit(const FitOptions& options) {
  constexpr size_t kLeastSegments = 20;
  std::vector<fit::DriveSegment> segments;
  Require(fit::ReadDriveRecord(options.drive, segments));
  if (segments.size() < kLeastSegments) {
    throw CommandFailure(
        kBadInput, options.drive + ": fewer than " + std::to_string(kLeastSegments) + " segments");
  }
  const std::string name = std::filesystem::path(options.drive).filename().string();
  const fit::FitReport report =
      fit::MakeFitReport(segments, name, options.held_out, options.seed, {});
  if (report.segments_fitted == 0 || report.segments_held_out == 0) {
    throw CommandFailure(kBadInput, options.drive + ": too few runs to hold some out");
  }
  if (!options.out.empty()) WriteFiles(options, report, segments);
  std::cout << (options.json ? fit::FitReportToJson(report).dump() + "\n"
                             : fit::FitReportToMarkdown(report));
}

}  // namespace

void AddFitCommand(CLI::App& app) {
  CLI::App* fit = app.add_subcommand(
      "fit",
      "Fit the simulator's vehicle to a recorded drive, and report how well it predicts held-out\n"
      "data, compared with an ideal differential drive and the published first-order powertrain.\n"
      "With --out: fit.json, fit.md, fit.png (recorded and predicted) and the two vehicles of\n"
      "config/vehicles, warthog_recorded.toml and warthog_paper.toml.");
  const auto options = std::make_shared<FitOptions>();
  fit->add_option("--drive", options->drive,
                  "CSV of commands, wheel speeds and poses (format: tools/fit/drive_record.h)")
      ->required();
  fit->add_option("--out", options->out, "Folder to write to; created if missing");
  fit->add_option("--seed", options->seed, "Seed for selecting the held-out runs (default 1)");
  fit->add_option("--held-out", options->held_out, "Share of runs held out (default 0.3)")
      ->check(CLI::Range(0.05, 0.95));
  fit->add_flag("--json", options->json, "Print one JSON object on stdout");
  fit->callback([options] { RunFit(*options); });
}

}  // namespace hardpack::command
