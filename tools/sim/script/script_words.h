// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "tools/sim/script/scripted_vehicle.h"

// Parsing of script commands (tools/sim/script/script.h).

namespace hardpack::sim::script {

using Action = std::function<void(ScriptedVehicle&)>;
using MaybeAction = std::optional<Action>;
// The arguments of a command.
using Words = std::vector<std::string>;

// Decimal or 0x hexadecimal; the whole word must match, otherwise nothing.
inline std::optional<int64_t> Integer(const std::string& word) {
  const bool negative = word.starts_with("-");
  const std::string_view digits = std::string_view(word).substr(negative ? 1 : 0);
  const bool hexadecimal = digits.starts_with("0x");
  const std::string_view rest = digits.substr(hexadecimal ? 2 : 0);
  int64_t value = 0;
  const auto [end, error] =
      std::from_chars(rest.data(), rest.data() + rest.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc() || end != rest.data() + rest.size() || value < 0) return std::nullopt;
  return negative ? -value : value;
}

inline std::optional<double> Real(const std::string& word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

// Integer, if the type can hold it.
template <typename Unsigned>
std::optional<Unsigned> Bounded(const std::string& word) {
  const auto value = Integer(word);
  if (!value || *value < 0 || static_cast<uint64_t>(*value) > Unsigned(~Unsigned{0})) {
    return std::nullopt;
  }
  return static_cast<Unsigned>(*value);
}

// on or off.
inline std::optional<bool> Switch(const std::string& word) {
  if (word == "on") return true;
  if (word == "off") return false;
  return std::nullopt;
}

// A command's action for a given number of arguments; none: the arguments are invalid.
struct Command {
  size_t least_words;
  size_t most_words;
  std::function<MaybeAction(const Words&)> parse;
};

}  // namespace hardpack::sim::script
