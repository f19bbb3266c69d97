// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "port_linux/files/read_outcome.h"

// Conditions on a text before it is given to toml++ (3.3), which is not safe for arbitrary input:
//  - A dotted key is one nested table per dot, and tables are freed by recursion: a long line
//    could exhaust the stack.
//  - A non-ASCII letter outside quotes and comments gets a clear message. This check takes every
//    quote for the beginning of a text, the parser only one at the beginning of a value: a letter
//    after a = 3" does reach the parser, which is made safe in port_linux/files/toml_parser.h.
//  - So that a single line shows what is within quotes, no text may span several lines.

namespace hardpack {

inline constexpr size_t kMaxTomlLineBytes = 2000;

// kOversized: a line is longer; kInvalidArgument: a non-ASCII letter, or the beginning of a
// multi-line text, outside quotes and comments. The message names file and line.
ReadOutcome CheckTomlLines(std::string_view toml, const std::string& name);

}  // namespace hardpack
