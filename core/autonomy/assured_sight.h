// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// How far a lidar sees low objects, computed from its beams alone, and the speed this allows
// (docs/assured_sight.md; ours). It does not use what has been seen.
//
// An object of height h standing on level ground is met when a beam ends on the part of it above
// the tolerance of the ground test, segmentation.ground_band_m: one such beam in a direction is
// enough for the segmenter to class its return as standing (tested on the segmenter). Two
// neighbouring beams, of slopes t and t' (rise over level distance), are (t' - t) d apart at the
// distance d. As long as that is no more than the height less the band, one of them meets the
// object, at any pitch of the vehicle. Nothing is met closer than where the lowest beam is as low
// as the object.
//
//   H o----__
//          -----___-----____              t'
//               -----____   -----___
//                    t    -----____ |h ---    |
//   ____________________________|__-|_________|____
//            nearest                d         sight
//
// To be distinguished from growth it must be firm as well: within one beam, a return with three of
// its four neighbours in azimuth on the same surface (core/segmentation/texture.h), so four
// columns. They are 2 pi d / W apart, W per revolution. If the sensor leaves
// out places of its grid, one in such a row may be missing: then five columns that arrive.

namespace hardpack {

// The level distance from the sensor up to which every object of height_m is met above band_m,
// starting where the lowest beam is as low as height_m; at most kMostSight_m. 0: none; an empty
// model, or heights that are not 0 <= band_m < height_m < sensor_height_m. Cost: kMaxBeams.
inline constexpr float kMostSight_m = 100.0f;
float AssuredSight_m(const BeamModel& model, float sensor_height_m, float band_m, float height_m);

// The level distance from the sensor up to which every object that is width_m wide across the line
// of sight has enough columns on it to make a return firm; at most kMostSight_m. 0: a model without
// columns, or a width that is not above 0.
float FirmSight_m(const BeamModel& model, float width_m);

// The height of the lidar's centre above level ground.
float SensorHeight_m(const BeamModel& model, const LidarMountParams& mount);

// The level distance from the sensor within which no beam meets level ground: of its lowest beam,
// in the direction in which the mount is tilted down; at most kMostSight_m.
float BlindRadius_m(const BeamModel& model, const LidarMountParams& mount);

// The least height that is met as far away as a stop from speed_mps needs, in steps of 1 cm up to 2
// m; 0: none. Cost: 200 times AssuredSight_m.
float LeastAssuredHeight_m(const BeamModel& model, const PerceptionParams& perception,
                           const VehicleParams& vehicle, const SpeedParams& speed, float speed_mps);

// The speed from which the vehicle stops, its front unseen_margin_m before the object, within both
// sights for objects of speed.assured_height_m and assured_width_m: at most max_speed_mps, 0 if it
// sees nothing far enough.
float AssuredSpeed_mps(const BeamModel& model, const PerceptionParams& perception,
                       const VehicleParams& vehicle, const SpeedParams& speed);

// Lowers the limits of `speed` to that speed. If it is below person_creep_mps the vehicle creeps,
// or must not drive: kParameterOutOfRange with refuse_unassured.
Status LimitToAssuredSight(const BeamModel& model, const PerceptionParams& perception,
                           const VehicleParams& vehicle, SpeedParams& speed);

}  // namespace hardpack
