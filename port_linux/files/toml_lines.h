// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "port_linux/files/read_outcome.h"

// What a text has to be before it is given to toml++ (3.3), which is not safe with just any:
//  - A dotted key is a table in a table for each dot, and tables are freed by recursion: a long
//  line
//    could reach the end of the stack.
//  - A letter beyond ASCII outside of quotes and comments may lead to undefined behaviour (the last
//    switch of its is_non_ascii_horizontal_whitespace does not know U+00A1 to U+0499).
//  - So that a line alone shows what is within quotes, no text may reach over several lines.

namespace hardpack {

inline constexpr size_t kMaxTomlLineBytes = 2000;

// kOversized: a line is longer; kInvalidArgument: a letter beyond ASCII, or the beginning of a text
// of several lines, stands outside of quotes and comments. The message names file and line.
ReadOutcome CheckTomlLines(std::string_view toml, const std::string& name);

}  // namespace hardpack
