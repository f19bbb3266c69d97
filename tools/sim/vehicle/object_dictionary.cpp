// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/object_dictionary.h"

namespace hardpack::sim {
namespace {

uint32_t Key(uint16_t index, uint8_t sub_index) {
  return uint32_t{index} << 8 | sub_index;
}

constexpr int64_t kMaxU8 = 0xff;
constexpr int64_t kMaxU16 = 0xffff;
constexpr int64_t kMaxU32 = 0xffffffff;
constexpr uint8_t kEngineering = 4;  // level of access

ObjectEntry ReadOnly(uint16_t index, uint8_t sub_index, uint8_t size_bytes, int64_t value) {
  ObjectEntry entry;
  entry.index = index;
  entry.sub_index = sub_index;
  entry.size_bytes = size_bytes;
  entry.value = value;
  return entry;
}

ObjectEntry Setting(uint16_t index, uint8_t sub_index, uint8_t size_bytes, int64_t low,
                    int64_t high, int64_t value) {
  ObjectEntry entry = ReadOnly(index, sub_index, size_bytes, value);
  entry.writable = true;
  entry.write_level = kEngineering;
  entry.low = low;
  entry.high = high;
  return entry;
}

ObjectEntry ForAll(ObjectEntry entry) {
  entry.write_level = 0;
  return entry;
}

ObjectEntry Signed(ObjectEntry entry) {
  entry.is_signed = true;
  return entry;
}

ObjectEntry Mappable(ObjectEntry entry) {
  entry.mappable = true;
  return entry;
}

ObjectEntry PreOperational(ObjectEntry entry) {
  entry.in_pre_operational_only = true;
  return entry;
}

void AddCommunication(const Gen4Identity& identity, ObjectDictionary& objects) {
  objects.Add(ReadOnly(0x1000, 0, 4, 0xffff0192));  // a drive (CiA 402)
  objects.Add(ReadOnly(0x1001, 0, 1, 0));
  objects.Add(PreOperational(Setting(0x1005, 0, 4, 0, 0x5fffffff, 0x80)));
  objects.Add(Setting(0x1006, 0, 4, 0x2711, 0x01f3fc18, 100'000));
  objects.Add(PreOperational(Setting(0x1014, 0, 4, 0, 0x1fffffff, 0x80 + identity.node)));
  constexpr uint8_t kConsumers = 7;
  objects.Add(ReadOnly(0x1016, 0, 1, kConsumers));
  for (uint8_t i = 1; i <= kConsumers; ++i) objects.Add(Setting(0x1016, i, 4, 0, kMaxU32, 0));
  objects.Add(Setting(0x1017, 0, 2, 0, kMaxU16, 500));
  objects.Add(ReadOnly(0x1018, 0, 1, 4));
  objects.Add(ReadOnly(0x1018, 1, 4, identity.vendor_id));
  objects.Add(ReadOnly(0x1018, 2, 4, identity.product_code));
  objects.Add(ReadOnly(0x1018, 3, 4, identity.revision));
  objects.Add(ReadOnly(0x1018, 4, 4, identity.serial_number));
}

void AddMapping(uint16_t index, const std::vector<uint32_t>& mapped, ObjectDictionary& objects) {
  constexpr uint8_t kMaxMapped = 8;
  objects.Add(Setting(index, 0, 1, 0, kMaxMapped, static_cast<int64_t>(mapped.size())));
  for (uint8_t i = 1; i <= kMaxMapped; ++i) {
    const int64_t value = i <= mapped.size() ? int64_t{mapped[i - 1u]} : 0;
    objects.Add(Setting(index, i, 4, 0, kMaxU32, value));
  }
}

void AddProcessData(uint8_t node, bool has_rpdo_event_timer, ObjectDictionary& objects) {
  objects.Add(ReadOnly(0x1400, 0, 1, has_rpdo_event_timer ? 5 : 2));
  objects.Add(Setting(0x1400, 1, 4, 1, 0x9fffffff, 0x200 + node));
  objects.Add(Setting(0x1400, 2, 1, 0, kMaxU8, 255));
  if (has_rpdo_event_timer) objects.Add(Setting(0x1400, 5, 2, 0, kMaxU16, 0));
  AddMapping(0x1600, {0x60400010, 0x60ff0020, 0x60720010}, objects);
  objects.Add(ReadOnly(0x1800, 0, 1, 5));
  objects.Add(Setting(0x1800, 1, 4, 1, 0x9fffffff, 0x180 + node));
  objects.Add(Setting(0x1800, 2, 1, 0, kMaxU8, 1));
  objects.Add(Setting(0x1800, 3, 2, 0, kMaxU16, 0));
  objects.Add(Setting(0x1800, 5, 2, 0, kMaxU16, 0));
  AddMapping(0x1a00, {0x60410010, 0x606c0020, 0x60770010}, objects);
}

void AddMaker(const Gen4Identity& identity, ObjectDictionary& objects) {
  objects.Add(Setting(0x2800, 0, 1, 0, 1, 0));
  objects.Add(ReadOnly(0x5000, 0, 1, 3));
  objects.Add(ReadOnly(0x5000, 1, 1, 0));
  ObjectEntry password = ForAll(Setting(0x5000, 2, 2, 0, kMaxU16, 0));
  password.readable = false;
  objects.Add(password);
  objects.Add(ForAll(Setting(0x5000, 3, 2, 0, kMaxU16, 0)));
  objects.Add(ReadOnly(0x5100, 0, 1, 4));
  objects.Add(Mappable(ReadOnly(0x5100, 1, 2, 0)));
  objects.Add(Mappable(Signed(ReadOnly(0x5100, 2, 2, 0))));
  objects.Add(Mappable(ReadOnly(0x5100, 3, 2, 0)));
  objects.Add(Mappable(Signed(ReadOnly(0x5100, 4, 1, 25))));
  objects.Add(ReadOnly(0x5110, 0, 1, 0));
  objects.Add(ReadOnly(0x5310, 0, 2, 0));
  objects.Add(ReadOnly(0x5900, 0, 1, 2));
  objects.Add(PreOperational(Setting(0x5900, 1, 1, 1, 127, identity.node)));
  objects.Add(PreOperational(Setting(0x5900, 2, 2, 0, 6, 0)));
  objects.Add(PreOperational(Setting(0x5902, 0, 1, 0, 3, 0)));
}

void AddDrive(ObjectDictionary& objects) {
  constexpr int64_t kMaxSpeed_rpm = 20'000;
  objects.Add(Mappable(ForAll(Setting(0x6040, 0, 2, 0, kMaxU16, 0))));
  objects.Add(Mappable(ReadOnly(0x6041, 0, 2, 0)));
  objects.Add(PreOperational(Signed(Setting(0x6060, 0, 1, 3, 4, 4))));
  objects.Add(Signed(ReadOnly(0x6061, 0, 1, 4)));
  objects.Add(Mappable(Signed(ReadOnly(0x606c, 0, 4, 0))));
  objects.Add(Mappable(Setting(0x6072, 0, 2, 0, 1000, 1000)));
  objects.Add(Mappable(Signed(ReadOnly(0x6077, 0, 2, 0))));
  objects.Add(Mappable(Setting(0x6080, 0, 4, 0, kMaxSpeed_rpm, 2500)));
  objects.Add(Setting(0x6083, 0, 4, 0, 0x7fff, 0x7fff));
  objects.Add(Mappable(Signed(ForAll(Setting(0x60ff, 0, 4, -kMaxSpeed_rpm, kMaxSpeed_rpm, 0)))));
}

}  // namespace

void ObjectDictionary::Add(const ObjectEntry& entry) {
  entries_[Key(entry.index, entry.sub_index)] = entry;
}

bool ObjectDictionary::HasIndex(uint16_t index) const {
  const auto next = entries_.lower_bound(Key(index, 0));
  return next != entries_.end() && next->second.index == index;
}

const ObjectEntry* ObjectDictionary::Find(uint16_t index, uint8_t sub_index) const {
  const auto found = entries_.find(Key(index, sub_index));
  return found == entries_.end() ? nullptr : &found->second;
}

int64_t ObjectDictionary::Get(uint16_t index, uint8_t sub_index) const {
  const ObjectEntry* entry = Find(index, sub_index);
  return entry == nullptr ? 0 : entry->value;
}

void ObjectDictionary::Set(uint16_t index, uint8_t sub_index, int64_t value) {
  const auto found = entries_.find(Key(index, sub_index));
  if (found == entries_.end()) return;
  ObjectEntry& entry = found->second;
  entry.value = FromBytes(ToBytes(value, entry.size_bytes), entry.is_signed);
}

std::vector<uint8_t> ToBytes(int64_t value, int size_bytes) {
  std::vector<uint8_t> bytes;
  for (int i = 0; i < size_bytes; ++i) {
    bytes.push_back(static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
  }
  return bytes;
}

int64_t FromBytes(std::span<const uint8_t> bytes, bool is_signed) {
  uint64_t value = 0;
  for (size_t i = 0; i < bytes.size(); ++i) value |= uint64_t{bytes[i]} << (8 * i);
  const bool negative = is_signed && !bytes.empty() && (bytes.back() & 0x80u) != 0;
  if (negative && bytes.size() < 8) value |= ~uint64_t{0} << (8 * bytes.size());
  return static_cast<int64_t>(value);
}

ObjectDictionary Gen4Objects(const Gen4Identity& identity, bool has_rpdo_event_timer) {
  ObjectDictionary objects;
  AddCommunication(identity, objects);
  AddProcessData(identity.node, has_rpdo_event_timer, objects);
  AddMaker(identity, objects);
  AddDrive(objects);
  return objects;
}

}  // namespace hardpack::sim
