// SPDX-License-Identifier: Apache-2.0
#include "core/base/math.h"
#include "core/base/units.h"
#include "hal/onboard/pilot/pilot.h"

// Pilot: what is done about it. Plans, follows the one that is committed as far as the
// supervisor lets it, and tells the drives.

namespace hardpack {

// Where this tick's command takes effect. The speed is the one that it has been told to have then.
VehicleState Pilot::PredictedState() const {
  VehicleState state;
  state.pose = tracker_.predicted().pose;
  state.speed_mps = tracker_.speed_mps();
  state.driven_mps = tracker_.predicted().speed_mps;
  state.curvature_per_m = tracker_.curvature_per_m();
  return state;
}

bool Pilot::HasPlan() const {
  const CommittedPlan& plan = replanner_.committed();
  const ReplanDecision decision = replanner_.outcome().decision;
  return on_mission_ && is_located_ && plan.number != 0 && !plan.is_stop &&
         decision != ReplanDecision::kNone && decision != ReplanDecision::kStop &&
         IsUsable(replanner_.outcome().status);
}

SupervisorInput Pilot::Situation(const DriveFeedback& drives, bool bus_is_active) const {
  SupervisorInput situation;
  situation.now_ns = now_ns_;
  situation.lidar_ns = lidar_ns_;
  const SightLook look = OldestLook();
  situation.look_ns = look.time_ns;
  situation.blind_by = BlindBy(look);
  // Of the wheel speeds themselves, since a tick may have used old ones; seen from the tick before,
  // as the drives are when nothing comes from them: their silence is told rather than its effect.
  const uint64_t wheels_ns = drives.wheels.time_ns + now_ns_ - before_ns_;
  situation.odometry_ns = odometry_.moved_ns();
  if (wheels_ns < situation.odometry_ns) situation.odometry_ns = wheels_ns;
  if (is_gap_) situation.odometry_ns = 0;
  situation.ins_ns = ins_ns_;
  situation.operator_ns = operator_ns_;
  situation.plan_checked_ns = replanner_.committed().checked_ns;
  situation.bus_active = bus_is_active;
  situation.drives_ready = drives.ready;
  situation.drives_enabled = drives.enabled;
  situation.drives_faulty = drives.faulty;
  situation.foreign_sender = drives.foreign_sender;
  situation.at_rest = drives.standstill;
  situation.has_goal = on_mission_;
  situation.has_plan = HasPlan();
  situation.has_path = replanner_.committed().number != 0;
  situation.arrived = HasArrived();
  situation.ahead = Ahead();
  situation.ahead_is_person = corridor_.is_person();
  situation.sweep = sweep_advice_;
  situation.held_by = situation.arrived ? StopReason::kNone : HeldBy();
  if (situation.held_by == StopReason::kNone) situation.held_by = HeldByMission();
  situation.misbehaves = Misbehaves();
  situation.area = area_;
  situation.ground_drops = ground_drops_;
  situation.is_tilted = is_tilted_;
  situation.wishes = wishes_;
  return situation;
}

void Pilot::Decide(std::span<const uint8_t> command, const DriveFeedback& drives,
                   bool bus_is_active, CommandAnswer& answer) {
  TakeCommand(command, drives, answer);
  FollowEarth();
  AdvanceGoal(drives);
  UpdatePlanner();
  FollowPlan();
  WatchMotion(drives.wheels);
  WatchGround();
  const StampedPose& here = odometry_.pose();
  is_tilted_ = tilt_.Judge(config_.onboard.safety, now_ns_, here.roll_rad, here.pitch_rad);
  sweep_advice_ = JudgeSweep();
  area_ = JudgeAreas();
  const SupervisorInput situation = Situation(drives, bus_is_active);
  permission_ = supervisor_.Judge(situation);
  if (permission_.drop_goal) {
    // A stop from which the vehicle may set out again without anybody touching it keeps the
    // mission.
    if (permission_.mode != Mode::kArmed || situation.arrived) may_resume_ = false;
    DropGoals();
  }
  if (!answer.has_answer || !IsUsable(answer.answer)) return;
  answer.answer = permission_.wish_status;
  answer.reason = permission_.reason;
  if (!IsUsable(answer.answer)) ++counters_.refused_commands;
}

// A person in the way is told rather than this, and stops the vehicle sooner.
StopReason Pilot::HeldByMission() const {
  if (!on_mission_) return StopReason::kNone;
  if (paused_) return StopReason::kPaused;
  return held_at_ns_ != 0 ? StopReason::kAtWaypoint : StopReason::kNone;
}

// The state that the next plan is made from.
void Pilot::UpdatePlanner() {
  if (!on_mission_) return;
  const PlanGoal wanted = WantedGoal();
  VehicleState state = PredictedState();
  state.reaction_s = ReactionTime();
  state.turn_quickness = tracker_.model().quickness();
  if (may_creep_) state.lookouts = lookouts_;
  people_.Walk(now_ns_, config_.planner.speed.person_speed_mps, walkers_);
  FillUnseenStart(state);
  is_located_ = IsUsable(replanner_.Update(now_ns_, state, wanted, &walkers_));
  if (!is_located_) ++counters_.refused_states;
}

// The wheels' commands of this tick. A path that cannot be followed is not.
void Pilot::Move() {
  const bool follows = permission_.motion == Motion::kFollow;
  const bool has_path = replanner_.committed().path.size() >= 2;
  if ((!follows && permission_.motion != Motion::kStopAlong) || !has_path) {
    tracker_.Zero(tracking_output_);
    return;
  }
  const bool stands = tracker_.speed_mps() <= Replanner::kStanding_mps &&
                      Abs(odometry_.speed_mps()) <= kStandsSpeed_mps;
  const PathFollower follower = {.pose = tracker_.predicted().pose,
                                 .place = replanner_.place(),
                                 .speed_mps = tracker_.speed_mps(),
                                 .turn_ahead_m = tracker_.TurnAhead_m(),
                                 .wheel_ahead_m = tracker_.WheelAhead_m(),
                                 .stands = stands};
  TrackingInput target;
  static_cast<void>(PathTarget(replanner_.committed(), follower, config_.onboard.tracking, target));
  target.deceleration_mps2 = speed_on_ground_.max_deceleration_mps2;
  const Status status = follows ? tracker_.Follow(target, tick_s_, tracking_output_)
                                : tracker_.StopAlong(target, tick_s_, tracking_output_);
  if (!IsUsable(status)) tracker_.Zero(tracking_output_);
}

DriveDemand Pilot::Act() {
  Move();
  DriveDemand demand;
  demand.reset_faults = permission_.reset_faults;  // the tick before they are enabled
  demand.enable = permission_.motion != Motion::kOff && !demand.reset_faults;
  demand.wheels = PassGate();
  return demand;
}

// A safe stop keeps the path that it has.
void Pilot::PlanOn() {
  if (!on_mission_ || permission_.mode == Mode::kSafeStop) return;
  const bool was_busy = replanner_.busy();
  const bool is_judged =
      replanner_.Step(mapper_, config_.onboard.tick.planning_units, &areas_) == Progress::kDone;
  NoteRound(was_busy, is_judged);
  if (!is_judged) return;
  ++counters_.plans;
  hardpack::AddToHash(replanner_, hash_);
}

}  // namespace hardpack
