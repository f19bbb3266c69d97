// SPDX-License-Identifier: Apache-2.0
#include "core/areas/area_shape.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {
namespace {

constexpr int64_t kCell_mm = 200;
constexpr float kMetersPerMillimeter = 0.001f;
// A few roundings of single precision, of the size of the numbers that were rounded.
constexpr float kRounding = 1.0f / (1 << 20);
constexpr float kLeastMargin_cells = 0.001f;
constexpr float kLeastMargin_m = 0.001f;
// Farther out than any corner of an area.
constexpr int32_t kFarPlace_mm = 1 << 28;
// Beyond it nothing is on the map.
constexpr int64_t kFar_mm = 1 << 30;

constexpr int32_t kLastColumn = kMapSize_cells - 1;
constexpr uint32_t kWordBits = 32;

int Next(const Area& area, int corner) {
  return corner + 1 < area.corners ? corner + 1 : 0;
}

// From the low edge of the map's first cell, along one axis [cells].
float InCells(int32_t place_mm, int32_t origin_cells) {
  const int64_t apart_mm = place_mm - kCell_mm * origin_cells;
  const int64_t kept_mm =
      apart_mm < -kFar_mm ? -kFar_mm : (apart_mm > kFar_mm ? kFar_mm : apart_mm);
  return static_cast<float>(static_cast<int32_t>(kept_mm)) / static_cast<float>(kCell_mm);
}

struct Edge {
  Vec2 from;  // [cells, despite the type]
  Vec2 to;
  float margin_cells = 0.0f;
};

Edge EdgeOf(const Area& area, const GridWindow& window, int corner) {
  const AreaCorner& a = area.corner[corner];
  const AreaCorner& b = area.corner[Next(area, corner)];
  Edge edge;
  edge.from = {InCells(a.x_mm, window.origin.x), InCells(a.y_mm, window.origin.y)};
  edge.to = {InCells(b.x_mm, window.origin.x), InCells(b.y_mm, window.origin.y)};
  edge.margin_cells = kLeastMargin_cells + kRounding * (Abs(edge.from.x_m) + Abs(edge.from.y_m) +
                                                        Abs(edge.to.x_m) + Abs(edge.to.y_m));
  return edge;
}

// Columns first .. last, of those on the map.
void Fill(int32_t first, int32_t last, RowCells& cells) {
  const int32_t low = first < 0 ? 0 : first;
  const int32_t high = last > kLastColumn ? kLastColumn : last;
  if (low > high) return;
  const auto low_word = static_cast<uint32_t>(low) / kWordBits;
  const auto high_word = static_cast<uint32_t>(high) / kWordBits;
  HP_LOOP_BOUND(kRowWords)
  for (uint32_t word = low_word; word <= high_word; ++word) {
    uint32_t bits = 0xffffffffu;
    if (word == low_word) bits &= 0xffffffffu << (static_cast<uint32_t>(low) % kWordBits);
    if (word == high_word) {
      bits &= 0xffffffffu >> (kWordBits - 1 - static_cast<uint32_t>(high) % kWordBits);
    }
    cells.word[word] |= bits;
  }
}

// The columns that an edge touches within a row, margin included; first > last: none.
RowRange ColumnsOf(const Edge& edge, float row) {
  const float low = row - edge.margin_cells;
  const float high = row + 1.0f + edge.margin_cells;
  if (Min(edge.from.y_m, edge.to.y_m) > high || Max(edge.from.y_m, edge.to.y_m) < low) return {};
  const float dx = edge.to.x_m - edge.from.x_m;
  const float dy = edge.to.y_m - edge.from.y_m;
  // The share of the edge that lies in the row. Where it hardly rises, all of it.
  float enters = 0.0f;
  float leaves = 1.0f;
  if (Abs(dy) > edge.margin_cells) {
    const float to_low = (low - edge.from.y_m) / dy;
    const float to_high = (high - edge.from.y_m) / dy;
    enters = Clamp(Min(to_low, to_high), 0.0f, 1.0f);
    leaves = Clamp(Max(to_low, to_high), 0.0f, 1.0f);
  }
  const float x_enters = edge.from.x_m + enters * dx;
  const float x_leaves = edge.from.x_m + leaves * dx;
  return {FloorToInt(Min(x_enters, x_leaves) - edge.margin_cells),
          FloorToInt(Max(x_enters, x_leaves) + edge.margin_cells)};
}

// From toggles to what lies behind an odd number of them: each bit becomes the parity of those at
// and below it. `before`: of what lies left of the map.
void SumParity(bool before, RowCells& cells) {
  uint32_t carried = before ? 0xffffffffu : 0u;
  HP_LOOP_BOUND(kRowWords)
  for (uint32_t& word : cells.word) {
    word ^= word << 1u;
    word ^= word << 2u;
    word ^= word << 4u;
    word ^= word << 8u;
    word ^= word << 16u;
    word ^= carried;
    carried = (word >> (kWordBits - 1)) != 0 ? 0xffffffffu : 0u;
  }
}

// A corner from the middle of the outline, in its axes.
struct BodyView {
  int64_t x_mm = 0;
  int64_t y_mm = 0;
  SinCosPair heading = {};
  float middle_m = 0.0f;

