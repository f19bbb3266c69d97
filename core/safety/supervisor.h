// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "core/base/status.h"
#include "core/safety/corridor.h"

// Whether the vehicle may move, and how it stops (docs/safety.md). Owns the modes; sees ages, flags
// and the operator's wishes; commands no wheel. Times are ours.
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
// Nothing but the operator's arm leaves standby, and no goal outlives a stop: after a safe stop the
// vehicle waits for a new one. A plan that is blocked does not leave driving: the vehicle stops
// along its path, waits, and goes on when there is a way. Emergency stop and fault are left by the
// operator's disarm alone. A fault of a drive in standby stays there: arming resets it. A goal that
// still waits for its plan is dropped by a stop, too. Once zero speed was commanded at once,
// nothing is followed before the vehicle is at rest, in a safe stop neither: a plan from a state at
// rest is no plan for one that rolls, and along a path the vehicle stops later. A return in the
// corridor of the path (core/safety/corridor.h) does not leave driving either: the vehicle stops
// along its path, or with zero speed at once where that is too long, until a plan that was checked
// since is clear of it. Nor does a plan by which it is to stand where it is; for a person it stops
// with zero speed at once.

namespace hardpack {

enum class Mode : uint8_t { kStandby = 0, kArmed, kDriving, kSafeStop, kEmergencyStop, kFault };
inline constexpr int kModes = 6;

// Why the vehicle does not move, or may not: the first that applies.
enum class StopReason : uint8_t {
  kNone = 0,
  kOperator,        // told to stop
  kLidarOld,        // no column lately
  kOdometryOld,     // no wheel speeds lately
  kInsOld,          // no message of the INS lately
  kPlanOld,         // the committed plan has not been checked lately
  kNoPlan,          // there is no way, or none yet
  kOperatorSilent,  // the operator's program was to speak, and does not
  kStopTooLong,     // a safe stop took longer than it may
  kDrives,          // a drive has a fault or is silent
  kForeignSender,   // another node sends with our identifiers
  kBus,             // the CAN bus is down or off
  kEmergency,       // told to, by the operator
  kMoving,          // it still moves: not to be armed yet
  kNoWay,           // planning found that there is no way
  kUnseenGround,    // the ground ahead has not been observed
  kPerson,          // a person stands in the way, or too near to it
  kObstacle,        // a return stands in the way of the committed path
  kGoalInObstacle,  // the goal lies in an obstacle, and is not to be moved
  kRunaway,       // it moves when it was told to stand, or much faster (core/safety/motion_watch.h)
  kWrongTurn,     // it turns against its command
  kStuck,         // it was told to move, and does not
  kBadCommand,    // a command was no number (core/safety/command_gate.h)
  kBlindAhead,    // the lidar has not looked along the way lately (core/scan/sight_watch.h)
  kLidarCovered,  // its window is covered: nothing comes back, or from the window
  kLidarFrozen,   // it sends the same image again
  kLidarTurned,   // it has turned in its mount (core/scan/mount_watch.h)
  kWheelSpin,     // the wheels do not hold the ground
};
inline constexpr int kStopReasons = 28;

// What is asked of the drives.
enum class Motion : uint8_t {
  kOff = 0,    // zero, and no torque once at rest
  kHold,       // torque, zero speed
  kFollow,     // along the committed plan
  kStopAlong,  // come to rest along the committed plan, as fast as the limits allow
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
  uint64_t look_ns = 0;  // the oldest newest look along the way, over the vehicle's width
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
  // (core/safety/motion_sweep.h): kObstacle: along its path it does, or hits it more slowly, and it
  // has to begin now; kTooNear: with zero speed at once.
  WayAhead sweep = WayAhead::kClear;
  // Why there is no plan, as far as it is known, or why by the plan the vehicle is to stand where
  // it is, short of its end: kNone, kNoWay, kUnseenGround, kPerson or kGoalInObstacle. It stops
  // then.
  StopReason held_by = StopReason::kNone;
  // Why the look along the way is as old as it is, once it is too old: kBlindAhead, kLidarCovered,
  // kLidarFrozen or kLidarTurned.
  StopReason blind_by = StopReason::kBlindAhead;
  // What the vehicle does against its commands, or with them: kNone, kRunaway, kWrongTurn, kStuck,
  // kWheelSpin or kBadCommand. A fault, once it has torque.
  StopReason misbehaves = StopReason::kNone;
  OperatorWishes wishes;
};

struct Permission {
  Mode mode = Mode::kStandby;
  StopReason reason = StopReason::kNone;
  Motion motion = Motion::kOff;
  uint64_t reason_since_ns = 0;      // that reason() has been what it is; 0: since the start
  bool drop_goal = false;            // the goals are void from this tick on
  bool reset_faults = false;         // of the drives: arming begins with it, refused or not
  Status wish_status = Status::kOk;  // of this tick's wishes: kNotPermitted with `reason`
};

class Supervisor {
 public:
  // Drives may take so long to reset their faults when arming.
  static constexpr uint64_t kResetTime_ns = 3'000'000'000;

  // Standby. kParameterOutOfRange.
  Status Configure(const SafetyParams& params);

  // Once a tick. Constant cost.
  Permission Judge(const SupervisorInput& input);

  Mode mode() const { return mode_; }
  // Why the last stop was made; kept until the next goal is taken.
  StopReason last_stop() const { return last_stop_; }
  // Why the vehicle does not move now, whatever this tick's wishes were refused for.
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
  StopReason told_ = StopReason::kNone;  // reason_ at the end of the tick before
  uint64_t reason_since_ns_ = 0;
  uint64_t since_ns_ = 0;   // of the mode
  uint64_t reset_ns_ = 0;   // when it began with a reset of the drives' faults; 0: it did not
  bool disarming_ = false;  // a safe stop that ends in standby
  bool zero_ = false;       // no path is followed before the vehicle is at rest
};
static_assert(std::is_trivially_copyable_v<Supervisor>);

}  // namespace hardpack
