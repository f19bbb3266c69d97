// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/replanner.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {

// Nothing can be driven: neither a new plan, nor a stretch to come to rest on.
void Replanner::DropAll() {
  committed_.number = 0;
  committed_.path.Clear();
  committed_.actuator.steps.Clear();
  committed_.speed.Clear();
  round_.decision = candidate_.decision;
  round_.status = StopStatus();
  EndRound();
}

Status Replanner::StopStatus() const {
  if (!rest_.empty() && !RestIsFree()) return Status::kCollision;
  if (!IsUsable(fresh_.status)) return fresh_.status;
  return late_ ? Status::kLate : Status::kPathTooShort;
}

// Whether the vehicle is already behind the point where the candidate leaves the committed path.
bool Replanner::HasPassedJoint() const {
  if (candidate_.joint < 0) return false;
  return place_.along_m > WayTo(committed_.path, dropped_ + candidate_.joint);
}

// With the state of this moment, in one unit: so that neither place nor speed has moved on.
void Replanner::Publish() {
  if (HasPassedJoint()) {
    // It is not chosen again, so this happens twice at most.
    if (candidate_.decision == ReplanDecision::kReplaced) {
      late_ = true;
    } else {
      extension_point_ = -1;
    }
    return Decide();
  }
  Commit(Project(candidate_.path, state_.pose, Stands(), ReachOfRound()));
  EndRound();
  place_ = PathPlace{};
  Locate(0.0f);
}

void Replanner::Commit(const PathPlace& place) {
  const WorldPath& path = candidate_.path;
  CommittedPlan& plan = committed_;
  const int first = FirstKept(path, place.point);
  plan.start_curvature_per_m = CurvatureAt(path, first, candidate_.start_curvature_per_m);
  plan.start_turn_rad = TurnAt(path, first, candidate_.start_turn_rad);
  plan.path.Clear();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = first; k < path.size(); ++k) {
    plan.path.Resize(plan.path.size() + 1);
    plan.path.back() = path[k];
  }
  if (TurnsOnTheSpotAt(plan.path, 0)) plan.path[0].theta_rad = state_.pose.theta_rad;
  const int slow_points = candidate_.slow_points - first;
  plan.slow_points = slow_points < 0 ? 0 : slow_points;
  const int lead_points = candidate_.lead_points - first;
  plan.lead_points = lead_points < 0 ? 0 : lead_points;
  plan.room_m.Clear();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = first; k < path.size(); ++k) {
    plan.room_m.Resize(plan.room_m.size() + 1);
    plan.room_m.back() = caps_.room_m(k);
  }
  plan.ground = candidate_.ground;
  plan.narrow = caps_.narrow();
  plan.status = candidate_.status == Status::kNarrowGap ? Status::kOk : candidate_.status;
  if (plan.narrow) plan.status = Graver(plan.status, Status::kNarrowGap);
  plan.is_stop = candidate_.decision == ReplanDecision::kStop;
  if (candidate_.decision != ReplanDecision::kKept) {
    plan.number = ++last_number_;
    if (!plan.is_stop) plan.goal = candidate_.goal;
  }
  const Pose2& end = plan.path.back();
  const float dx_m = end.x_m - plan.goal.position_odom.x_m;
  const float dy_m = end.y_m - plan.goal.position_odom.y_m;
  plan.reaches_goal = !plan.is_stop && dx_m * dx_m + dy_m * dy_m <= kSameEnd_m * kSameEnd_m;
  plan.checked_ns = begun_ns_;
  const int next = place.point + 1;
  plan.creeps = caps_.cause(next) == CapCause::kHiddenGround;
  caps_.StandFrom(next);
  const Status timed = TimeFrom(place);
  round_.decision = candidate_.decision;
  round_.reason = candidate_.reason;
  const float cap_mps = caps_.cap_mps()[static_cast<size_t>(next)];
  round_.held_by = caps_.cause(next);
  // Faster beside a person than the ramp can mend: it stands sooner than that brings it down.
  const bool is_too_fast = round_.held_by == CapCause::kPerson && IsUsable(timed) &&
                           plan.speed[next - first] > cap_mps + kTooFast_mps;
  round_.held = is_too_fast || (cap_mps <= kStanding_mps && round_.held_by != CapCause::kPathEnd);
  round_.status = plan.is_stop ? StopStatus() : (IsUsable(timed) ? plan.status : timed);
}

// Of the rate of curvature, by how slowly the vehicle turns and how much room it has for that on
// what is timed, whose first point is the committed path's `behind`.
float Replanner::TurnShare(int behind) const {
  float room_m = kRoomToTurnLate_m;
  float way_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 0; k < timed_.steps.size() && way_m <= kTurnsAhead_m; ++k) {
    room_m = Min(room_m, committed_.room_m[behind + k]);
    way_m += Abs(timed_.steps[k].dr_m);
  }
  const float spared =
      Max((room_m - kNoRoomToTurnLate_m) / (kRoomToTurnLate_m - kNoRoomToTurnLate_m), 0.0f);
  const float quickness = Clamp(state_.turn_quickness, kLeastQuickness, 1.0f);
  return quickness + spared * (1.0f - quickness);
}

// Speeds from the vehicle's place on. The first chord is what is left of the one it is on, with the
// same curvature at its end: the turn there shrinks with the mean of the chords that meet. What
// lies behind the vehicle has its speed.
Status Replanner::TimeFrom(const PathPlace& place) {
  CommittedPlan& plan = committed_;
  const Status status = ToActuator<PlanarModel>(plan.path, plan.actuator);
  if (!IsUsable(status)) return status;
  const int behind = place.point - FirstKept(candidate_.path, place.point);
  timed_.start = plan.path[behind];
  timed_.steps.Clear();
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = behind; k < plan.actuator.steps.size(); ++k) {
    timed_.steps.Resize(timed_.steps.size() + 1);
    timed_.steps.back() = plan.actuator.steps[k];
  }
  SpeedRequest request;
  request.start_curvature_per_m = CurvatureAt(plan.path, behind, plan.start_curvature_per_m);
  plan.start_along_m = WayTo(plan.path, behind);
  const float driven_m = timed_.steps[0].dr_m;
  const float chord_m = Abs(driven_m);
  if (HasLength(chord_m)) {
    plan.start_along_m += place.share * chord_m;
    const float left_m = Max((1.0f - place.share) * chord_m, 2.0f * kLeastChord_m);
    const float next_m = timed_.steps.size() > 1 ? Abs(timed_.steps[1].dr_m) : chord_m;
    timed_.steps[0].dr_m = driven_m < 0.0f ? -left_m : left_m;
    timed_.steps[0].phi_rad *= MeanChord(left_m, next_m) / MeanChord(chord_m, next_m);
    const float next = CurvatureAt(plan.path, behind + 1, 0.0f);
    request.start_curvature_per_m += place.share * (next - request.start_curvature_per_m);
  }
  request.start_speed_mps = state_.speed_mps;
  request.slow_points = plan.slow_points - behind < 0 ? 0 : plan.slow_points - behind;
  request.cap_mps = caps_.cap_mps().subspan(static_cast<size_t>(place.point));
  SpeedParams speed = caps_params_;
  speed.max_curvature_rate_per_s2 *= TurnShare(behind);
  const Status timed = PlanSpeed(speed, params_.vehicle, timed_, request, plan.speed);
  if (!IsUsable(timed) || behind == 0) return timed;
  plan.speed.Resize(plan.path.size());
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = plan.path.size() - 1; k > 0; --k) plan.speed[k] = plan.speed[k - 1];
  return timed;
}

}  // namespace hardpack
