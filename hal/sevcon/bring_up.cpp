// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/bring_up.h"

#include "core/base/saturate.h"
#include "hal/sevcon/process_data.h"

namespace hardpack::sevcon {
namespace {

// A state that was asked for is looked for so often, this far apart: 2 s.
constexpr int32_t kMaxPolls = 40;
constexpr uint64_t kPollPause_ns = 50'000'000;

constexpr uint8_t kUserSubindex = 3;
constexpr uint8_t kPasswordSubindex = 2;
constexpr uint8_t kLevelSubindex = 1;

SdoQuestion Read(uint16_t index, uint8_t subindex, uint8_t size) {
  return {index, subindex, size, false, 0};
}
SdoQuestion Write(uint16_t index, uint8_t subindex, uint8_t size, uint32_t value) {
  return {index, subindex, size, true, value};
}
SdoQuestion Read(const ObjectRow& row) {
  return Read(row.index, row.subindex, row.size);
}

bool HasLogin(const DriveParams& params) {
  return params.login_user != 0 || params.login_password != 0;
}

}  // namespace

void BringUp::Restart() {
  const uint32_t written = settings_written_;
  const bool stopped = stopped_;
  *this = BringUp{};
  settings_written_ = written;
  stopped_ = stopped;
}

void BringUp::Wake() {
  if (stopped_ && phase_ == Phase::kIdentify) Go(Phase::kWake);
}

NmtCommand BringUp::AdvanceWake(uint64_t now_ns) {
  if (!stopped_) {
    Go(Phase::kIdentify);
    return NmtCommand::kNone;
  }
  if (waits_ && now_ns < next_ns_) return NmtCommand::kNone;
  Await(false, now_ns, Phase::kWake);
  return halted() ? NmtCommand::kNone : NmtCommand::kEnterPreOperational;
}

void BringUp::Go(Phase phase) {
  phase_ = phase;
  row_ = 0;
  part_ = 0;
  polls_ = 0;
  waits_ = false;
}

void BringUp::Fail(DriveFault fault) {
  Go(Phase::kHalted);
  fault_ = fault;
}

DriveState BringUp::state() const {
  switch (phase_) {
    case Phase::kWake:
    case Phase::kIdentify:
      return heard_ ? DriveState::kIdentifying : DriveState::kSilent;
    case Phase::kVerify:
    case Phase::kStart:
    case Phase::kMode:
      return DriveState::kVerifying;
    case Phase::kDone:
      return DriveState::kReady;
    case Phase::kHalted:
      return DriveState::kFault;
    default:
      return DriveState::kConfiguring;
  }
}

NmtCommand BringUp::Advance(uint64_t now_ns, const DriveParams& params, int32_t node,
                            SdoClient& client) {
  if (done() || halted()) return NmtCommand::kNone;
  if (phase_ == Phase::kWake) return AdvanceWake(now_ns);
  if (stopped_) return NmtCommand::kNone;
  const SdoOutcome outcome = client.TakeOutcome();
  switch (outcome) {
    case SdoOutcome::kNone:
      break;
    case SdoOutcome::kDone:
      if (client.question().write) {
        TakeWritten();
      } else {
        TakeValue(client.value(), now_ns, params, node);
      }
      break;
    case SdoOutcome::kAborted:
      TakeAbort(client.abort_code(), params);
      break;
    case SdoOutcome::kTimedOut:
      TakeTimeout();
      break;
  }
  if (done() || halted() || client.busy()) return NmtCommand::kNone;
  if (waits_ && now_ns < next_ns_) return NmtCommand::kNone;
  waits_ = false;
  asked_unheard_ = silent();
  heard_since_asked_ = false;
  client.Ask(NextQuestion(params), asked_unheard_ ? 0 : params.sdo_retries);
  if (phase_ == Phase::kAwaitPre) return NmtCommand::kEnterPreOperational;
  return phase_ == Phase::kStart ? NmtCommand::kStart : NmtCommand::kNone;
}

SdoQuestion BringUp::NextQuestion(const DriveParams& params) const {
  switch (phase_) {
    case Phase::kIdentify:
      return Read(kIdentity[row_]);
    case Phase::kSurvey:
    case Phase::kWrite: {
      ObjectRow row = kSettings[row_];
      if (row.wanted == Wanted::kWatchUs) row.subindex = consumer_;
      if (phase_ == Phase::kSurvey || part_ == 1) return Read(row);
      return Write(row.index, row.subindex, row.size, ValueOf(row.wanted, params));
    }
    case Phase::kForced:
      return Read(kForcePreOperational, 0, 1);
    case Phase::kForce:
      return Write(kForcePreOperational, 0, 1, 1);
    case Phase::kRelease:
      return Write(kForcePreOperational, 0, 1, 0);
    case Phase::kReadAccess:
      return Read(kAccess, kLevelSubindex, 1);
    case Phase::kLogin:
      if (part_ == 0) {
        return Write(kAccess, kUserSubindex, 2, static_cast<uint32_t>(params.login_user));
      }
      if (part_ == 1) {
        return Write(kAccess, kPasswordSubindex, 2, static_cast<uint32_t>(params.login_password));
      }
      return Read(kAccess, kLevelSubindex, 1);
    case Phase::kRest:
      return Read(kActualSpeedIndex, 0, 4);
    case Phase::kVerify:
      return Read(kMapping[row_]);
    case Phase::kMode:
      return Read(kModeDisplay, 0, 1);
    default:
      return Read(kNmtStateIndex, 0, 1);
  }
}

void BringUp::TakeValue(uint32_t value, uint64_t now_ns, const DriveParams& params, int32_t node) {
  heard_ = true;
  switch (phase_) {
    case Phase::kIdentify:
      return NextIdentity(value, params, node);
    case Phase::kSurvey:
      return TakeSetting(value, params, node);
    case Phase::kForced:
      forced_ = value != 0;
      return Go(differs_ != 0 || forced_ ? Phase::kReadAccess : Phase::kVerify);
    case Phase::kReadAccess:
      return Go(value >= kNeededAccess || !HasLogin(params) ? Phase::kRest : Phase::kLogin);
    case Phase::kLogin:
      return value >= kNeededAccess ? Go(Phase::kRest) : Fail(DriveFault::kLoginRefused);
    case Phase::kRest: {
      const float speed_radps = WheelSpeed_radps(
          ClampInt(static_cast<int32_t>(value), -kMaxReported_rpm, kMaxReported_rpm), 1,
          params.gear_ratio);
      polls_ = 0;  // a vehicle may roll for as long as it likes
      return Await(Abs(speed_radps) <= params.standstill_radps, now_ns,
                   has_force_ ? Phase::kForce : Phase::kAwaitPre);
    }
    case Phase::kAwaitPre:
      Await(value == static_cast<uint32_t>(NmtState::kPreOperational), now_ns, Phase::kWrite);
      if (phase_ == Phase::kWrite) NextWrite();
      return;
    case Phase::kWrite:
      if (!Matches(kSettings[row_].wanted, value, params, node)) return Fail(DriveFault::kReadBack);
      ++row_;
      return NextWrite();
    case Phase::kVerify:
      return NextMapping(value, params, node);
    case Phase::kStart:
      return Await(value == static_cast<uint32_t>(NmtState::kOperational), now_ns, Phase::kMode);
    case Phase::kMode:
      if (value != static_cast<uint32_t>(params.operation_mode)) {
        return Fail(DriveFault::kWrongMode);
      }
      return Go(Phase::kDone);
    default:
      return;
  }
}

void BringUp::Await(bool reached, uint64_t now_ns, Phase next) {
  if (reached) return Go(next);
  if (++polls_ >= kMaxPolls) return Fail(DriveFault::kStateRefused);
  waits_ = true;
  next_ns_ = now_ns + kPollPause_ns;
}

void BringUp::NextIdentity(uint32_t value, const DriveParams& params, int32_t node) {
  if (!Matches(kIdentity[row_].wanted, value, params, node)) {
    return Fail(DriveFault::kWrongIdentity);
  }
  if (++row_ < kIdentity.size()) return;
  Go(Phase::kSurvey);
  differs_ = 0;
  consumer_ = 1;
  NextSetting(params);
}

// Of the survey: the present row, or the next that the parameters do not leave out.
void BringUp::NextSetting(const DriveParams& params) {
  HP_LOOP_BOUND(kSettings.size())
  while (row_ < kSettings.size() && IsLeftOut(kSettings[row_].wanted, params)) ++row_;
  if (row_ >= kSettings.size()) Go(Phase::kForced);
}

void BringUp::TakeSetting(uint32_t value, const DriveParams& params, int32_t node) {
  const Wanted wanted = kSettings[row_].wanted;
  if (wanted == Wanted::kWatchUs) {
    // Entries that watch other nodes stay as they are.
    const uint32_t watched = (value >> 16u) & 0x7fu;
    const bool is_free = watched == 0 || (value & 0xffffu) == 0;
    if (!is_free && watched != static_cast<uint32_t>(params.master_node) &&
        consumer_ < kMaxConsumers) {
      ++consumer_;
      return;
    }
  }
  if (!Matches(wanted, value, params, node)) differs_ |= 1u << row_;
  ++row_;
  NextSetting(params);
}

// The next setting to be written, from the present row on.
void BringUp::NextWrite() {
  part_ = 0;
  HP_LOOP_BOUND(kSettings.size())
  while (row_ < kSettings.size() && (differs_ & (1u << row_)) == 0) ++row_;
  if (row_ >= kSettings.size()) Go(has_force_ ? Phase::kRelease : Phase::kVerify);
}

void BringUp::TakeWritten() {
  switch (phase_) {
    case Phase::kLogin:
      ++part_;
      return;
    case Phase::kForce:
      return Go(Phase::kAwaitPre);
    case Phase::kWrite:
      ++settings_written_;
      part_ = 1;
      return;
    case Phase::kRelease:
      return Go(Phase::kVerify);
    default:
      return;
  }
}

void BringUp::NextMapping(uint32_t value, const DriveParams& params, int32_t node) {
  const Wanted wanted = kMapping[row_].wanted;
  if (!Matches(wanted, value, params, node)) return Fail(DriveFault::kWrongMapping);
  if (wanted == Wanted::kFeedbackType) by_event_ = value > 240;
  if (wanted == Wanted::kSpeedLimit && value < static_cast<uint32_t>(kNoSpeedLimit_rpm)) {
    speed_limit_rpm_ = static_cast<int32_t>(value);
  }
  ++row_;
  if (row_ < kMapping.size() && kMapping[row_].wanted == Wanted::kFeedbackPeriod && !by_event_) {
    ++row_;
  }
  if (row_ >= kMapping.size()) Go(Phase::kStart);
}

void BringUp::TakeAbort(uint32_t code, const DriveParams& params) {
  heard_ = true;
  if (code == kAbortNoObject || code == kAbortNoSubindex) {
    if (phase_ == Phase::kSurvey && kSettings[row_].optional) {
      ++row_;
      return NextSetting(params);
    }
    if (phase_ == Phase::kVerify && kMapping[row_].optional) {
      ++row_;
      if (row_ >= kMapping.size()) Go(Phase::kStart);
      return;
    }
    if (phase_ == Phase::kForced) {  // a slave need not have 2800h: NMT will do
      has_force_ = false;
      return Go(differs_ != 0 ? Phase::kReadAccess : Phase::kVerify);
    }
  }
  Fail(phase_ == Phase::kLogin ? DriveFault::kLoginRefused : DriveFault::kSdoAbort);
}

void BringUp::TakeTimeout() {
  if (asked_unheard_) return;  // silent, or just starting: asked again
  if (!heard_since_asked_) return Restart();
  Fail(DriveFault::kSdoTimeout);
}

}  // namespace hardpack::sevcon
