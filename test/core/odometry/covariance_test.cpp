// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/covariance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// Against the textbook's formulas in double precision, and under input of any size.

namespace hardpack {
namespace {

constexpr int kN = kOdometryStates;

struct Dense {
  double p[kN][kN] = {};

  void Predict(const OdometryTransition& t, const OdometryVector& noise) {
    double f[kN][kN] = {};
    for (int i = 0; i < kN; ++i) f[i][i] = 1.0;
    f[0][2] = t.x_by_yaw;
    f[0][3] = t.x_by_speed;
    f[0][4] = t.x_by_rate;
    f[1][2] = t.y_by_yaw;
    f[1][3] = t.y_by_speed;
    f[1][4] = t.y_by_rate;
    f[2][4] = t.yaw_by_rate;
    double fp[kN][kN] = {};
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j < kN; ++j) {
        for (int k = 0; k < kN; ++k) fp[i][j] += f[i][k] * p[k][j];
      }
    }
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j < kN; ++j) {
        p[i][j] = i == j ? noise[i] : 0.0;
        for (int k = 0; k < kN; ++k) p[i][j] += fp[i][k] * f[j][k];
      }
    }
  }

  void Update(const OdometryVector& h, double r, double (&gain)[kN]) {
    double ph[kN] = {};
    double s = r;
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j < kN; ++j) ph[i] += p[i][j] * h[j];
    }
    for (int i = 0; i < kN; ++i) s += h[i] * ph[i];
    for (int i = 0; i < kN; ++i) gain[i] = ph[i] / s;
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j < kN; ++j) p[i][j] -= ph[i] * ph[j] / s;
    }
  }
};

// Smallest eigenvalue of the correlations, by Jacobi's rotations in double precision.
double SmallestEigenvalue(const Covariance& covariance) {
  double c[kN][kN];
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      c[i][j] = covariance.At(i, j) / std::sqrt(static_cast<double>(covariance.At(i, i)) *
                                                static_cast<double>(covariance.At(j, j)));
    }
  }
  for (int sweep = 0; sweep < 8; ++sweep) {
    for (int p = 0; p < kN; ++p) {
      for (int q = p + 1; q < kN; ++q) {
        if (std::fabs(c[p][q]) < 1e-15) continue;
        const double angle = 0.5 * std::atan2(2.0 * c[p][q], c[q][q] - c[p][p]);
        const double cos = std::cos(angle);
        const double sin = std::sin(angle);
        for (int k = 0; k < kN; ++k) {
          const double a = c[k][p];
          const double b = c[k][q];
          c[k][p] = cos * a - sin * b;
          c[k][q] = sin * a + cos * b;
        }
        for (int k = 0; k < kN; ++k) {
          const double a = c[p][k];
          const double b = c[q][k];
          c[p][k] = cos * a - sin * b;
          c[q][k] = sin * a + cos * b;
        }
      }
    }
  }
  double smallest = c[0][0];
  for (int i = 1; i < kN; ++i) smallest = std::min(smallest, c[i][i]);
  return smallest;
}

TEST(Covariance, DoesWhatTheTextbookDoes) {
  const OdometryVector sigma = {0.1f, 0.2f, 0.05f, 1.0f, 0.5f, 0.01f, 0.05f, 0.3f};
  Covariance covariance;
  covariance.Reset(sigma);
  Dense dense;
  for (int i = 0; i < kN; ++i) dense.p[i][i] = static_cast<double>(sigma[i]) * sigma[i];
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (int step = 0; step < 200; ++step) {
    const OdometryTransition t = {unit(random), 0.1f * unit(random), 0.1f * unit(random),
                                  unit(random), 0.1f * unit(random), 0.1f * unit(random),
                                  0.1f};
    const OdometryVector noise = {1e-4f, 1e-4f, 1e-5f, 1e-2f, 1e-2f, 1e-9f, 1e-6f, 1e-5f};
    covariance.Predict(t, noise);
    dense.Predict(t, noise);
    OdometryVector h;
    for (float& value : h) value = unit(random);
    double expected_variance = 0.0;
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j < kN; ++j) expected_variance += h[i] * dense.p[i][j] * h[j];
    }
    ASSERT_NEAR(covariance.VarianceOf(h), expected_variance, 1e-3 * expected_variance);
    OdometryVector gain;
    double expected_gain[kN];
    covariance.Update(h, 0.02f, gain);
    dense.Update(h, 0.02, expected_gain);
    for (int i = 0; i < kN; ++i) {
      ASSERT_NEAR(gain[i], expected_gain[i], 2e-3) << "step " << step << " state " << i;
      const double tolerance = 3e-3 * dense.p[i][i];
      ASSERT_NEAR(covariance.At(i, i), dense.p[i][i], tolerance) << "step " << step << " " << i;
    }
  }
}

