// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/control/status_report.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "core/autonomy/mapper.h"
#include "core/autonomy/replanner.h"
#include "core/timebase/timebase.h"
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "hal/ouster/packet_monitor.h"
#include "hal/pose_datagram/pose_datagram.h"
#include "hal/sevcon/sevcon.h"
#include "hal/vectornav/stream_parser.h"
#include "hal/velodyne/lidar.h"
#include "test/hal/onboard/control/random_messages.h"

namespace hardpack::control {
namespace {

// A counter that is added where it is counted has to be added here too: then an operator sees it.
static_assert(sizeof(InsStreamPart) == sizeof(uint64_t) + sizeof(vectornav::StreamCounters));
static_assert(sizeof(PoseDatagramPart) == sizeof(uint64_t) + sizeof(pose_datagram::Counters));
static_assert(sizeof(LidarPacketPart) == sizeof(ouster::PacketCounters) + 4 * sizeof(uint64_t));
static_assert(sizeof(LidarPacketPart) == sizeof(velodyne::PacketCounters) + 3 * sizeof(uint64_t));
static_assert(sizeof(MapperPart) == sizeof(MapperCounters));
static_assert(sizeof(ReplanPart) == sizeof(ReplanCounters));
static_assert(sizeof(LoopPart) == sizeof(LoopCounters));
static_assert(5 * sizeof(uint32_t) == sizeof(TimebaseCounters));
static_assert(5 * sizeof(uint32_t) == sizeof(sevcon::PairCounters));
static_assert(kReplanReasonCount == kReplanReasons);
static_assert(kInputSourceCount == kInputSources);

struct Listed {
  std::string name;
  size_t offset;  // in the message, of its first byte
  size_t bytes;
  bool is_flag;
  bool is_text;
};

class Lister {
 public:
  void BeginGroup(const char* name) { group_ = name; }
  template <typename Value>
  void operator()(const char* name, FieldKind, Concern, const Value& value) {
    const size_t bytes = std::is_same_v<Value, Age> ? 16 : sizeof(value);
    listed_.push_back(
        {group_ + "." + name, offset_, bytes, std::is_same_v<Value, bool>, std::is_array_v<Value>});
    offset_ += bytes;
  }
  const std::vector<Listed>& listed() const { return listed_; }

 private:
  std::string group_;
  size_t offset_ = kHeaderBytes + 4;
  std::vector<Listed> listed_;
};

std::vector<Listed> AllFields() {
  Lister lister;
  const StatusReport report;
  VisitStatus(report, lister);
  return lister.listed();
}

// Sums up the sizes of the members that are visited, to be held against the struct's.
class MemberBytes {
 public:
  void BeginGroup(const char*) {}
  template <typename Value>
  void operator()(const char*, FieldKind, Concern, const Value& value) {
    seen_.insert(&value);
    bytes_ += sizeof(value);
  }
  size_t bytes() const { return bytes_; }
  size_t count() const { return seen_.size(); }

