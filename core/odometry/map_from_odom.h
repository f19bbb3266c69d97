// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "core/odometry/local_plane.h"

// Where odom lies on earth: the slowly changing transform odom -> map of REP-105, from the INS's
// poses. map has x east and y north, and its origin where the INS first had a pose that it stands
// by (LocalPlane). odom itself is never moved: what drives in it does not see satellites come and
// go. A goal in latitude and longitude is kept on earth and moves in odom as the transform does.
//
// An estimate of the vehicle's place and odom's heading in map is corrected by each pose of the INS
// (a Kalman filter of the place as one number and of the heading), and widened by what odom drifts.
// A pose that is too far off by its Mahalanobis distance is rejected; where such poses agree with
// each other for persist_s they are right, and the estimate begins anew from them. The transform
// that is told follows the estimate by no more than slew_mps at the vehicle and slew_radps.

namespace hardpack {

enum class MapStatus : uint8_t {
  kNone = 0,       // the INS has not had a pose since the start, or since odom lost its place
  kTracking = 1,   // follows the INS
  kRejecting = 2,  // the INS's poses are rejected: the transform is kept
  kHeld = 3,       // no pose of the INS that it stands by: the transform is kept
};

struct MapCounters {
  uint32_t taken = 0;
  uint32_t rejected = 0;
  uint32_t relocations = 0;  // what was rejected persisted
};

class MapFromOdom {
 public:
  // Of the INS's poses more often nothing new is to be learned: their errors last.
  static constexpr uint64_t kPeriod_ns = 100'000'000;

  // kParameterOutOfRange.
  Status Configure(const MapFromOdomParams& params, const InsParams& ins);

  // odom has lost its place: the next good pose sets the transform. The anchor stays.
  void Restart();

  // A message of the INS, that came at now_ns, with the vehicle's pose in odom then and the way
  // that it has driven. kOk: used, or not needed (kPeriod_ns); kStale: it holds no pose that the
  // INS stands by; kLimitExceeded: rejected; kNotFinite, kInvalidArgument: a number. Constant cost.
  Status TakeIns(const InsSample& sample, const Pose2& pose_odom, float driven_m, uint64_t now_ns);

  // Moves the transform towards the estimate. Once a tick. Constant cost.
  void Advance(uint64_t now_ns, const Pose2& pose_odom);

  MapStatus status() const { return status_; }
  bool has_transform() const { return status_ != MapStatus::kNone; }
  // Where odom's origin and x axis lie in map. Precondition: has_transform().
  const Pose2& map_from_odom() const { return told_; }
  const LocalPlane& plane() const { return plane_; }
  // kNotStarted: no transform; the statuses of LocalPlane.
  Status ToOdom(int64_t latitude_ndeg, int64_t longitude_ndeg, Vec2& place_odom) const;

  float position_sigma_m() const;
  float yaw_sigma_rad() const;
  const MapCounters& counters() const { return counters_; }

 private:
  struct Observation {
    Vec2 place_map;
    Vec2 place_odom;
    float yaw_rad = 0.0f;  // of odom in map
    float position_m2 = 0.0f;
  };

  Status Observe(const InsSample& sample, const Pose2& pose_odom, Observation& seen);
  bool Agrees(const Pose2& transform, const Observation& seen, float position_m2,
              float yaw_rad2) const;
  Status Reject(const Observation& seen, uint64_t now_ns);
  void Begin(const Pose2& transform, const Observation& seen);

  MapFromOdomParams params_;
  float body_from_ins_[9] = {};  // [3 x 3], row-major
  bool configured_ = false;
  LocalPlane plane_;
  MapStatus status_ = MapStatus::kNone;
  Pose2 estimate_;  // odom's origin and x axis in map
  Pose2 told_;
  float position_m2_ = 0.0f;  // variances of the estimate at the vehicle
  float yaw_rad2_ = 0.0f;
  float driven_m_ = 0.0f;  // until the newest pose that was taken or rejected
  uint64_t seen_ns_ = 0;   // when that was
  uint64_t good_ns_ = 0;   // of the newest pose that the INS stands by
  uint64_t told_ns_ = 0;
  Pose2 candidate_;            // the transform by the poses that are rejected
  uint64_t candidate_ns_ = 0;  // since when; 0: there is none
  MapCounters counters_;
};
static_assert(std::is_trivially_copyable_v<MapFromOdom>);

}  // namespace hardpack
