// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/plan_json.h"

#include <cmath>

#include "port_linux/command_line/arguments.h"

namespace hardpack::command {
namespace {

using nlohmann::json;

json CostJson(const PathCost& cost) {
  return {{"map", JsonNumber(cost.map)},
          {"path", JsonNumber(cost.path)},
          {"total", JsonNumber(cost.total())}};
}

json LimitJson(float limit, float largest, float excess) {
  return {{"limit", JsonNumber(limit)},
          {"largest", JsonNumber(largest)},
          {"excess", JsonNumber(excess)}};
}

json SearchJson(const AstarResult& search) {
  const Vec2 goal = CellCenter(search.goal);
  const Vec2 end = CellCenter(search.end);
  return {{"status", StatusName(search.status)},
          {"expansions", search.expansions},
          {"path_cells", search.path_cells},
          {"cost", search.cost},
          {"goal_outside_map", search.goal_outside_map},
          {"goal_moved", search.goal_moved},
          {"start_in_obstacle", search.start_in_obstacle},
          {"partial", search.partial},
          {"goal_cell_x_m", JsonNumber(goal.x_m)},
          {"goal_cell_y_m", JsonNumber(goal.y_m)},
          {"end_cell_x_m", JsonNumber(end.x_m)},
          {"end_cell_y_m", JsonNumber(end.y_m)}};
}

json CheckJson(const PathCheckResult& check, const OptimizerParams& limits) {
  return {{"smallest_clearance_m", JsonNumber(check.smallest_clearance_m)},
          {"smallest_clearance_point", check.smallest_clearance_point},
          {"smallest_hard_distance_m", JsonNumber(check.smallest_hard_distance_m)},
          {"leaves_map", check.leaves_map},
          {"curvature_per_m", LimitJson(limits.max_curvature_per_m, check.largest_curvature_per_m,
                                        check.curvature_excess_per_m)},
          {"curvature_rate_per_m2",
           LimitJson(limits.max_curvature_rate_per_m2, check.largest_curvature_rate_per_m2,
                     check.curvature_rate_excess_per_m2)}};
}

json TimesJson(const PlanReport& report) {
  const StageTimes& times = report.times;
  const auto rounded = [](double us) { return std::round(us * 10.0) / 10.0; };
  return {{"load", rounded(report.load_us)},
          {"costmap", rounded(times.of(PlanStage::kHeights) + times.of(PlanStage::kPending) +
                              times.of(PlanStage::kCostmap))},
          {"search", rounded(times.of(PlanStage::kSearch))},
          {"sample", rounded(times.of(PlanStage::kSample))},
          {"optimize", rounded(times.of(PlanStage::kOptimize))},
          {"speed", rounded(times.of(PlanStage::kSpeed))},
          {"check", rounded(times.of(PlanStage::kCheck))},
          {"plan", rounded(times.total_us())}};
}

json RequestJson(const PlanRequest& request) {
  const PathStart& start = request.start;
  return {{"start",
           {{"x_m", JsonNumber(start.pose.x_m)},
            {"y_m", JsonNumber(start.pose.y_m)},
            {"theta_rad", JsonNumber(start.pose.theta_rad)},
            {"curvature_per_m", JsonNumber(start.curvature_per_m)},
            {"speed_mps", JsonNumber(start.speed_mps)}}},
          {"goal",
           {{"x_m", JsonNumber(request.goal_odom.x_m)},
            {"y_m", JsonNumber(request.goal_odom.y_m)},
            {"theta_rad",
             request.has_goal_heading ? JsonNumber(request.goal_heading_rad) : json(nullptr)}}}};
}

// The arrays over points and over steps.
void AddArrays(const Plan& plan, json& object) {
  for (const char* name : {"x_m", "y_m", "theta_rad", "v_mps", "phi_rad", "dr_m"}) {
    object[name] = json::array();
  }
  for (const Pose2& pose : plan.path) {
    object["x_m"].push_back(JsonNumber(pose.x_m));
    object["y_m"].push_back(JsonNumber(pose.y_m));
    object["theta_rad"].push_back(JsonNumber(pose.theta_rad));
  }
  for (const float speed_mps : plan.speed) object["v_mps"].push_back(JsonNumber(speed_mps));
  for (const ActuatorStep& step : plan.actuator.steps) {
    object["phi_rad"].push_back(JsonNumber(step.phi_rad));
    object["dr_m"].push_back(JsonNumber(step.dr_m));
  }
  json base = {{"x_m", json::array()}, {"y_m", json::array()}};
  for (const Pose2& pose : plan.base) {
    base["x_m"].push_back(JsonNumber(pose.x_m));
    base["y_m"].push_back(JsonNumber(pose.y_m));
  }
  object["base"] = std::move(base);
}

}  // namespace

float PlanLength(const Plan& plan) {
  float length_m = 0.0f;
  for (const ActuatorStep& step : plan.actuator.steps) length_m += std::abs(step.dr_m);
  return length_m;
}

float PlanDuration(const Plan& plan, const SpeedParams& params) {
  if (plan.speed.size() != plan.actuator.steps.size() + 1) return 0.0f;
  float duration_s = 0.0f;
  for (int i = 0; i < plan.actuator.steps.size(); ++i) {
    const ActuatorStep& step = plan.actuator.steps[i];
    const float dr_m = std::abs(step.dr_m);
    const float mean_mps = (plan.speed[i] + plan.speed[i + 1]) / 2.0f;
    if (dr_m == 0.0f) {
      duration_s += std::abs(step.phi_rad) / params.max_yaw_rate_radps;
    } else if (mean_mps > 0.0f) {
      duration_s += dr_m / mean_mps;
    } else {  // from rest to rest
      duration_s += 2.0f * std::sqrt(dr_m / params.max_acceleration_mps2);
    }
  }
  return duration_s;
}

json PlanToJson(const PlanReport& report) {
  const Plan& plan = *report.plan;
  json object = RequestJson(report.request);
  object["version"] = HARDPACK_VERSION;
  object["status"] = StatusName(plan.status);
  object["usable"] = IsUsable(plan.status);
  object["stage_status"] = {{"base", StatusName(plan.base_status)},
                            {"optimizer", StatusName(plan.optimizer_status)},
                            {"check", StatusName(plan.check_status)}};
  object["pivots_first"] = plan.pivots_first;
  object["pivots_last"] = plan.pivots_last;
  object["is_seed"] = plan.is_seed;
  object["narrow"] = plan.narrow;
  object["stays"] = plan.stays;
  object["starts_in_obstacle"] = plan.starts_in_obstacle;
  object["length_m"] = JsonNumber(PlanLength(plan));
  object["duration_s"] = JsonNumber(PlanDuration(plan, report.params.speed));
  AddArrays(plan, object);
  object["cost"] = {{"before", CostJson(plan.cost_before)}, {"after", CostJson(plan.cost_after)}};
  object["check"] = CheckJson(plan.check, report.params.optimizer);
  object["search"] = SearchJson(plan.search);
  object["stage_us"] = TimesJson(report);
  object["input"] = report.input;
  object["parameters"] = report.parameters;
  return object;
}

}  // namespace hardpack::command
