// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "test/core/odometry/drive.h"
#include "test/not_finite.h"

// Sensors that are silent, stuck, late, or say what cannot be.

namespace hardpack {
namespace {

using testing::Flaws;
using testing::KnownDrive;

using testing::kInfinity;
using testing::kNaN;
constexpr float kHuge = std::numeric_limits<float>::max();

// A vehicle that has driven for a while.
KnownDrive Driving(const Flaws& flaws = {}) {
  KnownDrive drive(flaws);
  drive.Ticks(100, 0.0, 0.0);
  drive.Ticks(300, 2.0, 0.3);
  return drive;
}

void ExpectAllFinite(const Odometry& odometry) {
  EXPECT_TRUE(std::isfinite(odometry.pose().position.x_m));
  EXPECT_TRUE(std::isfinite(odometry.pose().position.y_m));
  EXPECT_TRUE(std::isfinite(odometry.pose().roll_rad));
  EXPECT_TRUE(std::isfinite(odometry.pose().pitch_rad));
  EXPECT_LE(std::fabs(odometry.pose().yaw_rad), 3.1415928f);
  EXPECT_LE(std::fabs(odometry.speed_mps()), 50.0f);
  EXPECT_LE(std::fabs(odometry.yaw_rate_radps()), 20.0f);
  for (int i = 0; i < kOdometryStates; ++i) {
    EXPECT_TRUE(std::isfinite(odometry.Sigma(static_cast<OdometryState>(i))));
    EXPECT_GT(odometry.Sigma(static_cast<OdometryState>(i)), 0.0f);
  }
}

TEST(OdometryFaults, ASilentGyroIsReplacedByTheWheels) {
  KnownDrive drive = Driving();
  for (int tick = 0; tick < 500; ++tick) {
    drive.Move(2.0, 0.3);
    drive.Move(2.0, 0.3);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
    if (tick == 10) {
      EXPECT_FALSE(drive.odometry.uses_ins_rate());
    }
  }
  EXPECT_LT(std::fabs(drive.YawError()), 0.15);
  EXPECT_LT(drive.PositionError(), 0.06 * drive.driven_m);
  drive.Ticks(5, 2.0, 0.3);
  EXPECT_TRUE(drive.odometry.uses_ins_rate());
}

TEST(OdometryFaults, AGyroThatOnlyRepeatsItselfGrowsOld) {
  KnownDrive drive = Driving();
  const InsSample sample = drive.Ins();  // which it has taken
  for (int tick = 0; tick < 20; ++tick) {
    drive.Move(2.0, 0.3);
    drive.Move(2.0, 0.3);
    ASSERT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kDuplicate);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  }
  EXPECT_FALSE(drive.odometry.uses_ins_rate());
  EXPECT_EQ(drive.odometry.counters().repeated, 20u);
}

// Messages without a time since the device's start, as $VNINS: their GPS time tells. One of each
// kind at the same instant are two messages.
// SR-ODO03
TEST(OdometryFaults, ARepetitionIsToldByGpsTimeToo) {
  KnownDrive drive = Driving();
  InsSample line = drive.Ins();
  line.has_timestamp = false;
  line.has_gps_time = true;
  line.gps_time_ns = 1'400'000'000'000'000'000;
  EXPECT_EQ(drive.odometry.TakeIns(line, drive.now_ns), Status::kOk);
  InsSample binary = drive.Ins();
  binary.timestamp_ns += 1;
  binary.has_gps_time = true;
  binary.gps_time_ns = line.gps_time_ns;
  EXPECT_EQ(drive.odometry.TakeIns(binary, drive.now_ns), Status::kOk);
  EXPECT_EQ(drive.odometry.TakeIns(line, drive.now_ns), Status::kDuplicate);
  EXPECT_EQ(drive.odometry.TakeIns(binary, drive.now_ns), Status::kDuplicate);
  line.gps_time_ns += 5'000'000;
  EXPECT_EQ(drive.odometry.TakeIns(line, drive.now_ns), Status::kOk);
}

// New stamps, the same number, while the wheels begin to turn the other way.
// SR-ODO02
TEST(OdometryFaults, AFrozenGyroIsFoundByTheWheels) {
  KnownDrive drive = Driving();
  const AngularRate stuck = drive.Ins().angular_rate;
  for (int tick = 0; tick < 600; ++tick) {
    const double w_radps = std::max(-0.5, 0.3 - 0.01 * tick);
    drive.Move(2.0, w_radps);
    drive.Move(2.0, w_radps);
    InsSample sample = drive.Ins();
    sample.angular_rate = stuck;
    ASSERT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  }
  EXPECT_EQ(drive.odometry.counters().gyro_frozen, 1u);
  EXPECT_FALSE(drive.odometry.uses_ins_rate());
  EXPECT_NEAR(drive.odometry.yaw_rate_radps(), -0.5, 0.1);
  drive.Ticks(50, 2.0, -0.5);
  EXPECT_TRUE(drive.odometry.uses_ins_rate());
}

// They say the same while the vehicle brakes: the odometry has no wheel speeds any more.
// SR-ODO02
TEST(OdometryFaults, FrozenWheelsAreFoundByTheSpeedOverGround) {
  KnownDrive drive = Driving();
  const WheelFeedback stuck = drive.Wheels();
  const uint64_t before_ns = drive.odometry.moved_ns();
  int stale = 0;
  for (int tick = 0; tick < 300; ++tick) {
    const double v_mps = std::max(0.0, 2.0 - 0.02 * tick);
    drive.Move(v_mps, 0.3);
    drive.Move(v_mps, 0.3);
    ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
    WheelFeedback wheels = stuck;
    wheels.time_ns = drive.now_ns;
    stale += drive.odometry.Advance(drive.now_ns, wheels) == Status::kStale ? 1 : 0;
  }
  EXPECT_EQ(drive.odometry.counters().wheels_frozen, 1u);
  EXPECT_GT(stale, 150);
  EXPECT_GT(drive.odometry.moved_ns(), before_ns);
  EXPECT_LT(drive.odometry.moved_ns(), drive.now_ns - 1'000'000'000);
  EXPECT_EQ(drive.odometry.speed_mps(), 0.0f);
  // They come back: nobody knows where it went.
  drive.Ticks(20, 0.5, 0.0);
  EXPECT_EQ(drive.odometry.gaps(), 1u);
}

// The wheels stand, and say so, while the body still slides on behind them.
// SR-ODO02
TEST(OdometryFaults, WheelsThatStopBeforeTheBodyAreNotFrozen) {
  for (const double lag_s : {0.2, 0.35, 0.5}) {
    KnownDrive drive = Driving();
    for (int tick = 0; tick < 400; ++tick) {
      const double v_mps = 2.0 * std::exp(-0.01 * tick / lag_s);
      drive.Move(v_mps, 0.0);
      drive.Move(v_mps, 0.0);
      ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
      WheelFeedback wheels = drive.Wheels();
      wheels.left_radps = 0.0f;
      wheels.right_radps = 0.0f;
      ASSERT_EQ(drive.odometry.Advance(drive.now_ns, wheels), Status::kOk) << lag_s << ' ' << tick;
    }
    EXPECT_EQ(drive.odometry.counters().wheels_frozen, 0u);
  }
}

// The wheels turn on the spot as fast as they can, and the body follows them late.
// SR-ODO02
TEST(OdometryFaults, WheelsThatTurnBeforeTheBodyAreNotFrozen) {
  for (const double lag_s : {0.2, 0.4, 0.8}) {
    KnownDrive drive = Driving();
    drive.Ticks(100, 0.0, 0.0);
    for (int tick = 0; tick < 400; ++tick) {
      const double w_radps = -0.8 * (1.0 - std::exp(-0.01 * tick / lag_s));
      drive.Move(0.0, w_radps);
      drive.Move(0.0, w_radps);
      ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
      WheelFeedback wheels = drive.Wheels();
      wheels.left_radps = 3.5f;
      wheels.right_radps = -3.5f;
      ASSERT_NE(drive.odometry.Advance(drive.now_ns, wheels), Status::kStale)
          << lag_s << ' ' << tick;
    }
    EXPECT_EQ(drive.odometry.counters().wheels_frozen, 0u);
  }
}

TEST(OdometryFaults, AConstantSpeedIsNotFrozen) {
  KnownDrive drive(
      {.gyro_noise_radps = 0.0, .wheel_noise_radps = 0.0, .ground_speed_noise_mps = 0.0});
  drive.Ticks(6000, 2.0, 0.3);
  EXPECT_EQ(drive.odometry.counters().gyro_frozen, 0u);
  EXPECT_EQ(drive.odometry.counters().wheels_frozen, 0u);
}

// It rolled on while nobody said how fast.
// SR-ODO01
TEST(OdometryFaults, ASilenceOfTheWheelsIsBridgedWhileShortAndAGapBeyond) {
  for (const int silent : {10, 50}) {
    KnownDrive drive = Driving();
    const float before_m = drive.odometry.driven_m();
    const uint64_t moved_ns = drive.odometry.moved_ns();
    const double error_m = drive.PositionError();
    for (int i = 0; i < silent; ++i) {
      drive.Move(2.0, 0.3);
      drive.Move(2.0, 0.3);
      ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
      ASSERT_EQ(drive.odometry.Advance(drive.now_ns, {}), Status::kStale);
      ASSERT_EQ(drive.odometry.moved_ns(), moved_ns);
      ASSERT_EQ(drive.odometry.pose().time_ns, drive.now_ns);
    }
    const bool is_gap = silent == 50;
    EXPECT_EQ(drive.odometry.speed_mps() == 0.0f, is_gap);
    EXPECT_NEAR(drive.odometry.driven_m() - before_m, is_gap ? 0.4 : 0.2, 0.03);
    drive.Ticks(1, 2.0, 0.3);
    EXPECT_EQ(drive.odometry.gaps(), is_gap ? 1u : 0u);
    EXPECT_NEAR(drive.odometry.speed_mps(), 2.0, 0.15);
    if (!is_gap) {
      EXPECT_LT(drive.PositionError() - error_m, 0.02);
    }
  }
}

// SR-ODO01
TEST(OdometryFaults, APauseOfEverythingIsAGapAndNotBridged) {
  KnownDrive drive = Driving();
  const StampedPose before = drive.odometry.pose();
  drive.now_ns += 500'000'000;
  ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  EXPECT_EQ(drive.odometry.gaps(), 1u);
  EXPECT_EQ(drive.odometry.pose().position.x_m, before.position.x_m);
  EXPECT_EQ(drive.odometry.pose().yaw_rad, before.yaw_rad);
}

// SR-ODO05
TEST(OdometryFaults, RefusesWhatIsNoNumberAndWhatNoSensorSays) {
  KnownDrive drive = Driving();
  const StampedPose before = drive.odometry.pose();
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int field = 0; field < 6; ++field) {
      InsSample sample = drive.Ins();
      sample.timestamp_ns += static_cast<uint64_t>(field) + 1;
      float* fields[] = {&sample.angular_rate.x_radps,
                         &sample.angular_rate.z_radps,
                         &sample.roll_rad,
                         &sample.yaw_rad,
                         &sample.velocity_ned.north_mps,
                         &sample.velocity_ned.down_mps};
      *fields[field] = bad;
      EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kNotFinite) << field;
    }
  }
  InsSample sample = drive.Ins();
  sample.angular_rate.z_radps = kHuge;
  EXPECT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kInvalidArgument);
  EXPECT_EQ(drive.odometry.counters().refused, 19u);
  EXPECT_EQ(drive.odometry.pose().yaw_rad, before.yaw_rad);
  drive.now_ns += 10'000'000;
  WheelFeedback wheels = drive.Wheels();
  wheels.left_radps = kNaN;
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, wheels), Status::kNotFinite);
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, wheels), Status::kInvalidArgument);
  drive.now_ns += 10'000'000;
  wheels = drive.Wheels();
  wheels.right_radps = kHuge;
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, wheels), Status::kNotFinite);
  EXPECT_LT(drive.odometry.moved_ns(), drive.now_ns);
  ExpectAllFinite(drive.odometry);
}

