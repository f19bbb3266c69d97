// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "core/base/status.h"
#include "core/safety/corridor.h"

// Whether the vehicle may move, and how it stops (docs/safety.md). Owns the modes; its inputs are
// ages, flags and the operator's requests; it does not command the wheels itself. Times are ours.
//
//             arm                goal, plan, enabled
//   standby ------> armed --------------------------> driving
//      ^  ^           ^  <--------------------------     |
//      |  |  disarm   |     arrived, or told to stop     | input too old, operator silent
//      |  +-----------+                                  v
//      |  at rest     +----------- at rest --------- safe stop
//      |
//      +--- disarm --- fault, emergency stop <--- from any other
//
// Only the operator's arm leaves standby, and no goal survives a stop: after a safe stop the
// vehicle waits for a new one. A blocked plan does not leave driving: the vehicle stops along its
// path, waits, and continues when there is a way. Only the operator's disarm leaves emergency stop
// and fault. A drive fault in standby stays there: arming resets it. A stop also drops a goal that
// is still waiting for its plan. Once zero speed was commanded at once, no path is followed before
// the vehicle is at rest, not even in a safe stop: a plan from a state at rest does not fit a
// rolling vehicle, and along a path the vehicle stops later. A return in the corridor of the path
// (core/safety/corridor.h) does not leave driving either: the vehicle stops along its path, or with
// zero speed at once if that takes too long, until a plan checked since then is clear of it. The
// same holds for a plan that makes the vehicle hold where it is; for a person it stops with zero
// speed at once. It holds for a mission that is paused, or waits at a waypoint, in the same way.
// Where a person has forbidden it to be (core/areas), and where a wheel drops, it makes a safe stop
// with zero speed.

namespace hardpack {

enum class Mode : uint8_t { kStandby = 0, kArmed, kDriving, kSafeStop, kEmergencyStop, kFault };
inline constexpr int kModes = 6;

// Why the vehicle does not or may not move: the first that applies.
enum class StopReason : uint8_t {
  kNone = 0,
  kOperator,        // told to stop
  kLidarOld,        // no recent column
  kOdometryOld,     // no recent wheel speeds
  kInsOld,          // no recent INS message
  kPlanOld,         // the committed plan has not been checked recently
  kNoPlan,          // there is no plan, or none yet
  kOperatorSilent,  // the operator is silent
  kStopTooLong,     // a safe stop took longer than allowed
  kDrives,          // a drive has a fault or is silent
  kForeignSender,   // another node sends with our identifiers
  kBus,             // the CAN bus is down or off
  kEmergency,       // commanded by the operator
  kMoving,          // it still moves: cannot be armed yet
  kNoWay,           // planning found no path
  kUnseenGround,    // the ground ahead has not been observed
  kPerson,          // a person is in the way, or too close to it
  kObstacle,        // a return is in the way of the committed path
  kGoalInObstacle,  // the goal is in an obstacle and must not be moved
  kRunaway,         // it moves when told to stand, or much faster (core/safety/motion_watch.h)
  kWrongTurn,       // it turns against its command
  kStuck,           // told to move, and does not
  kBadCommand,      // a command was not a number (core/safety/command_gate.h)
  kBlindAhead,      // no recent look along the path (core/scan/sight_watch.h)
  kLidarCovered,    // its window is covered: no returns, or returns from the window
  kLidarFrozen,     // it repeats an image
  kLidarTurned,     // it has turned in its mount (core/scan/mount_watch.h)
  kWheelSpin,       // the wheels slip
  kPaused,          // the operator has paused the mission
  kAtWaypoint,      // it holds at a waypoint, as the mission says
  kNoMission,       // nothing to pause, resume or skip
  kLastWaypoint,    // the last waypoint cannot be skipped
  kAreaBreached,    // it is in a keep-out area, or not inside the fence (core/areas)
  kAreaUnknown,     // not all areas have arrived, or one on earth has no place in odom
  kGroundDrops,     // a wheel drops in ground that was not seen (core/safety/ground_watch.h)
  kTilted,          // the body leans too far, or is about to (core/safety/tilt_watch.h)
  kSteepGround,     // on the way down ahead it could not stop (core/speed/ground_ahead.h)
};
inline constexpr int kStopReasons = 37;

// What the drives are told to do.
enum class Motion : uint8_t {
  kOff = 0,    // zero, and no torque once at rest
  kHold,       // torque, zero speed
  kFollow,     // along the committed plan
  kStopAlong,  // stop along the committed plan, as fast as the limits allow
  kZero,       // zero speed at once, the path is not followed
};

struct OperatorWishes {
  bool arm = false;  // of this tick
  bool disarm = false;
  bool go = false;  // a new goal was given
  bool stop = false;
  bool emergency_stop = false;
};

struct SupervisorInput {
  uint64_t now_ns = 0;
  // Newest of each; 0: none yet.
  uint64_t lidar_ns = 0;
  uint64_t look_ns = 0;  // oldest of the newest looks along the path, across its width
  uint64_t odometry_ns = 0;
  uint64_t ins_ns = 0;
  uint64_t plan_checked_ns = 0;
  uint64_t operator_ns = 0;
  bool bus_active = false;
  bool drives_ready = false;
  bool drives_enabled = false;
  bool drives_faulty = false;
  bool foreign_sender = false;
  bool at_rest = false;
  bool has_goal = false;
  bool has_plan = false;  // a checked, committed plan that may be driven
  bool has_path = false;  // a committed path along which to stop
  bool arrived = false;   // at the last goal
  // The first return in the corridor of the path.
  WayAhead ahead = WayAhead::kClear;
  bool ahead_is_person = false;
  // Whether the vehicle, from its actual state, comes to rest without touching anything
  // (core/safety/motion_sweep.h). kObstacle: along its path it does, or hits more slowly that way,
  // and it must begin now; kTooNear: with zero speed at once.
  WayAhead sweep = WayAhead::kClear;
  // Why there is no plan, if known, or why the plan makes the vehicle hold where it is, short of
  // its end, or why the mission does: kNone, kNoWay, kUnseenGround, kPerson, kGoalInObstacle,
  // kPaused or kAtWaypoint. It stops then; the last two keep an armed vehicle from setting out,
  // too.
  StopReason held_by = StopReason::kNone;
  // Why the look along the path is as old as it is, once it is too old: kBlindAhead, kLidarCovered,
  // kLidarFrozen or kLidarTurned.
  StopReason blind_by = StopReason::kBlindAhead;
  // How the vehicle deviates from its commands: kNone, kRunaway, kWrongTurn, kStuck, kWheelSpin or
  // kBadCommand. A fault, once it has torque.
  StopReason misbehaves = StopReason::kNone;
  // Whether the vehicle is where an area allows it to be: kNone, kAreaBreached or kAreaUnknown. If
  // not, it is not armed, does not set out, and stops: where it breaches one, with zero speed.
  StopReason area = StopReason::kNone;
  bool ground_drops = false;  // stops, with zero speed
  bool is_tilted = false;     // stops along its path, and does not set out
  OperatorWishes wishes;
};

struct Permission {
  Mode mode = Mode::kStandby;
  StopReason reason = StopReason::kNone;
  Motion motion = Motion::kOff;
  uint64_t reason_since_ns = 0;      // since when reason() is unchanged; 0: since the start
  bool drop_goal = false;            // the goals are dropped from this tick on
  bool reset_faults = false;         // of the drives: arming begins with it, even if refused
  Status wish_status = Status::kOk;  // of this tick's requests: kNotPermitted with `reason`
};

class Supervisor {
 public:
  // Time for the drives to reset their faults when arming.
  static constexpr uint64_t kResetTime_ns = 3'000'000'000;

