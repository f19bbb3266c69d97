// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/prediction.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tools/sim/vehicle/exact_math.h"

namespace hardpack::fit {
namespace {

constexpr double kWheelRadius_m = 0.30;

size_t StepsOf(const DriveSegment& segment, double step_s) {
  return static_cast<size_t>(std::ceil(segment.samples.back().t_s / step_s - 1.0e-9));
}

// The sample whose setpoints hold at a time; `at` is the last one's, for the next call.
size_t SampleAt(const DriveSegment& segment, double t_s, size_t at) {
  while (at + 1 < segment.samples.size() && segment.samples[at + 1].t_s <= t_s + 1.0e-9) ++at;
  return at;
}

void MoveIdeally(double separation_m, double step_s, TrackPoint& point) {
  const double speed_mps = kWheelRadius_m * point.wheels.common_radps();
  const double yaw_rate_radps =
      2.0 * kWheelRadius_m * point.wheels.differential_radps() / separation_m;
  const sim::SinCosOf heading =
      sim::ExactSinCos(point.pose.theta_rad + 0.5 * yaw_rate_radps * step_s);
  point.pose.x_m += heading.cos * speed_mps * step_s;
  point.pose.y_m += heading.sin * speed_mps * step_s;
  point.pose.theta_rad += yaw_rate_radps * step_s;
}

// One side's fresh samples, joined by straight lines.
double Joined(const DriveSegment& segment, double age_s, double t_s, bool is_left) {
  const auto value_of = [is_left](const DriveSample& sample) {
    return is_left ? sample.measured.left_radps : sample.measured.right_radps;
  };
  double before_s = 0.0;
  double before_radps = value_of(segment.samples.front());
  for (size_t i = 1; i < segment.samples.size(); ++i) {
    const DriveSample& sample = segment.samples[i];
    if (!(is_left ? sample.fresh_left : sample.fresh_right)) continue;
    const double at_s = sample.t_s - age_s;
    if (at_s >= t_s) {
      const double share = at_s > before_s ? (t_s - before_s) / (at_s - before_s) : 1.0;
      return before_radps + (value_of(sample) - before_radps) * std::clamp(share, 0.0, 1.0);
    }
    before_s = at_s;
    before_radps = value_of(sample);
  }
  return before_radps;
}

}  // namespace

TrackPoint Track::At(double t_s) const {
  const double place = std::clamp(t_s / step_s, 0.0, static_cast<double>(points.size() - 1));
  const size_t before = std::min(static_cast<size_t>(place), points.size() - 1);
  const size_t after = std::min(before + 1, points.size() - 1);
  const double share = place - static_cast<double>(before);
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  const TrackPoint& a = points[before];
  const TrackPoint& b = points[after];
  return {{mix(a.wheels.left_radps, b.wheels.left_radps),
           mix(a.wheels.right_radps, b.wheels.right_radps)},
          {mix(a.pose.x_m, b.pose.x_m), mix(a.pose.y_m, b.pose.y_m),
           mix(a.pose.theta_rad, b.pose.theta_rad)}};
}

void ModelPredictor::operator()(const DriveSegment& segment, Track& track) {
  const size_t steps = StepsOf(segment, step_s_);
  track.step_s = step_s_;
  track.points.resize(steps + 1);
  sim::VehicleModel model(params_, {}, step_s_);
  const sim::WheelSpeeds& begin = segment.samples.front().measured;
  if (segment.has_history && segment.number == before_ + 1) {
    model.Settle(begin, segment.history, integral_radps_);
  } else {
    model.Settle(begin, segment.history);
  }
  track.points[0] = {model.wheels(), model.pose()};
  size_t at = 0;
  for (size_t i = 0; i < steps; ++i) {
    at = SampleAt(segment, static_cast<double>(i) * step_s_, at);
    model.Step({.speeds = segment.samples[at].command});
    track.points[i + 1] = {model.wheels(), model.pose()};
  }
  before_ = segment.number;
  integral_radps_ = model.integral_radps();
}

void PredictIdeal(double separation_m, const DriveSegment& segment, double step_s, Track& track) {
  const size_t steps = StepsOf(segment, step_s);
  track.step_s = step_s;
  track.points.resize(steps + 1);
  TrackPoint point;
  point.wheels = segment.samples.front().command;
  track.points[0] = point;
  size_t at = 0;
  for (size_t i = 0; i < steps; ++i) {
    at = SampleAt(segment, static_cast<double>(i) * step_s, at);
    point.wheels = segment.samples[at].command;
    MoveIdeally(separation_m, step_s, point);
    track.points[i + 1] = point;
  }
}

void PredictFirstOrder(const FirstOrderPowertrain& powertrain, double separation_m,
                       const DriveSegment& segment, double step_s, Track& track) {
  const size_t steps = StepsOf(segment, step_s);
  track.step_s = step_s;
  track.points.resize(steps + 1);
  sim::DelayLine left(powertrain.dead_time_left_s, step_s);
  sim::DelayLine right(powertrain.dead_time_right_s, step_s);
  left.Fill(segment.history.left_radps);
  right.Fill(segment.history.right_radps);
  TrackPoint point;
  point.wheels = segment.samples.front().measured;
  track.points[0] = point;
  size_t at = 0;
  for (size_t i = 0; i < steps; ++i) {
    at = SampleAt(segment, static_cast<double>(i) * step_s, at);
    const sim::WheelSpeeds& command = segment.samples[at].command;
    sim::WheelSpeeds& wheels = point.wheels;
    wheels.left_radps += (left.Step(command.left_radps) - wheels.left_radps) * step_s /
                         powertrain.time_constant_left_s;
    wheels.right_radps += (right.Step(command.right_radps) - wheels.right_radps) * step_s /
                          powertrain.time_constant_right_s;
    MoveIdeally(separation_m, step_s, point);
    track.points[i + 1] = point;
  }
}

void PredictFromWheels(const sim::VehicleModelParams& params, double wheel_age_s,
                       const DriveSegment& segment, double step_s, Track& track) {
  const size_t steps = StepsOf(segment, step_s);
  track.step_s = step_s;
  track.points.resize(steps + 1);
  sim::VehicleModel model(params, {}, step_s);
  model.Settle(segment.samples.front().measured, segment.history);
  track.points[0] = {model.wheels(), model.pose()};
  for (size_t i = 0; i < steps; ++i) {
    const double t_s = static_cast<double>(i + 1) * step_s;
    model.StepBody(
        {Joined(segment, wheel_age_s, t_s, true), Joined(segment, wheel_age_s, t_s, false)});
    track.points[i + 1] = {model.wheels(), model.pose()};
  }
}

}  // namespace hardpack::fit
