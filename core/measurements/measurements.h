// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/pose.h"

// Typed measurements: what the codecs of hal make of bytes and what the stages of core work on.
// Types only.

namespace hardpack {

// The largest lidar: 128 beams; 2048 columns a revolution at 64 beams, 1024 at 128.
inline constexpr int kMaxBeams = 128;
inline constexpr int kMaxColumnsPerRevolution = 2048;
// Beams' azimuth offsets reach over at most so many columns: the wait until a direction is
// complete.
inline constexpr int kMaxColumnShift = 128;

// What a return is, as far as driving goes ([OS] Cost Map Creation; person and ignored are ours).
enum class ReturnClass : uint8_t {
  kIgnored = 0,  // no return, void, sky, the vehicle itself
  kGround = 1,
  kSoft = 2,    // to be avoided, but may be driven through: bushes, tall grass
  kHard = 3,    // never to be driven through: trees, rocks, fences
  kPerson = 4,  // hard, and counted as a person
};

// One measurement column: all beams fired at one encoder position. [beams] arrays, row 0 first as
// the sensor sends them.
struct LidarColumn {
  uint64_t timestamp_ns = 0;          // sensor's clock
  uint16_t measurement_id = 0;        // column of the revolution, 0 .. columns_per_frame - 1
  uint16_t frame_id = 0;              // revolution counter, wraps
  uint32_t encoder_ticks = 0;         // LEGACY: 90112 a revolution; 0 where the profile has none
  uint32_t status = 0;                // as sent
  bool valid = false;                 // the sensor vouches for this column
  int32_t beams = 0;                  // rows used in the arrays below
  uint32_t range_mm[kMaxBeams] = {};  // 0: no return
  uint16_t signal[kMaxBeams] = {};
  uint16_t reflectivity[kMaxBeams] = {};
  uint16_t near_ir[kMaxBeams] = {};
  uint8_t flags[kMaxBeams] = {};
  // Profiles with two returns a beam: the second one; with one return these are not written.
  int32_t returns = 1;  // a beam
  uint32_t second_range_mm[kMaxBeams] = {};
  uint16_t second_signal[kMaxBeams] = {};
  uint16_t second_reflectivity[kMaxBeams] = {};
  uint8_t second_flags[kMaxBeams] = {};
};

// What an external segmentation says of one column's returns, in raw measurement order: codes of
// its ontology (core/segmentation turns them into classes).
struct ColumnLabels {
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  int32_t beams = 0;
  uint8_t label[kMaxBeams] = {};
};

// One sample of an inertial sensor, in its own frame.
struct ImuSample {
  uint64_t acceleration_time_ns = 0;  // sensor's clock, of each of the two readings
  uint64_t angular_rate_time_ns = 0;
  Vec3 acceleration_mps2;  // specific force: +9.81 upward at rest
  Vec3 angular_rate_radps;
};

// Where the vehicle was: body -> odom, as position and as Rz(yaw) Ry(pitch) Rx(roll).
struct StampedPose {
  uint64_t time_ns = 0;  // our clock
  Vec3 position;         // [m]
  float roll_rad = 0.0f;
  float pitch_rad = 0.0f;
  float yaw_rad = 0.0f;
};

// Geometry of the beams: everything that turns (column, row, range) into a point of the lidar's
// sensor frame. Angles as sines and cosines, computed once by MakeBeamModel (core/scan).
struct BeamModel {
  int32_t beams = 0;
  int32_t columns_per_revolution = 0;
  float origin_to_beam_m = 0.0f;  // lidar_origin_to_beam_origin
  float sin_altitude[kMaxBeams] = {};
  float cos_altitude[kMaxBeams] = {};
  float sin_azimuth[kMaxBeams] = {};  // of theta_a = -beam_azimuth
  float cos_azimuth[kMaxBeams] = {};
  // Beams of one column look in different directions: row r looks along direction j of the
  // revolution (j as a measurement id) at measurement j + column_shift[r], to half a column.
  int32_t column_shift[kMaxBeams] = {};  // 0 .. max_column_shift
  int32_t max_column_shift = 0;          // up to kMaxColumnShift
  uint8_t by_altitude[kMaxBeams] = {};   // rows, lowest beam first
  // Of the encoder angle theta_e = 2 pi (1 - m / W), [columns_per_revolution].
  float sin_encoder[kMaxColumnsPerRevolution] = {};
  float cos_encoder[kMaxColumnsPerRevolution] = {};
  Transform3 sensor_from_lidar;  // lidar frame -> sensor frame [m]
};

}  // namespace hardpack
