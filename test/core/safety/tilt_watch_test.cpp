// SPDX-License-Identifier: Apache-2.0
#include "core/safety/tilt_watch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace hardpack {
namespace {

constexpr uint64_t kTiltTick_ns = 10'000'000;

struct Attitude {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

// The time at which it says that the body leans too far, in ticks of 10 ms for 5 s; -1: never.
double ToldAt_s(const std::function<Attitude(double t_s)>& body, const SafetyParams& limits = {}) {
  TiltWatch watch;
  uint64_t now_ns = 77'000'000'000;
  for (int tick = 0; tick < 500; ++tick, now_ns += kTiltTick_ns) {
    const double t_s = 0.01 * tick;
    const Attitude is = body(t_s);
    if (watch.Judge(limits, now_ns, static_cast<float>(is.roll_rad),
                    static_cast<float>(is.pitch_rad))) {
      return t_s;
    }
  }
  return -1.0;
}

// SR-TLT01: either way, roll and pitch, each by its own limit.
TEST(TiltWatch, TellsABodyThatLeansBeyondItsLimits) {
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(ToldAt_s([&](double) { return Attitude{side * 0.44, side * 0.49}; }), -1.0);
    EXPECT_NEAR(ToldAt_s([&](double) { return Attitude{side * 0.46, 0.0}; }), 0.05, 0.011);
    EXPECT_NEAR(ToldAt_s([&](double) { return Attitude{0.0, side * 0.51}; }), 0.05, 0.011);
  }
}

// SR-TLT01: before it leans so far, if it goes on as it did; but not by more than kMostAhead_rad.
TEST(TiltWatch, TellsABodyThatIsAboutToLeanTooFar) {
  const double told_s = ToldAt_s([](double t_s) { return Attitude{0.2 * t_s, 0.0}; });
  EXPECT_LT(told_s, 2.25 - 0.2);
  EXPECT_GT(told_s, 2.25 - 0.35);
  // A ramp of 20 degrees, up which it tips within 0.3 s.
  EXPECT_EQ(ToldAt_s([](double t_s) {
              return Attitude{0.0, 0.35 * std::fmin(t_s / 0.3, 1.0)};
            }),
            -1.0);
  EXPECT_GT(ToldAt_s([](double t_s) {
              return Attitude{0.0, 0.45 * std::fmin(t_s / 0.3, 1.0)};
            }),
            0.0);
}

// A stone under a wheel, and noise.
TEST(TiltWatch, DoesNotTellOfWhatIsOverInAMoment) {
  EXPECT_EQ(ToldAt_s([](double t_s) {
              const bool is_hit = std::fmod(t_s, 1.0) < 0.035;
              return Attitude{is_hit ? 0.6 : 0.0, 0.0};
            }),
            -1.0);
  EXPECT_EQ(ToldAt_s([](double t_s) {
              const double shakes = 0.03 * std::sin(60.0 * t_s);
              return Attitude{0.34 + shakes, 0.36 - shakes};
            }),
            -1.0);
}

TEST(TiltWatch, WithoutALimitOnlyWhatIsNoNumberIsTold) {
  SafetyParams limits;
  limits.max_roll_rad = limits.max_pitch_rad = 0.0f;
  EXPECT_EQ(ToldAt_s([](double t_s) { return Attitude{t_s, -t_s}; }, limits), -1.0);
  for (const double wild : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    EXPECT_GE(ToldAt_s(
                  [&](double t_s) {
                    return Attitude{t_s > 1.0 ? wild : 0.0, 0.0};
                  },
                  limits),
              1.0);
    EXPECT_GE(ToldAt_s([&](double t_s) { return Attitude{0.0, t_s > 1.0 ? wild : 0.0}; }), 1.0);
    EXPECT_GE(ToldAt_s([&](double t_s) { return Attitude{t_s < 0.5 ? wild : 0.0, 0.0}; }), 0.05);
  }
}

// SR-TLT01: once it stands level again it begins anew.
TEST(TiltWatch, EndsWithTheLean) {
  TiltWatch watch;
  uint64_t now_ns = 1'000'000'000;
  for (int tick = 0; tick < 30; ++tick) watch.Judge({}, now_ns += kTiltTick_ns, 0.6f, 0.0f);
  EXPECT_TRUE(watch.Judge({}, now_ns += kTiltTick_ns, 0.6f, 0.0f));
  for (int tick = 0; tick < 30; ++tick) watch.Judge({}, now_ns += kTiltTick_ns, 0.1f, 0.0f);
  EXPECT_FALSE(watch.Judge({}, now_ns += kTiltTick_ns, 0.1f, 0.0f));
}

}  // namespace
}  // namespace hardpack
