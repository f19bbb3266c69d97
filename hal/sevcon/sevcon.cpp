// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/sevcon.h"

#include "config/conflicts.h"
#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/validate.h"
#include "hal/sevcon/bus_load.h"
#include "hal/sevcon/canopen.h"
#include "hal/sevcon/durations.h"
#include "hal/sevcon/power_states.h"

namespace hardpack::sevcon {
namespace {

constexpr int kLeftIndex = static_cast<int>(Side::kLeft);
constexpr int kRightIndex = static_cast<int>(Side::kRight);

bool IsSign(int32_t sign) {
  return sign == 1 || sign == -1;
}

bool FitTogether(const DriveParams& params) {
  bool fits = IsSign(params.left_sign) && IsSign(params.right_sign);
  ForEachConflict(params, [&fits](const ParameterConflict&) { fits = false; });
  return fits;
}

}  // namespace

// Not *this = DrivePair{}: that takes one more on the stack.
void DrivePair::Forget() {
  params_ = DriveParams{};
  configured_ = was_foreign_heard_ = was_reset_asked_ = false;
  now_ns_ = foreign_ns_ = 0;
  HP_LOOP_BOUND(kSides)
  for (Drive& drive : drives_) drive.Configure(0, 1);
  commanded_ = WheelCommand{};
  command_beat_ = sync_beat_ = heartbeat_beat_ = Beat{};
  bus_load_percent_ = 0;
  counters_ = PairCounters{};
}

Status DrivePair::Configure(const DriveParams& params) {
  Forget();
  if (FirstInvalidParameter(params) != nullptr) return Status::kParameterOutOfRange;
  if (!FitTogether(params)) return Status::kInvalidArgument;
  const int32_t load_percent = BusLoad_percent(params);
  if (load_percent > params.max_bus_load_percent) return Status::kCapacityExceeded;
  params_ = params;
  bus_load_percent_ = load_percent;
  drives_[kLeftIndex].Configure(params.left_node, params.left_sign);
  drives_[kRightIndex].Configure(params.right_node, params.right_sign);
  configured_ = true;
  return Status::kOk;
}

DrivePair::Sender DrivePair::SenderOf(uint32_t id, int& side) const {
  if (id == kNmtId || id == IdOf(kHeartbeatBase, params_.master_node)) return Sender::kUs;
  // A drive may have been made to send SYNC itself (1005h) until the bring-up has written
  // otherwise.
  if (id == kSyncId && params_.sync_period_ms > 0) return ready() ? Sender::kUs : Sender::kOther;
  HP_LOOP_BOUND(kSides)
  for (side = 0; side < kSides; ++side) {
    const int32_t node = drives_[side].node();
    if (id == IdOf(kCommandBase, node) || id == IdOf(kSdoQuestionBase, node)) return Sender::kUs;
    if (id == IdOf(kFeedbackBase, node) || id == IdOf(kHeartbeatBase, node) ||
        id == IdOf(kSdoAnswerBase, node) || id == IdOf(kEmergencyBase, node)) {
      return Sender::kDrive;
    }
  }
  return Sender::kOther;
}

// Whether the frame came so long ago that it says nothing of now. That a drive has stopped,
// restarted or found a fault stays true.
bool DrivePair::IsPast(const Drive& drive, const CanFrame& frame, uint64_t came_ns) const {
  if (now_ns_ - came_ns <= Milliseconds(params_.max_frame_age_ms)) return false;
  const uint32_t base = frame.id - static_cast<uint32_t>(drive.node());
  const bool is_operational =
      frame.size == 1 && frame.data[0] == static_cast<uint8_t>(NmtState::kOperational);
  return base == kFeedbackBase || base == kSdoAnswerBase ||
         (base == kHeartbeatBase && is_operational);
}

bool DrivePair::TakeFromDrive(Drive& drive, const CanFrame& frame, uint64_t came_ns) {
  if (frame.remote) return false;
  const uint32_t base = frame.id - static_cast<uint32_t>(drive.node());
  switch (base) {
    case kFeedbackBase:
      return drive.TakeFeedback(frame, came_ns, params_);
    case kHeartbeatBase:
      return drive.TakeHeartbeat(frame, came_ns);
    case kSdoAnswerBase:
      return drive.TakeSdo(frame);
    default:
      return drive.TakeEmergency(frame);
  }
}

void DrivePair::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  if (!configured_) return;
  now_ns_ = now_ns;  // what is asked between the frames of a tick and its end is asked of now
  if (!IsValid(frame)) {
    ++counters_.frames_malformed;
    return;
  }
  const bool is_timed = frame.received_ns != 0 && frame.received_ns < now_ns;
  const uint64_t came_ns = is_timed ? frame.received_ns : now_ns;
  int side = 0;
  const Sender sender = frame.extended ? Sender::kOther : SenderOf(frame.id, side);
  if (sender == Sender::kOther) {
    ++counters_.frames_ignored;
  } else if (sender == Sender::kDrive) {
    if (IsPast(drives_[side], frame, came_ns)) {
      ++counters_.frames_old;
      return;
    }
    const bool taken = TakeFromDrive(drives_[side], frame, came_ns);
    ++(taken ? counters_.frames_taken : counters_.frames_malformed);
  } else {
    ++counters_.foreign_frames;
    was_foreign_heard_ = true;
    foreign_ns_ = now_ns;
    drives_[kLeftIndex].SetFault(DriveFault::kForeignSender);
    drives_[kRightIndex].SetFault(DriveFault::kForeignSender);
  }
}

