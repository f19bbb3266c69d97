// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/drive_record.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tools/fit/vehicle_fit.h"

namespace hardpack::fit {
namespace {

constexpr const char* kRows[] = {
    "0,0,0.0,5,6,1,1,0,0,0,0,0,3.1\n", "0,1,0.05,5,6,1,1.5,0,0,0,0,0,3.1\n",
    "0,2,0.1,5,6,1,1.5,0.1,0,0,0,0,-3.1\n", "0,3,0.15,5,6,1.2,1.5,0.1,0,0,0,0,-3.1\n"};

std::string Good() {
  std::string text = std::string(kDriveRecordHeader) + "\n";
  for (const char* row : kRows) text += row;
  return text;
}

std::string Refused(const std::string& text) {
  std::vector<DriveSegment> segments(1);
  const ReadOutcome outcome = ParseDriveRecord(text, "d.csv", segments);
  EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  EXPECT_EQ(segments.size(), 1u) << "touched";
  return outcome.message;
}

TEST(DriveRecord, MarksWhatIsFreshAndUnwrapsTheYaw) {
  std::vector<DriveSegment> segments;
  ASSERT_TRUE(ParseDriveRecord(Good(), "d.csv", segments).ok());
  ASSERT_EQ(segments.size(), 1u);
  const std::vector<DriveSample>& samples = segments[0].samples;
  ASSERT_EQ(samples.size(), 4u);
  EXPECT_FALSE(samples[0].fresh_left || samples[0].fresh_right || samples[0].fresh_pose);
  EXPECT_TRUE(samples[1].fresh_right);
  EXPECT_FALSE(samples[1].fresh_left || samples[1].fresh_pose);
  EXPECT_TRUE(samples[2].fresh_pose);
  EXPECT_FALSE(samples[2].fresh_right);
  EXPECT_NEAR(samples[2].yaw_rad, 3.1 + 0.0831853, 1.0e-6);
  EXPECT_TRUE(samples[3].fresh_left);
  EXPECT_FALSE(samples[3].fresh_pose);
}

TEST(DriveRecord, KnowsTheSetpointsBeforeASegmentThatGoesOn) {
  std::string text = Good();
  const auto add = [&text](int segment, double wheel) {
    for (int i = 0; i < 4; ++i) {
      text += std::to_string(segment) + "," + std::to_string(i) + "," + std::to_string(0.05 * i) +
              ",7,8," + std::to_string(wheel) + "," + std::to_string(wheel) + ",0,0,0,0,0,0\n";
    }
  };
  add(1, 1.4);   // goes on
  add(2, -3.0);  // after a break
  add(4, -3.0);  // one is missing
  std::vector<DriveSegment> segments;
  ASSERT_TRUE(ParseDriveRecord(text, "d.csv", segments).ok());
  ASSERT_EQ(segments.size(), 4u);
  EXPECT_FALSE(segments[0].has_history);
  EXPECT_TRUE(segments[1].has_history);
  EXPECT_EQ(segments[1].history, (sim::WheelSpeeds{5.0, 6.0}));
  EXPECT_FALSE(segments[2].has_history);
  EXPECT_EQ(segments[2].history, (sim::WheelSpeeds{-3.0, -3.0}));
  EXPECT_FALSE(segments[3].has_history);
}

TEST(DriveRecord, RefusesWhatItCannotUse) {
  EXPECT_NE(Refused("").find("d.csv"), std::string::npos);
  EXPECT_NE(Refused("a,b\n1,2\n").find("d.csv:1"), std::string::npos);
  EXPECT_NE(Refused(Good() + "0,4,0.2,5,nan,1,1,0,0,0,0,0,0\n").find("d.csv:6"), std::string::npos);
  EXPECT_NE(Refused(Good() + "0,4,0.2,5,6,1,1,0,0,0,0,0\n").find("d.csv:6"), std::string::npos);
  EXPECT_NE(Refused(Good() + "0,4,0.2,5,6,1,1,0,0,0,0,0,0,9\n").find("d.csv:6"), std::string::npos);
  EXPECT_NE(Refused(Good() + "0,4,0.2,5,6,1e300,1,0,0,0,0,0,0\n").find("d.csv:6"),
            std::string::npos);
  EXPECT_NE(Refused(Good() + "0,4,0.1,5,6,1,1,0,0,0,0,0,0\n").find("time"), std::string::npos);
  EXPECT_NE(Refused(Good() + "-1,0,0,5,6,1,1,0,0,0,0,0,0\n").find("segment"), std::string::npos);
  EXPECT_NE(Refused(Good() + "3e9,0,0,5,6,1,1,0,0,0,0,0,0\n").find("d.csv:6"), std::string::npos);
  EXPECT_NE(Refused(Good() + "1.5,0,0,5,6,1,1,0,0,0,0,0,0\n").find("segment"), std::string::npos);
  EXPECT_NE(Refused(Good() + "1,0,0,5,6,1,1,0,0,0,0,0,0\n").find("fewer than 4"),
            std::string::npos);
}

std::vector<DriveSegment> Numbered(int runs) {
  std::vector<DriveSegment> segments;
  for (int run = 0; run < runs; ++run) {
    for (int part = 0; part < 7; ++part) segments.emplace_back().number = 10 * run + part;
  }
  return segments;
}

TEST(SplitByRun, HoldsOutWholeRunsByItsSeed) {
  const std::vector<DriveSegment> segments = Numbered(20);
  const Split split = SplitByRun(segments, 0.3, 1);
  EXPECT_EQ(split.held_out.size(), 6u * 7u);
  EXPECT_EQ(split.fit.size(), 14u * 7u);
  std::set<int> fitted;
  for (const DriveSegment& segment : split.fit) fitted.insert(segment.run());
  for (const DriveSegment& segment : split.held_out) EXPECT_FALSE(fitted.contains(segment.run()));
  const Split again = SplitByRun(segments, 0.3, 1);
  const Split other = SplitByRun(segments, 0.3, 2);
  const auto numbers = [](const Split& one) {
    std::vector<int> list;
    for (const DriveSegment& segment : one.held_out) list.push_back(segment.number);
    return list;
  };
  EXPECT_EQ(numbers(split), numbers(again));
  EXPECT_NE(numbers(split), numbers(other));
}

}  // namespace
}  // namespace hardpack::fit
