// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Every parameter of planning, with its unit in its name, its default (the Clearpath Warthog) and,
// in config/parameter_tables.h, its range. A parameter is checked against that one table wherever
// it comes from. Sources: [OS] is Overbye and Saripalli; what is not in the paper is our choice,
// explained in docs/parameters.md.

namespace hardpack {

// The vehicle's shape and what it can do. Its outline, the discs that cover it, the circle of a
// turn on the spot and how far obstacles are dilated at least follow from the first three
// (core/base/footprint.h).
struct VehicleParams {
  static constexpr int32_t kSkidSteered = 0;  // left and right wheels at different speeds
  static constexpr int32_t kAckermann = 1;    // front wheels that are steered
  float length_m = 1.52f;                     // overall
  float width_m = 1.38f;                      // overall
  // How far the axle's centre, about which it turns on the spot (with kAckermann: the rear axle's),
  // is ahead of the outline's middle.
  float axle_offset_m = 0.0f;
  float wheel_radius_m = 0.30f;
  float skid_baseline_m = 1.87f;  // effective distance of the wheels of a skid-steer turn
  float max_wheel_speed_radps = 17.5f;
  float ground_clearance_m = 0.254f;  // under its belly, from the maker's manual
  float max_step_m = 0.2f;            // that its wheels climb: two thirds of their radius
  int32_t kinematics = kSkidSteered;
  float wheelbase_m = 1.5f;        // with kAckermann: from the rear axle to the front axle
  float max_steering_rad = 0.45f;  // the same: of the front wheels' mean, to either side
};

// The least height of what the vehicle cannot pass over: obstacles are told from there on.
constexpr float LeastObstacle_m(const VehicleParams& vehicle) {
  return vehicle.ground_clearance_m < vehicle.max_step_m ? vehicle.ground_clearance_m
                                                         : vehicle.max_step_m;
}

// Which returns become obstacles ([OS] Cost Map Creation).
enum class ObstacleRule : int32_t {
  kInCell = 0,       // the paper: highest hard return above the lowest return of the same cell
  kLocalGround = 1,  // default: height above the local ground surface
};

struct CostmapParams {
  ObstacleRule obstacle_rule = ObstacleRule::kLocalGround;
  float obstacle_height_m = 0.2f;    // what stands as high as this is an obstacle if it is firm
  float growth_height_m = 0.5f;      // what scatters the beams and is no higher is passed through
  float clearance_height_m = 2.0f;   // returns above this do not count
  int32_t ground_window_cells = 15;  // side of the neighbourhood whose lowest return is the ground
  float planning_radius_m = 0.94f;   // dilation, at least (PlanningRadius in core/path/path.h)
  float halo_m = 2.1f;               // width of the repulsive halo around the dilated region
  float hard_edge_cost = 7.0f;       // hard layer: cost at the region's edge ...
  float hard_slope_per_m = 12.0f;    // ... and its growth with the depth inside
  float soft_edge_cost = 1.5f;       // soft layer: the same
  float soft_slope_per_m = 3.0f;
  float unknown_cost = 1.0f;  // added where the ground was not observed
};

struct AstarParams {
  int32_t max_expansions = 262144;
  int32_t move_goal_out_of_obstacle = 1;  // 0: refuse a goal inside a hard obstacle
};

struct PathParams {
  float step_m = 0.275f;                 // resampling step of the base path
  int32_t smoothing_passes = 40;         // averaging passes over the seed; 0: the staircase itself
  float max_join_heading_rad = 1.0472f;  // larger start heading errors begin with a pivot
  float pivot_margin_m = 0.15f;          // free distance around the pivot circle
  float margin_m = 0.1f;                 // between the outline and what is hard, on a new plan ...
  float kept_margin_m = 0.05f;           // ... and on one that is driven: what tracking needs
  float lead_out_m = 10.0f;  // longest way along the heading out of where there is no room to turn
  float unseen_start_m = 2.4f;  // way from the map's first pose before a turn; 0: none
};

// Cost weights and limits of [OS] Cost Function Formulation, per metre of path.
struct OptimizerParams {
  static constexpr int32_t kPaperDescent = 0;   // Algorithm 1 of the paper
  static constexpr int32_t kLateralNewton = 1;  // ours
  int32_t method = kLateralNewton;
  float max_curvature_per_m = 0.5f;
  float max_curvature_rate_per_m2 = 0.5f;
  // Tried first: there speed.max_curvature_rate_per_s2 allows speed.min_speed_mps.
  float preferred_curvature_rate_per_m2 = 0.175f;
  // Its out-of-bounds weight.
  float preferred_curvature_rate_beta = 6.0f;

  float curvature_alpha = 1.0f;        // in-bounds weight of |curvature|
  float curvature_beta = 40.0f;        // out-of-bounds weight
  float curvature_rate_alpha = 0.1f;   // in-bounds weight of |curvature rate|
  float curvature_rate_beta = 20.0f;   // out-of-bounds weight
  float perturbation_rad = 0.02f;      // the unit step delta of Algorithm 1
  float max_perturbation_rad = 0.04f;  // clamp of the scaled step
  float perturbation_scale = 0.1f;     // scaled step = unit step * scale * decrease of cost
  int32_t window_steps = 25;           // N, the damping length
  int32_t max_sweeps = 60;
  float min_relative_decrease = 0.01f;  // a sweep that lowers F by less ends the descent
  int32_t max_newton_steps = 20;
};

// [OS] Speed Control; values below the blank line are ours.
struct SpeedParams {
  float max_speed_mps = 5.0f;
  float min_speed_mps = 2.0f;
  float gamma_per_m = 0.5f;  // curvature at which min_speed_mps is asked for

