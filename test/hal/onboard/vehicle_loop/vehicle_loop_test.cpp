// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/vehicle_loop/vehicle_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <ostream>
#include <random>
#include <span>

#include "hal/onboard/vehicle_loop/any_vehicle.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"

namespace hardpack {
namespace {

using control::GoalFrame;
using control::Kind;
using testing::ClosedLoop;

TEST(VehicleLoop, BringsUpDrivesArmsDrivesStraightAndStopsAtTheGoal) {
  ClosedLoop drive;
  drive.DriveTo(15.0f, 0.0f);
  double cross_track_m = 0.0;
  ASSERT_TRUE(drive.Until(30.0, [&] {
    cross_track_m = std::max(cross_track_m, std::fabs(drive.Pose().y_m));
    return drive.mode() == Mode::kArmed;
  }));
  EXPECT_LT(cross_track_m, 0.15);
  // Nothing was lost on the way, and each column of a packet is filed once there is a pose for it.
  const Mapper& mapper = drive.loop().mapper();
  EXPECT_GT(mapper.ring().counters().columns, 10'000u);
  EXPECT_LT(mapper.counters().columns_without_pose, 100u);
  EXPECT_LE(mapper.ring().counters().missing_columns, mapper.counters().columns_without_pose);
  EXPECT_NEAR(drive.Pose().x_m, 15.0, 0.6);
  EXPECT_FALSE(drive.vehicle().collided());
  EXPECT_EQ(drive.loop().goals(), 0);
  drive.Ticks(100);
  EXPECT_NEAR(drive.Speed_mps(), 0.0, 0.02);
  EXPECT_EQ(drive.mode(), Mode::kArmed);
  EXPECT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  EXPECT_TRUE(drive.Until(3.0, [&] { return !drive.loop().drives().enabled(); }));
  EXPECT_EQ(drive.mode(), Mode::kStandby);
}

TEST(VehicleLoop, TurnsToAGoalBesideIt) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(0.0f, 2.5f, GoalFrame::kBody), Status::kOk);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  ASSERT_TRUE(drive.Until(40.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 0.0, 0.7);
  EXPECT_NEAR(drive.Pose().y_m, 2.5, 0.7);
}

TEST(VehicleLoop, GoesAroundWhatStandsInTheWay) {
  //      start ------> [box] ------> goal
  ClosedLoop drive("at 0 box 8 0 1.5 1.5");
  drive.BringUpAndArm();
  ASSERT_EQ(drive.Goal(18.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  ASSERT_TRUE(drive.Until(60.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 18.0, 0.7);
  EXPECT_FALSE(drive.vehicle().collided());
}

TEST(VehicleLoop, DrivesWaypointsInTurn) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 2;
  command.waypoint[0].position_m = {7.0f, 1.0f};
  command.waypoint[1].position_m = {14.0f, 0.0f};
  ASSERT_EQ(drive.Say(command), Status::kOk);
  EXPECT_EQ(drive.loop().goals(), 2);
  ASSERT_TRUE(drive.Until(40.0, [&] { return drive.loop().goal_index() == 1; }));
  EXPECT_NEAR(drive.Pose().x_m, 6.0, 1.5);
  ASSERT_TRUE(drive.Until(40.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 14.0, 0.6);
  EXPECT_EQ(drive.loop().goals(), 0);
  EXPECT_EQ(drive.loop().goal_index(), 0) << "the next one begins at its first waypoint";
}

// The simulated INS tells latitude and longitude of the place where the vehicle really is.
TEST(VehicleLoop, DrivesToALatitudeAndLongitude) {
  ClosedLoop drive;
  drive.BringUpAndArm();
  ASSERT_TRUE(drive.loop().newest_ins().has_position);
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 1;
  command.waypoint[0].frame = GoalFrame::kGeodetic;
  // 10 m ahead of the vehicle, in the direction in which the INS says that it looks.
  const InsSample& ins = drive.loop().newest_ins();
  const double latitude = static_cast<double>(ins.latitude_ndeg) * 1e-9;
  const double north_m = 10.0 * std::cos(ins.yaw_rad);
  const double east_m = 10.0 * std::sin(ins.yaw_rad);
  const double radius_m = 6371000.0;
  command.waypoint[0].latitude_ndeg =
      ins.latitude_ndeg + std::llround(north_m / radius_m * 180.0 / M_PI * 1e9);
  command.waypoint[0].longitude_ndeg =
      ins.longitude_ndeg +
      std::llround(east_m / (radius_m * std::cos(latitude * M_PI / 180.0)) * 180.0 / M_PI * 1e9);
  ASSERT_EQ(drive.Say(command), Status::kOk);
  EXPECT_NEAR(drive.loop().goal_odom().x_m, 10.0f, 0.1f);
  EXPECT_NEAR(drive.loop().goal_odom().y_m, 0.0f, 0.1f);
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.mode() == Mode::kDriving; }));
  ASSERT_TRUE(drive.Until(30.0, [&] { return drive.mode() == Mode::kArmed; }));
  EXPECT_NEAR(drive.Pose().x_m, 10.0, 0.7);
}

// SR-OPR05
TEST(VehicleLoop, RefusesALatitudeFarAwayAndOneWithoutPosition) {
  ClosedLoop drive("at 12 ins-mode 0");
  drive.BringUpAndArm();
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = 1;
  command.waypoint[0].frame = GoalFrame::kGeodetic;
  command.waypoint[0].latitude_ndeg = drive.loop().newest_ins().latitude_ndeg + 1'000'000'000;
  command.waypoint[0].longitude_ndeg = drive.loop().newest_ins().longitude_ndeg;
  EXPECT_EQ(drive.Say(command), Status::kInvalidArgument);
  ASSERT_TRUE(drive.Until(
      20.0, [&] { return drive.loop().newest_ins().status.mode == InsMode::kNotTracking; }));
  command.waypoint[0].latitude_ndeg = drive.loop().newest_ins().latitude_ndeg;
  EXPECT_EQ(drive.Say(command), Status::kStale);
  EXPECT_EQ(drive.loop().goals(), 0);
}

struct Fault {
  const char* script;
  StopReason reason;
  Mode mode;
  double rest_s;  // within which the vehicle stands
};

// Its bytes would be an address.
void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.script;
}

class VehicleLoopFaults : public ::testing::TestWithParam<Fault> {};

// Each at 2 m/s or so, on a straight lane. Never a contact, and the vehicle stands within the time.
// SR-SUP04, SR-SUP05, SR-SUP09
TEST_P(VehicleLoopFaults, BringTheVehicleToRest) {
  const Fault& fault = GetParam();
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 2.0; }));
  std::vector<sim::ScriptEvent> events;
  ASSERT_TRUE(sim::ParseScript(fault.script, "fault", events).ok());
  for (const sim::ScriptEvent& event : events) event.act(drive.vehicle());
  ASSERT_TRUE(drive.Until(2.0, [&] { return drive.mode() != Mode::kDriving; }));
  EXPECT_EQ(drive.mode(), fault.mode);
  EXPECT_EQ(drive.reason(), fault.reason);
  EXPECT_TRUE(drive.Until(fault.rest_s, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }))
      << drive.Speed_mps();
  drive.Ticks(200);
  EXPECT_LT(std::fabs(drive.Speed_mps()), 0.02);
  EXPECT_NE(drive.mode(), Mode::kDriving);
  EXPECT_FALSE(drive.vehicle().collided());
}

