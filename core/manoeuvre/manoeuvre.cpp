// SPDX-License-Identifier: Apache-2.0
#include "core/manoeuvre/manoeuvre.h"

#include <bit>

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/kinematics/kinematics.h"
#include "core/safety/outline.h"

namespace hardpack {
namespace {

constexpr int kHeadingMask = Manoeuvre::kHeadings - 1;
constexpr float kHair_m = 0.001f;
constexpr float kFar_m = 1.0e3f;
constexpr int kQuarters = 4;
constexpr float kTurn_rad = kTwoPi / static_cast<float>(Manoeuvre::kHeadings);

// From one heading to another the shorter way round, in turns.
int TurnsBetween(int from, int to) {
  const int left = (to - from) & kHeadingMask;
  const int right = (from - to) & kHeadingMask;
  return left < right ? left : right;
}

int16_t Rounded(float value) {
  return static_cast<int16_t>(FloorToInt(value + 0.5f));
}

}  // namespace

Status Manoeuvre::Begin(const Costmap& map, const VehicleParams& vehicle, const PathParams& params,
                        float max_curvature_per_m, const Pose2& start, const WorldPath& way) {
  phase_ = Phase::kDone;
  used_nodes_ = 0;
  refused_ = 0;
  found_ = kNone;
  chord_m_ = Max(kTurn_rad / Max(max_curvature_per_m, 1.0e-3f), kLeastChord_m);
  if (chord_m_ > kMostChord_m) return status_ = Status::kParameterOutOfRange;
  if (!map.window.Contains(CellAt(PlaceOf(start)))) return status_ = Status::kStartOutsideMap;
  footprint_ = FootprintOf(vehicle);
  vehicle_ = vehicle;
  params_ = params;
  start_ = start;
  start_heading_ = SinCos(start.theta_rad);
  can_pivot_ = CanPivot(vehicle);
  margin_m_ = params.margin_m + kHair_m;
  near_margin_m_ = margin_m_;
  HP_LOOP_BOUND(kQuarters)
  for (int quarter = kQuarters - 1; quarter >= 0 && !IsFree(map, start); --quarter) {
    near_margin_m_ = 0.25f * margin_m_ * static_cast<float>(quarter);
  }
  if (!IsFree(map, start)) return status_ = Status::kStartInObstacle;
  if (near_margin_m_ < margin_m_) near_margin_m_ *= 0.5f;
  KeepWay(way);
  HP_LOOP_BOUND(kHeadings)
  for (int heading = 0; heading < kHeadings; ++heading) {
    const SinCosPair along = SinCos(kTurn_rad * static_cast<float>(heading));
    chord_x_[heading] = Rounded(along.cos * static_cast<float>(kUnitsPerChord));
    chord_y_[heading] = Rounded(along.sin * static_cast<float>(kUnitsPerChord));
  }
  cleared_ = 0;
  HP_LOOP_BOUND(kBucketWords)
  for (uint32_t& word : used_) word = 0;
  phase_ = Phase::kClear;
  status_ = Status::kNotStarted;
  return Status::kOk;
}

void Manoeuvre::KeepWay(const WorldPath& way) {
  way_points_ = way.size() < kMaxWayPoints ? way.size() : kMaxWayPoints;
  first_ = 0;
  HP_LOOP_BOUND(kMaxWayPoints)
  for (int point = 0; point < way_points_; ++point) way_[point] = way[point];
}

// The heuristic: the larger of the turns and the chords that are left. Both change by one with a
// chord at most, as a chord is a little longer here than it is.
uint32_t Manoeuvre::CostLeft(const Node& node) const {
  constexpr float kLonger = 1.01f;
  const Vec2 place = PlaceOf(PoseOf(node));
  float nearest2_m2 = kFar_m * kFar_m;
  HP_LOOP_BOUND(kMaxWayPoints)
  for (int point = first_led_; point < way_points_; ++point) {
    const float dx_m = way_[point].x_m - place.x_m;
    const float dy_m = way_[point].y_m - place.y_m;
    nearest2_m2 = Min(nearest2_m2, dx_m * dx_m + dy_m * dy_m);
  }
  const float left_m = way_points_ > 0 ? Sqrt(nearest2_m2) - kReach_m : 0.0f;
  const int chords = left_m > 0.0f ? FloorToInt(left_m / (kLonger * chord_m_)) : 0;
  const int turns = turns_left_[node.heading];
  return static_cast<uint32_t>(kForward * (chords > turns ? chords : turns));
}

// Where the search begins, once and for all. A vehicle that can turn on the spot may end at any
// heading.
void Manoeuvre::FillTurnsLeft() {
  first_led_ = first_;
  const bool may_be_any = can_pivot_ || way_points_ == 0;
  uint64_t ends = may_be_any ? ~uint64_t{0} : 0;
  HP_LOOP_BOUND(kMaxWayPoints)
  for (int point = first_; point < way_points_; ++point) {
    const float turn_rad = WrapAngle(way_[point].theta_rad - start_.theta_rad);
    const int low = FloorToInt((turn_rad - kAligned_rad) / kTurn_rad);
    constexpr int kWide = static_cast<int>(2.0f * kAligned_rad / kTurn_rad) + 2;
    HP_LOOP_BOUND(kWide)
    for (int k = 0; k < kWide; ++k) ends |= uint64_t{1} << ((low + k) & kHeadingMask);
  }
  HP_LOOP_BOUND(kHeadings)
  for (int heading = 0; heading < kHeadings; ++heading) {
    const uint64_t turned = std::rotr(ends, heading);
    int left = 0;
    HP_LOOP_BOUND(kHeadings / 2)
    while (left < kHeadings / 2 &&
           ((turned >> left | turned >> ((kHeadings - left) & kHeadingMask)) & 1u) == 0) {
      ++left;
    }
    turns_left_[heading] = static_cast<uint8_t>(left);
  }
}

Progress Manoeuvre::Step(const Costmap& map, const AstarSearch& from_goal, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && phase_ != Phase::kDone; ++unit) DoUnit(map, from_goal);
  return phase_ == Phase::kDone ? Progress::kDone : Progress::kBusy;
}

