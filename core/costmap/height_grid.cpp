// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/height_grid.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/costmap/cell_walk.h"
#include "core/costmap/rows.h"

namespace hardpack {
namespace {

// kNone is above every height, so the first return needs no case of its own here ...
void Lower(int16_t& lowest_cm, int16_t height_cm) {
  if (height_cm < lowest_cm) lowest_cm = height_cm;
}

// ... and does here.
void Raise(int16_t& highest_cm, int16_t height_cm) {
  if (highest_cm == HeightGrid::kNone || height_cm > highest_cm) highest_cm = height_cm;
}

// Where floats tell cells apart.
bool IsNearOrigin(Cell cell) {
  constexpr int32_t kFar = 1 << 22;
  return cell.x > -kFar && cell.x < kFar && cell.y > -kFar && cell.y < kFar;
}

int64_t StepsBetween(int32_t from, int32_t to) {
  const int64_t steps = int64_t{to} - from;
  return steps < 0 ? -steps : steps;
}

// By how many cells a window's edge moves, as far as it matters: a whole window empties it.
int Shift(int32_t from, int32_t to) {
  const int64_t shift = int64_t{to} - from;
  if (shift > kMapSize_cells) return kMapSize_cells;
  if (shift < -kMapSize_cells) return -kMapSize_cells;
  return static_cast<int>(shift);
}

template <typename T>
void CopyCells(const T* __restrict from, int first, int cells, T* __restrict to) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int i = 0; i < cells; ++i) to[i] = from[first + i];
}

template <typename T>
void FillCells(T* to, int cells, T value) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int i = 0; i < cells; ++i) to[i] = value;
}

}  // namespace

HeightGrid::HeightGrid() : window_(GridWindow::CenteredAt({})), began_with_person_{} {
  ClearRows(0, kMapSize_cells);
  ClearNotes();
}

Status HeightGrid::Reset(Vec2 center_odom) {
  if (!IsFinite(center_odom)) return Status::kNotFinite;
  window_ = GridWindow::CenteredAt(center_odom);
  datum_cm_ = 0;
  ClearRows(0, kMapSize_cells);
  ClearNotes();
  return Status::kOk;
}

Status HeightGrid::Recenter(Vec2 center_odom) {
  if (!IsFinite(center_odom)) return Status::kNotFinite;
  const Cell old_origin = window_.origin;
  window_ = GridWindow::CenteredAt(center_odom);
  const int dx = Shift(old_origin.x, window_.origin.x);
  const int dy = Shift(old_origin.y, window_.origin.y);
  const int columns = dx < 0 ? -dx : dx;
  const int rows = dy < 0 ? -dy : dy;
  // Rows that come in, over the full width; then, in the rows that stay, columns that come in.
  ClearRows(dy > 0 ? kMapSize_cells - rows : 0, rows);
  ClearColumns(dx > 0 ? kMapSize_cells - columns : 0, columns, dy > 0 ? 0 : rows,
               kMapSize_cells - rows);
  return Status::kOk;
}

int16_t HeightGrid::Stored(float z_m) const {
  constexpr int32_t kMost_cm = kMaxHeight_cm + kMaxShift_cm;
  const int32_t height_cm = ClampInt(InCentimeters(z_m), -kMost_cm, kMost_cm);
  return static_cast<int16_t>(ClampInt(height_cm - datum_cm_, -kMaxHeight_cm, kMaxHeight_cm));
}

int16_t HeightGrid::Told(int16_t stored_cm) const {
  return static_cast<int16_t>(stored_cm == kNone ? kNone : stored_cm + datum_cm_);
}

