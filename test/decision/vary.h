// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "config/parameter_tables.h"
#include "core/base/math.h"
#include "core/base/validate.h"
#include "port_linux/files/set_parameter.h"
#include "test/decision/random.h"

namespace hardpack::decision {

// Anything near what a parameter is, or, one time in five, anything that it may be.
template <typename Group>
double NearBy(Random& random, const ParameterEntry<Group>& entry, const Group& group) {
  const float now = entry.Get(group);
  const bool is_near = random.Between(0, 4) != 0;
  const float reach = Min(Abs(now) * 0.5f, entry.high - entry.low);
  const float low = is_near ? Max(entry.low, now - reach) : entry.low;
  const float high = is_near ? Min(entry.high, now + reach) : entry.high;
  const float value = random.RealBetween(low, high);
  return entry.number != nullptr ? double{value} : double(RoundToInt(value));
}

// Parameters of other vehicles than the one that these decisions are about, of waypoints that are
// passed, of ground that is hidden, of slopes, or of driving in reverse. They draw no numbers, so
// that the decisions of before are the same.
inline bool StaysAsItIs(std::string_view full_name) {
  constexpr std::array<std::string_view, 15> kNames = {"replan.pass_radius_m",
                                                       "speed.hidden_creep_mps",
                                                       "costmap.near_unknown_cost",
                                                       "costmap.max_grade",
                                                       "costmap.free_grade",
                                                       "costmap.grade_cost",
                                                       "costmap.free_roughness_m",
                                                       "costmap.roughness_cost_per_m",
                                                       "path.reverse_out_m",
                                                       "speed.max_reverse_mps",
                                                       "vehicle.kinematics",
                                                       "vehicle.wheelbase_m",
                                                       "vehicle.max_steering_rad",
                                                       "speed.friction",
                                                       "speed.max_vertical_acceleration_mps2"};
  return std::ranges::find(kNames, full_name) != kNames.end() ||
         full_name.starts_with("twist_drive.");
}

// Changes each parameter of a kind (see VisitParameters) one time in `seldom`.
template <typename Params>
void Vary(Random& random, int seldom, Params& params) {
  VisitParameters(params,
                  [&]<typename Group, size_t kEntries>(
                      Group& group, const std::array<ParameterEntry<Group>, kEntries>& table) {
                    for (const ParameterEntry<Group>& entry : table) {
                      if (StaysAsItIs(entry.full_name)) continue;
                      if (random.Between(1, seldom) != 1) continue;
                      static_cast<void>(SetParameter(entry, NearBy(random, entry, group), group));
                    }
                  });
}

}  // namespace hardpack::decision
