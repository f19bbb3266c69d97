// SPDX-License-Identifier: Apache-2.0
// What the mapper does with what a sensor and an odometry do wrong: each its status, its counter,
// and the map stays.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <random>

#include "test/core/autonomy/mapper_bench.h"
#include "test/not_finite.h"

namespace hardpack::perception {
namespace {

using testing::kInfinity;
using testing::kNaN;

Status ConfigureWith(Mapper& mapper, const PerceptionParams& params, const LabelTable& table,
                     const BeamModel& model, int first, int last) {
  return mapper.Configure(params, CostmapParams{}, table, model, first, last);
}

TEST(Mapper, TakesNothingBeforeItIsConfigured) {
  const auto mapper = std::make_unique<Mapper>();
  EXPECT_FALSE(mapper->started());
  EXPECT_EQ(mapper->AddPose(StandingAt(1)), Status::kNotStarted);
  EXPECT_EQ(mapper->AddColumn(LidarColumn{}, 1), Status::kNotStarted);
  EXPECT_EQ(mapper->AddLabels(ColumnLabels{}), Status::kNotStarted);
  mapper->Advance(1);
  mapper->Finish();
  EXPECT_EQ(mapper->fold_count(), 0u);
}

TEST(Mapper, RefusesWhatItCannotWorkWith) {
  const auto mapper = std::make_unique<Mapper>();
  const PerceptionParams good;
  const BeamModel model = TheModel();
  const LabelTable table = RellisLabelTable();
  PerceptionParams params = good;
  params.mount.z_m = kNaN;
  EXPECT_EQ(ConfigureWith(*mapper, params, table, model, 0, 1023), Status::kParameterOutOfRange);
  params = good;
  params.segmentation.bridge_factor = kInfinity;
  EXPECT_EQ(ConfigureWith(*mapper, params, table, model, 0, 1023), Status::kParameterOutOfRange);
  params = good;
  params.mapping.ageing_revolutions = HeightGrid::kMaxAgeingRevolutions + 1;
  EXPECT_EQ(ConfigureWith(*mapper, params, table, model, 0, 1023), Status::kParameterOutOfRange);
  CostmapParams rule;
  rule.clearance_height_m = 0.1f;
  EXPECT_EQ(mapper->Configure(good, rule, table, model, 0, 1023), Status::kParameterOutOfRange);
  LabelTable no_class = table;
  no_class.class_of[200] = static_cast<ReturnClass>(9);
  EXPECT_EQ(ConfigureWith(*mapper, good, no_class, model, 0, 1023), Status::kInvalidArgument);
  EXPECT_EQ(ConfigureWith(*mapper, good, table, BeamModel{}, 0, 1023), Status::kInvalidArgument);
  EXPECT_EQ(ConfigureWith(*mapper, good, table, model, 0, 1024), Status::kInvalidArgument);
  EXPECT_EQ(ConfigureWith(*mapper, good, table, model, -1, 1023), Status::kInvalidArgument);
  BeamModel too_large = model;
  too_large.beams = kMaxBeams;
  too_large.columns_per_revolution = kMaxColumnsPerRevolution;
  EXPECT_EQ(ConfigureWith(*mapper, good, table, too_large, 0, 2047), Status::kCapacityExceeded);
  EXPECT_FALSE(mapper->started());
  EXPECT_EQ(mapper->AddPose(StandingAt(1)), Status::kNotStarted);
  EXPECT_EQ(ConfigureWith(*mapper, good, table, model, 0, 1023), Status::kOk);
  EXPECT_TRUE(mapper->started());
}

TEST(Mapper, ForgetsEverythingWhenConfiguredAgain) {
  MapperBench bench(false);
  bench.GiveAll(0, kColumns - 1);
  bench.mapper->Finish();
  EXPECT_GT(bench.HardInGrid(MapperBench::kBox), 0);
  bench.Configure();
  const MapperBench fresh(false);
  EXPECT_EQ(DigestOf(bench.mapper->heights()), DigestOf(fresh.mapper->heights()));
  EXPECT_EQ(bench.mapper->counters().folded_without_labels, 0u);
  EXPECT_EQ(bench.mapper->ring().counters().columns, 0u);
  EXPECT_EQ(bench.mapper->poses().size(), 0);
}

TEST(Mapper, TakesTheGroundAroundTheStartAsObserved) {
  MapperBench bench(false);
  EXPECT_EQ(bench.Count({-4.0, -4.0, 4.0, 4.0}, Costmap::kObserved), 0);
  EXPECT_EQ(bench.mapper->AddPose(StandingAt(1)), Status::kOk);
  EXPECT_EQ(bench.Count({-3.4, -3.4, 3.4, 3.4}, Costmap::kObserved),
            Chain::Cells({-3.4, -3.4, 3.4, 3.4}));
  EXPECT_EQ(bench.Count({5.2, -6.0, 8.0, 6.0}, Costmap::kObserved), 0);
}

// SR-PER08
TEST(Mapper, CountsColumnsWithoutAPose) {
  MapperBench bench(false);
  EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(0).first, TimeOf_ns(0)), Status::kNoPose);
  EXPECT_EQ(bench.mapper->AddPose(StandingAt(TimeOf_ns(200))), Status::kOk);
  EXPECT_EQ(bench.mapper->AddPose(StandingAt(TimeOf_ns(300))), Status::kOk);
  EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(199).first, TimeOf_ns(199)), Status::kNoPose);
  EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(200).first, TimeOf_ns(200)), Status::kOk);
  // Carried on for 50 ms, and no further.
  EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(700).first, TimeOf_ns(700)), Status::kOk);
  EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(900).first, TimeOf_ns(900)), Status::kNoPose);
  EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(901).first, UINT64_MAX), Status::kNoPose);
  EXPECT_EQ(bench.mapper->counters().columns_without_pose, 4u);
  EXPECT_EQ(bench.mapper->ring().counters().columns, 2u);
}

