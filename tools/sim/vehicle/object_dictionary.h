// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

// The object dictionary of a CANopen device (CiA 301): numbers of 1, 2 or 4 bytes under an index
// and a sub-index, with the access rules that the manufacturer states for each.

namespace hardpack::sim {

struct ObjectEntry {
  uint16_t index = 0;
  uint8_t sub_index = 0;
  uint8_t size_bytes = 1;  // 1, 2 or 4
  bool is_signed = false;
  bool readable = true;
  bool writable = false;
  bool in_pre_operational_only = false;  // for writing
  uint8_t write_level = 0;               // access level needed for writing
  bool mappable = false;                 // into process data
  int64_t low = 0;                       // limits for writing
  int64_t high = 0;
  int64_t value = 0;
};

class ObjectDictionary {
 public:
  // Replaces an existing entry.
  void Add(const ObjectEntry& entry);

  bool HasIndex(uint16_t index) const;
  const ObjectEntry* Find(uint16_t index, uint8_t sub_index) const;  // nullptr: none

  // 0 if there is no such object.
  int64_t Get(uint16_t index, uint8_t sub_index) const;
  // Ignores access rules; does nothing if there is no such object.
  void Set(uint16_t index, uint8_t sub_index, int64_t value);

 private:
  std::map<uint32_t, ObjectEntry> entries_;
};

// Little-endian, two's complement.
std::vector<uint8_t> ToBytes(int64_t value, int size_bytes);
int64_t FromBytes(std::span<const uint8_t> bytes, bool is_signed);

// The objects of a Sevcon Gen4 that a vehicle's computer uses: sizes, access, ranges and
// defaults as in the published EDS (REFERENCES.md), the process data of docs/vehicle.md, each PDO
// enabled. The EDS has no event timer (1400h:5) for an RPDO; CiA 301 has.
struct Gen4Identity {
  uint8_t node = 2;
  uint32_t vendor_id = 0x1e;
  uint32_t product_code = 0x07055037;
  uint32_t revision = 0x00010026;
  uint32_t serial_number = 1;
};
ObjectDictionary Gen4Objects(const Gen4Identity& identity, bool has_rpdo_event_timer);

}  // namespace hardpack::sim
