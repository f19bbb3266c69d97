// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hardpack {

// The name closest to a mistyped one by edit distance, the first of several; empty if none is
// close: more than half of the typed letters would have to change. Cost: letters typed times
// letters of all names.
std::string NearestName(std::string_view typed, const std::vector<std::string>& names);

}  // namespace hardpack
