// SPDX-License-Identifier: Apache-2.0
// What the segmenter makes of scenes that an engineer would draw. Levels along the way the lidar
// looks, o the lidar.
#include "test/core/segmentation/scene.h"

namespace hardpack {
namespace {

bool IsGround(const Seen& item) {
  return item.what == ReturnClass::kGround;
}
bool IsHard(const Seen& item) {
  return item.what == ReturnClass::kHard;
}
bool IsSoft(const Seen& item) {
  return item.what == ReturnClass::kSoft;
}
// Of the ground near enough to matter: far away, at grazing angles, its rings are ragged.
bool OfGround(const Seen& item) {
  return item.thing == -1 && item.level_m < 35.0;
}
auto OfThing(int thing) {
  return [thing](const Seen& item) { return item.thing == thing; };
}

//  o
//  |____________________________
TEST(SegmentationScenes, FlatGroundIsGroundAndObserved) {
  World world;
  const std::vector<Seen> seen = world.Look();
  EXPECT_GE(Share(seen, OfGround, IsGround), 0.995);
  const auto near = [](const Seen& item) { return item.level_m > 4.8 && item.level_m < 20.0; };
  EXPECT_GE(Share(seen, near, [](const Seen& item) { return item.observed_from >= 0; }), 0.9);
  EXPECT_EQ(Share(seen, OfGround, IsObstacle), 0.0);
}

//                        __.-'
//  o              __.-''
//  |________.-'' 25 degrees
// SR-PER07
TEST(SegmentationScenes, SlopesOf25DegreesAreGround) {
  for (const double slope : {0.466, -0.25}) {
    World world;
    world.ground = [slope](int) { return Profile{{0.0, 0.0}, {6.0, 0.0}, {40.0, 34.0 * slope}}; };
    const std::vector<Seen> seen = world.Look();
    EXPECT_GE(Share(seen, OfGround, IsGround), 0.98) << slope;
    EXPECT_EQ(Share(seen, OfGround, IsObstacle), 0.0) << slope;
  }
}

//      /      the vehicle stands on the slope itself, or drives up to one that begins at its nose
//   o /
//  //'
TEST(SegmentationScenes, APitchedVehicleSeesItsSlopeAsGround) {
  for (const double degrees : {25.0, -25.0}) {
    const double slope = std::tan(degrees * M_PI / 180.0);
    World world;
    world.ground = [slope](int) { return Profile{{0.0, 0.0}, {60.0, 60.0 * slope}}; };
    world.pitch_rad = degrees * M_PI / 180.0;
    const std::vector<Seen> standing = world.Look();
    EXPECT_GE(Share(standing, OfGround, IsGround), 0.98) << degrees;
    EXPECT_EQ(Share(standing, OfGround, IsObstacle), 0.0) << degrees;
  }
  World level;
  level.ground = [](int) { return Profile{{0.0, 0.0}, {1.0, 0.0}, {60.0, 59.0 * 0.466}}; };
  const std::vector<Seen> ahead = level.Look();
  EXPECT_GE(Share(ahead, OfGround, IsGround), 0.95);
  EXPECT_EQ(Share(ahead, OfGround, IsObstacle), 0.0);
}

//                 ___________      ______
//  o              |     or         |    |
//  |______________|          ______|    |________
TEST(SegmentationScenes, AKerbOfSixtyCentimetresStandsUp) {
  for (const double level_m : {3.0, 5.0, 8.0, 11.0}) {
    for (const double depth_m : {1.0, 60.0}) {
      World world;
      world.ground = [=](int) {
        return Profile{{0.0, 0.0},
                       {level_m, 0.0},
                       {level_m, 0.6},
                       {level_m + depth_m, 0.6},
                       {level_m + depth_m, 0.0},
                       {100.0, 0.0}};
      };
      const std::vector<Seen> seen = world.Look();
      const auto top_of_face = [=](const Seen& item) {
        return std::abs(item.level_m - level_m) < 0.08 && item.height_m > 0.52 &&
               item.height_m < 0.58;
      };
      EXPECT_GE(Share(seen, top_of_face, IsObstacle), 0.95) << level_m << " " << depth_m;
      const auto before = [=](const Seen& item) { return item.level_m < level_m - 1.0; };
      if (level_m > 5.5) {
        EXPECT_GE(Share(seen, before, IsGround), 0.99) << level_m;
      }
    }
  }
}

//  o                                  one box, as wide as the middle third of the directions
//  |          ____
//  |_________|    |______________
TEST(SegmentationScenes, ABoxNearbyHasHardSidesAndAHardTop) {
  World world;
  world.ground = [](int direction) {
    if (direction < 27 || direction >= 54) return FlatGround();
    return Profile{{0.0, 0.0}, {5.0, 0.0}, {5.0, 0.6}, {6.0, 0.6}, {6.0, 0.0}, {100.0, 0.0}};
  };
  const std::vector<Seen> seen = world.Look();
  const auto top = [](const Seen& item) {
    return item.level_m > 4.9 && item.level_m < 6.1 && item.height_m > 0.55;
  };
  // Its far edge, seen at a grazing angle with the ground far behind, may look like vegetation.
  EXPECT_GE(Share(seen, top, IsHard), 0.9);
  EXPECT_GE(Share(seen, top, IsObstacle), 0.95);
  const auto beside = [](const Seen& item) {
    return OfGround(item) && (item.direction < 25 || item.direction > 56);
  };
  EXPECT_GE(Share(seen, beside, IsGround), 0.99);
}

//  o
//  |_________        ____________
//            |______|
// SR-PER09
TEST(SegmentationScenes, ADitchIsNotObservedAndGroundGoesOnBeyond) {
  World world;
  world.ground = [](int) {
    return Profile{{0.0, 0.0}, {8.0, 0.0}, {8.0, -1.0}, {10.0, -1.0}, {10.0, 0.0}, {100.0, 0.0}};
  };
  const std::vector<Seen> seen = world.Look();
  const auto beyond = [](const Seen& item) { return item.level_m > 10.2 && item.level_m < 25.0; };
  EXPECT_GE(Share(seen, beyond, IsGround), 0.95);
  EXPECT_EQ(Share(seen, beyond, IsObstacle), 0.0);
  // The first beyond: nothing connects it with the ground on this side.
  const auto across = [&](const Seen& item) {
    if (item.observed_from < 0 || item.level_m < 8.1) return false;
    const double from_m = kSensorHeight_m / -world.Slope(item.observed_from);
    return from_m < 8.1;
  };
  const auto all = [](const Seen&) { return true; };
  EXPECT_EQ(Share(seen, all, across), 0.0);
}

//  o
//  |__________________
//        .  .            a few returns from below the ground, some of them side by side
TEST(SegmentationScenes, MultipathBelowTheGroundDoesNotDragItDown) {
  World world;
  auto segmenter = std::make_unique<Segmenter>();
  ASSERT_EQ(segmenter->Configure({}, World::kBeams), Status::kOk);
  int wrong = 0;
  int right = 0;
  for (int direction = 0; direction < 40; ++direction) {
    DirectionView view;
    view.beams = World::kBeams;
    view.sensor_height_m = static_cast<float>(kSensorHeight_m);
    for (int beam = 0; beam < World::kBeams; ++beam) {
      const double slope = world.Slope(beam);
      view.slope[beam] = static_cast<float>(slope);
      if (slope > -0.03) continue;
      // Two beams of three directions, and one beam of one.
      const bool below = (direction >= 20 && direction < 23 && (beam == 8 || beam == 9)) ||
                         (direction == 30 && beam == 12);
      const double level_m = (kSensorHeight_m + (below ? 1.5 : 0.0)) / -slope;
      view.seen[beam] = true;
      view.level_m[beam] = static_cast<float>(level_m);
      view.height_m[beam] = static_cast<float>(kSensorHeight_m + slope * level_m);
      view.range_m[beam] = static_cast<float>(level_m * std::sqrt(1.0 + slope * slope));
    }
    ASSERT_EQ(segmenter->Push(view), Status::kOk);
    if (!segmenter->ready()) continue;
    for (int beam = 12; beam < 25; ++beam) {
      const int there = direction - Segmenter::kLag;
      if (there == 30 && beam == 12) continue;
      const bool is_ground = segmenter->result().what[beam] == ReturnClass::kGround &&
                             std::abs(segmenter->result().above_ground_m[beam]) < 0.1f;
      (is_ground ? right : wrong) += 1;
    }
    if (direction - Segmenter::kLag == 30) {
      EXPECT_EQ(segmenter->result().what[12], ReturnClass::kIgnored);
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(right, 0);
}

//  o            .:.:.
//  |           .:.:.:.
//  |___________:.:.:.:_______
TEST(SegmentationScenes, ABushIsSoft) {
  for (const double level_m : {7.0, 10.0}) {
    World world;
    world.things.push_back(Leaves(level_m, 0.0, 0.8, 0.0, 1.2, 0.5, world.random()));
    const std::vector<Seen> seen = world.Look();
    const auto bush = [](const Seen& item) {
      return item.thing == 0 && item.above_ground_m > 0.5f;
    };
    EXPECT_GE(Share(seen, bush, IsSoft), 0.9) << level_m;
    EXPECT_GE(Share(seen, OfGround, IsGround), 0.97) << level_m;
  }
}

//  o           .:. .:.
//  |          .:.|#|.:.
//  |__________:.:|#|:.:______
TEST(SegmentationScenes, ATrunkInsideABushIsHard) {
  struct Case {
    double level_m;
    double radius_m;
    double least_share;
  };
  // The last is three directions wide, with leaves in front of half of it.
  for (const Case& one : {Case{7.0, 0.15, 0.97}, {10.0, 0.1, 0.97}, {10.0, 0.05, 0.8}}) {
    double hard = 0.0;
    for (uint32_t seed = 1; seed <= 10; ++seed) {
      World world(seed);
      world.things.push_back(Leaves(one.level_m, 0.0, 0.9, 0.0, 1.2, 0.5, world.random()));
      world.things.push_back(Cylinder(one.level_m, 0.0, one.radius_m, 0.0, 1.2));
      const std::vector<Seen> seen = world.Look();
      const auto trunk = [](const Seen& item) { return item.thing == 1 && item.height_m > 0.5; };
      hard += 0.1 * Share(seen, trunk, IsHard);
    }
    EXPECT_GE(hard, one.least_share) << one.level_m << " " << one.radius_m;
  }
}

//  o            the bush reaches to 2.6 m: a tree
TEST(SegmentationScenes, WhatReachesAboveTheVehicleIsHard) {
  World world;
  world.things.push_back(Leaves(8.0, 0.0, 0.9, 0.0, 2.8, 0.5, world.random()));
  const std::vector<Seen> seen = world.Look();
  const auto inner = [](const Seen& item) {
    return item.thing == 0 && item.height_m > 0.5 && item.direction > 25 && item.direction < 57;
  };
  EXPECT_GE(Share(seen, inner, IsHard), 0.9);
}

//  o
//  |   ,,,,,,,,,,,,,,,,   returns from anywhere up to 0.4 m
TEST(SegmentationScenes, GrassIsNoObstacle) {
  World world;
  world.things.push_back([&world](double, double slope) {
    // A blade at a random height below the top, where the ray passes it.
    const double height_m = std::uniform_real_distribution(0.0, 0.4)(world.random());
    return slope < -0.02 ? (kSensorHeight_m - height_m) / -slope : kNowhere_m;
  });
  const std::vector<Seen> seen = world.Look();
  const auto all = [](const Seen& item) { return item.level_m < 20.0; };
  EXPECT_LE(Share(seen, all, IsObstacle), 0.01);
  EXPECT_LE(Share(seen, all, IsHard), 0.25);
}

//  o  '  ,  '
//  | '  '  ,  '  ,
//  |__________________
// SR-PER07
TEST(SegmentationScenes, RainIsIgnored) {
  World world(3);
  world.rain_share = 0.01;
  const std::vector<Seen> seen = world.Look();
  const auto drop = [](const Seen& item) {
    return item.thing == World::kRain && item.height_m > 0.5;
  };
  EXPECT_GE(Share(seen, drop, [](const Seen& item) { return item.what == ReturnClass::kIgnored; }),
            0.9);
  EXPECT_GE(Share(seen, OfGround, IsGround), 0.98);
}

//  o           O
//  |          /|\      an upright cylinder of half a metre
//  |__________/_\____
// SR-PER10
TEST(SegmentationScenes, EveryReturnOfAPersonAboveHalfAMetreIsHard) {
  for (const double level_m : {2.5, 4.0, 7.0, 10.0, 15.0, 25.0}) {
    World world(static_cast<uint32_t>(level_m * 10.0));
    world.things.push_back(Cylinder(level_m, 0.0, 0.25, 0.0, 1.75));
    const std::vector<Seen> seen = world.Look();
    const auto body = [](const Seen& item) { return item.thing == 0 && item.height_m > 0.52; };
    EXPECT_EQ(Share(seen, body, IsHard), 1.0) << level_m;
    const auto chest = [](const Seen& item) { return item.thing == 0 && item.height_m > 0.65; };
    EXPECT_EQ(Share(seen, chest, IsObstacle), 1.0) << level_m;
  }
}

//  o      |  |  |  |     posts of 6 cm, two metres apart, a wire between them
//  |______|__|__|__|_
// SR-PER02
TEST(SegmentationScenes, AFenceIsHard) {
  World world;
  for (const double y_m : {-0.8, -0.2, 0.4}) {
    world.things.push_back(Cylinder(8.0, y_m, 0.03, 0.0, 1.2));
  }
  world.things.push_back([](double, double slope) {
    const double z_m = kSensorHeight_m + slope * 8.0;
    return z_m > 0.85 && z_m < 0.93 ? 8.0 : kNowhere_m;
  });
  const std::vector<Seen> seen = world.Look();
  const auto fence = [](const Seen& item) { return item.thing >= 0 && item.height_m > 0.55; };
  EXPECT_GE(Share(seen, fence, IsObstacle), 0.98);
  EXPECT_GE(Share(seen, fence, IsHard), 0.95);
}

//  o        =====  2.5 m
//  |
//  |__________________
TEST(SegmentationScenes, AnOverhangingBranchLeavesTheGroundAlone) {
  World world;
  world.things.push_back(Cylinder(8.0, 0.0, 0.3, 2.5, 2.7));
  const std::vector<Seen> seen = world.Look();
  const auto high = [](const Seen& item) {
    return item.ground_known && item.above_ground_m > 2.3f;
  };
  EXPECT_EQ(Share(seen, OfThing(0), high), 1.0);
  EXPECT_GE(Share(seen, OfGround, IsGround), 0.99);
}

}  // namespace
}  // namespace hardpack
