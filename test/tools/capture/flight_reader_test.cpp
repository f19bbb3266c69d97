// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/flight_reader.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "test/fakes/memory_recorder.h"
#include "test/hal/onboard/flight_log/made_up_run.h"
#include "test/port_linux/log_files.h"

namespace hardpack::capture {
namespace {

using fakes::LogDirectory;
using fakes::MadeUpRun;
using fakes::MadeUpTick;
using fakes::MemoryRecorder;
using Item = FlightReader::Item;

void WriteFile(const std::string& path, const std::vector<uint8_t>& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

void ExpectSame(const LoggedTick& logged, const MadeUpTick& tick) {
  ASSERT_EQ(logged.begin.index, tick.index);
  EXPECT_EQ(logged.begin.now_ns, tick.now_ns);
  EXPECT_EQ(logged.begin.bus, CanBusState::kActive);
  EXPECT_EQ(logged.time_ns, static_cast<int64_t>(tick.now_ns) + MadeUpRun::kWallOffset_ns);
  EXPECT_EQ(logged.end.decision_hash, tick.hash);
  EXPECT_EQ(logged.end.duration_ns, 123'456u);
  EXPECT_EQ(logged.end.refused, 1);
  EXPECT_EQ(logged.frames_in, tick.frames);
  for (size_t i = 0; i < tick.frames.size() && i < logged.frames_in.size(); ++i) {
    EXPECT_EQ(logged.frames_in[i].received_ns, tick.frames[i].received_ns);
  }
  EXPECT_EQ(logged.command, tick.command);
  EXPECT_EQ(logged.frames_out,
            std::vector<CanFrame>(tick.output.frames.begin(), tick.output.frames.end()));
  ASSERT_EQ(logged.datagrams.size(), tick.datagrams.size());
  for (size_t i = 0; i < tick.datagrams.size(); ++i) {
    EXPECT_EQ(logged.datagrams[i].source, tick.datagrams[i].source);
    EXPECT_EQ(logged.datagrams[i].sender, tick.arrivals[i].sender);
    EXPECT_EQ(logged.datagrams[i].bytes, tick.payloads[i]);
  }
}

TEST(FlightReader, GivesBackWhatWasLogged) {
  LogDirectory directory;
  MemoryRecorder recorder(1'000'000);
  MadeUpRun run(recorder);
  std::vector<MadeUpTick> ticks;
  std::vector<uint8_t> state;
  size_t first_of_second = 0;
  while (recorder.files().size() < 2 || ticks.size() < first_of_second + 10) {
    if (recorder.files().size() < 2) {
      state = run.state();
      first_of_second = ticks.size();
    }
    ticks.push_back(run.Tick());
  }
  run.log().End();
  size_t next = 0;
  for (size_t file = 0; file < 2; ++file) {
    const std::string path = directory.path() + "/log.pcap";
    WriteFile(path, MemoryRecorder::AsPcap(recorder.files()[file]));
    bool is_log = false;
    ASSERT_TRUE(FlightReader::IsFlightLog(path, is_log).ok());
    EXPECT_TRUE(is_log);
    FlightReader reader;
    ASSERT_TRUE(reader.Open(path).ok());
    LoggedTick tick;
    Item item = reader.Next(tick);
    for (; item == Item::kTick; item = reader.Next(tick)) ExpectSame(tick, ticks.at(next++));
    EXPECT_EQ(item, file == 0 ? Item::kFileEnd : Item::kEnd);
    EXPECT_EQ(reader.version().file, file);
    EXPECT_EQ(std::string(reader.configuration().bytes.begin(), reader.configuration().bytes.end()),
              run.configuration());
    EXPECT_TRUE(reader.configuration().whole);
    EXPECT_TRUE(reader.lidar_metadata().whole);
    EXPECT_EQ(reader.image().whole, file == 1);
    if (file == 0) continue;
    EXPECT_EQ(reader.image().bytes, state);
    EXPECT_EQ(reader.image_index(), ticks[first_of_second - 1].index);
  }
  EXPECT_EQ(next, ticks.size());
}

class DamagedLog : public ::testing::Test {
 protected:
  void SetUp() override {
    MadeUpRun run(recorder_, 40'000);
    for (int i = 0; i < 6; ++i) ticks_.push_back(run.Tick());
    run.log().End();
    bytes_ = MemoryRecorder::AsPcap(recorder_.files()[0]);
    WriteFile(path_, bytes_);
  }
  // How many ticks it gives, which are the first ones. `item`: what came then.
  size_t WholeTicks(Item& item) {
    FlightReader reader;
    item = Item::kFileEnd;
    if (!reader.Open(path_).ok()) return 0;
    LoggedTick tick;
    size_t count = 0;
    while ((item = reader.Next(tick)) == Item::kTick) {
      EXPECT_EQ(tick.end.decision_hash, ticks_.at(count).hash);
      ++count;
    }
    cut_ = reader.ends_within_tick() || !reader.outcome().ok();
    return count;
  }

  LogDirectory directory_;
  std::string path_ = directory_.path() + "/log.pcap";
  MemoryRecorder recorder_;
  std::vector<MadeUpTick> ticks_;
  std::vector<uint8_t> bytes_;
  bool cut_ = false;
};

TEST_F(DamagedLog, GivesWholeTicksWhereverItIsCut) {
  size_t before = ticks_.size();
  for (size_t size = bytes_.size(); size > 0; size -= size > bytes_.size() - 3000 ? 1 : 53) {
    std::filesystem::resize_file(path_, size);
    Item item = Item::kTick;
    const size_t count = WholeTicks(item);
    ASSERT_LE(count, before) << size;
    ASSERT_TRUE(item == Item::kFileEnd || item == Item::kEnd) << size;
    before = count;
    if (size <= 53) break;
  }
  EXPECT_EQ(before, 0u);
}

TEST_F(DamagedLog, SurvivesAnyFlippedBits) {
  std::mt19937 random(3);
  int noticed = 0;
  for (int i = 0; i < 1000; ++i) {
    std::vector<uint8_t> bytes = bytes_;
    for (int flips = 1 + i % 3; flips > 0; --flips) {
      bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
    }
    WriteFile(path_, bytes);
    FlightReader reader;
    if (!reader.Open(path_).ok()) continue;
    LoggedTick tick;
    Item item = Item::kTick;
    while (item != Item::kFileEnd && item != Item::kDamaged) item = reader.Next(tick);
    noticed += item == Item::kDamaged ? 1 : 0;
  }
  // Most flips fall into datagrams, which only their receiver can tell from others.
  EXPECT_GT(noticed, 0);
}

TEST_F(DamagedLog, SaysWhatIsMissing) {
  const auto without = [this](size_t index) {
    MemoryRecorder::File file = recorder_.files()[0];
    file.erase(file.begin() + static_cast<std::ptrdiff_t>(index));
    WriteFile(path_, MemoryRecorder::AsPcap(file));
    Item item = Item::kTick;
    WholeTicks(item);
    return item;
  };
  // Behind the version, four parts of texts and the last TickEnd every packet is missed.
  const size_t packets = recorder_.files()[0].size();
  for (size_t i = 5; i + 2 < packets; ++i) EXPECT_EQ(without(i), Item::kDamaged) << i;
  EXPECT_EQ(without(packets - 1), Item::kFileEnd);
}

TEST(FlightReader, TellsAGap) {
  LogDirectory directory;
  MemoryRecorder recorder;
  MadeUpRun run(recorder);
  run.Tick();
  MemoryRecorder::File file = recorder.files()[0];
  const flight_log::RecordHead gap(flight_log::GapRecord{42});
  MemoryRecorder::Packet packet = {1, std::vector<uint8_t>(flight_log::kDatagramHeadBytes)};
  constexpr flight_log::Endpoint kOwn = {flight_log::kLoopback, flight_log::kRecordPort};
  flight_log::EncodeDatagramHead(kOwn, kOwn, gap.bytes().size(),
                                 std::span(packet.bytes).first<flight_log::kDatagramHeadBytes>());
  packet.bytes.insert(packet.bytes.end(), gap.bytes().begin(), gap.bytes().end());
  file.insert(file.end() - 1, packet);
  const std::string path = directory.path() + "/log.pcap";
  WriteFile(path, MemoryRecorder::AsPcap(file));
  FlightReader reader;
  ASSERT_TRUE(reader.Open(path).ok());
  LoggedTick tick;
  EXPECT_EQ(reader.Next(tick), Item::kGap);
  EXPECT_EQ(reader.gap_records(), 42u);
}

TEST(FlightReader, TellsAPlainCaptureFromALog) {
  LogDirectory directory;
  const std::string path = directory.path() + "/log.pcap";
  WriteFile(path, MemoryRecorder::AsPcap({}));
  bool is_log = true;
  ASSERT_TRUE(FlightReader::IsFlightLog(path, is_log).ok());
  EXPECT_FALSE(is_log);
  WriteFile(path, {1, 2, 3});
  EXPECT_FALSE(FlightReader::IsFlightLog(path, is_log).ok());
}

// Standard output of a shell command; empty and `missing` when the program is not there.
std::string OutputOf(const std::string& command, int& status) {
  std::string text;
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> buffer;
  while (const size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    text.append(buffer.data(), got);
  }
  status = pclose(pipe);
  return text;
}

std::string LogOfCanOpen(const LogDirectory& directory) {
  MemoryRecorder recorder;
  flight_log::FlightLog log(recorder, {});
  EXPECT_EQ(log.Start({}), Status::kOk);
  TickOutput output;
  const auto add = [&output](uint32_t id, std::initializer_list<uint8_t> data) {
    CanFrame frame;
    frame.id = id;
    for (const uint8_t byte : data) frame.data[frame.size++] = byte;
    EXPECT_EQ(output.frames.PushBack(frame), Status::kOk);
  };
  add(0x000, {1, 2});
  add(0x080, {});
  add(0x701, {5});
  add(0x602, {0x40, 0x18, 0x10, 1, 0, 0, 0, 0});
  add(0x202, {1, 2, 3, 4, 5, 6});
  CanFrame feedback;
  feedback.id = 0x182;
  feedback.size = 8;
  log.BeginTick({1, 1, CanBusState::kActive, {}, std::span(&feedback, 1), {}}, {}, {});
  log.EndTick({1, Status::kOk, 0, 0, 0}, output);
  log.End();
  const std::string path = directory.path() + "/log.pcap";
  WriteFile(path, MemoryRecorder::AsPcap(recorder.files()[0]));
  return path;
}

TEST(FlightReader, WritesWhatTsharkDissectsAsCanOpen) {
  int status = 0;
  OutputOf("command -v tshark", status);
  if (status != 0) GTEST_SKIP() << "tshark is not installed";
  LogDirectory directory;
  const std::string text =
      OutputOf("tshark -r " + LogOfCanOpen(directory) +
                   " -d can.subdissector,canopen -T fields -e _ws.col.Protocol -e _ws.col.Info -e "
                   "sll.pkttype 2>/dev/null",
               status);
  ASSERT_EQ(status, 0);
  for (const char* line : {"CANopen\tNMT: Start remote node [0x2]\t4\n", "CANopen\tSYNC\t4\n",
                           "CANopen\tNMT Error Control: Operational [0x1]\t4\n",
                           "CANopen\tDefault-SDO (rx): Initiate upload request\t4\n",
                           "CANopen\tPDO1 (rx)\t4\n", "CANopen\tPDO1 (tx)\t0\n", "UDP\t47100"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << "not in\n" << text;
  }
  EXPECT_EQ(text.find("alformed"), std::string::npos);
}

TEST(FlightReader, WritesWhatTcpdumpReads) {
  int status = 0;
  OutputOf("command -v tcpdump", status);
  if (status != 0) GTEST_SKIP() << "tcpdump is not installed";
  LogDirectory directory;
  const std::string text =
      OutputOf("tcpdump -nvr " + LogOfCanOpen(directory) + " udp 2>/dev/null", status);
  ASSERT_EQ(status, 0);
  EXPECT_NE(text.find("127.0.0.1.47100 > 127.0.0.1.47100: UDP, length"), std::string::npos);
  EXPECT_EQ(text.find("bad"), std::string::npos) << text;  // "bad cksum"
}

}  // namespace
}  // namespace hardpack::capture
