// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Every parameter of planning, with its unit in its name, its default (for the Clearpath Warthog)
// and, in config/parameter_tables.h, its range. A parameter is checked against that one table
// wherever it comes from. Sources: [OS] is Overbye and Saripalli; anything not in the paper is our
// choice, explained in docs/parameters.md.

namespace hardpack {

// The vehicle's shape and capabilities. Its outline, the discs that cover it, the circle of a turn
// on the spot and the least dilation of obstacles follow from the first three
// (core/base/footprint.h).
struct VehicleParams {
  static constexpr int32_t kSkidSteered = 0;  // left and right wheels at different speeds
  static constexpr int32_t kAckermann = 1;    // steered front wheels
  float length_m = 1.52f;                     // overall
  float width_m = 1.38f;                      // overall
  // How far the axle's centre, about which it turns on the spot (with kAckermann: the rear axle's),
  // is ahead of the outline's centre.
  float axle_offset_m = 0.0f;
  float wheel_radius_m = 0.30f;
  float skid_baseline_m = 1.87f;  // effective distance of the wheels in a skid-steer turn
  float max_wheel_speed_radps = 17.5f;
  float ground_clearance_m = 0.254f;  // under its belly, from the manufacturer's manual
  float max_step_m = 0.2f;            // that its wheels can climb: two thirds of their radius
  int32_t kinematics = kSkidSteered;
  float wheelbase_m = 1.5f;        // with kAckermann: from the rear axle to the front axle
  float max_steering_rad = 0.45f;  // likewise: mean of the front wheels, to either side
};

// The least height of objects that the vehicle cannot drive over: obstacles are detected from there
// on.
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
  float obstacle_height_m = 0.2f;    // objects at least this high are obstacles if firm
  float growth_height_m = 0.5f;      // growth (scatters the beams) up to this is driven through
  float clearance_height_m = 2.0f;   // returns above this are ignored
  int32_t ground_window_cells = 15;  // side of the neighbourhood whose lowest return is the ground
  float planning_radius_m = 0.94f;   // least dilation (PlanningRadius in core/path/path.h)
  float halo_m = 2.1f;               // width of the repulsive halo around the dilated region
  float hard_edge_cost = 2.0f;       // hard layer: cost at the region's edge ...
  float hard_slope_per_m = 12.0f;    // ... and its growth with the depth inside
  float soft_edge_cost = 1.5f;       // soft layer: the same
  float soft_slope_per_m = 3.0f;
  float unknown_cost = 1.0f;           // added where the ground was not observed
  float near_unknown_cost = 9.0f;      // likewise near the lidar (core/costmap/near_unknown.h)
  float max_grade = 0.5f;              // rise per metre: steeper ground is hard; 0: none is
  float free_grade = 0.15f;            // up to here the grade costs nothing ...
  float grade_cost = 5.0f;             // ... and this much more per unit beyond
  float free_roughness_m = 0.04f;      // about the plane of 1 m of ground; likewise
  float roughness_cost_per_m = 20.0f;  // up to 15 altogether (core/costmap/terrain.h)
};

struct AstarParams {
  int32_t max_expansions = 262144;
  int32_t move_goal_out_of_obstacle = 1;  // 0: refuse a goal inside a hard obstacle
};

struct PathParams {
  float step_m = 0.275f;                 // resampling step of the base path
  int32_t smoothing_passes = 40;         // averaging passes over the seed; 0: keep the staircase
  float max_join_heading_rad = 1.0472f;  // larger start heading errors begin with a pivot
  float pivot_margin_m = 0.15f;          // clearance around the pivot circle
  float margin_m = 0.1f;                 // from the outline to hard cells, on a new plan ...
  float kept_margin_m = 0.05f;           // ... and on the one being driven: for tracking errors
  float lead_out_m = 10.0f;     // longest lead-out along the heading where there is no room to turn
  float reverse_out_m = 24.0f;  // longest lead-out in reverse, where there is none ahead; 0: never
  float unseen_start_m = 2.4f;  // distance from the map's first pose before a turn; 0: none
};

// Cost weights and limits of [OS] Cost Function Formulation, per metre of path.
struct OptimizerParams {
  static constexpr int32_t kPaperDescent = 0;   // Algorithm 1 of the paper
  static constexpr int32_t kLateralNewton = 1;  // ours
  int32_t method = kLateralNewton;
  float max_curvature_per_m = 0.5f;
  float max_curvature_rate_per_m2 = 0.5f;
  // Tried first: at this rate speed.max_curvature_rate_per_s2 allows 3.4 m/s.
  float preferred_curvature_rate_per_m2 = 0.06f;
  // Its out-of-bounds weight.
  float preferred_curvature_rate_beta = 8.0f;

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
  float gamma_per_m = 0.5f;  // curvature at which the limit falls to min_speed_mps

