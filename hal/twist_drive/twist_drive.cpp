// SPDX-License-Identifier: Apache-2.0
#include "hal/twist_drive/twist_drive.h"

#include "config/conflicts.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "core/base/validate.h"
#include "core/kinematics/kinematics.h"

namespace hardpack::twist_drive {
namespace {

uint64_t Nanoseconds(int32_t milliseconds) {
  return static_cast<uint64_t>(milliseconds) * 1'000'000u;
}

// Of a time within the table's range.
uint64_t NanosecondsOf(float seconds) {
  return static_cast<uint64_t>(static_cast<uint32_t>(seconds * 1000.0f)) * 1'000'000u;
}

bool IsFresher(uint64_t now_ns, uint64_t since_ns, uint64_t most_ns) {
  return since_ns != 0 && (since_ns >= now_ns || now_ns - since_ns <= most_ns);
}

float Unit(int16_t value, float per_unit) {
  return static_cast<float>(value) / per_unit;
}

}  // namespace

Status TwistDrive::Configure(const VehicleParams& vehicle, const TwistDriveParams& params) {
  *this = TwistDrive{};
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  if (FirstConflict(params, vehicle).name != nullptr) return Status::kInvalidArgument;
  vehicle_ = vehicle;
  params_ = params;
  configured_ = true;
  return Status::kOk;
}

void TwistDrive::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  if (!configured_) return;
  const auto id = static_cast<int32_t>(frame.id);
  const bool is_ours = !frame.extended && (id == params_.command_id || id == params_.feedback_id ||
                                           id == params_.status_id);
  if (!is_ours) {
    ++counters_.frames_ignored;
    return;
  }
  if (id == params_.command_id) {
    ++counters_.foreign_frames;
    foreign_ns_ = now_ns;
    return;
  }
  const uint64_t came_ns =
      frame.received_ns != 0 && frame.received_ns < now_ns ? frame.received_ns : now_ns;
  if (id == params_.feedback_id) return TakeFeedback(frame, came_ns);
  TakeStatus(frame);
}

void TwistDrive::TakeFeedback(const CanFrame& frame, uint64_t came_ns) {
  Feedback feedback;
  if (!IsUsable(Decode(frame, feedback))) {
    ++counters_.frames_malformed;
    return;
  }
  const bool is_first = report_.feedback_ns == 0;
  const auto steps = static_cast<uint8_t>(feedback.counter - counter_);
  if (!is_first && steps == 0) {
    ++counters_.frames_repeated;
    return;
  }
  ++counters_.frames_taken;
  if (!is_first) counters_.frames_missed += steps - 1u;
  counter_ = feedback.counter;
  if (is_first || feedback.echo != echo_) echo_ns_ = came_ns;
  echo_ = feedback.echo;
  turn_kind_ = feedback.turn_kind;
  report_.state = feedback.state;
  report_.feedback_ns = came_ns;
  report_.speed_mps = Unit(feedback.speed, kPerMetre);
  report_.yaw_rate_radps =
      turn_kind_ == TurnKind::kYawRate
          ? Unit(feedback.turn, kPerYawRate)
          : report_.speed_mps * CurvatureOfSteering(vehicle_, Unit(feedback.turn, kPerSteering));
  const bool moves = Abs(report_.speed_mps) > params_.standstill_mps ||
                     Abs(report_.yaw_rate_radps) > kStandstill_radps;
  if (moves) moved_ns_ = came_ns;
}

void TwistDrive::TakeStatus(const CanFrame& frame) {
  ControllerStatus status;
  if (!IsUsable(Decode(frame, status))) {
    ++counters_.frames_malformed;
    return;
  }
  ++counters_.frames_taken;
  has_version_ = true;
  version_ = status.version;
  report_.controller_faults = status.faults;
  report_.battery_V = 0.01f * static_cast<float>(status.battery);
  report_.temperature_degC = status.temperature_degC;
}

