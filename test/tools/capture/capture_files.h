// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

// Capture files, frame by frame and byte by byte, independently of libpcap; and the recordings.

namespace hardpack::capture::test {

using Bytes = std::vector<uint8_t>;

inline void Append(Bytes& out, const Bytes& more) {
  out.insert(out.end(), more.begin(), more.end());
}
// Network order.
inline void AppendBig(Bytes& out, uint64_t value, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}
inline void AppendLittle(Bytes& out, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

inline Bytes Counting(size_t size, unsigned first = 0) {
  Bytes bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(first + i * 7 + i / 256);
  return bytes;
}

constexpr uint32_t kSensorAddress = 0xc0a80102;  // 192.168.1.2
constexpr uint32_t kHostAddress = 0xc0a80101;

inline Bytes Udp(const Bytes& payload, uint16_t destination_port = 7502) {
  Bytes out;
  AppendBig(out, 40000, 2);
  AppendBig(out, destination_port, 2);
  AppendBig(out, payload.size() + 8, 2);
  AppendBig(out, 0, 2);
  Append(out, payload);
  return out;
}

struct IpOptions {
  uint16_t identification = 1;
  size_t offset = 0;
  bool more = false;
  uint8_t protocol = 17;
  uint32_t source = kSensorAddress;
  size_t option_words = 0;
};

inline Bytes Ipv4(const Bytes& content, const IpOptions& options = {}) {
  Bytes out;
  out.push_back(static_cast<uint8_t>(0x40 + 5 + options.option_words));
  out.push_back(0);
  AppendBig(out, 20 + 4 * options.option_words + content.size(), 2);
  AppendBig(out, options.identification, 2);
  AppendBig(out, (options.more ? 0x2000u : 0u) | options.offset / 8, 2);
  out.push_back(64);
  out.push_back(options.protocol);
  AppendBig(out, 0, 2);
  AppendBig(out, options.source, 4);
  AppendBig(out, kHostAddress, 4);
  Append(out, Bytes(4 * options.option_words, 1));
  Append(out, content);
  return out;
}

inline Bytes Ethernet(const Bytes& packet, uint16_t type = 0x0800) {
  Bytes out(12, 0xee);
  AppendBig(out, type, 2);
  Append(out, packet);
  return out;
}

// The fragments of one datagram, in order; each but the last carries fragment_bytes.
inline std::vector<Bytes> Fragments(const Bytes& datagram, uint16_t identification,
                                    size_t fragment_bytes = 1480) {
  std::vector<Bytes> frames;
  for (size_t offset = 0; offset < datagram.size(); offset += fragment_bytes) {
    const size_t end = std::min(offset + fragment_bytes, datagram.size());
    const Bytes part(datagram.begin() + static_cast<std::ptrdiff_t>(offset),
                     datagram.begin() + static_cast<std::ptrdiff_t>(end));
    IpOptions options;
    options.identification = identification;
    options.offset = offset;
    options.more = end < datagram.size();
    frames.push_back(Ethernet(Ipv4(part, options)));
  }
  return frames;
}

// A capture file (nanosecond stamps, little-endian) that is removed with the object.
class CaptureFile {
 public:
  explicit CaptureFile(int link_type = 1) {
    AppendLittle(bytes_, 0xa1b23c4d, 4);
    AppendLittle(bytes_, 2, 2);
    AppendLittle(bytes_, 4, 2);
    AppendLittle(bytes_, 0, 8);
    AppendLittle(bytes_, 262144, 4);
    AppendLittle(bytes_, static_cast<uint64_t>(link_type), 4);
  }
  ~CaptureFile() { std::filesystem::remove(path_); }
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  // `kept`: bytes that the capture kept of the frame.
  void Add(const Bytes& frame, int64_t time_ns = 0, size_t kept = SIZE_MAX) {
    kept = std::min(kept, frame.size());
    AppendLittle(bytes_, static_cast<uint64_t>(time_ns / 1'000'000'000), 4);
    AppendLittle(bytes_, static_cast<uint64_t>(time_ns % 1'000'000'000), 4);
    AppendLittle(bytes_, kept, 4);
    AppendLittle(bytes_, frame.size(), 4);
    bytes_.insert(bytes_.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(kept));
  }
  Bytes& bytes() { return bytes_; }

  // Writes what was added so far.
  const std::string& Write() {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes_.data()),
               static_cast<std::streamsize>(bytes_.size()));
    return path_;
  }

 private:
  static std::string UniquePath() {
    static int count = 0;
    return testing::TempDir() + "hardpack_" + std::to_string(::getpid()) + "_" +
           std::to_string(count++) + ".pcap";
  }
  std::string path_ = UniquePath();
  Bytes bytes_;
};

// A text file that is removed with the object.
class TextFile {
 public:
  explicit TextFile(const std::string& text) { std::ofstream(path_, std::ios::binary) << text; }
  ~TextFile() { std::filesystem::remove(path_); }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  static std::string UniquePath() {
    static int count = 0;
    return testing::TempDir() + "hardpack_" + std::to_string(::getpid()) + "_" +
           std::to_string(count++) + ".txt";
  }
  std::string path_ = UniquePath();
};

// Folder of real recordings, or nothing.
inline std::string DataFolder() {
  const char* const folder = std::getenv("HARDPACK_DATA");
  if (folder == nullptr || !std::filesystem::exists(std::string(folder) + "/ouster")) return {};
  return folder;
}

}  // namespace hardpack::capture::test
