// SPDX-License-Identifier: Apache-2.0
#include "core/committed_plan/committed_plan.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

// A turn on the spot by less is none: the direction of driving changes there.
constexpr float kNoTurn_rad = 1.0e-3f;

Vec2 ChordBehind(const WorldPath& path, int point) {
  return {path[point + 1].x_m - path[point].x_m, path[point + 1].y_m - path[point].y_m};
}

// Nearer than what was best so far, or not.
void TryChord(const WorldPath& path, int point, float along_m, Vec2 position, PathPlace& best) {
  const Vec2 chord = ChordBehind(path, point);
  const float length_m = Length(chord);
  const Vec2 arm = {position.x_m - path[point].x_m, position.y_m - path[point].y_m};
  const float share =
      Clamp((arm.x_m * chord.x_m + arm.y_m * chord.y_m) / (length_m * length_m), 0.0f, 1.0f);
  const float off_m = Length({arm.x_m - share * chord.x_m, arm.y_m - share * chord.y_m});
  if (off_m < best.cross_track_m) best = {point, share, along_m + share * length_m, off_m};
}

}  // namespace

PlanGoal PlaceOfGoal(const PlanGoal& goal, int target) {
  const int vias = goal.route.vias.size();
  if (target >= vias) return goal;
  PlanGoal place;
  place.position_odom = goal.route.vias[target].position_odom;
  place.route = goal.route;
  place.route.goal_speed_mps = goal.route.vias[target].speed_mps;
  place.route.vias.Resize(target);
  place.number = goal.number - static_cast<uint32_t>(vias - target);
  place.list = goal.list;
  return place;
}

bool AreOfOneWay(const PlanGoal& earlier, const PlanGoal& later, float tolerance_m) {
  const auto vias = static_cast<uint32_t>(later.route.vias.size());
  const uint32_t first = later.number - vias;
  if (earlier.list != later.list || earlier.number < first) return false;
  const uint32_t earlier_first = earlier.number - static_cast<uint32_t>(earlier.route.vias.size());
  HP_LOOP_BOUND(kMaxVias + 1)
  for (uint32_t number = first; number <= later.number && number <= earlier.number; ++number) {
    if (number < earlier_first) continue;
    const Vec2 was = PlaceOfGoal(earlier, static_cast<int>(number - earlier_first)).position_odom;
    const Vec2 is = PlaceOfGoal(later, static_cast<int>(number - first)).position_odom;
    if (!AreWithin(was, is, tolerance_m)) return false;
  }
  return true;
}

bool TurnsOnTheSpotAt(const WorldPath& path, int point) {
  return point + 1 < path.size() && !HasLength(Length(ChordBehind(path, point)));
}

int StandingPoint(const WorldPath& path, int point) {
  int standing = point;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (standing + 1 < path.size() && !TurnsOnTheSpotAt(path, standing)) ++standing;
  return standing;
}

int RestPoint(const CommittedPlan& plan, int point, int last) {
  float along_m = WayTo(plan.path, point);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (int rest = point + 1; rest < last; ++rest) {
    along_m += Length(ChordBehind(plan.path, rest - 1));
    if (plan.speed[rest] <= 0.0f && along_m > plan.start_along_m) return rest;
  }
  return last;
}

int FirstKept(const WorldPath& path, int point) {
  const bool has_before = point > 0 && !TurnsOnTheSpotAt(path, point);
  return has_before && !TurnsOnTheSpotAt(path, point - 1) ? point - 1 : point;
}

float WayTo(const WorldPath& path, int point) {
  float way_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 0; k < point; ++k) way_m += Length(ChordBehind(path, k));
  return way_m;
}

float TurnAt(const WorldPath& path, int point, float at_start_rad) {
  if (point <= 0) return at_start_rad;
  if (point + 1 >= path.size()) return 0.0f;
  const Vec2 before = ChordBehind(path, point - 1);
  const Vec2 behind = ChordBehind(path, point);
  if (!HasLength(Length(before)) || !HasLength(Length(behind))) return 0.0f;
  return PlanarModel::TurnBetween(before, behind);
}

float CurvatureAt(const WorldPath& path, int point, float at_start_per_m) {
  if (point <= 0) return at_start_per_m;
  if (point + 1 >= path.size()) return 0.0f;
  return CurvatureBetween(TurnAt(path, point, 0.0f), Length(ChordBehind(path, point - 1)),
                          Length(ChordBehind(path, point)));
}

