// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/replanner.h"
#include "core/base/footprint.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/wide_int.h"

namespace hardpack {
namespace {

// Headings of goals that differ by less are the same.
constexpr float kGoalTurn_rad = 0.1f;
// The largest value of SpeedParams::reaction_time_s.
constexpr float kMaxReaction_s = 5.0f;

float Distance(Vec2 a, Vec2 b) {
  return Length(Minus(a, b));
}

bool AreSame(Vec2 a, Vec2 b) {
  return Distance(a, b) <= Replanner::kSameEnd_m;
}

}  // namespace

// Whether the committed path, which leads to one of the places of the goal's way, passes those
// before it.
bool Replanner::PassesVias() const {
  const PlanGoal& goal = round_goal_;
  const auto vias = static_cast<uint32_t>(goal.route.vias.size());
  const uint32_t places = committed_.goal.number - (goal.number - vias);
  const int before = places < vias ? static_cast<int>(places) : goal.route.vias.size();
  const int last = committed_.path.size() - 1;
  return ViasPassed(committed_.path, goal.route, PassReach_m(), last) >= before;
}

bool Replanner::GoalHasChanged() const {
  const PlanGoal& old = committed_.goal;
  if (!old.route.vias.empty() || !round_goal_.route.vias.empty()) {
    if (!AreOfOneWay(old, round_goal_, params_.replan.goal_change_m)) return true;
    if (!PassesVias()) return true;
    if (old.number != round_goal_.number) return false;
  }
  if (Distance(old.position_odom, round_goal_.position_odom) > params_.replan.goal_change_m) {
    return true;
  }
  if (old.has_heading != round_goal_.has_heading) return true;
  return old.has_heading &&
         Abs(WrapAngle(old.heading_rad - round_goal_.heading_rad)) > kGoalTurn_rad;
}

// The anchor as a point of rest_. The vehicle may have passed it: then nothing joins there, and
// costs are taken from where it is.
int Replanner::AnchorOfRest() const {
  return anchored_ && anchor_ > dropped_ ? anchor_ - dropped_ : 0;
}

// Whether the new plan ends nearer to the goal by so much that the committed path has to be carried
// on: where the new one was cut, by how much longer it is than what is left.
bool Replanner::EndCouldBeNearer(int anchor) const {
  if (!IsUsable(fresh_.status)) return false;
  const Vec2 end = PlaceOf(rest_.back());
  const Vec2 fresh_end = PlaceOf(fresh_.path.back());
  const float left_m = WayTo(rest_, rest_.size() - 1) - WayTo(rest_, anchor);
  const bool has_vias = !round_goal_.route.vias.empty() || !committed_.goal.route.vias.empty();
  if (has_vias && fresh_.goal.number != committed_.goal.number) {
    return fresh_.goal.number > committed_.goal.number;
  }
  const Vec2 goal = fresh_.goal.position_odom;
  const float nearer_m = Distance(end, goal) - Distance(fresh_end, goal);
  // An end at the goal itself is worth having at once. Of two ends that both lie beside it the
  // committed one is rather good enough, and a window that moves on is followed in stretches.
  const bool reaches_goal = Distance(fresh_end, goal) <= kSameEnd_m;
  const float beside_m = left_m < kTail_m ? kNearerEnd_m : params_.replan.extend_m;
  if (nearer_m > (reaches_goal ? kSameEnd_m : beside_m)) return true;
  const bool is_cut = !AreSame(fresh_end, fresh_.end_odom);
  return is_cut && !AreSame(end, fresh_.end_odom) &&
         LengthOf(fresh_.path) > left_m + params_.replan.extend_m;
}

// B, or -1. Says in ends_short_ whether the committed path leads too little far.
int Replanner::ExtensionPoint() {
  if (left_path_ || committed_.is_stop || GoalHasChanged()) return -1;
  const int anchor = AnchorOfRest();
  const float anchor_m = WayTo(rest_, anchor);
  float last_m = 0.0f;
  if (RestIsFree()) {
    ends_short_ = EndCouldBeNearer(anchor);
    if (!ends_short_) return -1;
    last_m = WayTo(rest_, rest_.size() - 1) - kTail_m;
  } else {
    if (free_until_ <= anchor) return -1;
    const float free_m = WayTo(rest_, free_until_) - anchor_m;
    if (free_m <= kFarBlock_m) return -1;
    last_m = anchor_m + 0.5f * free_m;
  }
  int point = -1;
  float along_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < rest_.size() && along_m <= last_m; ++k) {
    // A turn on the spot is left out of it: a path ends before one or leads on behind it.
    if (k > anchor && !TurnsOnTheSpotAt(rest_, k) && !IsReversed(rest_, k)) point = k;
    if (k + 1 < rest_.size()) along_m += Distance(PlaceOf(rest_[k]), PlaceOf(rest_[k + 1]));
  }
  return point;
}

