// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/conflicts.h"
#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/areas/area_set.h"
#include "core/autonomy/mapper.h"
#include "core/autonomy/replanner.h"
#include "core/base/decision_hash.h"
#include "core/base/status.h"
#include "core/committed_plan/path_target.h"
#include "core/measurements/measurements.h"
#include "core/odometry/map_from_odom.h"
#include "core/odometry/odometry.h"
#include "core/people/moving_bodies.h"
#include "core/people/people_tracks.h"
#include "core/safety/command_gate.h"
#include "core/safety/corridor.h"
#include "core/safety/ground_watch.h"
#include "core/safety/motion_sweep.h"
#include "core/safety/motion_watch.h"
#include "core/safety/reaction_meter.h"
#include "core/safety/supervisor.h"
#include "core/safety/tilt_watch.h"
#include "core/scan/mount_watch.h"
#include "core/scan/sight_watch.h"
#include "core/segmentation/label_table.h"
#include "core/tracking/stop_motion.h"
#include "core/tracking/tracking.h"
#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"
#include "hal/onboard/pilot/input_source.h"
#include "hal/onboard/pilot/ways_out.h"

// Drives the vehicle, whatever its devices are: measurements with their times in our clock in,
// demands on the drives out. It knows no packets and no frames; hal/onboard/vehicle_loop passes it
// the devices' data, in the order of the functions below, once a tick:
//
//   BeginTick, TakeIns..., Localise, TakeLabels..., TakeColumn..., FinishMap, Decide, Act, PlanOn

namespace hardpack {

// Everything that determines the vehicle's behaviour, except what its devices are.
struct PilotConfig {
  PlannerParams planner;
  PerceptionParams perception;
  OnboardParams onboard;
  LabelTable labels = RellisLabelTable();
  AreaList areas;  // the configured ones, which no command removes
};

// Content of the answer to an operator's command.
struct CommandAnswer {
  bool has_answer = false;
  uint32_t sequence = 0;
  Status answer = Status::kOk;
  StopReason reason = StopReason::kNone;  // why it was not permitted
};

// Counters as reported to the operator. Since the loop was configured.
using LoopCounters = control::LoopPart;
static_assert(control::kInputSourceCount == kInputSources);

class Pilot {
 public:
  static constexpr float kRouteAhead_m = 30.0f;  // of waypoints that a plan passes at most
  static constexpr float kMovedGoal_m = 3.0f;    // distance of an end beside an occupied goal
  static constexpr float kArrived_m = 0.3f;
  static constexpr float kArrivedSpeed_mps = 0.05f;
  // A goal on earth that moves in odom by less than this stays where it is, because each move
  // causes a new plan.
  static constexpr float kGoalFollows_m = 0.05f;
  // Measured speed: a turn on the spot does not begin above it.
  static constexpr float kStandsSpeed_mps = 0.1f;
  // The time of the ramps that a late tick may make up for.
  static constexpr float kLongestTick_s = 0.1f;
  // With more than this hidden behind the rear by the self filter it does not reverse.
  static constexpr float kMaxHiddenBehind_m = 0.3f;
  // Of the lidar's columns, those that the mount's watch looks at, and at most in a tick.
  static constexpr int kMountEvery = 4;
  static constexpr int kMaxMountColumns = 64;
  // Columns with a person that are followed in a tick: those that are not beside the one before.
  // What is not followed is not released.
  static constexpr int kMaxPersonLooks = 64;
  // Bodies that may walk, in a tick, and the rows of a column that are looked at for them: all, or
  // with more beams every second one. What is more is not seen to walk in that revolution.
  static constexpr int kMaxBodyLooks = 16;
  static constexpr int kBodyRows = 64;

