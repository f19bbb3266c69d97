// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "port_linux/files/read_outcome.h"

// The parts of a text file of one record a line: words, numbers, and what is said of a wrong one.
// In every function `name` is what the message begins with, such as "FILE:LINE: x".

namespace hardpack {

// The words of a line, without its comment, which begins with #.
std::vector<std::string> WordsOf(std::string line);

// kInvalidArgument, "NAME: WHAT".
ReadOutcome Wrong(const std::string& name, const std::string& what);

// Between single quotes.
std::string Quoted(std::string_view text);

// Whether it has no other character than 0 to 9; true for an empty text.
bool AreDigits(std::string_view text);

// Where in `names` the text is; -1: nowhere.
template <size_t kNames>
int IndexOfName(const std::array<const char*, kNames>& names, std::string_view text) {
  const auto found = std::find(names.begin(), names.end(), text);
  return found == names.end() ? -1 : static_cast<int>(std::distance(names.begin(), found));
}

// A finite decimal number within +-limit; a sign may stand before it. kInvalidArgument.
ReadOutcome ParseDecimal(const std::string& name, std::string_view text, double limit,
                         double& value);

// A number of degrees, exactly: "-12.345678901" is -12345678901. Digits, at most nine of them after
// the point, an optional sign. kInvalidArgument: not in this form, or beyond +-90 or +-180 degrees.
ReadOutcome ParseLatitude(const std::string& name, std::string_view text, int64_t& latitude_ndeg);
ReadOutcome ParseLongitude(const std::string& name, std::string_view text, int64_t& longitude_ndeg);

}  // namespace hardpack
