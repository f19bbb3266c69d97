// SPDX-License-Identifier: Apache-2.0
#include "core/astar/astar.h"

#include <bit>

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

// The search of a bucket queue (R. Dial, "Algorithm 360", CACM 1969) with A*'s f as its key.
//
// The heuristic h is the octile norm with the edges' own lengths: the least cost on a free plane.
// It is consistent, as for neighbours a, b: h(a) <= length(a, b) + h(b), the triangle inequality,
// and length <= EdgeCost. So f = g + h never falls along a path, each cell is expanded once, at its
// least g, and least_f_ only rises.
//
// Why 4096 buckets are enough: a step from a cell with f to its neighbour changes f by EdgeCost +
// h' - h, which lies in [0, kMaxEdgeCost + kDiagonalLength]. Every cell of the open set was reached
// from an expanded one with f <= least_f_, and the open set's least f is at least least_f_. So all
// f in the open set lie within that span of least_f_, and f modulo 4096 tells them apart. Two
// values of g for one cell of the open set differ as much as their f, so 16 bits of g tell which is
// less.

namespace hardpack {
namespace {

// A node: links of its bucket's list, g modulo 2^16, the direction of the step from its parent,
// what became of it, and the query that wrote it. A node of another epoch is a cell not seen yet,
// so nothing needs clearing between queries.
//   63      46 45      28 27   12 11      9 8   7 6     0
//   |  next   |   prev   |   g   | direction | state | epoch |
// next of a list's last cell is the cell itself; prev of its first one means nothing.
constexpr uint32_t kEpochMask = 0x7f;
constexpr uint32_t kLastEpoch = kEpochMask;
constexpr uint32_t kOpen = 1u << 7;
constexpr uint32_t kClosed = 2u << 7;
constexpr uint32_t kOnPath = 3u << 7;
constexpr uint32_t kStateMask = 3u << 7;
constexpr uint32_t kDirectionShift = 9;
constexpr uint32_t kDirectionMask = 7u << kDirectionShift;
constexpr uint32_t kGShift = 12;
constexpr uint32_t kPrevShift = 28;
constexpr uint32_t kNextShift = 46;
constexpr uint64_t kIndexMask = kMapCells - 1;
constexpr uint64_t kFieldsMask = (uint64_t{1} << kPrevShift) - 1;  // all but the links
static_assert(kMapCells == 1 << 18);

constexpr uint32_t kSize = kMapSize_cells;
static_assert(kSize == 512);
constexpr uint32_t kColumnMask = kSize - 1;
constexpr uint32_t kRowShift = 9;

// Directions are numbered anticlockwise from +x; the odd ones are diagonal.
//   3 2 1
//   4 . 0
//   5 6 7
constexpr int kDirections = 8;
constexpr uint32_t kOdd = 0xaa;
constexpr uint32_t kAllDirections = 0xff;
constexpr int32_t kDx[kDirections] = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr int32_t kDy[kDirections] = {0, 1, 1, 1, 0, -1, -1, -1};
// Index differences, as unsigned numbers that wrap.
constexpr uint32_t kStep[kDirections] = {1u,  513u,      512u,      511u,
                                         ~0u, 0u - 513u, 0u - 512u, 0u - 511u};

static_assert(kMaxEdgeCost + kDiagonalLength < 4096);
// The dearest path fits 32 bits: every cell of the map once.
static_assert(int64_t{kMapCells} * kMaxEdgeCost < INT32_MAX);

uint32_t Neighbour(uint32_t index, uint32_t direction) {
  return index + kStep[direction];
}

// The directions that may be taken: those not blocked, the diagonal ones only if neither direction
// beside them is blocked. blocked: a bit a direction.
uint32_t WithoutCutCorners(uint32_t blocked) {
  const uint32_t wrapped = blocked | blocked << 8;
  const uint32_t beside = (wrapped >> 1 | wrapped >> 7) & kOdd;
  return ~(blocked | beside) & kAllDirections;
}

// One bit a direction: the neighbour may not be entered from here. For any cell.
uint32_t BlockedNear(const Costmap& map, uint32_t index) {
  const int32_t x = static_cast<int32_t>(index & kColumnMask);
  const int32_t y = static_cast<int32_t>(index >> kRowShift);
  // A cell that is not lethal has no depth, whatever the map says there.
  const int depth2 = map.Lethal(static_cast<int>(index)) ? map.hard_depth2[index] : 0;
  uint32_t blocked = 0;
  HP_LOOP_BOUND(kDirections)
  for (uint32_t direction = 0; direction < kDirections; ++direction) {
    const int32_t nx = x + kDx[direction];
    const int32_t ny = y + kDy[direction];
    const bool on_map = nx >= 0 && nx < kMapSize_cells && ny >= 0 && ny < kMapSize_cells;
    const uint32_t neighbour = on_map ? Neighbour(index, direction) : index;
    const bool lethal = map.Lethal(static_cast<int>(neighbour));
    if (!on_map || (lethal && map.hard_depth2[neighbour] >= depth2)) blocked |= 1u << direction;
  }
  return blocked;
}

uint32_t LethalBit(const Costmap& map, uint32_t index) {
  constexpr uint32_t kLethalShift = std::countr_zero(uint32_t{Costmap::kLethal});
  return (uint32_t{map.flags[index]} >> kLethalShift) & 1u;
}

// The same, for a cell that is not lethal and not at the map's border: nearly every cell.
uint32_t BlockedNearInner(const Costmap& map, uint32_t index) {
  return LethalBit(map, index + 1) | LethalBit(map, index + 513) << 1 |
         LethalBit(map, index + 512) << 2 | LethalBit(map, index + 511) << 3 |
         LethalBit(map, index - 1) << 4 | LethalBit(map, index - 513) << 5 |
         LethalBit(map, index - 512) << 6 | LethalBit(map, index - 511) << 7;
}

bool IsInner(uint32_t index) {
  const uint32_t x = index & kColumnMask;
  const uint32_t y = index >> kRowShift;
  return x - 1 < kSize - 2 && y - 1 < kSize - 2;
}

// The directions worth taking after a step in `direction`: straight on and up to a right angle to
// either side. The other three lead back, or to a cell that the parent reaches by a straight step:
// at the price of that cell alone, less than by way of here. (Legal from here, they are legal from
// the parent: a straight step needs nothing but the cell itself, and the depth it must undercut is
// greater there.)
uint32_t WorthTaking(uint32_t direction) {
  constexpr uint32_t kAhead = 0x1f;  // directions 0 to 4, ahead of direction 2
  return std::rotl(static_cast<uint8_t>(kAhead), static_cast<int>(direction) - 2);
}

// Of the step into the cell.
uint32_t CostInto(const Costmap& map, uint32_t index, uint32_t direction) {
  const int cost_q8 = map.cost_q8[index] < kMaxCost_q8 ? map.cost_q8[index] : kMaxCost_q8;
  const int length = (direction & 1u) != 0 ? kDiagonalLength : kStraightLength;
  return static_cast<uint32_t>(EdgeCost(length, cost_q8));
}

// Precondition: not 0. In halves, as for 64 bits a 32-bit processor calls its compiler's library.
uint32_t LowestBit(uint64_t bits) {
  const uint32_t low = static_cast<uint32_t>(bits);
  if (low != 0) return static_cast<uint32_t>(std::countr_zero(low));
  return 32 + static_cast<uint32_t>(std::countr_zero(static_cast<uint32_t>(bits >> 32)));
}

bool IsFinitePoint(Vec2 point) {
  return IsFinite(point.x_m) && IsFinite(point.y_m);
}

}  // namespace

Status AstarSearch::Begin(const Costmap& map, const AstarParams& params, Vec2 start_odom,
                          Vec2 goal_odom) {
  result_ = AstarResult{};
  window_ = map.window;
  phase_ = Phase::kDone;
  if (!IsFinitePoint(start_odom) || !IsFinitePoint(goal_odom))
    return result_.status = Status::kNotFinite;
  if (params.max_expansions < 1 || params.max_expansions > kMapCells ||
      params.move_goal_out_of_obstacle < 0 || params.move_goal_out_of_obstacle > 1) {
    return result_.status = Status::kParameterOutOfRange;
  }
  result_.start = CellAt(start_odom);
  if (!window_.Contains(result_.start)) return result_.status = Status::kStartOutsideMap;
  const Cell asked = CellAt(goal_odom);
  result_.goal = window_.Nearest(asked);
  result_.goal_outside_map = result_.goal != asked;

  const int start = window_.Index(result_.start);
  const int goal = window_.Index(result_.goal);
  result_.start_in_obstacle = map.Lethal(start);
  result_.goal_moved = map.Lethal(goal);
  if (result_.goal_moved && params.move_goal_out_of_obstacle == 0) {
    result_.goal_moved = false;
    return result_.status = Status::kGoalInObstacle;
  }
  start_ = static_cast<uint32_t>(start);
  goal_ = static_cast<uint32_t>(goal);
  max_expansions_ = params.max_expansions;
  row_ = 0;
  nearest_distance2_cells2_ = INT32_MAX;
  const bool must_clear = epoch_ == 0 || epoch_ == kLastEpoch;
  epoch_ = must_clear ? 1 : epoch_ + 1;
  phase_ = must_clear ? Phase::kClear : result_.goal_moved ? Phase::kMoveGoal : Phase::kSearch;
  if (phase_ == Phase::kSearch) StartSearch();
  return Status::kOk;
}

Progress AstarSearch::Step(const Costmap& map, int units) {
  if (phase_ == Phase::kClear) units = ClearNodes(units);
  if (phase_ == Phase::kMoveGoal) units = MoveGoal(map, units);
  if (phase_ == Phase::kSearch) units = Search(map, units);
  if (phase_ == Phase::kTrace) units = Trace(units);
  return phase_ == Phase::kDone ? Progress::kDone : Progress::kBusy;
}

Cell AstarSearch::Next(Cell cell) const {
  const uint32_t index = static_cast<uint32_t>(window_.Index(cell));
  const uint32_t node = static_cast<uint32_t>(nodes_[index]);
  HP_ASSERT(IsUsable(result_.status) && cell != result_.end);
  HP_ASSERT((node & (kStateMask | kEpochMask)) == (kOnPath | epoch_));
  const uint32_t direction = (node & kDirectionMask) >> kDirectionShift;
  return {cell.x + kDx[direction], cell.y + kDy[direction]};
}

// The phases: each does at most `units` units and returns those left over.

int AstarSearch::ClearNodes(int units) {
  HP_LOOP_BOUND(kMapSize_cells)
  while (units > 0 && row_ < kMapSize_cells) {
    uint64_t* const row = nodes_ + row_ * kMapSize_cells;
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) row[x] = 0;
    ++row_;
    --units;
  }
  if (row_ < kMapSize_cells) return units;
  row_ = 0;
  phase_ = result_.goal_moved ? Phase::kMoveGoal : Phase::kSearch;
  if (phase_ == Phase::kSearch) StartSearch();
  return units;
}

