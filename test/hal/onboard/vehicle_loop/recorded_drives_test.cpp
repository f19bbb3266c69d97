// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "test/decision/map_hash.h"
#include "test/decision/random.h"
#include "test/decision/vary.h"
#include "test/hal/onboard/vehicle_loop/closed_loop.h"

// Drives that nobody chose: random parameters, faults, bytes, obstacles and commands of an
// operator, and every decision as it was when it was last changed on purpose. What they come to is
// not judged here; the simulated vehicle is the same to the bit everywhere.

namespace hardpack::testing {
namespace {

using control::GoalFrame;
using control::Kind;
using decision::Random;

constexpr int kSteps = 30;  // of a drive: something is said, then it goes on for a while
constexpr int kBringUp_ticks = 1500;

// What can go wrong; # stands for a small number.
constexpr std::array kFaults = {"box 12 # 1.5 1.2",
                                "box 7 -# 0.4 1.7",
                                "box # 6 3 0.3",
                                "lidar-loss 200",
                                "ins-loss 300",
                                "lidar off",
                                "lidar on",
                                "ins off",
                                "ins on",
                                "lidar-delay #0",
                                "ins-delay #0",
                                "lidar-duplicate on",
                                "ins-duplicate on",
                                "lidar-reorder #",
                                "ins-reorder #",
                                "ins-garbage on",
                                "ins-garbage off",
                                "lidar-garbage on",
                                "lidar-garbage off",
                                "lidar-restart",
                                "lidar-clock #00",
                                "lidar-clock -#00",
                                "ins-cut #",
                                "ins-cut 0",
                                "ins-mode 1",
                                "ins-mode 2",
                                "ins-mode 0",
                                "ins-jump # -#",
                                "ins-drift 0.# 0.2",
                                "ins-drift 0 0",
                                "frozen left on",
                                "frozen left off",
                                "blocked right on",
                                "blocked right off",
                                "speed-offset left #0",
                                "speed-offset left 0",
                                "opposite right on",
                                "opposite right off",
                                "emcy left 0x3210 1 #",
                                "fault right 0x4310",
                                "reboot left",
                                "lose-enable right",
                                "nmt left pre-operational",
                                "nmt left operational",
                                "bus-error warning",
                                "bus-error passive",
                                "can-frame 1#5#0102",
                                "key left off",
                                "key left on",
                                "sdo-silent left 0x6060 on",
                                "sdo-silent left 0x6060 off",
                                "mode-refused right on",
                                "mode-refused right off"};

std::string AnyFault(Random& random) {
  const int most = static_cast<int>(kFaults.size()) - 1;
  std::string fault = kFaults[static_cast<size_t>(random.Between(0, most))];
  for (char& letter : fault) {
    if (letter == '#' && fault.find("can-frame") != 0) {
      letter = static_cast<char>('0' + random.Between(1, 9));
    }
  }
  if (fault == "can-frame 1#5#0102") fault = "can-frame 185#0102";
  return fault;
}

control::Waypoint AnyWaypoint(Random& random, const InsSample& ins) {
  control::Waypoint waypoint;
  waypoint.frame = static_cast<GoalFrame>(std::max(random.Between(-3, 2), 0));
  waypoint.position_m = {random.RealBetween(-5.0f, 25.0f), random.RealBetween(-6.0f, 6.0f)};
  waypoint.latitude_ndeg = ins.latitude_ndeg + random.Between(-100'000, 100'000);
  waypoint.longitude_ndeg = ins.longitude_ndeg + random.Between(-100'000, 100'000);
  return waypoint;
}

control::OperatorCommand AnyGoal(Random& random, const InsSample& ins) {
  control::OperatorCommand command;
  command.kind = Kind::kGoal;
  command.waypoints = random.Between(1, 3);
  for (int i = 0; i < command.waypoints; ++i) command.waypoint[i] = AnyWaypoint(random, ins);
  command.has_heading = random.Between(0, 2) == 0;
  command.heading_frame = static_cast<GoalFrame>(random.Between(0, 1));
  command.heading_rad = random.RealBetween(-3.1f, 3.1f);
  return command;
}

// What would lead on, as a rule; now and then anything.
control::OperatorCommand NextCommand(Random& random, const VehicleLoop& loop) {
  control::OperatorCommand command;
  if (random.Between(0, 9) == 0) {
    command.kind = static_cast<Kind>(random.Between(1, 6));
    if (command.kind == Kind::kGoal) command = AnyGoal(random, loop.newest_ins());
    return command;
  }
  switch (loop.permission().mode) {
    case Mode::kStandby:
      command.kind = Kind::kArm;
      break;
    case Mode::kArmed:
      return AnyGoal(random, loop.newest_ins());
    case Mode::kDriving:
      command.kind = Kind::kAlive;
      break;
    default:
      command.kind = Kind::kDisarm;
      break;
  }
  return command;
}

template <typename Counters>
void AddCounters(const Counters& counters, DecisionHash& hash) {
  static_assert(std::has_unique_object_representations_v<Counters>);
  std::array<uint8_t, sizeof(Counters)> bytes;
  std::memcpy(bytes.data(), &counters, bytes.size());
  for (const uint8_t byte : bytes) hash.AddU8(byte);
}

// What is told of it, besides what it decides.
void AddReport(const VehicleLoop& loop, DecisionHash& hash) {
  AddCounters(loop.counters(), hash);
  AddCounters(loop.mapper().counters(), hash);
  AddCounters(loop.lidar().monitor().counters(), hash);
  AddCounters(loop.lidar_time().counters(), hash);
  AddCounters(loop.ins().counters(), hash);
  AddCounters(loop.odometry().counters(), hash);
  AddCounters(loop.map_from_odom().counters(), hash);
  AddCounters(loop.replanner().counters(), hash);
  AddCounters(loop.drives().counters(), hash);
  for (const sevcon::Side side : {sevcon::Side::kLeft, sevcon::Side::kRight}) {
    const sevcon::DriveReport& drive = loop.drives().report(side);
    for (const uint32_t value :
         {uint32_t{drive.statusword}, uint32_t{drive.emergency_code}, drive.sdo_abort_code,
          uint32_t{drive.sdo_index}, drive.emergencies, drive.reboots, drive.sdo_timeouts,
          drive.sdo_aborts, drive.heartbeats_missed}) {
      hash.AddU32(value);
    }
    hash.AddFloat(drive.wheel_radps);
  }
  hash.AddU8(static_cast<uint8_t>(loop.permission().reason));
  hash.AddFloat(loop.tracking().speed_mps);
  if (loop.goals() > 0) hash.AddFloat(loop.goal_odom().x_m);
}

struct Drive {
  uint64_t decisions = 0;
  double way_m = 0.0;
};

Drive DriveOnce(uint32_t seed) {
  Random random(seed);
  ClosedLoop drive("", sim::LaneWorld(), static_cast<uint8_t>(seed));
  VehicleConfig config = drive.config();
  // Every other one as it is: what is far from it stands still soon.
  if (random.Between(0, 1) == 0) {
    decision::Vary(random, 40, config.planner);
    decision::Vary(random, 40, config.perception);
    decision::Vary(random, 40, config.onboard);
    if (drive.loop().Configure(config) != Status::kOk) {
      EXPECT_EQ(drive.loop().Configure(drive.config()), Status::kOk);
    }
  }
  Drive came;
  DecisionHash told;
  drive.Until(kBringUp_ticks * 0.01, [&] { return drive.loop().drives().ready(); });
  uint32_t sequence = 0;
  for (int step = 0; step < kSteps; ++step) {
    if (random.Between(0, 3) == 0) drive.Act("at 0 " + AnyFault(random));
    control::OperatorCommand command = NextCommand(random, drive.loop());
    command.sequence = ++sequence;
    uint8_t bytes[control::kMaxMessageBytes];
    int size_bytes = 0;
    EXPECT_EQ(control::Encode(command, bytes, size_bytes), Status::kOk);
    EXPECT_EQ(drive.Tick({bytes, static_cast<size_t>(size_bytes)}), Status::kOk);
    const int ticks = random.Between(1, 80);
    for (int tick = 0; tick < ticks; ++tick) {
      came.way_m += std::abs(drive.Speed_mps()) * 0.01;
      EXPECT_EQ(drive.Tick(), Status::kOk);
    }
    AddReport(drive.loop(), told);
  }
  decision::AddHeights(drive.loop().mapper().heights(), told);
  told.AddU64(drive.loop().decision_hash());
  came.decisions = told.value();
  return came;
}

class RecordedDrives : public ::testing::TestWithParam<int> {};

constexpr std::array<uint64_t, 8> kDecided = {
    0x5db46dbcd46a16bu,  0x4105be03dd67f203u, 0x38101c2a42585860u, 0x4dc4ded84a747a63u,
    0x854f415dd19166f2u, 0x9c111000cc34bb18u, 0x9d8b86f4ff99e223u, 0x5c99b0112281f9fdu};

TEST_P(RecordedDrives, DecideAsTheyDid) {
  const Drive drive = DriveOnce(0x5eed0410u + static_cast<uint32_t>(GetParam()));
  EXPECT_EQ(drive.decisions, kDecided[static_cast<size_t>(GetParam())])
      << "0x" << std::hex << drive.decisions << "u";
  EXPECT_GT(drive.way_m, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Any, RecordedDrives, ::testing::Range(0, int{kDecided.size()}));

}  // namespace
}  // namespace hardpack::testing
