// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace hardpack::command {

// A line of text formatted as by printf, cut at 255 characters.
template <typename... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 256> text = {};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace hardpack::command
