// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "port_linux/files/read_outcome.h"

// Conditions on a text before it is given to toml++ (3.3), which is not safe for arbitrary input:
//  - A dotted key is one nested table per dot, and tables are freed by recursion: a long line
//    could exhaust the stack.
//  - A non-ASCII letter outside quotes and comments may lead to undefined behaviour (the last
//    switch of its is_non_ascii_horizontal_whitespace does not handle U+00A1 to U+0499).
//  - So that a single line shows what is within quotes, no text may span several lines.

namespace hardpack {

inline constexpr size_t kMaxTomlLineBytes = 2000;

// kOversized: a line is longer; kInvalidArgument: a non-ASCII letter, or the beginning of a
// multi-line text, outside quotes and comments. The message names file and line.
ReadOutcome CheckTomlLines(std::string_view toml, const std::string& name);

}  // namespace hardpack