INSTANTIATE_TEST_SUITE_P(
    All, VehicleLoopFaults,
    ::testing::Values(Fault{"at 0 lidar off", StopReason::kLidarOld, Mode::kSafeStop, 5.0},
                      Fault{"at 0 ins off", StopReason::kInsOld, Mode::kSafeStop, 5.0},
                      Fault{"at 0 drive-silent left on", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 drive-silent both on", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 reboot right", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 reboot left quiet", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 fault left 0x3210", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 emcy right 0x5530", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 lose-enable left", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 nmt right pre-operational", StopReason::kDrives, Mode::kFault,
                            5.0},
                      Fault{"at 0 key both off", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 process-data left off", StopReason::kDrives, Mode::kFault, 5.0},
                      Fault{"at 0 can-frame 202#0F00000000000000", StopReason::kForeignSender,
                            Mode::kFault, 5.0}),
    [](const ::testing::TestParamInfo<Fault>& param) {
      std::string name = param.param.script + 5;
      for (char& c : name) {
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      }
      return name;
    });

// SR-DRV07, SR-SUP09
TEST(VehicleLoop, StopsForGoodWhenTheBusGoes) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  drive.bus = CanBusState::kBusOff;
  drive.drops_frames = true;
  drive.Ticks(1);
  EXPECT_EQ(drive.mode(), Mode::kFault);
  EXPECT_EQ(drive.reason(), StopReason::kBus);
  // The drives' own time-out stops the wheels.
  EXPECT_TRUE(drive.Until(4.0, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }));
  drive.bus = CanBusState::kActive;
  drive.drops_frames = false;
  drive.Ticks(300);
  EXPECT_EQ(drive.mode(), Mode::kFault);
  EXPECT_LT(std::fabs(drive.Speed_mps()), 0.02);
}

