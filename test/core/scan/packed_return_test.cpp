// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "core/scan/scan.h"

namespace hardpack {
namespace {

TEST(PackedReturn, BeginsAsRawIgnoredAndOfUnknownHeight) {
  for (const uint32_t range_mm : {0u, 1u, 16749u, 0x7ffffu}) {
    for (const bool self : {false, true}) {
      const PackedReturn packed = PackedReturn::Raw(range_mm, self);
      EXPECT_EQ(packed.range_mm(), range_mm);
      EXPECT_EQ(packed.self(), self);
      EXPECT_EQ(packed.return_class(), ReturnClass::kIgnored);
      EXPECT_FALSE(packed.labelled());
      EXPECT_FALSE(packed.height_known());
    }
  }
}

// Every class with every height: no field touches another one.
TEST(PackedReturn, KeepsItsFieldsApart) {
  for (const uint32_t range_mm : {0u, 0x7ffffu}) {
    for (const bool self : {false, true}) {
      for (int c = 0; c <= 4; ++c) {
        for (int32_t height_cm = -100; height_cm <= 408; height_cm += 2) {
          const bool labelled = (height_cm / 2) % 2 == 0;
          PackedReturn packed = PackedReturn::Raw(range_mm, self);
          packed.SetClass(ReturnClass::kPerson, !labelled);
          packed.SetHeight(408 - height_cm - 100);
          packed.SetClass(static_cast<ReturnClass>(c), labelled);
          packed.SetHeight(height_cm);
          ASSERT_EQ(packed.range_mm(), range_mm);
          ASSERT_EQ(packed.self(), self);
          ASSERT_EQ(packed.return_class(), static_cast<ReturnClass>(c));
          ASSERT_EQ(packed.labelled(), labelled);
          ASSERT_TRUE(packed.height_known());
          ASSERT_EQ(packed.height_cm(), height_cm);
        }
      }
    }
  }
}

TEST(PackedReturn, RoundsHeightsToItsStepAndSaturates) {
  PackedReturn packed = PackedReturn::Raw(1000, false);
  const int32_t cases[][2] = {{INT32_MIN, -100}, {-101, -100}, {-100, -100},  {407, 408},
                              {408, 408},        {409, 408},   {100000, 408}, {INT32_MAX, 408}};
  for (const auto& [given_cm, held_cm] : cases) {
    packed.SetHeight(given_cm);
    EXPECT_TRUE(packed.height_known());
    EXPECT_EQ(packed.height_cm(), held_cm) << given_cm;
  }
  for (int32_t height_cm = -100; height_cm <= 408; ++height_cm) {
    packed.SetHeight(height_cm);
    EXPECT_LE(std::abs(packed.height_cm() - height_cm), 1);
  }
}

TEST(NearestRange, IsTheNearerOfTheReturnsThatAreThere) {
  const auto column = std::make_unique<LidarColumn>();
  column->range_mm[3] = 5000;
  column->second_range_mm[3] = 2000;
  EXPECT_EQ(NearestRange(*column, 3), 5000u);  // the second one was not written
  column->returns = 2;
  EXPECT_EQ(NearestRange(*column, 3), 2000u);
  column->second_range_mm[3] = 7000;
  EXPECT_EQ(NearestRange(*column, 3), 5000u);
  column->second_range_mm[3] = 0;
  EXPECT_EQ(NearestRange(*column, 3), 5000u);
  column->range_mm[3] = 0;
  column->second_range_mm[3] = 7000;
  EXPECT_EQ(NearestRange(*column, 3), 7000u);
  column->second_range_mm[3] = 0;
  EXPECT_EQ(NearestRange(*column, 3), 0u);
}

}  // namespace
}  // namespace hardpack
