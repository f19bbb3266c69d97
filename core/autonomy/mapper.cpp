// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/mapper.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"
#include "core/base/validate.h"
#include "core/base/wide_int.h"

namespace hardpack {
namespace {

// Where the body frame's origin lies in the sensor frame.
Vec3 BodyOriginInSensor(const Transform3& body_from_sensor) {
  const float* r = body_from_sensor.rotation;
  const Vec3& t = body_from_sensor.translation;
  return {-(r[0] * t.x_m + r[3] * t.y_m + r[6] * t.z_m),
          -(r[1] * t.x_m + r[4] * t.y_m + r[7] * t.z_m),
          -(r[2] * t.x_m + r[5] * t.y_m + r[8] * t.z_m)};
}

float Length(const Vec3& v) {
  return Sqrt(v.x_m * v.x_m + v.y_m * v.y_m + v.z_m * v.z_m);
}

// Rise of the ground that a vehicle stands on, along odom's x and y; level under one that has
// fallen over.
Vec2 SlopeUnder(const StampedPose& pose) {
  const Transform3 odom_from_body = TransformFrom(pose);
  const float up = odom_from_body.rotation[8];
  constexpr float kFallenOver = 0.5f;
  if (!(up > kFallenOver)) return {};
  return {-odom_from_body.rotation[2] / up, -odom_from_body.rotation[5] / up};
}

// Beyond this range no return is the vehicle itself: one inside the box's outline would have to lie
// more than 60 degrees below the level.
float SelfReach(const LidarMountParams& mount) {
  const Vec3 corner = {Max(Abs(mount.self_min_x_m), Abs(mount.self_max_x_m)),
                       mount.self_max_abs_y_m, 0.0f};
  return 2.0f * (Length(corner) + Length({mount.x_m, mount.y_m, 0.0f})) + mount.self_max_z_m +
         mount.z_m;
}

bool Awaits(ColumnState state) {
  return state == ColumnState::kRaw || state == ColumnState::kClassed;
}

}  // namespace

Status Mapper::Configure(const PerceptionParams& params, const CostmapParams& rule,
                         const LabelTable& table, const BeamModel& model, int window_first,
                         int window_last) {
  configured_ = false;
  if (FirstInvalidParameter(params) != nullptr || CheckCostmapParams(rule) != Status::kOk ||
      !(params.segmentation.ground_band_m < rule.obstacle_height_m)) {
    return Status::kParameterOutOfRange;
  }
  Status status = CheckLabelTable(table);
  if (!IsUsable(status)) return status;
  status = ring_.Configure(model.beams, model.columns_per_revolution, window_first, window_last);
  if (!IsUsable(status)) return status;
  status = segmenter_.Configure(params.segmentation, model.beams);
  if (!IsUsable(status)) return status;
  params_ = params;
  table_ = table;
  model_ = model;
  body_from_sensor_ = BodyFromSensor(params.mount);
  body_origin_sensor_ = BodyOriginInSensor(body_from_sensor_);
  self_reach_m_ = SelfReach(params.mount);
  obstacle_height_m_ = rule.obstacle_height_m;
  growth_cm_ = InCentimeters(rule.growth_height_m);
  band_m_ = params.segmentation.ground_band_m;
  growth_height_m_ = rule.growth_height_m;
  knows_low_ = rule.obstacle_rule != ObstacleRule::kInCell;
  const int32_t deadline_ms = RoundToInt(params.mapping.label_deadline_s * kMillisecondsPerSecond);
  deadline_ns_ = static_cast<uint64_t>(deadline_ms) * 1'000'000u;
  // The paper's rule knows no overhead.
  clearance_cm_ = rule.obstacle_rule == ObstacleRule::kInCell
                      ? INT32_MAX
                      : InCentimeters(rule.clearance_height_m);
  counters_ = MapperCounters{};
  fresh_.Clear();
  restarting_ = false;
  silent_ = true;
  newest_time_ns_ = 0;
  Forget();
  configured_ = true;
  return heights_.Reset({});
}

// The next column begins a stretch of directions of its own.
void Mapper::StartDirections() {
  next_direction_ = -1;
  segmenter_.Restart();
  wires_.Restart();
}

Status Mapper::AddPose(const StampedPose& pose) {
  if (!configured_) return Status::kNotStarted;
  const bool first = poses_.size() == 0;
  if (!first) JudgeStep(poses_.newest(), pose);
  const bool emptied = !first && poses_.size() == 0;
  if (const Status status = poses_.Add(pose); !IsUsable(status)) return status;
  const Vec2 place = {pose.position.x_m, pose.position.y_m};
  if (first || emptied) {
    const float radius_m = first ? params_.mapping.start_ground_radius_m : 0.0f;
    const Status reset = heights_.Reset(place);
    const Status assumed = heights_.AssumeGround(pose.position, radius_m, SlopeUnder(pose));
    if (!IsUsable(reset) || !IsUsable(assumed)) return Status::kNotFinite;
  }
  const Status moved = heights_.Recenter(place);
  const Status stands = heights_.StandOnGround(pose.position, kStandingRadius_m, SlopeUnder(pose));
  return IsUsable(moved) ? stands : moved;
}

// What a step of the odometry means for what was measured before it; a pose that PoseHistory will
// refuse means nothing.
void Mapper::JudgeStep(const StampedPose& before, const StampedPose& pose) {
  const Vec3 step = {pose.position.x_m - before.position.x_m,
                     pose.position.y_m - before.position.y_m,
                     pose.position.z_m - before.position.z_m};
  if (pose.time_ns <= before.time_ns || !PoseHistory::Takes(pose)) return;
  const float elapsed_s = SecondsBetween(before.time_ns, pose.time_ns);
  const MappingParams& limits = params_.mapping;
  if (Length({step.x_m, step.y_m, 0.0f}) > limits.position_jump_m + kMaxSpeed_mps * elapsed_s) {
    ++counters_.position_jumps;
    return Forget();
  }
  if (Abs(step.z_m) <= limits.height_jump_m + kMaxClimb_mps * elapsed_s) return;
  ++counters_.height_jumps;
  if (!IsUsable(heights_.ShiftHeights(step.z_m))) return Forget();
  poses_.ShiftHeights(step.z_m);
  ring_.ShiftHeights(step.z_m);
  HP_LOOP_BOUND(Segmenter::kLag + 1)
  for (Direction& direction : directions_) {
    direction.fan.sensor_odom.z_m += step.z_m;
    HP_LOOP_BOUND(kMaxBeams)
    for (Vec3& point : direction.point_odom) point.z_m += step.z_m;
  }
}

// Poses, columns and, with the next pose, the map.
void Mapper::Forget() {
  poses_.Clear();
  ring_.Restart();
  StartDirections();
  fold_next_ = -1;
}

Status Mapper::AddColumn(const LidarColumn& column, uint64_t time_ns) {
  if (!configured_) return Status::kNotStarted;
  fresh_.Clear();
  if (restarting_) return Status::kSensorRestarted;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < model_.beams; ++row) self_[row] = 0;
  const std::span<const uint8_t> self(self_, static_cast<size_t>(model_.beams));
  const Result<int64_t> sequence = ring_.SequenceOf(column.frame_id, column.measurement_id);
  const bool is_column = column.valid && column.beams == model_.beams && ring_.TakesOffset(column);
  if (!is_column || !sequence.ok()) {
    // The ring has a name for it, and counts it.
    const Status refused = ring_.Push(column, time_ns, Transform3{}, self);
    late_run_ = refused == Status::kLate ? late_run_ + 1 : 0;
    // A single wild frame id has taken the ring far ahead of the sensor, or it has started anew at
    // a number just below: nothing else makes every column late.
    const bool lost = late_run_ >= kMaxLateRun;
    const bool restarts = refused == Status::kSensorRestarted || lost;
    if (restarts && DirectionsToEnd() <= directions_left_) BeginRestart();
    return lost ? Status::kSensorRestarted : refused;
  }
  StampedPose pose;
  if (const Status known = poses_.At(time_ns, pose); !IsUsable(known)) {
    ++counters_.columns_without_pose;
    return known;
  }
  const int64_t newest = ring_.newest_sequence();
  const int64_t needed =
      DirectionsFor(sequence.value(), newest) + (IsOccupantRaw(sequence.value()) ? 1 : 0);
  if (needed > directions_left_) {
    ++counters_.columns_over_limit;
    return Status::kCapacityExceeded;
  }
  FoldOccupant(sequence.value());
  MarkSelf(column);
  const Status filed = ring_.Push(column, time_ns, TransformFrom(pose) * body_from_sensor_, self);
  if (!IsUsable(filed)) return filed;
  silent_ = false;
  late_run_ = 0;
  if (time_ns > newest_time_ns_) newest_time_ns_ = time_ns;
  if (fold_next_ < 0 || sequence.value() < fold_next_) fold_next_ = sequence.value();
  ClassDirections(sequence.value(), newest);
  return Status::kOk;
}

