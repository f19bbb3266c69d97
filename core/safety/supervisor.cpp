// SPDX-License-Identifier: Apache-2.0
#include "core/safety/supervisor.h"

#include "core/base/units.h"
#include "core/base/validate.h"

namespace hardpack {
namespace {

// Age of what last came at then_ns; 0 stands for never.
bool IsOlder(uint64_t now_ns, uint64_t then_ns, float limit_s) {
  if (then_ns == 0) return true;
  return then_ns < now_ns && SecondsBetween(then_ns, now_ns) > limit_s;
}

}  // namespace

Status Supervisor::Configure(const SafetyParams& params) {
  *this = Supervisor{};
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  params_ = params;
  configured_ = true;
  return Status::kOk;
}

// The inputs that driving relies upon, by how much they matter.
StopReason Supervisor::OldInput(const SupervisorInput& input) const {
  const uint64_t now_ns = input.now_ns;
  if (IsOlder(now_ns, input.lidar_ns, params_.max_lidar_age_s)) return StopReason::kLidarOld;
  if (IsOlder(now_ns, input.look_ns, params_.max_look_age_s)) return input.blind_by;
  if (IsOlder(now_ns, input.odometry_ns, params_.max_odometry_age_s)) {
    return StopReason::kOdometryOld;
  }
  if (params_.needs_ins != 0 && IsOlder(now_ns, input.ins_ns, params_.max_ins_age_s)) {
    return StopReason::kInsOld;
  }
  if (params_.operator_timeout_s > 0.0f &&
      IsOlder(now_ns, input.operator_ns, params_.operator_timeout_s)) {
    return StopReason::kOperatorSilent;
  }
  return StopReason::kNone;
}

// Along a path that nobody has looked at for so long, or without knowing where, is no way to stop.
bool Supervisor::IsFarTooOld(const SupervisorInput& input) const {
  const float factor = params_.hard_age_factor;
  return IsOlder(input.now_ns, input.lidar_ns, factor * params_.max_lidar_age_s) ||
         IsOlder(input.now_ns, input.look_ns, factor * params_.max_look_age_s) ||
         IsOlder(input.now_ns, input.odometry_ns, factor * params_.max_odometry_age_s) ||
         (params_.needs_ins != 0 &&
          IsOlder(input.now_ns, input.ins_ns, factor * params_.max_ins_age_s));
}

// What makes it impossible to command the drives at all.
StopReason Supervisor::Unfit(const SupervisorInput& input) const {
  if (input.foreign_sender) return StopReason::kForeignSender;
  if (!input.bus_active) return StopReason::kBus;
  if (input.drives_faulty) return StopReason::kDrives;
  return input.misbehaves;
}

StopReason Supervisor::MayNotArm(const SupervisorInput& input) const {
  if (input.foreign_sender) return StopReason::kForeignSender;
  if (!input.bus_active) return StopReason::kBus;
  // A fault of a drive is what arming resets; a silent or unready one it cannot help.
  if (!input.drives_ready && !input.drives_faulty) return StopReason::kDrives;
  const StopReason old = OldInput(input);
  // What its silence makes old is told by its name.
  if (old == StopReason::kOdometryOld && !input.drives_ready) return StopReason::kDrives;
  if (old != StopReason::kNone) return old;
  if (input.area != StopReason::kNone) return input.area;
  return input.at_rest ? StopReason::kNone : StopReason::kMoving;
}

void Supervisor::Change(Mode mode, StopReason reason, uint64_t now_ns) {
  if (reason != StopReason::kNone) last_stop_ = reason;
  mode_ = mode;
  reason_ = reason;
  since_ns_ = now_ns;
  reset_ns_ = 0;
  if (mode != Mode::kSafeStop) zero_ = false;  // which has to end it too
}

// A safe stop that begins meanwhile does not end it: along the path the vehicle would stop later.
void Supervisor::JudgeZero(const SupervisorInput& input) {
  if (mode_ != Mode::kDriving && mode_ != Mode::kSafeStop) return;
  const bool has_way = input.has_plan || input.has_path;
  const bool is_held = input.held_by == StopReason::kPerson;
  const bool is_too_near = input.ahead == WayAhead::kTooNear || input.sweep == WayAhead::kTooNear;
  const bool is_breached = input.area == StopReason::kAreaBreached;
  if (!has_way || is_held || is_too_near || is_breached || input.ground_drops) zero_ = true;
  if (input.at_rest && !is_breached) zero_ = false;
}

void Supervisor::TakeWishes(const SupervisorInput& input, Permission& permission) {
  const OperatorWishes& wishes = input.wishes;
  const bool drives = mode_ == Mode::kArmed || mode_ == Mode::kDriving;
  if (wishes.emergency_stop) {  // whatever else is wished for
    Change(Mode::kEmergencyStop, StopReason::kEmergency, input.now_ns);
    return;
  }
  if (wishes.disarm) {
    if (mode_ == Mode::kArmed) zero_ = true;  // which is what it has: no path was followed
    if (drives) Change(Mode::kSafeStop, StopReason::kOperator, input.now_ns);
    if (mode_ == Mode::kSafeStop) {
      disarming_ = true;
    } else {
      Change(Mode::kStandby, StopReason::kNone, input.now_ns);
    }
    return;
  }
  if (wishes.stop) {
    if (mode_ == Mode::kDriving) Change(Mode::kSafeStop, StopReason::kOperator, input.now_ns);
    if (mode_ == Mode::kArmed) permission.drop_goal = true;  // one that waits for its plan
    return;
  }
  StopReason refusal = StopReason::kNone;
  if (wishes.arm && mode_ == Mode::kStandby) {
    refusal = MayNotArm(input);
    if (refusal == StopReason::kNone) {
      Change(Mode::kArmed, StopReason::kNone, input.now_ns);
      permission.reset_faults = true;
      reset_ns_ = input.now_ns;
    } else if (input.drives_faulty && !input.foreign_sender && input.bus_active) {
      // A drive that was stopped says nothing before it is reset: armed the next time.
      permission.reset_faults = true;
    }
  } else if ((wishes.arm || wishes.go) && !drives) {
    refusal = reason_ == StopReason::kNone ? StopReason::kOperator : reason_;
  }
  if (wishes.go && drives) last_stop_ = StopReason::kNone;
  if (refusal == StopReason::kNone) return;
  permission.wish_status = Status::kNotPermitted;
  permission.reason = refusal;
}

void Supervisor::StepArmed(const SupervisorInput& input) {
  const StopReason unfit = Unfit(input);
  const bool is_resetting = unfit == StopReason::kDrives && !input.drives_enabled &&
                            reset_ns_ != 0 && input.now_ns - reset_ns_ <= kResetTime_ns;
  if (unfit != StopReason::kNone && !is_resetting) {
    Change(Mode::kFault, unfit, input.now_ns);
    return;
  }
  reason_ = OldInput(input);
  if (reason_ == StopReason::kNone) reason_ = input.area;
  if (reason_ == StopReason::kNone && input.is_tilted) reason_ = StopReason::kTilted;
  const bool is_held =
      input.held_by == StopReason::kPaused || input.held_by == StopReason::kAtWaypoint;
  if (reason_ == StopReason::kNone && input.has_goal && (!input.has_plan || is_held)) {
    reason_ = Waits(input);
  }
  if (reason_ == StopReason::kNone && input.has_goal &&
      IsOlder(input.now_ns, input.plan_checked_ns, params_.max_plan_age_s)) {
    reason_ = StopReason::kPlanOld;
  }
  const bool goes = input.has_goal && !input.wishes.stop;
  if (reason_ == StopReason::kNone && goes && input.drives_enabled) {
    Change(Mode::kDriving, StopReason::kNone, input.now_ns);
  }
}

// Why the vehicle stops or waits for its way, while it drives or would.
StopReason Supervisor::Waits(const SupervisorInput& input) const {
  if (input.ahead != WayAhead::kClear) {
    return input.ahead_is_person ? StopReason::kPerson : StopReason::kObstacle;
  }
  if (input.sweep != WayAhead::kClear) return StopReason::kObstacle;
  if (input.held_by != StopReason::kNone) return input.held_by;
  if (!zero_) return input.has_plan ? StopReason::kNone : StopReason::kNoPlan;
  // It comes to rest before it goes on, for the reason for which that began.
  const bool was_blocked = reason_ == StopReason::kPerson || reason_ == StopReason::kObstacle;
  return was_blocked ? reason_ : StopReason::kNoPlan;
}

void Supervisor::StepDriving(const SupervisorInput& input) {
  const StopReason unfit = Unfit(input);
  if (unfit != StopReason::kNone || !input.drives_enabled) {
    Change(Mode::kFault, unfit == StopReason::kNone ? StopReason::kDrives : unfit, input.now_ns);
    return;
  }
  const StopReason old = OldInput(input);
  if (old != StopReason::kNone) {
    Change(Mode::kSafeStop, old, input.now_ns);
    return;
  }
  if (input.area != StopReason::kNone) {
    Change(Mode::kSafeStop, input.area, input.now_ns);
    return;
  }
  if (input.ground_drops) {
    Change(Mode::kSafeStop, StopReason::kGroundDrops, input.now_ns);
    return;
  }
  if (input.is_tilted) {
    Change(Mode::kSafeStop, StopReason::kTilted, input.now_ns);
    return;
  }
  if (input.has_plan && IsOlder(input.now_ns, input.plan_checked_ns, params_.max_plan_age_s)) {
    Change(Mode::kSafeStop, StopReason::kPlanOld, input.now_ns);
    return;
  }
  reason_ = Waits(input);
  if ((input.arrived && input.at_rest) || !input.has_goal) {
    Change(Mode::kArmed, StopReason::kNone, input.now_ns);
  }
}

void Supervisor::StepSafeStop(const SupervisorInput& input) {
  const StopReason unfit = Unfit(input);
  if (unfit != StopReason::kNone) {
    Change(Mode::kFault, unfit, input.now_ns);
    return;
  }
  if (input.at_rest) {
    Change(disarming_ ? Mode::kStandby : Mode::kArmed, StopReason::kNone, input.now_ns);
    disarming_ = false;
    return;
  }
  if (SecondsBetween(since_ns_, input.now_ns) > params_.max_stop_s) {
    zero_ = true;
    reason_ = StopReason::kStopTooLong;
    last_stop_ = reason_;
  }
}

Motion Supervisor::MotionOf(const SupervisorInput& input) const {
  switch (mode_) {
    case Mode::kArmed:
      return Motion::kHold;
    case Mode::kDriving:
      if (zero_) return Motion::kZero;
      if (input.has_plan && input.ahead == WayAhead::kClear && input.sweep == WayAhead::kClear &&
          input.held_by == StopReason::kNone) {
        return Motion::kFollow;
      }
      return input.has_path ? Motion::kStopAlong : Motion::kZero;
    case Mode::kSafeStop:
      return input.has_path && !zero_ ? Motion::kStopAlong : Motion::kZero;
    case Mode::kStandby:
    case Mode::kEmergencyStop:
    case Mode::kFault:
      break;
  }
  return Motion::kOff;
}

Permission Supervisor::Judge(const SupervisorInput& input) {
  Permission permission;
  if (!configured_) return permission;
  if (mode_ != Mode::kSafeStop) disarming_ = false;
  const Mode before = mode_;
  JudgeZero(input);
  TakeWishes(input, permission);
  if (mode_ == before) {
    switch (mode_) {
      case Mode::kArmed:
        StepArmed(input);
        break;
      case Mode::kDriving:
        StepDriving(input);
        break;
      case Mode::kSafeStop:
        StepSafeStop(input);
        break;
      case Mode::kStandby:
        reason_ = Unfit(input);
        break;
      case Mode::kEmergencyStop:
      case Mode::kFault:
        break;
    }
  }
  // In the tick in which the stop begins, too: ages leap where ticks are missed.
  if (mode_ == Mode::kSafeStop && IsFarTooOld(input)) zero_ = true;
  if (reason_ != told_) reason_since_ns_ = input.now_ns;
  told_ = reason_;
  permission.reason_since_ns = reason_since_ns_;
  permission.mode = mode_;
  if (permission.wish_status == Status::kOk) permission.reason = reason_;
  permission.motion = MotionOf(input);
  // A goal waits while the vehicle is armed for it, and its path is what a safe stop follows.
  const bool keeps = mode_ == Mode::kDriving || mode_ == Mode::kSafeStop ||
                     (mode_ == Mode::kArmed && before == mode_);
  permission.drop_goal = permission.drop_goal || !keeps;
  return permission;
}

}  // namespace hardpack
