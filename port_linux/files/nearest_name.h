// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hardpack {

// The name nearest to a mistyped one by edit distance, the first of several; empty when none is
// near: more than half of the letters typed would have to change. Cost: letters typed times letters
// of all names.
std::string NearestName(std::string_view typed, const std::vector<std::string>& names);

}  // namespace hardpack
