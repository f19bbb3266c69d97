// SPDX-License-Identifier: Apache-2.0
// How obstacles age by being seen through.
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/costmap/cell_walk.h"
#include "core/costmap/height_grid.h"

namespace hardpack {
namespace {

constexpr float kCellReach_cm = 14.142136f;  // from a cell's middle to its corner
// Who has gone leaves a foot below the lowest beam that passes. A cut by so much is no noise on the
// top of a low thing: the block's counts were of what has gone, and what still stands counts anew.
constexpr int32_t kOther_cm = 15;

// The fan can be used, and its furthest return; 0: it saw nothing.
Status CheckFan(const SightFan& fan, float& furthest_m) {
  furthest_m = 0.0f;
  if (fan.beams < 0 || fan.beams > kMaxBeams) return Status::kInvalidArgument;
  if (!IsFinite(fan.sensor_odom) || !IsFinite(fan.direction_odom) || !IsFinite(fan.lowest_slope) ||
      !IsFinite(fan.highest_slope)) {
    return Status::kNotFinite;
  }
  bool finite = true;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
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

}  // namespace

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
  const GridWindow window = window_;  // nothing that is stored below changes it
  CellWalk walk(sensor, sight.direction);
  HP_LOOP_BOUND(kMaxSight_cells)
  for (int i = 0; i < cells; ++i) {
    const Cell cell = walk.cell();
    if (!window.Contains(cell)) break;
    if (HasObstacle(Slot(cell)) && CanAge(Slot(cell), sight)) {
      if (aged_left_ == 0) break;
      --aged_left_;
      AgeCell(cell, fan, sight);
    }
    walk.Next();
  }
  return Status::kOk;
}

// Else neither a hit nor a miss would change anything.
bool HeightGrid::CanAge(int slot, const Sight& sight) const {
  const bool is_new = ((seen_[slot] & kSightOdd) != 0) != sight.odd;
  return is_new || (seen_[slot] & kMissMask) != 0;
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void HeightGrid::AgeCell(Cell cell, const SightFan& fan, const Sight& sight) {
  const int slot = Slot(cell);
  const Vec2 middle = CellCenter(cell);
  const float distance_m = (middle.x_m - fan.sensor_odom.x_m) * sight.direction.x_m +
                           (middle.y_m - fan.sensor_odom.y_m) * sight.direction.y_m;
  const int misses = (seen_[slot] & kMissMask) / kMissOne;
  const bool is_new = ((seen_[slot] & kSightOdd) != 0) != sight.odd;
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
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
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
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
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
    if (highest_hard_cm_[slot] - highest_cm >= kOther_cm) {
      low_[BlockSlot({slot % kMapSize_cells, slot / kMapSize_cells})] = 0;
    }
    highest_hard_cm_[slot] = kept_cm;
    if (gone) lowest_hard_cm_[slot] = kNone;
    seen_[slot] = static_cast<uint8_t>(seen_[slot] & ~kPersonMask);
  } else {
    highest_soft_cm_[slot] = kept_cm;
  }
  if (!HasObstacle(slot) && (seen_[slot] & kGroundHeightKnown) == 0) lowest_cm_[slot] = kNone;
}

void HeightGrid::ClearNotes() {
  HP_LOOP_BOUND(kMapCells / 32)
  for (int word = 0; word < kMapCells / 32; ++word) {
    noted_[0].words[word] = 0;
    noted_[1].words[word] = 0;
    began_with_person_.words[word] = 0;
  }
}

// This stretch becomes the one before.
void HeightGrid::ShiftNotes() {
  HP_LOOP_BOUND(kMapCells / 32)
  for (int word = 0; word < kMapCells / 32; ++word) {
    noted_[1].words[word] = noted_[0].words[word];
    noted_[0].words[word] = 0;
  }
}

void HeightGrid::ForgetNotes(uint64_t now_ns) {
  if (now_ns - noted_since_ns_ < kNoted_ns) return;
  noted_since_ns_ = now_ns;
  ShiftNotes();
}

template <typename Act>
void HeightGrid::AroundPerson(Vec2 place_odom, float radius_m, Act&& act) {
  if (!IsFinite(place_odom) || !(radius_m >= 0.0f && radius_m <= kMaxReleased_m)) return;
  constexpr int kReach_cells = static_cast<int>(kMaxReleased_m * kCellsPerMeter) + 1;
  const Cell middle = CellAt(place_odom);
  HP_LOOP_BOUND(2 * kReach_cells + 1)
  for (int dy = -kReach_cells; dy <= kReach_cells; ++dy) {
    HP_LOOP_BOUND(2 * kReach_cells + 1)
    for (int dx = -kReach_cells; dx <= kReach_cells; ++dx) {
      const Cell cell = {SaturatedSum(middle.x, dx), SaturatedSum(middle.y, dy)};
      if (!window_.Contains(cell) || !AreWithin(CellCenter(cell), place_odom, radius_m)) continue;
      act(Slot(cell));
    }
  }
}

// Not inlined, as the two below: their calls are counted (config/timing.toml).
[[gnu::noinline]] void HeightGrid::NotePerson(Vec2 place_odom, float radius_m) {
  AroundPerson(place_odom, radius_m, [this](int slot) { noted_[0].Set(slot, true); });
}

[[gnu::noinline]] void HeightGrid::FlagPerson(Vec2 place_odom, float radius_m) {
  AroundPerson(place_odom, radius_m, [this](int slot) {
    if (highest_hard_cm_[slot] != kNone) seen_[slot] |= kPersonMask;
  });
}

[[gnu::noinline]] void HeightGrid::ReleasePerson(Vec2 place_odom, float radius_m) {
  AroundPerson(place_odom, radius_m, [this](int slot) {
    if (highest_hard_cm_[slot] != kNone && began_with_person_.Has(slot)) ReleaseCell(slot);
  });
}

// As if the beams had passed through all of it.
void HeightGrid::ReleaseCell(int slot) {
  CutDown(slot, true, static_cast<float>(lowest_hard_cm_[slot]));
  seen_[slot] = static_cast<uint8_t>(seen_[slot] & ~kMissMask);
}

}  // namespace hardpack
