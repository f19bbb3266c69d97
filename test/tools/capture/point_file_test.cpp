// SPDX-License-Identifier: Apache-2.0
// Files of plain points: what is read of them, and what is said of those that cannot be.
#include "tools/capture/point_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

namespace hardpack::capture {
namespace {

class PointFile : public testing::Test {
 protected:
  ReadOutcome Read(const std::string& name, const std::string& content) {
    const std::string path = testing::TempDir() + "point_file_" +
                             testing::UnitTest::GetInstance()->current_test_info()->name() + name;
    std::ofstream(path, std::ios::binary) << content;
    const ReadOutcome outcome = ReadPoints(path, cloud_);
    std::filesystem::remove(path);
    if (!outcome.ok()) {
      EXPECT_NE(outcome.message.find(path), std::string::npos) << outcome.message;
      EXPECT_TRUE(cloud_.points.empty());
    }
    return outcome;
  }

  void ExpectPoint(size_t i, Vec3 position, int ring) {
    ASSERT_LT(i, cloud_.points.size());
    EXPECT_EQ(cloud_.points[i].position.x_m, position.x_m) << i;
    EXPECT_EQ(cloud_.points[i].position.y_m, position.y_m) << i;
    EXPECT_EQ(cloud_.points[i].position.z_m, position.z_m) << i;
    EXPECT_EQ(cloud_.points[i].ring, ring) << i;
  }

  void ExpectRefused(const std::string& name, const std::string& content, Status status,
                     const std::string& what) {
    const ReadOutcome outcome = Read(name, content);
    EXPECT_EQ(outcome.status, status) << content;
    EXPECT_NE(outcome.message.find(what), std::string::npos) << outcome.message;
  }

