// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/dead_reckoning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Drive {
  VehicleParams vehicle;
  OdometryParams params;
  DeadReckoning odometry;
  uint64_t now_ns = 1'000'000'000;

  explicit Drive(const InsParams& ins = {}) {
    EXPECT_EQ(odometry.Configure(vehicle, params, ins), Status::kOk);
  }
  WheelFeedback Wheels(float left_radps, float right_radps) const {
    return {.valid = true, .time_ns = now_ns, .left_radps = left_radps, .right_radps = right_radps};
  }
  void Ticks(int count, float left_radps, float right_radps) {
    for (int i = 0; i < count; ++i) {
      now_ns += kTick_ns;
      EXPECT_EQ(odometry.Advance(now_ns, Wheels(left_radps, right_radps)), Status::kOk);
    }
  }
};

TEST(DeadReckoning, DrivesStraightAtTheGroundsShareOfTheRimSpeed) {
  Drive drive;
  drive.Ticks(1, 0.0f, 0.0f);  // the first tick has no step before it
  drive.Ticks(100, 10.0f, 10.0f);
  const float speed_mps = 10.0f * 0.30f * 0.962f;
  EXPECT_FLOAT_EQ(drive.odometry.speed_mps(), speed_mps);
  EXPECT_NEAR(drive.odometry.pose().position.x_m, speed_mps * 1.0f, 1e-4f);
  EXPECT_EQ(drive.odometry.pose().position.y_m, 0.0f);
  EXPECT_EQ(drive.odometry.pose().yaw_rad, 0.0f);
}

// Wheels at v (1 -+ b / 2R) drive a circle of radius R, to the left:
//        ___
//      /     \   centre (0, R)
TEST(DeadReckoning, DrivesACircleBack) {
  Drive drive;
  drive.Ticks(1, 0.0f, 0.0f);
  const float rim_m = 0.30f * 0.962f;
  const float v_mps = 2.0f;
  const float w_radps = 0.5f;
  const float half_radps = w_radps * drive.vehicle.skid_baseline_m / (2.0f * rim_m);
  const int ticks = static_cast<int>(std::lround(2.0 * M_PI / w_radps * 100.0));
  drive.Ticks(ticks / 2, v_mps / rim_m - half_radps, v_mps / rim_m + half_radps);
  EXPECT_NEAR(drive.odometry.pose().position.y_m, 2.0f * v_mps / w_radps, 0.02f);
  drive.Ticks(ticks - ticks / 2, v_mps / rim_m - half_radps, v_mps / rim_m + half_radps);
  EXPECT_NEAR(drive.odometry.pose().position.x_m, 0.0f, 0.02f);
  EXPECT_NEAR(drive.odometry.pose().position.y_m, 0.0f, 0.02f);
  EXPECT_FALSE(drive.odometry.uses_ins_rate());
}

TEST(DeadReckoning, TurnsByTheInsWhereItIsFreshAndByTheWheelsWhereNot) {
  Drive drive;
  drive.Ticks(1, 0.0f, 0.0f);
  InsSample sample;
  sample.has_angular_rate = true;
  sample.angular_rate_radps = {0.0f, 0.0f, -0.4f};  // z down: to the left
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
  drive.Ticks(1, 5.0f, 5.0f);
  EXPECT_TRUE(drive.odometry.uses_ins_rate());
  EXPECT_FLOAT_EQ(drive.odometry.yaw_rate_radps(), 0.4f);
  EXPECT_NEAR(drive.odometry.pose().yaw_rad, 0.004f, 1e-6f);
  drive.Ticks(10, 5.0f, 5.0f);  // 0.1 s later it is too old
  EXPECT_FALSE(drive.odometry.uses_ins_rate());
  EXPECT_EQ(drive.odometry.yaw_rate_radps(), 0.0f);
}

TEST(DeadReckoning, LeansAsTheInsDoes) {
  Drive drive;
  InsSample sample;
  sample.has_attitude = true;
  sample.roll_rad = 0.1f;    // right side down: so in both frames
  sample.pitch_rad = -0.2f;  // nose down, which is positive in ours
  sample.yaw_rad = 2.0f;
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
  EXPECT_NEAR(drive.odometry.pose().roll_rad, 0.1f, 1e-5f);
  EXPECT_NEAR(drive.odometry.pose().pitch_rad, 0.2f, 1e-5f);
  EXPECT_EQ(drive.odometry.pose().yaw_rad, 0.0f);  // odom's own
}

// Mounted with its x to the left: what it calls nose up is our left side up, that is right side
// down.
TEST(DeadReckoning, KnowsHowTheInsIsMounted) {
  Drive drive({.yaw_rad = static_cast<float>(M_PI_2)});
  InsSample sample;
  sample.has_attitude = true;
  sample.pitch_rad = 0.1f;
  sample.has_angular_rate = true;
  sample.angular_rate_radps = {0.0f, 0.0f, 0.3f};
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
  drive.Ticks(1, 0.0f, 0.0f);
  EXPECT_NEAR(drive.odometry.pose().roll_rad, 0.1f, 1e-5f);
  EXPECT_NEAR(drive.odometry.pose().pitch_rad, 0.0f, 1e-5f);
  EXPECT_NEAR(drive.odometry.yaw_rate_radps(), -0.3f, 1e-6f);
}

