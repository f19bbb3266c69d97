// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Writes messages as the sensor does (hal/vectornav/vectornav.h has the formats): for the simulator
// and the tests. The onboard program never sends one.

namespace hardpack::vectornav {

// A binary message of the Common group with those of its fields that the sample has: TimeStartup,
// TimeGps, YawPitchRoll, AngularRate, PosLla, VelNed, Accel, InsStatus. All except the acceleration
// give the header FA 01 EB 10 and 84 bytes. The status word is built from the named status bits
// and, for the other bits, from the sample's word. Numbers that are not finite are written as such.
// kInvalidArgument: the sample has none of them; kCapacityExceeded: `message` is too small
// (kMaxBinaryBytes are always enough). Then `message_bytes` is unchanged. Cost: constant.
Status EncodeBinary(const InsSample& sample, std::span<uint8_t> message, size_t& message_bytes);

// A $VNINS line with an exclusive or as its checksum. Missing values are written as zero; without
// GPS time, week 0 and the seconds since the sensor's start are written. Numbers are rounded to the
// decimals that the sensor writes. kInvalidArgument: a number does not fit its field;
// kCapacityExceeded: `line` is too small (kMaxAsciiBytes are always enough). Then `line_bytes` is
// unchanged. Cost: constant.
Status EncodeAscii(const InsSample& sample, std::span<uint8_t> line, size_t& line_bytes);

}  // namespace hardpack::vectornav
