// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "config/onboard_parameters.h"
#include "core/scan/scan.h"
#include "core/scan/sight_watch.h"
#include "hal/ouster/ouster.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/tools/capture/capture_files.h"
#include "tools/capture/pcap_reader.h"

// No capture of a real sensor looks like a sensor that is covered or frozen.

namespace hardpack::capture {
namespace {

struct Capture {
  const char* capture;
  const char* metadata;
};

void PrintTo(const Capture& capture, std::ostream* out) {
  *out << capture.capture;
}

class SightOnCaptures : public testing::TestWithParam<Capture> {};

// SR-SEE02: neither covered nor frozen, on recordings of real sensors.
TEST_P(SightOnCaptures, IsNeitherCoveredNorFrozen) {
  const std::string folder = test::DataFolder();
  if (folder.empty()) GTEST_SKIP() << "HARDPACK_DATA names no folder with ouster/";
  ouster::Metadata metadata;
  ReadOutcome outcome = ouster::ReadMetadata(folder + "/" + GetParam().metadata, metadata);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  PcapReader reader;
  outcome = reader.Open(folder + "/" + GetParam().capture);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  const auto model = std::make_unique<BeamModel>();
  const auto beams = static_cast<size_t>(metadata.beams);
  ASSERT_EQ(MakeBeamModel({metadata.beam_altitude_deg, beams}, {metadata.beam_azimuth_deg, beams},
                          metadata.columns_per_frame, metadata.lidar_origin_to_beam_origin_m,
                          metadata.sensor_from_lidar, *model),
            Status::kOk);
  const auto watch = std::make_unique<SightWatch>();
  ASSERT_EQ(watch->Configure({}, {}, *model, metadata.columns_per_packet,
                             metadata.column_window_first, metadata.column_window_last),
            Status::kOk);
  ouster::PacketLayout layout;
  ASSERT_EQ(ouster::MakeLayout(metadata, layout), Status::kOk);
  const auto column = std::make_unique<LidarColumn>();
  UdpDatagram packet;
  int columns = 0;
  int most_covered = 0;
  int most_frozen = 0;
  while (reader.Next(packet)) {
    ouster::PacketHeader header;
    if (!IsUsable(ouster::CheckPacket(layout, metadata, packet.payload, header))) continue;
    for (int i = 0; i < layout.columns_per_packet; ++i) {
      if (!IsUsable(ouster::DecodeColumn(layout, packet.payload, i, *column))) continue;
      watch->Take(*column, column->timestamp_ns);
      ++columns;
      most_covered = std::max(most_covered, watch->covered_sectors());
      most_frozen = std::max(most_frozen, watch->frozen_sectors());
    }
  }
  std::printf("%d columns, %d sectors, most covered %d, most frozen %d, old %d\n", columns,
              watch->sectors(), most_covered, most_frozen,
              watch->OldSectors(watch->newest_ns(), 0.42f));
  EXPECT_GT(columns, 100);
  EXPECT_EQ(most_covered, 0);
  EXPECT_EQ(most_frozen, 0);
}

INSTANTIATE_TEST_SUITE_P(
    All, SightOnCaptures,
    testing::Values(
        Capture{"ouster/OS-1-128_v2.3.0_1024x10_lb_n3.pcap", "ouster/OS-1-128_v2.3.0_1024x10.json"},
        Capture{"ouster/OS-1-64_1024x10_fw20.pcap", "ouster/OS-1-64_sensor_config_reduced.json"},
        Capture{"ouster/OS-2-128-U1_v2.3.0_1024x10.pcap", "ouster/OS-2-128-U1_v2.3.0_1024x10.json"},
        Capture{"ouster/windowed_frame1.pcap", "ouster/windowed_frame1_0.json"},
        Capture{"rellis/rellis_000104_os1-64_2048x10_legacy_reencoded.pcap",
                "rellis/rellis_000104_os1-64_2048x10_legacy_reencoded.json"}),
    [](const testing::TestParamInfo<Capture>& param) {
      std::string name = param.param.capture;
      for (char& c : name) {
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      }
      return name;
    });

}  // namespace
}  // namespace hardpack::capture
