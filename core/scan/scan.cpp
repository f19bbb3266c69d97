// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"

namespace hardpack {
namespace {

constexpr uint32_t kMaxPackedRange_mm = 0x7ffffu;
constexpr float kMillimetersPerMeter = 1000.0f;
constexpr float kMaxAltitude_deg = 90.0f;
constexpr float kMaxAzimuth_deg = 360.0f;

bool IsFiniteTransform(const Transform3& transform) {
  bool finite = IsFinite(transform.translation.x_m) && IsFinite(transform.translation.y_m) &&
                IsFinite(transform.translation.z_m);
  HP_LOOP_BOUND(9)
  for (int i = 0; i < 9; ++i) finite = finite && IsFinite(transform.rotation[i]);
  return finite;
}

Status CheckBeams(std::span<const float> altitude_deg, std::span<const float> azimuth_deg) {
  HP_LOOP_BOUND(kMaxBeams)
  for (size_t row = 0; row < altitude_deg.size(); ++row) {
    if (!IsFinite(altitude_deg[row]) || !IsFinite(azimuth_deg[row])) return Status::kNotFinite;
    if (Abs(altitude_deg[row]) > kMaxAltitude_deg || Abs(azimuth_deg[row]) > kMaxAzimuth_deg) {
      return Status::kInvalidArgument;
    }
  }
  return Status::kOk;
}

bool IsReturnClass(ReturnClass value) {
  return static_cast<uint8_t>(value) <= static_cast<uint8_t>(ReturnClass::kPerson);
}

}  // namespace

Status MakeBeamModel(std::span<const float> altitude_deg, std::span<const float> azimuth_deg,
                     int columns_per_revolution, float origin_to_beam_m,
                     const Transform3& sensor_from_lidar, BeamModel& model) {
  model.beams = 0;
  model.columns_per_revolution = 0;
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
  HP_LOOP_BOUND(kMaxBeams)
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
  model.origin_to_beam_m = origin_to_beam_m;
  model.sensor_from_lidar = sensor_from_lidar;
  return Status::kOk;
}

SinCosPair EncoderSinCos(const BeamModel& model, int measurement_id) {
  HP_ASSERT(measurement_id >= 0 && measurement_id < model.columns_per_revolution);
  const float share =
      static_cast<float>(measurement_id) / static_cast<float>(model.columns_per_revolution);
  return SinCos(kTwoPi * (1.0f - share));
}

Vec3 PointInSensor(const BeamModel& model, SinCosPair encoder, int row, uint32_t range_mm) {
  HP_ASSERT(row >= 0 && row < model.beams);
  const float range_m = static_cast<float>(range_mm) / kMillimetersPerMeter;
  const float beam_m = range_m - model.origin_to_beam_m;
  const float level_m = beam_m * model.cos_altitude[row];
  const float cos_beam =
      encoder.cos * model.cos_azimuth[row] - encoder.sin * model.sin_azimuth[row];
  const float sin_beam =
      encoder.sin * model.cos_azimuth[row] + encoder.cos * model.sin_azimuth[row];
  return model.sensor_from_lidar.Apply({level_m * cos_beam + model.origin_to_beam_m * encoder.cos,
                                        level_m * sin_beam + model.origin_to_beam_m * encoder.sin,
                                        beam_m * model.sin_altitude[row]});
}

Status ScanRing::Configure(int beams, int columns_per_revolution, int window_first,
                           int window_last) {
  beams_ = 0;
  columns_ = 0;
  any_ = false;
  counters_ = ScanCounters{};
  if (beams < 1 || beams > kMaxBeams || columns_per_revolution < 1 ||
      columns_per_revolution > kMaxColumnsPerRevolution || window_first < 0 ||
      window_first >= columns_per_revolution || window_last < 0 ||
      window_last >= columns_per_revolution) {
    return Status::kInvalidArgument;
  }
  if (beams * columns_per_revolution > kCapacityReturns) return Status::kCapacityExceeded;
  beams_ = beams;
  columns_ = columns_per_revolution;
  window_first_ = window_first;
  window_last_ = window_last;
  HP_LOOP_BOUND(kMaxColumnsPerRevolution)
  for (int slot = 0; slot < columns_; ++slot) info_[slot].present = false;
  HP_LOOP_BOUND(kCapacityReturns)
  for (int i = 0; i < beams_ * columns_; ++i) returns_[i] = PackedReturn();
  return Status::kOk;
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

// Counts columns in the order the sensor took them: an ideal stream advances by one.
void ScanRing::CountSequence(const LidarColumn& column, int position) {
  const int32_t frames = static_cast<int16_t>(static_cast<uint16_t>(
      static_cast<uint32_t>(column.frame_id) - static_cast<uint32_t>(last_frame_id_)));
  const int32_t advance = frames * window_columns() + (position - last_position_);
  if (any_ && advance < 0 && advance > -window_columns()) {
    ++counters_.late_columns;
    return;  // the latest column stays the latest
  }
  if (any_ && (advance <= 0 || frames > kMaxFrameGap)) {
    ++counters_.restarts;
  } else if (any_) {
    counters_.missing_columns += static_cast<uint32_t>(advance - 1);
  }
  any_ = true;
  last_frame_id_ = column.frame_id;
  last_position_ = position;
}

Status ScanRing::Push(const LidarColumn& column, const Transform3& odom_from_sensor,
                      ReturnClass unlabelled_class) {
  HP_ASSERT(IsReturnClass(unlabelled_class));
  if (columns_ == 0) return Status::kNotStarted;
  if (!IsFiniteTransform(odom_from_sensor)) return Status::kNotFinite;
  if (!column.valid) {
    ++counters_.invalid_columns;
    return Status::kColumnInvalid;
  }
  const int position = WindowPosition(column.measurement_id);
  if (position < 0 || column.beams != beams_) {
    ++counters_.bad_columns;
    return Status::kBadColumn;
  }
  ScanColumn& info = info_[column.measurement_id];
  if (info.present && info.frame_id == column.frame_id &&
      info.timestamp_ns == column.timestamp_ns) {
    ++counters_.duplicates;
    return Status::kDuplicate;
  }
  CountSequence(column, position);
  ++counters_.columns;
  info = {column.timestamp_ns, column.frame_id, column.measurement_id, true, odom_from_sensor};
  PackedReturn* const returns = &returns_[column.measurement_id * beams_];
  HP_LOOP_BOUND(kMaxBeams)
  for (int row = 0; row < beams_; ++row) {
    uint32_t range_mm = column.range_mm[row];
    if (range_mm > kMaxPackedRange_mm) {
      range_mm = 0;
      ++counters_.unusable_ranges;
    }
    returns[row] =
        PackedReturn(range_mm, range_mm == 0 ? ReturnClass::kIgnored : unlabelled_class, false);
  }
  return Status::kOk;
}

Status ScanRing::Label(const ColumnLabels& labels) {
  const bool known = labels.measurement_id < columns_ && labels.beams == beams_ &&
                     info_[labels.measurement_id].present &&
                     info_[labels.measurement_id].frame_id == labels.frame_id;
  if (!known) {
    ++counters_.labels_without_column;
    return Status::kBadColumn;
  }
  HP_LOOP_BOUND(kMaxBeams)
  for (int row = 0; row < beams_; ++row) {
    if (!IsReturnClass(labels.label[row])) return Status::kInvalidArgument;
  }
  PackedReturn* const returns = &returns_[labels.measurement_id * beams_];
  HP_LOOP_BOUND(kMaxBeams)
  for (int row = 0; row < beams_; ++row) {
    const uint32_t range_mm = returns[row].range_mm();
    returns[row] =
        PackedReturn(range_mm, range_mm == 0 ? ReturnClass::kIgnored : labels.label[row], true);
  }
  return Status::kOk;
}

const ScanColumn& ScanRing::column(int slot) const {
  HP_ASSERT(slot >= 0 && slot < columns_);
  return info_[slot];
}

PackedReturn ScanRing::at(int slot, int row) const {
  HP_ASSERT(slot >= 0 && slot < columns_ && row >= 0 && row < beams_);
  return returns_[slot * beams_ + row];
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
