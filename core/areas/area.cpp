// SPDX-License-Identifier: Apache-2.0
#include "core/areas/area.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/odometry/local_plane.h"

namespace hardpack {
namespace {

constexpr int kEdgePairs = kMaxAreaCorners - 1;

// Corners in one plane.
struct Polygon {
  int32_t corners = 0;
  int32_t x_mm[kMaxAreaCorners] = {};
  int32_t y_mm[kMaxAreaCorners] = {};
  int Next(int corner) const { return corner + 1 < corners ? corner + 1 : 0; }
};

Status MakePolygonInOdom(const Area& area, Polygon& polygon) {
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const AreaCorner& corner = area.corner[i];
    if (!IsAreaPosition(corner.x_mm, corner.y_mm)) return Status::kInvalidArgument;
    polygon.x_mm[i] = corner.x_mm;
    polygon.y_mm[i] = corner.y_mm;
  }
  return Status::kOk;
}

Status MakePolygonOnEarth(const Area& area, Polygon& polygon) {
  LocalPlane plane;
  const AreaCorner& first = area.corner[0];
  Status status = plane.SetAnchor(first.latitude_ndeg, first.longitude_ndeg);
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners && IsUsable(status); ++i) {
    const AreaCorner& corner = area.corner[i];
    Vec2 place;
    status = plane.ToPlane(corner.latitude_ndeg, corner.longitude_ndeg, place);
    polygon.x_mm[i] = ToMillimeters(place.x_m);
    polygon.y_mm[i] = ToMillimeters(place.y_m);
  }
  return status;
}

Status MakePolygon(const Area& area, Polygon& polygon) {
  polygon.corners = area.corners;
  return area.frame == AreaFrame::kEarth ? MakePolygonOnEarth(area, polygon)
                                         : MakePolygonInOdom(area, polygon);
}

// Twice the area of the triangle, positive anticlockwise [mm^2]. Differences are below 2^28, so the
// products and their sum are exact.
int64_t Turn(const Polygon& polygon, int a, int b, int c) {
  const int64_t ab_x = polygon.x_mm[b] - polygon.x_mm[a];
  const int64_t ab_y = polygon.y_mm[b] - polygon.y_mm[a];
  const int64_t ac_x = polygon.x_mm[c] - polygon.x_mm[a];
  const int64_t ac_y = polygon.y_mm[c] - polygon.y_mm[a];
  return ab_x * ac_y - ab_y * ac_x;
}

int SignOf(int64_t value) {
  return value > 0 ? 1 : (value < 0 ? -1 : 0);
}

// Whether the ranges from a to b and from c to d have a value in common.
bool Overlap(int32_t a, int32_t b, int32_t c, int32_t d) {
  const int32_t low = a < b ? a : b;
  const int32_t high = a < b ? b : a;
  const int32_t other_low = c < d ? c : d;
  const int32_t other_high = c < d ? d : c;
  return low <= other_high && other_low <= high;
}

// Whether two edges, given by their first corners, have a point in common: each has its ends on
// both sides of the other's line or on it, and their boxes overlap, which tells apart what lies on
// one line.
bool EdgesTouch(const Polygon& polygon, int one, int other) {
  const int one_end = polygon.Next(one);
  const int other_end = polygon.Next(other);
  const int32_t* x = polygon.x_mm;
  const int32_t* y = polygon.y_mm;
  if (!Overlap(x[one], x[one_end], x[other], x[other_end])) return false;
  if (!Overlap(y[one], y[one_end], y[other], y[other_end])) return false;
  const int across_one =
      SignOf(Turn(polygon, one, one_end, other)) * SignOf(Turn(polygon, one, one_end, other_end));
  const int across_other = SignOf(Turn(polygon, other, other_end, one)) *
                           SignOf(Turn(polygon, other, other_end, one_end));
  return across_one <= 0 && across_other <= 0;
}

// Whether the edge to a corner and the edge from it share more than that corner, or one of them has
// no length. Not inlined: within IsSimple's loop the first corner becomes a second way into it, and
// such a loop has no static bound.
[[gnu::noinline]] bool FoldsBack(const Polygon& polygon, int corner) {
  const int before = corner > 0 ? corner - 1 : polygon.corners - 1;
  const int next = polygon.Next(corner);
  const int64_t in_x = polygon.x_mm[corner] - polygon.x_mm[before];
  const int64_t in_y = polygon.y_mm[corner] - polygon.y_mm[before];
  const int64_t out_x = polygon.x_mm[next] - polygon.x_mm[corner];
  const int64_t out_y = polygon.y_mm[next] - polygon.y_mm[corner];
  const bool has_length = (in_x != 0 || in_y != 0) && (out_x != 0 || out_y != 0);
  const bool is_straight = Turn(polygon, before, corner, next) == 0;
  return !has_length || (is_straight && in_x * out_x + in_y * out_y < 0);
}

bool IsSimple(const Polygon& polygon) {
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int edge = 0; edge < polygon.corners; ++edge) {
    if (FoldsBack(polygon, edge)) return false;
    HP_LOOP_BOUND(kEdgePairs)
    for (int other = edge + 2; other < polygon.corners; ++other) {
      if (polygon.Next(other) != edge && EdgesTouch(polygon, edge, other)) return false;
    }
  }
  return true;
}

bool IsLarge(const Polygon& polygon) {
  int64_t doubled_mm2 = 0;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 1; i + 1 < polygon.corners; ++i) doubled_mm2 += Turn(polygon, 0, i, i + 1);
  return doubled_mm2 >= 2 * kMinArea_mm2 || doubled_mm2 <= -2 * kMinArea_mm2;
}

Status CheckSpeed(const Area& area) {
  if (!IsFinite(area.speed_mps)) return Status::kNotFinite;
  const bool fits = area.kind == AreaKind::kSpeedZone
                        ? area.speed_mps >= kMinZoneSpeed_mps && area.speed_mps <= kMaxZoneSpeed_mps
                        : area.speed_mps == 0.0f;
  return fits ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace

Status CheckArea(const Area& area) {
  const bool is_known =
      static_cast<int>(area.kind) < kAreaKinds && static_cast<int>(area.frame) < kAreaFrames;
  if (!is_known || area.corners < kMinAreaCorners) return Status::kInvalidArgument;
  if (area.corners > kMaxAreaCorners) return Status::kCapacityExceeded;
  Status status = CheckSpeed(area);
  if (!IsUsable(status)) return status;
  Polygon polygon;
  status = MakePolygon(area, polygon);
  if (!IsUsable(status)) return status;
  if (!IsSimple(polygon)) return Status::kAreaNotSimple;
  return IsLarge(polygon) ? Status::kOk : Status::kAreaTooSmall;
}

Status CheckAreas(const AreaList& areas) {
  bool has_fence = false;
  HP_LOOP_BOUND(kMaxAreas)
  for (const Area& area : areas) {
    const Status status = CheckArea(area);
    if (!IsUsable(status)) return status;
    const bool is_fence = area.kind == AreaKind::kFence;
    if (is_fence && has_fence) return Status::kSecondFence;
    has_fence = has_fence || is_fence;
  }
  return Status::kOk;
}

}  // namespace hardpack
