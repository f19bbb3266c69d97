// SPDX-License-Identifier: Apache-2.0
// The object dictionary as accessed by SDO: the manufacturer's access rules, and the effects of
// writing.
#include <algorithm>

#include "tools/sim/vehicle/sevcon_drive.h"

namespace hardpack::sim {
namespace {

// 5310h, where the abort code is the general one.
enum AbortReason : uint16_t {
  kNotPreOperational = 4,
  kCannotGoPreOperational = 6,
  kCannotGoOperational = 7,
  kAccessLevel = 8,
  kLoginFailed = 9,
  kRangeUnderflow = 10,
  kRangeOverflow = 11,
};

constexpr uint8_t kEngineering = 4;
constexpr uint32_t kPdoInvalid = 0x80000000;
constexpr char kProductName[] = "Gen4 (simulated)";

bool IsMapping(uint16_t index) {
  return index == 0x1600 || index == 0x1a00;
}

uint16_t CommunicationOf(uint16_t mapping) {
  return mapping == 0x1600 ? 0x1400 : 0x1800;
}

}  // namespace

bool SevconDrive::PdoExists(uint16_t communication) const {
  return (static_cast<uint64_t>(objects_.Get(communication, 1)) & kPdoInvalid) == 0;
}

uint32_t SevconDrive::RefuseGenerally(uint16_t reason) {
  objects_.Set(0x5310, 0, reason);
  return sdo_abort::kGeneral;
}

uint32_t SevconDrive::Read(uint16_t index, uint8_t sub_index, std::vector<uint8_t>& bytes) {
  const auto fault = faults_.sdo_aborts.find(index);
  if (fault != faults_.sdo_aborts.end()) return fault->second;
  if (index == 0x1008) {
    if (sub_index != 0) return sdo_abort::kNoSubIndex;
    bytes.assign(kProductName, kProductName + sizeof(kProductName) - 1);
    return sdo_abort::kNone;
  }
  if (!objects_.HasIndex(index)) return sdo_abort::kNoObject;
  const ObjectEntry* entry = objects_.Find(index, sub_index);
  if (entry == nullptr) return sdo_abort::kNoSubIndex;
  if (!entry->readable) return sdo_abort::kWriteOnly;
  bytes = ToBytes(entry->value, entry->size_bytes);
  return sdo_abort::kNone;
}

uint32_t SevconDrive::CheckWrite(const ObjectEntry& entry, size_t bytes, int64_t value,
                                 bool sized) {
  if (!entry.writable) return sdo_abort::kReadOnly;
  if (sized ? bytes != entry.size_bytes : bytes < entry.size_bytes) return sdo_abort::kLength;
  if (entry.in_pre_operational_only && nmt_ != NmtState::kPreOperational) {
    return RefuseGenerally(kNotPreOperational);
  }
  if (objects_.Get(0x5000, 1) < entry.write_level) return RefuseGenerally(kAccessLevel);
  if (value < entry.low) return RefuseGenerally(kRangeUnderflow);
  if (value > entry.high) return RefuseGenerally(kRangeOverflow);
  return IsMapping(entry.index) ? CheckMapping(entry.index, entry.sub_index, value)
                                : sdo_abort::kNone;
}

// CiA 301: a mapping is changed while its PDO does not exist and it maps nothing.
uint32_t SevconDrive::CheckMapping(uint16_t index, uint8_t sub_index, int64_t value) const {
  if (PdoExists(CommunicationOf(index))) return sdo_abort::kDeviceState;
  if (sub_index != 0) {
    return objects_.Get(index, 0) == 0 ? sdo_abort::kNone : sdo_abort::kDeviceState;
  }
  int64_t bits = 0;
  for (uint8_t i = 1; i <= value; ++i) {
    const auto mapped = static_cast<uint32_t>(objects_.Get(index, i));
    const ObjectEntry* entry =
        objects_.Find(static_cast<uint16_t>(mapped >> 16), static_cast<uint8_t>(mapped >> 8));
    const uint32_t size_bits = mapped & 0xffu;
    if (entry == nullptr || !entry->mappable || size_bits != 8u * entry->size_bytes) {
      return sdo_abort::kNotMappable;
    }
    bits += size_bits;
  }
  return bits <= 64 ? sdo_abort::kNone : sdo_abort::kPdoTooLong;
}

uint32_t SevconDrive::Write(uint16_t index, uint8_t sub_index, std::span<const uint8_t> bytes,
                            bool sized) {
  const auto fault = faults_.sdo_aborts.find(index);
  if (fault != faults_.sdo_aborts.end()) return fault->second;
  if (index == 0x1008) return sub_index == 0 ? sdo_abort::kReadOnly : sdo_abort::kNoSubIndex;
  if (!objects_.HasIndex(index)) return sdo_abort::kNoObject;
  const ObjectEntry* entry = objects_.Find(index, sub_index);
  if (entry == nullptr) return sdo_abort::kNoSubIndex;
  const size_t size_bytes =
      sized ? bytes.size() : std::min<size_t>(bytes.size(), entry->size_bytes);
  const int64_t value = FromBytes(bytes.first(size_bytes), entry->is_signed);
  uint32_t code = CheckWrite(*entry, bytes.size(), value, sized);
  if (code == sdo_abort::kNone) code = WriteMaker(index, sub_index, value);
  if (code != sdo_abort::kNone || faults_.sdo_kept.contains(index)) return code;
  objects_.Set(index, sub_index, value);
  UseWritten(index, sub_index);
  return sdo_abort::kNone;
}

// The manufacturer's objects that are commands.
uint32_t SevconDrive::WriteMaker(uint16_t index, uint8_t sub_index, int64_t value) {
  if (index == 0x5000 && sub_index == 2) {
    const bool right =
        value == settings_.login_password && objects_.Get(0x5000, 3) == settings_.login_user;
    objects_.Set(0x5000, 1, right ? kEngineering : 0);
    return right ? sdo_abort::kNone : RefuseGenerally(kLoginFailed);
  }
  if (index == 0x2800) {
    if (value != 0 && !AtRest()) return RefuseGenerally(kCannotGoPreOperational);
    if (value == 0 && nmt_ == NmtState::kStopped) return RefuseGenerally(kCannotGoOperational);
    EnterNmtState(value != 0 ? NmtState::kPreOperational : NmtState::kOperational);
  }
  return sdo_abort::kNone;
}

void SevconDrive::UseWritten(uint16_t index, uint8_t sub_index) {
  if (index == 0x6040) power_.SetControlword(static_cast<uint16_t>(objects_.Get(0x6040, 0)));
  if (index == 0x6060 && !faults_.mode_refused) objects_.Set(0x6061, 0, objects_.Get(0x6060, 0));
  if (index == 0x1016) consumers_[sub_index] = {};
  if (index == 0x1017) heartbeat_ns_ = now_ns_;
  if (index == 0x1400) rpdo_heard_ = false;
}

}  // namespace hardpack::sim
