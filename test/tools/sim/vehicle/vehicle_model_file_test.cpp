// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/vehicle_model_file.h"

#include <gtest/gtest.h>

#include <string>

namespace hardpack::sim {
namespace {

std::string Good() {
  UncertainVehicle vehicle;
  vehicle.typical.skid_baseline_m = 1.9;
  vehicle.deviation.skid_baseline_m = 0.1;
  return VehicleToToml(vehicle, "A vehicle.\nOf two lines.");
}

// The file with the line of one number replaced.
std::string With(const std::string& name, const std::string& line) {
  std::string text = Good();
  const size_t from = text.find("\n" + name + " = ") + 1;
  return text.replace(from, text.find('\n', from) - from, line);
}

// Reads it, expects it to fail, and gives what it said.
std::string Refused(const std::string& text, Status status) {
  UncertainVehicle vehicle;
  vehicle.typical.wheel_radius_m = 0.123;
  const ReadOutcome outcome = ParseVehicle(text, "v.toml", vehicle);
  EXPECT_EQ(outcome.status, status) << outcome.message;
  EXPECT_EQ(vehicle.typical.wheel_radius_m, 0.123) << "touched";
  return outcome.message;
}

TEST(VehicleFile, ReadsBackWhatWasWritten) {
  UncertainVehicle vehicle;
  uint64_t seed = 1;
  for (const VehicleParameter& parameter : VehicleParameters()) {
    vehicle.deviation.*parameter.value = 0.1 * (vehicle.typical.*parameter.value);
  }
  vehicle.typical = Draw(vehicle, seed);
  UncertainVehicle read;
  const ReadOutcome outcome = ParseVehicle(VehicleToToml(vehicle, ""), "v.toml", read);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  for (const VehicleParameter& parameter : VehicleParameters()) {
    EXPECT_EQ(read.typical.*parameter.value, vehicle.typical.*parameter.value) << parameter.name;
    EXPECT_EQ(read.deviation.*parameter.value, vehicle.deviation.*parameter.value);
  }
}

TEST(VehicleFile, TakesAPlainNumberAsExact) {
  UncertainVehicle read;
  ASSERT_TRUE(ParseVehicle(With("skid_baseline_m", "skid_baseline_m = 2"), "v.toml", read).ok());
  EXPECT_EQ(read.typical.skid_baseline_m, 2.0);
  EXPECT_EQ(read.deviation.skid_baseline_m, 0.0);
}

TEST(VehicleFile, RefusesAnUnknownKeyAndNamesTheNearest) {
  const std::string message =
      Refused(With("skid_baseline_m", "skid_base_line_m = 1.9"), Status::kInvalidArgument);
  EXPECT_NE(message.find("skid_base_line_m: unknown key, did you mean skid_baseline_m?"),
            std::string::npos);
  EXPECT_NE(message.find("v.toml: skid_baseline_m: must be set"), std::string::npos);
}

TEST(VehicleFile, RefusesWhatIsOutOfItsRange) {
  const std::string message =
      Refused(With("skid_baseline_m", "skid_baseline_m = 11.0"), Status::kParameterOutOfRange);
  EXPECT_NE(message.find("skid_baseline_m: 11.0 is not from 0.1 to 10.0"), std::string::npos);
  EXPECT_NE(message.find("v.toml:"), std::string::npos);
  (void)Refused(With("turn_slip", "turn_slip = { value = 0.2, deviation = -0.1 }"),
                Status::kParameterOutOfRange);
}

TEST(VehicleFile, RefusesWhatIsNoFiniteNumber) {
  (void)Refused(With("turn_slip", "turn_slip = nan"), Status::kNotFinite);
  (void)Refused(With("turn_slip", "turn_slip = { value = 0.2, deviation = inf }"),
                Status::kNotFinite);
  (void)Refused(With("turn_slip", "turn_slip = \"0.2\""), Status::kInvalidArgument);
  (void)Refused(With("turn_slip", "turn_slip = { deviation = 0.1 }"), Status::kInvalidArgument);
  (void)Refused(With("turn_slip", "turn_slip = { value = 0.1, spread = 0.1 }"),
                Status::kInvalidArgument);
}

TEST(VehicleFile, RefusesWhatIsNoVehicle) {
  (void)Refused("", Status::kInvalidArgument);
  (void)Refused("[vehicle_model", Status::kInvalidArgument);
  (void)Refused("vehicle_model = 1\n", Status::kInvalidArgument);
  (void)Refused(Good() + "\n[engine]\npower = 1\n", Status::kInvalidArgument);
  (void)Refused(Good() + "turn_slip = 0.2\n", Status::kInvalidArgument);  // twice
  (void)Refused(std::string(kMaxVehicleFileBytes + 1, '\n'), Status::kOversized);
}

TEST(VehicleFile, TellsAllProblemsAtOnce) {
  std::string text = With("turn_slip", "turn_slip = nan");
  text.replace(text.find("wheel_radius_m = "), 17, "wheel_radius_m = -");
  const std::string message = Refused(text, Status::kNotFinite);
  EXPECT_NE(message.find("turn_slip: is not a finite number"), std::string::npos);
  EXPECT_NE(message.find("wheel_radius_m: -0.3 is not"), std::string::npos);
}

TEST(VehicleFile, SaysWhenItCannotBeRead) {
  UncertainVehicle vehicle;
  const ReadOutcome outcome = ReadVehicle("/nonexistent/v.toml", vehicle);
  EXPECT_FALSE(outcome.ok());
  EXPECT_NE(outcome.message.find("/nonexistent/v.toml"), std::string::npos);
}

}  // namespace
}  // namespace hardpack::sim
