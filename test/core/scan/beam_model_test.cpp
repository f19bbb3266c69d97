// SPDX-License-Identifier: Apache-2.0
#include "core/scan/scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
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

TEST(BeamModel, TakesALayoutWithPlacesLeftOut) {
  const std::vector<float> angles(16, 1.0f);
  LidarLayout layout;
  layout.altitude_deg = layout.azimuth_deg = angles;
  layout.columns_per_revolution = 1863;
  auto model = std::make_unique<BeamModel>();
  ASSERT_EQ(MakeBeamModel(layout, *model), Status::kOk);
  EXPECT_EQ(model->fired_per_revolution, 1863);
  layout.fired_per_revolution = 1808;
  ASSERT_EQ(MakeBeamModel(layout, *model), Status::kOk);
  EXPECT_EQ(model->fired_per_revolution, 1808);
  EXPECT_EQ(model->columns_per_revolution, 1863);
  for (const int fired : {-1, 1864}) {
    layout.fired_per_revolution = fired;
    EXPECT_EQ(MakeBeamModel(layout, *model), Status::kInvalidArgument);
    EXPECT_EQ(model->beams, 0);
  }
  EXPECT_EQ(MakeBeamModel(LidarLayout{}, *model), Status::kInvalidArgument);
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
  EXPECT_EQ(MakeBeamModel(angles, angles, 1024, kNaN, identity, *model), Status::kNotFinite);
  std::vector<float> broken = angles;
  broken[63] = kInfinity;
  EXPECT_EQ(MakeBeamModel(angles, broken, 1024, 0.0f, identity, *model), Status::kNotFinite);
  broken[63] = 91.0f;
  EXPECT_EQ(MakeBeamModel(broken, angles, 1024, 0.0f, identity, *model), Status::kInvalidArgument);
  broken.assign(64, 359.0f);
  EXPECT_EQ(MakeBeamModel(angles, broken, 1024, 0.0f, identity, *model), Status::kOk);
  broken[63] = 361.0f;
  EXPECT_EQ(MakeBeamModel(angles, broken, 1024, 0.0f, identity, *model), Status::kInvalidArgument);
  Transform3 nowhere;
  nowhere.rotation[4] = kNaN;
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
  const auto model = std::make_unique<BeamModel>();
  ASSERT_EQ(MakeBeamModel(level, level, 2048, 0.0f, Transform3{}, *model), Status::kOk);
  const Vec3 ahead = PointInSensor(*model, EncoderSinCos(*model, 0), 0, 10000);
  EXPECT_NEAR(ahead.x_m, 10.0f, 1e-5f);
  EXPECT_NEAR(ahead.y_m, 0.0f, 1e-5f);
  const Vec3 right = PointInSensor(*model, EncoderSinCos(*model, 512), 0, 10000);
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

TEST(EncoderSinCos, IsTheFormulaBitForBit) {
  const std::vector<float> level(1, 0.0f);
  const auto model = std::make_unique<BeamModel>();
  for (const int columns : {1, 2, 700, 512, 1024, 2048}) {
    ASSERT_EQ(MakeBeamModel(level, level, columns, 0.0f, Transform3{}, *model), Status::kOk);
    for (int id = 0; id < columns; ++id) {
      const float share = static_cast<float>(id) / static_cast<float>(columns);
      const SinCosPair expected = SinCos(kTwoPi * (1.0f - share));
      EXPECT_EQ(EncoderSinCos(*model, id).sin, expected.sin);
      EXPECT_EQ(EncoderSinCos(*model, id).cos, expected.cos);
    }
  }
}

double WrapDouble(double angle_rad) {
  return std::remainder(angle_rad, 2.0 * kPiDouble);
}

// How far apart in angle, in columns, the beams look that the shifts put into one direction.
double SpreadInColumns(const BeamModel& model, const std::vector<float>& azimuth_deg,
                       int direction) {
  const int columns = model.columns_per_revolution;
  double least = 1e9;
  double most = -1e9;
  for (int row = 0; row < model.beams; ++row) {
    const int measured = (direction + model.column_shift[row]) % columns;
    const double encoder = 2.0 * kPiDouble * (1.0 - static_cast<double>(measured) / columns);
    const double azimuth =
        -static_cast<double>(azimuth_deg[static_cast<size_t>(row)]) * kPiDouble / 180.0;
    const double own = 2.0 * kPiDouble * (1.0 - static_cast<double>(direction) / columns);
    const double off = WrapDouble(encoder + azimuth - own) * columns / (2.0 * kPiDouble);
    least = std::min(least, off);
    most = std::max(most, off);
  }
  return most - least;
}

// Four beams, one above the other, fired in one column:
//
//      row 0   1     2   3
//          \   \   /   /         azimuth 3.1, 1.03, -1.03, -3.1 degrees
//           \   \ /   /
//             lidar              a direction is complete when the last of them has come round
TEST(ColumnShift, TurnsTheFourBeamPatternIntoOneDirection) {
  const std::vector<float> pattern = {3.1f, 1.03f, -1.03f, -3.1f};
  std::vector<float> azimuth;
  std::vector<float> altitude;
  for (int row = 0; row < 64; ++row) {
    azimuth.push_back(pattern[static_cast<size_t>(row % 4)]);
    altitude.push_back(16.0f - 0.5f * static_cast<float>(row));
  }
  const auto model = std::make_unique<BeamModel>();
  for (const int columns : {512, 1024, 2048}) {
    SCOPED_TRACE(columns);
    ASSERT_EQ(MakeBeamModel(altitude, azimuth, columns, 0.0f, Transform3{}, *model), Status::kOk);
    const int32_t* const shift = model->column_shift;
    EXPECT_EQ(*std::min_element(shift, shift + 64), 0);
    EXPECT_EQ(*std::max_element(shift, shift + 64), model->max_column_shift);
    EXPECT_NEAR(model->max_column_shift, 6.2 / 360.0 * columns, 1.0);
    for (int direction = 0; direction < columns; ++direction) {
      ASSERT_LE(SpreadInColumns(*model, azimuth, direction), 1.0 + 1e-4);
    }
    // And so do the points themselves.
    const int measured[2] = {(7 + shift[0]) % columns, (7 + shift[3]) % columns};
    const Vec3 a = PointInSensor(*model, EncoderSinCos(*model, measured[0]), 0, 50000);
    const Vec3 b = PointInSensor(*model, EncoderSinCos(*model, measured[1]), 3, 50000);
    const float apart_rad = WrapAngle(Atan2(a.y_m, a.x_m) - Atan2(b.y_m, b.x_m));
    EXPECT_LE(Abs(apart_rad), kTwoPi / static_cast<float>(columns) + 1e-5f);
  }
}

TEST(ColumnShift, HoldsForAnyAzimuths) {
  const unsigned seed = 77;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto model = std::make_unique<BeamModel>();
  for (int round = 0; round < 200; ++round) {
    const int columns = 1 + static_cast<int>(random() % 2048);
    const size_t beams = 1 + random() % 128;
    // Within 20 degrees; the middle anywhere, also where 180 and -180 degrees meet.
    const float middle_deg = static_cast<float>(random() % 7000) * 0.1f - 350.0f;
    std::vector<float> azimuth(beams);
    for (float& angle : azimuth) {
      angle = middle_deg + static_cast<float>(random() % 2000) * 0.01f - 10.0f;
    }
    ASSERT_EQ(MakeBeamModel(std::vector<float>(beams, 0.0f), azimuth, columns, 0.0f, Transform3{},
                            *model),
              Status::kOk)
        << middle_deg;
    const int32_t* const shift = model->column_shift;
    EXPECT_EQ(*std::min_element(shift, shift + beams), 0);
    EXPECT_EQ(*std::max_element(shift, shift + beams), model->max_column_shift);
    ASSERT_LE(SpreadInColumns(*model, azimuth, static_cast<int>(random()) & 255), 1.0 + 1e-3);
  }
}

TEST(ColumnShift, RefusesBeamsThatLookTooFarApart) {
  const auto model = std::make_unique<BeamModel>();
  const std::vector<float> level(2, 0.0f);
  EXPECT_EQ(MakeBeamModel(level, std::vector<float>{10.0f, -10.0f}, 2048, 0.0f, {}, *model),
            Status::kOk);
  EXPECT_EQ(model->max_column_shift, 114);
  EXPECT_EQ(MakeBeamModel(level, std::vector<float>{12.0f, -12.0f}, 2048, 0.0f, {}, *model),
            Status::kInvalidArgument);
  EXPECT_EQ(model->beams, 0);
  EXPECT_EQ(model->columns_per_revolution, 0);
  EXPECT_EQ(MakeBeamModel(level, std::vector<float>{12.0f, -12.0f}, 1024, 0.0f, {}, *model),
            Status::kOk);
}

TEST(BeamModel, OrdersItsBeamsFromTheLowestUp) {
  const unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto model = std::make_unique<BeamModel>();
  for (int round = 0; round < 300; ++round) {
    std::vector<float> altitude(1 + random() % 128);
    // Few values, so that some are equal.
    for (float& angle : altitude) angle = static_cast<float>(random() % 40) - 20.0f;
    const std::vector<float> azimuth(altitude.size(), 0.0f);
    ASSERT_EQ(MakeBeamModel(altitude, azimuth, 512, 0.0f, Transform3{}, *model), Status::kOk);
    std::vector<uint8_t> rows(altitude.size());
    std::iota(rows.begin(), rows.end(), uint8_t{0});
    std::stable_sort(rows.begin(), rows.end(),
                     [&](uint8_t a, uint8_t b) { return altitude[a] < altitude[b]; });
    EXPECT_TRUE(std::equal(rows.begin(), rows.end(), model->by_altitude));
  }
}

// The numbers of the first array of that name in a JSON file; empty when there is none.
std::vector<float> ArrayIn(const std::string& json, const std::string& name) {
  std::vector<float> numbers;
  const size_t found = json.find('"' + name + '"');
  if (found == std::string::npos) return numbers;
  const size_t begin = json.find('[', found);
  const size_t end = json.find(']', begin);
  std::string inside = json.substr(begin + 1, end - begin - 1);
  std::replace(inside.begin(), inside.end(), ',', ' ');
  std::istringstream stream(inside);
  for (float number = 0.0f; stream >> number;) numbers.push_back(number);
  return numbers;
}

// Real sensors say by how many columns a row of an image is to be moved so that its columns become
// directions: the shift the other way round, up to a constant.
TEST(ColumnShift, AgreesWithThePixelShiftsOfRealSensors) {
  const char* const data = std::getenv("HARDPACK_DATA");
  const std::filesystem::path folder =
      data == nullptr ? std::filesystem::path() : std::filesystem::path(data) / "ouster";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no recordings";
  const auto model = std::make_unique<BeamModel>();
  int sensors = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    SCOPED_TRACE(entry.path());
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const std::vector<float> azimuth = ArrayIn(text.str(), "beam_azimuth_angles");
    const std::vector<float> altitude = ArrayIn(text.str(), "beam_altitude_angles");
    const std::vector<float> pixel_shift = ArrayIn(text.str(), "pixel_shift_by_row");
    if (azimuth.empty() || pixel_shift.size() != azimuth.size()) continue;
    ++sensors;
    const size_t number = text.str().find("\"columns_per_frame\"");
    ASSERT_NE(number, std::string::npos);
    int columns = 0;
    std::istringstream(text.str().substr(text.str().find(':', number) + 1)) >> columns;
    ASSERT_EQ(MakeBeamModel(altitude, azimuth, columns, 0.0f, Transform3{}, *model), Status::kOk);
    std::vector<int> sums;
    for (size_t row = 0; row < azimuth.size(); ++row) {
      sums.push_back(model->column_shift[row] + static_cast<int>(pixel_shift[row]));
    }
    std::sort(sums.begin(), sums.end());
    // Old firmware gives the shifts of the ideal sensor, newer firmware those of this one.
    const bool ideal = entry.path().filename().string().find("legacy") != std::string::npos;
    const int slack = ideal ? 1 : 0;
    EXPECT_LE(sums.back() - sums[sums.size() / 2], slack);
    EXPECT_LE(sums[sums.size() / 2] - sums.front(), slack);
    for (int direction = 0; direction < columns; ++direction) {
      ASSERT_LE(SpreadInColumns(*model, azimuth, direction), 1.0 + 1e-3);
    }
  }
  EXPECT_GE(sensors, 4);
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
