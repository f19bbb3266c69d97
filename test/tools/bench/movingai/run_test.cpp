// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>

#include "test/tools/bench/movingai/text_file.h"
#include "tools/bench/movingai/movingai.h"

namespace hardpack {
namespace {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HARDPACK_SLOW_BUILD
#endif
#endif

// All problems in optimised builds; one in ten where a search takes several times as long.
#if defined(NDEBUG) && !defined(HARDPACK_SLOW_BUILD) && !defined(__SANITIZE_ADDRESS__)
constexpr int kStride = 1;
#else
constexpr int kStride = 10;
#endif

// Five by three:  (0, 0) . . @ . .
//                        . . @ . .
//                        . . . . .
const std::string kMap = "type octile\nheight 3\nwidth 5\nmap\n..@..\n..@..\n.....\n";

MovingaiOr<MovingaiReport> RunOn(const std::string& map, const std::string& problems) {
  const TextFile map_file("a.map", map);
  const TextFile scen_file("a.scen", "version 1\n" + problems);
  return RunMovingai(map_file.path(), scen_file.path());
}

TEST(MovingaiRun, SolvesProblemsOfASmallMap) {
  const auto outcome = RunOn(kMap,
                             "0 a 5 3 0 0 1 1 1.41421356\n"
                             "0 a 5 3 1 1 3 1 4\n"
                             "0 a 5 3 0 0 0 0 0\n");
  ASSERT_TRUE(std::holds_alternative<MovingaiReport>(outcome));
  const auto& report = std::get<MovingaiReport>(outcome);
  EXPECT_EQ(report.problems, 3);
  EXPECT_EQ(report.solved, 3);
  EXPECT_EQ(report.mismatches, 0) << report.first_mismatch;
  EXPECT_LT(report.largest_relative_error, 1e-8);
  EXPECT_EQ(report.first_mismatch, "");
  EXPECT_GE(report.expansions, 3 + 5 + 1);  // at least the cells of the paths
  EXPECT_LE(report.median_ns, report.worst_ns);
  EXPECT_LE(report.worst_ns, report.total_ns);
}

TEST(MovingaiRun, ReportsALengthThatDoesNotMatch) {
  const auto outcome = RunOn(kMap,
                             "0 a 5 3 0 0 1 0 1\n"
                             "0 a 5 3 1 1 3 1 3.41421356\n"  // by cutting a corner
                             "0 a 5 3 1 1 3 1 4.004\n"       // within 0.1 %
                             "0 a 5 3 1 1 3 1 4.00800\n");   // beyond it
  ASSERT_TRUE(std::holds_alternative<MovingaiReport>(outcome));
  const auto& report = std::get<MovingaiReport>(outcome);
  EXPECT_EQ(report.solved, 4);
  EXPECT_EQ(report.mismatches, 2);
  EXPECT_EQ(report.first_mismatch, "line 3: length 4.00000, listed 3.41421");
  EXPECT_NEAR(report.largest_relative_error, (4 - 3.41421356) / 3.41421356, 1e-9);
}

TEST(MovingaiRun, ReportsProblemsThatAreNotSolved) {
  const auto outcome = RunOn("type octile\nheight 1\nwidth 4\nmap\n.@..\n",
                             "0 a 4 1 0 0 3 0 3\n"
                             "0 a 4 1 1 0 3 0 2\n"
                             "0 a 4 1 3 0 1 0 2\n");
  ASSERT_TRUE(std::holds_alternative<MovingaiReport>(outcome));
  const auto& report = std::get<MovingaiReport>(outcome);
  EXPECT_EQ(report.solved, 0);
  EXPECT_EQ(report.mismatches, 3);
  EXPECT_EQ(report.first_mismatch, "line 2: no_path");
}

TEST(MovingaiRun, RefusesProblemsForAMapOfAnotherSize) {
  const auto outcome = RunOn(kMap, "0 a 5 4 0 3 1 1 2\n");
  ASSERT_TRUE(std::holds_alternative<std::string>(outcome));
  EXPECT_NE(std::get<std::string>(outcome).find(":2: the problem is for a map of another size"),
            std::string::npos);
}

TEST(MovingaiRun, PassesOnWhatIsWrongWithAFile) {
  EXPECT_TRUE(std::holds_alternative<std::string>(RunOn("", "0 a 5 3 0 0 1 1 1.41\n")));
  EXPECT_TRUE(std::holds_alternative<std::string>(RunOn(kMap, "")));
}

TEST(MovingaiRun, FillsTheRestOfTheWindowWithObstacles) {
  const TextFile file("a.map", kMap);
  const auto read = ReadMovingaiMap(file.path());
  ASSERT_TRUE(std::holds_alternative<MovingaiMap>(read));
  const auto costmap = std::make_unique<Costmap>();
  FillMovingaiCostmap(std::get<MovingaiMap>(read), *costmap);
  int free_cells = 0;
  for (int index = 0; index < kMapCells; ++index) {
    if (costmap->flags[index] == 0) {
      ++free_cells;
    } else {
      EXPECT_EQ(costmap->flags[index], Costmap::kHard | Costmap::kLethal);
    }
    EXPECT_EQ(costmap->cost_q8[index], 0);
  }
  EXPECT_EQ(free_cells, 13);
  EXPECT_TRUE(costmap->Lethal(costmap->window.Index({2, 1})));
  EXPECT_FALSE(costmap->Lethal(costmap->window.Index({2, 2})));
}

// One in five of the maze's: it has nine thousand, and the ways are long.
int StrideOf(const std::string& map) {
  return map.substr(0, 4) == "maze" ? 5 * kStride : kStride;
}

class MovingaiBenchmark : public ::testing::TestWithParam<const char*> {};

TEST_P(MovingaiBenchmark, IsSolvedToTheListedLengths) {
  const char* const data = std::getenv("HARDPACK_DATA");
  const std::string folder = data == nullptr ? "" : std::string(data) + "/movingai/";
  const std::string map = folder + GetParam() + ".map";
  if (data == nullptr || !std::filesystem::exists(map)) {
    GTEST_SKIP() << "needs " << GetParam() << ".map in $HARDPACK_DATA/movingai";
  }
  const int stride = StrideOf(GetParam());
  const auto outcome = RunMovingai(map, map + ".scen", stride);
  ASSERT_TRUE(std::holds_alternative<MovingaiReport>(outcome)) << std::get<std::string>(outcome);
  const auto& report = std::get<MovingaiReport>(outcome);
  std::cout << report.problems << " problems (one in " << stride << "), "
            << report.total_ns / 1000000 << " ms of searching\n";
  EXPECT_GT(report.problems, 0);
  EXPECT_EQ(report.solved, report.problems);
  EXPECT_EQ(report.mismatches, 0) << report.first_mismatch;
}

INSTANTIATE_TEST_SUITE_P(Maps, MovingaiBenchmark,
                         ::testing::Values("16room_000", "AR0011SR", "Berlin_1_512", "maze512-16-0",
                                           "random512-25-0"),
                         [](const auto& info) {
                           std::string name = info.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

}  // namespace
}  // namespace hardpack
