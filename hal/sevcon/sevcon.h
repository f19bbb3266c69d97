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
#include "hal/sevcon/drive.h"
#include "hal/sevcon/drive_report.h"

// The CANopen master of a vehicle with two Sevcon Gen4 traction controllers, one per side (CiA 301,
// CiA 402; REFERENCES.md; for what is public on the Warthog's bus see docs/vehicle.md). Frames in,
// frames out; no clock, no bus: time and frames come in as arguments. It brings the drives up
// (identify, log in, write differences, read back, verify the process data, start), follows their
// state machines, commands wheel speeds, monitors them, and brings them to rest. It does not decide
// whether the vehicle may move (core/safety does); but a fault of one drive sends zero to both in
// the same tick, whatever is requested.
//
//   TakeFrame (each received frame), then Tick once: frames to send, in order.

namespace hardpack::sevcon {

struct PairCounters {
  uint32_t frames_taken = 0;
  uint32_t frames_ignored = 0;    // with identifiers that do not concern us
  uint32_t frames_malformed = 0;  // wrong length, remote, extended, or an impossible value
  uint32_t foreign_frames = 0;    // with identifiers that only we send
  uint32_t frames_old = 0;        // of a drive, longer ago than max_frame_age_ms: dropped
};

class DrivePair {
 public:
  // Clears everything and begins with silent drives. kParameterOutOfRange; kInvalidArgument: two
  // nodes are the same, a sign is neither 1 nor -1, or a time-out is no longer than the period that
  // it monitors; kCapacityExceeded: the bus load would be above max_bus_load_percent. On failure
  // nothing is accepted and nothing sent.
  Status Configure(const DriveParams& params);
  // As a DriveDevice: everything it needs about the vehicle is in its own parameters.
  Status Configure(const VehicleParams&, const DriveParams& params) { return Configure(params); }
  static const DriveParams& ParamsOf(const OnboardParams& onboard) { return onboard.drive; }

  // A frame received since the last tick, in order. It counts as of its time of arrival, if known;
  // frames that a drive sent longer than max_frame_age_ms ago are dropped, because they say nothing
  // about the present. But EMCY, heartbeats of states other than operational and frames of foreign
  // senders are accepted at any age. Cost: constant.
  void TakeFrame(const CanFrame& frame, uint64_t now_ns);

  // One tick: adds the frames to send now, at most kMaxFramesPerTick, for which there must be room.
  // Only zero speed is sent unless both drives are enabled, neither has a fault and the demand
  // requests motion. A demand that is not finite is a fault of the caller and counts as zero.
  // now_ns does not run backwards. Cost: constant.
  void Tick(uint64_t now_ns, const DriveDemand& demand, CanBatch& out);

  // Both are ready (or further), and neither has a fault.
  bool ready() const;
  bool enabled() const;     // both follow commands
  bool standstill() const;  // both report it, with fresh data
  // kOk: none has a fault; kDeviceFault; kWrongDevice: identity, mapping or a foreign sender;
  // kTimedOut: silent.
  Status health() const;
  // Another node sends with our identifiers, or did within the last kForeignHold_ns: the vehicle
  // must not be driven on this bus. The drives' faults stay until they are reset.
  bool foreign_sender() const;
  // No drive can produce torque: each reports that it is not enabled, or has been silent for longer
  // than a stop takes.
  bool AreOff(uint64_t now_ns) const;
  const DriveReport& report(Side side) const;
  WheelFeedback feedback(uint64_t now_ns) const;
  DriveFeedback State(uint64_t now_ns) const;
  WheelCommand commanded() const;  // of the last Tick, as sent: clamped, or zero
  const PairCounters& counters() const;
  // Bus load of what we send and request, as configured.
  int32_t bus_load_percent() const;

  // A master with one heartbeat per second is always heard.
  static constexpr uint64_t kForeignHold_ns = 2'000'000'000;
  // To each drive a command, an NMT command and a request; SYNC, and our heartbeat.
  static constexpr int kMaxFramesPerTick = 8;

 private:
  enum class Sender : uint8_t { kOther, kDrive, kUs };

  void Forget();
  Sender SenderOf(uint32_t id, int& side) const;
  bool TakeFromDrive(Drive& drive, const CanFrame& frame, uint64_t came_ns);
  bool IsPast(const Drive& drive, const CanFrame& frame, uint64_t came_ns) const;
  bool has_fault() const;
  bool IsCarried(int side) const;
  bool RestOf(const Drive& drive) const;
  void Sequence(const DriveDemand& demand);
  void SendCommands(const DriveDemand& demand, CanBatch& out);
  void SendPeriodic(CanBatch& out);

  // When a periodic frame is due next.
  struct Beat {
    uint64_t next_ns = 0;
    bool IsDue(uint64_t now_ns, int32_t period_ms);
  };

  DriveParams params_;
  bool configured_ = false;
  bool was_foreign_heard_ = false;
  bool was_reset_asked_ = false;
  uint64_t now_ns_ = 0;
  uint64_t foreign_ns_ = 0;
  Drive drives_[kSides];
  WheelCommand commanded_;
  Beat command_beat_;
  Beat sync_beat_;
  Beat heartbeat_beat_;
  int32_t bus_load_percent_ = 0;
  PairCounters counters_;
};
static_assert(std::is_trivially_copyable_v<DrivePair>);
static_assert(sizeof(DrivePair) <= 1024);

// Adds the decisions: states, faults, commands.
void AddToHash(const DrivePair& pair, DecisionHash& hash);

}  // namespace hardpack::sevcon
