// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"

namespace hardpack {
namespace {

constexpr uint32_t kMaxPackedRange_mm = 0x7ffffu;
constexpr float kMaxAltitude_deg = 90.0f;
constexpr float kMaxAzimuth_deg = 360.0f;
constexpr float kTurn_deg = 360.0f;

bool IsFiniteTransform(const Transform3& transform) {
  bool finite = IsFinite(transform.translation);
  HP_LOOP_BOUND(9)
  for (int i = 0; i < 9; ++i) finite = finite && IsFinite(transform.rotation[i]);
  return finite;
}

Status CheckBeams(std::span<const float> altitude_deg, std::span<const float> azimuth_deg) {
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (size_t row = 0; row < altitude_deg.size(); ++row) {
    if (!IsFinite(altitude_deg[row]) || !IsFinite(azimuth_deg[row])) return Status::kNotFinite;
    if (Abs(altitude_deg[row]) > kMaxAltitude_deg || Abs(azimuth_deg[row]) > kMaxAzimuth_deg) {
      return Status::kInvalidArgument;
    }
  }
  return Status::kOk;
}

// theta_e(j + s) + theta_a = theta_e(j) + const makes s = -azimuth W / 360 + const, modulo W: of
// those the one next to row 0's, so that it does not matter where the azimuths have their zero.
Status SetColumnShifts(std::span<const float> azimuth_deg, int columns, BeamModel& model) {
  const float columns_per_deg = static_cast<float>(columns) / kTurn_deg;
  const int32_t first = RoundToInt(-azimuth_deg[0] * columns_per_deg);
  int32_t least = 0;
  int32_t most = 0;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (size_t row = 0; row < azimuth_deg.size(); ++row) {
    const int32_t apart = (RoundToInt(-azimuth_deg[row] * columns_per_deg) - first) % columns;
    const int32_t ahead = apart < 0 ? apart + columns : apart;
    const int32_t shift = 2 * ahead > columns ? ahead - columns : ahead;
    model.column_shift[row] = shift;
    least = shift < least ? shift : least;
    most = shift > most ? shift : most;
  }
  if (most - least > kMaxColumnShift) return Status::kInvalidArgument;
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (size_t row = 0; row < azimuth_deg.size(); ++row) model.column_shift[row] -= least;
  model.max_column_shift = most - least;
  return Status::kOk;
}

// By insertion: beams of the same altitude stay in the order of their rows.
void OrderByAltitude(std::span<const float> altitude_deg, BeamModel& model) {
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (size_t row = 0; row < altitude_deg.size(); ++row) {
    size_t place = row;
    HP_LOOP_BOUND_BEAMS(kMaxBeams - 1)
    while (place > 0 && altitude_deg[model.by_altitude[place - 1]] > altitude_deg[row]) {
      model.by_altitude[place] = model.by_altitude[place - 1];
      --place;
    }
    model.by_altitude[place] = static_cast<uint8_t>(row);
  }
}

void SetEncoderAngles(int columns, BeamModel& model) {
  HP_LOOP_BOUND(kMaxColumnsPerRevolution)
  for (int id = 0; id < columns; ++id) {
    const float share = static_cast<float>(id) / static_cast<float>(columns);
    const SinCosPair encoder = SinCos(kTwoPi * (1.0f - share));
    model.sin_encoder[id] = encoder.sin;
    model.cos_encoder[id] = encoder.cos;
  }
}

}  // namespace

Status MakeBeamModel(std::span<const float> altitude_deg, std::span<const float> azimuth_deg,
                     int columns_per_revolution, float origin_to_beam_m,
                     const Transform3& sensor_from_lidar, BeamModel& model) {
  model.beams = 0;
  model.columns_per_revolution = 0;
  model.fired_per_revolution = 0;
  model.max_column_shift = 0;
  if (altitude_deg.empty() || altitude_deg.size() > kMaxBeams ||
      altitude_deg.size() != azimuth_deg.size() || columns_per_revolution < 1 ||
      columns_per_revolution > kMaxColumnsPerRevolution) {
    return Status::kInvalidArgument;
  }
  if (!IsFinite(origin_to_beam_m) || !IsFiniteTransform(sensor_from_lidar)) {
    return Status::kNotFinite;
  }
  if (const Status status = CheckBeams(altitude_deg, azimuth_deg); !IsUsable(status)) {
    return status;
  }
  if (const Status status = SetColumnShifts(azimuth_deg, columns_per_revolution, model);
      !IsUsable(status)) {
    return status;
  }
  OrderByAltitude(altitude_deg, model);
  SetEncoderAngles(columns_per_revolution, model);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (size_t row = 0; row < altitude_deg.size(); ++row) {
    const SinCosPair altitude = SinCos(altitude_deg[row] * kRadPerDeg);
    const SinCosPair azimuth = SinCos(-azimuth_deg[row] * kRadPerDeg);
    model.sin_altitude[row] = altitude.sin;
    model.cos_altitude[row] = altitude.cos;
    model.sin_azimuth[row] = azimuth.sin;
    model.cos_azimuth[row] = azimuth.cos;
  }
  model.beams = static_cast<int32_t>(altitude_deg.size());
  model.columns_per_revolution = columns_per_revolution;
  model.fired_per_revolution = columns_per_revolution;
  model.origin_to_beam_m = origin_to_beam_m;
  model.sensor_from_lidar = sensor_from_lidar;
  return Status::kOk;
}

Status MakeBeamModel(const LidarLayout& layout, BeamModel& model) {
  const Status status =
      MakeBeamModel(layout.altitude_deg, layout.azimuth_deg, layout.columns_per_revolution,
                    layout.origin_to_beam_m, layout.sensor_from_lidar, model);
  const int32_t fired = layout.fired_per_revolution;
  if (!IsUsable(status) || fired == 0) return status;
  if (fired < 0 || fired > model.columns_per_revolution) {
    model.beams = 0;
    model.columns_per_revolution = 0;
    model.fired_per_revolution = 0;
    return Status::kInvalidArgument;
  }
  model.fired_per_revolution = fired;
  return Status::kOk;
}

uint32_t NearestRange(const LidarColumn& column, int row) {
  HP_ASSERT(row >= 0 && row < kMaxBeams);
  const uint32_t first_mm = column.range_mm[row];
  if (column.returns < 2) return first_mm;
  const uint32_t second_mm = column.second_range_mm[row];
  if (first_mm == 0) return second_mm;
  return second_mm != 0 && second_mm < first_mm ? second_mm : first_mm;
}

Status ScanRing::Configure(int beams, int columns_per_revolution, int window_first,
                           int window_last) {
  beams_ = 0;
  columns_ = 0;
  slots_ = 0;
  newest_sequence_ = -1;
  first_turn_ = 0;
  fold_count_ = 0;
  measures_azimuth_ = false;
  counters_ = ScanCounters{};
  if (beams < 1 || beams > kMaxBeams || columns_per_revolution < 1 ||
      columns_per_revolution > kMaxColumnsPerRevolution || window_first < 0 ||
      window_first >= columns_per_revolution || window_last < 0 ||
      window_last >= columns_per_revolution) {
    return Status::kInvalidArgument;
  }
  const int32_t returns = beams * columns_per_revolution;
  if (returns > kCapacityReturns) return Status::kCapacityExceeded;
  beams_ = beams;
  columns_ = columns_per_revolution;
  window_first_ = window_first;
  window_last_ = window_last;
  const int32_t turns = ClampInt(kMaxReturns / returns, 1, kMaxColumns / columns_);
  slots_ = turns * columns_;
  // From here on each column that the ring reaches back to has a number that is not negative.
  first_turn_ = turns;
  ForgetColumns();
  HP_LOOP_BOUND(kMaxReturns)
  for (int i = 0; i < slots_ * beams_; ++i) returns_[i] = PackedReturn();
  return Status::kOk;
}

void ScanRing::ForgetColumns() {
  newest_sequence_ = -1;
  HP_LOOP_BOUND(kMaxColumns)
  for (int slot = 0; slot < slots_; ++slot) info_[slot].Clear();
}

void ScanRing::Restart() {
  if (newest_sequence_ < 0) return;
  // No number is given twice: what comes late reaches back to after the newest of before.
  first_turn_ = TurnOf(newest_sequence_) + slots_ / columns_ + 1;
  ForgetColumns();
}

int ScanRing::window_columns() const {
  if (columns_ == 0) return 0;
  if (window_first_ <= window_last_) return window_last_ - window_first_ + 1;
  return columns_ - window_first_ + window_last_ + 1;
}

// Where a column comes within its revolution, which begins at measurement id 0 also when the window
// wraps (the sensor counts its frames at the encoder's zero); -1 off the window.
int ScanRing::WindowPosition(int measurement_id) const {
  if (measurement_id < 0 || measurement_id >= columns_) return -1;
  if (window_first_ <= window_last_) {
    const bool inside = measurement_id >= window_first_ && measurement_id <= window_last_;
    return inside ? measurement_id - window_first_ : -1;
  }
  if (measurement_id <= window_last_) return measurement_id;
  if (measurement_id < window_first_) return -1;
  return measurement_id - window_first_ + window_last_ + 1;
}

Result<int64_t> ScanRing::SequenceOf(uint16_t frame_id, uint16_t measurement_id) const {
  if (columns_ == 0) return Status::kNotStarted;
  if (!InWindow(measurement_id)) return Status::kBadColumn;
  if (newest_sequence_ < 0) return first_turn_ * columns_ + measurement_id;
  // Frame ids wrap: the difference of 16 bits is the way from one to the other.
  const uint32_t newest_frame = info_[SlotOf(newest_sequence_)].frame_id;
  const int32_t ahead = static_cast<int16_t>(static_cast<uint16_t>(frame_id - newest_frame));
  if (ahead > kMaxFrameGap || ahead < -kMaxFrameGap) return Status::kSensorRestarted;
  const int64_t sequence = (TurnOf(newest_sequence_) + ahead) * columns_ + measurement_id;
  if (sequence <= newest_sequence_ - slots_) return Status::kLate;
  return sequence;
}

// Counts a column that is about to be filed: the window's columns between the first and the last
// that were filed are either filed or missing.
void ScanRing::Count(int64_t sequence) {
  const int64_t turn = TurnOf(sequence);
  const int64_t place = PlaceOf(sequence);
  const bool first = newest_sequence_ < 0;
  const int64_t newest_turn = first ? turn - 1 : TurnOf(newest_sequence_);
  if (first) {
    first_place_ = place;
    last_place_ = place - 1;
  }
  if (turn > newest_turn) {
    if (!first) EndRevolution();
    BeginRevolutions(static_cast<uint32_t>(turn - newest_turn));
  }
  if (turn >= newest_turn) ++filed_in_revolution_;
  ++counters_.columns;
  if (place > last_place_) {
    counters_.missing_columns += static_cast<uint32_t>(place - last_place_ - 1);
    last_place_ = place;
    return;
  }
  ++counters_.late_columns;
  if (place > first_place_) {
    --counters_.missing_columns;
    return;
  }
  counters_.missing_columns += static_cast<uint32_t>(first_place_ - place - 1);
  first_place_ = place;
}

// The last of `count`; of the others nothing came.
void ScanRing::BeginRevolutions(uint32_t count) {
  counters_.revolutions += count;
  counters_.incomplete_revolutions += count - 1;
  filed_in_revolution_ = 0;
  revolution_ended_ = false;
}

void ScanRing::EndRevolution() {
  if (newest_sequence_ < 0 || revolution_ended_) return;
  revolution_ended_ = true;
  const int64_t begin = TurnOf(newest_sequence_) * window_columns();
  const int64_t end = begin + window_columns();
  counters_.missing_columns += static_cast<uint32_t>(end - 1 - last_place_);
  last_place_ = end - 1;
  // What the sensor sent before it was first heard is not missing.
  const int64_t expected = end - (first_place_ > begin ? first_place_ : begin);
  if (filed_in_revolution_ < expected) ++counters_.incomplete_revolutions;
}

Status ScanRing::Push(const LidarColumn& column, uint64_t time_ns,
                      const Transform3& odom_from_sensor, std::span<const uint8_t> self) {
  if (columns_ == 0) return Status::kNotStarted;
  if (self.size() != static_cast<size_t>(beams_)) return Status::kInvalidArgument;
  if (!IsFiniteTransform(odom_from_sensor)) return Status::kNotFinite;
  if (!column.valid) {
    ++counters_.invalid_columns;
    return Status::kColumnInvalid;
  }
  const Result<int64_t> named = SequenceOf(column.frame_id, column.measurement_id);
  if (column.beams != beams_ || named.status() == Status::kBadColumn || !TakesOffset(column)) {
    ++counters_.bad_columns;
    return Status::kBadColumn;
  }
  if (!named.ok()) {
    ++(named.status() == Status::kLate ? counters_.too_late_columns : counters_.restarts);
    return named.status();
  }
  const int64_t sequence = named.value();
  if (Holds(sequence)) {
    ++counters_.duplicates;
    return Status::kDuplicate;
  }
  Count(sequence);
  const int slot = SlotOf(sequence);
  ScanColumn& info = info_[slot];
  info.Clear();
  info.sequence = sequence;
  info.time_ns = time_ns;
  info.frame_id = column.frame_id;
  info.measurement_id = column.measurement_id;
  info.state = ColumnState::kRaw;
  info.azimuth_offset_rad = column.azimuth_offset_rad;
  measures_azimuth_ = measures_azimuth_ || column.azimuth_offset_rad != 0.0f;
  info.odom_from_sensor = odom_from_sensor;
  FileReturns(column, slot, self);
  if (sequence > newest_sequence_) newest_sequence_ = sequence;
  return Status::kOk;
}

void ScanRing::FileReturns(const LidarColumn& column, int slot, std::span<const uint8_t> self) {
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int row = 0; row < beams_; ++row) {
    uint32_t range_mm = NearestRange(column, row);
    if (range_mm > kMaxPackedRange_mm) {
      range_mm = 0;
      ++counters_.unusable_ranges;
    }
    returns_[slot * beams_ + row] =
        PackedReturn::Raw(range_mm, self[static_cast<size_t>(row)] != 0);
  }
}

