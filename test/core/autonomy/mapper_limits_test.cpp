// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "test/core/autonomy/mapper_bench.h"

// What one tick takes at most (Mapper::BeginTick), and what becomes of the rest.

namespace hardpack::perception {
namespace {

// Columns that wait for those ahead of them before their directions are complete.
const int kWaiting = TheModel().max_column_shift;

// SR-DET03
TEST(MapperLimits, ColumnsBeyondATicksDirectionsAreRefusedAndCounted) {
  MapperBench bench(true);
  bench.GiveAll(0, 99);
  constexpr int kLimit = Mapper::kMaxDirections;
  bench.mapper->BeginTick(kLimit);
  bench.GiveAll(100, 100 + kLimit - 1);
  EXPECT_EQ(bench.mapper->counters().columns_over_limit, 0u);
  EXPECT_EQ(bench.Give(100 + kLimit), Status::kCapacityExceeded);
  EXPECT_EQ(bench.mapper->counters().columns_over_limit, 1u);
  EXPECT_EQ(bench.ColumnOf(100 + kLimit).state, ColumnState::kAbsent);
  EXPECT_TRUE(bench.mapper->fresh().empty());
  // The next tick goes on, with the column that was refused if it comes again.
  bench.mapper->BeginTick(kLimit);
  bench.GiveAll(100 + kLimit, 100 + kLimit + 50);
  EXPECT_EQ(bench.mapper->counters().columns_over_limit, 1u);
}

TEST(MapperLimits, ALateColumnCountsAsADirection) {
  MapperBench bench(true);
  bench.GiveAll(0, 99);
  bench.GiveAll(120, 219);  // 100 .. 119 are missing
  bench.mapper->BeginTick(Mapper::kMaxDirections);
  bench.GiveAll(220, 220 + Mapper::kMaxDirections - 11);
  bench.GiveAll(100, 109);
  EXPECT_EQ(bench.ColumnOf(109).state, ColumnState::kClassed);
  // What came too late for the geometry is hard, and is counted.
  EXPECT_EQ(bench.mapper->counters().late_unclassed_columns, 10u);
  EXPECT_EQ(bench.Give(110), Status::kCapacityExceeded);
  EXPECT_EQ(bench.ColumnOf(110).state, ColumnState::kAbsent);
  EXPECT_EQ(bench.mapper->counters().columns_over_limit, 1u);
  bench.mapper->BeginTick(Mapper::kMaxDirections);
  EXPECT_EQ(bench.Give(110), Status::kOk);
}

// Also where nothing so near to the lidar, which sits at 1.3 m, is taken for the vehicle itself.
TEST(MapperLimits, ALateColumnThatSawNothingIsClassedAsNothing) {
  MapperBench bench(true);
  bench.params.mount.min_range_m = 0.0f;
  bench.params.mount.self_max_z_m = 1.0f;
  bench.Configure();
  bench.GiveAll(0, 99);
  bench.GiveAll(110, 219);  // 100 .. 109 are missing
  LidarColumn empty = bench.Cast(105).first;
  for (uint32_t& range_mm : empty.range_mm) range_mm = 0;
  for (uint32_t& range_mm : empty.second_range_mm) range_mm = 0;
  ASSERT_EQ(bench.mapper->AddColumn(empty, TimeOf_ns(105)), Status::kOk);
  EXPECT_EQ(bench.ColumnOf(105).state, ColumnState::kClassed);
  EXPECT_EQ(bench.mapper->counters().late_unclassed_columns, 0u);
  ASSERT_EQ(bench.Give(106), Status::kOk);
  EXPECT_EQ(bench.mapper->counters().late_unclassed_columns, 1u);
}

// A slot that is needed while its column waits for its class: both are work of the tick.
TEST(MapperLimits, AColumnThatIsFoldedUnclassedCountsAsADirection) {
  const auto directions_left = [](bool occupied) {
    MapperBench bench(true);
    const int slots = bench.mapper->ring().slots();
    if (occupied) {  // raw: nothing comes behind it
      EXPECT_EQ(bench.Give(0), Status::kOk);
    }
    bench.PosesFor(slots);
    bench.mapper->BeginTick(Mapper::kMaxDirections);
    int taken = 0;
    while (bench.Give(slots + taken) == Status::kOk) ++taken;
    EXPECT_EQ(bench.mapper->counters().folded_early, occupied ? 1u : 0u);
    return taken;
  };
  const int free = directions_left(false);
  EXPECT_EQ(free, Mapper::kMaxDirections);
  // The gap ends the directions that the first one began, and it is itself classed as hard.
  EXPECT_EQ(directions_left(true), free - (kWaiting + Segmenter::kLag) - 1);
}

// SR-DET03
TEST(MapperLimits, ATickFoldsSoManyColumnsThatAreOverdue) {
  MapperBench bench(true);
  constexpr int kGiven = 900;
  constexpr uint32_t kFolds = Mapper::kMaxFolds;
  bench.GiveAll(0, kGiven - 1);
  const uint64_t late_ns = TimeOf_ns(kGiven) + 1'000'000'000u;
  uint32_t folded = bench.Folded();
  ASSERT_EQ(folded, 0u);
  for (int tick = 0; tick < 3; ++tick) {
    bench.mapper->BeginTick(Mapper::kMaxDirections);
    bench.mapper->Advance(late_ns);
    EXPECT_EQ(bench.Folded() - folded, kFolds) << tick;
    folded = bench.Folded();
    bench.mapper->Advance(late_ns);  // in the same tick
    EXPECT_EQ(bench.Folded(), folded) << tick;
  }
  bench.mapper->BeginTick(Mapper::kMaxDirections);
  bench.mapper->Advance(late_ns);
  EXPECT_EQ(bench.Folded(), static_cast<uint32_t>(kGiven));
  EXPECT_EQ(bench.Pending(), 0);
}

// Labels are taken however many come: what they fold leaves less for Advance.
TEST(MapperLimits, WhatLabelsFoldCountsAmongATicksFolds) {
  MapperBench bench(true);
  bench.GiveAll(0, 899);
  bench.mapper->BeginTick(Mapper::kMaxDirections);
  constexpr int kLabelled = 200;
  for (int index = 0; index < kLabelled; ++index) {
    ASSERT_EQ(bench.mapper->AddLabels(bench.LabelsOf(500 + index, 0)), Status::kOk);
  }
  EXPECT_EQ(bench.Folded(), static_cast<uint32_t>(kLabelled));
  bench.mapper->Advance(TimeOf_ns(900) + 1'000'000'000u);
  EXPECT_EQ(bench.Folded(), static_cast<uint32_t>(Mapper::kMaxFolds));
}

// SR-DET03
TEST(MapperLimits, ATickCrossesSoManyCells) {
  const auto crossed = [](bool limited) {
    MapperBench bench(true);
    bench.world.bodies.clear();
    if (limited) bench.mapper->BeginTick(1'000'000);
    bench.GiveAll(0, 2 * kColumns);
    return bench.mapper->heights().crossed_cells();
  };
  const uint32_t limited = crossed(true);
  EXPECT_GE(limited, Mapper::kMaxCrossedInTick_cells);
  EXPECT_LT(limited, Mapper::kMaxCrossedInTick_cells + HeightGrid::kMaxBridge_cells);
  EXPECT_GT(crossed(false), 2 * Mapper::kMaxCrossedInTick_cells);
}

}  // namespace
}  // namespace hardpack::perception