bool Mapper::IsOccupantRaw(int64_t sequence) const {
  const ScanColumn& occupant = ring_.column(ring_.SlotOf(sequence));
  return occupant.sequence != sequence && occupant.state == ColumnState::kRaw;
}

// A slot is needed again before its column has been folded: only where the ring holds less than the
// deadline.
void Mapper::FoldOccupant(int64_t sequence) {
  const int slot = ring_.SlotOf(sequence);
  const ScanColumn& occupant = ring_.column(slot);
  if (occupant.sequence == sequence || !Awaits(occupant.state)) return;
  ++counters_.folded_early;
  if (occupant.state == ColumnState::kRaw) ClassAsHard(slot, occupant.sequence + 1);
  if (occupant.state == ColumnState::kClassed) Fold(slot);
}

void Mapper::MarkSelf(const LidarColumn& column) {
  const SinCosPair encoder =
      EncoderSinCos(model_, column.measurement_id, column.azimuth_offset_rad);
  const LidarMountParams& mount = params_.mount;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < model_.beams; ++row) {
    const uint32_t range_mm = NearestRange(column, row);
    const float range_m = FromMillimeters(range_mm);
    bool self = range_m < mount.min_range_m || range_m > mount.max_range_m;
    if (!self && range_m <= self_reach_m_) {
      const Vec3 point = PointInSensor(model_, encoder, row, range_mm);
      self = IsSelfReturn(mount, body_from_sensor_.Apply(point), range_m);
    }
    self_[row] = static_cast<uint8_t>(self);
  }
}

