// SPDX-License-Identifier: Apache-2.0
#include "tools/plan/plan_command.h"

#include <array>
#include <cstdio>
#include <iostream>
#include <memory>

#include "port_linux/command_line/arguments.h"
#include "port_linux/command_line/command.h"
#include "tools/picture/class_picture.h"
#include "tools/picture/cost_panels.h"
#include "tools/picture/plan_picture.h"
#include "tools/picture/terrain_picture.h"
#include "tools/plan/plan_inputs.h"
#include "tools/plan/plan_json.h"

namespace hardpack::command {
namespace {

struct PlanOptions {
  LidarFiles lidar;
  PointsFile points;
  MapFile map = {.yaml = "", .unknown_is = "soft"};
  std::string start;
  std::string goal;
  std::string out;
  std::vector<std::string> parameters;
  bool json = false;
};

std::string Format(const char* format, double value) {
  std::array<char, 64> text = {};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

PlanRequest RequestFrom(const PlanOptions& options) {
  PlanRequest request;
  if (!options.start.empty()) {
    const auto start = ParseNumbers("--start", options.start, 3, 3, "X,Y,THETA (m, m, rad)");
    request.start.pose = {start[0], start[1], WrapAngle(start[2])};
  } else if (!options.map.yaml.empty()) {
    throw CommandFailure(kBadInput, "--start: required with --map (X,Y,THETA in m, m, rad)");
  }
  const auto goal = ParseNumbers("--goal", options.goal, 2, 3, "X,Y[,THETA] (m, m, rad)");
  request.goal_odom = {goal[0], goal[1]};
  request.has_goal_heading = goal.size() == 3;
  if (request.has_goal_heading) request.goal_heading_rad = WrapAngle(goal[2]);
  return request;
}

void CheckInputs(const PlanOptions& options) {
  const bool lidar = !options.lidar.capture.empty();
  const int inputs =
      (lidar ? 1 : 0) + (options.points.path.empty() ? 0 : 1) + (options.map.yaml.empty() ? 0 : 1);
  if (inputs != 1)
    throw CommandFailure(kBadInput, "give exactly one of --lidar, --points and --map");
  if (lidar && options.lidar.metadata.empty()) {
    throw CommandFailure(kBadInput, "--metadata: required with --lidar (the sensor's JSON)");
  }
  if (!lidar && (!options.lidar.metadata.empty() || !options.lidar.labels.empty())) {
    throw CommandFailure(kBadInput, "--metadata and --labels need --lidar");
  }
}

// The reason why there is no plan, and whether the request or the world causes it.
CommandFailure FailureOf(Status status, const PlanRequest& request) {
  const std::string goal = Format("--goal: %g", double{request.goal_odom.x_m}) +
                           Format(",%g", double{request.goal_odom.y_m});
  const std::string name = std::string(StatusName(status)) + ": ";
  switch (status) {
    case Status::kGoalInObstacle:
      return {kBadInput, name + goal + " lies in a hard obstacle and may not be moved"};
    case Status::kStartOutsideMap:
      return {kBadInput, name + "--start lies off the map"};
    case Status::kParameterOutOfRange:
      return {kBadInput, name + "--param: the values are inconsistent"};
    case Status::kNoPath:
      return {kWorkFailed, name + "every way to the goal is blocked"};
    case Status::kStartEnclosed:
      return {kWorkFailed, name + "the start lies in a hard obstacle and nothing leads out"};
    case Status::kPivotBlocked:
      return {kWorkFailed, name + "there is no room for the required turn on the spot"};
    case Status::kNeedsManoeuvre:
      return {kWorkFailed, name +
                               "the way bends more sharply than the vehicle can be steered, or "
                               "needs a turn on the spot"};
    case Status::kCollision:
      return {kWorkFailed, name + "the path would touch a hard obstacle or leave the map"};
    default:
      return {kWorkFailed, name + "no plan"};
  }
}

// The meaning of a usable outcome that is not exactly as requested.
std::string Remark(Status status) {
  switch (status) {
    case Status::kGoalOutsideMap:
      return "the goal is off the map: the nearest cell was used";
    case Status::kGoalMoved:
      return "the goal lies in a hard obstacle: the nearest free cell was used";
    case Status::kStartInObstacle:
      return "the start lies in a hard obstacle: the vehicle leaves it slowly";
    case Status::kPartialPath:
      return "the expansion limit was reached: the path ends before the goal";
    case Status::kPathCut:
      return "the path exceeds its capacity and was cut";
    case Status::kIterationLimit:
      return "the optimizer reached its sweep limit";
    case Status::kNarrowGap:
      return "little room beside the outline: low speed there";
    case Status::kLimitExceeded:
      return "a curvature limit is exceeded";
    default:
      return "";
  }
}

std::string Summary(const Plan& plan, const SpeedParams& speed) {
  return Format("%.1f m, ", double{PlanLength(plan)}) +
         Format("%.1f s, ", double{PlanDuration(plan, speed)}) +
         Format("clearance %.2f m", double{plan.check.smallest_clearance_m});
}

picture::PlanPicture PictureOf(const PlanReport& report, const Costmap& map) {
  const Plan& plan = *report.plan;
  picture::PlanPicture picture;
  picture.map = &map;
  picture.plan = &plan;
  picture.params = &report.params;
  picture.request = report.request;
  picture.title = std::string(StatusName(plan.status));
  if (IsUsable(plan.status)) picture.title += ": " + Summary(plan, report.params.speed);
  if (plan.pivots_first) picture.title += ", begins with a turn on the spot";
  if (plan.starts_in_obstacle) picture.title += ", starts in an obstacle";
  if (plan.is_seed) picture.title += "; the base path: optimized it would touch";
  const auto add = [&picture](const char* what, const std::string& value) {
    picture.figures.emplace_back(what, value);
  };
  if (plan.path.size() > 1) {
    const float clearance_m = plan.check.smallest_clearance_m;
    add("least clearance of the outline", clearance_m >= kClearanceReach_m
                                              ? Format("over %.0f m", double{kClearanceReach_m})
                                              : Format("%.2f m", double{clearance_m}));
    add("cost of the base path", Format("%.1f", double{plan.cost_before.total()}));
    add("cost of the optimized path", Format("%.1f", double{plan.cost_after.total()}));
    add("largest curvature", Format("%.2f 1/m", double{plan.check.largest_curvature_per_m}));
    add("largest curvature rate",
        Format("%.2f 1/m²", double{plan.check.largest_curvature_rate_per_m2}));
  }
  add("planning, wall clock", Format("%.1f ms", report.times.total_us() / 1000.0));
  return picture;
}

void WritePictures(const PlanReport& report, const Costmap& map, const std::string& folder) {
  const picture::PlanPicture plan_picture = PictureOf(report, map);
  Require(picture::DrawPlan(plan_picture).WritePng(folder + "/plan.png"));
  picture::Range x;
  picture::Range y;
  picture::FindView(plan_picture, x, y);
  Require(picture::DrawCostPanels(map, report.params.costmap, x, y, "Costmap of the plan")
              .WritePng(folder + "/costmap.png"));
}

// Around the vehicle, as the classes are.
void WriteTerrain(const PlanReport& report, const Planner& planner, const std::string& folder) {
  const Pose2& pose = report.request.start.pose;
  const auto shown = [](float middle_m) {
    return picture::Range{double{middle_m}, double{middle_m}}.WidenedBy(picture::kClassesReach_m);
  };
  Require(picture::DrawTerrain(planner.terrain(), planner.costmap().window, shown(pose.x_m),
                               shown(pose.y_m), "The ground, as the lidar measured it")
              .WritePng(folder + "/terrain.png"));
}

void WriteClasses(const PlanReport& report, const PlannedInput& input, bool labelled,
                  const std::string& folder) {
  const Pose2& pose = report.request.start.pose;
  const picture::ClassPicture classes = {.map = &input.planner->costmap(),
                                         .vehicle = report.params.vehicle,
                                         .pose = pose,
                                         .beams = input.mapper->model().beams,
                                         .columns = input.mapper->model().columns_per_revolution,
                                         .returns = picture::ReturnsOf(*input.mapper, pose),
                                         .title = input.revolution +
                                                  " as the vehicle understood it, " +
                                                  (labelled ? "by labels" : "by geometry alone")};
  Require(picture::DrawClasses(classes).WritePng(folder + "/classes.png"));
}

void RunPlan(const PlanOptions& options) {
  CheckInputs(options);
  const PlanRequest request = RequestFrom(options);
  Parameters parameters;
  SetParameters(options.parameters, parameters);
  parameters.perception.mapping.use_labels = options.lidar.labels.empty() ? 0 : 1;
  MakeOutputFolder(options.out);
  const PlannedInput input = !options.map.yaml.empty() ? PlanOnMap(options.map, parameters, request)
                             : !options.points.path.empty()
                                 ? PlanOnPoints(options.points, parameters, request)
                                 : PlanOnLidar(options.lidar, parameters, request);
  if (!IsUsable(input.begin_status)) throw FailureOf(input.begin_status, request);

  const Plan& plan = input.planner->result();
  const PlanReport report = {.plan = &plan,
                             .request = request,
                             .params = parameters.planner,
                             .times = input.times,
                             .load_us = input.load_us,
                             .input = input.report,
                             .parameters = ParametersToJson(parameters)};
  const nlohmann::json object = PlanToJson(report);
  WriteText(options.out + "/plan.json", object.dump(1) + "\n");
  WritePictures(report, input.planner->costmap(), options.out);
  if (input.mapper) {
    WriteClasses(report, input, !options.lidar.labels.empty(), options.out);
    WriteTerrain(report, *input.planner, options.out);
  }
  if (options.json) std::cout << object.dump() << "\n";
  if (!IsUsable(plan.status)) throw FailureOf(plan.status, request);
  if (options.json) return;
  std::string remark = Remark(plan.status);
  const auto also = [&remark](const std::string& more) {
    remark += (remark.empty() ? "" : "; ") + more;
  };
  if (plan.stays) {
    also(plan.pivots_last ? "the goal is where the vehicle stands: a turn on the spot"
                          : "the goal is where the vehicle stands: it has arrived");
  }
  if (plan.starts_in_obstacle && plan.status != Status::kStartInObstacle) {
    also(Remark(Status::kStartInObstacle));
  }
  std::cout << StatusName(plan.status) << ": " << Summary(plan, parameters.planner.speed)
            << (remark.empty() ? "" : " (" + remark + ")") << " -> " << options.out
            << "/plan.png\n";
}

}  // namespace

void AddPlanCommand(CLI::App& app) {
  CLI::App* plan =
      app.add_subcommand("plan",
                         "Plan a path on one lidar scan, on plain points or on one "
                         "occupancy map; write plan.json,\n"
                         "plan.png, costmap.png and, except with --map, classes.png: the "
                         "class of each return,\n"
                         "and terrain.png: grade and roughness of the ground.\n"
                         "Lengths are metres, angles radians anticlockwise from +x; "
                         "except with --map, the vehicle stands at\n"
                         "--start (default 0,0,0), x ahead, y left.");
  const auto options = std::make_shared<PlanOptions>();
  plan->add_option("--lidar", options->lidar.capture, "Capture of an Ouster lidar (pcap)");
  plan->add_option("--metadata", options->lidar.metadata, "The sensor's metadata (JSON)");
  plan->add_option("--labels", options->lidar.labels,
                   "Class of each return (CSV: ring, meas_id, label)");
  plan->add_option("--points", options->points.path,
                   "Points of one scan in the lidar's frame (PCD or CSV)");
  plan->add_option("--map", options->map.yaml, "Occupancy map (ROS map_server YAML; PGM or PNG)");
  plan->add_option("--unknown", options->map.unknown_is,
                   "What unknown cells of --map become: soft (default), hard or free")
      ->check(CLI::IsMember({"soft", "hard", "free"}));
  plan->add_option("--start", options->start, "Start pose X,Y,THETA [m, m, rad]");
  plan->add_option("--goal", options->goal, "Goal X,Y or X,Y,THETA [m, m, rad]")->required();
  plan->add_option("--param", options->parameters, "GROUP.NAME=VALUE; may be repeated")->take_all();
  plan->add_option("--out", options->out, "Folder to write to; created if missing")->required();
  plan->add_flag("--json", options->json, "Print plan.json on stdout instead of a line");
  plan->footer("Exit codes: 0 planned; 1 no plan (no path, collision); 2 bad usage or input.");
  plan->callback([options] { RunPlan(*options); });
}

}  // namespace hardpack::command
