// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/mission.h"

#include <cmath>
#include <memory>
#include <span>

#include "port_linux/files/area_file.h"
#include "port_linux/files/vehicle_types.h"
#include "tools/replay/replay.h"
#include "tools/sim/mission/lock_step.h"
#include "tools/sim/mission/observer.h"
#include "tools/sim/script/script.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::mission {
namespace {

using experiment::Outcome;
using experiment::RunResult;

constexpr double kBootLimit_s = 20.0;
constexpr double kSettle_s = 0.5;  // for the first columns to come in

ReadOutcome Bad(const std::string& message) {
  return {Status::kInvalidArgument, message};
}

ReadOutcome ChooseMethods(const MissionSettings& settings, Configuration& configuration) {
  if (settings.planner == "astar") {
    // No sweep of the descent: the base path as found by the search.
    configuration.planner.optimizer.method = OptimizerParams::kPaperDescent;
    configuration.planner.optimizer.max_sweeps = 0;
  } else if (settings.planner != "optimizer") {
    return Bad("there is no planner '" + settings.planner + "': optimizer or astar");
  }
  if (settings.tracker == "pursuit") {
    configuration.onboard.tracking.method = TrackingParams::kPurePursuit;
  } else if (settings.tracker != "full") {
    return Bad("there is no tracker '" + settings.tracker + "': full or pursuit");
  }
  return {};
}

template <typename Params>
Params OneOf(const sim::Uncertain<Params>& vehicle, const MissionSettings& settings) {
  return settings.spread ? sim::Draw(vehicle, settings.seed) : vehicle.typical;
}

// The body and its actuation: a motion controller if the vehicle's type has one.
ReadOutcome DescribeBody(const MissionSettings& settings, sim::VehicleSettings& vehicle,
                         Configuration& configuration) {
  const bool has_controller = DevicesOf(configuration.vehicle_type).twist_drive;
  VehicleParams& told = configuration.planner.vehicle;
  const TwistDriveParams& drive = configuration.onboard.twist_drive;
  if (has_controller) {
    vehicle.controller.emplace();
    vehicle.controller->command_id = static_cast<uint32_t>(drive.command_id);
    vehicle.controller->feedback_id = static_cast<uint32_t>(drive.feedback_id);
    vehicle.controller->status_id = static_cast<uint32_t>(drive.status_id);
    vehicle.controller->steers = drive.turn == TwistDriveParams::kSteering;
  }
  if (const auto* skids = std::get_if<sim::UncertainVehicle>(&settings.vehicle)) {
    vehicle.model = OneOf(*skids, settings);
    // Of its kind, as anybody who drives one has measured.
    told.max_wheel_speed_radps = static_cast<float>(skids->typical.wheel_limit_radps);
    if (told.kinematics == VehicleParams::kSkidSteered && drive.turn == TwistDriveParams::kYawRate)
      return {};
    return Bad("vehicle " + settings.vehicle_name +
               " is skid-steered: vehicle.kinematics and twist_drive.turn must be 0");
  }
  vehicle.steered = OneOf(std::get<sim::UncertainSteered>(settings.vehicle), settings);
  if (has_controller && told.kinematics == VehicleParams::kAckermann &&
      drive.turn == TwistDriveParams::kSteering) {
    return {};
  }
  return Bad("vehicle " + settings.vehicle_name +
             " has steered wheels: it needs a configuration with vehicle.type \"twist_base\", "
             "vehicle.kinematics = 1 and twist_drive.turn = 1");
}

sim::LidarModel LidarModelOf(const Configuration& configuration) {
  if (!DevicesOf(configuration.vehicle_type).velodyne) return sim::LidarModel::kOuster;
  return configuration.velodyne.model == "vlp32c" ? sim::LidarModel::kVlp32c
                                                  : sim::LidarModel::kVlp16;
}

}  // namespace