Status HeightGrid::Insert(const Vec3& point_odom, ReturnClass return_class, uint32_t revolution) {
  if (return_class == ReturnClass::kIgnored) return Status::kOk;
  if (return_class > ReturnClass::kPerson) return Status::kInvalidArgument;
  if (!IsFinite(point_odom)) return Status::kNotFinite;
  const Cell cell = CellAt({point_odom.x_m, point_odom.y_m});
  if (!window_.Contains(cell)) return Status::kInvalidArgument;

  const int slot = Slot(cell);
  const int16_t height_cm = Stored(point_odom.z_m);
  const bool odd = (revolution & 1) != 0;
  if (return_class == ReturnClass::kGround) {
    FileGround(slot, height_cm, odd);
  } else if (return_class == ReturnClass::kSoft) {
    FileSoft(slot, height_cm, odd);
  } else {
    FileHard(slot, height_cm, odd, return_class == ReturnClass::kPerson);
  }
  return Status::kOk;
}

void HeightGrid::Count(int block, bool firm) {
  int firm_count = low_[block] / kCountOne;
  int against = low_[block] % kCountOne;
  if (firm_count == kMostCount || against == kMostCount) {
    firm_count /= 2;
    against /= 2;
  }
  firm_count += firm ? 1 : 0;
  against += firm ? 0 : 1;
  low_[block] = static_cast<uint8_t>(firm_count * kCountOne + against);
}

void HeightGrid::CountLow(const Vec3& point_odom, bool firm) {
  if (!IsFinite(point_odom)) return;
  const Cell cell = CellAt({point_odom.x_m, point_odom.y_m});
  if (window_.Contains(cell)) Count(BlockSlot(cell), firm);
}

void HeightGrid::DoubtLow(const Vec3& point_odom) {
  if (!IsFinite(point_odom)) return;
  const Cell cell = CellAt({point_odom.x_m, point_odom.y_m});
  if (!window_.Contains(cell)) return;
  const int block = BlockSlot(cell);
  if (low_[block] < kCountOne) return;
  const int slot = Slot(cell);
  if (highest_hard_cm_[slot] == kNone) return;
  const int32_t middle2_cm = lowest_hard_cm_[slot] + highest_hard_cm_[slot];
  if (2 * Stored(point_odom.z_m) >= middle2_cm) Count(block, false);
}

void HeightGrid::ReadLow(Cell first, int cells, uint8_t* low) const {
  HP_LOOP_BOUND(kMostLow_cells)
  for (int x = 0; x < cells; ++x) {
    const int counts = low_[BlockSlot({first.x + x, first.y})];
    const uint8_t growth = IsGrowth(counts) ? kGrowth : uint8_t{0};
    low[x] = IsFirm(counts) ? kFirmLow : growth;
  }
}

// True when the last return that was noted was of another revolution; notes this one's.
bool HeightGrid::IsNewlyFiled(int slot, bool odd) {
  const bool was_odd = (seen_[slot] & kFiledOdd) != 0;
  seen_[slot] = static_cast<uint8_t>((seen_[slot] & ~kFiledOdd) | (odd ? kFiledOdd : 0));
  return odd != was_odd;
}

// A height from beside gives way to one that was measured here.
void HeightGrid::FileGround(int slot, int16_t height_cm, bool odd) {
  const bool empty = !HasObstacle(slot);
  const bool is_person = (seen_[slot] & kPersonMask) != 0;
  if ((empty || is_person) && IsNewlyFiled(slot, odd)) {
    if (is_person) seen_[slot] = static_cast<uint8_t>(seen_[slot] - kPersonOne);
    if (empty && lowest_cm_[slot] < height_cm) ++lowest_cm_[slot];
  }
  const bool guessed = (seen_[slot] & (kGroundHeightKnown | kGroundFromBeside)) ==
                       (kGroundHeightKnown | kGroundFromBeside);
  if (empty && guessed) lowest_cm_[slot] = height_cm;
  Lower(lowest_cm_[slot], height_cm);
  seen_[slot] = static_cast<uint8_t>((seen_[slot] & ~kGroundFromBeside) | kGroundHeightKnown);
}