  const PilotConfig& config() const { return config_; }
  const Permission& permission() const { return permission_; }
  const Supervisor& supervisor() const { return supervisor_; }
  const Mapper& mapper() const { return mapper_; }
  const Replanner& replanner() const { return replanner_; }
  const Corridor& corridor() const { return corridor_; }
  const MotionSweep& sweep() const { return sweep_; }
  const CommandGate& gate() const { return gate_; }
  const MotionWatch& motion() const { return motion_; }
  const ReactionMeter& reaction() const { return reaction_; }
  const SightWatch& sight() const { return sight_; }
  const MountWatch& mount() const { return mount_; }
  // As the supervisor uses it: the age of the oldest look along the path.
  SightLook OldestLook() const;
  const Odometry& odometry() const { return odometry_; }
  const MapFromOdom& map_from_odom() const { return map_from_odom_; }
  const InsSample& newest_ins() const { return newest_ins_; }
  const LoopCounters& counters() const { return counters_; }
  uint64_t now_ns() const { return now_ns_; }
  uint64_t index() const { return index_; }
  uint64_t lidar_ns() const { return lidar_ns_; }
  uint64_t ins_ns() const { return ins_ns_; }
  uint64_t operator_ns() const { return operator_ns_; }
  int goals() const { return on_mission_ ? goals_.size() : 0; }
  int goal_index() const { return goal_index_; }
  // Precondition: goals() > 0.
  Vec2 goal_odom() const { return goals_[goal_index_].position_odom; }
  bool paused() const { return paused_; }
  bool at_waypoint() const { return held_at_ns_ != 0; }
  // Whether there is a mission that was stopped and can be resumed.
  bool may_resume() const { return !on_mission_ && may_resume_ && !goals_.empty(); }
  const AreaSet& areas() const { return areas_; }
  // The area that forbids the vehicle to be where it is, by its index; -1: none.
  int breached_area() const { return breached_area_; }
  const TrackingOutput& tracking() const { return tracking_output_; }
  // Hash of all decisions since Configure: commands, modes, plans.
  uint64_t decision_hash() const { return hash_.value(); }

 protected:
  // Clears inputs and decisions.
  void Forget();

  // Configures everything, after Forget. The statuses of the stages' Configure. Cost: everything is
  // cleared.
  Status Configure(const PilotConfig& config, const LidarLayout& lidar);

  // tick_s: since the previous tick, within limits.
  void BeginTick(uint64_t index, uint64_t now_ns);

  // Whether a device's clock offset may be fixed anew.
  bool MayFixClocks() const { return supervisor_.mode() == Mode::kStandby; }

  // An INS message measured at measured_ns.
  void TakeIns(const InsSample& sample, uint64_t measured_ns);

  // Updates the vehicle's pose, before the columns that were measured before it are taken.
  void Localise(const WheelFeedback& wheels);

  void TakeLabels(const ColumnLabels& labels);
  // A lidar column measured at time_ns.
  void TakeColumn(const LidarColumn& column, uint64_t time_ns);
  // A received column that does not reach the map.
  void LoseColumn();
  // Processes the columns of this tick.
  void FinishMap();

  // Decides whether and how the vehicle may move. `answer` is the answer to the command.
  void Decide(std::span<const uint8_t> command, const DriveFeedback& drives, bool bus_is_active,
              CommandAnswer& answer);

  // The demand on the drives.
  DriveDemand Act();

  // A fixed number of units of planning, independent of measured time: so a replay is reproducible.
  void PlanOn();

  // Adds this tick's decisions.
  void AddToHash(const CommandAnswer& answer);

  DecisionHash hash_;
  LoopCounters counters_;

 private:
  struct Goal {
    Vec2 position_odom;
    bool is_on_earth = false;  // if so, it moves in odom as odom drifts
    int64_t latitude_ndeg = 0;
    int64_t longitude_ndeg = 0;
    bool has_heading = false;
    float heading_rad = 0.0f;
    bool stops = false;      // the vehicle comes to rest here; always at the last one
    uint8_t hold_s = 0;      // and for so long
    float speed_mps = 0.0f;  // limit on the leg that leads here; 0: none
  };

