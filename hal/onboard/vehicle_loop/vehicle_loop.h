// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/conflicts.h"
#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/autonomy/mapper.h"
#include "core/autonomy/replanner.h"
#include "core/base/decision_hash.h"
#include "core/base/status.h"
#include "core/committed_plan/path_target.h"
#include "core/odometry/map_from_odom.h"
#include "core/odometry/odometry.h"
#include "core/safety/command_gate.h"
#include "core/safety/corridor.h"
#include "core/safety/motion_sweep.h"
#include "core/safety/motion_watch.h"
#include "core/safety/reaction_meter.h"
#include "core/safety/supervisor.h"
#include "core/scan/mount_watch.h"
#include "core/scan/sight_watch.h"
#include "core/segmentation/label_table.h"
#include "core/timebase/timebase.h"
#include "core/tracking/stop_motion.h"
#include "core/tracking/tracking.h"
#include "hal/can_batch.h"
#include "hal/can_bus.h"
#include "hal/datagram_socket.h"
#include "hal/onboard/control/messages.h"
#include "hal/ouster/ouster.h"
#include "hal/ouster/packet_monitor.h"
#include "hal/sevcon/sevcon.h"
#include "hal/vectornav/stream_parser.h"

// The whole system for one period: bytes in, CAN frames out. Makes no call through an interface and
// reads no clock: everything that it takes is in TickInput, so that a recording of the inputs gives
// the same outputs again, bit for bit. The state is one trivially copyable object without pointers.

namespace hardpack {

// Where a datagram came from, in the order in which a tick has to be given them.
enum class InputSource : uint8_t { kIns = 0, kLabels = 1, kLidar = 2 };
inline constexpr int kInputSources = 3;

struct TickDatagram {
  InputSource source = InputSource::kIns;
  std::span<const uint8_t> bytes;
};

struct TickInput {
  uint64_t index = 0;   // of the tick; a gap: ticks that were missed
  uint64_t now_ns = 0;  // our clock, read once: everything in this input counts as received now
  CanBusState bus = CanBusState::kDown;
  std::span<const TickDatagram> datagrams;  // at most kMaxDatagramsPerTick
  std::span<const CanFrame> frames;         // at most CanBus::kMaxFramesPerTick, in order
  std::span<const uint8_t> command;         // one control message of a permitted sender, or empty
};

struct TickOutput {
  CanBatch frames;          // to be sent, in order
  bool has_answer = false;  // to the command
  uint32_t sequence = 0;
  Status answer = Status::kOk;
  StopReason reason = StopReason::kNone;  // why it was not permitted
};

// Everything that decides how the vehicle behaves.
struct VehicleConfig {
  PlannerParams planner;
  PerceptionParams perception;
  OnboardParams onboard;
  LabelTable labels = RellisLabelTable();
  ouster::Metadata lidar;
};

struct LoopCounters {
  uint64_t ticks = 0;
  uint64_t missed_ticks = 0;   // gaps of the index
  uint64_t refused_ticks = 0;  // input that no tick can have: time or index ran backwards
  uint64_t datagrams[kInputSources] = {};
  uint64_t refused_datagrams[kInputSources] = {};
  uint64_t refused_columns = 0;  // those beyond a tick's directions among them
  uint64_t suspect_columns = 0;  // dropped while the lidar's clock was not to be relied upon
  uint64_t lidar_restarts = 0;
  uint64_t clock_jumps = 0;     // of the lidar
  uint64_t untimed_ins = 0;     // INS messages dropped while its clock was not to be relied upon
  uint64_t odometry_gaps = 0;   // pauses that odometry does not bridge: the map began anew
  uint64_t odometry_jumps = 0;  // steps that no vehicle makes: the same
  uint64_t refused_labels = 0;  // columns of labels that the map has no use for any more
  uint64_t commands = 0;
  uint64_t refused_commands = 0;
  uint64_t plans = 0;           // rounds of planning that were judged
  uint64_t refused_states = 0;  // that the planner would not take
};

class VehicleLoop {
 public:
  static constexpr int kMaxDatagramsPerTick = 32;
  // Of these the port takes at most so many of the INS and of labels, so that none can keep the
  // others out: as many of labels as the fastest lidar sends. The lidar has what they leave.
  static constexpr int kMaxInsDatagrams = 6;
  static constexpr int kMaxLabelDatagrams = 13;
  // Of a datagram of the INS: more than a second of its messages.
  static constexpr int kMaxInsDatagram_bytes = 4096;
  static constexpr int kMaxInsFeeds = 4;
  // Of all datagrams of a tick: a quarter of a second of the fastest INS. What is more waits.
  static constexpr int kMaxInsMessages = 64;
  static constexpr float kWaypointReached_m = 2.0f;  // where it is not the last one
  static constexpr float kMovedGoal_m = 3.0f;        // an end beside a goal that is occupied
  static constexpr float kArrived_m = 0.3f;
  static constexpr float kArrivedSpeed_mps = 0.05f;
  // A goal on earth that moves in odom by less than this stays where it is: each move is a new
  // plan.
  static constexpr float kGoalFollows_m = 0.05f;
  // Measured: a turn on the spot is not begun above it.
  static constexpr float kStandsSpeed_mps = 0.1f;
  // What a late tick may make up for of the ramps.
  static constexpr float kLongestTick_s = 0.1f;

