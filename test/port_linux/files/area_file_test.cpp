// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/area_file.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "port_linux/files/configuration.h"
#include "test/port_linux/files/configuration_texts.h"

namespace hardpack {
namespace {

constexpr const char* kThree =
    "# a site\n"
    "keep_out odom   # a pond\n"
    "12.0005 -3\n16 -3.0\n+16 2\n"
    "\n"
    "fence latlon\n30.600000000 -96.300000000\n30.6 -96.299\n30.601 -96.299\n"
    "speed_zone odom 1.5\n0 0\n5 0\n5 5\n0 5\n";

std::string AreaMessage(const std::string& text) {
  AreaList areas;
  return ParseAreas(text, "f", areas).message;
}

// SR-ARE01
TEST(AreaFile, TakesAreasOfEveryKind) {
  const auto areas = std::make_unique<AreaList>();
  const ReadOutcome outcome = ParseAreas(kThree, "f", *areas);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  ASSERT_EQ(areas->size(), 3);
  EXPECT_EQ((*areas)[0].kind, AreaKind::kKeepOut);
  EXPECT_EQ((*areas)[0].corners, 3);
  EXPECT_EQ((*areas)[0].corner[0], (AreaCorner{.x_mm = 12'001, .y_mm = -3000}));
  EXPECT_EQ((*areas)[1].kind, AreaKind::kFence);
  EXPECT_EQ((*areas)[1].frame, AreaFrame::kEarth);
  EXPECT_EQ((*areas)[1].corner[2].latitude_ndeg, 30'601'000'000);
  EXPECT_EQ((*areas)[1].corner[2].longitude_ndeg, -96'299'000'000);
  EXPECT_EQ((*areas)[2].speed_mps, 1.5f);
  EXPECT_EQ((*areas)[2].corners, 4);
}

TEST(AreaFile, NamesTheLineOfWhatIsWrong) {
  const std::string triangle = "0 0\n4 0\n0 4\n";
  struct Case {
    std::string text;
    const char* message;
  };
  const Case cases[] = {
      {"", "f:0: no area"},
      {"# nothing\n", "f:1: no area"},
      {"1 2\n", "f:1: the first word must be keep_out"},
      {"pond odom\n", "f:1: 'pond' is not keep_out"},
      {"keep_out\n", "f:1: the second word must be odom or latlon"},
      {"keep_out map\n", "f:1: the second word must be odom or latlon"},
      {"keep_out odom 1.0\n", "f:1: only a speed zone has a speed"},
      {"speed_zone odom\n", "f:1: a speed zone has a speed"},
      {"speed_zone odom fast\n", "f:1: 'fast' is not a number"},
      {"speed_zone odom nan\n", "f:1: 'nan' is out of range"},
      {"speed_zone odom 0.05\n" + triangle, "f:1: it needs three corners"},
      {"keep_out odom\n1\n", "f:2: expected x and y"},
      {"keep_out odom\n1 2 3\n", "f:2: expected x and y"},
      {"keep_out odom\n1 two\n", "f:2: y: 'two' is not a number"},
      {"keep_out odom\n1 1e9\n", "f:2: y: '1e9' is out of range"},
      {"keep_out odom\n1 inf\n", "f:2: y: 'inf' is out of range"},
      {"fence latlon\n91 0\n", "f:2: latitude: '91' is not within 90"},
      {"fence latlon\n1 2\n1 181\n", "f:3: longitude: '181' is not within 180"},
      {"fence latlon\n1.0000000001 2\n", "f:2: latitude: '1.0000000001' has more than nine"},
      {"keep_out odom\n0 0\n4 0\n", "f:1: it needs three corners"},
      {"\nkeep_out odom\n0 0\n4 4\n4 0\n0 4\n", "f:2: its border touches or crosses itself"},
      {"keep_out odom\n0 0\n0.1 0\n0 0.1\n", "f:1: it is smaller than a cell"},
      {"fence odom\n" + triangle + "fence odom\n" + triangle, "f:5: there is a fence already"},
  };
  for (const Case& one : cases) {
    const std::string message = AreaMessage(one.text);
    EXPECT_EQ(message.substr(0, std::string(one.message).size()), one.message);
  }
}

TEST(AreaFile, TakesSixtyFourAreasAndThirtyTwoCornersAndNoMore) {
  std::string text;
  for (int i = 0; i < kMaxAreas; ++i) text += "keep_out odom\n0 0\n4 0\n0 4\n";
  EXPECT_EQ(AreaMessage(text), "");
  EXPECT_EQ(AreaMessage(text + "keep_out odom\n0 0\n4 0\n0 4\n"), "f:257: more than 64 areas");
  std::string comb = "keep_out odom\n";
  for (int i = 0; i < kMaxAreaCorners - 1; ++i) {
    comb += std::to_string(i) + (i % 2 == 0 ? " 1\n" : " 2\n");
  }
  comb += "15 0\n";
  EXPECT_EQ(AreaMessage(comb), "");
  EXPECT_EQ(AreaMessage(comb + "14 0\n"), "f:34: more than 32 corners");
}

TEST(AreaFile, LeavesTheListAsItWasOnFailure) {
  const auto areas = std::make_unique<AreaList>();
  ASSERT_TRUE(ParseAreas(kThree, "f", *areas).ok());
  EXPECT_FALSE(ParseAreas("keep_out odom\n", "f", *areas).ok());
  EXPECT_EQ(areas->size(), 3);
  EXPECT_FALSE(ReadAreas("/nowhere/areas.txt", *areas).ok());
}

std::string ConfigurationMessage(const std::string& lines) {
  Configuration configuration;
  return ParseConfiguration(kRequiredLines + lines, "f", configuration).message;
}

// What is written reads back as the same: of every kind, to the last digit.
TEST(ConfigurationAreas, ComeBackAsTheyWere) {
  Configuration configuration = Parsed(kRequiredLines);
  EXPECT_EQ(ToToml(configuration).find("[[area]]"), std::string::npos);
  ASSERT_TRUE(ParseAreas(kThree, "f", configuration.areas).ok());
  configuration.areas[0].corner[1] = {.x_mm = -99'999'999, .y_mm = -1};
  configuration.areas[1].corner[0].latitude_ndeg = 30'600'000'001;
  configuration.areas[1].corner[0].longitude_ndeg = -96'299'999'999;
  configuration.areas[2].speed_mps = 0.3f;
  ASSERT_EQ(CheckAreas(configuration.areas), Status::kOk);
  const Configuration again = Parsed(ToToml(configuration));
  ASSERT_EQ(again.areas.size(), 3);
  for (int i = 0; i < 3; ++i) {
    const Area& a = configuration.areas[i];
    const Area& b = again.areas[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_EQ(a.speed_mps, b.speed_mps);
    ASSERT_EQ(a.corners, b.corners);
    for (int k = 0; k < a.corners; ++k) EXPECT_EQ(a.corner[k], b.corner[k]) << i << ", " << k;
  }
}

TEST(ConfigurationAreas, NameTheLineOfWhatIsWrong) {
  const std::string head = "[[area]]\nkind = 'keep_out'\nframe = 'odom'\n";
  const std::string corners = "corners = [[0, 0], [4, 0.0], [0, 4]]\n";
  EXPECT_EQ(ConfigurationMessage(head + corners), "");
  struct Case {
    std::string lines;
    const char* message;
  };
  const Case cases[] = {
      {"[area]\nkind = 'fence'\n", "f:7: area: expected tables: [[area]]"},
      {"area = [1, 2]\n", "f:7: area: expected tables: [[area]]"},
      {"[[area]]\nkind = 'pond'\n", "f:8: area 1.kind: must be"},
      {"[[area]]\nkind = 'fence'\nframe = 'map'\n", "f:9: area 1.frame: must be"},
      {"[[area]]\nframe = 'odom'\n", "f:7: area 1.kind: must be"},
      {head, "f:7: area 1.corners: must be a list"},
      {head + "corners = [[0, 0], [1]]\n", "f:10: area 1.corners: each must be [x, y]"},
      {head + "corners = [[0, 0], [nan, 1]]\n", "f:10: area 1.corners: each must be [x, y]"},
      {head + "corners = [[0, 0], [1e6, 1]]\n", "f:10: area 1.corners: each must be [x, y]"},
      {head + "speed_mps = 1.0\n" + corners, "f:10: area 1.speed_mps: only a speed zone"},
      {head + "name = 'pond'\n" + corners, "f:10: area 1: an area has kind, frame"},
      {head + "corners = [[0, 0], [4, 4], [4, 0], [0, 4]]\n", "f:7: area 1: its border touches"},
      {head + corners + head + "corners = [[0, 0], [4, 4]]\n", "f:11: area 2: it needs three"},
      {"[[area]]\nkind = 'speed_zone'\nframe = 'odom'\n" + corners, "f:7: area 1.speed_mps: must"},
  };
  for (const Case& one : cases) {
    const std::string message = ConfigurationMessage(one.lines);
    EXPECT_EQ(message.substr(0, std::string(one.message).size()), one.message);
  }
  std::string many;
  for (int i = 0; i <= kMaxAreas; ++i) many += head + corners;
  EXPECT_EQ(ConfigurationMessage(many), "f:263: area 65: there are more than 64");
}

}  // namespace
}  // namespace hardpack
