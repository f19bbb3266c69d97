// SPDX-License-Identifier: Apache-2.0
#include "port_linux/hardpackctl/code_names.h"

#include <span>

#include "core/autonomy/replanner.h"
#include "core/measurements/measurements.h"
#include "core/odometry/map_from_odom.h"
#include "core/safety/supervisor.h"
#include "hal/can_bus.h"
#include "hal/sevcon/sevcon.h"
#include "hal/twist_drive/twist_drive.h"

namespace hardpack::ctl {
namespace {

using control::FieldKind;

constexpr CodeName kModeNames[] = {
    {"standby", "", false},  {"armed", "", false},         {"driving", "", false},
    {"safe_stop", "", true}, {"emergency_stop", "", true}, {"fault", "", true},
};
static_assert(std::size(kModeNames) == kModes);
static_assert(static_cast<int>(Mode::kFault) + 1 == kModes);

constexpr CodeName kStopReasonNames[] = {
    {"none", "", false},
    {"operator", "stopped by the operator", false},
    {"lidar_old", "no lidar column lately", true},
    {"odometry_old", "no wheel speeds lately", true},
    {"ins_old", "no message from the INS lately", true},
    {"plan_old", "the plan has not been checked recently", true},
    {"no_plan", "there is no plan, or none yet", true},
    {"operator_silent", "no command or key press from the operator", true},
    {"stop_too_long", "a safe stop took longer than allowed", true},
    {"drives", "a drive has a fault, is silent or not ready", true},
    {"foreign_sender", "another node sends with our CAN identifiers", true},
    {"bus", "the CAN bus is down or off", true},
    {"emergency", "stopped by the operator's emergency stop", true},
    {"moving", "it still moves", false},
    {"no_way", "planning finds no path", true},
    {"unseen_ground", "the ground ahead has not been observed", true},
    {"person", "a person is in the way, or too close to it", true},
    {"obstacle", "an obstacle is in the way of the path", true},
    {"goal_in_obstacle", "the goal is in an obstacle", true},
    {"runaway", "it moves when commanded to stand, or much faster than commanded", true},
    {"wrong_turn", "it turns against its command", true},
    {"stuck", "it was commanded to move and does not", true},
    {"bad_command", "a command was not a number", true},
    {"blind_ahead", "the lidar has not looked along the path recently", true},
    {"lidar_covered", "the lidar's window is covered, or nothing comes back ahead", true},
    {"lidar_frozen", "the lidar repeats an image", true},
    {"lidar_turned", "the lidar has turned in its mount", true},
    {"wheel_spin", "the wheels slip", true},
    {"paused", "the operator has paused the mission", false},
    {"at_waypoint", "it holds at a waypoint of the mission", false},
    {"no_mission", "there is no mission to pause, resume or skip a waypoint of", false},
    {"last_waypoint", "the last waypoint cannot be skipped", false},
    {"area_breached", "it is in a keep-out area, or not inside the fence", true},
    {"area_unknown", "not all areas have arrived, or one on earth has no place yet", true},
    {"ground_drops", "a wheel drops in ground that was not seen", true},
    {"tilted", "it leans too far, or is about to", true},
    {"steep_ground", "on the way down ahead it could not stop", true},
};
static_assert(std::size(kStopReasonNames) == kStopReasons);
static_assert(static_cast<int>(StopReason::kSteepGround) + 1 == kStopReasons);

constexpr CodeName kMotionNames[] = {
    {"off", "", false},        {"hold", "", false}, {"follow", "", false},
    {"stop_along", "", false}, {"zero", "", false},
};
static_assert(std::size(kMotionNames) == static_cast<int>(Motion::kZero) + 1);

constexpr CodeName kReplanDecisionNames[] = {
    {"none", "", false},     {"kept", "", false}, {"extended", "", false},
    {"replaced", "", false}, {"stop", "", true},
};
static_assert(std::size(kReplanDecisionNames) == static_cast<int>(ReplanDecision::kStop) + 1);

constexpr CodeName kReplanReasonNames[] = {
    {"none", "", false},         {"first", "", false},      {"off_path", "", false},
    {"goal_changed", "", false}, {"after_stop", "", false}, {"blocked", "", false},
    {"ends", "", false},         {"cheaper", "", false},
};
static_assert(std::size(kReplanReasonNames) == kReplanReasons);
static_assert(kReplanReasons == control::kReplanReasonCount);

constexpr CodeName kMapStatusNames[] = {
    {"none", "no position on earth yet", false},
    {"tracking", "", false},
    {"rejecting", "the INS's position does not fit", true},
    {"held", "no valid position from the INS", true},
};
static_assert(std::size(kMapStatusNames) == static_cast<int>(MapStatus::kHeld) + 1);

constexpr CodeName kInsModeNames[] = {
    {"not_tracking", "", true},
    {"aligning", "", true},
    {"tracking", "", false},
    {"gnss_lost", "", true},
};
static_assert(std::size(kInsModeNames) == static_cast<int>(InsMode::kGnssLost) + 1);

constexpr CodeName kDriveStateNames[] = {
    {"silent", "", true},     {"identifying", "", false}, {"configuring", "", false},
    {"verifying", "", false}, {"ready", "", false},       {"enabling", "", false},
    {"enabled", "", false},   {"disabling", "", false},   {"fault", "", true},
};
static_assert(std::size(kDriveStateNames) == static_cast<int>(sevcon::DriveState::kFault) + 1);

constexpr CodeName kDriveFaultNames[] = {
    {"none", "", false},
    {"silent", "heartbeat or process data missed", true},
    {"rebooted", "restarted", true},
    {"emergency", "EMCY", true},
    {"status_fault", "fault bit of the statusword", true},
    {"wrong_identity", "not the configured device", true},
    {"sdo_abort", "refused a request or a setting", true},
    {"sdo_timeout", "does not answer", true},
    {"read_back", "a setting does not read back as written", true},
    {"wrong_mapping", "different mapping of the process data", true},
    {"wrong_mode", "another mode of operation", true},
    {"opposite_motion", "the wheel turns against its command", true},
    {"foreign_sender", "another node sends with our identifiers", true},
    {"lost_enable", "left operation enabled without a request", true},
    {"login_refused", "user and password do not give the access that settings need", true},
    {"state_refused", "did not reach the requested state in time", true},
    {"double_reports", "more reports than SYNCs: two nodes send them", true},
};
static_assert(std::size(kDriveFaultNames) == sevcon::kDriveFaults);

constexpr CodeName kControllerStateNames[] = {
    {"starting", "", false}, {"ready", "", false}, {"following", "", false},
    {"stopping", "", false}, {"fault", "", true},
};
static_assert(std::size(kControllerStateNames) == twist_drive::kControllerStates);

constexpr CodeName kControllerFaultNames[] = {
    {"none", "", false},
    {"controller", "the controller reports a fault", true},
    {"silent", "no feedback lately", true},
    {"not_heard", "it takes no commands", true},
    {"wrong_turn", "it measures the other kind of turn: see twist_drive.turn", true},
    {"wrong_version", "its protocol has another version", true},
    {"enable_timeout", "it was enabled and does not follow", true},
    {"dropped", "it stopped following by itself", true},
};
static_assert(std::size(kControllerFaultNames) ==
              static_cast<int>(twist_drive::Fault::kDropped) + 1);

constexpr CodeName kCanBusStateNames[] = {
    {"down", "", true},    {"active", "", false}, {"warning", "", true},
    {"passive", "", true}, {"bus_off", "", true},
};
static_assert(std::size(kCanBusStateNames) == kCanBusStates);
static_assert(static_cast<int>(CanBusState::kBusOff) + 1 == kCanBusStates);

CodeName Among(std::span<const CodeName> names, uint8_t code) {
  return code < names.size() ? names[code] : CodeName{};
}

// CiA 301.
CodeName NmtStateName(uint8_t code) {
  switch (code) {
    case 0x00:
      return {"boot_up", "", false};
    case 0x04:
      return {"stopped", "", false};
    case 0x05:
      return {"operational", "", false};
    case 0x7f:
      return {"pre_operational", "", false};
    case 0xff:
      return {"not_heard", "", false};
    default:
      return {};
  }
}

}  // namespace

CodeName NameOf(FieldKind kind, uint8_t code) {
  switch (kind) {
    case FieldKind::kMode:
      return Among(kModeNames, code);
    case FieldKind::kStopReason:
      return Among(kStopReasonNames, code);
    case FieldKind::kMotion:
      return Among(kMotionNames, code);
    case FieldKind::kReplanDecision:
      return Among(kReplanDecisionNames, code);
    case FieldKind::kReplanReason:
      return Among(kReplanReasonNames, code);
    case FieldKind::kMapStatus:
      return Among(kMapStatusNames, code);
    case FieldKind::kInsMode:
      return Among(kInsModeNames, code);
    case FieldKind::kDriveState:
      return Among(kDriveStateNames, code);
    case FieldKind::kDriveFault:
      return Among(kDriveFaultNames, code);
    case FieldKind::kCanBusState:
      return Among(kCanBusStateNames, code);
    case FieldKind::kControllerState:
      return Among(kControllerStateNames, code);
    case FieldKind::kControllerFault:
      return Among(kControllerFaultNames, code);
    case FieldKind::kNmtState:
      return NmtStateName(code);
    case FieldKind::kStatus: {
      // kNotStarted is not a problem: there was no goal yet.
      const auto status = static_cast<Status>(code);
      return {StatusName(status), WordsOf(status),
              !IsUsable(status) && status != Status::kNotStarted};
    }
    case FieldKind::kValue:
    case FieldKind::kDuration:
    case FieldKind::kHex:
    case FieldKind::kNanodegree:
    case FieldKind::kAge:
      break;
  }
  return {};
}

const char* WordsOf(Status status) {
  switch (status) {
    case Status::kNotPermitted:
      return "only the owner and the group of the control socket may command";
    case Status::kNotStarted:
      return "it has not started yet";
    case Status::kStale:
      return "the INS has no valid position and heading";
    case Status::kInvalidArgument:
      return "a number is out of its range";
    case Status::kNotFinite:
      return "a number is not finite";
    case Status::kUnsupported:
      return "this command and the onboard program have different versions";
    case Status::kTruncated:
    case Status::kOversized:
    case Status::kWrongPacketType:
      return "the message was not understood";
    case Status::kNoPath:
      return "every way to the goal is blocked";
    case Status::kNeedsManoeuvre:
      return "the way bends more sharply than the vehicle can, or needs a turn on the spot";
    case Status::kCollision:
      return "the way is blocked";
    case Status::kGoalInObstacle:
      return "the goal lies in an obstacle";
    case Status::kGoalForbidden:
      return "the goal lies in a keep-out area, or not inside the fence";
    case Status::kAreaNotSimple:
      return "the border of an area touches or crosses itself";
    case Status::kAreaTooSmall:
      return "an area is smaller than a cell of the map";
    case Status::kSecondFence:
      return "there is a fence already";
    case Status::kCapacityExceeded:
      return "too many areas or corners";
    case Status::kStartEnclosed:
      return "the vehicle stands in an obstacle";
    default:
      return "";
  }
}

}  // namespace hardpack::ctl
