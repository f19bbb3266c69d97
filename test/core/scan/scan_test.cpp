// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <vector>

namespace hardpack {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kPiDouble = 3.14159265358979323846;

std::unique_ptr<BeamModel> EvenModel(int beams, int columns, float origin_m) {
  std::vector<float> altitude(static_cast<size_t>(beams));
  std::vector<float> azimuth(static_cast<size_t>(beams));
  for (int row = 0; row < beams; ++row) {
    altitude[static_cast<size_t>(row)] = 16.0f - 0.5f * static_cast<float>(row);
    azimuth[static_cast<size_t>(row)] = 3.0f - 2.0f * static_cast<float>(row % 4);
  }
  auto model = std::make_unique<BeamModel>();
  const Transform3 half_turn{{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0.0f, 0.0f, 0.03618f}};
  EXPECT_EQ(MakeBeamModel(altitude, azimuth, columns, origin_m, half_turn, *model), Status::kOk);
  return model;
}

TEST(BeamModel, RefusesWhatIsNoSensor) {
  const std::vector<float> angles(64, 1.0f);
  const std::vector<float> fewer(63, 1.0f);
  const std::vector<float> too_many(129, 1.0f);
  const Transform3 identity;
  auto model = std::make_unique<BeamModel>();
  EXPECT_EQ(MakeBeamModel(angles, fewer, 1024, 0.0f, identity, *model), Status::kInvalidArgument);
  EXPECT_EQ(MakeBeamModel({}, {}, 1024, 0.0f, identity, *model), Status::kInvalidArgument);
  EXPECT_EQ(MakeBeamModel(too_many, too_many, 1024, 0.0f, identity, *model),
            Status::kInvalidArgument);
  EXPECT_EQ(MakeBeamModel(angles, angles, 0, 0.0f, identity, *model), Status::kInvalidArgument);
  EXPECT_EQ(MakeBeamModel(angles, angles, 2049, 0.0f, identity, *model), Status::kInvalidArgument);
  EXPECT_EQ(MakeBeamModel(angles, angles, 1024, kNan, identity, *model), Status::kNotFinite);
  std::vector<float> broken = angles;
  broken[63] = kInfinity;
  EXPECT_EQ(MakeBeamModel(angles, broken, 1024, 0.0f, identity, *model), Status::kNotFinite);
  broken[63] = 91.0f;
  EXPECT_EQ(MakeBeamModel(broken, angles, 1024, 0.0f, identity, *model), Status::kInvalidArgument);
  EXPECT_EQ(MakeBeamModel(angles, broken, 1024, 0.0f, identity, *model), Status::kOk);
  Transform3 nowhere;
  nowhere.rotation[4] = kNan;
  EXPECT_EQ(MakeBeamModel(angles, angles, 1024, 0.0f, nowhere, *model), Status::kNotFinite);
  EXPECT_EQ(model->beams, 0);
}

// Column 0 looks along the lidar's +x, which is the sensor's -x; ids grow clockwise seen from
// above.
//
//            m = 3/4 W            lidar frame
//                |
//   m = 1/2 W ---o--- m = 0
//                |
//            m = 1/4 W
TEST(PointInSensor, FollowsTheEncoderClockwise) {
  const std::vector<float> level(1, 0.0f);
  BeamModel model;
  ASSERT_EQ(MakeBeamModel(level, level, 2048, 0.0f, Transform3{}, model), Status::kOk);
  const Vec3 ahead = PointInSensor(model, EncoderSinCos(model, 0), 0, 10000);
  EXPECT_NEAR(ahead.x_m, 10.0f, 1e-5f);
  EXPECT_NEAR(ahead.y_m, 0.0f, 1e-5f);
  const Vec3 right = PointInSensor(model, EncoderSinCos(model, 512), 0, 10000);
  EXPECT_NEAR(right.x_m, 0.0f, 1e-5f);
  EXPECT_NEAR(right.y_m, -10.0f, 1e-5f);
}

TEST(PointInSensor, EqualsTheFormulaInDoublePrecision) {
  constexpr float kOrigin_m = 0.015806f;
  constexpr int kColumns = 1024;
  const auto model = EvenModel(64, kColumns, kOrigin_m);
  const unsigned seed = 20240611;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int i = 0; i < 20000; ++i) {
    const int row = static_cast<int>(random() % 64);
    const int column = static_cast<int>(random() % kColumns);
    const uint32_t range_mm = 300 + static_cast<uint32_t>(random() % 200000);
    const double encoder = 2.0 * kPiDouble * (1.0 - static_cast<double>(column) / kColumns);
    const double azimuth = -(3.0 - 2.0 * (row % 4)) * kPiDouble / 180.0;
    const double altitude = (16.0 - 0.5 * row) * kPiDouble / 180.0;
    const double n = static_cast<double>(kOrigin_m);
    const double r = range_mm / 1000.0;
    const double x =
        (r - n) * std::cos(encoder + azimuth) * std::cos(altitude) + n * std::cos(encoder);
    const double y =
        (r - n) * std::sin(encoder + azimuth) * std::cos(altitude) + n * std::sin(encoder);
    const double z = (r - n) * std::sin(altitude) + 0.03618;
    const Vec3 point = PointInSensor(*model, EncoderSinCos(*model, column), row, range_mm);
    ASSERT_NEAR(static_cast<double>(point.x_m), -x, 2e-4);
    ASSERT_NEAR(static_cast<double>(point.y_m), -y, 2e-4);
    ASSERT_NEAR(static_cast<double>(point.z_m), z, 2e-4);
  }
}

