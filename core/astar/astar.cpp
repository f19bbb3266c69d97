// SPDX-License-Identifier: Apache-2.0
#include "core/astar/astar.h"

#include <bit>

#include "core/astar/steps.h"
#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"

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
// f in the open set lie within that span of least_f_, and f modulo 4096 tells them apart.
//
// Why nothing is cleared and no cell is marked as closed: a cell's label is its g above a base that
// falls from query to query, so the labels left by earlier queries are larger than any of this one,
// and "not seen, or dearer than this way" is one comparison. An expanded cell has the least g there
// is, so no way to it compares as cheaper. That holds even if the map changes during the search, as
// EdgeCost is never less than the length.

namespace hardpack {

using namespace steps;

namespace {

// A node: its label, the links of its bucket's list, the direction of the step from its parent.
//   63   39 38    21 20     3 2         0
//   | label | next  | prev  | direction |
// next of a list's last cell is the cell itself; prev of its first one means nothing.
constexpr uint64_t kDirectionMask = 7;
constexpr uint32_t kPrevShift = 3;
constexpr uint32_t kNextShift = 21;
constexpr uint32_t kLabelShift = 39;
constexpr uint64_t kIndexMask = kMapCells - 1;
constexpr uint64_t kLinksMask = (uint64_t{1} << kLabelShift) - 1;  // all but the label
static_assert(kMapCells == 1 << 18);

// Labels. A query takes the kLabelsOfQuery ones below those of the query before it, enough for most
// paths. If its costs outgrow them, the labels are moved (Phase::kMoveLabels), which takes all.
constexpr uint32_t kLargestLabel = (1u << 25) - 1;  // a cell never seen
constexpr uint32_t kLabelsOfQuery = 1u << 18;

static_assert(kMaxEdgeCost + kDiagonalLength < 4096);
// The dearest path fits 32 bits: every cell of the map once.
static_assert(int64_t{kMapCells} * kMaxEdgeCost < INT32_MAX);

// The largest h on the map.
constexpr uint32_t kMaxHeuristic = kDiagonalLength * (kSize - 1);

// Moved labels have room for so large a rise of f, see Expand and MoveLabels.
constexpr uint32_t kRoomOfMove = kLargestLabel - kMaxHeuristic - 2 * 4096;
constexpr uint32_t kLargestF = kMapCells * uint32_t{kMaxEdgeCost} + kMaxHeuristic;
static_assert(kLargestF / kRoomOfMove + 2 <= AstarSearch::kMaxLabelMoves);

// A cell that was not observed is further than any that was: behind the front of what stands on the
// goal there seems to be room, and the vehicle would drive around it to look.
constexpr int32_t kUnseenGoal_cells2 = 1 << 20;
static_assert(kUnseenGoal_cells2 > 2 * kMapSize_cells * kMapSize_cells);
constexpr int32_t kRowMask = kMapSize_cells - 1;

// Precondition: not 0. In halves, as for 64 bits a 32-bit processor calls its compiler's library.
uint32_t LowestBit(uint64_t bits) {
  const uint32_t low = static_cast<uint32_t>(bits);
  if (low != 0) return static_cast<uint32_t>(std::countr_zero(low));
  return 32 + static_cast<uint32_t>(std::countr_zero(static_cast<uint32_t>(bits >> 32)));
}

}  // namespace

Status AstarSearch::Begin(const Costmap& map, const AstarParams& params, Vec2 start_odom,
                          Vec2 goal_odom) {
  result_ = AstarResult{};
  window_ = map.window;
  phase_ = Phase::kDone;
  if (!IsFinite(start_odom) || !IsFinite(goal_odom)) return result_.status = Status::kNotFinite;
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
  goal_limit_cells2_ = INT32_MAX;
  const bool must_clear = least_label_ < kLabelsOfQuery;
  ceiling_ = must_clear ? kLargestLabel : least_label_;
  base_ = ceiling_ - kLabelsOfQuery;
  least_label_ = must_clear ? 0 : base_;
  phase_ = must_clear ? Phase::kClear : result_.goal_moved ? Phase::kMoveGoal : Phase::kSearch;
  if (phase_ == Phase::kSearch) StartSearch();
  return Status::kOk;
}

Progress AstarSearch::Step(const Costmap& map, int units) {
  if (phase_ == Phase::kClear) units = ClearNodes(units);
  if (phase_ == Phase::kMoveGoal) units = MoveGoal(map, units);
  HP_LOOP_BOUND(2 * kMaxLabelMoves + 1)
  while (units > 0 && (phase_ == Phase::kSearch || phase_ == Phase::kMoveLabels)) {
    units = phase_ == Phase::kSearch ? Search(map, units) : MoveLabels(units);
  }
  if (phase_ == Phase::kTrace) units = Trace(units);
  return phase_ == Phase::kDone ? Progress::kDone : Progress::kBusy;
}

Cell AstarSearch::Next(Cell cell) const {
  const uint32_t index = static_cast<uint32_t>(window_.Index(cell));
  HP_ASSERT(IsUsable(result_.status) && cell != result_.end);
  const uint32_t direction = static_cast<uint32_t>(nodes_[index] & kDirectionMask);
  return {cell.x + kDx[direction], cell.y + kDy[direction]};
}

bool AstarSearch::HasReached(Cell cell) const {
  if (!window_.Contains(cell)) return false;
  return static_cast<uint32_t>(nodes_[window_.Index(cell)] >> kLabelShift) < ceiling_;
}

// The phases: each does at most `units` units and returns those left over.

int AstarSearch::ClearNodes(int units) {
  HP_LOOP_BOUND(kMapSize_cells)
  while (units > 0 && row_ < kMapSize_cells) {
    uint64_t* const row = nodes_ + row_ * kMapSize_cells;
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) row[x] = ~uint64_t{0};
    ++row_;
    --units;
  }
  if (row_ < kMapSize_cells) return units;
  row_ = 0;
  least_label_ = base_;
  phase_ = result_.goal_moved ? Phase::kMoveGoal : Phase::kSearch;
  if (phase_ == Phase::kSearch) StartSearch();
  return units;
}

