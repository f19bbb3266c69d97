// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "core/areas/area.h"
#include "port_linux/files/read_outcome.h"

// Areas (core/areas) as people write them: in a file of their own, or as tables of the
// configuration. docs/areas.md.

namespace hardpack {

// An odom corner is written in metres and kept in millimetres; the furthest one [m].
inline constexpr double kAreaUnitsPerMeter = 1.0e3;
inline constexpr double kMaxAreaPosition_m =
    static_cast<double>(kMaxAreaPosition_mm) / kAreaUnitsPerMeter;

// By AreaKind and AreaFrame.
inline constexpr std::array<const char*, kAreaKinds> kAreaKindNames = {"keep_out", "fence",
                                                                       "speed_zone"};
inline constexpr std::array<const char*, kAreaFrames> kAreaFrameNames = {"odom", "latlon"};

// In plain words what CheckAreas refuses: "its border touches or crosses itself".
std::string WordsOfRefusedArea(Status status);

// An area file. A line with the kind, the coordinates and, for a speed zone, the speed in m/s
// begins an area; each line after it is a corner.
//
//   # Text after a # is a comment.
//   keep_out odom              or: fence, speed_zone; latlon
//   12.0 -3.5                  x y in metres; latitude and longitude in degrees
//   ...
//   speed_zone latlon 1.5
//   30.617512345 -96.338912345
//   ...
//
// At least one area, at most kMaxAreas. Metres are rounded to a millimetre; degrees have at most
// nine decimals and are read exactly. Every area and all together are as CheckAreas requires. On
// failure a line "FILE:LINE: ...", and `areas` is unchanged. kInvalidArgument, kCapacityExceeded
// and the statuses of CheckAreas; kOversized. The same from a text; `name` is its name in messages.
inline constexpr size_t kMaxAreaFileBytes = 262144;
ReadOutcome ReadAreas(const std::string& path, AreaList& areas);
ReadOutcome ParseAreas(const std::string& text, const std::string& name, AreaList& areas);

// Areas as the tables [[area]] of a configuration (configuration_areas.h), which read back as the
// same areas; empty without areas.
std::string AreasToToml(const AreaList& areas);

}  // namespace hardpack
