// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/pose.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "core/tracking/drive_model.h"
#include "core/tracking/prediction_error.h"

// From path targets to wheel speeds, once a tick, forwards and in reverse, and turns on the spot.
// It does not choose the path, the place on it or whether to move (core/safety/supervisor.h);
// core/committed_plan/path_target.h collects the targets from the path. The paper hands its path to
// a tracker of its own ([OS] System Overview); this is docs/algorithm.md section 7 (ours).
//
// Everything is computed at the state after the dead time (drive_model.h), where a command acts
// through lags only: that of the wheels and, after it, that of the body. The equations are in
// docs/tracking.md ("The law"); the comments below use its names.
//
// The turn keeps the vehicle on its path: if a wheel would be too fast, the common part is reduced.

namespace hardpack {

// The path at one place. Curvature and its rate are those of the heading over the distance in the
// direction of the heading, so they do not change when a path is driven in reverse.
struct TrackingPoint {
  Pose2 pose;  // odom; the heading is the vehicle's, in reverse too
  float speed_mps = 0.0f;
};

struct TrackingInput {
  Pose2 pose;                    // odom, predicted for when this command takes effect
  bool turn = false;             // on the spot, to aim.pose.theta_rad; the vehicle stands
  bool reverse = false;          // the path is driven backwards
  float speed_limit_mps = 0.0f;  // of the path at the predicted place: a magnitude
  TrackingPoint aim;             // pure pursuit: the target point; turn: its heading
  // The rest is for the lag-aware method.
  Pose2 path;  // odom, the path's place nearest to `pose`; its heading is the vehicle's
  float acceleration_mps2 = 0.0f;      // of that speed, in the direction of driving
  float turn_curvature_per_m = 0.0f;   // kappa_t
  float wheel_curvature_per_m = 0.0f;  // kappa_z ...
  float curvature_rate_per_m2 = 0.0f;  // ... and its change there
  float left_m = 0.0f;                 // distance to the next stop; never negative
  // What the ground leaves of max_deceleration_mps2 for it (core/speed/ground_ahead.h); 0: all.
  float deceleration_mps2 = 0.0f;
};

struct TrackingOutput {
  float speed_mps = 0.0f;  // commanded by now; in reverse: negative
  float yaw_rate_radps = 0.0f;
  float curvature_per_m = 0.0f;  // 0 when standing or turning on the spot
  WheelCommand wheels;
};

class Tracker {
 public:
  static constexpr float kRampGain_per_s = 4.0f;
  static constexpr float kMaxReturn_rad = 0.35f;
  static constexpr float kMaxIntegral_radps = 0.4f;
  static constexpr float kMaxLead_mps = 0.5f;               // of the reference before the vehicle
  static constexpr float kMaxCommandChange_radps2 = 60.0f;  // so a command ramps over several ticks
  static constexpr float kEndLags = 2.2f;            // time constant of the last stretch, in lags
  static constexpr float kEndBrakeShare = 0.85f;     // of the deceleration; the rest corrects
  static constexpr float kEndSpeed_mps = 0.03f;      // slower is standing
  static constexpr float kStillTurns_radps = 0.35f;  // at rest: no path is set out on before

  // At rest. kParameterOutOfRange: odometry, dynamics or tracking; the others were checked before.
  Status Configure(const VehicleParams& vehicle, const SpeedParams& speed,
                   const OdometryParams& odometry, const DynamicsParams& dynamics,
                   const TrackingParams& tracking);

  // Once every tick, before the command: the present pose and motion, and the newest wheel speeds.
  // Statuses and cost: DriveModel::Advance and Predict.
  Status Predict(uint64_t now_ns, const Pose2& pose, const WheelFeedback& wheels,
                 const BodyMotion& body);

  // The predicted position and speed of the vehicle when this tick's command takes effect.
  const DriveState& predicted() const { return predicted_; }