ReadOutcome DescribeMission(const MissionSettings& settings, sim::ScriptedVehicleSettings& vehicle,
                            Configuration& configuration) {
  configuration = settings.configuration;
  const ReadOutcome outcome = ChooseMethods(settings, configuration);
  if (!outcome.ok()) return outcome;
  const sim::LidarModel lidar_model = LidarModelOf(configuration);
  if (settings.labels && sim::IsVelodyne(lidar_model)) {
    return {Status::kUnsupported, "--labels needs an Ouster"};
  }
  vehicle = {};
  vehicle.world = settings.scenario.world;
  vehicle.vehicle.start = {settings.scenario.start.position.x_m,
                           settings.scenario.start.position.y_m, settings.scenario.start.yaw_rad};
  vehicle.labels = settings.labels;
  const ReadOutcome body = DescribeBody(settings, vehicle.vehicle, configuration);
  if (!body.ok()) return body;
  const auto seed = static_cast<uint32_t>(settings.seed);
  vehicle.lidar = sim::NoisyLidar(lidar_model);
  if (sim::IsVelodyne(lidar_model)) {
    vehicle.lidar.revolutions_per_s = configuration.velodyne.rpm / 60;
  }
  vehicle.lidar.columns = settings.lidar_columns;
  vehicle.lidar.seed = seed;
  if (vehicle.vehicle.steered) {
    vehicle.lidar.x_m = vehicle.vehicle.steered->lidar_x_m;
    vehicle.lidar.z_m = vehicle.vehicle.steered->lidar_z_m;
  }
  vehicle.lidar.off_roll_rad = settings.scenario.mount_roll_rad;
  vehicle.lidar.off_pitch_rad = settings.scenario.mount_pitch_rad;
  vehicle.brake_pitch_rad = settings.scenario.brake_pitch_rad;
  vehicle.ins.errors = sim::Vn300Errors();
  if (DevicesOf(configuration.vehicle_type).pose_datagram) {
    vehicle.ins.format = sim::InsFormat::kPoseDatagram;
  }
  vehicle.ins.seed = seed;
  vehicle.seed = seed;
  if (vehicle.labels) {
    vehicle.labels->seed = seed;
    configuration.perception.mapping.use_labels = 1;
  }
  return {};
}

RunResult ResultOf(const MissionSettings& settings) {
  RunResult result;
  result.world = settings.scenario.name;
  result.planner = settings.planner;
  result.tracker = settings.tracker;
  result.vehicle = settings.vehicle_name;
  result.labels = LabelsName(settings.labels);
  result.max_speed_set_mps = double{settings.configuration.planner.speed.max_speed_mps};
  result.settings = DigestOf(settings);
  result.seed = settings.seed;
  result.reason = "none";
  result.clearance_m = world::Contact::kFar_m;
  result.person_clearance_m = world::Contact::kFar_m;
  return result;
}

