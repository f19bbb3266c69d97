// SPDX-License-Identifier: Apache-2.0
// Anything in any order: what comes out does not depend on when Advance is called, nothing crashes,
// and every column that was filed is folded exactly once.
#include <gtest/gtest.h>

#include <deque>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "test/core/autonomy/mapper_bench.h"

namespace hardpack::perception {
namespace {

TEST(MapperSequences, WithoutLabelsTheGridDoesNotDependOnAdvance) {
  constexpr int kFirst = 300;
  constexpr int kLast = 2 * kColumns;
  uint64_t expected = 0;
  for (const unsigned seed : {0u, 1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    MapperBench bench(false);
    std::mt19937 random(seed);
    for (int index = kFirst; index <= kLast; ++index) {
      EXPECT_EQ(bench.Give(index), Status::kOk);
      // None at all; then, with another seed each, now and then several.
      while (seed != 0 && random() % (40 * seed) == 0) bench.mapper->Advance(TimeOf_ns(index));
    }
    bench.mapper->Finish();
    const uint64_t digest = DigestOf(bench.mapper->heights());
    if (seed == 0) expected = digest;
    EXPECT_EQ(digest, expected);
    EXPECT_EQ(bench.HardInGrid(MapperBench::kBox), Chain::Cells(MapperBench::kBox));
  }
}

// A small lidar, whose ring turns over quickly, and everything that may come on its wires.
class Storm {
 public:
  static constexpr int kStormBeams = 6;
  static constexpr int kStormColumns = 90;
  static constexpr uint64_t kColumn_ns = 1'111'111;

  explicit Storm(unsigned seed) : random_(seed) {
    const float altitude_deg[kStormBeams] = {15.0f, 4.0f, -3.0f, -8.0f, -14.0f, -20.0f};
    const float azimuth_deg[kStormBeams] = {4.0f, -4.0f, 12.0f, 0.0f, -12.0f, 8.0f};
    BeamModel model;
    EXPECT_EQ(MakeBeamModel(altitude_deg, azimuth_deg, kStormColumns, 0.01f, Transform3{}, model),
              Status::kOk);
    PerceptionParams params;
    params.mapping.use_labels = static_cast<int32_t>(random_() % 2);
    window_first_ = static_cast<int>(random_() % kStormColumns);
    window_last_ = static_cast<int>(random_() % kStormColumns);
    EXPECT_EQ(mapper_->Configure(params, CostmapParams{}, RellisLabelTable(), model, window_first_,
                                 window_last_),
              Status::kOk);
  }

  void Blow(int events) {
    for (int event = 0; event < events; ++event) {
      const uint64_t kind = random_() % 64;
      if (kind < 36) GiveColumn();
      if (kind >= 36 && kind < 48) GiveLabels();
      if (kind >= 48 && kind < 58) GivePose();
      if (kind >= 58) mapper_->Advance(now_ns_ + random_() % 3 * 20'000'000u);
      if (event % 16 == 0) CheckCounters();
    }
  }

  void CheckAllFolded() {
    mapper_->Finish();
    EXPECT_EQ(Pending(), 0u);
    EXPECT_EQ(Folded() + dropped_, mapper_->ring().counters().columns);
    EXPECT_EQ(mapper_->fold_count(), Folded());
  }

  const Mapper& mapper() const { return *mapper_; }

 private:
  bool Rarely() { return random_() % 50 == 0; }

  float Strange() {
    constexpr float kStrange[] = {std::numeric_limits<float>::quiet_NaN(),
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  3.0e38f,
                                  -1.0e6f,
                                  1.0e-40f};
    return kStrange[random_() % std::size(kStrange)];
  }

  void GiveColumn() {
    LidarColumn column;
    turn_ += random_() % 4 == 0 ? random_() % 4 : 1;
    if (random_() % 500 == 0) turn_ += random_() % 20'000 * kStormColumns;
    // Most in order, some late by up to two revolutions.
    const uint64_t index = turn_ - (random_() % 8 == 0 ? random_() % (2 * kStormColumns) : 0);
    column.frame_id = static_cast<uint16_t>(Rarely() ? random_() : index / kStormColumns);
    column.measurement_id = static_cast<uint16_t>(Rarely() ? random_() : index % kStormColumns);
    column.valid = !Rarely();
    column.beams = Rarely() ? static_cast<int32_t>(random_()) : kStormBeams;
    column.returns = 1 + static_cast<int32_t>(random_() % 2);
    for (int row = 0; row < kStormBeams; ++row) {
      column.range_mm[row] = static_cast<uint32_t>(Rarely() ? random_() : random_() % 30'000);
      column.second_range_mm[row] = static_cast<uint32_t>(random_() % 30'000);
    }
    now_ns_ += random_() % (2 * kColumn_ns);
    const uint64_t time_ns = Rarely() ? random_() : now_ns_ - random_() % 3 * 1'000'000u;
    static_cast<void>(mapper_->AddColumn(column, time_ns));
    sent_.push_back(column);
    if (sent_.size() > 200) sent_.pop_front();
  }

  void GiveLabels() {
    ColumnLabels labels;
    labels.beams = Rarely() ? static_cast<int32_t>(random_()) : kStormBeams;
    labels.frame_id = static_cast<uint16_t>(random_());
    labels.measurement_id = static_cast<uint16_t>(random_() % kStormColumns);
    if (!sent_.empty() && !Rarely()) {
      const LidarColumn& column = sent_[random_() % sent_.size()];
      labels.frame_id = column.frame_id;
      labels.measurement_id = column.measurement_id;
    }
    for (uint8_t& label : labels.label) label = static_cast<uint8_t>(random_() % 40);
    static_cast<void>(mapper_->AddLabels(labels));
  }

  void GivePose() {
    StampedPose pose = StandingAt(now_ns_ - (Rarely() ? 5'000'000 : 0));
    x_m_ += 0.05f;
    pose.position = {x_m_, 0.3f * x_m_, random_() % 40 == 0 ? 0.7f : 0.0f};
    pose.yaw_rad = 0.2f * x_m_;
    if (random_() % 100 == 0) x_m_ += 50.0f;
    if (Rarely()) pose.position.x_m = Strange();
    if (Rarely()) pose.position.z_m = Strange();
    if (Rarely()) pose.pitch_rad = Strange();
    const uint32_t pending = Pending();
    const uint32_t jumps = mapper_->counters().position_jumps;
    static_cast<void>(mapper_->AddPose(pose));
    // A position jump empties the map, and what was on the way to it.
    if (mapper_->counters().position_jumps != jumps) dropped_ += pending;
  }

  uint32_t Pending() const {
    uint32_t pending = 0;
    for (int slot = 0; slot < mapper_->ring().slots(); ++slot) {
      const ColumnState state = mapper_->ring().column(slot).state;
      pending += state == ColumnState::kRaw || state == ColumnState::kClassed ? 1 : 0;
    }
    return pending;
  }

  uint32_t Folded() const {
    const MapperCounters& counters = mapper_->counters();
    return counters.folded_with_labels + counters.folded_without_labels;
  }

  void CheckCounters() {
    ASSERT_EQ(Folded() + Pending() + dropped_, mapper_->ring().counters().columns);
  }

  std::mt19937_64 random_;
  int window_first_ = 0;
  int window_last_ = 0;
  uint64_t turn_ = 3 * kStormColumns;
  uint64_t now_ns_ = 1'000'000'000;
  float x_m_ = 0.0f;
  uint32_t dropped_ = 0;
  std::deque<LidarColumn> sent_;
  std::unique_ptr<Mapper> mapper_ = std::make_unique<Mapper>();
};

TEST(MapperSequences, EveryFiledColumnIsFoldedOnceWhateverComes) {
  MapperCounters sum;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const auto storm = std::make_unique<Storm>(seed);
    storm->Blow(2500);
    if (::testing::Test::HasFatalFailure()) return;
    storm->CheckAllFolded();
    const MapperCounters& counters = storm->mapper().counters();
    sum.folded_with_labels += counters.folded_with_labels;
    sum.folded_without_labels += counters.folded_without_labels;
    sum.position_jumps += counters.position_jumps;
    sum.height_jumps += counters.height_jumps;
    sum.sensor_restarts += counters.sensor_restarts;
    sum.late_unclassed_columns += counters.late_unclassed_columns;
    sum.columns_without_pose += counters.columns_without_pose;
  }
  // The storm blows from everywhere.
  EXPECT_GT(sum.folded_with_labels, 0u);
  EXPECT_GT(sum.folded_without_labels, 0u);
  EXPECT_GT(sum.position_jumps, 0u);
  EXPECT_GT(sum.height_jumps, 0u);
  EXPECT_GT(sum.sensor_restarts, 0u);
  EXPECT_GT(sum.late_unclassed_columns, 0u);
  EXPECT_GT(sum.columns_without_pose, 0u);
}

// The lidar was out of reach again and again, and nobody called Advance.
TEST(MapperSequences, FinishFoldsWhatManyJumpsOfTheCounterLeftBehind) {
  MapperBench bench(true);
  for (int jump = 0; jump < 8; ++jump) {
    const int first = jump * 95 * kColumns;
    bench.GiveAll(first, first + 200);
  }
  EXPECT_GT(bench.Pending(), 0);
  bench.mapper->Finish();
  EXPECT_EQ(bench.Pending(), 0);
  EXPECT_EQ(bench.Folded(), bench.mapper->ring().counters().columns);
}

// The times of a second recording lie before those of the first.
TEST(MapperSequences, SilenceIsToldAfterConfigureWhateverCameBeforeIt) {
  MapperBench bench(false);
  bench.GiveAll(10 * kColumns, 10 * kColumns + 200);
  bench.Configure();
  for (uint64_t time_ns = TimeOf_ns(0); time_ns < TimeOf_ns(400); time_ns += 10'000'000) {
    EXPECT_EQ(bench.mapper->AddPose(StandingAt(time_ns)), Status::kOk);
  }
  for (int index = 0; index <= 200; ++index) {
    EXPECT_EQ(bench.mapper->AddColumn(bench.Cast(index).first, TimeOf_ns(index)), Status::kOk);
  }
  EXPECT_GT(bench.Pending(), 0);
  bench.mapper->Advance(TimeOf_ns(200) + static_cast<uint64_t>(Mapper::kSilence_ns) + 1);
  EXPECT_EQ(bench.Pending(), 0);
}

}  // namespace
}  // namespace hardpack::perception
