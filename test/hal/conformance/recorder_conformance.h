// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "hal/recorder.h"
#include "test/fakes/memory_recorder.h"

// What every Recorder has to do (hal/recorder.h). A Harness has one:
//
//   Recorder& recorder()     with room for some 500,000 bytes, files of 200,000
//   Packets Finish()         ends it and gives every packet that was written, in order; once
//   void Fill()              records until there is no room

namespace hardpack {

using RecordedPacket = fakes::MemoryRecorder::Packet;

template <typename Harness>
class RecorderConformance : public testing::Test {
 protected:
  Recorder& recorder() { return harness_.recorder(); }

  RecordedPacket PacketOf(uint32_t number, size_t head_bytes, size_t body_bytes) {
    RecordedPacket packet = {int64_t{1'795'000'000'000'000'000} + number, {}};
    packet.bytes.resize(head_bytes + body_bytes);
    for (size_t i = 0; i < packet.bytes.size(); ++i) {
      packet.bytes[i] = static_cast<uint8_t>(number + i);
    }
    return packet;
  }
  Status Record(const RecordedPacket& packet, size_t head_bytes) {
    const std::span<const uint8_t> bytes(packet.bytes);
    return recorder().Record(packet.time_ns, bytes.first(head_bytes), bytes.subspan(head_bytes));
  }

  Harness harness_;
};
TYPED_TEST_SUITE_P(RecorderConformance);

TYPED_TEST_P(RecorderConformance, WritesEveryPacketOnceInOrder) {
  std::vector<RecordedPacket> packets;
  this->recorder().BeginFile();
  for (uint32_t i = 0; i < 200; ++i) {
    const size_t head_bytes = i % 50;
    packets.push_back(this->PacketOf(i, head_bytes, i * 7 % 1500));
    ASSERT_EQ(this->Record(packets.back(), head_bytes), Status::kOk);
  }
  EXPECT_EQ(this->recorder().counters().records, 200u);
  EXPECT_EQ(this->recorder().counters().dropped, 0u);
  EXPECT_EQ(this->harness_.Finish(), packets);
}

TYPED_TEST_P(RecorderConformance, TakesTheLargestPacketAndNoLarger) {
  this->recorder().BeginFile();
  const size_t most = Recorder::kMaxRecord_bytes;
  EXPECT_EQ(this->Record(this->PacketOf(1, 48, most - 48), 48), Status::kOk);
  EXPECT_EQ(this->Record(this->PacketOf(2, 48, most - 47), 48), Status::kOversized);
  EXPECT_EQ(this->Record(this->PacketOf(3, most + 1, 0), most + 1), Status::kOversized);
  EXPECT_EQ(this->Record(this->PacketOf(4, 0, 0), 0), Status::kOk);
  EXPECT_EQ(this->recorder().counters().records, 2u);
  EXPECT_EQ(this->recorder().counters().bytes, most);
}

TYPED_TEST_P(RecorderConformance, WantsAnOpeningAtTheStartAndWhenAFileIsFull) {
  EXPECT_TRUE(this->recorder().wants_opening());
  this->recorder().BeginFile();
  EXPECT_FALSE(this->recorder().wants_opening());
  for (uint32_t i = 0; i < 25; ++i) {
    ASSERT_EQ(this->Record(this->PacketOf(i, 48, 10'000), 48), Status::kOk);
  }
  EXPECT_TRUE(this->recorder().wants_opening());
  this->recorder().BeginFile();
  EXPECT_FALSE(this->recorder().wants_opening());
  this->harness_.Finish();
  EXPECT_EQ(this->recorder().counters().files, 2u);
}

TYPED_TEST_P(RecorderConformance, DropsWholePacketsAndCountsThemWhereThereIsNoRoom) {
  this->recorder().BeginFile();
  const uint64_t dropped = this->harness_.Fill();
  EXPECT_GT(dropped, 0u);
  EXPECT_EQ(this->recorder().counters().dropped, dropped);
}

REGISTER_TYPED_TEST_SUITE_P(RecorderConformance, WritesEveryPacketOnceInOrder,
                            TakesTheLargestPacketAndNoLarger,
                            WantsAnOpeningAtTheStartAndWhenAFileIsFull,
                            DropsWholePacketsAndCountsThemWhereThereIsNoRoom);

}  // namespace hardpack
