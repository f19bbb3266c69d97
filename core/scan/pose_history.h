// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Where the vehicle was when a lidar column was taken: the latest odometry poses, interpolated
// (motion compensation, one pose per column; docs/algorithm.md section 1). The vehicle turns by up
// to 13 degrees during one revolution of the lidar. Poses are in time order; poses out of order are
// refused. It does not estimate poses, and does not judge their quality.
//
// Between two poses dt apart, the vehicle is assumed to move in a straight line and to turn at a
// constant rate. On an arc at speed v and yaw rate w the error is at most v w dt^2 / 8: 0.14 mm
// with 100 poses a second at 5 m/s and 2.2 rad/s, plus the float32 rounding of the position
// (0.03 mm within 500 m). Extrapolated by t beyond the newest pose it is v w t (t + dt) / 2: 3.3 mm
// after 20 ms, 16.5 mm after 50 ms.

namespace hardpack {

class PoseHistory {
 public:
  static constexpr int kCapacity = 128;  // 1.28 s at 100 Hz
  // How far the newest pose is extrapolated: lidar columns may be a tick or two ahead of the
  // odometry.
  static constexpr int64_t kMaxExtrapolation_ns = 50'000'000;
  // Adjacent poses further apart form a gap: nothing is interpolated across it.
  static constexpr int64_t kMaxGap_ns = 200'000'000;
  // Poses closer together give no velocity: extrapolation would amplify their rounding error.
  static constexpr int64_t kMinVelocityBase_ns = 5'000'000;
  // Coordinates up to this are exact to half a cell in float32 (core/base/grid.h).
  static constexpr float kMaxPosition_m = 838860.0f;

  void Clear();

  // Whether a pose can be stored, regardless of its time. kNotFinite: a number is not finite;
  // kInvalidArgument: a coordinate beyond kMaxPosition_m, an angle beyond kSinCosMaxAngle_rad.
  static Status Check(const StampedPose& pose);
  static bool Takes(const StampedPose& pose) { return Check(pose) == Status::kOk; }

  // The statuses of Check; kInvalidArgument: the time is before the newest pose's; kDuplicate: it
  // is the same. On failure nothing changes. Angles are stored in (-pi, pi]. When full, the oldest
  // pose is dropped. Cost: constant.
  Status Add(const StampedPose& pose);

  // The pose at a time: one that was added; or a linear interpolation between its neighbours
  // (angles the short way round, in (-pi, pi]); or the newest pose, extrapolated with the velocity
  // since the last pose that is at least kMinVelocityBase_ns older and not across a gap; without
  // such a pose, the newest pose unchanged. kNoPose: before the oldest pose, more than
  // kMaxExtrapolation_ns beyond the newest, inside a gap, or no poses; `pose` is untouched.
  // Cost: 7 comparisons; beyond the newest pose up to kCapacity.
  Status At(uint64_t time_ns, StampedPose& pose) const;

  // Raises all poses by dz_m: the odometry's height has jumped, and earlier measurements must be
  // expressed in the new heights. Precondition: dz_m is finite. Cost: kCapacity.
  void ShiftHeights(float dz_m);

  int size() const { return size_; }
  // Precondition: size() > 0.
  const StampedPose& newest() const;

 private:
  // The pose `age` entries before the newest. Precondition: 0 <= age < size_.
  const StampedPose& Ago(int age) const;
  Status Beyond(uint64_t time_ns, StampedPose& pose) const;

  int32_t size_ = 0;
  int32_t next_ = 0;  // slot of the next pose
  StampedPose poses_[kCapacity] = {};
};
static_assert(std::is_trivially_copyable_v<PoseHistory>);

// body -> odom.
Transform3 TransformFrom(const StampedPose& pose);

}  // namespace hardpack