void HeightGrid::FileHard(int slot, int16_t height_cm, bool odd, bool person) {
  const bool fades = IsNewlyFiled(slot, odd) && (seen_[slot] & kPersonMask) != 0;
  if (person) {
    seen_[slot] |= kPersonMask;
  } else if (fades) {
    seen_[slot] = static_cast<uint8_t>(seen_[slot] - kPersonOne);
  }
  if (highest_hard_cm_[slot] == kNone) {
    began_with_person_.Set(slot, person || noted_[0].Has(slot) || noted_[1].Has(slot));
  }
  Lower(lowest_cm_[slot], height_cm);
  Lower(lowest_hard_cm_[slot], height_cm);
  Raise(highest_hard_cm_[slot], height_cm);
  if (2 * height_cm >= lowest_hard_cm_[slot] + highest_hard_cm_[slot]) MakeYoung(slot, odd);
}

void HeightGrid::FileSoft(int slot, int16_t height_cm, bool odd) {
  Lower(lowest_cm_[slot], height_cm);
  Raise(highest_soft_cm_[slot], height_cm);
  const bool upper = 2 * height_cm >= lowest_cm_[slot] + highest_soft_cm_[slot];
  if (upper && highest_hard_cm_[slot] == kNone) MakeYoung(slot, odd);
}

// Off the window, or one of `known` (of Seen) is there already.
bool HeightGrid::NeedsNone(Cell cell, int known) const {
  return !window_.Contains(cell) || (seen_[Slot(cell)] & known) != 0;
}

void HeightGrid::TakeAsGround(Cell cell, float z_m) {
  if (NeedsNone(cell, kGroundHeightKnown)) return;
  const int slot = Slot(cell);
  Lower(lowest_cm_[slot], Stored(z_m));
  seen_[slot] |= kGroundHeightKnown | kGroundFromBeside;
}

Status HeightGrid::BridgeGround(const Vec3& from_odom, const Vec3& to_odom) {
  return CrossCells(from_odom, to_odom, Crossing::kBridge);
}

Status HeightGrid::ObserveGround(const Vec3& from_odom, const Vec3& to_odom) {
  return CrossCells(from_odom, to_odom, Crossing::kObserve);
}

Status HeightGrid::ForgetGround(const Vec3& from_odom, const Vec3& to_odom) {
  return CrossCells(from_odom, to_odom, Crossing::kForget);
}

void HeightGrid::ForgetCell(int slot) {
  if ((seen_[slot] & kGroundFromBeside) == 0) return;
  const bool had_height = (seen_[slot] & kGroundHeightKnown) != 0;
  seen_[slot] = static_cast<uint8_t>(seen_[slot] & ~(kGroundHeightKnown | kGroundFromBeside));
  // The lowest return is not told apart from the height that is forgotten: of a hard obstacle it is
  // known, and a soft one keeps it.
  if (had_height && highest_soft_cm_[slot] == kNone) lowest_cm_[slot] = lowest_hard_cm_[slot];
}

Status HeightGrid::CrossCells(const Vec3& from_odom, const Vec3& to_odom, Crossing crossing) {
  if (!IsFinite(from_odom) || !IsFinite(to_odom)) return Status::kNotFinite;
  const Vec2 from = {from_odom.x_m, from_odom.y_m};
  const Vec2 along = {to_odom.x_m - from.x_m, to_odom.y_m - from.y_m};
  const float length2 = along.x_m * along.x_m + along.y_m * along.y_m;
  const Cell first = CellAt(from);
  const Cell last = CellAt({to_odom.x_m, to_odom.y_m});
  const int64_t columns = StepsBetween(first.x, last.x);
  const int64_t rows = StepsBetween(first.y, last.y);
  if (!(length2 <= kMaxBridge_m * kMaxBridge_m) || !IsNearOrigin(first) || !IsNearOrigin(last) ||
      columns + rows >= kMaxBridge_cells) {
    return Status::kInvalidArgument;
  }

  const int steps = static_cast<int>(columns + rows);
  // Near the vehicle there is seldom a cell between two ground returns that were filed before.
  const int known = crossing == Crossing::kObserve ? kGroundHeightKnown | kGroundFromBeside
                                                   : int{kGroundHeightKnown};
  if (steps <= 1 &&
      (crossing == Crossing::kForget || (NeedsNone(first, known) && NeedsNone(last, known)))) {
    return Status::kOk;
  }
  crossed_cells_ += static_cast<uint32_t>(steps) + 1u;
  CellWalk walk(from, along);
  HP_LOOP_BOUND(kMaxBridge_cells)
  for (int step = 0; step <= steps; ++step) {
    // Rounding could lead the walk past the last cell by a corner.
    const Cell cell = step == steps ? last : walk.cell();
    walk.Next();
    // Most of it was observed before.
    if (crossing == Crossing::kForget) {
      if (step > 0 && step < steps && window_.Contains(cell)) ForgetCell(Slot(cell));
      continue;
    }
    if (NeedsNone(cell, known)) continue;
    if (crossing == Crossing::kObserve) {
      seen_[Slot(cell)] |= kGroundFromBeside;
      continue;
    }
    const Vec2 middle = CellCenter(cell);
    const float reach = (middle.x_m - from.x_m) * along.x_m + (middle.y_m - from.y_m) * along.y_m;
    const float part = length2 > 0.0f ? Clamp(reach / length2, 0.0f, 1.0f) : 0.0f;
    TakeAsGround(cell, from_odom.z_m + (to_odom.z_m - from_odom.z_m) * part);
  }
  return Status::kOk;
}

