// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/pose.h"

namespace hardpack {

// 64-bit FNV-1a over decisions, identical on every processor: numbers are added in little-endian
// byte order, field by field, never as raw memory. -0 is hashed as +0. A float that is not finite
// is a programming error.
class DecisionHash {
 public:
  void AddU8(uint8_t value);
  void AddBool(bool value) { AddU8(value ? 1 : 0); }
  void AddU32(uint32_t value);
  void AddI32(int32_t value) { AddU32(static_cast<uint32_t>(value)); }
  void AddU64(uint64_t value);
  void AddFloat(float value);
  void AddPose(const Pose2& pose);
  uint64_t value() const { return hash_; }

 private:
  uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace hardpack
