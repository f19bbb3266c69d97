// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/sevcon_drive.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hardpack::sim {
namespace {

constexpr double kStep_s = 1.0e-3 * SevconDrive::kStep_ns / 1.0e6;
constexpr double kRpmPerRadps = 60.0 / (2.0 * std::numbers::pi);
constexpr uint64_t kMillisecond_ns = 1'000'000;
constexpr uint32_t kIdMask = 0x7ff;
constexpr int64_t kPdoInvalid = 0x80000000;
constexpr uint8_t kSynchronous = 240;  // transmission types up to this

// CiA 301 and CiA 402, error codes of EMCY.
constexpr uint16_t kUnderVoltage = 0x3220;
constexpr uint16_t kHeartbeatError = 0x8130;
constexpr uint16_t kPdoTooShort = 0x8210;
constexpr uint16_t kRpdoTimeout = 0x8250;
constexpr uint8_t kCommunicationError = 0x11;  // error register: generic, communication

uint64_t Nanoseconds(double seconds) {
  return static_cast<uint64_t>(std::llround(seconds * 1.0e9));
}

}  // namespace

const char* Name(NmtState state) {
  switch (state) {
    case NmtState::kInitialising:
      return "initialising";
    case NmtState::kStopped:
      return "stopped";
    case NmtState::kOperational:
      return "operational";
    case NmtState::kPreOperational:
      return "pre-operational";
    case NmtState::kOff:
      return "off";
  }
  return "?";
}

SevconDrive::SevconDrive(const DriveSettings& settings, uint64_t power_on_ns)
    : settings_(settings),
      objects_(Gen4Objects(settings.identity, settings.has_rpdo_event_timer)),
      power_(Nanoseconds(settings.transition_s)),
      motor_(settings.motor, kStep_s),
      now_ns_(power_on_ns),
      boot_done_ns_(power_on_ns + Nanoseconds(settings.boot_s)) {}

void SevconDrive::Advance(uint64_t now_ns, std::vector<CanFrame>& sent) {
  StepTo(now_ns);
  sent.insert(sent.end(), outbox_.begin(), outbox_.end());
  outbox_.clear();
}

void SevconDrive::StepTo(uint64_t now_ns) {
  while (now_ns_ + kStep_ns <= now_ns) Step();
}

void SevconDrive::Step() {
  now_ns_ += kStep_ns;
  if (nmt_ == NmtState::kInitialising && now_ns_ >= boot_done_ns_) FinishBoot();
  const bool on = nmt_ != NmtState::kOff && nmt_ != NmtState::kInitialising;
  if (on) {
    WatchCommands();
    WatchHeartbeats();
    const bool had_fault = power_.state() == PowerState::kFault;
    power_.Step(now_ns_, nmt_ == NmtState::kOperational, AtRest());
    if (had_fault && power_.state() != PowerState::kFault) SendEmergency({0, 0, 0});  // reset
  }
  MoveWheel();
  if (!on) return;
  Report();
  Produce();
}

void SevconDrive::FinishBoot() {
  if (boot_up_message_ && !faults_.silent) {
    constexpr uint8_t kBootUp[] = {0};
    Send(0x700u + settings_.identity.node, kBootUp);
    ++boot_ups_;
  }
  heartbeat_ns_ = now_ns_;
  EnterNmtState(NmtState::kPreOperational);
}

void SevconDrive::EnterNmtState(NmtState state) {
  if (state == NmtState::kOperational && nmt_ != NmtState::kOperational) {
    rpdo_heard_ = false;
    syncs_ = 0;
    tpdo_sent_.clear();
  }
  if (state != NmtState::kOperational) rpdo_waits_.clear();
  nmt_ = state;
  objects_.Set(0x5110, 0, static_cast<uint8_t>(state));
}

void SevconDrive::SetObject(uint16_t index, uint8_t sub_index, int64_t value) {
  made_.push_back({index, sub_index, value});
  objects_.Set(index, sub_index, value);
}

// Written values are lost: they were only in its memory.
void SevconDrive::Reboot(bool with_boot_up_message) {
  SevconDrive booted(settings_, now_ns_);
  booted.faults_ = faults_;
  booted.motor_ = motor_;
  booted.outbox_ = outbox_;
  booted.boot_up_message_ = with_boot_up_message;
  booted.boot_ups_ = boot_ups_;
  booted.emergency_ = emergency_;
  booted.emergencies_ = emergencies_;
  booted.rpdos_ = rpdos_;
  for (const MadeObject& made : made_) booted.SetObject(made.index, made.sub_index, made.value);
  *this = booted;
}

