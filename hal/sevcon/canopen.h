// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/loop_bound.h"
#include "hal/can_frame.h"

// The parts of CANopen (CiA 301) that the master of two drives needs: identifiers, network
// management, heartbeat, SYNC, emergency messages, and the expedited transfer of service data
// objects (SDO). Outgoing frames are complete; incoming frames may be anything, and incomplete ones
// are not decoded. All numbers are little-endian.

namespace hardpack::sevcon {

// The predefined connection set (CiA 301, 7.3.3): a node's identifiers are base + node.
inline constexpr uint32_t kNmtId = 0x000;
inline constexpr uint32_t kSyncId = 0x080;
inline constexpr uint32_t kEmergencyBase = 0x080;
inline constexpr uint32_t kFeedbackBase = 0x180;     // TPDO 1: from the drive
inline constexpr uint32_t kCommandBase = 0x200;      // RPDO 1: to the drive
inline constexpr uint32_t kSdoAnswerBase = 0x580;    // from the drive
inline constexpr uint32_t kSdoQuestionBase = 0x600;  // to the drive
inline constexpr uint32_t kHeartbeatBase = 0x700;

constexpr uint32_t IdOf(uint32_t base, int32_t node) {
  return base + static_cast<uint32_t>(node);
}

enum class NmtCommand : uint8_t {
  kNone = 0,  // not in the standard: nothing is sent
  kStart = 0x01,
  kEnterPreOperational = 0x80,
};

enum class NmtState : uint8_t {
  kBootUp = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7f,
  kUnknown = 0xff,  // not in the standard: not heard
};

constexpr uint32_t LittleEndian(const CanFrame& frame, int first, int bytes) {
  uint32_t value = 0;
  HP_LOOP_BOUND(4)
  for (int i = 0; i < bytes; ++i) {
    value |= static_cast<uint32_t>(frame.data[first + i]) << (8 * i);
  }
  return value;
}
constexpr void PutLittleEndian(CanFrame& frame, int first, int bytes, uint32_t value) {
  HP_LOOP_BOUND(4)
  for (int i = 0; i < bytes; ++i) {
    frame.data[first + i] = static_cast<uint8_t>((value >> (8 * i)) & 0xffu);
  }
}

constexpr CanFrame MakeFrame(uint32_t id, uint8_t size) {
  CanFrame frame;
  frame.id = id;
  frame.size = size;
  return frame;
}
// To one node: never to all (0), which would also start nodes that are not ours.
constexpr CanFrame NmtFrame(NmtCommand command, int32_t node) {
  CanFrame frame = MakeFrame(kNmtId, 2);
  frame.data[0] = static_cast<uint8_t>(command);
  frame.data[1] = static_cast<uint8_t>(node);
  return frame;
}
constexpr CanFrame HeartbeatFrame(int32_t node, NmtState state) {
  CanFrame frame = MakeFrame(IdOf(kHeartbeatBase, node), 1);
  frame.data[0] = static_cast<uint8_t>(state);
  return frame;
}
constexpr CanFrame SyncFrame() {
  return MakeFrame(kSyncId, 0);
}

// Emergency message (CiA 301, 7.2.7); bytes 3 and 4 are the manufacturer's fault id (Gen4).
struct Emergency {
  uint16_t code = 0;  // 0: error cleared
  uint8_t error_register = 0;
  uint16_t fault_id = 0;
};
// Precondition: size 8.
constexpr Emergency DecodeEmergency(const CanFrame& frame) {
  return {static_cast<uint16_t>(LittleEndian(frame, 0, 2)), frame.data[2],
          static_cast<uint16_t>(LittleEndian(frame, 3, 2))};
}

// Abort codes (CiA 301, table 22).
inline constexpr uint32_t kAbortNoObject = 0x06020000;
inline constexpr uint32_t kAbortNoSubindex = 0x06090011;
inline constexpr uint32_t kAbortGeneral = 0x08000000;

// A request to a node's object dictionary: to read or to write an object.
struct SdoQuestion {
  uint16_t index = 0;
  uint8_t subindex = 0;
  uint8_t size = 4;  // of the object: 1 .. 4 bytes
  bool write = false;
  uint32_t value = 0;  // to write; signed values as two's complement
};

// Bit mask of an object of this size.
constexpr uint32_t BitsOf(uint32_t size) {
  return size >= 4 ? 0xffffffffu : (1u << (8u * size)) - 1u;
}

// Expedited upload or download request (CiA 301, 7.2.4.3). Precondition: size 1 .. 4.
constexpr CanFrame SdoQuestionFrame(int32_t node, const SdoQuestion& question) {
  CanFrame frame = MakeFrame(IdOf(kSdoQuestionBase, node), 8);
  frame.data[0] =
      question.write ? static_cast<uint8_t>(0x23u | ((4u - question.size) << 2u)) : uint8_t{0x40};
  PutLittleEndian(frame, 1, 2, question.index);
  frame.data[3] = question.subindex;
  if (question.write) PutLittleEndian(frame, 4, 4, question.value & BitsOf(question.size));
  return frame;
}

enum class SdoAnswerKind : uint8_t {
  kOther = 0,  // not an expedited answer: segmented, a block, or not in the standard
  kValue,
  kWritten,
  kAbort,
};
struct SdoAnswer {
  SdoAnswerKind kind = SdoAnswerKind::kOther;
  uint16_t index = 0;
  uint8_t subindex = 0;
  uint8_t size = 0;    // of the value; 0: not given
  uint32_t value = 0;  // or the abort code
};
// Precondition: size 8.
constexpr SdoAnswer DecodeSdoAnswer(const CanFrame& frame) {
  SdoAnswer answer;
  answer.index = static_cast<uint16_t>(LittleEndian(frame, 1, 2));
  answer.subindex = frame.data[3];
  const uint32_t command = frame.data[0];
  if (command == 0x80u) {
    answer.kind = SdoAnswerKind::kAbort;
    answer.value = LittleEndian(frame, 4, 4);
  } else if (command == 0x60u) {
    answer.kind = SdoAnswerKind::kWritten;
  } else if ((command & 0xe2u) == 0x42u) {
    answer.kind = SdoAnswerKind::kValue;
    const bool told = (command & 1u) != 0;
    answer.size = told ? static_cast<uint8_t>(4u - ((command >> 2u) & 3u)) : uint8_t{0};
    answer.value = LittleEndian(frame, 4, told ? answer.size : 4);
  }
  return answer;
}

}  // namespace hardpack::sevcon
