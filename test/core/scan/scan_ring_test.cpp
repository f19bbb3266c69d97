// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "core/scan/scan.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kNaN;

class ScanRingTest : public ::testing::Test {
 protected:
  // A column whose rows lie at 1000 + measurement id + row millimetres.
  const LidarColumn& Column(int frame_id, int measurement_id, int beams = 16) {
    *column_ = LidarColumn{};
    column_->frame_id = static_cast<uint16_t>(frame_id);
    column_->measurement_id = static_cast<uint16_t>(measurement_id);
    column_->valid = true;
    column_->beams = beams;
    for (int row = 0; row < beams && row < kMaxBeams; ++row) {
      column_->range_mm[row] = static_cast<uint32_t>(1000 + measurement_id + row);
    }
    return *column_;
  }
  Status PushColumn(const LidarColumn& column, uint64_t time_ns = 0,
                    const Transform3& pose = Transform3{}) {
    return ring_->Push(column, time_ns, pose, self_);
  }
  Status Push(int frame_id, int measurement_id) {
    return PushColumn(Column(frame_id, measurement_id));
  }
  int64_t Sequence(int frame_id, int measurement_id) const {
    return ring_->SequenceOf(static_cast<uint16_t>(frame_id), static_cast<uint16_t>(measurement_id))
        .value();
  }
  Status SequenceStatus(int frame_id, int measurement_id) const {
    return ring_->SequenceOf(static_cast<uint16_t>(frame_id), static_cast<uint16_t>(measurement_id))
        .status();
  }
  int Slot(int frame_id, int measurement_id) const {
    return ring_->SlotOf(Sequence(frame_id, measurement_id));
  }
  bool Holds(int frame_id, int measurement_id) const {
    return ring_->Holds(Sequence(frame_id, measurement_id));
  }
  const ScanCounters& counters() const { return ring_->counters(); }

  std::unique_ptr<ScanRing> ring_ = std::make_unique<ScanRing>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
  std::vector<uint8_t> self_ = std::vector<uint8_t>(16, 0);
};

TEST_F(ScanRingTest, RefusesWhatDoesNotFit) {
  EXPECT_EQ(ring_->Configure(128, 2048), Status::kCapacityExceeded);
  EXPECT_EQ(Push(0, 0), Status::kNotStarted);
  EXPECT_EQ(SequenceStatus(0, 0), Status::kNotStarted);
  EXPECT_FALSE(ring_->Holds(0));
  EXPECT_EQ(ring_->slots(), 0);
  EXPECT_EQ(ring_->Configure(0, 1024), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(129, 1024), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(64, 0), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(16, 4096), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(16, 512, 0, 512), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(16, 512, -1, 511), Status::kInvalidArgument);
  EXPECT_EQ(Push(0, 0), Status::kNotStarted);
  int64_t sequence = -1;
  EXPECT_EQ(ring_->FindForLabels(0, 0, sequence), Status::kBadColumn);
}

TEST_F(ScanRingTest, HoldsAtLeastThreeRevolutionsOfEverySensor) {
  for (const int beams : {1, 16, 32, 63, 64, 127, 128}) {
    for (const int columns : {1, 2, 511, 512, 1023, 1024, 2047, 2048}) {
      if (beams * columns > ScanRing::kCapacityReturns) continue;
      ASSERT_EQ(ring_->Configure(beams, columns), Status::kOk);
      EXPECT_GE(ring_->slots(), 3 * columns);
      EXPECT_EQ(ring_->slots() % columns, 0);
      EXPECT_LE(ring_->slots(), ScanRing::kMaxColumns);
      EXPECT_LE(ring_->slots() * beams, ScanRing::kMaxReturns);
    }
  }
}

