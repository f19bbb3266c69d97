// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/pose.h"
#include "core/costmap/height_grid.h"

// Where the ground and what stands on it should send the lidar's beams back, by the map: on ground
// that falls away, as behind a crest, fewer beams meet it than on level ground, and none of them is
// missing (core/scan/sight_watch.h).

namespace hardpack {

// A beam is looked for in so many places along its way, from kNearestKnown_m on.
inline constexpr int kKnownPlaces = 21;
inline constexpr float kNearestKnown_m = 2.0f;
inline constexpr float kKnownStep_m = 0.4f;
// More than any beam falls [m/m]: nothing is known there.
inline constexpr float kNoFall = 1.0e6f;

// How little a line of sight from the lidar may fall, in a direction of the body frame, so that it
// still meets something known within 10 m of it: ground whose height is known, or a hard obstacle
// [m of the body's z axis downwards per m along its level plane]. All that fall more steeply meet
// it, or something nearer. Below 0: what is known there is higher than the lidar; kNoFall: nothing
// is. sensor_body: the lidar in the body frame; direction_body: of length 1. Cost: kKnownPlaces
// cells. Ours.
float LeastFallToKnown(const HeightGrid& heights, const Transform3& odom_from_body,
                       const Vec3& sensor_body, Vec2 direction_body);

}  // namespace hardpack
