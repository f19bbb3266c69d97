// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cstdint>

#include "core/base/grid.h"
#include "core/base/math.h"
#include "core/base/pose.h"
#include "core/base/saturate.h"
#include "test/decision/random.h"
#include "test/decision/report.h"

// Elementary functions over sweeps that include the ends of their ranges and any bit pattern.

namespace hardpack::decision {
namespace {

void AddPair(const SinCosPair& pair, DecisionHash& hash) {
  hash.AddFloat(pair.sin);
  hash.AddFloat(pair.cos);
}

DecisionHash Angles() {
  DecisionHash hash;
  for (int i = -6000; i <= 6000; ++i) {
    const float angle_rad = static_cast<float>(i) * 0.0137f;
    AddPair(SinCos(angle_rad), hash);
    hash.AddFloat(WrapAngle(angle_rad));
  }
  return hash;
}

DecisionHash Vectors() {
  DecisionHash hash;
  Random random(0x5eed0001u);
  for (int i = 0; i < 6000; ++i) {
    const float x = random.RealBetween(-50.0f, 50.0f);
    const float y = random.RealBetween(-50.0f, 50.0f);
    hash.AddFloat(Atan2(y, x));
    hash.AddFloat(Sqrt(x * x + y * y));
    hash.AddI32(FloorToInt(x * y));
    hash.AddI32(RoundToInt(x / (y + 100.0f)));
  }
  return hash;
}

// Subnormals, infinities and NaN included: what comes back is a number.
DecisionHash AnyBits() {
  DecisionHash hash;
  Random random(0x5eed0002u);
  for (int i = 0; i < 6000; ++i) {
    const float a = std::bit_cast<float>(random.Next());
    const float b = std::bit_cast<float>(random.Next());
    AddPair(SinCos(a), hash);
    hash.AddFloat(Atan2(a, b));
    hash.AddFloat(WrapAngle(a));
    hash.AddI32(FloorToInt(a));
    hash.AddI32(RoundToInt(b));
    const float root = Sqrt(a);
    hash.AddU8(IsFinite(root));
    if (IsFinite(root)) hash.AddFloat(root);
  }
  return hash;
}

DecisionHash Transforms() {
  DecisionHash hash;
  Random random(0x5eed0003u);
  Transform3 chain;
  for (int i = 0; i < 500; ++i) {
    const float roll_rad = random.RealBetween(-0.3f, 0.3f);
    const float pitch_rad = random.RealBetween(-0.3f, 0.3f);
    const float yaw_rad = random.RealBetween(-3.2f, 3.2f);
    chain = TransformFromRollPitchYaw(roll_rad, pitch_rad, yaw_rad, {0.1f, -0.2f, 0.3f}) * chain;
    const Vec3 point = chain.Apply({1.0f, 2.0f, 3.0f});
    hash.AddFloat(point.x_m);
    hash.AddFloat(point.y_m);
    hash.AddFloat(point.z_m);
    const Cell cell = CellAt({point.x_m, point.y_m});
    hash.AddI32(cell.x);
    hash.AddI32(cell.y);
    hash.AddFloat(CellCenter(cell).x_m);
  }
  return hash;
}

}  // namespace

void RunBase(Report& report) {
  report.Add("base.angles", Angles());
  report.Add("base.vectors", Vectors());
  report.Add("base.any_bits", AnyBits());
  report.Add("base.transforms", Transforms());
}

}  // namespace hardpack::decision
