// SPDX-License-Identifier: Apache-2.0
#include "core/safety/motion_sweep.h"

#include <bit>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

namespace hardpack {
namespace {

constexpr int32_t kSide = MotionSweep::kSide_cells;
constexpr uint32_t kMask = kSide - 1;
static_assert((kSide & (kSide - 1)) == 0);
static_assert(kSide == 64, "a row is a word");
constexpr int32_t kAllParts = MotionSweep::kParts * MotionSweep::kParts;
static_assert(kAllParts == 64, "so are the parts of a cell");
constexpr uint64_t kWhole = ~uint64_t{0};

int32_t Place(int32_t cell) {
  return static_cast<int32_t>(static_cast<uint32_t>(cell) & kMask);
}

int PartsIndex(Cell cell) {
  return Place(cell.y) * kSide + Place(cell.x);
}

int PartOf(float coordinate_cells, int32_t cell) {
  constexpr float kOf = MotionSweep::kParts;
  return ClampInt(FloorToInt((coordinate_cells - static_cast<float>(cell)) * kOf), 0,
                  MotionSweep::kParts - 1);
}

}  // namespace

void MotionSweep::Configure(const Footprint& footprint, float margin_m) {
  footprint_ = footprint;
  margin_m_ = margin_m;
  const float reach_m = footprint.pivot_radius_m + margin_m + kCellDiagonal_m;
  reach_cells_ = FloorToInt(Min(reach_m * kCellsPerMeter, 1.0e6f)) + 1;
  Reset();
}

void MotionSweep::Reset() {
  has_vehicle_ = false;
  tests_left_ = kMaxTests;
  HP_LOOP_BOUND(kSide)
  for (int32_t y = 0; y < kSide; ++y) ClearRow(y);
}

bool MotionSweep::IsInside(Cell cell) const {
  const uint32_t dx = static_cast<uint32_t>(cell.x) - static_cast<uint32_t>(low_.x);
  const uint32_t dy = static_cast<uint32_t>(cell.y) - static_cast<uint32_t>(low_.y);
  return dx < kSide && dy < kSide;
}

void MotionSweep::ClearRow(int32_t y) {
  const int32_t row = Place(y);
  mapped_[row] = 0;
  waiting_[row] = 0;
  fresh_[row] = 0;
  HP_LOOP_BOUND(kSide)
  for (int32_t x = 0; x < kSide; ++x) parts_[row * kSide + x] = 0;
}

void MotionSweep::ClearColumn(int32_t x) {
  const int32_t column = Place(x);
  const uint64_t others = ~(uint64_t{1} << column);
  HP_LOOP_BOUND(kSide)
  for (int32_t row = 0; row < kSide; ++row) {
    mapped_[row] &= others;
    waiting_[row] &= others;
    fresh_[row] &= others;
    parts_[row * kSide + column] = 0;
  }
}

void MotionSweep::Advance(Vec2 vehicle_odom) {
  if (!IsFinite(vehicle_odom)) return;
  constexpr int32_t kMostSteps = 8;
  tests_left_ = kMaxTests;
  const Cell middle = CellAt(vehicle_odom);
  const Cell low = {middle.x - kSide / 2, middle.y - kSide / 2};
  const int64_t dx = int64_t{low.x} - low_.x;
  const int64_t dy = int64_t{low.y} - low_.y;
  const bool is_far = dx < -kMostSteps || dx > kMostSteps || dy < -kMostSteps || dy > kMostSteps;
  if (!has_vehicle_ || is_far) {
    Reset();
    low_ = low;
    has_vehicle_ = true;
    return;
  }
  // A row that leaves on one side comes in on the other: it has the same place.
  HP_LOOP_BOUND(kMostSteps)
  for (int32_t step = 0; low_.x != low.x && step < kMostSteps; ++step) {
    const bool grows = low.x > low_.x;
    ClearColumn(grows ? low_.x : low_.x - 1);
    low_.x += grows ? 1 : -1;
  }
  HP_LOOP_BOUND(kMostSteps)
  for (int32_t step = 0; low_.y != low.y && step < kMostSteps; ++step) {
    const bool grows = low.y > low_.y;
    ClearRow(grows ? low_.y : low_.y - 1);
    low_.y += grows ? 1 : -1;
  }
}

void MotionSweep::File(Vec2 point_odom) {
  if (!has_vehicle_ || !IsFinite(point_odom)) return;
  const Cell cell = CellAt(point_odom);
  if (!IsInside(cell)) return;
  fresh_[Place(cell.y)] |= uint64_t{1} << Place(cell.x);
  const int part = PartOf(point_odom.y_m * kCellsPerMeter, cell.y) * kParts +
                   PartOf(point_odom.x_m * kCellsPerMeter, cell.x);
  parts_[PartsIndex(cell)] |= uint64_t{1} << part;
}

void MotionSweep::MapBegun() {
  HP_LOOP_BOUND(kSide)
  for (int32_t row = 0; row < kSide; ++row) {
    waiting_[row] |= fresh_[row];
    fresh_[row] = 0;
  }
}

void MotionSweep::MapDone(const Costmap& map) {
  if (!has_vehicle_) return;
  HP_LOOP_BOUND(kSide)
  for (int32_t y = 0; y < kSide; ++y) TakeRow(map, low_.y + y);
}

// What is not hard any more leaves no part of itself.
void MotionSweep::TakeRow(const Costmap& map, int32_t y) {
  const int32_t row = Place(y);
  mapped_[row] = 0;
  waiting_[row] = 0;
  HP_LOOP_BOUND(kSide)
  for (int32_t x = low_.x; x < low_.x + kSide; ++x) {
    const Cell cell = {x, y};
    const bool is_hard =
        map.window.Contains(cell) && (map.flags[map.window.Index(cell)] & Costmap::kHard) != 0;
    const uint64_t bit = uint64_t{1} << Place(x);
    if (is_hard) mapped_[row] |= bit;
    if (!is_hard && (fresh_[row] & bit) == 0) parts_[PartsIndex(cell)] = 0;
  }
}

bool MotionSweep::IsHard(Cell cell) const {
  if (!has_vehicle_ || !IsInside(cell)) return false;
  return (Occupied(Place(cell.y)) >> Place(cell.x) & 1u) != 0;
}

// Of cells x .. x + columns - 1 of a row, the first one's lowest. Precondition: columns < 64.
uint64_t MotionSweep::BitsOf(int32_t y, int32_t x, int32_t columns) const {
  return std::rotr(Occupied(Place(y)), Place(x)) & ((uint64_t{1} << columns) - 1u);
}

MotionSweep::Frame MotionSweep::FrameOf(const SweptPose& swept) const {
  const SinCosPair heading = SinCos(WrapAngle(swept.pose.theta_rad));
  const float share = Min(
      kLeastMarginShare + (1.0f - kLeastMarginShare) * Abs(swept.speed_mps) / kFullMarginSpeed_mps,
      1.0f);
  const float along_m = Min(swept.along_m, kMaxOff_m);
  const float aside_m = Min(swept.aside_m, kMaxOff_m);
  const float off_cells = Max(along_m, aside_m) * kCellsPerMeter;
  const int32_t beyond_cells = off_cells > 0.0f ? FloorToInt(off_cells) + 1 : 0;
  return {.origin = {swept.pose.x_m, swept.pose.y_m},
          .cos = heading.cos,
          .sin = heading.sin,
          .along_m = share * margin_m_ + along_m,
          .aside_m = share * margin_m_ + aside_m,
          .reach_cells = ClampInt(reach_cells_ + beyond_cells, 0, kMaxReach_cells)};
}

MotionSweep::Depth MotionSweep::DepthOf(const Frame& frame, Vec2 point_odom) const {
  const float dx_m = point_odom.x_m - frame.origin.x_m;
  const float dy_m = point_odom.y_m - frame.origin.y_m;
  const float ahead_m = frame.cos * dx_m + frame.sin * dy_m - footprint_.middle_m();
  const float left_m = frame.cos * dy_m - frame.sin * dx_m;
  return {.along_m = footprint_.half_length_m() - Abs(ahead_m),
          .aside_m = footprint_.half_width_m - Abs(left_m)};
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] bool MotionSweep::TouchesCell(Cell cell, const Frame& frame,
                                                const Frame& start) const {
  const float middle_m = DepthOf(frame, CellCenter(cell)).Within(frame.along_m, frame.aside_m);
  if (middle_m < -0.5f * kCellDiagonal_m) return false;
  const uint64_t known = parts_[PartsIndex(cell)];
  uint64_t parts = known != 0 ? known : kWhole;
  constexpr float kOf = kParts;
  HP_LOOP_BOUND(kAllParts)
  while (parts != 0) {
    const int part = std::countr_zero(parts);
    parts &= parts - 1;
    const int part_row = part / kParts;
    const auto column = static_cast<float>(part - part_row * kParts);
    const auto row = static_cast<float>(part_row);
    const Vec2 point = {(static_cast<float>(cell.x) + (column + 0.5f) / kOf) / kCellsPerMeter,
                        (static_cast<float>(cell.y) + (row + 0.5f) / kOf) / kCellsPerMeter};
    const Depth depth = DepthOf(frame, point);
    const bool is_near = depth.Within(frame.along_m, frame.aside_m) > 0.0f;
    const bool is_deeper =
        depth.Within(0.0f, 0.0f) > DepthOf(start, point).Within(0.0f, 0.0f) + kDeeper_m;
    if (is_near & is_deeper) return true;  // not &&: one way on, so that the loop stays one
  }
  return false;
}

bool MotionSweep::TouchesAt(const Frame& frame, const Frame& start) {
  const Cell middle = CellAt(frame.origin);
  const int32_t columns = 2 * frame.reach_cells + 1;
  HP_LOOP_BOUND(2 * kMaxReach_cells + 1)
  for (int32_t y = middle.y - frame.reach_cells; y <= middle.y + frame.reach_cells; ++y) {
    const int32_t first_x = middle.x - frame.reach_cells;
    // What lies beyond the square has the place of something within.
    if (!IsInside({first_x, y}) || !IsInside({first_x + columns - 1, y})) continue;
    uint64_t bits = BitsOf(y, first_x, columns);
    HP_LOOP_BOUND(2 * kMaxReach_cells + 1)
    while (bits != 0) {
      const Cell cell = {first_x + std::countr_zero(bits), y};
      bits &= bits - 1;
      if (tests_left_ <= 0) return true;
      --tests_left_;
      if (TouchesCell(cell, frame, start)) return true;
    }
  }
  return false;
}

SweepResult MotionSweep::Try(std::span<const SweptPose> motion) {
  SweepResult result;
  if (!has_vehicle_ || motion.empty()) return result;
  const Frame start = FrameOf(motion[0]);
  HP_LOOP_BOUND(kMaxPoses)
  for (const SweptPose& swept : motion) {
    if (reach_cells_ <= kMaxReach_cells && !TouchesAt(FrameOf(swept), start)) continue;
    result.clear = false;
    result.impact_mps = Abs(swept.speed_mps);
    return result;
  }
  return result;
}

}  // namespace hardpack
