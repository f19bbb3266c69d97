// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/packet_monitor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "test/hal/ouster/ouster_packets.h"

namespace hardpack::ouster {
namespace {

constexpr uint32_t kInitId = 0x111111;
constexpr uint64_t kSerialNumber = 0x2222222222;
constexpr int kPacketsPerFrame = 32;

// 16 beams, 512 columns in 32 packets: small, but as a sensor's.
Metadata SmallSensor(Profile profile = Profile::kRng15Rfl8Nir8) {
  Metadata metadata;
  metadata.profile = profile;
  metadata.beams = 16;
  metadata.columns_per_frame = 512;
  metadata.columns_per_packet = 16;
  metadata.column_window_last = 511;
  metadata.init_id = kInitId;
  metadata.serial_number = kSerialNumber;
  return metadata;
}

// The packet at a place of the stream: number 0 is the first of frame 0; frame ids wrap.
std::vector<uint8_t> PacketAt(int64_t number, Profile profile = Profile::kRng15Rfl8Nir8,
                              uint32_t init_id = kInitId, uint64_t serial = kSerialNumber) {
  const auto frame_id = static_cast<uint16_t>(number / kPacketsPerFrame);
  std::vector<LidarColumn> columns(16);
  for (int i = 0; i < 16; ++i) {
    LidarColumn& column = columns[static_cast<size_t>(i)];
    column.beams = 16;
    column.frame_id = frame_id;
    column.measurement_id = static_cast<uint16_t>(number % kPacketsPerFrame * 16 + i);
    column.status = 0xffffffffu;
  }
  return test::Encode(profile, {1, frame_id, init_id, serial}, columns);
}

uint64_t SumOf(const PacketCounters& c) {
  return c.accepted + c.wrong_size + c.wrong_type + c.bad_crc + c.wrong_sensor + c.not_resumed +
         c.before_start + c.duplicates;
}

class OusterPacketMonitor : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(monitor_.Configure(SmallSensor()), Status::kOk); }
  Status Give(int64_t number) { return monitor_.Check(PacketAt(number), header_); }
  Status Give(int64_t number, uint32_t init_id, uint64_t serial = kSerialNumber) {
    return monitor_.Check(PacketAt(number, Profile::kRng15Rfl8Nir8, init_id, serial), header_);
  }
  const PacketCounters& counters() const { return monitor_.counters(); }

  PacketMonitor monitor_;
  PacketHeader header_;
};

TEST_F(OusterPacketMonitor, CountsNothingAmissInAWholeStream) {
  // Over the end of the frame counter.
  const int64_t first = 65534 * kPacketsPerFrame + 7;
  for (int64_t number = first; number < first + 200; ++number) {
    ASSERT_EQ(Give(number), Status::kOk);
    EXPECT_EQ(header_.frame_id, static_cast<uint16_t>(number / kPacketsPerFrame));
  }
  EXPECT_EQ(counters().accepted, 200u);
  EXPECT_EQ(SumOf(counters()), 200u);
  EXPECT_EQ(counters().missing, 0u);
  EXPECT_EQ(counters().out_of_order, 0u);
  EXPECT_EQ(counters().jumps, 0u);
  EXPECT_EQ(counters().unplaced, 0u);
  EXPECT_EQ(counters().restarts, 0u);
}

//   came     30 31 | 0 . . 3 | (a whole frame) | 5
//   missing              2     28 + 32 + 5
TEST_F(OusterPacketMonitor, CountsWhatIsMissingWithinAndAcrossFrames) {
  for (const int64_t number : {30, 31, 32, 35, 3 * kPacketsPerFrame + 5}) {
    ASSERT_EQ(Give(number), Status::kOk);
  }
  EXPECT_EQ(counters().missing, 2u + 28u + 32u + 5u);
  EXPECT_EQ(counters().accepted, 5u);
  EXPECT_EQ(counters().jumps, 0u);
}