  // The commands of one tick of dt_s. The reference speed approaches the path's by at most the
  // plan's acceleration and deceleration limits. kOffPath: farther from the path than
  // max_cross_track_m: it steers back while it comes to rest. kNeedsManoeuvre: a turn on the spot,
  // for a vehicle that cannot make one; zero is commanded. kNotFinite: a number; zero is commanded.
  // kNotStarted. A standing vehicle that still turns faster than kStillTurns_radps, from a turn on
  // the spot that was given up, gets zero first. An input of the other direction than that of the
  // reference is driven only once the reference is 0: until then it falls as for a stop. Constant
  // cost.
  Status Follow(const TrackingInput& input, float dt_s, TrackingOutput& output);

  // The same, with the speed going to 0 by the deceleration limit along the path. A turn on the
  // spot ends at once.
  Status StopAlong(const TrackingInput& input, float dt_s, TrackingOutput& output);

  // Zero at once.
  void Zero(TrackingOutput& output);

  // The reference: the speed commanded by now, a magnitude, and whether it is one in reverse.
  float speed_mps() const { return speed_mps_; }
  bool reverse() const { return reverse_; }
  float curvature_per_m() const { return curvature_per_m_; }
  const DriveModel& model() const { return model_; }
  const MotionError& prediction_error() const { return error_.lately(); }

  // The speed from which the vehicle comes to rest within left_m by braking with
  // max_deceleration_mps2, and then, in the last stretch, by coasting: no faster than its lag
  // allows without being told to drive backwards. Zero for a left_m that is not positive.
  //   v = left / T below a T^2, else sqrt(2 a (left - a T^2 / 2)),
  //   a = kEndBrakeShare max_deceleration, T = kEndLags (common_lag + speed_lag)
  float EndSpeed(float left_m, float max_deceleration_mps2) const;

  // Where PathTarget takes the curvatures of the input, as distances ahead of the predicted place
  // in the direction of driving.
  float TurnAhead_m() const;   // kappa_t
  float WheelAhead_m() const;  // kappa_z

 private:
  struct Errors {
    float cross_track_m = 0.0f;
    float heading_rad = 0.0f;
  };
  struct Turn {
    float pole_radps = 0.0f;          // p
    float wanted_radps = 0.0f;        // w_d
    float path_radps = 0.0f;          // w_r
    float path_wheels_radps = 0.0f;   // z_r
    float path_change_radps2 = 0.0f;  // z_r'
  };
  struct Gains {
    float jerk_per_s = 0.0f;      // a_1
    float rate_per_s2 = 0.0f;     // a_2
    float heading_per_s3 = 0.0f;  // a_3
    float place_per_s4 = 0.0f;    // a_4
  };

  Gains GainsAt(float pole_radps) const;
  float WheelsChange(const Turn& turn) const;
  float MostTurn_radps() const;
  bool IsAtLimit(float command_radps) const;
  Status Drive(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output);
  bool StillTurns() const;
  Status DriveAlong(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output);
  void PursueAim(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output);
  void FollowPath(const TrackingInput& input, bool stops, float dt_s, TrackingOutput& output);
  void TurnOnTheSpot(const TrackingInput& input, float dt_s, TrackingOutput& output);
  float CurvatureTo(const TrackingInput& input) const;
  float Reference(const TrackingInput& input, float off_m, bool stops, float dt_s);
  Turn TurnFor(const TrackingInput& input, const Errors& errors, float change_mps2, float dt_s);
  float EndTime_s() const;
  float CommonCommand(float change_mps2, float reference_change_mps2) const;
  float DifferentialCommandFor(const Turn& turn) const;
  void Command(WheelParts command, float dt_s, TrackingOutput& output);
  float Drivable(const WheelParts& command) const;
  void Mix(WheelParts command, TrackingOutput& output);

  VehicleParams vehicle_;
  SpeedParams limits_;
  TrackingParams params_;
  DriveModel model_;
  DriveState predicted_;
  PredictionError error_;
  bool configured_ = false;
  bool saturated_ = false;  // the previous command was clipped
  float speed_mps_ = 0.0f;  // reference
  bool reverse_ = false;    // of the reference
  float curvature_per_m_ = 0.0f;
  float integral_radps_ = 0.0f;
  float give_way_ = 1.0f;  // share of the path's speed, where turns need more than the drives have
  WheelParts command_;
};
static_assert(std::is_trivially_copyable_v<Tracker>);

}  // namespace hardpack
