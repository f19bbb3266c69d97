// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/map_from_odom.h"

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/validate.h"
#include "core/odometry/ins_attitude.h"

namespace hardpack {
namespace {

// How fast those that are rejected are averaged.
constexpr float kCandidateGain = 0.1f;
// The estimate is never taken to be surer than this: the INS's errors last.
constexpr float kMinPosition_m2 = 1.0e-4f;
constexpr float kMinYaw_rad2 = 1.0e-6f;

Vec2 Apply(const Pose2& transform, const Vec2& place) {
  const SinCosPair turn = SinCos(transform.theta_rad);
  return {turn.cos * place.x_m - turn.sin * place.y_m + transform.x_m,
          turn.sin * place.x_m + turn.cos * place.y_m + transform.y_m};
}

// The transform of that heading that leads from a place of odom to one of map.
Pose2 TransformThrough(const Vec2& place_odom, const Vec2& place_map, float yaw_rad) {
  const Vec2 turned = Apply({0.0f, 0.0f, yaw_rad}, place_odom);
  return {place_map.x_m - turned.x_m, place_map.y_m - turned.y_m, WrapAngle(yaw_rad)};
}

// Part of the way from one transform to the other, as seen at a place of odom.
Pose2 Towards(const Pose2& from, const Pose2& to, const Vec2& place_odom, float position_gain,
              float yaw_gain) {
  const Vec2 here = Apply(from, place_odom);
  const Vec2 there = Apply(to, place_odom);
  const Vec2 place_map = {here.x_m + position_gain * (there.x_m - here.x_m),
                          here.y_m + position_gain * (there.y_m - here.y_m)};
  const float turn_rad = yaw_gain * WrapAngle(to.theta_rad - from.theta_rad);
  return TransformThrough(place_odom, place_map, from.theta_rad + turn_rad);
}

bool StandsByItsPose(const InsStatus& status) {
  return status.mode == InsMode::kTracking && !status.imu_error && !status.gnss_error;
}

float LengthOf(const Vec2& v) {
  return Sqrt(v.x_m * v.x_m + v.y_m * v.y_m);
}

}  // namespace

Status MapFromOdom::Configure(const MapFromOdomParams& params, const InsParams& ins) {
  *this = MapFromOdom{};
  if (FirstInvalidParameter(params) != nullptr || FirstInvalidParameter(ins) != nullptr) {
    return Status::kParameterOutOfRange;
  }
  params_ = params;
  BodyFromIns(ins, body_from_ins_);
  configured_ = true;
  return Status::kOk;
}

void MapFromOdom::Restart() {
  status_ = MapStatus::kNone;
  candidate_ns_ = 0;
  good_ns_ = 0;
  seen_ns_ = 0;
}

float MapFromOdom::position_sigma_m() const {
  return Sqrt(position_m2_);
}

float MapFromOdom::yaw_sigma_rad() const {
  return Sqrt(yaw_rad2_);
}

Status MapFromOdom::Observe(const InsSample& sample, const Pose2& pose_odom, Observation& seen) {
  if (!sample.has_position || !sample.has_attitude || !sample.has_status ||
      !StandsByItsPose(sample.status)) {
    return Status::kStale;
  }
  const bool is_finite = IsFinite(pose_odom) && Abs(sample.roll_rad) <= kTwoPi &&
                         Abs(sample.pitch_rad) <= kTwoPi && Abs(sample.yaw_rad) <= kTwoPi &&
                         IsFinite(sample.position_uncertainty_m);
  if (!is_finite) return Status::kNotFinite;
  if (!plane_.has_anchor()) {
    const Status status = plane_.SetAnchor(sample.latitude_ndeg, sample.longitude_ndeg);
    if (!IsUsable(status)) return status;
  }
  const Status status = plane_.ToPlane(sample.latitude_ndeg, sample.longitude_ndeg, seen.place_map);
  if (!IsUsable(status)) return status;
  seen.place_odom = {pose_odom.x_m, pose_odom.y_m};
  const float heading_rad = BodyAttitudeOf(sample, body_from_ins_).heading_rad +
                            plane_.Convergence(sample.latitude_ndeg, sample.longitude_ndeg);
  seen.yaw_rad = WrapAngle(heading_rad - pose_odom.theta_rad);
  const float sigma_m = sample.has_position_uncertainty
                            ? Max(sample.position_uncertainty_m, params_.min_position_sigma_m)
                            : params_.position_sigma_m;
  seen.position_m2 = sigma_m * sigma_m;
  return Status::kOk;
}

// Whether a transform with these variances and an observation are of one place.
bool MapFromOdom::Agrees(const Pose2& transform, const Observation& seen, float position_m2,
                         float yaw_rad2) const {
  const Vec2 expected = Apply(transform, seen.place_odom);
  const float dx_m = seen.place_map.x_m - expected.x_m;
  const float dy_m = seen.place_map.y_m - expected.y_m;
  const float turn_rad = WrapAngle(seen.yaw_rad - transform.theta_rad);
  const float yaw_noise_rad2 = params_.yaw_sigma_rad * params_.yaw_sigma_rad;
  const float distance2 = (dx_m * dx_m + dy_m * dy_m) / (position_m2 + seen.position_m2) +
                          turn_rad * turn_rad / (yaw_rad2 + yaw_noise_rad2);
  return distance2 <= params_.gate_sigma * params_.gate_sigma;
}

void MapFromOdom::Begin(const Pose2& transform, const Observation& seen) {
  estimate_ = transform;
  position_m2_ = seen.position_m2;
  yaw_rad2_ = params_.yaw_sigma_rad * params_.yaw_sigma_rad;
  candidate_ns_ = 0;
}

Status MapFromOdom::Reject(const Observation& seen, uint64_t now_ns) {
  const Pose2 by_this = TransformThrough(seen.place_odom, seen.place_map, seen.yaw_rad);
  const float yaw_rad2 = params_.yaw_sigma_rad * params_.yaw_sigma_rad;
  if (candidate_ns_ == 0 || !Agrees(candidate_, seen, seen.position_m2, yaw_rad2)) {
    candidate_ = by_this;
    candidate_ns_ = now_ns;
  } else {
    candidate_ = Towards(candidate_, by_this, seen.place_odom, kCandidateGain, kCandidateGain);
  }
  if (SecondsBetween(candidate_ns_, now_ns) >= params_.persist_s) {
    ++counters_.relocations;
    Begin(candidate_, seen);
    status_ = MapStatus::kTracking;
    return Status::kOk;
  }
  ++counters_.rejected;
  status_ = MapStatus::kRejecting;
  return Status::kLimitExceeded;
}

Status MapFromOdom::TakeIns(const InsSample& sample, const Pose2& pose_odom, float driven_m,
                            uint64_t now_ns) {
  if (!configured_) return Status::kNotStarted;
  Observation seen;
  const Status status = Observe(sample, pose_odom, seen);
  // It says itself that it has none; a message of another kind says nothing about it.
  if (status == Status::kStale && sample.has_status && !StandsByItsPose(sample.status) &&
      status_ != MapStatus::kNone) {
    status_ = MapStatus::kHeld;
  }
  if (!IsUsable(status)) return status;
  if (now_ns < good_ns_) return Status::kInvalidArgument;
  good_ns_ = now_ns;
  if (status_ == MapStatus::kNone) {
    Begin(TransformThrough(seen.place_odom, seen.place_map, seen.yaw_rad), seen);
    told_ = estimate_;
    told_ns_ = now_ns;
    seen_ns_ = now_ns;
    driven_m_ = driven_m;
    status_ = MapStatus::kTracking;
    ++counters_.taken;
    return Status::kOk;
  }
  if (now_ns - seen_ns_ < kPeriod_ns) return Status::kOk;
  const float way_m = Max(driven_m - driven_m_, 0.0f);
  const float time_s = SecondsBetween(seen_ns_, now_ns);
  position_m2_ += params_.drift_share * params_.drift_share * way_m + kMinPosition_m2 * time_s;
  yaw_rad2_ += params_.yaw_drift_radps * params_.yaw_drift_radps * time_s;
  seen_ns_ = now_ns;
  driven_m_ = driven_m;
  if (!Agrees(estimate_, seen, position_m2_, yaw_rad2_)) return Reject(seen, now_ns);
  const float position_gain = position_m2_ / (position_m2_ + seen.position_m2);
  const float yaw_noise_rad2 = params_.yaw_sigma_rad * params_.yaw_sigma_rad;
  const float yaw_gain = yaw_rad2_ / (yaw_rad2_ + yaw_noise_rad2);
  estimate_ = Towards(estimate_, TransformThrough(seen.place_odom, seen.place_map, seen.yaw_rad),
                      seen.place_odom, position_gain, yaw_gain);
  position_m2_ = Max(position_m2_ * (1.0f - position_gain), kMinPosition_m2);
  yaw_rad2_ = Max(yaw_rad2_ * (1.0f - yaw_gain), kMinYaw_rad2);
  candidate_ns_ = 0;
  status_ = MapStatus::kTracking;
  ++counters_.taken;
  return Status::kOk;
}

void MapFromOdom::Advance(uint64_t now_ns, const Pose2& pose_odom) {
  if (status_ == MapStatus::kNone || now_ns < told_ns_) return;
  if (now_ns > good_ns_ && SecondsBetween(good_ns_, now_ns) > params_.max_ins_age_s) {
    status_ = MapStatus::kHeld;
  }
  const float time_s = SecondsBetween(told_ns_, now_ns);
  told_ns_ = now_ns;
  const Vec2 here = {pose_odom.x_m, pose_odom.y_m};
  const Vec2 told = Apply(told_, here);
  const Vec2 wanted = Apply(estimate_, here);
  const float way_m = LengthOf({wanted.x_m - told.x_m, wanted.y_m - told.y_m});
  const float turn_rad = Abs(WrapAngle(estimate_.theta_rad - told_.theta_rad));
  const float most_m = params_.slew_mps * time_s;
  const float most_rad = params_.slew_radps * time_s;
  told_ = Towards(told_, estimate_, here, way_m > most_m ? most_m / way_m : 1.0f,
                  turn_rad > most_rad ? most_rad / turn_rad : 1.0f);
}

Status MapFromOdom::ToOdom(int64_t latitude_ndeg, int64_t longitude_ndeg, Vec2& place_odom) const {
  if (!has_transform()) return Status::kNotStarted;
  Vec2 place_map;
  const Status status = plane_.ToPlane(latitude_ndeg, longitude_ndeg, place_map);
  if (!IsUsable(status)) return status;
  const SinCosPair turn = SinCos(told_.theta_rad);
  const float dx_m = place_map.x_m - told_.x_m;
  const float dy_m = place_map.y_m - told_.y_m;
  place_odom = {turn.cos * dx_m + turn.sin * dy_m, -turn.sin * dx_m + turn.cos * dy_m};
  return Status::kOk;
}

}  // namespace hardpack