  PointCloud cloud_;
};

template <typename T>
std::string BytesOf(T value) {
  std::string bytes(sizeof(value), '\0');
  std::memcpy(bytes.data(), &value, sizeof(value));
  return bytes;
}

// As the format's description has it ([PCD]), but for the points.
const std::string kAsciiHeader =
    "# .PCD v.7 - Point Cloud Data file format\n"
    "VERSION .7\n"
    "FIELDS x y z rgb\n"
    "SIZE 4 4 4 4\n"
    "TYPE F F F F\n"
    "COUNT 1 1 1 1\n"
    "WIDTH 2\n"
    "HEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\n"
    "POINTS 2\n"
    "DATA ascii\n";

TEST_F(PointFile, ReadsCsvByItsNames) {
  ASSERT_TRUE(
      Read(".csv", "intensity,Z,X,y,laser_id\r\n7, 3,1 ,2,15\r\n\r\n8,-0.5,1e1,-2.5,0\r\n").ok());
  ASSERT_EQ(cloud_.points.size(), 2u);
  ExpectPoint(0, {1.0f, 2.0f, 3.0f}, 15);
  ExpectPoint(1, {10.0f, -2.5f, -0.5f}, 0);
}

TEST_F(PointFile, ReadsCsvWithoutNamesAndWithoutAnEndOfItsLastLine) {
  ASSERT_TRUE(Read(".CSV", "1,2,3,99\n4,5,6,99").ok());
  ASSERT_EQ(cloud_.points.size(), 2u);
  ExpectPoint(0, {1.0f, 2.0f, 3.0f}, -1);
  ExpectPoint(1, {4.0f, 5.0f, 6.0f}, -1);
}

TEST_F(PointFile, CountsPointsThatAreNowhere) {
  ASSERT_TRUE(Read(".csv", "x,y,z\n1,2,3\nnan,nan,nan\n1,inf,2\n1e300,0,0\n").ok());
  EXPECT_EQ(cloud_.points.size(), 1u);
  EXPECT_EQ(cloud_.without_position, 3);
}

TEST_F(PointFile, ReadsAsciiPcdAsItsDescriptionSays) {
  ASSERT_TRUE(Read(".pcd", kAsciiHeader + "0.93773 0.33763 0 4.2108e+06\nnan nan nan 0\n").ok());
  ASSERT_EQ(cloud_.points.size(), 1u);
  ExpectPoint(0, {0.93773f, 0.33763f, 0.0f}, -1);
  EXPECT_EQ(cloud_.without_position, 1);
}

TEST_F(PointFile, ReadsBinaryPcdWithFieldsOfAnyKindInAnyOrder) {
  const std::string header =
      "VERSION 0.7\nFIELDS normal ring z y x\nSIZE 4 2 8 4 4\nTYPE F U F F I\nCOUNT 3 1 1 1 1\n"
      "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nDATA binary\n";
  const auto point = [](uint16_t ring, double z, float y, int32_t x) {
    return BytesOf(0.1f) + BytesOf(0.2f) + BytesOf(0.3f) + BytesOf(ring) + BytesOf(z) + BytesOf(y) +
           BytesOf(x);
  };
  ASSERT_TRUE(Read(".pcd", header + point(3, -1.25, 2.5f, 10) + point(63, 0.5, -1.0f, -7)).ok());
  ASSERT_EQ(cloud_.points.size(), 2u);
  ExpectPoint(0, {10.0f, 2.5f, -1.25f}, 3);
  ExpectPoint(1, {-7.0f, -1.0f, 0.5f}, 63);
}

TEST_F(PointFile, AFieldOfSeveralNumbersTakesAsManyWords) {
  const std::string header =
      "FIELDS n x y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 3 1 1 1\nPOINTS 1\nDATA ascii\n";
  ASSERT_TRUE(Read(".pcd", header + "9 9 9 1 2 3\n").ok());
  ExpectPoint(0, {1.0f, 2.0f, 3.0f}, -1);
}

TEST_F(PointFile, SaysWhatIsWrongWithACsv) {
  ExpectRefused(".csv", "", Status::kInvalidArgument, ":1: ");
  ExpectRefused(".csv", "a,b,c\n1,2,3\n", Status::kInvalidArgument, ":1: neither the names");
  ExpectRefused(".csv", "x,y,z\n1,2,3\n1,2\n", Status::kInvalidArgument, ":3: z");
  ExpectRefused(".csv", "x,y,z\n1,two,3\n", Status::kInvalidArgument, ":2: y");
  ExpectRefused(".csv", "x,y,z,ring\n1,2,3,-1\n", Status::kInvalidArgument, ":2: ring");
  ExpectRefused(".csv", "x,y,z,ring\n1,2,3,1.5\n", Status::kInvalidArgument, ":2: ring");
  ExpectRefused(".csv", "x,y,z\nnan,nan,nan\n", Status::kEmpty, "no points");
}

TEST_F(PointFile, SaysWhatIsWrongWithAPcd) {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string header = kAsciiHeader;
    return header.replace(header.find(from), from.size(), to);
  };
  const std::string points = "1 2 3 4\n5 6 7 8\n";
  ExpectRefused(".pcd", "", Status::kInvalidArgument, "no DATA");
  ExpectRefused(".pcd", kAsciiHeader.substr(0, 60), Status::kInvalidArgument, "");
  ExpectRefused(".pcd",
                "\x7f"
                "ELF",
                Status::kInvalidArgument, ":1: ");
  ExpectRefused(".pcd", changed("x y z rgb", "x y w rgb") + points, Status::kInvalidArgument,
                "FIELDS");
  ExpectRefused(".pcd", changed("SIZE 4 4 4 4", "SIZE 4 4 4") + points, Status::kInvalidArgument,
                ":4: SIZE");
  ExpectRefused(".pcd", changed("POINTS 2", "POINTS two") + points, Status::kInvalidArgument,
                ":10: POINTS");
  ExpectRefused(".pcd", changed("POINTS 2", "POINTS 99999999999") + points,
                Status::kCapacityExceeded, "POINTS");
  ExpectRefused(".pcd", kAsciiHeader + "1 2 3 4\n", Status::kTruncated, "there are 1");
  ExpectRefused(".pcd", changed("ascii", "binary_compressed") + points, Status::kUnsupported,
                "binary_compressed");
  ExpectRefused(".pcd", changed("ascii", "binary") + points, Status::kTruncated, "cut off");
  ExpectRefused(
      ".pcd",
      changed("TYPE F F F F\n", "TYPE X F F F\n")
              .replace(changed("TYPE F F F F\n", "TYPE X F F F\n").find("ascii"), 5, "binary") +
          std::string(32, '\0'),
      Status::kInvalidArgument, "x: not one number");
}

TEST_F(PointFile, KnowsAFileByItsName) {
  ExpectRefused(".ply", "ply\n", Status::kUnsupported, ".pcd");
  EXPECT_FALSE(ReadPoints("/nowhere/cloud.csv", cloud_).ok());
}

}  // namespace
}  // namespace hardpack::capture
