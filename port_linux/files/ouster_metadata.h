// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "hal/ouster/ouster.h"
#include "port_linux/files/read_outcome.h"

// Reads a lidar's metadata JSON into the fixed-size ouster::Metadata. Accepts the flat form of old
// firmware and the nested one of new firmware (beam_intrinsics, lidar_data_format, sensor_info
// ...), and reduced files: missing values are derived where possible (below) and an error
// otherwise. Allocates; for start-up only. Throws nothing.
//
//   missing                           used instead
//   columns_per_frame                 the number before the x of lidar_mode
//   pixels_per_column                 the number of beam_altitude_angles
//   columns_per_packet                16
//   column_window                     the whole revolution
//   udp_profile_lidar                 LEGACY
//   lidar_origin_to_beam_origin_mm    x of beam_to_lidar_transform, otherwise by prod_line
//   lidar_to_sensor_transform         half a turn about z, 36.18 mm up
//   initialization_id, prod_sn        0: not compared with packets
//   image_rev                         build_rev; without a version in either, firmware is 0
//   header_type                       STANDARD, the only supported one
//
// crc_in_footer is set from firmware 3.2 on. The manufacturer does not document the version in
// which the field came into use: recordings of 2.2 have zeros there, those of 2.3 a constant, those
// of 3.2 the CRC; for versions in between it is not checked.
//
// Lengths are millimetres in the file and metres in Metadata.

namespace hardpack::ouster {

// Far larger than any sensor's metadata; larger files are refused unread.
inline constexpr size_t kMaxMetadataBytes = 1024 * 1024;

// `name` is the text's name in messages, usually its path. On failure `metadata` is empty:
// kUnsupported (an unknown profile, packet header or beam geometry), kCapacityExceeded (more beams
// than kMaxBeams, a text longer than its field), kOversized, kNotFinite or kInvalidArgument
// (everything else).
ReadOutcome ParseMetadata(std::string_view json, std::string_view name, Metadata& metadata);

// Reads and parses a file. Also kInvalidArgument if it cannot be read.
ReadOutcome ReadMetadata(const std::string& path, Metadata& metadata);

}  // namespace hardpack::ouster