TEST(PackedReturn, KeepsRangeClassAndLabelMark) {
  for (const uint32_t range_mm : {0u, 1u, 16749u, 0x7ffffu}) {
    for (int c = 0; c <= 4; ++c) {
      for (const bool labelled : {false, true}) {
        const PackedReturn packed(range_mm, static_cast<ReturnClass>(c), labelled);
        EXPECT_EQ(packed.range_mm(), range_mm);
        EXPECT_EQ(packed.return_class(), static_cast<ReturnClass>(c));
        EXPECT_EQ(packed.labelled(), labelled);
      }
    }
  }
}

class ScanRingTest : public testing::Test {
 protected:
  // A column whose rows lie at 1000 + measurement id + row millimetres.
  const LidarColumn& Column(int frame_id, int measurement_id, int beams = 16) {
    *column_ = LidarColumn{};
    column_->frame_id = static_cast<uint16_t>(frame_id);
    column_->measurement_id = static_cast<uint16_t>(measurement_id);
    column_->timestamp_ns = static_cast<uint64_t>(frame_id) * 100'000'000u +
                            static_cast<uint64_t>(measurement_id) * 1000u;
    column_->valid = true;
    column_->beams = beams;
    for (int row = 0; row < beams; ++row) {
      column_->range_mm[row] = static_cast<uint32_t>(1000 + measurement_id + row);
    }
    return *column_;
  }
  Status Push(int frame_id, int measurement_id) {
    return ring_->Push(Column(frame_id, measurement_id), Transform3{}, ReturnClass::kHard);
  }

  std::unique_ptr<ScanRing> ring_ = std::make_unique<ScanRing>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

TEST_F(ScanRingTest, RefusesWhatDoesNotFit) {
  EXPECT_EQ(ring_->Configure(128, 2048), Status::kCapacityExceeded);
  EXPECT_EQ(Push(0, 0), Status::kNotStarted);
  EXPECT_EQ(ring_->Configure(0, 1024), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(129, 1024), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(64, 0), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(16, 4096), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(16, 512, 0, 512), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(16, 512, -1, 511), Status::kInvalidArgument);
  EXPECT_EQ(ring_->Configure(128, 1024), Status::kOk);
  EXPECT_EQ(ring_->Configure(64, 2048), Status::kOk);
}

TEST_F(ScanRingTest, FilesAColumnWithItsPose) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Transform3 pose;
  pose.translation = {1.0f, 2.0f, 3.0f};
  Column(7, 300);
  column_->range_mm[5] = 0;
  ASSERT_EQ(ring_->Push(*column_, pose, ReturnClass::kGround), Status::kOk);
  EXPECT_FALSE(ring_->column(299).present);
  EXPECT_TRUE(ring_->column(300).present);
  EXPECT_EQ(ring_->column(300).frame_id, 7);
  EXPECT_EQ(ring_->column(300).timestamp_ns, column_->timestamp_ns);
  EXPECT_EQ(ring_->column(300).odom_from_sensor.translation.z_m, 3.0f);
  EXPECT_EQ(ring_->at(300, 3).range_mm(), 1303u);
  EXPECT_EQ(ring_->at(300, 3).return_class(), ReturnClass::kGround);
  EXPECT_FALSE(ring_->at(300, 3).labelled());
  EXPECT_EQ(ring_->at(300, 5).return_class(), ReturnClass::kIgnored);
  EXPECT_EQ(ring_->counters().columns, 1u);
}

