// SPDX-License-Identifier: Apache-2.0
#include "core/safety/corridor.h"

#include "core/base/footprint.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/speed/speed.h"

namespace hardpack {
namespace {

constexpr uint32_t kRecentMask = Corridor::kRecent_cells - 1;
static_assert((Corridor::kRecent_cells & (Corridor::kRecent_cells - 1)) == 0);
constexpr int32_t kHalf_cells = Corridor::kRecent_cells / 2;

bool IsSize(float value_m, float largest_m) {
  return value_m >= 0.0f && value_m <= largest_m;
}

uint32_t Place(Cell cell) {
  const uint32_t x = static_cast<uint32_t>(cell.x) & kRecentMask;
  const uint32_t y = static_cast<uint32_t>(cell.y) & kRecentMask;
  return y * Corridor::kRecent_cells + x;
}

// The cell of the window around `middle` that has this place along one axis.
int32_t Unwrapped(int32_t place, int32_t middle) {
  const uint32_t low = static_cast<uint32_t>(middle) - static_cast<uint32_t>(kHalf_cells);
  const uint32_t ahead = (static_cast<uint32_t>(place) - low) & kRecentMask;
  return static_cast<int32_t>(low + ahead);
}

Status CheckInput(const WorldPath& path, float along_m, const CorridorSize& size) {
  if (path.size() < 2) return Status::kPathTooShort;
  if (!IsFinite(along_m)) return Status::kNotFinite;
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : path) {
    if (!IsFinite(pose.x_m) || !IsFinite(pose.y_m)) return Status::kNotFinite;
  }
  const bool fits = IsSize(size.half_width_m, Corridor::kMaxHalfWidth_m) &&
                    IsSize(size.pivot_radius_m, Corridor::kMaxHalfWidth_m) &&
                    IsSize(size.reach_m, Corridor::kMaxReach_m);
  return fits ? Status::kOk : Status::kInvalidArgument;
}

}  // namespace

void Corridor::Reset() {
  Clear();
  tick_ = 0;
  has_vehicle_ = false;
  HP_LOOP_BOUND(kRecent_cells * kRecent_cells)
  for (uint32_t& cell : recent_) cell = 0;
}

void Corridor::Clear() {
  chords_ = 0;
  has_obstacle_ = false;
  is_person_ = false;
  obstacle_along_m_ = 0.0f;
}

// What is older than the memory goes before its tick comes again, a row each time.
void Corridor::Advance(Vec2 vehicle_odom, uint32_t tick) {
  if (!IsFinite(vehicle_odom)) return;
  tick_ = tick;
  tests_left_ = kMaxTests;
  vehicle_ = CellAt(vehicle_odom);
  has_vehicle_ = true;
  uint32_t* row = recent_ + (tick & kRecentMask) * kRecent_cells;
  HP_LOOP_BOUND(kRecent_cells)
  for (int x = 0; x < kRecent_cells; ++x) {
    if (((tick_ - row[x]) & kTickMask) > kMemory_ticks) row[x] = 0;
  }
}

uint32_t Corridor::Tag(Cell cell) {
  const uint32_t x = (static_cast<uint32_t>(cell.x) / kRecent_cells) & 31u;
  const uint32_t y = (static_cast<uint32_t>(cell.y) / kRecent_cells) & 31u;
  return (y << 27u) | (x << 22u);
}

void Corridor::Remember(Vec2 point_odom, bool is_person) {
  if (!has_vehicle_) return;
  const Cell cell = CellAt(point_odom);
  const int64_t dx = int64_t{cell.x} - vehicle_.x;
  const int64_t dy = int64_t{cell.y} - vehicle_.y;
  if (dx < -kHalf_cells || dx >= kHalf_cells || dy < -kHalf_cells || dy >= kHalf_cells) return;
  uint32_t& place = recent_[Place(cell)];
  const uint32_t now = Tag(cell) | kUsedBit | (tick_ & kTickMask);
  const bool was_person = (place & ~kPersonBit) == now && (place & kPersonBit) != 0;
  place = now | (is_person || was_person ? kPersonBit : 0u);
}

