// SPDX-License-Identifier: Apache-2.0
#include "core/path/path.h"

#include "core/base/footprint.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

Vec2 Chord(const Pose2& from, const Pose2& to) {
  return {to.x_m - from.x_m, to.y_m - from.y_m};
}

// Distance from a coordinate to the interval of one cell, in cells: 0 inside it.
float DistanceToCell(float coordinate_cells, int32_t cell) {
  const float low = static_cast<float>(cell);
  return Max(0.0f, Max(low - coordinate_cells, coordinate_cells - (low + 1.0f)));
}

}  // namespace

float CurvatureBetween(float turn_rad, float chord_before_m, float chord_after_m) {
  if (!HasLength(chord_before_m) || !HasLength(chord_after_m)) return 0.0f;
  return ClampCurvature(turn_rad / MeanChord(chord_before_m, chord_after_m));
}

bool IsReversed(const WorldPath& path, int point) {
  if (point + 1 >= path.size()) return false;
  const float driven_m = PlanarModel::Inverse(path[point], path[point + 1]).dr_m;
  return driven_m < 0.0f && HasLength(driven_m);
}

Pose2 PlanarModel::Forward(const Pose2& from, const ActuatorStep& step) {
  const SinCosPair heading = SinCos(from.theta_rad);
  return {from.x_m + heading.cos * step.dr_m, from.y_m + heading.sin * step.dr_m,
          WrapAngle(from.theta_rad + step.phi_rad)};
}

ActuatorStep PlanarModel::Inverse(const Pose2& from, const Pose2& to) {
  const Vec2 chord = Chord(from, to);
  const SinCosPair heading = SinCos(from.theta_rad);
  const bool reverse = chord.x_m * heading.cos + chord.y_m * heading.sin < 0.0f;
  const float distance_m = Length(chord);
  return {WrapAngle(to.theta_rad - from.theta_rad), reverse ? -distance_m : distance_m};
}

float PlanarModel::TurnBetween(Vec2 chord, Vec2 next_chord) {
  return Atan2(chord.x_m * next_chord.y_m - chord.y_m * next_chord.x_m,
               chord.x_m * next_chord.x_m + chord.y_m * next_chord.y_m);
}

Vec2 PlanarModel::Turned(Vec2 arm, const SinCosPair& turn) {
  return {turn.cos * arm.x_m - turn.sin * arm.y_m, turn.sin * arm.x_m + turn.cos * arm.y_m};
}

float HeadingOf(Vec2 chord) {
  return WrapAngle(Atan2(chord.y_m, chord.x_m));
}

void SetHeadingsFromChords(WorldPath& path) {
  const int points = path.size();
  if (points == 0) return;
  float theta_rad = path[0].theta_rad;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int i = 0; i + 1 < points; ++i) {
    const Vec2 chord = Chord(path[i], path[i + 1]);
    if (chord.x_m != 0.0f || chord.y_m != 0.0f) theta_rad = HeadingOf(chord);
    path[i].theta_rad = theta_rad;
  }
  path[points - 1].theta_rad = theta_rad;
}

float LengthOf(const WorldPath& path) {
  float length_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int i = 0; i + 1 < path.size(); ++i) length_m += Length(Chord(path[i], path[i + 1]));
  return length_m;
}

float BaseHeading(const WorldPath& base) {
  constexpr float kReach_m = 1.0f;
  if (base.size() < 2) return 0.0f;
  float along_m = 0.0f;
  int reached = 0;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int i = 1; i < base.size() && along_m < kReach_m; ++i) {
    along_m += Length(Chord(base[i - 1], base[i]));
    reached = i;
  }
  return HeadingOf(Chord(base[0], base[reached]));
}

float PlanningRadius(const CostmapParams& costmap, const VehicleParams& vehicle,
                     const PathParams& params) {
  const float needed_m = 0.5f * vehicle.width_m + params.margin_m + 0.5f * kCellDiagonal_m;
  return Max(costmap.planning_radius_m, needed_m);
}

// Of a row the cells within the circle are those from one column to another: their squares are at
// most `half` columns from the position, what is left of the radius there.
bool PivotIsFree(const Costmap& map, const VehicleParams& vehicle, const PathParams& params,
                 Vec2 position_odom) {
  constexpr int kMaxSide_cells = static_cast<int>(2.0f * kMaxPivotCircle_m * kCellsPerMeter) + 2;
  constexpr uint8_t kBlocks = Costmap::kHard | Costmap::kPerson;
  const float radius_m = PivotRadiusOf(vehicle) + params.pivot_margin_m;
  if (!IsFinite(position_odom)) return false;
  if (!(radius_m >= 0.0f && radius_m <= kMaxPivotCircle_m)) return false;

  const Cell low = CellAt({position_odom.x_m - radius_m, position_odom.y_m - radius_m});
  const Cell high = CellAt({position_odom.x_m + radius_m, position_odom.y_m + radius_m});
  if (!map.window.Contains(low) || !map.window.Contains(high)) return false;
  // Very far from the origin a float's steps are wider than cells.
  if (high.x - low.x >= kMaxSide_cells || high.y - low.y >= kMaxSide_cells) return false;

  const float radius_cells = radius_m * kCellsPerMeter;
  const float u = position_odom.x_m * kCellsPerMeter;
  const float v = position_odom.y_m * kCellsPerMeter;
  HP_LOOP_BOUND(kMaxSide_cells)
  for (int32_t y = low.y; y <= high.y; ++y) {
    const float dy = DistanceToCell(v, y);
    const uint8_t* flags = &map.flags[map.window.Index({low.x, y})];
    const float half2 = radius_cells * radius_cells - dy * dy;
    if (half2 < 0.0f) continue;
    const float half = Sqrt(half2);
    const int32_t first = ClampInt(FloorToInt(u - half), low.x, high.x);
    const int32_t last = ClampInt(FloorToInt(u + half), low.x, high.x);
    uint8_t found = 0;
    HP_LOOP_BOUND(kMaxSide_cells)
    for (int32_t x = first - low.x; x <= last - low.x; ++x) found |= flags[x];
    if ((found & kBlocks) != 0) return false;
  }
  return true;
}

}  // namespace hardpack
