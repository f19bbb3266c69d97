// SPDX-License-Identifier: Apache-2.0
#include "port_linux/file_recorder.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <thread>

#include "test/fakes/memory_recorder.h"
#include "test/hal/conformance/recorder_conformance.h"
#include "test/port_linux/log_files.h"

namespace hardpack {
namespace {

using fakes::GapIn;
using fakes::LogDirectory;
using fakes::PacketsOf;

constexpr uint64_t kLong_ns = 20'000'000'000;
constexpr size_t kSmallRing_bytes = FileRecorder::kMinRing_bytes;

FileRecorderConfig ConfigOf(const LogDirectory& directory) {
  return {.directory = directory.path(),
          .file_bytes = 200'000,
          .total_bytes = 100'000'000,
          .min_free_bytes = 0,
          .ring_bytes = kSmallRing_bytes};
}

std::vector<uint8_t> PacketOf(uint64_t number, size_t bytes) {
  std::vector<uint8_t> packet(std::max<size_t>(bytes, 8));
  std::memcpy(packet.data(), &number, 8);
  return packet;
}

uint64_t NumberOf(const RecordedPacket& packet) {
  uint64_t number = 0;
  std::memcpy(&number, packet.bytes.data(), 8);
  return number;
}

bool Until(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000 && !condition(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

// What the files hold is 0, 1, 2 ..., but for what Gap records say is missing. The count, with
// them.
uint64_t CheckNumbers(const std::vector<std::string>& files) {
  uint64_t next = 0;
  for (const std::string& path : files) {
    bool whole = false;
    for (const RecordedPacket& packet : PacketsOf(path, &whole)) {
      if (const uint64_t gap = GapIn(packet); gap != 0) {
        next += gap;
        continue;
      }
      EXPECT_EQ(NumberOf(packet), next) << path;
      next = NumberOf(packet) + 1;
    }
    EXPECT_TRUE(whole) << path;
  }
  return next;
}

class FileHarness {
 public:
  FileHarness() { EXPECT_TRUE(recorder_.Start(ConfigOf(directory_)).ok()); }
  Recorder& recorder() { return recorder_; }
  std::vector<RecordedPacket> Finish() {
    EXPECT_TRUE(recorder_.Stop(kLong_ns));
    std::vector<RecordedPacket> packets;
    for (const std::string& path : directory_.Files()) {
      const std::vector<RecordedPacket> file = PacketsOf(path);
      packets.insert(packets.end(), file.begin(), file.end());
    }
    return packets;
  }
  // Faster than any thread can write.
  uint64_t Fill() {
    const std::vector<uint8_t> packet(60'000);
    for (int i = 0; i < 100'000; ++i) {
      if (!IsUsable(recorder_.Record(1, packet, {}))) return 1;
    }
    return 0;
  }

 private:
  LogDirectory directory_;
  FileRecorder recorder_;
};

class MemoryHarness {
 public:
  Recorder& recorder() { return recorder_; }
  std::vector<RecordedPacket> Finish() {
    std::vector<RecordedPacket> packets;
    for (const auto& file : recorder_.files()) {
      for (const auto& packet : file) packets.push_back({packet.time_ns, packet.bytes});
    }
    return packets;
  }
  uint64_t Fill() {
    const std::vector<uint8_t> packet(60'000);
    uint64_t dropped = 0;
    for (int i = 0; i < 20; ++i) dropped += IsUsable(recorder_.Record(1, packet, {})) ? 0 : 1;
    return dropped;
  }

 private:
  fakes::MemoryRecorder recorder_{200'000, 500'000};
};

INSTANTIATE_TYPED_TEST_SUITE_P(File, RecorderConformance, FileHarness);
INSTANTIATE_TYPED_TEST_SUITE_P(Memory, RecorderConformance, MemoryHarness);

TEST(FileRecorder, MakesTheFolderAndNamesFilesByTheRun) {
  LogDirectory directory;
  FileRecorderConfig config = ConfigOf(directory);
  config.directory += "/a/b";
  FileRecorder recorder;
  ASSERT_TRUE(recorder.Start(config).ok());
  for (int i = 0; i < 2; ++i) {
    recorder.BeginFile();
    ASSERT_EQ(recorder.Record(1, PacketOf(0, 8), {}), Status::kOk);
  }
  ASSERT_TRUE(recorder.Stop(kLong_ns));
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(config.directory)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[0].size(), std::strlen("flight_20261121_210000_000.pcap"));
  EXPECT_TRUE(names[0].ends_with("_000.pcap"));
  EXPECT_EQ(names[1].substr(0, 23), names[0].substr(0, 23));
  EXPECT_TRUE(names[1].ends_with("_001.pcap"));
}

TEST(FileRecorder, RefusesWhatItCannotWriteTo) {
  LogDirectory directory;
  const auto start = [&directory](const std::function<void(FileRecorderConfig&)>& change) {
    FileRecorderConfig config = ConfigOf(directory);
    change(config);
    FileRecorder recorder;
    const ReadOutcome outcome = recorder.Start(config);
    EXPECT_NE(outcome.message.find(config.directory), std::string::npos);
    return outcome.status;
  };
  EXPECT_EQ(start([](auto& config) { config.directory = "/proc/no/such"; }),
            Status::kInvalidArgument);
  EXPECT_EQ(start([](auto& config) { config.directory = "/dev/null"; }), Status::kInvalidArgument);
  EXPECT_EQ(start([](auto& config) { config.ring_bytes = 1000; }), Status::kInvalidArgument);
  EXPECT_EQ(start([](auto& config) { config.file_bytes = 1000; }), Status::kInvalidArgument);
  EXPECT_EQ(start([](auto& config) { config.total_bytes = 300'000; }), Status::kInvalidArgument);
  FileRecorder never;
  EXPECT_EQ(never.Record(1, PacketOf(1, 8), {}), Status::kCapacityExceeded);
  EXPECT_FALSE(never.wants_opening());
}

TEST(FileRecorder, WritesWhatIsLeftAtTheEndAndNothingAfter) {
  LogDirectory directory;
  FileRecorder recorder;
  ASSERT_TRUE(recorder.Start(ConfigOf(directory)).ok());
  recorder.BeginFile();
  for (uint64_t i = 0; i < 100; ++i) {
    ASSERT_EQ(recorder.Record(1, PacketOf(i, 1000), {}), Status::kOk);
  }
  EXPECT_TRUE(recorder.Stop(kLong_ns));
  EXPECT_EQ(recorder.Record(1, PacketOf(100, 8), {}), Status::kCapacityExceeded);
  EXPECT_EQ(CheckNumbers(directory.Files()), 100u);
}

TEST(FileRecorder, WritesALittleWithoutWaitingForMore) {
  LogDirectory directory;
  FileRecorder recorder;
  ASSERT_TRUE(recorder.Start(ConfigOf(directory)).ok());
  recorder.BeginFile();
  ASSERT_EQ(recorder.Record(1, PacketOf(0, 100), {}), Status::kOk);
  EXPECT_TRUE(Until([&] { return recorder.counters().written_bytes == 116; }));
}

TEST(FileRecorder, RotatesAndKeepsToItsTotalByDeletingItsOldest) {
  LogDirectory directory;
  const std::string foreign = directory.path() + "/flight_of_the_bumblebee.pcap";
  const std::string older = directory.path() + "/flight_20000101_000000_007.pcap";
  std::ofstream(foreign) << std::string(500'000, 'x');
  std::ofstream(older) << std::string(500'000, 'x');
  FileRecorderConfig config = ConfigOf(directory);
  config.total_bytes = 1'000'000;
  FileRecorder recorder;
  ASSERT_TRUE(recorder.Start(config).ok());
  uint64_t files = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    if (recorder.wants_opening()) {
      recorder.BeginFile();
      ++files;
      ASSERT_TRUE(Until([&] { return recorder.counters().files == files; }));
    }
    ASSERT_EQ(recorder.Record(1, PacketOf(i, 1000), {}), Status::kOk);
  }
  ASSERT_TRUE(recorder.Stop(kLong_ns));
  EXPECT_EQ(recorder.counters().files, files);
  EXPECT_GE(files, 15u);
  uint64_t total = 0;
  std::vector<std::string> ours;
  for (const std::string& path : directory.Files()) {
    if (path == foreign) continue;
    ours.push_back(path);
    total += std::filesystem::file_size(path);
    EXPECT_LE(std::filesystem::file_size(path), 210'000u);
  }
  EXPECT_TRUE(std::filesystem::exists(foreign));
  EXPECT_FALSE(std::filesystem::exists(older));
  EXPECT_LE(total, config.total_bytes);
  EXPECT_GE(total, config.total_bytes / 2);
  EXPECT_EQ(NumberOf(PacketsOf(ours.back()).back()), 2999u);
}

// The medium is full for as long as the room that it has to leave to others is more than there is.
TEST(FileRecorder, WaitsForRoomAndThenTellsTheGap) {
  LogDirectory directory;
  FileRecorderConfig config = ConfigOf(directory);
  config.min_free_bytes = UINT64_MAX / 2;
  FileRecorder recorder;
  ASSERT_TRUE(recorder.Start(config).ok());
  recorder.BeginFile();
  uint64_t recorded = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    recorded += IsUsable(recorder.Record(1, PacketOf(i, 1000), {})) ? 1 : 0;
  }
  EXPECT_LT(recorded, 1100u);  // what the ring holds
  EXPECT_EQ(recorder.counters().dropped, 2000 - recorded);
  EXPECT_TRUE(Until([&] { return recorder.counters().write_errors > 1; }));
  EXPECT_EQ(recorder.counters().written_bytes, 0u);
  EXPECT_FALSE(recorder.Stop(0));
}

// A file that may not become longer than 300,000 bytes: EFBIG in its middle.
TEST(FileRecorder, GoesOnInAnotherFileWhereOneCannotGrow) {
  LogDirectory directory;
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit = {300'000, 300'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    FileRecorderConfig config = ConfigOf(directory);
    config.file_bytes = 10'000'000;
    FileRecorder recorder;
    if (!recorder.Start(config).ok()) _exit(1);
    recorder.BeginFile();
    for (uint64_t i = 0; i < 2000; ++i) {
      if (i % 100 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(20));
      (void)recorder.Record(1, PacketOf(i, 1000), {});
    }
    if (!recorder.Stop(kLong_ns)) _exit(2);
    // What was dropped last has no Gap record behind it.
    if (CheckNumbers(directory.Files()) < 1000 || ::testing::Test::HasFailure()) _exit(3);
    if (recorder.counters().write_errors == 0 || recorder.counters().files < 4) _exit(4);
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status)) << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

// SR-LOG02
TEST(FileRecorder, TellsHowManyRecordsAreMissingWhereTheyAre) {
  LogDirectory directory;
  FileRecorder recorder;
  ASSERT_TRUE(recorder.Start(ConfigOf(directory)).ok());
  recorder.BeginFile();
  uint64_t next = 0;
  for (int round = 0; round < 3; ++round) {
    // Faster than it can be written.
    const uint64_t dropped = recorder.counters().dropped;
    for (int i = 0; recorder.counters().dropped < dropped + 10 && i < 1'000'000; ++i) {
      (void)recorder.Record(1, PacketOf(next++, 30'000), {});
    }
    EXPECT_TRUE(Until([&] { return IsUsable(recorder.Record(1, PacketOf(next++, 8), {})); }));
  }
  EXPECT_TRUE(recorder.Stop(kLong_ns));
  EXPECT_EQ(CheckNumbers(directory.Files()), next);
}

TEST(RecordRing, HandsOverWhatIsPutWithItsFileStarts) {
  RecordRing ring(4099);  // so that it wraps everywhere
  constexpr uint64_t kParts = 20'000;
  uint64_t sum_taken = 0;
  uint64_t starts_taken = 0;
  std::thread taker([&] {
    uint64_t at = 0;
    while (starts_taken < kParts / 100 || at < kParts * 67) {
      const uint64_t end = ring.End();
      uint64_t limit = end;
      if (ring.NextFileStart(end, limit) && limit == at) {
        EXPECT_EQ(at, starts_taken * 6700);
        ring.TakeFileStart();
        ++starts_taken;
        continue;
      }
      const std::span<const uint8_t> bytes = ring.Peek(at, limit);
      for (const uint8_t byte : bytes) sum_taken += byte;
      at += bytes.size();
      ring.Release(at);
      if (bytes.empty()) std::this_thread::yield();
    }
  });
  uint64_t sum_put = 0;
  for (uint64_t i = 0; i < kParts; ++i) {
    std::array<uint8_t, 60> body;
    body.fill(static_cast<uint8_t>(i));
    const std::array<uint8_t, 7> head = {1, 2, 3, 4, 5, 6, 7};
    const std::array<std::span<const uint8_t>, 2> parts = {head, body};
    if (i % 100 == 0) {
      while (!ring.StartFile()) std::this_thread::yield();
    }
    while (!ring.Put(parts)) std::this_thread::yield();
    sum_put += 28 + 60 * (i % 256);
  }
  taker.join();
  EXPECT_EQ(sum_taken, sum_put);
  EXPECT_EQ(starts_taken, kParts / 100);
}

}  // namespace
}  // namespace hardpack
