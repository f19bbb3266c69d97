// SPDX-License-Identifier: Apache-2.0
#include "test/tools/fit/recorded_drive.h"

#include <gtest/gtest.h>

#include "tools/fit/fit_report.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::fit {
namespace {

constexpr double kPoseAge_s = 0.05;  // as docs/simulation.md has it
constexpr double kPromised_radps = 0.25;

const std::string kVehicles = std::string(HARDPACK_SOURCE) + "/config/vehicles/";

sim::UncertainVehicle Vehicle(const std::string& name) {
  sim::UncertainVehicle vehicle;
  const ReadOutcome outcome = sim::ReadVehicle(kVehicles + name, vehicle);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return vehicle;
}

std::vector<DriveSegment> Recorded() {
  std::vector<DriveSegment> segments;
  const ReadOutcome outcome = ReadDriveRecord(RecordedDrivePath(), segments);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return segments;
}

TEST(Vehicles, DifferInNothingButTheWheelLimit) {
  const sim::UncertainVehicle recorded = Vehicle("warthog_recorded.toml");
  const sim::UncertainVehicle paper = Vehicle("warthog_paper.toml");
  EXPECT_EQ(recorded.typical.wheel_limit_radps, kRecordedWheelLimit_radps);
  EXPECT_EQ(paper.typical.wheel_limit_radps, kPaperWheelLimit_radps);
  for (const sim::VehicleParameter& parameter : sim::VehicleParameters()) {
    if (parameter.value == &sim::VehicleModelParams::wheel_limit_radps) continue;
    EXPECT_EQ(recorded.typical.*parameter.value, paper.typical.*parameter.value);
    EXPECT_EQ(recorded.deviation.*parameter.value, paper.deviation.*parameter.value);
  }
}

TEST(Vehicles, ReachTheirSpeeds) {
  const auto settled_mps = [](const char* name) {
    sim::VehicleModel model(Vehicle(name).typical);
    for (int i = 0; i < 20'000; ++i) model.Step({.speeds = {18.0, 18.0}});
    return model.speed_mps();
  };
  EXPECT_NEAR(settled_mps("warthog_recorded.toml"), 3.82, 0.08);  // the fastest that was recorded
  EXPECT_NEAR(settled_mps("warthog_paper.toml"), 5.0, 0.1);
}

TEST(Vehicles, SpinAsRecorded) {
  sim::VehicleModel model(Vehicle("warthog_recorded.toml").typical);
  for (int i = 0; i < 6'000; ++i) model.Step({.speeds = {-13.4, 13.4}});
  EXPECT_NEAR(model.wheels().right_radps, 6.8, 0.5);
  EXPECT_GT(model.yaw_rate_radps(), 1.8);
  EXPECT_LT(model.yaw_rate_radps(), 2.5);
}

TEST(Vehicles, PredictWhatTheyWereNotFittedTo) {
  SKIP_WITHOUT_RECORDED_DRIVE();
  const std::vector<DriveSegment> held_out = SplitByRun(Recorded(), 0.3, 1).held_out;
  ASSERT_GT(held_out.size(), 50u);
  const sim::VehicleModelParams params = Vehicle("warthog_recorded.toml").typical;
  const Errors model = Evaluate(held_out, ModelPredictor(params, 0.001), kPoseAge_s);
  EXPECT_LE(model.yaw_rate_rms_radps, kPromised_radps);
  EXPECT_GT(model.windows, 700);
  const Errors published = Evaluate(
      held_out,
      [](const DriveSegment& segment, Track& track) {
        PredictFirstOrder({}, 1.6875, segment, 0.001, track);
      },
      kPoseAge_s);
  EXPECT_GT(published.yaw_rate_rms_radps, 2.0 * model.yaw_rate_rms_radps);
  EXPECT_GT(published.two_s.position_m.rms, 2.0 * model.two_s.position_m.rms);
}

TEST(VehicleFit, KeepsItsPromiseOnRunsItHasNotSeen) {
  SKIP_WITHOUT_RECORDED_DRIVE();
  const Split split = SplitByRun(Recorded(), 0.3, 3);
  const VehicleFit fit = FitVehicle(split.fit, FirstGuess(), {.step_s = 0.01, .iterations = 8});
  const Errors errors = Evaluate(split.held_out, ModelPredictor(fit.params, 0.005), fit.pose_age_s);
  EXPECT_LE(errors.yaw_rate_rms_radps, kPromised_radps);
}

}  // namespace
}  // namespace hardpack::fit
