// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <type_traits>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"
#include "hal/onboard/control/status_table.h"

// Messages of every kind for the tests of the codec.

namespace hardpack::control {

using Bytes = std::vector<uint8_t>;

template <typename Message>
Status TryEncode(const Message& message, Bytes& bytes) {
  bytes.assign(kMaxMessageBytes, 0xa5);
  int size_bytes = -1;
  const Status status = Encode(message, bytes, size_bytes);
  bytes.resize(static_cast<size_t>(size_bytes));
  return status;
}

inline Status TryEncode(const StatusReport& report, uint32_t sequence, Bytes& bytes) {
  bytes.assign(kMaxMessageBytes, 0xa5);
  int size_bytes = -1;
  const Status status = Encode(report, sequence, bytes, size_bytes);
  bytes.resize(static_cast<size_t>(size_bytes));
  return status;
}

inline float RandomWithin(std::mt19937& random, float limit) {
  switch (random() % 6) {
    case 0:
      return limit;
    case 1:
      return -limit;
    case 2:
      return -0.0f;
    default:
      return std::uniform_real_distribution<float>(-limit, limit)(random);
  }
}

inline int64_t RandomWithin(std::mt19937& random, int64_t limit) {
  if (random() % 6 == 0) return random() % 2 == 0 ? limit : -limit;
  return std::uniform_int_distribution<int64_t>(-limit, limit)(random);
}

inline void SetRandomArea(std::mt19937& random, OperatorCommand& command) {
  command.area_count = 1 + static_cast<int32_t>(random() % kMaxAreas);
  command.area_index = static_cast<int32_t>(random() % static_cast<uint32_t>(command.area_count));
  Area& area = command.area;
  area.kind = static_cast<AreaKind>(random() % kAreaKinds);
  area.frame = static_cast<AreaFrame>(random() % kAreaFrames);
  area.speed_mps = RandomWithin(random, 20.0f);
  area.corners =
      kMinAreaCorners + static_cast<int32_t>(random() % (kMaxAreaCorners - kMinAreaCorners + 1));
  for (int i = 0; i < area.corners; ++i) {
    AreaCorner& corner = area.corner[i];
    if (area.frame == AreaFrame::kEarth) {
      corner.latitude_ndeg = RandomWithin(random, kMaxLatitude_ndeg);
      corner.longitude_ndeg = RandomWithin(random, kMaxLongitude_ndeg);
    } else {
      corner.x_mm = static_cast<int32_t>(RandomWithin(random, int64_t{kMaxAreaPosition_mm}));
      corner.y_mm = static_cast<int32_t>(RandomWithin(random, int64_t{kMaxAreaPosition_mm}));
    }
  }
}

inline OperatorCommand RandomCommand(std::mt19937& random) {
  OperatorCommand command;
  command.kind = static_cast<Kind>(1 + random() % 11);
  command.sequence = static_cast<uint32_t>(random());
  if (command.kind == Kind::kArea) SetRandomArea(random, command);
  if (command.kind != Kind::kGoal) return command;
  command.waypoints = 1 + static_cast<int32_t>(random() % kMaxWaypoints);
  for (int i = 0; i < command.waypoints; ++i) {
    Waypoint& waypoint = command.waypoint[i];
    waypoint.frame = static_cast<GoalFrame>(random() % 3);
    if (waypoint.frame == GoalFrame::kGeodetic) {
      waypoint.latitude_ndeg = RandomWithin(random, kMaxLatitude_ndeg);
      waypoint.longitude_ndeg = RandomWithin(random, kMaxLongitude_ndeg);
    } else {
      waypoint.position_m = {RandomWithin(random, kMaxPosition_m),
                             RandomWithin(random, kMaxPosition_m)};
    }
    waypoint.stops = random() % 2 == 0;
    const bool may_hold = waypoint.stops && i + 1 < command.waypoints;
    waypoint.hold_s = may_hold ? static_cast<uint8_t>(random() % 256) : uint8_t{0};
    waypoint.speed_dmps = static_cast<uint8_t>(random() % 256);
  }
  command.has_heading = random() % 2 == 0;
  if (command.has_heading) {
    command.heading_frame = random() % 2 == 0 ? GoalFrame::kOdom : GoalFrame::kBody;
    command.heading_rad = RandomWithin(random, kMaxHeading_rad);
  }
  return command;
}

// Sets every field to any value of its type.
class RandomFields {
 public:
  explicit RandomFields(std::mt19937& random) : random_(random) {}
  void BeginGroup(const char*) {}

  template <typename Value>
  void operator()(const char*, FieldKind, Concern, Value& value) {
    const uint64_t bits = static_cast<uint64_t>(random_()) << 32u | random_();
    if constexpr (std::is_same_v<Value, Age>) {
      value = {bits, static_cast<uint64_t>(random_())};
    } else if constexpr (std::is_array_v<Value>) {
      const size_t length = random_() % sizeof(value);
      for (size_t i = 0; i < sizeof(value); ++i) {
        value[i] = i < length ? static_cast<char>(' ' + random_() % 95) : '\0';
      }
    } else if constexpr (std::is_same_v<Value, float>) {
      value = std::bit_cast<float>(static_cast<uint32_t>(bits));
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = bits % 2 == 1;
    } else {
      value = static_cast<Value>(bits);
    }
  }

 private:
  std::mt19937& random_;
};

inline StatusReport RandomReport(std::mt19937& random) {
  StatusReport report;
  RandomFields fields(random);
  VisitStatus(report, fields);
  return report;
}

// The bits of every field in order, so that reports can be compared, NaN among them.
class FieldBits {
 public:
  void BeginGroup(const char*) {}
  template <typename Value>
  void operator()(const char*, FieldKind, Concern, const Value& value) {
    if constexpr (std::is_same_v<Value, Age>) {
      Add(&value.age_ns, sizeof(value.age_ns));
      Add(&value.limit_ns, sizeof(value.limit_ns));
    } else {
      Add(&value, sizeof(value));
    }
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  void Add(const void* value, size_t size) {
    const size_t begin = bytes_.size();
    bytes_.resize(begin + size);
    std::memcpy(bytes_.data() + begin, value, size);
  }
  Bytes bytes_;
};

inline Bytes BitsOf(const StatusReport& report) {
  FieldBits bits;
  VisitStatus(report, bits);
  return bits.bytes();
}

}  // namespace hardpack::control