TEST(Mapper, RefusesPosesThatAreNone) {
  MapperBench bench(false);
  bench.GiveAll(0, kColumns - 1);
  const uint64_t before = DigestOf(bench.mapper->heights());
  const StampedPose newest = bench.mapper->poses().newest();
  StampedPose pose = newest;
  EXPECT_EQ(bench.mapper->AddPose(pose), Status::kDuplicate);
  pose.time_ns -= 1'000'000;
  EXPECT_EQ(bench.mapper->AddPose(pose), Status::kInvalidArgument);
  for (float StampedPose::*angle :
       {&StampedPose::roll_rad, &StampedPose::pitch_rad, &StampedPose::yaw_rad}) {
    pose = newest;
    pose.time_ns += 10'000'000;
    pose.*angle = kNaN;
    EXPECT_EQ(bench.mapper->AddPose(pose), Status::kNotFinite);
  }
  for (float Vec3::*axis : {&Vec3::x_m, &Vec3::y_m, &Vec3::z_m}) {
    for (const float value : {kNaN, kInfinity, -kInfinity, 1.0e9f, -3.0e38f}) {
      pose = newest;
      pose.time_ns += 10'000'000;
      pose.position.*axis = value;
      EXPECT_FALSE(IsUsable(bench.mapper->AddPose(pose))) << value;
    }
  }
  EXPECT_EQ(DigestOf(bench.mapper->heights()), before);
  EXPECT_EQ(bench.mapper->counters().height_jumps, 0u);
  EXPECT_EQ(bench.mapper->counters().position_jumps, 0u);
}