// Twice over the map: how near to the goal a free cell is, then which of those that are about as
// near is best to drive to.
int AstarSearch::MoveGoal(const Costmap& map, int units) {
  HP_LOOP_BOUND(2 * kMapSize_cells)
  while (units > 0 && row_ < 2 * kMapSize_cells) {
    if (row_ == kMapSize_cells) LimitGoal();
    ScanForGoal(map, row_ & kRowMask, row_ < kMapSize_cells ? goal_ : start_);
    ++row_;
    --units;
  }
  if (row_ < 2 * kMapSize_cells) return units;
  if (nearest_distance2_cells2_ == INT32_MAX) {
    Finish(Status::kStartEnclosed);  // every cell is lethal, the start too
    return units;
  }
  row_ = 0;
  goal_ = nearest_goal_;
  result_.goal = window_.FromIndex(static_cast<int>(goal_));
  phase_ = Phase::kSearch;
  StartSearch();
  return units;
}

void AstarSearch::LimitGoal() {
  const bool is_unseen = nearest_distance2_cells2_ >= kUnseenGoal_cells2;
  const int32_t distance2_cells2 = nearest_distance2_cells2_ & (kUnseenGoal_cells2 - 1);
  const float reach_cells = Sqrt(static_cast<float>(distance2_cells2)) + kGoalReach_cells;
  goal_limit_cells2_ = FloorToInt(reach_cells * reach_cells) + (is_unseen ? kUnseenGoal_cells2 : 0);
  nearest_distance2_cells2_ = INT32_MAX;
}

