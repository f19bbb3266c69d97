// SPDX-License-Identifier: Apache-2.0
// The device: where each laser looked and when, and what it makes of a stream that is not whole.
#include "hal/velodyne/lidar.h"

#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "core/scan/scan.h"
#include "hal/velodyne/beams.h"
#include "test/hal/velodyne/velodyne_packets.h"

namespace hardpack::velodyne {
namespace {

using test::PacketOf;
using test::PutAzimuth;
using test::PutTime;
using test::Raw;
using test::Turning;

constexpr double kRadPerCdeg = M_PI / 18'000.0;

std::vector<Config> AllConfigs() {
  std::vector<Config> configs;
  for (const Model model : {Model::kVlp16, Model::kVlp32c}) {
    for (const ReturnMode mode : {ReturnMode::kStrongest, ReturnMode::kLast, ReturnMode::kDual}) {
      for (const int32_t rpm : {540, 600, 900, 1200}) configs.push_back({model, mode, rpm});
    }
  }
  return configs;
}

std::unique_ptr<BeamModel> ModelOf(const Config& config) {
  const LidarLayout layout = Lidar::LayoutOf(config);
  auto model = std::make_unique<BeamModel>();
  EXPECT_EQ(MakeBeamModel(layout, *model), Status::kOk);
  return model;
}

uint64_t SumOf(const PacketCounters& c) {
  return c.accepted + c.wrong_size + c.wrong_type + c.wrong_sensor + c.wrong_mode + c.bad_azimuth +
         c.bad_time + c.wrong_rate + c.not_resumed + c.duplicates;
}

class VelodyneLidar : public ::testing::Test {
 protected:
  void Begin(const Turning& sensor) {
    sensor_ = sensor;
    ASSERT_EQ(lidar_->Configure(sensor.config), Status::kOk);
  }
  Status Check(int64_t k) { return lidar_->Check(PacketOf(sensor_, k)); }
  const LidarColumn& Column(int64_t k, int index) {
    EXPECT_EQ(lidar_->Decode(PacketOf(sensor_, k), index, *column_), Status::kOk);
    return *column_;
  }
  // The angle that a column says it was measured at, clockwise [0.01 degree].
  double Told_cdeg(const LidarColumn& column) const {
    const double columns = Lidar::LayoutOf(sensor_.config).columns_per_revolution;
    return column.measurement_id * 36'000.0 / columns -
           static_cast<double>(column.azimuth_offset_rad) / kRadPerCdeg;
  }