int AstarSearch::MoveGoal(const Costmap& map, int units) {
  const int32_t goal_x = static_cast<int32_t>(goal_ & kColumnMask);
  const int32_t goal_y = static_cast<int32_t>(goal_ >> kRowShift);
  HP_LOOP_BOUND(kMapSize_cells)
  while (units > 0 && row_ < kMapSize_cells) {
    const int32_t dy = row_ - goal_y;
    HP_LOOP_BOUND(kMapSize_cells)
    for (int32_t x = 0; x < kMapSize_cells; ++x) {
      const int index = row_ * kMapSize_cells + x;
      const int32_t distance2_cells2 = (x - goal_x) * (x - goal_x) + dy * dy;
      if (!map.Lethal(index) && distance2_cells2 < nearest_distance2_cells2_) {
        nearest_distance2_cells2_ = distance2_cells2;
        nearest_goal_ = static_cast<uint32_t>(index);
      }
    }
    ++row_;
    --units;
  }
  if (row_ < kMapSize_cells) return units;
  if (nearest_distance2_cells2_ == INT32_MAX) {
    Finish(Status::kStartEnclosed);  // every cell is lethal, the start too
    return units;
  }
  goal_ = nearest_goal_;
  result_.goal = window_.FromIndex(static_cast<int>(goal_));
  phase_ = Phase::kSearch;
  StartSearch();
  return units;
}

