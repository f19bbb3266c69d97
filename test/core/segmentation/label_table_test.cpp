// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/label_table.h"

#include <gtest/gtest.h>

namespace hardpack {
namespace {

constexpr float kObstacle_m = 0.5f;

TEST(LabelTable, NamesTheRellisOntology) {
  const LabelTable table = RellisLabelTable();
  EXPECT_EQ(CheckLabelTable(table), Status::kOk);
  EXPECT_EQ(table.class_of[0], ReturnClass::kIgnored);
  EXPECT_EQ(table.class_of[3], ReturnClass::kGround);
  EXPECT_EQ(table.class_of[4], ReturnClass::kHard);
  EXPECT_EQ(table.class_of[17], ReturnClass::kPerson);
  EXPECT_EQ(table.class_of[19], ReturnClass::kSoft);
  EXPECT_EQ(table.class_of[31], ReturnClass::kSoft);
}

// SR-PER01
TEST(LabelTable, TakesACodeThatItDoesNotNameForHard) {
  const LabelTable table = RellisLabelTable();
  for (int code = 35; code < kLabelCodes; ++code)
    EXPECT_EQ(table.class_of[code], ReturnClass::kHard);
  EXPECT_EQ(table.class_of[2], ReturnClass::kHard);
}

TEST(LabelTable, RefusesAnEntryThatIsNoClass) {
  LabelTable table = RellisLabelTable();
  table.class_of[255] = static_cast<ReturnClass>(5);
  EXPECT_EQ(CheckLabelTable(table), Status::kInvalidArgument);
  table.class_of[255] = static_cast<ReturnClass>(255);
  EXPECT_EQ(CheckLabelTable(table), Status::kInvalidArgument);
}

//   label: grass                     grass?
//   ____,,,,____ 0.2 m: ground       |  0.6 m above the ground: something stands there
// SR-PER06
TEST(CheckedLabel, GroundThatStandsUpIsHard) {
  const ReturnClass ground = ReturnClass::kGround;
  const ReturnClass hard = ReturnClass::kHard;
  EXPECT_EQ(CheckedLabel(ground, {hard, 0.2f, true}, kObstacle_m), ground);
  EXPECT_EQ(CheckedLabel(ground, {hard, 0.5f, true}, kObstacle_m), ground);
  EXPECT_EQ(CheckedLabel(ground, {hard, 0.6f, true}, kObstacle_m), hard);
  EXPECT_EQ(CheckedLabel(ground, {ReturnClass::kSoft, 0.6f, true}, kObstacle_m), hard);
  EXPECT_EQ(CheckedLabel(ground, {hard, 0.6f, false}, kObstacle_m), ground);
  // Rain and dust do not stand.
  EXPECT_EQ(CheckedLabel(ground, {ReturnClass::kIgnored, 0.6f, true}, kObstacle_m), ground);
}

// SR-LOW04 labels do not lower what geometry saw.
TEST(CheckedLabel, VoidAndSkyChangeNothing) {
  for (const float height_m : {-1.0f, 0.0f, 0.3f, 0.6f, 3.0f}) {
    for (const ReturnClass what : {ReturnClass::kIgnored, ReturnClass::kGround, ReturnClass::kSoft,
                                   ReturnClass::kHard, ReturnClass::kPerson}) {
      EXPECT_EQ(CheckedLabel(ReturnClass::kIgnored, {what, height_m, true}, kObstacle_m), what);
      EXPECT_EQ(CheckedLabel(ReturnClass::kIgnored, {what, height_m, false}, kObstacle_m), what);
    }
  }
}

TEST(CheckedLabel, HeightChangesNoOtherClass) {
  for (const float height_m : {-1.0f, 0.0f, 0.6f, 3.0f}) {
    for (const ReturnClass said : {ReturnClass::kSoft, ReturnClass::kHard, ReturnClass::kPerson}) {
      EXPECT_EQ(CheckedLabel(said, {ReturnClass::kHard, height_m, true}, kObstacle_m), said);
    }
  }
}

}  // namespace
}  // namespace hardpack
