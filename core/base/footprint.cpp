// SPDX-License-Identifier: Apache-2.0
#include "core/base/footprint.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// Of n discs each covers a piece of the length; its corners are on the disc.
float DiscRadius(float half_width_m, float length_m, int32_t discs) {
  const float half_piece_m = 0.5f * length_m / static_cast<float>(discs);
  return Sqrt(half_width_m * half_width_m + half_piece_m * half_piece_m);
}

}  // namespace

float PivotRadiusOf(const VehicleParams& vehicle) {
  const float reach_m = 0.5f * vehicle.length_m + Abs(vehicle.axle_offset_m);
  const float half_width_m = 0.5f * vehicle.width_m;
  return Sqrt(reach_m * reach_m + half_width_m * half_width_m);
}

Footprint FootprintOf(const VehicleParams& vehicle) {
  Footprint footprint;
  footprint.front_m = FrontOf(vehicle);
  footprint.rear_m = RearOf(vehicle);
  footprint.half_width_m = 0.5f * vehicle.width_m;
  const float half_width_m = footprint.half_width_m;
  const float most_m = half_width_m + Footprint::kMaxDiscOverhang_m;
  footprint.discs = 2;
  HP_LOOP_BOUND(Footprint::kMaxDiscs)
  while (footprint.discs < Footprint::kMaxDiscs &&
         DiscRadius(half_width_m, vehicle.length_m, footprint.discs) > most_m) {
    ++footprint.discs;
  }
  footprint.disc_radius_m = DiscRadius(half_width_m, vehicle.length_m, footprint.discs);
  footprint.disc_step_m = vehicle.length_m / static_cast<float>(footprint.discs);
  footprint.pivot_radius_m = PivotRadiusOf(vehicle);
  return footprint;
}

float DistanceToOutline(const Footprint& footprint, Vec2 point_body) {
  const float x_m =
      Max(0.0f, Max(footprint.rear_m - point_body.x_m, point_body.x_m - footprint.front_m));
  const float y_m = Max(0.0f, Abs(point_body.y_m) - footprint.half_width_m);
  return Sqrt(x_m * x_m + y_m * y_m);
}

}  // namespace hardpack
