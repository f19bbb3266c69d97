// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// Where the vehicle was when a lidar column was taken: the last poses of the odometry, interpolated
// (motion compensation, a pose a column). The vehicle turns by up to 13 degrees during one
// revolution of the lidar. Poses are in order of time; what comes out of order is refused.

namespace hardpack {

class PoseHistory {
 public:
  static constexpr int kCapacity = 128;  // 1.28 s at 100 Hz
  // How far the newest two poses are carried on: the lidar's columns may be ahead of the odometry
  // by a tick or two.
  static constexpr int64_t kMaxExtrapolation_ns = 50'000'000;
  // Neighbouring poses further apart are a gap: nothing is interpolated across it.
  static constexpr int64_t kMaxGap_ns = 200'000'000;

  void Clear();

  // kNotFinite: a number of the pose; kInvalidArgument: a position beyond 838 km, an angle beyond
  // kSinCosMaxAngle_rad, or a time that is before the newest pose's; kDuplicate: at its very time.
  // Then nothing changes. When full the oldest pose gives way. Cost: constant.
  Status Add(const StampedPose& pose);

  // The pose at a time, interpolated linearly between its neighbours (angles the short way round)
  // or, beyond the newest pose, carried on from the last two with their velocity; with one pose
  // alone, that pose. kNoPose: before the oldest pose, more than kMaxExtrapolation_ns beyond the
  // newest, inside a gap, or there is none. Cost: a search over kCapacity poses.
  Status At(uint64_t time_ns, StampedPose& pose) const;

  // Raises all poses by dz_m: the odometry's height has jumped, and what was measured before is to
  // be told in the new heights. Precondition: finite. Cost: kCapacity.
  void ShiftHeights(float dz_m);

  int size() const { return size_; }
  // Precondition: size() > 0.
  const StampedPose& newest() const;

 private:
  int32_t size_ = 0;
  int32_t next_ = 0;  // slot of the next pose
  StampedPose poses_[kCapacity] = {};
};
static_assert(std::is_trivially_copyable_v<PoseHistory>);

// body -> odom.
Transform3 TransformFrom(const StampedPose& pose);

}  // namespace hardpack