TEST_F(ScanRingTest, FilesAColumnWithItsTimeItsPoseAndItself) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Transform3 pose;
  pose.translation = {1.0f, 2.0f, 3.0f};
  Column(7, 300);
  column_->range_mm[5] = 0;
  self_[4] = 1;
  ASSERT_EQ(PushColumn(*column_, 12'345'678'901u, pose), Status::kOk);
  EXPECT_FALSE(Holds(7, 299));
  ASSERT_TRUE(Holds(7, 300));
  EXPECT_EQ(ring_->newest_sequence(), Sequence(7, 300));
  const int slot = Slot(7, 300);
  const ScanColumn& info = ring_->column(slot);
  EXPECT_EQ(info.sequence, Sequence(7, 300));
  EXPECT_EQ(info.frame_id, 7);
  EXPECT_EQ(info.measurement_id, 300);
  EXPECT_EQ(info.time_ns, 12'345'678'901u);
  EXPECT_EQ(info.odom_from_sensor.translation.z_m, 3.0f);
  EXPECT_EQ(info.state, ColumnState::kRaw);
  EXPECT_FALSE(info.labelled);
  EXPECT_EQ(ring_->at(slot, 3).range_mm(), 1303u);
  EXPECT_EQ(ring_->at(slot, 3).return_class(), ReturnClass::kIgnored);
  EXPECT_FALSE(ring_->at(slot, 3).self());
  EXPECT_TRUE(ring_->at(slot, 4).self());
  EXPECT_EQ(ring_->at(slot, 5).range_mm(), 0u);
  EXPECT_EQ(counters().columns, 1u);
}

// Sequence numbers count on, one a column, from a number that leaves room for what comes late.
TEST_F(ScanRingTest, NumbersColumnsFromItsOwnLengthOn) {
  for (const int frame_id : {0, 3, 65535}) {
    ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
    EXPECT_EQ(ring_->newest_sequence(), -1);
    ASSERT_EQ(Push(frame_id, 17), Status::kOk);
    EXPECT_GE(ring_->newest_sequence(), ring_->slots());
    EXPECT_EQ(ring_->newest_sequence() % 512, 17);
    EXPECT_EQ(Sequence(frame_id, 18), ring_->newest_sequence() + 1);
    EXPECT_EQ(Sequence(frame_id + 1, 17), ring_->newest_sequence() + 512);
    EXPECT_EQ(Sequence(frame_id - 1, 511), ring_->newest_sequence() - 18);
  }
}

TEST_F(ScanRingTest, ConfigureEmptiesIt) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(7, 300), Status::kOk);
  const int slot = Slot(7, 300);
  ring_->MarkClassed(slot);
  ring_->MarkFolded(slot);
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  EXPECT_EQ(ring_->column(slot).state, ColumnState::kAbsent);
  EXPECT_EQ(ring_->at(slot, 0).range_mm(), 0u);
  EXPECT_EQ(counters().columns, 0u);
  EXPECT_EQ(ring_->fold_count(), 0u);
  EXPECT_EQ(Push(7, 302), Status::kOk);
  EXPECT_FALSE(Holds(7, 300));
  EXPECT_EQ(counters().missing_columns, 0u);
}

TEST_F(ScanRingTest, ConfigureLeavesNoReturnInAnySlot) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  for (int turn = 0; turn < ring_->slots() / 512; ++turn) {
    for (int id = 0; id < 512; ++id) ASSERT_EQ(Push(turn, id), Status::kOk);
  }
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  for (int slot = 0; slot < ring_->slots(); ++slot) {
    for (int row = 0; row < 16; ++row) ASSERT_EQ(ring_->at(slot, row).range_mm(), 0u) << slot;
  }
}

