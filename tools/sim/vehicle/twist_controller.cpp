// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/twist_controller.h"

#include <algorithm>
#include <cmath>

namespace hardpack::sim {
namespace {

constexpr double kSpeedUnit_mps = 1.0e-3;
constexpr double kStanding_mps = 0.02;
constexpr uint8_t kEnableBit = 1;
constexpr uint8_t kResetBit = 2;
constexpr uint8_t kSteeringBitOfCommand = 4;
constexpr uint8_t kSteeringBitOfFeedback = 8;
constexpr uint8_t kTimedOutBit = 16;

// CRC-8/SAE-J1850, bit by bit.
uint8_t Crc8(uint32_t id, const uint8_t* bytes, size_t count) {
  uint8_t crc = 0xff;
  const auto add = [&crc](uint8_t byte) {
    crc = static_cast<uint8_t>(crc ^ byte);
    for (int i = 0; i < 8; ++i) {
      const bool carries = (crc & 0x80u) != 0;
      crc = static_cast<uint8_t>(crc << 1u);
      if (carries) crc = static_cast<uint8_t>(crc ^ 0x1du);
    }
  };
  add(static_cast<uint8_t>(id));
  add(static_cast<uint8_t>(id >> 8u));
  for (size_t i = 0; i < count; ++i) add(bytes[i]);
  return static_cast<uint8_t>(crc ^ 0xffu);
}

int16_t Integer(const CanFrame& frame, int at) {
  return static_cast<int16_t>(
      static_cast<uint16_t>(frame.data[at] | static_cast<unsigned>(frame.data[at + 1]) << 8u));
}

void AppendInteger(std::vector<uint8_t>& bytes, double value) {
  const long whole = std::clamp(std::lround(value), -32767L, 32767L);
  const auto bits = static_cast<uint16_t>(static_cast<int16_t>(whole));
  bytes.push_back(static_cast<uint8_t>(bits));
  bytes.push_back(static_cast<uint8_t>(bits >> 8u));
}

}  // namespace

const char* Name(TwistState state) {
  constexpr const char* kNames[] = {"starting", "ready", "following", "stopping", "fault"};
  return kNames[static_cast<size_t>(state)];
}

TwistController::TwistController(const TwistControllerSettings& settings, uint64_t start_ns)
    : settings_(settings), next_feedback_ns_(start_ns), next_status_ns_(start_ns) {}

void TwistController::TakeFrame(const CanFrame& frame, uint64_t now_ns) {
  const bool is_heard = !faults_.silent && !faults_.deaf && !boots_;
  if (!is_heard || frame.extended || frame.remote || frame.id != settings_.command_id) return;
  const uint8_t bits = frame.data[1];
  const bool is_whole = frame.size == 8 && frame.data[6] == 0 && bits < 8 &&
                        frame.data[7] == Crc8(frame.id, frame.data, 7);
  const bool is_of_its_kind = ((bits & kSteeringBitOfCommand) != 0) == settings_.steers;
  if (!is_whole || !is_of_its_kind || echo_ == frame.data[0]) return;
  echo_ = frame.data[0];
  told_ns_ = now_ns;
  Told told = {(bits & kEnableBit) != 0, kSpeedUnit_mps * Integer(frame, 2),
               TurnUnit() * Integer(frame, 4)};
  // At rest a steering angle does not change.
  if (settings_.steers && told.speed_mps == 0.0 && told_) told.turn = told_->turn;
  told_ = told;
  if ((bits & kResetBit) != 0) fault_bits_ = 0;
}

void TwistController::Advance(uint64_t now_ns, std::vector<CanFrame>& sent) {
  Decide(now_ns);
  const bool speaks = !faults_.silent && state_ != TwistState::kStarting;
  if (now_ns >= next_feedback_ns_) {
    next_feedback_ns_ = now_ns + settings_.feedback_period_ns;
    if (speaks) sent.push_back(Feedback());
  }
  if (now_ns >= next_status_ns_ || said_fault_bits_ != fault_bits_) {
    next_status_ns_ = now_ns + settings_.status_period_ns;
    said_fault_bits_ = fault_bits_;
    if (speaks) sent.push_back(Status());
  }
}

void TwistController::Decide(uint64_t now_ns) {
  if (boots_) {
    boots_ = false;
    booted_ns_ = now_ns + static_cast<uint64_t>(std::llround(settings_.boot_s * 1.0e9));
    told_.reset();
    fault_bits_ = 0;
  }
  timed_out_ = !told_ || now_ns - told_ns_ > settings_.command_timeout_ns;
  const bool rests = std::abs(speed_mps_) < kStanding_mps;
  const bool wants = told_ && told_->enable && !timed_out_ && !faults_.refuses;
  if (now_ns < booted_ns_) {
    state_ = TwistState::kStarting;
  } else if (fault_bits_ != 0) {
    state_ = rests ? TwistState::kFault : TwistState::kStopping;
  } else if (wants) {
    state_ = TwistState::kFollowing;
  } else {
    state_ = rests ? TwistState::kReady : TwistState::kStopping;
  }
}

TwistController::Motion TwistController::motion() const {
  if (state_ == TwistState::kFollowing) return {true, told_->speed_mps, told_->turn};
  // It brakes along its path.
  if (state_ == TwistState::kStopping) return {true, 0.0, settings_.steers ? turn_ : 0.0};
  return {};
}

CanFrame TwistController::Ended(uint32_t id, std::vector<uint8_t> bytes) const {
  bytes.push_back(Crc8(id, bytes.data(), bytes.size()));
  if (faults_.bad_crc) bytes.back() = static_cast<uint8_t>(bytes.back() ^ 0x55u);
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data);
  return frame;
}

CanFrame TwistController::Feedback() {
  if (!faults_.frozen) {
    reported_speed_mps_ = speed_mps_;
    reported_turn_ = turn_;
  }
  const auto bits = static_cast<uint8_t>(static_cast<unsigned>(state_) |
                                         (settings_.steers ? kSteeringBitOfFeedback : 0u) |
                                         (timed_out_ ? kTimedOutBit : 0u));
  std::vector<uint8_t> bytes = {feedback_counter_++, bits};
  AppendInteger(bytes, reported_speed_mps_ / kSpeedUnit_mps);
  AppendInteger(bytes, reported_turn_ / TurnUnit());
  bytes.push_back(echo_.value_or(0));
  return Ended(settings_.feedback_id, std::move(bytes));
}

CanFrame TwistController::Status() {
  constexpr uint8_t kTemperature_degC = 31;
  std::vector<uint8_t> bytes = {status_counter_++, faults_.version,
                                static_cast<uint8_t>(fault_bits_),
                                static_cast<uint8_t>(fault_bits_ >> 8u)};
  AppendInteger(bytes, 4812.0);  // 48.12 V
  bytes.push_back(kTemperature_degC);
  return Ended(settings_.status_id, std::move(bytes));
}

}  // namespace hardpack::sim
