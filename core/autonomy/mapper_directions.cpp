// SPDX-License-Identifier: Apache-2.0
// How one direction is looked along and classed: into the ring what each return is, into the grid
// the ground that was observed, what is low and what the beams saw.
#include "core/autonomy/mapper.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/wide_int.h"

namespace hardpack {
namespace {

// What is taken for ground tells that nothing low stands there when ground was seen so far before
// it: the first rings may meet the top of a thing whose foot is in the blind cone.
constexpr float kFootAhead_m = 1.0f;
constexpr float kNoGround_m = 1.0e9f;
// Steeper than any beam.
constexpr float kSteepest = 1.0e6f;

// value modulo size, for 0 <= value < 2 size.
constexpr int Wrapped(int value, int size) {
  return value < size ? value : value - size;
}

}  // namespace

Mapper::Direction& Mapper::DirectionOf(int64_t sequence) {
  return directions_[Divide(sequence, Segmenter::kLag + 1).remainder];
}

// Makes the view of one direction from the columns that its beams were fired in, and hands it to
// the segmenter. Not inlined, as UseClasses: their calls are counted (config/timing.toml).
[[gnu::noinline]] void Mapper::LookAlong(int64_t sequence) {
  Direction& direction = DirectionOf(sequence);
  direction.sequence = sequence;
  direction.slot = ring_.SlotOf(sequence);
  const int64_t own = ring_.Holds(sequence) ? sequence : ring_.newest_sequence();
  const Transform3& pose = ring_.column(ring_.SlotOf(own)).odom_from_sensor;
  const float ground_m = pose.Apply(body_origin_sensor_).z_m;
  SightFan& fan = direction.fan;
  fan.sensor_odom = pose.Apply(model_.sensor_from_lidar.translation);
  fan.beams = model_.beams;
  fan.lowest_slope = kSteepest;
  fan.highest_slope = -kSteepest;
  view_.beams = model_.beams;
  view_.sensor_height_m = fan.sensor_odom.z_m - ground_m;
  const int measurement_id = ring_.MeasurementIdOf(sequence);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < model_.beams; ++beam) {
    LookWithBeam(beam, measurement_id, pose, direction);
    view_.height_m[beam] = direction.point_odom[beam].z_m - ground_m;
    view_.slope[beam] = fan.slope[beam];
    view_.level_m[beam] = fan.level_m[beam];
    fan.lowest_slope = Min(fan.lowest_slope, fan.slope[beam]);
    fan.highest_slope = Max(fan.highest_slope, fan.slope[beam]);
  }
  PassThroughNothing(direction);
  // A view that is refused counts as one with nothing seen.
  static_cast<void>(segmenter_.Push(view_));
}

// A beam that was fired and came back from nowhere has gone through as far as the direction is
// known not to be blocked: without this what stood against the sky would stay for ever.
void Mapper::PassThroughNothing(Direction& direction) {
  float furthest_m = 0.0f;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < model_.beams; ++beam) {
    furthest_m = Max(furthest_m, direction.fan.level_m[beam]);
  }
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < model_.beams; ++beam) {
    const bool up = direction.fan.slope[beam] >= 0.0f;
    if (up && direction.nothing[beam]) direction.fan.level_m[beam] = furthest_m;
  }
}

