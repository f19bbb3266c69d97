// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "core/autonomy/mapper.h"
#include "core/base/validate.h"
#include "core/costmap/costmap.h"
#include "core/scan/scan.h"
#include "test/fuzz/accepted.h"

// The script of the mapper's fuzz target, how a mapper is configured by it, and what holds of every
// grid and map.

namespace hardpack {

inline void Require(bool condition, int line = __builtin_LINE()) {
  if (condition) return;
  std::fprintf(stderr, "line %d: not as required\n", line);
  std::abort();
}

// The script's bytes, one argument after the other.
class Script {
 public:
  Script(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  bool ended() const { return at_ >= size_; }
  uint8_t Byte() { return at_ < size_ ? data_[at_++] : uint8_t{0}; }
  uint16_t Two() { return static_cast<uint16_t>(Byte() | Byte() << 8); }
  uint32_t Four() { return Two() | static_cast<uint32_t>(Two()) << 16; }
  uint64_t Eight() { return Four() | static_cast<uint64_t>(Four()) << 32; }
  // Any float there is: half of them come from a list of awkward ones.
  float Any() {
    constexpr float kAwkward[] = {std::numeric_limits<float>::quiet_NaN(),
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  3.0e38f,
                                  -3.0e38f,
                                  838860.0f,
                                  -838860.0f,
                                  1.0e-40f,
                                  -0.0f,
                                  100.0f,
                                  -100.0f};
    const uint8_t which = Byte();
    if (which % 2 == 0) return kAwkward[which / 2 % std::size(kAwkward)];
    return std::bit_cast<float>(Four());
  }

 private:
  const uint8_t* data_;
  size_t size_;
  size_t at_ = 0;
};

// What a run of returns looks like when the script does not spell it out.
class Noise {
 public:
  explicit Noise(uint64_t seed) : state_(seed * 2 + 1) {}
  uint32_t Next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>(state_ >> 33);
  }

 private:
  uint64_t state_;
};

struct Sensor {
  int beams;
  int columns;
};
inline constexpr Sensor kSensors[] = {
    {16, 512},  {16, 128},  {6, 90},   {32, 256}, {64, 512}, {1, 1},      {3, 7},      {17, 100},
    {128, 512}, {64, 2048}, {128, 24}, {2, 2048}, {16, 512}, {128, 2048}, {128, 1024}, {5, 11}};
inline constexpr int kWidestSpread_columns = 2 * kMaxColumnShift;
inline constexpr uint64_t kTick_ns = 10'000'000;

// Sets one parameter to an end of its range, into it, or outside.
template <typename Params>
void Bend(Script& script, Params& params) {
  const int chosen = script.Byte();
  const uint8_t how = script.Byte();
  int index = 0;
  const auto bend = [&]<typename Group, size_t kEntries>(
                        Group& group, const std::array<ParameterEntry<Group>, kEntries>& table) {
    for (const ParameterEntry<Group>& entry : table) {
      if (index++ != chosen) continue;
      const float share = static_cast<float>(how) / 255.0f;
      float value = entry.low + share * (entry.high - entry.low);
      if (how == 0) value = script.Any();
      if (entry.number != nullptr) group.*entry.number = value;
      if (entry.whole != nullptr) group.*entry.whole = RoundToInt(value);
      if (entry.rule != nullptr) group.*entry.rule = static_cast<ObstacleRule>(how % 3);
    }
  };
  if constexpr (requires { params.mount; }) {
    VisitParameters(params, bend);
  } else {
    bend(params, kCostmapTable);
  }
}

// One configuration, as the script wants it.
struct Setup {
  PerceptionParams params;
  CostmapParams rule;
  LabelTable table = RellisLabelTable();
  BeamModel model;
  int32_t window_first = 0;
  int32_t window_last = 0;
};

inline void MakeModel(Script& script, BeamModel& model) {
  const uint8_t choice = script.Byte();
  const Sensor sensor = kSensors[choice % std::size(kSensors)];
  float altitude_deg[kMaxBeams];
  float azimuth_deg[kMaxBeams];
  const uint8_t order = script.Byte();
  const float column_deg = 360.0f / static_cast<float>(sensor.columns);
  const float spread_deg =
      column_deg * static_cast<float>(script.Byte() * kWidestSpread_columns) / 255.0f;
  const float field_deg = choice < 240 ? 40.0f : 180.0f;
  for (int row = 0; row < sensor.beams; ++row) {
    const int place = order % 2 == 0 ? row : row * 7 % sensor.beams;
    const float share = static_cast<float>(place) / static_cast<float>(kMaxBeams);
    const float reach = share * static_cast<float>(kMaxBeams) / static_cast<float>(sensor.beams);
    altitude_deg[row] = 0.4f * field_deg - 0.9f * field_deg * reach;
    azimuth_deg[row] = spread_deg * (static_cast<float>(row % 4) / 4.0f - 0.5f);
  }
  const auto beams = static_cast<size_t>(sensor.beams);
  Transform3 sensor_from_lidar;
  sensor_from_lidar.translation.z_m = 0.036f;
  const Status made = MakeBeamModel({altitude_deg, beams}, {azimuth_deg, beams}, sensor.columns,
                                    order < 250 ? 0.015f : 30.0f, sensor_from_lidar, model);
  Require(IsUsable(made) || made == Status::kInvalidArgument);
}

inline void MakeSetup(Script& script, Setup& setup) {
  setup = Setup{};
  MakeModel(script, setup.model);
  const uint8_t what = script.Byte();
  setup.params.mapping.use_labels = what % 2;
  if ((what & 2) != 0) Bend(script, setup.params);
  if ((what & 4) != 0) Bend(script, setup.params);
  if ((what & 8) != 0) Bend(script, setup.rule);
  if ((what & 16) != 0)
    setup.table.class_of[script.Byte()] = static_cast<ReturnClass>(script.Byte());
  setup.window_last = setup.model.columns_per_revolution - 1;
  if ((what & 32) != 0) {
    setup.window_first = static_cast<int16_t>(script.Two());
    setup.window_last = static_cast<int16_t>(script.Two());
  }
}

inline void CheckGrid(const HeightGrid& heights) {
  for (int index = 0; index < kMapCells; ++index) {
    const HeightGrid::CellHeights cell = heights.At(heights.window().FromIndex(index));
    constexpr int16_t kNone = HeightGrid::kNone;
    const bool hard = cell.highest_hard_cm != kNone;
    const bool soft = cell.highest_soft_cm != kNone;
    Require(hard == (cell.lowest_hard_cm != kNone));
    Require(!hard || cell.lowest_hard_cm <= cell.highest_hard_cm);
    Require(!hard || cell.lowest_cm <= cell.lowest_hard_cm);
    Require(!soft || cell.lowest_cm <= cell.highest_soft_cm);
    Require((cell.lowest_cm != kNone) == (hard || soft || cell.ground));
    Require(!cell.person || hard);
  }
}

inline void CheckMap(const Costmap& map) {
  for (int index = 0; index < kMapCells; ++index) {
    const uint8_t flags = map.flags[index];
    const bool hard = (flags & Costmap::kHard) != 0;
    Require(map.cost_q8[index] <= kMaxCost_q8);
    Require(!hard || map.Lethal(index));
    Require(!hard || (flags & Costmap::kSoft) == 0);
    Require(hard || (flags & Costmap::kPerson) == 0);
    Require(hard == (map.hard_distance2[index] == 0));
    Require(map.Lethal(index) == (map.hard_depth2[index] != 0));
  }
}

}  // namespace hardpack