// SR-SUP08
TEST(VehicleLoop, StopsWhenToldToAndOnEmergency) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  EXPECT_EQ(drive.Say(Kind::kStop), Status::kOk);
  EXPECT_EQ(drive.mode(), Mode::kSafeStop);
  ASSERT_TRUE(drive.Until(8.0, [&] { return drive.mode() == Mode::kArmed; }));
  ASSERT_EQ(drive.Goal(60.0f, 0.0f), Status::kOk);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 1.0; }));
  EXPECT_EQ(drive.Say(Kind::kEmergencyStop), Status::kOk);
  EXPECT_EQ(drive.mode(), Mode::kEmergencyStop);
  EXPECT_EQ(drive.loop().drives().commanded().left_radps, 0.0f);
  ASSERT_TRUE(drive.Until(5.0, [&] { return std::fabs(drive.Speed_mps()) < 0.02; }));
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);
  EXPECT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  EXPECT_EQ(drive.mode(), Mode::kStandby);
}

TEST(VehicleLoop, TakesUpDrivingAgainAfterAReset) {
  ClosedLoop drive;
  drive.DriveTo(60.0f, 0.0f);
  std::vector<sim::ScriptEvent> events;
  ASSERT_TRUE(sim::ParseScript("at 0 fault left 0x3210", "fault", events).ok());
  events[0].act(drive.vehicle());
  ASSERT_TRUE(drive.Until(2.0, [&] { return drive.mode() == Mode::kFault; }));
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.loop().drives().standstill(); }));
  drive.Ticks(100);
  ASSERT_EQ(drive.Say(Kind::kDisarm), Status::kOk);
  ASSERT_TRUE(drive.Until(10.0, [&] { return drive.Say(Kind::kArm) == Status::kOk; }));
  ASSERT_TRUE(drive.Until(5.0, [&] { return drive.loop().drives().enabled(); }));
  ASSERT_EQ(drive.Goal(5.0f, 0.0f, GoalFrame::kBody), Status::kOk);
  EXPECT_TRUE(drive.Until(10.0, [&] { return drive.Speed_mps() > 0.5; }));
}

// SR-SUP01
TEST(VehicleLoop, RefusesToMoveUnlessArmed) {
  ClosedLoop drive;
  EXPECT_EQ(drive.Say(Kind::kArm), Status::kNotPermitted);  // nothing is up yet
  EXPECT_EQ(drive.Goal(5.0f, 0.0f), Status::kNotPermitted);
  ASSERT_TRUE(drive.Until(20.0, [&] { return drive.loop().drives().ready(); }));
  EXPECT_EQ(drive.Goal(5.0f, 0.0f), Status::kNotPermitted);
  EXPECT_EQ(drive.loop().goals(), 0);
  drive.Ticks(300);
  EXPECT_FALSE(drive.loop().drives().enabled());
  EXPECT_EQ(drive.Speed_mps(), 0.0);
}

