// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Where the vehicle was when a lidar column was taken: the last poses of the odometry, interpolated
// (motion compensation, a pose a column; docs/algorithm.md section 1). The vehicle turns by up to
// 13 degrees during one revolution of the lidar. Poses are in order of time; what comes out of
// order is refused. It does not estimate poses, and does not know which of them are good.
//
// Between two poses that are dt apart the vehicle is taken to move straight and to turn evenly. On
// an arc at speed v and yaw rate w it is off by at most v w dt^2 / 8: 0.14 mm with 100 poses a
// second at 5 m/s and 2.2 rad/s, and float32's rounding of the position besides (0.03 mm within
// 500 m). Carried on by t beyond the newest pose: v w t (t + dt) / 2, 3.3 mm after 20 ms, 16.5 mm
// after 50 ms.

namespace hardpack {

class PoseHistory {
 public:
  static constexpr int kCapacity = 128;  // 1.28 s at 100 Hz
  // How far the newest pose is carried on: the lidar's columns may be ahead of the odometry by a
  // tick or two.
  static constexpr int64_t kMaxExtrapolation_ns = 50'000'000;
  // Neighbouring poses further apart are a gap: nothing is interpolated across it.
  static constexpr int64_t kMaxGap_ns = 200'000'000;
  // Poses closer together tell no velocity: their rounding would be carried on many times over.
  static constexpr int64_t kMinVelocityBase_ns = 5'000'000;
  // Coordinates up to here are exact to half a cell in float32 (core/base/grid.h).
  static constexpr float kMaxPosition_m = 838860.0f;

  void Clear();

  // Whether a pose can be held, whatever its time. kNotFinite: one of its numbers is not;
  // kInvalidArgument: a coordinate beyond kMaxPosition_m, an angle beyond kSinCosMaxAngle_rad.
  static Status Check(const StampedPose& pose);
  static bool Takes(const StampedPose& pose) { return Check(pose) == Status::kOk; }

  // The statuses of Check; kInvalidArgument: a time before the newest pose's; kDuplicate: at its
  // very time. Then nothing changes. Angles are held in (-pi, pi]. When full the oldest pose gives
  // way. Cost: constant.
  Status Add(const StampedPose& pose);

  // The pose at a time: one that was added, or interpolated linearly between its neighbours (angles
  // the short way round, in (-pi, pi]), or the newest, carried on with the velocity since the last
  // pose that is at least kMinVelocityBase_ns older and not across a gap; without such a pose, the
  // newest as it is. kNoPose: before the oldest pose, more than kMaxExtrapolation_ns beyond the
  // newest, inside a gap, or there is none; `pose` is untouched.
  // Cost: 7 comparisons; beyond the newest pose up to kCapacity.
  Status At(uint64_t time_ns, StampedPose& pose) const;

  // Raises all poses by dz_m: the odometry's height has jumped, and what was measured before is to
  // be told in the new heights. Precondition: finite. Cost: kCapacity.
  void ShiftHeights(float dz_m);

  int size() const { return size_; }
  // Precondition: size() > 0.
  const StampedPose& newest() const;

 private:
  // The pose `age` places before the newest. Precondition: 0 <= age < size_.
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
