// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/height_grid.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

constexpr float kCentimetersPerMeter = 100.0f;
constexpr int32_t kMaxHeight_cm = HeightGrid::kNone - 1;

int16_t HeightInCm(float z_m) {
  const int32_t height_cm = RoundToInt(z_m * kCentimetersPerMeter);
  return static_cast<int16_t>(ClampInt(height_cm, -kMaxHeight_cm, kMaxHeight_cm));
}

// kNone is above every height, so the first return needs no case of its own here ...
void Lower(int16_t& lowest_cm, int16_t height_cm) {
  if (height_cm < lowest_cm) lowest_cm = height_cm;
}

// ... and does here.
void Raise(int16_t& highest_cm, int16_t height_cm) {
  if (highest_cm == HeightGrid::kNone || height_cm > highest_cm) highest_cm = height_cm;
}

// By how many cells a window's edge moves, as far as it matters: a whole window empties it.
int Shift(int32_t from, int32_t to) {
  const int64_t shift = int64_t{to} - from;
  if (shift > kMapSize_cells) return kMapSize_cells;
  if (shift < -kMapSize_cells) return -kMapSize_cells;
  return static_cast<int>(shift);
}

}  // namespace

HeightGrid::HeightGrid() : window_(GridWindow::CenteredAt({})) {
  Clear(0, 0, kMapSize_cells, kMapSize_cells);
}

Status HeightGrid::Reset(Vec2 center_odom) {
  if (!IsFinite(center_odom.x_m) || !IsFinite(center_odom.y_m)) return Status::kNotFinite;
  window_ = GridWindow::CenteredAt(center_odom);
  Clear(0, 0, kMapSize_cells, kMapSize_cells);
  return Status::kOk;
}

Status HeightGrid::Recenter(Vec2 center_odom) {
  if (!IsFinite(center_odom.x_m) || !IsFinite(center_odom.y_m)) return Status::kNotFinite;
  const Cell old_origin = window_.origin;
  window_ = GridWindow::CenteredAt(center_odom);
  const int dx = Shift(old_origin.x, window_.origin.x);
  const int dy = Shift(old_origin.y, window_.origin.y);
  const int columns = dx < 0 ? -dx : dx;
  const int rows = dy < 0 ? -dy : dy;
  // Rows that come in, over the full width; then, in the rows that stay, columns that come in.
  Clear(0, dy > 0 ? kMapSize_cells - rows : 0, kMapSize_cells, rows);
  Clear(dx > 0 ? kMapSize_cells - columns : 0, dy > 0 ? 0 : rows, columns, kMapSize_cells - rows);
  return Status::kOk;
}

Status HeightGrid::Insert(const Vec3& point_odom, ReturnClass return_class) {
  if (return_class == ReturnClass::kIgnored) return Status::kOk;
  if (return_class > ReturnClass::kPerson) return Status::kInvalidArgument;
  if (!IsFinite(point_odom.x_m) || !IsFinite(point_odom.y_m) || !IsFinite(point_odom.z_m)) {
    return Status::kNotFinite;
  }
  const Cell cell = CellAt({point_odom.x_m, point_odom.y_m});
  if (!window_.Contains(cell)) return Status::kInvalidArgument;

  const int slot = Slot(cell);
  const int16_t height_cm = HeightInCm(point_odom.z_m);
  Lower(lowest_cm_[slot], height_cm);
  if (return_class == ReturnClass::kGround) seen_[slot] |= kGroundSeen;
  if (return_class == ReturnClass::kPerson) seen_[slot] |= kPersonSeen;
  if (return_class == ReturnClass::kSoft) Raise(highest_soft_cm_[slot], height_cm);
  if (return_class == ReturnClass::kHard || return_class == ReturnClass::kPerson) {
    Lower(lowest_hard_cm_[slot], height_cm);
    Raise(highest_hard_cm_[slot], height_cm);
  }
  return Status::kOk;
}

HeightGrid::CellHeights HeightGrid::At(Cell cell) const {
  if (!window_.Contains(cell)) return {};
  const int slot = Slot(cell);
  return {lowest_cm_[slot],
          lowest_hard_cm_[slot],
          highest_hard_cm_[slot],
          highest_soft_cm_[slot],
          (seen_[slot] & kGroundSeen) != 0,
          (seen_[slot] & kPersonSeen) != 0};
}

void HeightGrid::Read(Cell first, Strip& strip) const {
  const Cell last = {first.x + (kStripCells - 1), first.y};
  const int slot = Slot(first);
  const bool side_by_side = Slot(last) == slot + (kStripCells - 1);
  if (side_by_side && window_.Contains(first) && window_.Contains(last)) {
    HP_LOOP_BOUND(kStripCells)
    for (int i = 0; i < kStripCells; ++i) {
      strip.lowest_cm[i] = lowest_cm_[slot + i];
      strip.lowest_hard_cm[i] = lowest_hard_cm_[slot + i];
      strip.highest_hard_cm[i] = highest_hard_cm_[slot + i];
      strip.highest_soft_cm[i] = highest_soft_cm_[slot + i];
      strip.ground[i] = seen_[slot + i] & kGroundSeen;
      strip.person[i] = (seen_[slot + i] & kPersonSeen) / kPersonSeen;
    }
    return;
  }
  // Storage wraps around inside the strip, or an end of the window lies in it.
  HP_LOOP_BOUND(kStripCells)
  for (int i = 0; i < kStripCells; ++i) {
    const CellHeights heights = At({first.x + i, first.y});
    strip.lowest_cm[i] = heights.lowest_cm;
    strip.lowest_hard_cm[i] = heights.lowest_hard_cm;
    strip.highest_hard_cm[i] = heights.highest_hard_cm;
    strip.highest_soft_cm[i] = heights.highest_soft_cm;
    strip.ground[i] = heights.ground;
    strip.person[i] = heights.person;
  }
}

void HeightGrid::Clear(int dx, int dy, int width, int height) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int row = 0; row < height; ++row) {
    HP_LOOP_BOUND(kMapSize_cells)
    for (int column = 0; column < width; ++column) {
      const int slot = Slot({window_.origin.x + dx + column, window_.origin.y + dy + row});
      lowest_cm_[slot] = kNone;
      lowest_hard_cm_[slot] = kNone;
      highest_hard_cm_[slot] = kNone;
      highest_soft_cm_[slot] = kNone;
      seen_[slot] = 0;
    }
  }
}

}  // namespace hardpack
