// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "test/tools/bench/movingai/text_file.h"
#include "tools/bench/movingai/movingai.h"

namespace hardpack {
namespace {

const std::string kHeader = "type octile\nheight 2\nwidth 3\nmap\n";

std::string MapComplaint(const std::string& content) {
  const TextFile file("a.map", content);
  const auto read = ReadMovingaiMap(file.path());
  const auto* complaint = std::get_if<std::string>(&read);
  if (complaint == nullptr) return "";
  EXPECT_EQ(complaint->rfind(file.path() + ":", 0), 0u) << *complaint;
  return complaint->substr(file.path().size());
}

std::string ScenarioComplaint(const std::string& content) {
  const TextFile file("a.scen", content);
  const auto read = ReadMovingaiScenarios(file.path());
  const auto* complaint = std::get_if<std::string>(&read);
  if (complaint == nullptr) return "";
  EXPECT_EQ(complaint->rfind(file.path() + ":", 0), 0u) << *complaint;
  return complaint->substr(file.path().size());
}

TEST(MovingaiMapFile, IsReadRowByRow) {
  const TextFile file("a.map", kHeader + ".GS\n@OW\n");
  const auto read = ReadMovingaiMap(file.path());
  ASSERT_TRUE(std::holds_alternative<MovingaiMap>(read));
  const auto& map = std::get<MovingaiMap>(read);
  EXPECT_EQ(map.width_cells, 3);
  EXPECT_EQ(map.height_cells, 2);
  EXPECT_EQ(map.free, (std::vector<bool>{true, true, true, false, false, false}));
}

TEST(MovingaiMapFile, MayEndItsLinesWithCrLf) {
  EXPECT_EQ(MapComplaint("type octile\r\nheight 2\r\nwidth 3\r\nmap\r\n...\r\n.T.\r\n"), "");
}

TEST(MovingaiMapFile, MayLackTheLastNewline) {
  EXPECT_EQ(MapComplaint(kHeader + "...\n..."), "");
}

TEST(MovingaiMapFile, SaysWhereItIsWrong) {
  EXPECT_EQ(MapComplaint(""), ":0: the file ends where \"type octile\" should be");
  EXPECT_EQ(MapComplaint("type hexagon\n"), ":1: expected \"type octile\"");
  EXPECT_EQ(MapComplaint("type octile\nwidth 3\n"), ":2: expected \"height N\", N from 1 to 512");
  for (const std::string size : {"0", "-1", "513", "3x", "99999999999", "", "3 3"}) {
    EXPECT_EQ(MapComplaint("type octile\nheight 2\nwidth " + size + "\nmap\n"),
              ":3: expected \"width N\", N from 1 to 512")
        << size;
  }
  EXPECT_EQ(MapComplaint("type octile\nheight 2\nwidth 3\n...\n"), ":4: expected \"map\"");
  EXPECT_EQ(MapComplaint(kHeader + "...\n"), ":5: the file ends where a row of the map should be");
  EXPECT_EQ(MapComplaint(kHeader + "...\n..\n"), ":6: expected a row of 3 characters, found 2");
  EXPECT_EQ(MapComplaint(kHeader + "....\n"), ":5: expected a row of 3 characters, found 4");
  EXPECT_EQ(MapComplaint(kHeader + "...\n.x.\n"), ":6: a character other than . G S @ O T W");
}

TEST(MovingaiMapFile, MustExist) {
  const auto read = ReadMovingaiMap("/nowhere/a.map");
  ASSERT_TRUE(std::holds_alternative<std::string>(read));
  EXPECT_EQ(std::get<std::string>(read), "/nowhere/a.map: cannot be read");
}

TEST(MovingaiMapFile, SurvivesBytesThatAreNoText) {
  std::string bytes;
  for (int i = 0; i < 70000; ++i) bytes.push_back(static_cast<char>(i * 7));
  EXPECT_NE(MapComplaint(bytes), "");
  EXPECT_NE(MapComplaint(kHeader + bytes), "");
  EXPECT_NE(ScenarioComplaint(bytes), "");
  EXPECT_NE(ScenarioComplaint("version 1\n" + bytes), "");
}

TEST(MovingaiScenarioFile, IsReadWithTabs) {
  const TextFile file("a.scen",
                      "version 1\n"
                      "1\tmaps/a.map\t20\t10\t12\t4\t3\t9\t4.41421\n"
                      "1\tmaps/a.map\t20\t10\t0\t0\t6\t0\t6\n");
  const auto read = ReadMovingaiScenarios(file.path());
  ASSERT_TRUE(std::holds_alternative<std::vector<MovingaiProblem>>(read));
  const auto& problems = std::get<std::vector<MovingaiProblem>>(read);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].line, 2);
  EXPECT_EQ(problems[0].map_width_cells, 20);
  EXPECT_EQ(problems[0].map_height_cells, 10);
  EXPECT_EQ(problems[0].start, (Cell{12, 4}));
  EXPECT_EQ(problems[0].goal, (Cell{3, 9}));
  EXPECT_DOUBLE_EQ(problems[0].optimum_cells, 4.41421);
  EXPECT_DOUBLE_EQ(problems[0].rounding_cells, 0.000005);
  EXPECT_DOUBLE_EQ(problems[1].rounding_cells, 0.0);
}