namespace {

control::OperatorCommand Command(control::Kind kind) {
  control::OperatorCommand command;
  command.kind = kind;
  return command;
}

Moment MomentOf(const LockStep& run) {
  const Pilot& pilot = run.pilot();
  Moment now;
  now.time_s = run.time_s();
  now.vehicle = &run.vehicle();
  now.mode = pilot.permission().mode;
  now.reason = pilot.permission().reason;
  now.goals = static_cast<uint32_t>(pilot.goals());
  now.commanded_mps = pilot.tracking().speed_mps;
  now.commanded_yaw_radps = pilot.tracking().yaw_rate_radps;
  now.reaction_m = pilot.reaction().Radius_m(0.5f);
  now.plan = pilot.replanner().committed().number;
  now.pilot = &pilot;
  return now;
}

// Copies the bins of a meter into a histogram with the same bins.
void AddBins(std::span<const uint32_t> bins, experiment::Histogram& histogram) {
  for (size_t i = 0; i < bins.size(); ++i) {
    if (bins[i] > 0) histogram.Add((static_cast<double>(i) + 0.5) * histogram.width(), bins[i]);
  }
}

// Ticks until it is true; false if it takes too long.
template <typename Condition>
bool Until(LockStep& run, double limit_s, Condition&& condition) {
  const double end_s = run.time_s() + limit_s;
  while (!condition()) {
    if (run.time_s() > end_s || !IsUsable(run.Tick())) return false;
  }
  return true;
}

// Areas as the vehicle gets them: its odom frame begins where it starts.
Area InOdom(const Area& area, const WorldFromOdom& frame) {
  Area moved = area;
  for (int i = 0; i < area.corners && area.frame == AreaFrame::kOdom; ++i) {
    const AreaCorner& corner = area.corner[i];
    const Vec2 place = frame.ToOdom({corner.x_mm / 1000.0, corner.y_mm / 1000.0});
    moved.corner[i].x_mm = static_cast<int32_t>(std::lround(1000.0 * double{place.x_m}));
    moved.corner[i].y_mm = static_cast<int32_t>(std::lround(1000.0 * double{place.y_m}));
  }
  return moved;
}

// Empty, or the reason why one was not accepted.
std::string SendAreas(LockStep& run, const AreaList& areas) {
  const WorldFromOdom frame(run.vehicle().vehicle().pose(), run.pilot().odometry().pose());
  control::OperatorCommand command = Command(control::Kind::kArea);
  command.area_count = areas.size();
  for (int i = 0; i < areas.size(); ++i) {
    command.area_index = i;
    command.area = InOdom(areas[i], frame);
    const Status sent = run.Say(command);
    if (!IsUsable(sent) || run.output().answer != Status::kOk) {
      return "area " + std::to_string(i + 1) + " was refused";
    }
  }
  return "";
}

// Boots, sends the areas, arms and sends the goal. Empty, or the reason why it was not accepted.
std::string Begin(LockStep& run, const MissionSettings& settings) {
  if (!Until(run, kBootLimit_s, [&] { return run.onboard().Drives().ready; })) {
    return "the drives do not become ready";
  }
  const double settled_s = run.time_s() + kSettle_s;
  if (!Until(run, kBootLimit_s, [&] { return run.time_s() > settled_s; })) return "a tick failed";
  const std::string refused = SendAreas(run, settings.areas);
  if (!refused.empty()) return refused;
  const Status armed = run.Say(Command(control::Kind::kArm));
  if (!IsUsable(armed) || run.output().answer != Status::kOk) return "arming was refused";
  if (!Until(run, kBootLimit_s, [&] { return run.onboard().Drives().enabled; })) {
    return "the drives are not enabled";
  }
  const WorldFromOdom frame(run.vehicle().vehicle().pose(), run.pilot().odometry().pose());
  const Status sent = run.Say(GoalCommand(settings.scenario.goal, settings.waypoints, frame));
  if (!IsUsable(sent) || run.output().answer != Status::kOk) return "the goal was refused";
  return "";
}

}  // namespace

control::OperatorCommand GoalCommand(world::Point2 goal,
                                     const std::vector<control::Waypoint>& waypoints,
                                     const WorldFromOdom& frame) {
  control::OperatorCommand command = Command(control::Kind::kGoal);
  command.waypoints = 1;
  command.waypoint[0].position_m = frame.ToOdom(goal);
  if (waypoints.empty()) return command;
  command.waypoints = static_cast<int32_t>(waypoints.size());
  for (size_t i = 0; i < waypoints.size(); ++i) {
    const Vec2 place = waypoints[i].position_m;
    command.waypoint[i] = waypoints[i];
    command.waypoint[i].position_m = frame.ToOdom({double{place.x_m}, double{place.y_m}});
  }
  return command;
}

std::string LabelsName(const std::optional<sim::LabelSettings>& labels) {
  if (!labels) return "none";
  return std::to_string(std::lround(1000.0 * labels->delay_s)) + " ms";
}