int AstarSearch::Search(const Costmap& map, int units) {
  // Each unit but the last closes a cell; a map without a free goal is never searched.
  HP_LOOP_BOUND(kMapCells)
  while (units > 0 && phase_ == Phase::kSearch) {
    --units;
    if (bucket_words_used_ == 0) {
      Finish(best_heuristic_ == UINT32_MAX ? Status::kStartEnclosed : Status::kNoPath);
    } else if (result_.expansions == max_expansions_) {
      BeginTrace(best_, best_cost_, true);
    } else {
      Expand(map, PopFirst());
    }
  }
  return units;
}

// Walks back from the end and turns the directions round, so that each cell of the path says where
// the next one is.
int AstarSearch::Trace(int units) {
  HP_LOOP_BOUND(kMapCells)
  while (units > 0 && phase_ == Phase::kTrace) {
    --units;
    ++result_.path_cells;
    const uint32_t node = static_cast<uint32_t>(nodes_[trace_cell_]);
    const uint32_t into = (node & kDirectionMask) >> kDirectionShift;
    nodes_[trace_cell_] = kOnPath | epoch_ | uint64_t{trace_direction_} << kDirectionShift;
    if (trace_cell_ == start_) {
      Finish(UsableStatus());
    } else {
      trace_cell_ -= kStep[into];
      trace_direction_ = into;
    }
  }
  return units;
}

