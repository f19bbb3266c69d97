// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/decision_hash.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "hal/can_batch.h"
#include "hal/can_frame.h"
#include "hal/twist_drive/twist_frames.h"

// A vehicle's own motion controller, which takes a speed and a turn and measures both
// (docs/twist_drive.md). This class monitors the controller and brings it to rest: zero, then
// standstill, and only then disabled. It does not decide whether the vehicle may move
// (core/safety).
//
// The chain's wheel speeds of two sides represent the motion of the body here:
//   v = r (left + right) / 2      w = r (right - left) / b      delta = atan(L w / v_measured)
// with r, b and L of VehicleParams (wheel_radius_m, skid_baseline_m, wheelbase_m).

namespace hardpack::twist_drive {

// Why it is not driven. The first fault since the last reset is kept.
enum class Fault : uint8_t {
  kNone = 0,
  kController,     // the controller reports a fault
  kSilent,         // nothing received from it for feedback_timeout_ms
  kNotHeard,       // it has accepted no command for echo_timeout_ms
  kWrongTurn,      // it measures the other kind of turn
  kWrongVersion,   // it uses another protocol version
  kEnableTimeout,  // it was asked to follow, but did not
  kDropped,        // it stopped following on its own
};

struct Report {
  ControllerState state = ControllerState::kStarting;
  Fault fault = Fault::kNone;
  float speed_mps = 0.0f;  // measured
  float yaw_rate_radps = 0.0f;
  uint64_t feedback_ns = 0;  // when the feedback arrived; 0: never
  uint16_t controller_faults = 0;
  float battery_V = 0.0f;  // 0: not measured
  int32_t temperature_degC = 0;
};

struct Counters {
  uint32_t frames_taken = 0;
  uint32_t frames_ignored = 0;    // with identifiers that are not ours
  uint32_t frames_malformed = 0;  // refused by Decode
  uint32_t frames_repeated = 0;   // with the counter of the previous frame
  uint32_t frames_missed = 0;     // by the counters of the frames received
  uint32_t foreign_frames = 0;    // with the identifier that only we send
};

class TwistDrive {
 public:
  // Resets everything. kParameterOutOfRange; kInvalidArgument: two identifiers are the same, or a
  // steering angle is configured for a vehicle without steering.
  Status Configure(const VehicleParams& vehicle, const TwistDriveParams& params);
  static const TwistDriveParams& ParamsOf(const OnboardParams& onboard) {
    return onboard.twist_drive;
  }

  // Takes a frame received since the last tick, in order; it counts from when it arrived. Constant
  // cost.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);

  // One tick: adds the command. Its speed is zero unless the controller follows, has no fault, and
  // the demand asks for motion; values that are not finite count as zero. now_ns does not run
  // backwards. Constant cost.
  void Tick(uint64_t now_ns, const DriveDemand& demand, CanBatch& out);

  DriveFeedback State(uint64_t now_ns) const;
  // The controller reports that it applies no torque, or has been silent for longer than a stop
  // takes.
  bool AreOff(uint64_t now_ns) const;
  const Report& report() const { return report_; }
  const Counters& counters() const { return counters_; }
  const Command& commanded() const { return command_; }  // of the last tick

  static constexpr uint64_t kForeignHold_ns = 2'000'000'000;
  static constexpr uint64_t kForgotten_ns = 5'000'000'000;  // longer than a stop takes
  // How long a controller may take to clear its faults.
  static constexpr uint64_t kResetHold_ns = 1'000'000'000;
  // Below this speed a steering angle cannot be derived from a yaw rate: it is kept.
  static constexpr float kLeastSteeredSpeed_mps = 0.05f;
  // From this speed on, the angle is computed for the measured speed.
  static constexpr float kDrivingSpeed_mps = 0.3f;
  static constexpr float kStandstill_radps = 0.05f;

 private:
  enum class Power : uint8_t { kOff, kEnabling, kOn, kStopping };

  void TakeFeedback(const CanFrame& frame, uint64_t came_ns);
  void TakeStatus(const CanFrame& frame);
  bool IsFresh(uint64_t now_ns) const;
  bool IsAtRest(uint64_t now_ns) const;
  bool IsReady(uint64_t now_ns) const;
  void SetFault(Fault fault);
  void Watch(uint64_t now_ns);
  void WatchPower(uint64_t now_ns);
  void Sequence(uint64_t now_ns, bool wish);
  void SetPower(Power power, uint64_t now_ns);
  void SetMotion(const WheelCommand& wheels);

  VehicleParams vehicle_;
  TwistDriveParams params_;
  bool configured_ = false;
  Report report_;
  Counters counters_;
  Power power_ = Power::kOff;
  uint64_t power_since_ns_ = 0;
  uint64_t moved_ns_ = 0;    // when it was last seen to move
  uint64_t foreign_ns_ = 0;  // 0: never
  uint64_t reset_ns_ = 0;    // when requested; 0: never
  bool was_reset_asked_ = false;
  TurnKind turn_kind_ = TurnKind::kYawRate;  // the kind that it measures
  uint8_t counter_ = 0;                      // of its feedback
  uint8_t echo_ = 0;
  uint64_t echo_ns_ = 0;  // when the echo last changed, or since when we wait for it
  bool has_version_ = false;
  uint8_t version_ = 0;
  Command command_;
};
static_assert(std::is_trivially_copyable_v<TwistDrive>);

// Adds the decisions: states, faults, commands.
void AddToHash(const TwistDrive& drive, DecisionHash& hash);

}  // namespace hardpack::twist_drive
