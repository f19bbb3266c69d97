// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "core/base/decision_hash.h"
#include "hal/ouster/packet_monitor.h"
#include "test/hal/ouster/ouster_packets.h"

// Streams of packets of every profile that are lost, late, doubled, spoilt and of a sensor that
// starts anew: what is told of them is what it was when it was last changed on purpose.

namespace hardpack::ouster {
namespace {

// The same numbers everywhere, 32 bits of them.
class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  uint32_t operator()() { return static_cast<uint32_t>(engine_()); }

 private:
  std::mt19937 engine_;
};

class Stream {
 public:
  explicit Stream(uint32_t seed) : random_(seed) {
    metadata_.profile = static_cast<Profile>(Below(4));
    metadata_.beams = 16 << Below(3);
    metadata_.columns_per_frame = 512 << Below(3);
    metadata_.columns_per_packet = Below(4) == 0 ? 7 : 16;
    metadata_.column_window_last = metadata_.columns_per_frame - 1;
    if (Below(3) == 0) {  // a window, now and then past zero
      metadata_.column_window_first = Below(metadata_.columns_per_frame);
      metadata_.column_window_last = Below(metadata_.columns_per_frame);
    }
    identity_.frame_id = static_cast<uint16_t>(65500 + Below(100));
    identity_.init_id = 0x10203u + static_cast<uint32_t>(Below(5));
    identity_.serial_number = 0x991234;
    if (Below(2) == 0) metadata_.init_id = identity_.init_id;
    if (Below(2) == 0) metadata_.serial_number = identity_.serial_number;
    metadata_.crc_in_footer = metadata_.profile != Profile::kLegacy && Below(2) == 0;
  }

  // Packets that were accepted.
  int Run(int packets, DecisionHash& hash) {
    const Status taken = monitor_->Configure(metadata_);
    hash.AddU8(static_cast<uint8_t>(taken));
    if (!IsUsable(taken)) return 0;
    int accepted = 0;
    for (int i = 0; i < packets; ++i) {
      std::vector<uint8_t> packet = Next();
      if (Below(10) == 0) packet.swap(late_);  // the one that was kept back, now
      if (Below(25) == 0) Spoil(packet);
      accepted += Give(packet, hash) ? 1 : 0;
      if (Below(15) == 0) Give(packet, hash);
      if (monitor_->restarted() && Below(4) == 0) monitor_->Resume();
    }
    return accepted;
  }

 private:
  int Below(int count) { return static_cast<int>(random_() % static_cast<uint32_t>(count)); }

  LidarColumn AnyColumn(int measurement_id) {
    LidarColumn column;
    column.timestamp_ns = random_();
    column.measurement_id = static_cast<uint16_t>(measurement_id);
    column.frame_id = identity_.frame_id;
    column.encoder_ticks = random_() % 90112;
    column.status = Below(12) == 0 ? random_() & 0xfffeu : 0xffffffffu;
    column.beams = metadata_.beams;
    for (int row = 0; row < metadata_.beams; ++row) {
      column.range_mm[row] = random_() % (1u << 15) & ~7u;
      column.flags[row] = static_cast<uint8_t>(random_() % 2);
      column.reflectivity[row] = static_cast<uint16_t>(random_() % 256);
      column.signal[row] = static_cast<uint16_t>(random_());
      column.near_ir[row] = static_cast<uint16_t>(random_() % 256 * 16);
      column.second_range_mm[row] = random_() % (1u << 19);
    }
    return column;
  }

  // The next one of the sensor's, which turns, loses some, jumps and starts anew.
  std::vector<uint8_t> Next() {
    if (Below(60) == 0) at_ += metadata_.columns_per_packet * Below(40);
    if (Below(200) == 0) identity_.frame_id = static_cast<uint16_t>(random_());
    if (Below(150) == 0) {
      identity_.init_id += static_cast<uint32_t>(Below(3));
      identity_.frame_id = 0;
      at_ = 0;
    }
    if (at_ >= metadata_.columns_per_frame) {
      at_ = Below(30) == 0 ? Below(16) : 0;
      ++identity_.frame_id;
    }
    std::vector<LidarColumn> columns;
    for (int i = 0; i < metadata_.columns_per_packet; ++i) {
      columns.push_back(AnyColumn((at_ + i) % metadata_.columns_per_frame));
    }
    at_ += metadata_.columns_per_packet;
    std::vector<uint8_t> packet = test::Encode(metadata_.profile, identity_, columns);
    if (metadata_.crc_in_footer) test::SetCrc(packet);
    return packet;
  }

  void Spoil(std::vector<uint8_t>& packet) {
    if (packet.empty()) return;
    if (Below(3) == 0) packet.resize(static_cast<size_t>(Below(static_cast<int>(packet.size()))));
    if (packet.empty()) return;
    const int most = Below(2) == 0 ? 40 : static_cast<int>(packet.size());
    packet[static_cast<size_t>(Below(most)) % packet.size()] ^= static_cast<uint8_t>(1 << Below(8));
  }

  bool Give(const std::vector<uint8_t>& packet, DecisionHash& hash) {
    PacketHeader header;
    const Status status = monitor_->Check(packet, header);
    hash.AddU8(static_cast<uint8_t>(status));
    hash.AddU32(header.frame_id);
    hash.AddU32(header.init_id);
    hash.AddU64(header.serial_number);
    hash.AddU8(monitor_->restarted());
    AddCounters(hash);
    if (status != Status::kOk) return false;
    for (int index = 0; index < metadata_.columns_per_packet; ++index) {
      LidarColumn& column = *column_;
      hash.AddU8(static_cast<uint8_t>(DecodeColumn(monitor_->layout(), packet, index, column)));
      hash.AddU64(column.timestamp_ns);
      hash.AddU32(column.measurement_id);
      hash.AddU32(column.frame_id);
      hash.AddU32(column.encoder_ticks);
      hash.AddU8(column.valid);
      const int row = Below(metadata_.beams);
      hash.AddU32(column.range_mm[row]);
      hash.AddU32(column.second_range_mm[row]);
      hash.AddU32(column.flags[row]);
      hash.AddU32(column.reflectivity[row]);
      hash.AddU32(column.signal[row]);
      hash.AddU32(column.near_ir[row]);
    }
    return true;
  }

  void AddCounters(DecisionHash& hash) const {
    const PacketCounters& c = monitor_->counters();
    for (const uint64_t count : {c.accepted, c.wrong_size, c.wrong_type, c.bad_crc, c.wrong_sensor,
                                 c.not_resumed, c.before_start, c.duplicates, c.restarts,
                                 c.out_of_order, c.missing, c.jumps, c.unplaced}) {
      hash.AddU64(count);
    }
  }

  Random random_;
  Metadata metadata_;
  test::PacketIdentity identity_;
  int at_ = 0;  // measurement of the next packet's first column
  std::vector<uint8_t> late_;
  std::unique_ptr<PacketMonitor> monitor_ = std::make_unique<PacketMonitor>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

TEST(OusterRecorded, TellsAsItDid) {
  DecisionHash hash;
  int accepted = 0;
  for (uint32_t seed = 1; seed <= 48; ++seed) accepted += Stream(seed).Run(150, hash);
  EXPECT_GT(accepted, 2000);
  EXPECT_EQ(hash.value(), 0x8f685290f8f13697u) << "0x" << std::hex << hash.value() << "u";
}

}  // namespace
}  // namespace hardpack::ouster