// One glitch is kept out; what lasts is taken.
// SR-ODO02
TEST(OdometryFaults, AGlitchOfTheWheelsIsRejectedAndAStepIsNot) {
  KnownDrive drive = Driving({.has_ground_speed = false});
  const double error_m = drive.PositionError();
  for (int tick = 0; tick < 5; ++tick) {
    drive.Move(2.0, 0.3);
    drive.Move(2.0, 0.3);
    ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
    WheelFeedback wheels = drive.Wheels();
    wheels.left_radps = tick == 3 ? -400.0f : 400.0f;
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, wheels), Status::kOk);
  }
  EXPECT_EQ(drive.odometry.counters().wheel_speed_rejected, 5u);
  EXPECT_LT(drive.PositionError() - error_m, 0.02);
  for (int tick = 0; tick < 100; ++tick) {
    drive.Move(6.0, 0.0);
    drive.Move(6.0, 0.0);
    ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  }
  EXPECT_NEAR(drive.odometry.speed_mps(), 6.0, 0.2);
}

// SR-ODO02
TEST(OdometryFaults, AGlitchOfTheGyroIsRejected) {
  KnownDrive drive = Driving();
  const double error_rad = drive.YawError();
  for (int tick = 0; tick < 20; ++tick) {
    drive.Move(2.0, 0.3);
    InsSample sample = drive.Ins();
    sample.angular_rate.z_radps = tick % 2 == 0 ? 30.0f : -30.0f;
    ASSERT_EQ(drive.odometry.TakeIns(sample, drive.now_ns), Status::kOk);
    drive.Move(2.0, 0.3);
    ASSERT_EQ(drive.odometry.TakeIns(drive.Ins(), drive.now_ns), Status::kOk);
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  }
  EXPECT_EQ(drive.odometry.counters().gyro_rejected, 20u);
  EXPECT_LT(std::fabs(drive.YawError() - error_rad), 0.02);
}

