// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "hal/onboard/flight_log/packets.h"
#include "hal/recorder.h"

namespace hardpack::fakes {

// Keeps what it is given, file by file. Takes at most `capacity_bytes` until MakeRoom, and wants a
// new file every `file_bytes`.
class MemoryRecorder final : public Recorder {
 public:
  struct Packet {
    int64_t time_ns = 0;
    std::vector<uint8_t> bytes;
    bool operator==(const Packet&) const = default;
  };
  using File = std::vector<Packet>;

  explicit MemoryRecorder(uint64_t file_bytes = UINT64_MAX, uint64_t capacity_bytes = UINT64_MAX)
      : file_limit_bytes_(file_bytes), capacity_bytes_(capacity_bytes) {}

  Status Record(int64_t time_ns, std::span<const uint8_t> head,
                std::span<const uint8_t> body) override {
    const uint64_t bytes = head.size() + body.size();
    if (bytes > kMaxRecord_bytes) return Status::kOversized;
    if (bytes > capacity_bytes_ - held_bytes_) {
      ++counters_.dropped;
      return Status::kCapacityExceeded;
    }
    if (files_.empty()) files_.emplace_back();
    Packet packet = {time_ns, {head.begin(), head.end()}};
    packet.bytes.insert(packet.bytes.end(), body.begin(), body.end());
    files_.back().push_back(packet);
    held_bytes_ += bytes;
    file_bytes_ += bytes;
    ++counters_.records;
    counters_.bytes += bytes;
    counters_.written_bytes += bytes;
    return Status::kOk;
  }

  bool wants_opening() const override { return !begun_ || file_bytes_ >= file_limit_bytes_; }
  void BeginFile() override {
    begun_ = true;
    file_bytes_ = 0;
    files_.emplace_back();
    ++counters_.files;
  }
  const RecorderCounters& counters() const override { return counters_; }

  void MakeRoom() { held_bytes_ = 0; }
  const std::vector<File>& files() const { return files_; }

  // A file as a pcap capture.
  static std::vector<uint8_t> AsPcap(const File& file) {
    std::vector<uint8_t> bytes(flight_log::kPcapFileHeaderBytes);
    flight_log::EncodeFileHeader(std::span(bytes).first<flight_log::kPcapFileHeaderBytes>());
    for (const Packet& packet : file) {
      uint8_t header[flight_log::kPcapPacketHeaderBytes];
      flight_log::EncodePacketHeader(static_cast<uint32_t>(packet.time_ns / 1'000'000'000),
                                     static_cast<uint32_t>(packet.time_ns % 1'000'000'000),
                                     static_cast<uint32_t>(packet.bytes.size()), header);
      bytes.insert(bytes.end(), std::begin(header), std::end(header));
      bytes.insert(bytes.end(), packet.bytes.begin(), packet.bytes.end());
    }
    return bytes;
  }

 private:
  uint64_t file_limit_bytes_;
  uint64_t capacity_bytes_;
  uint64_t held_bytes_ = 0;
  uint64_t file_bytes_ = 0;
  bool begun_ = false;
  std::vector<File> files_;
  RecorderCounters counters_;
};

}  // namespace hardpack::fakes
