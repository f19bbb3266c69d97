// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "core/odometry/covariance.h"

// The pose body -> odom by an extended Kalman filter of gyroscope, wheel speeds and the INS's
// ground speed. odom is the local frame since the start: smooth, never corrected towards a position
// on earth (REP-105, REFERENCES.md; core/odometry/map_from_odom.h does that). Roll and pitch come
// from the INS; the height is the integral of the climb since the start.
//
//   x' = x + v cos(pitch) dt cos(yaw + w dt / 2), y' alike with the sine, yaw' = yaw + w dt
//     plus sideways motion of -w t v / sqrt(v^2 + v_t^2) dt: a moving vehicle turns about a
//     point ahead of its centre, by up to t
//     and across a bank b, downhill, of what the INS says of it up to kSlideShare sin(b)
//     (|v| + kTurnArm_m |w|): tyres creep under a load, and no wheel tells
//     and along a grade of pitch p, up to kSlideShare (sin|p| - kLevelPitch) |v| of what the INS
//     says of it beyond the wheels: the scale k is learned only by and by
//   z' = z + c dt, c: the INS's vertical speed while it stands by it, otherwise, and never further
//     than kClimbShare |v| from it, -v sin(pitch): the nose dips when the vehicle brakes, and an
//     INS's vertical speed is wrong by a while's bias. Heights beyond kMaxHeight_m begin at 0
//     again, in one step, which the map takes over (core/autonomy/mapper.h)
//   v, w, gyro bias b, wheel scale k, baseline B: random walks
//   gyro:   z = w + b                    about the vertical, by roll and pitch
//   wheels: r (w_r + w_l) / 2 = v / k    and  r (w_r - w_l) = w B
//   INS:    ground speed along the heading = v cos(pitch)
//
// Use of the measurements: the wheels' difference is used only while the vehicle turns, which
// learns B, or if no gyro is fresh; otherwise wheels of unequal size would be taken for a gyro
// bias. The bias is learned at rest, when the wheels stand and the gyro is quiet; the pose is held
// then. Measurements correct the speeds and the learned states, and the pose is integrated from the
// speeds only: it never jumps, however much is learned about the distance already driven (a Schmidt
// filter: the gain withheld from the pose is accounted for in the covariance). The accelerometer is
// not used: on rough ground its tilt error exceeds its information.

namespace hardpack {

// Each counts since Configure.
struct OdometryCounters {
  uint32_t gyro_rejected = 0;  // by the gate: too unlikely, as its parameter says
  uint32_t wheel_speed_rejected = 0;
  uint32_t wheel_turn_rejected = 0;
  uint32_t ground_speed_rejected = 0;
  uint32_t reopened = 0;       // gates opened because the rejected values persisted
  uint32_t late = 0;           // measurements that arrived after later ones, and were used
  uint32_t too_late = 0;       // and were not used
  uint32_t repeated = 0;       // INS messages with the stamp of the previous one
  uint32_t refused = 0;        // not finite, or beyond a sensor's range
  uint32_t gyro_frozen = 0;    // times the gyro repeated its value while the wheels turned
  uint32_t wheels_frozen = 0;  // the wheels, while the vehicle turned or changed speed
  uint32_t restarts = 0;       // filter restarts after non-finite numbers: never seen
};

class Odometry {
 public:
  // A gap in the ticks or in the wheel speeds longer than this is not bridged: the pose stays where
  // it was, and it counts as a gap.
  static constexpr int64_t kMaxStep_ns = 200'000'000;

  static constexpr float kMaxHeight_m = 90.0f;
  // Tyres that roll on a bank creep by less (docs/simulation.md has a tenth of their load).
  static constexpr float kSlideShare = 0.5f;
  static constexpr float kTurnArm_m = 0.5f;
  static constexpr float kLevelPitch = 0.03f;  // nobody creeps on it, and an INS errs by less
  // The nose dips by up to 6 degrees.
  static constexpr float kClimbShare = 0.1f;