// SR-ODO01
TEST(Mapper, JudgesAStepByItsLengthWhateverItsDirection) {
  for (int step = 0; step < 8; ++step) {
    const float angle_rad = 0.25f * kPi * static_cast<float>(step);
    for (const float length_m : {0.5f, 2.0f}) {
      MapperBench bench(false);
      StampedPose pose = StandingAt(1'000'000'000);
      EXPECT_EQ(bench.mapper->AddPose(pose), Status::kOk);
      pose.time_ns += 10'000'000;
      const SinCosPair way = SinCos(angle_rad);
      pose.position = {length_m * way.cos, length_m * way.sin, 0.0f};
      EXPECT_EQ(bench.mapper->AddPose(pose), Status::kOk);
      EXPECT_EQ(bench.mapper->counters().position_jumps, length_m > 1.0f ? 1u : 0u)
          << step << ' ' << length_m;
    }
  }
}

TEST(Mapper, CountsColumnsThatAreNone) {
  MapperBench bench(false);
  bench.GiveAll(0, 99);
  const uint64_t time_ns = TimeOf_ns(100);
  const LidarColumn good = bench.Cast(100).first;
  LidarColumn column = good;
  column.valid = false;
  EXPECT_EQ(bench.mapper->AddColumn(column, time_ns), Status::kColumnInvalid);
  column = good;
  column.measurement_id = kColumns;
  EXPECT_EQ(bench.mapper->AddColumn(column, time_ns), Status::kBadColumn);
  for (const int beams : {-1, 0, kBeams - 1, kMaxBeams, kMaxBeams + 1, INT32_MAX}) {
    column = good;
    column.beams = beams;
    EXPECT_EQ(bench.mapper->AddColumn(column, time_ns), Status::kBadColumn) << beams;
  }
  const ScanCounters& counters = bench.mapper->ring().counters();
  EXPECT_EQ(counters.invalid_columns, 1u);
  EXPECT_EQ(counters.bad_columns, 7u);
  EXPECT_EQ(counters.columns, 100u);
}

// Every range at the edges of what fits, at once.
TEST(Mapper, TakesAnyRange) {
  MapperBench bench(false);
  bench.GiveAll(0, 9);
  const uint32_t ranges[] = {0, 1, 499, 500, 119'999, 120'001, 0x7ffff, 0x80000, UINT32_MAX};
  for (int index = 10; index < 400; ++index) {
    LidarColumn column = bench.Cast(index).first;
    for (int row = 0; row < kBeams; ++row) {
      column.range_mm[row] = ranges[static_cast<size_t>(row + index) % std::size(ranges)];
    }
    bench.PosesFor(index);
    EXPECT_EQ(bench.mapper->AddColumn(column, TimeOf_ns(index)), Status::kOk);
  }
  bench.mapper->Finish();
  EXPECT_GT(bench.mapper->ring().counters().unusable_ranges, 0u);
  EXPECT_EQ(bench.Folded(), bench.mapper->ring().counters().columns);
}

TEST(Mapper, KeepsTheMapWhenTheSensorRestarts) {
  MapperBench bench(true);
  bench.GiveAll(0, kColumns + 699);
  const uint32_t filed = bench.mapper->ring().counters().columns;
  LidarColumn column = bench.Cast(kColumns + 700).first;
  column.frame_id = 40'000;
  const uint64_t time_ns = TimeOf_ns(kColumns + 700);
  EXPECT_EQ(bench.mapper->AddColumn(column, time_ns), Status::kSensorRestarted);
  EXPECT_EQ(bench.mapper->AddColumn(column, time_ns), Status::kSensorRestarted);
  EXPECT_EQ(bench.mapper->counters().sensor_restarts, 1u);
  for (int tick = 0; tick < 10; ++tick) {
    bench.mapper->Advance(time_ns + static_cast<uint64_t>(tick) * 10'000'000u);
  }
  EXPECT_EQ(bench.Folded(), filed);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
  EXPECT_EQ(bench.mapper->AddColumn(column, time_ns), Status::kOk);
  EXPECT_EQ(bench.mapper->counters().sensor_restarts, 1u);
  bench.mapper->Finish();
  EXPECT_EQ(bench.Folded(), filed + 1);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
}

// One wrong frame id takes the ring ahead of the sensor: it finds back within two packets' columns
// and a tick, not after the 60 revolutions.
TEST(Mapper, FindsBackFromOneWrongFrameId) {
  MapperBench bench(false);
  bench.GiveAll(0, 2 * kColumns);
  LidarColumn wild = bench.Cast(2 * kColumns + 1).first;
  wild.frame_id = static_cast<uint16_t>(wild.frame_id + 60);
  EXPECT_EQ(bench.mapper->AddColumn(wild, TimeOf_ns(2 * kColumns + 1)), Status::kOk);
  int refused = 0;
  for (int index = 2 * kColumns + 2; index < 3 * kColumns; ++index) {
    refused += IsUsable(bench.Give(index)) ? 0 : 1;
    bench.mapper->Advance(TimeOf_ns(index));
  }
  EXPECT_GE(refused, 1);
  EXPECT_LE(refused, 2 * Mapper::kMaxLateRun);
  EXPECT_EQ(bench.mapper->counters().sensor_restarts, 1u);
}

TEST(Mapper, EndsTheRevolutionOfASilentSensor) {
  MapperBench bench(true);
  constexpr int kLast = kAhead + 100;
  bench.GiveAll(0, kLast);
  EXPECT_EQ(bench.ColumnOf(kLast).state, ColumnState::kRaw);
  const uint64_t silence_ns = Mapper::kSilence_ns;
  bench.mapper->Advance(TimeOf_ns(kLast) + silence_ns);
  EXPECT_EQ(bench.ColumnOf(kLast).state, ColumnState::kRaw);
  bench.mapper->Advance(TimeOf_ns(kLast) + silence_ns + 1);
  EXPECT_EQ(bench.ColumnOf(kLast).state, ColumnState::kClassed);
  EXPECT_EQ(bench.mapper->ring().counters().missing_columns,
            static_cast<uint32_t>(kColumns - 1 - kLast));
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), Chain::Cells(MapperBench::kBox));
  // The deadline passes; nothing is lost, and the sensor comes back.
  for (int tick = 0; tick < 30; ++tick) {
    bench.mapper->Advance(TimeOf_ns(kLast) + static_cast<uint64_t>(tick) * 10'000'000u);
  }
  EXPECT_EQ(bench.Pending(), 0);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
  bench.GiveAll(4 * kColumns, 4 * kColumns + kAhead);
  bench.mapper->Finish();
  EXPECT_EQ(bench.Folded(), bench.mapper->ring().counters().columns);
  EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
}