  // Standby. kParameterOutOfRange.
  Status Configure(const SafetyParams& params);

  // Once a tick. Constant cost.
  Permission Judge(const SupervisorInput& input);

  Mode mode() const { return mode_; }
  // Reason of the last stop; kept until the next goal is accepted.
  StopReason last_stop() const { return last_stop_; }
  // Why the vehicle does not move now, whatever this tick's requests were refused for.
  StopReason reason() const { return reason_; }

 private:
  StopReason OldInput(const SupervisorInput& input) const;
  bool IsFarTooOld(const SupervisorInput& input) const;
  StopReason Unfit(const SupervisorInput& input) const;
  StopReason MayNotArm(const SupervisorInput& input) const;
  void TakeWishes(const SupervisorInput& input, Permission& permission);
  void Change(Mode mode, StopReason reason, uint64_t now_ns);
  void JudgeZero(const SupervisorInput& input);
  void StepArmed(const SupervisorInput& input);
  void StepDriving(const SupervisorInput& input);
  void StepSafeStop(const SupervisorInput& input);
  StopReason Waits(const SupervisorInput& input) const;
  Motion MotionOf(const SupervisorInput& input) const;

  SafetyParams params_;
  bool configured_ = false;
  Mode mode_ = Mode::kStandby;
  StopReason reason_ = StopReason::kNone;
  StopReason last_stop_ = StopReason::kNone;
  StopReason told_ = StopReason::kNone;  // reason_ at the end of the previous tick
  uint64_t reason_since_ns_ = 0;
  uint64_t since_ns_ = 0;   // of the mode
  uint64_t reset_ns_ = 0;   // when it began by resetting drive faults; 0: it did not
  bool disarming_ = false;  // a safe stop that ends in standby
  bool zero_ = false;       // no path is followed before the vehicle is at rest
};
static_assert(std::is_trivially_copyable_v<Supervisor>);

}  // namespace hardpack
