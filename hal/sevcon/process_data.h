// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/math.h"
#include "core/base/saturate.h"
#include "hal/can_frame.h"
#include "hal/sevcon/canopen.h"

// The process data of one drive, as mapped (settings.h verifies it), and the conversion between
// motor rpm and wheel rad/s.
//
//   bytes        0-1               2-5                      6-7
//   0x200 + N    6040h controlword 60FFh target rpm i32     6072h torque limit, 0.001 of the rating
//   0x180 + N    6041h statusword  606Ch actual rpm i32     6077h torque i16, 0.001 of the rating

namespace hardpack::sevcon {

inline constexpr uint8_t kProcessData_bytes = 8;
inline constexpr int32_t kMaxReported_rpm = 20000;  // limits of 606Ch and 60FFh

struct MotorCommand {
  uint16_t controlword = 0;
  int32_t speed_rpm = 0;
  int32_t max_torque_permille = 0;
};
constexpr CanFrame Pack(int32_t node, const MotorCommand& command) {
  CanFrame frame = MakeFrame(IdOf(kCommandBase, node), kProcessData_bytes);
  PutLittleEndian(frame, 0, 2, command.controlword);
  PutLittleEndian(frame, 2, 4, static_cast<uint32_t>(command.speed_rpm));
  PutLittleEndian(frame, 6, 2, static_cast<uint32_t>(command.max_torque_permille));
  return frame;
}

struct MotorFeedback {
  uint16_t statusword = 0;
  int32_t speed_rpm = 0;
  int32_t torque_permille = 0;
};
// False: not 8 bytes, or a speed outside the range of 606Ch.
constexpr bool Unpack(const CanFrame& frame, MotorFeedback& feedback) {
  if (frame.size != kProcessData_bytes) return false;
  const auto speed_rpm = static_cast<int32_t>(LittleEndian(frame, 2, 4));
  if (speed_rpm > kMaxReported_rpm || speed_rpm < -kMaxReported_rpm) return false;
  feedback.statusword = static_cast<uint16_t>(LittleEndian(frame, 0, 2));
  feedback.speed_rpm = speed_rpm;
  feedback.torque_permille = static_cast<int16_t>(LittleEndian(frame, 6, 2));
  return true;
}

// Rotation of a wheel and of its motor. sign: 1 or -1, of the motor when the wheel drives forward;
// gear_ratio: motor turns per wheel turn.
inline constexpr float kRadps_per_rpm = kTwoPi / 60.0f;
constexpr float WheelSpeed_radps(int32_t motor_rpm, int32_t sign, float gear_ratio) {
  return static_cast<float>(motor_rpm * sign) * (kRadps_per_rpm / gear_ratio);
}
// To the nearest rpm, at most limit_rpm either way. NaN: 0.
constexpr int32_t MotorSpeed_rpm(float wheel_radps, int32_t sign, float gear_ratio,
                                 int32_t limit_rpm) {
  const int32_t rpm = RoundToInt(wheel_radps * (gear_ratio / kRadps_per_rpm));
  return sign * ClampInt(rpm, -limit_rpm, limit_rpm);
}

}  // namespace hardpack::sevcon