bool Replanner::ExtensionIsUsable() const {
  return extension_point_ >= 0 && IsUsable(planner_.result().status);
}

bool Replanner::FreshIsUsable() const {
  if (!IsUsable(fresh_.status)) return false;
  if (!anchored_) return !backed_up_;
  return !late_ && free_until_ >= AnchorOfRest();
}

// Whether the new plan is nowhere farther from the candidate than the vehicle is wide: both are
// free of obstacles over that width, so no obstacle is between them.
bool Replanner::IsSameWay() const {
  const WorldPath& path = candidate_.path;
  const WorldPath& fresh = fresh_.path;
  float largest_m = 0.0f;
  int nearest = 0;
  int point = 0;
  // Each time one of the two goes on.
  HP_LOOP_BOUND(2 * kMaxPathPoints)
  while (point < fresh.size()) {
    const Vec2 place = PlaceOf(fresh[point]);
    const float off_m = Distance(place, PlaceOf(path[nearest]));
    const int next = nearest + 1 < path.size() ? nearest + 1 : nearest;
    const bool is_nearer = next > nearest && Distance(place, PlaceOf(path[next])) <= off_m;
    if (!is_nearer) largest_m = Max(largest_m, off_m);
    nearest = is_nearer ? next : nearest;
    point = is_nearer ? point : point + 1;
  }
  return largest_m < params_.vehicle.width_m;
}

// Both from the anchor on; see the header, 5.
void Replanner::CompareCosts() {
  is_cheaper_ = false;
  round_.committed_cost = 0.0f;
  round_.new_cost = 0.0f;
  if (rest_.empty() || left_path_ || committed_.is_stop || GoalHasChanged()) return;
  if (!FreshIsUsable() || !(RestIsFree() || ExtensionIsUsable())) return;
  const Plan& extension = planner_.result();
  const int anchor = AnchorOfRest();
  const int last = ExtensionIsUsable() ? extension_point_ : rest_.size() - 1;
  const Costmap& map = planner_.costmap();
  const OptimizerParams costs = AtPreferredRate(params_.optimizer);
  const float kappa = request_.start.curvature_per_m;
  Join(anchor, last, ExtensionIsUsable() ? &extension.path : nullptr);
  const bool common_end = AreSame(PlaceOf(candidate_.path.back()), PlaceOf(fresh_.path.back()));
  if (common_end) {
    round_.committed_cost = CostOf(map, costs, candidate_.path, kappa).total();
    round_.new_cost = CostOf(map, costs, fresh_.path, kappa).total();
  } else {
    const bool common_search = ExtensionIsUsable()
                                   ? extension.search.end == fresh_.search_end
                                   : AreSame(PlaceOf(rest_.back()), fresh_.end_odom);
    if (!common_search) return;
    Join(anchor, last, nullptr);
    round_.committed_cost =
        LengthOf(candidate_.path) + CostOf(map, costs, candidate_.path, kappa).map;
    if (ExtensionIsUsable()) {
      round_.committed_cost +=
          ToFloat(static_cast<uint64_t>(extension.search.cost)) / kWayCostPerMeter;
    }
    round_.new_cost = fresh_.way_cost;
  }
  float share = params_.replan.cheaper_share;
  float floor = params_.replan.cheaper_floor;
  if (common_end && RestIsFree() && IsSameWay()) {
    share = Min(share, kSameWayShare);
    floor = Min(floor, kSameWayFloor);
  }
  const float least = Max(share * round_.committed_cost, floor);
  is_cheaper_ = round_.committed_cost - round_.new_cost > least;
}