  float max_acceleration_mps2 = 2.0f;
  float max_deceleration_mps2 = 2.0f;
  float max_lateral_acceleration_mps2 = 2.0f;
  float max_yaw_rate_radps = 1.1f;
  float max_wheel_speed_share = 0.9f;
  float max_curvature_rate_per_s2 = 0.7f;  // v^2 * |dkappa/ds| is at most this
  float obstacle_start_speed_mps = 0.5f;   // while leaving a hard obstacle at the start
  float reaction_time_s = 0.3f;            // from a return's stamp to the first command
  float stopping_dead_time_s = 0.15f;      // of the drives
  float stopping_lag_s = 0.55f;            // first-order lag of the drives and the body behind them
  float person_speed_mps = 2.0f;           // how fast a person may walk, into the way as well
  float person_margin_m = 0.5f;
  float person_creep_mps = 0.2f;  // up to and past a person who is near; 0: none
  float max_unseen_m = 0.6f;      // stretch of ground along the path that may be unobserved
  float unseen_margin_m = 0.6f;   // between the vehicle at rest and ground that was not observed
  float narrow_room_m = 0.15f;    // with less beside the footprint's discs: at min_speed_mps
  // What the vehicle is beside its path by, the odometry's drift included, at a speed: its sum of
  float track_error_m = 0.03f;    // so much at rest,
  float track_error_s = 0.03f;    // so much for each m/s,
  float track_error_s2 = 0.12f;   // and so much for each m/s^2 of lateral acceleration lately.
  float least_room_mps = 0.7f;    // with less room than any of that: at most this
  float growth_speed_mps = 3.0f;  // through growth, which may hide what is lower than itself
  // What has to be seen before the vehicle is nearer than it needs to stop, and whether a lidar
  // that never sees it so is refused.
  float assured_height_m = 0.2f;
  float assured_width_m = 0.32f;  // as wide as the legs of somebody who lies there
  int32_t refuse_unassured = 1;
};

// When the plan that is driven gives way to a new one, and where the new one joins it
// (core/autonomy/replanner.h).
struct ReplanParams {
  float cheaper_share = 0.25f;     // a new plan must cost less by so much of the old one's cost ...
  float cheaper_floor = 1.0f;      // ... and by so much at least
  float max_cross_track_m = 0.5f;  // further off the path: planned from the vehicle's own pose
  float least_cross_track_m = 0.2f;  // the same where there is less room, but not below this
  float min_latency_s = 0.1f;        // least time that a plan is taken to need
  float extend_m = 5.0f;             // an end short of the goal is left behind once it could be so
                                     // much nearer
  float goal_change_m = 1.0f;        // a goal that moves by more is another one
};

// Where the lidar sits on the vehicle, and which returns are the vehicle itself.
struct LidarMountParams {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float z_m = 1.284f;  // height of the sensor frame above the ground
  float roll_rad = 0.0f;
  float pitch_rad = 0.0f;
  float yaw_rad = 0.0f;  // the sensor frame's x points forward; pi where it points backward
  // Self filter: returns inside this box of the body frame are the vehicle itself.
  float self_min_x_m = -2.7f;
  float self_max_x_m = 0.95f;
  float self_max_abs_y_m = 0.85f;
  float self_max_z_m = 2.2f;
  float min_range_m = 0.5f;
  float max_range_m = 120.0f;
};

// What a return is by geometry alone (core/segmentation), and where ground counts as observed.
struct SegmentationParams {
  float max_ground_slope = 0.55f;  // rise over level distance of drivable ground
  float ground_band_m = 0.08f;     // what is no higher above the ground is ground
  float carry_m = 5.0f;            // beyond its last return the ground is known so far
  float isolation_m = 0.4f;        // a return with no neighbour so near in range is rain or dust
  float roughness_m = 0.08f;       // returns of one surface lie so near to it
  float max_soft_height_m = 2.0f;  // what reaches higher is a tree, and hard
  float bridge_factor = 1.5f;      // ring spacings that observed ground may bridge
  float bridge_max_slope = 0.3f;   // and the slope that it may have
};

// How the map takes in what was measured, and how it forgets (core/autonomy/mapper.h).
struct MappingParams {
  int32_t use_labels = 0;              // 1: a segmentation computer sends labels; wait for them
  float label_deadline_s = 0.25f;      // then a return is filed with its geometric class
  int32_t ageing_revolutions = 3;      // seen through in so many of them: no longer there
  float start_ground_radius_m = 5.0f;  // ground taken as observed around the place of the start
  float height_jump_m = 0.2f;          // a step of the odometry's height beyond this is a jump
  float position_jump_m = 1.0f;        // a step of its position beyond this empties the map
};

struct PerceptionParams {
  LidarMountParams mount;
  SegmentationParams segmentation;
  MappingParams mapping;
};

struct PlannerParams {
  VehicleParams vehicle;
  CostmapParams costmap;
  AstarParams astar;
  PathParams path;
  OptimizerParams optimizer;
  SpeedParams speed;
  ReplanParams replan;
};

}  // namespace hardpack
