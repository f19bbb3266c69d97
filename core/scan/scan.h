// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/result.h"
#include "core/measurements/measurements.h"

// The ring of lidar columns between the codec and the costmap, and the geometry that turns a column
// into classed points of the odom frame. Does not decode packets and does not decide what a return
// is. Section 1 of docs/algorithm.md; range to XYZ as published by the sensor's maker.

namespace hardpack {

// Beam angles in degrees, as the sensor's metadata give them.
// altitude_deg, azimuth_deg: [beams]. columns: 1 .. kMaxColumnsPerRevolution.
// kInvalidArgument: counts out of range or different; kNotFinite: an angle or the origin is.
Result<BeamModel> MakeBeamModel(std::span<const float> altitude_deg,
                                std::span<const float> azimuth_deg, int columns_per_revolution,
                                float origin_to_beam_m, const Transform3& sensor_from_lidar);

// The point of one return in the lidar's sensor frame [m].
//   theta_e = 2 pi (1 - m / W), theta_a = -azimuth, phi = altitude, n = origin_to_beam
//   x = (r - n) cos(theta_e + theta_a) cos(phi) + n cos(theta_e); y with sin; z = (r - n) sin(phi)
// encoder: SinCos(theta_e) of the column. Precondition: 0 <= row < model.beams.
Vec3 PointInSensor(const BeamModel& model, float sin_encoder, float cos_encoder, int row,
                   uint32_t range_mm);

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

// Counts of what came in, never reset by the ring itself.
struct ScanCounters {
  uint32_t columns = 0;
  uint32_t duplicates = 0;
  uint32_t invalid_columns = 0;
  uint32_t bad_columns = 0;      // measurement id beyond the revolution, or another number of beams
  uint32_t missing_columns = 0;  // skipped between two received columns
  uint32_t labels_without_column = 0;
};

// The most recent revolution, column by column: a slot a measurement id, overwritten a revolution
// later. rows x columns <= kCapacityReturns, else Configure refuses. Owned by the caller; 2 MiB.
class ScanRing {
 public:
  static constexpr int kCapacityReturns = 131072;

  // Empties the ring. kCapacityExceeded when beams x columns do not fit; kInvalidArgument when a
  // count is not positive or beyond its maximum.
  Status Configure(int beams, int columns_per_revolution);

  // Files one column with the pose of its time; every return is unlabelled and has class kIgnored
  // where there is none, else `unlabelled_class`.
  // kColumnInvalid, kBadColumn, kDuplicate (same frame and measurement id): counted, not filed.
  // Cost: one pass over the rows.
  Status Push(const LidarColumn& column, const Transform3& odom_from_sensor,
              ReturnClass unlabelled_class);

  // Sets the classes of a column that is in the ring. kBadColumn when it is not.
  Status Label(const ColumnLabels& labels);

  int beams() const { return beams_; }
  int columns() const { return columns_; }
  const ScanCounters& counters() const { return counters_; }

  // Precondition: 0 <= slot < columns() and 0 <= row < beams(). slot = measurement id.
  const ScanColumn& column(int slot) const;
  PackedReturn at(int slot, int row) const;

 private:
  int32_t beams_ = 0;
  int32_t columns_ = 0;
  bool any_ = false;
  uint16_t last_frame_id_ = 0;
  uint16_t last_measurement_id_ = 0;
  ScanCounters counters_;
  ScanColumn info_[kMaxColumnsPerRevolution] = {};
  PackedReturn returns_[kCapacityReturns] = {};  // [columns x beams], row-major
};
static_assert(sizeof(ScanRing) <= 2 * 1024 * 1024);

// True when a point lies on the vehicle itself (point in the body frame) or its range is outside
// the usable one.
bool IsSelfReturn(const LidarMountParams& params, const Vec3& point_body, float range_m);

// sensor -> body, from the mounting parameters.
Transform3 BodyFromSensor(const LidarMountParams& params);

}  // namespace hardpack
