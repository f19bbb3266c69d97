// SPDX-License-Identifier: Apache-2.0
#include "core/base/decision_hash.h"

#include <bit>

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack {

void DecisionHash::AddU8(uint8_t value) {
  hash_ = (hash_ ^ value) * 0x00000100000001b3u;
}

void DecisionHash::AddU32(uint32_t value) {
  HP_LOOP_BOUND(4)
  for (int byte = 0; byte < 4; ++byte) AddU8(static_cast<uint8_t>(value >> (8 * byte)));
}

void DecisionHash::AddU64(uint64_t value) {
  AddU32(static_cast<uint32_t>(value));
  AddU32(static_cast<uint32_t>(value >> 32));
}

void DecisionHash::AddFloat(float value) {
  HP_ASSERT(IsFinite(value));
  AddU32(std::bit_cast<uint32_t>(value == 0.0f ? 0.0f : value));
}

void DecisionHash::AddPose(const Pose2& pose) {
  AddFloat(pose.x_m);
  AddFloat(pose.y_m);
  AddFloat(pose.theta_rad);
}

}  // namespace hardpack