  // What of it does not go together, by name: config/conflicts.h, and a period that brings more
  // columns of the lidar than a tick classes directions, or more of its datagrams than a tick
  // takes. No name: nothing. Precondition: each parameter is within its range.
  static ParameterConflict ConflictOf(const VehicleConfig& config);

  // Sets everything up and forgets what was. The statuses of the stages' Configure;
  // kParameterOutOfRange too where there is a conflict. Cost: everything is cleared.
  Status Configure(const VehicleConfig& config);

  // One tick. kOk; kNotStarted: Configure has not succeeded; kInvalidArgument: the time or the
  // index does not grow, or there is more than fits: then nothing has changed but a counter, and
  // `output` has no frame but is valid. Cost: bounded, the sum of its stages'.
  Status Tick(const TickInput& input, TickOutput& output);

  const VehicleConfig& config() const { return config_; }
  const Permission& permission() const { return permission_; }
  const Supervisor& supervisor() const { return supervisor_; }
  const sevcon::DrivePair& drives() const { return drives_; }
  const Mapper& mapper() const { return mapper_; }
  const Replanner& replanner() const { return replanner_; }
  const Corridor& corridor() const { return corridor_; }
  const MotionSweep& sweep() const { return sweep_; }
  const CommandGate& gate() const { return gate_; }
  const MotionWatch& motion() const { return motion_; }
  const ReactionMeter& reaction() const { return reaction_; }
  const SightWatch& sight() const { return sight_; }
  const MountWatch& mount() const { return mount_; }
  // As the supervisor has it: how long ago the way ahead was looked along.
  SightLook OldestLook() const;
  const Odometry& odometry() const { return odometry_; }
  const MapFromOdom& map_from_odom() const { return map_from_odom_; }
  const Timebase& lidar_time() const { return lidar_time_; }
  const ouster::PacketMonitor& lidar_packets() const { return lidar_packets_; }
  const vectornav::StreamParser& ins() const { return ins_; }
  const InsSample& newest_ins() const { return newest_ins_; }
  const LoopCounters& counters() const { return counters_; }
  uint64_t now_ns() const { return now_ns_; }
  uint64_t index() const { return index_; }
  uint64_t lidar_ns() const { return lidar_ns_; }
  uint64_t ins_ns() const { return ins_ns_; }
  uint64_t operator_ns() const { return operator_ns_; }
  int goals() const { return goals_.size(); }
  int goal_index() const { return goal_index_; }
  // Precondition: goals() > 0.
  Vec2 goal_odom() const { return goals_[goal_index_].position_odom; }
  const TrackingOutput& tracking() const { return tracking_output_; }
  // Of everything decided since Configure: what was sent, modes, plans.
  uint64_t decision_hash() const { return hash_.value(); }

 private:
  struct Goal {
    Vec2 position_odom;
    bool is_on_earth = false;  // then it moves in odom as that drifts
    int64_t latitude_ndeg = 0;
    int64_t longitude_ndeg = 0;
    bool has_heading = false;
    float heading_rad = 0.0f;
  };

  // What came (vehicle_loop.cpp).
  bool IsRefused(const TickInput& input);
  void TakeFrames(const TickInput& input);
  void TakeDatagrams(const TickInput& input, InputSource source);
  Status TakeIns(std::span<const uint8_t> bytes);
  Status TakeLabels(std::span<const uint8_t> bytes);
  Status TakeLidar(std::span<const uint8_t> bytes);
  Status ObserveLidarClock(std::span<const uint8_t> bytes);
  uint64_t MeasuredAt(const InsSample& sample);
  void NoteIns(uint64_t measured_ns);
  void AddPose();
  void LocateInMap(const StampedPose& pose);
  Status LimitSpeed();
  Status ConfigureMapper();
  void AddToHash(const TickOutput& output);

  // What the operator wants (goals.cpp).
  void TakeCommand(std::span<const uint8_t> bytes, TickOutput& output);
  void NoteOperator();
  Status TakeGoals();
  Status InOdom(const control::Waypoint& waypoint, Vec2& position_odom) const;
  void DropGoals();
  void FollowEarth();
  void AdvanceGoal();
  bool IsAtEndFor(const Goal& goal) const;
  bool HasArrived() const;