  BodyView(const Pose2& pose, float middle)
      : x_mm(ToMillimeters(pose.x_m)),
        y_mm(ToMillimeters(pose.y_m)),
        heading(SinCos(pose.theta_rad)),
        middle_m(middle) {}

  static float Apart(int64_t apart_mm) {
    const int64_t kept_mm =
        apart_mm < -kFar_mm ? -kFar_mm : (apart_mm > kFar_mm ? kFar_mm : apart_mm);
    return static_cast<float>(static_cast<int32_t>(kept_mm)) * kMetersPerMillimeter;
  }
  Vec2 At(const AreaCorner& corner) const {
    const float dx_m = Apart(corner.x_mm - x_mm);
    const float dy_m = Apart(corner.y_mm - y_mm);
    return {dx_m * heading.cos + dy_m * heading.sin - middle_m,
            dy_m * heading.cos - dx_m * heading.sin};
  }
};

// Whether an edge touches the rectangle about the origin: neither the rectangle's axes nor the
// edge's normal separate them (separating axes).
bool EdgeTouches(Vec2 a, Vec2 b, float half_length_m, float half_width_m) {
  const float margin_m =
      kLeastMargin_m + kRounding * (Abs(a.x_m) + Abs(a.y_m) + Abs(b.x_m) + Abs(b.y_m));
  const float length_m = half_length_m + margin_m;
  const float width_m = half_width_m + margin_m;
  if (Min(a.x_m, b.x_m) > length_m || Max(a.x_m, b.x_m) < -length_m) return false;
  if (Min(a.y_m, b.y_m) > width_m || Max(a.y_m, b.y_m) < -width_m) return false;
  const float dx_m = b.x_m - a.x_m;
  const float dy_m = b.y_m - a.y_m;
  const float off_m2 = Abs(a.x_m * dy_m - a.y_m * dx_m);
  return off_m2 <= length_m * Abs(dy_m) + width_m * Abs(dx_m);
}

// Whether the edge crosses the x axis ahead of the origin.
bool CrossesAhead(Vec2 a, Vec2 b) {
  if ((a.y_m <= 0.0f) == (b.y_m <= 0.0f)) return false;
  return a.x_m - a.y_m * (b.x_m - a.x_m) / (b.y_m - a.y_m) > 0.0f;
}

struct Relation {
  bool touches_border = false;
  bool holds_middle = false;  // of the rectangle
};

Relation RelationTo(const Area& area, const BodyView& view, float half_length_m,
                    float half_width_m) {
  Relation relation;
  Vec2 a = view.At(area.corner[area.corners - 1]);
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const Vec2 b = view.At(area.corner[i]);
    if (EdgeTouches(a, b, half_length_m, half_width_m)) relation.touches_border = true;
    if (CrossesAhead(a, b)) relation.holds_middle = !relation.holds_middle;
    a = b;
  }
  return relation;
}

