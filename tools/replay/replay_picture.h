// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "tools/picture/canvas.h"
#include "tools/replay/replay.h"

// replay.png: the costmap of the last plan, the driven path, the committed path and the vehicle at
// the end.

namespace hardpack::replay {

picture::Canvas DrawReplay(const Report& report, const Pilot& pilot, const VehicleParams& vehicle);

}  // namespace hardpack::replay
