// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/experiment/progress.h"

#include <gtest/gtest.h>

namespace hardpack::experiment {
namespace {

TEST(ProgressLine, ShowsHowFarAndHowLongStill) {
  EXPECT_EQ(ProgressLine("gap", 50, 100, 2, 60.0, 60),
            "gap  [===========            ]  50/100  2 failed  1:00 left");
}

TEST(ProgressLine, IsNeverWiderThanTheTerminal) {
  for (int columns = 0; columns < 200; ++columns) {
    for (const int64_t done : {0, 1, 99, 100}) {
      const std::string line = ProgressLine("crossing", done, 100, done / 3, 3600.0, columns);
      EXPECT_LE(line.size(), static_cast<size_t>(std::max(columns - 1, 0)));
      EXPECT_EQ(line.find('\n'), std::string::npos);
    }
  }
}

TEST(ProgressLine, TakesAnExperimentOfNoRuns) {
  EXPECT_NE(ProgressLine("gap", 0, 0, 0, 0.0, 80).find("0/0"), std::string::npos);
}

}  // namespace
}  // namespace hardpack::experiment