bool TwistDrive::IsFresh(uint64_t now_ns) const {
  return IsFresher(now_ns, report_.feedback_ns, Nanoseconds(params_.feedback_timeout_ms));
}

bool TwistDrive::IsAtRest(uint64_t now_ns) const {
  return IsFresh(now_ns) && Abs(report_.speed_mps) <= params_.standstill_mps &&
         Abs(report_.yaw_rate_radps) <= kStandstill_radps;
}

bool TwistDrive::IsReady(uint64_t now_ns) const {
  return configured_ && report_.fault == Fault::kNone && IsFresh(now_ns) && has_version_ &&
         (report_.state == ControllerState::kReady || report_.state == ControllerState::kFollowing);
}

void TwistDrive::SetFault(Fault fault) {
  if (report_.fault == Fault::kNone) report_.fault = fault;
}

// What is wrong whether it is driven or not; what it has not said yet is not wrong.
void TwistDrive::Watch(uint64_t now_ns) {
  if (report_.feedback_ns == 0) return;
  const bool is_resetting = IsFresher(now_ns, reset_ns_, kResetHold_ns);
  if (report_.state == ControllerState::kFault && IsFresh(now_ns) && !is_resetting) {
    SetFault(Fault::kController);
  }
  const bool steers = params_.turn == TwistDriveParams::kSteering;
  if ((turn_kind_ == TurnKind::kSteering) != steers) SetFault(Fault::kWrongTurn);
  if (has_version_ && version_ != kVersion) SetFault(Fault::kWrongVersion);
  if (power_ != Power::kOff) WatchPower(now_ns);
}

// What is wrong with one that is to follow.
void TwistDrive::WatchPower(uint64_t now_ns) {
  if (!IsFresh(now_ns)) SetFault(Fault::kSilent);
  if (!IsFresher(now_ns, echo_ns_, Nanoseconds(params_.echo_timeout_ms))) {
    SetFault(Fault::kNotHeard);
  }
  const bool follows = report_.state == ControllerState::kFollowing;
  if (power_ == Power::kOn && !follows) SetFault(Fault::kDropped);
  const bool is_late = power_ == Power::kEnabling && !follows &&
                       now_ns - power_since_ns_ > NanosecondsOf(params_.enable_timeout_s);
  if (is_late) SetFault(Fault::kEnableTimeout);
}

void TwistDrive::SetPower(Power power, uint64_t now_ns) {
  power_ = power;
  power_since_ns_ = now_ns;
}

void TwistDrive::Sequence(uint64_t now_ns, bool wish) {
  const bool may = wish && report_.fault == Fault::kNone;
  switch (power_) {
    case Power::kOff:
      if (!may || !IsReady(now_ns)) return;
      echo_ns_ = now_ns;
      return SetPower(Power::kEnabling, now_ns);
    case Power::kEnabling:
      if (!may) return SetPower(Power::kStopping, now_ns);
      if (report_.state == ControllerState::kFollowing) SetPower(Power::kOn, now_ns);
      return;
    case Power::kOn:
      if (!may) SetPower(Power::kStopping, now_ns);
      return;
    case Power::kStopping:
      if (may && report_.state == ControllerState::kFollowing && IsFresh(now_ns)) {
        return SetPower(Power::kOn, now_ns);
      }
      // One that is not heard may hear us still: it is told zero until a stop must be over.
      const uint64_t delay_ns = NanosecondsOf(params_.disable_delay_s);
      const bool rests = IsAtRest(now_ns) && !IsFresher(now_ns, moved_ns_, delay_ns) &&
                         now_ns - power_since_ns_ >= delay_ns;
      if (rests || now_ns - power_since_ns_ > kForgotten_ns) SetPower(Power::kOff, now_ns);
      return;
  }
}