Status Corridor::Build(const WorldPath& path, float along_m, const CorridorSize& size,
                       uint32_t since) {
  Clear();
  const Status status = CheckInput(path, along_m, size);
  if (!IsUsable(status)) return status;
  Walk(path, along_m, size);
  if (chords_ == 0) return Status::kOk;  // the vehicle is at the path's end
  LayGrid();
  int rows_left = kMaxMarked_rows;
  bool is_marked = true;
  HP_LOOP_BOUND(kMaxChords)
  for (int chord = 0; chord < chords_ && is_marked; ++chord) is_marked = Mark(chord, rows_left);
  if (!is_marked) MarkAll();
  tests_left_ = kMaxTests;  // of its own; what is filed in this tick was before
  TestRecent(since);
  return Status::kOk;
}

// The path's own chords from along_m on.
void Corridor::Walk(const WorldPath& path, float along_m, const CorridorSize& size) {
  const float least_m = size.reach_m / static_cast<float>(kMaxChords - 2);
  const float end_m = along_m + size.reach_m;
  const int last = path.size() - 2;
  Vec2 from;
  float from_m = -1.0f;  // along; below 0: none is open
  float before_m = 0.0f;
  HP_LOOP_BOUND(kMaxPathPoints - 1)
  for (int k = 0; k <= last && before_m <= end_m; ++k) {
    const Vec2 a = {path[k].x_m, path[k].y_m};
    const Vec2 b = {path[k + 1].x_m, path[k + 1].y_m};
    const float length_m = Length({b.x_m - a.x_m, b.y_m - a.y_m});
    if (!HasLength(length_m)) {
      if (from_m >= 0.0f && from_m < before_m) Add(from, a, from_m, size.half_width_m);
      from_m = -1.0f;
      if (before_m >= along_m - kLeastChord_m) Add(a, a, before_m, size.pivot_radius_m);
      continue;
    }
    const float behind_m = before_m + length_m;
    if (behind_m > along_m) {
      if (from_m < 0.0f) {
        const float share = Clamp((along_m - before_m) / length_m, 0.0f, 1.0f);
        from = {a.x_m + share * (b.x_m - a.x_m), a.y_m + share * (b.y_m - a.y_m)};
        from_m = Max(before_m, along_m);
      }
      if (behind_m - from_m >= least_m || k == last) {
        Add(from, b, from_m, size.half_width_m);
        from = b;
        from_m = behind_m;
      }
    }
    before_m = behind_m;
  }
}

void Corridor::Add(Vec2 from, Vec2 to, float along_m, float radius_m) {
  if (chords_ == kMaxChords) return;
  const Vec2 way = {to.x_m - from.x_m, to.y_m - from.y_m};
  const float length_m = Length(way);
  Chord& chord = chord_[chords_++];
  chord.from = from;
  chord.length_m = length_m;
  chord.along_m = along_m;
  chord.radius_m = radius_m;
  chord.direction =
      HasLength(length_m) ? Vec2{way.x_m / length_m, way.y_m / length_m} : Vec2{0.0f, 0.0f};
}

// As small as holds all chords.
void Corridor::LayGrid() {
  Vec2 low = chord_[0].from;
  Vec2 high = low;
  HP_LOOP_BOUND(kMaxChords)
  for (int k = 0; k < chords_; ++k) {
    const Chord& chord = chord_[k];
    const Vec2 to = {chord.from.x_m + chord.length_m * chord.direction.x_m,
                     chord.from.y_m + chord.length_m * chord.direction.y_m};
    const float r_m = chord.radius_m;
    low = {Min(low.x_m, Min(chord.from.x_m, to.x_m) - r_m),
           Min(low.y_m, Min(chord.from.y_m, to.y_m) - r_m)};
    high = {Max(high.x_m, Max(chord.from.x_m, to.x_m) + r_m),
            Max(high.y_m, Max(chord.from.y_m, to.y_m) + r_m)};
  }
  low_ = low;
  high_ = high;
  constexpr float kLeastSide_m = 1.0f;
  constexpr float kMargin = 0.98f;  // of the side: rounding puts nothing outside
  const float side_m = Max(Max(high.x_m - low.x_m, high.y_m - low.y_m), kLeastSide_m);
  cells_per_m_ = kMargin * static_cast<float>(kSide) / side_m;
  const float edge_m = 0.5f * (1.0f - kMargin) * side_m;
  origin_ = {low.x_m - edge_m, low.y_m - edge_m};
  HP_LOOP_BOUND(kSide * kSide)
  for (int i = 0; i < kSide * kSide; ++i) {
    first_[i] = 255;
    last_[i] = 0;
  }
}

