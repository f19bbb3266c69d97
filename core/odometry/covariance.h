// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

// The covariance of the odometry filter, kept as P = U D U^T: U unit upper triangular, D diagonal
// and positive. Single precision is enough for this form, and neither symmetry nor definiteness can
// be lost: P is not stored (docs/decisions/0018). Time update: Thornton's modified weighted
// Gram-Schmidt; measurement update: Bierman's, one number at a time (REFERENCES.md).

namespace hardpack {

// The filter's state, in this order.
enum OdometryState {
  kStateX = 0,       // [m] odom
  kStateY,           // [m] odom
  kStateYaw,         // [rad]
  kStateSpeed,       // [m/s] forward, along the vehicle
  kStateYawRate,     // [rad/s] about the vertical
  kStateGyroBias,    // [rad/s] measured less true
  kStateWheelScale,  // ground speed over rim speed
  kStateBaseline,    // [m] difference of the rim speeds over the yaw rate: turn slip
  kOdometryStates
};

using OdometryVector = float[kOdometryStates];

// How the errors of the pose follow from those of the previous state; everything else stays as it
// was:
//   x' = x + x_by_yaw yaw + x_by_speed v + x_by_rate w, y' alike, yaw' = yaw + yaw_by_rate w
struct OdometryTransition {
  float x_by_yaw = 0.0f;
  float x_by_speed = 0.0f;
  float x_by_rate = 0.0f;
  float y_by_yaw = 0.0f;
  float y_by_speed = 0.0f;
  float y_by_rate = 0.0f;
  float yaw_by_rate = 0.0f;
};

class Covariance {
 public:
  // Variances within these are kept; larger ones are reduced, smaller noise is raised. In between,
  // no operation leaves the range of a float.
  static constexpr float kMinVariance = 1.0e-14f;
  static constexpr float kMaxVariance = 1.0e6f;

  // Initialises independent errors with these standard deviations.
  void Reset(const OdometryVector& sigma);

  // P' = F P F^T + diag(noise). Precondition: finite, noise not negative. Constant cost: about 3000
  // multiplications.
  void Predict(const OdometryTransition& transition, const OdometryVector& noise);

  // h P h^T, the variance of h x: never negative.
  float VarianceOf(const OdometryVector& h) const;

  // A measurement of h x with this variance: P' = (I - k h) P, and the gain k. Precondition:
  // variance > 0. Constant cost: about 200 multiplications.
  void Update(const OdometryVector& h, float variance, OdometryVector& gain);

  // Adds spread spread^T times `variance`, with the innovation's variance: the error left by the
  // part of an optimal gain that was not applied. Precondition: variance >= 0. Constant cost.
  void Add(const OdometryVector& spread, float variance);

  // P(row, column).
  float At(int row, int column) const;

 private:
  void Orthogonalize();
  void Limit();

  float u_[kOdometryStates * kOdometryStates] = {};  // column-major; the diagonal is 1
  float d_[kOdometryStates] = {};
  // For Predict: [F U | I], row-major, and D next to the noise. Too large for a stack frame.
  float rows_[kOdometryStates * 2 * kOdometryStates] = {};
  float weights_[2 * kOdometryStates] = {};
};
static_assert(std::is_trivially_copyable_v<Covariance>);

}  // namespace hardpack
