// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/onboard_parameters.h"
#include "config/parameters.h"

// Conditions on pairs of parameters, each in one place: the stages refuse parameters that violate
// one, and the configuration and the command line name both parameters. Limits within one group are
// in the tables (core/base/validate.h). The parameters are assumed to be in range here.

namespace hardpack {

struct ParameterConflict {
  const char* name = nullptr;   // full name of one; null: no conflict
  const char* other = nullptr;  // full name of the other
  const char* rule = nullptr;   // the condition, phrased to follow "must be"
};

// How far a sensor, and the box of returns from the vehicle itself, may extend beyond the outline
// at the front and the sides: objects in that box are not seen.
inline constexpr float kMaxBeyondOutline_m = 0.5f;
// The same at the rear, where there may be a mast or a trailer hitch and the vehicle does not
// drive.
inline constexpr float kMaxBehindOutline_m = 2.0f;
// Largest cost of one cell: both layers and unknown ground (core/costmap/costmap.h).
inline constexpr float kMaxCellCost = 39.0f;

// Calls take(conflict) for each conflict. Cost: a few comparisons.
template <typename Take>
constexpr void ForEachConflict(const PlannerParams& planner, Take&& take) {
  const VehicleParams& vehicle = planner.vehicle;
  const float offset_m =
      vehicle.axle_offset_m < 0.0f ? -vehicle.axle_offset_m : vehicle.axle_offset_m;
  if (!(offset_m <= 0.5f * vehicle.length_m)) {
    take(ParameterConflict{"vehicle.axle_offset_m", "vehicle.length_m",
                           "within the outline: at most half the length, in either direction"});
  }
  const CostmapParams& costmap = planner.costmap;
  if (!(costmap.clearance_height_m > costmap.growth_height_m)) {
    take(ParameterConflict{"costmap.clearance_height_m", "costmap.growth_height_m", "greater"});
  }
  const bool is_belly = vehicle.ground_clearance_m < vehicle.max_step_m;
  if (!(costmap.obstacle_height_m <= LeastObstacle_m(vehicle))) {
    take(ParameterConflict{"costmap.obstacle_height_m",
                           is_belly ? "vehicle.ground_clearance_m" : "vehicle.max_step_m",
                           "no greater: the vehicle cannot drive over anything higher"});
  }
  // Half a cell's diagonal beyond the outline and its margin (PlanningRadius, core/path/path.h).
  const float for_width_m = 0.5f * vehicle.width_m + planner.path.margin_m + 0.14142136f;
  const bool is_for_width = for_width_m > costmap.planning_radius_m;
  const float radius_m = is_for_width ? for_width_m : costmap.planning_radius_m;
  const float deepest = costmap.hard_edge_cost + costmap.soft_edge_cost + costmap.unknown_cost +
                        (costmap.hard_slope_per_m + costmap.soft_slope_per_m) * radius_m;
  if (!(deepest <= kMaxCellCost)) {
    take(ParameterConflict{
        "costmap.hard_slope_per_m", is_for_width ? "vehicle.width_m" : "costmap.planning_radius_m",
        "low enough that the costs of both layers at the depth of the dilation and "
        "costmap.unknown_cost add up to at most 39"});
  }
}

// Segmentation and map: ground for the one must not be an obstacle for the other.
template <typename Take>
constexpr void ForEachConflict(const CostmapParams& costmap, const SegmentationParams& segmentation,
                               Take&& take) {
  if (!(segmentation.ground_band_m < costmap.obstacle_height_m)) {
    take(ParameterConflict{"segmentation.ground_band_m", "costmap.obstacle_height_m",
                           "less: returns up to this height are ground"});
  }
}

template <typename Take>
constexpr void ForEachConflict(const VehicleParams& vehicle, const PerceptionParams& perception,
                               Take&& take) {
  const LidarMountParams& mount = perception.mount;
  const float front_m = 0.5f * vehicle.length_m - vehicle.axle_offset_m;
  const float rear_m = -0.5f * vehicle.length_m - vehicle.axle_offset_m;
  const float half_width_m = 0.5f * vehicle.width_m;
  constexpr const char* kOnVehicle = "on the vehicle: at most 0.5 m outside its outline";
  if (!(mount.x_m <= front_m + kMaxBeyondOutline_m && mount.x_m >= rear_m - kMaxBeyondOutline_m)) {
    take(ParameterConflict{"mount.x_m", "vehicle.length_m", kOnVehicle});
  }
  const float aside_m = mount.y_m < 0.0f ? -mount.y_m : mount.y_m;
  if (!(aside_m <= half_width_m + kMaxBeyondOutline_m)) {
    take(ParameterConflict{"mount.y_m", "vehicle.width_m", kOnVehicle});
  }
  constexpr const char* kAround =
      "0 to 0.5 m outside the outline: a part of the vehicle outside the box would count as an "
      "obstacle, and anything else inside the box stays hidden";
  if (!(mount.self_max_x_m >= front_m && mount.self_max_x_m <= front_m + kMaxBeyondOutline_m)) {
    take(ParameterConflict{"mount.self_max_x_m", "vehicle.length_m", kAround});
  }
  if (!(mount.self_max_abs_y_m >= half_width_m &&
        mount.self_max_abs_y_m <= half_width_m + kMaxBeyondOutline_m)) {
    take(ParameterConflict{"mount.self_max_abs_y_m", "vehicle.width_m", kAround});
  }
  if (!(mount.self_min_x_m <= rear_m && mount.self_min_x_m >= rear_m - kMaxBehindOutline_m)) {
    take(ParameterConflict{"mount.self_min_x_m", "vehicle.length_m", "0 to 2 m behind the rear"});
  }
}

template <typename Take>
constexpr void ForEachConflict(const PlannerParams& planner, const OnboardParams& onboard,
                               Take&& take) {
  const SpeedParams& speed = planner.speed;
  const DynamicsParams& dynamics = onboard.dynamics;
  if (!(speed.stopping_dead_time_s >= dynamics.dead_time_s)) {
    take(ParameterConflict{"speed.stopping_dead_time_s", "dynamics.dead_time_s",
                           "at least as long: plans must allow for the drives' dead time"});
  }
  if (!(speed.stopping_lag_s >= dynamics.common_lag_s + dynamics.speed_lag_s)) {
    take(ParameterConflict{"speed.stopping_lag_s", "dynamics.common_lag_s",
                           "at least the sum of dynamics.common_lag_s and dynamics.speed_lag_s"});
  }
  if (!(onboard.safety.corridor_margin_m <= planner.path.kept_margin_m)) {
    take(ParameterConflict{"safety.corridor_margin_m", "path.kept_margin_m",
                           "no greater: otherwise a free plan would brake forever"});
  }
}

// For the two drives. hal/sevcon itself refuses signs other than 1 and -1.
template <typename Take>
constexpr void ForEachConflict(const DriveParams& drive, Take&& take) {
  constexpr const char* kDiffers = "different: each node needs its own number";
  if (drive.left_node == drive.right_node) {
    take(ParameterConflict{"drive.right_node", "drive.left_node", kDiffers});
  }
  if (drive.master_node == drive.left_node) {
    take(ParameterConflict{"drive.master_node", "drive.left_node", kDiffers});
  }
  if (drive.master_node == drive.right_node) {
    take(ParameterConflict{"drive.master_node", "drive.right_node", kDiffers});
  }
  constexpr const char* kGreater = "greater";
  if (drive.heartbeat_timeout_ms <= drive.heartbeat_period_ms) {
    take(ParameterConflict{"drive.heartbeat_timeout_ms", "drive.heartbeat_period_ms", kGreater});
  }
  if (drive.command_timeout_ms <= drive.command_period_ms) {
    take(ParameterConflict{"drive.command_timeout_ms", "drive.command_period_ms", kGreater});
  }
  if (drive.feedback_timeout_ms <= drive.sync_period_ms) {
    take(ParameterConflict{"drive.feedback_timeout_ms", "drive.sync_period_ms", kGreater});
  }
}

// For a motion controller and the vehicle that it moves.
template <typename Take>
constexpr void ForEachConflict(const TwistDriveParams& drive, const VehicleParams& vehicle,
                               Take&& take) {
  constexpr const char* kDiffers = "different: each frame needs its own identifier";
  if (drive.feedback_id == drive.command_id) {
    take(ParameterConflict{"twist_drive.feedback_id", "twist_drive.command_id", kDiffers});
  }
  if (drive.status_id == drive.command_id) {
    take(ParameterConflict{"twist_drive.status_id", "twist_drive.command_id", kDiffers});
  }
  if (drive.status_id == drive.feedback_id) {
    take(ParameterConflict{"twist_drive.status_id", "twist_drive.feedback_id", kDiffers});
  }
  const bool can_steer = vehicle.kinematics == VehicleParams::kAckermann;
  if (drive.turn == TwistDriveParams::kSteering && !can_steer) {
    take(ParameterConflict{"twist_drive.turn", "vehicle.kinematics",
                           "0: a skid-steered vehicle has no steering angle"});
  }
}

// The first conflict of a group, or one without a name.
constexpr ParameterConflict FirstConflict(const PlannerParams& planner) {
  ParameterConflict first;
  ForEachConflict(planner, [&first](const ParameterConflict& conflict) {
    if (first.name == nullptr) first = conflict;
  });
  return first;
}

constexpr ParameterConflict FirstConflict(const TwistDriveParams& drive,
                                          const VehicleParams& vehicle) {
  ParameterConflict first;
  ForEachConflict(drive, vehicle, [&first](const ParameterConflict& conflict) {
    if (first.name == nullptr) first = conflict;
  });
  return first;
}

// For all parameters of an onboard program except the drives', which hal/sevcon checks itself.
constexpr ParameterConflict FirstConflict(const PlannerParams& planner,
                                          const PerceptionParams& perception,
                                          const OnboardParams& onboard) {
  ParameterConflict first = FirstConflict(planner);
  const auto take = [&first](const ParameterConflict& conflict) {
    if (first.name == nullptr) first = conflict;
  };
  ForEachConflict(planner.vehicle, perception, take);
  ForEachConflict(planner, onboard, take);
  return first;
}

// Inconsistent defaults do not compile.
static_assert(FirstConflict(PlannerParams{}, PerceptionParams{}, OnboardParams{}).name == nullptr);

}  // namespace hardpack
