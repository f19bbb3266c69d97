// SPDX-License-Identifier: Apache-2.0
// Columns that were measured beside their places in the grid: their angle, and what the ring keeps.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/scan/scan.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
constexpr int kColumns = 1863;
constexpr int kBeams = 16;

std::unique_ptr<BeamModel> Model() {
  const std::vector<float> altitude(kBeams, -10.0f);
  const std::vector<float> azimuth(kBeams, 1.4f);
  auto model = std::make_unique<BeamModel>();
  EXPECT_EQ(MakeBeamModel(altitude, azimuth, kColumns, 0.04f, Transform3{}, *model), Status::kOk);
  return model;
}

TEST(AzimuthOffset, NoneIsTheTableBitForBit) {
  const auto model = Model();
  for (int id = 0; id < kColumns; ++id) {
    const SinCosPair table = EncoderSinCos(*model, id);
    for (const float none : {0.0f, -0.0f}) {
      const SinCosPair same = EncoderSinCos(*model, id, none);
      ASSERT_EQ(same.sin, table.sin);
      ASSERT_EQ(same.cos, table.cos);
    }
  }
}

TEST(AzimuthOffset, TurnsTheEncoderAnticlockwise) {
  const auto model = Model();
  const double column_rad = 2.0 * M_PI / kColumns;
  for (int id = 0; id < kColumns; id += 31) {
    for (const double columns : {-2.0, -0.73, 1e-4, 0.5, 2.0}) {
      const auto offset_rad = static_cast<float>(columns * column_rad);
      const double angle_rad = 2.0 * M_PI - id * column_rad + static_cast<double>(offset_rad);
      const SinCosPair encoder = EncoderSinCos(*model, id, offset_rad);
      EXPECT_NEAR(static_cast<double>(encoder.sin), std::sin(angle_rad), 7e-7);
      EXPECT_NEAR(static_cast<double>(encoder.cos), std::cos(angle_rad), 7e-7);
    }
  }
  for (const float none : {kNaN, kInfinity, -kInfinity}) {
    const SinCosPair encoder = EncoderSinCos(*model, 100, none);
    EXPECT_NEAR(encoder.sin, model->sin_encoder[100], 1e-6f);
  }
}

// The same direction by two names.
TEST(AzimuthOffset, AColumnBackIsTheColumnBefore) {
  const auto model = Model();
  const float column_rad = kTwoPi / kColumns;
  for (int id = 1; id < kColumns; id += 17) {
    const Vec3 one = PointInSensor(*model, EncoderSinCos(*model, id), 3, 30'000);
    const Vec3 other = PointInSensor(*model, EncoderSinCos(*model, id - 1, -column_rad), 3, 30'000);
    EXPECT_NEAR(one.x_m, other.x_m, 5e-5f);
    EXPECT_NEAR(one.y_m, other.y_m, 5e-5f);
    EXPECT_EQ(one.z_m, other.z_m);
  }
}

class OffsetInTheRing : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(ring_->Configure(kBeams, kColumns), Status::kOk); }

  Status Push(int id, float offset_rad) {
    *column_ = LidarColumn{};
    column_->measurement_id = static_cast<uint16_t>(id);
    column_->valid = true;
    column_->beams = kBeams;
    column_->azimuth_offset_rad = offset_rad;
    return ring_->Push(*column_, 0, Transform3{}, self_);
  }

  std::unique_ptr<ScanRing> ring_ = std::make_unique<ScanRing>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
  std::vector<uint8_t> self_ = std::vector<uint8_t>(kBeams, 0);
};

TEST_F(OffsetInTheRing, IsKeptWithItsColumn) {
  EXPECT_EQ(Push(0, 0.0f), Status::kOk);
  EXPECT_FALSE(ring_->measures_azimuth());
  EXPECT_EQ(Push(1, -0.001f), Status::kOk);
  EXPECT_TRUE(ring_->measures_azimuth());
  EXPECT_EQ(Push(3, 0.0f), Status::kOk);
  const int64_t first = ring_->SequenceOf(0, 0).value();
  EXPECT_EQ(ring_->column(ring_->SlotOf(first)).azimuth_offset_rad, 0.0f);
  EXPECT_EQ(ring_->column(ring_->SlotOf(first + 1)).azimuth_offset_rad, -0.001f);
  EXPECT_EQ(ring_->column(ring_->SlotOf(first + 3)).azimuth_offset_rad, 0.0f);
  ASSERT_EQ(ring_->Configure(kBeams, kColumns), Status::kOk);
  EXPECT_FALSE(ring_->measures_azimuth());
}

TEST_F(OffsetInTheRing, IsNoMoreThanTwoColumns) {
  const float most_rad = 2.0f * kTwoPi / kColumns;
  EXPECT_EQ(Push(0, most_rad), Status::kOk);
  EXPECT_EQ(Push(1, -most_rad), Status::kOk);
  uint32_t bad = 0;
  for (const float wrong : {most_rad * 1.001f, -most_rad * 1.001f, 3.0f, kNaN, kInfinity}) {
    EXPECT_EQ(Push(2, wrong), Status::kBadColumn) << wrong;
    EXPECT_EQ(ring_->counters().bad_columns, ++bad);
  }
  EXPECT_EQ(Push(2, 0.0f), Status::kOk);
}

}  // namespace
}  // namespace hardpack