Status HeightGrid::AssumeGround(const Vec3& center_odom, float radius_m, Vec2 slope) {
  return AssumeAround<kMaxAssumed_m>(center_odom, radius_m, slope);
}

Status HeightGrid::StandOnGround(const Vec3& center_odom, float radius_m, Vec2 slope) {
  return AssumeAround<kMaxStanding_m>(center_odom, radius_m, slope);
}

template <int kMost_m>
Status HeightGrid::AssumeAround(const Vec3& center_odom, float radius_m, Vec2 slope) {
  if (!IsFinite(center_odom) || !IsFinite(radius_m) || !IsFinite(slope)) {
    return Status::kNotFinite;
  }
  if (radius_m < 0.0f || radius_m > static_cast<float>(kMost_m)) return Status::kInvalidArgument;
  const Cell middle = CellAt({center_odom.x_m, center_odom.y_m});
  const float u = PlaceInCell(center_odom.x_m, middle.x);
  const float v = PlaceInCell(center_odom.y_m, middle.y);
  const float radius_cells = radius_m * kCellsPerMeter;
  const int reach = FloorToInt(radius_cells) + 1;
  constexpr int kMost_cells = 2 * (kMost_m * static_cast<int>(kCellsPerMeter) + 1) + 1;
  static_assert(kMost_cells <= kMapSize_cells);
  HP_LOOP_BOUND(kMost_cells)
  for (int dy = -reach; dy <= reach; ++dy) {
    const float along_y = static_cast<float>(dy) + 0.5f - v;
    HP_LOOP_BOUND(kMost_cells)
    for (int dx = -reach; dx <= reach; ++dx) {
      const float along_x = static_cast<float>(dx) + 0.5f - u;
      if (along_x * along_x + along_y * along_y > radius_cells * radius_cells) continue;
      // Saturates rather than wraps at the end of the plane: such a cell is off any window.
      const float rise_m = (along_x * slope.x_m + along_y * slope.y_m) * kCellSize_m;
      TakeAsGround({SaturatedSum(middle.x, dx), SaturatedSum(middle.y, dy)},
                   center_odom.z_m + rise_m);
    }
  }
  return Status::kOk;
}

Status HeightGrid::ShiftHeights(float dz_m) {
  if (!IsFinite(dz_m)) return Status::kNotFinite;
  const int32_t shift_cm = InCentimeters(dz_m);
  if (shift_cm < -kMaxShift_cm || shift_cm > kMaxShift_cm) return Status::kInvalidArgument;
  const int32_t datum_cm = datum_cm_ + shift_cm;
  if (datum_cm < -kMaxShift_cm || datum_cm > kMaxShift_cm) return Status::kInvalidArgument;
  datum_cm_ = datum_cm;
  return Status::kOk;
}

