// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/pilot/pilot.h"

// Pilot: where a person forbids the vehicle to be, and how fast it may be elsewhere.

namespace hardpack {

// Only while it stands and does not drive. A goal that waits is dropped, and so is a mission that
// could be resumed: the way that either would take now is another. kNotPermitted: not at rest in
// standby or armed; the statuses of AreaSet::Take.
Status Pilot::TakeAreas(const DriveFeedback& drives, StopReason& refusal) {
  const Mode mode = supervisor_.mode();
  const bool may_change = (mode == Mode::kStandby || mode == Mode::kArmed) && drives.standstill;
  if (!may_change) {
    refusal = StopReason::kMoving;
    return Status::kNotPermitted;
  }
  may_resume_ = false;
  DropGoals();
  if (command_.kind == control::Kind::kArea) {
    return areas_.Take(command_.area_index, command_.area_count, command_.area);
  }
  areas_.Clear();
  return Status::kOk;
}

// By its outline where it is now. Where its motion until rest would take it, the sweep knows: the
// cells that areas close are hard in its map too.
StopReason Pilot::JudgeAreas() {
  const StampedPose& here = odometry_.pose();
  breached_area_ =
      areas_.BreachedBy(sweep_.footprint(), {here.position.x_m, here.position.y_m, here.yaw_rad});
  if (breached_area_ >= 0) return StopReason::kAreaBreached;
  return areas_.is_known() ? StopReason::kNone : StopReason::kAreaUnknown;
}

}  // namespace hardpack