void Corridor::MarkAll() {
  HP_LOOP_BOUND(kSide * kSide)
  for (int i = 0; i < kSide * kSide; ++i) {
    first_[i] = 0;
    last_[i] = static_cast<uint8_t>(chords_ - 1);
  }
}

// The cells of the box around its corridor, and one more to each side against rounding. False, and
// nothing is marked: they are more rows than are left. Not inlined: its rounds are counted
// (config/timing.toml).
[[gnu::noinline]] bool Corridor::Mark(int index, int& rows_left) {
  const Chord& chord = chord_[index];
  const Vec2 to = {chord.from.x_m + chord.length_m * chord.direction.x_m,
                   chord.from.y_m + chord.length_m * chord.direction.y_m};
  const auto column = [&](float value_m, float origin_m, int32_t beyond) {
    const int32_t cell = FloorToInt((value_m - origin_m) * cells_per_m_);
    return ClampInt(cell + beyond, 0, kSide - 1);
  };
  const float r_m = chord.radius_m;
  const int32_t x0 = column(Min(chord.from.x_m, to.x_m) - r_m, origin_.x_m, -1);
  const int32_t x1 = column(Max(chord.from.x_m, to.x_m) + r_m, origin_.x_m, 1);
  const int32_t y0 = column(Min(chord.from.y_m, to.y_m) - r_m, origin_.y_m, -1);
  const int32_t y1 = column(Max(chord.from.y_m, to.y_m) + r_m, origin_.y_m, 1);
  const auto number = static_cast<uint8_t>(index);
  rows_left -= y1 - y0 + 1;
  if (rows_left < 0) return false;
  HP_LOOP_BOUND(kSide)
  for (int32_t y = y0; y <= y1; ++y) {
    HP_LOOP_BOUND(kSide)
    for (int32_t x = x0; x <= x1; ++x) {
      const int32_t i = y * kSide + x;
      if (first_[i] == 255) first_[i] = number;
      last_[i] = number;
    }
  }
  return true;
}

// -1: off it. A comparison with NaN is false.
int Corridor::GridIndex(Vec2 point_odom) const {
  constexpr float kEnd = kSide;
  const float u = (point_odom.x_m - origin_.x_m) * cells_per_m_;
  const float v = (point_odom.y_m - origin_.y_m) * cells_per_m_;
  if (!(u >= 0.0f && u < kEnd && v >= 0.0f && v < kEnd)) return -1;
  return FloorToInt(v) * kSide + FloorToInt(u);
}

// The first return of a person is rarely the first of all, and labels come later than returns.
void Corridor::Take(float along_m, bool is_person) {
  if (has_obstacle_ && along_m > obstacle_along_m_ + kSamePerson_m) return;
  const bool was_near = has_obstacle_ && obstacle_along_m_ <= along_m + kSamePerson_m;
  is_person_ = is_person || (is_person_ && was_near);
  obstacle_along_m_ = has_obstacle_ ? Min(along_m, obstacle_along_m_) : along_m;
  has_obstacle_ = true;
}

// Whether so many chords may still be tested. If not, something is taken to be in the way at once:
// so many returns so near to the path are one obstacle or another.
bool Corridor::MayTest(int chords) {
  tests_left_ -= chords;
  if (tests_left_ >= 0) return true;
  tests_left_ = 0;
  Take(chord_[0].along_m, false);
  return false;
}

// Not inlined: its rounds are counted (config/timing.toml).
[[gnu::noinline]] bool Corridor::File(Vec2 point_odom, bool is_person) {
  if (!IsFinite(point_odom)) return false;
  Remember(point_odom, is_person);
  if (chords_ == 0) return false;
  const int cell = GridIndex(point_odom);
  if (cell < 0) return false;
  bool is_inside = false;
  const int last = last_[cell];
  if (last >= first_[cell] && !MayTest(last - first_[cell] + 1)) return true;
  HP_LOOP_BOUND(kMaxChords)
  for (int k = first_[cell]; k <= last; ++k) {
    const Chord& chord = chord_[k];
    const Vec2 arm = {point_odom.x_m - chord.from.x_m, point_odom.y_m - chord.from.y_m};
    const float along_m = arm.x_m * chord.direction.x_m + arm.y_m * chord.direction.y_m;
    // The vehicle's middle is where the first one begins; the next ones are round, too.
    if (chord.along_m + along_m < chord_[0].along_m) continue;
    const float on_m = Clamp(along_m, 0.0f, chord.length_m);
    const float dx_m = arm.x_m - on_m * chord.direction.x_m;
    const float dy_m = arm.y_m - on_m * chord.direction.y_m;
    if (dx_m * dx_m + dy_m * dy_m > chord.radius_m * chord.radius_m) continue;
    is_inside = true;
    // Not where the chord is nearest: it would be its end for all that its next chords hold.
    Take(chord.along_m + along_m, is_person);
  }
  return is_inside;
}

