// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/control/messages.h"

#include <cstddef>

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "hal/onboard/control/area_message.h"
#include "hal/onboard/control/message_checks.h"
#include "hal/onboard/control/message_writer.h"

namespace hardpack::control {
namespace {

constexpr size_t kMagicOffset = 0;
constexpr size_t kVersionOffset = 4;
constexpr size_t kKindOffset = 5;
constexpr size_t kSequenceOffset = 8;

// The body of a goal: count u8, has_heading u8, heading's frame u8, zero u8, heading f32; then for
// each waypoint its frame u8, stop u8, hold u8 and speed u8, and x, y f32 and eight zeros, or
// latitude and longitude i64. Without a heading its frame and the heading are zeros.
constexpr size_t kCountOffset = kHeaderBytes;
constexpr size_t kHasHeadingOffset = kHeaderBytes + 1;
constexpr size_t kHeadingFrameOffset = kHeaderBytes + 2;
constexpr size_t kGoalZeroOffset = kHeaderBytes + 3;
constexpr size_t kHeadingOffset = kHeaderBytes + 4;
constexpr size_t kWaypointsOffset = kHeaderBytes + 8;
constexpr size_t kWaypointBytes = 20;
constexpr size_t kStopOffset = 1;  // of a waypoint
constexpr size_t kHoldOffset = 2;
constexpr size_t kSpeedOffset = 3;
static_assert(kWaypointsOffset + kMaxWaypoints * kWaypointBytes <= kMaxMessageBytes);

// The body of an alive: the press u32, or nothing, which is no press.
constexpr size_t kPressOffset = kHeaderBytes;
constexpr size_t kAliveBytes = kHeaderBytes + 4;

constexpr size_t kDoneBytes = kHeaderBytes + 2;
constexpr size_t kParametersBytes = kHeaderBytes + 8;  // and the part

bool IsKind(uint8_t kind) {
  return (kind >= static_cast<uint8_t>(Kind::kArm) &&
          kind <= static_cast<uint8_t>(Kind::kClearAreas)) ||
         kind == static_cast<uint8_t>(Kind::kGetStatus) ||
         kind == static_cast<uint8_t>(Kind::kGetParameters) ||
         (kind >= static_cast<uint8_t>(Kind::kDone) &&
          kind <= static_cast<uint8_t>(Kind::kParameters));
}

// The members that its frame does not use are not looked at.
Status Check(const Waypoint& waypoint) {
  if (waypoint.hold_s > 0 && !waypoint.stops) return Status::kInvalidArgument;
  switch (waypoint.frame) {
    case GoalFrame::kOdom:
    case GoalFrame::kBody:
      return Both(CheckWithin(waypoint.position_m.x_m, kMaxPosition_m),
                  CheckWithin(waypoint.position_m.y_m, kMaxPosition_m));
    case GoalFrame::kGeodetic:
      return Both(CheckWithin(waypoint.latitude_ndeg, kMaxLatitude_ndeg),
                  CheckWithin(waypoint.longitude_ndeg, kMaxLongitude_ndeg));
  }
  return Status::kInvalidArgument;
}

Status CheckHeading(GoalFrame frame, float heading_rad) {
  if (frame != GoalFrame::kOdom && frame != GoalFrame::kBody) return Status::kInvalidArgument;
  return CheckWithin(heading_rad, kMaxHeading_rad);
}

// In place: a copy of it would be a loop without a bound of its own.
void ReadWaypoint(ByteReader& reader, size_t offset, Waypoint& waypoint) {
  waypoint = Waypoint{};
  waypoint.frame = static_cast<GoalFrame>(reader.U8(offset));
  waypoint.stops = reader.U8(offset + kStopOffset) == 1;
  waypoint.hold_s = reader.U8(offset + kHoldOffset);
  waypoint.speed_dmps = reader.U8(offset + kSpeedOffset);
  if (waypoint.frame == GoalFrame::kGeodetic) {
    waypoint.latitude_ndeg = static_cast<int64_t>(reader.U64(offset + 4));
    waypoint.longitude_ndeg = static_cast<int64_t>(reader.U64(offset + 12));
  } else {
    waypoint.position_m = {reader.F32(offset + 4), reader.F32(offset + 8)};
  }
}

void WriteWaypoint(const Waypoint& waypoint, MessageWriter& writer) {
  writer.U8(static_cast<uint8_t>(waypoint.frame));
  writer.U8(waypoint.stops ? 1 : 0);
  writer.U8(waypoint.hold_s);
  writer.U8(waypoint.speed_dmps);
  if (waypoint.frame == GoalFrame::kGeodetic) {
    writer.U64(static_cast<uint64_t>(waypoint.latitude_ndeg));
    writer.U64(static_cast<uint64_t>(waypoint.longitude_ndeg));
  } else {
    writer.F32(waypoint.position_m.x_m);
    writer.F32(waypoint.position_m.y_m);
    writer.U64(0);
  }
}

Status CheckWaypointBytes(ByteReader& reader, size_t offset) {
  Waypoint waypoint;
  ReadWaypoint(reader, offset, waypoint);
  const Status status = Check(waypoint);
  if (status != Status::kOk) return status;
  const bool metres = waypoint.frame != GoalFrame::kGeodetic;
  const bool fits =
      reader.U8(offset + kStopOffset) <= 1 && (!metres || reader.U64(offset + 12) == 0);
  return fits ? Status::kOk : Status::kInvalidArgument;
}

Status CheckHeadingBytes(ByteReader& reader) {
  const uint8_t has_heading = reader.U8(kHasHeadingOffset);
  const uint8_t frame = reader.U8(kHeadingFrameOffset);
  if (has_heading > 1 || reader.U8(kGoalZeroOffset) != 0) return Status::kInvalidArgument;
  if (has_heading == 1) {
    return CheckHeading(static_cast<GoalFrame>(frame), reader.F32(kHeadingOffset));
  }
  return frame == 0 && reader.U32(kHeadingOffset) == 0 ? Status::kOk : Status::kInvalidArgument;
}

// Precondition: the message has a header.
Status CheckGoal(std::span<const uint8_t> message) {
  if (message.size() < kWaypointsOffset) return Status::kTruncated;
  ByteReader reader(message);
  const size_t count = reader.U8(kCountOffset);
  if (count < 1 || count > kMaxWaypoints) return Status::kInvalidArgument;
  const Status size = CheckSize(message.size(), kWaypointsOffset + count * kWaypointBytes);
  if (size != Status::kOk) return size;
  const Status heading = CheckHeadingBytes(reader);
  if (heading != Status::kOk) return heading;
  HP_LOOP_BOUND(kMaxWaypoints)
  for (size_t i = 0; i < count; ++i) {
    const Status status = CheckWaypointBytes(reader, kWaypointsOffset + i * kWaypointBytes);
    if (status != Status::kOk) return status;
  }
  const size_t last = kWaypointsOffset + (count - 1) * kWaypointBytes;
  return reader.U8(last + kHoldOffset) == 0 ? Status::kOk : Status::kInvalidArgument;
}

// Precondition: the message has a header. A press of 0 is written as none.
Status CheckAlive(std::span<const uint8_t> message) {
  if (message.size() == kHeaderBytes) return Status::kOk;
  const Status size = CheckSize(message.size(), kAliveBytes);
  if (size != Status::kOk) return size;
  ByteReader reader(message);
  return reader.U32(kPressOffset) != 0 ? Status::kOk : Status::kInvalidArgument;
}

Status CheckBody(Kind kind, std::span<const uint8_t> message) {
  if (kind == Kind::kGoal) return CheckGoal(message);
  if (kind == Kind::kAlive) return CheckAlive(message);
  if (kind == Kind::kArea) return CheckArea(message);
  return CheckSize(message.size(), kHeaderBytes);
}

// Precondition: CheckGoal.
void ReadGoal(std::span<const uint8_t> message, OperatorCommand& command) {
  ByteReader reader(message);
  command.waypoints = reader.U8(kCountOffset);
  command.has_heading = reader.U8(kHasHeadingOffset) == 1;
  command.heading_frame = static_cast<GoalFrame>(reader.U8(kHeadingFrameOffset));
  command.heading_rad = reader.F32(kHeadingOffset);
  HP_LOOP_BOUND(kMaxWaypoints)
  for (int i = 0; i < command.waypoints; ++i) {
    const size_t offset = kWaypointsOffset + static_cast<size_t>(i) * kWaypointBytes;
    ReadWaypoint(reader, offset, command.waypoint[i]);
  }
  HP_LOOP_BOUND(kMaxWaypoints)
  for (int i = command.waypoints; i < kMaxWaypoints; ++i) command.waypoint[i] = Waypoint{};
}

Status Check(const OperatorCommand& command) {
  if (command.kind < Kind::kArm || !IsCommand(command.kind)) return Status::kInvalidArgument;
  if (command.kind == Kind::kArea) return CheckArea(command);
  if (command.kind != Kind::kGoal) return Status::kOk;
  if (command.waypoints < 1 || command.waypoints > kMaxWaypoints) return Status::kInvalidArgument;
  HP_LOOP_BOUND(kMaxWaypoints)
  for (int i = 0; i < command.waypoints; ++i) {
    const Status status = Check(command.waypoint[i]);
    if (status != Status::kOk) return status;
  }
  if (command.waypoint[command.waypoints - 1].hold_s > 0) return Status::kInvalidArgument;
  return command.has_heading ? CheckHeading(command.heading_frame, command.heading_rad)
                             : Status::kOk;
}

Status CheckPart(uint32_t offset, uint32_t whole_bytes, size_t part_bytes) {
  if (whole_bytes > kMaxParametersBytes || offset > whole_bytes || part_bytes > kMaxPartBytes ||
      part_bytes > whole_bytes - offset || (part_bytes == 0 && offset != whole_bytes)) {
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

}  // namespace

Status ReadHeader(std::span<const uint8_t> message, Header& header) {
  ByteReader reader(message);
  if (message.size() < kHeaderBytes) return Status::kTruncated;
  if (reader.U32(kMagicOffset) != kMagic) return Status::kWrongPacketType;
  if (reader.U8(kVersionOffset) != kVersion) return Status::kUnsupported;
  header.sequence = reader.U32(kSequenceOffset);
  const uint8_t kind = reader.U8(kKindOffset);
  if (!IsKind(kind)) return Status::kInvalidArgument;
  if (message.size() > kMaxMessageBytes) return Status::kOversized;
  const Status size = CheckSize(message.size(), reader.U16(MessageWriter::kSizeOffset));
  if (size == Status::kOk) header.kind = static_cast<Kind>(kind);
  return size;
}

Status Decode(std::span<const uint8_t> message, OperatorCommand& command) {
  Header header;
  const Status status = ReadHeader(message, header);
  if (status != Status::kOk) return status;
  if (!IsCommand(header.kind)) return Status::kWrongPacketType;
  const Status body = CheckBody(header.kind, message);
  if (body != Status::kOk) return body;
  command.kind = header.kind;
  command.sequence = header.sequence;
  command.press = 0;
  if (header.kind == Kind::kAlive && message.size() == kAliveBytes) {
    command.press = ByteReader(message).U32(kPressOffset);
  }
  command.waypoints = 0;
  command.has_heading = false;
  command.heading_frame = GoalFrame::kOdom;
  command.heading_rad = 0.0f;
  if (header.kind == Kind::kGoal) ReadGoal(message, command);
  if (header.kind == Kind::kArea) ReadArea(message, command);
  return Status::kOk;
}

Status Decode(std::span<const uint8_t> message, Question& question) {
  Header header;
  const Status status = ReadHeader(message, header);
  if (status != Status::kOk) return status;
  if (!IsQuestion(header.kind)) return Status::kWrongPacketType;
  const bool has_offset = header.kind == Kind::kGetParameters;
  const Status size = CheckSize(message.size(), kHeaderBytes + (has_offset ? 4 : 0));
  if (size != Status::kOk) return size;
  ByteReader reader(message);
  const uint32_t offset = has_offset ? reader.U32(kHeaderBytes) : 0;
  if (offset > kMaxParametersBytes) return Status::kInvalidArgument;
  question = {header.kind, header.sequence, offset};
  return Status::kOk;
}

Status Decode(std::span<const uint8_t> message, Done& answer) {
  Header header;
  const Status status = ReadHeader(message, header);
  if (status != Status::kOk) return status;
  if (header.kind != Kind::kDone) return Status::kWrongPacketType;
  const Status size = CheckSize(message.size(), kDoneBytes);
  if (size != Status::kOk) return size;
  ByteReader reader(message);
  answer = {header.sequence, static_cast<Status>(reader.U8(kHeaderBytes)),
            reader.U8(kHeaderBytes + 1)};
  return Status::kOk;
}

Status Decode(std::span<const uint8_t> message, ParametersPart& answer) {
  Header header;
  const Status status = ReadHeader(message, header);
  if (status != Status::kOk) return status;
  if (header.kind != Kind::kParameters) return Status::kWrongPacketType;
  if (message.size() < kParametersBytes) return Status::kTruncated;
  ByteReader reader(message);
  const uint32_t offset = reader.U32(kHeaderBytes);
  const uint32_t whole_bytes = reader.U32(kHeaderBytes + 4);
  const std::span<const uint8_t> bytes = message.subspan(kParametersBytes);
  const Status range = CheckPart(offset, whole_bytes, bytes.size());
  if (range == Status::kOk) answer = {header.sequence, offset, whole_bytes, bytes};
  return range;
}

Status Encode(const OperatorCommand& command, std::span<uint8_t> buffer, int& size_bytes) {
  size_bytes = 0;
  const Status status = Check(command);
  if (status != Status::kOk) return status;
  const bool goal = command.kind == Kind::kGoal;
  const bool pressed = command.kind == Kind::kAlive && command.press != 0;
  size_t needed = pressed ? kAliveBytes : kHeaderBytes;
  const bool area = command.kind == Kind::kArea;
  if (area) needed = AreaBytes(command.area);
  if (goal) needed = kWaypointsOffset + static_cast<size_t>(command.waypoints) * kWaypointBytes;
  if (buffer.size() < needed) return Status::kCapacityExceeded;
  MessageWriter writer(buffer, command.kind, command.sequence);
  if (pressed) writer.U32(command.press);
  if (area) WriteArea(command, writer);
  if (!goal) return writer.Finish(size_bytes);
  writer.U8(static_cast<uint8_t>(command.waypoints));
  writer.U8(command.has_heading ? 1 : 0);
  writer.U8(command.has_heading ? static_cast<uint8_t>(command.heading_frame) : uint8_t{0});
  writer.U8(0);
  writer.F32(command.has_heading ? command.heading_rad : 0.0f);
  HP_LOOP_BOUND(kMaxWaypoints)
  for (int i = 0; i < command.waypoints; ++i) WriteWaypoint(command.waypoint[i], writer);
  return writer.Finish(size_bytes);
}

Status Encode(const Question& question, std::span<uint8_t> buffer, int& size_bytes) {
  size_bytes = 0;
  const bool has_offset = question.kind == Kind::kGetParameters;
  if (!IsQuestion(question.kind) || question.offset > kMaxParametersBytes ||
      (!has_offset && question.offset != 0)) {
    return Status::kInvalidArgument;
  }
  if (buffer.size() < kHeaderBytes + (has_offset ? 4u : 0u)) return Status::kCapacityExceeded;
  MessageWriter writer(buffer, question.kind, question.sequence);
  if (has_offset) writer.U32(question.offset);
  return writer.Finish(size_bytes);
}

Status Encode(const Done& answer, std::span<uint8_t> buffer, int& size_bytes) {
  size_bytes = 0;
  if (buffer.size() < kDoneBytes) return Status::kCapacityExceeded;
  MessageWriter writer(buffer, Kind::kDone, answer.sequence);
  writer.U8(static_cast<uint8_t>(answer.status));
  writer.U8(answer.reason);
  return writer.Finish(size_bytes);
}

Status Encode(const ParametersPart& answer, std::span<uint8_t> buffer, int& size_bytes) {
  size_bytes = 0;
  const Status range = CheckPart(answer.offset, answer.whole_bytes, answer.bytes.size());
  if (range != Status::kOk) return range;
  if (buffer.size() < kParametersBytes + answer.bytes.size()) return Status::kCapacityExceeded;
  MessageWriter writer(buffer, Kind::kParameters, answer.sequence);
  writer.U32(answer.offset);
  writer.U32(answer.whole_bytes);
  HP_LOOP_BOUND(kMaxPartBytes)
  for (const uint8_t byte : answer.bytes) writer.U8(byte);
  return writer.Finish(size_bytes);
}

}  // namespace hardpack::control
