// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "config/parameters.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The ring of lidar columns between the codec and the costmap, and the geometry that turns a column
// into classed points of the odom frame. Does not decode packets and does not decide what a return
// is. Section 1 of docs/algorithm.md; range to XYZ as published by the sensor's maker.

namespace hardpack {

// Beam angles in degrees, as the sensor's metadata give them, to sines and cosines.
// altitude_deg, azimuth_deg: [beams]. columns_per_revolution: 1 .. kMaxColumnsPerRevolution.
// kInvalidArgument: counts out of range or different, an altitude beyond 90 degrees, an azimuth
// beyond 360; kNotFinite: an angle, the origin or the transform is. On failure the model is empty.
Status MakeBeamModel(std::span<const float> altitude_deg, std::span<const float> azimuth_deg,
                     int columns_per_revolution, float origin_to_beam_m,
                     const Transform3& sensor_from_lidar, BeamModel& model);

// Sine and cosine of the encoder angle of one column: theta_e = 2 pi (1 - m / W).
// Precondition: 0 <= measurement_id < model.columns_per_revolution.
SinCosPair EncoderSinCos(const BeamModel& model, int measurement_id);

// The point of one return in the lidar's sensor frame [m].
//   theta_e = 2 pi (1 - m / W), theta_a = -azimuth, phi = altitude, n = origin_to_beam
//   x = (r - n) cos(theta_e + theta_a) cos(phi) + n cos(theta_e); y with sin; z = (r - n) sin(phi)
// and from there the metadata's lidar-to-sensor transform. Precondition: 0 <= row < model.beams.
Vec3 PointInSensor(const BeamModel& model, SinCosPair encoder, int row, uint32_t range_mm);

// One return as it lies in the ring: range, class and flags in 32 bits.
//   bits 0-18 range [mm], 19-21 ReturnClass, 22 labelled, 23-31 zero
class PackedReturn {
 public:
  constexpr PackedReturn() = default;
  constexpr PackedReturn(uint32_t range_mm, ReturnClass return_class, bool labelled)
      : bits_((range_mm & 0x7ffffu) | (static_cast<uint32_t>(return_class) << 19) |
              (static_cast<uint32_t>(labelled) << 22)) {}
  constexpr uint32_t range_mm() const { return bits_ & 0x7ffffu; }
  constexpr ReturnClass return_class() const {
    return static_cast<ReturnClass>((bits_ >> 19) & 7u);
  }
  constexpr bool labelled() const { return ((bits_ >> 22) & 1u) != 0; }

 private:
  uint32_t bits_ = 0;
};

// What is known of one column of the ring.
struct ScanColumn {
  uint64_t timestamp_ns = 0;
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  bool present = false;
  Transform3 odom_from_sensor;  // pose of the sensor when the column was taken
};

// Counts of what came in since Configure.
struct ScanCounters {
  uint32_t columns = 0;  // filed
  uint32_t duplicates = 0;
  uint32_t invalid_columns = 0;
  uint32_t bad_columns = 0;      // off the window or the revolution, or another number of beams
  uint32_t missing_columns = 0;  // of the window, skipped between two columns that were filed
  uint32_t late_columns = 0;     // filed although a later one had come
  uint32_t restarts = 0;         // jumps in the sensor's counting: nothing is counted as missing
  uint32_t unusable_ranges = 0;  // beyond what a PackedReturn holds; filed as no return
  uint32_t labels_without_column = 0;
};

// The most recent revolution, column by column: a slot a measurement id, overwritten a revolution
// later (a slot whose column went missing keeps the previous one: its frame_id tells). Owned by the
// caller; at most 2 MiB.
class ScanRing {
 public:
  static constexpr int kCapacityReturns = 131072;
  // A frame counter that jumps further ahead is a restart of the sensor, not a loss.
  static constexpr int kMaxFrameGap = 100;

  // Empties the ring and its counters. The window is the range of measurement ids that the sensor
  // sends, both ends included; first > last wraps past zero.
  // kCapacityExceeded when beams x columns do not fit; kInvalidArgument when a count is not
  // positive or beyond its maximum, or the window is not within the revolution. On failure the ring
  // takes nothing.
  Status Configure(int beams, int columns_per_revolution, int window_first, int window_last);
  Status Configure(int beams, int columns_per_revolution) {
    return Configure(beams, columns_per_revolution, 0, columns_per_revolution - 1);
  }

  // Files one column with the pose of its time; every return is unlabelled and has class kIgnored
  // where there is none, else `unlabelled_class`.
  // kColumnInvalid, kBadColumn, kDuplicate (same frame, measurement id and time stamp): counted,
  // not filed. kNotFinite: the pose; kNotStarted: Configure has not succeeded.
  // Cost: one pass over the rows, at most kMaxBeams.
  Status Push(const LidarColumn& column, const Transform3& odom_from_sensor,
              ReturnClass unlabelled_class);

  // Sets the classes of a column that is in the ring; where there is no return the class stays
  // kIgnored. kBadColumn, and counted, when it is not; kInvalidArgument: a class that is none.
  Status Label(const ColumnLabels& labels);

  // Columns in the sensor's window, and whether a measurement id is one of them.
  int window_columns() const;
  bool InWindow(int measurement_id) const { return WindowPosition(measurement_id) >= 0; }

  int beams() const { return beams_; }
  int columns() const { return columns_; }
  const ScanCounters& counters() const { return counters_; }

  // Precondition: 0 <= slot < columns() and 0 <= row < beams(). slot = measurement id.
  const ScanColumn& column(int slot) const;
  PackedReturn at(int slot, int row) const;

 private:
  int WindowPosition(int measurement_id) const;
  void CountSequence(const LidarColumn& column, int position);

  int32_t beams_ = 0;
  int32_t columns_ = 0;
  int32_t window_first_ = 0;
  int32_t window_last_ = 0;
  bool any_ = false;
  uint16_t last_frame_id_ = 0;
  int32_t last_position_ = 0;
  ScanCounters counters_;
  ScanColumn info_[kMaxColumnsPerRevolution] = {};
  PackedReturn returns_[kCapacityReturns] = {};  // [columns x beams], row-major
};
static_assert(sizeof(ScanRing) <= 2 * 1024 * 1024);
static_assert(std::is_trivially_copyable_v<ScanRing>);

// True when a point lies on the vehicle itself (point in the body frame, in the box of the
// parameters, edges included) or its range is outside the usable one.
bool IsSelfReturn(const LidarMountParams& params, const Vec3& point_body, float range_m);

// sensor -> body, from the mounting parameters.
Transform3 BodyFromSensor(const LidarMountParams& params);

}  // namespace hardpack
