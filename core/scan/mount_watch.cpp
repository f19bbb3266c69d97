// SPDX-License-Identifier: Apache-2.0
#include "core/scan/mount_watch.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {

void MountWatch::Reset() {
  *this = MountWatch{};
}

void MountWatch::Add(Vec2 place_body, float step_m) {
  const float x_m = place_body.x_m;
  const float y_m = place_body.y_m;
  const bool is_usable = IsFinite(x_m) && IsFinite(y_m) && Abs(step_m) <= kMaxStep_m;
  if (!is_usable) return;
  ++returns_;
  product_[0] += x_m * x_m;
  product_[1] += x_m * y_m;
  product_[2] += y_m * y_m;
  product_[3] += x_m * step_m;
  product_[4] += y_m * step_m;
}

void MountWatch::Advance(uint64_t now_ns) {
  if (begun_ns_ == 0) begun_ns_ = now_ns;
  if (now_ns < begun_ns_ + kWindow_ns) return;
  Judge(begun_ns_);
  begun_ns_ = now_ns;
  returns_ = 0;
  HP_LOOP_BOUND(5)
  for (float& product : product_) product = 0.0f;
}

// Least squares of step = slope . place: the plane goes through where the vehicle stands, so that a
// side that lies as it did does not hide the other one. Returns of a line of places tell nothing.
void MountWatch::Judge(uint64_t begun_ns) {
  if (returns_ < kLeastReturns) return;
  const float share = 1.0f / static_cast<float>(returns_);
  const float xx = share * product_[0];
  const float xy = share * product_[1];
  const float yy = share * product_[2];
  const float xs = share * product_[3];
  const float ys = share * product_[4];
  constexpr float kLeastSpread_m4 = 4.0f;
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > kLeastSpread_m4)) return;
  const Vec2 slope = {(xs * yy - ys * xy) / determinant, (ys * xx - xs * xy) / determinant};
  tilt_rad_ = Sqrt(slope.x_m * slope.x_m + slope.y_m * slope.y_m);
  const bool same_way = slope.x_m * slope_.x_m + slope.y_m * slope_.y_m > 0.0f;
  slope_ = slope;
  if (!(tilt_rad_ > kLimit_rad)) {
    windows_ = 0;
    return;
  }
  windows_ = same_way ? windows_ + 1 : 1;
  if (windows_ == 1) since_ns_ = begun_ns;
  if (windows_ >= kWindows && turned_since_ns_ == 0) turned_since_ns_ = since_ns_;
}

}  // namespace hardpack
