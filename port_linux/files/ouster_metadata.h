// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "hal/ouster/ouster.h"
#include "port_linux/files/read_outcome.h"

// A lidar's metadata JSON into the fixed-size ouster::Metadata. Takes the flat form of old firmware
// and the nested one of new (beam_intrinsics, lidar_data_format, sensor_info ...), and reduced
// files: what is not stated is derived where it can be (below) and an error where it cannot.
// Allocates; for start-up only. No exception leaves it.
//
//   not stated                        taken instead
//   columns_per_frame                 the number before the x of lidar_mode
//   pixels_per_column                 the number of beam_altitude_angles
//   columns_per_packet                16
//   column_window                     the whole revolution
//   udp_profile_lidar                 LEGACY
//   lidar_origin_to_beam_origin_mm    x of beam_to_lidar_transform, else by prod_line
//   lidar_to_sensor_transform         half a turn about z, 36.18 mm up
//   initialization_id, prod_sn        0: packets are not held against them
//   image_rev                         build_rev; without a version in either, firmware is 0
//   header_type                       STANDARD, the only one that is read
//
// crc_in_footer is set from firmware 3.2 on. The maker does not say in which version the field came
// to be filled in: recordings of 2.2 have zeros there, those of 2.3 a constant, those of 3.2 the
// CRC; in between the packets are not held to it.
//
// Lengths are millimetres in the file and metres in Metadata.

namespace hardpack::ouster {

// Far more than any sensor's metadata; a larger file is refused unread.
inline constexpr size_t kMaxMetadataBytes = 1024 * 1024;

// `name` is what messages call the text, as a rule its path. On failure `metadata` is empty:
// kUnsupported (an unknown profile, packet header or beam geometry), kCapacityExceeded (more beams
// than kMaxBeams, a text longer than its field), kOversized, kNotFinite or kInvalidArgument
// (everything else).
ReadOutcome ParseMetadata(std::string_view json, std::string_view name, Metadata& metadata);

// Reads and parses a file. Besides: kInvalidArgument when it cannot be read.
ReadOutcome ReadMetadata(const std::string& path, Metadata& metadata);

}  // namespace hardpack::ouster
