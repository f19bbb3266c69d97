// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/figures_command.h"

#include <iostream>
#include <memory>
#include <string>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/plan/paper_figures.h"

namespace hardpack::command {
namespace {

void WriteFigures(const std::string& folder) {
  MakeOutputFolder(folder);
  Require(SquareFigure().WritePng(folder + "/path_around_square.png"));
  Require(PerturbationFigure().WritePng(folder + "/perturbation.png"));
  Require(CostmapFigure().WritePng(folder + "/costmap_panels.png"));
  std::cout << "ok: path_around_square.png, perturbation.png, costmap_panels.png -> " << folder
            << "\n";
}

}  // namespace

void AddFiguresCommand(CLI::App& app) {
  CLI::App* figures = app.add_subcommand(
      "figures", "Draw the paper's figures that need no simulator, with the library itself.");
  const auto out = std::make_shared<std::string>();
  figures->add_option("--out", *out, "Folder to write to; created if missing")->required();
  figures->callback([out] { WriteFigures(*out); });
}

}  // namespace hardpack::command