void AstarSearch::StartSearch() {
  HP_LOOP_BOUND(kBucketWords)
  for (uint64_t& word : bucket_used_) word = 0;
  bucket_words_used_ = 0;
  best_ = start_;
  best_heuristic_ = UINT32_MAX;
  best_cost_ = 0;
  least_f_ = Heuristic(start_);
  Link(start_, least_f_ % kBuckets, kOpen | epoch_);
}

void AstarSearch::Expand(const Costmap& map, uint32_t index) {
  const uint32_t node = static_cast<uint32_t>(nodes_[index]);
  const uint32_t heuristic = Heuristic(index);
  const uint32_t g = least_f_ - heuristic;
  ++result_.expansions;
  if (index == goal_) {
    BeginTrace(goal_, g, false);
    return;
  }
  const bool lethal = LethalBit(map, index) != 0;
  // Of cells with one heuristic the first expanded has the least cost, as f never falls.
  if (heuristic < best_heuristic_ && !lethal) {
    best_ = index;
    best_heuristic_ = heuristic;
    best_cost_ = g;
  }
  const uint32_t blocked =
      IsInner(index) && !lethal ? BlockedNearInner(map, index) : BlockedNear(map, index);
  uint32_t directions = WithoutCutCorners(blocked);
  if (index != start_) directions &= WorthTaking((node & kDirectionMask) >> kDirectionShift);
  HP_LOOP_BOUND(kDirections)
  while (directions != 0) {
    const uint32_t direction = static_cast<uint32_t>(std::countr_zero(directions));
    directions &= directions - 1;
    const uint32_t neighbour = Neighbour(index, direction);
    Relax(neighbour, direction, g + CostInto(map, neighbour, direction));
  }
}

// A way to the cell at cost g was found. A closed cell stays closed, even if the caller broke its
// word and changed the map between two Steps: each cell is expanded once, so every loop is bounded.
inline void AstarSearch::Relax(uint32_t index, uint32_t direction, uint32_t g) {
  const uint64_t node = nodes_[index];
  const bool seen = (node & kEpochMask) == epoch_;
  if (seen) {
    const uint16_t less = static_cast<uint16_t>((node >> kGShift) - g);  // modulo 2^16
    const bool cheaper = less != 0 && less < 0x8000;
    if ((node & kStateMask) == kClosed || !cheaper) return;
  }
  const uint32_t heuristic = Heuristic(index);
  if (seen) {
    Unlink(index, (static_cast<uint32_t>(node >> kGShift) + heuristic) % kBuckets);
  }
  const uint64_t fields =
      (uint64_t{g} << kGShift & kFieldsMask) | direction << kDirectionShift | kOpen | epoch_;
  Link(index, (g + heuristic) % kBuckets, fields);
}

// Takes the cell that goes first out of the open set and closes it. Precondition: not empty.
inline uint32_t AstarSearch::PopFirst() {
  // The next bucket in use at or after the current one, round the circle.
  const uint32_t current = least_f_ % kBuckets;
  uint32_t word = current / 64;
  uint64_t bits = bucket_used_[word] & ~uint64_t{0} << current % 64;
  if (bits == 0) {
    const uint64_t later_words = bucket_words_used_ & ~uint64_t{1} << word;
    word = LowestBit(later_words != 0 ? later_words : bucket_words_used_);
    bits = bucket_used_[word];
  }
  const uint32_t bucket = word * 64 + LowestBit(bits);
  least_f_ += (bucket - current) % kBuckets;

  const uint32_t index = bucket_head_[bucket];
  const uint64_t node = nodes_[index];
  const uint32_t next = static_cast<uint32_t>(node >> kNextShift);
  bucket_head_[bucket] = next;
  if (next == index) UnmarkBucket(bucket);
  nodes_[index] = (node & kFieldsMask & ~uint64_t{kStateMask}) | kClosed;
  return index;
}

