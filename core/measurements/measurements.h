// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/base/math.h"
#include "core/base/pose.h"

// Typed measurements: the output of the codecs in hal and the input of the stages in core. Types
// only.

namespace hardpack {

// The largest lidar: 128 beams; 2048 columns per revolution at 64 beams, 1024 at 128.
inline constexpr int kMaxBeams = 128;
inline constexpr int kMaxColumnsPerRevolution = 2048;
// The azimuth offsets of the beams span at most this many columns: the wait until a direction is
// complete.
inline constexpr int kMaxColumnShift = 128;

// What a return means for driving ([OS] Cost Map Creation; person and ignored are ours).
enum class ReturnClass : uint8_t {
  kIgnored = 0,  // no return, void, sky, the vehicle itself
  kGround = 1,
  kSoft = 2,    // to be avoided, but can be driven through: bushes, tall grass
  kHard = 3,    // never to be driven through: trees, rocks, fences
  kPerson = 4,  // hard, and counted as a person
};

// One measurement column: all beams fired at one encoder position. [beams] arrays, row 0 first as
// the sensor sends them. If a sensor fires at arbitrary angles and reports them, each column gets
// the nearest free place of a grid and its offset from that place.
struct LidarColumn {
  uint64_t timestamp_ns = 0;    // sensor's clock
  uint16_t measurement_id = 0;  // column of the revolution, 0 .. columns_per_frame - 1
  uint16_t frame_id = 0;        // revolution counter, wraps
  // The encoder's true angle minus that of measurement_id, anticlockwise: at most 2 columns either
  // way; 0 for a sensor that fires at the places of its grid.
  float azimuth_offset_rad = 0.0f;
  uint32_t encoder_ticks = 0;         // LEGACY: 90112 a revolution; 0 if the profile has none
  uint32_t status = 0;                // as sent
  bool valid = false;                 // the sensor vouches for this column
  int32_t beams = 0;                  // rows used in the arrays below
  uint32_t range_mm[kMaxBeams] = {};  // 0: no return
  uint16_t signal[kMaxBeams] = {};
  uint16_t reflectivity[kMaxBeams] = {};
  uint16_t near_ir[kMaxBeams] = {};
  uint8_t flags[kMaxBeams] = {};
  // The second return, for profiles with two returns per beam; with one return, not written.
  int32_t returns = 1;  // per beam
  uint32_t second_range_mm[kMaxBeams] = {};
  uint16_t second_signal[kMaxBeams] = {};
  uint16_t second_reflectivity[kMaxBeams] = {};
  uint8_t second_flags[kMaxBeams] = {};
};

// The labels that an external segmentation gives to one column's returns, in raw measurement order:
// codes of its ontology (core/segmentation maps them to classes).
struct ColumnLabels {
  uint16_t frame_id = 0;
  uint16_t measurement_id = 0;
  int32_t beams = 0;
  uint8_t label[kMaxBeams] = {};
};

struct AngularRate {
  float x_radps = 0.0f;
  float y_radps = 0.0f;
  float z_radps = 0.0f;
};
struct Acceleration {
  float x_mps2 = 0.0f;
  float y_mps2 = 0.0f;
  float z_mps2 = 0.0f;
};
struct VelocityNed {
  float north_mps = 0.0f;
  float east_mps = 0.0f;
  float down_mps = 0.0f;
};
constexpr bool IsFinite(const AngularRate& rate) {
  return IsFinite(rate.x_radps) && IsFinite(rate.y_radps) && IsFinite(rate.z_radps);
}
constexpr bool IsFinite(const Acceleration& acceleration) {
  return IsFinite(acceleration.x_mps2) && IsFinite(acceleration.y_mps2) &&
         IsFinite(acceleration.z_mps2);
}
constexpr bool IsFinite(const VelocityNed& velocity) {
  return IsFinite(velocity.north_mps) && IsFinite(velocity.east_mps) && IsFinite(velocity.down_mps);
}

// One sample of an inertial sensor, in its own frame.
struct ImuSample {
  uint64_t acceleration_time_ns = 0;  // sensor's clock, for each of the two readings
  uint64_t angular_rate_time_ns = 0;
  Acceleration acceleration;  // specific force: +9.81 upward at rest
  AngularRate angular_rate;
};

// How far an inertial navigation system (INS) vouches for its solution.
enum class InsMode : uint8_t {
  kNotTracking = 0,  // no solution yet; the yaw comes from a magnetic compass at best
  kAligning = 1,     // still determining the heading
  kTracking = 2,     // the whole solution is within specification
  kGnssLost = 3,     // long loss of satellites: position and velocity drift, attitude still good
};

struct InsStatus {
  InsMode mode = InsMode::kNotTracking;
  bool gnss_fix = false;
  bool time_error = false;  // its filter overruns its time
  bool imu_error = false;
  bool magnetometer_or_pressure_error = false;
  bool gnss_error = false;
  bool gnss_heading = false;  // the direction between its two antennas aids the heading
  bool gnss_compass = false;  // that direction is currently known
  uint16_t word = 0;          // as sent, including the bits not decoded above
};

// One message of an inertial navigation system. A message carries some of the groups; the flags of
// the others are false and their values zero. Nothing is converted to the vehicle's frames here:
// attitude and velocity are relative to the level frame north, east, down (NED), and measured
// values are in the sensor's own frame, whose axes point forward, right and down when it is level.
// Odometry converts these to body -> odom. All values are finite.
struct InsSample {
  bool has_timestamp = false;
  uint64_t timestamp_ns = 0;  // sensor's clock, since start-up
  bool has_gps_time = false;
  uint64_t gps_time_ns = 0;  // since 1980-01-06 00:00 UTC, without leap seconds