uint64_t DigestOf(const MissionSettings& settings) {
  std::string text = ToToml(settings.configuration) + settings.script;
  text += AreasToToml(settings.areas);
  text += sim::VehicleToToml(settings.vehicle, "");
  for (const double number : {settings.spread ? 1.0 : 0.0, settings.limit_s,
                              static_cast<double>(settings.lidar_columns)}) {
    text.append(" ").append(sim::NumberText(number));
  }
  if (settings.labels) {
    for (const double number : {settings.labels->accuracy, settings.labels->delay_s,
                                static_cast<double>(settings.labels->columns)}) {
      text.append(" ").append(sim::NumberText(number));
    }
  }
  for (const control::Waypoint& waypoint : settings.waypoints) {
    for (const double number : {double{waypoint.position_m.x_m}, double{waypoint.position_m.y_m},
                                waypoint.stops ? 1.0 : 0.0, static_cast<double>(waypoint.hold_s),
                                static_cast<double>(waypoint.speed_dmps)}) {
      text.append(" ").append(sim::NumberText(number));
    }
  }
  uint64_t digest = 14695981039346656037u;  // FNV-1a
  for (const char c : text) digest = (digest ^ static_cast<uint8_t>(c)) * 1099511628211u;
  return digest;
}

Outcome WantedOutcome(const std::string& world) {
  const std::string_view base = world::BaseName(world);
  const bool is_closed = base.starts_with("blind_") || base == "dead_end" || base == "corner_ditch";
  return is_closed ? Outcome::kSaid : Outcome::kReached;
}

ReadOutcome RunMission(const MissionSettings& settings, RunResult& result, MissionTrace* trace) {
  LockStepSettings lock_step;
  lock_step.log = settings.log;
  ReadOutcome outcome = DescribeMission(settings, lock_step.vehicle, lock_step.configuration);
  if (!outcome.ok()) return outcome;
  std::vector<sim::ScriptEvent> script;
  outcome = sim::ParseScript(settings.scenario.script + settings.script, "script", script);
  if (!outcome.ok()) return outcome;
  LockStep run;
  outcome = run.Start(lock_step);
  if (!outcome.ok()) return outcome;

  result = ResultOf(settings);
  const std::string refused = Begin(run, settings);
  if (!refused.empty()) {
    result.outcome = Outcome::kFault;
    result.reason = refused;
    return run.End();
  }
  const double start_s = run.time_s();
  Observer observer(settings.scenario, result, trace, start_s);
  size_t next_event = 0;
  while (!observer.ended() && run.time_s() - start_s < settings.limit_s) {
    for (; next_event < script.size() && script[next_event].at_s <= run.time_s() - start_s;
         ++next_event) {
      run.vehicle().Act(script[next_event]);
    }
    if (!IsUsable(run.Tick())) return Bad("a tick was refused");
    observer.Watch(MomentOf(run));
  }
  observer.Finish(run.pilot().decision_hash());
  AddBins(run.pilot().reaction().time_bins(), result.reaction_s);
  AddBins(run.pilot().reaction().radius_bins(), result.reaction_m);
  result.driven_m = run.vehicle().vehicle().driven_m();
  result.success = result.outcome == WantedOutcome(settings.scenario.name);
  return run.End();
}

ReadOutcome ReplaysTheSame(const std::string& log, uint64_t decision_hash,
                           std::string& difference) {
  replay::Request request;
  request.files = {log};
  const auto vehicle = std::make_unique<ChosenVehicle>();
  const auto configuration = std::make_unique<Configuration>();
  replay::Report report;
  const ReadOutcome outcome = replay::ReplayLog(request, *vehicle, *configuration, report);
  if (!outcome.ok()) return outcome;
  if (report.difference.found) {
    difference = "tick " + std::to_string(report.difference.index) + ": " + report.difference.what;
  } else if (!report.not_comparable.empty()) {
    difference = report.not_comparable;
  } else if (report.decision_hash != decision_hash) {
    difference = "different decision hash";
  }
  return {};
}

}  // namespace hardpack::mission
