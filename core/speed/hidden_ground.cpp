// SPDX-License-Identifier: Apache-2.0
#include "core/speed/hidden_ground.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/costmap/cell_walk.h"

namespace hardpack {
namespace {

// Of a line as long as a lookout reaches, along both axes together: most where it is diagonal. Each
// of its ends is up to half a cell from where it is taken to be.
constexpr int kMaxCrossed_cells =
    static_cast<int>(1.4143f * Lookouts::kReach_m * kCellsPerMeter) + 2;

int CellsBetween(Cell a, Cell b) {
  const int dx = a.x < b.x ? b.x - a.x : a.x - b.x;
  const int dy = a.y < b.y ? b.y - a.y : a.y - b.y;
  return dx + dy;
}

enum class View : uint8_t { kNone, kShadow, kShown };

// What the lidar sees of a cell from a place: nothing where it is too near or too far.
View ViewFrom(const Costmap& map, Vec2 place, float blind_m, Cell cell) {
  const Vec2 way = Minus(CellCenter(cell), place);
  const float way_m = Length(way);
  if (way_m < blind_m || way_m > Lookouts::kReach_m) return View::kNone;
  CellWalk walk(place, way);
  const int crossed = CellsBetween(walk.cell(), cell);
  HP_LOOP_BOUND(kMaxCrossed_cells)
  for (int k = 0; k < crossed; ++k) {
    const Cell before = walk.cell();
    const bool is_hard =
        map.window.Contains(before) && (map.flags[map.window.Index(before)] & Costmap::kHard) != 0;
    if (is_hard) return View::kShadow;
    walk.Next();
  }
  return View::kShown;
}

// Of the places, as Lookouts::climb.
Vec2 ClimbOf(const Lookouts& lookouts) {
  const auto& heights_m = lookouts.heights_m;
  const auto& places = lookouts.places_odom;
  float lowest_m = heights_m[0];
  float climbed_m = 0.0f;
  Vec2 steepest;  // of length 1
  float steepest_rises = 0.0f;
  HP_LOOP_BOUND(Lookouts::kMost - 1)
  for (int k = 1; k < heights_m.size(); ++k) {
    climbed_m = Max(climbed_m, heights_m[k] - lowest_m);
    lowest_m = Min(lowest_m, heights_m[k]);
    const int before = k > 1 ? k - 2 : 0;
    const Vec2 way = Minus(places[k], places[before]);
    const float way_m = Length(way);
    if (way_m < Lookouts::kApart_m) continue;
    const float rises = (heights_m[k] - heights_m[before]) / way_m;
    if (rises <= steepest_rises) continue;
    steepest_rises = rises;
    steepest = {way.x_m / way_m, way.y_m / way_m};
  }
  if (climbed_m < Lookouts::kClimbed_m) return {};
  return {steepest_rises * steepest.x_m, steepest_rises * steepest.y_m};
}

}  // namespace

void Lookouts::Add(Vec2 place_odom, float height_m) {
  const int places = places_odom.size();
  const bool is_near = places >= 2 && AreWithin(place_odom, places_odom[places - 2], kApart_m);
  if (is_near) {
    places_odom.back() = place_odom;
    heights_m.back() = height_m;
    return;
  }
  if (!places_odom.full()) {
    places_odom.Resize(places + 1);
    heights_m.Resize(places + 1);
  } else {
    HP_LOOP_BOUND(kMost - 1)
    for (int k = 0; k + 1 < kMost; ++k) {
      places_odom[k] = places_odom[k + 1];
      heights_m[k] = heights_m[k + 1];
    }
  }
  places_odom.back() = place_odom;
  heights_m.back() = height_m;
  const Vec2 climbs = ClimbOf(*this);
  const bool has_climbed = Length(climbs) > 0.0f;
  since_climb = has_climbed ? 0 : since_climb + 1;
  if (has_climbed || since_climb > kKept) climb = climbs;
}

void Lookouts::Clear() {
  places_odom.Clear();
  heights_m.Clear();
  climb = {};
  since_climb = 0;
}

bool IsHidden(const Costmap& map, const Lookouts& lookouts, Cell cell) {
  View best = View::kNone;
  HP_LOOP_BOUND(Lookouts::kMost)
  for (const Vec2& place : lookouts.places_odom) {
    const View view = ViewFrom(map, place, lookouts.blind_m, cell);
    best = view == View::kNone ? best : view;
    if (best == View::kShown) break;
  }
  return best == View::kShadow;
}

}  // namespace hardpack
