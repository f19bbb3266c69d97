// SPDX-License-Identifier: Apache-2.0
// Any text as a lidar's metadata: read, or refused with one line; what is read is a sensor.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "core/scan/scan.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/fuzz/accepted.h"

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(data, data + size);
  static const auto metadata = std::make_unique<hardpack::ouster::Metadata>();
  const hardpack::ReadOutcome outcome =
      hardpack::ouster::ParseMetadata(text, "scan.json", *metadata);
  Require(outcome.ok() == outcome.message.empty());
  for (const char c : outcome.message) Require(c >= ' ' && c <= '~');
  if (!outcome.ok()) return 0;

  hardpack::Accepted("metadata");
  hardpack::ouster::PacketLayout layout;
  const hardpack::Status made = MakeLayout(*metadata, layout);
  Require(made == hardpack::Status::kOk || made == hardpack::Status::kCapacityExceeded);
  Require(!metadata->crc_in_footer || metadata->firmware.first >= 3);
  static const auto model = std::make_unique<hardpack::BeamModel>();
  const size_t beams = static_cast<size_t>(metadata->beams);
  const hardpack::Status modelled =
      MakeBeamModel({metadata->beam_altitude_deg, beams}, {metadata->beam_azimuth_deg, beams},
                    metadata->columns_per_frame, metadata->lidar_origin_to_beam_origin_m,
                    metadata->sensor_from_lidar, *model);
  Require(IsUsable(modelled) || metadata->columns_per_frame > hardpack::kMaxColumnsPerRevolution);
  return 0;
}
