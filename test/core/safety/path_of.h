// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "core/path/path.h"

namespace hardpack::testing {

inline WorldPath PathOf(const std::vector<Pose2>& poses) {
  WorldPath path;
  for (const Pose2& pose : poses) EXPECT_EQ(path.PushBack(pose), Status::kOk);
  return path;
}

}  // namespace hardpack::testing