TEST(DeadReckoning, StaysWhereItIsWithoutWheelSpeeds) {
  Drive drive;
  drive.Ticks(10, 5.0f, 5.0f);
  const StampedPose before = drive.odometry.pose();
  const uint64_t moved_ns = drive.odometry.moved_ns();
  drive.now_ns += kTick_ns;
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, {}), Status::kStale);
  EXPECT_EQ(drive.odometry.pose().position.x_m, before.position.x_m);
  EXPECT_EQ(drive.odometry.pose().time_ns, drive.now_ns);
  EXPECT_EQ(drive.odometry.moved_ns(), moved_ns);
  EXPECT_EQ(drive.odometry.speed_mps(), 0.0f);
}

// It rolled on while nobody said how fast.
TEST(DeadReckoning, ASilenceOfTheWheelsIsBridgedWhileShortAndAGapBeyond) {
  for (const int silent : {10, 50}) {
    Drive drive;
    drive.Ticks(10, 5.0f, 5.0f);
    const float x_m = drive.odometry.pose().position.x_m;
    for (int i = 0; i < silent; ++i) {
      drive.now_ns += kTick_ns;
      EXPECT_EQ(drive.odometry.Advance(drive.now_ns, {}), Status::kStale);
    }
    EXPECT_EQ(drive.odometry.pose().position.x_m, x_m);
    drive.Ticks(1, 5.0f, 5.0f);
    const bool is_gap = silent == 50;
    EXPECT_EQ(drive.odometry.gaps(), is_gap ? 1u : 0u);
    const float step_m = drive.odometry.speed_mps() * 0.01f * static_cast<float>(silent + 1);
    EXPECT_NEAR(drive.odometry.pose().position.x_m - x_m, is_gap ? 0.0f : step_m, 1e-4f);
  }
}

TEST(DeadReckoning, ARateThatIsOnlyRepeatedGrowsOld) {
  Drive drive;
  drive.Ticks(2, 5.0f, 5.0f);
  InsSample sample;
  sample.has_timestamp = true;
  sample.timestamp_ns = 77;
  sample.has_angular_rate = true;
  sample.angular_rate_radps = {0.0f, 0.0f, 0.5f};
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
    drive.Ticks(1, 5.0f, 5.0f);
    if (i == 0) {
      EXPECT_TRUE(drive.odometry.uses_ins_rate());
    }
  }
  EXPECT_FALSE(drive.odometry.uses_ins_rate());
  ++sample.timestamp_ns;
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
  drive.Ticks(1, 5.0f, 5.0f);
  EXPECT_TRUE(drive.odometry.uses_ins_rate());
}

TEST(DeadReckoning, DoesNotBridgeAPause) {
  Drive drive;
  drive.Ticks(10, 5.0f, 5.0f);
  const float x_m = drive.odometry.pose().position.x_m;
  drive.now_ns += 500'000'000;
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels(5.0f, 5.0f)), Status::kOk);
  EXPECT_EQ(drive.odometry.pose().position.x_m, x_m);
  EXPECT_EQ(drive.odometry.gaps(), 1u);
}

TEST(DeadReckoning, RefusesWhatIsNoNumberAndTimeThatDoesNotGrow) {
  Drive drive;
  drive.Ticks(2, 1.0f, 1.0f);
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels(1.0f, 1.0f)),
            Status::kInvalidArgument);
  drive.now_ns += kTick_ns;
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels(kNan, 1.0f)), Status::kNotFinite);
  InsSample sample;
  sample.has_angular_rate = true;
  sample.angular_rate_radps = {0.0f, kNan, 0.0f};
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kNotFinite);
  sample = {};
  sample.has_attitude = true;
  sample.roll_rad = std::numeric_limits<float>::infinity();
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kNotFinite);
  sample.roll_rad = 0.0f;
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns - 1), Status::kInvalidArgument);
  EXPECT_TRUE(std::isfinite(drive.odometry.pose().position.x_m));
}

TEST(DeadReckoning, RefusesParametersOutOfRange) {
  DeadReckoning odometry;
  EXPECT_EQ(odometry.Configure({}, {.ground_per_wheel = 7.0f}, {}), Status::kParameterOutOfRange);
  EXPECT_EQ(odometry.Configure({}, {}, {.yaw_rad = kNan}), Status::kParameterOutOfRange);
  EXPECT_EQ(odometry.Advance(1, {}), Status::kNotStarted);
  EXPECT_EQ(odometry.TakeIns({}, 1), Status::kNotStarted);
}

}  // namespace
}  // namespace hardpack
