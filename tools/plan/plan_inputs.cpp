// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/plan_inputs.h"

#include <chrono>
#include <filesystem>
#include <sstream>

#include "port_linux/command_line/command.h"
#include "tools/capture/point_columns.h"
#include "tools/capture/point_file.h"
#include "tools/capture/scan_loader.h"
#include "tools/capture/standing_scan.h"
#include "tools/map_server/map_server.h"

namespace hardpack::command {
namespace {

// For messages that do not name the file.
void Require(const std::string& path, const ReadOutcome& outcome) {
  command::Require(ReadOutcome{outcome.status, path + ": " + outcome.message});
}

class Stopwatch {
 public:
  double us() const {
    return std::chrono::duration<double, std::micro>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

nlohmann::json LidarReport(const LidarFiles& files, const capture::LidarScanReport& scan) {
  return {{"kind", "lidar"},
          {"capture", files.capture},
          {"metadata", files.metadata},
          {"labels", files.labels.empty() ? nlohmann::json(nullptr) : nlohmann::json(files.labels)},
          {"frame_id", scan.frame_id},
          {"datagrams", scan.datagrams},
          {"packets", scan.packets},
          {"foreign_packets", scan.foreign_packets},
          {"damaged_datagrams", scan.damaged_datagrams},
          {"columns", scan.columns},
          {"missing_columns", scan.missing_columns},
          {"returns", scan.filed.returns},
          {"labelled_returns", scan.labelled_returns},
          {"self_returns", scan.filed.self_returns},
          {"returns_off_grid", scan.filed.returns_off_grid}};
}

nlohmann::json PointsReport(const PointsFile& file, const capture::PointCloud& cloud,
                            const capture::PointColumns& columns,
                            const capture::FiledReturns& filed) {
  return {{"kind", "points"},
          {"points", file.path},
          {"without_position", cloud.without_position},
          {"rows", columns.model.beams},
          {"rows_from", capture::NameOf(columns.rows)},
          {"largest_elevation_error_rad", columns.largest_elevation_error_rad},
          {"columns", columns.model.columns_per_revolution},
          {"hidden", columns.hidden},
          {"returns", filed.returns},
          {"self_returns", filed.self_returns},
          {"returns_off_grid", filed.returns_off_grid}};
}

nlohmann::json MapReport(const MapFile& file, const map_server::OccupancyMap& map) {
  return {{"kind", "map"},
          {"map", file.yaml},
          {"width_px", map.width_px},
          {"height_px", map.height_px},
          {"resolution_m", map.resolution_m},
          {"unknown_is", file.unknown_is}};
}

void RequireOnMap(const MapFile& file, const map_server::OccupancyMap& map,
                  const std::string& option, Vec2 point) {
  if (map.Contains(double{point.x_m}, double{point.y_m})) return;
  std::ostringstream reason;
  reason << option << ": " << point.x_m << "," << point.y_m << " is off the map " << file.yaml
         << " (x " << map.origin_x_m << " .. " << map.origin_x_m + map.width_m() << " m, y "
         << map.origin_y_m << " .. " << map.origin_y_m + map.height_m() << " m)";
  throw CommandFailure(kBadInput, reason.str());
}

map_server::UnknownIs UnknownFrom(const std::string& word) {
  if (word == "hard") return map_server::UnknownIs::kHard;
  return word == "free" ? map_server::UnknownIs::kFree : map_server::UnknownIs::kSoft;
}

// Where the vehicle stands.
StampedPose PoseOf(const PlanRequest& request) {
  const Pose2& start = request.start.pose;
  StampedPose pose;
  pose.position = {start.x_m, start.y_m, 0.0f};
  pose.yaw_rad = start.theta_rad;
  return pose;
}

void PlanOnMapper(const Parameters& parameters, const PlanRequest& request, PlannedInput& input) {
  input.begin_status = input.planner->Begin(*input.mapper, parameters.planner, request);
  if (IsUsable(input.begin_status)) input.times = RunToEnd(*input.planner, *input.mapper);
}

}  // namespace

PlannedInput PlanOnLidar(const LidarFiles& files, const Parameters& parameters,
                         const PlanRequest& request) {
  PlannedInput input;
  const Stopwatch stopwatch;
  input.mapper = std::make_unique<Mapper>();
  Mapper& mapper = *input.mapper;
  capture::LidarScanReport scan;
  Require(capture::LoadLidarScan({.capture_path = files.capture,
                                  .metadata_path = files.metadata,
                                  .labels_path = files.labels,
                                  .perception = parameters.perception,
                                  .costmap = parameters.planner.costmap,
                                  .labels = parameters.labels,
                                  .pose = PoseOf(request)},
                                 mapper, scan));
  input.report = LidarReport(files, scan);
  input.revolution = "Revolution " + std::to_string(scan.frame_id);
  input.load_us = stopwatch.us();
  PlanOnMapper(parameters, request, input);
  return input;
}

PlannedInput PlanOnPoints(const PointsFile& file, const Parameters& parameters,
                          const PlanRequest& request) {
  PlannedInput input;
  const Stopwatch stopwatch;
  capture::PointCloud cloud;
  Require(capture::ReadPoints(file.path, cloud));
  capture::PointColumns columns;
  Require(file.path, capture::MakeColumns(cloud.points, columns));
  input.mapper = std::make_unique<Mapper>();
  Mapper& mapper = *input.mapper;
  const int last = columns.model.columns_per_revolution - 1;
  Require(file.path, {mapper.Configure(parameters.perception, parameters.planner.costmap,
                                       parameters.labels, columns.model, 0, last),
                      "parameters: out of range"});
  Require(file.path, {capture::MapRevolution(columns.columns, PoseOf(request), nullptr, mapper),
                      "cannot be placed"});
  input.report = PointsReport(file, cloud, columns, capture::ReturnsIn(mapper));
  input.revolution = std::filesystem::path(file.path).filename().string();
  input.load_us = stopwatch.us();
  PlanOnMapper(parameters, request, input);
  return input;
}

PlannedInput PlanOnMap(const MapFile& file, const Parameters& parameters,
                       const PlanRequest& request) {
  PlannedInput input;
  const Stopwatch stopwatch;
  map_server::OccupancyMap map;
  Require(map_server::ReadOccupancyMap(file.yaml, map));
  const Vec2 start = {request.start.pose.x_m, request.start.pose.y_m};
  RequireOnMap(file, map, "--start", start);
  RequireOnMap(file, map, "--goal", request.goal_odom);
  const GridWindow window = map_server::WindowFor(map, start);
  const auto flags = map_server::CellFlags(map, window, UnknownFrom(file.unknown_is));
  input.report = MapReport(file, map);
  input.begin_status = input.planner->BeginCells(window, parameters.planner, request);
  if (!IsUsable(input.begin_status)) return input;
  for (int i = 0; i < kMapCells; ++i) {
    input.planner->costmap_builder().SetCell(i, flags[static_cast<size_t>(i)]);
  }
  input.load_us = stopwatch.us();
  input.times = RunCellsToEnd(*input.planner);
  return input;
}

}  // namespace hardpack::command
