// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "core/odometry/odometry.h"

// The wheels of a real Warthog, 252 pieces of two seconds at 20 Hz (warthog_drive_20hz.csv),
// against the poses that a lidar gave. There is no gyro in the recording: once the wheels alone,
// once with the lidar's turn as the gyro's.

namespace hardpack {
namespace {

struct Row {
  int segment;
  double t_s, left_radps, right_radps, x_m, y_m, yaw_rad;
};

std::vector<Row> ReadRows(const std::string& path) {
  std::vector<Row> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    Row row;
    int step = 0;
    double skipped[5];
    const int read =
        std::sscanf(line.c_str(), "%d,%d,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &row.segment,
                    &step, &row.t_s, &skipped[0], &skipped[1], &row.left_radps, &row.right_radps,
                    &row.x_m, &row.y_m, &skipped[2], &skipped[3], &skipped[4], &row.yaw_rad);
    if (read == 13) rows.push_back(row);
  }
  return rows;
}

// The turn around a row: the lidar's poses are held for 0.1 s.
double TurnRate(const std::vector<Row>& rows, size_t at) {
  size_t first = at;
  size_t last = at;
  for (int i = 0; i < 2; ++i) {
    if (first > 0 && rows[first - 1].segment == rows[at].segment) --first;
    if (last + 1 < rows.size() && rows[last + 1].segment == rows[at].segment) ++last;
  }
  const double turn_rad = std::remainder(rows[last].yaw_rad - rows[first].yaw_rad, 2.0 * M_PI);
  return std::clamp(turn_rad / (rows[last].t_s - rows[first].t_s), -4.0, 4.0);
}

struct Errors {
  double position_m = 0.0;  // medians, at the end of two seconds
  double yaw_rad = 0.0;
  double baseline_m = 0.0;
};

Errors Median(std::vector<Errors> all, double baseline_m) {
  const auto median = [&](double Errors::*member) {
    std::vector<double> values;
    for (const Errors& one : all) values.push_back(one.*member);
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  return {median(&Errors::position_m), median(&Errors::yaw_rad), baseline_m};
}

// Each piece is driven from where the one before ended: what is learned goes on.
Errors Drive(const std::vector<Row>& rows, bool has_gyro) {
  Odometry odometry;
  // Ten poses a second: such a gyro is a slow one, and a noisy one.
  const OdometryParams params = {.max_rate_age_s = 0.1f, .gyro_sigma_radps = 0.1f};
  EXPECT_EQ(odometry.Configure({}, params, {}), Status::kOk);
  std::vector<Errors> all;
  uint64_t now_ns = 1'000'000'000;
  double yaw0_rad = 0.0, x0_m = 0.0, y0_m = 0.0;
  StampedPose begin;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const bool is_first = i == 0 || rows[i - 1].segment != row.segment;
    now_ns += is_first ? 1'000'000'000 : 50'000'000;
    if (has_gyro && !is_first) {
      InsSample sample;
      sample.has_angular_rate = true;
      sample.angular_rate.z_radps = static_cast<float>(-TurnRate(rows, i));
      EXPECT_EQ(odometry.TakeIns(sample, now_ns), Status::kOk);
    }
    const Status status =
        odometry.Advance(now_ns, {.valid = true,
                                  .time_ns = now_ns,
                                  .left_radps = static_cast<float>(row.left_radps),
                                  .right_radps = static_cast<float>(row.right_radps)});
    EXPECT_TRUE(status == Status::kOk || status == Status::kStale);
    if (is_first) {
      begin = odometry.pose();
      yaw0_rad = row.yaw_rad;
      x0_m = row.x_m;
      y0_m = row.y_m;
    }
    if (i + 1 < rows.size() && rows[i + 1].segment == row.segment) continue;
    const double c = std::cos(begin.yaw_rad - yaw0_rad);
    const double s = std::sin(begin.yaw_rad - yaw0_rad);
    const double dx_m = c * (row.x_m - x0_m) - s * (row.y_m - y0_m);
    const double dy_m = s * (row.x_m - x0_m) + c * (row.y_m - y0_m);
    const StampedPose& end = odometry.pose();
    all.push_back({std::hypot(end.position.x_m - begin.position.x_m - dx_m,
                              end.position.y_m - begin.position.y_m - dy_m),
                   std::fabs(std::remainder(end.yaw_rad - begin.yaw_rad - (row.yaw_rad - yaw0_rad),
                                            2.0 * M_PI)),
                   0.0});
  }
  return Median(all, static_cast<double>(odometry.skid_baseline_m()));
}

TEST(OdometryRecordings, FollowsAWarthogsLidarPoses) {
  const char* folder = std::getenv("HARDPACK_DATA");
  const std::string path =
      std::string(folder != nullptr ? folder : "") + "/warthog/warthog_drive_20hz.csv";
  const std::vector<Row> rows = ReadRows(path);
  if (rows.empty()) GTEST_SKIP() << "no recording: " << path;
  ASSERT_GT(rows.size(), 10'000u);
  const Errors wheels = Drive(rows, false);
  const Errors gyro = Drive(rows, true);
  std::printf(
      "median after 2 s: wheels alone %.3f m %.3f rad; with a gyro %.3f m %.3f rad, "
      "baseline %.2f m\n",
      wheels.position_m, wheels.yaw_rad, gyro.position_m, gyro.yaw_rad, gyro.baseline_m);
  // The recorded wheel speeds are held for 0.25 s, and the wheels slip sideways in turns.
  EXPECT_LT(wheels.position_m, 0.7);
  EXPECT_LT(wheels.yaw_rad, 0.18);
  EXPECT_LT(gyro.position_m, 0.7);
  EXPECT_LT(gyro.yaw_rad, 0.06);
  EXPECT_GT(gyro.baseline_m, 1.2);
  EXPECT_LT(gyro.baseline_m, 2.2);
}

}  // namespace
}  // namespace hardpack
