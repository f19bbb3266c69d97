// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/planner.h"
#include "core/base/loop_bound.h"

namespace hardpack {
namespace {

void AddStatus(Status status, DecisionHash& hash) {
  hash.AddU8(static_cast<uint8_t>(status));
}

void AddCell(Cell cell, DecisionHash& hash) {
  hash.AddI32(cell.x);
  hash.AddI32(cell.y);
}

void AddPath(const WorldPath& path, DecisionHash& hash) {
  hash.AddI32(path.size());
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : path) hash.AddPose(pose);
}

void AddSteps(const ActuatorPath& path, DecisionHash& hash) {
  hash.AddPose(path.start);
  hash.AddI32(path.steps.size());
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (const ActuatorStep& step : path.steps) {
    hash.AddFloat(step.phi_rad);
    hash.AddFloat(step.dr_m);
  }
}

void AddSpeeds(const SpeedProfile& speed, DecisionHash& hash) {
  hash.AddI32(speed.size());
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const float speed_mps : speed) hash.AddFloat(speed_mps);
}

void AddCost(const PathCost& cost, DecisionHash& hash) {
  hash.AddFloat(cost.map);
  hash.AddFloat(cost.path);
}

void AddCheck(const PathCheckResult& check, DecisionHash& hash) {
  AddStatus(check.status, hash);
  hash.AddFloat(check.smallest_clearance_m);
  hash.AddFloat(check.smallest_hard_distance_m);
  hash.AddI32(check.smallest_clearance_point);
  hash.AddI32(check.collision_point);
  hash.AddI32(check.overlap_points);
  hash.AddFloat(check.curvature_excess_per_m);
  hash.AddFloat(check.curvature_rate_excess_per_m2);
  hash.AddFloat(check.largest_curvature_per_m);
  hash.AddFloat(check.largest_curvature_rate_per_m2);
  hash.AddBool(check.leaves_map);
  hash.AddBool(check.start_overlaps);
}

void AddSearch(const AstarResult& search, DecisionHash& hash) {
  AddStatus(search.status, hash);
  hash.AddBool(search.goal_outside_map);
  hash.AddBool(search.goal_moved);
  hash.AddBool(search.start_in_obstacle);
  hash.AddBool(search.partial);
  AddCell(search.start, hash);
  AddCell(search.goal, hash);
  AddCell(search.end, hash);
  hash.AddI32(search.path_cells);
  hash.AddU64(static_cast<uint64_t>(search.cost));
  hash.AddI32(search.expansions);
}

}  // namespace

void AddToHash(const Plan& plan, DecisionHash& hash) {
  AddStatus(plan.status, hash);
  AddStatus(plan.base_status, hash);
  AddStatus(plan.optimizer_status, hash);
  AddStatus(plan.check_status, hash);
  hash.AddBool(plan.pivots_first);
  hash.AddBool(plan.pivots_last);
  hash.AddBool(plan.narrow);
  hash.AddBool(plan.is_seed);
  hash.AddBool(plan.ends_short);
  hash.AddBool(plan.stays);
  hash.AddBool(plan.starts_in_obstacle);
  AddPath(plan.base, hash);
  AddPath(plan.path, hash);
  AddSteps(plan.actuator, hash);
  AddSpeeds(plan.speed, hash);
  AddCost(plan.cost_before, hash);
  AddCost(plan.cost_after, hash);
  AddCheck(plan.check, hash);
  AddSearch(plan.search, hash);
  if (plan.target > 0) hash.AddI32(plan.target);
  if (plan.refusals > 0) hash.AddI32(plan.refusals);
}

}  // namespace hardpack
