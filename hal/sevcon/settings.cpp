// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/settings.h"

#include "core/base/saturate.h"

namespace hardpack::sevcon {
namespace {

// Bits of the identifiers in 1005h, 1400h and 1800h (CiA 301, 7.5.2).
constexpr uint32_t kNotInUse = 0x80000000u;
constexpr uint32_t kProduces = 0x40000000u;  // of 1005h; of 1800h: no remote frames
constexpr uint32_t kIdBits = 0x3fffffffu;    // a bit of 29-bit identifiers among them

// Transmission types (CiA 301, table 71).
constexpr uint32_t kLastSynchronous = 240;
constexpr uint32_t kFirstEventDriven = 254;

// A mapped object: index, subindex, length in bits.
constexpr uint32_t Mapped(uint32_t index, uint32_t bits) {
  return index << 16u | bits;
}

// Each n-th SYNC gives a report.
bool IsOftenEnough(uint32_t type, const DriveParams& params) {
  if (type == 0 || type > kLastSynchronous) return type >= kFirstEventDriven;
  if (params.sync_period_ms == 0) return type == 1;
  return type * static_cast<uint32_t>(params.sync_period_ms) <
         static_cast<uint32_t>(params.feedback_timeout_ms);
}

}  // namespace

bool IsLeftOut(Wanted wanted, const DriveParams& params) {
  return (wanted == Wanted::kSync && params.sync_period_ms == 0) ||
         (wanted == Wanted::kAcceleration && params.motor_acceleration_rpmps <= 0.0f);
}

uint32_t ValueOf(Wanted wanted, const DriveParams& params) {
  switch (wanted) {
    case Wanted::kSync:
      return kSyncId;
    case Wanted::kWatchUs:
      return static_cast<uint32_t>(params.master_node) << 16u |
             static_cast<uint32_t>(params.heartbeat_timeout_ms);
    case Wanted::kHeartbeat:
      return static_cast<uint32_t>(params.heartbeat_period_ms);
    case Wanted::kCommandTimeout:
      return static_cast<uint32_t>(params.command_timeout_ms);
    case Wanted::kTimeoutScheme:
      return static_cast<uint32_t>(params.command_timeout_scheme);
    case Wanted::kMode:
      return static_cast<uint32_t>(params.operation_mode);
    case Wanted::kAcceleration:
      return static_cast<uint32_t>(RoundToInt(params.motor_acceleration_rpmps));
    default:
      return 0;
  }
}

bool Matches(Wanted wanted, uint32_t value, const DriveParams& params, int32_t node) {
  switch (wanted) {
    case Wanted::kVendor:
      return params.vendor_id == 0 || value == static_cast<uint32_t>(params.vendor_id);
    case Wanted::kProduct:
      return params.product_code == 0 || value == static_cast<uint32_t>(params.product_code);
    case Wanted::kSync:
      return (value & (kIdBits | kProduces)) == kSyncId;
    case Wanted::kCommandId:
      return (value & (kIdBits | kNotInUse)) == IdOf(kCommandBase, node);
    case Wanted::kFeedbackId:
      return (value & (kIdBits | kNotInUse)) == IdOf(kFeedbackBase, node);
    case Wanted::kCommandType:
      return value >= kFirstEventDriven;
    case Wanted::kFeedbackType:
      return IsOftenEnough(value, params);
    case Wanted::kFeedbackPeriod:
      return value > 0 && value < static_cast<uint32_t>(params.feedback_timeout_ms);
    case Wanted::kCount:
      return value == 3;
    case Wanted::kControlword:
      return value == Mapped(0x6040, 16);
    case Wanted::kTargetSpeed:
      return value == Mapped(0x60FF, 32);
    case Wanted::kMaxTorque:
      return value == Mapped(0x6072, 16);
    case Wanted::kStatusword:
      return value == Mapped(0x6041, 16);
    case Wanted::kActualSpeed:
      return value == Mapped(0x606C, 32);
    case Wanted::kTorque:
      return value == Mapped(0x6077, 16);
    case Wanted::kSpeedLimit:
      return true;
    default:
      return value == ValueOf(wanted, params);
  }
}

}  // namespace hardpack::sevcon
