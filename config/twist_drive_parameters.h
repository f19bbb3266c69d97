// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// A vehicle with its own motion controller, which takes a speed and a turn (hal/twist_drive,
// docs/twist_drive.md).

namespace hardpack {

struct TwistDriveParams {
  static constexpr int32_t kYawRate = 0;
  static constexpr int32_t kSteering = 1;  // with vehicle.kinematics 1
  int32_t turn = kYawRate;                 // how the turn is commanded and reported
  int32_t command_id = 0x210;              // 11 bits; of the frame we send ...
  int32_t feedback_id = 0x211;             // ... and of those the controller sends
  int32_t status_id = 0x212;
  int32_t feedback_timeout_ms = 100;  // age of the controller's reported motion
  int32_t echo_timeout_ms = 100;      // age of the newest command it has taken
  float standstill_mps = 0.03f;
  float disable_delay_s = 0.5f;   // at standstill before the controller is disabled
  float enable_timeout_s = 3.0f;  // from the request to `following`, otherwise a fault
};

}  // namespace hardpack
