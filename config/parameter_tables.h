// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/parameters.h"

// The valid values of each parameter of config/parameters.h: the one table used by the checks, the
// command line and docs/parameters.md. An entry names its member by pointer, so that neither a
// member without an entry nor a default out of range compiles (core/base/validate.h), and reading
// through an entry is plain data access: no call that a static timing analysis could not follow.
//
// The ranges are what the stages can compute with and what makes sense for a vehicle of this kind.
// Conditions on several parameters are in config/conflicts.h.

namespace hardpack {

// One member of a group of parameters; exactly one of the three pointers is set.
template <typename Group>
struct ParameterEntry {
  const char* full_name;      // "group.member", including the unit
  const char* name;           // "member"
  float Group::*number;       // a number with a unit
  int32_t Group::*whole;      // a count, or a switch with values 0 and 1
  ObstacleRule Group::*rule;  // by its number
  float low;                  // both ends included
  float high;
  const char* description;
  float Group::*not_above;  // null, or a member that this one must not exceed

  // An integer beyond 2^24 may be rounded: GetWhole is exact. Not inlined: GCC 12 would warn about
  // member types that a group does not have.
  [[gnu::noinline]] constexpr float Get(const Group& group) const {
    if (number != nullptr) return group.*number;
    return static_cast<float>(GetWhole(group));
  }

