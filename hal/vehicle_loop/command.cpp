// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"
#include "core/base/units.h"
#include "hal/vehicle_loop/vehicle_loop.h"

// VehicleLoop: what is done about it. Plans, follows the one that is committed as far as the
// supervisor lets it, and tells the drives.

namespace hardpack {

// Where this tick's command takes effect, with what was commanded until now.
VehicleState VehicleLoop::PredictedState() const {
  const StampedPose& pose = odometry_.pose();
  VehicleState state;
  state.pose = {pose.position.x_m, pose.position.y_m, pose.yaw_rad};
  state.speed_mps = tracker_.speed_mps();
  state.curvature_per_m = tracker_.curvature_per_m();
  const float ahead_s = config_.onboard.tracking.prediction_s;
  if (state.speed_mps > 0.0f) return PredictAhead(state, ahead_s);
  state.pose.theta_rad =
      WrapAngle(state.pose.theta_rad + tracking_output_.yaw_rate_radps * ahead_s);
  return state;
}

bool VehicleLoop::HasPlan() const {
  const CommittedPlan& plan = replanner_.committed();
  const ReplanDecision decision = replanner_.outcome().decision;
  return !goals_.empty() && is_located_ && plan.number != 0 && !plan.is_stop &&
         decision != ReplanDecision::kNone && decision != ReplanDecision::kStop &&
         IsUsable(replanner_.outcome().status);
}

SupervisorInput VehicleLoop::Situation(const TickInput& input) const {
  SupervisorInput situation;
  situation.now_ns = now_ns_;
  situation.lidar_ns = lidar_ns_;
  // Of the wheel speeds themselves, since a tick may have used old ones; seen from the tick before,
  // as the drives are when nothing comes from them: their silence is told rather than its effect.
  const uint64_t wheels_ns = drives_.feedback(now_ns_).time_ns + now_ns_ - before_ns_;
  situation.odometry_ns = odometry_.moved_ns();
  if (wheels_ns < situation.odometry_ns) situation.odometry_ns = wheels_ns;
  if (is_gap_) situation.odometry_ns = 0;
  situation.ins_ns = ins_ns_;
  situation.operator_ns = operator_ns_;
  situation.plan_checked_ns = replanner_.committed().checked_ns;
  situation.bus_active = input.bus == CanBusState::kActive || input.bus == CanBusState::kWarning ||
                         input.bus == CanBusState::kPassive;
  situation.drives_ready = drives_.ready();
  situation.drives_enabled = drives_.enabled();
  situation.drives_faulty = !IsUsable(drives_.health()) && !drives_.ready();
  situation.foreign_sender = drives_.foreign_sender();
  situation.at_rest = drives_.standstill();
  situation.has_goal = !goals_.empty();
  situation.has_plan = HasPlan();
  situation.has_path = replanner_.committed().number != 0;
  situation.arrived = HasArrived();
  situation.ahead = Ahead();
  situation.ahead_is_person = corridor_.is_person();
  situation.held_by = situation.arrived ? StopReason::kNone : HeldBy();
  situation.misbehaves = Misbehaves();
  situation.wishes = wishes_;
  return situation;
}

// The state that the next plan is made from.
void VehicleLoop::UpdatePlanner() {
  if (goals_.empty()) return;
  const Goal& goal = goals_[goal_index_];
  const PlanGoal wanted = {.position_odom = goal.position_odom,
                           .has_heading = goal.has_heading,
                           .heading_rad = goal.heading_rad};
  VehicleState state = PredictedState();
  state.reaction_s = ReactionTime();
  is_located_ = IsUsable(replanner_.Update(now_ns_, state, wanted));
  if (!is_located_) ++counters_.refused_states;
}

// What the path says here and ahead. A turn on the spot is made once the vehicle stands at it.
TrackingInput VehicleLoop::Target() const {
  const CommittedPlan& plan = replanner_.committed();
  const PathPlace& place = replanner_.place();
  const float along_m = place.along_m;
  TrackingInput target;
  target.pose = PredictedState().pose;
  target.speed_limit_mps = StateAt(plan, along_m + kStartWay_m).speed_mps;
  const int standing = StandingPoint(plan.path, place.point);
  const float left_m = WayTo(plan.path, standing) - along_m;
  const bool stands = tracker_.speed_mps() <= Replanner::kStanding_mps &&
                      Abs(odometry_.speed_mps()) <= kStandsSpeed_mps;
  if (TurnsOnTheSpotAt(plan.path, standing) && left_m <= kAtPoint_m && stands) {
    target.turn = true;
    target.aim.pose = plan.path[standing + 1];
    return target;
  }
  if (left_m <= kStartWay_m) target.speed_limit_mps = 0.0f;
  const TrackingParams& params = config_.onboard.tracking;
  const float reach_m = Max(params.min_lookahead_m, tracker_.speed_mps() * params.lookahead_s);
  target.aim.pose = StateAt(plan, along_m + Min(reach_m, left_m)).pose;
  // Beyond the end the path goes on straight, or the last stretch would be aimed at a point beside
  // the vehicle.
  const SinCosPair heading = SinCos(plan.path[standing].theta_rad);
  const float beyond_m = Max(reach_m - left_m, 0.0f);
  target.aim.pose.x_m += beyond_m * heading.cos;
  target.aim.pose.y_m += beyond_m * heading.sin;
  return target;
}

// The wheels' commands of this tick. A path that cannot be followed is not.
void VehicleLoop::Move() {
  const bool follows = permission_.motion == Motion::kFollow;
  const bool has_path = replanner_.committed().path.size() >= 2;
  if ((!follows && permission_.motion != Motion::kStopAlong) || !has_path) {
    tracker_.Zero(tracking_output_);
    return;
  }
  const TrackingInput target = Target();
  const Status status = follows ? tracker_.Follow(target, tick_s_, tracking_output_)
                                : tracker_.StopAlong(target, tick_s_, tracking_output_);
  if (!IsUsable(status)) tracker_.Zero(tracking_output_);
}

void VehicleLoop::Command(TickOutput& output) {
  sevcon::DriveDemand demand;
  demand.reset_faults = permission_.reset_faults;  // the tick before they are enabled
  demand.enable = permission_.motion != Motion::kOff && !demand.reset_faults;
  demand.wheels = PassGate();
  drives_.Tick(now_ns_, demand, output.frames);
}

// A fixed number of units, never measured time: so a replay repeats. A safe stop keeps the path
// that it has.
void VehicleLoop::StepPlanner() {
  if (goals_.empty() || permission_.mode == Mode::kSafeStop) return;
  const bool was_busy = replanner_.busy();
  const bool is_judged =
      replanner_.Step(mapper_, config_.onboard.tick.planning_units) == Progress::kDone;
  NoteRound(was_busy, is_judged);
  if (!is_judged) return;
  ++counters_.plans;
  hardpack::AddToHash(replanner_, hash_);
}

}  // namespace hardpack