ReplanDecision Replanner::Choose(ReplanReason& reason) const {
  const bool fresh = FreshIsUsable();
  const bool has_committed = committed_.number != 0;
  if (!has_committed) {
    reason = ReplanReason::kFirst;
    return fresh ? ReplanDecision::kReplaced : ReplanDecision::kNone;
  }
  if (!left_path_ && !committed_.is_stop && !GoalHasChanged()) return ChooseOnPath(reason);
  reason = left_path_
               ? ReplanReason::kOffPath
               : (committed_.is_stop ? ReplanReason::kAfterStop : ReplanReason::kGoalChanged);
  return fresh ? ReplanDecision::kReplaced : ReplanDecision::kStop;
}

ReplanDecision Replanner::ChooseOnPath(ReplanReason& reason) const {
  const bool fresh = FreshIsUsable();
  const bool is_free = RestIsFree();
  reason = is_cheaper_ ? ReplanReason::kCheaper
                       : (is_free ? ReplanReason::kEnds : ReplanReason::kBlocked);
  if (is_cheaper_) return ReplanDecision::kReplaced;
  if (ExtensionIsUsable()) return ReplanDecision::kExtended;
  if (fresh && (!is_free || ends_short_)) return ReplanDecision::kReplaced;
  if (!is_free) return ReplanDecision::kStop;
  reason = ReplanReason::kNone;
  return ReplanDecision::kKept;
}

void Replanner::Decide() {
  CompareCosts();
  ReplanReason reason = ReplanReason::kNone;
  ReplanDecision decision = Choose(reason);
  MakeCandidate(decision, reason);
  const bool is_new =
      decision == ReplanDecision::kReplaced || decision == ReplanDecision::kExtended;
  if (is_new && !ComesToRest()) {
    const bool may_keep =
        RestIsFree() && !rest_.empty() && !left_path_ && !committed_.is_stop && !GoalHasChanged();
    decision = may_keep ? ReplanDecision::kKept
                        : (rest_.empty() ? ReplanDecision::kNone : ReplanDecision::kStop);
    MakeCandidate(decision, ReplanReason::kNone);
  }
  if (candidate_.path.size() < 2) return DropAll();
  caps_params_ = OnGround(params_.speed, candidate_.ground);
  caps_params_.reaction_time_s =
      Clamp(state_.reaction_s, params_.speed.reaction_time_s, kMaxReaction_s);
  caps_.Begin(planner_.costmap().window, caps_params_, params_.vehicle, candidate_.path,
              Abs(state_.driven_mps), state_.lookouts, has_walkers_ ? &walkers_ : nullptr,
              candidate_.ground.too_steep_m);
  phase_ = Phase::kSpeed;
}

// Points first .. last of the rest, and `tail` (which begins at the last of them) behind it, as far
// as there is room.
void Replanner::Join(int first, int last, const WorldPath* tail) {
  WorldPath& path = candidate_.path;
  path.Clear();
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = first; k <= last; ++k) {
    path.Resize(path.size() + 1);
    path.back() = rest_[k];
  }
  if (tail == nullptr) return;
  if (!path.empty()) path.Resize(path.size() - 1);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int k = 0; k < tail->size() && !path.full(); ++k) {
    path.Resize(path.size() + 1);
    path.back() = (*tail)[k];
  }
}

