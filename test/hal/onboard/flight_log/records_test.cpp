// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/flight_log/records.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace hardpack::flight_log {
namespace {

using Bytes = std::vector<uint8_t>;

Bytes PayloadOf(const RecordHead& head, const Bytes& bytes = {}) {
  Bytes payload(head.bytes().begin(), head.bytes().end());
  payload.insert(payload.end(), bytes.begin(), bytes.end());
  return payload;
}

TickBeginRecord SomeTick() {
  TickBeginRecord record;
  record.index = 0x0102030405060708u;
  record.now_ns = 1'000'000'007;
  record.bus = CanBusState::kPassive;
  record.datagrams[0] = 1;
  record.datagrams[1] = 2;
  record.datagrams[2] = 31;
  record.frames = 128;
  record.command_bytes = 4096;
  return record;
}

TEST(Records, GiveAVersionBack) {
  VersionRecord record;
  record.run = 11;
  record.file = 12;
  record.next_tick = 13;
  record.state_bytes = 14;
  record.state_layout = 15;
  std::strcpy(record.version, "0.1.0");
  std::strcpy(record.vehicle, "warthog");
  std::memset(record.build, 'b', sizeof(record.build));  // fills its field
  std::strcpy(record.processor, "x86-64");
  VersionRecord read;
  ASSERT_EQ(Decode(PayloadOf(RecordHead(record)), read), Status::kOk);
  EXPECT_EQ(read.run, 11u);
  EXPECT_EQ(read.file, 12u);
  EXPECT_EQ(read.next_tick, 13u);
  EXPECT_EQ(read.state_bytes, 14u);
  EXPECT_EQ(read.state_layout, 15u);
  EXPECT_STREQ(read.version, "0.1.0");
  EXPECT_STREQ(read.vehicle, "warthog");
  EXPECT_EQ(std::memcmp(read.build, record.build, sizeof(record.build)), 0);
  EXPECT_STREQ(read.processor, "x86-64");
}

TEST(Records, GiveATickBack) {
  TickBeginRecord begin;
  ASSERT_EQ(Decode(PayloadOf(RecordHead(SomeTick())), begin), Status::kOk);
  EXPECT_EQ(begin.index, 0x0102030405060708u);
  EXPECT_EQ(begin.now_ns, 1'000'000'007u);
  EXPECT_EQ(begin.bus, CanBusState::kPassive);
  EXPECT_EQ(begin.datagrams[0], 1);
  EXPECT_EQ(begin.datagrams[1], 2);
  EXPECT_EQ(begin.datagrams[2], 31);
  EXPECT_EQ(begin.frames, 128);
  EXPECT_EQ(begin.command_bytes, 4096);
  TickEndRecord end;
  ASSERT_EQ(Decode(PayloadOf(RecordHead(TickEndRecord{7, Status::kInvalidArgument, 32, 3,
                                                      0xfedcba9876543210u, 12345})),
                   end),
            Status::kOk);
  EXPECT_EQ(end.index, 7u);
  EXPECT_EQ(end.status, Status::kInvalidArgument);
  EXPECT_EQ(end.frames, 32);
  EXPECT_EQ(end.refused, 3);
  EXPECT_EQ(end.decision_hash, 0xfedcba9876543210u);
  EXPECT_EQ(end.duration_ns, 12345u);
}

TEST(Records, GivePartsBack) {
  const Bytes text(kMaxPartBytes, 'x');
  const Bytes payload = PayloadOf(RecordHead(RecordKind::kLidarMetadata, {5, 70000, {}}), text);
  PartRecord part;
  ASSERT_EQ(Decode(payload, part), Status::kOk);
  EXPECT_EQ(part.offset, 5u);
  EXPECT_EQ(part.whole_bytes, 70000u);
  EXPECT_EQ(Bytes(part.bytes.begin(), part.bytes.end()), text);
  ImageRecord image;
  ASSERT_EQ(Decode(PayloadOf(RecordHead(ImageRecord{9, 1, 4, 77, {}}), {1, 2, 3}), image),
            Status::kOk);
  EXPECT_EQ(image.index, 9u);
  EXPECT_EQ(image.crc, 77u);
  EXPECT_EQ(image.bytes.size(), 3u);
  CommandRecord command;
  ASSERT_EQ(Decode(PayloadOf(RecordHead(CommandRecord{1000, {}}), {4, 5}), command), Status::kOk);
  EXPECT_EQ(command.user, 1000u);
  EXPECT_EQ(command.bytes.size(), 2u);
  GapRecord gap;
  ASSERT_EQ(Decode(PayloadOf(RecordHead(GapRecord{3})), gap), Status::kOk);
  EXPECT_EQ(gap.records, 3u);
  EXPECT_EQ(KindOf(PayloadOf(RecordHead::End())), RecordKind::kEnd);
}

TEST(Records, RefuseAPartOutsideItsWhole) {
  PartRecord part;
  const auto status = [&part](uint32_t offset, uint32_t whole, const Bytes& bytes) {
    return Decode(PayloadOf(RecordHead(RecordKind::kConfiguration, {offset, whole, {}}), bytes),
                  part);
  };
  EXPECT_EQ(status(0, 2, {1, 2, 3}), Status::kInvalidArgument);
  EXPECT_EQ(status(0xffffffffu, 2, {1}), Status::kInvalidArgument);
  EXPECT_EQ(status(2, 2, {}), Status::kOk);
  EXPECT_EQ(status(0, UINT32_MAX, Bytes(kMaxPartBytes + 1, 0)), Status::kOversized);
  EXPECT_TRUE(part.bytes.empty());
}

TEST(Records, RefuseWhatIsOfAnotherKindOrSize) {
  const Bytes tick = PayloadOf(RecordHead(SomeTick()));
  for (size_t size = 0; size < tick.size(); ++size) {
    TickBeginRecord read = SomeTick();
    const Bytes cut(tick.begin(), tick.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(Decode(cut, read),
              size < kRecordHeaderBytes ? Status::kWrongPacketType : Status::kTruncated);
    EXPECT_EQ(read.index, 0u);
  }
  Bytes longer = tick;
  longer.push_back(0);
  TickBeginRecord read;
  EXPECT_EQ(Decode(longer, read), Status::kOversized);
  GapRecord gap;
  EXPECT_EQ(Decode(tick, gap), Status::kWrongPacketType);
  Bytes bad = tick;
  bad[24] = kCanBusStates;
  EXPECT_EQ(Decode(bad, read), Status::kInvalidArgument);
  bad = tick;
  bad[0] ^= 1u;
  EXPECT_EQ(KindOf(bad), RecordKind::kNone);
  bad = tick;
  bad[4] = kRecordVersion + 1;
  EXPECT_EQ(KindOf(bad), RecordKind::kNone);
  bad = tick;
  bad[5] = 10;
  EXPECT_EQ(KindOf(bad), RecordKind::kNone);
}

TEST(Records, SurviveAnyBytes) {
  std::mt19937 random(2);
  for (int i = 0; i < 20000; ++i) {
    Bytes payload = PayloadOf(RecordHead(GapRecord{}));
    payload.resize(kRecordHeaderBytes + random() % 200);
    payload[5] = static_cast<uint8_t>(random() % 11);
    for (size_t byte = kRecordHeaderBytes; byte < payload.size(); ++byte) {
      payload[byte] = static_cast<uint8_t>(random());
    }
    const auto decode = [&payload](auto record) { return Decode(payload, record); };
    int usable = 0;
    for (const Status status :
         {decode(VersionRecord{}), decode(PartRecord{}), decode(ImageRecord{}),
          decode(TickBeginRecord{}), decode(CommandRecord{}), decode(TickEndRecord{}),
          decode(GapRecord{})}) {
      usable += IsUsable(status) ? 1 : 0;
    }
    ASSERT_LE(usable, 1);
  }
}

}  // namespace
}  // namespace hardpack::flight_log
