// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/assert.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/result.h"
#include "core/base/saturate.h"
#include "core/base/status.h"
#include "core/base/units.h"
#include "core/base/wide_int.h"
#include "core/measurements/measurements.h"

// The ring of lidar columns between the codec and the costmap, and the geometry that turns a column
// into points. It does not decode packets and does not classify returns. Sections 1 and 8 of
// docs/algorithm.md; range to XYZ as published by the sensor's manufacturer.

namespace hardpack {

// Converts beam angles in degrees, as in the sensor's metadata, to sines and cosines.
// altitude_deg, azimuth_deg: [beams]. columns_per_revolution: 1 .. kMaxColumnsPerRevolution.
// kInvalidArgument: counts out of range or different, an altitude beyond 90 degrees, an azimuth
// beyond 360, azimuths that differ by more than kMaxColumnShift columns; kNotFinite: an angle, the
// origin or the transform is not finite. On failure the model is empty.
// Cost: kMaxColumnsPerRevolution sines, and kMaxBeams^2 / 2 comparisons to order the beams.
Status MakeBeamModel(std::span<const float> altitude_deg, std::span<const float> azimuth_deg,
                     int columns_per_revolution, float origin_to_beam_m,
                     const Transform3& sensor_from_lidar, BeamModel& model);
// The same for a lidar's layout. kInvalidArgument also if more columns fire than there are places.
Status MakeBeamModel(const LidarLayout& layout, BeamModel& model);

// Sine and cosine of the encoder angle of one column, theta_e = 2 pi (1 - m / W), from the model's
// table. Precondition: 0 <= measurement_id < model.columns_per_revolution.
inline SinCosPair EncoderSinCos(const BeamModel& model, int measurement_id) {
  HP_ASSERT(measurement_id >= 0 && measurement_id < model.columns_per_revolution);
  return {model.sin_encoder[measurement_id], model.cos_encoder[measurement_id]};
}

// The largest azimuth offset that is taken, besides a limit in columns (ScanRing::TakesOffset).
inline constexpr float kMostAzimuthOffset_rad = 0.05f;

// The same for a column azimuth_offset_rad away from its place in the grid; bit for bit the table's
// value if the offset is 0. Sine and cosine by their series, to 3e-7 for |offset| <=
// kMostAzimuthOffset_rad; a larger one, or one that is not finite, counts as 0. Inline because
// every return passes through it.
inline SinCosPair EncoderSinCos(const BeamModel& model, int measurement_id,
                                float azimuth_offset_rad) {
  const SinCosPair encoder = EncoderSinCos(model, measurement_id);
  const float size_rad = Abs(azimuth_offset_rad);
  if (!(size_rad > 0.0f && size_rad <= kMostAzimuthOffset_rad)) return encoder;
  const float square = azimuth_offset_rad * azimuth_offset_rad;
  const float sin = azimuth_offset_rad - azimuth_offset_rad * square * (1.0f / 6.0f);
  const float cos = 1.0f - 0.5f * square;
  return {encoder.sin * cos + encoder.cos * sin, encoder.cos * cos - encoder.sin * sin};
}

// The point of one return in the lidar's sensor frame [m].
//   theta_e = 2 pi (1 - m / W), theta_a = -azimuth, phi = altitude, n = origin_to_beam
//   x = (r - n) cos(theta_e + theta_a) cos(phi) + n cos(theta_e); y with sin; z = (r - n) sin(phi)
// then the metadata's lidar-to-sensor transform. Precondition: 0 <= row < model.beams.
// Inline because every return passes through it twice.
inline Vec3 PointInSensor(const BeamModel& model, SinCosPair encoder, int row, uint32_t range_mm) {
  HP_ASSERT(row >= 0 && row < model.beams);
  const float beam_m = FromMillimeters(range_mm) - model.origin_to_beam_m;
  const float level_m = beam_m * model.cos_altitude[row];
  const float cos_beam =
      encoder.cos * model.cos_azimuth[row] - encoder.sin * model.sin_azimuth[row];
  const float sin_beam =
      encoder.sin * model.cos_azimuth[row] + encoder.cos * model.sin_azimuth[row];
  return model.sensor_from_lidar.Apply({level_m * cos_beam + model.origin_to_beam_m * encoder.cos,
                                        level_m * sin_beam + model.origin_to_beam_m * encoder.sin,
                                        beam_m * model.sin_altitude[row]});
}

// Range of the nearer of a beam's returns [mm]; 0: none. Precondition: 0 <= row < kMaxBeams.
uint32_t NearestRange(const LidarColumn& column, int row);

// One return as stored in the ring, in 32 bits.
//   bits 0-18 range [mm], 19-21 ReturnClass, 22 labelled, 23-30 height above the local ground,
//   31 the vehicle itself or outside the usable range
class PackedReturn {
 public:
  constexpr PackedReturn() = default;
  // Class kIgnored, unlabelled, height unknown. Precondition: range_mm < 2^19.
  static constexpr PackedReturn Raw(uint32_t range_mm, bool self) {
    PackedReturn packed;
    packed.bits_ = (range_mm & kRangeMask) | kHeightUnknown << kHeightShift |
                   static_cast<uint32_t>(self) << kSelfShift;
    return packed;
  }

