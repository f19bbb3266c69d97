// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "core/autonomy/mapper.h"
#include "core/autonomy/planner.h"
#include "nlohmann/json.hpp"
#include "tools/plan/parameter_list.h"
#include "tools/plan/planner_run.h"

// The possible inputs of a plan: a recorded revolution of the lidar, plain points, and an occupancy
// map. Each fills a planner, runs it, and reports the data read.

namespace hardpack::command {

struct LidarFiles {
  std::string capture;
  std::string metadata;
  std::string labels;  // empty: none
};

// Points in the lidar's frame (tools/capture/point_file.h).
struct PointsFile {
  std::string path;
};

struct MapFile {
  std::string yaml;
  std::string unknown_is;  // soft, hard or free
};

struct PlannedInput {
  std::unique_ptr<Planner> planner = std::make_unique<Planner>();
  std::unique_ptr<Mapper> mapper;             // the revolution, with --lidar or --points
  std::string revolution;                     // its name in a picture
  Status begin_status = Status::kNotStarted;  // usable: the planner has run
  StageTimes times;
  double load_us = 0.0;   // reading and filing the input, wall clock
  nlohmann::json report;  // "input" of plan.json
};

// All throw a CommandFailure (bad input) naming the file and the field if it cannot be read.
PlannedInput PlanOnLidar(const LidarFiles& files, const Parameters& parameters,
                         const PlanRequest& request);
PlannedInput PlanOnPoints(const PointsFile& file, const Parameters& parameters,
                          const PlanRequest& request);
// Also if the start or the goal is off the map.
PlannedInput PlanOnMap(const MapFile& file, const Parameters& parameters,
                       const PlanRequest& request);

}  // namespace hardpack::command
