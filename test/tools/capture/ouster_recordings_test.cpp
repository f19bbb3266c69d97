// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <ostream>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "hal/ouster/ouster.h"
#include "hal/ouster/packet_monitor.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/tools/capture/capture_files.h"
#include "tools/capture/pcap_reader.h"

// Every capture of a real sensor, from its first packet to its last, through monitor and codec.

namespace hardpack::capture {
namespace {

class OusterRecordings : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::DataFolder();
    if (folder_.empty()) GTEST_SKIP() << "HARDPACK_DATA names no folder with ouster/";
  }

  void Open(const std::string& capture, const std::string& metadata) {
    ReadOutcome outcome = ouster::ReadMetadata(folder_ + "/ouster/" + metadata, metadata_);
    ASSERT_TRUE(outcome.ok()) << outcome.message;
    outcome = reader_.Open(folder_ + "/ouster/" + capture);
    ASSERT_TRUE(outcome.ok()) << outcome.message;
  }

  std::string folder_;
  ouster::Metadata metadata_;
  PcapReader reader_;
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

// A capture, and what is known of it from its metadata, the sensor's data sheet and from reading it
// by other means.
struct Recording {
  const char* capture;
  const char* metadata;
  int packets;
  int invalid_columns;  // marked so by the sensor
  // Of the valid columns' pixels, the share with a return lies between.
  double least_share;
  double greatest_share;
  // All but a fiftieth of the ranges at either end lie between: from what the maker's sheet gives
  // as the nearest to the reach at 80 % reflectivity. Beyond it are some stray ones: 1.7 % in the
  // windowed capture.
  uint32_t nearest_mm;
  uint32_t reach_mm;
  int imu_packets;
  int frames;
};

void PrintTo(const Recording& recording, std::ostream* out) {
  *out << recording.capture;
}

constexpr Recording kRecordings[] = {
    {"OS-1-64_1024x10_fw20.pcap", "OS-1-64_sensor_config_reduced.json", 64, 0, 0.2, 0.3, 300,
     120000, 11, 1},
    {"OS-1-128_v2.3.0_1024x10_lb_n3.pcap", "OS-1-128_v2.3.0_1024x10.json", 192, 0, 0.8, 0.9, 300,
     120000, 30, 3},
    {"OS-2-128-U1_v2.3.0_1024x10.pcap", "OS-2-128-U1_v2.3.0_1024x10.json", 64, 0, 0.9, 0.95, 1000,
     240000, 10, 1},
    // 34 packets: a revolution and the beginning of the next.
    {"crc_test.pcap", "crc_test.json", 34, 0, 0.4, 0.5, 300, 50000, 10, 2},
    // Columns 1 .. 256 of 512, in 17 packets: 1 invalid column in the first, 15 in the last.
    {"windowed_frame1.pcap", "windowed_frame1_0.json", 17, 16, 0.25, 0.35, 240, 50000, 10, 1},
};

class EveryOusterCapture : public OusterRecordings, public testing::WithParamInterface<Recording> {
 protected:
  void SetUp() override {
    OusterRecordings::SetUp();
    if (IsSkipped()) return;
    Open(GetParam().capture, GetParam().metadata);
    ASSERT_EQ(monitor_.Configure(metadata_), Status::kOk);
  }

  bool InWindow(int id) const {
    const int first = metadata_.column_window_first;
    const int last = metadata_.column_window_last;
    return first <= last ? id >= first && id <= last : id >= first || id <= last;
  }

