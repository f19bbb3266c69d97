// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/assured_sight.h"

#include "core/base/footprint.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/speed/speed.h"

namespace hardpack {
namespace {

// Of a beam: rise over level distance.
float SlopeOf(const BeamModel& model, int beam) {
  const int row = model.by_altitude[beam];
  return model.sin_altitude[row] / model.cos_altitude[row];
}

// What a stop from a speed takes, from the sensor to the thing.
float NeededSight_m(const LidarMountParams& mount, const VehicleParams& vehicle,
                    const SpeedParams& speed, float speed_mps) {
  const float front_m = FootprintOf(vehicle).front_m + speed.unseen_margin_m;
  return StoppingDistance(speed, speed_mps) + front_m - mount.x_m;
}

}  // namespace

float AssuredSight_m(const BeamModel& model, float sensor_height_m, float band_m, float height_m) {
  const bool fits = band_m >= 0.0f && band_m < height_m && height_m < sensor_height_m;
  if (model.beams < 1 || !fits) return 0.0f;
  const float above_m = sensor_height_m - height_m;
  const float lowest = SlopeOf(model, 0);
  float sight_m = kMostSight_m;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam + 1 < model.beams; ++beam) {
    const float lower = SlopeOf(model, beam);
    const float upper = SlopeOf(model, beam + 1);
    if (lower >= 0.0f) break;
    const float reach_m = (height_m - band_m) / Max(upper - lower, 1.0e-6f);
    // Before the upper one comes down to the height, a beam below it may have met the thing.
    const bool ends = upper >= 0.0f || reach_m * -upper < above_m;
    if (ends) {
      sight_m = Min(reach_m, kMostSight_m);
      break;
    }
  }
  return sight_m * -lowest > above_m ? sight_m : 0.0f;
}

float FirmSight_m(const BeamModel& model, float width_m) {
  if (model.fired_per_revolution < 1 || !(width_m > 0.0f)) return 0.0f;
  // One more where a place among them may be left out: then the middle has three neighbours still.
  const bool are_all = model.fired_per_revolution >= model.columns_per_revolution;
  const float columns = are_all ? 4.0f : 5.0f;
  const float apart_rad = kTwoPi / static_cast<float>(model.fired_per_revolution);
  return Min(width_m / (columns * apart_rad), kMostSight_m);
}

float SensorHeight_m(const BeamModel& model, const LidarMountParams& mount) {
  return mount.z_m + model.sensor_from_lidar.translation.z_m;
}

float BlindRadius_m(const BeamModel& model, const LidarMountParams& mount) {
  const int row = model.beams > 0 ? model.by_altitude[0] : 0;
  const float tilt_rad = Sqrt(mount.pitch_rad * mount.pitch_rad + mount.roll_rad * mount.roll_rad);
  const SinCosPair tilt = SinCos(Min(tilt_rad, kHalfPi));
  const float down = tilt.sin * model.cos_altitude[row] - tilt.cos * model.sin_altitude[row];
  const float out = tilt.cos * model.cos_altitude[row] + tilt.sin * model.sin_altitude[row];
  const float height_m = SensorHeight_m(model, mount);
  const bool meets = model.beams > 0 && down > 0.0f && height_m > 0.0f;
  if (!meets || height_m * out > kMostSight_m * down) return kMostSight_m;
  return Max(height_m * out / down, 0.0f);
}

float LeastAssuredHeight_m(const BeamModel& model, const PerceptionParams& perception,
                           const VehicleParams& vehicle, const SpeedParams& speed,
                           float speed_mps) {
  constexpr int kSteps = 200;
  constexpr float kStep_m = 0.01f;
  const float needed_m = NeededSight_m(perception.mount, vehicle, speed, speed_mps);
  const float sensor_m = SensorHeight_m(model, perception.mount);
  const float band_m = perception.segmentation.ground_band_m;
  HP_LOOP_BOUND(kSteps)
  for (int step = 1; step <= kSteps; ++step) {
    const float height_m = kStep_m * static_cast<float>(step);
    if (AssuredSight_m(model, sensor_m, band_m, height_m) >= needed_m) return height_m;
  }
  return 0.0f;
}

float AssuredSpeed_mps(const BeamModel& model, const PerceptionParams& perception,
                       const VehicleParams& vehicle, const SpeedParams& speed) {
  const float met_m = AssuredSight_m(model, SensorHeight_m(model, perception.mount),
                                     perception.segmentation.ground_band_m, speed.assured_height_m);
  const float sight_m = Min(met_m, FirmSight_m(model, speed.assured_width_m));
  const float ahead_m = NeededSight_m(perception.mount, vehicle, speed, 0.0f);
  return ReactionSpeedCap(speed, sight_m - ahead_m);
}

Status LimitToAssuredSight(const BeamModel& model, const PerceptionParams& perception,
                           const VehicleParams& vehicle, SpeedParams& speed) {
  const float assured_mps = AssuredSpeed_mps(model, perception, vehicle, speed);
  const bool is_assured =
      assured_mps >= Min(speed.person_creep_mps, speed.max_speed_mps) && assured_mps > 0.0f;
  if (!is_assured && speed.refuse_unassured != 0) return Status::kParameterOutOfRange;
  constexpr float kLeast_mps = 0.1f;  // of the table of parameters
  const float limit_mps = Max(is_assured ? assured_mps : speed.person_creep_mps, kLeast_mps);
  speed.max_speed_mps = Min(speed.max_speed_mps, limit_mps);
  speed.min_speed_mps = Min(speed.min_speed_mps, speed.max_speed_mps);
  speed.person_creep_mps = Min(speed.person_creep_mps, speed.min_speed_mps);
  speed.hidden_creep_mps = Min(speed.hidden_creep_mps, speed.min_speed_mps);
  return Status::kOk;
}

}  // namespace hardpack
