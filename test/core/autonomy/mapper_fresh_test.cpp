// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "test/core/autonomy/mapper_bench.h"

// What the mapper tells of single columns, for those who do not wait for a map.

namespace hardpack::perception {
namespace {

// Slots told as fresh after each call, by how often.
void AddFresh(const Mapper& mapper, std::map<int64_t, int>& times) {
  for (const int16_t slot : mapper.fresh()) {
    const ColumnState state = mapper.ring().column(slot).state;
    EXPECT_TRUE(state == ColumnState::kClassed || state == ColumnState::kFolded);
    ++times[mapper.ring().column(slot).sequence];
  }
}

TEST(MapperFresh, TellsEachColumnOnceWhenItIsClassed) {
  MapperBench bench(false);
  std::map<int64_t, int> times;
  for (int index = 0; index < 2 * kColumns; ++index) {
    ASSERT_EQ(bench.Give(index), Status::kOk);
    AddFresh(*bench.mapper, times);
  }
  EXPECT_GT(times.size(), static_cast<size_t>(2 * kColumns - 100));
  bench.mapper->Advance(TimeOf_ns(2 * kColumns) + 1'000'000'000u);  // it has fallen silent
  AddFresh(*bench.mapper, times);
  EXPECT_EQ(times.size(), static_cast<size_t>(2 * kColumns));
  for (const auto& [sequence, count] : times) EXPECT_EQ(count, 1) << sequence;
  bench.mapper->Advance(TimeOf_ns(2 * kColumns) + 1'100'000'000u);
  EXPECT_TRUE(bench.mapper->fresh().empty());
}

TEST(MapperFresh, TellsNothingOfAColumnThatIsRefused) {
  MapperBench bench(false);
  bench.GiveAll(0, kColumns);
  EXPECT_FALSE(bench.mapper->fresh().empty());
  EXPECT_EQ(bench.Give(kColumns), Status::kDuplicate);
  EXPECT_TRUE(bench.mapper->fresh().empty());
}

// Where the box stands and nowhere else; twice the same.
TEST(MapperFresh, ToldObstaclesLieOnTheBox) {
  MapperBench bench(false);
  int on_box = 0;
  for (int index = 0; index < 3 * kColumns; ++index) {
    ASSERT_EQ(bench.Give(index), Status::kOk);
    for (const int16_t slot : bench.mapper->fresh()) {
      for (int row = 0; row < kBeams; ++row) {
        Vec2 point;
        const uint8_t flags = bench.mapper->ObstacleOf(slot, row, 50'000, point);
        if ((flags & Costmap::kHard) == 0) continue;
        ++on_box;
        EXPECT_NEAR(point.x_m, 6.3f, 0.4f);
        EXPECT_LT(std::abs(point.y_m), 0.6f);
        Vec2 again;
        EXPECT_EQ(bench.mapper->ObstacleOf(slot, row, 50'000, again), flags);
        EXPECT_EQ(bench.mapper->ObstacleOf(slot, row, 3'000, again), 0);  // further than asked for
      }
    }
  }
  EXPECT_GT(on_box, 50);
}

TEST(MapperFresh, LabelsMakeAPersonOfIt) {
  MapperBench bench(true);
  bench.GiveAll(0, kColumns + kColumns / 2);
  int people = 0;
  for (int index = kColumns; index < kColumns + kColumns / 4; ++index) {
    const Status status = bench.mapper->AddLabels(bench.LabelsOf(index, 17));
    ASSERT_EQ(status, Status::kOk);
    for (const int16_t slot : bench.mapper->fresh()) {
      for (int row = 0; row < kBeams; ++row) {
        Vec2 point;
        const uint8_t flags = bench.mapper->ObstacleOf(slot, row, 50'000, point);
        people += (flags & Costmap::kPerson) != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(people, 10);
}

TEST(MapperFresh, KnowsWhenItLookedAnywhereLast) {
  MapperBench bench(false);
  EXPECT_EQ(bench.mapper->NewestLook_ns({1.0f, 0.0f}), 0u);
  const int last = 2 * kColumns + kColumns / 3;
  bench.GiveAll(0, last);
  const double revolution_ns = kRevolution_s * 1e9;
  for (double angle = -3.1; angle < 3.1; angle += 0.05) {
    const Vec2 direction = {static_cast<float>(5.0 * std::cos(angle)),
                            static_cast<float>(5.0 * std::sin(angle))};
    const uint64_t seen_ns = bench.mapper->NewestLook_ns(direction);
    ASSERT_NE(seen_ns, 0u);
    ASSERT_LE(seen_ns, TimeOf_ns(last));
    const double age_ns = static_cast<double>(TimeOf_ns(last) - seen_ns);
    ASSERT_LT(age_ns, 1.01 * revolution_ns) << angle;
    // The encoder's angle falls with the measurement id: 2 pi (1 - m / W).
    double turns = -(angle + M_PI) / (2.0 * M_PI);  // the lidar is turned in its sensor
    turns -= std::floor(turns);
    double behind = static_cast<double>(last % kColumns) / kColumns - turns;
    if (behind < 0.0) behind += 1.0;
    if (behind > 0.01 && behind < 0.99) {
      EXPECT_NEAR(age_ns / revolution_ns, behind, 0.01) << angle;
    }
  }
}

}  // namespace
}  // namespace hardpack::perception
