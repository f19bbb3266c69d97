// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "hal/onboard/control/messages.h"
#include "hal/onboard/pilot/pilot.h"

// Pilot: what the operator wants.

namespace hardpack {
namespace {

// A goal further away than this is a mistake.
constexpr float kMaxGoal_m = 20000.0f;
// Of a waypoint's limit of speed, as the message has it.
constexpr float kSpeedUnit_mps = 0.1f;

float DistanceBetween(Vec2 a, Vec2 b) {
  const float dx_m = a.x_m - b.x_m;
  const float dy_m = a.y_m - b.y_m;
  return Sqrt(dx_m * dx_m + dy_m * dy_m);
}

bool IsForMission(control::Kind kind) {
  return kind == control::Kind::kPause || kind == control::Kind::kResume ||
         kind == control::Kind::kSkip;
}

bool IsForAreas(control::Kind kind) {
  return kind == control::Kind::kArea || kind == control::Kind::kClearAreas;
}

}  // namespace

void Pilot::TakeCommand(std::span<const uint8_t> bytes, const DriveFeedback& drives,
                        CommandAnswer& answer) {
  if (bytes.empty()) return;
  ++counters_.commands;
  control::Header header;
  Status decoded = control::ReadHeader(bytes, header);
  if (IsUsable(decoded)) decoded = control::Decode(bytes, command_);
  answer.has_answer = true;
  answer.sequence = header.sequence;
  answer.answer = decoded;
  answer.reason = StopReason::kNone;
  if (!IsUsable(decoded)) {
    ++counters_.refused_commands;
    return;
  }
  NoteOperator();
  TakeWishes(drives, answer);
}

void Pilot::TakeWishes(const DriveFeedback& drives, CommandAnswer& answer) {
  wishes_.arm = command_.kind == control::Kind::kArm;
  wishes_.disarm = command_.kind == control::Kind::kDisarm;
  wishes_.stop = command_.kind == control::Kind::kStop;
  wishes_.emergency_stop = command_.kind == control::Kind::kEmergencyStop;
  wishes_.go = command_.kind == control::Kind::kGoal;
  if (wishes_.go) {
    answer.answer = TakeGoals();
  } else if (IsForMission(command_.kind)) {
    answer.answer = TakeMissionCommand(answer.reason);
  } else if (IsForAreas(command_.kind)) {
    answer.answer = TakeAreas(drives, answer.reason);
  }
  if (!IsUsable(answer.answer)) {
    wishes_.go = false;
    ++counters_.refused_commands;
  }
}

// Every command is the operator's doing but an alive, which a program sends by itself: that has to
// carry a press that the one before did not.
void Pilot::NoteOperator() {
  if (command_.kind == control::Kind::kAlive) {
    if (command_.press == 0 || command_.press == operator_press_) return;
    operator_press_ = command_.press;
  }
  operator_ns_ = now_ns_;
}

// Only where they will be driven to: what is refused changes nothing.
Status Pilot::TakeGoals() {
  const Mode mode = supervisor_.mode();
  if (mode != Mode::kArmed && mode != Mode::kDriving) return Status::kOk;  // the supervisor refuses
  if (command_.waypoints < 1 || command_.waypoints > control::kMaxWaypoints) {
    return Status::kInvalidArgument;
  }
  HP_LOOP_BOUND(control::kMaxWaypoints)
  for (int i = 0; i < command_.waypoints; ++i) {
    Vec2 position_odom;
    const Status status = InOdom(command_.waypoint[i], position_odom);
    if (!IsUsable(status)) return status;
    // It would be moved to the nearest place that is free, which nobody asked for.
    if (!areas_.Permits(position_odom)) return Status::kGoalForbidden;
    command_.waypoint[i].position_m = position_odom;
  }
  const bool is_relative = command_.heading_frame == control::GoalFrame::kBody;
  // While it drives, the path to the goal before is followed until there is one to this.
  if (mode == Mode::kArmed) DropGoals();
  goals_.Clear();
  goal_index_ = 0;
  on_mission_ = true;
  may_resume_ = true;
  paused_ = false;
  ++goals_list_;
  BeginLeg();
  HP_LOOP_BOUND(control::kMaxWaypoints)
  for (int i = 0; i < command_.waypoints; ++i) {
    Goal goal;
    goal.position_odom = command_.waypoint[i].position_m;
    goal.is_on_earth = command_.waypoint[i].frame == control::GoalFrame::kGeodetic;
    goal.latitude_ndeg = command_.waypoint[i].latitude_ndeg;
    goal.longitude_ndeg = command_.waypoint[i].longitude_ndeg;
    goal.has_heading = command_.has_heading && i + 1 == command_.waypoints;
    goal.heading_rad = WrapAngle(is_relative ? odometry_.pose().yaw_rad + command_.heading_rad
                                             : command_.heading_rad);
    goal.stops = command_.waypoint[i].stops;
    goal.hold_s = command_.waypoint[i].hold_s;
    goal.speed_mps = kSpeedUnit_mps * static_cast<float>(command_.waypoint[i].speed_dmps);
    static_cast<void>(goals_.PushBack(goal));
  }
  return Status::kOk;
}

// kStale: no position and heading of the INS that it vouches for, or that were believed.
Status Pilot::InOdom(const control::Waypoint& waypoint, Vec2& position_odom) const {
  const StampedPose& pose = odometry_.pose();
  Vec2 place = waypoint.position_m;
  if (waypoint.frame == control::GoalFrame::kGeodetic) {
    if (map_from_odom_.status() != MapStatus::kTracking) return Status::kStale;
    const Status status =
        map_from_odom_.ToOdom(waypoint.latitude_ndeg, waypoint.longitude_ndeg, place);
    if (!IsUsable(status)) return status;
  }
  if (!IsFinite(place)) return Status::kNotFinite;
  if (waypoint.frame == control::GoalFrame::kBody) {
    const SinCosPair turn = SinCos(pose.yaw_rad);
    place = {pose.position.x_m + turn.cos * place.x_m - turn.sin * place.y_m,
             pose.position.y_m + turn.sin * place.x_m + turn.cos * place.y_m};
  }
  const bool is_near = Abs(place.x_m - pose.position.x_m) <= kMaxGoal_m &&
                       Abs(place.y_m - pose.position.y_m) <= kMaxGoal_m;
  if (!is_near) return Status::kInvalidArgument;
  position_odom = place;
  return Status::kOk;
}

// Whether the path leads to this goal, or as near as anything can, and has been driven to its end.
bool Pilot::IsAtEndFor(const Goal& goal) const {
  if (!HasPlan() || tracking_output_.speed_mps > kArrivedSpeed_mps) return false;
  const CommittedPlan& plan = replanner_.committed();
  const bool same_heading =
      plan.goal.has_heading == goal.has_heading &&
      (!goal.has_heading ||
       Abs(WrapAngle(plan.goal.heading_rad - goal.heading_rad)) <= kTurnDone_rad);
  const float moved_m = DistanceBetween(plan.goal.position_odom, goal.position_odom);
  if (!same_heading || moved_m > config_.planner.replan.goal_change_m) return false;
  const Pose2& end = plan.path.back();
  const float beside_m = DistanceBetween({end.x_m, end.y_m}, goal.position_odom);
  // The status may have something graver to say than that the goal was moved. That the plan is kept
  // says that none ends nearer.
  const bool is_nearest =
      plan.status == Status::kGoalMoved ||
      (replanner_.outcome().decision == ReplanDecision::kKept && beside_m <= kMovedGoal_m);
  if (beside_m > Replanner::kSameEnd_m && !is_nearest) return false;
  if (LengthOf(plan.path) - replanner_.place().along_m > kArrived_m) return false;
  // A turn on the spot may be the last of it.
  const int last = plan.path.size() - 1;
  const int standing = StandingPoint(plan.path, replanner_.place().point);
  const bool turned = Abs(WrapAngle(odometry_.pose().yaw_rad - end.theta_rad)) <= kTurnDone_rad;
  return standing == last || (standing == last - 1 && turned);
}

bool Pilot::HasArrived() const {
  return on_mission_ && goal_index_ + 1 == goals_.size() && IsAtEndFor(goals_[goal_index_]);
}

}  // namespace hardpack
