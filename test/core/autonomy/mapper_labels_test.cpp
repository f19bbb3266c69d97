// SPDX-License-Identifier: Apache-2.0
// Labels that come in time, late, twice, for the wrong column or never.
#include <gtest/gtest.h>

#include "test/core/autonomy/mapper_bench.h"

namespace hardpack::perception {
namespace {

constexpr uint64_t kDeadline_ns = 250'000'000;  // label_deadline_s
// Columns towards the box, and a margin that makes their directions complete.
constexpr int kFirst = kAhead - 24;
constexpr int kLast = kAhead + 24;
constexpr int kMargin = 30;

// Columns of one revolution towards the box; those kFirst .. kLast are classed.
void LookAtBox(MapperBench& bench) {
  bench.GiveAll(kFirst - kMargin, kLast + kMargin);
}

// SR-PER05
TEST(MapperLabels, UntilTheyComeTheGeometricClassIsInEveryBuild) {
  MapperBench bench(true);
  LookAtBox(bench);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kClassed);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), 0);
  EXPECT_EQ(bench.Folded(), 0u);
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), Chain::Cells(MapperBench::kBox));
}

TEST(MapperLabels, ReplaceTheGeometricClass) {
  MapperBench bench(true);
  LookAtBox(bench);
  for (int index = kFirst - kMargin; index <= kLast + kMargin; ++index) {
    EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(index, kBushCode)), Status::kOk);
  }
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kFolded);
  EXPECT_TRUE(bench.ColumnOf(kAhead).labelled);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), 0);
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), 0);
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kSoft), Chain::Cells(MapperBench::kBox));
  bench.mapper->Finish();
  EXPECT_EQ(bench.mapper->counters().folded_with_labels, bench.mapper->ring().counters().columns);
}

// SR-PER06
TEST(MapperLabels, GroundThatStandsTooHighIsHard) {
  MapperBench bench(true);
  LookAtBox(bench);
  for (int index = kFirst; index <= kLast; ++index) {
    EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(index, kGrassCode)), Status::kOk);
  }
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), Chain::Cells(MapperBench::kBox));
}

// SR-PER10
TEST(MapperLabels, PersonIsFlagged) {
  MapperBench bench(true);
  LookAtBox(bench);
  for (int index = kFirst; index <= kLast; ++index) {
    EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(index, kPersonCode)), Status::kOk);
  }
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kPerson), Chain::Cells(MapperBench::kBox));
}

TEST(MapperLabels, OfAColumnThatIsNotClassedYetWait) {
  MapperBench bench(true);
  bench.GiveAll(kFirst - kMargin, kAhead);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kRaw);
  EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(kAhead, kBushCode)), Status::kOk);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kRaw);
  bench.GiveAll(kAhead + 1, kLast + kMargin);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kFolded);
  EXPECT_EQ(bench.mapper->counters().folded_with_labels, 1u);
}

// The deadline counts from when the column was taken.
// SR-PER05
TEST(MapperLabels, ThatNeverComeAreWaitedForUntilTheDeadline) {
  MapperBench bench(true);
  LookAtBox(bench);
  const uint64_t due_ns = TimeOf_ns(kAhead) + kDeadline_ns;
  bench.mapper->Advance(due_ns - 1);
  EXPECT_EQ(bench.ColumnOf(kAhead - 1).state, ColumnState::kFolded);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kClassed);
  bench.mapper->Advance(due_ns);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kFolded);
  EXPECT_FALSE(bench.ColumnOf(kAhead).labelled);
  bench.mapper->Advance(due_ns + kDeadline_ns);
  EXPECT_EQ(bench.Pending(), 0);
  EXPECT_EQ(bench.mapper->counters().folded_with_labels, 0u);
  EXPECT_EQ(bench.mapper->counters().folded_without_labels,
            bench.mapper->ring().counters().columns);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
}

// SR-PER05
TEST(MapperLabels, ThatComeLateChangeNothing) {
  MapperBench bench(true);
  LookAtBox(bench);
  bench.mapper->Advance(TimeOf_ns(kLast + kMargin) + kDeadline_ns);
  bench.mapper->Advance(TimeOf_ns(kLast + kMargin) + kDeadline_ns);
  const uint64_t before = DigestOf(bench.mapper->heights());
  for (int index = kFirst; index <= kLast; ++index) {
    EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(index, kBushCode)), Status::kLate);
  }
  EXPECT_EQ(bench.mapper->ring().counters().late_labels, static_cast<uint32_t>(kLast - kFirst + 1));
  EXPECT_EQ(DigestOf(bench.mapper->heights()), before);
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), Chain::Cells(MapperBench::kBox));
}

