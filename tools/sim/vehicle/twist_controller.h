// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "hal/can_frame.h"

// A motion controller that takes a speed and a turn over CAN, as required by docs/twist_drive.md:
// it boots, follows, brakes on its own when commands cease, and reports its motion. The bytes are
// written from that page, independent of hal/twist_drive. The body is simulated elsewhere: motion()
// is what the controller demands of it, SetMeasured what it then does.

namespace hardpack::sim {

struct TwistControllerSettings {
  uint32_t command_id = 0x210;
  uint32_t feedback_id = 0x211;
  uint32_t status_id = 0x212;
  bool steers = false;  // the turn is a steering angle, else a yaw rate
  double boot_s = 1.5;  // after power on, until it is ready
  uint64_t feedback_period_ns = 10'000'000;
  uint64_t status_period_ns = 500'000'000;
  uint64_t command_timeout_ns = 200'000'000;
};

// Its faults, from now on.
struct TwistControllerFaults {
  bool silent = false;   // it neither sends nor receives
  bool deaf = false;     // it receives nothing
  bool frozen = false;   // it reports the same motion forever
  bool refuses = false;  // it does not follow
  bool bad_crc = false;  // in everything it sends
  uint8_t version = 1;   // the protocol version that it reports
};

// docs/twist_drive.md.
enum class TwistState : uint8_t { kStarting, kReady, kFollowing, kStopping, kFault };
const char* Name(TwistState state);

class TwistController {
 public:
  struct Motion {
    bool driven = false;  // false: it applies no torque, and the brake holds
    double speed_mps = 0.0;
    double turn = 0.0;  // rad/s, or rad
  };

  TwistController(const TwistControllerSettings& settings, uint64_t start_ns);

  // Takes a frame sent by another node. Time does not run backwards.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);
  // Appends the frames it has sent until now_ns.
  void Advance(uint64_t now_ns, std::vector<CanFrame>& sent);

  Motion motion() const;
  // The vehicle's current motion.
  void SetMeasured(double speed_mps, double turn) {
    speed_mps_ = speed_mps;
    turn_ = turn;
  }

  // Raises one of its own faults, by the bits that it reports; cleared by the command to reset
  // faults.
  void RaiseFault(uint16_t bits) { fault_bits_ = bits; }
  void Reboot() { boots_ = true; }

  TwistState state() const { return state_; }
  const TwistControllerSettings& settings() const { return settings_; }
  TwistControllerFaults& faults() { return faults_; }

 private:
  struct Told {
    bool enable = false;
    double speed_mps = 0.0;
    double turn = 0.0;
  };

  void Decide(uint64_t now_ns);
  CanFrame Feedback();
  CanFrame Status();
  CanFrame Ended(uint32_t id, std::vector<uint8_t> bytes) const;
  double TurnUnit() const { return settings_.steers ? 1.0e-4 : 1.0e-3; }

  TwistControllerSettings settings_;
  TwistControllerFaults faults_;
  TwistState state_ = TwistState::kStarting;
  bool boots_ = true;
  uint64_t booted_ns_ = 0;  // end of booting
  uint64_t next_feedback_ns_;
  uint64_t next_status_ns_;
  uint16_t fault_bits_ = 0;
  uint16_t said_fault_bits_ = 0;
  std::optional<Told> told_;
  uint64_t told_ns_ = 0;
  bool timed_out_ = true;
  std::optional<uint8_t> echo_;  // counter of the newest command
  uint8_t feedback_counter_ = 0;
  uint8_t status_counter_ = 0;
  double speed_mps_ = 0.0;
  double turn_ = 0.0;
  double reported_speed_mps_ = 0.0;
  double reported_turn_ = 0.0;
};

}  // namespace hardpack::sim
