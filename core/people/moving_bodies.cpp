// SPDX-License-Identifier: Apache-2.0
#include "core/people/moving_bodies.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"

namespace hardpack {
namespace {

constexpr float kNothing_m = 1.0e6f;  // a column without a return
constexpr float kSameBody_m = 0.4f;   // from a column's return to the next one's
constexpr float kGate_m = 0.15f;
constexpr int kLeastColumns = 2;

}  // namespace

void MovingBodies::Reset() {
  bodies_.Clear();
  run_ = Run{};
  before_m_ = kNothing_m;
}

// What was seen up to here is a body of a person's size, and what follows is farther away.
bool MovingBodies::EndRun(float next_m, Vec2& body_odom) const {
  const Run& run = run_;
  const Vec2 size = {run.high_odom.x_m - run.low_odom.x_m, run.high_odom.y_m - run.low_odom.y_m};
  const bool is_narrow = size.x_m * size.x_m + size.y_m * size.y_m <= kWidest_m * kWidest_m;
  const bool is_body = run.columns >= kLeastColumns && run.stands_out && is_narrow &&
                       next_m > run.last_m + kBeside_m;
  if (!is_body) return false;
  const float share = 1.0f / static_cast<float>(run.columns);
  body_odom = {share * run.sum_odom.x_m, share * run.sum_odom.y_m};
  return true;
}

bool MovingBodies::Column(bool has_return, Vec2 nearest_odom, float distance_m, uint64_t now_ns,
                          Vec2& body_odom) {
  const bool is_seen = has_return && IsFinite(nearest_odom) && IsFinite(distance_m);
  const float here_m = is_seen ? distance_m : kNothing_m;
  Run& run = run_;
  const bool goes_on =
      is_seen && run.columns > 0 && AreWithin(nearest_odom, run.last_odom, kSameBody_m);
  bool is_body = false;
  if (!goes_on) {
    is_body = EndRun(here_m, body_odom);
    run = Run{};
    run.stands_out = before_m_ > here_m + kBeside_m;
    run.low_odom = nearest_odom;
    run.high_odom = nearest_odom;
  }
  before_m_ = here_m;
  if (!is_seen) return is_body;
  HP_LOOP_BOUND(kMost)
  for (Body& body : bodies_) {
    if (AreWithin(nearest_odom, body.origin_odom, kLeft_m)) body.origin_seen_ns = now_ns;
  }
  ++run.columns;
  run.low_odom = {Min(run.low_odom.x_m, nearest_odom.x_m), Min(run.low_odom.y_m, nearest_odom.y_m)};
  run.high_odom = {Max(run.high_odom.x_m, nearest_odom.x_m),
                   Max(run.high_odom.y_m, nearest_odom.y_m)};
  run.sum_odom = {run.sum_odom.x_m + nearest_odom.x_m, run.sum_odom.y_m + nearest_odom.y_m};
  run.last_odom = nearest_odom;
  run.last_m = here_m;
  return is_body;
}

bool MovingBodies::FreeCells::Has(Vec2 place_odom) const {
  const Cell cell = CellAt(place_odom);
  const int64_t dx = int64_t{cell.x} - middle.x + kReach_cells;
  const int64_t dy = int64_t{cell.y} - middle.y + kReach_cells;
  const bool is_around = dx >= 0 && dx < kAround_cells && dy >= 0 && dy < kAround_cells;
  return is_around && (rows[dy] >> dx & 1) != 0;
}

void MovingBodies::Remember(Vec2 place_odom, uint64_t now_ns, const HeightGrid& heights,
                            Body& body) {
  body.origin_odom = place_odom;
  body.origin_ns = now_ns;
  body.origin_seen_ns = now_ns;
  body.moved_looks = 0;
  FreeCells& around = body.around_origin;
  around.middle = CellAt(place_odom);
  HP_LOOP_BOUND(kAround_cells)
  for (int dy = 0; dy < kAround_cells; ++dy) {
    uint32_t row = 0;
    HP_LOOP_BOUND(kAround_cells)
    for (int dx = 0; dx < kAround_cells; ++dx) {
      const Cell cell = {SaturatedSum(around.middle.x, dx - kReach_cells),
                         SaturatedSum(around.middle.y, dy - kReach_cells)};
      row |= (heights.IsFree(cell) ? 1u : 0u) << dx;
    }
    around.rows[dy] = static_cast<uint16_t>(row);
  }
}

// The nearest one seen lately whose gate the place is in; -1: none.
int MovingBodies::BodyOf(Vec2 place_odom, uint64_t now_ns) const {
  int nearest = -1;
  float nearest_m2 = 0.0f;
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < bodies_.size(); ++k) {
    const Body& body = bodies_[k];
    if (now_ns - body.seen_ns > kUnseen_ns) continue;
    const float gate_m = kGate_m + kFastest_mps * SecondsBetween(body.seen_ns, now_ns);
    const Vec2 off = Minus(body.place_odom, place_odom);
    const float off_m2 = off.x_m * off.x_m + off.y_m * off.y_m;
    if (off_m2 > gate_m * gate_m || (nearest >= 0 && off_m2 >= nearest_m2)) continue;
    nearest = k;
    nearest_m2 = off_m2;
  }
  return nearest;
}

