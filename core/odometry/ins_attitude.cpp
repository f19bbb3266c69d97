// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/ins_attitude.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/pose.h"

namespace hardpack {
namespace {

constexpr int kRotation = 9;

}  // namespace

void BodyFromIns(const InsParams& ins, float (&body_from_ins)[9]) {
  const Transform3 mount = TransformFromRollPitchYaw(ins.roll_rad, ins.pitch_rad, ins.yaw_rad, {});
  HP_LOOP_BOUND(kRotation)
  for (int i = 0; i < kRotation; ++i) {
    body_from_ins[i] = i % 3 == 0 ? mount.rotation[i] : -mount.rotation[i];
  }
}

// R_body = Rx(pi) R_ins->ned R_ins->body^T, into north, west, up.
BodyAttitude BodyAttitudeOf(const InsSample& sample, const float (&body_from_ins)[9]) {
  const Transform3 ned_from_ins =
      TransformFromRollPitchYaw(sample.roll_rad, sample.pitch_rad, sample.yaw_rad, {});
  const float(&a)[kRotation] = ned_from_ins.rotation;
  float body[kRotation];
  HP_LOOP_BOUND(kRotation)
  for (int i = 0; i < kRotation; ++i) {
    const int row = 3 * (i / 3);
    const int column = 3 * (i % 3);
    const float sum = a[row] * body_from_ins[column] + a[row + 1] * body_from_ins[column + 1] +
                      a[row + 2] * body_from_ins[column + 2];
    body[i] = row == 0 ? sum : -sum;
  }
  BodyAttitude attitude;
  attitude.roll_rad = Atan2(body[7], body[8]);
  attitude.pitch_rad = Atan2(-body[6], Sqrt(body[7] * body[7] + body[8] * body[8]));
  attitude.heading_rad = WrapAngle(Atan2(body[3], body[0]) + kHalfPi);
  return attitude;
}

}  // namespace hardpack
