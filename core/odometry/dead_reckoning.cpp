// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/dead_reckoning.h"

#include "config/validate.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

constexpr int kRotation = 9;

// c = a b, or a b^T. All [3 x 3], row-major.
void Multiply(const float (&a)[kRotation], const float (&b)[kRotation], bool transpose_b,
              float (&c)[kRotation]) {
  HP_LOOP_BOUND(kRotation)
  for (int i = 0; i < kRotation; ++i) {
    const int row = 3 * (i / 3);
    const int column = i % 3;
    const int first = transpose_b ? 3 * column : column;
    const int stride = transpose_b ? 1 : 3;
    c[i] = a[row] * b[first] + a[row + 1] * b[first + stride] + a[row + 2] * b[first + 2 * stride];
  }
}

// Half a turn about x: between a frame with z up and one with z down.
void FlipRows(float (&rotation)[kRotation]) {
  HP_LOOP_BOUND(kRotation)
  for (int i = 3; i < kRotation; ++i) rotation[i] = -rotation[i];
}

bool IsFiniteVec(const Vec3& v) {
  return IsFinite(v.x_m) && IsFinite(v.y_m) && IsFinite(v.z_m);
}

}  // namespace

Status DeadReckoning::Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                                const InsParams& ins) {
  *this = DeadReckoning{};
  OnboardParams onboard;
  onboard.odometry = odometry;
  onboard.ins = ins;
  if (FirstInvalidParameter(onboard) != nullptr) return Status::kParameterOutOfRange;
  vehicle_ = vehicle;
  params_ = odometry;
  const Transform3 mount = TransformFromRollPitchYaw(ins.roll_rad, ins.pitch_rad, ins.yaw_rad, {});
  // The INS's own frame has z down: half a turn about x comes first.
  HP_LOOP_BOUND(kRotation)
  for (int i = 0; i < kRotation; ++i) {
    body_from_ins_[i] = i % 3 == 0 ? mount.rotation[i] : -mount.rotation[i];
  }
  configured_ = true;
  return Status::kOk;
}

Status DeadReckoning::TakeIns(const InsSample& sample, uint64_t host_ns) {
  if (!configured_) return Status::kNotStarted;
  if (host_ns < ins_ns_) return Status::kInvalidArgument;
  const bool rate_is_fine = !sample.has_angular_rate || IsFiniteVec(sample.angular_rate_radps);
  const bool attitude_is_fine =
      !sample.has_attitude || (Abs(sample.roll_rad) <= kTwoPi && Abs(sample.pitch_rad) <= kTwoPi &&
                               Abs(sample.yaw_rad) <= kTwoPi);
  if (!rate_is_fine || !attitude_is_fine) return Status::kNotFinite;
  ins_ns_ = host_ns;
  // A device or a bridge that says the same again says nothing about now.
  const bool repeats = sample.has_timestamp && sample.timestamp_ns == rate_stamp_ns_ && has_rate_;
  if (sample.has_angular_rate && !repeats) {
    const Vec3& rate = sample.angular_rate_radps;
    ins_yaw_rate_radps_ =
        body_from_ins_[6] * rate.x_m + body_from_ins_[7] * rate.y_m + body_from_ins_[8] * rate.z_m;
    rate_ns_ = host_ns;
    rate_stamp_ns_ = sample.timestamp_ns;
    has_rate_ = true;
  }
  if (sample.has_attitude) TakeAttitude(sample);
  return Status::kOk;
}

// Roll and pitch of the body from those of the INS: R_body = Rx(pi) R_ins->ned R_ins->body^T.
void DeadReckoning::TakeAttitude(const InsSample& sample) {
  const Transform3 ned_from_ins =
      TransformFromRollPitchYaw(sample.roll_rad, sample.pitch_rad, sample.yaw_rad, {});
  float body[kRotation];
  Multiply(ned_from_ins.rotation, body_from_ins_, true, body);
  FlipRows(body);
  pose_.roll_rad = Atan2(body[7], body[8]);
  pose_.pitch_rad = Atan2(-body[6], Sqrt(body[7] * body[7] + body[8] * body[8]));
}

float DeadReckoning::YawRate(uint64_t now_ns, const WheelFeedback& wheels) {
  uses_ins_rate_ =
      has_rate_ && now_ns >= rate_ns_ && SecondsBetween(rate_ns_, now_ns) <= params_.max_rate_age_s;
  if (uses_ins_rate_) return ins_yaw_rate_radps_;
  return vehicle_.wheel_radius_m * params_.ground_per_wheel *
         (wheels.right_radps - wheels.left_radps) / vehicle_.skid_baseline_m;
}

Status DeadReckoning::Advance(uint64_t now_ns, const WheelFeedback& wheels) {
  if (!configured_) return Status::kNotStarted;
  if (pose_.time_ns != 0 && now_ns <= pose_.time_ns) return Status::kInvalidArgument;
  pose_.time_ns = now_ns;
  const bool finite = IsFinite(wheels.left_radps) && IsFinite(wheels.right_radps);
  if (!wheels.valid || !finite) {
    speed_mps_ = 0.0f;
    yaw_rate_radps_ = 0.0f;
    return finite ? Status::kStale : Status::kNotFinite;
  }
  speed_mps_ = vehicle_.wheel_radius_m * params_.ground_per_wheel *
               (wheels.left_radps + wheels.right_radps) / 2.0f;
  yaw_rate_radps_ = YawRate(now_ns, wheels);
  // Since the wheel speeds before these: it has moved while there were none, too.
  const uint64_t before_ns = moved_ns_;
  moved_ns_ = now_ns;
  if (before_ns == 0) return Status::kOk;
  if (now_ns - before_ns > static_cast<uint64_t>(kMaxStep_ns)) {
    ++gaps_;
    return Status::kOk;
  }
  const float dt_s = SecondsBetween(before_ns, now_ns);
  const SinCosPair middle = SinCos(pose_.yaw_rad + yaw_rate_radps_ * dt_s / 2.0f);
  pose_.position.x_m += speed_mps_ * dt_s * middle.cos;
  pose_.position.y_m += speed_mps_ * dt_s * middle.sin;
  pose_.yaw_rad = WrapAngle(pose_.yaw_rad + yaw_rate_radps_ * dt_s);
  return Status::kOk;
}

}  // namespace hardpack