// SR-OPR02
TEST(VehicleLoop, AnswersWhatIsNoCommand) {
  ClosedLoop drive;
  const uint8_t noise[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13};
  EXPECT_EQ(drive.Tick(noise), Status::kOk);
  EXPECT_TRUE(drive.output().has_answer);
  EXPECT_FALSE(IsUsable(drive.output().answer));
  EXPECT_EQ(drive.loop().counters().refused_commands, 1u);
}

// SR-INP08
TEST(VehicleLoop, RefusesATickWhoseTimeDoesNotGrow) {
  ClosedLoop drive;
  drive.Ticks(5);
  TickInput input;
  TickOutput output;
  input.bus = CanBusState::kActive;
  input.now_ns = drive.now_ns();
  input.index = 100;
  EXPECT_EQ(drive.loop().Tick(input, output), Status::kInvalidArgument);
  input.now_ns += 1;
  input.index = 5;
  EXPECT_EQ(drive.loop().Tick(input, output), Status::kInvalidArgument);
  EXPECT_EQ(output.frames.size(), 0);
  EXPECT_EQ(drive.loop().counters().refused_ticks, 2u);
  const TickDatagram many[VehicleLoop::kMaxDatagramsPerTick + 1] = {};
  input.index = 6;
  input.datagrams = many;
  EXPECT_EQ(drive.loop().Tick(input, output), Status::kInvalidArgument);
  input.datagrams = {};
  EXPECT_EQ(drive.loop().Tick(input, output), Status::kOk);
}

TEST(VehicleLoop, IsNothingBeforeItIsConfigured) {
  const auto loop = std::make_unique<VehicleLoop>();
  TickOutput output;
  TickInput input;
  input.index = 1;
  input.now_ns = 1;
  EXPECT_EQ(loop->Tick(input, output), Status::kNotStarted);
  EXPECT_EQ(output.frames.size(), 0);
  VehicleConfig empty;
  EXPECT_FALSE(IsUsable(loop->Configure(empty)));  // no lidar
}

// What a tick leaves waits, and what waits for good is old: 512 columns 20 times a second are 6.4
// datagrams and 102.4 columns in 10 ms.
// SR-CFG02
TEST(VehicleLoop, RefusesAPeriodThatBringsMoreThanATickTakes) {
  ClosedLoop drive;
  const auto loop = std::make_unique<VehicleLoop>();
  const auto config = std::make_unique<VehicleConfig>(drive.config());
  ASSERT_EQ(config->lidar.columns_per_frame, 512);
  ASSERT_EQ(config->lidar.columns_per_packet, 16);
  struct Case {
    int period_ms;
    int directions;
    int use_labels;
    Status status;
  };
  for (const Case& one : {Case{10, 160, 0, Status::kOk}, Case{25, 256, 0, Status::kOk},
                          Case{26, 256, 0, Status::kParameterOutOfRange},  // columns
                          Case{40, 1024, 0, Status::kOk},                  // 25.6 of 26 datagrams
                          Case{41, 1024, 0, Status::kParameterOutOfRange},
                          Case{20, 1024, 1, Status::kOk},  // 12.8 of 13
                          Case{21, 1024, 1, Status::kParameterOutOfRange}}) {
    config->onboard.tick.period_ms = one.period_ms;
    config->onboard.tick.directions = one.directions;
    config->perception.mapping.use_labels = one.use_labels;
    EXPECT_EQ(loop->Configure(*config), one.status) << one.period_ms;
  }
}

