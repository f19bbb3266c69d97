// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/flight_log/flight_log.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/base/crc32.h"
#include "test/fakes/memory_recorder.h"
#include "test/hal/onboard/flight_log/made_up_run.h"

namespace hardpack::flight_log {
namespace {

using fakes::MadeUpRun;
using fakes::MadeUpTick;
using fakes::MemoryRecorder;

bool IsDatagram(const MemoryRecorder::Packet& packet) {
  return packet.bytes[0] == 0x08 && packet.bytes[1] == 0x00;
}

std::span<const uint8_t> PayloadOf(const MemoryRecorder::Packet& packet) {
  return std::span(packet.bytes).subspan(kDatagramHeadBytes);
}

// "V" version, "C", "M" parts of texts, "I" part of the image, "[" "]" a tick's records, "f" a
// frame in, "o" one out, "d" a datagram, "c" a command, "E" the end.
std::string OrderOf(const MemoryRecorder::File& file) {
  std::string order;
  for (const MemoryRecorder::Packet& packet : file) {
    if (!IsDatagram(packet)) {
      order += packet.bytes[10] == static_cast<uint8_t>(Direction::kOut) ? 'o' : 'f';
      continue;
    }
    constexpr std::string_view kLetters = "dVCMI[c]GE";
    order += kLetters[static_cast<size_t>(KindOf(PayloadOf(packet)))];
  }
  return order;
}

std::string OrderOf(const MadeUpTick& tick, const std::string& image_parts = "") {
  return "[" + std::string(tick.frames.size(), 'f') + std::string(tick.datagrams.size(), 'd') +
         (tick.command.empty() ? "" : "c") +
         std::string(static_cast<size_t>(tick.output.frames.size()), 'o') + image_parts + "]";
}

TEST(FlightLog, OpensAFileAndLogsTicksInOrder) {
  MemoryRecorder recorder;
  MadeUpRun run(recorder);
  std::string expected = "VCCCM";  // 70,012 bytes of configuration are three parts
  for (int i = 0; i < 50; ++i) expected += OrderOf(run.Tick());
  run.log().End();
  ASSERT_EQ(recorder.files().size(), 1u);
  EXPECT_EQ(OrderOf(recorder.files()[0]), expected + "E");
}

TEST(FlightLog, HandsOutTheImageWithTheTicksOfALaterFile) {
  MemoryRecorder recorder(1'000'000);
  MadeUpRun run(recorder);  // its state of 300,000 bytes is ten parts: 4, 4 and 2
  std::vector<uint8_t> state;
  MadeUpTick last;
  std::vector<MadeUpTick> ticks;
  while (recorder.files().size() < 2) {
    state = run.state();
    if (!ticks.empty()) last = ticks.back();
    ticks = {run.Tick()};
  }
  for (int i = 0; i < 4; ++i) ticks.push_back(run.Tick());
  EXPECT_EQ(OrderOf(recorder.files()[1]), "VCCCM" + OrderOf(ticks[0], "IIII") +
                                              OrderOf(ticks[1], "IIII") + OrderOf(ticks[2], "II") +
                                              OrderOf(ticks[3]) + OrderOf(ticks[4]));
  VersionRecord version;
  ASSERT_EQ(Decode(PayloadOf(recorder.files()[1][0]), version), Status::kOk);
  EXPECT_EQ(version.file, 1u);
  EXPECT_EQ(version.next_tick, last.index + 1);
  EXPECT_EQ(version.state_bytes, 300'000u);
  EXPECT_EQ(version.state_layout, MadeUpRun::kStateLayout);
  EXPECT_STREQ(version.vehicle, "made up");

  std::vector<uint8_t> image;
  uint32_t crc = 0;
  for (const MemoryRecorder::Packet& packet : recorder.files()[1]) {
    ImageRecord part;
    if (!IsDatagram(packet) || !IsUsable(Decode(PayloadOf(packet), part))) continue;
    EXPECT_EQ(part.index, last.index);
    EXPECT_EQ(part.offset, image.size());
    EXPECT_EQ(part.whole_bytes, 300'000u);
    image.insert(image.end(), part.bytes.begin(), part.bytes.end());
    crc = ExtendCrc32<kMaxPartBytes>(crc, part.bytes);
    EXPECT_EQ(part.crc, crc);
  }
  EXPECT_EQ(image, state);  // as it was before the file's first tick
}

TEST(FlightLog, DoesWithoutAnImageWhereThereIsNoRoomForIt) {
  MemoryRecorder recorder(200'000);
  std::vector<uint8_t> small(100);
  FlightLog log(recorder, small);
  ASSERT_EQ(log.Start({}), Status::kOk);
  const std::vector<uint8_t> state(101);
  const std::vector<uint8_t> packet(30'000);
  const TickDatagram datagram = {InputSource::kLidar, packet};
  for (uint64_t i = 1; i <= 10; ++i) {
    log.BeginTick({i, i, CanBusState::kDown, std::span(&datagram, 1), {}, {}}, {},
                  std::as_bytes(std::span(state)));
    log.EndTick({i, Status::kOk, 0, 0, 0}, {});
  }
  ASSERT_EQ(recorder.files().size(), 2u);
  EXPECT_EQ(OrderOf(recorder.files()[1]).substr(0, 6), "VCM[d]");
}

TEST(FlightLog, StampsPacketsByTheKernelOrByTheTick) {
  MemoryRecorder recorder;
  FlightLog log(recorder, {});
  FlightLogSetup setup;
  setup.wall_clock_offset_ns = 1'000'000'000'000;
  setup.sender[2] = {0x0a000005u, 7502};
  ASSERT_EQ(log.Start(setup), Status::kOk);
  const std::vector<uint8_t> bytes = {1, 2, 3};
  const std::vector<TickDatagram> datagrams(4, {InputSource::kLidar, bytes});
  const int64_t tick_ns = 1'010'000'000'000;
  const std::vector<Arrival> arrivals = {{tick_ns - 1, {1, 2}},
                                         {0, {1, 2}},
                                         {tick_ns + 1, {1, 2}},
                                         {tick_ns - FlightLog::kMaxStampAge_ns - 1, {1, 2}}};
  log.BeginTick({1, 10'000'000'000, CanBusState::kDown, datagrams, {}, {}}, {arrivals, 0}, {});
  log.BeginTick({1, 10'000'000'000, CanBusState::kDown, datagrams, {}, {}}, {}, {});
  std::vector<int64_t> times_ns;
  std::vector<uint8_t> senders;
  for (const MemoryRecorder::Packet& packet : recorder.files()[0]) {
    if (KindOf(PayloadOf(packet)) != RecordKind::kNone) continue;
    times_ns.push_back(packet.time_ns);
    senders.push_back(packet.bytes[35]);
  }
  EXPECT_EQ(times_ns, (std::vector<int64_t>{tick_ns - 1, tick_ns, tick_ns, tick_ns, tick_ns,
                                            tick_ns, tick_ns, tick_ns}));
  EXPECT_EQ(senders, (std::vector<uint8_t>{1, 1, 1, 1, 5, 5, 5, 5}));
}

TEST(FlightLog, RecordsNothingWithoutAStart) {
  MemoryRecorder recorder;
  FlightLog log(recorder, {});
  log.BeginTick({}, {}, {});
  log.EndTick({}, {});
  log.End();
  std::vector<uint8_t> text(FlightLog::kMaxTextBytes + 1);
  FlightLogSetup setup;
  setup.configuration = text;
  EXPECT_EQ(log.Start(setup), Status::kOversized);
  log.BeginTick({}, {}, {});
  EXPECT_EQ(recorder.counters().records, 0u);
}

// SR-LOG03
TEST(FlightLog, GoesOnWhereTheRecorderHasNoRoom) {
  MemoryRecorder recorder(UINT64_MAX, 300'000);
  MadeUpRun run(recorder);
  for (int i = 0; i < 100; ++i) run.Tick();
  EXPECT_GT(recorder.counters().dropped, 0u);
  EXPECT_LE(recorder.counters().bytes, 300'000u);
}

}  // namespace
}  // namespace hardpack::flight_log
