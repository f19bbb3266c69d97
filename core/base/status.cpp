// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.h"

#include "core/base/loop_bound.h"

namespace hardpack {
namespace {

struct Named {
  Status status;
  const char* name;
};

constexpr Named kNames[] = {
    {Status::kOk, "ok"},
    {Status::kGoalOutsideMap, "goal_outside_map"},
    {Status::kGoalMoved, "goal_moved"},
    {Status::kStartInObstacle, "start_in_obstacle"},
    {Status::kPartialPath, "partial_path"},
    {Status::kPathCut, "path_cut"},
    {Status::kIterationLimit, "iteration_limit"},
    {Status::kNarrowGap, "narrow_gap"},
    {Status::kLimitExceeded, "limit_exceeded"},
    {Status::kClockJumped, "clock_jumped"},
    {Status::kOffPath, "off_path"},
    {Status::kNotStarted, "not_started"},
    {Status::kInvalidArgument, "invalid_argument"},
    {Status::kNotFinite, "not_finite"},
    {Status::kParameterOutOfRange, "parameter_out_of_range"},
    {Status::kCapacityExceeded, "capacity_exceeded"},
    {Status::kNoPath, "no_path"},
    {Status::kStartOutsideMap, "start_outside_map"},
    {Status::kStartEnclosed, "start_enclosed"},
    {Status::kGoalInObstacle, "goal_in_obstacle"},
    {Status::kPivotBlocked, "pivot_blocked"},
    {Status::kCollision, "collision"},
    {Status::kPathTooShort, "path_too_short"},
    {Status::kTruncated, "truncated"},
    {Status::kOversized, "oversized"},
    {Status::kWrongPacketType, "wrong_packet_type"},
    {Status::kWrongSensor, "wrong_sensor"},
    {Status::kBadColumn, "bad_column"},
    {Status::kColumnInvalid, "column_invalid"},
    {Status::kUnsupported, "unsupported"},
    {Status::kBadCrc, "bad_crc"},
    {Status::kDuplicate, "duplicate"},
    {Status::kLate, "late"},
    {Status::kSensorRestarted, "sensor_restarted"},
    {Status::kNoPose, "no_pose"},
    {Status::kEmpty, "empty"},
    {Status::kExpired, "expired"},
    {Status::kInterfaceDown, "interface_down"},
    {Status::kBusOff, "bus_off"},
    {Status::kNotPermitted, "not_permitted"},
    {Status::kSystemError, "system_error"},
    {Status::kWrongSender, "wrong_sender"},
    {Status::kTimedOut, "timed_out"},
    {Status::kAborted, "aborted"},
    {Status::kDeviceFault, "device_fault"},
    {Status::kWrongDevice, "wrong_device"},
    {Status::kStale, "stale"},
    {Status::kNeedsManoeuvre, "needs_manoeuvre"},
    {Status::kAreaNotSimple, "area_not_simple"},
    {Status::kAreaTooSmall, "area_too_small"},
    {Status::kSecondFence, "second_fence"},
    {Status::kGoalForbidden, "goal_forbidden"},
};
constexpr int kNameCount = sizeof(kNames) / sizeof(kNames[0]);

}  // namespace

const char* StatusName(Status status) {
  HP_LOOP_BOUND(kNameCount)
  for (const Named& named : kNames) {
    if (named.status == status) return named.name;
  }
  return "unknown";
}

}  // namespace hardpack
