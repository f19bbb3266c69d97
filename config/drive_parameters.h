// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// The two traction controllers on the CAN bus (hal/sevcon). The traffic on the Warthog's bus is not
// public (docs/vehicle.md): defaults follow the controller's published EDS, and values that are not
// public at all must be set before the onboard program starts.

namespace hardpack {

struct DriveParams {
  int32_t left_node = 2;
  int32_t right_node = 3;
  int32_t master_node = 1;
  int32_t left_sign = 1;  // of the motor speed when the wheel drives forward: 1 or -1
  int32_t right_sign = 1;
  float gear_ratio = 1.0f;  // motor turns per wheel turn; not public: must be set
  float max_motor_speed_rpm = 6000.0f;
  float motor_acceleration_rpmps = 0.0f;  // 6083h; 0: left unchanged
  int32_t max_torque_permille = 1000;     // of the controller's rating, in every command
  int32_t operation_mode = 3;             // 6060h: 3 profile velocity, 4 torque profile
  int32_t command_period_ms = 10;
  int32_t sync_period_ms = 20;        // 0: another node produces SYNC
  int32_t heartbeat_period_ms = 100;  // both ways
  int32_t heartbeat_timeout_ms = 300;
  // How long the drives wait for a command before they stop on their own (1400h:5, written if a
  // drive has it; the published EDS does not: the time is then the drive's own), and their reaction
  // (5902h): 1 warn and slow down, 2 inhibit, 3 severe.
  int32_t command_timeout_ms = 200;
  int32_t command_timeout_scheme = 2;
  int32_t feedback_timeout_ms = 100;  // age of the speed that a drive reports
  int32_t max_frame_age_ms = 100;     // by its receive time; older ones are dropped
  int32_t sdo_timeout_ms = 100;
  int32_t sdo_retries = 3;
  int32_t vendor_id = 0x1e;  // 1018h:1; 0: any
  int32_t product_code = 0;  // 1018h:2; 0: any
  int32_t login_user = 0;    // 5000h; not public
  int32_t login_password = 0;
  int32_t bit_rate_kbps = 1000;  // of the bus, for its load
  int32_t max_bus_load_percent = 60;
  float opposite_speed_radps = 1.0f;  // a wheel that turns against its command faster than this ...
  float opposite_time_s = 0.5f;       // ... for this long is a fault
  float standstill_radps = 0.2f;
  float disable_delay_s = 0.5f;   // at standstill before the drives are disabled
  float enable_timeout_s = 3.0f;  // from the request to operation enabled, otherwise a fault
};

}  // namespace hardpack
