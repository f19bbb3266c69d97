// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/lead_out.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/kinematics/kinematics.h"

namespace hardpack {

void LeadOut::Begin(const VehicleParams& vehicle, const PathParams& params, const Pose2& start,
                    Vec2 goal_odom, const Ways& ways) {
  *this = LeadOut{};
  footprint_ = FootprintOf(vehicle);
  vehicle_ = vehicle;
  params_ = params;
  start_ = start;
  goal_odom_ = goal_odom;
  can_pivot_ = CanPivot(vehicle);
  most_curvature_per_m_ = kPlannedCurvatureShare * MostCurvature(vehicle);
  reverse_ = ways.reverse;
  const bool is_long = reverse_ || !can_pivot_;
  step_m_ = is_long ? kLongStep_m : kStep_m;
  least_m_ = ways.least_m;
  longest_m_ = Min(ways.longest_m, is_long ? kMaxLongLength_m : kMaxLength_m);
  if (!reverse_ && !can_pivot_) longest_m_ = kMaxLongLength_m;
  first_bend_ = ways.first_bend;
  bend_ = ways.first_bend;
  bends_ = ways.end_bend;
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
  const Cell cell = CellAt(PlaceOf(pose));
  if (!map.window.Contains(cell) || map.Lethal(map.window.Index(cell))) return false;
  const Vec2 way = {goal_odom_.x_m - pose.x_m, goal_odom_.y_m - pose.y_m};
  return Abs(WrapAngle(HeadingOf(way) - pose.theta_rad)) <= kAhead_rad;
}

// The bend begins in the middle of the first chord, where the path begins to turn.
Pose2 LeadOut::PoseAt(int bend, float along_m) const {
  const float direction = reverse_ ? -1.0f : 1.0f;
  const float straight_m = direction * Min(along_m, 0.5f * kFirstChord_m);
  const float arc_m = direction * along_m - straight_m;
  const float turn_rad = Bend(bend) * arc_m;
  const float half_rad = 0.5f * turn_rad;
  const float shortened = Abs(half_rad) < 1.0e-3f ? 1.0f : Sin(half_rad) / half_rad;
  const SinCosPair heading = SinCos(start_.theta_rad);
  const SinCosPair chord = SinCos(WrapAngle(start_.theta_rad + half_rad));
  const float chord_m = arc_m * shortened;
  return {start_.x_m + straight_m * heading.cos + chord_m * chord.cos,
          start_.y_m + straight_m * heading.sin + chord_m * chord.sin,
          WrapAngle(start_.theta_rad + turn_rad)};
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

// Chord by chord: each along the heading of its first pose, which is why the first chord, along the
// start's own, is a short one. At every point between the path turns as sharply as the bend.
void LeadOut::Poses(WorldPath& path) const {
  path.Clear();
  if (!found()) return;
  constexpr int kMaxChords = kMaxPoses / kStepsPerPoint + 1;
  const float direction = reverse_ ? -1.0f : 1.0f;
  const float most_m = static_cast<float>(kStepsPerPoint) * step_m_;
  const float first_m = Min(kFirstChord_m, 0.5f * best_m_);
  const int chords = ClampInt(FloorToInt((best_m_ - first_m) / most_m) + 1, 1, kMaxChords);
  const float chord_m = (best_m_ - first_m) / static_cast<float>(chords);
  Pose2 pose = start_;
  float way_m = first_m;
  HP_LOOP_BOUND(kMaxChords + 1)
  for (int k = 0; k <= chords; ++k) {
    path.Resize(path.size() + 1);
    path.back() = pose;
    const SinCosPair heading = SinCos(pose.theta_rad);
    const float next_m = k < chords ? chord_m : 0.0f;
    const float driven_m = direction * way_m;
    const float turn_rad = direction * 0.5f * (way_m + next_m) * Bend(best_bend_);
    pose = {pose.x_m + driven_m * heading.cos, pose.y_m + driven_m * heading.sin,
            WrapAngle(pose.theta_rad + turn_rad)};
    way_m = next_m;
  }
  path.Resize(path.size() + 1);
  path.back() = pose;
}

}  // namespace hardpack