bool DrivePair::has_fault() const {
  return drives_[kLeftIndex].has_fault() || drives_[kRightIndex].has_fault();
}

// Whether a drive that reports at all reports standstill.
bool DrivePair::RestOf(const Drive& drive) const {
  return !drive.IsFresh(now_ns_, params_) ||
         Abs(drive.report().wheel_radps) <= params_.standstill_radps;
}

// Whether the turning tyres hold a wheel back from its command, which is to turn against the way
// that the pair is to drive: the other side pulls that way and is faster, and the wheel is no
// faster than both together are to be. A wheel that its own motor drives the wrong way turns as
// fast as it is told, and then as a rule beyond that.
bool DrivePair::IsCarried(int side) const {
  const Drive& wheel = drives_[side];
  const Drive& other = drives_[kLeftIndex + kRightIndex - side];
  if (!other.IsFresh(now_ns_, params_)) return false;
  const float direction = wheel.report().wheel_radps > 0.0f ? 1.0f : -1.0f;
  const float speed_radps = direction * wheel.report().wheel_radps;
  const float told_radps = direction * wheel.WheelSpeed(wheel.sent_rpm(), params_);
  const float other_told_radps = direction * other.WheelSpeed(other.sent_rpm(), params_);
  const float both_radps = 0.5f * (told_radps + other_told_radps);
  return both_radps > 0.0f && direction * other.report().wheel_radps > speed_radps &&
         speed_radps <= both_radps + params_.opposite_speed_radps;
}

void DrivePair::Sequence(const DriveDemand& demand) {
  const bool reset = demand.reset_faults && !was_reset_asked_ && !demand.enable;
  was_reset_asked_ = demand.reset_faults;
  HP_LOOP_BOUND(kSides)
  for (int side = 0; side < kSides; ++side) {
    if (reset) drives_[side].ResetFault(now_ns_, params_);
    drives_[side].Watch(now_ns_, params_, IsCarried(side));
  }
  const bool wish = demand.enable && drives_[kLeftIndex].ready() && drives_[kRightIndex].ready();
  const bool rest = RestOf(drives_[kLeftIndex]) && RestOf(drives_[kRightIndex]);
  HP_LOOP_BOUND(kSides)
  for (Drive& drive : drives_) drive.Sequence(now_ns_, params_, wish, rest);
  // One that could not be enabled takes the other with it.
  if (wish && has_fault()) {
    HP_LOOP_BOUND(kSides)
    for (Drive& drive : drives_) drive.Sequence(now_ns_, params_, false, rest);
  }
}

bool DrivePair::Beat::IsDue(uint64_t now_ns, int32_t period_ms) {
  // The ticks' times jitter: half a tick early is in time, and the average rate is kept.
  constexpr uint64_t kEarly_ns = 4'000'000;
  if (now_ns + kEarly_ns < next_ns) return false;
  const uint64_t period_ns = Milliseconds(period_ms);
  next_ns += period_ns;
  if (next_ns <= now_ns || next_ns > now_ns + period_ns + kEarly_ns) next_ns = now_ns + period_ns;
  return true;
}

void DrivePair::SendCommands(const DriveDemand& demand, CanBatch& out) {
  int32_t speed_rpm[kSides] = {0, 0};
  // Drives that are not to be enabled are not since Sequence.
  const bool follow = enabled() && !foreign_sender() && IsFinite(demand.wheels.left_radps) &&
                      IsFinite(demand.wheels.right_radps);
  if (follow) {
    speed_rpm[kLeftIndex] = drives_[kLeftIndex].MotorSpeed(demand.wheels.left_radps, params_);
    speed_rpm[kRightIndex] = drives_[kRightIndex].MotorSpeed(demand.wheels.right_radps, params_);
  }
  bool now = command_beat_.IsDue(now_ns_, params_.command_period_ms);
  HP_LOOP_BOUND(kSides)
  for (int side = 0; side < kSides; ++side) {
    Drive& drive = drives_[side];
    // Faults and stops do not wait.
    if (drive.TakeNewFault() || (drive.sent_rpm() != 0 && speed_rpm[side] == 0)) now = true;
  }
  if (!now) return;
  HP_LOOP_BOUND(kSides)
  for (int side = 0; side < kSides; ++side) {
    drives_[side].Command(params_, speed_rpm[side], out);
  }
  commanded_.left_radps = drives_[kLeftIndex].WheelSpeed(speed_rpm[kLeftIndex], params_);
  commanded_.right_radps = drives_[kRightIndex].WheelSpeed(speed_rpm[kRightIndex], params_);
}