  // Inputs (pilot.cpp).
  void NoteIns(const InsSample& sample, uint64_t measured_ns);
  void LocateInMap(const StampedPose& pose);
  void NoteLookout();
  Status LimitSpeed(const LidarLayout& lidar);
  Status ConfigureMapper();
  void Restart();

  // The operator's requests (goals.cpp).
  void TakeCommand(std::span<const uint8_t> bytes, const DriveFeedback& drives,
                   CommandAnswer& answer);
  void TakeWishes(const DriveFeedback& drives, CommandAnswer& answer);
  Status TakeMissionCommand(StopReason& refusal);
  Status CheckResume() const;
  Status Resume();
  void Skip();
  void NoteOperator();
  Status TakeGoals();
  Status InOdom(const control::Waypoint& waypoint, Vec2& position_odom) const;
  void DropGoals();
  void BeginLeg();
  void FollowEarth();
  void FollowEarth(Goal& goal) const;
  void AdvanceGoal(const DriveFeedback& drives);
  bool HasPassed(int index) const;
  bool IsPathBehind(int index) const;
  bool HasStoodAt(const DriveFeedback& drives);
  bool IsPassed(int index) const { return index + 1 < goals_.size() && !goals_[index].stops; }
  PlanGoal WantedGoal() const;
  bool IsAtEndFor(const Goal& goal) const;
  bool HasArrived() const;

  // Areas (areas.cpp).
  Status TakeAreas(const DriveFeedback& drives, StopReason& refusal);
  StopReason JudgeAreas();

  // Decisions (decide.cpp).
  VehicleState PredictedState() const;
  bool HasPlan() const;
  SupervisorInput Situation(const DriveFeedback& drives, bool bus_is_active) const;
  void UpdatePlanner();
  StopReason HeldByMission() const;
  void Move();

  // Monitoring (watch.cpp).
  Status ConfigureSafety();
  CorridorSize SizeOfCorridor() const;
  void TestReturns(bool are_new);
  void TestColumn(int slot, uint32_t max_range_mm, bool is_new);
  bool MayLookAtPerson(Vec2 person_odom) const;
  void LookAtPerson(Vec2 person_odom, uint64_t measured_ns);
  bool HasLabels() const;
  void LookForBody(int slot, uint32_t max_range_mm);
  void LookAtBody(Vec2 body_odom, uint64_t measured_ns);
  void LookForLost();
  void ReleaseLeftPlace();
  void FollowPlan();
  WayAhead Ahead() const;
  float MeasuredYawRate() const;
  MotionSample SampleMotion(const WheelFeedback& wheels) const;
  void WatchMotion(const WheelFeedback& wheels);
  void WatchGround();
  StopReason Misbehaves() const;
  bool IsPersonNear() const;
  void NoteNoWay();
  StopReason HeldBy() const;
  float ReactionTime() const;
  bool IsOnLeadOut() const;
  void NoteRound(bool was_busy, bool is_judged);
  WheelCommand PassGate();

  // Whether the lidar sees where the vehicle goes (sight.cpp).
  Status ConfigureSight();
  bool TurnsNext() const;
  bool MayWatchMount(int slot) const;
  void WatchMount(int slot);
  void AdvanceMount();
  void ExpectReturns();
  void LookAt(const PathState& state, SightLook& oldest) const;
  StopReason BlindBy(const SightLook& look) const;

  // The vehicle's motion until rest (sweep.cpp).
  void ConfigureSweep();
  WayAhead JudgeSweep();
  WayAhead JudgeStop();
  WayAhead JudgeSettingOut();
  void LayFirstWay();
  void FillUnseenStart(VehicleState& state) const;

