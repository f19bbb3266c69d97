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
// poses. map has x east and y north, and its origin where the INS first reported a valid pose
// (LocalPlane). odom itself never moves: driving in it is not affected by GNSS coming and going. A
// goal in latitude and longitude stays fixed on earth and moves in odom as the transform does.
//
// Each pose of the INS corrects an estimate of the vehicle's position and odom's heading in map (a
// Kalman filter with one variance for the position and one for the heading), and odometry drift
// widens it. A pose that is too far off by its Mahalanobis distance is rejected. If such poses
// agree with each other for persist_s they are right, and the estimate restarts from them. The
// published transform follows the estimate by no more than slew_mps at the vehicle and slew_radps.

namespace hardpack {

enum class MapStatus : uint8_t {
  kNone = 0,       // no pose of the INS since the start, or since odom lost its position
  kTracking = 1,   // follows the INS
  kRejecting = 2,  // the INS's poses are rejected: the transform is kept
  kHeld = 3,       // no valid pose of the INS: the transform is kept
};

struct MapCounters {
  uint32_t taken = 0;
  uint32_t rejected = 0;
  uint32_t relocations = 0;  // rejected poses persisted
};

class MapFromOdom {
 public:
  // More frequent INS poses add no information: their errors are correlated.
  static constexpr uint64_t kPeriod_ns = 100'000'000;

  // kParameterOutOfRange.
  Status Configure(const MapFromOdomParams& params, const InsParams& ins);

  // odom has lost its position: the next good pose sets the transform. The anchor stays.
  void Restart();

  // An INS message received at now_ns, with the vehicle's pose in odom then and the distance driven
  // so far. kOk: used, or not needed (kPeriod_ns); kStale: it holds no valid pose; kLimitExceeded:
  // rejected; kNotFinite, kInvalidArgument: a number. Constant cost.
  Status TakeIns(const InsSample& sample, const Pose2& pose_odom, float driven_m, uint64_t now_ns);

  // Moves the transform towards the estimate. Once a tick. Constant cost.
  void Advance(uint64_t now_ns, const Pose2& pose_odom);

  MapStatus status() const { return status_; }
  bool has_transform() const { return status_ != MapStatus::kNone; }
  // Position of odom's origin and x axis in map. Precondition: has_transform().
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
  float driven_m_ = 0.0f;  // until the newest pose accepted or rejected
  uint64_t seen_ns_ = 0;   // time of that pose
  uint64_t good_ns_ = 0;   // of the newest valid pose of the INS
  uint64_t told_ns_ = 0;
  Pose2 candidate_;            // the transform according to the rejected poses
  uint64_t candidate_ns_ = 0;  // since when; 0: none
  MapCounters counters_;
};
static_assert(std::is_trivially_copyable_v<MapFromOdom>);

}  // namespace hardpack