  ouster::PacketMonitor monitor_;
};

// The lidar's packets, all of them, in order, none refused; and in them plausible columns.
TEST_P(EveryOusterCapture, DecodesPlausibly) {
  const Recording& known = GetParam();
  UdpDatagram datagram;
  ouster::PacketHeader header;
  std::vector<uint32_t> ranges_mm;
  std::set<int> frames;
  uint64_t newest_ns = 0;
  int invalid = 0;
  int pixels = 0;
  int others = 0;
  while (reader_.Next(datagram)) {
    if (datagram.payload.size() == static_cast<size_t>(ouster::kImuPacketBytes)) {
      ++others;
      EXPECT_EQ(monitor_.Check(datagram.payload, header), Status::kTruncated);
      continue;
    }
    ASSERT_EQ(monitor_.Check(datagram.payload, header), Status::kOk);
    for (int index = 0; index < monitor_.layout().columns_per_packet; ++index) {
      const Status status =
          ouster::DecodeColumn(monitor_.layout(), datagram.payload, index, *column_);
      EXPECT_GT(column_->timestamp_ns, newest_ns);
      newest_ns = column_->timestamp_ns;
      EXPECT_EQ(InWindow(column_->measurement_id), column_->valid);
      ASSERT_EQ(status, column_->valid ? Status::kOk : Status::kColumnInvalid);
      frames.insert(column_->frame_id);
      if (!column_->valid) {
        ++invalid;
        continue;
      }
      pixels += column_->beams;
      for (int row = 0; row < column_->beams; ++row) {
        if (column_->range_mm[row] != 0) ranges_mm.push_back(column_->range_mm[row]);
      }
    }
  }
  EXPECT_TRUE(reader_.outcome().ok());
  EXPECT_EQ(others, known.imu_packets);
  EXPECT_EQ(monitor_.counters().accepted, static_cast<uint64_t>(known.packets));
  EXPECT_EQ(monitor_.counters().wrong_size, static_cast<uint64_t>(known.imu_packets));
  EXPECT_EQ(monitor_.counters().missing, 0u);
  EXPECT_EQ(monitor_.counters().out_of_order, 0u);
  EXPECT_EQ(monitor_.counters().unplaced, 0u);
  EXPECT_EQ(monitor_.counters().jumps, 0u);
  EXPECT_EQ(frames.size(), static_cast<size_t>(known.frames));
  EXPECT_EQ(invalid, known.invalid_columns);

  const double share = static_cast<double>(ranges_mm.size()) / pixels;
  EXPECT_GT(share, known.least_share);
  EXPECT_LT(share, known.greatest_share);
  std::sort(ranges_mm.begin(), ranges_mm.end());
  EXPECT_GE(ranges_mm[ranges_mm.size() / 50], known.nearest_mm);
  EXPECT_LE(ranges_mm[ranges_mm.size() * 49 / 50], known.reach_mm);
}

// Straight from the bytes, field by field, with the offsets written out again.
TEST_P(EveryOusterCapture, HoldsTheNumbersThatItsBytesSpell) {
  UdpDatagram datagram;
  ouster::PacketHeader header;
  const bool legacy = metadata_.profile == ouster::Profile::kLegacy;
  const bool low_data = metadata_.profile == ouster::Profile::kRng15Rfl8Nir8;
  while (reader_.Next(datagram)) {
    if (monitor_.Check(datagram.payload, header) != Status::kOk) continue;
    const std::span<const uint8_t> bytes = datagram.payload;
    size_t at = legacy ? 0 : 32;
    for (int index = 0; index < 16; ++index) {
      (void)ouster::DecodeColumn(monitor_.layout(), bytes, index, *column_);
      at += legacy ? 16 : 12;
      for (int row = 0; row < metadata_.beams; ++row) {
        const auto u16 = [&bytes, at](size_t offset) {
          return static_cast<uint32_t>(bytes[at + offset] + 256 * bytes[at + offset + 1]);
        };
        if (low_data) {
          ASSERT_EQ(column_->range_mm[row], u16(0) % 32768 * 8);
          ASSERT_EQ(column_->flags[row], u16(0) / 32768);
          ASSERT_EQ(column_->reflectivity[row], bytes[at + 2]);
          ASSERT_EQ(column_->near_ir[row], bytes[at + 3] * 16);
          ASSERT_EQ(column_->signal[row], 0);
        } else {
          ASSERT_EQ(column_->range_mm[row], u16(0) + u16(2) % (legacy ? 16 : 8) * 65536);
          ASSERT_EQ(column_->flags[row], legacy ? u16(2) / 4096 : u16(2) / 8 % 32);
          ASSERT_EQ(column_->reflectivity[row], legacy ? u16(4) : u16(4) % 256);
          ASSERT_EQ(column_->signal[row], u16(6));
          ASSERT_EQ(column_->near_ir[row], u16(8));
        }
        at += low_data ? 4 : 12;
      }
      at += legacy ? 4 : 0;
    }
  }
}

// At rest an accelerometer reads 1 g; one of the sensors is being moved about.
TEST_P(EveryOusterCapture, HasAnImuThatFeelsGravity) {
  constexpr double kG_mps2 = 9.80665;
  UdpDatagram datagram;
  ImuSample sample;
  uint64_t newest_ns = 0;
  int samples = 0;
  double sum_mps2 = 0.0;
  while (reader_.Next(datagram)) {
    if (datagram.payload.size() != static_cast<size_t>(ouster::kImuPacketBytes)) {
      EXPECT_EQ(ouster::DecodeImu(datagram.payload, sample), Status::kOversized);
      continue;
    }
    ASSERT_EQ(ouster::DecodeImu(datagram.payload, sample), Status::kOk);
    ++samples;
    // 100 Hz; the two readings of a packet are a fraction of a millisecond apart.
    if (newest_ns != 0) {
      EXPECT_NEAR(static_cast<double>(sample.acceleration_time_ns - newest_ns), 10e6, 0.1e6);
    }
    newest_ns = sample.acceleration_time_ns;
    EXPECT_GT(sample.angular_rate_time_ns, sample.acceleration_time_ns);
    EXPECT_LT(sample.angular_rate_time_ns, sample.acceleration_time_ns + 1'000'000);
    const auto norm = [](const auto& v) {
      const auto& [x, y, z] = v;
      return std::hypot(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
    };
    const double acceleration_mps2 = norm(sample.acceleration);
    EXPECT_NEAR(acceleration_mps2, kG_mps2, 0.2 * kG_mps2);
    EXPECT_GT(static_cast<double>(sample.acceleration.z_mps2), 0.85 * kG_mps2) << "upright";
    EXPECT_LT(norm(sample.angular_rate), 0.2);
    sum_mps2 += acceleration_mps2;
  }
  EXPECT_EQ(samples, GetParam().imu_packets);
  EXPECT_NEAR(sum_mps2 / samples, kG_mps2, 0.1 * kG_mps2);
}

// The first packet alone: a stream that breaks off at once.
TEST_P(EveryOusterCapture, DecodesASinglePacket) {
  UdpDatagram datagram;
  ouster::PacketHeader header;
  Status status = Status::kTruncated;
  while (status != Status::kOk && reader_.Next(datagram)) {
    status = monitor_.Check(datagram.payload, header);
  }
  ASSERT_EQ(status, Status::kOk);
  EXPECT_EQ(monitor_.Check(datagram.payload, header), Status::kDuplicate);
  EXPECT_EQ(monitor_.counters().accepted, 1u);
  EXPECT_EQ(monitor_.counters().missing, 0u);
  for (int index = 0; index < 16; ++index) {
    const Status decoded =
        ouster::DecodeColumn(monitor_.layout(), datagram.payload, index, *column_);
    EXPECT_EQ(decoded, InWindow(column_->measurement_id) ? Status::kOk : Status::kColumnInvalid);
  }
}

// With the metadata of another sensor, or in another profile, nothing passes and nothing breaks.
TEST_P(EveryOusterCapture, IsRefusedInEveryOtherProfileAndAsAnotherSensor) {
  const ouster::Metadata true_metadata = metadata_;
  for (int profile = 0; profile < 4; ++profile) {
    metadata_.profile = static_cast<ouster::Profile>(profile);
    metadata_.serial_number = true_metadata.serial_number;
    if (metadata_.profile == true_metadata.profile) ++metadata_.serial_number;
    if (true_metadata.profile == ouster::Profile::kLegacy &&
        metadata_.profile == ouster::Profile::kLegacy) {
      continue;  // carries no identity
    }
    ASSERT_EQ(monitor_.Configure(metadata_), Status::kOk);
    ASSERT_TRUE(reader_.Open(folder_ + "/ouster/" + GetParam().capture).ok());
    UdpDatagram datagram;
    ouster::PacketHeader header;
    while (reader_.Next(datagram)) {
      EXPECT_FALSE(IsUsable(monitor_.Check(datagram.payload, header)));
      for (int index = 0; index < 16; ++index) {
        (void)ouster::DecodeColumn(monitor_.layout(), datagram.payload, index, *column_);
      }
    }
    EXPECT_EQ(monitor_.counters().accepted, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, EveryOusterCapture, testing::ValuesIn(kRecordings),
                         [](const testing::TestParamInfo<Recording>& info) {
                           std::string name;
                           for (const char c : std::string(info.param.capture)) {
                             if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
                           }
                           return name;
                         });

// Firmware 3.2 fills the CRC in: it is right in every packet, and damage shows. Firmware 2.3 puts a
// constant in its place: held to it, no packet would pass.
TEST_F(OusterRecordings, CarryACrcFromFirmware32On) {
  for (const Recording& recording : kRecordings) {
    SCOPED_TRACE(recording.capture);
    Open(recording.capture, recording.metadata);
    if (metadata_.profile == ouster::Profile::kLegacy) continue;
    const bool has_crc = metadata_.firmware.first >= 3;
    EXPECT_EQ(metadata_.crc_in_footer, has_crc);
    metadata_.crc_in_footer = true;
    ouster::PacketMonitor monitor;
    ASSERT_EQ(monitor.Configure(metadata_), Status::kOk);
    UdpDatagram datagram;
    ouster::PacketHeader header;
    while (reader_.Next(datagram)) {
      if (datagram.payload.size() != static_cast<size_t>(monitor.layout().packet_bytes)) continue;
      test::Bytes damaged(datagram.payload.begin(), datagram.payload.end());
      damaged[4000] ^= 0x10;
      EXPECT_EQ(monitor.Check(damaged, header), Status::kBadCrc);
      EXPECT_EQ(monitor.Check(datagram.payload, header), has_crc ? Status::kOk : Status::kBadCrc);
    }
    EXPECT_EQ(monitor.counters().accepted, has_crc ? static_cast<uint64_t>(recording.packets) : 0u);
  }
}

// Two captures one after the other, as from a sensor that was exchanged, and one with another init
// id in its metadata, as after a boot.
TEST_F(OusterRecordings, TellAnotherSensorFromANewStart) {
  Open("windowed_frame1.pcap", "windowed_frame1_0.json");
  ++metadata_.init_id;
  ouster::PacketMonitor monitor;
  ASSERT_EQ(monitor.Configure(metadata_), Status::kOk);
  UdpDatagram datagram;
  ouster::PacketHeader header;
  while (!monitor.restarted() && reader_.Next(datagram)) {
    EXPECT_FALSE(IsUsable(monitor.Check(datagram.payload, header)));
  }
  ASSERT_TRUE(monitor.restarted());
  monitor.Resume();
  while (reader_.Next(datagram)) (void)monitor.Check(datagram.payload, header);
  EXPECT_EQ(monitor.counters().restarts, 1u);
  EXPECT_EQ(monitor.counters().not_resumed, 1u);
  EXPECT_EQ(monitor.counters().accepted, 16u);

  ASSERT_TRUE(reader_.Open(folder_ + "/ouster/OS-1-128_v2.3.0_1024x10_lb_n3.pcap").ok());
  while (reader_.Next(datagram)) (void)monitor.Check(datagram.payload, header);
  EXPECT_EQ(monitor.counters().wrong_sensor, 192u);
  EXPECT_EQ(monitor.counters().accepted, 16u);
}

}  // namespace
}  // namespace hardpack::capture
