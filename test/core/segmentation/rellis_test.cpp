// SPDX-License-Identifier: Apache-2.0
// Precision and recall of the geometric classes on a real, labelled scan. The floors are a little
// below what was measured: they are there to show a change, not to say how good it is.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/segmentation/label_table.h"
#include "test/core/segmentation/rellis_scan.h"

namespace hardpack {
namespace {

constexpr int kPersonLabel = 17;
constexpr int kBushLabel = 19;

struct Classed {
  LabelledReturn item;
  ReturnClass truth;  // by its label; a person is hard
  ReturnClass what;   // by geometry
  bool ground_known;
  float above_ground_m;
};

// What the map would take for an obstacle.
bool IsMapObstacle(const Classed& hit) {
  const bool stands = hit.what == ReturnClass::kHard || hit.what == ReturnClass::kSoft;
  return stands && (!hit.ground_known || hit.above_ground_m > 0.5f);
}

class SegmenterOnRellis : public ::testing::Test {
 protected:
  void SetUp() override {
    RellisScan scan;
    if (!scan.Load()) GTEST_SKIP() << "HARDPACK_DATA holds no rellis/rellis_000104_labelled.csv";
    auto segmenter = std::make_unique<Segmenter>();
    ASSERT_EQ(segmenter->Configure({}, RellisScan::kBeams), Status::kOk);
    const LabelTable table = RellisLabelTable();
    ClassRevolution(scan, *segmenter, [&](int direction, const DirectionClasses& classes) {
      for (int beam = 0; beam < RellisScan::kBeams; ++beam) {
        const LabelledReturn& item = scan.at(direction, beam);
        if (!item.seen) continue;
        ReturnClass truth = table.class_of[item.label];
        if (truth == ReturnClass::kPerson) truth = ReturnClass::kHard;
        classed_.push_back({item, truth, classes.what[beam], classes.ground_known[beam],
                            classes.above_ground_m[beam]});
      }
    });
  }

  template <typename Which>
  double Count(Which which) const {
    double count = 0.0;
    for (const Classed& hit : classed_) count += which(hit) ? 1.0 : 0.0;
    return count;
  }
  double Recall(ReturnClass of) const {
    return Count([=](const Classed& hit) { return hit.truth == of && hit.what == of; }) /
           Count([=](const Classed& hit) { return hit.truth == of; });
  }
  // Of what has a label other than ignored: the void of the labels is mostly the vehicle's rider.
  double Precision(ReturnClass of) const {
    const auto labelled = [](const Classed& hit) { return hit.truth != ReturnClass::kIgnored; };
    return Count([=](const Classed& hit) { return hit.truth == of && hit.what == of; }) /
           Count([=](const Classed& hit) { return labelled(hit) && hit.what == of; });
  }

