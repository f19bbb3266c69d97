// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/wide_int.h"
#include "hal/control/messages.h"
#include "hal/vehicle_loop/vehicle_loop.h"

// VehicleLoop: what the operator wants.

namespace hardpack {
namespace {

constexpr float kDegreesPerNanodegree = 1.0e-9f;
// A goal further away than this is a mistake.
constexpr float kMaxGoal_m = 20000.0f;
// And a position of the INS older than this is none.
constexpr float kMaxPositionAge_s = 1.0f;

// Lengths of a degree of latitude and of longitude on the WGS 84 ellipsoid: the usual series in the
// latitude (REFERENCES.md), good to a centimetre.
float MetersNorth(float latitude_rad) {
  return 111132.92f - 559.82f * Cos(2.0f * latitude_rad) + 1.175f * Cos(4.0f * latitude_rad);
}
float MetersEast(float latitude_rad) {
  return 111412.84f * Cos(latitude_rad) - 93.5f * Cos(3.0f * latitude_rad) +
         0.118f * Cos(5.0f * latitude_rad);
}

float Degrees(int64_t from_ndeg, int64_t to_ndeg) {
  const int64_t difference = to_ndeg - from_ndeg;
  const auto magnitude = static_cast<uint64_t>(difference < 0 ? -difference : difference);
  const float degrees = ToFloat(magnitude) * kDegreesPerNanodegree;
  return difference < 0 ? -degrees : degrees;
}

float DistanceBetween(Vec2 a, Vec2 b) {
  const float dx_m = a.x_m - b.x_m;
  const float dy_m = a.y_m - b.y_m;
  return Sqrt(dx_m * dx_m + dy_m * dy_m);
}

}  // namespace

void VehicleLoop::TakeCommand(std::span<const uint8_t> bytes, TickOutput& output) {
  if (bytes.empty()) return;
  ++counters_.commands;
  control::Header header;
  Status decoded = control::ReadHeader(bytes, header);
  if (IsUsable(decoded)) decoded = control::Decode(bytes, command_);
  output.has_answer = true;
  output.sequence = header.sequence;
  output.answer = decoded;
  output.reason = StopReason::kNone;
  if (!IsUsable(decoded)) {
    ++counters_.refused_commands;
    return;
  }
  operator_ns_ = now_ns_;
  wishes_.arm = command_.kind == control::Kind::kArm;
  wishes_.disarm = command_.kind == control::Kind::kDisarm;
  wishes_.stop = command_.kind == control::Kind::kStop;
  wishes_.emergency_stop = command_.kind == control::Kind::kEmergencyStop;
  wishes_.go = command_.kind == control::Kind::kGoal;
  if (wishes_.go) output.answer = TakeGoals();
  if (!IsUsable(output.answer)) {
    wishes_.go = false;
    ++counters_.refused_commands;
  }
}

// Only where they will be driven to: what is refused changes nothing.
Status VehicleLoop::TakeGoals() {
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
    command_.waypoint[i].frame = control::GoalFrame::kOdom;
    command_.waypoint[i].position_m = position_odom;
  }
  const bool is_relative = command_.heading_frame == control::GoalFrame::kBody;
  // While it drives, the path to the goal before is followed until there is one to this.
  if (mode == Mode::kArmed) DropGoals();
  goals_.Clear();
  goal_index_ = 0;
  HP_LOOP_BOUND(control::kMaxWaypoints)
  for (int i = 0; i < command_.waypoints; ++i) {
    Goal goal;
    goal.position_odom = command_.waypoint[i].position_m;
    goal.has_heading = command_.has_heading && i + 1 == command_.waypoints;
    goal.heading_rad = WrapAngle(is_relative ? odometry_.pose().yaw_rad + command_.heading_rad
                                             : command_.heading_rad);
    static_cast<void>(goals_.PushBack(goal));
  }
  return Status::kOk;
}

// kStale: no position and heading of the INS that it vouches for.
Status VehicleLoop::InOdom(const control::Waypoint& waypoint, Vec2& position_odom) const {
  const StampedPose& pose = odometry_.pose();
  Vec2 ahead = waypoint.position_m;
  float turn_rad = 0.0f;
  bool is_relative = waypoint.frame == control::GoalFrame::kBody;
  if (is_relative) turn_rad = pose.yaw_rad;
  if (waypoint.frame == control::GoalFrame::kGeodetic) {
    const bool is_good = newest_ins_.has_position && newest_ins_.has_attitude &&
                         newest_ins_.has_status && newest_ins_.status.mode == InsMode::kTracking &&
                         SecondsBetween(ins_ns_, now_ns_) <= kMaxPositionAge_s;
    if (!is_good) return Status::kStale;
    const float latitude_rad = Degrees(0, newest_ins_.latitude_ndeg) * kRadPerDeg;
    ahead = {
        Degrees(newest_ins_.longitude_ndeg, waypoint.longitude_ndeg) * MetersEast(latitude_rad),
        Degrees(newest_ins_.latitude_ndeg, waypoint.latitude_ndeg) * MetersNorth(latitude_rad)};
    // From east and north into odom: by how much the body's heading differs between the two.
    const float heading_enu_rad = kHalfPi - newest_ins_.yaw_rad - config_.onboard.ins.yaw_rad;
    turn_rad = WrapAngle(pose.yaw_rad - heading_enu_rad);
    is_relative = true;
  }
  if (!IsFinite(ahead.x_m) || !IsFinite(ahead.y_m)) return Status::kNotFinite;
  const SinCosPair turn = SinCos(turn_rad);
  position_odom = {turn.cos * ahead.x_m - turn.sin * ahead.y_m,
                   turn.sin * ahead.x_m + turn.cos * ahead.y_m};
  if (is_relative) {
    position_odom.x_m += pose.position.x_m;
    position_odom.y_m += pose.position.y_m;
  }
  const bool is_near = Abs(position_odom.x_m - pose.position.x_m) <= kMaxGoal_m &&
                       Abs(position_odom.y_m - pose.position.y_m) <= kMaxGoal_m;
  return is_near ? Status::kOk : Status::kInvalidArgument;
}

void VehicleLoop::DropGoals() {
  if (!goals_.empty()) replanner_.Forget();
  goals_.Clear();
  goal_index_ = 0;
}

// On to the next waypoint where this one is near enough, or as near as it can be; the last one is
// to be stopped at.
void VehicleLoop::AdvanceGoal() {
  if (goal_index_ + 1 >= goals_.size()) return;
  const Vec2& goal = goals_[goal_index_].position_odom;
  const float dx_m = goal.x_m - odometry_.pose().position.x_m;
  const float dy_m = goal.y_m - odometry_.pose().position.y_m;
  if (dx_m * dx_m + dy_m * dy_m <= kWaypointReached_m * kWaypointReached_m ||
      (IsAtEndFor(goals_[goal_index_]) && drives_.standstill())) {
    ++goal_index_;
  }
}

// Whether the path leads to this goal, or as near as anything can, and has been driven to its end.
bool VehicleLoop::IsAtEndFor(const Goal& goal) const {
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

bool VehicleLoop::HasArrived() const {
  return goal_index_ + 1 == goals_.size() && IsAtEndFor(goals_[goal_index_]);
}

}  // namespace hardpack
