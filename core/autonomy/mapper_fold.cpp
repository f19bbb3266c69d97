// SPDX-License-Identifier: Apache-2.0
// How columns leave the ring: by their labels, by the deadline, and into every build meanwhile.
#include "core/autonomy/mapper.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "core/base/units.h"

namespace hardpack {

Status Mapper::AddLabels(const ColumnLabels& labels) {
  if (!configured_) return Status::kNotStarted;
  fresh_.Clear();
  if (labels.beams != model_.beams) return Status::kInvalidArgument;
  int64_t sequence = -1;
  const Status found = ring_.FindForLabels(labels.frame_id, labels.measurement_id, sequence);
  if (!IsUsable(found)) return found;
  const int slot = ring_.SlotOf(sequence);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < model_.beams; ++row) {
    PackedReturn packed = ring_.at(slot, row);
    if (packed.range_mm() == 0) continue;
    const bool known = packed.height_known();
    const float height_m = known ? FromCentimeters(packed.height_cm()) : 0.0f;
    const ReturnClass said = table_.class_of[labels.label[row]];
    const SeenReturn seen = {packed.return_class(), height_m, known};
    // One that is not classed yet is held against its label again when it is.
    packed.SetClass(CheckedLabel(said, seen, obstacle_height_m_), true);
    if (said == ReturnClass::kHard && known && height_m > band_m_ && height_m <= growth_height_m_) {
      heights_.CountLow(PointOdom(ring_.column(slot), EncoderOf(slot), row, packed), true);
    }
    ring_.Set(slot, row, packed);
  }
  ring_.MarkLabelled(slot);
  if (ring_.column(slot).state != ColumnState::kClassed) return Status::kOk;
  MarkFresh(slot);
  Fold(slot);
  return Status::kOk;
}

// What a return is filed as: nothing (kIgnored) for the vehicle itself, what hangs over the way,
// and ground that was filed when it was classed, without labels. A person is filed wherever the
// label finds one.
ReturnClass Mapper::FiledClass(PackedReturn packed) const {
  const ReturnClass what = packed.return_class();
  if (packed.range_mm() == 0) return ReturnClass::kIgnored;
  if (packed.self() && what != ReturnClass::kPerson) return ReturnClass::kIgnored;
  if (what == ReturnClass::kGround && params_.mapping.use_labels == 0) return ReturnClass::kIgnored;
  return what;
}

bool Mapper::IsOverhead(PackedReturn packed) const {
  return packed.height_known() && packed.height_cm() > clearance_cm_;
}

uint32_t Mapper::RevolutionOf(int64_t sequence) const {
  return static_cast<uint32_t>(ring_.TurnOf(sequence));
}

SinCosPair Mapper::EncoderOf(int slot) const {
  const ScanColumn& column = ring_.column(slot);
  return EncoderSinCos(model_, column.measurement_id, column.azimuth_offset_rad);
}

Vec3 Mapper::PointOdom(const ScanColumn& column, SinCosPair encoder, int row,
                       PackedReturn packed) const {
  return column.odom_from_sensor.Apply(PointInSensor(model_, encoder, row, packed.range_mm()));
}

// Not inlined: its calls are counted (config/timing.toml).
[[gnu::noinline]] void Mapper::Fold(int slot) {
  --folds_left_;
  const ScanColumn& column = ring_.column(slot);
  const uint32_t revolution = RevolutionOf(column.sequence);
  const SinCosPair encoder = EncoderOf(slot);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < model_.beams; ++row) {
    const PackedReturn packed = ring_.at(slot, row);
    const ReturnClass what = FiledClass(packed);
    if (what == ReturnClass::kIgnored) continue;
    if (what != ReturnClass::kGround && IsOverhead(packed)) {
      ++counters_.overhead_returns;
      continue;
    }
    if (!IsUsable(heights_.Insert(PointOdom(column, encoder, row, packed), what, revolution))) {
      ++counters_.returns_off_map;
    }
  }
  if (column.labelled) {
    ++counters_.folded_with_labels;
  } else {
    ++counters_.folded_without_labels;
  }
  ring_.MarkFolded(slot);
}

void Mapper::Advance(uint64_t now_ns) {
  if (!configured_) return;
  fresh_.Clear();
  heights_.ForgetNotes(now_ns);
  const bool fell_silent = !silent_ && ring_.newest_sequence() >= 0 &&
                           now_ns > newest_time_ns_ + static_cast<uint64_t>(kSilence_ns) &&
                           DirectionsToEnd() <= directions_left_;
  if (fell_silent) {
    silent_ = true;
    EndDirections();
    ring_.EndRevolution();
  }
  const bool all = restarting_ ? FoldPending(UINT64_MAX, 0) : FoldPending(now_ns, deadline_ns_);
  if (restarting_ && all) {
    restarting_ = false;
    fold_next_ = -1;
    ring_.Restart();
  }
}