  std::vector<Classed> classed_;
};

TEST_F(SegmenterOnRellis, ReachesItsPrecisionAndRecall) {
  const std::array names = {"ignored", "ground", "soft", "hard"};
  std::printf("%-10s %9s %9s %9s %9s\n", "label", names[0], names[1], names[2], names[3]);
  for (int truth = 0; truth < 4; ++truth) {
    std::printf("%-10s", names[static_cast<size_t>(truth)]);
    for (int what = 0; what < 4; ++what) {
      std::printf(" %9.0f", Count([=](const Classed& hit) {
                    return static_cast<int>(hit.truth) == truth &&
                           static_cast<int>(hit.what) == what;
                  }));
    }
    std::printf("\n");
  }
  for (const ReturnClass of : {ReturnClass::kGround, ReturnClass::kSoft, ReturnClass::kHard}) {
    std::printf("%-10s precision %.3f recall %.3f\n", names[static_cast<size_t>(of)], Precision(of),
                Recall(of));
  }
  const double bush = Count([](const Classed& hit) { return hit.item.label == kBushLabel; });
  const double soft_bush = Count([](const Classed& hit) {
    return hit.item.label == kBushLabel && hit.what == ReturnClass::kSoft;
  });
  std::printf("of bushes alone soft %.3f\n", soft_bush / bush);
  EXPECT_GE(Recall(ReturnClass::kGround), 0.97);
  EXPECT_GE(Precision(ReturnClass::kGround), 0.83);
  EXPECT_GE(Recall(ReturnClass::kHard), 0.65);
  EXPECT_GE(Precision(ReturnClass::kHard), 0.87);
  EXPECT_GE(soft_bush / bush, 0.26);
  EXPECT_GE(Precision(ReturnClass::kSoft), 0.47);
}

// The dangerous error: driven through instead of around.
TEST_F(SegmenterOnRellis, FewHardReturnsThatStandComeOutSoft) {
  const auto stands = [](const Classed& hit) {
    return hit.truth == ReturnClass::kHard && hit.ground_known && hit.above_ground_m > 0.5f;
  };
  const double standing = Count(stands);
  const double soft =
      Count([&](const Classed& hit) { return stands(hit) && hit.what == ReturnClass::kSoft; });
  std::printf("of %.0f standing hard returns soft %.0f\n", standing, soft);
  ASSERT_GT(standing, 1000.0);
  EXPECT_LE(soft / standing, 0.054);
}

// SR-PER10
TEST_F(SegmenterOnRellis, EveryReturnOfAPersonAboveHalfAMetreIsHard) {
  // Both persons stand on ground within 0.15 m of the vehicle's.
  const auto body = [](const Classed& hit) {
    return hit.item.label == kPersonLabel && hit.item.height_m > 0.7f;
  };
  const auto hard = [](const Classed& hit) { return hit.what == ReturnClass::kHard; };
  ASSERT_GT(Count(body), 1000.0);
  EXPECT_EQ(Count([&](const Classed& hit) { return body(hit) && hard(hit); }), Count(body));
}

// Hard returns 0.5 to 2 m above the lowest return labelled as ground within 1.5 m: most of them
// must become obstacles by geometry alone. On a slope that lowest return lies below the ground at
// the place itself, so not all of them stand up by so much.
TEST_F(SegmenterOnRellis, WhatStandsBecomesAnObstacleAndGroundDoesNot) {
  const auto cell = [](float value_m) { return static_cast<int>(std::floor(value_m / 0.5f)); };
  std::map<std::pair<int, int>, std::vector<const LabelledReturn*>> ground;
  for (const Classed& hit : classed_) {
    if (hit.truth != ReturnClass::kGround) continue;
    ground[{cell(hit.item.x_m), cell(hit.item.y_m)}].push_back(&hit.item);
  }
  const auto lowest_near = [&](const LabelledReturn& item) {
    float lowest_m = 1.0e9f;
    for (int y = cell(item.y_m) - 3; y <= cell(item.y_m) + 3; ++y) {
      for (int x = cell(item.x_m) - 3; x <= cell(item.x_m) + 3; ++x) {
        const auto here = ground.find({x, y});
        if (here == ground.end()) continue;
        for (const LabelledReturn* hit : here->second) {
          if (std::hypot(hit->x_m - item.x_m, hit->y_m - item.y_m) > 1.5f) continue;
          lowest_m = std::min(lowest_m, hit->height_m);
        }
      }
    }
    return lowest_m;
  };
  const auto stands = [&](const Classed& hit) {
    if (hit.truth != ReturnClass::kHard) return false;
    const float height_m = hit.item.height_m - lowest_near(hit.item);
    return height_m > 0.5f && height_m < 2.0f;
  };
  const double standing = Count(stands);
  const double found = Count([&](const Classed& hit) { return stands(hit) && IsMapObstacle(hit); });
  const double missed =
      Count([&](const Classed& hit) { return stands(hit) && hit.what == ReturnClass::kGround; });
  const auto is_ground = [](const Classed& hit) { return hit.truth == ReturnClass::kGround; };
  const double raised =
      Count([&](const Classed& hit) { return is_ground(hit) && IsMapObstacle(hit); }) /
      Count(is_ground);
  std::printf("standing hard returns: %.0f, obstacles %.3f, taken for ground %.3f\n", standing,
              found / standing, missed / standing);
  std::printf("ground returns that become obstacles: %.4f\n", raised);
  ASSERT_GT(standing, 1000.0);
  EXPECT_GE(found / standing, 0.8);
  EXPECT_LE(missed / standing, 0.05);
  EXPECT_LE(raised, 0.004);
}

}  // namespace
}  // namespace hardpack