// A gain that is not applied to some states: P' = (I - k h) P (I - k h)^T + k r k^T.
TEST(Covariance, KnowsOfTheGainThatWasNotApplied) {
  Covariance covariance;
  covariance.Reset({0.1f, 0.2f, 0.05f, 1.0f, 0.5f, 0.01f, 0.05f, 0.3f});
  covariance.Predict({0.5f, 0.9f, -0.2f, 0.7f, 0.4f, 0.3f, 0.2f}, {});
  double before[kN][kN];
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) before[i][j] = covariance.At(i, j);
  }
  const OdometryVector h = {0.0f, 0.0f, 0.0f, 1.0f, 0.5f, 1.0f, 0.3f, -0.2f};
  const float r = 0.3f;
  OdometryVector gain;
  const float innovation = covariance.VarianceOf(h) + r;
  covariance.Update(h, r, gain);
  covariance.Add({gain[0], gain[1], gain[2], 0.0f, 0.0f, 0.0f, gain[6], gain[7]}, innovation);
  ASSERT_GT(std::fabs(gain[0]), 0.1f);
  ASSERT_GT(std::fabs(gain[7]), 0.01f);
  for (const int i : {0, 1, 2, 6, 7}) gain[i] = 0.0f;
  double left[kN][kN] = {};
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      for (int k = 0; k < kN; ++k) {
        left[i][j] += ((i == k ? 1.0 : 0.0) - static_cast<double>(gain[i]) * h[k]) * before[k][j];
      }
    }
  }
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      double expected = static_cast<double>(gain[i]) * r * gain[j];
      for (int k = 0; k < kN; ++k) {
        expected += left[i][k] * ((j == k ? 1.0 : 0.0) - static_cast<double>(gain[j]) * h[k]);
      }
      EXPECT_NEAR(covariance.At(i, j), expected, 1e-5) << i << " " << j;
    }
  }
}

// 1e5 steps of any size that is allowed, and measurements from nearly exact to useless.
// SR-ODO05
TEST(Covariance, StaysSymmetricAndPositiveWhateverComes) {
  constexpr uint32_t kSeed = 20250209;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  const auto power = [&](float low, float high) {
    return std::pow(10.0f, low + (high - low) * (unit(random) + 1.0f) / 2.0f);
  };
  Covariance covariance;
  covariance.Reset({0.001f, 0.001f, 0.001f, 5.0f, 3.0f, 0.01f, 0.05f, 0.3f});
  for (int step = 0; step < 100'000; ++step) {
    if (step % 3 != 2) {
      const float way = power(-4.0f, 1.0f);
      OdometryVector noise;
      for (float& value : noise) value = unit(random) < 0.0f ? 0.0f : power(-14.0f, 2.0f);
      covariance.Predict({way * unit(random), unit(random), way * unit(random), way * unit(random),
                          unit(random), way * unit(random), unit(random)},
                         noise);
    } else {
      OdometryVector h;
      for (float& value : h) value = unit(random) < 0.0f ? 0.0f : power(-2.0f, 2.0f);
      OdometryVector gain;
      const float variance = power(-10.0f, 6.0f);
      const float innovation = covariance.VarianceOf(h) + variance;
      covariance.Update(h, variance, gain);
      if (step % 2 == 0)
        covariance.Add({gain[0], gain[1], gain[2], 0.0f, 0.0f, gain[5]}, innovation);
      for (const float value : gain) ASSERT_TRUE(std::isfinite(value)) << "step " << step;
    }
    for (int i = 0; i < kN; ++i) {
      const float variance = covariance.At(i, i);
      ASSERT_TRUE(std::isfinite(variance)) << "step " << step << " state " << i;
      ASSERT_GT(variance, 0.0f) << "step " << step << " state " << i;
      ASSERT_LE(variance, 1.001f * Covariance::kMaxVariance) << "step " << step << " state " << i;
      for (int j = 0; j < i; ++j) {
        ASSERT_EQ(covariance.At(i, j), covariance.At(j, i)) << "step " << step;
        const double limit = static_cast<double>(variance) * covariance.At(j, j);
        ASSERT_LE(std::pow(static_cast<double>(covariance.At(i, j)), 2.0), 1.00001 * limit)
            << "step " << step << " states " << i << " " << j;
      }
    }
    if (step % 10 == 0) {
      // The numbers that At gives are rounded: 64 of them, to eight digits of 1 each.
      ASSERT_GT(SmallestEigenvalue(covariance), -4e-6) << "step " << step;
    }
  }
}

// S P S, with the diagonal S that brings each variance down: the correlations stay.
// SR-ODO05
TEST(Covariance, BringsDownWhatIsTooLargeAndKeepsItsCorrelations) {
  const OdometryVector sigma = {3000.0f, 2000.0f, 1500.0f, 900.0f,
                                1200.0f, 10.0f,   4000.0f, 1100.0f};
  const OdometryTransition step = {0.3f, 0.8f, -0.2f, -0.4f, 0.1f, 0.5f, 0.6f};
  const OdometryVector noise = {3e5f, 2e5f, 1e5f, 4e5f, 5e5f, 1.0f, 6e5f, 7e5f};
  Covariance covariance;
  covariance.Reset(sigma);
  Dense expected;
  for (int i = 0; i < kN; ++i) expected.p[i][i] = covariance.At(i, i);
  covariance.Predict(step, noise);
  expected.Predict(step, noise);
  double scale[kN];
  int scaled = 0;
  for (int i = 0; i < kN; ++i) {
    const double variance = expected.p[i][i];
    scale[i] = variance > Covariance::kMaxVariance
                   ? std::sqrt(double{Covariance::kMaxVariance} / variance)
                   : 1.0;
    scaled += scale[i] < 1.0 ? 1 : 0;
  }
  ASSERT_GE(scaled, 4);
  ASSERT_LT(scaled, kN);
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j < kN; ++j) {
      const double wanted = scale[i] * expected.p[i][j] * scale[j];
      EXPECT_NEAR(covariance.At(i, j), wanted, 1e-5 * Covariance::kMaxVariance) << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace hardpack