void Manoeuvre::DoUnit(const Costmap& map, const AstarSearch& from_goal) {
  switch (phase_) {
    case Phase::kClear:
      return ClearSlots();
    case Phase::kTake:
      return Take(map, from_goal);
    case Phase::kChords:
      return TryChord(map);
    case Phase::kDone:
      return;
  }
}

void Manoeuvre::ClearSlots() {
  uint16_t* const slots = slots_ + cleared_;
  HP_LOOP_BOUND(kClear_slots)
  for (int slot = 0; slot < kClear_slots; ++slot) slots[slot] = kNone;
  cleared_ += kClear_slots;
  if (cleared_ < kSlots) return;
  FillTurnsLeft();
  const Node start;
  Push(start, SlotOf(start));
  phase_ = Phase::kTake;
}

uint32_t Manoeuvre::BinOf(const Node& node) {
  const auto column = static_cast<uint32_t>(node.x + kReach_units) / kBin;
  const auto row = static_cast<uint32_t>(node.y + kReach_units) / kBin;
  return ((row * kSide_bins + column) * kHeadings + node.heading) * 2 + node.reverse;
}

// Where the cheapest node of its bin is, or may be put; -1: too many others are there. Linear
// probing from a multiplicative hash.
int32_t Manoeuvre::SlotOf(const Node& node) const {
  constexpr uint32_t kGoldenRatio = 0x9e3779b1u;
  const uint32_t bin = BinOf(node);
  const uint32_t first = bin * kGoldenRatio >> (kWordBits - kSlotBits);
  HP_LOOP_BOUND(kMaxProbes)
  for (uint32_t probe = 0; probe < kMaxProbes; ++probe) {
    const uint32_t slot = (first + probe) & (kSlots - 1);
    const uint16_t known = slots_[slot];
    if (known == kNone || BinOf(nodes_[known]) == bin) return static_cast<int32_t>(slot);
  }
  return -1;
}

Pose2 Manoeuvre::PoseOf(const Node& node) const {
  const float ahead_m = chord_m_ / static_cast<float>(kUnitsPerChord) * static_cast<float>(node.x);
  const float left_m = chord_m_ / static_cast<float>(kUnitsPerChord) * static_cast<float>(node.y);
  return {start_.x_m + start_heading_.cos * ahead_m - start_heading_.sin * left_m,
          start_.y_m + start_heading_.sin * ahead_m + start_heading_.cos * left_m,
          WrapAngle(start_.theta_rad + kTurn_rad * static_cast<float>(node.heading))};
}

// What is dearer than the last of them goes there too.
uint32_t Manoeuvre::BucketOf(const Node& node) const {
  const uint32_t f = node.cost + kHeuristicWeight * CostLeft(node);
  return f < kBuckets ? f : kBuckets - 1;
}

