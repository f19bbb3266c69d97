// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// A vehicle with a motion controller of its own, which takes a speed and a turn
// (hal/twist_drive, docs/twist_drive.md).

namespace hardpack {

struct TwistDriveParams {
  static constexpr int32_t kYawRate = 0;
  static constexpr int32_t kSteering = 1;  // with vehicle.kinematics 1
  int32_t turn = kYawRate;                 // what the turn is told as, and measured as
  int32_t command_id = 0x210;              // 11 bits; of the frame that we send ...
  int32_t feedback_id = 0x211;             // ... and of those that the controller sends
  int32_t status_id = 0x212;
  int32_t feedback_timeout_ms = 100;  // age of the motion that the controller reports
  int32_t echo_timeout_ms = 100;      // age of the newest command that it has taken
  float standstill_mps = 0.03f;
  float disable_delay_s = 0.5f;   // at standstill before the controller is disabled
  float enable_timeout_s = 3.0f;  // from asking to `following`, or it is a fault
};

}  // namespace hardpack
