// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/toml_lines.h"

#include <algorithm>

namespace hardpack {
namespace {

// The position after the quote that ends a text, or the line's end: the parser reports a text
// without an end. `at` is the position after its first quote.
size_t BehindText(std::string_view line, size_t at, char quote) {
  while (at < line.size() && line[at] != quote) {
    at += quote == '"' && line[at] == '\\' ? 2 : 1;
  }
  return std::min(at + 1, line.size());
}

// The error of the line, or null. At the start of a line the parser is outside quotes, because no
// text continues over the end of a line.
const char* Fault(std::string_view line) {
  for (size_t at = 0; at < line.size();) {
    const char letter = line[at];
    if (letter == '#') return nullptr;
    if (letter != '"' && letter != '\'') {
      if (static_cast<unsigned char>(letter) >= 0x80) {
        return "a non-ASCII letter outside quotes";
      }
      ++at;
      continue;
    }
    const std::string_view rest = line.substr(at);
    if (rest.starts_with("\"\"\"") || rest.starts_with("'''")) {
      return "a multi-line text, which is not supported";
    }
    at = BehindText(line, at + 1, letter);
  }
  return nullptr;
}

}  // namespace

ReadOutcome CheckTomlLines(std::string_view toml, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (toml.starts_with(kByteOrderMark)) toml.remove_prefix(kByteOrderMark.size());
  size_t number = 1;
  for (size_t from = 0; from < toml.size(); ++number) {
    const size_t end = std::min(toml.find('\n', from), toml.size());
    const std::string_view line = toml.substr(from, end - from);
    const std::string where = name + ":" + std::to_string(number) + ": ";
    if (line.size() > kMaxTomlLineBytes) {
      return {Status::kOversized,
              where + "longer than " + std::to_string(kMaxTomlLineBytes) + " bytes"};
    }
    if (const char* fault = Fault(line)) return {Status::kInvalidArgument, where + fault};
    from = end + 1;
  }
  return {};
}

}  // namespace hardpack
