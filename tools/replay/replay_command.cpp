// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_command.h"

#include <iostream>
#include <memory>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/replay/replay.h"
#include "tools/replay/replay_picture.h"
#include "tools/replay/report_json.h"

namespace hardpack::command {
namespace {

struct ReplayOptions {
  replay::Request request;
  std::string out;
  bool json = false;
};

std::string Summary(const replay::Report& report) {
  std::string text = std::to_string(report.ticks) + " ticks, decision hash " +
                     replay::HashText(report.decision_hash);
  if (!report.is_flight_log) text += " (a plain capture: nothing to compare)";
  if (report.from_image) text += ", from the file's state image";
  if (report.is_flight_log && !report.ended) text += ", the log does not say that the run ended";
  return text;
}

void RunReplay(const ReplayOptions& options) {
  bool are_logs = false;
  Require(replay::AreFlightLogs(options.request.files, are_logs));
  const auto vehicle = std::make_unique<ChosenVehicle>();
  const auto configuration = std::make_unique<Configuration>();
  replay::Report report;
  Require(are_logs ? replay::ReplayLog(options.request, *vehicle, *configuration, report)
                   : replay::ReplayCapture(options.request, *vehicle, *configuration, report));
  const nlohmann::json object = replay::ReportToJson(report, vehicle->get()->pilot());
  if (!options.out.empty()) {
    MakeOutputFolder(options.out);
    WriteText(options.out + "/replay.json", object.dump(1) + "\n");
    Require(replay::DrawReplay(report, vehicle->get()->pilot(), configuration->planner.vehicle)
                .WritePng(options.out + "/replay.png"));
  }
  if (options.json) std::cout << object.dump() << "\n";
  if (report.difference.found) {
    throw CommandFailure(kWorkFailed, "tick " + std::to_string(report.difference.index) +
                                          " decides differently: " + report.difference.what);
  }
  if (!report.not_comparable.empty()) throw CommandFailure(kWorkFailed, report.not_comparable);
  if (!options.json) std::cout << "ok: " << Summary(report) << "\n";
}

}  // namespace

void AddReplayCommand(CLI::App& app) {
  CLI::App* replay = app.add_subcommand(
      "replay",
      "Run a recorded drive through the same code again: a flight log, whose decisions must be\n"
      "reproduced bit for bit, or a plain capture of `tcpdump -i any`. Prints the decision hash.");
  const auto options = std::make_shared<ReplayOptions>();
  replay->add_option("files", options->request.files, "The log files of one run, or captures")
      ->required();
  replay->add_option("--config", options->request.configuration_path,
                     "Configuration (TOML) instead of the log's; a plain capture needs one");
  replay->add_option("--metadata", options->request.metadata_path,
                     "The lidar's metadata (JSON) instead of the log's or the configuration's");
  replay->add_flag("--from-image", options->request.from_image,
                   "Start every file from its state image, if it has one");
  replay->add_option("--out", options->out,
                     "Folder for replay.json and replay.png; created if missing");
  replay->add_flag("--json", options->json, "Print replay.json as one line on standard output");
  replay->callback([options] { RunReplay(*options); });
}

}  // namespace hardpack::command