// Puts a cell in front of a bucket's list.
inline void AstarSearch::Link(uint32_t index, uint32_t bucket, uint64_t fields) {
  uint32_t next = index;
  if ((bucket_used_[bucket / 64] >> (bucket % 64) & 1u) != 0) {
    next = bucket_head_[bucket];
    SetPrev(next, index);
  } else {
    MarkBucket(bucket);
  }
  nodes_[index] = fields | uint64_t{next} << kNextShift;
  bucket_head_[bucket] = index;
}

// Takes a cell out of its bucket's list.
inline void AstarSearch::Unlink(uint32_t index, uint32_t bucket) {
  const uint64_t node = nodes_[index];
  const uint32_t next = static_cast<uint32_t>(node >> kNextShift);
  if (bucket_head_[bucket] == index) {
    bucket_head_[bucket] = next;
    if (next == index) UnmarkBucket(bucket);
    return;
  }
  const uint32_t prev = static_cast<uint32_t>(node >> kPrevShift & kIndexMask);
  if (next == index) {
    SetNext(prev, prev);
  } else {
    SetNext(prev, next);
    SetPrev(next, prev);
  }
}

inline void AstarSearch::SetNext(uint32_t index, uint32_t next) {
  nodes_[index] = (nodes_[index] & ~(kIndexMask << kNextShift)) | uint64_t{next} << kNextShift;
}

inline void AstarSearch::SetPrev(uint32_t index, uint32_t prev) {
  nodes_[index] = (nodes_[index] & ~(kIndexMask << kPrevShift)) | uint64_t{prev} << kPrevShift;
}

inline void AstarSearch::MarkBucket(uint32_t bucket) {
  bucket_used_[bucket / 64] |= uint64_t{1} << (bucket % 64);
  bucket_words_used_ |= uint64_t{1} << (bucket / 64);
}

inline void AstarSearch::UnmarkBucket(uint32_t bucket) {
  bucket_used_[bucket / 64] &= ~(uint64_t{1} << (bucket % 64));
  if (bucket_used_[bucket / 64] == 0) bucket_words_used_ &= ~(uint64_t{1} << (bucket / 64));
}

// 70 x straight + 99 x diagonal steps on a free plane.
inline uint32_t AstarSearch::Heuristic(uint32_t index) const {
  const int32_t dx =
      static_cast<int32_t>(index & kColumnMask) - static_cast<int32_t>(goal_ & kColumnMask);
  const int32_t dy =
      static_cast<int32_t>(index >> kRowShift) - static_cast<int32_t>(goal_ >> kRowShift);
  const uint32_t ax = static_cast<uint32_t>(dx < 0 ? -dx : dx);
  const uint32_t ay = static_cast<uint32_t>(dy < 0 ? -dy : dy);
  const uint32_t larger = ax < ay ? ay : ax;
  const uint32_t smaller = ax < ay ? ax : ay;
  return kStraightLength * (larger - smaller) + kDiagonalLength * smaller;
}

void AstarSearch::Finish(Status status) {
  result_.status = status;
  phase_ = Phase::kDone;
}

void AstarSearch::BeginTrace(uint32_t end, uint32_t cost, bool partial) {
  result_.end = window_.FromIndex(static_cast<int>(end));
  result_.cost = cost;
  result_.partial = partial;
  trace_cell_ = end;
  trace_direction_ = 0;
  phase_ = Phase::kTrace;
}

// The gravest of what holds.
Status AstarSearch::UsableStatus() const {
  if (result_.partial) return Status::kPartialPath;
  if (result_.start_in_obstacle) return Status::kStartInObstacle;
  if (result_.goal_moved) return Status::kGoalMoved;
  if (result_.goal_outside_map) return Status::kGoalOutsideMap;
  return Status::kOk;
}

}  // namespace hardpack
