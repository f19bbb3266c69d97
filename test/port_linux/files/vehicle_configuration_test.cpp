// SPDX-License-Identifier: Apache-2.0
// What a configuration has to say by which vehicle it is for.
#include <string>

#include "gtest/gtest.h"
#include "port_linux/files/configuration.h"
#include "test/port_linux/files/configuration_texts.h"

namespace hardpack {
namespace {

std::string MessageOf(const std::string& text) {
  Configuration configuration;
  return ParseConfiguration(text, "f", configuration).message;
}

TEST(VehicleConfiguration, AsksOnlyForWhatTheVehicleHas) {
  const std::string sources =
      "lidar.address = \"10.0.0.2\"\nins = { address = \"10.0.0.3\", port = 5000 }\n";
  const std::string metadata = "lidar.metadata = \"os1.json\"\n";
  const std::string drives = "drive = { gear_ratio = 24.5, left_sign = 1, right_sign = -1 }\n";
  EXPECT_EQ(MessageOf("vehicle.type = \"twist_base\"\n" + sources + metadata), "");
  EXPECT_NE(MessageOf("vehicle.type = \"twist_base\"\n" + sources).find("lidar.metadata"),
            std::string::npos);
  EXPECT_EQ(MessageOf("vehicle.type = \"warthog_velodyne\"\n" + sources + drives), "");
  EXPECT_NE(MessageOf("vehicle.type = \"warthog_velodyne\"\n" + sources).find("drive.gear_ratio"),
            std::string::npos);
}

TEST(VehicleConfiguration, RefusesAVelodyneThatThereIsNot) {
  EXPECT_EQ(MessageOf(kRequiredLines + "velodyne.model = \"hdl64\"\n"),
            "f:7: velodyne.model: must be vlp16 or vlp32c, not \"hdl64\"");
  EXPECT_EQ(MessageOf(kRequiredLines + "velodyne.returns = \"all\"\n"),
            "f:7: velodyne.returns: must be strongest, last or dual, not \"all\"");
  EXPECT_EQ(MessageOf(kRequiredLines + "velodyne.rpm = 610\n"),
            "f:7: velodyne.rpm: must be a multiple of 60, not 610");
}

TEST(VehicleConfiguration, RefusesAMotionControllerThatDoesNotFitTheVehicle) {
  EXPECT_NE(MessageOf(kRequiredLines + "twist_drive.turn = 1\n").find("vehicle.kinematics"),
            std::string::npos);
  EXPECT_EQ(MessageOf(kRequiredLines + "twist_drive.turn = 1\nvehicle.kinematics = 1\n"), "");
  EXPECT_NE(
      MessageOf(kRequiredLines + "twist_drive.status_id = 0x210\n").find("twist_drive.command_id"),
      std::string::npos);
}

TEST(VehicleConfiguration, OfEachVehicleOfTheProjectIsRead) {
  for (const char* name : {"twist_base", "ackermann", "warthog_velodyne"}) {
    Configuration configuration;
    const ReadOutcome outcome = ReadConfiguration(
        std::string(HARDPACK_SOURCE_DIR) + "/config/" + name + ".toml", configuration);
    EXPECT_TRUE(outcome.ok()) << outcome.message;
  }
}

}  // namespace
}  // namespace hardpack