  // At the origin, at rest. kParameterOutOfRange: odometry or ins; `vehicle` was checked before.
  Status Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                   const InsParams& ins);

  // An INS message, measured at time_ns of our clock. Uses its angular rate, attitude and ground
  // speed where present. kNotFinite, and kInvalidArgument for an angular rate that no gyro reports:
  // only a counter changes; kDuplicate: the stamp equals the previous one (the GPS time for
  // messages without a time since the device's start), likewise; kLate: older than what was already
  // used by more than max_lateness_s, likewise. Constant cost: at most one Predict and three Update
  // of Covariance.
  Status TakeIns(const InsSample& sample, uint64_t time_ns);

  // Advances to now_ns with the newest wheel speeds; speeds whose time was already used are not
  // used again. kOk; kStale: they are invalid or frozen: the speed is extrapolated for kMaxStep_ns,
  // and moved_ns() stays; kNotFinite: a wheel speed, or an impossible one, likewise;
  // kInvalidArgument: time does not increase. Constant cost: at most two Predict and five Update of
  // Covariance.
  Status Advance(uint64_t now_ns, const WheelFeedback& wheels);

  const StampedPose& pose() const { return pose_; }
  float speed_mps() const { return state_[kStateSpeed]; }
  float yaw_rate_radps() const { return state_[kStateYawRate]; }
  float gyro_bias_radps() const { return state_[kStateGyroBias]; }
  float wheel_scale() const { return state_[kStateWheelScale]; }
  // Effective distance between the left and right wheels: w = k r (w_r - w_l) / skid_baseline.
  float skid_baseline_m() const { return state_[kStateBaseline] * state_[kStateWheelScale]; }
  // One standard deviation of a state; of the pose since the start.
  float Sigma(OdometryState state) const;
  const Covariance& covariance() const { return covariance_; }

  // When wheel speeds last moved it; 0: never.
  uint64_t moved_ns() const { return moved_ns_; }
  // The distance driven, forward or backward, since Configure.
  float driven_m() const { return driven_m_; }
  // Whether the gyro is fresh; otherwise the wheels give the yaw rate.
  bool uses_ins_rate() const { return uses_gyro_; }
  bool at_rest() const { return at_rest_; }
  uint32_t gaps() const { return gaps_; }
  const OdometryCounters& counters() const { return counters_; }

 private:
  struct Pair {
    float a = 0.0f;
    float b = 0.0f;
  };
  // What another sensor measures while one repeats its value: its range, and how far it moves away
  // from that value, starting where it was closest.
  struct Wandering {
    float low = 0.0f;
    float high = 0.0f;
    float nearest = 0.0f;
    float away = 0.0f;

    void Begin(float measured, float said);
    void Add(float measured, float said);
  };
  // A sensor that repeats its value, and what others have measured meanwhile.
  struct Sameness {
    bool started = false;
    bool frozen = false;
    uint64_t since_ns = 0;
    Pair value;
    Wandering radps;
    Wandering mps;
  };
  // The vehicle's motion.
  struct Moves {
    float yaw_rate_radps = 0.0f;
    float speed_mps = 0.0f;
  };
  // One measured number: h x minus the expected value.
  struct Innovation {
    OdometryVector h = {};
    float value = 0.0f;
    float variance = 0.0f;
    OdometryState learns = kOdometryStates;  // in addition to the speeds; kOdometryStates: nothing
  };
  // One number's gate.
  struct Gate {
    uint64_t closed_ns = 0;  // rejecting since; 0: not rejecting
  };