// One beam: where its return lies, or where it points if there is none. own_id: the measurement id
// of the direction; the beam was fired some columns later.
void Mapper::LookWithBeam(int beam, int own_id, const Transform3& pose, Direction& direction) {
  constexpr uint32_t kSomewhere_mm = 10000;
  constexpr float kLeast_m = 0.001f;
  const int row = model_.by_altitude[beam];
  const int shift = model_.column_shift[row];
  const int slot = Wrapped(direction.slot + shift, ring_.slots());
  const bool held = ring_.column(slot).sequence == direction.sequence + shift;
  const PackedReturn packed = held ? ring_.at(slot, row) : PackedReturn();
  const bool seen = packed.range_mm() != 0 && !packed.self();
  const Transform3& from = held ? ring_.column(slot).odom_from_sensor : pose;
  const float offset_rad = held ? ring_.column(slot).azimuth_offset_rad : 0.0f;
  const SinCosPair encoder =
      EncoderSinCos(model_, Wrapped(own_id + shift, model_.columns_per_revolution), offset_rad);
  const Vec3 point =
      from.Apply(PointInSensor(model_, encoder, row, seen ? packed.range_mm() : kSomewhere_mm));
  const Vec3& sensor = direction.fan.sensor_odom;
  const float dx_m = point.x_m - sensor.x_m;
  const float dy_m = point.y_m - sensor.y_m;
  const float level_m = Max(Sqrt(dx_m * dx_m + dy_m * dy_m), kLeast_m);
  direction.point_odom[beam] = point;
  direction.fan.level_m[beam] = seen ? level_m : 0.0f;
  direction.fan.slope[beam] = (point.z_m - sensor.z_m) / level_m;
  if (beam == model_.beams / 2) direction.fan.direction_odom = {dx_m / level_m, dy_m / level_m};
  direction.nothing[beam] = held && packed.range_mm() == 0;
  view_.seen[beam] = seen;
  view_.range_m[beam] = FromMillimeters(packed.range_mm());
}

// The segmenter's result: classes and heights into the ring, observed ground and what the beams saw
// into the grid. The column at the direction's own angle is then classed as a whole: its other rows
// belong to directions before.
[[gnu::noinline]] void Mapper::UseClasses() {
  const Direction& direction = DirectionOf(next_direction_ - Segmenter::kLag);
  const DirectionClasses& classes = segmenter_.result();
  const auto revolution = RevolutionOf(direction.sequence);
  crossed_before_ = heights_.crossed_cells();
  float ground_from_m = kNoGround_m;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < model_.beams; ++beam) {
    if (direction.fan.level_m[beam] > 0.0f) ClassReturn(direction, beam, classes);
    if (classes.what[beam] == ReturnClass::kGround) {
      FileGround(direction, beam, classes);
      const float level_m = direction.fan.level_m[beam];
      ground_from_m = Min(ground_from_m, level_m);
      const bool tells = classes.observed_from[beam] >= 0 && level_m > ground_from_m + kFootAhead_m;
      if (tells) heights_.DoubtLow(direction.point_odom[beam]);
    }
    const bool firm = segmenter_.IsFirm(beam);
    if (IsLow(classes, beam) && (firm || segmenter_.IsLoose(beam))) {
      heights_.CountLow(direction.point_odom[beam], firm);
    }
  }
  FileWires(direction, classes);
  // A fan off the map, or one that is not finite, ages nothing.
  static_cast<void>(heights_.Age(direction.fan, revolution, params_.mapping.ageing_revolutions));
  if (ring_.Holds(direction.sequence)) FinishColumn(ring_.SlotOf(direction.sequence));
}

// Higher than the ground test tolerates, but no higher than growth.
bool Mapper::StandsLow(const DirectionClasses& classes, int beam) const {
  return classes.ground_known[beam] && classes.above_ground_m[beam] > band_m_ &&
         classes.above_ground_m[beam] <= growth_height_m_;
}

// What stands up, but no higher than growth does: its label has no part in what it is, and grass
// that is taken for ground speaks against it.
bool Mapper::IsLow(const DirectionClasses& classes, int beam) const {
  return classes.what[beam] != ReturnClass::kIgnored && StandsLow(classes, beam);
}