  bool has_ticked_ = false;
  uint64_t index_ = 0;
  uint64_t now_ns_ = 0;
  uint64_t lidar_ns_ = 0;  // our time of the newest column in the map
  uint64_t ins_ns_ = 0;    // of the newest INS message that was not a repetition: when it was
                           // measured, as well as known, otherwise when it arrived
  uint64_t operator_ns_ = 0;
  uint64_t before_ns_ = 0;   // of the previous tick
  float tick_s_ = 0.0f;      // since the previous tick, within limits
  bool is_gap_ = false;      // of the odometry, in this tick
  bool is_located_ = false;  // the planner has this tick's state
  PilotConfig config_;
  OperatorWishes wishes_;
  control::OperatorCommand command_;
  FixedVector<Goal, control::kMaxWaypoints> goals_;
  int32_t goal_index_ = 0;
  // The goals are driven to. If not, they are those of a mission that was stopped, or none.
  bool on_mission_ = false;
  bool may_resume_ = false;  // odom still is what it was when they were given
  bool paused_ = false;      // by the operator
  uint64_t held_at_ns_ = 0;  // at a waypoint to stop at since; 0: not
  Vec2 leg_start_odom_;      // where the vehicle was when the goal became the present one
  uint32_t goals_list_ = 0;  // the number of the list of goals, which a skip makes another one
  InsSample newest_ins_;
  AngularRate ins_rate_;         // the newest angular rate, which not every message has
  uint64_t ins_rate_ns_ = 0;     // its time, likewise; 0: none yet
  float ins_speed_mps_ = 0.0f;   // the newest valid ground speed ...
  uint64_t ins_speed_ns_ = 0;    // ... and its time; 0: none yet
  uint32_t operator_press_ = 0;  // from the operator's last message with one
  InsSample ins_position_;       // of this tick, the newest with a position
  bool has_position_ = false;
  Odometry odometry_;
  MapFromOdom map_from_odom_;
  AreaSet areas_;
  int32_t breached_area_ = -1;
  StopReason area_ = StopReason::kNone;  // as JudgeAreas found in this tick
  Tracker tracker_;
  TrackingOutput tracking_output_;
  Supervisor supervisor_;
  Permission permission_;
  LidarWindow window_;
  BeamModel beam_model_;
  Mapper mapper_;
  Replanner replanner_;
  Corridor corridor_;
  MotionSweep sweep_;
  SweptMotion swept_;  // scratch of JudgeSweep
  WayAhead sweep_advice_ = WayAhead::kClear;
  uint32_t swept_plan_ = 0;     // the plan on which it last stopped
  bool comes_to_rest_ = false;  // it stops for what it would have touched, from a creep
  WaysOut ways_out_;
  bool has_start_ = false;  // the map began ...
  Pose2 start_odom_;        // ... at this pose
  CommandGate gate_;
  MotionWatch motion_;
  PeopleTracks people_;
  MovingBodies bodies_;
  Walkers walkers_;
  int32_t body_looks_ = 0;    // in this tick
  uint64_t labels_ns_ = 0;    // the last labels came; 0: none have
  int32_t person_looks_ = 0;  // in this tick ...
  Vec2 person_look_odom_;     // ... the last one
  Lookouts lookouts_;
  GroundWatch ground_;
  bool ground_drops_ = false;  // in this tick
  bool may_creep_ = true;      // no wheel has dropped since it was last in standby
  TiltWatch tilt_;
  bool is_tilted_ = false;
  ReactionMeter reaction_;
  SightWatch sight_;
  MountWatch mount_;
  int32_t expected_sector_ = 0;            // the last whose returns were told
  int32_t mount_columns_ = 0;              // watched in this tick
  StopReason no_way_ = StopReason::kNone;  // as the last round found
  uint32_t round_tick_ = 0;                // in which the round began
  SpeedParams speed_on_ground_;            // along that plan
  uint32_t seen_plan_ = 0;                 // number and check of the corridor's plan
  uint64_t seen_check_ns_ = 0;
};
static_assert(std::is_trivially_copyable_v<Pilot>);

}  // namespace hardpack