  bool has_attitude = false;  // sensor -> NED as Rz(yaw) Ry(pitch) Rx(roll)
  float roll_rad = 0.0f;      // (-pi, pi], right side down positive
  float pitch_rad = 0.0f;     // [-pi/2, pi/2], nose up positive
  float yaw_rad = 0.0f;       // (-pi, pi], from north, CLOCKWISE seen from above

  bool has_angular_rate = false;
  AngularRate angular_rate;
  bool has_acceleration = false;
  Acceleration acceleration;  // specific force: (0, 0, -9.81) level and at rest

  bool has_position = false;   // WGS 84
  int64_t latitude_ndeg = 0;   // 1e-9 degree (0.11 mm), north positive, at most 90 degrees
  int64_t longitude_ndeg = 0;  // 1e-9 degree, east positive, at most 180 degrees
  float altitude_m = 0.0f;     // above the ellipsoid
  bool has_velocity = false;
  VelocityNed velocity_ned;

  bool has_status = false;
  InsStatus status;

  // One standard deviation, as the sensor estimates it.
  bool has_attitude_uncertainty = false;
  float attitude_uncertainty_rad = 0.0f;
  bool has_position_uncertainty = false;
  float position_uncertainty_m = 0.0f;
  bool has_velocity_uncertainty = false;
  float velocity_uncertainty_mps = 0.0f;
};

// Wheel angular speeds of the two sides, as the drives report them: forward positive, the same for
// the front and rear wheels of a side.
struct WheelFeedback {
  bool valid = false;    // both sides have reported within the drives' time-out
  uint64_t time_ns = 0;  // our clock; of the older of the two reports
  float left_radps = 0.0f;
  float right_radps = 0.0f;
};

// Commanded wheel speeds: forward positive.
struct WheelCommand {
  float left_radps = 0.0f;
  float right_radps = 0.0f;
};

// What the drives are asked to do in one tick.
struct DriveDemand {
  bool enable = false;        // torque requested; false: zero, standstill, disable, in this order
  bool reset_faults = false;  // one attempt when it becomes true; only with enable false
  WheelCommand wheels;        // clamped to the drives' limits
};

// What the drives report in one tick.
struct DriveFeedback {
  WheelFeedback wheels;
  bool ready = false;           // they can be enabled (or are), and none has a fault
  bool enabled = false;         // they follow commands
  bool faulty = false;          // one has a fault, and they are not ready
  bool standstill = false;      // all report it, recently
  bool foreign_sender = false;  // another node commands them: must not be driven
};

// Where the vehicle was: body -> odom, as position and as Rz(yaw) Ry(pitch) Rx(roll).
struct StampedPose {
  uint64_t time_ns = 0;  // our clock
  Vec3 position;         // [m]
  float roll_rad = 0.0f;
  float pitch_rad = 0.0f;
  float yaw_rad = 0.0f;
};

// Geometry of the beams: everything needed to turn (column, row, range) into a point in the lidar's
// sensor frame. Angles are stored as sines and cosines, computed once by MakeBeamModel (core/scan).
struct BeamModel {
  int32_t beams = 0;
  int32_t columns_per_revolution = 0;
  // How many of them fire: fewer if the sensor measures its azimuth and leaves places empty.
  int32_t fired_per_revolution = 0;
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

// The part of a revolution that a lidar sends.
struct LidarWindow {
  int32_t columns_per_datagram = 0;
  int32_t first = 0;  // measurement ids; first > last wraps past zero
  int32_t last = 0;
};

// The geometry of a lidar and what it sends. The angles are [beams], in degrees, stored with the
// lidar's description; core/scan makes a BeamModel from it.
struct LidarLayout {
  std::span<const float> altitude_deg;
  std::span<const float> azimuth_deg;
  int32_t columns_per_revolution = 0;
  int32_t fired_per_revolution = 0;  // as in BeamModel; 0: all columns
  float origin_to_beam_m = 0.0f;
  Transform3 sensor_from_lidar;
  LidarWindow window;
};

}  // namespace hardpack