// Packets of 16 columns get lost.
// SR-PER08
TEST(Mapper, KeepsTheMapWithPacketsLost) {
  MapperBench bench(false);
  bench.GiveAll(0, kColumns - 1);
  std::mt19937 random(5);
  uint32_t lost = 0;
  for (int packet = 0; packet < 3 * kColumns / 16; ++packet) {
    const int first = kColumns + 16 * packet;
    const bool last = packet == 3 * kColumns / 16 - 1;
    if (random() % 4 == 0 && !last) {
      lost += 16;
      continue;
    }
    bench.GiveAll(first, first + 15);
  }
  EXPECT_EQ(bench.mapper->ring().counters().missing_columns, lost);
  bench.mapper->Finish();
  EXPECT_EQ(bench.Folded(), bench.mapper->ring().counters().columns);
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), Chain::Cells(MapperBench::kBox));
  EXPECT_EQ(bench.Count({-12.0, -12.0, 5.6, 12.0}, Costmap::kHard | Costmap::kSoft), 0);
}

// SR-PER08
TEST(Mapper, TakesEachColumnOnce) {
  MapperBench once(false);
  MapperBench twice(false);
  constexpr int kLast = 2 * kColumns;
  once.GiveAll(0, kLast);
  for (int index = 0; index <= kLast; ++index) {
    EXPECT_EQ(twice.Give(index), Status::kOk);
    EXPECT_EQ(twice.Give(index), Status::kDuplicate);
    EXPECT_EQ(twice.Give(std::max(index - 40, 0)), Status::kDuplicate);
  }
  once.mapper->Finish();
  twice.mapper->Finish();
  EXPECT_EQ(DigestOf(twice.mapper->heights()), DigestOf(once.mapper->heights()));
  EXPECT_EQ(twice.mapper->ring().counters().columns, once.mapper->ring().counters().columns);
  EXPECT_EQ(twice.Folded(), once.Folded());
}

// Packets overtake one another: each pair of them comes the wrong way round.
// SR-PER08
TEST(Mapper, KeepsTheMapWithPacketsOutOfOrder) {
  MapperBench bench(false);
  bench.GiveAll(0, kColumns - 1);
  for (int pair = 0; pair < kColumns / 32; ++pair) {
    const int first = kColumns + 32 * pair;
    bench.GiveAll(first + 16, first + 31);
    bench.GiveAll(first, first + 15);
  }
  const ScanCounters& counters = bench.mapper->ring().counters();
  EXPECT_EQ(counters.late_columns, static_cast<uint32_t>(kColumns / 2));
  EXPECT_EQ(counters.missing_columns, 0u);
  EXPECT_EQ(counters.columns, static_cast<uint32_t>(2 * kColumns));
  bench.mapper->Finish();
  EXPECT_EQ(bench.Folded(), counters.columns);
  EXPECT_EQ(bench.Count(MapperBench::kBox, Costmap::kHard), Chain::Cells(MapperBench::kBox));
}

// Nobody calls Advance: the ring's slots are needed again, and nothing is lost.
TEST(Mapper, FoldsEarlyWhatItsSlotIsNeededFor) {
  MapperBench bench(true);
  const int slots = bench.mapper->ring().slots();
  for (int index = 0; index < slots + kColumns; index += 3) {
    EXPECT_EQ(bench.Give(index), Status::kOk);
  }
  EXPECT_GT(bench.mapper->counters().folded_early, 0u);
  bench.mapper->Finish();
  EXPECT_EQ(bench.Folded(), bench.mapper->ring().counters().columns);
  EXPECT_EQ(bench.Pending(), 0);
}

}  // namespace
}  // namespace hardpack::perception
