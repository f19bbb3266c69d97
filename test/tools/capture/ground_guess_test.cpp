// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/ground_guess.h"

#include <gtest/gtest.h>

#include <vector>

namespace hardpack::capture {
namespace {

constexpr Vec3 kVehicle = {0.0f, 0.0f, 0.0f};

ClassedPoint At(float x_m, float y_m, float z_m) {
  return {{x_m, y_m, z_m}, ReturnClass::kIgnored};
}

//        o  1.2 m        o 0.4 m
//  ______o_______________o____ ground
TEST(GroundGuess, TellsPostsFromTheGroundAroundThem) {
  std::vector<ClassedPoint> points = {At(8.0f, 0.0f, 0.0f), At(8.1f, 0.0f, 1.2f),
                                      At(12.0f, 0.0f, 0.0f), At(12.1f, 0.0f, 0.4f)};
  GuessGround(kVehicle, points);
  EXPECT_EQ(points[0].return_class, ReturnClass::kGround);
  EXPECT_EQ(points[1].return_class, ReturnClass::kHard);
  EXPECT_EQ(points[2].return_class, ReturnClass::kGround);
  EXPECT_EQ(points[3].return_class, ReturnClass::kGround);
}

// A single ring has no lower return near it: 4 m away it may be a wall, 30 m away a gentle rise.
TEST(GroundGuess, JudgesALoneRingByTheVehiclesFeet) {
  std::vector<ClassedPoint> points = {At(4.0f, 0.0f, 1.0f), At(30.0f, 0.0f, 1.0f)};
  GuessGround(kVehicle, points);
  EXPECT_EQ(points[0].return_class, ReturnClass::kHard);
  EXPECT_EQ(points[1].return_class, ReturnClass::kGround);
}

TEST(GroundGuess, MeasuresFromWhereTheVehicleStands) {
  std::vector<ClassedPoint> points = {At(104.0f, -50.0f, 7.0f), At(104.0f, -48.0f, 7.5f)};
  GuessGround({100.0f, -50.0f, 7.0f}, points);
  EXPECT_EQ(points[0].return_class, ReturnClass::kGround);
  EXPECT_EQ(points[1].return_class, ReturnClass::kGround);
}

TEST(GroundGuess, TakesWhatIsOffTheGridAsHard) {
  std::vector<ClassedPoint> points = {At(60.0f, 0.0f, 0.0f)};
  GuessGround(kVehicle, points);
  EXPECT_EQ(points[0].return_class, ReturnClass::kHard);
}

}  // namespace
}  // namespace hardpack::capture
