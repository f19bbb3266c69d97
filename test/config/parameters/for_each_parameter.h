// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "config/onboard_parameters.h"
#include "config/parameters.h"
#include "core/base/validate.h"

namespace hardpack {

// visit(params, group, entry) for each parameter of new default parameters.
template <typename Params, typename Visit>
void ForEachParameter(Visit visit) {
  Params outer;
  VisitParameters(outer, [&](auto&, const auto& table) {
    for (const auto& entry : table) {
      Params params;
      VisitParameters(params, [&]<typename Group>(Group& group, const auto& other_table) {
        if constexpr (std::is_same_v<decltype(table), decltype(other_table)>) {
          visit(params, group, entry);
        }
      });
    }
  });
}
template <typename Visit>
void ForEachParameter(Visit visit) {
  ForEachParameter<PlannerParams>(visit);
  ForEachParameter<PerceptionParams>(visit);
  ForEachParameter<OnboardParams>(visit);
}

}  // namespace hardpack
