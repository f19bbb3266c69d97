// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "hal/onboard/control/messages.h"
#include "port_linux/files/read_outcome.h"

// Goals in human-readable form.

namespace hardpack::ctl {

// A limit of speed: "1.5" is 15; 0.1 to 25.5 m/s with at most one decimal. kInvalidArgument, with a
// line that begins with `name`.
ReadOutcome ParseLegSpeed(const std::string& name, std::string_view text, uint8_t& speed_dmps);

// A file of waypoints:
//
//   # Text after a # is a comment. The first word says what the numbers are:
//   latlon                      or: odom (x y in metres), relative (metres ahead and to the left)
//   30.617512345 -96.33891
//   30.617600000 -96.33850 stop=5 speed=1.5
//
// Behind the numbers, in any order: `stop` (the vehicle comes to rest there), `stop=SECONDS` (and
// waits, 1 to 255 whole seconds; not at the last one), `speed=M/S` (the limit on the way there).
// At least one waypoint, at most control::kMaxWaypoints. On failure a line "FILE:LINE: ...", and
// `command` must not be used. kInvalidArgument, kCapacityExceeded, kOversized.
inline constexpr size_t kMaxWaypointsFileBytes = 65536;
ReadOutcome ReadWaypoints(const std::string& path, control::OperatorCommand& command);

}  // namespace hardpack::ctl