TEST_F(ScanRingTest, RefusesBadColumnsAndCountsThem) {
  ASSERT_EQ(ring_->Configure(16, 512, 10, 20), Status::kOk);
  EXPECT_EQ(Push(0, 512), Status::kBadColumn);
  EXPECT_EQ(Push(0, 65535), Status::kBadColumn);
  EXPECT_EQ(Push(0, 9), Status::kBadColumn);
  EXPECT_EQ(Push(0, 21), Status::kBadColumn);
  EXPECT_EQ(PushColumn(Column(0, 15, 32)), Status::kBadColumn);
  Column(0, 15);
  column_->beams = -1;
  EXPECT_EQ(PushColumn(*column_), Status::kBadColumn);
  column_->beams = INT32_MAX;
  EXPECT_EQ(PushColumn(*column_), Status::kBadColumn);
  EXPECT_EQ(counters().bad_columns, 7u);
  Column(0, 15);
  column_->valid = false;
  EXPECT_EQ(PushColumn(*column_), Status::kColumnInvalid);
  EXPECT_EQ(counters().invalid_columns, 1u);
  Transform3 nowhere;
  nowhere.translation.y_m = kNaN;
  EXPECT_EQ(PushColumn(Column(0, 15), 0, nowhere), Status::kNotFinite);
  self_.resize(15);
  EXPECT_EQ(Push(0, 15), Status::kInvalidArgument);
  EXPECT_EQ(ring_->newest_sequence(), -1);
  EXPECT_EQ(counters().columns, 0u);
}

TEST_F(ScanRingTest, FilesRangesBeyondItsWidthAsNoReturn) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Column(0, 0);
  column_->range_mm[0] = 0x7ffff;
  column_->range_mm[1] = 0x80001;
  column_->range_mm[2] = 0xffffffff;
  ASSERT_EQ(PushColumn(*column_), Status::kOk);
  const int slot = Slot(0, 0);
  EXPECT_EQ(ring_->at(slot, 0).range_mm(), 0x7ffffu);
  EXPECT_EQ(ring_->at(slot, 1).range_mm(), 0u);
  EXPECT_EQ(ring_->at(slot, 2).range_mm(), 0u);
  EXPECT_FALSE(ring_->at(slot, 1).labelled());
  EXPECT_EQ(counters().unusable_ranges, 2u);
}

TEST_F(ScanRingTest, FilesTheNearerOfTwoReturns) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Column(0, 0);
  column_->returns = 2;
  column_->second_range_mm[0] = 999;
  column_->second_range_mm[1] = 5000;
  column_->range_mm[2] = 0x80001;  // beyond the width, but the other one is nearer
  column_->second_range_mm[2] = 8000;
  ASSERT_EQ(PushColumn(*column_), Status::kOk);
  EXPECT_EQ(ring_->at(Slot(0, 0), 0).range_mm(), 999u);
  EXPECT_EQ(ring_->at(Slot(0, 0), 1).range_mm(), 1001u);
  EXPECT_EQ(ring_->at(Slot(0, 0), 2).range_mm(), 8000u);
  EXPECT_EQ(counters().unusable_ranges, 0u);
}

//  frame 4:  ... 508 509 [510 511]    frame 5: [0 1] 2 ...      [ ] lost
TEST_F(ScanRingTest, CountsColumnsMissingAcrossFrames) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(4, 508), Status::kOk);
  ASSERT_EQ(Push(4, 509), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 0u);
  ASSERT_EQ(Push(5, 2), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 4u);
  ASSERT_EQ(Push(7, 2), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 4u + 1023u);
}

TEST_F(ScanRingTest, CountsOnAcrossTheWrapOfTheFrameCounter) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(65535, 511), Status::kOk);
  const int64_t before = ring_->newest_sequence();
  ASSERT_EQ(Push(0, 0), Status::kOk);
  EXPECT_EQ(ring_->newest_sequence(), before + 1);
  EXPECT_EQ(Push(65535, 510), Status::kOk);
  EXPECT_EQ(Push(65535, 511), Status::kDuplicate);
  EXPECT_EQ(counters().missing_columns, 0u);
  EXPECT_EQ(counters().restarts, 0u);
}