PathPlace Project(const WorldPath& path, const Pose2& pose, bool stands, float search_m) {
  const auto turned = [&](int point) {
    const float next_rad = path[point + 1].theta_rad;
    return Abs(WrapAngle(pose.theta_rad - next_rad)) <= kTurnDone_rad ||
           Abs(WrapAngle(path[point].theta_rad - next_rad)) <= kNoTurn_rad;
  };
  const Vec2 position = {pose.x_m, pose.y_m};
  // A turn at the very end stays: nothing is behind it.
  const int last = path.size() - 2;
  const bool begins_behind_turn = TurnsOnTheSpotAt(path, 0) && last > 0 && turned(0);
  int point = begins_behind_turn ? 1 : 0;
  PathPlace best = {point, 0.0f, 0.0f,
                    Length({position.x_m - path[point].x_m, position.y_m - path[point].y_m})};
  float along_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (; point <= last && along_m <= search_m; ++point) {
    if (TurnsOnTheSpotAt(path, point)) break;
    TryChord(path, point, along_m, position, best);
    along_m += Length(ChordBehind(path, point));
  }
  const bool at_turn = point <= last && point > best.point && TurnsOnTheSpotAt(path, point) &&
                       along_m - best.along_m <= kAtPoint_m;
  if (!at_turn || !stands) return best;
  const int behind = turned(point) && point < last ? point + 1 : point;
  return {behind, 0.0f, along_m, best.cross_track_m};
}

PathState StateAt(const CommittedPlan& plan, float along_m) {
  PathState state;
  const WorldPath& path = plan.path;
  if (path.size() < 2) return state;
  int point = 0;
  float before_m = 0.0f;
  float length_m = Length(ChordBehind(path, 0));
  HP_LOOP_BOUND(kMaxPathPoints)
  while (point + 2 < path.size() && before_m + length_m <= along_m) {
    before_m += length_m;
    ++point;
    length_m = Length(ChordBehind(path, point));
  }
  const bool has_length = HasLength(length_m);
  const float share = has_length ? Clamp((along_m - before_m) / length_m, 0.0f, 1.0f) : 0.0f;
  const Vec2 chord = ChordBehind(path, point);
  const float turn_rad = TurnAt(path, point, plan.start_turn_rad);
  const float next_turn_rad = TurnAt(path, point + 1, 0.0f);
  const float bend_rad = share < 0.5f ? -(0.5f - share) * turn_rad : (share - 0.5f) * next_turn_rad;
  const float chord_rad = has_length ? HeadingOf(chord) : path[point].theta_rad;
  state.reverse = Abs(WrapAngle(path[point].theta_rad - chord_rad)) > 0.5f * kPi;
  const float heading_rad = state.reverse ? chord_rad + kPi : chord_rad;
  state.pose = {path[point].x_m + share * chord.x_m, path[point].y_m + share * chord.y_m,
                WrapAngle(heading_rad + bend_rad)};
  const float curvature = CurvatureAt(path, point, plan.start_curvature_per_m);
  const float next_curvature = CurvatureAt(path, point + 1, 0.0f);
  const float bend_per_m = curvature + share * (next_curvature - curvature);
  state.curvature_per_m = state.reverse ? -bend_per_m : bend_per_m;

  // The first speed holds where the vehicle was, not at the first point.
  const float from =
      has_length ? Clamp((plan.start_along_m - before_m) / length_m, 0.0f, 1.0f) : 0.0f;
  const float speed_share = share > from && from < 1.0f ? (share - from) / (1.0f - from) : 0.0f;
  const float speed2 = plan.speed[point] * plan.speed[point];
  const float next2 = plan.speed[point + 1] * plan.speed[point + 1];
  state.speed_mps = Sqrt(speed2 + speed_share * (next2 - speed2));
  return state;
}

void CurvaturesFrom(const CommittedPlan& plan, float along_m, float step_m,
                    std::span<float> curvature_per_m) {
  const WorldPath& path = plan.path;
  const int last = path.size() - 2;
  int point = 0;
  float before_m = 0.0f;
  float length_m = last >= 0 ? Length(ChordBehind(path, 0)) : 0.0f;
  float wanted_m = along_m;
  bool is_reversed = false;
  bool has_begun = false;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (float& curvature : curvature_per_m) curvature = 0.0f;
  HP_LOOP_BOUND_INNER(kMaxPathPoints, kMaxPathPoints)
  for (float& curvature : curvature_per_m) {
    HP_LOOP_BOUND(kMaxPathPoints)
    while (point < last && before_m + length_m <= wanted_m) {
      before_m += length_m;
      ++point;
      length_m = Length(ChordBehind(path, point));
      if (!HasLength(length_m)) return;  // it stands there
    }
    if (last >= 0 && HasLength(length_m) && wanted_m <= before_m + length_m) {
      const float share = Clamp((wanted_m - before_m) / length_m, 0.0f, 1.0f);
      const float from = CurvatureAt(path, point, plan.start_curvature_per_m);
      const float bend_per_m = from + share * (CurvatureAt(path, point + 1, 0.0f) - from);
      if (!has_begun) is_reversed = IsReversed(path, point);
      has_begun = true;
      curvature = is_reversed ? -bend_per_m : bend_per_m;
    }
    wanted_m += step_m;
  }
}

}  // namespace hardpack
