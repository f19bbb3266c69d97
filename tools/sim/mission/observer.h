// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/safety/supervisor.h"
#include "hal/onboard/pilot/pilot.h"
#include "tools/sim/experiment/run_result.h"
#include "tools/sim/mission/frame.h"
#include "tools/sim/mission/map_record.h"
#include "tools/sim/mission/mission.h"
#include "tools/sim/mission/reaction_window.h"
#include "tools/sim/mission/way_watch.h"
#include "tools/sim/script/scripted_vehicle.h"

// Watches a mission from outside, every 10 ms: contact, clearance, the vehicle's distance from the
// path that it follows, how it came to a stop. Nothing is fed back to the vehicle.

namespace hardpack::mission {

// The observable data at one moment: the true state of the vehicle and its world, the onboard
// program's public status, and its internal data.
struct Moment {
  double time_s = 0.0;  // since the vehicle was switched on
  const sim::ScriptedVehicle* vehicle = nullptr;
  // The status; over the wire it may be some time old.
  Mode mode = Mode::kStandby;
  StopReason reason = StopReason::kNone;
  uint32_t goals = 0;
  uint32_t plan = 0;           // number of the committed path; 0: none
  double commanded_mps = 0.0;  // the tracker's current reference
  double commanded_yaw_radps = 0.0;
  double reaction_m = 0.0;  // the median so far
  // Internal data: paths, maps, odometry. Null over the wire: then there are no plans, no
  // cross-track errors and no maps.
  const Pilot* pilot = nullptr;
};

class Observer {
 public:
  // `trace` may be null; the others must outlive the observer. start_s: the Moment time at which
  // the goal was accepted.
  Observer(const world::Scenario& scenario, experiment::RunResult& result, MissionTrace* trace,
           double start_s)
      : result_(result),
        trace_(trace),
        start_s_(start_s),
        goal_(scenario.goal),
        way_(scenario, result.way) {
    if (!scenario.world.people().empty()) patience_s_ = kSaidAmongPeople_s;
  }

  void Watch(const Moment& now);
  // After the end: contact while coming to rest still counts.
  void WatchRest(const Moment& now);
  void Finish(uint64_t decision_hash);

  // A mission that ends this close to the goal, including odometry drift, has reached it.
  static constexpr double kAtGoal_m = 3.0;
  // A vehicle that has not moved and is this close was at the goal from the start; after this time
  // the status is from after the goal was accepted.
  static constexpr double kHere_m = 0.5;
  static constexpr double kAccepted_s = 1.0;
  // It stands, and has given the same reason for this long.
  static constexpr double kSaid_s = 5.0;
  // Longer, because people who stand in the way move on.
  static constexpr double kSaidAmongPeople_s = 30.0;
  // It stands, and gives no reason.
  static constexpr double kStuck_s = 20.0;
  static constexpr double kPersonSpeed_mps = 0.3;
  static constexpr double kTouch_mps = 0.1;  // slower, it is the person who walks up
  static constexpr double kFast_mps = 4.0;

  // Whether the outcome of the mission is known.
  bool ended() const { return ended_; }

 private:
  void WatchContact(const Moment& now, double t_s);
  void WatchPlan(const Moment& now, double t_s);
  void WatchMode(const Moment& now, double t_s);
  void WatchMotion(const Moment& now, double t_s);
  void WatchOdometry(const Moment& now);
  void WatchReaction(const Moment& now);
  void Sample(const Moment& now, double t_s);
  void SampleInside(const Pilot& pilot, MissionTrace::Sample& sample);
  void Note(double t_s, const std::string& text);
  void End(experiment::Outcome outcome);
  void EndBy(experiment::Outcome contact, double t_s, const std::string& text);

  experiment::RunResult& result_;
  MissionTrace* trace_;
  double start_s_;
  world::Point2 goal_;
  double patience_s_ = kSaid_s;
  WayWatch way_;
  bool ended_ = false;
  bool drove_ = false;
  bool stands_ = true;
  double stands_since_s_ = 0.0;
  double said_since_s_ = 0.0;
  std::string said_;
  Mode mode_ = Mode::kStandby;
  uint32_t plan_ = 0;                   // number of the committed path
  std::vector<world::Point2> path_;     // the committed path, in the odometry's frame
  std::optional<WorldFromOdom> first_;  // position of that frame when the goal was accepted
  double cross_track_m_ = 0.0;
  std::deque<double> speeds_mps_;  // of the last ticks, for the jerk
  double rise_mps_ = 0.0;          // of the body, one tick ago
  double jerk2_sum_ = 0.0;
  int64_t jerks_ = 0;
  double clearance_m_ = 0.0;
  double next_sample_s_ = 0.0;
  MapRecorder maps_;
  std::vector<uint32_t> reactions_;  // bins of the reaction meter before this tick
  ReactionWindow reaction_;
};

}  // namespace hardpack::mission