// SR-INP01
TEST_F(OusterPacketMonitor, RefusesDuplicates) {
  EXPECT_EQ(Give(100), Status::kOk);
  EXPECT_EQ(Give(100), Status::kDuplicate);
  EXPECT_EQ(Give(103), Status::kOk);
  EXPECT_EQ(Give(100), Status::kDuplicate);
  EXPECT_EQ(Give(101), Status::kOk);
  EXPECT_EQ(Give(101), Status::kDuplicate);
  EXPECT_EQ(Give(103 + 63), Status::kOk);
  EXPECT_EQ(Give(103), Status::kDuplicate) << "63 places back";
  EXPECT_EQ(counters().duplicates, 4u);
  EXPECT_EQ(counters().accepted, 4u);
  EXPECT_EQ(counters().missing, 1u + 62u);
}

// It remembers 64 places: what came before says nothing of those that are new.
TEST_F(OusterPacketMonitor, RemembersNothingAcrossALossOfAllThatItRemembers) {
  for (const int64_t loss : {63, 64, 65}) {
    ASSERT_EQ(monitor_.Configure(SmallSensor()), Status::kOk);
    EXPECT_EQ(Give(100), Status::kOk);
    EXPECT_EQ(Give(101), Status::kOk);
    const int64_t newest = 101 + loss;
    EXPECT_EQ(Give(newest), Status::kOk);
    constexpr int64_t kLate = 62;  // all that lie between where the loss is smallest
    for (int64_t back = 1; back <= kLate; ++back) {
      EXPECT_EQ(Give(newest - back), Status::kOk) << loss << ' ' << back;
    }
    EXPECT_EQ(counters().missing, static_cast<uint64_t>(loss - 1 - kLate));
    EXPECT_EQ(counters().duplicates, 0u);
  }
}

TEST_F(OusterPacketMonitor, TakesLatePacketsOffTheMissing) {
  EXPECT_EQ(Give(kPacketsPerFrame - 2), Status::kOk);
  EXPECT_EQ(Give(kPacketsPerFrame + 3), Status::kOk);
  EXPECT_EQ(counters().missing, 4u);
  EXPECT_EQ(Give(kPacketsPerFrame - 1), Status::kOk);  // of the frame before
  EXPECT_EQ(Give(kPacketsPerFrame + 1), Status::kOk);
  EXPECT_EQ(counters().missing, 2u);
  EXPECT_EQ(counters().out_of_order, 2u);
  // What comes from before the first was never missing.
  EXPECT_EQ(Give(kPacketsPerFrame - 3), Status::kOk);
  EXPECT_EQ(counters().missing, 2u);
  EXPECT_EQ(counters().out_of_order, 3u);
  EXPECT_EQ(Give(kPacketsPerFrame - 3), Status::kDuplicate);
}

TEST_F(OusterPacketMonitor, TellsALossFromAJump) {
  const int64_t most = int64_t{PacketMonitor::kMaxFrameGap} * kPacketsPerFrame;
  ASSERT_EQ(Give(0), Status::kOk);
  ASSERT_EQ(Give(most), Status::kOk);
  EXPECT_EQ(counters().missing, static_cast<uint64_t>(most - 1));
  EXPECT_EQ(counters().jumps, 0u);
  ASSERT_EQ(Give(2 * most + kPacketsPerFrame), Status::kOk);
  EXPECT_EQ(counters().jumps, 1u);
  ASSERT_EQ(Give(3), Status::kOk) << "the counter began anew";
  EXPECT_EQ(counters().jumps, 2u);
  ASSERT_EQ(Give(4), Status::kOk);
  EXPECT_EQ(counters().missing, static_cast<uint64_t>(most - 1));
  EXPECT_EQ(counters().accepted, 5u);
}

