// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "core/odometry/covariance.h"

// The pose body -> odom by an extended Kalman filter of gyroscope, wheel speeds and the INS's speed
// over ground. odom is where the vehicle has been since its start: smooth, never corrected towards
// a position on earth (REP-105, REFERENCES.md; core/odometry/map_from_odom.h has that). Roll and
// pitch are those of the INS, the height stays 0.
//
//   x' = x + v cos(pitch) dt cos(yaw + w dt / 2), y' alike with the sine, yaw' = yaw + w dt
//     and besides sideways by -w t v / sqrt(v^2 + v_t^2) dt: a vehicle that drives turns about a
//     point ahead of its middle, by up to t
//   v, w, gyro bias b, wheel scale k, baseline B: random walks
//   gyro:   z = w + b                    about the vertical, by roll and pitch
//   wheels: r (w_r + w_l) / 2 = v / k    and  r (w_r - w_l) = w B
//   INS:    ground speed along the heading = v cos(pitch)
//
// What tells what: the wheels' difference is used only where the vehicle turns, which learns B, or
// where no gyro is fresh: wheels of unequal size would be taken for a bias of the gyro otherwise.
// The bias is learned at rest, when the wheels stand and the gyro is quiet; then the pose is held.
// Measurements correct the speeds and what is learned, and the pose only goes by the speeds: it
// never jumps, however much is learned of the way behind it (a Schmidt filter: the gain that the
// pose is not given is in the covariance). The accelerometer is not used: on rough ground its tilt
// is larger than what it would tell.

namespace hardpack {

// Each counts since Configure.
struct OdometryCounters {
  uint32_t gyro_rejected = 0;  // by the gate: as unlikely as its parameter says
  uint32_t wheel_speed_rejected = 0;
  uint32_t wheel_turn_rejected = 0;
  uint32_t ground_speed_rejected = 0;
  uint32_t reopened = 0;       // gates that were opened as what they kept out persisted
  uint32_t late = 0;           // measurements that came after later ones, and were used
  uint32_t too_late = 0;       // and that were not
  uint32_t repeated = 0;       // messages of the INS with the stamp of the one before
  uint32_t refused = 0;        // not finite, or beyond what a sensor can say
  uint32_t gyro_frozen = 0;    // times that the gyro said the same while the wheels turned
  uint32_t wheels_frozen = 0;  // and the wheels while the vehicle turned or changed its speed
  uint32_t restarts = 0;       // the filter began anew as its numbers had become none: never seen
};

class Odometry {
 public:
  // A pause of the ticks or of the wheel speeds that is longer than this is not bridged: the pose
  // stays where it was then, and it counts as a gap.
  static constexpr int64_t kMaxStep_ns = 200'000'000;

  // At the origin, at rest. kParameterOutOfRange: odometry or ins; `vehicle` was checked before.
  Status Configure(const VehicleParams& vehicle, const OdometryParams& odometry,
                   const InsParams& ins);

  // A message of the INS, measured at time_ns of our clock. Uses its angular rate, attitude and
  // speed over ground where it has them. kNotFinite, and kInvalidArgument for an angular rate that
  // no gyro tells: nothing changes but a counter; kDuplicate: the stamp is that of the one before
  // (of messages without a time since the device's start: the GPS time), the same; kLate: before
  // what was used already by more than max_lateness_s, the same. Constant
  // cost: at most one Predict and three Update of Covariance.
  Status TakeIns(const InsSample& sample, uint64_t time_ns);

  // To now_ns, with the newest wheel speeds; those of a time that was used before are not used
  // again. kOk; kStale: they are not valid, or frozen: the speed is taken to go on for kMaxStep_ns,
  // and moved_ns() stays; kNotFinite: a wheel speed, or one that no wheel has, the same;
  // kInvalidArgument: time does not grow. Constant cost: at most two Predict and five Update of
  // Covariance.
  Status Advance(uint64_t now_ns, const WheelFeedback& wheels);

  const StampedPose& pose() const { return pose_; }
  float speed_mps() const { return state_[kStateSpeed]; }
  float yaw_rate_radps() const { return state_[kStateYawRate]; }
  float gyro_bias_radps() const { return state_[kStateGyroBias]; }
  float wheel_scale() const { return state_[kStateWheelScale]; }
  // Effective distance of the left from the right wheels: w = k r (w_r - w_l) / skid_baseline.
  float skid_baseline_m() const { return state_[kStateBaseline] * state_[kStateWheelScale]; }
  // One standard deviation of a state; of the pose since the start.
  float Sigma(OdometryState state) const;
  const Covariance& covariance() const { return covariance_; }