// SR-DET05
TEST(VehicleLoop, DecidesTheSameTwice) {
  uint64_t hash[2] = {};
  for (uint64_t& value : hash) {
    ClosedLoop drive;
    drive.DriveTo(12.0f, 0.0f);
    drive.Ticks(300);
    value = drive.loop().decision_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

// Every decision of two drives as it was when it was last changed on purpose: what says otherwise
// is a change to look at, and then to write down here. The simulated vehicle is the same to the bit
// everywhere.
TEST(VehicleLoop, DecidesAsRecorded) {
  ClosedLoop straight;
  straight.DriveTo(12.0f, 0.0f);
  straight.Ticks(300);
  EXPECT_EQ(straight.loop().decision_hash(), 0x475e3e9f5a62da49u);

  ClosedLoop around("at 0 box 8 0 1.5 1.5");
  around.DriveTo(18.0f, 0.0f);
  around.Ticks(1500);
  EXPECT_EQ(around.loop().decision_hash(), 0x312657f8f59a4e1bu);
}

// The image of the state is the state: a copy of its bytes goes on as the original does.
// SR-DET05
TEST(VehicleLoop, GoesOnFromACopyOfItsBytes) {
  ClosedLoop drive;
  drive.DriveTo(12.0f, 0.0f);
  const auto copy = std::make_unique<VehicleLoop>();
  std::memcpy(static_cast<void*>(copy.get()), &drive.loop(), sizeof(VehicleLoop));
  EXPECT_EQ(copy->decision_hash(), drive.loop().decision_hash());
  TickInput input;
  TickOutput output;
  TickOutput copied;
  input.bus = CanBusState::kActive;
  for (uint64_t i = 1; i <= 50; ++i) {
    input.index = drive.loop().index() + 1;
    input.now_ns = drive.loop().now_ns() + ClosedLoop::kTick_ns;
    ASSERT_EQ(drive.loop().Tick(input, output), Status::kOk);
    ASSERT_EQ(copy->Tick(input, copied), Status::kOk);
    ASSERT_EQ(copy->decision_hash(), drive.loop().decision_hash()) << "tick " << i;
  }
}

// Random bytes from everywhere, and a bus that says anything: no command leaves but zero.
TEST(VehicleLoop, StandsStillUnderNoise) {
  constexpr uint32_t kSeed = 20250114;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const auto number = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  ClosedLoop drive;
  TickInput input;
  TickOutput output;
  std::vector<std::vector<uint8_t>> bytes(20);
  for (int tick = 1; tick <= 2000; ++tick) {
    std::vector<TickDatagram> datagrams;
    for (std::vector<uint8_t>& one : bytes) {
      one.resize(static_cast<size_t>(number(0, 10) == 0 ? 12608 : number(0, 200)));
      for (uint8_t& byte : one) byte = static_cast<uint8_t>(random());
      datagrams.push_back({static_cast<InputSource>(number(0, 2)), one});
    }
    std::vector<CanFrame> frames(static_cast<size_t>(number(0, 40)));
    for (CanFrame& frame : frames) {
      frame.id = static_cast<uint32_t>(number(0, 0x7ff));
      frame.size = static_cast<uint8_t>(number(0, 8));
      for (int i = 0; i < frame.size; ++i) frame.data[i] = static_cast<uint8_t>(random());
    }
    input.index = static_cast<uint64_t>(tick);
    input.now_ns = 1'000'000'000u + static_cast<uint64_t>(tick) * 10'000'000u;
    input.bus = static_cast<CanBusState>(number(0, kCanBusStates - 1));
    input.datagrams = datagrams;
    input.frames = frames;
    input.command = bytes[0];
    ASSERT_EQ(drive.loop().Tick(input, output), Status::kOk);
    ASSERT_EQ(drive.loop().drives().commanded().left_radps, 0.0f);
    ASSERT_EQ(drive.loop().drives().commanded().right_radps, 0.0f);
    ASSERT_NE(drive.mode(), Mode::kDriving);
  }
}

TEST(AnyVehicle, TakesBackAStateThatWasCopied) {
  ClosedLoop drive;
  const auto vehicle = std::make_unique<VehicleOf<Warthog>>();
  const std::span<const std::byte> state = drive.onboard().state();
  ASSERT_NE(std::memcmp(vehicle->state().data(), state.data(), state.size()), 0);
  EXPECT_EQ(vehicle->Restore(state.first(state.size() - 1)), Status::kInvalidArgument);
  ASSERT_EQ(vehicle->Restore(state), Status::kOk);
  EXPECT_EQ(std::memcmp(vehicle->state().data(), state.data(), state.size()), 0);
  EXPECT_EQ(vehicle->state_layout(), drive.onboard().state_layout());
}

}  // namespace
}  // namespace hardpack