void DrivePair::SendPeriodic(CanBatch& out) {
  if (params_.sync_period_ms > 0 && sync_beat_.IsDue(now_ns_, params_.sync_period_ms)) {
    Push(out, SyncFrame());
    HP_LOOP_BOUND(kSides)
    for (Drive& drive : drives_) drive.EndSyncPeriod();
  }
  if (heartbeat_beat_.IsDue(now_ns_, params_.heartbeat_period_ms)) {
    Push(out, HeartbeatFrame(params_.master_node, NmtState::kOperational));
  }
}

void DrivePair::Tick(uint64_t now_ns, const DriveDemand& demand, CanBatch& out) {
  if (!configured_) return;
  HP_ASSERT(CanBatch::capacity() - out.size() >= kMaxFramesPerTick);
  now_ns_ = now_ns;
  Sequence(demand);
  SendCommands(demand, out);
  SendPeriodic(out);
  HP_LOOP_BOUND(kSides)
  for (Drive& drive : drives_) drive.Ask(now_ns_, params_, out);
}

bool DrivePair::ready() const {
  return drives_[kLeftIndex].ready() && drives_[kRightIndex].ready();
}

bool DrivePair::enabled() const {
  return drives_[kLeftIndex].follows(now_ns_, params_) &&
         drives_[kRightIndex].follows(now_ns_, params_);
}

bool DrivePair::standstill() const {
  return drives_[kLeftIndex].IsFresh(now_ns_, params_) &&
         drives_[kRightIndex].IsFresh(now_ns_, params_) && RestOf(drives_[kLeftIndex]) &&
         RestOf(drives_[kRightIndex]);
}

Status DrivePair::health() const {
  bool wrong = foreign_sender();
  bool faulty = false;
  bool silent = !configured_;
  HP_LOOP_BOUND(kSides)
  for (const Drive& drive : drives_) {
    const DriveReport& report = drive.report();
    switch (report.fault) {
      case DriveFault::kNone:
        silent = silent || report.state == DriveState::kSilent;
        break;
      case DriveFault::kSilent:
        silent = true;
        break;
      case DriveFault::kWrongIdentity:
      case DriveFault::kWrongMapping:
      case DriveFault::kForeignSender:
        wrong = true;
        break;
      default:
        faulty = true;
    }
  }
  if (wrong) return Status::kWrongDevice;
  if (faulty) return Status::kDeviceFault;
  return silent ? Status::kTimedOut : Status::kOk;
}

bool DrivePair::foreign_sender() const {
  return was_foreign_heard_ && now_ns_ - foreign_ns_ < kForeignHold_ns;
}

bool DrivePair::AreOff(uint64_t now_ns) const {
  constexpr uint64_t kForgotten_ns = 5'000'000'000;  // longer than a stop takes
  HP_LOOP_BOUND(kSides)
  for (const Drive& drive : drives_) {
    const DriveReport& report = drive.report();
    const bool was_heard =
        report.wheel_time_ns != 0 && now_ns - report.wheel_time_ns < kForgotten_ns;
    if (was_heard && PowerStateOf(report.statusword) == PowerState::kOperationEnabled) return false;
  }
  return true;
}

const DriveReport& DrivePair::report(Side side) const {
  return drives_[static_cast<int>(side)].report();
}

WheelFeedback DrivePair::feedback(uint64_t now_ns) const {
  const DriveReport& left = drives_[kLeftIndex].report();
  const DriveReport& right = drives_[kRightIndex].report();
  WheelFeedback feedback;
  feedback.valid = configured_ && drives_[kLeftIndex].IsFresh(now_ns, params_) &&
                   drives_[kRightIndex].IsFresh(now_ns, params_);
  feedback.time_ns =
      left.wheel_time_ns < right.wheel_time_ns ? left.wheel_time_ns : right.wheel_time_ns;
  feedback.left_radps = left.wheel_radps;
  feedback.right_radps = right.wheel_radps;
  return feedback;
}

DriveFeedback DrivePair::State(uint64_t now_ns) const {
  return {.wheels = feedback(now_ns),
          .ready = ready(),
          .enabled = enabled(),
          .faulty = !IsUsable(health()) && !ready(),
          .standstill = standstill(),
          .foreign_sender = foreign_sender()};
}

WheelCommand DrivePair::commanded() const {
  return commanded_;
}

const PairCounters& DrivePair::counters() const {
  return counters_;
}

int32_t DrivePair::bus_load_percent() const {
  return bus_load_percent_;
}

void AddToHash(const DrivePair& pair, DecisionHash& hash) {
  HP_LOOP_BOUND(kSides)
  for (int side = 0; side < kSides; ++side) {
    const DriveReport& report = pair.report(static_cast<Side>(side));
    hash.AddU8(static_cast<uint8_t>(report.state));
    hash.AddU8(static_cast<uint8_t>(report.fault));
    hash.AddU8(report.nmt_state);
    hash.AddU32(report.statusword);
  }
  const WheelCommand commanded = pair.commanded();
  hash.AddFloat(commanded.left_radps);
  hash.AddFloat(commanded.right_radps);
  hash.AddU8(static_cast<uint8_t>(pair.foreign_sender()));
}

}  // namespace hardpack::sevcon
