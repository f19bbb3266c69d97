// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/base/byte_reader.h"
#include "hal/onboard/flight_log/packets.h"
#include "hal/onboard/flight_log/records.h"
#include "test/fakes/memory_recorder.h"

// A folder for logs that goes when the test does, and what is in such files.

namespace hardpack::fakes {

using RecordedPacket = MemoryRecorder::Packet;

class LogDirectory {
 public:
  LogDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "hardpack_log_XXXXXX").string();
    path_ = mkdtemp(name.data()) == nullptr ? "" : name;
  }
  ~LogDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }

  // Of flight logs, sorted by name.
  std::vector<std::string> Files() const {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      if (entry.path().filename().string().starts_with("flight_")) {
        files.push_back(entry.path().string());
      }
    }
    std::sort(files.begin(), files.end());
    return files;
  }

 private:
  std::string path_;
};

inline std::vector<uint8_t> ReadBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Every packet of a pcap file. `whole` is false when it ends within one.
inline std::vector<RecordedPacket> PacketsOf(const std::string& path, bool* whole = nullptr) {
  const std::vector<uint8_t> bytes = ReadBytes(path);
  ByteReader reader(bytes);
  EXPECT_EQ(reader.U32(0), flight_log::kPcapMagic_ns);
  EXPECT_EQ(reader.U32(20), flight_log::kLinkType);
  std::vector<RecordedPacket> packets;
  size_t at = flight_log::kPcapFileHeaderBytes;
  while (at < bytes.size()) {
    const int64_t time_ns = int64_t{reader.U32(at)} * 1'000'000'000 + reader.U32(at + 4);
    const uint32_t size = reader.U32(at + 8);
    EXPECT_EQ(reader.U32(at + 12), size);
    const std::span<const uint8_t> packet = reader.Sub(at + 16, size);
    if (!IsUsable(reader.status())) break;
    packets.push_back({time_ns, {packet.begin(), packet.end()}});
    at += 16 + size;
  }
  if (whole != nullptr) *whole = at == bytes.size();
  return packets;
}

// How many records a packet says to be missing; 0: it is no Gap record.
inline uint64_t GapIn(const RecordedPacket& packet) {
  flight_log::GapRecord gap;
  if (packet.bytes.size() < flight_log::kDatagramHeadBytes) return 0;
  const auto payload = std::span(packet.bytes).subspan(flight_log::kDatagramHeadBytes);
  return IsUsable(flight_log::Decode(payload, gap)) ? gap.records : 0;
}

}  // namespace hardpack::fakes
