// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/assured_sight.h"
#include "core/autonomy/known_ground.h"
#include "core/base/footprint.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/speed/speed.h"
#include "hal/onboard/pilot/pilot.h"

// Pilot: whether the lidar has looked along the way that is driven, lately, and over the
// vehicle's width.

namespace hardpack {
namespace {

// The way to a stop is looked along at so many places.
constexpr int kPlaces = 12;
constexpr uint32_t kGroundReach_mm = 12'000;
// 128 sectors in 0.16 s at 100 ticks a second.
constexpr int kExpectedInTick = 8;
// A turn on the spot within so many points is the next thing that is driven.
constexpr int kTurnAhead = 3;

}  // namespace

// With the map that it is seen into.
Status Pilot::ConfigureSight() {
  mount_.Reset();
  lookouts_.blind_m = BlindRadius_m(beam_model_, config_.perception.mount);
  if (const Status status = ConfigureMapper(); !IsUsable(status)) return status;
  return sight_.Configure(config_.perception.mount, config_.onboard.safety, beam_model_,
                          window_.columns_per_datagram, window_.first, window_.last);
}

// Where the lidar is now.
void Pilot::NoteLookout() {
  const StampedPose& here = odometry_.pose();
  const LidarMountParams& mount = config_.perception.mount;
  const SinCosPair body = SinCos(here.yaw_rad);
  lookouts_.Add({here.position.x_m + body.cos * mount.x_m - body.sin * mount.y_m,
                 here.position.y_m + body.sin * mount.x_m + body.cos * mount.y_m},
                static_cast<float>(here.position.z_m));
}

bool Pilot::TurnsNext() const {
  const CommittedPlan& plan = replanner_.committed();
  const int here = replanner_.place().point;
  HP_LOOP_BOUND(kTurnAhead)
  for (int k = 0; k < kTurnAhead && here + k + 1 < plan.path.size(); ++k) {
    if (TurnsOnTheSpotAt(plan.path, here + k)) return true;
  }
  return false;
}

// Of the directions in which the edge that goes first moves until it stands, all around where it
// turns on the spot. Without a path of any direction.
SightLook Pilot::OldestLook() const {
  SightLook oldest;
  sight_.LookAtFaults(oldest);
  if (mount_.has_turned() && mount_.turned_since_ns() < oldest.time_ns) {
    oldest = {mount_.turned_since_ns(), SightCause::kNone};
  }
  const CommittedPlan& plan = replanner_.committed();
  if (plan.number == 0) {
    // A fault that is known tells more than that nothing is seen.
    if (oldest.cause == SightCause::kNone) oldest.cause = SightCause::kSilent;
    if (sight_.newest_ns() < oldest.time_ns) oldest.time_ns = sight_.newest_ns();
    return oldest;
  }
  if (TurnsNext()) {
    sight_.LookAround(now_ns_, oldest);
    return oldest;
  }
  const float speed_mps = Max(Abs(odometry_.speed_mps()), tracker_.speed_mps());
  const float reach_m = StoppingDistance(speed_on_ground_, speed_mps);
  HP_LOOP_BOUND(kPlaces)
  for (int i = 0; i < kPlaces; ++i) {
    const float ahead_m = reach_m * static_cast<float>(i) / static_cast<float>(kPlaces - 1);
    LookAt(StateAt(plan, replanner_.place().along_m + ahead_m), oldest);
  }
  return oldest;
}

// The vehicle's front at one place of the path, in reverse its rear, as it lies in the body frame.
void Pilot::LookAt(const PathState& state, SightLook& oldest) const {
  const VehicleParams& vehicle = config_.planner.vehicle;
  const Pose2& place = state.pose;
  const float edge_m = state.reverse ? RearOf(vehicle) : FrontOf(vehicle);
  const float side_m = SizeOfCorridor().half_width_m;
  const StampedPose& here = odometry_.pose();
  const SinCosPair body = SinCos(here.yaw_rad);
  const SinCosPair ahead = SinCos(place.theta_rad - here.yaw_rad);
  const float dx_m = place.x_m - here.position.x_m;
  const float dy_m = place.y_m - here.position.y_m;
  const Vec2 middle = {body.cos * dx_m + body.sin * dy_m + edge_m * ahead.cos,
                       body.cos * dy_m - body.sin * dx_m + edge_m * ahead.sin};
  const Vec2 aside = {-side_m * ahead.sin, side_m * ahead.cos};
  sight_.LookBetween({middle.x_m - aside.x_m, middle.y_m - aside.y_m},
                     {middle.x_m + aside.x_m, middle.y_m + aside.y_m}, now_ns_, oldest);
}

// One column in kMountEvery, which is enough of a revolution, and kMaxMountColumns in a tick.
bool Pilot::MayWatchMount(int slot) const {
  return slot % kMountEvery == 0 && mount_columns_ < kMaxMountColumns;
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void Pilot::WatchMount(int slot) {
  ++mount_columns_;
  const StampedPose& here = odometry_.pose();
  const SinCosPair body = SinCos(here.yaw_rad);
  const int beams = mapper_.model().beams;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < beams; ++row) {
    Vec2 point;
    float step_m = 0.0f;
    if (!mapper_.GroundStepOf(slot, row, kGroundReach_mm, point, step_m)) continue;
    const float dx_m = point.x_m - here.position.x_m;
    const float dy_m = point.y_m - here.position.y_m;
    mount_.Add({body.cos * dx_m + body.sin * dy_m, body.cos * dy_m - body.sin * dx_m}, step_m);
  }
}

// Some sectors in each tick, one after the other: what the map knows in their directions.
void Pilot::ExpectReturns() {
  const int sectors = sight_.sectors();
  const Transform3 odom_from_body = TransformFrom(odometry_.pose());
  const Vec3 sensor =
      BodyFromSensor(config_.perception.mount).Apply(beam_model_.sensor_from_lidar.translation);
  HP_LOOP_BOUND(kExpectedInTick)
  for (int i = 0; i < kExpectedInTick && sectors > 0; ++i) {
    expected_sector_ = expected_sector_ + 1 < sectors ? expected_sector_ + 1 : 0;
    const float fall = LeastFallToKnown(mapper_.heights(), odom_from_body, sensor,
                                        sight_.DirectionOf(expected_sector_));
    sight_.ExpectKnown(expected_sector_, fall, beam_model_);
  }
}

// The operator who arms anew has looked at it.
void Pilot::AdvanceMount() {
  if (permission_.mode == Mode::kStandby || is_gap_) mount_.Reset();
  mount_.Advance(now_ns_);
  mount_columns_ = 0;
}

StopReason Pilot::BlindBy(const SightLook& look) const {
  if (mount_.has_turned() && look.time_ns == mount_.turned_since_ns()) {
    return StopReason::kLidarTurned;
  }
  switch (look.cause) {
    case SightCause::kEmpty:
    case SightCause::kCovered:
      return StopReason::kLidarCovered;
    case SightCause::kFrozen:
      return StopReason::kLidarFrozen;
    case SightCause::kNone:
    case SightCause::kSilent:
      break;
  }
  return StopReason::kBlindAhead;
}

}  // namespace hardpack