TEST_F(ScanRingTest, ExpectsOnlyColumnsOfTheWindow) {
  ASSERT_EQ(ring_->Configure(16, 512, 100, 199), Status::kOk);
  EXPECT_EQ(ring_->window_columns(), 100);
  ASSERT_EQ(Push(4, 199), Status::kOk);
  ASSERT_EQ(Push(5, 100), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 0u);
  ASSERT_EQ(Push(6, 101), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 100u);
}

// The window 500 .. 11 wraps; a frame begins at measurement id 0 all the same.
TEST_F(ScanRingTest, ExpectsOnlyColumnsOfAWindowThatWraps) {
  ASSERT_EQ(ring_->Configure(16, 512, 500, 11), Status::kOk);
  EXPECT_EQ(ring_->window_columns(), 24);
  EXPECT_TRUE(ring_->InWindow(0));
  EXPECT_FALSE(ring_->InWindow(12));
  EXPECT_FALSE(ring_->InWindow(499));
  ASSERT_EQ(Push(4, 11), Status::kOk);
  ASSERT_EQ(Push(4, 500), Status::kOk);
  for (int id = 501; id < 512; ++id) ASSERT_EQ(Push(4, id), Status::kOk);
  ASSERT_EQ(Push(5, 0), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 0u);
  EXPECT_EQ(counters().incomplete_revolutions, 0u);
  ASSERT_EQ(Push(5, 500), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 11u);
}

TEST_F(ScanRingTest, RefusesAColumnThatCameBeforeWhateverItsTime) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(PushColumn(Column(4, 8), 1000), Status::kOk);
  ASSERT_EQ(PushColumn(Column(4, 9), 2000), Status::kOk);
  EXPECT_EQ(PushColumn(Column(4, 9), 2000), Status::kDuplicate);
  EXPECT_EQ(PushColumn(Column(4, 8), 9000), Status::kDuplicate);
  EXPECT_EQ(counters().duplicates, 2u);
  EXPECT_EQ(ring_->column(Slot(4, 8)).time_ns, 1000u);
  ASSERT_EQ(Push(4, 10), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 0u);
}

TEST_F(ScanRingTest, FilesColumnsThatComeLate) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  for (const int id : {0, 3}) ASSERT_EQ(Push(4, id), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 2u);
  for (const int id : {1, 2, 4}) ASSERT_EQ(Push(4, id), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 0u);
  EXPECT_EQ(counters().late_columns, 2u);
  for (int id = 0; id < 5; ++id) EXPECT_TRUE(Holds(4, id));
  EXPECT_EQ(ring_->newest_sequence(), Sequence(4, 4));
}

// The first that comes need not be the first that was sent.
//
//   sent:  3/510  3/511  4/0  4/1        come:  4/1, then 3/510
TEST_F(ScanRingTest, FilesColumnsFromBeforeTheFirstThatCame) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(4, 1), Status::kOk);
  ASSERT_EQ(Push(3, 510), Status::kOk);
  EXPECT_TRUE(Holds(3, 510));
  EXPECT_EQ(counters().missing_columns, 2u);
  EXPECT_EQ(counters().late_columns, 1u);
  ASSERT_EQ(Push(4, 0), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 1u);
}

// 64 x 2048: three revolutions. With 4/100 the newest, 1/101 is the oldest that has a slot.
TEST_F(ScanRingTest, RefusesColumnsThatItNoLongerReachesBackTo) {
  self_.assign(64, 0);
  ASSERT_EQ(ring_->Configure(64, 2048), Status::kOk);
  ASSERT_EQ(ring_->slots(), 3 * 2048);
  ASSERT_EQ(PushColumn(Column(4, 100, 64)), Status::kOk);
  EXPECT_EQ(PushColumn(Column(1, 100, 64)), Status::kLate);
  EXPECT_EQ(PushColumn(Column(1, 101, 64)), Status::kOk);
  EXPECT_EQ(PushColumn(Column(0, 2047, 64)), Status::kLate);
  EXPECT_EQ(PushColumn(Column(4 - ScanRing::kMaxFrameGap, 5, 64)), Status::kLate);
  EXPECT_EQ(counters().too_late_columns, 3u);
  EXPECT_EQ(counters().restarts, 0u);
  EXPECT_EQ(counters().columns, 2u);
}

