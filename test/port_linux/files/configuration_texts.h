// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "port_linux/files/configuration.h"
#include "port_linux/files/configuration_keys.h"

namespace hardpack {

// What every vehicle has to set, one line each from line 1 on, and nothing else.
inline const std::string kRequiredLines =
    "drive.gear_ratio = 24.5\n"
    "drive.left_sign = 1\n"
    "drive.right_sign = -1\n"
    "lidar.address = \"10.0.0.2\"\n"
    "lidar.metadata = \"os1.json\"\n"
    "ins = { address = \"10.0.0.3\", port = 5000 }\n";

inline Configuration Parsed(const std::string& text) {
  Configuration configuration;
  const ReadOutcome outcome = ParseConfiguration(text, "f", configuration);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return configuration;
}

// Every value, floats to the bit.
inline std::string Values(Configuration configuration) {
  std::ostringstream text;
  for (const ConfigurationKey& key : KeysOf(configuration)) {
    text << key.full_name << ' ';
    if (const auto* number = std::get_if<float*>(&key.value)) {
      text << std::bit_cast<uint32_t>(**number);
    } else {
      text << ValueText(key);
    }
    text << '\n';
  }
  for (const ReturnClass meaning : configuration.labels.class_of) {
    text << static_cast<int>(meaning);
  }
  return text.str();
}

inline const ConfigurationKey& KeyNamed(const std::vector<ConfigurationKey>& keys,
                                        const std::string& full_name) {
  return *std::find_if(keys.begin(), keys.end(), [&full_name](const ConfigurationKey& key) {
    return key.full_name == full_name;
  });
}

}  // namespace hardpack
