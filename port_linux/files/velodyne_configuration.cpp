// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "port_linux/files/configuration.h"

namespace hardpack {

Status ToConfig(const VelodyneConfiguration& configuration, velodyne::Config& config) {
  const auto choose = [](const std::string& name, const auto& known, auto& chosen) {
    for (const auto& [text, value] : known) {
      if (name != text) continue;
      chosen = value;
      return true;
    }
    return false;
  };
  using Models = std::array<std::pair<std::string_view, velodyne::Model>, 2>;
  using Modes = std::array<std::pair<std::string_view, velodyne::ReturnMode>, 3>;
  constexpr Models kModels = {
      {{"vlp16", velodyne::Model::kVlp16}, {"vlp32c", velodyne::Model::kVlp32c}}};
  constexpr Modes kModes = {{{"strongest", velodyne::ReturnMode::kStrongest},
                             {"last", velodyne::ReturnMode::kLast},
                             {"dual", velodyne::ReturnMode::kDual}}};
  velodyne::Config made;
  made.rpm = configuration.rpm;
  const bool is_known = choose(configuration.model, kModels, made.model) &&
                        choose(configuration.returns, kModes, made.return_mode);
  if (is_known) config = made;
  return is_known ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace hardpack
