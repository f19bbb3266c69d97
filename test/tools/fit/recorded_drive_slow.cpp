// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "test/tools/fit/recorded_drive.h"
#include "tools/fit/fit_report.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::fit {
namespace {

// config/vehicles/warthog_recorded.toml is what the command that stands in it writes.
TEST(Vehicles, AreWhatTheFitGives) {
  SKIP_WITHOUT_RECORDED_DRIVE();
  std::vector<DriveSegment> segments;
  ASSERT_TRUE(ReadDriveRecord(RecordedDrivePath(), segments).ok());
  const FitReport report = MakeFitReport(segments, "warthog_drive_20hz.csv", 0.3, 1, {});
  EXPECT_LE(report.contenders.front().errors.yaw_rate_rms_radps, 0.25);
  const sim::UncertainVehicle fitted = FittedVehicle(report, kRecordedWheelLimit_radps);
  sim::UncertainVehicle kept;
  const ReadOutcome outcome = sim::ReadVehicle(
      std::string(HARDPACK_SOURCE) + "/config/vehicles/warthog_recorded.toml", kept);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  for (const sim::VehicleParameter& parameter : sim::VehicleParameters()) {
    // Another libm may end the search a little elsewhere.
    const double tolerance = 0.02 * std::abs(fitted.typical.*parameter.value) + 1.0e-3;
    EXPECT_NEAR(kept.typical.*parameter.value, fitted.typical.*parameter.value, tolerance)
        << parameter.name;
    EXPECT_NEAR(kept.deviation.*parameter.value, fitted.deviation.*parameter.value,
                0.1 * fitted.deviation.*parameter.value + 1.0e-3)
        << parameter.name;
  }
}

}  // namespace
}  // namespace hardpack::fit
