// SPDX-License-Identifier: Apache-2.0
#include "core/base/footprint.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "gtest/gtest.h"

namespace hardpack {
namespace {

VehicleParams Vehicle(float length_m, float width_m, float axle_offset_m) {
  VehicleParams vehicle;
  vehicle.length_m = length_m;
  vehicle.width_m = width_m;
  vehicle.axle_offset_m = axle_offset_m;
  return vehicle;
}

//   +-----------x---+      the axle 1 m ahead of the middle of 4 m
//   -3          0   1
TEST(Footprint, HasTheAxleAsItsOrigin) {
  const Footprint footprint = FootprintOf(Vehicle(4.0f, 2.0f, 1.0f));
  EXPECT_FLOAT_EQ(footprint.front_m, 1.0f);
  EXPECT_FLOAT_EQ(footprint.rear_m, -3.0f);
  EXPECT_FLOAT_EQ(footprint.half_width_m, 1.0f);
  EXPECT_FLOAT_EQ(footprint.middle_m(), -1.0f);
  EXPECT_FLOAT_EQ(footprint.half_length_m(), 2.0f);
  EXPECT_FLOAT_EQ(footprint.pivot_radius_m, std::sqrt(10.0f));
}

TEST(Footprint, OfTheDefaultsIsTheWarthogs) {
  const Footprint footprint = FootprintOf(VehicleParams{});
  EXPECT_FLOAT_EQ(footprint.front_m, 0.76f);
  EXPECT_FLOAT_EQ(footprint.rear_m, -0.76f);
  EXPECT_NEAR(footprint.pivot_radius_m, 1.0265f, 1.0e-4f);
  EXPECT_LE(footprint.disc_radius_m, 0.79f);
}

// SR-GEO01: the discs cover the whole outline, and reach no further than 0.1 m beside it; 1,000
// vehicles over the whole of the ranges, points of a fine raster of each.
TEST(Footprint, IsCoveredByItsDiscs) {
  std::mt19937 random(20261125);
  std::uniform_real_distribution<float> share(0.0f, 1.0f);
  for (int i = 0; i < 1000; ++i) {
    const float length_m = 0.3f + 5.7f * share(random);
    const float width_m = 0.3f + 3.7f * share(random);
    const float offset_m = length_m * (share(random) - 0.5f);
    const Footprint footprint = FootprintOf(Vehicle(length_m, width_m, offset_m));
    SCOPED_TRACE(::testing::Message() << length_m << " x " << width_m << ", axle " << offset_m);
    EXPECT_LE(footprint.disc_radius_m, footprint.half_width_m + 0.1f + 1.0e-5f);
    ASSERT_GE(footprint.discs, 2);
    ASSERT_LE(footprint.discs, Footprint::kMaxDiscs);
    constexpr int kRaster = 40;
    for (int k = 0; k <= kRaster; ++k) {
      const float along = static_cast<float>(k) / kRaster;
      const float x_m = footprint.rear_m + along * length_m;
      // The flank is the furthest from the discs' centres.
      float nearest_m = 1.0e9f;
      for (int disc = 0; disc < footprint.discs; ++disc) {
        nearest_m = std::min(nearest_m,
                             std::hypot(x_m - footprint.DiscAhead(disc), footprint.half_width_m));
      }
      EXPECT_LE(nearest_m, footprint.disc_radius_m + 1.0e-5f);
      EXPECT_LE(std::hypot(x_m, footprint.half_width_m), footprint.pivot_radius_m + 1.0e-5f);
    }
  }
}

//        *  (1.3, 1.4)
//   +-----+
//   |     |  * (2, 0)
//   +-----+
TEST(Footprint, TellsTheDistanceOfAPoint) {
  const Footprint footprint = FootprintOf(Vehicle(2.0f, 2.0f, 0.0f));
  EXPECT_EQ(DistanceToOutline(footprint, {0.9f, -0.9f}), 0.0f);
  EXPECT_FLOAT_EQ(DistanceToOutline(footprint, {2.0f, 0.0f}), 1.0f);
  EXPECT_FLOAT_EQ(DistanceToOutline(footprint, {-0.5f, -1.5f}), 0.5f);
  EXPECT_FLOAT_EQ(DistanceToOutline(footprint, {1.3f, 1.4f}), 0.5f);
}

}  // namespace
}  // namespace hardpack
