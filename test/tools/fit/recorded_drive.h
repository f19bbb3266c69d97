// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/fit/drive_record.h"

// The real recording, which is not part of the project.

namespace hardpack::fit {

// Empty without HARDPACK_DATA, or where it is not there.
inline std::string RecordedDrivePath() {
  const char* folder = std::getenv("HARDPACK_DATA");
  if (folder == nullptr) return {};
  const std::string path = std::string(folder) + "/warthog/warthog_drive_20hz.csv";
  return std::filesystem::exists(path) ? path : "";
}

}  // namespace hardpack::fit

// NOLINTNEXTLINE(readability-identifier-naming)
#define SKIP_WITHOUT_RECORDED_DRIVE()                                                    \
  if (hardpack::fit::RecordedDrivePath().empty()) {                                      \
    GTEST_SKIP() << "no recording: HARDPACK_DATA has no warthog/warthog_drive_20hz.csv"; \
  }