// Folds pending columns in order, until one that was taken less than deadline_ns ago, or the work
// of one tick is done. True when none is left.
bool Mapper::FoldPending(uint64_t now_ns, uint64_t deadline_ns) {
  const int64_t newest = ring_.newest_sequence();
  if (fold_next_ < 0) return true;
  // Without a tick's limit one call has its own.
  if (!is_limited_) folds_left_ = kMaxFolds;
  int passed = 0;
  // Not from the newest revolutions on: what a jump of the frame counter has left behind is still
  // in the ring.
  HP_LOOP_BOUND(ScanRing::kMaxColumns)
  for (; fold_next_ <= newest && folds_left_ > 0 && passed < ScanRing::kMaxColumns;
       ++fold_next_, ++passed) {
    if (!ring_.Holds(fold_next_)) continue;
    const int slot = ring_.SlotOf(fold_next_);
    const ScanColumn& column = ring_.column(slot);
    if (column.state == ColumnState::kFolded) continue;
    if (column.state == ColumnState::kRaw || column.time_ns + deadline_ns > now_ns) return false;
    Fold(slot);
  }
  return fold_next_ > newest;
}

void Mapper::Finish() {
  if (!configured_) return;
  EndDirections();
  ring_.EndRevolution();
  silent_ = true;
  // By slots: jumps of the frame counter may have left columns behind anywhere. Each has its class.
  if (fold_next_ < 0) return;
  const int64_t newest = ring_.newest_sequence();
  HP_LOOP_BOUND(ScanRing::kMaxColumns)
  for (int ahead = 1; ahead <= ring_.slots(); ++ahead) {
    const int slot = ring_.SlotOf(newest + ahead);
    if (ring_.column(slot).state == ColumnState::kClassed) Fold(slot);
  }
  fold_next_ = newest + 1;
}

void Mapper::MarkPending(int slot, uint32_t since, CostmapBuilder& builder) const {
  const ScanColumn& column = ring_.column(slot);
  // Differences, because the counter wraps.
  const bool folded_since =
      column.state == ColumnState::kFolded && static_cast<int32_t>(column.fold_count - since) >= 0;
  if (column.state != ColumnState::kClassed && !folded_since) return;
  const GridWindow& window = builder.result().window;
  const SinCosPair encoder = EncoderOf(slot);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < model_.beams; ++row) {
    const PackedReturn packed = ring_.at(slot, row);
    if (!MayBeObstacle(packed)) continue;
    const Vec3 point = PointOdom(column, encoder, row, packed);
    const Cell cell = CellAt({point.x_m, point.y_m});
    if (!IsFinite(point.x_m) || !IsFinite(point.y_m) || !window.Contains(cell)) continue;
    const uint8_t flags = PendingFlags(packed, InCentimeters(point.z_m), heights_.At(cell));
    if (flags != 0) builder.Mark(window.Index(cell), flags);
  }
}

uint8_t Mapper::ObstacleOf(int slot, int row, uint32_t max_range_mm, Vec2& point_odom) const {
  const ColumnState state = ring_.column(slot).state;
  if (state != ColumnState::kClassed && state != ColumnState::kFolded) return 0;
  const PackedReturn packed = ring_.at(slot, row);
  if (packed.range_mm() > max_range_mm || !MayBeObstacle(packed)) return 0;
  const Vec3 point = PointOdom(ring_.column(slot), EncoderOf(slot), row, packed);
  const Cell cell = CellAt({point.x_m, point.y_m});
  if (!IsFinite(point.x_m) || !IsFinite(point.y_m)) return 0;
  point_odom = {point.x_m, point.y_m};
  return PendingFlags(packed, InCentimeters(point.z_m), heights_.At(cell));
}

