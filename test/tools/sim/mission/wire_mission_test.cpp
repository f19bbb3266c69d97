// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/wire_mission.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "port_linux/files/ouster_metadata.h"
#include "tools/sim/mission/observer.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::mission {
namespace {

using experiment::Outcome;
using experiment::RunResult;

class WireMission : public ::testing::Test {
 protected:
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("wire_" + std::to_string(::getpid()));
  WireMissionSettings settings;

  void SetUp() override {
    std::filesystem::create_directory(folder);
    MissionSettings& mission = settings.mission;
    ASSERT_TRUE(world::MakeScenario("open", 1, mission.scenario).ok());
    ASSERT_TRUE(sim::ReadBody(HARDPACK_VEHICLES "/warthog_paper.toml", mission.vehicle).ok());
    mission.lidar_columns = 512;
    // Any port: several tests may run at a time.
    settings.wire.lidar_from = settings.wire.ins_from = "127.0.0.1:0";
    settings.control = folder / "control.sock";
    settings.wait_s = 0.0;
  }
  ~WireMission() override { std::filesystem::remove_all(folder); }

  ReadOutcome Run() {
    RunResult result;
    WireReport report;
    return RunWireMission(settings, result, nullptr, report);
  }
};

TEST_F(WireMission, SaysThatThereIsNoHardpackd) {
  const ReadOutcome outcome = Run();
  EXPECT_EQ(outcome.status, Status::kAborted);
  EXPECT_NE(outcome.message.find(settings.control), std::string::npos) << outcome.message;
}

TEST_F(WireMission, RefusesACanInterfaceThatThereIsNot) {
  settings.wire.can = "nocan7";
  const ReadOutcome outcome = Run();
  EXPECT_EQ(outcome.status, Status::kSystemError);
  EXPECT_NE(outcome.message.find("nocan7"), std::string::npos) << outcome.message;
}

TEST_F(WireMission, WritesWhatHardpackdHasToKnowOfTheVehicle) {
  settings.write_configuration = folder / "hardpackd.toml";
  settings.lidar_port = 17001;
  settings.ins_port = 17002;
  settings.mission.tracker = "pursuit";
  EXPECT_EQ(Run().status, Status::kAborted);
  Configuration read;
  const ReadOutcome outcome = ReadConfiguration(settings.write_configuration, read);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  const sim::VehicleSettings vehicle = sim::DefaultVehicle();
  EXPECT_EQ(read.onboard.drive.left_sign, vehicle.left.sign);
  EXPECT_EQ(read.onboard.drive.right_sign, vehicle.right.sign);
  EXPECT_EQ(read.onboard.drive.gear_ratio, static_cast<float>(vehicle.left.gear_ratio));
  EXPECT_EQ(read.onboard.tracking.method, TrackingParams::kPurePursuit);
  EXPECT_EQ(read.lidar.port, 17001);
  EXPECT_EQ(read.ins.port, 17002);
  EXPECT_EQ(read.control.socket, settings.control);
  EXPECT_EQ(read.log.directory, folder / "flight");
  const auto metadata = std::make_unique<ouster::Metadata>();
  const ReadOutcome lidar = ouster::ReadMetadata(read.lidar.metadata, *metadata);
  ASSERT_TRUE(lidar.ok()) << lidar.message;
  EXPECT_EQ(metadata->columns_per_frame, 512);
}

TEST_F(WireMission, SaysWhereItsConfigurationCannotBeWritten) {
  settings.write_configuration = folder / "nowhere" / "hardpackd.toml";
  const ReadOutcome outcome = Run();
  EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  EXPECT_NE(outcome.message.find("hardpackd.toml"), std::string::npos) << outcome.message;
}

// A vehicle that is not brought to rest by the end of its mission.
TEST(Observer, CountsContactOnTheWayToRest) {
  sim::ScriptedVehicleSettings settings;
  settings.lidar.columns = 512;
  sim::ScriptedVehicle vehicle(settings, {}, 1'000'000'000);
  RunResult result;
  MissionTrace trace;
  const world::Scenario scenario;
  Observer observer(scenario, result, &trace, 0.0);
  Moment now;
  now.vehicle = &vehicle;
  now.mode = Mode::kFault;
  now.reason = StopReason::kDrives;
  now.time_s = 0.01;
  observer.Watch(now);
  ASSERT_TRUE(observer.ended());
  EXPECT_EQ(result.outcome, Outcome::kFault);
  observer.WatchRest(now);
  EXPECT_EQ(result.outcome, Outcome::kFault);
  vehicle.world().AddCylinder({0.5, 0.0}, 0.3, -0.5, 1.0,
                              {world::Label::kLog, world::Matter::kSolid, 1.0});
  now.time_s = 0.02;
  observer.WatchRest(now);
  observer.WatchRest(now);
  EXPECT_EQ(result.outcome, Outcome::kContact);
  EXPECT_EQ(result.reason, "drives");
  ASSERT_EQ(trace.events.size(), 2u);
  EXPECT_EQ(trace.events[1].text, "touched");
}

// What only who looks into the loop sees is left out.
TEST(Observer, DoesWithoutTheInsideOfTheLoop) {
  sim::ScriptedVehicleSettings settings;
  settings.lidar.columns = 512;
  sim::ScriptedVehicle vehicle(settings, {}, 1'000'000'000);
  RunResult result;
  MissionTrace trace;
  const world::Scenario scenario;
  Observer observer(scenario, result, &trace, 0.0);
  Moment now;
  now.vehicle = &vehicle;
  now.mode = Mode::kDriving;
  for (const uint32_t plan : {1u, 2u, 2u, 0u, 3u}) {
    now.plan = plan;
    now.time_s += 0.01;
    observer.Watch(now);
  }
  EXPECT_EQ(result.replans, 1);
  EXPECT_TRUE(trace.plans.empty());
  EXPECT_EQ(result.cross_track_m.count(), 0);
}

}  // namespace
}  // namespace hardpack::mission
