// SPDX-License-Identifier: Apache-2.0
#include "core/base/pose.h"

#include <cmath>
#include <random>

#include "core/base/math.h"
#include "gtest/gtest.h"

namespace hardpack {
namespace {

void ExpectNear(const Vec3& actual, const Vec3& expected, float tolerance_m) {
  EXPECT_NEAR(actual.x_m, expected.x_m, tolerance_m);
  EXPECT_NEAR(actual.y_m, expected.y_m, tolerance_m);
  EXPECT_NEAR(actual.z_m, expected.z_m, tolerance_m);
}

//        ^ y
//        |   p = (1, 0) of the body
//        |   |
//        +---o-> body's x is odom's y: theta = pi/2, at (3, 0)
TEST(TransformFromPose, TurnsAndMovesInThePlane) {
  const Transform3 odom_from_body = TransformFromPose({3.0f, 0.0f, kHalfPi}, 0.5f);
  ExpectNear(odom_from_body.Apply({1.0f, 0.0f, 0.0f}), {3.0f, 1.0f, 0.5f}, 1e-6f);
  ExpectNear(odom_from_body.Apply({0.0f, 1.0f, 2.0f}), {2.0f, 0.0f, 2.5f}, 1e-6f);
}

TEST(TransformFromPose, OfTheOriginIsTheIdentity) {
  const Transform3 identity = TransformFromPose({}, 0.0f);
  const Vec3 point = identity.Apply({1.25f, -7.0f, 0.3f});
  EXPECT_EQ(point.x_m, 1.25f);
  EXPECT_EQ(point.y_m, -7.0f);
  EXPECT_EQ(point.z_m, 0.3f);
}

// x forward, y left, z up: nose down is a positive pitch, left side up a positive roll.
TEST(TransformFromRollPitchYaw, HasTheSignsOfABodyFrame) {
  const Transform3 rolled = TransformFromRollPitchYaw(kHalfPi, 0.0f, 0.0f, {});
  ExpectNear(rolled.Apply({0.0f, 1.0f, 0.0f}), {0.0f, 0.0f, 1.0f}, 1e-6f);
  const Transform3 pitched = TransformFromRollPitchYaw(0.0f, kHalfPi, 0.0f, {});
  ExpectNear(pitched.Apply({1.0f, 0.0f, 0.0f}), {0.0f, 0.0f, -1.0f}, 1e-6f);
  const Transform3 yawed = TransformFromRollPitchYaw(0.0f, 0.0f, kHalfPi, {});
  ExpectNear(yawed.Apply({1.0f, 0.0f, 0.0f}), {0.0f, 1.0f, 0.0f}, 1e-6f);
}

class RandomTransforms : public ::testing::Test {
 protected:
  static constexpr uint32_t kSeed = 17;

  float Between(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random_);
  }
  Vec3 Point() { return {Between(-50, 50), Between(-50, 50), Between(-5, 5)}; }
  Transform3 Next() {
    return TransformFromRollPitchYaw(Between(-kPi, kPi), Between(-kHalfPi, kHalfPi),
                                     Between(-kPi, kPi), Point());
  }

  std::mt19937 random_{kSeed};
};

// Rz(yaw) Ry(pitch) Rx(roll), turn by turn, in double.
TEST_F(RandomTransforms, AreTheThreeTurnsOneAfterTheOther) {
  for (int i = 0; i < 1000; ++i) {
    const float roll_rad = Between(-kPi, kPi);
    const float pitch_rad = Between(-kHalfPi, kHalfPi);
    const float yaw_rad = Between(-kPi, kPi);
    const Vec3 p = Point();
    double x = p.x_m, y = p.y_m, z = p.z_m;
    const auto turn = [](double angle_rad, double& a, double& b) {
      const double turned = std::cos(angle_rad) * a - std::sin(angle_rad) * b;
      b = std::sin(angle_rad) * a + std::cos(angle_rad) * b;
      a = turned;
    };
    turn(roll_rad, y, z);
    turn(pitch_rad, z, x);
    turn(yaw_rad, x, y);
    const Vec3 actual = TransformFromRollPitchYaw(roll_rad, pitch_rad, yaw_rad, {}).Apply(p);
    ASSERT_NEAR(actual.x_m, x, 1e-4) << "seed " << kSeed;
    ASSERT_NEAR(actual.y_m, y, 1e-4) << "seed " << kSeed;
    ASSERT_NEAR(actual.z_m, z, 1e-4) << "seed " << kSeed;
  }
}

TEST_F(RandomTransforms, AreOrthonormal) {
  for (int i = 0; i < 1000; ++i) {
    const Transform3 transform = Next();
    for (int row = 0; row < 3; ++row) {
      for (int other = 0; other < 3; ++other) {
        float dot = 0.0f;
        for (int k = 0; k < 3; ++k) {
          dot += transform.rotation[3 * row + k] * transform.rotation[3 * other + k];
        }
        ASSERT_NEAR(dot, row == other ? 1.0f : 0.0f, 2e-6f) << "seed " << kSeed;
      }
    }
  }
}

TEST_F(RandomTransforms, ComposeAsTheyApply) {
  for (int i = 0; i < 1000; ++i) {
    const Transform3 a = Next();
    const Transform3 b = Next();
    const Vec3 p = Point();
    ExpectNear((a * b).Apply(p), a.Apply(b.Apply(p)), 1e-4f);
    ASSERT_FALSE(HasFailure()) << "seed " << kSeed;
  }
}

TEST_F(RandomTransforms, KeepWhatTheyAreComposedWithTheIdentity) {
  const Transform3 transform = Next();
  for (const Transform3& same : {transform * Transform3{}, Transform3{} * transform}) {
    for (int k = 0; k < 9; ++k) EXPECT_EQ(same.rotation[k], transform.rotation[k]);
    EXPECT_EQ(same.translation.x_m, transform.translation.x_m);
    EXPECT_EQ(same.translation.y_m, transform.translation.y_m);
    EXPECT_EQ(same.translation.z_m, transform.translation.z_m);
  }
}

}  // namespace
}  // namespace hardpack
