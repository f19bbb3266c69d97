// SPDX-License-Identifier: Apache-2.0
#include "test/core/autonomy/random_outlines.h"

namespace hardpack {
namespace {

// SR-GEO04: of 1,000 random vehicles on random maps no usable plan's swept outline touches a hard
// cell.
TEST(Outlines, OfAThousandVehiclesTouchNothing) {
  OutlineCounts counts;
  JudgeOutlines(1, 1000, counts);
  EXPECT_GE(counts.plans, 400);
  std::printf("%d plans, %d from within an obstacle, %d refused; least clearance %.3f m\n",
              counts.plans, counts.in_start, counts.refused, counts.least_m);
}

}  // namespace
}  // namespace hardpack
