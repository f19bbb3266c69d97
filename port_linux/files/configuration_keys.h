// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "port_linux/files/configuration.h"

// Every key of the configuration except those of [labels.classes], in one list: the parameters of
// the tables of config/, and this port's own. Reading, writing, docs/configuration.md and
// config/warthog.toml use it.

namespace hardpack {

// Longest text that a key accepts; longer paths are useless.
inline constexpr int kMaxText = 500;

struct ConfigurationKey {
  std::string full_name;  // "costmap.halo_m"
  // Where its value is, in the configuration that the list was made from.
  std::variant<float*, int32_t*, ObstacleRule*, bool*, std::string*, Ipv4Address*> value;
  float low = 0.0f;  // of a number, both ends included; of a text, its length
  float high = 0.0f;
  std::string description;
  std::string not_above = {};  // the full name of the key that it must not exceed, if any
  bool is_parameter = false;   // of config/: docs/parameters.md has it

  std::string group() const { return full_name.substr(0, full_name.find('.')); }
  std::string name() const { return full_name.substr(full_name.find('.') + 1); }
};

// In the order in which they are written to a file, the keys of a group together. The list is valid
// as long as `configuration` is.
std::vector<ConfigurationKey> KeysOf(Configuration& configuration);

// A key without a value that is right for every vehicle: it must be in the file, and must not be 0
// or empty.
struct RequiredKey {
  std::string_view full_name;
  bool (*is_needed)(const Configuration& configuration);
  std::string_view why;  // "the vehicle's is not public: measure it"
};
std::span<const RequiredKey> RequiredKeys();

// Whether the value is 0 or empty, which counts as missing for a required key.
bool IsUnset(const ConfigurationKey& key);

// "m/s" for "max_speed_mps": the unit that a name ends in; empty for a plain number.
std::string_view UnitOf(std::string_view name);

// "a number from 0 to 3 m": the valid values of the key, for messages and pages.
std::string ExpectedOf(const ConfigurationKey& key);

// The value as it is written in a file, exact.
std::string ValueText(const ConfigurationKey& key);

// The shortest digits that are the same float again, with a point or an exponent.
std::string NumberText(float value);

// By ReturnClass.
inline constexpr std::array<const char*, 5> kReturnClassNames = {"ignored", "ground", "soft",
                                                                 "hard", "person"};

// The placeholder in the example for a value that only the vehicle's owner knows.
inline constexpr std::string_view kPlaceholder = "TO BE FILLED IN";

}  // namespace hardpack