  constexpr uint32_t range_mm() const { return bits_ & kRangeMask; }
  constexpr ReturnClass return_class() const {
    return static_cast<ReturnClass>((bits_ >> kClassShift) & 7u);
  }
  constexpr bool labelled() const { return ((bits_ >> kLabelledShift) & 1u) != 0; }
  constexpr bool self() const { return ((bits_ >> kSelfShift) & 1u) != 0; }
  constexpr bool height_known() const { return HeightCode() != kHeightUnknown; }
  // Height above the local ground [cm], in steps of 2 from kLowestHeight_cm to kHighestHeight_cm;
  // the end values also stand for everything beyond. Precondition: height_known().
  constexpr int32_t height_cm() const {
    return static_cast<int32_t>(HeightCode()) * kHeightStep_cm + kLowestHeight_cm;
  }

  constexpr void SetClass(ReturnClass return_class, bool labelled) {
    bits_ = (bits_ & ~(7u << kClassShift | 1u << kLabelledShift)) |
            static_cast<uint32_t>(return_class) << kClassShift |
            static_cast<uint32_t>(labelled) << kLabelledShift;
  }
  // Saturates.
  constexpr void SetHeight(int32_t height_cm) {
    // Rounds to the nearest step; the clamped difference is not negative.
    const int32_t above_cm =
        ClampInt(height_cm, kLowestHeight_cm, kHighestHeight_cm) - kLowestHeight_cm;
    const auto code = static_cast<uint32_t>((above_cm + kHeightStep_cm / 2) / kHeightStep_cm);
    bits_ = (bits_ & ~(0xffu << kHeightShift)) | (code < kHeightUnknown ? code : kHeightUnknown - 1)
                                                     << kHeightShift;
  }

  static constexpr int32_t kHeightStep_cm = 2;
  static constexpr int32_t kLowestHeight_cm = -100;
  static constexpr int32_t kHighestHeight_cm = kLowestHeight_cm + 254 * kHeightStep_cm;  // 4.08 m

 private:
  static constexpr uint32_t kRangeMask = 0x7ffffu;
  static constexpr uint32_t kClassShift = 19;
  static constexpr uint32_t kLabelledShift = 22;
  static constexpr uint32_t kHeightShift = 23;
  static constexpr uint32_t kSelfShift = 31;
  static constexpr uint32_t kHeightUnknown = 255;

  constexpr uint32_t HeightCode() const { return (bits_ >> kHeightShift) & 0xffu; }

  uint32_t bits_ = 0;
};

// The states of a column in the ring.
enum class ColumnState : uint8_t {
  kAbsent,   // never received, or its slot has not been used
  kRaw,      // its returns are not classed yet
  kClassed,  // its returns have their geometric class; the column is pending: it waits for labels
  kFolded,   // it is in the map and no longer changes
};

// What is known about one column of the ring.
struct ScanColumn {
  int64_t sequence = -1;    // sequence number; -1: none
  uint64_t time_ns = 0;     // when it was taken, our clock
  uint32_t fold_count = 0;  // ScanRing::fold_count() when it was folded
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  ColumnState state = ColumnState::kAbsent;
  bool labelled = false;
  float azimuth_offset_rad = 0.0f;  // as in LidarColumn
  Transform3 odom_from_sensor;      // pose of the sensor when the column was taken