// In order within 30 ms, everything else as it was: nearly the same drive.
TEST(OdometryFaults, MeasurementsThatComeOutOfOrderAreUsed) {
  KnownDrive drive;
  drive.Ticks(100, 0.0, 0.0);
  for (int tick = 0; tick < 1000; ++tick) {
    struct Held {
      InsSample sample;
      uint64_t time_ns;
    } held[6];
    const double w_radps = 0.5 * std::sin(0.01 * tick);
    for (int i = 0; i < 6; ++i) {
      drive.Move(std::min(2.0, 0.06 * tick), w_radps);
      held[i] = {drive.Ins(), drive.now_ns};
    }
    for (const int i : {3, 0, 5, 1, 4, 2}) {
      ASSERT_EQ(drive.odometry.TakeIns(held[i].sample, held[i].time_ns), Status::kOk);
    }
    ASSERT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kOk);
  }
  EXPECT_GT(drive.odometry.counters().late, 3000u);
  EXPECT_EQ(drive.odometry.counters().too_late, 0u);
  EXPECT_LT(std::fabs(drive.YawError()), 0.1);
  EXPECT_LT(drive.PositionError(), 0.03 * drive.driven_m);
}

TEST(OdometryFaults, WhatComesTooLateIsNotUsedAndTimeDoesNotRunBack) {
  KnownDrive drive = Driving();
  const InsSample old = drive.Ins();
  const uint64_t old_ns = drive.now_ns;
  drive.Ticks(30, 2.0, 0.3);
  const StampedPose before = drive.odometry.pose();
  EXPECT_EQ(drive.odometry.TakeIns(old, old_ns), Status::kLate);
  EXPECT_EQ(drive.odometry.counters().too_late, 1u);
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns, drive.Wheels()), Status::kInvalidArgument);
  EXPECT_EQ(drive.odometry.Advance(drive.now_ns - 1, drive.Wheels()), Status::kInvalidArgument);
  EXPECT_EQ(drive.odometry.pose().position.x_m, before.position.x_m);
}

