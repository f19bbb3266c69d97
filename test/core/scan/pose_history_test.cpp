// SPDX-License-Identifier: Apache-2.0
#include "core/scan/pose_history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/base/math.h"
#include "test/not_finite.h"

namespace hardpack {
namespace {

using testing::kInfinity;
using testing::kNaN;
constexpr double kHalfTurn_rad = 3.14159265358979323846;
constexpr uint64_t kMillisecond_ns = 1'000'000u;
constexpr uint64_t kStart_ns = 1'000'000'000'000u;

// A vehicle on a circle, rolling and pitching, with its true pose in double precision.
struct Motion {
  double speed_mps = 5.0;
  double yaw_rate_radps = 2.2;
  double yaw_start_rad = 3.0;
  double center_x_m = 0.0;
  double center_y_m = 0.0;

  double x_m(double t_s) const {
    return center_x_m + radius_m() * std::sin(yaw_start_rad + yaw_rate_radps * t_s);
  }
  double y_m(double t_s) const {
    return center_y_m - radius_m() * std::cos(yaw_start_rad + yaw_rate_radps * t_s);
  }
  double z_m(double t_s) const { return 0.3 * t_s; }
  double roll_rad(double t_s) const { return 0.1 + 0.2 * t_s; }
  double pitch_rad(double t_s) const { return 0.05 - 0.1 * t_s; }
  double yaw_rad(double t_s) const {
    return std::remainder(yaw_start_rad + yaw_rate_radps * t_s, 2.0 * kHalfTurn_rad);
  }
  double radius_m() const { return speed_mps / yaw_rate_radps; }