// One row for the free cell nearest to `from`, of those within the limit of the goal.
void AstarSearch::ScanForGoal(const Costmap& map, int32_t row, uint32_t from) {
  const int32_t goal_x = static_cast<int32_t>(goal_ & kColumnMask);
  const int32_t goal_dy = row - static_cast<int32_t>(goal_ >> kRowShift);
  const int32_t from_x = static_cast<int32_t>(from & kColumnMask);
  const int32_t from_dy = row - static_cast<int32_t>(from >> kRowShift);
  HP_LOOP_BOUND(kMapSize_cells)
  for (int32_t x = 0; x < kMapSize_cells; ++x) {
    const int index = row * kMapSize_cells + x;
    const int32_t unseen = (map.flags[index] & Costmap::kObserved) != 0 ? 0 : kUnseenGoal_cells2;
    const int32_t to_goal2 = (x - goal_x) * (x - goal_x) + goal_dy * goal_dy + unseen;
    const int32_t distance2 = (x - from_x) * (x - from_x) + from_dy * from_dy + unseen;
    if (map.Lethal(index) || to_goal2 > goal_limit_cells2_) continue;
    if (distance2 >= nearest_distance2_cells2_) continue;
    nearest_distance2_cells2_ = distance2;
    nearest_goal_ = static_cast<uint32_t>(index);
  }
}

int AstarSearch::Search(const Costmap& map, int units) {
  // Each unit but the last closes a cell; a map without a free goal is never searched.
  HP_LOOP_BOUND(kMapCells)
  while (units > 0 && phase_ == Phase::kSearch) {
    --units;
    const uint32_t index = PopFirst();
    if (index == kNone) {
      Finish(best_heuristic_ == UINT32_MAX ? Status::kStartEnclosed : Status::kNoPath);
    } else if (result_.expansions == max_expansions_) {
      BeginTrace(best_, best_cost_, true);
    } else {
      Expand(map, index);
    }
  }
  return units;
}

// The labels of this query to the bottom of all there are, and those of earlier ones to the top.
// Any g still to come is at least least_f_ less the largest h. Lower ones are of expanded cells:
// what tells those apart may be lost.
int AstarSearch::MoveLabels(int units) {
  const uint32_t lowest = base_ + least_f_ - kMaxHeuristic;
  HP_LOOP_BOUND(kMapSize_cells)
  while (units > 0 && row_ < kMapSize_cells) {
    uint64_t* const row = nodes_ + row_ * kMapSize_cells;
    HP_LOOP_BOUND(kMapSize_cells)
    for (int x = 0; x < kMapSize_cells; ++x) {
      const uint32_t label = static_cast<uint32_t>(row[x] >> kLabelShift);
      const uint32_t above = label < lowest ? 0 : label - lowest;
      const uint32_t moved = label < ceiling_ ? above : kLargestLabel;
      row[x] = (row[x] & kLinksMask) | uint64_t{moved} << kLabelShift;
    }
    ++row_;
    --units;
  }
  if (row_ < kMapSize_cells) return units;
  row_ = 0;
  base_ = kMaxHeuristic - least_f_;  // below 0: it wraps, and back in every sum with a g
  ceiling_ = kLargestLabel;
  phase_ = Phase::kSearch;
  return units;
}