TEST_F(ScanRingTest, LetsALaterRevolutionTakeTheSlot) {
  self_.assign(64, 0);
  ASSERT_EQ(ring_->Configure(64, 2048), Status::kOk);
  ASSERT_EQ(PushColumn(Column(4, 100, 64)), Status::kOk);
  const int64_t old = Sequence(4, 100);
  ring_->MarkLabelled(ring_->SlotOf(old));
  ASSERT_EQ(PushColumn(Column(6, 100, 64)), Status::kOk);
  EXPECT_TRUE(ring_->Holds(old));
  ASSERT_EQ(PushColumn(Column(7, 100, 64)), Status::kOk);
  EXPECT_FALSE(ring_->Holds(old));
  EXPECT_EQ(ring_->column(ring_->SlotOf(old)).frame_id, 7);
  EXPECT_EQ(ring_->column(ring_->SlotOf(old)).state, ColumnState::kRaw);
  EXPECT_FALSE(ring_->column(ring_->SlotOf(old)).labelled);
}

TEST_F(ScanRingTest, TakesFarJumpsForARestart) {
  for (const int jump : {ScanRing::kMaxFrameGap + 1, 30000, -30000, -ScanRing::kMaxFrameGap - 1}) {
    ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
    ASSERT_EQ(Push(200, 100), Status::kOk);
    EXPECT_EQ(Push(200 + jump, 7), Status::kSensorRestarted) << jump;
    EXPECT_EQ(counters().restarts, 1u);
    EXPECT_EQ(counters().columns, 1u);
    EXPECT_TRUE(Holds(200, 100));
    EXPECT_EQ(Push(200 + ScanRing::kMaxFrameGap, 100), Status::kOk);
    EXPECT_EQ(counters().missing_columns, 512u * ScanRing::kMaxFrameGap - 1u);
  }
}

TEST_F(ScanRingTest, BeginsAnewAfterTheSensorRestarted) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ring_->Restart();
  ASSERT_EQ(Push(40000, 100), Status::kOk);
  ASSERT_EQ(Push(40001, 110), Status::kOk);
  const int64_t old = ring_->newest_sequence();
  EXPECT_EQ(Push(0, 7), Status::kSensorRestarted);
  ring_->Restart();
  EXPECT_EQ(ring_->newest_sequence(), -1);
  EXPECT_FALSE(ring_->Holds(old));
  const uint32_t missing = counters().missing_columns;
  ASSERT_EQ(Push(0, 7), Status::kOk);
  // Numbers are not given twice, not even to what comes late.
  EXPECT_GE(ring_->newest_sequence() - ring_->slots(), old);
  EXPECT_EQ(counters().missing_columns, missing);
  EXPECT_EQ(counters().columns, 3u);
  ASSERT_EQ(Push(0, 9), Status::kOk);
  EXPECT_EQ(counters().missing_columns, missing + 1);
}

