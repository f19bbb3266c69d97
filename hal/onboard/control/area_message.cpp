// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/control/area_message.h"

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "hal/onboard/control/message_checks.h"

namespace hardpack::control {
namespace {

// The body of an area: index u8, count u8, kind u8, frame u8, corners u8, three zeros, speed f32;
// then for each corner x, y i32 (mm) and eight zeros, or latitude and longitude i64.
constexpr size_t kAreaIndexOffset = kHeaderBytes;
constexpr size_t kAreaCountOffset = kHeaderBytes + 1;
constexpr size_t kAreaKindOffset = kHeaderBytes + 2;
constexpr size_t kAreaFrameOffset = kHeaderBytes + 3;
constexpr size_t kAreaCornerCountOffset = kHeaderBytes + 4;
constexpr size_t kAreaZerosOffset = kHeaderBytes + 5;
constexpr size_t kAreaSpeedOffset = kHeaderBytes + 8;
constexpr size_t kAreaCornersOffset = kHeaderBytes + 12;
constexpr size_t kAreaCornerBytes = 16;
static_assert(kAreaCornersOffset + kMaxAreaCorners * kAreaCornerBytes <= kMaxMessageBytes);

Status CheckCorner(AreaFrame frame, const AreaCorner& corner) {
  if (frame == AreaFrame::kEarth) {
    return Both(CheckWithin(corner.latitude_ndeg, kMaxLatitude_ndeg),
                CheckWithin(corner.longitude_ndeg, kMaxLongitude_ndeg));
  }
  return Both(CheckWithin(int64_t{corner.x_mm}, int64_t{kMaxAreaPosition_mm}),
              CheckWithin(int64_t{corner.y_mm}, int64_t{kMaxAreaPosition_mm}));
}

// All of an area's message but its corners.
struct AreaHead {
  int32_t index = 0;
  int32_t count = 0;
  AreaKind kind = AreaKind::kKeepOut;
  AreaFrame frame = AreaFrame::kOdom;
  int32_t corners = 0;
  float speed_mps = 0.0f;
};

Status Check(const AreaHead& head) {
  const bool fits = head.count <= kMaxAreas && head.index >= 0 && head.index < head.count &&
                    static_cast<int>(head.kind) < kAreaKinds &&
                    static_cast<int>(head.frame) < kAreaFrames && head.corners >= kMinAreaCorners &&
                    head.corners <= kMaxAreaCorners;
  if (!fits) return Status::kInvalidArgument;
  return IsFinite(head.speed_mps) ? Status::kOk : Status::kNotFinite;
}

AreaCorner ReadCorner(ByteReader& reader, AreaFrame frame, size_t offset) {
  AreaCorner corner;
  if (frame == AreaFrame::kEarth) {
    corner.latitude_ndeg = static_cast<int64_t>(reader.U64(offset));
    corner.longitude_ndeg = static_cast<int64_t>(reader.U64(offset + 8));
  } else {
    corner.x_mm = static_cast<int32_t>(reader.U32(offset));
    corner.y_mm = static_cast<int32_t>(reader.U32(offset + 4));
  }
  return corner;
}

constexpr size_t CornerOffset(int corner) {
  return kAreaCornersOffset + static_cast<size_t>(corner) * kAreaCornerBytes;
}

// Precondition: the message has these bytes.
AreaHead ReadAreaHead(ByteReader& reader) {
  return {reader.U8(kAreaIndexOffset),
          reader.U8(kAreaCountOffset),
          static_cast<AreaKind>(reader.U8(kAreaKindOffset)),
          static_cast<AreaFrame>(reader.U8(kAreaFrameOffset)),
          reader.U8(kAreaCornerCountOffset),
          reader.F32(kAreaSpeedOffset)};
}

}  // namespace

size_t AreaBytes(const Area& area) {
  return CornerOffset(area.corners);
}

Status CheckArea(std::span<const uint8_t> message) {
  if (message.size() < kAreaCornersOffset) return Status::kTruncated;
  ByteReader reader(message);
  const AreaHead head = ReadAreaHead(reader);
  const Status numbers = Check(head);
  if (numbers != Status::kOk) return numbers;
  const Status size = CheckSize(message.size(), CornerOffset(head.corners));
  if (size != Status::kOk) return size;
  if (reader.U24(kAreaZerosOffset) != 0) return Status::kInvalidArgument;
  const bool metres = head.frame == AreaFrame::kOdom;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < head.corners; ++i) {
    const Status status = CheckCorner(head.frame, ReadCorner(reader, head.frame, CornerOffset(i)));
    if (status != Status::kOk) return status;
    if (metres && reader.U64(CornerOffset(i) + 8) != 0) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

void ReadArea(std::span<const uint8_t> message, OperatorCommand& command) {
  ByteReader reader(message);
  const AreaHead head = ReadAreaHead(reader);
  command.area_index = head.index;
  command.area_count = head.count;
  command.area.kind = head.kind;
  command.area.frame = head.frame;
  command.area.corners = head.corners;
  command.area.speed_mps = head.speed_mps;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < kMaxAreaCorners; ++i) {
    command.area.corner[i] = i < command.area.corners
                                 ? ReadCorner(reader, command.area.frame, CornerOffset(i))
                                 : AreaCorner{};
  }
}

void WriteArea(const OperatorCommand& command, MessageWriter& writer) {
  const Area& area = command.area;
  writer.U8(static_cast<uint8_t>(command.area_index));
  writer.U8(static_cast<uint8_t>(command.area_count));
  writer.U8(static_cast<uint8_t>(area.kind));
  writer.U8(static_cast<uint8_t>(area.frame));
  writer.U8(static_cast<uint8_t>(area.corners));
  writer.U8(0);
  writer.U16(0);
  writer.F32(area.speed_mps);
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const AreaCorner& corner = area.corner[i];
    if (area.frame == AreaFrame::kEarth) {
      writer.U64(static_cast<uint64_t>(corner.latitude_ndeg));
      writer.U64(static_cast<uint64_t>(corner.longitude_ndeg));
    } else {
      writer.U32(static_cast<uint32_t>(corner.x_mm));
      writer.U32(static_cast<uint32_t>(corner.y_mm));
      writer.U64(0);
    }
  }
}

Status CheckArea(const OperatorCommand& command) {
  const Area& area = command.area;
  const Status numbers = Check(AreaHead{command.area_index, command.area_count, area.kind,
                                        area.frame, area.corners, area.speed_mps});
  if (numbers != Status::kOk) return numbers;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const Status status = CheckCorner(area.frame, area.corner[i]);
    if (status != Status::kOk) return status;
  }
  return Status::kOk;
}

}  // namespace hardpack::control