Status ScanRing::FindForLabels(uint16_t frame_id, uint16_t measurement_id, int64_t& sequence) {
  const Result<int64_t> named = SequenceOf(frame_id, measurement_id);
  if (!named.ok() || !Holds(named.value())) {
    ++counters_.labels_without_column;
    return Status::kBadColumn;
  }
  sequence = named.value();
  const ScanColumn& info = info_[SlotOf(sequence)];
  if (info.labelled) {
    ++counters_.duplicate_labels;
    return Status::kDuplicate;
  }
  if (info.state == ColumnState::kFolded) {
    ++counters_.late_labels;
    return Status::kLate;
  }
  return Status::kOk;
}

int64_t ScanRing::PlaceOf(int64_t sequence) const {
  const Division at = Parts(sequence);
  return at.quotient * window_columns() + WindowPosition(at.remainder);
}

void ScanRing::MarkClassed(int slot) {
  HP_ASSERT(column(slot).state == ColumnState::kRaw);
  info_[slot].state = ColumnState::kClassed;
}

void ScanRing::MarkLabelled(int slot) {
  HP_ASSERT(column(slot).state == ColumnState::kRaw || column(slot).state == ColumnState::kClassed);
  info_[slot].labelled = true;
}

void ScanRing::MarkFolded(int slot) {
  HP_ASSERT(column(slot).state == ColumnState::kClassed);
  info_[slot].state = ColumnState::kFolded;
  info_[slot].fold_count = fold_count_++;
}

void ScanRing::ShiftHeights(float dz_m) {
  HP_LOOP_BOUND(kMaxColumns)
  for (int slot = 0; slot < slots_; ++slot) info_[slot].odom_from_sensor.translation.z_m += dz_m;
}

bool IsSelfReturn(const LidarMountParams& params, const Vec3& point_body, float range_m) {
  if (range_m < params.min_range_m || range_m > params.max_range_m) return true;
  return point_body.x_m >= params.self_min_x_m && point_body.x_m <= params.self_max_x_m &&
         Abs(point_body.y_m) <= params.self_max_abs_y_m && point_body.z_m <= params.self_max_z_m;
}

Transform3 BodyFromSensor(const LidarMountParams& params) {
  return TransformFromRollPitchYaw(params.roll_rad, params.pitch_rad, params.yaw_rad,
                                   {params.x_m, params.y_m, params.z_m});
}

}  // namespace hardpack
