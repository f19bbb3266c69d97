// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

#include "port_linux/files/area_file.h"
#include "port_linux/files/configuration.h"
#include "port_linux/files/configuration_keys.h"

namespace hardpack {
namespace {

// "default" covers the codes of one class, so these are not listed.
std::string ClassesToToml(const LabelTable& labels) {
  constexpr ReturnClass kUnlisted = ReturnClass::kHard;
  const auto name_of = [](ReturnClass meaning) {
    return '"' + std::string(kReturnClassNames[static_cast<size_t>(meaning)]) + "\"\n";
  };
  std::string text = "\n[labels.classes]\ndefault = " + name_of(kUnlisted);
  for (size_t code = 0; code < kLabelCodes; ++code) {
    const ReturnClass meaning = labels.class_of[code];
    if (meaning != kUnlisted) text += std::to_string(code) + " = " + name_of(meaning);
  }
  return text;
}

}  // namespace

bool ParseIpv4(std::string_view text, Ipv4Address& address) {
  uint32_t value = 0;
  if (text.empty()) {
    address = {};
    return true;
  }
  for (int part = 0; part < 4; ++part) {
    uint8_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const size_t digits = static_cast<size_t>(end - text.data());
    if (error != std::errc{} || digits > 3 || (digits > 1 && text.front() == '0')) return false;
    value = value << 8 | number;
    text.remove_prefix(digits);
    if (part == 3) break;
    if (!text.starts_with('.')) return false;
    text.remove_prefix(1);
  }
  if (!text.empty()) return false;
  address.value = value;
  return true;
}

std::string ToText(Ipv4Address address) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += std::to_string(address.value >> shift & 0xffu);
    if (shift > 0) text += '.';
  }
  return text;
}

std::string ToToml(const Configuration& configuration, Secrets secrets) {
  Configuration copy = configuration;
  const bool hides = secrets == Secrets::kHidden && configuration.onboard.drive.login_password != 0;
  if (hides) copy.onboard.drive.login_password = 0;
  std::string text = "# Every key of hardpackd's configuration.\n";
  std::string group;
  for (const ConfigurationKey& key : KeysOf(copy)) {
    if (key.group() != group) {
      group = key.group();
      text += "\n[" + group + "]\n";
    }
    text += key.name() + " = " + ValueText(key);
    if (hides && key.group() == "drive" && key.name() == "login_password") {
      text += ' ';
      text += kHiddenSecret;
    }
    text += '\n';
  }
  return text + ClassesToToml(configuration.labels) + AreasToToml(configuration.areas);
}

}  // namespace hardpack
