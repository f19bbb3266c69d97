// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/line_words.h"

#include <charconv>
#include <cmath>
#include <sstream>

namespace hardpack {
namespace {

constexpr size_t kFractionDigits = 9;
constexpr int64_t kNanodegreesPerDegree = 1'000'000'000;

ReadOutcome ParseNanodegrees(const std::string& name, std::string_view text, int64_t limit_deg,
                             int64_t& value_ndeg) {
  std::string_view digits = text;
  const bool negative = digits.starts_with('-');
  if (negative || digits.starts_with('+')) digits.remove_prefix(1);
  const size_t point = std::min(digits.find('.'), digits.size());
  const std::string_view whole = digits.substr(0, point);
  const std::string_view fraction = digits.substr(std::min(point + 1, digits.size()));
  if (whole.empty() || !AreDigits(whole) || !AreDigits(fraction) ||
      (point < digits.size() && fraction.empty())) {
    return Wrong(name, Quoted(text) + " is not a number of degrees such as -96.338912345");
  }
  if (fraction.size() > kFractionDigits) {
    return Wrong(name, Quoted(text) + " has more than nine decimals");
  }
  std::string scaled = std::string(whole) + std::string(fraction);
  scaled.append(kFractionDigits - fraction.size(), '0');
  int64_t magnitude_ndeg = 0;
  const auto [end, error] =
      std::from_chars(scaled.data(), scaled.data() + scaled.size(), magnitude_ndeg);
  if (error != std::errc{} || magnitude_ndeg > limit_deg * kNanodegreesPerDegree) {
    return Wrong(name, Quoted(text) + " is not within " + std::to_string(limit_deg) + " degrees");
  }
  value_ndeg = negative ? -magnitude_ndeg : magnitude_ndeg;
  return {};
}

}  // namespace

std::vector<std::string> WordsOf(std::string line) {
  line.resize(std::min(line.size(), line.find('#')));
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

ReadOutcome Wrong(const std::string& name, const std::string& what) {
  return {Status::kInvalidArgument, name + ": " + what};
}

std::string Quoted(std::string_view text) {
  // Not with operator+: GCC 12 warns of overlaps there (its bug 105329).
  std::string quoted(1, '\'');
  quoted.append(text);
  quoted.push_back('\'');
  return quoted;
}

bool AreDigits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

ReadOutcome ParseDecimal(const std::string& name, std::string_view text, double limit,
                         double& value) {
  const char* first = text.data();
  const char* last = first + text.size();
  if (first != last && *first == '+') ++first;
  const auto [end, error] = std::from_chars(first, last, value);
  if (error != std::errc{} || end != last) return Wrong(name, Quoted(text) + " is not a number");
  if (std::isfinite(value) && std::abs(value) <= limit) return {};
  return Wrong(name, Quoted(text) + " is out of range");
}

ReadOutcome ParseLatitude(const std::string& name, std::string_view text, int64_t& latitude_ndeg) {
  return ParseNanodegrees(name, text, 90, latitude_ndeg);
}

ReadOutcome ParseLongitude(const std::string& name, std::string_view text,
                           int64_t& longitude_ndeg) {
  return ParseNanodegrees(name, text, 180, longitude_ndeg);
}

}  // namespace hardpack
