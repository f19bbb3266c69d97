// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/can_frame.h"

// The server's side of SDO transfers (CiA 301): expedited downloads, expedited and segmented
// uploads. Segmented downloads, which no object of ours needs, and block transfers are refused as
// unknown commands.

namespace hardpack::sim {

namespace sdo_abort {
inline constexpr uint32_t kNone = 0;
inline constexpr uint32_t kToggle = 0x05030000;
inline constexpr uint32_t kCommand = 0x05040001;
inline constexpr uint32_t kWriteOnly = 0x06010001;
inline constexpr uint32_t kReadOnly = 0x06010002;
inline constexpr uint32_t kNoObject = 0x06020000;
inline constexpr uint32_t kNotMappable = 0x06040041;
inline constexpr uint32_t kPdoTooLong = 0x06040042;
inline constexpr uint32_t kLength = 0x06070010;
inline constexpr uint32_t kNoSubIndex = 0x06090011;
inline constexpr uint32_t kGeneral = 0x08000000;
inline constexpr uint32_t kDeviceState = 0x08000022;
}  // namespace sdo_abort

// The objects that transfers access. Each call returns an abort code, or kNone.
class SdoObjects {
 public:
  virtual uint32_t Read(uint16_t index, uint8_t sub_index, std::vector<uint8_t>& bytes) = 0;
  // `sized`: the client stated the number of bytes; otherwise there are four, and the object takes
  // as many as its size.
  virtual uint32_t Write(uint16_t index, uint8_t sub_index, std::span<const uint8_t> bytes,
                         bool sized) = 0;

 protected:
  ~SdoObjects() = default;
};

class SdoServer {
 public:
  // Takes the eight bytes of a request; returns those of the answer, or nothing if none is due.
  std::optional<std::vector<uint8_t>> Answer(std::span<const uint8_t> request, SdoObjects& objects);

  // Drops a transfer in progress.
  void Reset() { left_.clear(); }

 private:
  std::vector<uint8_t> Download(std::span<const uint8_t> request, SdoObjects& objects);
  std::vector<uint8_t> Upload(std::span<const uint8_t> request, SdoObjects& objects);
  std::vector<uint8_t> Segment(std::span<const uint8_t> request);

  uint16_t index_ = 0;  // of the segmented upload in progress
  uint8_t sub_index_ = 0;
  bool toggle_ = false;
  std::vector<uint8_t> left_;
};

}  // namespace hardpack::sim
