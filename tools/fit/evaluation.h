// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "tools/fit/prediction.h"

// The errors of predictions against a recording. Only fresh samples count. A value is older than
// the sample in which it appears: a wheel speed by kWheelAge_s, a pose by an age that is fitted.

namespace hardpack::fit {

// Half of the 50 ms between samples. The delay of the vehicle's own reporting cannot be separated
// from its dead time, which therefore contains it.
inline constexpr double kWheelAge_s = 0.025;

// Two fresh poses, kWindow_s or slightly more apart: their difference gives a yaw rate.
inline constexpr double kWindow_s = 0.5;
struct PoseWindow {
  size_t from = 0;  // samples
  size_t to = 0;
};
std::vector<PoseWindow> WindowsOf(const DriveSegment& segment);

double YawRate_radps(const DriveSegment& segment, const PoseWindow& window);
double YawRate_radps(const Track& track, const DriveSegment& segment, const PoseWindow& window,
                     double pose_age_s);

// From one pose to another, in the axes of the first.
struct Displacement {
  double forward_m = 0.0;
  double left_m = 0.0;
  double turn_rad = 0.0;
};
Displacement DisplacementOf(const sim::Pose& from, const sim::Pose& to);
sim::Pose PoseOf(const DriveSample& sample);

// Of many errors.
struct Spread {
  double rms = 0.0;
  double median = 0.0;  // of the magnitudes, as the next
  double p95 = 0.0;
};
Spread SpreadOf(std::vector<double> errors);

// Errors at a time after the first fresh pose, with which the prediction is aligned.
struct HorizonErrors {
  double mean_s = 0.0;  // the actual time
  Spread position_m;
  Spread heading_rad;
  Spread yaw_rate_radps;  // of the last window of that time
};

struct Errors {
  int segments = 0;
  int windows = 0;
  double yaw_rate_rms_radps = 0.0;  // of all windows
  double wheel_rms_radps = 0.0;     // of all fresh samples
  HorizonErrors one_s;
  HorizonErrors two_s;  // at the end of a segment of 2 s: 1.9 s
};

using Predictor = std::function<void(const DriveSegment& segment, Track& track)>;

Errors Evaluate(const std::vector<DriveSegment>& segments, const Predictor& predict,
                double pose_age_s);

}  // namespace hardpack::fit
