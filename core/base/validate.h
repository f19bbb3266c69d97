// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "config/onboard_parameters.h"
#include "config/onboard_tables.h"
#include "config/parameter_tables.h"
#include "config/parameters.h"
#include "core/base/loop_bound.h"
#include "core/base/saturate.h"
#include "core/base/status.h"

// Checks parameters against config/parameter_tables.h. It does not check parameters against each
// other (config/conflicts.h does); port_linux/files/set_parameter.h sets them by name.

namespace hardpack {

// The table of a group of parameters.
constexpr const auto& TableOf(const VehicleParams&) {
  return kVehicleTable;
}
constexpr const auto& TableOf(const CostmapParams&) {
  return kCostmapTable;
}
constexpr const auto& TableOf(const AstarParams&) {
  return kAstarTable;
}
constexpr const auto& TableOf(const PathParams&) {
  return kPathTable;
}
constexpr const auto& TableOf(const OptimizerParams&) {
  return kOptimizerTable;
}
constexpr const auto& TableOf(const SpeedParams&) {
  return kSpeedTable;
}
constexpr const auto& TableOf(const ReplanParams&) {
  return kReplanTable;
}
constexpr const auto& TableOf(const LidarMountParams&) {
  return kLidarMountTable;
}
constexpr const auto& TableOf(const SegmentationParams&) {
  return kSegmentationTable;
}
constexpr const auto& TableOf(const MappingParams&) {
  return kMappingTable;
}
constexpr const auto& TableOf(const DriveParams&) {
  return kDriveTable;
}
constexpr const auto& TableOf(const TwistDriveParams&) {
  return kTwistDriveTable;
}
constexpr const auto& TableOf(const InsParams&) {
  return kInsTable;
}
constexpr const auto& TableOf(const OdometryParams&) {
  return kOdometryTable;
}
constexpr const auto& TableOf(const MapFromOdomParams&) {
  return kMapFromOdomTable;
}
constexpr const auto& TableOf(const ClockParams&) {
  return kClockTable;
}
constexpr const auto& TableOf(const DynamicsParams&) {
  return kDynamicsTable;
}
constexpr const auto& TableOf(const TrackingParams&) {
  return kTrackingTable;
}
constexpr const auto& TableOf(const SafetyParams&) {
  return kSafetyTable;
}
constexpr const auto& TableOf(const TickParams&) {
  return kTickTable;
}

// Calls visit(group, table) for each group of parameters, in the order of the structs. Params:
// PlannerParams, PerceptionParams, OnboardParams or one group of them, const or not.
template <typename Params, typename Visit>
constexpr void VisitParameters(Params& params, Visit&& visit) {
  if constexpr (requires { TableOf(params); }) {
    visit(params, TableOf(params));
  } else if constexpr (requires { params.vehicle; }) {
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
  } else {
    visit(params.drive, kDriveTable);
    visit(params.twist_drive, kTwistDriveTable);
    visit(params.ins, kInsTable);
    visit(params.odometry, kOdometryTable);
    visit(params.map_from_odom, kMapFromOdomTable);
    visit(params.clock, kClockTable);
    visit(params.dynamics, kDynamicsTable);
    visit(params.tracking, kTrackingTable);
    visit(params.safety, kSafetyTable);
    visit(params.tick, kTickTable);
  }
}

// False for NaN too. Integers are compared as integers: a float may not hold them.
template <typename Group>
constexpr bool IsInRange(const ParameterEntry<Group>& entry, const Group& group) {
  if (entry.number != nullptr) {
    const float value = group.*entry.number;
    return value >= entry.low && value <= entry.high;
  }
  const int32_t value = entry.GetWhole(group);
  return value >= RoundToInt(entry.low) && value <= RoundToInt(entry.high);
}

// Whether the parameter respects the member that it must not exceed.
template <typename Group>
constexpr bool IsInOrder(const ParameterEntry<Group>& entry, const Group& group) {
  return entry.not_above == nullptr || entry.Get(group) <= group.*entry.not_above;
}

// The full name of the first parameter that is not finite or out of range; if there is none, of the
// first that is above the one that it must not exceed; otherwise nullptr. Params: as
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
static_assert(FirstInvalidParameter(OnboardParams{}) == nullptr);

}  // namespace hardpack