  // The filter (odometry.cpp).
  void Start();
  bool IsTooLate(uint64_t time_ns);
  bool IsRepeated(const InsSample& sample) const;
  float Lateness(uint64_t time_ns) const;
  bool IsGyroFresh(uint64_t now_ns) const;
  void PredictTo(uint64_t time_ns);
  float TurningPoint_m() const;
  // By the INS, lately: what the wheels do not tell.
  bool IsDriftTold() const;
  float Climb_mps() const;
  float Slide_mps() const;
  float Creep_mps() const;
  void Propagate(float dt_s);
  void Correct(const Innovation& innovation);
  // Whether it was accepted. `opened`: the state that is doubted if it persists; kOdometryStates:
  // none.
  bool CorrectGated(const Innovation& innovation, uint64_t time_ns, OdometryState opened,
                    Gate& gate, uint32_t& rejected);
  void Reopen(OdometryState state);
  void ForgetBaseline();
  void KeepInRange();
  void HoldStill();

  // Its inputs (measurements.cpp).
  void TakeAttitude(const InsSample& sample);
  void TakeRate(const AngularRate& rate, uint64_t time_ns);
  void TakeVelocity(const InsSample& sample, uint64_t time_ns);
  void NoteDrift(Vec2 level_mps, float climb_mps, uint64_t time_ns);
  void TakeGroundSpeed(float measured_mps, uint64_t time_ns);
  static bool AreWheelSpeeds(const WheelFeedback& wheels);
  bool AreFrozen(const WheelFeedback& wheels);
  void FollowRims(const WheelFeedback& wheels);
  float Gathering(float change_mps) const;
  void TakeWheels(const WheelFeedback& wheels);
  void TakeTurn(float rim_mps, uint64_t time_ns);
  void JudgeRest(const WheelFeedback& wheels, uint64_t now_ns);
  void Follow(Sameness& same, const Pair& value, uint64_t time_ns, const Moves& said,
              const Moves& measured) const;

  VehicleParams vehicle_;
  OdometryParams params_;
  float body_from_ins_[9] = {};  // [3 x 3], row-major
  bool configured_ = false;
  OdometryVector state_ = {};
  Covariance covariance_;
  uint64_t filter_ns_ = 0;  // the time of state_; 0: no input yet
  StampedPose pose_;
  float driven_m_ = 0.0f;

  uint64_t ins_ns_ = 0;  // of the INS's newest message, our clock
  struct Stamp {
    bool known = false;
    uint64_t time_ns = 0;
  };
  Stamp stamp_;                   // of the newest message that had one, device clock
  Stamp gps_stamp_;               // of the newest with GPS time only
  uint64_t rate_ns_ = 0;          // of the newest rate used, our clock; 0: none
  float rate_radps_ = 0.0f;       // that rate, about the vertical, including its bias
  uint64_t ground_speed_ns_ = 0;  // of the newest that was used
  float ground_speed_mps_ = 0.0f;
  uint64_t climb_ns_ = 0;  // of the INS's newest vertical speed; 0: none
  float climb_mps_ = 0.0f;
  float aside_mps_ = 0.0f;  // to the left, beyond what a turn does: over the last kAsideLag_s
  float ahead_mps_ = 0.0f;  // beyond the wheels' speed, likewise
  uint64_t wheels_ns_ = 0;
  uint64_t rims_ns_ = 0;       // of the four below; 0: none yet
  float rim_mps_ = 0.0f;       // r (w_r + w_l) / 2
  float rim_turn_mps_ = 0.0f;  // r (w_r - w_l)
  float past_rim_mps_ = 0.0f;  // the same, a while ago
  float past_turn_mps_ = 0.0f;
  uint64_t moved_ns_ = 0;
  uint64_t still_ns_ = 0;  // wheels standing since; 0: they turn
  bool at_rest_ = false;
  bool uses_gyro_ = false;
  Gate gyro_gate_;
  Gate wheel_speed_gate_;
  Gate wheel_turn_gate_;
  Gate ground_speed_gate_;
  Sameness gyro_sameness_;
  Sameness wheel_sameness_;
  uint32_t gaps_ = 0;
  OdometryCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Odometry>);

}  // namespace hardpack