// What is thin, those that stand alone among it, and lies on a line with others: hard and firm,
// whatever each of them was taken for.
void Mapper::FileWires(const Direction& direction, const DirectionClasses& classes) {
  float level_m = 0.0f;  // of the last thin one
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int beam = 0; beam < model_.beams; ++beam) {
    const bool seen = direction.fan.level_m[beam] > 0.0f;
    if (!seen || !StandsLow(classes, beam)) continue;
    if (segmenter_.IsThin(beam)) {
      wires_.AddThin(direction.point_odom[beam], direction.sequence);
      level_m = direction.fan.level_m[beam];
    } else if (!segmenter_.IsFirm(beam)) {
      wires_.AddOther(direction.point_odom[beam], direction.sequence);
    }
  }
  if (level_m == 0.0f) return;
  const SightFan& fan = direction.fan;
  const auto steps = static_cast<float>(fan.beams > 1 ? fan.beams - 1 : 1);
  const float spacing_m = level_m * (fan.highest_slope - fan.lowest_slope) / steps;
  const uint32_t revolution = RevolutionOf(direction.sequence);
  HP_LOOP_BOUND(WireFinder::kMost)
  for (const Vec3& point : wires_.Find(direction.sequence, spacing_m)) {
    static_cast<void>(heights_.Insert(point, ReturnClass::kHard, revolution));
    heights_.CountLow(point, true);
  }
}

// Differences, because the counter wraps.
bool Mapper::MayCross() const {
  const uint32_t crossed = heights_.crossed_cells();
  return crossed - crossed_before_ <= kMaxCrossed_cells &&
         (!is_limited_ || static_cast<int32_t>(crossing_ends_ - crossed) > 0);
}

// Ground that geometry has found. Where labels are to come only that it was observed: its height is
// filed with the labels, because what looks like ground may be low growth, and would raise the
// ground that obstacles are held against.
void Mapper::FileGround(const Direction& direction, int beam, const DirectionClasses& classes) {
  const Vec3& point = direction.point_odom[beam];
  const int gap_from = classes.gap_from[beam];
  if (gap_from >= 0 && MayCross()) {
    static_cast<void>(heights_.ForgetGround(direction.point_odom[gap_from], point));
  }
  // Returns of one direction that lie so far apart are none: what is between them stays unknown.
  const int from = classes.observed_from[beam];
  const Vec3& start = from >= 0 ? direction.point_odom[from] : point;
  if (params_.mapping.use_labels != 0) {
    // A stretch that is too long to be filed, or ends off the map, stays unknown.
    if (MayCross()) static_cast<void>(heights_.ObserveGround(start, point));
    return;
  }
  const uint32_t revolution = RevolutionOf(direction.sequence);
  if (!IsUsable(heights_.Insert(point, ReturnClass::kGround, revolution))) {
    ++counters_.returns_off_map;
  }
  if (from >= 0 && MayCross()) static_cast<void>(heights_.BridgeGround(start, point));
}

// A label that came before its return was classed is held against the ground now.
void Mapper::ClassReturn(const Direction& direction, int beam, const DirectionClasses& classes) {
  const int row = model_.by_altitude[beam];
  const int shift = model_.column_shift[row];
  const int slot = Wrapped(direction.slot + shift, ring_.slots());
  if (ring_.column(slot).sequence != direction.sequence + shift) return;
  if (ring_.column(slot).state != ColumnState::kRaw) return;
  PackedReturn packed = ring_.at(slot, row);
  if (packed.range_mm() == 0 || packed.self()) return;
  const bool known = classes.ground_known[beam];
  const float height_m = classes.above_ground_m[beam];
  if (known) packed.SetHeight(InCentimeters(height_m));
  if (packed.labelled()) {
    const SeenReturn seen = {classes.what[beam], height_m, known};
    const ReturnClass said = packed.return_class();
    packed.SetClass(CheckedLabel(said, seen, obstacle_height_m_), true);
    if (said == ReturnClass::kHard && IsLow(classes, beam)) {
      heights_.CountLow(direction.point_odom[beam], true);
    }
  } else {
    packed.SetClass(classes.what[beam], false);
  }
  ring_.Set(slot, row, packed);
}

}  // namespace hardpack