  // As it is by default; by members, since a whole one is copied by a call of memcpy.
  void Clear() {
    sequence = -1;
    time_ns = 0;
    fold_count = 0;
    frame_id = 0;
    measurement_id = 0;
    state = ColumnState::kAbsent;
    labelled = false;
    azimuth_offset_rad = 0.0f;
    odom_from_sensor = Transform3{};
  }
};

// Counts of the input since Configure.
struct ScanCounters {
  uint32_t columns = 0;  // filed
  uint32_t duplicates = 0;
  uint32_t invalid_columns = 0;
  // Outside the window or the revolution, a wrong number of beams, or too far from its place.
  uint32_t bad_columns = 0;
  // In the window, skipped between two columns that were filed, or before EndRevolution.
  uint32_t missing_columns = 0;
  uint32_t late_columns = 0;      // filed after a later column; no longer missing
  uint32_t too_late_columns = 0;  // older than the ring reaches back: not filed
  uint32_t revolutions = 0;       // begun, including the first and those without any column
  // Of these, ended with columns missing. Columns that arrive afterwards do not change it.
  uint32_t incomplete_revolutions = 0;
  uint32_t restarts = 0;               // columns not filed because the sensor's count has jumped
  uint32_t unusable_ranges = 0;        // beyond what a PackedReturn holds; filed as no return
  uint32_t labels_without_column = 0;  // their column never arrived, or has left the ring
  uint32_t late_labels = 0;            // their column had already been folded
  uint32_t duplicate_labels = 0;
};

// The most recent revolutions, column by column, from arrival until a later revolution needs their
// slots: at least three revolutions. 250 ms of pending columns fit at 10 revolutions a second, and
// at 20 with up to 64 beams and 1024 columns; 128 x 1024 at 20 fills it in 150 ms. A column is
// identified by its sequence number: turn x columns + measurement id, where turn counts revolutions
// and neither wraps nor starts again after a restart. Owned by the caller; at most 2 MiB.
class ScanRing {
 public:
  static constexpr int kCapacityReturns = 131072;  // rows x columns of one revolution
  static constexpr int kMaxColumns = 6144;
  static constexpr int kMaxReturns = 393216;
  // How far from its place in the grid a column may have been measured.
  static constexpr float kMaxOffset_columns = 2.0f;
  // A larger jump of the frame counter, ahead or back, means a sensor restart, not a loss.
  static constexpr int kMaxFrameGap = 100;

  // Empties the ring and its counters. The window is the range of measurement ids that the sensor
  // sends, both ends included; first > last wraps past zero.
  // kCapacityExceeded if beams x columns do not fit; kInvalidArgument if a count is not positive or
  // beyond its maximum, or the window is not within the revolution. On failure the ring accepts
  // nothing. It holds as many whole revolutions as fit: slots() columns.
  // Cost: clears kMaxColumns and kMaxReturns.
  Status Configure(int beams, int columns_per_revolution, int window_first, int window_last);
  Status Configure(int beams, int columns_per_revolution) {
    return Configure(beams, columns_per_revolution, 0, columns_per_revolution - 1);
  }

  // Discards all columns but keeps the counters: the sensor has restarted. Columns missing from its
  // last revolution are not counted. Cost: kMaxColumns.
  void Restart();

  // The sensor has fallen silent: the revolution ends, and the rest of its window counts as missing
  // (columns of it that still arrive are late). Does nothing if it has already ended.
  void EndRevolution();

  // The sequence number that a column has or would have, without filing it. kNotStarted;
  // kBadColumn: outside the window or the revolution; kSensorRestarted: its frame id is more than
  // kMaxFrameGap from the newest column's, so call Restart() first; otherwise kLate: it is older
  // than the ring reaches, slots() columns back from the newest.
  Result<int64_t> SequenceOf(uint16_t frame_id, uint16_t measurement_id) const;

  // Whether a column's azimuth offset is finite, and at most kMaxOffset_columns and
  // kMostAzimuthOffset_rad.
  bool TakesOffset(const LidarColumn& column) const {
    const float most_rad = kMaxOffset_columns * kTwoPi / static_cast<float>(columns_);
    return Abs(column.azimuth_offset_rad) <= Min(most_rad, kMostAzimuthOffset_rad);
  }
  // The sensor's columns are not at the places of the grid: some places stay empty, and nothing is
  // lost.
  bool measures_azimuth() const { return measures_azimuth_; }

  // Files one column as kRaw, with its time and the sensor's pose at that time; it replaces what
  // its slot holds from an earlier revolution. Of each beam's returns, the nearer one is kept.
  // `self`: for each row, whether it is the vehicle itself or outside the usable range; [beams].
  // kColumnInvalid, kBadColumn, kDuplicate (the column is in the ring), kLate, kSensorRestarted:
  // counted, not filed; kBadColumn also for an invalid azimuth offset (TakesOffset).
  // kNotFinite: the pose; kNotStarted: Configure has not succeeded;
  // kInvalidArgument: self has the wrong size.
  // Cost: one pass over the rows, at most kMaxBeams.
  Status Push(const LidarColumn& column, uint64_t time_ns, const Transform3& odom_from_sensor,
              std::span<const uint8_t> self);

