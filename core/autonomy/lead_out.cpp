// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/lead_out.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/kinematics/kinematics.h"

namespace hardpack {

void LeadOut::Begin(const VehicleParams& vehicle, const PathParams& params, const Pose2& start,
                    Vec2 goal_odom, float least_m, float longest_m, int first_bend, int end_bend) {
  *this = LeadOut{};
  footprint_ = FootprintOf(vehicle);
  vehicle_ = vehicle;
  params_ = params;
  start_ = start;
  goal_odom_ = goal_odom;
  can_pivot_ = CanPivot(vehicle);
  most_curvature_per_m_ = kPlannedCurvatureShare * MostCurvature(vehicle);
  step_m_ = can_pivot_ ? kStep_m : kTurningStep_m;
  least_m_ = least_m;
  longest_m_ = can_pivot_ ? Min(longest_m, kMaxLength_m) : kMaxTurningLength_m;
  first_bend_ = first_bend;
  bend_ = first_bend;
  bends_ = end_bend;
  const float reach_m = footprint_.pivot_radius_m + kCellDiagonal_m;
  reach_cells_ = FloorToInt(Min(reach_m * kCellsPerMeter, 1.0e6f)) + 1;
  if (2 * reach_cells_ >= kMaxSide_cells) bends_ = 0;  // further than it looks
}

float LeadOut::Bend(int bend) const {
  return can_pivot_ ? kBends_per_m[bend] : kBendShares[bend] * most_curvature_per_m_;
}

// How much longer it may be than a straight way. Who has to turn on the way may bend as well.
float LeadOut::Cost_m(int bend) const {
  return can_pivot_ ? kBendCost_m2 * Abs(kBends_per_m[bend]) : 0.0f;
}

// Whether the rest of the path can be planned from there.
bool LeadOut::IsOut(const Costmap& map, const Pose2& pose) const {
  if (can_pivot_) return PivotIsFree(map, vehicle_, params_, {pose.x_m, pose.y_m});
  const Vec2 way = {goal_odom_.x_m - pose.x_m, goal_odom_.y_m - pose.y_m};
  return Abs(WrapAngle(HeadingOf(way) - pose.theta_rad)) <= kAhead_rad;
}

Pose2 LeadOut::PoseAt(int bend, float along_m) const {
  const float turn_rad = Bend(bend) * along_m;
  const float half_rad = 0.5f * turn_rad;
  const float shortened = Abs(half_rad) < 1.0e-3f ? 1.0f : Sin(half_rad) / half_rad;
  const SinCosPair chord = SinCos(WrapAngle(start_.theta_rad + half_rad));
  return {start_.x_m + along_m * shortened * chord.cos,
          start_.y_m + along_m * shortened * chord.sin, WrapAngle(start_.theta_rad + turn_rad)};
}

// How deep a point lies in the outline at a pose; negative outside.
float LeadOut::Depth(const Pose2& pose, const SinCosPair& heading, Vec2 point_odom) const {
  const float dx_m = point_odom.x_m - pose.x_m;
  const float dy_m = point_odom.y_m - pose.y_m;
  const float ahead_m = heading.cos * dx_m + heading.sin * dy_m - footprint_.middle_m();
  const float left_m = heading.cos * dy_m - heading.sin * dx_m;
  return Min(footprint_.half_length_m() - Abs(ahead_m), footprint_.half_width_m - Abs(left_m));
}

bool LeadOut::Touches(const Costmap& map, const Pose2& pose) const {
  const Cell middle = CellAt({pose.x_m, pose.y_m});
  const Cell low = {middle.x - reach_cells_, middle.y - reach_cells_};
  const Cell high = {middle.x + reach_cells_, middle.y + reach_cells_};
  if (!map.window.Contains(low) || !map.window.Contains(high)) return true;
  const SinCosPair heading = SinCos(pose.theta_rad);
  const SinCosPair start_heading = SinCos(start_.theta_rad);
  HP_LOOP_BOUND(kMaxSide_cells)
  for (int32_t y = low.y; y <= high.y; ++y) {
    const uint8_t* flags = &map.flags[map.window.Index({low.x, y})];
    Vec2 centre = CellCenter({low.x, y});
    HP_LOOP_BOUND(kMaxSide_cells)
    for (int32_t x = low.x; x <= high.x; ++x) {
      if ((flags[x - low.x] & Costmap::kHard) == 0) continue;
      centre.x_m = (static_cast<float>(x) + 0.5f) / kCellsPerMeter;
      const float before_m = Max(Depth(start_, start_heading, centre), 0.0f);
      if (Depth(pose, heading, centre) > before_m + kCellTolerance_m) return true;
    }
  }
  return false;
}

void LeadOut::EndBend() {
  ++bend_;
  pose_ = 0;
}

void LeadOut::RefuseFound() {
  if (!found()) return;
  refused_ |= 1u << static_cast<uint32_t>(best_bend_);
  best_bend_ = -1;
  bend_ = first_bend_;
  pose_ = 0;
}

Progress LeadOut::Step(const Costmap& map, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && bend_ < bends_; ++unit) {
    const bool is_refused = ((refused_ >> static_cast<uint32_t>(bend_)) & 1u) != 0;
    const float along_m = step_m_ * static_cast<float>(pose_);
    const float bend_m = Cost_m(bend_);
    const bool is_worse = found() && along_m + bend_m >= best_cost_m_;
    if (is_refused || along_m > longest_m_ || is_worse) {
      EndBend();
      continue;
    }
    const Pose2 pose = PoseAt(bend_, along_m);
    if (Touches(map, pose)) {
      EndBend();
      continue;
    }
    const bool is_far_enough = pose_ > 0 && along_m >= least_m_ - 0.5f * step_m_;
    if (is_far_enough && IsOut(map, pose)) {
      best_bend_ = bend_;
      best_m_ = along_m;
      best_cost_m_ = along_m + bend_m;
      EndBend();
      continue;
    }
    ++pose_;
  }
  return bend_ < bends_ ? Progress::kBusy : Progress::kDone;
}

// How far along its way a point of the result lies. Who turns on the way sets off by a short chord,
// which is along its heading.
float LeadOut::AlongAt(int point, int points) const {
  const float first_m = can_pivot_ ? 0.0f : Min(kFirstChord_m, 0.5f * best_m_);
  const int whole = can_pivot_ ? 0 : 1;
  if (point < whole) return 0.0f;
  const float share = static_cast<float>(point - whole) / static_cast<float>(points - whole);
  return first_m + share * (best_m_ - first_m);
}

void LeadOut::Poses(WorldPath& path) const {
  path.Clear();
  if (!found()) return;
  constexpr int kMaxPoints = kMaxPoses / kStepsPerPoint + 2;
  const float point_step_m = static_cast<float>(kStepsPerPoint) * step_m_;
  const int steps = ClampInt(FloorToInt(best_m_ / point_step_m) + 1, 1, kMaxPoints);
  const int points = can_pivot_ ? steps : steps + 1;
  HP_LOOP_BOUND(kMaxPoints + 2)
  for (int k = 0; k <= points; ++k) {
    path.Resize(path.size() + 1);
    path.back() = PoseAt(best_bend_, AlongAt(k, points));
    // A chord of an arc points where the arc does in its middle. At its ends the turns are as sharp
    // as between: its chords are not all as long, nor is the one behind it.
    if (!can_pivot_ && k < points) {
      const float middle_m = 0.5f * (AlongAt(k, points) + AlongAt(k + 1, points));
      path.back().theta_rad = PoseAt(best_bend_, middle_m).theta_rad;
    }
  }
}

}  // namespace hardpack
