// SPDX-License-Identifier: Apache-2.0
#include "port_linux/command_line/arguments.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "port_linux/command_line/command.h"

namespace hardpack::command {
namespace {

constexpr double kLargestNumber = 1.0e6;

}  // namespace

double ParseNumber(const std::string& option, const std::string& text) {
  double value = 0.0;
  const char* first = text.data();
  const char* last = first + text.size();
  if (first != last && *first == '+') ++first;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc{} || end != last) {
    throw CommandFailure(kBadInput, option + ": '" + text + "' is not a number");
  }
  if (!std::isfinite(value) || std::abs(value) > kLargestNumber) {
    throw CommandFailure(kBadInput, option + ": " + text + " is not a finite number up to 1e6");
  }
  return value;
}

std::vector<float> ParseNumbers(const std::string& option, const std::string& text, size_t least,
                                size_t most, const std::string& form) {
  std::vector<float> numbers;
  size_t from = 0;
  while (from <= text.size()) {
    const size_t comma = std::min(text.find(',', from), text.size());
    numbers.push_back(static_cast<float>(ParseNumber(option, text.substr(from, comma - from))));
    from = comma + 1;
  }
  if (numbers.size() < least || numbers.size() > most) {
    throw CommandFailure(kBadInput, option + ": '" + text + "' is not of the form " + form);
  }
  return numbers;
}

void MakeOutputFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path, error)) {
    const std::string reason = error ? error.message() : "a file of that name exists";
    throw CommandFailure(kBadInput, "--out " + path + ": cannot be created (" + reason + ")");
  }
}

void WriteText(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw CommandFailure(kBadInput, path + ": cannot be written");
}

nlohmann::json JsonNumber(float value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text = {};
  const auto shortest = std::to_chars(text.data(), text.data() + text.size(), value);
  double number = 0.0;
  std::from_chars(text.data(), shortest.ptr, number);
  return number;
}

}  // namespace hardpack::command