TEST_F(ScanRingTest, ConfigureEmptiesIt) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(7, 300), Status::kOk);
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  EXPECT_FALSE(ring_->column(300).present);
  EXPECT_EQ(ring_->at(300, 0).range_mm(), 0u);
  EXPECT_EQ(ring_->counters().columns, 0u);
  EXPECT_EQ(Push(7, 302), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
}

TEST_F(ScanRingTest, RefusesBadColumnsAndCountsThem) {
  ASSERT_EQ(ring_->Configure(16, 512, 10, 20), Status::kOk);
  EXPECT_EQ(Push(0, 512), Status::kBadColumn);
  EXPECT_EQ(Push(0, 65535), Status::kBadColumn);
  EXPECT_EQ(Push(0, 9), Status::kBadColumn);
  EXPECT_EQ(Push(0, 21), Status::kBadColumn);
  EXPECT_EQ(ring_->Push(Column(0, 15, 32), Transform3{}, ReturnClass::kHard), Status::kBadColumn);
  EXPECT_EQ(ring_->counters().bad_columns, 5u);
  Column(0, 15);
  column_->valid = false;
  EXPECT_EQ(ring_->Push(*column_, Transform3{}, ReturnClass::kHard), Status::kColumnInvalid);
  EXPECT_EQ(ring_->counters().invalid_columns, 1u);
  Transform3 nowhere;
  nowhere.translation.y_m = kNan;
  EXPECT_EQ(ring_->Push(Column(0, 15), nowhere, ReturnClass::kHard), Status::kNotFinite);
  EXPECT_FALSE(ring_->column(15).present);
  EXPECT_EQ(ring_->counters().columns, 0u);
}

TEST_F(ScanRingTest, FilesRangesBeyondItsWidthAsNoReturn) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Column(0, 0);
  column_->range_mm[0] = 0x7ffff;
  column_->range_mm[1] = 0x80001;
  column_->range_mm[2] = 0xffffffff;
  ASSERT_EQ(ring_->Push(*column_, Transform3{}, ReturnClass::kHard), Status::kOk);
  EXPECT_EQ(ring_->at(0, 0).range_mm(), 0x7ffffu);
  EXPECT_EQ(ring_->at(0, 1).range_mm(), 0u);
  EXPECT_EQ(ring_->at(0, 1).return_class(), ReturnClass::kIgnored);
  EXPECT_EQ(ring_->counters().unusable_ranges, 2u);
}

//  frame 4:  ... 508 509 [510 511]    frame 5: [0 1] 2 ...      [ ] lost
TEST_F(ScanRingTest, CountsColumnsMissingAcrossFrames) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(4, 508), Status::kOk);
  ASSERT_EQ(Push(4, 509), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
  ASSERT_EQ(Push(5, 2), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 4u);
  ASSERT_EQ(Push(7, 2), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 4u + 1023u);
}

TEST_F(ScanRingTest, CountsOnAcrossTheWrapOfTheFrameCounter) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(65535, 511), Status::kOk);
  ASSERT_EQ(Push(0, 0), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
  EXPECT_EQ(ring_->counters().restarts, 0u);
}

