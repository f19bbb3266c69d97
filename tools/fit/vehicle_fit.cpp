// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/vehicle_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>

#include "tools/fit/least_squares.h"

namespace hardpack::fit {
namespace {

using sim::VehicleModelParams;
using P = VehicleModelParams;

// The fitted numbers, their bounds, and the step of each variable for differences.
struct Fitted {
  double P::*value;
  double low;
  double high;
  double step;
};
constexpr std::array<Fitted, 19> kFitted = {{
    {&P::dead_time_common_s, 0.0, 0.4, 0.004},
    {&P::dead_time_differential_s, 0.0, 0.4, 0.004},
    {&P::time_constant_common_s, 0.05, 2.0, 0.01},
    {&P::time_constant_differential_s, 0.05, 2.0, 0.01},
    {&P::slew_common_radps2, 5.0, 60.0, 0.3},
    {&P::slew_differential_radps2, 5.0, 60.0, 0.3},
    {&P::common_turn_loss, 0.0, 0.8, 0.01},
    {&P::scrub_radps, 0.0, 10.0, 0.02},
    {&P::scrub_width_radps, 0.05, 3.0, 0.02},
    {&P::integral_time_s, 0.3, 30.0, 0.1},
    {&P::differential_limit_radps, 4.0, 20.0, 0.05},
    {&P::differential_limit_slope, 0.0, 1.0, 0.01},
    {&P::ground_per_wheel, 0.8, 1.1, 0.003},
    {&P::turn_slip, 0.0, 0.8, 0.01},
    {&P::skid_baseline_m, 1.2, 2.6, 0.01},
    {&P::speed_time_constant_s, 0.0, 0.6, 0.01},
    {&P::yaw_time_constant_s, 0.0, 0.6, 0.01},
    {&P::turning_point_m, 0.0, 1.5, 0.01},
    {&P::turning_point_speed_mps, 0.05, 6.0, 0.03},
}};
constexpr Variable kPoseAge = {.start = 0.1, .low = -0.1, .high = 0.4, .step = 0.005};

// The uncertainty of the recording.
constexpr double kWheel_radps = 0.4;
constexpr double kYawRate_radps = 0.12;
constexpr double kSpeed_mps = 0.25;

double Tamed(double residual) {
  const double magnitude = std::sqrt(2.0 * (std::sqrt(1.0 + residual * residual) - 1.0));
  return std::copysign(magnitude, residual);
}

struct SegmentWindows {
  const DriveSegment* segment;
  std::vector<PoseWindow> windows;
};

void AddResiduals(const SegmentWindows& item, const Track& track, double pose_age_s,
                  std::vector<double>& residuals) {
  const DriveSegment& segment = *item.segment;
  for (const DriveSample& sample : segment.samples) {
    if (!sample.fresh_left && !sample.fresh_right) continue;
    const sim::WheelSpeeds told = track.At(sample.t_s - kWheelAge_s).wheels;
    if (sample.fresh_left) {
      residuals.push_back(Tamed((told.left_radps - sample.measured.left_radps) / kWheel_radps));
    }
    if (sample.fresh_right) {
      residuals.push_back(Tamed((told.right_radps - sample.measured.right_radps) / kWheel_radps));
    }
  }
  for (const PoseWindow& window : item.windows) {
    const DriveSample& from = segment.samples[window.from];
    const DriveSample& to = segment.samples[window.to];
    const double seconds = to.t_s - from.t_s;
    const Displacement seen = DisplacementOf(PoseOf(from), PoseOf(to));
    const Displacement told =
        DisplacementOf(track.At(from.t_s - pose_age_s).pose, track.At(to.t_s - pose_age_s).pose);
    const double speed_window = kSpeed_mps * seconds;
    residuals.push_back(Tamed((told.turn_rad - seen.turn_rad) / (kYawRate_radps * seconds)));
    residuals.push_back(Tamed((told.forward_m - seen.forward_m) / speed_window));
    residuals.push_back(Tamed((told.left_m - seen.left_m) / speed_window));
  }
}

VehicleFit FitOf(const std::vector<double>& x, const VehicleFit& start) {
  VehicleFit fit = start;
  for (size_t i = 0; i < kFitted.size(); ++i) fit.params.*kFitted[i].value = x[i];
  fit.pose_age_s = x[kFitted.size()];
  return fit;
}

// prior_share: the width of the prior about `start`, as a share of each number; 0: no prior.
VehicleFit Fit(const std::vector<DriveSegment>& segments, const VehicleFit& start,
               const FitSettings& settings, double prior_share) {
  std::vector<Variable> variables;
  variables.reserve(kFitted.size() + 1);
  for (const Fitted& fitted : kFitted) {
    variables.push_back({start.params.*fitted.value, fitted.low, fitted.high, fitted.step});
  }
  variables.push_back(kPoseAge);
  variables.back().start = start.pose_age_s;
  std::vector<SegmentWindows> items;
  items.reserve(segments.size());
  for (const DriveSegment& segment : segments) items.push_back({&segment, WindowsOf(segment)});
  Track track;
  const auto residuals_of = [&](const std::vector<double>& x, std::vector<double>& residuals) {
    const VehicleFit trial = FitOf(x, start);
    ModelPredictor predict(trial.params, settings.step_s);
    for (const SegmentWindows& item : items) {
      predict(*item.segment, track);
      AddResiduals(item, track, trial.pose_age_s, residuals);
    }
    if (prior_share <= 0.0) return;
    for (size_t i = 0; i < x.size(); ++i) {
      const double width = prior_share * std::abs(variables[i].start) + variables[i].step;
      residuals.push_back((x[i] - variables[i].start) / width);
    }
  };
  const LeastSquares found = Minimize(residuals_of, variables, settings.iterations);
  VehicleFit fit = FitOf(found.x, start);
  fit.cost = found.cost;
  fit.evaluations = found.evaluations;
  return fit;
}

// Segments are in order, so that those of a run are neighbours.
std::vector<std::vector<DriveSegment>> RunsOf(const std::vector<DriveSegment>& segments) {
  std::vector<std::vector<DriveSegment>> runs;
  for (const DriveSegment& segment : segments) {
    if (runs.empty() || runs.back().back().run() != segment.run()) runs.emplace_back();
    runs.back().push_back(segment);
  }
  return runs;
}

}  // namespace

VehicleFit FirstGuess() {
  VehicleFit guess;
  P& params = guess.params;
  params.dead_time_common_s = 0.15;
  params.dead_time_differential_s = 0.15;
  params.time_constant_common_s = 0.3;
  params.time_constant_differential_s = 0.5;
  params.slew_common_radps2 = 15.0;
  params.slew_differential_radps2 = 7.0;
  params.common_turn_loss = 0.1;
  params.scrub_radps = 3.0;
  params.scrub_width_radps = 1.0;
  params.integral_time_s = 1.5;
  params.differential_limit_radps = 7.5;
  params.differential_limit_slope = 0.1;
  params.ground_per_wheel = 0.95;
  params.turn_slip = 0.4;
  params.skid_baseline_m = 1.8;
  params.speed_time_constant_s = 0.2;
  params.yaw_time_constant_s = 0.2;
  params.turning_point_m = 0.6;
  params.turning_point_speed_mps = 1.5;
  return guess;
}

VehicleFit FitVehicle(const std::vector<DriveSegment>& segments, const VehicleFit& start,
                      const FitSettings& settings) {
  return Fit(segments, start, settings, 0.0);
}

Split SplitByRun(const std::vector<DriveSegment>& segments, double held_out_share, uint64_t seed) {
  const std::vector<std::vector<DriveSegment>> runs = RunsOf(segments);
  std::vector<size_t> order(runs.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937_64 random(seed);
  for (size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  const auto held_out =
      static_cast<size_t>(std::lround(held_out_share * static_cast<double>(runs.size())));
  std::vector<bool> is_held_out(runs.size(), false);
  for (size_t i = 0; i < std::min(held_out, order.size()); ++i) is_held_out[order[i]] = true;
  Split split;
  for (size_t i = 0; i < runs.size(); ++i) {
    std::vector<DriveSegment>& part = is_held_out[i] ? split.held_out : split.fit;
    part.insert(part.end(), runs[i].begin(), runs[i].end());
  }
  return split;
}

VehicleModelParams DeviationOverRuns(const std::vector<DriveSegment>& segments,
                                     const VehicleFit& whole, const FitSettings& settings) {
  constexpr double kPriorShare = 1.0 / 3.0;
  constexpr int kIterations = 8;
  FitSettings of_run = settings;
  of_run.iterations = std::min(settings.iterations, kIterations);
  std::vector<VehicleModelParams> fits;
  for (const std::vector<DriveSegment>& run : RunsOf(segments)) {
    fits.push_back(Fit(run, whole, of_run, kPriorShare).params);
  }
  VehicleModelParams deviation = sim::UncertainVehicle().deviation;
  if (fits.size() < 2) return deviation;
  const double count = static_cast<double>(fits.size());
  for (const Fitted& fitted : kFitted) {
    double mean = 0.0;
    for (const VehicleModelParams& params : fits) mean += params.*fitted.value / count;
    double squares = 0.0;
    for (const VehicleModelParams& params : fits) {
      squares += (params.*fitted.value - mean) * (params.*fitted.value - mean);
    }
    deviation.*fitted.value = std::sqrt(squares / (count - 1.0));
  }
  return deviation;
}

}  // namespace hardpack::fit
