// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <openssl/evp.h>

#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/byte_reader.h"
#include "core/scan/scan.h"
#include "hal/ouster/ouster.h"
#include "port_linux/files/ouster_metadata.h"
#include "test/tools/capture/capture_files.h"
#include "tools/capture/pcap_reader.h"

// The codec on captures of real sensors, against what the maker's own software made of them.

namespace hardpack::capture {
namespace {

class OusterCaptures : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::DataFolder();
    if (folder_.empty()) GTEST_SKIP() << "HARDPACK_DATA names no folder with ouster/";
  }

  void Open(const std::string& capture, const std::string& metadata) {
    ReadOutcome outcome = ouster::ReadMetadata(folder_ + "/" + metadata, metadata_);
    ASSERT_TRUE(outcome.ok()) << outcome.message;
    outcome = reader_.Open(folder_ + "/" + capture);
    ASSERT_TRUE(outcome.ok()) << outcome.message;
  }

  // The next datagram that is a packet of the sensor.
  bool NextPacket(const ouster::PacketLayout& layout, UdpDatagram& packet) {
    ouster::PacketHeader header;
    while (reader_.Next(packet)) {
      if (IsUsable(ouster::CheckPacket(layout, metadata_, packet.payload, header))) return true;
    }
    return false;
  }

  std::string folder_;
  ouster::Metadata metadata_;
  PcapReader reader_;
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

// The maker's digests are MD5 sums over arrays of fixed-width little-endian numbers.
class Digest {
 public:
  void Add(uint64_t value, int bytes) { test::AppendLittle(bytes_, value, bytes); }
  std::string Hex() const {
    unsigned char sum[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    EXPECT_EQ(EVP_Digest(bytes_.data(), bytes_.size(), sum, &size, EVP_md5(), nullptr), 1);
    std::ostringstream hex;
    for (unsigned int i = 0; i < size; ++i) {
      hex << "0123456789abcdef"[sum[i] >> 4] << "0123456789abcdef"[sum[i] & 15];
    }
    return hex.str();
  }

 private:
  test::Bytes bytes_;
};

// Numbers of one field in the order [packet][row][column of the packet], as the maker hashes them,
// and where they belong in the revolution.
struct FieldOfScan {
  int bytes = 0;
  std::vector<uint64_t> in_packets;
  std::vector<uint64_t> in_scan;  // [row][measurement id]