TEST_F(ScanRingTest, ExpectsOnlyColumnsOfTheWindow) {
  ASSERT_EQ(ring_->Configure(16, 512, 100, 199), Status::kOk);
  EXPECT_EQ(ring_->window_columns(), 100);
  ASSERT_EQ(Push(4, 199), Status::kOk);
  ASSERT_EQ(Push(5, 100), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
  ASSERT_EQ(Push(6, 101), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 100u);
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
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
  ASSERT_EQ(Push(5, 500), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 11u);
}

TEST_F(ScanRingTest, RefusesAColumnThatCameBefore) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(4, 8), Status::kOk);
  ASSERT_EQ(Push(4, 9), Status::kOk);
  EXPECT_EQ(Push(4, 9), Status::kDuplicate);
  EXPECT_EQ(Push(4, 8), Status::kDuplicate);
  EXPECT_EQ(ring_->counters().duplicates, 2u);
  ASSERT_EQ(Push(4, 10), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
}

TEST_F(ScanRingTest, FilesColumnsThatComeLate) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  for (const int id : {0, 3, 1, 2, 4}) ASSERT_EQ(Push(4, id), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 2u);
  EXPECT_EQ(ring_->counters().late_columns, 2u);
  for (int id = 0; id < 5; ++id) EXPECT_TRUE(ring_->column(id).present);
}

TEST_F(ScanRingTest, GoesOnAfterTheSensorRestarted) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  ASSERT_EQ(Push(40000, 100), Status::kOk);
  ASSERT_EQ(Push(0, 7), Status::kOk);
  EXPECT_EQ(ring_->counters().restarts, 1u);
  EXPECT_EQ(ring_->counters().missing_columns, 0u);
  ASSERT_EQ(Push(0, 9), Status::kOk);
  EXPECT_EQ(ring_->counters().missing_columns, 1u);
  // Restarted again, at the same frame id: another time stamp, so no duplicate.
  Column(0, 9);
  column_->timestamp_ns += 5'000'000'000u;
  EXPECT_EQ(ring_->Push(*column_, Transform3{}, ReturnClass::kHard), Status::kOk);
  EXPECT_EQ(ring_->counters().duplicates, 0u);
  EXPECT_EQ(ring_->counters().restarts, 2u);
}

TEST_F(ScanRingTest, LabelsOnlyWhatItHolds) {
  ASSERT_EQ(ring_->Configure(16, 512), Status::kOk);
  Column(4, 8);
  column_->range_mm[2] = 0;
  ASSERT_EQ(ring_->Push(*column_, Transform3{}, ReturnClass::kHard), Status::kOk);
  ColumnLabels labels;
  labels.frame_id = 4;
  labels.measurement_id = 8;
  labels.beams = 16;
  labels.label[1] = ReturnClass::kPerson;
  labels.label[2] = ReturnClass::kSoft;
  EXPECT_EQ(ring_->Label(labels), Status::kOk);
  EXPECT_EQ(ring_->at(8, 0).return_class(), ReturnClass::kIgnored);
  EXPECT_EQ(ring_->at(8, 1).return_class(), ReturnClass::kPerson);
  EXPECT_EQ(ring_->at(8, 2).return_class(), ReturnClass::kIgnored);
  EXPECT_TRUE(ring_->at(8, 1).labelled());
  EXPECT_EQ(ring_->at(8, 1).range_mm(), 1009u);

  labels.frame_id = 3;
  EXPECT_EQ(ring_->Label(labels), Status::kBadColumn);
  labels.frame_id = 4;
  labels.measurement_id = 9;
  EXPECT_EQ(ring_->Label(labels), Status::kBadColumn);
  labels.measurement_id = 512;
  EXPECT_EQ(ring_->Label(labels), Status::kBadColumn);
  labels.measurement_id = 8;
  labels.beams = 32;
  EXPECT_EQ(ring_->Label(labels), Status::kBadColumn);
  EXPECT_EQ(ring_->counters().labels_without_column, 4u);

  labels.beams = 16;
  labels.label[1] = static_cast<ReturnClass>(5);
  EXPECT_EQ(ring_->Label(labels), Status::kInvalidArgument);
  EXPECT_EQ(ring_->at(8, 1).return_class(), ReturnClass::kPerson);
}