// In front of its bucket: among equals the last one reached goes first.
void Manoeuvre::Push(const Node& node, int32_t slot) {
  if (used_nodes_ == kMaxStates || slot < 0) return End(Status::kCapacityExceeded);
  ++used_nodes_;
  const uint32_t bucket = BucketOf(node);
  const uint32_t word = bucket / kWordBits;
  const uint32_t bit = 1u << bucket % kWordBits;
  const bool is_used = (used_[word] & bit) != 0;
  Node& kept = nodes_[used_nodes_];
  kept.x = node.x;
  kept.y = node.y;
  kept.heading = node.heading;
  kept.reverse = node.reverse;
  kept.parent = node.parent;
  kept.cost = node.cost;
  kept.next = is_used ? head_[bucket] : kNone;
  head_[bucket] = static_cast<uint16_t>(used_nodes_);
  used_[word] |= bit;
  slots_[slot] = static_cast<uint16_t>(used_nodes_);
}

// The cheapest of the open set, unless a cheaper one in its bin has replaced it.
void Manoeuvre::Take(const Costmap& map, const AstarSearch& from_goal) {
  uint32_t word = 0;
  HP_LOOP_BOUND(kBucketWords)
  while (word < kBucketWords && used_[word] == 0) ++word;
  if (word == kBucketWords) return End(Status::kNoPath);
  const uint32_t bucket = word * kWordBits + static_cast<uint32_t>(std::countr_zero(used_[word]));
  const uint16_t taken = head_[bucket];
  head_[bucket] = nodes_[taken].next;
  if (head_[bucket] == kNone) used_[word] &= used_[word] - 1;
  if (slots_[SlotOf(nodes_[taken])] != taken) return;  // in its slot one of its bin is
  taken_ = taken;
  motion_ = 0;
  phase_ = Phase::kChords;
  if (!MayEnd(map, from_goal, nodes_[taken])) return;
  found_ = taken;
  End(Status::kOk);
}

// Straight on, left, right, and the other way; from the start, where it stands, straight only.
void Manoeuvre::TryChord(const Costmap& map) {
  const Node& from = nodes_[taken_];
  const int motion = motion_;
  ++motion_;
  const bool stands = from.parent == kNone;
  if (stands && (motion == 1 || motion == 2)) return;
  if (motion_ == kMotions) phase_ = Phase::kTake;
  const bool changes = motion == 3;
  const int turn = motion == 1 ? 1 : (motion == 2 ? -1 : 0);
  Node to;
  to.reverse = static_cast<uint8_t>(changes ? 1 - from.reverse : from.reverse);
  // In reverse a bend to the same side turns the vehicle the other way; here it is the turn.
  to.heading = static_cast<uint8_t>((from.heading + turn) & kHeadingMask);
  const int sign = to.reverse != 0 ? -1 : 1;
  const int32_t x = from.x + sign * chord_x_[to.heading];
  const int32_t y = from.y + sign * chord_y_[to.heading];
  const bool is_inside =
      x >= -kReach_units && x < kReach_units && y >= -kReach_units && y < kReach_units;
  const int cost =
      from.cost + (to.reverse != 0 ? kReverse : kForward) + (changes && !stands ? kChange : 0);
  if (!is_inside || cost > kMaxCost) return;
  to.x = static_cast<int16_t>(x);
  to.y = static_cast<int16_t>(y);
  to.parent = taken_;
  to.cost = static_cast<uint16_t>(cost);
  const int32_t slot = SlotOf(to);
  const uint16_t known = slot < 0 ? kNone : slots_[slot];
  if (known != kNone && nodes_[known].cost <= to.cost) return;
  if (IsSweptFree(map, from, to)) Push(to, slot);
}

// The outline at the pose before is free. Along a chord it sweeps nothing but what it covers at
// both ends.
bool Manoeuvre::IsSweptFree(const Costmap& map, const Node& from, const Node& to) const {
  const Pose2 end = PoseOf(to);
  if (!IsFree(map, end)) return false;
  if (from.heading == to.heading) return true;
  Pose2 turned = PoseOf(from);
  const float half_rad = 0.5f * WrapAngle(end.theta_rad - turned.theta_rad);
  turned.theta_rad = WrapAngle(turned.theta_rad + half_rad);
  if (!IsFree(map, turned, kTurnMargin_m)) return false;
  turned.theta_rad = end.theta_rad;
  return IsFree(map, turned, kTurnMargin_m);
}

bool Manoeuvre::IsFree(const Costmap& map, const Pose2& pose, float more_m) const {
  const Vec2 place = PlaceOf(pose);
  if (!map.window.Contains(CellAt(place))) return false;
  const bool is_near = AreWithin(place, PlaceOf(start_), kNearStart_m);
  const float margin_m = (is_near ? near_margin_m_ : margin_m_) + more_m;
  if (NearestHardAtLeast(map, footprint_, pose) > margin_m * kCellsPerMeter) return true;
  return IsClear(map, footprint_, pose, margin_m);
}