// In the place of one that is not seen any more, or of the farthest.
void MovingBodies::Begin(Vec2 place_odom, uint64_t now_ns, Vec2 here_odom,
                         const HeightGrid& heights) {
  int free = -1;
  float free_m2 = 0.0f;
  HP_LOOP_BOUND(kMost)
  for (int k = 0; k < bodies_.size(); ++k) {
    const Vec2 off = Minus(bodies_[k].place_odom, here_odom);
    const bool is_gone = now_ns - bodies_[k].seen_ns > kUnseen_ns;
    const float off_m2 = is_gone ? kNothing_m * kNothing_m : off.x_m * off.x_m + off.y_m * off.y_m;
    if (bodies_[k].moves && !is_gone) continue;
    if (free >= 0 && off_m2 <= free_m2) continue;
    free = k;
    free_m2 = off_m2;
  }
  const Vec2 off = Minus(place_odom, here_odom);
  if (!bodies_.full() && free_m2 < kNothing_m * kNothing_m) {
    free = bodies_.size();
    bodies_.Resize(free + 1);
  } else if (free < 0 || off.x_m * off.x_m + off.y_m * off.y_m >= free_m2) {
    return;
  }
  Body& body = bodies_[free];
  body.place_odom = place_odom;
  body.seen_ns = now_ns;
  body.moves = false;
  Remember(place_odom, now_ns, heights, body);
}

bool MovingBodies::Look(Vec2 body_odom, uint64_t now_ns, Vec2 here_odom,
                        const HeightGrid& heights) {
  if (!IsFinite(body_odom)) return false;
  const int k = BodyOf(body_odom, now_ns);
  if (k < 0) {
    Begin(body_odom, now_ns, here_odom, heights);
    return false;
  }
  Body& body = bodies_[k];
  body.place_odom = body_odom;
  body.seen_ns = now_ns;
  // What goes along a fence or a hedge is another piece of it: the first one is still there.
  const bool has_left = now_ns - body.origin_seen_ns > kLeft_ns;
  const bool has_moved = has_left && !AreWithin(body_odom, body.origin_odom, kMoved_m) &&
                         body.around_origin.Has(body_odom);
  if (!has_moved) body.moved_looks = 0;
  // Several pieces of a bush in one revolution are one look.
  if (has_moved && (body.moved_looks == 0 || now_ns - body.moved_ns >= kLooksApart_ns)) {
    if (body.moved_looks == 0) body.moved_odom = body_odom;
    ++body.moved_looks;
    body.moved_ns = now_ns;
  }
  const bool goes_on = !AreWithin(body_odom, body.moved_odom, kGoesOn_m);
  body.moves = body.moves || (body.moved_looks >= kSureLooks && goes_on);
  const bool is_old = now_ns - body.origin_ns > kMemory_ns;
  const bool is_far =
      !AreWithin(body_odom, body.origin_odom, kCellSize_m * static_cast<float>(kReach_cells - 1));
  if (!body.moves && (is_old || is_far)) Remember(body_odom, now_ns, heights, body);
  return body.moves;
}

}  // namespace hardpack