// Random loss, repetition and reordering by a few columns: what is missing in the end is exactly
// what was lost between the first and the last column.
TEST_F(ScanRingTest, AccountsForEveryColumnOfALossyStream) {
  constexpr int kColumns = 64;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    ASSERT_EQ(ring_->Configure(16, kColumns), Status::kOk);
    const int first_frame = static_cast<int>(random() % 65536);
    std::vector<int> sent;  // index of the column in the stream
    for (int index = 0; index < 6 * kColumns; ++index) {
      const bool lost = index != 0 && random() % 8 == 0;
      if (lost) continue;
      sent.push_back(index);
      if (random() % 16 == 0) sent.push_back(index);
    }
    for (size_t i = 1; i + 5 < sent.size(); ++i) {
      if (random() % 4 == 0) std::swap(sent[i], sent[i + random() % 4]);
    }
    uint32_t duplicates = 0;
    std::set<int> seen;
    for (const int index : sent) {
      const Status status = Push((first_frame + index / kColumns) % 65536, index % kColumns);
      duplicates += status == Status::kDuplicate ? 1 : 0;
      EXPECT_EQ(status, seen.insert(index).second ? Status::kOk : Status::kDuplicate);
    }
    const ScanCounters& counters = ring_->counters();
    EXPECT_EQ(counters.columns, seen.size());
    EXPECT_EQ(counters.duplicates, duplicates);
    EXPECT_EQ(counters.missing_columns - counters.late_columns,
              static_cast<uint32_t>(*seen.rbegin() + 1) - seen.size());
    EXPECT_EQ(counters.restarts, 0u);
  }
}

TEST(SelfFilter, DropsTheBoxAndWhatIsTooNearOrTooFar) {
  LidarMountParams params;
  params.self_min_x_m = -2.0f;
  params.self_max_x_m = 1.0f;
  params.self_max_abs_y_m = 0.5f;
  params.self_max_z_m = 2.0f;
  params.min_range_m = 0.5f;
  params.max_range_m = 100.0f;
  EXPECT_TRUE(IsSelfReturn(params, {-1.0f, 0.0f, 1.0f}, 1.0f));
  EXPECT_TRUE(IsSelfReturn(params, {-2.0f, -0.5f, 2.0f}, 2.0f));
  EXPECT_FALSE(IsSelfReturn(params, {-2.1f, 0.0f, 1.0f}, 2.0f));
  EXPECT_FALSE(IsSelfReturn(params, {1.1f, 0.0f, 1.0f}, 2.0f));
  EXPECT_FALSE(IsSelfReturn(params, {0.0f, 0.6f, 1.0f}, 2.0f));
  EXPECT_FALSE(IsSelfReturn(params, {0.0f, -0.6f, 1.0f}, 2.0f));
  EXPECT_FALSE(IsSelfReturn(params, {0.0f, 0.0f, 2.1f}, 2.0f));
  EXPECT_TRUE(IsSelfReturn(params, {0.0f, 20.0f, 2.1f}, 0.4f));
  EXPECT_TRUE(IsSelfReturn(params, {0.0f, 20.0f, 2.1f}, 100.1f));
}

TEST(Mount, TurnsTheSensorByItsYawAndLiftsIt) {
  LidarMountParams params;
  params.x_m = 0.5f;
  params.z_m = 1.25f;
  params.roll_rad = 0.0f;
  params.pitch_rad = 0.0f;
  params.yaw_rad = kHalfPi;
  const Vec3 point = BodyFromSensor(params).Apply({2.0f, 0.0f, 0.5f});
  EXPECT_NEAR(point.x_m, 0.5f, 1e-6f);
  EXPECT_NEAR(point.y_m, 2.0f, 1e-6f);
  EXPECT_NEAR(point.z_m, 1.75f, 1e-6f);
}

}  // namespace
}  // namespace hardpack
