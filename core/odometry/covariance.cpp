// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/covariance.h"

#include "core/base/assert.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

// The only file that uses Eigen: short vectors of fixed size, so that all of its loops are unrolled
// and the order of every sum is that of the source. Products of matrices would differ with the
// instruction set (docs/decisions/0018). The other definitions are core/CMakeLists.txt's.
#if !defined(eigen_assert)
// NOLINTNEXTLINE(readability-identifier-naming): the name is Eigen's.
#define eigen_assert(expression) HP_ASSERT(expression)
#endif
#include <Eigen/Core>

namespace hardpack {
namespace {

constexpr int kStates = kOdometryStates;
constexpr int kTerms = 2 * kStates;

using Column = Eigen::Map<Eigen::Array<float, kStates, 1>>;
using ConstColumn = Eigen::Map<const Eigen::Array<float, kStates, 1>>;
using Terms = Eigen::Map<Eigen::Array<float, kTerms, 1>>;
using ConstTerms = Eigen::Map<const Eigen::Array<float, kTerms, 1>>;

// Functions of their own, so that an expression's temporaries are in a small frame without
// optimisation too.

// to += factor from, [kStates].
void AddScaled(float factor, const float* from, float* to) {
  Column(to) += factor * ConstColumn(from);
}

// to -= factor from, [kTerms].
void SubtractScaled(float factor, const float* from, float* to) {
  Terms(to) -= factor * ConstTerms(from);
}

// The sum of a b weights, [kTerms].
float Weighted(const float* a, const float* b, const float* weights) {
  return (ConstTerms(a) * ConstTerms(b) * ConstTerms(weights)).sum();
}

float Dot(const float* a, const float* b) {
  return (ConstColumn(a) * ConstColumn(b)).sum();
}

}  // namespace

void Covariance::Reset(const OdometryVector& sigma) {
  HP_LOOP_BOUND(kStates)
  for (int i = 0; i < kStates; ++i) {
    Column(u_ + i * kStates).setZero();
    u_[i * kStates + i] = 1.0f;
    d_[i] = Clamp(sigma[i] * sigma[i], kMinVariance, kMaxVariance);
  }
}

void Covariance::Predict(const OdometryTransition& transition, const OdometryVector& noise) {
  HP_LOOP_BOUND(kStates)
  for (int row = 0; row < kStates; ++row) {
    float* terms = rows_ + row * kTerms;
    Terms(terms).setZero();
    HP_LOOP_BOUND(kStates)
    for (int column = row; column < kStates; ++column) {
      terms[column] = u_[column * kStates + row];
    }
    terms[kStates + row] = 1.0f;
    weights_[row] = d_[row];
    weights_[kStates + row] = Clamp(noise[row], kMinVariance, kMaxVariance);
  }
  float* const x = rows_ + kStateX * kTerms;
  float* const y = rows_ + kStateY * kTerms;
  float* const yaw = rows_ + kStateYaw * kTerms;
  const float* const speed = rows_ + kStateSpeed * kTerms;
  const float* const rate = rows_ + kStateYawRate * kTerms;
  AddScaled(transition.x_by_yaw, yaw, x);
  AddScaled(transition.x_by_speed, speed, x);
  AddScaled(transition.x_by_rate, rate, x);
  AddScaled(transition.y_by_yaw, yaw, y);
  AddScaled(transition.y_by_speed, speed, y);
  AddScaled(transition.y_by_rate, rate, y);
  AddScaled(transition.yaw_by_rate, rate, yaw);
  Orthogonalize();
  Limit();
}

// Gram and Schmidt's procedure from the last row on: the rows' weighted products are P.
void Covariance::Orthogonalize() {
  HP_LOOP_BOUND(kStates)
  for (int j = kStates - 1; j >= 0; --j) {
    const float* last = rows_ + j * kTerms;
    // At least the noise: no later row has a term in its column.
    const float d = Weighted(last, last, weights_);
    d_[j] = d;
    HP_LOOP_BOUND(kStates)
    for (int i = 0; i < j; ++i) {
      float* row = rows_ + i * kTerms;
      const float u = Weighted(row, last, weights_) / d;
      u_[j * kStates + i] = u;
      SubtractScaled(u, last, row);
    }
  }
}

// Where a variance is too large, its row and column are made smaller: S P S with a diagonal S is a
// covariance as P is. (S U S^-1) (S D S) (S^-1 U^T S) is its form.
void Covariance::Limit() {
  HP_LOOP_BOUND(kStates)
  for (int i = 0; i < kStates; ++i) {
    const float variance = At(i, i);
    if (variance <= kMaxVariance) continue;
    const float scale = Sqrt(kMaxVariance / variance);
    HP_LOOP_BOUND(kStates)
    for (int j = i + 1; j < kStates; ++j) u_[j * kStates + i] *= scale;
    HP_LOOP_BOUND(kStates)
    for (int k = 0; k < i; ++k) u_[i * kStates + k] /= scale;
    d_[i] = Max(d_[i] * scale * scale, kMinVariance);
  }
}

float Covariance::VarianceOf(const OdometryVector& h) const {
  float variance = 0.0f;
  HP_LOOP_BOUND(kStates)
  for (int j = 0; j < kStates; ++j) {
    const float f = Dot(h, u_ + j * kStates);
    variance += f * f * d_[j];
  }
  return variance;
}

void Covariance::Update(const OdometryVector& h, float variance, OdometryVector& gain) {
  Column(gain).setZero();  // what it is times the last sum
  float sum = variance;
  HP_LOOP_BOUND(kStates)
  for (int j = 0; j < kStates; ++j) {
    float* column = u_ + j * kStates;
    const float f = Dot(h, column);
    const float v = d_[j] * f;
    const float before = sum;
    sum += f * v;
    d_[j] = Max(d_[j] * (before / sum), kMinVariance);
    const float p = -f / before;
    HP_LOOP_BOUND(kStates)
    for (int i = 0; i < j; ++i) {
      const float u = column[i];
      column[i] = u + gain[i] * p;
      gain[i] += u * v;
    }
    gain[j] = v;
  }
  HP_LOOP_BOUND(kStates)
  for (int i = 0; i < kStates; ++i) gain[i] /= sum;
}

// Agee and Turner's update of the factors by a vector.
void Covariance::Add(const OdometryVector& spread, float variance) {
  OdometryVector a = {};
  AddScaled(1.0f, spread, a);
  float c = variance;
  HP_LOOP_BOUND(kStates)
  for (int j = kStates - 1; j >= 0; --j) {
    const float s = a[j];
    const float d = Clamp(d_[j] + c * s * s, kMinVariance, kMaxVariance);
    const float b = c * s / d;
    c *= d_[j] / d;
    d_[j] = d;
    HP_LOOP_BOUND(kStates)
    for (int i = 0; i < j; ++i) {
      a[i] -= s * u_[j * kStates + i];
      u_[j * kStates + i] += b * a[i];
    }
  }
}

float Covariance::At(int row, int column) const {
  float sum = 0.0f;
  HP_LOOP_BOUND(kStates)
  for (int j = 0; j < kStates; ++j) {
    sum += u_[j * kStates + row] * u_[j * kStates + column] * d_[j];
  }
  return sum;
}

}  // namespace hardpack
