// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "test/bare_metal/tape.h"

namespace hardpack {

// Collects ticks, each with what was decided, and writes them as a tape.
class TapeWriter {
 public:
  void Add(const TickInput& input, Status status, std::span<const CanFrame> frames_out,
           uint64_t decision_hash) {
    payload_.clear();
    for (const TickDatagram& datagram : input.datagrams) {
      AppendOne(payload_, TapeDatagram{static_cast<uint32_t>(datagram.source),
                                       static_cast<uint32_t>(datagram.bytes.size())});
      Append(payload_, datagram.bytes);
    }
    Append(payload_, BytesOf(input.frames));
    Append(payload_, input.command);
    Append(payload_, BytesOf(frames_out));
    AppendOne(ticks_, TapeTick{.index = input.index,
                               .now_ns = input.now_ns,
                               .decision_hash = decision_hash,
                               .bus = static_cast<uint16_t>(input.bus),
                               .status = static_cast<uint16_t>(status),
                               .datagrams = static_cast<uint16_t>(input.datagrams.size()),
                               .frames_in = static_cast<uint16_t>(input.frames.size()),
                               .frames_out = static_cast<uint16_t>(frames_out.size()),
                               .command_bytes = static_cast<uint16_t>(input.command.size()),
                               .payload_bytes = static_cast<uint32_t>(payload_.size())});
    Append(ticks_, payload_);
    ++head_.ticks;
  }

  uint32_t ticks() const { return head_.ticks; }

  // False: the file cannot be written.
  bool WriteTo(const std::string& path, const VehicleConfig& config) const {
    std::vector<uint8_t> opening;
    AppendOne(opening, head_);
    AppendOne(opening, config);
    std::ofstream file(path, std::ios::binary);
    for (const auto& part : {std::cref(opening), std::cref(ticks_)}) {
      const std::vector<uint8_t>& bytes = part;
      file.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    }
    file.close();
    return file.good();
  }

 private:
  template <typename T>
  static std::span<const uint8_t> BytesOf(std::span<const T> things) {
    return {reinterpret_cast<const uint8_t*>(things.data()), things.size_bytes()};
  }
  static void Append(std::vector<uint8_t>& bytes, std::span<const uint8_t> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  template <typename T>
  static void AppendOne(std::vector<uint8_t>& bytes, const T& thing) {
    Append(bytes, BytesOf(std::span<const T>(&thing, 1)));
  }

  TapeHead head_;
  std::vector<uint8_t> ticks_;
  std::vector<uint8_t> payload_;  // of one tick
};

}  // namespace hardpack
