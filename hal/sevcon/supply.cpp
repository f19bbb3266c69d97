// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/drive.h"
#include "hal/sevcon/settings.h"

// What a drive that is ready is asked for besides (5100h, scaled as in the Gen4's EDS), and what is
// told of it.

namespace hardpack::sevcon {
namespace {

// Each question waits so long after the one before; all four take a second.
constexpr uint64_t kSupplyPause_ns = 250'000'000;
constexpr float kVoltPerUnit = 0.0625f;
constexpr float kAmperePerUnit = 0.0625f;

constexpr uint8_t kBatteryVoltage = 1;
constexpr uint8_t kBatteryCurrent = 2;
constexpr uint8_t kCapacitorVoltage = 3;
constexpr uint8_t kHeatsink = 4;

}  // namespace

void Drive::AskSupply(uint64_t now_ns) {
  if (now_ns < supply_ns_) return;
  supply_ns_ = now_ns + kSupplyPause_ns;
  supply_row_ = supply_row_ % kHeatsink + 1;
  const uint8_t size = supply_row_ == kHeatsink ? 1 : 2;
  client_.Ask({kSupply, supply_row_, size, false, 0}, 0);
}

void Drive::TakeSupply() {
  const uint32_t value = client_.value();
  switch (client_.question().subindex) {
    case kBatteryVoltage:
      report_.battery_V = static_cast<float>(value) * kVoltPerUnit;
      return;
    case kBatteryCurrent:  // signed
      report_.battery_A = static_cast<float>(static_cast<int16_t>(value)) * kAmperePerUnit;
      return;
    case kCapacitorVoltage:
      report_.capacitor_V = static_cast<float>(value) * kVoltPerUnit;
      return;
    case kHeatsink: {  // one byte, signed
      const auto byte = static_cast<int32_t>(value & 0xffu);
      report_.heatsink_degC = byte < 0x80 ? byte : byte - 0x100;
      report_.has_supply = true;
      return;
    }
    default:
      return;
  }
}

// What the last question was about, and why it was refused. What a drive need not have is no news.
void Drive::ReportQuestion() {
  report_.sdo_index = client_.question().index;
  report_.sdo_subindex = client_.question().subindex;
  if (client_.abort_code() == 0) return;
  report_.sdo_abort_code = client_.abort_code();
  report_.sdo_abort_reason = client_.abort_reason();
}

void Drive::Report() {
  report_.sdo_timeouts = client_.timeouts();
  report_.sdo_aborts = client_.aborts();
  report_.sdo_ignored = client_.ignored();
  report_.settings_written = bring_up_.settings_written();
  if (bring_up_.halted()) ReportQuestion();
  report_.state = bring_up_.state();
  if (has_fault()) {
    report_.state = DriveState::kFault;
  } else if (bring_up_.done()) {
    switch (power_) {
      case Power::kOff:
        break;
      case Power::kEnabling:
        report_.state = DriveState::kEnabling;
        break;
      case Power::kOn:
        report_.state = DriveState::kEnabled;
        break;
      case Power::kStopping:
        report_.state = DriveState::kDisabling;
        break;
    }
  }
}

}  // namespace hardpack::sevcon
