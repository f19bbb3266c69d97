// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/parameters.h"
#include "core/autonomy/planner.h"
#include "nlohmann/json.hpp"
#include "tools/plan/planner_run.h"

// plan.json: a plan with all data required to judge it. docs/plan_json.md explains each key; a test
// compares the two.

namespace hardpack::command {

struct PlanReport {
  const Plan* plan = nullptr;
  PlanRequest request;
  PlannerParams params;
  StageTimes times;
  double load_us = 0.0;       // reading the input files, wall clock
  nlohmann::json input;       // the data read, by kind
  nlohmann::json parameters;  // every parameter's value, by group
};

nlohmann::json PlanToJson(const PlanReport& report);

// Length of the path [m], turns on the spot not counted.
float PlanLength(const Plan& plan);

// Time to drive the path [s]: each chord at the mean of its two speeds, a turn on the spot at the
// largest yaw rate.
float PlanDuration(const Plan& plan, const SpeedParams& params);

}  // namespace hardpack::command