// Loss, duplicates and delays of at most 60 places, against a list of what was given.
TEST_F(OusterPacketMonitor, AgreesWithAListOnADisturbedStream) {
  for (unsigned seed = 7301; seed < 7309; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    ASSERT_EQ(monitor_.Configure(SmallSensor()), Status::kOk);
    const int64_t start = static_cast<int64_t>(random() % 65536) * kPacketsPerFrame;
    std::vector<std::pair<int64_t, int64_t>> arrivals;  // when, which
    for (int64_t number = start; number < start + 2000; ++number) {
      if (random() % 8 == 0) continue;
      const bool delayed = random() % 8 == 0;
      arrivals.emplace_back(number + (delayed ? static_cast<int64_t>(random() % 60) : 0), number);
      if (random() % 8 == 0) arrivals.emplace_back(number + 1, number);
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::set<int64_t> came;
    uint64_t duplicates = 0;
    uint64_t late = 0;
    for (const auto& [when, number] : arrivals) {
      const bool is_new = came.count(number) == 0;
      if (!is_new) ++duplicates;
      if (is_new && !came.empty() && number < *came.rbegin()) ++late;
      ASSERT_EQ(Give(number), is_new ? Status::kOk : Status::kDuplicate);
      came.insert(number);
    }
    EXPECT_EQ(counters().accepted, came.size());
    EXPECT_EQ(counters().duplicates, duplicates);
    EXPECT_EQ(counters().out_of_order, late);
    EXPECT_EQ(counters().jumps, 0u);
    // Places before the first to come are not known to be missing.
    const int64_t first = arrivals.front().second;
    const auto before = static_cast<uint64_t>(std::distance(came.begin(), came.find(first)));
    EXPECT_EQ(counters().missing,
              static_cast<uint64_t>(*came.rbegin() - first + 1) - (came.size() - before));
  }
}

// SR-INP01
TEST_F(OusterPacketMonitor, RefusesANewStartUntilItIsResumed) {
  constexpr uint32_t kSecond = 0x111112;
  constexpr uint32_t kThird = 0x111113;
  ASSERT_EQ(Give(1000), Status::kOk);
  EXPECT_FALSE(monitor_.restarted());
  EXPECT_EQ(Give(0, kSecond), Status::kSensorRestarted);
  EXPECT_EQ(header_.init_id, kSecond);
  EXPECT_EQ(Give(1, kSecond), Status::kSensorRestarted);
  EXPECT_TRUE(monitor_.restarted());
  EXPECT_EQ(counters().restarts, 1u);
  EXPECT_EQ(counters().not_resumed, 2u);
  EXPECT_EQ(Give(1001), Status::kOk) << "of the old start, and still on its way";

  monitor_.Resume();
  EXPECT_FALSE(monitor_.restarted());
  EXPECT_EQ(monitor_.identity().init_id, kSecond);
  EXPECT_EQ(Give(2, kSecond), Status::kOk);
  EXPECT_EQ(Give(1002), Status::kLate) << "of the old start: no other restart";
  EXPECT_EQ(Give(3, kSecond), Status::kOk);
  EXPECT_EQ(counters().before_start, 1u);
  EXPECT_EQ(counters().restarts, 1u);
  EXPECT_EQ(counters().missing, 0u) << "the count of the new start has nothing to do with the old";
  EXPECT_EQ(counters().jumps, 0u);

  EXPECT_EQ(Give(0, kThird), Status::kSensorRestarted);
  EXPECT_EQ(counters().restarts, 2u);
  monitor_.Resume();
  monitor_.Resume();  // nothing to resume
  EXPECT_EQ(Give(1, kThird), Status::kOk);
  EXPECT_EQ(Give(4, kSecond), Status::kLate);
  EXPECT_EQ(SumOf(counters()), 10u);
}

TEST_F(OusterPacketMonitor, LearnsWhomItFollows) {
  Metadata metadata = SmallSensor();
  metadata.init_id = 0;
  metadata.serial_number = 0;
  ASSERT_EQ(monitor_.Configure(metadata), Status::kOk);
  EXPECT_EQ(monitor_.identity().serial_number, 0u);
  EXPECT_EQ(Give(10, 5, 77), Status::kOk);
  EXPECT_EQ(monitor_.identity().init_id, 5u);
  EXPECT_EQ(monitor_.identity().serial_number, 77u);
  EXPECT_EQ(Give(11, 5, 78), Status::kWrongSensor) << "another sensor on the same port";
  EXPECT_EQ(Give(11, 6, 77), Status::kSensorRestarted);
  EXPECT_EQ(Give(11, 5, 77), Status::kOk);
}

// SR-INP01
TEST_F(OusterPacketMonitor, CountsEachKindOfRefusal) {
  Metadata metadata = SmallSensor();
  metadata.crc_in_footer = true;
  ASSERT_EQ(monitor_.Configure(metadata), Status::kOk);
  std::vector<uint8_t> packet = PacketAt(0);
  test::SetCrc(packet);
  EXPECT_EQ(monitor_.Check(packet, header_), Status::kOk);

  std::vector<uint8_t> damaged = packet;
  damaged[500] ^= 1;
  EXPECT_EQ(monitor_.Check(damaged, header_), Status::kBadCrc);
  damaged = packet;
  damaged[4] ^= 1;  // the init id: damage, no restart
  EXPECT_EQ(monitor_.Check(damaged, header_), Status::kBadCrc);
  damaged = packet;
  damaged[0] = 2;
  EXPECT_EQ(monitor_.Check(damaged, header_), Status::kWrongPacketType);
  EXPECT_EQ(monitor_.Check({packet.data(), packet.size() - 1}, header_), Status::kTruncated);
  EXPECT_EQ(monitor_.Check({}, header_), Status::kTruncated);
  std::vector<uint8_t> longer = packet;
  longer.push_back(0);
  EXPECT_EQ(monitor_.Check(longer, header_), Status::kOversized);
  std::vector<uint8_t> foreign = PacketAt(0, metadata.profile, kInitId, 99);
  test::SetCrc(foreign);
  EXPECT_EQ(monitor_.Check(foreign, header_), Status::kWrongSensor);

  EXPECT_EQ(counters().accepted, 1u);
  EXPECT_EQ(counters().bad_crc, 2u);
  EXPECT_EQ(counters().wrong_type, 1u);
  EXPECT_EQ(counters().wrong_size, 3u);
  EXPECT_EQ(counters().wrong_sensor, 1u);
  EXPECT_EQ(counters().restarts, 0u);
  EXPECT_EQ(SumOf(counters()), 8u);
}

//   window [40, 90] of 512: packets 2 .. 5 of each frame are sent
//   window [480, 20]:       packets 0, 1, 30 and 31
//   window [100, 99]:       all, though it begins and ends in packet 6
TEST_F(OusterPacketMonitor, KnowsWhichPacketsAWindowHas) {
  struct Case {
    int first, last;
    std::vector<int> sent;
  };
  std::vector<int> all(kPacketsPerFrame);
  for (int i = 0; i < kPacketsPerFrame; ++i) all[static_cast<size_t>(i)] = i;
  const Case cases[] = {{40, 90, {2, 3, 4, 5}},
                        {480, 20, {0, 1, 30, 31}},
                        {100, 99, all},
                        {96, 96, {6}},
                        {0, 0, {0}}};
  for (const Case& one : cases) {
    SCOPED_TRACE(one.first);
    Metadata metadata = SmallSensor();
    metadata.column_window_first = one.first;
    metadata.column_window_last = one.last;
    ASSERT_EQ(monitor_.Configure(metadata), Status::kOk);
    for (int frame = 10; frame < 14; ++frame) {
      for (const int packet : one.sent) {
        ASSERT_EQ(Give(frame * kPacketsPerFrame + packet), Status::kOk);
      }
    }
    EXPECT_EQ(counters().missing, 0u);
    EXPECT_EQ(counters().unplaced, 0u);
    // A frame and the first of the next but one are lost.
    for (size_t i = 1; i < one.sent.size(); ++i) {
      ASSERT_EQ(Give(15 * kPacketsPerFrame + one.sent[i]), Status::kOk);
    }
    if (one.sent.size() > 1) {
      EXPECT_EQ(counters().missing, one.sent.size() + 1);
    }
    EXPECT_EQ(counters().out_of_order, 0u);
    EXPECT_EQ(counters().jumps, 0u);
    if (one.sent.size() == all.size()) continue;
    // One that the window does not have is let through, and is no part of the order.
    const PacketCounters before = counters();
    ASSERT_EQ(Give(17 * kPacketsPerFrame + 15), Status::kOk);
    ASSERT_EQ(Give(17 * kPacketsPerFrame + 15), Status::kOk);
    EXPECT_EQ(counters().unplaced, 2u);
    EXPECT_EQ(counters().missing, before.missing);
  }
}

TEST_F(OusterPacketMonitor, FollowsLegacyPacketsByTheirColumns) {
  ASSERT_EQ(monitor_.Configure(SmallSensor(Profile::kLegacy)), Status::kOk);
  const auto give = [this](int64_t number) {
    return monitor_.Check(PacketAt(number, Profile::kLegacy), header_);
  };
  EXPECT_EQ(give(20000), Status::kOk);
  EXPECT_EQ(give(20003), Status::kOk);
  EXPECT_EQ(give(20002), Status::kOk);
  EXPECT_EQ(give(20002), Status::kDuplicate);
  EXPECT_EQ(counters().missing, 1u);
  // Started anew, which only the counting shows.
  EXPECT_EQ(give(5), Status::kOk);
  EXPECT_EQ(give(6), Status::kOk);
  EXPECT_EQ(counters().jumps, 1u);
  EXPECT_EQ(counters().restarts, 0u);
  EXPECT_EQ(counters().missing, 1u);
}

TEST_F(OusterPacketMonitor, LetsThroughWhatItCannotNumber) {
  Metadata metadata = SmallSensor();
  metadata.columns_per_packet = 10;  // does not divide 512
  ASSERT_EQ(monitor_.Configure(metadata), Status::kOk);
  std::vector<LidarColumn> columns(10);
  for (LidarColumn& column : columns) column.beams = 16;
  const std::vector<uint8_t> packet =
      test::Encode(metadata.profile, {1, 0, kInitId, kSerialNumber}, columns);
  EXPECT_EQ(monitor_.Check(packet, header_), Status::kOk);
  EXPECT_EQ(monitor_.Check(packet, header_), Status::kOk);
  EXPECT_EQ(counters().unplaced, 2u);

  // Measurement ids off the packets' raster or beyond the revolution.
  ASSERT_EQ(monitor_.Configure(SmallSensor()), Status::kOk);
  for (const unsigned id : {1u, 511u, 512u, 65535u}) {
    std::vector<uint8_t> odd = PacketAt(0);
    odd[32 + 8] = static_cast<uint8_t>(id);
    odd[32 + 9] = static_cast<uint8_t>(id >> 8);
    EXPECT_EQ(monitor_.Check(odd, header_), Status::kOk);
  }
  EXPECT_EQ(counters().unplaced, 4u);
  EXPECT_EQ(counters().missing, 0u);
}

TEST_F(OusterPacketMonitor, AcceptsNothingUnlessConfigured) {
  PacketMonitor fresh;
  EXPECT_EQ(fresh.Check(PacketAt(0), header_), Status::kNotStarted);
  fresh.Resume();
  EXPECT_EQ(SumOf(fresh.counters()), 0u);

  ASSERT_EQ(Give(0), Status::kOk);
  Metadata metadata = SmallSensor();
  metadata.beams = 0;
  EXPECT_EQ(monitor_.Configure(metadata), Status::kInvalidArgument);
  EXPECT_EQ(Give(1), Status::kNotStarted);
  EXPECT_EQ(counters().accepted, 0u);
  for (const auto& [first, last] : {std::pair{-1, 511}, {512, 511}, {0, 512}, {0, INT32_MIN}}) {
    metadata = SmallSensor();
    metadata.column_window_first = first;
    metadata.column_window_last = last;
    EXPECT_EQ(monitor_.Configure(metadata), Status::kInvalidArgument);
    EXPECT_EQ(Give(1), Status::kNotStarted);
  }
  EXPECT_EQ(monitor_.Configure(SmallSensor()), Status::kOk);
  EXPECT_EQ(Give(0), Status::kOk);
}

// Whatever comes: every packet is counted once, and the order's counters stay within reason.
TEST_F(OusterPacketMonitor, KeepsItsBooksOnRandomPackets) {
  const unsigned seed = 7302;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  uint64_t given = 0;
  for (int round = 0; round < 8000; ++round) {
    std::vector<uint8_t> packet = PacketAt(static_cast<int64_t>(random() % 200));
    if (random() % 4 == 0) packet[random() % 42] ^= static_cast<uint8_t>(1u << random() % 8);
    if (random() % 50 == 0) packet.resize(random() % packet.size());
    if (random() % 200 == 0) monitor_.Resume();
    (void)monitor_.Check(packet, header_);
    ASSERT_EQ(SumOf(counters()), ++given);
    const uint64_t order = counters().out_of_order + counters().jumps + counters().unplaced;
    ASSERT_LE(order, counters().accepted);
    // At most kMaxFrameGap frames and one are skipped at once; a count taken below 0 would be huge.
    ASSERT_LE(counters().missing,
              counters().accepted * (PacketMonitor::kMaxFrameGap + 1) * kPacketsPerFrame);
  }
  EXPECT_GT(counters().accepted, 1000u);
}

}  // namespace
}  // namespace hardpack::ouster