TEST(OdometryFaults, RefusesParametersOutOfRange) {
  Odometry odometry;
  EXPECT_EQ(odometry.Advance(1, {}), Status::kNotStarted);
  EXPECT_EQ(odometry.TakeIns({}, 1), Status::kNotStarted);
  EXPECT_EQ(odometry.Configure({}, {.ground_per_wheel = 7.0f}, {}), Status::kParameterOutOfRange);
  EXPECT_EQ(odometry.Configure({}, {}, {.yaw_rad = kNaN}), Status::kParameterOutOfRange);
  EXPECT_EQ(odometry.Advance(1, {}), Status::kNotStarted);
}

// Whatever comes, in any order and at any time: a number comes out, and the pose does not jump.
// SR-ODO05
TEST(OdometryFaults, NeverGivesAnythingButNumbers) {
  constexpr uint32_t kSeed = 20250210;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const auto number = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  const auto value = [&]() -> float {
    switch (number(0, 9)) {
      case 0:
        return std::bit_cast<float>(static_cast<uint32_t>(random()));
      case 1:
        return static_cast<float>(number(-40, 40));
      case 2:
        return 0.0f;
      default:
        return static_cast<float>(number(-100, 100)) * 0.02f;
    }
  };
  Odometry odometry;
  ASSERT_EQ(odometry.Configure({}, {}, {}), Status::kOk);
  uint64_t now_ns = 1'000'000'000;
  for (int step = 0; step < 100'000; ++step) {
    now_ns += static_cast<uint64_t>(number(0, 300) == 0 ? 400'000'000 : number(0, 12'000'000));
    const auto time_ns =
        static_cast<uint64_t>(static_cast<int64_t>(now_ns) + number(-30, 5) * int64_t{5'000'000});
    if (number(0, 2) != 0) {
      InsSample sample;
      sample.has_timestamp = number(0, 1) == 0;
      sample.timestamp_ns = random();
      sample.has_angular_rate = number(0, 3) != 0;
      sample.angular_rate = {value(), value(), value()};
      sample.has_attitude = number(0, 1) == 0;
      sample.roll_rad = value();
      sample.pitch_rad = value();
      sample.yaw_rad = value();
      sample.has_velocity = number(0, 1) == 0;
      sample.velocity_ned = {value(), value(), value()};
      sample.has_status = true;
      sample.status.mode = InsMode::kTracking;
      sample.status.gnss_fix = true;
      static_cast<void>(odometry.TakeIns(sample, time_ns));
    } else {
      WheelFeedback wheels;
      wheels.valid = number(0, 5) != 0;
      wheels.time_ns = time_ns;
      wheels.left_radps = value() * 5.0f;
      wheels.right_radps = number(0, 3) == 0 ? wheels.left_radps : value() * 5.0f;
      const StampedPose before = odometry.pose();
      static_cast<void>(odometry.Advance(now_ns, wheels));
      const StampedPose& after = odometry.pose();
      // Of 50 m/s at most, and what a measurement corrects.
      ASSERT_LE(std::hypot(after.position.x_m - before.position.x_m,
                           after.position.y_m - before.position.y_m),
                25.0f)
          << "step " << step;
    }
    ExpectAllFinite(odometry);
    ASSERT_FALSE(HasFailure()) << "step " << step;
  }
  EXPECT_EQ(odometry.counters().restarts, 0u);
}

}  // namespace
}  // namespace hardpack