  float max_acceleration_mps2 = 2.0f;
  float max_deceleration_mps2 = 2.0f;
  float max_lateral_acceleration_mps2 = 2.0f;
  float max_vertical_acceleration_mps2 = 2.5f;  // of the body, over ground that bends
  float friction = 0.5f;                        // of tyres on the ground
  float max_yaw_rate_radps = 1.1f;
  float max_wheel_speed_share = 0.9f;
  float max_curvature_rate_per_s2 = 0.7f;  // v^2 * |dkappa/ds| is at most this
  float obstacle_start_speed_mps = 0.5f;   // while leaving a hard obstacle at the start
  float max_reverse_mps = 0.5f;
  float reaction_time_s = 0.3f;        // from a return's stamp to the first command
  float stopping_dead_time_s = 0.15f;  // of the drives
  float stopping_lag_s = 0.55f;        // first-order lag of the drives plus the body
  float person_speed_mps = 2.0f;       // assumed walking speed of a person, also into the path
  float person_margin_m = 0.5f;
  float person_creep_mps = 0.2f;  // up to and past a person close by; 0: none
  float max_unseen_m = 0.6f;      // longest unobserved stretch of ground along the path
  float unseen_margin_m = 0.6f;   // between the vehicle at rest and unobserved ground
  float hidden_creep_mps = 0.2f;  // over ground that no place could show; 0: none
  float narrow_room_m = 0.15f;    // with less beside the footprint's discs: at min_speed_mps
  // The vehicle's error beside its path, including odometry drift, at a speed: the sum of
  float track_error_m = 0.03f;    // this at rest,
  float track_error_s = 0.03f;    // this for each m/s,
  float track_error_s2 = 0.12f;   // and this for each m/s^2 of recent lateral acceleration.
  float least_room_mps = 0.7f;    // with less room than that: at most this
  float growth_speed_mps = 3.0f;  // through growth, which may hide lower objects
  // Objects that must be seen before the vehicle is closer than its stopping distance, and whether
  // a lidar that cannot do so is refused.
  float assured_height_m = 0.2f;
  float assured_width_m = 0.32f;  // the width of a lying person's legs
  int32_t refuse_unassured = 1;
};

// When the plan being driven is replaced by a new one, and where the new one joins it
// (core/autonomy/replanner.h).
struct ReplanParams {
  float cheaper_share = 0.25f;       // a new plan must be cheaper by this share of the old cost ...
  float cheaper_floor = 1.0f;        // ... and by at least this
  float max_cross_track_m = 0.5f;    // farther off the path: planned from the vehicle's own pose
  float least_cross_track_m = 0.2f;  // the same where there is less room, but not below this
  float min_latency_s = 0.1f;        // least planning time assumed
  float extend_m = 5.0f;             // an end short of the goal is extended if it can come this
                                     // much closer
  float goal_change_m = 1.0f;        // a goal that moves by more is a new goal
  float pass_radius_m = 1.5f;        // a waypoint that is passed is passed within this
};

// Pose of the lidar on the vehicle, and which returns are the vehicle itself.
struct LidarMountParams {
  float x_m = 0.0f;
  float y_m = 0.0f;
  float z_m = 1.284f;  // height of the sensor frame above the ground
  float roll_rad = 0.0f;
  float pitch_rad = 0.0f;
  float yaw_rad = 0.0f;  // 0: the sensor frame's x points forward; pi: backward
  // Self filter: returns inside this box of the body frame are the vehicle itself.
  float self_min_x_m = -0.86f;
  float self_max_x_m = 0.95f;
  float self_max_abs_y_m = 0.85f;
  float self_max_z_m = 2.2f;
  float min_range_m = 0.5f;
  float max_range_m = 120.0f;
};

// The class of a return by geometry alone (core/segmentation), and where ground counts as observed.
struct SegmentationParams {
  float max_ground_slope = 0.55f;  // rise over level distance of drivable ground
  float ground_band_m = 0.08f;     // returns up to this height above the ground are ground
  float carry_m = 5.0f;            // beyond its last return the ground is known this far
  float isolation_m = 0.4f;        // a return with no neighbour this close in range is rain or dust
  float roughness_m = 0.08f;       // returns of one surface lie this close to it
  float max_soft_height_m = 2.0f;  // anything that reaches higher is a tree, and hard
  float bridge_factor = 1.5f;      // ring spacings that observed ground may bridge
  float bridge_max_slope = 0.3f;   // and its largest slope
};

// How the map takes in measurements, and how it ages (core/autonomy/mapper.h).
struct MappingParams {
  int32_t use_labels = 0;              // 1: a segmentation computer sends labels; wait for them
  float label_deadline_s = 0.25f;      // after this a return is filed with its geometric class
  int32_t ageing_revolutions = 3;      // seen through in this many: removed
  float start_ground_radius_m = 5.0f;  // ground counted as observed around the start
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
