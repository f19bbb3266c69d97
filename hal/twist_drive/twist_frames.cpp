// SPDX-License-Identifier: Apache-2.0
#include "hal/twist_drive/twist_frames.h"

#include <array>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack::twist_drive {
namespace {

constexpr int kCrcByte = kFrame_bytes - 1;

// Of a command's second byte.
constexpr uint32_t kEnableBit = 0x01u;
constexpr uint32_t kResetBit = 0x02u;
constexpr uint32_t kSteeringBit = 0x04u;
// Of a feedback's second byte: the state in the lowest three.
constexpr uint32_t kStateBits = 0x07u;
constexpr uint32_t kMeasuresSteeringBit = 0x08u;
constexpr uint32_t kTimedOutBit = 0x10u;

consteval std::array<uint8_t, 256> MakeCrcTable() {
  constexpr uint32_t kPolynomial = 0x1du;
  std::array<uint8_t, 256> table{};
  HP_LOOP_BOUND(256)
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t crc = byte;
    HP_LOOP_BOUND(8)
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc << 1u) ^ ((crc & 0x80u) != 0 ? kPolynomial : 0u);
    }
    table[byte] = static_cast<uint8_t>(crc & 0xffu);
  }
  return table;
}
constexpr std::array<uint8_t, 256> kCrcTable = MakeCrcTable();

uint32_t U16(const CanFrame& frame, int at) {
  return uint32_t{frame.data[at]} | uint32_t{frame.data[at + 1]} << 8u;
}

int32_t I8(const CanFrame& frame, int at) {
  const int32_t byte = frame.data[at];
  return byte < 128 ? byte : byte - 256;
}

int16_t I16(const CanFrame& frame, int at) {
  return static_cast<int16_t>(static_cast<uint16_t>(U16(frame, at)));
}

void PutU16(uint32_t value, int at, CanFrame& frame) {
  frame.data[at] = static_cast<uint8_t>(value & 0xffu);
  frame.data[at + 1] = static_cast<uint8_t>(value >> 8u & 0xffu);
}

void PutI16(int16_t value, int at, CanFrame& frame) {
  PutU16(static_cast<uint16_t>(value), at, frame);
}

CanFrame FrameOf(uint32_t id, uint8_t counter, uint32_t second) {
  CanFrame frame;
  frame.id = id;
  frame.size = kFrame_bytes;
  frame.data[0] = counter;
  frame.data[1] = static_cast<uint8_t>(second);
  return frame;
}

Status CheckFrame(const CanFrame& frame) {
  if (frame.extended || frame.remote || frame.size != kFrame_bytes) return Status::kWrongPacketType;
  return frame.data[kCrcByte] == CrcOf(frame) ? Status::kOk : Status::kBadCrc;
}

bool IsValue(int16_t value) {
  return value >= -kMostInteger;
}

TurnKind KindOf(bool steering) {
  return steering ? TurnKind::kSteering : TurnKind::kYawRate;
}

}  // namespace

uint8_t CrcOf(const CanFrame& frame) {
  uint32_t crc = 0xffu;
  crc = kCrcTable[(crc ^ frame.id) & 0xffu];
  crc = kCrcTable[(crc ^ frame.id >> 8u) & 0xffu];
  HP_LOOP_BOUND(kFrame_bytes - 1)
  for (int i = 0; i < kCrcByte; ++i) crc = kCrcTable[(crc ^ frame.data[i]) & 0xffu];
  return static_cast<uint8_t>(~crc & 0xffu);
}

CanFrame Encode(uint32_t id, const Command& command) {
  const uint32_t bits = (command.enable ? kEnableBit : 0u) |
                        (command.reset_faults ? kResetBit : 0u) |
                        (command.turn_kind == TurnKind::kSteering ? kSteeringBit : 0u);
  CanFrame frame = FrameOf(id, command.counter, bits);
  PutI16(command.speed, 2, frame);
  PutI16(command.turn, 4, frame);
  frame.data[kCrcByte] = CrcOf(frame);
  return frame;
}

CanFrame Encode(uint32_t id, const Feedback& feedback) {
  const uint32_t bits = static_cast<uint32_t>(feedback.state) |
                        (feedback.turn_kind == TurnKind::kSteering ? kMeasuresSteeringBit : 0u) |
                        (feedback.timed_out ? kTimedOutBit : 0u);
  CanFrame frame = FrameOf(id, feedback.counter, bits);
  PutI16(feedback.speed, 2, frame);
  PutI16(feedback.turn, 4, frame);
  frame.data[6] = feedback.echo;
  frame.data[kCrcByte] = CrcOf(frame);
  return frame;
}

CanFrame Encode(uint32_t id, const ControllerStatus& status) {
  CanFrame frame = FrameOf(id, status.counter, status.version);
  PutU16(status.faults, 2, frame);
  PutU16(status.battery, 4, frame);
  frame.data[6] = static_cast<uint8_t>(ClampInt(status.temperature_degC, -128, 127));
  frame.data[kCrcByte] = CrcOf(frame);
  return frame;
}

Status Decode(const CanFrame& frame, Command& command) {
  if (const Status status = CheckFrame(frame); !IsUsable(status)) return status;
  const uint32_t bits = frame.data[1];
  const bool fits = bits < 2u * kSteeringBit && frame.data[6] == 0 && IsValue(I16(frame, 2)) &&
                    IsValue(I16(frame, 4));
  if (!fits) return Status::kInvalidArgument;
  command = {frame.data[0],           (bits & kEnableBit) != 0,
             (bits & kResetBit) != 0, KindOf((bits & kSteeringBit) != 0),
             I16(frame, 2),           I16(frame, 4)};
  return Status::kOk;
}

Status Decode(const CanFrame& frame, Feedback& feedback) {
  if (const Status status = CheckFrame(frame); !IsUsable(status)) return status;
  const uint32_t bits = frame.data[1];
  const uint32_t state = bits & kStateBits;
  const bool fits = state < kControllerStates && bits < 2u * kTimedOutBit &&
                    IsValue(I16(frame, 2)) && IsValue(I16(frame, 4));
  if (!fits) return Status::kInvalidArgument;
  feedback = {frame.data[0],
              static_cast<ControllerState>(state),
              KindOf((bits & kMeasuresSteeringBit) != 0),
              (bits & kTimedOutBit) != 0,
              I16(frame, 2),
              I16(frame, 4),
              frame.data[6]};
  return Status::kOk;
}

Status Decode(const CanFrame& frame, ControllerStatus& status) {
  if (const Status checked = CheckFrame(frame); !IsUsable(checked)) return checked;
  status = {frame.data[0], static_cast<uint16_t>(U16(frame, 2)), frame.data[1],
            static_cast<uint16_t>(U16(frame, 4)), I8(frame, 6)};
  return Status::kOk;
}

int16_t ToInteger(float value, float per_unit) {
  return static_cast<int16_t>(ClampInt(RoundToInt(value * per_unit), -kMostInteger, kMostInteger));
}

}  // namespace hardpack::twist_drive