// The yaw rate is wanted of the vehicle as it drives: a steering angle is told for its measured
// speed, which the told one is ahead of. At rest an angle cannot be told from a yaw rate, so it
// stays as it was: the vehicle brakes along its way.
void TwistDrive::SetMotion(const WheelCommand& wheels) {
  const float radius_m = vehicle_.wheel_radius_m;
  const float speed_mps = 0.5f * radius_m * (wheels.left_radps + wheels.right_radps);
  const float yaw_rate_radps =
      radius_m * (wheels.right_radps - wheels.left_radps) / vehicle_.skid_baseline_m;
  command_.speed = ToInteger(speed_mps, kPerMetre);
  if (params_.turn == TwistDriveParams::kYawRate) {
    command_.turn = ToInteger(PossibleYawRate(vehicle_, speed_mps, yaw_rate_radps), kPerYawRate);
    return;
  }
  if (Abs(speed_mps) < kLeastSteeredSpeed_mps) return;
  const bool drives = Abs(report_.speed_mps) >= kDrivingSpeed_mps;
  const float driven_mps = drives ? report_.speed_mps : speed_mps;
  command_.turn =
      ToInteger(SteeringOfCurvature(vehicle_, yaw_rate_radps / driven_mps), kPerSteering);
}

void TwistDrive::Tick(uint64_t now_ns, const DriveDemand& demand, CanBatch& out) {
  if (!configured_) return;
  const bool asks_reset = demand.reset_faults && !demand.enable;
  if (asks_reset && !was_reset_asked_) {
    report_.fault = Fault::kNone;
    reset_ns_ = now_ns;
  }
  was_reset_asked_ = asks_reset;
  Watch(now_ns);
  Sequence(now_ns, demand.enable);
  const bool is_number = IsFinite(demand.wheels.left_radps) && IsFinite(demand.wheels.right_radps);
  const bool drives = power_ == Power::kOn && is_number && IsFresh(now_ns);
  SetMotion(drives ? demand.wheels : WheelCommand{});
  ++command_.counter;
  command_.enable = power_ != Power::kOff;
  command_.reset_faults = !command_.enable && IsFresher(now_ns, reset_ns_, kResetHold_ns / 10);
  command_.turn_kind =
      params_.turn == TwistDriveParams::kSteering ? TurnKind::kSteering : TurnKind::kYawRate;
  static_cast<void>(out.PushBack(Encode(static_cast<uint32_t>(params_.command_id), command_)));
}

DriveFeedback TwistDrive::State(uint64_t now_ns) const {
  DriveFeedback state;
  state.foreign_sender = IsFresher(now_ns, foreign_ns_, kForeignHold_ns);
  state.ready = IsReady(now_ns);
  state.enabled =
      power_ == Power::kOn && state.ready && report_.state == ControllerState::kFollowing;
  state.faulty = report_.fault != Fault::kNone;
  state.standstill = IsAtRest(now_ns);
  state.wheels.valid = IsFresh(now_ns);
  state.wheels.time_ns = report_.feedback_ns;
  const float common_radps = report_.speed_mps / vehicle_.wheel_radius_m;
  const float differential_radps =
      0.5f * report_.yaw_rate_radps * vehicle_.skid_baseline_m / vehicle_.wheel_radius_m;
  state.wheels.left_radps = common_radps - differential_radps;
  state.wheels.right_radps = common_radps + differential_radps;
  return state;
}

bool TwistDrive::AreOff(uint64_t now_ns) const {
  if (!IsFresher(now_ns, report_.feedback_ns, kForgotten_ns)) return true;
  return report_.state == ControllerState::kReady || report_.state == ControllerState::kFault ||
         report_.state == ControllerState::kStarting;
}

void AddToHash(const TwistDrive& drive, DecisionHash& hash) {
  const Report& report = drive.report();
  hash.AddU8(static_cast<uint8_t>(report.state));
  hash.AddU8(static_cast<uint8_t>(report.fault));
  hash.AddFloat(report.speed_mps);
  hash.AddFloat(report.yaw_rate_radps);
  const Command& command = drive.commanded();
  hash.AddU8(command.enable ? 1 : 0);
  hash.AddI32(command.speed);
  hash.AddI32(command.turn);
}

}  // namespace hardpack::twist_drive