// Of a place, to the millimetre and exactly: corners and the place are less than 2^29 mm apart.
Relation RelationTo(const Area& area, int32_t x_mm, int32_t y_mm) {
  const int64_t place_x = ClampInt(x_mm, -kFarPlace_mm, kFarPlace_mm);
  const int64_t place_y = ClampInt(y_mm, -kFarPlace_mm, kFarPlace_mm);
  Relation relation;
  int64_t ax = area.corner[area.corners - 1].x_mm - place_x;
  int64_t ay = area.corner[area.corners - 1].y_mm - place_y;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const int64_t bx = area.corner[i].x_mm - place_x;
    const int64_t by = area.corner[i].y_mm - place_y;
    const int64_t off = ax * by - ay * bx;  // of the edge's line from the place
    if (off == 0 && ax * bx <= 0 && ay * by <= 0) relation.touches_border = true;
    const bool crosses_axis = (ay <= 0) != (by <= 0);
    if (crosses_axis && (off > 0) == (by > ay)) relation.holds_middle = !relation.holds_middle;
    ax = bx;
    ay = by;
  }
  return relation;
}

bool ForbidsBy(AreaKind kind, const Relation& relation) {
  if (kind == AreaKind::kSpeedZone) return false;
  return relation.touches_border || relation.holds_middle == (kind == AreaKind::kKeepOut);
}

}  // namespace

RowRange RowsOf(const Area& area, const GridWindow& window) {
  if (area.kind == AreaKind::kFence) return {0, kMapSize_cells - 1};
  constexpr float kNothing_cells = 1.0e9f;
  float low = kNothing_cells;
  float high = -kNothing_cells;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const Edge edge = EdgeOf(area, window, i);
    low = Min(low, Min(edge.from.y_m, edge.to.y_m) - edge.margin_cells);
    high = Max(high, Max(edge.from.y_m, edge.to.y_m) + edge.margin_cells);
  }
  const int32_t first = FloorToInt(low);
  const int32_t last = FloorToInt(high);
  return {first < 0 ? 0 : first, last > kMapSize_cells - 1 ? kMapSize_cells - 1 : last};
}

RowCells ClosedCells(const Area& area, const GridWindow& window, int row) {
  RowCells touched;
  if (area.kind == AreaKind::kSpeedZone) return touched;
  const auto row_cells = static_cast<float>(row);
  const float middle = row_cells + 0.5f;
  RowCells inside;
  bool is_left_inside = false;
  HP_LOOP_BOUND(kMaxAreaCorners)
  for (int i = 0; i < area.corners; ++i) {
    const Edge edge = EdgeOf(area, window, i);
    const RowRange columns = ColumnsOf(edge, row_cells);
    if (columns.first > columns.last) continue;
    Fill(columns.first, columns.last, touched);
    if ((edge.from.y_m <= middle) == (edge.to.y_m <= middle)) continue;
    const float share = (middle - edge.from.y_m) / (edge.to.y_m - edge.from.y_m);
    const float x = edge.from.x_m + share * (edge.to.x_m - edge.from.x_m);
    // Among the touched ones in any case: so every other cell has it on the right side.
    const int32_t column = ClampInt(FloorToInt(x), columns.first, columns.last);
    if (column < 0) is_left_inside = !is_left_inside;
    if (column < 0 || column > kLastColumn) continue;
    inside.word[static_cast<uint32_t>(column) / kWordBits] ^=
        1u << (static_cast<uint32_t>(column) % kWordBits);
  }
  SumParity(is_left_inside, inside);
  const uint32_t flip = area.kind == AreaKind::kFence ? 0xffffffffu : 0u;
  HP_LOOP_BOUND(kRowWords)
  for (int word = 0; word < kRowWords; ++word) {
    touched.word[word] |= inside.word[word] ^ flip;
  }
  return touched;
}

bool IsTouched(const Area& area, const Footprint& footprint, const Pose2& pose, float ends_m,
               float flanks_m) {
  const BodyView view(pose, footprint.middle_m());
  const Relation relation =
      RelationTo(area, view, footprint.half_length_m() + ends_m, footprint.half_width_m + flanks_m);
  return relation.touches_border || relation.holds_middle;
}

bool IsBreached(const Area& area, const Footprint& footprint, const Pose2& pose) {
  const BodyView view(pose, footprint.middle_m());
  return ForbidsBy(area.kind,
                   RelationTo(area, view, footprint.half_length_m(), footprint.half_width_m));
}

bool Forbids(const Area& area, Vec2 place_odom) {
  return ForbidsBy(area.kind,
                   RelationTo(area, ToMillimeters(place_odom.x_m), ToMillimeters(place_odom.y_m)));
}

}  // namespace hardpack