// Classes every direction that the column has made complete. newest: the furthest column before it.
void Mapper::ClassDirections(int64_t sequence, int64_t newest) {
  if (sequence <= newest) {
    // It came late: the directions that were looked along had to do without it.
    ClassAsHard(ring_.SlotOf(sequence), next_direction_ >= 0 ? next_direction_ : newest + 1);
    return;
  }
  const bool gap =
      next_direction_ >= 0 && sequence - newest > model_.max_column_shift + Segmenter::kLag;
  if (gap) {
    ClassUpTo(newest + Segmenter::kLag);
    StartDirections();
  }
  if (next_direction_ < 0) next_direction_ = sequence - model_.max_column_shift;
  ClassUpTo(sequence - model_.max_column_shift);
}

// How many those are; 1 for a late column, which is classed as hard in the place of one.
int64_t Mapper::DirectionsFor(int64_t sequence, int64_t newest) const {
  if (sequence <= newest) return 1;
  if (next_direction_ < 0) return 1;
  const int64_t complete = sequence - model_.max_column_shift - next_direction_ + 1;
  const int64_t rest = newest + Segmenter::kLag - next_direction_ + 1;
  const bool gap = sequence - newest > model_.max_column_shift + Segmenter::kLag;
  return gap ? rest + 1 : complete;
}

int64_t Mapper::DirectionsToEnd() const {
  return next_direction_ < 0 ? 0 : ring_.newest_sequence() + Segmenter::kLag - next_direction_ + 1;
}

void Mapper::ClassUpTo(int64_t last) {
  HP_LOOP_BOUND(kMaxDirections)
  for (; next_direction_ <= last; ++next_direction_) {
    --directions_left_;
    LookAlong(next_direction_);
    if (segmenter_.ready()) UseClasses();
  }
}

// Rows of a column whose directions lie before `looked`, and so were looked along without them, are
// hard: when in doubt. With all its rows classed the column is.
void Mapper::ClassAsHard(int slot, int64_t looked) {
  const ScanColumn& column = ring_.column(slot);
  if (column.state != ColumnState::kRaw) return;
  --directions_left_;
  bool any = false;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < model_.beams; ++row) {
    PackedReturn packed = ring_.at(slot, row);
    if (packed.range_mm() == 0 || packed.self()) continue;
    if (column.sequence - model_.column_shift[row] >= looked) continue;
    any = true;
    if (packed.labelled()) continue;
    packed.SetClass(ReturnClass::kHard, false);
    ring_.Set(slot, row, packed);
  }
  if (any) ++counters_.late_unclassed_columns;
  if (column.sequence < looked) FinishColumn(slot);
}

void Mapper::FinishColumn(int slot) {
  if (ring_.column(slot).state != ColumnState::kRaw) return;
  ring_.MarkClassed(slot);
  MarkFresh(slot);
  if (params_.mapping.use_labels == 0 || ring_.column(slot).labelled) Fold(slot);
}

// It has room for all that one call classes.
void Mapper::MarkFresh(int slot) {
  static_cast<void>(fresh_.PushBack(static_cast<int16_t>(slot)));
}

// Classes what is there of the directions that nothing more will come for.
void Mapper::EndDirections() {
  if (next_direction_ >= 0) ClassUpTo(ring_.newest_sequence() + Segmenter::kLag);
  StartDirections();
}

void Mapper::BeginRestart() {
  late_run_ = 0;
  EndDirections();
  ++counters_.sensor_restarts;
  restarting_ = true;
}

}  // namespace hardpack
