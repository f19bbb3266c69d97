// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/drive.h"

#include "core/base/assert.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "hal/sevcon/durations.h"
#include "hal/sevcon/process_data.h"

namespace hardpack::sevcon {
namespace {

constexpr float kUnitsOfTorque = 1000.0f;

// A drive that was told zero for so long is disabled, whatever it says of its speed, or says
// nothing: longer than a stop from 5 m/s takes.
constexpr uint64_t kLongestStop_ns = 5'000'000'000;
// A fault that has not gone so long after its reset stays.
constexpr uint64_t kResetTime_ns = 1'000'000'000;
// A wheel that is carried along may turn against its command for so many times opposite_time_s.
constexpr uint64_t kCarriedTimes = 6;
// So many reports more than SYNCs are a second sender's.
constexpr int32_t kMostReports = 10;

}  // namespace

void Drive::Configure(int32_t node, int32_t sign) {
  *this = Drive{};
  node_ = node;
  sign_ = sign;
}

float Drive::WheelSpeed(int32_t motor_rpm, const DriveParams& params) const {
  return WheelSpeed_radps(motor_rpm, sign_, params.gear_ratio);
}

int32_t Drive::MotorSpeed(float wheel_radps, const DriveParams& params) const {
  int32_t limit_rpm = RoundToInt(params.max_motor_speed_rpm);
  if (bring_up_.speed_limit_rpm() < limit_rpm) limit_rpm = bring_up_.speed_limit_rpm();
  return MotorSpeed_rpm(wheel_radps, sign_, params.gear_ratio, limit_rpm);
}

bool Drive::IsFresh(uint64_t now_ns, const DriveParams& params) const {
  return has_feedback_ && now_ns - feedback_ns_ <= Milliseconds(params.feedback_timeout_ms);
}

bool Drive::follows(uint64_t now_ns, const DriveParams& params) const {
  return power_ == Power::kOn && ready() && IsIn(PowerState::kOperationEnabled) &&
         IsFresh(now_ns, params);
}

void Drive::SetFault(DriveFault fault) {
  if (has_fault() || fault == DriveFault::kNone) return;
  report_.fault = fault;
  new_fault_ = true;
}

bool Drive::TakeNewFault() {
  const bool is_new = new_fault_;
  new_fault_ = false;
  return is_new;
}

// The bring-up, from the first question on.
void Drive::BeginAnew() {
  client_.Cancel();
  bring_up_.Restart();
  was_done_ = false;
  report_.has_supply = false;
}

void Drive::ResetFault(uint64_t now_ns, const DriveParams& params) {
  report_.fault = DriveFault::kNone;
  new_fault_ = false;
  opposite_radps_ = 0.0f;
  excess_ = 0;
  if (bring_up_.halted() || bring_up_.stopped()) BeginAnew();
  bring_up_.Wake();
  if (IsFresh(now_ns, params) && IsFault(PowerStateOf(report_.statusword))) {
    resetting_ = true;
    resetting_since_ns_ = now_ns;
  }
}

bool Drive::TakeHeartbeat(const CanFrame& frame, uint64_t came_ns) {
  if (frame.size != 1) return false;
  const uint8_t state = frame.data[0];
  switch (static_cast<NmtState>(state)) {
    case NmtState::kBootUp:
      ++report_.reboots;
      break;
    case NmtState::kStopped:
    case NmtState::kOperational:
    case NmtState::kPreOperational:
      break;
    default:
      return false;
  }
  report_.nmt_state = state;
  if (came_ns > heartbeat_ns_) heartbeat_ns_ = came_ns;
  const bool stopped = state == static_cast<uint8_t>(NmtState::kStopped);
  // Somebody else's doing. It answers no question then; it is brought back by the operator's reset.
  if (stopped && !bring_up_.stopped()) SetFault(DriveFault::kRebooted);
  bring_up_.HearState(stopped);
  const bool booted = state == static_cast<uint8_t>(NmtState::kBootUp);
  const bool left = bring_up_.done() && state != static_cast<uint8_t>(NmtState::kOperational);
  if (booted || left) {
    // The first start of a drive is nothing that anybody minds.
    if (was_done_) SetFault(DriveFault::kRebooted);
    drops_command_ = commandable_;
    BeginAnew();
  }
  bring_up_.Hear();
  return true;
}

bool Drive::TakeEmergency(const CanFrame& frame) {
  if (frame.size != 8) return false;
  const Emergency emergency = DecodeEmergency(frame);
  report_.emergency_code = emergency.code;
  report_.emergency_register = emergency.error_register;
  report_.sevcon_fault_id = emergency.fault_id;
  bring_up_.Hear();
  if (emergency.code == 0) return true;
  ++report_.emergencies;
  // While it is brought up a drive says that it is pre-operational, and the like; what then still
  // stands in the way shows in its statusword.
  if (bring_up_.done()) SetFault(DriveFault::kEmergency);
  return true;
}

bool Drive::TakeFeedback(const CanFrame& frame, uint64_t came_ns, const DriveParams& params) {
  MotorFeedback feedback;
  if (!Unpack(frame, feedback)) return false;
  bring_up_.Hear();
  if (reports_ < kMostReports) ++reports_;
  // What is mapped there is not known before; and nothing is newer than what is known.
  if (!commandable_ || drops_command_ || (has_feedback_ && came_ns < feedback_ns_)) return true;
  report_.statusword = feedback.statusword;
  report_.wheel_radps = WheelSpeed(feedback.speed_rpm, params);
  report_.wheel_time_ns = came_ns;
  report_.torque_share = static_cast<float>(feedback.torque_permille * sign_) / kUnitsOfTorque;
  feedback_ns_ = came_ns;
  has_feedback_ = true;
  if (!reported_) found_enabled_ = IsIn(PowerState::kOperationEnabled);
  reported_ = true;
  return true;
}

// An answer that is late makes two in one period and none in the one before: only what is more than
// one a period for long is somebody else's.
void Drive::EndSyncPeriod() {
  const int32_t reports = reports_;
  reports_ = 0;
  if (!bring_up_.done() || bring_up_.reports_by_event()) {
    excess_ = 0;
    return;
  }
  if (reports > 1) ++report_.doubled_reports;
  excess_ += reports - 1;
  if (excess_ < 0) excess_ = 0;
  if (excess_ > kMostReports) excess_ = kMostReports;
}

bool Drive::TakeSdo(const CanFrame& frame) {
  if (frame.size != 8) return false;
  bring_up_.Hear();
  client_.TakeAnswer(frame);
  return true;
}

void Drive::Watch(uint64_t now_ns, const DriveParams& params, bool carried) {
  if (bring_up_.verified() && !commandable_ && !drops_command_) {
    commandable_ = true;
    has_feedback_ = false;
    sent_rpm_ = 0;
  }
  WatchSilence(now_ns, params);
  WatchStatus(now_ns, params);
  WatchDirection(now_ns, params, carried);
  if (excess_ >= kMostReports) SetFault(DriveFault::kDoubleReports);
  Report();
}

// From the end of the bring-up on: what has not come since is waited for as long as ever.
void Drive::BeginWatch(uint64_t now_ns, const DriveParams& params) {
  was_done_ = true;
  heartbeat_ns_ = now_ns;
  supply_ns_ = now_ns;
  if (IsFresh(now_ns, params)) return;
  has_feedback_ = false;
  feedback_ns_ = now_ns;
}

void Drive::TakeBringUpFault() {
  if (!bring_up_.halted()) return;
  const DriveFault fault = bring_up_.fault();
  SetFault(fault);
  // Not to be commanded: it is another device, or its process data mean something else.
  if (fault == DriveFault::kWrongIdentity || fault == DriveFault::kWrongMapping ||
      fault == DriveFault::kWrongMode) {
    drops_command_ = commandable_;
  }
}

void Drive::WatchSilence(uint64_t now_ns, const DriveParams& params) {
  if (!bring_up_.done()) return;
  const bool no_heartbeat = now_ns - heartbeat_ns_ > Milliseconds(params.heartbeat_timeout_ms);
  const bool no_feedback = now_ns - feedback_ns_ > Milliseconds(params.feedback_timeout_ms);
  if (!no_heartbeat && !no_feedback) return;
  if (no_heartbeat) ++report_.heartbeats_missed;
  SetFault(DriveFault::kSilent);
  BeginAnew();
}

void Drive::WatchStatus(uint64_t now_ns, const DriveParams& params) {
  const PowerState state = PowerStateOf(report_.statusword);
  if (!bring_up_.done() || !IsFresh(now_ns, params)) return;
  if (!IsFault(state)) {
    resetting_ = false;
    if (power_ == Power::kOn && state != PowerState::kOperationEnabled) {
      SetFault(DriveFault::kLostEnable);
    }
    return;
  }
  if (resetting_ && now_ns - resetting_since_ns_ < kResetTime_ns) return;
  resetting_ = false;
  SetFault(DriveFault::kStatusFault);
}

// A wheel that is told to turn back takes its time; one that turns against its command and does not
// slow down is wired, geared or signed the wrong way round; or, for a while, the inner wheel of a
// turn, whose motor has no torque left against the scrubbing tyres.
void Drive::WatchDirection(uint64_t now_ns, const DriveParams& params, bool carried) {
  const float wanted_radps = WheelSpeed(sent_rpm_, params);
  const float against_radps = wanted_radps > 0.0f ? -report_.wheel_radps : report_.wheel_radps;
  if (sent_rpm_ == 0 || !IsFresh(now_ns, params) || against_radps <= params.opposite_speed_radps) {
    opposite_radps_ = 0.0f;
    return;
  }
  constexpr float kSlower = 0.25f;  // of opposite_speed_radps: counts as slowing down
  if (opposite_radps_ <= 0.0f ||
      against_radps < opposite_radps_ - kSlower * params.opposite_speed_radps) {
    opposite_radps_ = against_radps;
    opposite_ns_ = 0;
    opposite_seen_ns_ = now_ns;
    return;
  }
  // Both count together, each by its share: a turn may carry the wheel now and then.
  const uint64_t passed_ns = now_ns - opposite_seen_ns_;
  opposite_seen_ns_ = now_ns;
  opposite_ns_ += carried ? passed_ns : kCarriedTimes * passed_ns;
  if (opposite_ns_ >= kCarriedTimes * Seconds(params.opposite_time_s)) {
    SetFault(DriveFault::kOppositeMotion);
  }
}

void Drive::SetPower(Power power, uint64_t now_ns) {
  if (power != power_) power_since_ns_ = rest_since_ns_ = now_ns;
  power_ = power;
}

void Drive::Sequence(uint64_t now_ns, const DriveParams& params, bool wish, bool rests) {
  const bool fresh = IsFresh(now_ns, params);
  const bool enabled = fresh && IsIn(PowerState::kOperationEnabled);
  if (!commandable_ || drops_command_) {
    SetPower(Power::kOff, now_ns);
  } else if (wish) {
    if (enabled) {
      SetPower(Power::kOn, now_ns);
    } else {
      if (power_ != Power::kEnabling) SetPower(Power::kEnabling, now_ns);
      if (now_ns - power_since_ns_ > Seconds(params.enable_timeout_s)) {
        SetFault(DriveFault::kStateRefused);
      }
    }
  } else {
    SequenceStop(now_ns, params, rests);
  }
  Report();
}

void Drive::SequenceStop(uint64_t now_ns, const DriveParams& params, bool rests) {
  const bool fresh = IsFresh(now_ns, params);
  const bool enabled = fresh && IsIn(PowerState::kOperationEnabled);
  if (power_ == Power::kOn || power_ == Power::kEnabling || found_enabled_) {
    SetPower(Power::kStopping, now_ns);
  }
  found_enabled_ = false;
  if (power_ != Power::kStopping) return;
  if (fresh && !enabled) return SetPower(Power::kOff, now_ns);
  // Silent, or seen not to stop. More than zero cannot be told to it: the brakes are left.
  const bool stands = fresh && rests;
  if (!stands && now_ns - power_since_ns_ >= kLongestStop_ns) return SetPower(Power::kOff, now_ns);
  if (!fresh) return;
  if (!rests) rest_since_ns_ = now_ns;
  if (now_ns - rest_since_ns_ >= Seconds(params.disable_delay_s)) SetPower(Power::kOff, now_ns);
}

uint16_t Drive::Controlword() const {
  switch (power_) {
    case Power::kEnabling:
      return StepToEnabled(PowerStateOf(report_.statusword));
    case Power::kOn:
    case Power::kStopping:
      return kEnableOperation;
    case Power::kOff:
      break;
  }
  return resetting_ ? kResetFault : kDisableVoltage;
}

void Drive::Command(const DriveParams& params, int32_t speed_rpm, CanBatch& out) {
  HP_ASSERT(speed_rpm == 0 || power_ == Power::kOn);
  // Whether it is enabled already (we may have been started anew) has to be known first: then it is
  // stopped like any other.
  if (reported_) {
    Push(out, Pack(node_, {Controlword(), speed_rpm, params.max_torque_permille}));
    sent_rpm_ = speed_rpm;
  }
  if (!drops_command_) return;
  drops_command_ = false;
  commandable_ = false;
  has_feedback_ = false;
  reported_ = false;
  found_enabled_ = false;
}

void Drive::Ask(uint64_t now_ns, const DriveParams& params, CanBatch& out) {
  const NmtCommand command = bring_up_.Advance(now_ns, params, node_, client_);
  if (command != NmtCommand::kNone) Push(out, NmtFrame(command, node_));
  TakeBringUpFault();
  if (bring_up_.done() && !was_done_) BeginWatch(now_ns, params);
  if (bring_up_.done()) {
    const SdoOutcome outcome = client_.TakeOutcome();
    if (outcome == SdoOutcome::kDone) TakeSupply();
    if (outcome == SdoOutcome::kAborted) ReportQuestion();
    if (!client_.busy()) AskSupply(now_ns);
  }
  CanFrame question;
  if (client_.Send(now_ns, node_, Milliseconds(params.sdo_timeout_ms), question)) {
    Push(out, question);
  }
  Report();
}

}  // namespace hardpack::sevcon