TEST_F(ScanRingTest, CountsRevolutionsAndWhichOfThemWereIncomplete) {
  ASSERT_EQ(ring_->Configure(16, 4), Status::kOk);
  // Begun in its middle: what came before is not missing.
  ASSERT_EQ(Push(9, 2), Status::kOk);
  ASSERT_EQ(Push(9, 3), Status::kOk);
  EXPECT_EQ(counters().revolutions, 1u);
  for (int id = 0; id < 4; ++id) ASSERT_EQ(Push(10, id), Status::kOk);
  EXPECT_EQ(counters().revolutions, 2u);
  for (const int id : {0, 3, 1}) ASSERT_EQ(Push(11, id), Status::kOk);
  EXPECT_EQ(counters().incomplete_revolutions, 0u);
  ASSERT_EQ(Push(12, 0), Status::kOk);
  EXPECT_EQ(counters().incomplete_revolutions, 1u);
  // Late: the column is no longer missing, but the revolution had ended without it.
  ASSERT_EQ(Push(11, 2), Status::kOk);
  EXPECT_EQ(counters().incomplete_revolutions, 1u);
  EXPECT_EQ(counters().missing_columns, 0u);
  // 12 lacks three columns, and of 13 and 14 nothing comes.
  ASSERT_EQ(Push(15, 0), Status::kOk);
  EXPECT_EQ(counters().revolutions, 7u);
  EXPECT_EQ(counters().incomplete_revolutions, 4u);
  EXPECT_EQ(counters().missing_columns, 11u);
}

TEST_F(ScanRingTest, EndsTheRevolutionOfASensorThatFellSilent) {
  ASSERT_EQ(ring_->Configure(16, 512, 500, 11), Status::kOk);
  ring_->EndRevolution();
  EXPECT_EQ(counters().missing_columns, 0u);
  for (const int id : {0, 1, 2}) ASSERT_EQ(Push(4, id), Status::kOk);
  ring_->EndRevolution();
  EXPECT_EQ(counters().missing_columns, 21u);
  EXPECT_EQ(counters().incomplete_revolutions, 1u);
  ring_->EndRevolution();
  EXPECT_EQ(counters().missing_columns, 21u);
  EXPECT_EQ(counters().incomplete_revolutions, 1u);
  // It goes on all the same.
  ASSERT_EQ(Push(4, 501), Status::kOk);
  EXPECT_EQ(ring_->newest_sequence(), Sequence(4, 501));
  EXPECT_EQ(counters().missing_columns, 20u);
  EXPECT_EQ(counters().late_columns, 1u);
  ring_->EndRevolution();
  EXPECT_EQ(counters().missing_columns, 20u);
  ASSERT_EQ(Push(5, 1), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 21u);
  EXPECT_EQ(counters().incomplete_revolutions, 1u);
}

TEST_F(ScanRingTest, EndsARevolutionThatIsComplete) {
  ASSERT_EQ(ring_->Configure(16, 4), Status::kOk);
  for (int id = 0; id < 4; ++id) ASSERT_EQ(Push(9, id), Status::kOk);
  ring_->EndRevolution();
  EXPECT_EQ(counters().missing_columns, 0u);
  EXPECT_EQ(counters().incomplete_revolutions, 0u);
  ASSERT_EQ(Push(10, 0), Status::kOk);
  EXPECT_EQ(counters().missing_columns, 0u);
}

TEST_F(ScanRingTest, LeadsAColumnFromRawToFolded) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(4, 8), Status::kOk);
  ASSERT_EQ(Push(4, 9), Status::kOk);
  for (const int id : {8, 9}) {
    const int slot = Slot(4, id);
    PackedReturn packed = ring_->at(slot, 2);
    packed.SetClass(ReturnClass::kSoft, false);
    packed.SetHeight(80);
    ring_->Set(slot, 2, packed);
    EXPECT_EQ(ring_->at(slot, 2).return_class(), ReturnClass::kSoft);
    EXPECT_EQ(ring_->at(slot, 2).height_cm(), 80);
    EXPECT_EQ(ring_->at(slot, 3).return_class(), ReturnClass::kIgnored);
    EXPECT_EQ(ring_->column(slot).state, ColumnState::kRaw);
    ring_->MarkClassed(slot);
    EXPECT_EQ(ring_->column(slot).state, ColumnState::kClassed);
    const uint32_t before = ring_->fold_count();
    ring_->MarkFolded(slot);
    EXPECT_EQ(ring_->column(slot).state, ColumnState::kFolded);
    EXPECT_EQ(ring_->column(slot).fold_count, before);
    EXPECT_EQ(ring_->fold_count(), before + 1);
  }
}

