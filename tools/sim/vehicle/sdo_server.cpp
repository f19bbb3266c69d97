// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/sdo_server.h"

#include <algorithm>

#include "tools/sim/vehicle/object_dictionary.h"

namespace hardpack::sim {
namespace {

constexpr size_t kExpedited_bytes = 4;
constexpr size_t kSegment_bytes = 7;

uint16_t IndexOf(std::span<const uint8_t> frame) {
  return static_cast<uint16_t>(frame[1] | frame[2] << 8);
}

std::vector<uint8_t> Message(uint8_t command, uint16_t index, uint8_t sub_index, uint32_t value) {
  std::vector<uint8_t> bytes = {command, static_cast<uint8_t>(index),
                                static_cast<uint8_t>(index >> 8), sub_index};
  for (const uint8_t byte : ToBytes(value, 4)) bytes.push_back(byte);
  return bytes;
}

std::vector<uint8_t> Abort(uint16_t index, uint8_t sub_index, uint32_t code) {
  constexpr uint8_t kAbort = 0x80;
  return Message(kAbort, index, sub_index, code);
}

}  // namespace

std::optional<std::vector<uint8_t>> SdoServer::Answer(std::span<const uint8_t> request,
                                                      SdoObjects& objects) {
  enum Command : uint8_t { kDownload = 1, kUpload = 2, kUploadSegment = 3, kAborted = 4 };
  switch (request[0] >> 5) {
    case kDownload:
      return Download(request, objects);
    case kUpload:
      return Upload(request, objects);
    case kUploadSegment:
      return Segment(request);
    case kAborted:
      Reset();
      return std::nullopt;
    default:
      return Abort(IndexOf(request), request[3], sdo_abort::kCommand);
  }
}

std::vector<uint8_t> SdoServer::Download(std::span<const uint8_t> request, SdoObjects& objects) {
  const uint16_t index = IndexOf(request);
  const uint8_t sub_index = request[3];
  const bool expedited = (request[0] & 2u) != 0;
  const bool sized = (request[0] & 1u) != 0;
  if (!expedited) return Abort(index, sub_index, sdo_abort::kCommand);
  const size_t unused = sized ? request[0] >> 2 & 3u : 0u;
  const uint32_t code =
      objects.Write(index, sub_index, request.subspan(4, kExpedited_bytes - unused), sized);
  if (code != sdo_abort::kNone) return Abort(index, sub_index, code);
  return Message(0x60, index, sub_index, 0);
}

std::vector<uint8_t> SdoServer::Upload(std::span<const uint8_t> request, SdoObjects& objects) {
  Reset();
  index_ = IndexOf(request);
  sub_index_ = request[3];
  std::vector<uint8_t> bytes;
  const uint32_t code = objects.Read(index_, sub_index_, bytes);
  if (code != sdo_abort::kNone) return Abort(index_, sub_index_, code);
  if (bytes.size() > kExpedited_bytes) {
    left_ = bytes;
    toggle_ = false;
    return Message(0x41, index_, sub_index_, static_cast<uint32_t>(bytes.size()));
  }
  const size_t unused = kExpedited_bytes - bytes.size();
  const auto value = static_cast<uint32_t>(FromBytes(bytes, false));
  return Message(static_cast<uint8_t>(0x43u | unused << 2), index_, sub_index_, value);
}

std::vector<uint8_t> SdoServer::Segment(std::span<const uint8_t> request) {
  if (left_.empty()) return Abort(index_, sub_index_, sdo_abort::kCommand);
  const bool toggle = (request[0] & 0x10u) != 0;
  if (toggle != toggle_) {
    Reset();
    return Abort(index_, sub_index_, sdo_abort::kToggle);
  }
  const size_t size = std::min(left_.size(), kSegment_bytes);
  const bool last = size == left_.size();
  std::vector<uint8_t> bytes = {static_cast<uint8_t>(
      (toggle ? 0x10u : 0u) | (kSegment_bytes - size) << 1 | (last ? 1u : 0u))};
  bytes.insert(bytes.end(), left_.begin(), left_.begin() + static_cast<ptrdiff_t>(size));
  bytes.resize(8);
  left_.erase(left_.begin(), left_.begin() + static_cast<ptrdiff_t>(size));
  toggle_ = !toggle_;
  return bytes;
}

}  // namespace hardpack::sim
