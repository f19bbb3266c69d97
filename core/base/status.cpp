// SPDX-License-Identifier: Apache-2.0
#include "core/base/status.h"

namespace hardpack {

const char* StatusName(Status status) {
  // A switch, so that the compiler names a code that is missing; a code a line.
  // clang-format off
  switch (status) {
    case Status::kOk: return "ok";
    case Status::kGoalOutsideMap: return "goal_outside_map";
    case Status::kGoalMoved: return "goal_moved";
    case Status::kStartInObstacle: return "start_in_obstacle";
    case Status::kPartialPath: return "partial_path";
    case Status::kPathCut: return "path_cut";
    case Status::kIterationLimit: return "iteration_limit";
    case Status::kNarrowGap: return "narrow_gap";
    case Status::kLimitExceeded: return "limit_exceeded";
    case Status::kNotStarted: return "not_started";
    case Status::kInvalidArgument: return "invalid_argument";
    case Status::kNotFinite: return "not_finite";
    case Status::kParameterOutOfRange: return "parameter_out_of_range";
    case Status::kCapacityExceeded: return "capacity_exceeded";
    case Status::kNoPath: return "no_path";
    case Status::kStartOutsideMap: return "start_outside_map";
    case Status::kStartEnclosed: return "start_enclosed";
    case Status::kGoalInObstacle: return "goal_in_obstacle";
    case Status::kPivotBlocked: return "pivot_blocked";
    case Status::kCollision: return "collision";
    case Status::kPathTooShort: return "path_too_short";
    case Status::kTruncated: return "truncated";
    case Status::kOversized: return "oversized";
    case Status::kWrongPacketType: return "wrong_packet_type";
    case Status::kWrongSensor: return "wrong_sensor";
    case Status::kBadColumn: return "bad_column";
    case Status::kColumnInvalid: return "column_invalid";
    case Status::kUnsupported: return "unsupported";
    case Status::kBadCrc: return "bad_crc";
    case Status::kDuplicate: return "duplicate";
  }
  // clang-format on
  return "unknown";
}

}  // namespace hardpack
