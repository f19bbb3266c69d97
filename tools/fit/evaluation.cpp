// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/evaluation.h"

#include <algorithm>
#include <cmath>

namespace hardpack::fit {
namespace {

constexpr double kNearly_s = 1.0e-6;

double RootMeanSquare(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double error : errors) sum += error * error;
  return errors.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

double Elapsed_s(const DriveSegment& segment, const PoseWindow& window) {
  return segment.samples[window.to].t_s - segment.samples[window.from].t_s;
}

// From the first fresh pose to the fresh one nearest to `horizon_s` later; {0, 0}: no such poses.
PoseWindow HorizonOf(const DriveSegment& segment, double horizon_s) {
  PoseWindow window;
  for (size_t i = 0; i < segment.samples.size(); ++i) {
    if (!segment.samples[i].fresh_pose) continue;
    if (window.from == 0) window.from = i;
    const PoseWindow other = {window.from, i};
    const bool is_nearer = window.to == 0 || std::abs(Elapsed_s(segment, other) - horizon_s) <
                                                 std::abs(Elapsed_s(segment, window) - horizon_s);
    if (is_nearer) window.to = i;
  }
  return window;
}

struct HorizonSamples {
  double sum_s = 0.0;
  std::vector<double> position_m;
  std::vector<double> heading_rad;
  std::vector<double> yaw_rate_radps;

  void Take(const DriveSegment& segment, const Track& track, double horizon_s, double pose_age_s);
  HorizonErrors Summary() const;
};

void HorizonSamples::Take(const DriveSegment& segment, const Track& track, double horizon_s,
                          double pose_age_s) {
  const PoseWindow window = HorizonOf(segment, horizon_s);
  if (window.to <= window.from) return;
  const DriveSample& from = segment.samples[window.from];
  const DriveSample& to = segment.samples[window.to];
  const Displacement seen = DisplacementOf(PoseOf(from), PoseOf(to));
  const Displacement told =
      DisplacementOf(track.At(from.t_s - pose_age_s).pose, track.At(to.t_s - pose_age_s).pose);
  const double forward_m = told.forward_m - seen.forward_m;
  const double left_m = told.left_m - seen.left_m;
  sum_s += Elapsed_s(segment, window);
  position_m.push_back(std::sqrt(forward_m * forward_m + left_m * left_m));
  heading_rad.push_back(told.turn_rad - seen.turn_rad);
  PoseWindow last;
  for (const PoseWindow& other : WindowsOf(segment)) {
    if (other.to <= window.to) last = other;
  }
  if (last.to <= last.from) return;
  yaw_rate_radps.push_back(YawRate_radps(track, segment, last, pose_age_s) -
                           YawRate_radps(segment, last));
}

HorizonErrors HorizonSamples::Summary() const {
  const double count = static_cast<double>(std::max<size_t>(position_m.size(), 1));
  return {sum_s / count, SpreadOf(position_m), SpreadOf(heading_rad), SpreadOf(yaw_rate_radps)};
}

}  // namespace

std::vector<PoseWindow> WindowsOf(const DriveSegment& segment) {
  std::vector<PoseWindow> windows;
  for (size_t from = 0; from < segment.samples.size(); ++from) {
    if (!segment.samples[from].fresh_pose) continue;
    for (size_t to = from + 1; to < segment.samples.size(); ++to) {
      const PoseWindow window = {from, to};
      if (!segment.samples[to].fresh_pose) continue;
      if (Elapsed_s(segment, window) < kWindow_s - kNearly_s) continue;
      windows.push_back(window);
      break;
    }
  }
  return windows;
}

double YawRate_radps(const DriveSegment& segment, const PoseWindow& window) {
  return (segment.samples[window.to].yaw_rad - segment.samples[window.from].yaw_rad) /
         Elapsed_s(segment, window);
}

double YawRate_radps(const Track& track, const DriveSegment& segment, const PoseWindow& window,
                     double pose_age_s) {
  const double from_s = segment.samples[window.from].t_s - pose_age_s;
  const double to_s = segment.samples[window.to].t_s - pose_age_s;
  return (track.At(to_s).pose.theta_rad - track.At(from_s).pose.theta_rad) /
         Elapsed_s(segment, window);
}

sim::Pose PoseOf(const DriveSample& sample) {
  return {sample.x_m, sample.y_m, sample.yaw_rad};
}

Displacement DisplacementOf(const sim::Pose& from, const sim::Pose& to) {
  const double x_m = to.x_m - from.x_m;
  const double y_m = to.y_m - from.y_m;
  const double cosine = std::cos(from.theta_rad);
  const double sine = std::sin(from.theta_rad);
  return {cosine * x_m + sine * y_m, cosine * y_m - sine * x_m, to.theta_rad - from.theta_rad};
}

Spread SpreadOf(std::vector<double> errors) {
  if (errors.empty()) return {};
  Spread spread;
  spread.rms = RootMeanSquare(errors);
  for (double& error : errors) error = std::abs(error);
  std::sort(errors.begin(), errors.end());
  spread.median = errors[errors.size() / 2];
  spread.p95 = errors[std::min(errors.size() * 95 / 100, errors.size() - 1)];
  return spread;
}

Errors Evaluate(const std::vector<DriveSegment>& segments, const Predictor& predict,
                double pose_age_s) {
  Errors errors;
  Track track;
  std::vector<double> rates_radps;
  std::vector<double> wheels_radps;
  HorizonSamples one_s;
  HorizonSamples two_s;
  for (const DriveSegment& segment : segments) {
    predict(segment, track);
    for (const PoseWindow& window : WindowsOf(segment)) {
      rates_radps.push_back(YawRate_radps(track, segment, window, pose_age_s) -
                            YawRate_radps(segment, window));
    }
    for (const DriveSample& sample : segment.samples) {
      const sim::WheelSpeeds told = track.At(sample.t_s - kWheelAge_s).wheels;
      if (sample.fresh_left) wheels_radps.push_back(told.left_radps - sample.measured.left_radps);
      if (sample.fresh_right) {
        wheels_radps.push_back(told.right_radps - sample.measured.right_radps);
      }
    }
    one_s.Take(segment, track, 1.0, pose_age_s);
    two_s.Take(segment, track, 2.0, pose_age_s);
    ++errors.segments;
  }
  errors.windows = static_cast<int>(rates_radps.size());
  errors.yaw_rate_rms_radps = RootMeanSquare(rates_radps);
  errors.wheel_rms_radps = RootMeanSquare(wheels_radps);
  errors.one_s = one_s.Summary();
  errors.two_s = two_s.Summary();
  return errors;
}

}  // namespace hardpack::fit
