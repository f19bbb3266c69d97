// SPDX-License-Identifier: Apache-2.0
#include "core/costmap/height_grid.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/costmap/cell_walk.h"

namespace hardpack {
namespace {

constexpr float kCentimetersPerMeter = 100.0f;
constexpr float kCellReach_cm = 14.142136f;  // from a cell's middle to its corner
constexpr float kMaxAssumed_m = 50.0f;

// kNone is above every height, so the first return needs no case of its own here ...
void Lower(int16_t& lowest_cm, int16_t height_cm) {
  if (height_cm < lowest_cm) lowest_cm = height_cm;
}

// ... and does here.
void Raise(int16_t& highest_cm, int16_t height_cm) {
  if (highest_cm == HeightGrid::kNone || height_cm > highest_cm) highest_cm = height_cm;
}

bool IsFinitePoint(const Vec3& point) {
  return IsFinite(point.x_m) && IsFinite(point.y_m) && IsFinite(point.z_m);
}

int32_t Offset(int32_t cell, int32_t by) {
  const int64_t sum = int64_t{cell} + by;
  return sum > INT32_MAX ? INT32_MAX : sum < INT32_MIN ? INT32_MIN : static_cast<int32_t>(sum);
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

// The fan can be used, and its furthest return; 0: it saw nothing.
Status CheckFan(const SightFan& fan, float& furthest_m) {
  furthest_m = 0.0f;
  if (fan.beams < 0 || fan.beams > kMaxBeams) return Status::kInvalidArgument;
  if (!IsFinitePoint(fan.sensor_odom) || !IsFinite(fan.direction_odom.x_m) ||
      !IsFinite(fan.direction_odom.y_m) || !IsFinite(fan.lowest_slope) ||
      !IsFinite(fan.highest_slope)) {
    return Status::kNotFinite;
  }
  bool finite = true;
  HP_LOOP_BOUND(kMaxBeams)
  for (int beam = 0; beam < fan.beams; ++beam) {
    const float level_m = fan.level_m[beam];
    finite = finite && IsFinite(level_m) && (level_m <= 0.0f || IsFinite(fan.slope[beam]));
    furthest_m = Max(furthest_m, level_m);
  }
  if (!finite) return Status::kNotFinite;
  const Vec2 direction = fan.direction_odom;
  const float length2 = direction.x_m * direction.x_m + direction.y_m * direction.y_m;
  const bool unit = length2 >= 0.99f * 0.99f && length2 <= 1.01f * 1.01f;
  return unit ? Status::kOk : Status::kInvalidArgument;
}

// How many cells a walk takes until their middles are further away than any return can tell of.
int CellsInReach(Vec2 direction, float furthest_m) {
  const float cells_per_m = (Abs(direction.x_m) + Abs(direction.y_m)) * kCellsPerMeter;
  // A cell's middle lies up to 0.15 m ahead of a return in it, the line's end in it as far again.
  const float cells = (furthest_m + 2.0f * HeightGrid::kEndsBefore_m) * cells_per_m;
  return ClampInt(FloorToInt(cells), 0, HeightGrid::kMaxSight_cells - 3) + 3;
}

// By how many cells a window's edge moves, as far as it matters: a whole window empties it.
int Shift(int32_t from, int32_t to) {
  const int64_t shift = int64_t{to} - from;
  if (shift > kMapSize_cells) return kMapSize_cells;
  if (shift < -kMapSize_cells) return -kMapSize_cells;
  return static_cast<int>(shift);
}

// As Told, for a strip; without branches, so that the loop vectorises.
void TellStrip(const int16_t* __restrict stored_cm, int16_t datum_cm, int16_t* __restrict told_cm) {
  HP_LOOP_BOUND(HeightGrid::kStripCells)
  for (int i = 0; i < HeightGrid::kStripCells; ++i) {
    const int16_t stored = stored_cm[i];
    const int16_t told = static_cast<int16_t>(stored + datum_cm);
    told_cm[i] = stored == HeightGrid::kNone ? HeightGrid::kNone : told;
  }
}

}  // namespace

HeightGrid::HeightGrid() : window_(GridWindow::CenteredAt({})) {
  Clear(0, 0, kMapSize_cells, kMapSize_cells);
}

Status HeightGrid::Reset(Vec2 center_odom) {
  if (!IsFinite(center_odom.x_m) || !IsFinite(center_odom.y_m)) return Status::kNotFinite;
  window_ = GridWindow::CenteredAt(center_odom);
  datum_cm_ = 0;
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

int16_t HeightGrid::Stored(float z_m) const {
  constexpr int32_t kMost_cm = kMaxHeight_cm + kMaxShift_cm;
  const int32_t height_cm = ClampInt(RoundToInt(z_m * kCentimetersPerMeter), -kMost_cm, kMost_cm);
  return static_cast<int16_t>(ClampInt(height_cm - datum_cm_, -kMaxHeight_cm, kMaxHeight_cm));
}

int16_t HeightGrid::Told(int16_t stored_cm) const {
  return static_cast<int16_t>(stored_cm == kNone ? kNone : stored_cm + datum_cm_);
}

bool HeightGrid::HasObstacle(int slot) const {
  return ((highest_hard_cm_[slot] ^ kNone) | (highest_soft_cm_[slot] ^ kNone)) != 0;
}

// No misses, and none any more in this revolution.
void HeightGrid::MakeYoung(int slot, bool odd) {
  seen_[slot] =
      static_cast<uint8_t>((seen_[slot] & ~(kMissMask | kSightOdd)) | (odd ? kSightOdd : 0));
}

Status HeightGrid::Insert(const Vec3& point_odom, ReturnClass return_class, uint32_t revolution) {
  if (return_class == ReturnClass::kIgnored) return Status::kOk;
  if (return_class > ReturnClass::kPerson) return Status::kInvalidArgument;
  if (!IsFinitePoint(point_odom)) return Status::kNotFinite;
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

// True when the last return that was noted was of another revolution; notes this one's.
bool HeightGrid::IsNewlyFiled(int slot, bool odd) {
  const bool was_odd = (seen_[slot] & kFiledOdd) != 0;
  seen_[slot] = static_cast<uint8_t>((seen_[slot] & ~kFiledOdd) | (odd ? kFiledOdd : 0));
  return odd != was_odd;
}

void HeightGrid::FileGround(int slot, int16_t height_cm, bool odd) {
  if (!HasObstacle(slot) && IsNewlyFiled(slot, odd) && lowest_cm_[slot] < height_cm) {
    ++lowest_cm_[slot];
  }
  Lower(lowest_cm_[slot], height_cm);
  seen_[slot] |= kGroundHeightKnown;
}

void HeightGrid::FileHard(int slot, int16_t height_cm, bool odd, bool person) {
  const bool fades = IsNewlyFiled(slot, odd) && (seen_[slot] & kPersonMask) != 0;
  if (person) {
    seen_[slot] |= kPersonMask;
  } else if (fades) {
    seen_[slot] = static_cast<uint8_t>(seen_[slot] - kPersonOne);
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
  seen_[slot] |= kGroundHeightKnown;
}

Status HeightGrid::BridgeGround(const Vec3& from_odom, const Vec3& to_odom) {
  return CrossCells(from_odom, to_odom, true);
}

Status HeightGrid::ObserveGround(const Vec3& from_odom, const Vec3& to_odom) {
  return CrossCells(from_odom, to_odom, false);
}

Status HeightGrid::CrossCells(const Vec3& from_odom, const Vec3& to_odom, bool with_heights) {
  if (!IsFinitePoint(from_odom) || !IsFinitePoint(to_odom)) return Status::kNotFinite;
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
  const int known = with_heights ? kGroundHeightKnown : kGroundHeightKnown | kGroundObserved;
  if (steps <= 1 && NeedsNone(first, known) && NeedsNone(last, known)) return Status::kOk;
  CellWalk walk(from, along);
  HP_LOOP_BOUND(kMaxBridge_cells)
  for (int step = 0; step <= steps; ++step) {
    // Rounding could lead the walk past the last cell by a corner.
    const Cell cell = step == steps ? last : walk.cell();
    walk.Next();
    // Most of it was observed before.
    if (NeedsNone(cell, known)) continue;
    if (!with_heights) {
      seen_[Slot(cell)] |= kGroundObserved;
      continue;
    }
    const Vec2 middle = CellCenter(cell);
    const float reach = (middle.x_m - from.x_m) * along.x_m + (middle.y_m - from.y_m) * along.y_m;
    const float part = length2 > 0.0f ? Clamp(reach / length2, 0.0f, 1.0f) : 0.0f;
    TakeAsGround(cell, from_odom.z_m + (to_odom.z_m - from_odom.z_m) * part);
  }
  return Status::kOk;
}

Status HeightGrid::AssumeGround(const Vec3& center_odom, float radius_m) {
  if (!IsFinitePoint(center_odom) || !IsFinite(radius_m)) return Status::kNotFinite;
  if (radius_m < 0.0f || radius_m > kMaxAssumed_m) return Status::kInvalidArgument;
  const Cell middle = CellAt({center_odom.x_m, center_odom.y_m});
  const float u = PlaceInCell(center_odom.x_m, middle.x);
  const float v = PlaceInCell(center_odom.y_m, middle.y);
  const float radius_cells = radius_m * kCellsPerMeter;
  const int reach = FloorToInt(radius_cells) + 1;
  static_assert(2 * (kMaxAssumed_m * kCellsPerMeter + 1) + 1 <= kMapSize_cells);
  HP_LOOP_BOUND(kMapSize_cells)
  for (int dy = -reach; dy <= reach; ++dy) {
    const float along_y = static_cast<float>(dy) + 0.5f - v;
    HP_LOOP_BOUND(kMapSize_cells)
    for (int dx = -reach; dx <= reach; ++dx) {
      const float along_x = static_cast<float>(dx) + 0.5f - u;
      if (along_x * along_x + along_y * along_y > radius_cells * radius_cells) continue;
      // Saturates rather than wraps at the end of the plane: such a cell is off any window.
      TakeAsGround({Offset(middle.x, dx), Offset(middle.y, dy)}, center_odom.z_m);
    }
  }
  return Status::kOk;
}

Status HeightGrid::ShiftHeights(float dz_m) {
  if (!IsFinite(dz_m)) return Status::kNotFinite;
  const int32_t shift_cm = RoundToInt(dz_m * kCentimetersPerMeter);
  if (shift_cm < -kMaxShift_cm || shift_cm > kMaxShift_cm) return Status::kInvalidArgument;
  const int32_t datum_cm = datum_cm_ + shift_cm;
  if (datum_cm < -kMaxShift_cm || datum_cm > kMaxShift_cm) return Status::kInvalidArgument;
  datum_cm_ = datum_cm;
  return Status::kOk;
}

Status HeightGrid::Age(const SightFan& fan, uint32_t revolution, int ageing_revolutions) {
  float furthest_m = 0.0f;
  const Status status = CheckFan(fan, furthest_m);
  if (status != Status::kOk) return status;
  const Vec2 sensor = {fan.sensor_odom.x_m, fan.sensor_odom.y_m};
  if (ageing_revolutions < 1 || ageing_revolutions > kMaxAgeingRevolutions ||
      !window_.Contains(CellAt(sensor))) {
    return Status::kInvalidArgument;
  }
  if (furthest_m <= 0.0f) return Status::kOk;

  Sight sight = {};
  const Vec2 given = fan.direction_odom;
  const float length = Sqrt(given.x_m * given.x_m + given.y_m * given.y_m);
  sight.direction = {given.x_m / length, given.y_m / length};
  sight.z_cm = fan.sensor_odom.z_m * kCentimetersPerMeter - static_cast<float>(datum_cm_);
  const float spread = Max(fan.highest_slope - fan.lowest_slope, 0.0f) * kCentimetersPerMeter;
  sight.spacing_cm_per_m = fan.beams > 1 ? spread / static_cast<float>(fan.beams - 1) : 0.0f;
  sight.odd = (revolution & 1) != 0;
  sight.ageing_revolutions = ageing_revolutions;

  const int cells = CellsInReach(sight.direction, furthest_m);
  CellWalk walk(sensor, sight.direction);
  HP_LOOP_BOUND(kMaxSight_cells)
  for (int i = 0; i < cells; ++i) {
    if (!window_.Contains(walk.cell())) break;
    const int slot = Slot(walk.cell());
    if (HasObstacle(slot)) {
      const Vec2 middle = CellCenter(walk.cell());
      AgeCell(slot,
              (middle.x_m - sensor.x_m) * sight.direction.x_m +
                  (middle.y_m - sensor.y_m) * sight.direction.y_m,
              fan, sight);
    }
    walk.Next();
  }
  return Status::kOk;
}

void HeightGrid::AgeCell(int slot, float distance_m, const SightFan& fan, const Sight& sight) {
  const int misses = (seen_[slot] & kMissMask) / kMissOne;
  const bool is_new = ((seen_[slot] & kSightOdd) != 0) != sight.odd;
  if (!is_new && misses == 0) return;  // neither a hit nor a miss would change anything

  const bool hard = highest_hard_cm_[slot] != kNone;
  Target target = {};
  target.lowest_cm = hard ? lowest_hard_cm_[slot] : lowest_cm_[slot];
  target.highest_cm = hard ? highest_hard_cm_[slot] : highest_soft_cm_[slot];
  target.distance_m = distance_m;
  target.margin_cm = kEdge_cm + sight.spacing_cm_per_m * Max(distance_m, 0.0f);
  const Evidence evidence = Look(fan, sight, target);
  if (evidence.hit) {
    MakeYoung(slot, sight.odd);
    return;
  }
  const bool through = evidence.inside || (evidence.around && !evidence.ended);
  if (!is_new || !through) return;
  MakeYoung(slot, sight.odd);
  if (misses + 1 < sight.ageing_revolutions) {
    seen_[slot] = static_cast<uint8_t>(seen_[slot] + (misses + 1) * kMissOne);
    return;
  }
  CutDown(slot, hard, evidence.inside ? Cut_cm(fan, sight, target) : target.lowest_cm);
}

HeightGrid::Evidence HeightGrid::Look(const SightFan& fan, const Sight& sight,
                                      const Target& target) {
  const float near_m = Max(target.distance_m - kEndsBefore_m, 0.0f);
  const float behind_m = target.distance_m + kBehind_m;
  const float reach_cm = target.distance_m * kCentimetersPerMeter;
  const float low_cm = target.lowest_cm - target.margin_cm;
  const float high_cm = target.highest_cm + target.margin_cm;
  const float middle_cm = 0.5f * (target.lowest_cm + target.highest_cm);
  const float hit_cm = middle_cm - kEdge_cm;
  const float edge_cm = target.highest_cm - kEdge_cm;
  int32_t hit = 0;
  int32_t ended = 0;
  int32_t inside = 0;
  int32_t below = 0;
  int32_t above = 0;
  // No branches: it runs for every obstacle along every direction.
  HP_LOOP_BOUND(kMaxBeams)
  for (int beam = 0; beam < fan.beams; ++beam) {
    const float level_m = fan.level_m[beam];
    const float slope = fan.slope[beam];
    const int32_t beyond = -(level_m > behind_m);
    const int32_t got_here = -(level_m > near_m);
    const float level_cm = level_m * kCentimetersPerMeter;
    const float height_cm = sight.z_cm + slope * Min(level_cm, reach_cm);
    const float half_cm = Abs(slope) * kCellReach_cm;
    const float bottom_cm = height_cm - half_cm;
    const float top_cm = height_cm + half_cm;
    const int32_t ended_here =
        got_here & ~beyond & -(height_cm >= low_cm) & -(height_cm <= high_cm);
    ended |= ended_here;
    hit |= ended_here & -(height_cm >= hit_cm);
    inside |= beyond & -(bottom_cm >= target.lowest_cm) & -(top_cm <= edge_cm);
    below |= beyond & -(top_cm >= low_cm) & -(top_cm <= middle_cm);
    above |= beyond & -(bottom_cm >= middle_cm) & -(bottom_cm <= high_cm);
  }
  return {hit != 0, ended != 0, inside != 0, below != 0 && above != 0};
}

// Down to where an obstacle is cut: a beam went through inside it, and none hit it.
float HeightGrid::Cut_cm(const SightFan& fan, const Sight& sight, const Target& target) {
  const float near_m = Max(target.distance_m - kEndsBefore_m, 0.0f);
  const float behind_m = target.distance_m + kBehind_m;
  const float reach_cm = target.distance_m * kCentimetersPerMeter;
  const float top_cm = target.highest_cm - kEdge_cm;
  float lowest_through_cm = top_cm;
  float highest_end_cm = target.lowest_cm;
  HP_LOOP_BOUND(kMaxBeams)
  for (int beam = 0; beam < fan.beams; ++beam) {
    const float level_m = fan.level_m[beam];
    if (!(level_m > near_m)) continue;
    const float slope = fan.slope[beam];
    const float level_cm = level_m * kCentimetersPerMeter;
    const float height_cm = sight.z_cm + slope * Min(level_cm, reach_cm);
    const float half_cm = Abs(slope) * kCellReach_cm;
    if (level_m > behind_m) {
      if (height_cm - half_cm >= target.lowest_cm) {
        lowest_through_cm = Min(lowest_through_cm, height_cm + half_cm);
      }
    } else if (height_cm <= top_cm) {
      highest_end_cm = Max(highest_end_cm, height_cm);
    }
  }
  return Max(lowest_through_cm, highest_end_cm);
}

// The hard obstacle, or the soft one, ends at a height below its highest return from now on.
void HeightGrid::CutDown(int slot, bool hard, float cut_cm) {
  const int32_t highest_cm = RoundToInt(cut_cm);
  const int16_t lowest_cm = hard ? lowest_hard_cm_[slot] : lowest_cm_[slot];
  const bool gone = highest_cm <= lowest_cm + kRest_cm;
  const int16_t kept_cm = gone ? kNone : static_cast<int16_t>(highest_cm);
  if (hard) {
    highest_hard_cm_[slot] = kept_cm;
    if (gone) lowest_hard_cm_[slot] = kNone;
    seen_[slot] = static_cast<uint8_t>(seen_[slot] & ~kPersonMask);
  } else {
    highest_soft_cm_[slot] = kept_cm;
  }
  if (!HasObstacle(slot) && (seen_[slot] & kGroundHeightKnown) == 0) lowest_cm_[slot] = kNone;
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
          (seen_[slot] & (kGroundHeightKnown | kGroundObserved)) != 0};
}

void HeightGrid::Read(Cell first, Strip& strip) const {
  const Cell last = {first.x + (kStripCells - 1), first.y};
  const int slot = Slot(first);
  const bool side_by_side = Slot(last) == slot + (kStripCells - 1);
  if (side_by_side && window_.Contains(first) && window_.Contains(last)) {
    const int16_t datum_cm = static_cast<int16_t>(datum_cm_);
    TellStrip(lowest_cm_ + slot, datum_cm, strip.lowest_cm);
    TellStrip(lowest_hard_cm_ + slot, datum_cm, strip.lowest_hard_cm);
    TellStrip(highest_hard_cm_ + slot, datum_cm, strip.highest_hard_cm);
    TellStrip(highest_soft_cm_ + slot, datum_cm, strip.highest_soft_cm);
    const uint8_t* seen = seen_ + slot;
    HP_LOOP_BOUND(kStripCells)
    for (int i = 0; i < kStripCells; ++i) {
      strip.ground[i] = seen[i] & kGroundHeightKnown;
      strip.person[i] = (seen[i] & kPersonMask) != 0;
      strip.observed[i] = (seen[i] & (kGroundHeightKnown | kGroundObserved)) != 0;
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
    strip.observed[i] = heights.observed;
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
