// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/drive_parameters.h"
#include "hal/can_batch.h"
#include "hal/can_frame.h"
#include "hal/sevcon/bring_up.h"
#include "hal/sevcon/drive_report.h"
#include "hal/sevcon/power_states.h"
#include "hal/sevcon/sdo_client.h"

namespace hardpack::sevcon {

// One of the two drives of DrivePair (sevcon.h): its bring-up, its power states, its reports, and
// their monitoring. It does not know of the other drive.
//
// Two state machines run side by side. The bring-up (bring_up.h) sends requests; it starts over
// when the drive reboots or goes silent. The power sequence sends commands, once the process data
// have been verified, and keeps commanding zero while the drive is not heard: it may still hear us.
class Drive {
 public:
  void Configure(int32_t node, int32_t sign);
  int32_t node() const { return node_; }

  // Frames of this drive. False: malformed, and ignored.
  bool TakeHeartbeat(const CanFrame& frame, uint64_t came_ns);
  bool TakeEmergency(const CanFrame& frame);
  bool TakeFeedback(const CanFrame& frame, uint64_t came_ns, const DriveParams& params);
  bool TakeSdo(const CanFrame& frame);

  // Our next SYNC is sent: one report was due for the previous one.
  void EndSyncPeriod();

  // First in a tick: checks for anything missing, late or wrong. `carried`: the vehicle drags the
  // wheel along in a turn, so it may turn against its command for longer.
  void Watch(uint64_t now_ns, const DriveParams& params, bool carried);
  // Then: towards operation enabled while `wish`, otherwise to zero, and disabled once `rests` has
  // lasted.
  void Sequence(uint64_t now_ns, const DriveParams& params, bool wish, bool rests);
  // Finally: the frames to the drive. NMT first.
  void Command(const DriveParams& params, int32_t speed_rpm, CanBatch& out);
  void Ask(uint64_t now_ns, const DriveParams& params, CanBatch& out);

  // The first since the last reset is kept.
  void SetFault(DriveFault fault);
  // One attempt: clears the fault, resets the drive's own, restarts a failed bring-up.
  void ResetFault(uint64_t now_ns, const DriveParams& params);
  // Whether a fault has occurred since the last call.
  bool TakeNewFault();

  bool has_fault() const { return report_.fault != DriveFault::kNone; }
  // Its statusword must be known, because it may contain a fault.
  bool ready() const { return bring_up_.done() && has_feedback_ && !has_fault() && !resetting_; }
  bool follows(uint64_t now_ns, const DriveParams& params) const;
  bool IsFresh(uint64_t now_ns, const DriveParams& params) const;
  int32_t sent_rpm() const { return sent_rpm_; }
  int32_t MotorSpeed(float wheel_radps, const DriveParams& params) const;
  float WheelSpeed(int32_t motor_rpm, const DriveParams& params) const;
  const DriveReport& report() const { return report_; }

 private:
  enum class Power : uint8_t { kOff, kEnabling, kOn, kStopping };

  bool IsIn(PowerState state) const { return PowerStateOf(report_.statusword) == state; }
  uint16_t Controlword() const;
  void SetPower(Power power, uint64_t now_ns);
  void SequenceStop(uint64_t now_ns, const DriveParams& params, bool rests);
  void WatchSilence(uint64_t now_ns, const DriveParams& params);
  void WatchStatus(uint64_t now_ns, const DriveParams& params);
  void WatchDirection(uint64_t now_ns, const DriveParams& params, bool carried);
  void BeginAnew();
  void BeginWatch(uint64_t now_ns, const DriveParams& params);
  void TakeBringUpFault();
  void AskSupply(uint64_t now_ns);
  void TakeSupply();
  void ReportQuestion();
  void Report();

  int32_t node_ = 0;
  int32_t sign_ = 1;
  DriveReport report_;
  SdoClient client_;
  BringUp bring_up_;

  Power power_ = Power::kOff;
  uint64_t power_since_ns_ = 0;
  uint64_t rest_since_ns_ = 0;
  bool commandable_ = false;    // its process data have been verified since it started
  bool drops_command_ = false;  // stop commanding after the next one
  bool reported_ = false;       // since it is commandable
  bool found_enabled_ = false;  // by that first report
  bool new_fault_ = false;
  bool was_done_ = false;
  bool resetting_ = false;
  uint64_t resetting_since_ns_ = 0;
  bool has_feedback_ = false;  // since it is commandable, or done again
  uint64_t heartbeat_ns_ = 0;  // of the last, or start of the wait for one
  uint64_t feedback_ns_ = 0;   // the same
  int32_t sent_rpm_ = 0;
  float opposite_radps_ = 0.0f;    // against its command, recent minimum; 0: it does not turn so
  uint64_t opposite_ns_ = 0;       // weighted time: dragged by a turn once, otherwise kCarriedTimes
  uint64_t opposite_seen_ns_ = 0;  // counted up to here
  uint8_t supply_row_ = 0;
  uint64_t supply_ns_ = 0;
  int32_t reports_ = 0;  // since the last SYNC
  int32_t excess_ = 0;   // of reports over SYNCs, recently
};
static_assert(std::is_trivially_copyable_v<Drive>);

}  // namespace hardpack::sevcon
