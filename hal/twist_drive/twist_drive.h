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

// A motion controller of the vehicle's own, told a speed and a turn, which measures both
// (docs/twist_drive.md). It watches the controller and brings it to rest: zero, standstill, and
// only then no longer enabled; it does not decide whether the vehicle may move (core/safety).
//
// What the chain knows as the speeds of two sides' wheels is here the motion of the body:
//   v = r (left + right) / 2      w = r (right - left) / b      delta = atan(L w / v_measured)
// with r, b and L of VehicleParams (wheel_radius_m, skid_baseline_m, wheelbase_m).

namespace hardpack::twist_drive {

// Why it is not driven. The first since the last reset stays.
enum class Fault : uint8_t {
  kNone = 0,
  kController,     // it says so itself
  kSilent,         // nothing came from it for feedback_timeout_ms
  kNotHeard,       // it has taken no command for echo_timeout_ms
  kWrongTurn,      // it measures the other kind of turn
  kWrongVersion,   // its protocol is another one
  kEnableTimeout,  // it was asked to follow, and did not
  kDropped,        // it stopped following by itself
};

struct Report {
  ControllerState state = ControllerState::kStarting;
  Fault fault = Fault::kNone;
  float speed_mps = 0.0f;  // measured
  float yaw_rate_radps = 0.0f;
  uint64_t feedback_ns = 0;  // when that came; 0: never
  uint16_t controller_faults = 0;
  float battery_V = 0.0f;  // 0: not measured
  int8_t temperature_degC = 0;
};

struct Counters {
  uint32_t frames_taken = 0;
  uint32_t frames_ignored = 0;    // of identifiers that are none of ours
  uint32_t frames_malformed = 0;  // Decode refused them
  uint32_t frames_repeated = 0;   // with the counter of the one before
  uint32_t frames_missed = 0;     // by the counters of those that came
  uint32_t foreign_frames = 0;    // with the identifier that only we send
};

class TwistDrive {
 public:
  // Forgets everything. kParameterOutOfRange; kInvalidArgument: two identifiers are the same, or a
  // steering angle is to be told to a vehicle without one.
  Status Configure(const VehicleParams& vehicle, const TwistDriveParams& params);
  static const TwistDriveParams& ParamsOf(const OnboardParams& onboard) {
    return onboard.twist_drive;
  }

  // A frame that was taken since the last tick, in order; it counts as of when it came. Constant
  // cost.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);

  // One tick: adds the command. Only zero speed goes out unless the controller follows, has no
  // fault, and the demand asks for it; what is not finite is taken for zero. now_ns does not run
  // backwards. Constant cost.
  void Tick(uint64_t now_ns, const DriveDemand& demand, CanBatch& out);

  DriveFeedback State(uint64_t now_ns) const;
  // It pushes nothing, as it says itself, or has said nothing for longer than a stop takes.
  bool AreOff(uint64_t now_ns) const;
  const Report& report() const { return report_; }
  const Counters& counters() const { return counters_; }
  const Command& commanded() const { return command_; }  // of the last tick

  static constexpr uint64_t kForeignHold_ns = 2'000'000'000;
  static constexpr uint64_t kForgotten_ns = 5'000'000'000;  // longer than a stop takes
  // A controller may take so long to forget its faults.
  static constexpr uint64_t kResetHold_ns = 1'000'000'000;
  // Slower than this, a steering angle cannot be told from a yaw rate: it stays as it was.
  static constexpr float kLeastSteeredSpeed_mps = 0.05f;
  // From this on it is told for the speed that is measured.
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
  uint64_t reset_ns_ = 0;    // asked for; 0: never
  bool was_reset_asked_ = false;
  TurnKind turn_kind_ = TurnKind::kYawRate;  // that it measures
  uint8_t counter_ = 0;                      // of its feedback
  uint8_t echo_ = 0;
  uint64_t echo_ns_ = 0;  // when that last changed, or since when it is waited for
  bool has_version_ = false;
  uint8_t version_ = 0;
  Command command_;
};
static_assert(std::is_trivially_copyable_v<TwistDrive>);

// Adds what was decided: states, faults, what was commanded.
void AddToHash(const TwistDrive& drive, DecisionHash& hash);

}  // namespace hardpack::twist_drive
