// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/odometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "test/core/odometry/drive.h"

namespace hardpack {
namespace {

using testing::Flaws;
using testing::KnownDrive;

TEST(Odometry, DrivesStraight) {
  KnownDrive drive;
  drive.Ticks(100, 0.0, 0.0);
  drive.Ticks(2000, 3.0, 0.0);
  EXPECT_GT(drive.driven_m, 50.0);
  EXPECT_LT(drive.PositionError(), 0.01 * drive.driven_m);
  EXPECT_LT(std::fabs(drive.YawError()), 0.005);
  EXPECT_NEAR(drive.odometry.speed_mps(), 3.0, 0.05);
  EXPECT_NEAR(drive.odometry.driven_m(), drive.driven_m, 0.01 * drive.driven_m);
  EXPECT_EQ(drive.odometry.gaps(), 0u);
}

//        ___
//      /     \   centre (0, R)
TEST(Odometry, DrivesACircle) {
  KnownDrive drive;
  drive.Ticks(100, 0.0, 0.0);
  drive.Ticks(4 * 1257, 2.0, 0.5);
  EXPECT_LT(drive.PositionError(), 0.005 * drive.driven_m);
  EXPECT_LT(std::fabs(drive.YawError()), 0.02);
  EXPECT_NEAR(drive.odometry.yaw_rate_radps(), 0.5, 0.02);
}

TEST(Odometry, DrivesAFigureOfEight) {
  KnownDrive drive({.gyro_bias_radps = 0.01});
  drive.Ticks(1000, 0.0, 0.0);
  for (int eight = 0; eight < 3; ++eight) {
    drive.Ticks(1257, 2.0, 0.5);
    drive.Ticks(1257, 2.0, -0.5);
  }
  EXPECT_GT(drive.driven_m, 140.0);
  EXPECT_LT(drive.PositionError(), 0.01 * drive.driven_m);
  EXPECT_LT(std::fabs(drive.YawError()), 0.04);
}

// This vehicle is never behind its wheels, and is told so.
TEST(Odometry, DrivesBackwardAndTurnsOnTheSpot) {
  OdometryParams firm_ground;
  firm_ground.wheel_lag_share = 0.0f;
  KnownDrive drive({}, 20250208, firm_ground);
  drive.Ticks(100, 0.0, 0.0);
  drive.Ticks(500, -1.5, 0.0);
  drive.Ticks(500, 0.0, 0.8);
  drive.Ticks(500, -1.5, 0.2);
  EXPECT_LT(drive.PositionError(), 0.015 * drive.driven_m);
  EXPECT_LT(std::fabs(drive.YawError()), 0.02);
}

// What the INS calls down may be any direction: roll and pitch say how much of a turn it sees.
TEST(Odometry, TurnsAboutTheVerticalOnASlope) {
  KnownDrive drive({.gyro_noise_radps = 0.0, .wheel_noise_radps = 0.0, .has_ground_speed = false});
  drive.Ticks(100, 0.0, 0.0);
  const double pitch_rad = 0.35;  // nose down in odom, where it stays while it turns: a cone
  for (int tick = 0; tick < 400; ++tick) {
    drive.Move(0.0, 0.5);
    drive.Move(0.0, 0.5);
    InsSample sample = drive.Ins();
    sample.pitch_rad = static_cast<float>(-pitch_rad);
    sample.angular_rate = {static_cast<float>(-0.5 * std::sin(pitch_rad)), 0.0f,
                           static_cast<float>(-0.5 * std::cos(pitch_rad))};
    sample.timestamp_ns += static_cast<uint64_t>(tick);
    ASSERT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  }
  EXPECT_NEAR(drive.odometry.pose().pitch_rad, pitch_rad, 1e-4);
  EXPECT_LT(std::fabs(drive.YawError()), 0.03);
}

// Up and down, forward and backward, by the INS's vertical speed and without it.
TEST(Odometry, ItsHeightFollowsTheGround) {
  for (const bool has_velocity : {true, false}) {
    for (const double grade_rad : {0.35, -0.2}) {
      for (const double speed_mps : {3.0, -1.0}) {
        SCOPED_TRACE(::testing::Message() << has_velocity << ' ' << grade_rad << ' ' << speed_mps);
        KnownDrive drive({.has_ground_speed = has_velocity});
        drive.Ticks(100, 0.0, 0.0);
        drive.grade_rad = grade_rad;
        drive.Ticks(1000, speed_mps, 0.0);
        EXPECT_GT(std::fabs(drive.z_m), 1.5);
        EXPECT_NEAR(drive.odometry.pose().position.z_m, drive.z_m, 0.02 * std::fabs(drive.z_m));
        if (has_velocity) {
          EXPECT_LT(drive.PositionError(), 0.015 * drive.driven_m);
        }
      }
    }
  }
}

// A nose that dips on level ground is no slope, as long as the INS tells; and what the INS says of
// a vertical speed that no pitch bears out does not lift the vehicle off.
TEST(Odometry, ANoseThatDipsIsNoSlopeAndAVerticalSpeedNoLift) {
  KnownDrive drive;
  drive.Ticks(100, 0.0, 0.0);
  drive.dip_rad = 0.05;
  drive.Ticks(1000, 2.0, 0.0);
  EXPECT_LT(std::fabs(drive.odometry.pose().position.z_m), 0.02f);
  drive.dip_rad = 0.0;
  drive.climb_error_mps = 3.0;
  drive.driven_m = 0.0;
  const float before_m = drive.odometry.pose().position.z_m;
  drive.Ticks(300, 2.0, 0.0);
  const float lifted_m = drive.odometry.pose().position.z_m - before_m;
  EXPECT_LT(lifted_m, 1.05f * Odometry::kClimbShare * static_cast<float>(drive.driven_m));
  drive.Ticks(300, 0.0, 0.0);
  const float stood_m = drive.odometry.pose().position.z_m;
  drive.Ticks(1000, 0.0, 0.0);
  EXPECT_EQ(drive.odometry.pose().position.z_m, stood_m) << "at rest";
}

// Tyres on a bank creep downhill, which no wheel tells; uphill they do not, and on level ground not
// either, whatever an INS says whose heading is wrong.
TEST(Odometry, CreepsDownhillOnABankAndNowhereElse) {
  for (const double bank_rad : {0.25, -0.25, 0.0}) {
    for (const double slide_mps : {0.1, -0.1}) {
      SCOPED_TRACE(::testing::Message() << bank_rad << ' ' << slide_mps);
      KnownDrive drive({.ground_speed_noise_mps = 0.02});
      drive.Ticks(100, 0.0, 0.0);
      drive.bank_rad = bank_rad;
      drive.slide_mps = slide_mps;
      drive.Ticks(1000, 2.0, 0.0);
      const bool is_downhill = bank_rad * slide_mps > 0.0;
      const double aside_m =
          -(drive.x_m * std::sin(drive.yaw_rad)) + drive.y_m * std::cos(drive.yaw_rad);
      EXPECT_GT(std::fabs(aside_m), 0.9);
      const double found_m = static_cast<double>(drive.odometry.pose().position.y_m);
      EXPECT_NEAR(found_m, is_downhill ? aside_m : 0.0, 0.15);
      // No more than tyres do that still roll.
      drive.slide_mps *= 100.0;
      drive.Ticks(100, 2.0, 0.0);
      const double moved_m = static_cast<double>(drive.odometry.pose().position.y_m) - found_m;
      EXPECT_LT(std::fabs(moved_m), 1.1 * 0.5 * 2.0 * std::sin(0.25));
    }
  }
}

// Tyres creep along a grade at once, and the wheels' scale is learned only by and by.
TEST(Odometry, CreepsAlongAGradeBeforeItHasLearnedIt) {
  for (const double grade_rad : {-0.35, 0.35}) {
    SCOPED_TRACE(grade_rad);
    KnownDrive drive;
    drive.Ticks(100, 0.0, 0.0);
    drive.grade_rad = grade_rad;
    drive.creep = grade_rad < 0.0 ? 0.1 : -0.1;  // up a grade it falls behind its wheels
    drive.Ticks(300, 1.5, 0.0);
    EXPECT_LT(drive.PositionError(), 0.04 * drive.driven_m);
  }
}

TEST(Odometry, DoesNotCreepOnLevelGround) {
  const auto end_m = [](bool has_ground_speed) {
    KnownDrive drive({.has_ground_speed = has_ground_speed});
    drive.Ticks(100, 0.0, 0.0);
    drive.creep = 0.1;
    drive.Ticks(60, 1.5, 0.0);
    return drive.odometry.pose().position.x_m;
  };
  EXPECT_NEAR(end_m(true), end_m(false), 0.01f) << "too slow for the filter to learn from";
}

// An INS that stopped telling how fast it climbs told the past.
TEST(Odometry, AVerticalSpeedThatIsOldIsNotUsed) {
  KnownDrive drive({.ground_speed_noise_mps = 0.0});
  drive.Ticks(100, 0.0, 0.0);
  drive.grade_rad = 0.1;
  drive.Ticks(300, 2.0, 0.0);
  drive.flaws.has_ground_speed = false;
  drive.grade_rad = 0.0;
  drive.Ticks(500, 2.0, 0.0);
  EXPECT_NEAR(drive.odometry.pose().position.z_m, drive.z_m, 0.05);
}

TEST(Odometry, ItsHeightBeginsAnewBeyondItsLimit) {
  for (const double grade_rad : {0.5, -0.5}) {
    KnownDrive drive;
    drive.grade_rad = grade_rad;
    float most_m = 0.0f;
    int steps = 0;
    for (int tick = 0; tick < 6000; ++tick) {
      const float before_m = drive.odometry.pose().position.z_m;
      drive.Ticks(1, 5.0, 0.0);
      const float step_m = drive.odometry.pose().position.z_m - before_m;
      most_m = std::max(most_m, std::fabs(drive.odometry.pose().position.z_m));
      if (std::fabs(step_m) > 1.0f) ++steps;
    }
    EXPECT_GT(std::fabs(drive.z_m), double{Odometry::kMaxHeight_m});
    EXPECT_LE(most_m, Odometry::kMaxHeight_m);
    EXPECT_EQ(steps, 1);
  }
}

TEST(Odometry, LearnsTheGyrosBiasAtRest) {
  for (const double bias_radps : {0.02, -0.02}) {
    KnownDrive drive({.gyro_bias_radps = bias_radps});
    drive.Ticks(1000, 0.0, 0.0);
    EXPECT_TRUE(drive.odometry.at_rest());
    EXPECT_NEAR(drive.odometry.gyro_bias_radps(), bias_radps, 0.001);
    EXPECT_LT(drive.odometry.Sigma(kStateGyroBias), 0.002f);
    const double before_rad = drive.YawError();
    drive.Ticks(3000, 3.0, 0.0);
    EXPECT_FALSE(drive.odometry.at_rest());
    EXPECT_LT(std::fabs(drive.YawError() - before_rad), 30.0 * 0.001);
  }
}

TEST(Odometry, RestsWhileNoWheelIsFasterThanItsParameter) {
  const float limit_radps = OdometryParams{}.rest_wheel_radps;
  const float faster_radps = std::nextafter(limit_radps, 1.0f);
  for (const float left_radps : {limit_radps, -limit_radps, faster_radps, -faster_radps}) {
    for (const float right_radps : {limit_radps, -limit_radps, faster_radps, -faster_radps}) {
      KnownDrive drive;
      for (int tick = 0; tick < 100; ++tick) {
        drive.Move(0.0, 0.0);
        drive.Move(0.0, 0.0);
        ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
        ASSERT_EQ(drive.odometry.Advance(drive.now_ns, {.valid = true,
                                                        .time_ns = drive.now_ns,
                                                        .left_radps = left_radps,
                                                        .right_radps = right_radps}),
                  Status::kOk);
      }
      EXPECT_EQ(drive.odometry.at_rest(),
                std::fabs(left_radps) <= limit_radps && std::fabs(right_radps) <= limit_radps)
          << left_radps << ' ' << right_radps;
    }
  }
}

// Ten minutes. Half a second goes by until it is known to rest, then the pose does not move.
TEST(Odometry, DoesNotTurnAtRestWhateverTheBias) {
  KnownDrive drive({.gyro_bias_radps = 0.02});
  drive.Ticks(60, 0.0, 0.0);
  const StampedPose before = drive.odometry.pose();
  EXPECT_LT(std::fabs(before.yaw_rad), 0.02f);
  drive.Ticks(60'000, 0.0, 0.0);
  EXPECT_EQ(drive.odometry.pose().yaw_rad, before.yaw_rad);
  EXPECT_EQ(drive.odometry.pose().position.x_m, before.position.x_m);
  EXPECT_EQ(drive.odometry.pose().position.y_m, before.position.y_m);
  EXPECT_EQ(drive.odometry.speed_mps(), 0.0f);
}

// A bias that wanders is followed; a turn that is none of the wheels' doing is not a bias.
TEST(Odometry, SeesThatItIsTurnedWhileItsWheelsStand) {
  KnownDrive drive;
  drive.Ticks(500, 0.0, 0.0);
  const float bias_radps = drive.odometry.gyro_bias_radps();
  for (int tick = 0; tick < 200; ++tick) {  // on a boat
    drive.Move(0.0, 0.2);
    drive.Move(0.0, 0.2);
    ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, {.valid = true, .time_ns = drive.now_ns}),
              Status::kOk);
  }
  EXPECT_FALSE(drive.odometry.at_rest());
  EXPECT_NEAR(drive.odometry.pose().yaw_rad, 0.4, 0.02);
  EXPECT_NEAR(drive.odometry.gyro_bias_radps(), bias_radps, 0.001);
}

TEST(Odometry, LearnsHowMuchTheWheelsSlipInATurn) {
  for (const double baseline_m : {1.5, 1.87, 2.3}) {
    KnownDrive drive({.baseline_m = baseline_m});
    drive.Ticks(100, 0.0, 0.0);
    drive.Ticks(2000, 2.0, 0.6);
    EXPECT_NEAR(drive.odometry.skid_baseline_m(), baseline_m, 0.06) << baseline_m;
    // And so it turns right without the gyro.
    const double before_rad = drive.YawError();
    for (int tick = 0; tick < 500; ++tick) {
      drive.Move(2.0, 0.6);
      drive.Move(2.0, 0.6);
      ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
    }
    EXPECT_FALSE(drive.odometry.uses_ins_rate());
    EXPECT_LT(std::fabs(drive.YawError() - before_rad), 0.05 * 3.0) << baseline_m;
  }
}

TEST(Odometry, LearnsTheWheelScaleFromTheSpeedOverGround) {
  for (const double scale : {0.9, 1.02}) {
    KnownDrive drive({.wheel_scale = scale});
    drive.Ticks(100, 0.0, 0.0);
    drive.Ticks(6000, 3.0, 0.0);
    EXPECT_NEAR(drive.odometry.wheel_scale(), scale, 0.01);
    drive.flaws.has_ground_speed = false;
    const double error_m = drive.PositionError();
    const double driven_m = drive.driven_m;
    drive.Ticks(2000, 2.0, 0.0);
    EXPECT_LT(drive.PositionError() - error_m, 0.012 * (drive.driven_m - driven_m));
  }
}

// Wheels of unequal size on a straight are not taken for a bias of the gyro.
TEST(Odometry, DoesNotLearnABiasFromUnequalWheels) {
  KnownDrive drive;
  drive.Ticks(1000, 0.0, 0.0);
  for (int tick = 0; tick < 6000; ++tick) {
    const double v_mps = std::min(3.0, 0.02 * tick);
    drive.Move(v_mps, 0.0);
    drive.Move(v_mps, 0.0);
    ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
    WheelFeedback wheels = drive.Wheels();
    wheels.right_radps *= 1.02f;
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, wheels), Status::kOk);
  }
  EXPECT_NEAR(drive.odometry.gyro_bias_radps(), 0.0, 5e-4);
  EXPECT_LT(std::fabs(drive.YawError()), 0.03);
}

// The error stays within what the filter says of it.
TEST(Odometry, IsAsSureAsItMayBe) {
  int outside = 0;
  for (uint32_t seed = 1; seed <= 10; ++seed) {
    KnownDrive drive({.gyro_bias_radps = 0.005}, seed);
    drive.Ticks(300, 0.0, 0.0);
    drive.Ticks(1000, 2.0, 0.3);
    drive.Ticks(1000, 3.0, -0.3);
    const double sigma_m = std::hypot(drive.odometry.Sigma(kStateX), drive.odometry.Sigma(kStateY));
    outside += drive.PositionError() > 3.0 * sigma_m ? 1 : 0;
    EXPECT_LT(sigma_m, 0.03 * drive.driven_m);
  }
  EXPECT_LE(outside, 1);
}

}  // namespace
}  // namespace hardpack
