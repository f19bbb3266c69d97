// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "core/areas/area.h"
#include "core/base/status.h"
#include "port_linux/files/toml_parser.h"

// The tables [[area]] of a configuration:
//
//   [[area]]
//   kind = "keep_out"      or "fence", "speed_zone"
//   frame = "odom"         or "latlon"
//   speed_mps = 1.5        of a speed zone only
//   corners = [[12.0, -3.5], [16.0, -3.5], [16.0, 2.0]]   x, y in metres; latitude, longitude

namespace hardpack {

// Reads the value of the key `area`. Problems go to `report`, with their lines; areas with one are
// left out.
using ReportProblem = std::function<void(size_t line, Status status, std::string text)>;
void TakeConfiguredAreas(const toml::node& node, AreaList& areas, const ReportProblem& report);

}  // namespace hardpack
