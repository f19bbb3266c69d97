// SPDX-License-Identifier: Apache-2.0
#include "core/safety/outline.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

// A side that is so nearly along an axis of the map is taken to be: over its whole length it is off
// by less than 0.1 mm.
constexpr float kAlongAxis = 1.0e-5f;

// How many cells of a row are passed from one on, itself included, until the first hard one; more
// than `most` where none of so many behind it is.
template <int kStep>
inline int32_t PassedToHard(const uint8_t* flags, int32_t most) {
  HP_LOOP_BOUND(Outline::kMaxSpan_cells)
  for (int32_t passed = 0; passed <= most; ++passed) {
    if ((flags[passed * kStep] & Costmap::kHard) != 0) return passed;
  }
  return most + 1;
}

// The middle of the rectangle's chord along the line `y` above its middle, from its middle.
// Precondition: |y| <= half_y_cells.
float MiddleOfChord(const Outline& outline, float y) {
  float low = -outline.half_x_cells;
  float high = outline.half_x_cells;
  if (Abs(outline.cos) > kAlongAxis) {  // between front and rear
    const float middle = -y * outline.sin / outline.cos;
    const float half = outline.half_length_cells / Abs(outline.cos);
    low = Max(low, middle - half);
    high = Min(high, middle + half);
  }
  if (Abs(outline.sin) > kAlongAxis) {  // between the flanks
    const float middle = y * outline.cos / outline.sin;
    const float half = outline.half_width_cells / Abs(outline.sin);
    low = Max(low, middle - half);
    high = Min(high, middle + half);
  }
  return Clamp(0.5f * (low + high), -outline.half_x_cells, outline.half_x_cells);
}

int32_t OnMap(float cells) {
  return ClampInt(FloorToInt(cells), 0, kMapSize_cells - 1);
}

}  // namespace

Outline OutlineAt(const GridWindow& window, const Footprint& footprint, const Pose2& pose) {
  const SinCosPair heading = SinCos(pose.theta_rad);
  Outline outline;
  outline.cos = heading.cos;
  outline.sin = heading.sin;
  const float ahead_cells = footprint.middle_m() * kCellsPerMeter;
  outline.middle.x_m =
      pose.x_m * kCellsPerMeter - static_cast<float>(window.origin.x) + ahead_cells * heading.cos;
  outline.middle.y_m =
      pose.y_m * kCellsPerMeter - static_cast<float>(window.origin.y) + ahead_cells * heading.sin;
  outline.half_length_cells = footprint.half_length_m() * kCellsPerMeter;
  outline.half_width_cells = footprint.half_width_m * kCellsPerMeter;
  const float cos = Abs(heading.cos);
  const float sin = Abs(heading.sin);
  outline.half_x_cells = outline.half_length_cells * cos + outline.half_width_cells * sin;
  outline.half_y_cells = outline.half_length_cells * sin + outline.half_width_cells * cos;
  outline.half_cell_cells = 0.5f * (cos + sin);
  return outline;
}

CellApart ApartFrom(const Outline& outline, int32_t x, int32_t y) {
  const float dx = static_cast<float>(x) + 0.5f - outline.middle.x_m;
  const float dy = static_cast<float>(y) + 0.5f - outline.middle.y_m;
  const float ahead = dx * outline.cos + dy * outline.sin;
  const float left = dy * outline.cos - dx * outline.sin;
  CellApart apart;
  apart.along_cells = Abs(ahead) - outline.half_length_cells - outline.half_cell_cells;
  apart.aside_cells = Abs(left) - outline.half_width_cells - outline.half_cell_cells;
  const float on_x = Abs(dx) - 0.5f - outline.half_x_cells;
  const float on_y = Abs(dy) - 0.5f - outline.half_y_cells;
  apart.least_cells = Max(Max(apart.along_cells, apart.aside_cells), Max(on_x, on_y));
  return apart;
}

// Two rectangles that are apart are nearest at a corner of one of them: each corner of the square
// to the rectangle, in the body's axes, and each of the rectangle to the square, in the map's.
float Distance2To(const Outline& outline, int32_t x, int32_t y) {
  if (ApartFrom(outline, x, y).least_cells <= 0.0f) return 0.0f;
  const float dx = static_cast<float>(x) + 0.5f - outline.middle.x_m;
  const float dy = static_cast<float>(y) + 0.5f - outline.middle.y_m;
  constexpr float kSigns[4][2] = {{1.0f, 1.0f}, {1.0f, -1.0f}, {-1.0f, 1.0f}, {-1.0f, -1.0f}};
  float nearest2 = Squared(2.0f * Outline::kMaxSpan_cells);
  HP_LOOP_BOUND(4)
  for (const auto& sign : kSigns) {
    const float corner_x = dx + 0.5f * sign[0];
    const float corner_y = dy + 0.5f * sign[1];
    const float ahead = Abs(corner_x * outline.cos + corner_y * outline.sin);
    const float left = Abs(corner_y * outline.cos - corner_x * outline.sin);
    const float to_rectangle2 = Squared(Max(0.0f, ahead - outline.half_length_cells)) +
                                Squared(Max(0.0f, left - outline.half_width_cells));
    const float arm_ahead = sign[0] * outline.half_length_cells;
    const float arm_left = sign[1] * outline.half_width_cells;
    const float from_x = Abs(arm_ahead * outline.cos - arm_left * outline.sin - dx);
    const float from_y = Abs(arm_ahead * outline.sin + arm_left * outline.cos - dy);
    const float to_square2 = Squared(Max(0.0f, from_x - 0.5f)) + Squared(Max(0.0f, from_y - 0.5f));
    nearest2 = Min(nearest2, Min(to_rectangle2, to_square2));
  }
  return nearest2;
}

