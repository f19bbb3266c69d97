// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "tools/experiment/run_result.h"
#include "tools/mission/frame.h"
#include "tools/mission/lock_step.h"
#include "tools/mission/map_record.h"
#include "tools/mission/mission.h"
#include "tools/mission/reaction_window.h"
#include "tools/mission/way_watch.h"

// Watches a mission from outside, once a tick: contact, clearance, how far the vehicle is from the
// path that it follows, how it came to a stop. Nothing of it goes back to the vehicle.

namespace hardpack::mission {

class Observer {
 public:
  // `trace` may be null; the others outlive it. start_s: the lock step's time at which the goal was
  // accepted.
  Observer(const world::Scenario& scenario, experiment::RunResult& result, MissionTrace* trace,
           double start_s)
      : result_(result), trace_(trace), start_s_(start_s), way_(scenario, result.way) {}

  void Watch(const LockStep& run);
  void Finish(const LockStep& run);

  // It stands, and has said the same reason for so long.
  static constexpr double kSaid_s = 5.0;
  // It stands, and says nothing.
  static constexpr double kStuck_s = 20.0;
  static constexpr double kPersonSpeed_mps = 0.3;

  // Whether it is known what became of the mission.
  bool ended() const { return ended_; }

 private:
  void WatchContact(const LockStep& run, double t_s);
  void WatchPlan(const LockStep& run, double t_s);
  void WatchMode(const LockStep& run, double t_s);
  void WatchMotion(const LockStep& run, double t_s);
  void Sample(const LockStep& run, double t_s);
  void Note(double t_s, const std::string& text);
  void End(experiment::Outcome outcome);

  experiment::RunResult& result_;
  MissionTrace* trace_;
  double start_s_;
  WayWatch way_;
  bool ended_ = false;
  bool drove_ = false;
  bool stands_ = true;
  double stands_since_s_ = 0.0;
  double said_since_s_ = 0.0;
  std::string said_;
  Mode mode_ = Mode::kStandby;
  uint32_t plan_ = 0;                // number of the committed path
  std::vector<world::Point2> path_;  // of it, in the world
  double cross_track_m_ = 0.0;
  std::deque<double> speeds_mps_;  // of the last ticks, for the jerk
  double jerk2_sum_ = 0.0;
  int64_t jerks_ = 0;
  double clearance_m_ = 0.0;
  double next_sample_s_ = 0.0;
  MapRecorder maps_;
  ReactionWindow reaction_;
};

}  // namespace hardpack::mission