void SevconDrive::SetKey(bool on) {
  if (on && nmt_ == NmtState::kOff) Reboot(true);
  if (on || nmt_ == NmtState::kOff) return;
  RaiseFault({kUnderVoltage, 0x05, 0});
  EnterNmtState(NmtState::kOff);
}

void SevconDrive::SendEmergency(const Emergency& emergency) {
  emergency_ = emergency;
  ++emergencies_;
  objects_.Set(0x1001, 0, emergency.error_register);
  if (nmt_ != NmtState::kOperational && nmt_ != NmtState::kPreOperational) return;
  std::vector<uint8_t> bytes = ToBytes(emergency.code, 2);
  bytes.push_back(emergency.error_register);
  for (const uint8_t byte : ToBytes(emergency.fault_id, 2)) bytes.push_back(byte);
  bytes.resize(8);
  Send(static_cast<uint32_t>(objects_.Get(0x1014, 0)) & kIdMask, bytes);
}

void SevconDrive::RaiseFault(const Emergency& emergency) {
  SendEmergency(emergency);
  power_.RaiseFault();
}

// RPDO monitoring starts with the first one (CiA 301); 5902h says what follows when it ends.
void SevconDrive::WatchCommands() {
  const int64_t severity = objects_.Get(0x5902, 0);
  const int64_t event_timer_ms = objects_.Get(0x1400, 5);
  if (nmt_ != NmtState::kOperational || !rpdo_heard_) return;
  const uint64_t timeout_ns = event_timer_ms > 0
                                  ? static_cast<uint64_t>(event_timer_ms) * kMillisecond_ns
                                  : Nanoseconds(settings_.rpdo_timeout_s);
  if (severity == 0 || now_ns_ - rpdo_ns_ <= timeout_ns) return;
  rpdo_heard_ = false;
  warning_ = true;
  const Emergency emergency = {kRpdoTimeout, kCommunicationError, 0};
  if (severity == 1) {
    SendEmergency(emergency);
  } else {
    RaiseFault(emergency);
  }
}

void SevconDrive::WatchHeartbeats() {
  for (uint8_t i = 1; i < consumers_.size(); ++i) {
    const uint64_t timeout_ns =
        static_cast<uint64_t>(objects_.Get(0x1016, i) & 0xffff) * kMillisecond_ns;
    HeartbeatConsumer& consumer = consumers_[i];
    if (timeout_ns == 0 || !consumer.heard || now_ns_ - consumer.heard_ns <= timeout_ns) continue;
    consumer.heard = false;
    RaiseFault({kHeartbeatError, kCommunicationError, 0});
    // The error behaviour that CiA 301 has where 1029h does not say otherwise.
    if (nmt_ == NmtState::kOperational) EnterNmtState(NmtState::kPreOperational);
  }
}

bool SevconDrive::AtRest() const {
  constexpr double kRest_radps = 0.05;
  return std::abs(motor_.speed_radps()) < kRest_radps;
}

double SevconDrive::CommandedMotor_rpm() const {
  if (power_.state() != PowerState::kEnabled || warning_) return 0.0;
  const auto limit_rpm = static_cast<double>(objects_.Get(0x6080, 0));
  return std::clamp(static_cast<double>(objects_.Get(0x60ff, 0)), -limit_rpm, limit_rpm);
}

void SevconDrive::MoveWheel() {
  const double motor_per_wheel = settings_.gear_ratio * settings_.sign * kRpmPerRadps;
  command_radps_ = CommandedMotor_rpm() / motor_per_wheel;
  const bool on = nmt_ != NmtState::kOff && nmt_ != NmtState::kInitialising;
  turns_ = on && power_.driven();
  if (has_motor_) {
    motor_.Step(turns_, setpoint_radps());
  } else {
    motor_.Turn(turned_radps_);
  }
  if (faults_.blocked) motor_.Stop();
  if (faults_.frozen) return;
  const double rpm = motor_.speed_radps() * motor_per_wheel;
  reported_rpm_ = static_cast<int32_t>(std::lround(rpm)) + faults_.speed_offset_rpm;
}

uint16_t SevconDrive::statusword() const {
  constexpr double kReached_rpm = 20.0;
  const bool reached = std::abs(CommandedMotor_rpm() - reported_rpm_) < kReached_rpm;
  return power_.statusword(true, warning_, nmt_ == NmtState::kOperational, reached);
}

