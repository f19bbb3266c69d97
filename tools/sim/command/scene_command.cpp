// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/command/scene_command.h"

#include <iostream>
#include <memory>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/sim/scene/recording.h"

namespace hardpack::command {

void AddSceneCommand(CLI::App& app) {
  struct SceneOptions {
    std::string out;
    uint32_t seed = 1;
  };
  CLI::App* scene = app.add_subcommand(
      "scene",
      "Write a synthetic recording of an OS1-64: scan.pcap, scan.json (metadata), labels.csv.\n"
      "It shows a fence with a gap, trees, bushes, boxes, a hut and a person on undulating\n"
      "ground.");
  const auto options = std::make_shared<SceneOptions>();
  scene->add_option("--out", options->out, "Folder to write to; created if missing")->required();
  scene->add_option("--seed", options->seed, "Seed of the noise (default 1)");
  scene->callback([options] {
    MakeOutputFolder(options->out);
    Require(scene::WriteRecording(scene::Record(scene::DemoWorld(), options->seed), options->out));
    std::cout << "ok: one revolution -> " << options->out << "/scan.pcap, scan.json, labels.csv\n";
  });
}

}  // namespace hardpack::command
