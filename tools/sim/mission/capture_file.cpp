// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/capture_file.h"

#include "hal/onboard/flight_log/packets.h"

namespace hardpack::mission {
namespace {

constexpr int64_t kSecond_ns = 1'000'000'000;

void Append(std::ofstream& file, std::span<const uint8_t> bytes) {
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

ReadOutcome CaptureFile::Open(const std::string& path) {
  path_ = path;
  file_.open(path, std::ios::binary);
  uint8_t header[flight_log::kPcapFileHeaderBytes];
  flight_log::EncodeFileHeader(header);
  Append(file_, header);
  if (!file_.flush()) return {Status::kInvalidArgument, path + ": cannot be written"};
  return {};
}

ReadOutcome CaptureFile::Close() {
  file_.close();
  if (!file_) return {Status::kInvalidArgument, path_ + ": could not be written completely"};
  return {};
}

Status CaptureFile::Record(int64_t time_ns, std::span<const uint8_t> head,
                           std::span<const uint8_t> body) {
  const size_t bytes = head.size() + body.size();
  if (bytes > kMaxRecord_bytes) return Status::kOversized;
  if (!file_) {
    ++counters_.dropped;
    ++counters_.write_errors;
    return Status::kCapacityExceeded;
  }
  uint8_t header[flight_log::kPcapPacketHeaderBytes];
  flight_log::EncodePacketHeader(static_cast<uint32_t>(time_ns / kSecond_ns),
                                 static_cast<uint32_t>(time_ns % kSecond_ns),
                                 static_cast<uint32_t>(bytes), header);
  Append(file_, header);
  Append(file_, head);
  Append(file_, body);
  ++counters_.records;
  counters_.bytes += bytes;
  counters_.written_bytes += bytes;
  return Status::kOk;
}

}  // namespace hardpack::mission
