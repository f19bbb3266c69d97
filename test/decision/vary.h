// SPDX-License-Identifier: Apache-2.0
#pragma once

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
// passed, of ground that is hidden, or of driving in reverse. They draw no numbers, so that the
// decisions of before are the same.
inline bool StaysAsItIs(std::string_view full_name) {
  return full_name == "replan.pass_radius_m" || full_name == "speed.hidden_creep_mps" ||
         full_name == "costmap.near_unknown_cost" || full_name == "path.reverse_out_m" ||
         full_name == "speed.max_reverse_mps" || full_name == "vehicle.kinematics" ||
         full_name == "vehicle.wheelbase_m" || full_name == "vehicle.max_steering_rad" ||
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