HeightGrid::CellHeights HeightGrid::At(Cell cell) const {
  if (!window_.Contains(cell)) return {};
  const int slot = Slot(cell);
  return {Told(lowest_cm_[slot]),
          Told(lowest_hard_cm_[slot]),
          Told(highest_hard_cm_[slot]),
          Told(highest_soft_cm_[slot]),
          (seen_[slot] & kGroundHeightKnown) != 0,
          (seen_[slot] & kPersonMask) != 0,
          (seen_[slot] & (kGroundHeightKnown | kGroundFromBeside)) != 0,
          (seen_[slot] & kGroundHeightKnown) != 0 && (seen_[slot] & kGroundFromBeside) != 0,
          IsFirm(low_[BlockSlot(cell)]),
          IsGrowth(low_[BlockSlot(cell)])};
}

template <typename T>
void HeightGrid::CopyRow(const T* plane, Cell first, T empty,
                         std::span<T, kMapSize_cells> row) const {
  T* to = row.data();
  const int ahead = Shift(first.x, window_.origin.x);
  const int64_t dy = int64_t{first.y} - window_.origin.y;
  if (dy < 0 || dy >= kMapSize_cells) {
    FillCells(to, kMapSize_cells, empty);
    return;
  }
  // The columns begin .. end - 1 lie in the window: all, unless it has rolled meanwhile. Storage
  // goes round at column `seam`.
  const int begin = ClampInt(ahead, 0, kMapSize_cells);
  const int end = ClampInt(kMapSize_cells + ahead, 0, kMapSize_cells);
  const T* stored = plane + Slot({0, first.y});
  const int turn = Slot({first.x, 0});
  const int seam = ClampInt(kMapSize_cells - turn, begin, end);
  FillCells(to, begin, empty);
  CopyCells(stored, begin + turn, seam - begin, to + begin);
  CopyCells(stored, seam + turn - kMapSize_cells, end - seam, to + seam);
  FillCells(to + end, kMapSize_cells - end, empty);
}

void HeightGrid::ReadGround(Cell first, HeightRow lowest_cm, SeenRow seen) const {
  CopyRow(lowest_cm_, first, kNone, lowest_cm);
  CopyRow(seen_, first, uint8_t{0}, seen);
}

void HeightGrid::ReadObstacles(Cell first, HeightRow lowest_hard_cm, HeightRow highest_hard_cm,
                               HeightRow highest_soft_cm) const {
  CopyRow(lowest_hard_cm_, first, kNone, lowest_hard_cm);
  CopyRow(highest_hard_cm_, first, kNone, highest_hard_cm);
  CopyRow(highest_soft_cm_, first, kNone, highest_soft_cm);
}

void HeightGrid::ClearRows(int dy, int rows) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int row = 0; row < rows; ++row) {
    const int first = Slot({0, window_.origin.y + dy + row});
    FillRow(lowest_cm_ + first, kNone);
    FillRow(lowest_hard_cm_ + first, kNone);
    FillRow(highest_hard_cm_ + first, kNone);
    FillRow(highest_soft_cm_ + first, kNone);
    FillRow(seen_ + first, uint8_t{0});
    // A block that lies half in the window is emptied with either half: at its far edge.
    FillCells(low_ + BlockSlot({0, window_.origin.y + dy + row}), kBlocks, uint8_t{0});
  }
}

void HeightGrid::ClearColumns(int dx, int columns, int dy, int rows) {
  HP_LOOP_BOUND(kMapSize_cells)
  for (int row = 0; row < rows; ++row) {
    const int first = Slot({0, window_.origin.y + dy + row});
    HP_LOOP_BOUND(kMapSize_cells)
    for (int column = 0; column < columns; ++column) {
      const int slot = first + Slot({window_.origin.x + dx + column, 0});
      lowest_cm_[slot] = kNone;
      lowest_hard_cm_[slot] = kNone;
      highest_hard_cm_[slot] = kNone;
      highest_soft_cm_[slot] = kNone;
      seen_[slot] = 0;
      low_[BlockSlot({window_.origin.x + dx + column, window_.origin.y + dy + row})] = 0;
    }
  }
}

}  // namespace hardpack
