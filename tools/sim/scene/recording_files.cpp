// SPDX-License-Identifier: Apache-2.0
#include <pcap/pcap.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <span>

#include "tools/sim/scene/recording.h"

namespace hardpack::scene {
namespace {

constexpr size_t kMtuPayload_bytes = 1480;  // of 1500, less the IPv4 header; a multiple of 8
constexpr size_t kIpHeader_bytes = 20;
constexpr uint16_t kMoreFragments = 0x2000;
constexpr uint32_t kSensorAddress = 0xc0a80164;   // 192.168.1.100
constexpr uint32_t kVehicleAddress = 0xc0a80101;  // 192.168.1.1
constexpr uint64_t kBetweenFragments_ns = 12'000;

using Bytes = std::vector<uint8_t>;

void Append16(Bytes& bytes, uint32_t value) {
  bytes.push_back(static_cast<uint8_t>(value >> 8));
  bytes.push_back(static_cast<uint8_t>(value));
}

void Append32(Bytes& bytes, uint32_t value) {
  Append16(bytes, value >> 16);
  Append16(bytes, value & 0xffff);
}

// The Internet checksum (RFC 1071) of the bytes, which start at an even offset.
uint16_t Checksum(std::span<const uint8_t> bytes, uint32_t start_sum) {
  uint64_t sum = start_sum;
  for (size_t i = 0; i < bytes.size(); ++i) {
    sum += i % 2 == 0 ? uint32_t{bytes[i]} << 8 : uint32_t{bytes[i]};
  }
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<uint16_t>(~sum);
}

Bytes UdpSegment(const Datagram& datagram) {
  const auto length = static_cast<uint32_t>(datagram.payload.size() + 8);
  Bytes segment;
  Append16(segment, datagram.port);
  Append16(segment, datagram.port);
  Append16(segment, length);
  Append16(segment, 0);
  segment.insert(segment.end(), datagram.payload.begin(), datagram.payload.end());
  const uint32_t pseudo_header = (kSensorAddress >> 16) + (kSensorAddress & 0xffff) +
                                 (kVehicleAddress >> 16) + (kVehicleAddress & 0xffff) + 17 + length;
  const uint16_t checksum = Checksum(segment, pseudo_header);
  segment[6] = static_cast<uint8_t>(checksum >> 8);
  segment[7] = static_cast<uint8_t>(checksum);
  return segment;
}

Bytes EthernetFrame(std::span<const uint8_t> part, uint16_t id, uint32_t fragment_word) {
  Bytes frame = {0x02, 0, 0, 0, 0, 0x01, 0x02, 0, 0, 0, 0, 0x64, 0x08, 0x00};
  Bytes header = {0x45, 0x00};
  Append16(header, static_cast<uint32_t>(kIpHeader_bytes + part.size()));
  Append16(header, id);
  Append16(header, fragment_word);
  header.push_back(64);  // hops
  header.push_back(17);  // UDP
  Append16(header, 0);
  Append32(header, kSensorAddress);
  Append32(header, kVehicleAddress);
  const uint16_t checksum = Checksum(header, 0);
  header[10] = static_cast<uint8_t>(checksum >> 8);
  header[11] = static_cast<uint8_t>(checksum);
  frame.insert(frame.end(), header.begin(), header.end());
  frame.insert(frame.end(), part.begin(), part.end());
  return frame;
}

struct ClosePcap {
  void operator()(pcap_t* pcap) const { pcap_close(pcap); }
  void operator()(pcap_dumper_t* dumper) const { pcap_dump_close(dumper); }
};

void Dump(pcap_dumper_t* dumper, uint64_t time_ns, const Bytes& frame) {
  pcap_pkthdr header = {};
  header.ts.tv_sec = static_cast<time_t>(time_ns / 1'000'000'000);
  header.ts.tv_usec = static_cast<suseconds_t>(time_ns % 1'000'000'000 / 1000);
  header.caplen = static_cast<bpf_u_int32>(frame.size());
  header.len = header.caplen;
  pcap_dump(reinterpret_cast<u_char*>(dumper), &header, frame.data());
}

ReadOutcome WriteCapture(const std::vector<Datagram>& datagrams, const std::string& path) {
  constexpr int kSnapLength = 65535;
  const std::unique_ptr<pcap_t, ClosePcap> pcap(pcap_open_dead(DLT_EN10MB, kSnapLength));
  const std::unique_ptr<pcap_dumper_t, ClosePcap> dumper(pcap_dump_open(pcap.get(), path.c_str()));
  if (!dumper) return {Status::kInvalidArgument, path + ": cannot be written"};
  uint16_t id = 1000;
  for (const Datagram& datagram : datagrams) {
    const Bytes segment = UdpSegment(datagram);
    const std::span<const uint8_t> whole(segment);
    for (size_t offset = 0; offset < whole.size(); offset += kMtuPayload_bytes) {
      const size_t size = std::min(kMtuPayload_bytes, whole.size() - offset);
      const bool last = offset + size == whole.size();
      const auto word = static_cast<uint32_t>(offset / 8) | (last ? 0u : kMoreFragments);
      const uint64_t time_ns =
          datagram.time_ns + kBetweenFragments_ns * (offset / kMtuPayload_bytes);
      Dump(dumper.get(), time_ns, EthernetFrame(whole.subspan(offset, size), id, word));
    }
    ++id;
  }
  if (pcap_dump_flush(dumper.get()) != 0) {
    return {Status::kInvalidArgument, path + ": cannot be written"};
  }
  return {};
}

ReadOutcome WriteText(const std::string& text, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return {Status::kInvalidArgument, path + ": cannot be written"};
  return {};
}

}  // namespace

ReadOutcome WriteRecording(const Recording& recording, const std::string& folder) {
  ReadOutcome outcome = WriteCapture(recording.datagrams, folder + "/scan.pcap");
  if (outcome.ok()) outcome = WriteText(recording.metadata_json, folder + "/scan.json");
  if (outcome.ok()) outcome = WriteText(recording.labels_csv, folder + "/labels.csv");
  return outcome;
}

}  // namespace hardpack::scene