  std::string Hash(const std::vector<uint64_t>& values) const {
    Digest digest;
    for (const uint64_t value : values) digest.Add(value, bytes);
    return digest.Hex();
  }
};

TEST_F(OusterCaptures, Os2DecodesFieldForFieldToTheMakersDigest) {
  Open("ouster/OS-2-128-U1_v2.3.0_1024x10.pcap", "ouster/OS-2-128-U1_v2.3.0_1024x10.json");
  std::ifstream digest_file(folder_ + "/ouster/OS-2-128-U1_v2.3.0_1024x10_digest.json");
  const nlohmann::json digest = nlohmann::json::parse(digest_file);
  ouster::PacketLayout layout;
  ASSERT_EQ(ouster::MakeLayout(metadata_, layout), Status::kOk);

  constexpr size_t kRows = 128;
  constexpr size_t kColumns = 1024;
  std::map<std::string, FieldOfScan> fields = {
      {"RANGE", {4, {}, {}}},       {"SIGNAL", {2, {}, {}}},     {"REFLECTIVITY", {1, {}, {}}},
      {"NEAR_IR", {2, {}, {}}},     {"FLAGS", {1, {}, {}}},      {"RAW32_WORD1", {4, {}, {}}},
      {"RAW32_WORD2", {4, {}, {}}}, {"RAW32_WORD3", {4, {}, {}}}};
  for (auto& [name, field] : fields) field.in_scan.resize(kRows * kColumns);
  std::map<std::string, Digest> headers;       // of packets, each with the width it has there
  std::map<std::string, Digest> scan_headers;  // of the scan, where some are wider

  std::vector<LidarColumn> columns(16);
  UdpDatagram packet;
  int packets = 0;
  while (NextPacket(layout, packet)) {
    ++packets;
    for (size_t c = 0; c < 16; ++c) {
      LidarColumn& column = columns[c];
      ASSERT_EQ(ouster::DecodeColumn(layout, packet.payload, static_cast<int>(c), column),
                Status::kOk);
      EXPECT_EQ(column.frame_id, 1259);
      EXPECT_EQ(column.encoder_ticks, 0u);
      for (std::map<std::string, Digest>* sums : {&headers, &scan_headers}) {
        const bool of_scan = sums == &scan_headers;
        (*sums)["TIMESTAMP"].Add(column.timestamp_ns, 8);
        (*sums)["MEASUREMENT_ID"].Add(column.measurement_id, 2);
        (*sums)["STATUS"].Add(column.status, of_scan ? 8 : 4);
        (*sums)["ENCODER_COUNT"].Add(column.encoder_ticks, of_scan ? 8 : 4);
      }
      // The maker's deprecated column header: 0 in profiles whose packets have a header.
      headers["FRAME_ID"].Add(0, 2);
    }
    for (size_t row = 0; row < kRows; ++row) {
      for (size_t c = 0; c < 16; ++c) {
        const LidarColumn& column = columns[c];
        // The raw words are of the packet; they hold what the typed fields were taken from.
        const size_t at = 32 + c * (12 + kRows * 12) + 12 + row * 12;
        const auto word = [&packet, at](size_t index) {
          ByteReader reader(packet.payload);
          return uint64_t{reader.U32(at + 4 * index)};
        };
        const std::map<std::string, uint64_t> values = {{"RANGE", column.range_mm[row]},
                                                        {"SIGNAL", column.signal[row]},
                                                        {"REFLECTIVITY", column.reflectivity[row]},
                                                        {"NEAR_IR", column.near_ir[row]},
                                                        {"FLAGS", column.flags[row]},
                                                        {"RAW32_WORD1", word(0)},
                                                        {"RAW32_WORD2", word(1)},
                                                        {"RAW32_WORD3", word(2)}};
        for (const auto& [name, value] : values) {
          fields[name].in_packets.push_back(value);
          fields[name].in_scan[row * kColumns + column.measurement_id] = value;
        }
      }
    }
  }
  EXPECT_EQ(packets, 64);
  EXPECT_TRUE(reader_.outcome().ok());

  size_t compared = 0;
  for (const auto& [name, expected] : digest["packet_hash"].items()) {
    const auto header = headers.find(name);
    const std::string hash = header != headers.end()
                                 ? header->second.Hex()
                                 : fields.at(name).Hash(fields.at(name).in_packets);
    EXPECT_EQ(hash, expected.get<std::string>()) << name;
    ++compared;
  }
  EXPECT_EQ(compared, 13u);
  ASSERT_EQ(digest["scans"].size(), 1u);
  for (const auto& [name, expected] : digest["scans"][0].items()) {
    if (name == "FRAME_ID") {
      EXPECT_EQ(expected.get<std::string>(), "1259");
      continue;
    }
    const auto header = scan_headers.find(name);
    const std::string hash = header != scan_headers.end()
                                 ? header->second.Hex()
                                 : fields.at(name).Hash(fields.at(name).in_scan);
    EXPECT_EQ(hash, expected.get<std::string>()) << "scan " << name;
  }
}

TEST_F(OusterCaptures, Os1LegacyYieldsTheKnownNumberOfReturns) {
  Open("ouster/OS-1-64_1024x10_fw20.pcap", "ouster/OS-1-64_sensor_config_reduced.json");
  ouster::PacketLayout layout;
  ASSERT_EQ(ouster::MakeLayout(metadata_, layout), Status::kOk);
  UdpDatagram packet;
  std::set<int> ids;
  int returns = 0;
  while (NextPacket(layout, packet)) {
    for (int index = 0; index < 16; ++index) {
      ASSERT_EQ(ouster::DecodeColumn(layout, packet.payload, index, *column_), Status::kOk);
      // A revolution is 90112 encoder ticks.
      EXPECT_EQ(column_->encoder_ticks, column_->measurement_id * 88u);
      EXPECT_TRUE(ids.insert(column_->measurement_id).second);
      for (int row = 0; row < 64; ++row) returns += column_->range_mm[row] != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(ids.size(), 1024u);
  EXPECT_EQ(*ids.rbegin(), 1023);
  EXPECT_EQ(returns, 16749);
}

// Each return of the labelled scan, decoded from the packets, put into the sensor's frame and
// mounted without a turn, is the point that the data set gives for it.
TEST_F(OusterCaptures, RellisDecodesToTheLabelledPoints) {
  Open("rellis/rellis_000104_os1-64_2048x10_legacy_reencoded.pcap",
       "rellis/rellis_000104_os1-64_2048x10_legacy_reencoded.json");
  ouster::PacketLayout layout;
  ASSERT_EQ(ouster::MakeLayout(metadata_, layout), Status::kOk);
  const auto columns = std::make_unique<std::vector<LidarColumn>>(2048);
  UdpDatagram packet;
  while (NextPacket(layout, packet)) {
    for (int index = 0; index < 16; ++index) {
      ASSERT_EQ(ouster::DecodeColumn(layout, packet.payload, index, *column_), Status::kOk);
      (*columns)[column_->measurement_id] = *column_;
    }
  }
  const auto model = std::make_unique<BeamModel>();
  ASSERT_EQ(
      MakeBeamModel({metadata_.beam_altitude_deg, 64}, {metadata_.beam_azimuth_deg, 64}, 2048,
                    metadata_.lidar_origin_to_beam_origin_m, metadata_.sensor_from_lidar, *model),
      Status::kOk);
  LidarMountParams mount;
  mount.z_m = 0.0f;
  mount.yaw_rad = 0.0f;
  const Transform3 body_from_sensor = BodyFromSensor(mount);

  std::ifstream csv(folder_ + "/rellis/rellis_000104_labelled.csv");
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  int points = 0;
  while (std::getline(csv, line)) {
    ++points;
    std::vector<double> v;
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) v.push_back(std::stod(field));
    ASSERT_EQ(v.size(), 10u);
    const int ring = static_cast<int>(v[3]);
    const int id = static_cast<int>(v[4]);
    const LidarColumn& column = (*columns)[static_cast<size_t>(id)];
    EXPECT_EQ(column.range_mm[ring], static_cast<uint32_t>(v[5]));
    EXPECT_EQ(column.reflectivity[ring], static_cast<uint16_t>(v[6]));
    EXPECT_EQ(column.signal[ring], static_cast<uint16_t>(v[7]));
    EXPECT_EQ(column.near_ir[ring], static_cast<uint16_t>(v[8]));
    const Vec3 point = body_from_sensor.Apply(
        PointInSensor(*model, EncoderSinCos(*model, id), ring, column.range_mm[ring]));
    ASSERT_NEAR(static_cast<double>(point.x_m), v[0], 0.002) << line;
    ASSERT_NEAR(static_cast<double>(point.y_m), v[1], 0.002) << line;
    ASSERT_NEAR(static_cast<double>(point.z_m), v[2], 0.002) << line;
  }
  EXPECT_EQ(points, 77708);
}

}  // namespace
}  // namespace hardpack::capture