  StampedPose PoseAt(double t_s) const {
    StampedPose pose;
    pose.time_ns = kStart_ns + static_cast<uint64_t>(std::llround(t_s * 1e9));
    pose.position = {static_cast<float>(x_m(t_s)), static_cast<float>(y_m(t_s)),
                     static_cast<float>(z_m(t_s))};
    pose.roll_rad = static_cast<float>(roll_rad(t_s));
    pose.pitch_rad = static_cast<float>(pitch_rad(t_s));
    pose.yaw_rad = static_cast<float>(yaw_rad(t_s));
    return pose;
  }
};

struct PoseError {
  double level_m = 0.0;
  double height_m = 0.0;
  double angle_rad = 0.0;
};

double AngleBetween(float a_rad, double b_rad) {
  return std::abs(std::remainder(static_cast<double>(a_rad) - b_rad, 2.0 * kHalfTurn_rad));
}

PoseError ErrorOf(const StampedPose& pose, const Motion& motion, double t_s) {
  PoseError error;
  error.level_m = std::hypot(static_cast<double>(pose.position.x_m) - motion.x_m(t_s),
                             static_cast<double>(pose.position.y_m) - motion.y_m(t_s));
  error.height_m = std::abs(static_cast<double>(pose.position.z_m) - motion.z_m(t_s));
  error.angle_rad = std::max({AngleBetween(pose.roll_rad, motion.roll_rad(t_s)),
                              AngleBetween(pose.pitch_rad, motion.pitch_rad(t_s)),
                              AngleBetween(pose.yaw_rad, motion.yaw_rad(t_s))});
  return error;
}

void TakeLarger(PoseError& worst, const PoseError& error) {
  worst.level_m = std::max(worst.level_m, error.level_m);
  worst.height_m = std::max(worst.height_m, error.height_m);
  worst.angle_rad = std::max(worst.angle_rad, error.angle_rad);
}

StampedPose PoseOf(uint64_t time_ns, float x_m, float yaw_rad = 0.0f) {
  StampedPose pose;
  pose.time_ns = time_ns;
  pose.position.x_m = x_m;
  pose.yaw_rad = yaw_rad;
  return pose;
}

void AddAll(PoseHistory& history, const std::vector<StampedPose>& poses) {
  for (const StampedPose& pose : poses) ASSERT_EQ(history.Add(pose), Status::kOk);
}

// The bounds that the header states, between poses and beyond the newest, left and right turns
// through +-pi.
TEST(PoseHistory, FollowsTurningMotionWithinTheStatedBounds) {
  const unsigned seed = 20240802u;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> inside(0.0, 1.2);
  std::uniform_real_distribution<double> beyond(1.2, 1.25);
  PoseError between;
  PoseError after;
  for (int run = 0; run < 200; ++run) {
    Motion motion;
    motion.yaw_rate_radps = run % 2 == 0 ? 2.2 : -2.2;
    motion.yaw_start_rad = 0.1 * run;
    motion.center_x_m = -490.0 + 4.9 * run;
    motion.center_y_m = 490.0;
    PoseHistory history;
    for (int tick = 0; tick <= 120; ++tick) {
      ASSERT_EQ(history.Add(motion.PoseAt(0.01 * tick)), Status::kOk);
    }
    for (int i = 0; i < 500; ++i) {
      const bool extrapolated = i % 5 == 4;
      const uint64_t time_ns =
          motion.PoseAt(extrapolated ? beyond(random) : inside(random)).time_ns;
      StampedPose pose;
      ASSERT_EQ(history.At(time_ns, pose), Status::kOk);
      ASSERT_EQ(pose.time_ns, time_ns);
      ASSERT_GT(pose.yaw_rad, -kPi);
      ASSERT_LE(pose.yaw_rad, kPi);
      const double t_s = static_cast<double>(time_ns - kStart_ns) * 1e-9;
      TakeLarger(extrapolated ? after : between, ErrorOf(pose, motion, t_s));
    }
  }
  RecordProperty("between_level_um", static_cast<int>(between.level_m * 1e6));
  RecordProperty("between_angle_urad", static_cast<int>(between.angle_rad * 1e6));
  RecordProperty("after_level_um", static_cast<int>(after.level_m * 1e6));
  RecordProperty("after_angle_urad", static_cast<int>(after.angle_rad * 1e6));
  EXPECT_LT(between.level_m, 0.00014 + 0.00005);
  EXPECT_LT(between.height_m, 1e-6);
  EXPECT_LT(between.angle_rad, 2e-6);
  EXPECT_LT(after.level_m, 0.0165 + 0.0004);  // six times the rounding
  EXPECT_LT(after.height_m, 1e-5);
  EXPECT_LT(after.angle_rad, 1e-5);
}

// The slow way: every pair of neighbours is looked at.
Status SlowAt(const std::vector<StampedPose>& poses, uint64_t time_ns, double& x_m,
              double& yaw_rad) {
  for (size_t i = 0; i < poses.size(); ++i) {
    if (poses[i].time_ns == time_ns) {
      x_m = static_cast<double>(poses[i].position.x_m);
      yaw_rad = static_cast<double>(poses[i].yaw_rad);
      return Status::kOk;
    }
    if (i + 1 == poses.size() || poses[i].time_ns > time_ns || poses[i + 1].time_ns <= time_ns) {
      continue;
    }
    const double span_ns = static_cast<double>(poses[i + 1].time_ns - poses[i].time_ns);
    if (span_ns > 200e6) return Status::kNoPose;
    const double f = static_cast<double>(time_ns - poses[i].time_ns) / span_ns;
    const double x0_m = static_cast<double>(poses[i].position.x_m);
    const double yaw0_rad = static_cast<double>(poses[i].yaw_rad);
    x_m = x0_m + f * (static_cast<double>(poses[i + 1].position.x_m) - x0_m);
    yaw_rad = yaw0_rad + f * std::remainder(static_cast<double>(poses[i + 1].yaw_rad) - yaw0_rad,
                                            2.0 * kHalfTurn_rad);
    return Status::kOk;
  }
  return Status::kNoPose;
}

TEST(PoseHistory, EqualsASlowSearchInDoublePrecision) {
  const unsigned seed = 991u;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 300; ++run) {
    PoseHistory history;
    std::vector<StampedPose> poses;
    uint64_t time_ns = kStart_ns;
    const int count = 1 + static_cast<int>(random() % 300);
    for (int i = 0; i < count; ++i) {
      const bool gap = random() % 20 == 0;
      time_ns += 1 + random() % (gap ? 400u * kMillisecond_ns : 20u * kMillisecond_ns);
      poses.push_back(PoseOf(time_ns, static_cast<float>(random() % 1000) / 100.0f,
                             static_cast<float>(random() % 6283) / 1000.0f - 3.1415f));
      ASSERT_EQ(history.Add(poses.back()), Status::kOk);
    }
    if (poses.size() > PoseHistory::kCapacity) {
      poses.erase(poses.begin(), poses.end() - PoseHistory::kCapacity);
    }
    ASSERT_EQ(history.size(), static_cast<int>(poses.size()));
    const uint64_t span_ns = poses.back().time_ns - poses.front().time_ns;
    for (int i = 0; i < 300; ++i) {
      const uint64_t at_ns = i % 3 == 0 ? poses[random() % poses.size()].time_ns
                                        : poses.front().time_ns + random() % (span_ns + 1);
      double x_m = 0.0;
      double yaw_rad = 0.0;
      StampedPose pose;
      const Status expected = SlowAt(poses, at_ns, x_m, yaw_rad);
      ASSERT_EQ(history.At(at_ns, pose), expected);
      if (expected != Status::kOk) continue;
      ASSERT_NEAR(static_cast<double>(pose.position.x_m), x_m, 5e-6);
      ASSERT_LT(AngleBetween(pose.yaw_rad, yaw_rad), 2e-6);
    }
  }
}

//    |  .  .  .  .  |----->
//   first         newest   50 ms
TEST(PoseHistory, KnowsNothingBeforeItsOldestPoseOrFarBeyondItsNewest) {
  PoseHistory history;
  StampedPose pose = PoseOf(7, 7.0f);
  EXPECT_EQ(history.At(kStart_ns, pose), Status::kNoPose);
  AddAll(history, {PoseOf(kStart_ns, 1.0f), PoseOf(kStart_ns + 10 * kMillisecond_ns, 1.05f)});
  EXPECT_EQ(history.At(0, pose), Status::kNoPose);
  EXPECT_EQ(history.At(kStart_ns - 1, pose), Status::kNoPose);
  EXPECT_EQ(history.At(kStart_ns + 60 * kMillisecond_ns + 1, pose), Status::kNoPose);
  EXPECT_EQ(history.At(UINT64_MAX, pose), Status::kNoPose);
  EXPECT_EQ(pose.time_ns, 7u);
  EXPECT_EQ(pose.position.x_m, 7.0f);
  EXPECT_EQ(history.At(kStart_ns, pose), Status::kOk);
  EXPECT_EQ(pose.position.x_m, 1.0f);
  EXPECT_EQ(history.At(kStart_ns + 60 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.position.x_m, 1.3f, 1e-5f);
  history.Clear();
  EXPECT_EQ(history.size(), 0);
  EXPECT_EQ(history.At(kStart_ns, pose), Status::kNoPose);
}

TEST(PoseHistory, HoldsASinglePoseForAWhile) {
  PoseHistory history;
  ASSERT_EQ(history.Add(PoseOf(kStart_ns, 3.0f, 1.0f)), Status::kOk);
  StampedPose pose;
  ASSERT_EQ(history.At(kStart_ns + 50 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_EQ(pose.time_ns, kStart_ns + 50 * kMillisecond_ns);
  EXPECT_EQ(pose.position.x_m, 3.0f);
  EXPECT_EQ(pose.yaw_rad, 1.0f);
  EXPECT_EQ(history.At(kStart_ns + 50 * kMillisecond_ns + 1, pose), Status::kNoPose);
}

//   |  |  |                    |  |
//            longer than 200 ms
TEST(PoseHistory, InterpolatesAcrossNoGap) {
  PoseHistory history;
  const uint64_t gap_begin_ns = kStart_ns + 10 * kMillisecond_ns;
  const uint64_t gap_end_ns = gap_begin_ns + 200 * kMillisecond_ns + 1;
  AddAll(history, {PoseOf(kStart_ns, 0.0f), PoseOf(gap_begin_ns, 1.0f), PoseOf(gap_end_ns, 2.0f)});
  StampedPose pose;
  EXPECT_EQ(history.At(gap_begin_ns, pose), Status::kOk);
  EXPECT_EQ(pose.position.x_m, 1.0f);
  EXPECT_EQ(history.At(gap_begin_ns + 1, pose), Status::kNoPose);
  EXPECT_EQ(history.At(gap_end_ns - 1, pose), Status::kNoPose);
  EXPECT_EQ(history.At(gap_end_ns, pose), Status::kOk);
  // Nor is the newest carried on with a velocity across it.
  EXPECT_EQ(history.At(gap_end_ns + 20 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_EQ(pose.position.x_m, 2.0f);
  // One that is just none.
  ASSERT_EQ(history.Add(PoseOf(gap_end_ns + 200 * kMillisecond_ns, 4.0f)), Status::kOk);
  EXPECT_EQ(history.At(gap_end_ns + 100 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.position.x_m, 3.0f, 1e-6f);
}

// Two poses 1 us and 1 mm apart are no 1000 m/s.
TEST(PoseHistory, TakesNoVelocityFromPosesThatAreTooClose) {
  PoseHistory history;
  AddAll(history, {PoseOf(kStart_ns, 0.0f), PoseOf(kStart_ns + 10 * kMillisecond_ns, 0.05f),
                   PoseOf(kStart_ns + 10 * kMillisecond_ns + 1000, 0.051f)});
  StampedPose pose;
  ASSERT_EQ(history.At(kStart_ns + 60 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.position.x_m, 0.051f + 0.255f, 1e-4f);

  PoseHistory close;
  for (uint64_t i = 0; i < 200; ++i) {
    ASSERT_EQ(close.Add(PoseOf(kStart_ns + i, static_cast<float>(i))), Status::kOk);
  }
  ASSERT_EQ(close.At(kStart_ns + 40 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_EQ(pose.position.x_m, 199.0f);
}

TEST(PoseHistory, TurnsTheShortWayAroundPi) {
  PoseHistory history;
  AddAll(history,
         {PoseOf(kStart_ns, 0.0f, 3.1f), PoseOf(kStart_ns + 10 * kMillisecond_ns, 0.0f, -3.1f)});
  StampedPose pose;
  const float step_rad = 2.0f * (kPi - 3.1f);
  ASSERT_EQ(history.At(kStart_ns + 2 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.yaw_rad, 3.1f + 0.2f * step_rad, 1e-6f);
  ASSERT_EQ(history.At(kStart_ns + 8 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.yaw_rad, -3.1f - 0.2f * step_rad, 1e-6f);
  ASSERT_EQ(history.At(kStart_ns + 20 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.yaw_rad, -3.1f + step_rad, 1e-6f);
}

// An odometry that counts its turns.
TEST(PoseHistory, WrapsAnglesOfManyTurns) {
  PoseHistory history;
  AddAll(history, {PoseOf(kStart_ns, 0.0f, 2000.0f * kPi),
                   PoseOf(kStart_ns + 10 * kMillisecond_ns, 0.0f, -2000.0f * kPi + 0.2f)});
  StampedPose pose;
  ASSERT_EQ(history.At(kStart_ns + 5 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_NEAR(pose.yaw_rad, 0.1f, 1e-3f);  // a float32 of that size is no finer
  EXPECT_LE(std::abs(history.newest().yaw_rad), kPi);
}

TEST(PoseHistory, RefusesWhatIsOutOfOrder) {
  PoseHistory history;
  ASSERT_EQ(history.Add(PoseOf(kStart_ns, 1.0f)), Status::kOk);
  EXPECT_EQ(history.Add(PoseOf(kStart_ns, 2.0f)), Status::kDuplicate);
  EXPECT_EQ(history.Add(PoseOf(kStart_ns - 1, 2.0f)), Status::kInvalidArgument);
  EXPECT_EQ(history.Add(PoseOf(0, 2.0f)), Status::kInvalidArgument);
  EXPECT_EQ(history.size(), 1);
  EXPECT_EQ(history.newest().position.x_m, 1.0f);
  EXPECT_EQ(history.Add(PoseOf(UINT64_MAX, 2.0f)), Status::kOk);
  StampedPose pose;
  EXPECT_EQ(history.At(UINT64_MAX, pose), Status::kOk);
  EXPECT_EQ(history.At(UINT64_MAX - 1, pose), Status::kNoPose);
}

TEST(PoseHistory, RefusesNumbersThatAreNone) {
  PoseHistory history;
  float StampedPose::*const angles[] = {&StampedPose::roll_rad, &StampedPose::pitch_rad,
                                        &StampedPose::yaw_rad};
  float Vec3::*const coordinates[] = {&Vec3::x_m, &Vec3::y_m, &Vec3::z_m};
  for (const float broken : {kNaN, kInfinity, -kInfinity}) {
    for (float StampedPose::*const angle : angles) {
      StampedPose pose = PoseOf(kStart_ns, 0.0f);
      pose.*angle = broken;
      EXPECT_EQ(history.Add(pose), Status::kNotFinite);
      EXPECT_FALSE(PoseHistory::Takes(pose));
    }
    for (float Vec3::*const coordinate : coordinates) {
      StampedPose pose = PoseOf(kStart_ns, 0.0f);
      pose.position.*coordinate = broken;
      EXPECT_EQ(history.Add(pose), Status::kNotFinite);
    }
  }
  for (const float sign : {-1.0f, 1.0f}) {
    for (float StampedPose::*const angle : angles) {
      StampedPose pose = PoseOf(kStart_ns, 0.0f);
      pose.*angle = sign * 8193.0f;
      EXPECT_EQ(history.Add(pose), Status::kInvalidArgument);
    }
    for (float Vec3::*const coordinate : coordinates) {
      StampedPose pose = PoseOf(kStart_ns, 0.0f);
      pose.position.*coordinate = sign * 838861.0f;
      EXPECT_EQ(history.Add(pose), Status::kInvalidArgument);
      EXPECT_FALSE(PoseHistory::Takes(pose));
    }
  }
  EXPECT_EQ(history.size(), 0);
}

TEST(PoseHistory, LetsTheOldestGiveWay) {
  PoseHistory history;
  for (uint64_t i = 0; i < 1000; ++i) {
    ASSERT_EQ(history.Add(PoseOf(kStart_ns + i * 10 * kMillisecond_ns, static_cast<float>(i))),
              Status::kOk);
    EXPECT_EQ(history.newest().position.x_m, static_cast<float>(i));
  }
  EXPECT_EQ(history.size(), PoseHistory::kCapacity);
  StampedPose pose;
  EXPECT_EQ(history.At(kStart_ns + 871 * 10 * kMillisecond_ns, pose), Status::kNoPose);
  ASSERT_EQ(history.At(kStart_ns + 872 * 10 * kMillisecond_ns, pose), Status::kOk);
  EXPECT_EQ(pose.position.x_m, 872.0f);
}

TEST(PoseHistory, ShiftsAllHeights) {
  PoseHistory history;
  for (uint64_t i = 0; i < 130; ++i) {
    ASSERT_EQ(history.Add(PoseOf(kStart_ns + i * 10 * kMillisecond_ns, 0.0f)), Status::kOk);
  }
  history.ShiftHeights(-2.5f);
  for (uint64_t i = 2; i < 131; ++i) {
    StampedPose pose;
    ASSERT_EQ(history.At(kStart_ns + i * 10 * kMillisecond_ns, pose), Status::kOk);
    ASSERT_EQ(pose.position.z_m, -2.5f);
  }
  StampedPose next = PoseOf(kStart_ns + 1300 * kMillisecond_ns, 0.0f);
  next.position.z_m = 1.0f;
  ASSERT_EQ(history.Add(next), Status::kOk);
  EXPECT_EQ(history.newest().position.z_m, 1.0f);
}

// Whatever is added, what comes out is finite.
TEST(PoseHistory, StandsExtremePoses) {
  const unsigned seed = 5u;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  const float values[] = {0.0f,      -0.0f,     1e-40f,   838860.0f, -838860.0f, 8192.0f,
                          -8192.0f,  3.1415f,   1e30f,    kNaN,      kInfinity,  -kInfinity,
                          8191.999f, 838861.0f, -3.1415f, 1.0f};
  const auto value = [&] { return values[random() % std::size(values)]; };
  PoseHistory history;
  uint64_t time_ns = 0;
  int known = 0;
  for (int i = 0; i < 200'000; ++i) {
    time_ns += random() >> (36 + random() % 28);
    StampedPose pose;
    pose.time_ns = time_ns;
    pose.position = {value(), value(), value()};
    pose.roll_rad = value();
    pose.pitch_rad = value();
    pose.yaw_rad = value();
    const Status added = history.Add(pose);
    ASSERT_EQ(added == Status::kOk || added == Status::kDuplicate,
              PoseHistory::Takes(pose) && history.newest().time_ns == time_ns);
    StampedPose found;
    if (history.At(time_ns - random() % 100'000'000u + 50'000'000u, found) != Status::kOk) continue;
    ++known;
    const Transform3 transform = TransformFrom(found);
    for (const float element : transform.rotation) ASSERT_TRUE(IsFinite(element));
    ASSERT_TRUE(IsFinite(found.position.x_m) && IsFinite(found.position.y_m) &&
                IsFinite(found.position.z_m));
  }
  EXPECT_GT(known, 100);
}

TEST(TransformFrom, LeadsFromTheBodyToTheOdometryFrame) {
  StampedPose pose = PoseOf(0, 10.0f, kHalfPi);
  pose.position.z_m = 2.0f;
  const Vec3 ahead = TransformFrom(pose).Apply({1.0f, 0.0f, 0.0f});
  EXPECT_NEAR(ahead.x_m, 10.0f, 1e-6f);
  EXPECT_NEAR(ahead.y_m, 1.0f, 1e-6f);
  EXPECT_NEAR(ahead.z_m, 2.0f, 1e-6f);
}

}  // namespace
}  // namespace hardpack