 private:
  std::set<const void*> seen_;
  size_t bytes_ = 0;
};

TEST(StatusReport, EveryNameIsThereOnce) {
  std::set<std::string> names;
  for (const Listed& field : AllFields()) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
  }
  EXPECT_GT(names.size(), 200u);
}

// Parts without gaps between their members: a member that the table leaves out is missed here.
TEST(StatusReport, TheTableNamesEveryMemberOfTheCounters) {
  const StatusReport report;
  const auto expect_whole = [](const auto& part, auto visit_part) {
    MemberBytes members;
    visit_part(part, members);
    EXPECT_EQ(members.bytes(), sizeof(part));
  };
  expect_whole(report.can.bus, [](auto& p, auto& v) { VisitBusCounters(p, v); });
  expect_whole(report.lidar_packets, [](auto& p, auto& v) { VisitLidarPackets(p, v); });
  expect_whole(report.mapper, [](auto& p, auto& v) { VisitMapper(p, v); });
  expect_whole(report.lidar_socket, [](auto& p, auto& v) { VisitSocket(p, v); });
  expect_whole(report.loop, [](auto& p, auto& v) { VisitLoop(p, v); });
  expect_whole(report.replan, [](auto& p, auto& v) { VisitReplan(p, v); });
  expect_whole(report.recorder, [](auto& p, auto& v) { VisitRecorder(p, v); });
  expect_whole(report.control, [](auto& p, auto& v) { VisitControl(p, v); });
  expect_whole(report.inputs, [](auto& p, auto& v) { VisitInputs(p, v); });
  // A flag, and what fills it up to the counters' alignment.
  const auto expect_but_flag = [](const auto& part, auto visit_part) {
    MemberBytes members;
    visit_part(part, members);
    EXPECT_EQ(members.bytes() + sizeof(uint64_t) - sizeof(bool), sizeof(part));
  };
  expect_but_flag(report.ins_stream, [](auto& p, auto& v) { VisitInsStream(p, v); });
  expect_but_flag(report.pose_datagrams, [](auto& p, auto& v) { VisitPoseDatagrams(p, v); });
  MemberBytes all;
  VisitStatus(report, all);
  EXPECT_EQ(all.count(), AllFields().size()) << "a member is named twice";
}

TEST(StatusReport, FieldsLieInTheOrderOfTheTable) {
  StatusReport report;
  report.program.tick_index = 0x1122334455667788u;
  report.vehicle.mode = 2;
  report.vehicle.x_m = 1.0f;
  report.ins.latitude_ndeg = -2;
  report.left_drive.heatsink_degC = -3;
  report.can.bus.bus_offs = 9;
  report.inputs.lidar_age = {5, 6};
  Bytes bytes;
  ASSERT_EQ(TryEncode(report, 0xabcdu, bytes), Status::kOk);
  std::map<std::string, size_t> at;
  for (const Listed& field : AllFields()) at[field.name] = field.offset;
  const auto part = [&](const char* name, size_t size) {
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at.at(name));
    return Bytes(begin, begin + static_cast<std::ptrdiff_t>(size));
  };
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 6), (Bytes{0x48, 0x50, 0x43, 0x54, 1, 129}));
  EXPECT_EQ(bytes[6] | bytes[7] << 8, static_cast<int>(bytes.size()));
  EXPECT_EQ(Bytes(bytes.begin() + 8, bytes.begin() + 12), (Bytes{0xcd, 0xab, 0, 0}));
  EXPECT_EQ(part("program.tick_index", 8), (Bytes{0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11}));
  EXPECT_EQ(part("vehicle.mode", 1), (Bytes{2}));
  EXPECT_EQ(part("vehicle.x_m", 4), (Bytes{0, 0, 0x80, 0x3f}));
  EXPECT_EQ(part("ins.latitude_ndeg", 8), (Bytes{0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}));
  EXPECT_EQ(part("left_drive.heatsink_degC", 4), (Bytes{0xfd, 0xff, 0xff, 0xff}));
  EXPECT_EQ(part("can.bus_offs", 8), (Bytes{9, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(part("inputs.lidar_age", 16), (Bytes{5, 0, 0, 0, 0, 0, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0}));
  const Listed last = AllFields().back();
  EXPECT_EQ(bytes.size(), last.offset + last.bytes);
  EXPECT_LE(bytes.size(), static_cast<size_t>(kMaxMessageBytes));
}

TEST(StatusReport, ComesBackAsItWas) {
  const uint32_t seed = 54;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  StatusReport decoded;
  for (int i = 0; i < 300; ++i) {
    const StatusReport report = RandomReport(random);
    Bytes bytes;
    ASSERT_EQ(TryEncode(report, static_cast<uint32_t>(i), bytes), Status::kOk);
    Header header;
    ASSERT_EQ(ReadHeader(bytes, header), Status::kOk);
    EXPECT_EQ(header.kind, Kind::kStatus);
    EXPECT_EQ(header.sequence, static_cast<uint32_t>(i));
    ASSERT_EQ(Decode(bytes, decoded), Status::kOk);
    ASSERT_EQ(BitsOf(decoded), BitsOf(report));
  }
}

TEST(StatusReport, EveryTruncationIsTold) {
  std::mt19937 random(55);
  Bytes bytes;
  ASSERT_EQ(TryEncode(RandomReport(random), 1, bytes), Status::kOk);
  const StatusReport before = RandomReport(random);
  for (size_t size = 0; size < bytes.size(); ++size) {
    StatusReport report = before;
    ASSERT_EQ(Decode(std::span(bytes).first(size), report), Status::kTruncated) << size;
    Bytes resized(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    if (size >= kHeaderBytes) {
      resized[6] = static_cast<uint8_t>(size);
      resized[7] = static_cast<uint8_t>(size >> 8);
    }
    ASSERT_EQ(Decode(resized, report), Status::kTruncated) << size;
    ASSERT_EQ(BitsOf(report), BitsOf(before)) << size;
    int size_bytes = -1;
    Bytes small(size);
    ASSERT_EQ(Encode(before, 1, small, size_bytes), Status::kCapacityExceeded) << size;
    ASSERT_EQ(size_bytes, 0);
  }
  StatusReport report;
  bytes.push_back(0);
  EXPECT_EQ(Decode(bytes, report), Status::kOversized);
  bytes[6] = static_cast<uint8_t>(bytes.size());
  bytes[7] = static_cast<uint8_t>(bytes.size() >> 8);
  EXPECT_EQ(Decode(bytes, report), Status::kOversized);
}

TEST(StatusReport, FlagsAndTextsAreChecked) {
  std::mt19937 random(56);
  Bytes good;
  ASSERT_EQ(TryEncode(RandomReport(random), 1, good), Status::kOk);
  StatusReport report;
  ASSERT_EQ(Decode(good, report), Status::kOk);
  const Bytes before = BitsOf(report);
  for (const Listed& field : AllFields()) {
    if (!field.is_flag && !field.is_text) continue;
    SCOPED_TRACE(field.name);
    for (const int byte : {2, 27, 128, 255}) {
      Bytes bytes = good;
      bytes[field.offset] = static_cast<uint8_t>(byte);
      EXPECT_EQ(Decode(bytes, report), Status::kInvalidArgument) << byte;
      EXPECT_EQ(BitsOf(report), before);
    }
    if (!field.is_text) continue;
    Bytes endless = good;
    std::fill_n(endless.begin() + static_cast<std::ptrdiff_t>(field.offset), field.bytes, 'x');
    EXPECT_EQ(Decode(endless, report), Status::kInvalidArgument);
  }
  StatusReport endless = report;
  std::memset(endless.program.version, 'x', sizeof(endless.program.version));
  EXPECT_EQ(TryEncode(endless, 1, good), Status::kInvalidArgument);
}

TEST(StatusReport, OfAProgramWithAnotherTableIsToldAsSuch) {
  Bytes bytes;
  ASSERT_EQ(TryEncode(StatusReport{}, 1, bytes), Status::kOk);
  StatusReport report;
  for (size_t i = kHeaderBytes; i < kHeaderBytes + 4; ++i) {
    Bytes other = bytes;
    other[i] ^= 1;
    EXPECT_EQ(Decode(other, report), Status::kUnsupported);
  }
  Bytes done;
  ASSERT_EQ(TryEncode(Done{}, done), Status::kOk);
  EXPECT_EQ(Decode(done, report), Status::kWrongPacketType);
}

TEST(StatusReport, AgesAreFromThenToNow) {
  EXPECT_EQ(AgeAt(100, 0), (Age{Age::kNever, 0}));
  EXPECT_EQ(AgeAt(100, 40, 50), (Age{60, 50}));
  EXPECT_EQ(AgeAt(100, 100), (Age{0, 0}));
  EXPECT_EQ(AgeAt(100, 101), (Age{0, 0}));
}

}  // namespace
}  // namespace hardpack::control