void SevconDrive::Report() {
  objects_.Set(0x6041, 0, statusword());
  objects_.Set(0x606c, 0, reported_rpm_);
  // Rolling resistance and inertia are invented: it only matters that braking feeds the battery.
  const double torque =
      power_.driven()
          ? std::clamp(0.03 * motor_.acceleration_radps2() + 0.01 * motor_.speed_radps(), -1.0, 1.0)
          : 0.0;
  objects_.Set(0x6077, 0, std::lround(1000.0 * torque * settings_.sign));
  const double battery_A = 1.0 + 10.0 * torque * motor_.speed_radps();
  const double battery_V = settings_.battery_V - 0.02 * battery_A;
  constexpr double kPerUnit = 16.0;  // 0.0625 V and A
  objects_.Set(0x5100, 1, std::lround(kPerUnit * battery_V));
  objects_.Set(0x5100, 2, std::lround(kPerUnit * battery_A));
  objects_.Set(0x5100, 3, std::lround(kPerUnit * (battery_V - 0.5)));
}

void SevconDrive::Produce() {
  const uint64_t heartbeat_ns = static_cast<uint64_t>(objects_.Get(0x1017, 0)) * kMillisecond_ns;
  if (heartbeat_ns > 0 && now_ns_ - heartbeat_ns_ >= heartbeat_ns) SendHeartbeat();
  const int64_t sync = objects_.Get(0x1005, 0);
  constexpr int64_t kProducer = 0x40000000;
  const uint64_t period_ns = static_cast<uint64_t>(objects_.Get(0x1006, 0)) * 1000;
  if ((sync & kProducer) != 0 && now_ns_ - sync_ns_ >= period_ns) {
    sync_ns_ = now_ns_;
    Send(static_cast<uint32_t>(sync) & kIdMask, {});
    TakeSync();
  }
  if (nmt_ != NmtState::kOperational || objects_.Get(0x1800, 2) <= kSynchronous) return;
  const uint64_t inhibit_ns = static_cast<uint64_t>(objects_.Get(0x1800, 3)) * 100'000;
  const uint64_t timer_ns = static_cast<uint64_t>(objects_.Get(0x1800, 5)) * kMillisecond_ns;
  const uint64_t since_ns = now_ns_ - tpdo_ns_;
  const bool event = TpdoBytes() != tpdo_sent_ && since_ns >= inhibit_ns;
  if (event || (timer_ns > 0 && since_ns >= timer_ns)) SendTpdo();
}

void SevconDrive::SendHeartbeat() {
  heartbeat_ns_ = now_ns_;
  if (faults_.no_heartbeat) return;
  const uint8_t state[] = {static_cast<uint8_t>(nmt_)};
  Send(0x700u + settings_.identity.node, state);
}

std::vector<uint8_t> SevconDrive::TpdoBytes() const {
  std::vector<uint8_t> bytes;
  for (uint8_t i = 1; i <= objects_.Get(0x1a00, 0); ++i) {
    const auto mapped = static_cast<uint32_t>(objects_.Get(0x1a00, i));
    const int64_t value =
        objects_.Get(static_cast<uint16_t>(mapped >> 16), static_cast<uint8_t>(mapped >> 8));
    for (const uint8_t byte : ToBytes(value, (mapped & 0xff) / 8)) bytes.push_back(byte);
  }
  bytes.resize(std::min<size_t>(bytes.size(), kMaxCanData_bytes));
  return bytes;
}

void SevconDrive::SendTpdo() {
  const int64_t id = objects_.Get(0x1800, 1);
  if ((id & kPdoInvalid) != 0 || faults_.no_process_data) return;
  tpdo_sent_ = TpdoBytes();
  tpdo_ns_ = now_ns_;
  Send(static_cast<uint32_t>(id) & kIdMask, tpdo_sent_);
}

void SevconDrive::Send(uint32_t id, std::span<const uint8_t> bytes) {
  if (faults_.silent || nmt_ == NmtState::kOff) return;
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data);
  outbox_.push_back(frame);
}