  // When wheel speeds last moved it; 0: never.
  uint64_t moved_ns() const { return moved_ns_; }
  // The way, forward or backward, since Configure.
  float driven_m() const { return driven_m_; }
  // Whether the gyro is fresh: otherwise the wheels tell the turn.
  bool uses_ins_rate() const { return uses_gyro_; }
  bool at_rest() const { return at_rest_; }
  uint32_t gaps() const { return gaps_; }
  const OdometryCounters& counters() const { return counters_; }

 private:
  struct Pair {
    float a = 0.0f;
    float b = 0.0f;
  };
  // What another sensor measures while one says the same: how far it ranges, and by how much it
  // gets away from what that one says, from where it was nearest.
  struct Wandering {
    float low = 0.0f;
    float high = 0.0f;
    float nearest = 0.0f;
    float away = 0.0f;

    void Begin(float measured, float said);
    void Add(float measured, float said);
  };
  // What says the same again and again, and what others have measured meanwhile.
  struct Sameness {
    bool started = false;
    bool frozen = false;
    uint64_t since_ns = 0;
    Pair value;
    Wandering radps;
    Wandering mps;
  };
  // How the vehicle moves.
  struct Moves {
    float yaw_rate_radps = 0.0f;
    float speed_mps = 0.0f;
  };
  // One number that was measured: h x, less what was expected.
  struct Innovation {
    OdometryVector h = {};
    float value = 0.0f;
    float variance = 0.0f;
    OdometryState learns = kOdometryStates;  // beside the speeds; kOdometryStates: nothing
  };
  // One number's gate.
  struct Gate {
    uint64_t closed_ns = 0;  // since when it rejects; 0: it does not
  };

  // The filter (odometry.cpp).
  void Start();
  bool IsTooLate(uint64_t time_ns);
  bool IsRepeated(const InsSample& sample) const;
  float Lateness(uint64_t time_ns) const;
  bool IsGyroFresh(uint64_t now_ns) const;
  void PredictTo(uint64_t time_ns);
  float TurningPoint_m() const;
  void Propagate(float dt_s);
  void Correct(const Innovation& innovation);
  // Whether it was let in. `opened`: the state that is doubted where it persists; kOdometryStates:
  // none is.
  bool CorrectGated(const Innovation& innovation, uint64_t time_ns, OdometryState opened,
                    Gate& gate, uint32_t& rejected);
  void Reopen(OdometryState state);
  void ForgetBaseline();
  void KeepInRange();
  void HoldStill();

  // What is said to it (measurements.cpp).
  void TakeAttitude(const InsSample& sample);
  void TakeRate(const AngularRate& rate, uint64_t time_ns);
  void TakeGroundSpeed(const InsSample& sample, uint64_t time_ns);
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
  uint64_t filter_ns_ = 0;  // the time of state_; 0: nothing has come yet
  StampedPose pose_;
  float driven_m_ = 0.0f;

  uint64_t ins_ns_ = 0;  // of the INS's newest message, our clock
  struct Stamp {
    bool known = false;
    uint64_t time_ns = 0;
  };
  Stamp stamp_;                   // of the newest message that had one, its clock
  Stamp gps_stamp_;               // of the newest that had only GPS time
  uint64_t rate_ns_ = 0;          // of the newest rate that was used, our clock; 0: none was
  float rate_radps_ = 0.0f;       // that one, about the vertical, with its bias
  uint64_t ground_speed_ns_ = 0;  // of the newest that was used
  float ground_speed_mps_ = 0.0f;
  uint64_t wheels_ns_ = 0;
  uint64_t rims_ns_ = 0;       // of the four below; 0: none have come
  float rim_mps_ = 0.0f;       // r (w_r + w_l) / 2
  float rim_turn_mps_ = 0.0f;  // r (w_r - w_l)
  float past_rim_mps_ = 0.0f;  // the same, a while ago
  float past_turn_mps_ = 0.0f;
  uint64_t moved_ns_ = 0;
  uint64_t still_ns_ = 0;  // since when the wheels stand; 0: they do not
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