void Corridor::TestRecent(uint32_t since) {
  if (!has_vehicle_) return;
  const uint32_t ticks = tick_ - since;
  HP_LOOP_BOUND(kRecent_cells)
  for (int y = 0; y < kRecent_cells; ++y) {
    HP_LOOP_BOUND(kRecent_cells)
    for (int x = 0; x < kRecent_cells; ++x) {
      const uint32_t seen = recent_[y * kRecent_cells + x];
      if (seen == 0 || ((tick_ - seen) & kTickMask) >= ticks) continue;
      const Cell cell = {Unwrapped(x, vehicle_.x), Unwrapped(y, vehicle_.y)};
      if ((seen & ~(kTickMask | kPersonBit)) != (Tag(cell) | kUsedBit)) continue;
      TestCell(cell, (seen & kPersonBit) != 0);
    }
  }
}

// By the point of its square that is nearest to where the chord is nearest to its middle. Not
// inlined: its rounds are counted (config/timing.toml).
[[gnu::noinline]] void Corridor::TestCell(Cell cell, bool is_person) {
  const Vec2 middle = CellCenter(cell);
  constexpr float kHalf_m = 0.5f * kCellSize_m;
  // Half a cell, and as much again against rounding.
  const bool is_near =
      middle.x_m >= low_.x_m - kCellSize_m && middle.x_m <= high_.x_m + kCellSize_m &&
      middle.y_m >= low_.y_m - kCellSize_m && middle.y_m <= high_.y_m + kCellSize_m;
  if (!is_near || !MayTest(chords_)) return;
  HP_LOOP_BOUND(kMaxChords)
  for (int k = 0; k < chords_; ++k) {
    const Chord& chord = chord_[k];
    const Vec2 arm = {middle.x_m - chord.from.x_m, middle.y_m - chord.from.y_m};
    const float along_m = arm.x_m * chord.direction.x_m + arm.y_m * chord.direction.y_m;
    if (chord.along_m + along_m < chord_[0].along_m) continue;
    const float on_m = Clamp(along_m, 0.0f, chord.length_m);
    const float dx_m = Max(0.0f, Abs(arm.x_m - on_m * chord.direction.x_m) - kHalf_m);
    const float dy_m = Max(0.0f, Abs(arm.y_m - on_m * chord.direction.y_m) - kHalf_m);
    if (dx_m * dx_m + dy_m * dy_m > chord.radius_m * chord.radius_m) continue;
    Take(chord.along_m + along_m - kHalf_m, is_person);
  }
}

WayAhead Corridor::Ahead(const SpeedParams& speed, const VehicleParams& vehicle, float along_m,
                         float speed_mps, float commanded_mps, bool reverse) const {
  if (!has_obstacle_) return WayAhead::kClear;
  const float gap_m = obstacle_along_m_ - along_m - LeadingEdgeOf(vehicle, reverse);
  const float real_mps = Max(speed_mps, 0.0f);
  const float told_mps = Max(commanded_mps, 0.0f);
  if (!IsFinite(gap_m) || !IsFinite(speed_mps) || !IsFinite(commanded_mps)) {
    return WayAhead::kTooNear;
  }
  if (gap_m > StoppingDistance(speed, Max(real_mps, told_mps))) return WayAhead::kClear;
  const float way_m = real_mps * speed.stopping_lag_s + told_mps * speed.stopping_dead_time_s +
                      told_mps * told_mps / (2.0f * speed.max_deceleration_mps2);
  return gap_m < way_m ? WayAhead::kTooNear : WayAhead::kObstacle;
}

}  // namespace hardpack