// Along a row of squares the distance to a convex outline falls to a least one and grows from there
// on. It is least where the row's line nearest to the outline's middle meets the outline: there
// it is 0 in a row that meets it, and else the nearest corner is over it. So of the hard cells to
// either side of that place the first one is the nearest.
void LowerToNearestHard(const Costmap& map, const Outline& outline, float& nearest2_cells2) {
  const float reach_cells = Sqrt(nearest2_cells2);
  const float high_y = outline.middle.y_m + outline.half_y_cells;
  const float low_y = outline.middle.y_m - outline.half_y_cells;
  const int32_t first = OnMap(outline.middle.x_m - outline.half_x_cells - reach_cells);
  const int32_t last = OnMap(outline.middle.x_m + outline.half_x_cells + reach_cells);
  const int32_t first_row = OnMap(low_y - reach_cells);
  const int32_t last_row = OnMap(high_y + reach_cells);
  HP_LOOP_BOUND(Outline::kMaxSpan_cells)
  for (int32_t y = first_row; y <= last_row; ++y) {
    const float row = static_cast<float>(y);
    const float beyond = Max(0.0f, Max(row - high_y, low_y - (row + 1.0f)));
    if (beyond * beyond >= nearest2_cells2) continue;
    const float line =
        Clamp(row + 0.5f - outline.middle.y_m, -outline.half_y_cells, outline.half_y_cells);
    const int32_t middle =
        ClampInt(FloorToInt(outline.middle.x_m + MiddleOfChord(outline, line)), first, last);
    const uint8_t* flags = &map.flags[y * kMapSize_cells + middle];
    const int32_t right = PassedToHard<1>(flags, last - middle);
    const int32_t left = PassedToHard<-1>(flags, middle - first);
    if (middle + right <= last) {
      nearest2_cells2 = Min(nearest2_cells2, Distance2To(outline, middle + right, y));
    }
    if (middle - left >= first) {
      nearest2_cells2 = Min(nearest2_cells2, Distance2To(outline, middle - left, y));
    }
  }
}

// With c the map's cell nearest to a disc's centre and D the map's distance from c's centre to the
// nearest hard centre: the centre of the disc (or its projection onto the map, which is no further
// from any square of the map) lies in c, at most half a diagonal from its centre, and every point
// of a square lies at most half a diagonal from its own centre. So every hard square is at least
// D - one diagonal from it. A saturated D is a lower bound still.
float NearestHardAtLeast(const Costmap& map, const Footprint& footprint, const Pose2& pose) {
  // A little above the square root of two.
  constexpr float kDiagonal_cells = 1.41422f;
  const SinCosPair heading = SinCos(pose.theta_rad);
  uint8_t least2_cells2 = kMaxDistance2_cells2;
  HP_LOOP_BOUND(Footprint::kMaxDiscs)
  for (int disc = 0; disc < footprint.discs; ++disc) {
    const float ahead_m = footprint.DiscAhead(disc);
    const Vec2 centre = {pose.x_m + ahead_m * heading.cos, pose.y_m + ahead_m * heading.sin};
    const Cell cell = map.window.Nearest(CellAt(centre));
    const uint8_t distance2_cells2 = map.hard_distance2[map.window.Index(cell)];
    least2_cells2 = distance2_cells2 < least2_cells2 ? distance2_cells2 : least2_cells2;
  }
  return Sqrt(static_cast<float>(least2_cells2)) - kDiagonal_cells -
         footprint.disc_radius_m * kCellsPerMeter;
}

bool IsClear(const Costmap& map, const Footprint& footprint, const Pose2& pose, float margin_m) {
  // A hair further, so that what is exactly at the margin, or touches, is found.
  const float margin_cells = margin_m * kCellsPerMeter;
  const float reach2_cells2 = Squared(margin_cells + 1.0e-3f);
  float nearest2_cells2 = reach2_cells2;
  LowerToNearestHard(map, OutlineAt(map.window, footprint, pose), nearest2_cells2);
  if (nearest2_cells2 >= reach2_cells2) return true;
  return nearest2_cells2 > 0.0f && nearest2_cells2 >= margin_cells * margin_cells;
}

}  // namespace hardpack
