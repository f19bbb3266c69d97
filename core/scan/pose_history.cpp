// SPDX-License-Identifier: Apache-2.0
#include "core/scan/pose_history.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// Halvings of kCapacity places until one is left.
constexpr int kSearchSteps = 7;
static_assert(1 << kSearchSteps == PoseHistory::kCapacity);

// Precondition: less than 2^31 ns apart, as all is that is interpolated.
float Nanoseconds(uint64_t earlier_ns, uint64_t later_ns) {
  return static_cast<float>(static_cast<int32_t>(later_ns - earlier_ns));
}

bool IsGap(uint64_t earlier_ns, uint64_t later_ns) {
  return later_ns - earlier_ns > static_cast<uint64_t>(PoseHistory::kMaxGap_ns);
}

// The short way round.
float Turned(float base_rad, float from_rad, float to_rad, float fraction) {
  return WrapAngle(base_rad + fraction * WrapAngle(to_rad - from_rad));
}

// `base` moved by `fraction` of the way from `from` to `to`.
StampedPose Moved(const StampedPose& base, const StampedPose& from, const StampedPose& to,
                  float fraction, uint64_t time_ns) {
  StampedPose pose;
  pose.time_ns = time_ns;
  pose.position = {base.position.x_m + fraction * (to.position.x_m - from.position.x_m),
                   base.position.y_m + fraction * (to.position.y_m - from.position.y_m),
                   base.position.z_m + fraction * (to.position.z_m - from.position.z_m)};
  pose.roll_rad = Turned(base.roll_rad, from.roll_rad, to.roll_rad, fraction);
  pose.pitch_rad = Turned(base.pitch_rad, from.pitch_rad, to.pitch_rad, fraction);
  pose.yaw_rad = Turned(base.yaw_rad, from.yaw_rad, to.yaw_rad, fraction);
  return pose;
}

}  // namespace

void PoseHistory::Clear() {
  size_ = 0;
  next_ = 0;
}

Status PoseHistory::Check(const StampedPose& pose) {
  const float numbers[] = {pose.position.x_m, pose.position.y_m, pose.position.z_m,
                           pose.roll_rad,     pose.pitch_rad,    pose.yaw_rad};
  const float limits[] = {kMaxPosition_m,      kMaxPosition_m,      kMaxPosition_m,
                          kSinCosMaxAngle_rad, kSinCosMaxAngle_rad, kSinCosMaxAngle_rad};
  HP_LOOP_BOUND(6)
  for (const float number : numbers) {
    if (!IsFinite(number)) return Status::kNotFinite;
  }
  HP_LOOP_BOUND(6)
  for (int i = 0; i < 6; ++i) {
    if (Abs(numbers[i]) > limits[i]) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

Status PoseHistory::Add(const StampedPose& pose) {
  if (const Status checked = Check(pose); checked != Status::kOk) return checked;
  if (size_ > 0 && pose.time_ns == newest().time_ns) return Status::kDuplicate;
  if (size_ > 0 && pose.time_ns < newest().time_ns) return Status::kInvalidArgument;
  StampedPose& slot = poses_[next_];
  slot = pose;
  // Differences of wrapped angles can be wrapped in turn; those of large ones could not.
  slot.roll_rad = WrapAngle(pose.roll_rad);
  slot.pitch_rad = WrapAngle(pose.pitch_rad);
  slot.yaw_rad = WrapAngle(pose.yaw_rad);
  next_ = (next_ + 1) % kCapacity;
  if (size_ < kCapacity) ++size_;
  return Status::kOk;
}

Status PoseHistory::At(uint64_t time_ns, StampedPose& pose) const {
  if (size_ == 0 || time_ns < Ago(size_ - 1).time_ns) return Status::kNoPose;
  if (time_ns > newest().time_ns) return Beyond(time_ns, pose);
  // The pose that is not after time_ns lies in [newer, older], in places before the newest.
  int newer = 0;
  int older = size_ - 1;
  HP_LOOP_BOUND(kSearchSteps)
  while (newer < older) {
    const int middle = (newer + older) / 2;
    if (Ago(middle).time_ns <= time_ns) {
      older = middle;
    } else {
      newer = middle + 1;
    }
  }
  const StampedPose& before = Ago(older);
  if (before.time_ns == time_ns) {
    pose = before;
    return Status::kOk;
  }
  const StampedPose& after = Ago(older - 1);
  if (IsGap(before.time_ns, after.time_ns)) return Status::kNoPose;
  const float fraction =
      Nanoseconds(before.time_ns, time_ns) / Nanoseconds(before.time_ns, after.time_ns);
  pose = Moved(before, before, after, fraction, time_ns);
  return Status::kOk;
}

// Precondition: time_ns is after the newest pose's.
Status PoseHistory::Beyond(uint64_t time_ns, StampedPose& pose) const {
  const StampedPose& last = newest();
  if (time_ns - last.time_ns > static_cast<uint64_t>(kMaxExtrapolation_ns)) return Status::kNoPose;
  int age = 1;
  HP_LOOP_BOUND(kCapacity - 1)
  while (age < size_ &&
         last.time_ns - Ago(age).time_ns < static_cast<uint64_t>(kMinVelocityBase_ns)) {
    ++age;
  }
  if (age >= size_ || IsGap(Ago(age).time_ns, last.time_ns)) {
    pose = last;
    pose.time_ns = time_ns;
    return Status::kOk;
  }
  const StampedPose& before = Ago(age);
  const float fraction =
      Nanoseconds(last.time_ns, time_ns) / Nanoseconds(before.time_ns, last.time_ns);
  pose = Moved(last, before, last, fraction, time_ns);
  return Status::kOk;
}

void PoseHistory::ShiftHeights(float dz_m) {
  HP_LOOP_BOUND(kCapacity)
  for (int slot = 0; slot < size_; ++slot) poses_[slot].position.z_m += dz_m;
}

const StampedPose& PoseHistory::newest() const {
  HP_ASSERT(size_ > 0);
  return Ago(0);
}

const StampedPose& PoseHistory::Ago(int age) const {
  return poses_[(next_ - 1 - age + kCapacity) % kCapacity];
}

Transform3 TransformFrom(const StampedPose& pose) {
  return TransformFromRollPitchYaw(pose.roll_rad, pose.pitch_rad, pose.yaw_rad, pose.position);
}

}  // namespace hardpack