bool Mapper::GroundStepOf(int slot, int row, uint32_t max_range_mm, Vec2& point_odom,
                          float& step_m) const {
  const ColumnState state = ring_.column(slot).state;
  if (state != ColumnState::kClassed && state != ColumnState::kFolded) return false;
  const PackedReturn packed = ring_.at(slot, row);
  const bool is_ground = packed.return_class() == ReturnClass::kGround && !packed.self();
  if (!is_ground || packed.range_mm() == 0 || packed.range_mm() > max_range_mm) return false;
  const Vec3 point = PointOdom(ring_.column(slot), EncoderOf(slot), row, packed);
  const HeightGrid::CellHeights cell = heights_.At(CellAt({point.x_m, point.y_m}));
  if (!IsFinite(point.x_m) || !IsFinite(point.y_m) || !cell.ground) return false;
  point_odom = {point.x_m, point.y_m};
  step_m = point.z_m - FromCentimeters(cell.lowest_cm);
  return true;
}

// A column, or where the sensor has left its place out the one beside it.
int64_t Mapper::HeldBeside(int64_t sequence) const {
  if (!ring_.measures_azimuth() || ring_.Holds(sequence)) return sequence;
  return ring_.Holds(sequence + 1) ? sequence + 1 : sequence - 1;
}

// The encoder's angle runs backwards: theta_e = 2 pi (1 - m / W). The beams' own azimuths and the
// column's offset are left out: they shift its direction by less than the sectors in which ages
// differ.
uint64_t Mapper::NewestLook_ns(Vec2 direction_odom) const {
  const int64_t newest = ring_.newest_sequence();
  if (!configured_ || newest < 0 || !ring_.Holds(newest)) return 0;
  const float* odom = ring_.column(ring_.SlotOf(newest)).odom_from_sensor.rotation;
  const float* own = model_.sensor_from_lidar.rotation;
  const Vec2& d = direction_odom;
  const Vec3 sensor = {odom[0] * d.x_m + odom[3] * d.y_m, odom[1] * d.x_m + odom[4] * d.y_m,
                       odom[2] * d.x_m + odom[5] * d.y_m};
  const float x = own[0] * sensor.x_m + own[3] * sensor.y_m + own[6] * sensor.z_m;
  const float y = own[1] * sensor.x_m + own[4] * sensor.y_m + own[7] * sensor.z_m;
  const int columns = model_.columns_per_revolution;
  const float share = 1.0f - Atan2(y, x) / kTwoPi;  // of the revolution, 0.5 to 1.5
  const int32_t turned = FloorToInt(share * static_cast<float>(columns) + 0.5f);
  const int32_t looked = ClampInt(turned >= columns ? turned - columns : turned, 0, columns - 1);
  const int32_t since = ring_.MeasurementIdOf(newest) - looked;
  int64_t sequence = newest - (since < 0 ? since + columns : since);
  HP_LOOP_BOUND(kLookBack)
  for (int back = 0; back < kLookBack && sequence >= 0; ++back, sequence -= columns) {
    const int64_t held = HeldBeside(sequence);
    if (ring_.Holds(held)) return ring_.column(ring_.SlotOf(held)).time_ns;
  }
  return 0;
}

bool Mapper::MayBeObstacle(PackedReturn packed) const {
  const ReturnClass what = FiledClass(packed);
  return what != ReturnClass::kIgnored && what != ReturnClass::kGround && !IsOverhead(packed);
}

// What a return by itself makes of its cell, by the obstacle rule: above the ground that the cell
// has or, where it has none, that the segmenter found; without either it counts. Where a label has
// called the cell soft and nothing has called it hard, a return no higher than what was seen there
// is soft too until its own label comes: else a bush would be hard in every build.
uint8_t Mapper::PendingFlags(PackedReturn packed, int32_t height_cm,
                             const HeightGrid::CellHeights& cell) const {
  if (packed.return_class() == ReturnClass::kPerson) return Costmap::kHard | Costmap::kPerson;
  if (cell.ground || packed.height_known()) {
    const int32_t above_cm = cell.ground ? height_cm - cell.lowest_cm : packed.height_cm();
    const bool overhead = above_cm > clearance_cm_ && !cell.guessed;
    if (overhead) return 0;
    if (above_cm <= growth_cm_) {
      const bool low = cell.firm && knows_low_ && packed.return_class() == ReturnClass::kHard;
      return low ? uint8_t{Costmap::kHard} : uint8_t{0};
    }
  }
  constexpr int32_t kSameBush_cm = 30;
  const bool known_soft = !packed.labelled() && cell.highest_hard_cm == HeightGrid::kNone &&
                          cell.highest_soft_cm != HeightGrid::kNone &&
                          height_cm <= cell.highest_soft_cm + kSameBush_cm;
  if (packed.return_class() == ReturnClass::kSoft || known_soft) return Costmap::kSoft;
  return Costmap::kHard;
}

}  // namespace hardpack
