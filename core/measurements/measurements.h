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

// What a return is, as far as driving goes ([OS] Cost Map Creation; person and ignored are ours).
enum class ReturnClass : uint8_t {
  kIgnored = 0,  // no return, void, sky, the vehicle itself
  kGround = 1,
  kSoft = 2,    // to be avoided, but may be driven through: bushes, tall grass
  kHard = 3,    // never to be driven through: trees, rocks, fences
  kPerson = 4,  // hard, and counted as a person
};

// One measurement column: all beams fired at one encoder position.
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
};

// Semantic classes of one column's returns, in raw measurement order.
struct ColumnLabels {
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  int32_t beams = 0;
  ReturnClass label[kMaxBeams] = {};
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
  Transform3 sensor_from_lidar;  // lidar frame -> sensor frame [m]
};

}  // namespace hardpack