void SevconDrive::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  StepTo(now_ns);
  const bool hears = nmt_ != NmtState::kOff && nmt_ != NmtState::kInitialising && !faults_.silent;
  if (!hears || frame.extended || frame.remote) return;
  const uint32_t node = settings_.identity.node;
  const int64_t rpdo = objects_.Get(0x1400, 1);
  if (frame.id == 0) {
    TakeNmt(frame);
  } else if (frame.id == (static_cast<uint32_t>(objects_.Get(0x1005, 0)) & kIdMask)) {
    TakeSync();
  } else if (frame.id == 0x600 + node) {
    TakeSdo(frame);
  } else if (frame.id == (static_cast<uint32_t>(rpdo) & kIdMask) && (rpdo & kPdoInvalid) == 0) {
    TakeRpdo(frame);
  } else if (frame.id > 0x700 && frame.size == 1) {
    TakeHeartbeat(static_cast<uint8_t>(frame.id - 0x700), now_ns);
  }
}

void SevconDrive::TakeNmt(const CanFrame& frame) {
  if (frame.size != 2) return;
  if (frame.data[1] != 0 && frame.data[1] != settings_.identity.node) return;
  switch (frame.data[0]) {
    case 1:
      EnterNmtState(NmtState::kOperational);
      break;
    case 2:
      EnterNmtState(NmtState::kStopped);
      break;
    case 128:
      EnterNmtState(NmtState::kPreOperational);
      break;
    case 129:  // the application, or communication alone: both forget what was written
    case 130:
      Reboot(true);
      break;
    default:
      break;
  }
}

void SevconDrive::TakeSync() {
  if (nmt_ != NmtState::kOperational) return;
  if (!rpdo_waits_.empty()) ApplyRpdo(rpdo_waits_);
  rpdo_waits_.clear();
  const int64_t type = objects_.Get(0x1800, 2);
  ++syncs_;
  const bool due = type == 0 ? TpdoBytes() != tpdo_sent_ : type <= kSynchronous && syncs_ >= type;
  if (!due) return;
  syncs_ = 0;
  SendTpdo();
}

void SevconDrive::TakeSdo(const CanFrame& frame) {
  if (frame.size != kMaxCanData_bytes || nmt_ == NmtState::kStopped) return;
  const auto index = static_cast<uint16_t>(frame.data[1] | frame.data[2] << 8);
  if (faults_.sdo_silent.contains(index)) return;
  const auto answer = sdo_.Answer(frame.data, *this);
  if (answer) Send(0x580u + settings_.identity.node, *answer);
}

void SevconDrive::TakeRpdo(const CanFrame& frame) {
  if (nmt_ != NmtState::kOperational) return;
  int64_t mapped_bytes = 0;
  for (uint8_t i = 1; i <= objects_.Get(0x1600, 0); ++i) {
    mapped_bytes += (objects_.Get(0x1600, i) & 0xff) / 8;
  }
  if (frame.size < mapped_bytes) {
    SendEmergency({kPdoTooShort, kCommunicationError, 0});
    return;
  }
  const std::span<const uint8_t> bytes(frame.data, frame.size);
  rpdo_heard_ = true;
  rpdo_ns_ = now_ns_;
  ++rpdos_;
  if (power_.state() != PowerState::kFault) warning_ = false;
  if (objects_.Get(0x1400, 2) <= kSynchronous) {
    rpdo_waits_.assign(bytes.begin(), bytes.end());
  } else {
    ApplyRpdo(bytes);
  }
}

void SevconDrive::ApplyRpdo(std::span<const uint8_t> bytes) {
  size_t offset = 0;
  for (uint8_t i = 1; i <= objects_.Get(0x1600, 0); ++i) {
    const auto mapped = static_cast<uint32_t>(objects_.Get(0x1600, i));
    const size_t size_bytes = (mapped & 0xff) / 8;
    if (offset + size_bytes > bytes.size()) return;
    const auto index = static_cast<uint16_t>(mapped >> 16);
    objects_.Set(index, static_cast<uint8_t>(mapped >> 8),
                 FromBytes(bytes.subspan(offset, size_bytes), false));
    if (index == 0x6040) power_.SetControlword(static_cast<uint16_t>(objects_.Get(0x6040, 0)));
    offset += size_bytes;
  }
}

void SevconDrive::TakeHeartbeat(uint8_t node, uint64_t now_ns) {
  for (uint8_t i = 1; i < consumers_.size(); ++i) {
    const int64_t watched = objects_.Get(0x1016, i);
    if ((watched >> 16 & 0x7f) != node || (watched & 0xffff) == 0) continue;
    consumers_[i].heard = true;
    consumers_[i].heard_ns = now_ns;
  }
}

}  // namespace hardpack::sim