TEST(MapperLabels, ThatComeTwiceCountOnce) {
  MapperBench bench(true);
  bench.GiveAll(kFirst - kMargin, kAhead);
  EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(kAhead, kBushCode)), Status::kOk);
  EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(kAhead, kTreeCode)), Status::kDuplicate);
  EXPECT_EQ(bench.mapper->ring().counters().duplicate_labels, 1u);
  bench.GiveAll(kAhead + 1, kLast + kMargin);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kFolded);
  const uint64_t before = DigestOf(bench.mapper->heights());
  const uint32_t folded = bench.Folded();
  EXPECT_FALSE(IsUsable(bench.mapper->AddLabels(bench.LabelsOf(kAhead, kTreeCode))));
  EXPECT_EQ(bench.Folded(), folded);
  EXPECT_EQ(DigestOf(bench.mapper->heights()), before);
  EXPECT_EQ(bench.mapper->counters().folded_with_labels, 1u);
}

TEST(MapperLabels, OfColumnsThatAreNotThereAreCounted) {
  MapperBench bench(true);
  LookAtBox(bench);
  ColumnLabels wrong_frame = bench.LabelsOf(kAhead, kBushCode);
  wrong_frame.frame_id = 7;
  EXPECT_EQ(bench.mapper->AddLabels(wrong_frame), Status::kBadColumn);
  ColumnLabels never_came = bench.LabelsOf(kAhead, kBushCode);
  never_came.measurement_id = 3;
  EXPECT_EQ(bench.mapper->AddLabels(never_came), Status::kBadColumn);
  ColumnLabels no_column = bench.LabelsOf(kAhead, kBushCode);
  no_column.measurement_id = UINT16_MAX;
  EXPECT_EQ(bench.mapper->AddLabels(no_column), Status::kBadColumn);
  EXPECT_EQ(bench.mapper->ring().counters().labels_without_column, 3u);
  ColumnLabels other_sensor = bench.LabelsOf(kAhead, kBushCode);
  for (const int beams : {-1, 0, kBeams - 1, kBeams + 1, INT32_MAX}) {
    other_sensor.beams = beams;
    EXPECT_EQ(bench.mapper->AddLabels(other_sensor), Status::kInvalidArgument);
  }
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kClassed);
  EXPECT_FALSE(bench.ColumnOf(kAhead).labelled);
  EXPECT_EQ(bench.Folded(), 0u);
}

TEST(MapperLabels, AreTakenWithoutBeingWaitedForOnlyBeforeTheFold) {
  MapperBench bench(false);
  LookAtBox(bench);
  EXPECT_EQ(bench.ColumnOf(kAhead).state, ColumnState::kFolded);
  EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(kAhead, kBushCode)), Status::kLate);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
}

// A build that began before a fold still gets what was folded meanwhile.
TEST(MapperLabels, ColumnsFoldedDuringABuildAreInIt) {
  MapperBench bench(true);
  LookAtBox(bench);
  const auto builder = std::make_unique<CostmapBuilder>();
  ASSERT_EQ(builder->Begin(bench.mapper->heights(), CostmapParams{}), Status::kOk);
  const uint32_t since = bench.mapper->fold_count();
  while (builder->StepHeights(bench.mapper->heights(), 1 << 20) == Progress::kBusy) {
  }
  for (int index = kFirst; index <= kLast; ++index) {
    EXPECT_EQ(bench.mapper->AddLabels(bench.LabelsOf(index, kTreeCode)), Status::kOk);
  }
  for (int slot = 0; slot < bench.mapper->ring().slots(); ++slot) {
    bench.mapper->MarkPending(slot, since, *builder);
  }
  while (builder->StepCells(1 << 20) == Progress::kBusy) {
  }
  const Costmap& map = builder->result();
  MapperBench::kBox.ForEach(
      [&](Cell cell) { EXPECT_NE(map.flags[map.window.Index(cell)] & Costmap::kHard, 0); });
}

}  // namespace
}  // namespace hardpack::perception