  // Precondition: number is not set.
  [[gnu::noinline]] constexpr int32_t GetWhole(const Group& group) const {
    return whole != nullptr ? group.*whole : static_cast<int32_t>(group.*rule);
  }
};

template <typename Group>
constexpr ParameterEntry<Group> MakeEntry(const char* full_name, const char* name,
                                          float Group::*member, float low, float high,
                                          const char* description,
                                          float Group::*not_above = nullptr) {
  return {full_name, name, member, nullptr, nullptr, low, high, description, not_above};
}
template <typename Group>
constexpr ParameterEntry<Group> MakeEntry(const char* full_name, const char* name,
                                          int32_t Group::*member, float low, float high,
                                          const char* description) {
  return {full_name, name, nullptr, member, nullptr, low, high, description, nullptr};
}
template <typename Group>
constexpr ParameterEntry<Group> MakeEntry(const char* full_name, const char* name,
                                          ObstacleRule Group::*member, float low, float high,
                                          const char* description) {
  return {full_name, name, nullptr, nullptr, member, low, high, description, nullptr};
}

// The member gives the entry its names: they cannot disagree.
#define HP_ENTRY(group, type, member, ...) \
  MakeEntry(group "." #member, #member, &type::member, __VA_ARGS__)

#define HP_VEHICLE(...) HP_ENTRY("vehicle", VehicleParams, __VA_ARGS__)
inline constexpr std::array kVehicleTable = {
    HP_VEHICLE(length_m, 0.3f, 6.0f, "Overall length."),
    HP_VEHICLE(width_m, 0.3f, 4.0f, "Overall width."),
    HP_VEHICLE(axle_offset_m, -3.0f, 3.0f,
               "How far the axle's centre is ahead of the middle of the vehicle's length; "
               "negative: behind it. The axle's centre is the point about which the vehicle turns "
               "on the spot and the origin of the body frame; with steered front wheels it is the "
               "rear axle's. At most half of vehicle.length_m (ours)."),
    HP_VEHICLE(wheel_radius_m, 0.05f, 1.0f, "Radius of the wheels."),
    HP_VEHICLE(skid_baseline_m, 0.2f, 5.0f,
               "Effective distance between the left and right wheels in a skid-steer turn: more "
               "than the track, because the wheels slip."),
    HP_VEHICLE(max_wheel_speed_radps, 0.5f, 200.0f, "Highest wheel speed that the drives reach."),
    HP_VEHICLE(ground_clearance_m, 0.02f, 2.0f,
               "Height above the ground of the lowest part between the wheels. The lesser of this "
               "and max_step_m is the least height that the vehicle cannot drive over."),
    HP_VEHICLE(max_step_m, 0.02f, 2.0f,
               "Height of a step that the wheels can climb: two thirds of their radius (ours)."),
    HP_VEHICLE(kinematics, 0.0f, 1.0f,
               "Steering: 0 skid-steered by the wheel speeds, can turn on the spot; 1 Ackermann by "
               "the front wheels, cannot (ours)."),
    HP_VEHICLE(wheelbase_m, 0.3f, 5.0f,
               "With vehicle.kinematics 1: distance from the rear axle to the front axle."),
    HP_VEHICLE(max_steering_rad, 0.05f, 1.2f,
               "With vehicle.kinematics 1: largest steering angle to either side of a virtual "
               "wheel in the middle of the front axle. The minimum turning radius of the rear "
               "axle's centre is vehicle.wheelbase_m / tan of it.")};
#undef HP_VEHICLE

#define HP_COSTMAP(...) HP_ENTRY("costmap", CostmapParams, __VA_ARGS__)
inline constexpr std::array kCostmapTable = {
    HP_COSTMAP(obstacle_rule, 0.0f, 1.0f,
               "Reference for the height of a return: 0 the lowest return of its cell (the paper), "
               "1 the local ground around it (ours)."),
    HP_COSTMAP(obstacle_height_m, 0.05f, 2.0f,
               "Firm objects at least this high above the ground are obstacles: at most the lesser "
               "of vehicle.ground_clearance_m and vehicle.max_step_m (ours).",
               &CostmapParams::growth_height_m),
    HP_COSTMAP(growth_height_m, 0.05f, 2.0f,
               "Anything that scatters the beams, as grass does, is driven through up to this "
               "height; anything higher is an obstacle, firm or not (ours).",
               &CostmapParams::clearance_height_m),
    HP_COSTMAP(clearance_height_m, 0.1f, 4.0f,
               "Returns higher than this are ignored: the vehicle passes below them (ours)."),
    HP_COSTMAP(ground_window_cells, 1.0f, 31.0f,
               "Side of the neighbourhood whose lowest return is the local ground; odd (ours)."),
    HP_COSTMAP(planning_radius_m, 0.0f, 2.0f,
               "Least dilation of obstacles; half of vehicle.width_m plus path.margin_m plus half "
               "a cell's diagonal is used if it is more (ours)."),
    HP_COSTMAP(halo_m, 0.0f, 3.0f,
               "Width of the halo that repels paths around the dilated region (ours)."),
    HP_COSTMAP(hard_edge_cost, 0.0f, 39.0f,
               "Hard layer: cost at the edge of the dilated region, where the halo begins (ours)."),
    HP_COSTMAP(hard_slope_per_m, 0.0f, 100.0f,
               "Hard layer: growth of the cost with the depth inside; both layers together may "
               "reach 39 (ours)."),
    HP_COSTMAP(soft_edge_cost, 0.0f, 39.0f, "Soft layer: the same as hard_edge_cost (ours)."),
    HP_COSTMAP(soft_slope_per_m, 0.0f, 100.0f, "Soft layer: the same as hard_slope_per_m (ours)."),
    HP_COSTMAP(
        unknown_cost, 0.0f, 39.0f,
        "Cost of a cell whose ground was not observed, added to the cost of both layers (ours)."),
    HP_COSTMAP(near_unknown_cost, 0.0f, 39.0f,
               "Added where the outline would cover ground that was not observed, near something "
               "hard and about as near to the lidar as it cannot see the ground; 0: none (ours)."),
    HP_COSTMAP(
        max_grade, 0.0f, 1.9f,
        "Ground that rises by more than this per metre, in any direction, is an obstacle: 0.5 "
        "is 27 degrees, where friction of 0.5 ends; 0: none is, and grade and roughness cost "
        "nothing (ours)."),
    HP_COSTMAP(free_grade, 0.0f, 1.9f, "A grade up to this costs nothing (ours)."),
    HP_COSTMAP(grade_cost, 0.0f, 100.0f,
               "Cost of the grade beyond costmap.free_grade, per metre of rise in a metre (ours)."),
    HP_COSTMAP(free_roughness_m, 0.0f, 1.0f,
               "Roughness up to this costs nothing: the standard deviation of the ground's heights "
               "from the plane through a square of 1 m (ours)."),
    HP_COSTMAP(roughness_cost_per_m, 0.0f, 1000.0f,
               "Cost of the roughness beyond costmap.free_roughness_m (ours).")};
#undef HP_COSTMAP

#define HP_ASTAR(...) HP_ENTRY("astar", AstarParams, __VA_ARGS__)
inline constexpr std::array kAstarTable = {
    HP_ASTAR(max_expansions, 1.0f, 262144.0f,
             "Cells expanded before the search settles for the best partial path; the default is "
             "every cell of the map (ours)."),
    HP_ASTAR(move_goal_out_of_obstacle, 0.0f, 1.0f,
             "1: a goal inside a hard obstacle is moved to a free place near it, on the vehicle's "
             "side, up to 1 m farther than the nearest one; 0: it is refused (ours).")};
#undef HP_ASTAR

#define HP_PATH(...) HP_ENTRY("path", PathParams, __VA_ARGS__)
inline constexpr std::array kPathTable = {
    HP_PATH(step_m, 0.05f, 1.0f,
            "Spacing of the base path's points; a path has at most 256 of them (ours)."),
    HP_PATH(smoothing_passes, 0.0f, 200.0f,
            "Averaging passes that remove A*'s staircase from the optimizer's seed (ours); kept "
            "only if the cost decreases. 0: the paper's seed."),
    HP_PATH(max_join_heading_rad, 0.0f, 1.5707963f,
            "Up to this heading difference the base path is bent to begin along the vehicle's "
            "heading; beyond it the plan begins with a turn on the spot (60 degrees, ours)."),
    HP_PATH(pivot_margin_m, 0.0f, 0.5f,
            "Clearance required around the circle of a turn on the spot (ours)."),
    HP_PATH(margin_m, 0.0f, 0.5f,
            "Clearance between the outline and every hard cell along a new plan (ours)."),
    HP_PATH(kept_margin_m, 0.0f, 0.5f,
            "The same for the plan being driven, whenever it is checked on a new map: the "
            "allowance for tracking error. Less than margin_m, because the edge of an obstacle "
            "moves by a cell from map to map (ours).",
            &PathParams::margin_m),
    HP_PATH(lead_out_m, 0.0f, 12.0f,
            "Where there is no room to turn, the path begins along the present heading, for at "
            "most this distance; 0: never (ours)."),
    HP_PATH(
        reverse_out_m, 0.0f, 24.0f,
        "Where there is no way out along the heading either, the path begins in reverse, for "
        "at most this distance; 0: never. Onboard never with mount.self_min_x_m more than 0.3 m "
        "behind the rear, which hides what is there (ours)."),
    HP_PATH(unseen_start_m, 0.0f, 12.0f,
            "The surroundings of the place where the map begins have not been seen: the vehicle "
            "drives this far along its heading, if that is free, before it turns; 0: it may turn "
            "at once (ours).")};
#undef HP_PATH

#define HP_OPTIMIZER(...) HP_ENTRY("optimizer", OptimizerParams, __VA_ARGS__)
inline constexpr std::array kOptimizerTable = {
    HP_OPTIMIZER(method, 0.0f, 1.0f,
                 "Method that minimises the cost: 0 Algorithm 1 of the paper, 1 Newton's method on "
                 "all points at once (ours)."),
    HP_OPTIMIZER(max_curvature_per_m, 0.01f, 10.0f, "Limit of the curvature."),
    HP_OPTIMIZER(max_curvature_rate_per_m2, 0.01f, 50.0f,
                 "Limit of the curvature rate, the change of curvature along the path."),
    HP_OPTIMIZER(preferred_curvature_rate_per_m2, 0.01f, 50.0f,
                 "Limit used first, so that the path can be driven faster; if that path would "
                 "touch something, max_curvature_rate_per_m2 is used. If this is not lower, there "
                 "is only one limit (ours)."),
    HP_OPTIMIZER(preferred_curvature_rate_beta, 0.0f, 10000.0f,
                 "Cost of curvature rate beyond the preferred limit: low enough that the path "
                 "makes way for obstacles beside it (ours)."),
    HP_OPTIMIZER(curvature_alpha, 0.0f, 1000.0f, "Cost of curvature up to its limit.",
                 &OptimizerParams::curvature_beta),
    HP_OPTIMIZER(curvature_beta, 0.0f, 10000.0f,
                 "Cost of curvature beyond its limit: much higher, so that the limit is a steep "
                 "slope and not a wall."),
    HP_OPTIMIZER(curvature_rate_alpha, 0.0f, 1000.0f, "Cost of curvature rate up to its limit.",
                 &OptimizerParams::curvature_rate_beta),
    HP_OPTIMIZER(curvature_rate_beta, 0.0f, 10000.0f, "Cost of curvature rate beyond its limit."),
    HP_OPTIMIZER(perturbation_rad, 0.0001f, 0.5f,
                 "The unit step of Algorithm 1: the change of heading to try.",
                 &OptimizerParams::max_perturbation_rad),
    HP_OPTIMIZER(max_perturbation_rad, 0.0001f, 1.5f,
                 "Largest change of heading applied at once (ours)."),
    HP_OPTIMIZER(perturbation_scale, 0.0f, 1000.0f,
                 "The step applied is the unit step times this times the decrease of the cost."),
    HP_OPTIMIZER(window_steps, 2.0f, 255.0f,
                 "N, the number of steps within which a perturbation is damped out (25 in the "
                 "paper's figure)."),
    HP_OPTIMIZER(max_sweeps, 0.0f, 1000.0f, "Sweeps over the path before the descent is stopped."),
    HP_OPTIMIZER(min_relative_decrease, 0.0f, 0.5f,
                 "A sweep that lowers the cost by a smaller fraction has converged (ours)."),
    HP_OPTIMIZER(max_newton_steps, 0.0f, 200.0f,
                 "Steps of Newton's method before it is stopped (ours).")};
#undef HP_OPTIMIZER

#define HP_SPEED(...) HP_ENTRY("speed", SpeedParams, __VA_ARGS__)
inline constexpr std::array kSpeedTable = {
    HP_SPEED(max_speed_mps, 0.1f, 20.0f, "Speed on a straight (the paper's 5 m/s)."),
    HP_SPEED(min_speed_mps, 0.05f, 20.0f,
             "Speed where the curvature is gamma or more (the paper's 2 m/s).",
             &SpeedParams::max_speed_mps),
    HP_SPEED(gamma_per_m, 0.01f, 10.0f, "Curvature at which the limit falls to min_speed_mps."),
    HP_SPEED(max_acceleration_mps2, 0.05f, 10.0f, "Limit of the acceleration along the path."),
    HP_SPEED(max_deceleration_mps2, 0.05f, 10.0f, "Limit of the deceleration along the path."),
    HP_SPEED(max_lateral_acceleration_mps2, 0.05f, 10.0f,
             "Limit of the lateral acceleration; the default is the largest recorded above 3 m/s "
             "(ours)."),
    HP_SPEED(max_vertical_acceleration_mps2, 0.05f, 10.0f,
             "Limit of the body's vertical acceleration over ground whose slope along the path "
             "changes, as over waves and edges: a quarter of gravity leaves the wheels most of "
             "their load (ours)."),
    HP_SPEED(
        friction, 0.1f, 1.5f,
        "Friction of tyres on the ground: 0.8 of it is relied on for braking and cornering on a "
        "slope. 0.5 is dry earth and grass, 0.35 the same when wet (ours)."),
    HP_SPEED(
        max_yaw_rate_radps, 0.05f, 10.0f,
        "Limit of the yaw rate: at most what the drives achieve against scrubbing tyres (ours)."),
    HP_SPEED(max_wheel_speed_share, 0.05f, 1.0f,
             "The share of vehicle.max_wheel_speed_radps that a plan may use; the rest is for the "
             "tracker (ours)."),
    HP_SPEED(max_curvature_rate_per_s2, 0.05f, 100.0f,
             "Limit of the squared speed times the curvature rate, the yaw acceleration: at most "
             "what the drives reach while they turn (ours)."),
    HP_SPEED(obstacle_start_speed_mps, 0.05f, 5.0f,
             "Speed limit while leaving a hard obstacle at the start (ours)."),
    HP_SPEED(max_reverse_mps, 0.05f, 1.0f, "Speed limit in reverse (ours)."),
    HP_SPEED(reaction_time_s, 0.0f, 5.0f,
             "From a return's stamp to the first command that accounts for it (ours)."),
    HP_SPEED(stopping_dead_time_s, 0.0f, 5.0f, "Dead time of the drives when stopping (ours)."),
    HP_SPEED(stopping_lag_s, 0.0f, 5.0f,
             "Total lag of the drives, and of the body behind its wheels, when stopping (ours)."),
    HP_SPEED(person_speed_mps, 0.1f, 10.0f,
             "Assumed walking speed of a person into the path or towards the vehicle (ours)."),
    HP_SPEED(person_margin_m, 0.0f, 5.0f, "Distance to keep from a person when stopping (ours)."),
    HP_SPEED(
        person_creep_mps, 0.0f, 1.0f,
        "Creep speed: up to a person, as long as a stop from it leaves person_margin_m, and past a "
        "person who cannot reach the path in the time that it takes; 0: the vehicle stands (ours).",
        &SpeedParams::min_speed_mps),
    HP_SPEED(max_unseen_m, 0.0f, 100.0f,
             "A longer stretch of unobserved ground along the path ends the observed ground, "
             "before which the vehicle can always stop (ours)."),
    HP_SPEED(
        unseen_margin_m, 0.0f, 5.0f,
        "Distance between the vehicle's front at rest and the end of the observed ground, whose "
        "last part may be the slope into a ditch; the vehicle may turn on the spot there (ours)."),
    HP_SPEED(hidden_creep_mps, 0.0f, 0.3f,
             "Creep speed over ground that was in an obstacle's shadow from wherever the lidar has "
             "looked, or that lies behind the brow of a hill: the vehicle stops within half a "
             "wheel's radius of a wheel that drops; 0: it stands (ours).",
             &SpeedParams::min_speed_mps),
    HP_SPEED(narrow_room_m, 0.0f, 1.0f,
             "Where there is less room than this between one of the discs that cover the outline "
             "and a hard cell, less half a cell's diagonal, min_speed_mps is the limit: the "
             "allowance for tracking error (ours)."),
    HP_SPEED(track_error_m, 0.0f, 1.0f,
             "The vehicle's error beside its path must be less than the room there. The error is "
             "the sum of this at any speed, including odometry drift, ..."),
    HP_SPEED(track_error_s, 0.0f, 1.0f, "... this for each m/s, ..."),
    HP_SPEED(track_error_s2, 0.0f, 1.0f,
             "... and this for each m/s^2 of lateral acceleration there and shortly before."),
    HP_SPEED(least_room_mps, 0.1f, 5.0f, "This speed is allowed however little room there is."),
    HP_SPEED(growth_speed_mps, 0.05f, 20.0f,
             "Speed limit through growth, where lower objects cannot be seen (ours)."),
    HP_SPEED(assured_height_m, 0.05f, 2.0f,
             "The speed is limited so that a beam meets any object at least this high, above "
             "segmentation.ground_band_m, before the vehicle is closer than its stopping distance. "
             "A larger value allows more speed, but lower objects may be seen too late "
             "(docs/assured_sight.md; ours)."),
    HP_SPEED(
        assured_width_m, 0.05f, 10.0f,
        "Likewise, any object at least this wide across the line of sight then has enough lidar "
        "columns on it to be distinguished from growth. A larger value allows more speed, but "
        "narrower objects may be recognised too late (docs/assured_sight.md; ours)."),
    HP_SPEED(
        refuse_unassured, 0.0f, 1.0f,
        "If the lidar cannot see objects of assured_height_m and assured_width_m far enough ahead "
        "to stop: 1: the vehicle does not drive; 0: it creeps at person_creep_mps (ours).")};
#undef HP_SPEED

#define HP_REPLAN(...) HP_ENTRY("replan", ReplanParams, __VA_ARGS__)
inline constexpr std::array kReplanTable = {
    HP_REPLAN(cheaper_share, 0.0f, 1.0f,
              "On the same map and to the same end, a new plan replaces the committed one only if "
              "it is cheaper by this share of the committed plan's cost (ours)."),
    HP_REPLAN(cheaper_floor, 0.0f, 1000.0f,
              "And by at least this: when both cost little, a share is meaningless, and obstacle "
              "edges that flicker by a cell change the cost of a path past them by up to 0.8. "
              "Turning by 1 rad costs 1, and so does a metre of unknown ground (ours)."),
    HP_REPLAN(max_cross_track_m, 0.05f, 5.0f,
              "Farther off the committed path than this, the new plan starts from the vehicle's "
              "predicted pose instead of from the path (ours)."),
    HP_REPLAN(least_cross_track_m, 0.05f, 5.0f,
              "The same where there is less room than that beside the path: the room is then the "
              "limit, but never less than this (ours).",
              &ReplanParams::max_cross_track_m),
    HP_REPLAN(
        min_latency_s, 0.0f, 10.0f,
        "The new plan leaves the committed path beyond the stretch that is driven during planning: "
        "this long, or 1.5 times the duration of recent plans, if that is longer (ours)."),
    HP_REPLAN(extend_m, 0.5f, 50.0f,
              "A committed path that ends short of the goal (for example because the goal is off "
              "the map) is extended if its end can be brought closer by this (ours)."),
    HP_REPLAN(goal_change_m, 0.0f, 100.0f,
              "A goal that has moved by more than this is a new goal, whose plan replaces the "
              "committed one at once (ours)."),
    HP_REPLAN(pass_radius_m, 0.5f, 10.0f,
              "A waypoint that is passed without a stop is passed within this distance: the path "
              "may cut its corner so far (ours).")};
#undef HP_REPLAN

#define HP_LIDAR_MOUNT(...) HP_ENTRY("mount", LidarMountParams, __VA_ARGS__)
inline constexpr std::array kLidarMountTable = {
    HP_LIDAR_MOUNT(x_m, -10.0f, 10.0f, "Position of the sensor frame in the body frame: forward."),
    HP_LIDAR_MOUNT(y_m, -10.0f, 10.0f, "The same: to the left."),
    HP_LIDAR_MOUNT(z_m, 0.0f, 10.0f, "The same: above the ground."),
    HP_LIDAR_MOUNT(
        roll_rad, -3.1415927f, 3.1415927f,
        "Orientation of the sensor frame in the body frame: Rz(yaw) Ry(pitch) Rx(roll)."),
    HP_LIDAR_MOUNT(pitch_rad, -3.1415927f, 3.1415927f, "The same."),
    HP_LIDAR_MOUNT(yaw_rad, -3.1415927f, 3.1415927f,
                   "The same; pi if the sensor's x points backward."),
    HP_LIDAR_MOUNT(self_min_x_m, -10.0f, 10.0f,
                   "Returns inside a box of the body frame are the vehicle itself: from here ...",
                   &LidarMountParams::self_max_x_m),
    HP_LIDAR_MOUNT(self_max_x_m, -10.0f, 10.0f, "... to here,"),
    HP_LIDAR_MOUNT(self_max_abs_y_m, 0.0f, 10.0f, "up to this far to either side,"),
    HP_LIDAR_MOUNT(self_max_z_m, 0.0f, 10.0f, "up to this height above the ground."),
    HP_LIDAR_MOUNT(min_range_m, 0.0f, 50.0f, "Closer returns are ignored.",
                   &LidarMountParams::max_range_m),
    HP_LIDAR_MOUNT(max_range_m, 1.0f, 500.0f, "Farther returns are ignored.")};
#undef HP_LIDAR_MOUNT

#define HP_SEGMENTATION(...) HP_ENTRY("segmentation", SegmentationParams, __VA_ARGS__)
inline constexpr std::array kSegmentationTable = {
    HP_SEGMENTATION(max_ground_slope, 0.05f, 2.0f,
                    "Steepest slope (rise over level distance) that can be ground; 25 degrees are "
                    "0.47 (ours)."),
    HP_SEGMENTATION(ground_band_m, 0.0f, 0.5f,
                    "A return at most this high above the local ground is ground, as is one at "
                    "most 0.2 m below it. Must be below costmap.obstacle_height_m; a beam must "
                    "meet the part in between (ours)."),
    HP_SEGMENTATION(carry_m, 0.0f, 50.0f,
                    "Beyond the last ground return of a direction, the ground is extrapolated and "
                    "counts as known up to this distance (ours)."),
    HP_SEGMENTATION(isolation_m, 0.05f, 5.0f,
                    "A return whose neighbours in the range image are all farther away in range "
                    "than this is rain or dust, and is ignored (ours)."),
    HP_SEGMENTATION(
        roughness_m, 0.01f, 0.5f,
        "Returns of one surface lie within this distance of it: range noise and the texture of "
        "walls, bark and clothes. Anything that scatters more is vegetation (ours)."),
    HP_SEGMENTATION(max_soft_height_m, 0.0f, 10.0f,
                    "Vegetation that reaches higher above the ground is a tree, and hard (ours)."),
    HP_SEGMENTATION(bridge_factor, 0.0f, 10.0f,
                    "Ground between two ground returns counts as observed up to this many times "
                    "the ring spacing on flat ground (ours)."),
    HP_SEGMENTATION(bridge_max_slope, 0.0f, 2.0f,
                    "And up to this rise over level distance between them (ours).",
                    &SegmentationParams::max_ground_slope)};
#undef HP_SEGMENTATION

#define HP_MAPPING(...) HP_ENTRY("mapping", MappingParams, __VA_ARGS__)
inline constexpr std::array kMappingTable = {
    HP_MAPPING(use_labels, 0.0f, 1.0f,
               "1: a segmentation computer sends labels, and a return waits for its label until "
               "the deadline; 0: its geometric class is final (ours)."),
    HP_MAPPING(label_deadline_s, 0.0f, 0.25f,
               "Time that a return waits for its label before it is filed with its geometric class "
               "(ours)."),
    HP_MAPPING(ageing_revolutions, 2.0f, 4.0f,
               "An obstacle that the lidar has seen through in this many revolutions, without a "
               "return from it in between, is removed (ours)."),
    HP_MAPPING(start_ground_radius_m, 0.0f, 20.0f,
               "Where mapping starts, the lidar cannot see the ground below its lowest beam: the "
               "ground counts as observed within this radius (ours). 0: it does not."),
    HP_MAPPING(
        height_jump_m, 0.05f, 10.0f,
        "A step of the odometry's height between two poses that exceeds this, and what the vehicle "
        "can climb meanwhile, is a jump: the map is converted to the new heights (ours)."),
    HP_MAPPING(position_jump_m, 0.1f, 100.0f,
               "The same for its position: the map is emptied (ours).")};
#undef HP_MAPPING

#undef HP_ENTRY

// Each entry is one member of 4 bytes: a missing entry would make the sizes differ.
template <typename Group, size_t kEntries>
constexpr bool NamesAllMembers(const std::array<ParameterEntry<Group>, kEntries>&) {
  return kEntries * sizeof(float) == sizeof(Group);
}
static_assert(NamesAllMembers(kVehicleTable));
static_assert(NamesAllMembers(kCostmapTable));
static_assert(NamesAllMembers(kAstarTable));
static_assert(NamesAllMembers(kPathTable));
static_assert(NamesAllMembers(kOptimizerTable));
static_assert(NamesAllMembers(kSpeedTable));
static_assert(NamesAllMembers(kReplanTable));
static_assert(NamesAllMembers(kLidarMountTable));
static_assert(NamesAllMembers(kSegmentationTable));
static_assert(NamesAllMembers(kMappingTable));

}  // namespace hardpack
