// SPDX-License-Identifier: Apache-2.0
// Any text as the onboard program's configuration: read, or refused with a line for each problem;
// what is read is within its ranges, and written and read again it is the same.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "core/base/validate.h"
#include "port_linux/files/configuration.h"
#include "test/fuzz/accepted.h"

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // The first byte says whether what every vehicle has to set stands before the rest.
  constexpr const char* kRequired =
      "drive.gear_ratio = 24.5\ndrive.left_sign = 1\ndrive.right_sign = -1\n"
      "lidar.address = \"10.0.0.2\"\nlidar.metadata = \"os1.json\"\n"
      "ins.address = \"10.0.0.3\"\nins.port = 5000\n";
  std::string text(data, data + size);
  if (!text.empty()) text = (text.front() % 2 != 0 ? kRequired : "") + text.substr(1);

  hardpack::Configuration configuration;
  const hardpack::ReadOutcome outcome =
      hardpack::ParseConfiguration(text, "warthog.toml", configuration);
  Require(outcome.ok() == outcome.message.empty());
  for (const char c : outcome.message) Require((c >= ' ' && c <= '~') || c == '\n');
  Require(std::count(outcome.message.begin(), outcome.message.end(), '\n') <=
          hardpack::kMaxConfigurationProblems);
  if (!outcome.ok()) return 0;

  hardpack::Accepted("configuration");
  Require(hardpack::FirstInvalidParameter(configuration.planner) == nullptr);
  Require(hardpack::FirstInvalidParameter(configuration.perception) == nullptr);
  Require(hardpack::FirstInvalidParameter(configuration.onboard) == nullptr);
  const std::string written = hardpack::ToToml(configuration);
  hardpack::Configuration read;
  Require(hardpack::ParseConfiguration(written, "written", read).ok());
  Require(hardpack::ToToml(read) == written);
  return 0;
}