TEST(MovingaiScenarioFile, IsReadWithSpacesAndTwoDecimals) {
  const TextFile file("a.scen",
                      "version 1.0\r\n61 maps/a.map 512 512 210 395 87 201 244.95\r\n\r\n");
  const auto read = ReadMovingaiScenarios(file.path());
  ASSERT_TRUE(std::holds_alternative<std::vector<MovingaiProblem>>(read));
  const auto& problems = std::get<std::vector<MovingaiProblem>>(read);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].goal, (Cell{87, 201}));
  EXPECT_DOUBLE_EQ(problems[0].rounding_cells, 0.005);
}

TEST(MovingaiScenarioFile, SaysWhereItIsWrong) {
  EXPECT_EQ(ScenarioComplaint(""), ":0: the file ends where \"version 1\" should be");
  EXPECT_EQ(ScenarioComplaint("version 2\n"), ":1: expected \"version 1\" or \"version 1.0\"");
  EXPECT_EQ(ScenarioComplaint("version 1\n"), ":1: the file ends where a problem should be");
  EXPECT_EQ(ScenarioComplaint("version 1\n0 a 9 9 1 1 2 2\n"), ":2: expected 9 columns, found 8");
  EXPECT_EQ(ScenarioComplaint("version 1\n0 a b 9 9 1 1 2 2 3\n"),
            ":2: expected 9 columns, found 10");
  EXPECT_EQ(ScenarioComplaint("version 1\n0 a 9 9 1 one 2 2 3\n"), ":2: a column is not a number");
  EXPECT_EQ(ScenarioComplaint("version 1\n0 a 9 9 1 99999999999 2 2 3\n"),
            ":2: a column is not a number");
  EXPECT_EQ(ScenarioComplaint("version 1\n0 a 9 513 1 1 2 2 3\n"),
            ":2: a map size outside 1 to 512");
  for (const std::string cells : {"9 1 2 2", "-1 1 2 2", "1 8 2 2", "1 1 9 2", "1 1 2 8"}) {
    EXPECT_EQ(ScenarioComplaint("version 1\n0 a 9 8 " + cells + " 3\n"),
              ":2: a position off the map")
        << cells;
  }
  for (const std::string length : {"nan", "inf", "-1", "1e30"}) {
    EXPECT_EQ(ScenarioComplaint("version 1\n0 a 9 9 1 1 2 2 " + length + "\n"),
              ":2: an invalid length")
        << length;
  }
}

TEST(MovingaiScenarioFile, MustExist) {
  const auto read = ReadMovingaiScenarios("/nowhere/a.scen");
  ASSERT_TRUE(std::holds_alternative<std::string>(read));
  EXPECT_EQ(std::get<std::string>(read), "/nowhere/a.scen: cannot be read");
}

}  // namespace
}  // namespace hardpack