  // What is done about it (command.cpp).
  VehicleState PredictedState() const;
  bool HasPlan() const;
  SupervisorInput Situation(const TickInput& input) const;
  void UpdatePlanner();
  void StepPlanner();
  void Move();
  void Command(TickOutput& output);

  // What is looked after besides (safety.cpp).
  Status ConfigureSafety();
  CorridorSize SizeOfCorridor() const;
  void TestReturns(bool are_new);
  bool IsBeside(Vec2 point_odom) const;
  void TestColumn(int slot, uint32_t max_range_mm);
  void FollowPlan();
  WayAhead Ahead() const;
  float MeasuredYawRate() const;
  MotionSample SampleMotion() const;
  void WatchMotion();
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
  void WatchMount(int slot);
  void AdvanceMount();
  void LookAt(const Pose2& place, SightLook& oldest) const;
  StopReason BlindBy(const SightLook& look) const;

  // Where the vehicle goes until it is at rest (sweep.cpp).
  void ConfigureSweep();
  WayAhead JudgeSweep();
  WayAhead JudgeStop();
  WayAhead JudgeSettingOut();
  void LayFirstWay();
  void FillUnseenStart(VehicleState& state) const;

  bool configured_ = false;
  uint64_t index_ = 0;
  uint64_t now_ns_ = 0;
  uint64_t lidar_ns_ = 0;  // our time of the newest column in the map
  uint64_t ins_ns_ = 0;    // of the newest message of the INS that was no repetition: when it was
                           // measured, as near as its clock tells, else when it came
  uint64_t operator_ns_ = 0;
  uint64_t before_ns_ = 0;   // of the tick before
  float tick_s_ = 0.0f;      // since the tick before, within reason
  bool is_gap_ = false;      // of the odometry, in this tick
  bool is_located_ = false;  // the planner has this tick's state
  VehicleConfig config_;
  OperatorWishes wishes_;
  control::OperatorCommand command_;
  FixedVector<Goal, control::kMaxWaypoints> goals_;
  int32_t goal_index_ = 0;
  bool may_resume_ = true;    // the lidar has not restarted in this tick
  int32_t columns_left_ = 0;  // of the lidar, that this tick takes ...
  int32_t labels_left_ = 0;   // ... and of labels
  InsSample newest_ins_;
  AngularRate ins_rate_;         // the newest angular rate, which not every message has
  uint64_t ins_rate_ns_ = 0;     // the same of it; 0: none yet
  float ins_speed_mps_ = 0.0f;   // the newest speed over ground that it vouches for ...
  uint64_t ins_speed_ns_ = 0;    // ... and when; 0: none yet
  uint32_t operator_press_ = 0;  // the last that a message of the operator's carried
  InsSample ins_sample_;         // just decoded
  InsSample ins_position_;       // of this tick, the newest with a position
  bool has_position_ = false;
  LidarColumn column_;
  ColumnLabels labels_;
  sevcon::DrivePair drives_;
  vectornav::StreamParser ins_;
  ouster::PacketMonitor lidar_packets_;
  Timebase lidar_time_;
  Timebase ins_time_;
  Odometry odometry_;
  MapFromOdom map_from_odom_;
  Tracker tracker_;
  TrackingOutput tracking_output_;
  Supervisor supervisor_;
  Permission permission_;
  BeamModel beam_model_;
  Mapper mapper_;
  Replanner replanner_;
  Corridor corridor_;
  MotionSweep sweep_;
  SweptMotion swept_;  // scratch of JudgeSweep
  WayAhead sweep_advice_ = WayAhead::kClear;
  uint32_t swept_plan_ = 0;        // whose way it stopped on last
  int32_t lead_out_ = 0;           // that is tried next where it stands for that
  uint64_t held_since_ns_ = 0;     // that it stands for it; 0: it does not
  uint64_t person_beside_ns_ = 0;  // somebody was seen within reach last; 0: never
  bool has_start_ = false;         // the map began ...
  Pose2 start_odom_;               // ... at this pose
  CommandGate gate_;
  MotionWatch motion_;
  ReactionMeter reaction_;
  SightWatch sight_;
  MountWatch mount_;
  StopReason no_way_ = StopReason::kNone;  // as the last round found
  uint32_t round_tick_ = 0;                // in which the round began
  uint32_t seen_plan_ = 0;                 // number and check of the plan that the corridor is of
  uint64_t seen_check_ns_ = 0;
  DecisionHash hash_;
  LoopCounters counters_;
};
static_assert(std::is_trivially_copyable_v<VehicleLoop>);

// What all of it may take: it is copied into a flight log at once.
inline constexpr int kStateBudget_bytes = 8 * 1024 * 1024 + 256 * 1024;
static_assert(sizeof(VehicleLoop) <= kStateBudget_bytes);

}  // namespace hardpack
