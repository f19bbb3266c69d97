// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <type_traits>

#include "config/drive_parameters.h"
#include "hal/sevcon/canopen.h"
#include "hal/sevcon/drive_report.h"
#include "hal/sevcon/sdo_client.h"
#include "hal/sevcon/settings.h"

namespace hardpack::sevcon {

// Brings one drive from any state to operational, using requests only: no boot-up message is
// needed, and a drive that is already set up gets no write at all.
//
//   identify -> survey the settings -> verify the process data -> start -> 6061h -> done
//                    | one differs                ^
//                    v                            |
//       login -> wait for rest -> pre-operational -> write and read back each that differs
//
// A drive stopped by NMT answers no requests: it is left alone until Wake, which first makes it
// pre-operational (CiA 301: this needs only the NMT command).
//
// No write before the identity is confirmed. A failure ends it (halted) until Restart; a drive that
// goes silent meanwhile is waited for.
class BringUp {
 public:
  // Starts over, with a drive that may be silent.
  void Restart();
  // A frame arrived from the drive.
  void Hear() { heard_ = heard_since_asked_ = true; }
  // A heartbeat arrived, which says whether the drive is stopped.
  void HearState(bool stopped) { stopped_ = stopped; }
  bool stopped() const { return stopped_; }
  // The operator wants it back: after Restart, has no effect unless it is stopped.
  void Wake();

  // Once a tick: takes the answer to the client's request and sends the next. Returns the NMT
  // command to send to the drive now. Cost: constant.
  NmtCommand Advance(uint64_t now_ns, const DriveParams& params, int32_t node, SdoClient& client);

  bool done() const { return phase_ == Phase::kDone; }
  bool halted() const { return phase_ == Phase::kHalted; }
  bool silent() const { return phase_ == Phase::kIdentify && !heard_; }
  // The process data are as required: the drive may be commanded, and believed.
  bool verified() const { return phase_ >= Phase::kStart && phase_ <= Phase::kDone; }
  // Since the last Restart; kNone unless halted.
  DriveFault fault() const { return fault_; }
  // kSilent .. kVerifying; kReady when done.
  DriveState state() const;
  // 6080h, or a value above any command.
  int32_t speed_limit_rpm() const { return speed_limit_rpm_; }
  uint32_t settings_written() const { return settings_written_; }
  // Its reports are sent on its own timer, not one per SYNC.
  bool reports_by_event() const { return by_event_; }

 private:
  enum class Phase : uint8_t {
    kWake = 0,  // NMT, until its heartbeat says that it is not stopped
    kIdentify,
    kSurvey,
    kForced,  // is the drive held in pre-operational by an aborted configuration?
    kReadAccess,
    kLogin,     // part 0: user, 1: password, 2: read the access again
    kRest,      // the configuration is not touched while a wheel turns
    kForce,     // 2800h
    kAwaitPre,  // NMT, and 5110h
    kWrite,     // part 0: write, 1: read back
    kRelease,   // 2800h
    kVerify,
    kStart,  // NMT, and 5110h
    kMode,   // 6061h
    kDone,
    kHalted,
  };

  NmtCommand AdvanceWake(uint64_t now_ns);
  SdoQuestion NextQuestion(const DriveParams& params) const;
  void TakeValue(uint32_t value, uint64_t now_ns, const DriveParams& params, int32_t node);
  void TakeWritten();
  void TakeAbort(uint32_t code, const DriveParams& params);
  void TakeTimeout();
  void TakeSetting(uint32_t value, const DriveParams& params, int32_t node);
  void Await(bool reached, uint64_t now_ns, Phase next);
  void NextIdentity(uint32_t value, const DriveParams& params, int32_t node);
  void NextMapping(uint32_t value, const DriveParams& params, int32_t node);
  void NextSetting(const DriveParams& params);
  void NextWrite();
  void Go(Phase phase);
  void Fail(DriveFault fault);

  Phase phase_ = Phase::kIdentify;
  uint8_t row_ = 0;
  uint8_t part_ = 0;
  bool heard_ = false;
  bool heard_since_asked_ = false;
  bool stopped_ = false;        // as its last heartbeat reported
  bool asked_unheard_ = false;  // the present request, once, to a drive that may be silent
  bool has_force_ = true;
  bool forced_ = false;
  bool by_event_ = false;  // 1800h:2 says that reports use their own timer
  uint8_t consumer_ = 1;   // subindex of 1016h
  uint32_t differs_ = 0;   // bit per row of kSettings
  int32_t polls_ = 0;
  uint64_t next_ns_ = 0;  // not before
  bool waits_ = false;    // for next_ns_
  DriveFault fault_ = DriveFault::kNone;
  int32_t speed_limit_rpm_ = kNoSpeedLimit_rpm;
  uint32_t settings_written_ = 0;

  static constexpr int32_t kNoSpeedLimit_rpm = 1000000;
};
static_assert(std::is_trivially_copyable_v<BringUp>);

}  // namespace hardpack::sevcon