int Manoeuvre::NearestOfWay(Vec2 place_odom) const {
  int nearest = -1;
  float nearest2_m2 = kReach_m * kReach_m;
  HP_LOOP_BOUND(kMaxWayPoints)
  for (int point = 0; point < way_points_; ++point) {
    const float dx_m = way_[point].x_m - place_odom.x_m;
    const float dy_m = way_[point].y_m - place_odom.y_m;
    const float distance2_m2 = dx_m * dx_m + dy_m * dy_m;
    const bool is_nearer = distance2_m2 < nearest2_m2;
    nearest = is_nearer ? point : nearest;
    nearest2_m2 = is_nearer ? distance2_m2 : nearest2_m2;
  }
  return nearest;
}

bool Manoeuvre::MayEnd(const Costmap& map, const AstarSearch& from_goal, const Node& node) const {
  if (node.parent == kNone || IsRefused(node)) return false;
  const Pose2 pose = PoseOf(node);
  const Vec2 place = PlaceOf(pose);
  if (map.Lethal(map.window.Index(CellAt(place)))) return false;
  if (way_points_ == 0) return from_goal.HasReached(CellAt(place));
  const int point = NearestOfWay(place);
  if (point < first_) return false;
  const float off_rad = Abs(WrapAngle(pose.theta_rad - way_[point].theta_rad));
  if (off_rad <= kAligned_rad) return true;
  return can_pivot_ && PivotIsFree(map, vehicle_, params_, place);
}

bool Manoeuvre::IsRefused(const Node& node) const {
  constexpr int kApart_units = kRefused_chords * kUnitsPerChord;
  bool is_refused = false;
  HP_LOOP_BOUND(kMaxRefused)
  for (int k = 0; k < refused_; ++k) {
    const Node& end = nodes_[refused_ends_[k]];
    const int32_t dx = node.x - end.x;
    const int32_t dy = node.y - end.y;
    const bool is_near = (dx < 0 ? -dx : dx) <= kApart_units &&
                         (dy < 0 ? -dy : dy) <= kApart_units &&
                         TurnsBetween(node.heading, end.heading) <= kRefused_headings;
    is_refused = is_refused || is_near;
  }
  return is_refused;
}

void Manoeuvre::RefuseFound() {
  if (status_ != Status::kOk) return;
  if (refused_ == kMaxRefused) return End(Status::kNoPath);
  refused_ends_[refused_] = found_;
  ++refused_;
  found_ = kNone;
  status_ = Status::kNotStarted;
  phase_ = Phase::kChords;  // those from the end itself
}

void Manoeuvre::LeadBeyond(Vec2 place_odom, float beyond_m) {
  int point = NearestOfWay(place_odom);
  if (point < 0) return;
  HP_LOOP_BOUND(kMaxWayPoints)
  while (point < way_points_ && AreWithin(PlaceOf(way_[point]), place_odom, beyond_m)) ++point;
  point = point < way_points_ ? point : way_points_ - 1;
  first_ = point > first_ ? point : first_;
}

void Manoeuvre::End(Status status) {
  status_ = status;
  phase_ = Phase::kDone;
}

// Backwards, as the parents lead. A point has the heading of the chord behind it.
void Manoeuvre::Poses(WorldPath& path) const {
  path.Clear();
  if (status_ != Status::kOk) return;
  int points = 1;
  HP_LOOP_BOUND(kMaxPoints)
  for (uint16_t node = found_; nodes_[node].parent != kNone; node = nodes_[node].parent) {
    points += Changes(nodes_[node]) ? 2 : 1;
  }
  path.Resize(points);
  int point = points - 1;
  path[point] = PoseOf(nodes_[found_]);
  HP_LOOP_BOUND(kMaxPoints)
  for (uint16_t node = found_; point > 0; node = nodes_[node].parent) {
    Pose2 pose = PoseOf(nodes_[nodes_[node].parent]);
    pose.theta_rad = PoseOf(nodes_[node]).theta_rad;
    if (Changes(nodes_[node])) path[--point] = pose;
    path[--point] = pose;
  }
}

// Whether the direction changes before the chord that ends here. At the start the vehicle has none.
bool Manoeuvre::Changes(const Node& node) const {
  const Node& from = nodes_[node.parent];
  return from.parent != kNone && from.reverse != node.reverse;
}

}  // namespace hardpack