  // kOk if a column can still take labels, whether it is kRaw or kClassed. Otherwise counted:
  // kBadColumn: it is not in the ring; kDuplicate: it has its labels, folded or not; kLate: it was
  // folded without labels. Sets `sequence` in all cases but kBadColumn.
  Status FindForLabels(uint16_t frame_id, uint16_t measurement_id, int64_t& sequence);

  // Whether the column is in the ring.
  bool Holds(int64_t sequence) const {
    return sequence >= 0 && slots_ > 0 && info_[SlotOf(sequence)].sequence == sequence;
  }
  // The slot of a sequence number; every number that is not negative has one. Preconditions: the
  // number is not negative, and Configure has succeeded.
  int SlotOf(int64_t sequence) const {
    HP_ASSERT(sequence >= 0 && slots_ > 0);
    return Divide(sequence, slots_).remainder;
  }
  // The two parts of a sequence number. Preconditions as for SlotOf.
  int64_t TurnOf(int64_t sequence) const { return Parts(sequence).quotient; }
  int MeasurementIdOf(int64_t sequence) const { return Parts(sequence).remainder; }
  // The highest sequence number filed; -1 before the first.
  int64_t newest_sequence() const { return newest_sequence_; }
  int slots() const { return slots_; }

  // Preconditions: 0 <= slot < slots() and 0 <= row < beams(). The returns of a kAbsent column are
  // meaningless.
  const ScanColumn& column(int slot) const {
    HP_ASSERT(slot >= 0 && slot < slots_);
    return info_[slot];
  }
  PackedReturn at(int slot, int row) const { return returns_[Index(slot, row)]; }
  void Set(int slot, int row, PackedReturn packed) { returns_[Index(slot, row)] = packed; }
  // kRaw -> kClassed -> kFolded, never back. Preconditions: the column is present and in the
  // preceding state; for labels it is kRaw or kClassed.
  void MarkClassed(int slot);
  void MarkLabelled(int slot);
  void MarkFolded(int slot);
  // Columns folded since Configure.
  uint32_t fold_count() const { return fold_count_; }

  // Raises the poses of all columns by dz_m: the odometry's height has jumped. Precondition: dz_m
  // is finite. Cost: kMaxColumns.
  void ShiftHeights(float dz_m);

  // Number of columns in the sensor's window, and whether a measurement id is in it.
  int window_columns() const;
  bool InWindow(int measurement_id) const { return WindowPosition(measurement_id) >= 0; }

  int beams() const { return beams_; }
  int columns() const { return columns_; }
  const ScanCounters& counters() const { return counters_; }

 private:
  int Index(int slot, int row) const {
    HP_ASSERT(slot >= 0 && slot < slots_ && row >= 0 && row < beams_);
    return slot * beams_ + row;
  }
  Division Parts(int64_t sequence) const {
    HP_ASSERT(sequence >= 0 && columns_ > 0);
    return Divide(sequence, columns_);
  }
  int WindowPosition(int measurement_id) const;
  int64_t PlaceOf(int64_t sequence) const;
  void ForgetColumns();
  void Count(int64_t sequence);
  void BeginRevolutions(uint32_t count);
  void FileReturns(const LidarColumn& column, int slot, std::span<const uint8_t> self);

  int32_t beams_ = 0;
  int32_t columns_ = 0;
  int32_t slots_ = 0;  // whole revolutions x columns_
  int32_t window_first_ = 0;
  int32_t window_last_ = 0;
  int64_t newest_sequence_ = -1;
  int64_t first_turn_ = 0;  // turn of the next column while there is none yet
  // Places are columns of the window, numbered consecutively across revolutions. From the first to
  // the last of these two, inclusive, each one is filed or counted as missing.
  int64_t first_place_ = 0;
  int64_t last_place_ = 0;
  int32_t filed_in_revolution_ = 0;  // of the newest column
  bool revolution_ended_ = false;    // EndRevolution has counted it
  bool measures_azimuth_ = false;
  uint32_t fold_count_ = 0;
  ScanCounters counters_;
  ScanColumn info_[kMaxColumns] = {};
  PackedReturn returns_[kMaxReturns] = {};  // [slots x beams], row-major
};
static_assert(sizeof(ScanRing) <= 2 * 1024 * 1024);
static_assert(std::is_trivially_copyable_v<ScanRing>);

// True if a point is on the vehicle itself (point in the body frame, in the box of the parameters,
// edges included) or its range is outside the usable range.
bool IsSelfReturn(const LidarMountParams& params, const Vec3& point_body, float range_m);

// sensor -> body, from the mounting parameters.
Transform3 BodyFromSensor(const LidarMountParams& params);

}  // namespace hardpack
