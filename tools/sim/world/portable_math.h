// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

// Math for the simulation that gives the same bits on every processor: double-precision +, -, *, /
// and sqrt, which are correctly rounded everywhere, in a fixed order, with no fused operations.
// libm's sines and logarithms differ between machines, and so would the packets of a simulated
// sensor. core/base/math.h is the same in single precision.

namespace hardpack::world {

inline constexpr double kPi = 3.14159265358979323846;

struct Vector {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
};

struct Turn {
  double cos = 1.0;
  double sin = 0.0;
};

// Absolute error below 1e-15 for |angle_rad| <= 1e5; angles beyond, and NaN, count as 0.
Turn TurnOf(double angle_rad);

// Natural logarithm of a positive number; relative error below 1e-15 away from 1.
double Log(double value);

// In (-pi, pi]. |angle_rad| <= 1e6.
double Wrapped(double angle_rad);

// Angle of the vector (x, y), in [-pi, pi]; error below 1e-6: core's, in single precision.
double Angle(double y, double x);

// Rz(yaw) Ry(pitch) Rx(roll), row-major.
struct Rotation {
  double m[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

  static Rotation FromAngles(double roll_rad, double pitch_rad, double yaw_rad);
  Vector Apply(const Vector& v) const {
    return {m[0] * v.x_m + m[1] * v.y_m + m[2] * v.z_m, m[3] * v.x_m + m[4] * v.y_m + m[5] * v.z_m,
            m[6] * v.x_m + m[7] * v.y_m + m[8] * v.z_m};
  }
};

// Counter-based random numbers: a draw depends only on its key and not on earlier draws, so a
// sensor that skips a ray draws the same for the next one.
enum class Stream : uint32_t {
  kWorld = 1,
  kRange = 2,
  kDropOut = 3,
  kFoliage = 4,
  kLabel = 5,
  kIns = 6,
  kRain = 7,
  kDust = 8,
  kHead = 9,
};

constexpr uint64_t Mixed(uint64_t value) {  // the finalizer of SplitMix64 (REFERENCES.md)
  value += 0x9e3779b97f4a7c15u;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}
constexpr uint64_t KeyOf(uint64_t seed, Stream stream) {
  return Mixed(Mixed(seed) ^ static_cast<uint64_t>(stream));
}
constexpr uint64_t DrawBits(uint64_t key, uint64_t index) {
  return Mixed(key ^ Mixed(index));
}
// In [0, 1).
constexpr double DrawUniform(uint64_t key, uint64_t index) {
  return static_cast<double>(DrawBits(key, index) >> 11) * 0x1.0p-53;
}
// Mean 0, standard deviation 1, near normal: the sum of four numbers of 16 bits, so never beyond
// 3.47.
double DrawNormal(uint64_t key, uint64_t index);

// The same, in sequence: for things built once. Do not draw twice in the arguments of one call or
// the operands of one operator: their order of evaluation is unspecified (in braces it is left to
// right).
class Draws {
 public:
  explicit Draws(uint64_t seed, uint64_t part = 0)
      : key_(Mixed(KeyOf(seed, Stream::kWorld) ^ part)) {}
  double Uniform(double low, double high) {
    return low + (high - low) * DrawUniform(key_, next_++);
  }
  double Sign() { return (DrawBits(key_, next_++) & 1u) != 0 ? 1.0 : -1.0; }
  // From low to high, or from -high to -low.
  double UniformOnEitherSide(double low, double high) {
    const double sign = Sign();
    return sign * Uniform(low, high);
  }

 private:
  uint64_t key_;
  uint64_t next_ = 0;
};

}  // namespace hardpack::world
