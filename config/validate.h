// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "config/parameter_tables.h"
#include "config/parameters.h"
#include "core/base/loop_bound.h"
#include "core/base/saturate.h"
#include "core/base/status.h"

// Checks parameters against config/parameter_tables.h and reaches them by name. No heap; core may
// use it. It reads no files (the tools and the port do), and it cannot tell whether parameters of
// different meaning go together (the stages do).

namespace hardpack {

// Calls visit(group, table) for each group of parameters, in the order of the structs. Params:
// PlannerParams, PerceptionParams or one group of the latter, const or not.
template <typename Params, typename Visit>
constexpr void VisitParameters(Params& params, Visit&& visit) {
  if constexpr (requires { params.vehicle; }) {
    visit(params.vehicle, kVehicleTable);
    visit(params.costmap, kCostmapTable);
    visit(params.astar, kAstarTable);
    visit(params.path, kPathTable);
    visit(params.optimizer, kOptimizerTable);
    visit(params.speed, kSpeedTable);
    visit(params.replan, kReplanTable);
  } else if constexpr (requires { params.mount; }) {
    visit(params.mount, kLidarMountTable);
    visit(params.segmentation, kSegmentationTable);
    visit(params.mapping, kMappingTable);
  } else if constexpr (requires { params.self_min_x_m; }) {
    visit(params, kLidarMountTable);
  } else if constexpr (requires { params.bridge_factor; }) {
    visit(params, kSegmentationTable);
  } else {
    visit(params, kMappingTable);
  }
}

// False for NaN too.
template <typename Group>
constexpr bool IsInRange(const ParameterEntry<Group>& entry, const Group& group) {
  const float value = entry.Get(group);
  return value >= entry.low && value <= entry.high;
}

// Whether it does not exceed the member that it must not exceed.
template <typename Group>
constexpr bool IsInOrder(const ParameterEntry<Group>& entry, const Group& group) {
  return entry.not_above == nullptr || entry.Get(group) <= group.*entry.not_above;
}

// The full name of the first parameter that is not finite or out of its range; if there is none, of
// the first that is above the one that it must not exceed; else nullptr. Params: as
// VisitParameters. Cost: one pass over the tables.
template <typename Params>
constexpr const char* FirstInvalidParameter(const Params& params) {
  const char* out_of_range = nullptr;
  const char* out_of_order = nullptr;
  VisitParameters(
      params, [&]<typename Group, size_t kEntries>(
                  const Group& group, const std::array<ParameterEntry<Group>, kEntries>& table) {
        HP_LOOP_BOUND(kEntries)
        for (const ParameterEntry<Group>& entry : table) {
          if (out_of_range == nullptr && !IsInRange(entry, group)) out_of_range = entry.full_name;
          if (out_of_order == nullptr && !IsInOrder(entry, group)) out_of_order = entry.full_name;
        }
      });
  return out_of_range != nullptr ? out_of_range : out_of_order;
}

// A default outside its range does not compile.
static_assert(FirstInvalidParameter(PlannerParams{}) == nullptr);
static_assert(FirstInvalidParameter(PerceptionParams{}) == nullptr);

inline constexpr int kMaxParameterName = 48;  // letters of a full name

// Precondition: full_name is a table's. Cost: at most its letters.
constexpr bool IsNamed(const char* full_name, const char* name) {
  HP_LOOP_BOUND(kMaxParameterName)
  for (; *full_name != '\0' && *full_name == *name; ++full_name) ++name;
  return *full_name == *name;
}

// Sets one parameter of a group to a value as it was typed or read from a file.
// kNotFinite; kParameterOutOfRange: outside the entry's range, or a fraction of what is counted.
// On a failure the group is as it was. Does not compare it with others: FirstInvalidParameter does.
template <typename Group>
constexpr Status SetParameter(const ParameterEntry<Group>& entry, double value, Group& group) {
  if (!(value - value == 0.0)) return Status::kNotFinite;
  constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());
  if (value < -kLargest || value > kLargest) return Status::kParameterOutOfRange;
  // As a float: a limit of 0.1f admits a typed 0.1, although that double is the lesser of the two.
  const float number = static_cast<float>(value);
  if (number < entry.low || number > entry.high) return Status::kParameterOutOfRange;
  if (entry.number != nullptr) {
    group.*entry.number = number;
    return Status::kOk;
  }
  const int32_t whole = RoundToInt(number);
  if (static_cast<double>(whole) != value) return Status::kParameterOutOfRange;
  if (entry.whole != nullptr) {
    group.*entry.whole = whole;
  } else {
    group.*entry.rule = static_cast<ObstacleRule>(whole);
  }
  return Status::kOk;
}

// The same by full name, "costmap.halo_m". kInvalidArgument: no parameter has that name. Params:
// as VisitParameters. Cost: one pass over the names.
template <typename Params>
constexpr Status SetParameter(const char* full_name, double value, Params& params) {
  Status status = Status::kInvalidArgument;
  VisitParameters(params,
                  [&]<typename Group, size_t kEntries>(
                      Group& group, const std::array<ParameterEntry<Group>, kEntries>& table) {
                    HP_LOOP_BOUND(kEntries)
                    for (const ParameterEntry<Group>& entry : table) {
                      if (IsNamed(entry.full_name, full_name))
                        status = SetParameter(entry, value, group);
                    }
                  });
  return status;
}

}  // namespace hardpack