  Turning sensor_;
  std::unique_ptr<Lidar> lidar_ = std::make_unique<Lidar>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

// Every laser on its own, from the manual: its azimuth is the block's, how far the head has turned
// until it fires, and its offset; clockwise, 0 along the maker's y, which is our x.
//
//        x  azimuth 0
//        ^
//   y <--+     +90 degrees: -y
TEST_F(VelodyneLidar, EachLaserLooksWhereTheManualSays) {
  for (const Config& config : AllConfigs()) {
    const auto model = ModelOf(config);
    Begin({.config = config, .begin_cdeg = 35'700.4});
    const double origin_m = config.model == Model::kVlp16 ? 0.0427 : 0.0;
    for (int64_t k = 0; k < 40; ++k) {
      ASSERT_EQ(Check(k), Status::kOk);
      for (int index = 0; index < lidar_->columns(); ++index) {
        const LidarColumn& column = Column(k, index);
        const SinCosPair encoder =
            EncoderSinCos(*model, column.measurement_id, column.azimuth_offset_rad);
        for (int row = 0; row < sensor_.beams(); ++row) {
          const int slot = config.model == Model::kVlp16 ? row : row / 2;
          const double firing = static_cast<double>(k * lidar_->columns() + index);
          const auto place = static_cast<size_t>(row);
          const double own_deg =
              config.model == Model::kVlp16 ? 0.0 : static_cast<double>(kVlp32cAzimuth_deg[place]);
          const double azimuth_rad =
              kRadPerCdeg *
              (sensor_.Azimuth_cdeg(firing + slot * 2.304 / 55.296) + 100.0 * own_deg);
          const double altitude_rad =
              M_PI / 180.0 *
              static_cast<double>(config.model == Model::kVlp16 ? kVlp16Altitude_deg[place]
                                                                : kVlp32cAltitude_deg[place]);
          const double level_m = (50.0 - origin_m) * std::cos(altitude_rad) + origin_m;
          const Vec3 point = PointInSensor(*model, encoder, row, 50'000);
          // The azimuths' rounding is 0.01 degree, 9 mm, and in the last block counts half again.
          ASSERT_NEAR(static_cast<double>(point.x_m), level_m * std::cos(azimuth_rad), 0.016);
          ASSERT_NEAR(static_cast<double>(point.y_m), -level_m * std::sin(azimuth_rad), 0.016);
          ASSERT_NEAR(static_cast<double>(point.z_m), (50.0 - origin_m) * std::sin(altitude_rad),
                      1e-3);
        }
      }
    }
  }
}

// A wall 20 m away to the right, at azimuth 90: on our -y.
TEST_F(VelodyneLidar, RightIsRight) {
  Begin({.config = {}, .begin_cdeg = 8'900.0});
  const auto model = ModelOf(sensor_.config);
  ASSERT_EQ(Check(0), Status::kOk);
  const LidarColumn& column = Column(0, 5);
  const SinCosPair encoder =
      EncoderSinCos(*model, column.measurement_id, column.azimuth_offset_rad);
  const Vec3 point = PointInSensor(*model, encoder, 1, 20'000);
  EXPECT_NEAR(point.x_m, 0.0f, 0.1f);
  EXPECT_NEAR(point.y_m, -20.0f, 0.1f);
  EXPECT_GT(point.z_m, 0.3f) << "laser 1 looks up by a degree";
}

TEST_F(VelodyneLidar, InterpolatesOverTheNorth) {
  Begin({.config = {}});
  std::vector<uint8_t> packet = PacketOf(sensor_, 0);
  // 359.60, 359.99 (an odd step), 0.39, 0.79 ...
  for (size_t block = 0; block < 12; ++block) {
    const uint32_t turned_cdeg = block == 0 ? 0u : 39u + 40u * static_cast<uint32_t>(block - 1);
    PutAzimuth(packet, block, (35'960u + turned_cdeg) % 36'000u);
  }
  ASSERT_EQ(lidar_->Check(packet), Status::kOk);
  const double expected_cdeg[] = {35'960 + 39 * 0.15625, 35'960 + 39 * 0.65625,
                                  35'999 + 40 * 0.15625, 35'999 + 40 * 0.65625,
                                  36'039 + 40 * 0.15625, 36'039 + 40 * 0.65625};
  uint16_t frame = 0;
  for (int index = 0; index < 6; ++index) {
    ASSERT_EQ(lidar_->Decode(packet, index, *column_), Status::kOk);
    if (index == 0) frame = column_->frame_id;
    const double turns_cdeg = 36'000.0 * (column_->frame_id - frame);
    EXPECT_NEAR(Told_cdeg(*column_) + turns_cdeg, expected_cdeg[index], 0.01) << index;
  }
  // The last block goes on as the one before: 359.99 + 10 x 0.40.
  ASSERT_EQ(lidar_->Decode(packet, 23, *column_), Status::kOk);
  EXPECT_NEAR(Told_cdeg(*column_), 399.0 + 40 * 0.65625, 0.01);
  EXPECT_EQ(column_->frame_id, frame + 1);
}

// At any rate that is accepted, from any start: each firing has a name of its own, in order, and
// revolutions begin at id 0.
TEST_F(VelodyneLidar, GivesEachFiringAPlaceOfItsOwn) {
  for (const Config& config : AllConfigs()) {
    const int columns = Lidar::LayoutOf(config).columns_per_revolution;
    ASSERT_LE(columns, kMaxColumnsPerRevolution);
    for (const double rate : {0.985, 0.997, 1.0, 1.003, 1.03}) {
      Begin({.config = config, .rate = rate, .begin_cdeg = 123.4});
      int64_t before = -1;
      int64_t frame = -1;
      int64_t turn = 0;
      int left_out = 0;
      int firings = 0;
      for (int64_t k = 0; k < 8'000 / lidar_->columns(); ++k) {
        const std::vector<uint8_t> packet = PacketOf(sensor_, k);
        ASSERT_EQ(lidar_->Check(packet), Status::kOk);
        for (int index = 0; index < lidar_->columns(); ++index) {
          ASSERT_EQ(lidar_->Decode(packet, index, *column_), Status::kOk);
          const LidarColumn& column = *column_;
          ASSERT_LT(column.measurement_id, columns);
          if (frame >= 0 && column.frame_id != frame) {
            ASSERT_EQ(column.frame_id, frame + 1);
            ++turn;
          }
          frame = column.frame_id;
          const int64_t name = turn * columns + column.measurement_id;
          if (before >= 0) {
            ASSERT_GT(name, before) << config.rpm << " " << rate << " " << k;
            left_out += static_cast<int>(name - before - 1);
          }
          before = name;
          ++firings;
          const double angle_cdeg =
              sensor_.Azimuth_cdeg(static_cast<double>(k * lidar_->columns() + index) + 0.3125);
          ASSERT_NEAR(Told_cdeg(column) + 36'000.0 * static_cast<double>(turn), angle_cdeg, 2.0);
          ASSERT_LE(std::abs(column.azimuth_offset_rad), 1.51 * 2.0 * M_PI / columns);
        }
      }
      EXPECT_LT(left_out, firings * 0.065);
      EXPECT_EQ(lidar_->counters().missing, 0u);
      EXPECT_EQ(lidar_->counters().jumps, 0u);
    }
  }
}

TEST_F(VelodyneLidar, TellsTheTimeOfTheMiddleOfAFiring) {
  Begin({.config = {}, .begin_us = 5'000'000});
  for (int64_t k = 0; k < 50; ++k) {
    ASSERT_EQ(Check(k), Status::kOk);
    for (int index = 0; index < 24; ++index) {
      const double us = 3.6e9 + 5e6 + (static_cast<double>(24 * k + index) * 55.296 + 17.28);
      ASSERT_NEAR(static_cast<double>(Column(k, index).timestamp_ns), 1000.0 * us, 1001.0);
    }
  }
}

TEST_F(VelodyneLidar, GoesOnBeyondTheHour) {
  Begin({.config = {Model::kVlp32c, ReturnMode::kStrongest, 1200}, .begin_us = 3'599'990'000});
  uint64_t before_ns = 0;
  for (int64_t k = 0; k < 60; ++k) {
    ASSERT_EQ(Check(k), Status::kOk) << k;
    for (int index = 0; index < 12; ++index) {
      const uint64_t time_ns = Column(k, index).timestamp_ns;
      if (before_ns != 0) {
        ASSERT_NEAR(static_cast<double>(time_ns - before_ns), 55'296.0, 1000.0);
      }
      before_ns = time_ns;
    }
  }
  EXPECT_EQ(Check(14), Status::kDuplicate) << "from before it";
  EXPECT_EQ(lidar_->counters().restarts, 0u);
}

TEST_F(VelodyneLidar, CountsWhatIsLostTwiceAndLate) {
  Begin({.config = {}});
  for (const int64_t k : {0, 1, 2, 6, 4}) ASSERT_EQ(Check(k), Status::kOk) << k;
  EXPECT_EQ(lidar_->counters().missing, 2u);
  EXPECT_EQ(lidar_->counters().out_of_order, 1u);
  for (const int64_t k : {4, 6, 0}) EXPECT_EQ(Check(k), Status::kDuplicate) << k;
  ASSERT_EQ(Check(7), Status::kOk);
  for (const int64_t k : {5, 3}) ASSERT_EQ(Check(k), Status::kOk) << k;
  const PacketCounters& counters = lidar_->counters();
  EXPECT_EQ(counters.missing, 0u);
  EXPECT_EQ(counters.out_of_order, 3u);
  EXPECT_EQ(counters.duplicates, 3u);
  EXPECT_EQ(counters.accepted, 8u);
  EXPECT_EQ(counters.jumps, 0u);
}

// A late packet's columns have the names that they would have had.
TEST_F(VelodyneLidar, ALatePacketHasItsOwnRevolution) {
  const Turning sensor = {.config = {}, .begin_cdeg = 35'500.0};
  Begin(sensor);
  std::map<int64_t, std::pair<int, int>> names;
  for (int64_t k = 0; k < 70; ++k) {
    ASSERT_EQ(Check(k), Status::kOk);
    names[k] = {Column(k, 11).frame_id, Column(k, 11).measurement_id};
  }
  Begin(sensor);
  ASSERT_EQ(Check(0), Status::kOk);
  ASSERT_EQ(Check(60), Status::kOk);
  for (int64_t k = 59; k > 0; --k) {
    ASSERT_EQ(Check(k), Status::kOk);
    EXPECT_EQ(Column(k, 11).frame_id, names[k].first) << k;
    EXPECT_LE(std::abs(Column(k, 11).measurement_id - names[k].second), 1) << k;
  }
}

TEST_F(VelodyneLidar, KeepsCountOverAGap) {
  Begin({.config = {}});
  ASSERT_EQ(Check(0), Status::kOk);
  const int frame = Column(0, 0).frame_id;
  const auto per_second = static_cast<int64_t>(1e6 / (24 * 55.296));
  ASSERT_EQ(Check(2 * per_second), Status::kOk);
  EXPECT_NEAR(Column(2 * per_second, 0).frame_id - frame, 20, 1);
  EXPECT_EQ(lidar_->counters().missing, static_cast<uint64_t>(2 * per_second - 1));
  EXPECT_EQ(Check(9 * per_second), Status::kSensorRestarted) << "silent for 7 s";
}

TEST_F(VelodyneLidar, AClockThatGoesBackIsARestart) {
  Begin({.config = {}, .begin_us = 100'000'000});
  for (int64_t k = 0; k < 100; ++k) ASSERT_EQ(Check(k), Status::kOk);
  Turning anew = sensor_;
  anew.begin_us = 3'000'000;
  for (int64_t k = 0; k < 3; ++k) {
    EXPECT_EQ(lidar_->Check(PacketOf(anew, k)), Status::kSensorRestarted);
  }
  EXPECT_EQ(lidar_->counters().restarts, 1u);
  EXPECT_EQ(lidar_->counters().not_resumed, 3u);
  lidar_->Resume();
  ASSERT_EQ(lidar_->Check(PacketOf(anew, 3)), Status::kOk);
  EXPECT_EQ(lidar_->Check(PacketOf(anew, 3)), Status::kDuplicate);
  EXPECT_EQ(lidar_->Check(PacketOf(anew, 4)), Status::kOk);
  EXPECT_EQ(Check(100), Status::kSensorRestarted) << "of the old start";
}

// Less than 64 packets back, but not where a packet could be; and 64 and more.
TEST_F(VelodyneLidar, AStepBackOfTheClockIsARestart) {
  for (const int64_t back_us : {500, 20'000, 84'935}) {
    Begin({.config = {}, .begin_us = 100'000'000});
    for (int64_t k = 0; k < 100; ++k) ASSERT_EQ(Check(k), Status::kOk);
    std::vector<uint8_t> packet = PacketOf(sensor_, 99);
    PutTime(packet, static_cast<uint32_t>(100'000'000 + 99 * 1'327 + 10 - back_us));
    EXPECT_EQ(lidar_->Check(packet), Status::kSensorRestarted) << back_us;
    ASSERT_EQ(Check(100), Status::kOk) << "one stray packet";
    lidar_->Resume();
    EXPECT_EQ(Check(100), Status::kDuplicate) << "nothing was resumed";
  }
}

TEST_F(VelodyneLidar, AClockThatIsSetForwardIsAJump) {
  Begin({.config = {}});
  for (int64_t k = 0; k < 10; ++k) ASSERT_EQ(Check(k), Status::kOk);
  Turning set = sensor_;
  set.begin_us += 200'500;
  ASSERT_EQ(lidar_->Check(PacketOf(set, 10)), Status::kOk);
  ASSERT_EQ(lidar_->Check(PacketOf(set, 11)), Status::kOk);
  EXPECT_EQ(lidar_->counters().jumps, 1u);
  EXPECT_EQ(lidar_->counters().missing, 0u);
}

TEST_F(VelodyneLidar, CountsWhatItRefuses) {
  Begin({.config = {}});
  const std::vector<uint8_t> good = PacketOf(sensor_, 0);
  uint64_t given = 0;
  const auto refuse = [&](const std::vector<uint8_t>& bytes, const uint64_t& counter) {
    const uint64_t before = counter;
    EXPECT_FALSE(IsUsable(lidar_->Check(bytes)));
    EXPECT_EQ(counter, before + 1);
    EXPECT_EQ(SumOf(lidar_->counters()), ++given);
  };
  const auto with = [&](size_t at, uint8_t value) {
    std::vector<uint8_t> bytes = good;
    bytes[at] = value;
    return bytes;
  };
  const PacketCounters& counters = lidar_->counters();
  refuse({}, counters.wrong_size);
  refuse(std::vector<uint8_t>(1207), counters.wrong_size);
  refuse(with(200, 0), counters.wrong_type);
  refuse(with(1205, 0x28), counters.wrong_sensor);
  refuse(with(1204, 0x39), counters.wrong_mode);
  refuse(with(1003, 0xff), counters.bad_azimuth);
  refuse(with(1203, 0xff), counters.bad_time);
  refuse(with(2, 100), counters.wrong_rate);
  EXPECT_EQ(lidar_->Decode(good, 0, *column_), Status::kNotStarted);
  ASSERT_EQ(lidar_->Check(good), Status::kOk);
  ++given;
  refuse(good, counters.duplicates);
}

TEST_F(VelodyneLidar, DecodesItsOwnColumnsOnly) {
  EXPECT_EQ(lidar_->Check(PacketOf({.config = {}}, 0)), Status::kNotStarted);
  Begin({.config = {}});
  ASSERT_EQ(Check(0), Status::kOk);
  const std::vector<uint8_t> packet = PacketOf(sensor_, 0);
  for (const int index : {-1, 24, INT_MAX, INT_MIN}) {
    EXPECT_EQ(lidar_->Decode(packet, index, *column_), Status::kInvalidArgument);
  }
  EXPECT_EQ(lidar_->Decode(std::span(packet).first(1205), 0, *column_), Status::kTruncated);
}

TEST_F(VelodyneLidar, TakesNothingAfterABadConfiguration) {
  EXPECT_EQ(lidar_->Configure({Model::kVlp16, ReturnMode::kLast, 300}), Status::kInvalidArgument);
  EXPECT_EQ(lidar_->Check(PacketOf({.config = {}}, 0)), Status::kNotStarted);
  EXPECT_EQ(lidar_->columns(), 0);
  EXPECT_EQ(Lidar::LayoutOf({Model::kVlp16, ReturnMode::kLast, 300}).columns_per_revolution, 0);
  EXPECT_EQ(Lidar::MostColumnsPerSecond({Model::kVlp16, ReturnMode::kLast, 300}), 0);
}

// All beams of a VLP-16 look one way within half a column, so that a place that is left out is one
// direction and no more.
TEST_F(VelodyneLidar, AVlp16HasItsBeamsInOneColumn) {
  for (int rpm = kLeastRpm; rpm <= kMostRpm; rpm += kRpmStep) {
    const Config config = {Model::kVlp16, ReturnMode::kStrongest, rpm};
    EXPECT_EQ(ModelOf(config)->max_column_shift, 0) << rpm;
    EXPECT_GE(Lidar::MostColumnsPerSecond(config), 18'085);
    EXPECT_LE(Lidar::MostColumnsPerSecond(config), 20'480);
  }
}

TEST_F(VelodyneLidar, FillsBothReturns) {
  Turning sensor = {.config = {Model::kVlp32c, ReturnMode::kDual, 600}};
  sensor.sees = [](int64_t n, int row, bool last) {
    return Raw{static_cast<uint16_t>(1'000 + 10 * (n % 6) + row + (last ? 500 : 0)), 9};
  };
  Begin(sensor);
  ASSERT_EQ(Check(0), Status::kOk);
  ASSERT_EQ(lidar_->columns(), 6);
  for (int index = 0; index < 6; ++index) {
    const LidarColumn& column = Column(0, index);
    ASSERT_EQ(column.returns, 2);
    for (int row = 0; row < 32; ++row) {
      const auto nearer_mm = static_cast<uint32_t>(4 * (1'000 + 10 * index + row));
      EXPECT_EQ(column.range_mm[row], nearer_mm);
      EXPECT_EQ(column.second_range_mm[row], nearer_mm + 2'000u);
      EXPECT_EQ(NearestRange(column, row), nearer_mm);
    }
  }
}

}  // namespace
}  // namespace hardpack::velodyne