using ScanRingDeathTest = ScanRingTest;

TEST_F(ScanRingDeathTest, NeverGoesBack) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(4, 8), Status::kOk);
  const int slot = Slot(4, 8);
  EXPECT_DEATH(ring_->MarkFolded(slot), "");
  EXPECT_DEATH(ring_->MarkClassed(slot + 1), "");
  EXPECT_DEATH(ring_->MarkLabelled(slot + 1), "");
  ring_->MarkClassed(slot);
  EXPECT_DEATH(ring_->MarkClassed(slot), "");
  ring_->MarkFolded(slot);
  EXPECT_DEATH(ring_->MarkFolded(slot), "");
  EXPECT_DEATH(ring_->MarkLabelled(slot), "");
}

TEST_F(ScanRingTest, FindsColumnsForTheirLabels) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  for (const int id : {8, 9, 10}) ASSERT_EQ(Push(65535, id), Status::kOk);
  ASSERT_EQ(Push(0, 8), Status::kOk);
  int64_t sequence = -1;
  // Raw columns take labels as classed ones do.
  EXPECT_EQ(ring_->FindForLabels(65535, 8, sequence), Status::kOk);
  EXPECT_EQ(sequence, Sequence(65535, 8));
  ring_->MarkClassed(Slot(65535, 8));
  EXPECT_EQ(ring_->FindForLabels(65535, 8, sequence), Status::kOk);
  ring_->MarkLabelled(Slot(65535, 8));
  EXPECT_TRUE(ring_->column(Slot(65535, 8)).labelled);
  EXPECT_EQ(ring_->FindForLabels(65535, 8, sequence), Status::kDuplicate);
  ring_->MarkFolded(Slot(65535, 8));
  EXPECT_EQ(ring_->FindForLabels(65535, 8, sequence), Status::kDuplicate);
  EXPECT_EQ(counters().duplicate_labels, 2u);
  ring_->MarkClassed(Slot(65535, 9));
  ring_->MarkFolded(Slot(65535, 9));
  EXPECT_EQ(ring_->FindForLabels(65535, 9, sequence), Status::kLate);
  EXPECT_EQ(sequence, Sequence(65535, 9));
  EXPECT_EQ(counters().late_labels, 1u);
  EXPECT_EQ(counters().labels_without_column, 0u);
}

TEST_F(ScanRingTest, HasNoColumnForStrayLabels) {
  ASSERT_EQ(ring_->Configure(16, 512, 0, 100), Status::kOk);
  int64_t sequence = -7;
  EXPECT_EQ(ring_->FindForLabels(4, 8, sequence), Status::kBadColumn);
  ASSERT_EQ(Push(4, 8), Status::kOk);
  const int stray[][2] = {{3, 8}, {5, 8}, {4, 7}, {4, 101}, {4, 512}, {4, 65535}, {40000, 8}};
  for (const auto& [frame_id, id] : stray) {
    EXPECT_EQ(
        ring_->FindForLabels(static_cast<uint16_t>(frame_id), static_cast<uint16_t>(id), sequence),
        Status::kBadColumn);
  }
  EXPECT_EQ(sequence, -7);
  EXPECT_EQ(counters().labels_without_column, 8u);
}

TEST_F(ScanRingTest, RaisesThePosesOfItsColumns) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Transform3 pose;
  pose.translation = {1.0f, 2.0f, 3.0f};
  ASSERT_EQ(PushColumn(Column(4, 8), 0, pose), Status::kOk);
  ring_->ShiftHeights(-0.5f);
  const Vec3& translation = ring_->column(Slot(4, 8)).odom_from_sensor.translation;
  EXPECT_EQ(translation.x_m, 1.0f);
  EXPECT_EQ(translation.y_m, 2.0f);
  EXPECT_EQ(translation.z_m, 2.5f);
}

}  // namespace
}  // namespace hardpack
