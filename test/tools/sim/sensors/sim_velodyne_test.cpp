// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "test/tools/sim/sensors/velodyne_reader.h"
#include "tools/sim/sensors/sim_lidar.h"

// The bytes of a simulated Velodyne at places that are worked out by hand, and its ranges held
// against trigonometry.

namespace hardpack::sim::velodyne {
namespace {

constexpr world::Material kThing = {world::Label::kObject, world::Matter::kSolid, 1.0};
constexpr double kHeight_m = 1.284;  // of the sensor over level ground

// Its near side is 10 m ahead.
world::World WallAhead() {
  world::World wall;
  wall.AddBox({10.5, 0.0}, 0.0, 1.0, 400.0, -0.5, 60.0, kThing);
  return wall;
}

// With neither noise nor wander: sequence k begins 55.296 us k after the start, at 0.1990656 deg k.
LidarSettings Exact(LidarModel model) {
  LidarSettings settings = CleanLidar(model);
  settings.noise_m = 0.0;
  settings.turn_wander = 0.0;
  return settings;
}

std::vector<Bytes> PacketsOf(const LidarSettings& settings, const world::World& world,
                             uint64_t end_ms) {
  SimLidar lidar(settings, 0);
  std::vector<Bytes> packets;
  for (uint64_t ms = 0; ms <= end_ms; ++ms) lidar.Advance(ms * 1'000'000, {}, world, packets);
  return packets;
}

TEST(SimVelodyne, Vlp16SaysWhatIsWorkedOutByHand) {
  const auto packets = PacketsOf(Exact(LidarModel::kVlp16), WallAhead(), 10);
  ASSERT_GE(packets.size(), 3u);
  for (const Bytes& packet : packets) {
    ASSERT_EQ(packet.size(), 1206u);
    for (size_t block = 0; block < 12; ++block) ASSERT_EQ(At(packet, 100 * block, 2), 0xeeffu);
    EXPECT_EQ(packet[1204], 0x37);
    EXPECT_EQ(packet[1205], 0x22);
  }
  const Bytes& first = packets[0];
  EXPECT_EQ(Bytes(first.begin(), first.begin() + 4), (Bytes{0xff, 0xee, 0x00, 0x00}));
  // Laser 0, 15 deg down: 1.2952 m / sin(15 deg) = 5.0043 m, 2502 units.
  EXPECT_EQ(Bytes(first.begin() + 4, first.begin() + 6), (Bytes{0xc6, 0x09}));
  // Laser 1, 1 deg up: 10 m / cos(1 deg) = 10.0015 m, 5001 units.
  EXPECT_EQ(Bytes(first.begin() + 7, first.begin() + 9), (Bytes{0x89, 0x13}));
  EXPECT_GT(first[9], 0);
  // Two sequences a block: 0.3981312 deg on, and after eleven blocks 4.3794 deg.
  EXPECT_EQ(Azimuth_cdeg(first, 1), 40u);
  EXPECT_EQ(Azimuth_cdeg(first, 11), 438u);
  // 17 s past the hour, and 12 * 2 * 55.296 us = 1327.104 us from one packet to the next.
  EXPECT_EQ(Bytes(first.begin() + 1200, first.begin() + 1204), (Bytes{0x40, 0x66, 0x03, 0x01}));
  EXPECT_EQ(Time_us(packets[1]), 17'001'327u);
  EXPECT_EQ(Time_us(packets[2]), 17'002'654u);
  EXPECT_EQ(Azimuth_cdeg(packets[1], 0), 478u);  // 24 * 0.1990656 = 4.7776
}

TEST(SimVelodyne, Vlp32cSaysWhatIsWorkedOutByHand) {
  const auto packets = PacketsOf(Exact(LidarModel::kVlp32c), WallAhead(), 10);
  ASSERT_GE(packets.size(), 3u);
  for (const Bytes& packet : packets) {
    ASSERT_EQ(packet.size(), 1206u);
    EXPECT_EQ(packet[1204], 0x37);
    EXPECT_EQ(packet[1205], 0x28);
  }
  const Bytes& first = packets[0];
  EXPECT_EQ(Azimuth_cdeg(first, 0), 0u);
  EXPECT_EQ(Azimuth_cdeg(first, 1), 20u);
  EXPECT_EQ(Azimuth_cdeg(first, 11), 219u);
  EXPECT_EQ(Distance(first, 0, 0), 760u);   // 25 deg down: 1.284 m / sin(25 deg) = 3.038 m
  EXPECT_EQ(Distance(first, 0, 5), 2501u);  // level, 1.4 deg aside: 10 m / cos(1.4 deg) = 10.003 m
  EXPECT_EQ(Time_us(packets[1]), 17'000'663u);
  EXPECT_EQ(Time_us(packets[2]), 17'001'327u);
}

// Azimuth grows clockwise: what is at 90 deg is to the right.
TEST(SimVelodyne, TurnsClockwiseFromAhead) {
  world::World world;
  world.AddBox({0.0, -10.5}, 0.0, 8.0, 1.0, -0.5, 30.0, kThing);
  const Facts facts = FactsOf(LidarModel::kVlp16);
  const auto packets = PacketsOf(Exact(LidarModel::kVlp16), world, 100);
  int seen = 0;
  for (const Sequence& sequence : SequencesOf(packets, facts)) {
    const double from_right_deg = std::fabs(sequence.azimuth_deg - 90.0);
    if (from_right_deg < 15.0) {
      EXPECT_NEAR(sequence.distances[1], 5000.0 / std::cos(from_right_deg * M_PI / 180.0), 20.0);
      ++seen;
    } else if (from_right_deg > 30.0) {
      EXPECT_EQ(sequence.distances[1], 0u);
      EXPECT_EQ(sequence.reflectivities[1], 0u);
    }
  }
  EXPECT_NEAR(seen, 150, 2);
}

// A VLP-32C's offsets are clockwise too: a post at 4.2 deg is met by the lasers of +4.2 deg.
TEST(SimVelodyne, OffsetsOfLasersAreClockwise) {
  world::World world;
  const double aside_rad = 4.2 * M_PI / 180.0;
  world.AddCylinder({10.0 * std::cos(aside_rad), -10.0 * std::sin(aside_rad)}, 0.2, -0.5, 5.0,
                    kThing);
  const auto packets = PacketsOf(Exact(LidarModel::kVlp32c), world, 10);
  EXPECT_NEAR(Distance(packets.at(0), 0, 14), 2450.0, 3.0);  // 0.667 deg up, +4.2
  EXPECT_EQ(Distance(packets.at(0), 0, 9), 0u);              // 0.333 deg up, -4.2
  EXPECT_EQ(Distance(packets.at(0), 0, 18), 0u);             // 1.0 deg up, +1.4
}

class SimVelodyneModels : public ::testing::TestWithParam<LidarModel> {
 protected:
  const Facts facts_ = FactsOf(GetParam());
};

// Each laser of each sequence, from where the head is as it fires.
TEST_P(SimVelodyneModels, SeesTheWallAsTrigonometryDoes) {
  const auto packets = PacketsOf(Exact(GetParam()), WallAhead(), 100);
  const auto sequences = SequencesOf(packets, facts_);
  int compared = 0;
  for (size_t k = 0; k < sequences.size(); ++k) {
    for (size_t laser = 0; laser < facts_.lasers; ++laser) {
      const double time_us = 55.296 * static_cast<double>(k) + facts_.FiresAfter_us(laser);
      const double azimuth_rad = (0.0036 * time_us + facts_.offset_deg[laser]) * M_PI / 180.0;
      const double altitude_rad = facts_.altitude_deg[laser] * M_PI / 180.0;
      const double ahead = std::cos(altitude_rad) * std::cos(azimuth_rad);
      const double height_m = kHeight_m + 0.001 * facts_.above_mm[laser];
      double expected_m = ahead > 0.0 ? 10.0 / ahead : 1.0e9;
      if (altitude_rad < 0.0) expected_m = std::min(expected_m, height_m / -std::sin(altitude_rad));
      const double range_m = 0.001 * facts_.unit_mm * sequences[k].distances[laser];
      if (expected_m > 60.0) continue;
      ASSERT_NEAR(range_m, expected_m, 0.0006 + 0.0005 * facts_.unit_mm) << k << " " << laser;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000 * static_cast<int>(facts_.lasers) / 2);
}

TEST_P(SimVelodyneModels, SendsNothingBeforeItsLastLaserFired) {
  SimLidar lidar(Exact(GetParam()), 0);
  std::vector<Bytes> packets;
  const double last_us = facts_.packet_us - 55.296 + facts_.FiresAfter_us(facts_.lasers - 1);
  lidar.Advance(static_cast<uint64_t>(1000.0 * last_us) - 2, {}, {}, packets);
  EXPECT_EQ(packets.size(), 0u);
  lidar.Advance(static_cast<uint64_t>(1000.0 * last_us) + 2, {}, {}, packets);
  EXPECT_EQ(packets.size(), 1u);
}

TEST_P(SimVelodyneModels, SendsAtItsRate) {
  const auto packets = PacketsOf(CleanLidar(GetParam()), {}, 1000);
  EXPECT_NEAR(static_cast<double>(packets.size()), 1.0e6 / facts_.packet_us, 1.0);
  for (size_t i = 0; i < packets.size(); ++i) {
    ASSERT_EQ(packets[i].size(), 1206u);
    ASSERT_NEAR(Time_us(packets[i]), 17.0e6 + facts_.packet_us * static_cast<double>(i), 1.0);
  }
}

// Where the vehicle is between two calls is of no account to what is seen: it is where it is as
// each laser fires.
TEST_P(SimVelodyneModels, MovesOnBetweenCalls) {
  const world::World wall = WallAhead();
  const auto driven = [&](uint64_t step_us) {
    SimLidar lidar(Exact(GetParam()), 0);
    std::vector<Bytes> packets;
    for (uint64_t us = 0; us <= 120'000; us += step_us) {
      const double time_s = 1.0e-6 * static_cast<double>(us);
      const world::BodyPose pose = {{5.0 * time_s, 0.0, 0.0}, 0.0, 0.0, 1.5 * time_s};
      lidar.Advance(us * 1000, pose, wall, packets);
    }
    return SequencesOf(packets, facts_);
  };
  const auto fine = driven(100);
  const auto coarse = driven(10'000);
  ASSERT_EQ(fine.size(), coarse.size());
  for (size_t k = 0; k < fine.size(); ++k) {
    for (size_t laser = 0; laser < facts_.lasers; ++laser) {
      const double range_m = 0.001 * facts_.unit_mm * fine[k].distances[laser];
      if (range_m > 50.0) continue;
      ASSERT_NEAR(fine[k].distances[laser], coarse[k].distances[laser], 1.0) << k << " " << laser;
    }
  }
  // After one revolution the wall is half a metre nearer, and 0.15 rad askew.
  const size_t laser = facts_.lasers == 16 ? 1 : 13;
  const size_t later = 1808;
  const double lateral_rad = facts_.offset_deg[laser] * M_PI / 180.0 - 0.15;
  const double altitude_rad = facts_.altitude_deg[laser] * M_PI / 180.0;
  EXPECT_NEAR(0.001 * facts_.unit_mm * fine.at(later).distances[laser],
              9.5 / std::cos(lateral_rad) / std::cos(altitude_rad), 0.01);
}

TEST_P(SimVelodyneModels, WandersInItsRate) {
  const auto sequences = SequencesOf(PacketsOf(CleanLidar(GetParam()), {}, 4000), facts_);
  std::vector<double> begins_us;
  std::vector<double> azimuths_deg;
  for (size_t k = 1; k < sequences.size(); ++k) {
    const Sequence& sequence = sequences[k];
    if (sequence.azimuth_deg > sequences[k - 1].azimuth_deg) continue;
    azimuths_deg.push_back(sequence.azimuth_deg);
    begins_us.push_back(sequence.time_us - sequence.azimuth_deg / 0.0036);
  }
  ASSERT_GE(begins_us.size(), 38u);
  double shortest_us = 1.0e9;
  double longest_us = 0.0;
  for (size_t i = 1; i < begins_us.size(); ++i) {
    shortest_us = std::min(shortest_us, begins_us[i] - begins_us[i - 1]);
    longest_us = std::max(longest_us, begins_us[i] - begins_us[i - 1]);
  }
  EXPECT_GT(shortest_us, 100'000.0 * (1.0 - 0.0031) - 4.0);
  EXPECT_LT(longest_us, 100'000.0 * (1.0 + 0.0031) + 4.0);
  EXPECT_GT(longest_us - shortest_us, 100.0);
  // Not locked to the azimuth.
  const auto [least, most] = std::minmax_element(azimuths_deg.begin(), azimuths_deg.end());
  EXPECT_GT(*most - *least, 0.1);
}

TEST_P(SimVelodyneModels, ErrsAndLosesAsItIsToldTo) {
  LidarSettings settings = NoisyLidar(GetParam());
  settings.turn_wander = 0.0;
  const auto noisy = SequencesOf(PacketsOf(settings, WallAhead(), 100), facts_);
  const auto exact = SequencesOf(PacketsOf(Exact(GetParam()), WallAhead(), 100), facts_);
  ASSERT_EQ(noisy.size(), exact.size());
  double squares_m2 = 0.0;
  int both = 0;
  int lost = 0;
  for (size_t k = 0; k < noisy.size(); ++k) {
    for (size_t laser = 0; laser < facts_.lasers; ++laser) {
      const uint32_t truth = exact[k].distances[laser];
      const uint32_t said = noisy[k].distances[laser];
      if (truth == 0) continue;
      if (said == 0) {
        ++lost;
        continue;
      }
      const double error_m = 0.001 * facts_.unit_mm * (static_cast<double>(said) - truth);
      squares_m2 += error_m * error_m;
      ++both;
    }
  }
  EXPECT_NEAR(std::sqrt(squares_m2 / both), 0.012, 0.001);
  EXPECT_NEAR(1.0 * lost / (both + lost), 0.01, 0.003);
}

TEST_P(SimVelodyneModels, EndsWhereItsReachEnds) {
  const double reach_m = GetParam() == LidarModel::kVlp16 ? 100.0 : 200.0;
  const size_t laser = facts_.lasers == 16 ? 1 : 13;
  for (const double wall_m : {reach_m - 1.0, reach_m + 1.0}) {
    world::World world(world::Bounds{-50.0, -250.0, 250.0, 250.0});
    world.AddBox({wall_m + 0.5, 0.0}, 0.0, 1.0, 400.0, -0.5, 60.0, kThing);
    const auto sequences = SequencesOf(PacketsOf(Exact(GetParam()), world, 5), facts_);
    const double range_m = 0.001 * facts_.unit_mm * sequences.at(0).distances[laser];
    EXPECT_NEAR(range_m, wall_m < reach_m ? wall_m : 0.0, 0.15);
  }
}

TEST_P(SimVelodyneModels, SaysTheSameOfTheSameSeed) {
  LidarSettings settings = NoisyLidar(GetParam());
  const auto once = PacketsOf(settings, WallAhead(), 200);
  EXPECT_EQ(once, PacketsOf(settings, WallAhead(), 200));
  settings.seed = 2;
  EXPECT_NE(once, PacketsOf(settings, WallAhead(), 200));
}

TEST_P(SimVelodyneModels, BeginsTheHourAnew) {
  LidarSettings settings = Exact(GetParam());
  settings.clock_start_ns = 3'600'000'000'000 - 5'000'000;
  const auto packets = PacketsOf(settings, {}, 20);
  bool wrapped = false;
  for (size_t i = 0; i < packets.size(); ++i) {
    double expected_us = 3'599'995'000.0 + facts_.packet_us * static_cast<double>(i);
    wrapped = wrapped || expected_us >= 3.6e9;
    if (expected_us >= 3.6e9) expected_us -= 3.6e9;
    ASSERT_NEAR(Time_us(packets[i]), expected_us, 1.0);
    ASSERT_LT(Time_us(packets[i]), 3'600'000'000u);
  }
  EXPECT_TRUE(wrapped);
}

TEST_P(SimVelodyneModels, BeginsANewAfterARestart) {
  SimLidar lidar(Exact(GetParam()), 0);
  std::vector<Bytes> packets;
  lidar.Advance(50'300'000, {}, {}, packets);  // in the middle of a packet
  packets.clear();
  lidar.Restart(50'300'000);
  lidar.Advance(60'000'000, {}, {}, packets);
  ASSERT_GE(packets.size(), 2u);
  EXPECT_EQ(packets[0].size(), 1206u);
  EXPECT_EQ(Time_us(packets[0]), 0u);
  EXPECT_EQ(Azimuth_cdeg(packets[0], 0), 0u);
  EXPECT_NEAR(Time_us(packets[1]), facts_.packet_us, 1.0);
  // And a clock that is set back to before its zero is at the end of an hour. The packet under way
  // has its time from before.
  const double next_us = facts_.packet_us * static_cast<double>(packets.size() + 1);
  packets.clear();
  lidar.JumpClock(-20'000'000);
  lidar.Advance(65'000'000, {}, {}, packets);
  EXPECT_NEAR(Time_us(packets.at(0)), next_us - facts_.packet_us, 1.0);
  EXPECT_NEAR(Time_us(packets.at(1)), 3.6e9 - 20'000.0 + next_us, 1.0);
}

TEST_P(SimVelodyneModels, HasItsOwnBeamsAndNoMetadataOrTruth) {
  LidarSettings settings;  // with an Ouster's beams
  settings.model = GetParam();
  SimLidar lidar(settings, 0);
  EXPECT_EQ(lidar.settings().beams.count, static_cast<int>(facts_.lasers));
  EXPECT_EQ(lidar.MetadataJson(), "");
  std::vector<Bytes> packets;
  std::vector<CastColumn> truth;
  lidar.Advance(10'000'000, {}, {}, packets, &truth);
  EXPECT_FALSE(packets.empty());
  EXPECT_TRUE(truth.empty());
}

INSTANTIATE_TEST_SUITE_P(Models, SimVelodyneModels,
                         ::testing::Values(LidarModel::kVlp16, LidarModel::kVlp32c));

}  // namespace
}  // namespace hardpack::sim::velodyne
