// SPDX-License-Identifier: Apache-2.0
#include "tools/fit/vehicle_fit.h"

#include <gtest/gtest.h>

#include "test/tools/fit/made_drive.h"

namespace hardpack::fit {
namespace {

std::vector<DriveSegment> Made(const sim::VehicleModelParams& params, const MadeDrive& settings) {
  std::vector<DriveSegment> segments;
  const ReadOutcome outcome =
      ParseDriveRecord(MakeDriveCsv(params, settings), "made.csv", segments);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return segments;
}

TEST(MadeDrive, HoldsTheWheelsAtFourHertz) {
  const std::vector<DriveSegment> segments = Made({}, {});
  ASSERT_EQ(segments.size(), 48u);
  const DriveSegment& first = segments.front();
  ASSERT_EQ(first.samples.size(), 40u);
  int fresh = 0;
  for (const DriveSample& sample : first.samples) fresh += sample.fresh_left ? 1 : 0;
  EXPECT_LE(fresh, 8);
  EXPECT_GE(fresh, 6);
  EXPECT_FALSE(first.has_history);
  EXPECT_TRUE(segments[1].has_history);
}

// Another vehicle than that where the search begins, and than the default one.
sim::VehicleModelParams Other() {
  sim::VehicleModelParams params;
  params.dead_time_common_s = 0.10;
  params.dead_time_differential_s = 0.20;
  params.time_constant_common_s = 0.40;
  params.time_constant_differential_s = 0.35;
  params.slew_common_radps2 = 18.0;
  params.slew_differential_radps2 = 9.0;
  params.common_turn_loss = 0.05;
  params.scrub_radps = 2.0;
  params.scrub_width_radps = 0.8;
  params.integral_time_s = 2.0;
  params.differential_limit_radps = 8.5;
  params.differential_limit_slope = 0.2;
  params.ground_per_wheel = 0.90;
  params.turn_slip = 0.25;
  params.skid_baseline_m = 1.6;
  params.speed_time_constant_s = 0.15;
  params.yaw_time_constant_s = 0.10;
  params.turning_point_m = 0.4;
  params.turning_point_speed_mps = 1.0;
  return params;
}

TEST(VehicleFit, FindsTheNumbersThatMadeTheDrive) {
  const MadeDrive settings = {.runs = 12,
                              .seed = 3,
                              .wheel_noise_radps = 0.05,
                              .position_noise_m = 0.005,
                              .yaw_noise_rad = 0.003};
  const std::vector<DriveSegment> segments = Made(Other(), settings);
  const VehicleFit fit = FitVehicle(segments, FirstGuess(), {.step_s = 0.005, .iterations = 30});
  const sim::VehicleModelParams truth = Other();
  const auto near = [&](double sim::VehicleModelParams::*value, double tolerance) {
    for (const sim::VehicleParameter& parameter : sim::VehicleParameters()) {
      if (parameter.value != value) continue;
      EXPECT_NEAR(fit.params.*value, truth.*value, tolerance) << parameter.name;
    }
  };
  near(&sim::VehicleModelParams::dead_time_common_s, 0.02);
  near(&sim::VehicleModelParams::dead_time_differential_s, 0.02);
  near(&sim::VehicleModelParams::time_constant_common_s, 0.02);
  near(&sim::VehicleModelParams::time_constant_differential_s, 0.05);
  near(&sim::VehicleModelParams::slew_common_radps2, 0.9);
  near(&sim::VehicleModelParams::slew_differential_radps2, 0.5);
  near(&sim::VehicleModelParams::common_turn_loss, 0.02);
  near(&sim::VehicleModelParams::scrub_radps, 0.2);
  near(&sim::VehicleModelParams::integral_time_s, 0.3);
  near(&sim::VehicleModelParams::differential_limit_radps, 0.3);
  near(&sim::VehicleModelParams::differential_limit_slope, 0.05);
  near(&sim::VehicleModelParams::ground_per_wheel, 0.01);
  near(&sim::VehicleModelParams::turn_slip, 0.03);
  near(&sim::VehicleModelParams::skid_baseline_m, 0.03);
  near(&sim::VehicleModelParams::speed_time_constant_s, 0.04);
  near(&sim::VehicleModelParams::yaw_time_constant_s, 0.04);
  near(&sim::VehicleModelParams::turning_point_m, 0.05);
  EXPECT_NEAR(fit.pose_age_s, settings.pose_age_s, 0.03);
  EXPECT_EQ(fit.params.wheel_radius_m, FirstGuess().params.wheel_radius_m);  // not fitted
}

TEST(VehicleFit, PredictsItsOwnVehicleWithoutError) {
  const std::vector<DriveSegment> segments = Made(Other(), {.runs = 2});
  const Errors errors =
      Evaluate(segments, ModelPredictor(Other(), sim::VehicleModel::kStep_s), 0.05);
  // But for where a segment begins: wheel speeds up to 0.25 s old, and an unknown integral.
  EXPECT_LT(errors.yaw_rate_rms_radps, 0.08);
  EXPECT_LT(errors.one_s.position_m.rms, 0.15);
  const Errors wrong = Evaluate(
      segments,
      [](const DriveSegment& segment, Track& track) { PredictIdeal(1.6, segment, 0.001, track); },
      0.05);
  EXPECT_GT(wrong.yaw_rate_rms_radps, 0.5);
}

TEST(VehicleFit, DeviationsTellVehiclesThatDifferFromRunToRun) {
  std::vector<DriveSegment> same = Made(Other(), {.runs = 4, .wheel_noise_radps = 0.02});
  const VehicleFit whole = {.params = Other(), .pose_age_s = 0.05};
  const FitSettings settings = {.step_s = 0.01, .iterations = 6};
  const sim::VehicleModelParams none = DeviationOverRuns(same, whole, settings);
  std::vector<DriveSegment> differing;
  for (int run = 0; run < 4; ++run) {
    sim::VehicleModelParams params = Other();
    params.skid_baseline_m = 1.3 + 0.2 * run;
    std::vector<DriveSegment> one =
        Made(params, {.runs = 1, .seed = static_cast<uint64_t>(run + 1)});
    for (DriveSegment& segment : one) {
      segment.number += 10 * run;
      differing.push_back(segment);
    }
  }
  const sim::VehicleModelParams some = DeviationOverRuns(differing, whole, settings);
  EXPECT_LT(none.skid_baseline_m, 0.05);
  EXPECT_NEAR(some.skid_baseline_m, 0.258, 0.06);  // of 1.3, 1.5, 1.7, 1.9
  EXPECT_EQ(some.wheel_radius_m, 0.0);
}

}  // namespace
}  // namespace hardpack::fit