void Replanner::MakeCandidate(ReplanDecision decision, ReplanReason reason) {
  candidate_.decision = decision;
  candidate_.reason = reason;
  candidate_.start_curvature_per_m = rest_curvature_per_m_;
  candidate_.start_turn_rad = rest_turn_rad_;
  candidate_.joint = -1;
  candidate_.status = committed_.status;
  candidate_.goal = committed_.goal;
  const int slow_rest = committed_.slow_points - dropped_;
  const int overlap = rest_.empty() ? 0 : check_.result().overlap_points;
  candidate_.slow_points = slow_rest > overlap ? slow_rest : overlap;
  candidate_.lead_points = committed_.lead_points - dropped_;
  switch (decision) {
    case ReplanDecision::kNone:
      candidate_.path.Clear();
      break;
    case ReplanDecision::kKept:
      Join(0, rest_.size() - 1, nullptr);
      break;
    case ReplanDecision::kExtended:
      Join(0, extension_point_, &planner_.result().path);
      candidate_.joint = extension_point_;
      candidate_.status = planner_.result().status;
      candidate_.goal = PlannedGoal(passed_before_extension_);
      break;
    case ReplanDecision::kStop:
      Join(0, StopPoint(), nullptr);
      break;
    case ReplanDecision::kReplaced:
      TakeFresh();
      break;
  }
  candidate_.slow_points = ClampInt(candidate_.slow_points, 0, candidate_.path.size());
  candidate_.lead_points = ClampInt(candidate_.lead_points, 0, candidate_.path.size());
  candidate_.ground =
      LookAtGround(planner_.terrain(), planner_.costmap().window, params_.speed, candidate_.path);
}

void Replanner::TakeFresh() {
  candidate_.status = fresh_.status;
  candidate_.goal = fresh_.goal;
  if (anchored_) {
    const int anchor = AnchorOfRest();
    Join(0, anchor, &fresh_.path);
    candidate_.joint = anchor;
    if (fresh_.slow_points > 0) candidate_.slow_points = anchor + fresh_.slow_points;
    return;
  }
  candidate_.path = fresh_.path;
  candidate_.lead_points = fresh_.lead_points;
  candidate_.start_curvature_per_m = request_.start.curvature_per_m;
  candidate_.start_turn_rad = 0.0f;
  candidate_.slow_points = fresh_.slow_points;
}

// The last point that leaves room for a turn on the spot before what blocks the rest, so that it
// can be left; the last free one where there is none.
int Replanner::LastRoomyPoint() const {
  const float needed_m = PivotRadiusOf(params_.vehicle) + params_.path.pivot_margin_m -
                         LeadingEdgeOf(params_.vehicle, IsReversed(rest_, 0));
  if (RestIsFree() || free_until_ < 1) return free_until_;
  const float most_m = WayTo(rest_, free_until_) - needed_m;
  int point = 0;
  float along_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (point < free_until_) {
    along_m += Distance(PlaceOf(rest_[point]), PlaceOf(rest_[point + 1]));
    if (along_m > most_m) break;
    ++point;
  }
  return point < 1 ? free_until_ : point;
}

// The first point at which the vehicle can be at rest, within what was checked free; -1: none. A
// stop that is free stays where it is.
int Replanner::StopPoint() const {
  const int last = LastRoomyPoint();
  if (committed_.is_stop && RestIsFree()) return last;
  const float speed_mps = state_.speed_mps;
  const PathPlace place = Project(rest_, state_.pose, Stands(), ReachOfRound());
  const float brake_mps2 = OnGround(params_.speed, committed_.ground).max_deceleration_mps2;
  const float least_m = place.along_m + speed_mps * speed_mps / (2.0f * brake_mps2);
  int point = 0;
  float along_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (; point < last && (along_m < least_m || point < 1); ++point) {
    along_m += Distance(PlaceOf(rest_[point]), PlaceOf(rest_[point + 1]));
  }
  return last < 1 ? -1 : point;
}

// From the present speed, before the candidate's end or its first turn on the spot.
bool Replanner::ComesToRest() const {
  const WorldPath& path = candidate_.path;
  if (path.size() < 2) return false;
  const float speed_mps = state_.speed_mps;
  if (Stands()) return true;
  const PathPlace place = Project(path, state_.pose, Stands(), ReachOfRound());
  const float way_m = WayTo(path, StandingPoint(path, place.point)) - place.along_m;
  const float brake_mps2 = OnGround(params_.speed, candidate_.ground).max_deceleration_mps2;
  return speed_mps * speed_mps <= 2.0f * brake_mps2 * way_m;
}

}  // namespace hardpack
