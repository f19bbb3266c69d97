// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/mission.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "core/safety/supervisor.h"
#include "port_linux/hardpackctl/code_names.h"
#include "tools/sim/experiment/summary.h"
#include "tools/sim/vehicle/vehicle_model_file.h"

namespace hardpack::mission {
namespace {

using experiment::Outcome;
using experiment::RunResult;

// A short way on open ground, seen by few columns.
MissionSettings ShortMission(uint64_t seed = 1) {
  MissionSettings settings;
  EXPECT_TRUE(world::MakeScenario("open", seed, settings.scenario).ok());
  settings.scenario.goal = {6.0, 0.0};
  EXPECT_TRUE(sim::ReadBody(HARDPACK_VEHICLES "/warthog_paper.toml", settings.vehicle).ok());
  settings.seed = seed;
  settings.lidar_columns = 512;
  settings.limit_s = 20.0;
  return settings;
}

RunResult MissionOf(const MissionSettings& settings, MissionTrace* trace = nullptr) {
  RunResult result;
  const ReadOutcome outcome = RunMission(settings, result, trace);
  EXPECT_TRUE(outcome.ok()) << outcome.message;
  return result;
}

class LogFile : public ::testing::Test {
 protected:
  std::string path = ::testing::TempDir() + "mission_" + std::to_string(::getpid()) + ".pcap";
  ~LogFile() override { std::remove(path.c_str()); }
};

// The same with the vehicle of a configuration of config/.
MissionSettings ShortMissionOf(const std::string& configuration, const std::string& vehicle) {
  MissionSettings settings = ShortMission();
  const std::string folder = HARDPACK_VEHICLES "/..";
  const ReadOutcome read =
      ReadConfiguration(folder + "/" + configuration + ".toml", settings.configuration);
  EXPECT_TRUE(read.ok()) << read.message;
  EXPECT_TRUE(sim::ReadBody(folder + "/vehicles/" + vehicle + ".toml", settings.vehicle).ok());
  settings.vehicle_name = vehicle;
  return settings;
}

// SR-LOG01
TEST_F(LogFile, OfEachKindOfVehicleReplays) {
  for (const auto& [configuration, vehicle] : {std::pair{"twist_base", "warthog_paper"},
                                               {"ackermann", "ackermann"},
                                               {"warthog_velodyne", "warthog_paper"}}) {
    MissionSettings settings = ShortMissionOf(configuration, vehicle);
    settings.log = path;
    const RunResult result = MissionOf(settings);
    EXPECT_EQ(result.outcome, Outcome::kReached) << configuration << ": " << result.reason;
    EXPECT_NEAR(result.driven_m, 6.0, 1.0) << configuration;
    std::string difference;
    EXPECT_TRUE(ReplaysTheSame(path, result.decision_hash, difference).ok());
    EXPECT_EQ(difference, "") << configuration;
  }
}

TEST(Mission, StopsForTheFaultsOfAMotionController) {
  for (const char* fault :
       {"controller-silent on", "controller-deaf on", "controller-fault 2", "controller-refuses on",
        "controller-version 2", "controller-reboot", "controller-bad-crc on"}) {
    MissionSettings settings = ShortMissionOf("ackermann", "ackermann");
    settings.scenario.goal = {20.0, 0.0};
    settings.script = "at 3.0 " + std::string(fault) + "\n";
    const RunResult result = MissionOf(settings);
    EXPECT_EQ(result.outcome, Outcome::kFault) << fault << ": " << result.reason;
    EXPECT_EQ(result.reason, "drives") << fault;
    EXPECT_LT(result.time_s, 3.5) << fault;
  }
}

TEST(Mission, RefusesAVehicleThatItsConfigurationIsNotFor) {
  const MissionSettings skids = ShortMissionOf("ackermann", "warthog_paper");
  RunResult result;
  EXPECT_EQ(RunMission(skids, result, nullptr).status, Status::kInvalidArgument);
  const MissionSettings steers = ShortMissionOf("twist_base", "ackermann");
  const ReadOutcome outcome = RunMission(steers, result, nullptr);
  EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  EXPECT_NE(outcome.message.find("vehicle.kinematics = 1"), std::string::npos) << outcome.message;
}

// Labels name the columns of an Ouster.
TEST(Mission, RefusesLabelsWithAVelodyne) {
  MissionSettings settings = ShortMission();
  sim::ScriptedVehicleSettings vehicle;
  Configuration configuration;
  settings.configuration.vehicle_type = "warthog_velodyne";
  for (const auto& [name, model] :
       {std::pair{"vlp16", sim::LidarModel::kVlp16}, {"vlp32c", sim::LidarModel::kVlp32c}}) {
    settings.configuration.velodyne.model = name;
    settings.labels.reset();
    EXPECT_TRUE(DescribeMission(settings, vehicle, configuration).ok());
    EXPECT_EQ(vehicle.lidar.model, model);
    settings.labels = sim::LabelSettings{};
    const ReadOutcome outcome = DescribeMission(settings, vehicle, configuration);
    EXPECT_EQ(outcome.status, Status::kUnsupported);
    EXPECT_EQ(outcome.message, "--labels needs an Ouster");
  }
  settings.configuration.vehicle_type = "warthog";
  EXPECT_TRUE(DescribeMission(settings, vehicle, configuration).ok());
}

// SR-LOG01
TEST_F(LogFile, OfAMissionReplaysToItsDecisions) {
  MissionSettings settings = ShortMission();
  settings.log = path;
  MissionTrace trace;
  const RunResult result = MissionOf(settings, &trace);
  EXPECT_EQ(result.outcome, Outcome::kReached) << result.reason;
  EXPECT_TRUE(result.success);
  EXPECT_NEAR(result.driven_m, 6.0, 1.0);
  EXPECT_GT(result.max_speed_mps, 1.0);
  EXPECT_DOUBLE_EQ(result.clearance_m, world::Contact::kFar_m);
  EXPECT_GT(result.cross_track_m.count(), 100);
  EXPECT_GT(result.reaction_s.count(), 1000);
  ASSERT_FALSE(trace.plans.empty());
  ASSERT_GT(trace.samples.size(), 40u);
  EXPECT_NEAR(trace.samples.back().x_m, 6.0, 1.0);

  std::string difference;
  const ReadOutcome replayed = ReplaysTheSame(path, result.decision_hash, difference);
  EXPECT_TRUE(replayed.ok()) << replayed.message;
  EXPECT_EQ(difference, "");
  ASSERT_TRUE(ReplaysTheSame(path, result.decision_hash ^ 1, difference).ok());
  EXPECT_EQ(difference, "different decision hash");
}

TEST_F(LogFile, ThatCannotBeWrittenIsTold) {
  MissionSettings settings = ShortMission();
  settings.log = "/nowhere/run.pcap";
  RunResult result;
  const ReadOutcome outcome = RunMission(settings, result, nullptr);
  EXPECT_FALSE(outcome.ok());
  EXPECT_NE(outcome.message.find("/nowhere/run.pcap"), std::string::npos) << outcome.message;
}

TEST(Mission, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const RunResult once = MissionOf(ShortMission(2));
  EXPECT_EQ(experiment::ToJson(once), experiment::ToJson(MissionOf(ShortMission(2))));
  EXPECT_NE(once.decision_hash, MissionOf(ShortMission(3)).decision_hash);
}

TEST(Mission, TellsWhatTheScriptDoes) {
  MissionSettings settings = ShortMission();
  settings.script = "at 1.0 emcy left 0x3210 0x05 0x4581";
  const RunResult result = MissionOf(settings);
  EXPECT_EQ(result.outcome, Outcome::kFault);
  EXPECT_EQ(result.reason, "drives");
  EXPECT_EQ(result.reasons.at("drives"), 1);
  EXPECT_FALSE(result.success);
  EXPECT_LT(result.time_s, 2.0);
}

TEST(Mission, CountsHowOftenAReasonBegan) {
  MissionSettings settings = ShortMission();
  settings.scenario.goal = {30.0, 0.0};
  settings.script = "at 2.0 lidar off\nat 2.6 lidar on\n";
  const RunResult result = MissionOf(settings);
  EXPECT_EQ(result.reasons.at("lidar_old"), 1);
  EXPECT_EQ(result.reasons.count("none"), 0u);
  EXPECT_EQ(MissionOf(ShortMission()).reasons.count("lidar_old"), 0u);
}

// The table's list is of names: each of them has to be one that the status uses.
TEST(Mission, FaultAlarmsAreReasonsThatThereAre) {
  std::set<std::string> alarms;
  for (uint8_t code = 0; code < kStopReasons; ++code) {
    const std::string name = ctl::NameOf(control::FieldKind::kStopReason, code).name;
    if (experiment::IsFaultAlarm(name)) alarms.insert(name);
  }
  EXPECT_EQ(alarms.size(), 16u);
  for (const auto reason : {StopReason::kNone, StopReason::kOperator, StopReason::kObstacle,
                            StopReason::kPerson, StopReason::kNoWay, StopReason::kPlanOld}) {
    const auto code = static_cast<uint8_t>(reason);
    EXPECT_EQ(alarms.count(ctl::NameOf(control::FieldKind::kStopReason, code).name), 0u);
  }
}

// A log of 0.2 m is no obstacle to the planner, and one to the observer.
TEST(Mission, FindsThatTheVehicleStandsInSomething) {
  MissionSettings settings = ShortMission();
  settings.scenario.world.AddCylinder({3.0, 0.0}, 0.3, -0.5, 0.2,
                                      {world::Label::kLog, world::Matter::kSolid, 1.0});
  const RunResult result = MissionOf(settings);
  EXPECT_EQ(result.outcome, Outcome::kContact);
  EXPECT_DOUBLE_EQ(result.clearance_m, 0.0);
}

TEST(Mission, RefusesMethodsThatThereAreNot) {
  RunResult result;
  MissionSettings settings = ShortMission();
  settings.planner = "rrt";
  EXPECT_FALSE(RunMission(settings, result, nullptr).ok());
  settings = ShortMission();
  settings.tracker = "stanley";
  EXPECT_FALSE(RunMission(settings, result, nullptr).ok());
  settings = ShortMission();
  settings.script = "at 1 explode";
  EXPECT_FALSE(RunMission(settings, result, nullptr).ok());
}

}  // namespace
}  // namespace hardpack::mission