int AstarSearch::Trace(int units) {
  HP_LOOP_BOUND(kMapCells)
  while (units > 0 && phase_ == Phase::kTrace) {
    --units;
    ++result_.path_cells;
    const uint64_t node = nodes_[trace_cell_];
    const uint32_t into = static_cast<uint32_t>(node & kDirectionMask);
    nodes_[trace_cell_] = (node & ~kDirectionMask) | trace_direction_;
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
  Link(start_, least_f_ % kBuckets, uint64_t{base_} << kLabelShift);
}

inline void AstarSearch::Expand(const Costmap& map, uint32_t index) {
  const uint64_t node = nodes_[index];
  const uint32_t label = static_cast<uint32_t>(node >> kLabelShift);
  const uint32_t g = label - base_;
  const uint32_t heuristic = least_f_ - g;
  ++result_.expansions;
  if (index == goal_) {
    BeginTrace(goal_, g, false);
    return;
  }
  const bool lethal = map.Lethal(static_cast<int>(index));
  // Of cells with one heuristic the first expanded has the least cost, as f never falls.
  if (heuristic < best_heuristic_ && !lethal) {
    best_ = index;
    best_heuristic_ = heuristic;
    best_cost_ = g;
  }
  const bool inner = IsInner(index) && !lethal && index != start_;
  uint32_t directions = inner ? CheaperAhead(map, index, node) : CheaperAround(map, index, node);
  HP_LOOP_BOUND(kDirections)
  while (directions != 0) {
    const uint32_t direction = static_cast<uint32_t>(std::countr_zero(directions));
    directions &= directions - 1;
    const uint32_t neighbour = Neighbour(index, direction);
    Relax(neighbour, direction, label + CostInto(map, neighbour, direction));
  }
  // The next f is less than kBuckets above this one, and those reached from there again.
  if (least_f_ >= ceiling_ - base_ - 2 * kBuckets) {
    least_label_ = 0;
    phase_ = Phase::kMoveLabels;
  }
}

// The directions to take: those allowed and worth it, to cells not seen or dearer. Without a
// branch, as none could be foreseen. Precondition: an inner cell, not lethal, not the start.
inline uint32_t AstarSearch::CheaperAhead(const Costmap& map, uint32_t index, uint64_t node) const {
  const uint32_t label = static_cast<uint32_t>(node >> kLabelShift);
  const uint32_t arrival = static_cast<uint32_t>(node & kDirectionMask);
  const uint32_t* const step = kStepAhead + arrival;
  const uint32_t same = Length(arrival);  // of the direction itself and of those at right angles
  const uint32_t other = kStraightLength + kDiagonalLength - same;
  const uint32_t cheaper = Cheaper(map, index + step[0], same, label) |
                           Cheaper(map, index + step[1], other, label) << 1 |
                           Cheaper(map, index + step[2], same, label) << 2 |
                           Cheaper(map, index + step[3], other, label) << 3 |
                           Cheaper(map, index + step[4], same, label) << 4;
  return AllowedInner(map, index) &
         std::rotl(static_cast<uint8_t>(cheaper), static_cast<int>(arrival) - 2);
}

// The same for any cell.
uint32_t AstarSearch::CheaperAround(const Costmap& map, uint32_t index, uint64_t node) const {
  const uint32_t label = static_cast<uint32_t>(node >> kLabelShift);
  uint32_t allowed = WithoutCutCorners(BlockedNear(map, index));
  if (index != start_) allowed &= WorthTaking(static_cast<uint32_t>(node & kDirectionMask));
  uint32_t cheaper = 0;
  HP_LOOP_BOUND(kDirections)
  while (allowed != 0) {
    const uint32_t direction = static_cast<uint32_t>(std::countr_zero(allowed));
    allowed &= allowed - 1;
    cheaper |= Cheaper(map, Neighbour(index, direction), Length(direction), label) << direction;
  }
  return cheaper;
}

// 1 if the cell has a label (one never seen has) of more than `label` and the step's cost, else 0.
// EdgeCost is in whole numbers: the fraction is cut off, after the sum.
inline uint32_t AstarSearch::Cheaper(const Costmap& map, uint32_t neighbour, uint32_t length,
                                     uint32_t label) const {
  static_assert(kCostOne_q8 == 1 << 8);
  const uint64_t next_q8 = uint64_t{label + length + 1} << 8;
  const uint64_t above_q8 = (next_q8 + length * CostOf(map, neighbour)) & ~uint64_t{0xff};
  return nodes_[neighbour] >= above_q8 << (kLabelShift - 8) ? 1u : 0u;
}

// A cheaper way to the cell was found.
inline void AstarSearch::Relax(uint32_t index, uint32_t direction, uint32_t label) {
  const uint32_t known = static_cast<uint32_t>(nodes_[index] >> kLabelShift);
  const uint32_t f_less_label = Heuristic(index) - base_;
  if (known < ceiling_) Unlink(index, (known + f_less_label) % kBuckets);
  const uint64_t fields = uint64_t{label} << kLabelShift | direction;
  Link(index, (label + f_less_label) % kBuckets, fields);
}

// Takes the cell that goes first out of the open set; kNone if that is empty.
inline uint32_t AstarSearch::PopFirst() {
  // The next bucket in use at or after the current one, round the circle.
  const uint32_t current = least_f_ % kBuckets;
  uint32_t word = current / 64;
  uint64_t bits = bucket_used_[word] & ~uint64_t{0} << current % 64;
  if (bits == 0) {
    UnmarkWordIf(bucket_used_[word] == 0, word);
    const uint64_t later_words = bucket_words_used_ & ~uint64_t{1} << word;
    const uint64_t words = later_words != 0 ? later_words : bucket_words_used_;
    if (words == 0) return kNone;
    word = LowestBit(words);
    bits = bucket_used_[word];
  }
  const uint32_t bucket = word * 64 + LowestBit(bits);
  least_f_ += (bucket - current) % kBuckets;

  const uint32_t index = bucket_head_[bucket];
  const uint32_t next = static_cast<uint32_t>(nodes_[index] >> kNextShift & kIndexMask);
  bucket_head_[bucket] = next;
  bucket_used_[word] &= ~(uint64_t{next == index} << bucket % 64);
  return index;
}

// Puts a cell in front of a bucket's list.
inline void AstarSearch::Link(uint32_t index, uint32_t bucket, uint64_t fields) {
  const bool used = (bucket_used_[bucket / 64] >> (bucket % 64) & 1u) != 0;
  const uint32_t head = bucket_head_[bucket];
  const uint32_t next = used ? head : index;
  SetPrev(next, index);  // its own, if it is the only one: overwritten below
  MarkBucket(bucket);
  nodes_[index] = fields | uint64_t{next} << kNextShift;
  bucket_head_[bucket] = index;
}

// Takes a cell out of its bucket's list.
inline void AstarSearch::Unlink(uint32_t index, uint32_t bucket) {
  const uint64_t node = nodes_[index];
  const uint32_t next = static_cast<uint32_t>(node >> kNextShift & kIndexMask);
  if (bucket_head_[bucket] == index) {
    bucket_head_[bucket] = next;
    if (next == index) Unmark(bucket);
    return;
  }
  const uint32_t prev = static_cast<uint32_t>(node >> kPrevShift & kIndexMask);
  SetNext(prev, next == index ? prev : next);
  SetPrev(next, prev);
}

inline void AstarSearch::Unmark(uint32_t bucket) {
  const uint32_t word = bucket / 64;
  bucket_used_[word] &= ~(uint64_t{1} << bucket % 64);
  UnmarkWordIf(bucket_used_[word] == 0, word);
}

// PopFirst leaves the bit of the word that it is at until it goes on to another one.
inline void AstarSearch::UnmarkWordIf(bool empty, uint32_t word) {
  bucket_words_used_ &= ~(uint64_t{empty} << word);
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

// 70 x straight + 99 x diagonal steps on a free plane.
inline uint32_t AstarSearch::Heuristic(uint32_t index) const {
  const int32_t dx =
      static_cast<int32_t>(index & kColumnMask) - static_cast<int32_t>(goal_ & kColumnMask);
  const int32_t dy =
      static_cast<int32_t>(index >> kRowShift) - static_cast<int32_t>(goal_ >> kRowShift);
  const uint32_t ax = static_cast<uint32_t>(dx < 0 ? -dx : dx);
  const uint32_t ay = static_cast<uint32_t>(dy < 0 ? -dy : dy);
  const uint32_t larger = ax < ay ? ay : ax;
  return (2 * kStraightLength - kDiagonalLength) * larger +
         (kDiagonalLength - kStraightLength) * (ax + ay);
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
