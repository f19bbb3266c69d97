// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/areas/area.h"
#include "core/base/pose.h"
#include "core/base/status.h"

// The messages between an operator's program and the onboard program: one per packet of a local,
// connection-oriented socket that keeps packets intact (docs/control.md). Encodes and decodes; the
// port decides who may command, and hal/onboard/vehicle_loop what a command does.
//
//   @0 magic "HPCT"  @4 version u8  @5 kind u8  @6 size u16 of the whole  @8 sequence u32  @12 body
//
// All numbers little-endian.

namespace hardpack::control {

inline constexpr uint32_t kMagic = 0x54435048u;
inline constexpr uint8_t kVersion = 1;
inline constexpr int kHeaderBytes = 12;
inline constexpr int kMaxMessageBytes = 4096;
inline constexpr int kMaxWaypoints = 64;

enum class Kind : uint8_t {
  // Commands: they go into the tick and into the flight log.
  kArm = 1,
  kDisarm = 2,
  kGoal = 3,  // one or more waypoints, to be reached in order
  kStop = 4,
  kEmergencyStop = 5,
  kAlive = 6,   // the operator is present: has pressed something since
  kPause = 7,   // stop along the path and keep the goals
  kResume = 8,  // drive on to them, after a pause or a stop
  kSkip = 9,    // on to the next waypoint
  kArea = 10,   // one area of a set, which replaces the operator's earlier ones
  kClearAreas = 11,
  // Questions: they change nothing, and are answered outside the tick.
  kGetStatus = 64,
  kGetParameters = 65,
  // Answers.
  kDone = 128,        // body: status u8, stop reason u8
  kStatus = 129,      // body: a StatusReport
  kParameters = 130,  // body: offset u32, whole size u32, a part of the configuration as TOML
};
constexpr bool IsCommand(Kind kind) {
  return kind <= Kind::kClearAreas;
}
constexpr bool IsQuestion(Kind kind) {
  return kind == Kind::kGetStatus || kind == Kind::kGetParameters;
}
constexpr bool IsAnswer(Kind kind) {
  return kind >= Kind::kDone;
}

// Limits on the numbers of a message.
inline constexpr float kMaxPosition_m = 1.0e6f;  // either way, x and y
inline constexpr float kMaxHeading_rad = 3.1415927f;
inline constexpr int64_t kMaxLatitude_ndeg = 90'000'000'000;
inline constexpr int64_t kMaxLongitude_ndeg = 180'000'000'000;
inline constexpr int kMaxParametersBytes = 1 << 20;  // of the whole configuration

enum class GoalFrame : uint8_t {
  kOdom = 0,      // metres in the local frame
  kBody = 1,      // metres ahead and to the left of the vehicle's pose on acceptance
  kGeodetic = 2,  // latitude and longitude, WGS 84
};

struct Waypoint {
  GoalFrame frame = GoalFrame::kOdom;
  Vec2 position_m;            // kOdom, kBody
  int64_t latitude_ndeg = 0;  // kGeodetic: 1e-9 degree
  int64_t longitude_ndeg = 0;
  // The vehicle comes to rest here, for hold_s; else it passes. At the last one it always does, and
  // there is nothing to hold for: 0.
  bool stops = false;
  uint8_t hold_s = 0;      // 0 unless it stops
  uint8_t speed_dmps = 0;  // limit of the leg that leads here, 0.1 m/s; 0: the configured speed
};

struct OperatorCommand {
  Kind kind = Kind::kAlive;
  uint32_t sequence = 0;
  // kAlive: a different number at every key press of the operator; 0: no press. Without a new one,
  // a forgotten program proves nobody's presence.
  uint32_t press = 0;
  // kGoal:
  int32_t waypoints = 0;  // 1 .. kMaxWaypoints
  Waypoint waypoint[kMaxWaypoints] = {};
  bool has_heading = false;                    // at the last one
  GoalFrame heading_frame = GoalFrame::kOdom;  // kOdom or kBody
  float heading_rad = 0.0f;                    // (-pi, pi]
  // kArea: number area_index, from 0, of the area_count of a set (1 .. kMaxAreas), which are sent
  // in order.
  int32_t area_index = 0;
  int32_t area_count = 0;
  Area area;
};
static_assert(std::is_trivially_copyable_v<OperatorCommand>);

struct Question {
  Kind kind = Kind::kGetStatus;
  uint32_t sequence = 0;
  uint32_t offset = 0;  // kGetParameters: the first requested byte
};

// The result of a command.
struct Done {
  uint32_t sequence = 0;
  Status status = Status::kOk;
  uint8_t reason = 0;  // StopReason: why it was not permitted
};

// A part of the configuration's text.
struct ParametersPart {
  uint32_t sequence = 0;
  uint32_t offset = 0;             // of its first byte
  uint32_t whole_bytes = 0;        // of the text, at most kMaxParametersBytes
  std::span<const uint8_t> bytes;  // empty only if the offset is the end
};
inline constexpr int kMaxPartBytes = kMaxMessageBytes - kHeaderBytes - 8;

struct Header {
  Kind kind = Kind::kAlive;
  uint32_t sequence = 0;
};

// Reads the kind of a message; its body is not examined. If several things are wrong, returns the
// first in this list. kTruncated: no complete header; kWrongPacketType: another magic number;
// kUnsupported: another version; kInvalidArgument: an unknown kind; kTruncated, kOversized: not the
// size that it states, or more than kMaxMessageBytes. On failure header.kind is unchanged;
// header.sequence is the message's, so that its sender can be answered, except after the first
// three. Constant cost.
Status ReadHeader(std::span<const uint8_t> message, Header& header);

// Each decodes exactly one complete message and checks every byte of it: an accepted message
// re-encodes to the same bytes. The statuses of ReadHeader; kWrongPacketType: a message of another
// sort; kTruncated, kOversized: not the size that its body must have; kNotFinite; kInvalidArgument:
// a number out of range (above), an unknown frame, no waypoint or too many, a time to hold where
// nothing stops or at the last one, or a byte that must be 0 and is not. Then the output is
// unchanged. The codes in an answer are not checked, nor whether an area's corners make a polygon
// (CheckArea). Cost: one pass over the bytes, two for a goal or an area. (A command other than a
// goal leaves the waypoints unchanged, one other than an area the area.)
Status Decode(std::span<const uint8_t> message, OperatorCommand& command);
Status Decode(std::span<const uint8_t> message, Question& question);
Status Decode(std::span<const uint8_t> message, Done& answer);
Status Decode(std::span<const uint8_t> message, ParametersPart& answer);  // bytes: of `message`

// Each encodes one message and sets `size_bytes`. kCapacityExceeded: the buffer is too small (never
// with kMaxMessageBytes); kInvalidArgument, kNotFinite: what Decode would refuse. Then nothing is
// written, and `size_bytes` is 0. Cost: as above.
Status Encode(const OperatorCommand& command, std::span<uint8_t> buffer, int& size_bytes);
Status Encode(const Question& question, std::span<uint8_t> buffer, int& size_bytes);
Status Encode(const Done& answer, std::span<uint8_t> buffer, int& size_bytes);
Status Encode(const ParametersPart& answer, std::span<uint8_t> buffer, int& size_bytes);

}  // namespace hardpack::control
