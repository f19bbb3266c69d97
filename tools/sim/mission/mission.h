// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/read_outcome.h"
#include "tools/sim/experiment/run_result.h"
#include "tools/sim/mission/frame.h"
#include "tools/sim/mission/map_record.h"
#include "tools/sim/script/scripted_vehicle.h"
#include "tools/sim/sensors/sim_labels.h"
#include "tools/sim/vehicle/vehicle_model_file.h"
#include "tools/sim/world/named_worlds.h"

// One mission in a simulated world, from power-on to rest: the drives boot, the operator arms and
// sends the goal, the vehicle drives, and the outcome is recorded.

namespace hardpack::mission {

struct MissionSettings {
  world::Scenario scenario;
  // On the way to the scenario's goal, which is the last of them, as metres in the world's frame;
  // empty: to the goal alone. At most control::kMaxWaypoints.
  std::vector<control::Waypoint> waypoints;
  std::string planner = "optimizer";  // or "astar": the base path as it is
  std::string tracker = "full";       // or "pursuit": pure pursuit without lag compensation
  std::string vehicle_name = "warthog_paper";
  sim::UncertainBody vehicle;  // the seed draws one of its kind
  bool spread = true;          // false: the typical one

  uint64_t seed = 1;  // of everything random except the scenario
  // External labels, for which the vehicle then waits (mapping.use_labels); none: it classes all
  // returns itself.
  std::optional<sim::LabelSettings> labels;
  int lidar_columns = 1024;  // of an Ouster
  Configuration configuration;
  // Sent by the operator before arming. Those in odom are in the world's frame here.
  AreaList areas;
  std::string script;  // more events (tools/sim/script/script.h), timed from the goal's acceptance
  double limit_s = 120.0;  // from the goal on
  std::string log;         // path of the flight log; empty: none
};

// Their name in the table of an experiment: "none", or their delay, "100 ms".
std::string LabelsName(const std::optional<sim::LabelSettings>& labels);

// A digest of everything that determines a mission except the world, the methods' names and the
// seed.
uint64_t DigestOf(const MissionSettings& settings);

// The outcome with which the experiment of a world should end.
experiment::Outcome WantedOutcome(const std::string& world);

// What happened, for pictures. Frame: the world's; times since the goal's acceptance.
struct MissionTrace {
  struct Sample {  // every 0.05 s
    double t_s = 0.0;
    double x_m = 0.0;
    double y_m = 0.0;
    double yaw_rad = 0.0;
    double speed_mps = 0.0;      // in reverse: negative, as the next two
    double commanded_mps = 0.0;  // the tracker's current reference
    double planned_mps = 0.0;    // by the committed plan at that place; 0 without one
    double yaw_rate_radps = 0.0;
    double commanded_yaw_radps = 0.0;  // from the wheels' setpoints, without slip
    double commanded_curvature_per_m = 0.0;
    double cross_track_m = 0.0;
    double clearance_m = 0.0;        // to anything hard, now
    double reaction_median_m = 0.0;  // of the columns of the preceding second; 0 without any
    double reaction_p99_m = 0.0;
    std::vector<world::Point2> people;  // in the order of the world's list
  };
  struct Plan {
    double t_s = 0.0;
    std::vector<world::Point2> path;
  };
  struct Event {
    double t_s = 0.0;
    std::string text;  // "driving", "safe_stop: person", "touched a person at 0.2 m/s"
  };
  world::Footprint footprint;  // of the vehicle
  std::vector<Sample> samples;
  std::vector<Plan> plans;  // all committed plans
  std::vector<Event> events;
  std::vector<MapRecord> maps;  // by time
};

// Failures are settings that cannot be run; a mission that goes wrong is a result. `trace` may be
// null. The map of the last tick is left in `map` if it is given.
ReadOutcome RunMission(const MissionSettings& settings, experiment::RunResult& result,
                       MissionTrace* trace);

// The vehicle, and the configuration of the program that drives it: `settings` with its names
// resolved and its seed drawn. kInvalidArgument: an unknown method; kUnsupported: labels with a
// lidar other than an Ouster, because labels name the columns of an Ouster.
ReadOutcome DescribeMission(const MissionSettings& settings, sim::ScriptedVehicleSettings& vehicle,
                            Configuration& configuration);

// The operator's goal: the scenario's, or the waypoints, as the vehicle's odometry has them.
control::OperatorCommand GoalCommand(world::Point2 goal,
                                     const std::vector<control::Waypoint>& waypoints,
                                     const WorldFromOdom& frame);

// A result in which nothing has happened yet.
experiment::RunResult ResultOf(const MissionSettings& settings);

// Replays the written log of a run: true if every tick was decided the same; otherwise `difference`
// says what was not.
ReadOutcome ReplaysTheSame(const std::string& log, uint64_t decision_hash, std::string& difference);

}  // namespace hardpack::mission
