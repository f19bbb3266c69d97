// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Dead reckoning: wheel speeds and the INS's yaw rate summed up into the pose body -> odom. Roll
// and pitch are those of the INS, the height stays 0. It does not filter, weigh or bound its drift:
// odom is where the vehicle has been since its start, smooth and never corrected (REP-105).
//
//   v     = ground_per_wheel r (w_l + w_r) / 2
//   w     = yaw rate of the INS in the body frame, or r (w_r - w_l) / skid_baseline
//   theta' = theta + w dt;  (x, y)' = (x, y) + v dt (cos, sin)(theta + w dt / 2)

namespace hardpack {

class DeadReckoning {
 public:
  // A pause of the ticks or of the wheel speeds that is longer than this is not bridged: the pose
  // stays where it was, and it counts as a jump.
  static constexpr int64_t kMaxStep_ns = 200'000'000;

  // At the origin, at rest. kParameterOutOfRange: odometry or ins; `vehicle` was checked before.
  Status Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                   const InsParams& ins);

  // A message of the INS that came at host_ns. Uses its angular rate and attitude where it has
  // them; the rate of a message with the stamp of the one before is not taken again. kNotFinite:
  // nothing changes; kInvalidArgument: host_ns is before the last one's.
  Status TakeIns(const InsSample& sample, uint64_t host_ns);

  // To now_ns, with the newest wheel speeds. kOk; kStale: they are not valid: the pose stays where
  // it is, and so does moved_ns(); kInvalidArgument: time does not grow; kNotFinite: a wheel speed
  // (as kStale). Constant cost.
  Status Advance(uint64_t now_ns, const WheelFeedback& wheels);

  const StampedPose& pose() const { return pose_; }
  float speed_mps() const { return speed_mps_; }
  float yaw_rate_radps() const { return yaw_rate_radps_; }
  // When wheel speeds last moved it; 0: never.
  uint64_t moved_ns() const { return moved_ns_; }
  bool uses_ins_rate() const { return uses_ins_rate_; }
  uint32_t gaps() const { return gaps_; }

 private:
  void TakeAttitude(const InsSample& sample);
  float YawRate(uint64_t now_ns, const WheelFeedback& wheels);

  VehicleParams vehicle_;
  OdometryParams params_;
  float body_from_ins_[9] = {};  // [3 x 3], row-major
  bool configured_ = false;
  bool has_rate_ = false;
  uint64_t ins_ns_ = 0;
  uint64_t rate_ns_ = 0;
  uint64_t rate_stamp_ns_ = 0;  // the device's
  float ins_yaw_rate_radps_ = 0.0f;
  StampedPose pose_;
  float speed_mps_ = 0.0f;
  float yaw_rate_radps_ = 0.0f;
  uint64_t moved_ns_ = 0;
  bool uses_ins_rate_ = false;
  uint32_t gaps_ = 0;
};
static_assert(std::is_trivially_copyable_v<DeadReckoning>);

}  // namespace hardpack
