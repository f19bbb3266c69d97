// SPDX-License-Identifier: Apache-2.0
// The elementary functions and the conversions over every float there is, on all cores.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <thread>
#include <vector>

#include "core/base/math.h"
#include "core/base/saturate.h"
#include "gtest/gtest.h"
#include "test/core/base/exact_angles.h"

namespace hardpack {
namespace {

using exact::BitsOf;
using exact::FromBits;
using exact::Worst;

constexpr uint64_t kAllFloats = uint64_t{1} << 32;

// visit(float, worst) for each float with bits in [first, end); the worst of all.
template <typename Visit>
Worst OverBits(uint64_t first, uint64_t end, Visit visit) {
  const uint64_t threads = std::max(1u, std::thread::hardware_concurrency());
  std::vector<Worst> worst(threads);
  std::vector<std::thread> pool;
  for (uint64_t thread = 0; thread < threads; ++thread) {
    pool.emplace_back([=, &result = worst[thread]] {
      Worst own;  // not the shared array: its neighbours are other threads'
      for (uint64_t bits = first + thread; bits < end; bits += threads) {
        visit(FromBits(static_cast<uint32_t>(bits)), own);
      }
      result = own;
    });
  }
  for (std::thread& thread : pool) thread.join();
  Worst all;
  for (const Worst& one : worst) all.Take(one);
  return all;
}

void Report(const char* name, const Worst& worst) {
  testing::Test::RecordProperty(name, std::to_string(worst.error));
  std::printf("%s: largest error %.4e at %.9g\n", name, worst.error, static_cast<double>(worst.at));
}

// Negative angles give the same, as their symmetry is checked for each.
TEST(EveryFloat, SinCosIsWithinItsErrorAndSymmetric) {
  const Worst worst =
      OverBits(0, uint64_t{BitsOf(kSinCosMaxAngle_rad)} + 1, [](float angle_rad, Worst& own) {
        const SinCosPair there = SinCos(angle_rad);
        exact::TakeSinCos(angle_rad, there, own);
        const SinCosPair opposite = SinCos(-angle_rad);
        const bool symmetric = opposite.sin == -there.sin && opposite.cos == there.cos;
        own.Take(symmetric ? 0.0 : INFINITY, angle_rad);
      });
  Report("sin_cos", worst);
  EXPECT_LE(worst.error, kSinCosMaxError) << "at " << worst.at;
}

// With any other vector the quotient inside Atan2 is rounded, by at most 2^-25, which moves the
// angle by less than that. So the bound holds for the whole plane.
TEST(EveryFloat, Atan2OfARatioIsWithinItsErrorWithRoomForTheQuotients) {
  const Worst worst = OverBits(0, uint64_t{BitsOf(1.0f)} + 1, exact::TakeOctants);
  Report("atan2", worst);
  EXPECT_LE(worst.error, static_cast<double>(kAtan2MaxError_rad) - 0x1p-25) << "at " << worst.at;
}

TEST(EveryFloat, WrapAngleIsWithinItsErrorAndItsRange) {
  const Worst worst = OverBits(0, kAllFloats, [](float angle_rad, Worst& own) {
    const float wrapped = WrapAngle(angle_rad);
    if (!(wrapped > -kPi && wrapped <= kPi)) own.Take(INFINITY, angle_rad);
    if (angle_rad > -kPi && angle_rad <= kPi) {
      own.Take(BitsOf(wrapped) == BitsOf(angle_rad) ? 0.0 : INFINITY, angle_rad);
    } else if (std::abs(angle_rad) <= kSinCosMaxAngle_rad) {
      exact::TakeWrap(angle_rad, own);
    }
  });
  Report("wrap_angle", worst);
  EXPECT_LE(worst.error, kWrapAngleMaxError_rad) << "at " << worst.at;
}

int32_t Saturated(double value) {
  if (std::isnan(value)) return 0;
  return static_cast<int32_t>(std::clamp(value, -2147483648.0, 2147483647.0));
}

TEST(EveryFloat, ConversionsToIntegersAreThoseOfDouble) {
  const Worst worst = OverBits(0, kAllFloats, [](float value, Worst& own) {
    const double exact_value = static_cast<double>(value);
    const bool equal = FloorToInt(value) == Saturated(std::floor(exact_value)) &&
                       RoundToInt(value) == Saturated(std::round(exact_value));
    own.Take(equal ? 0.0 : INFINITY, value);
  });
  EXPECT_EQ(worst.error, 0.0) << "at " << worst.at;
}

}  // namespace
}  // namespace hardpack
