// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <span>
#include <vector>

#include "gtest/gtest.h"
#include "tools/sim/sensors/sim_ins.h"
#include "tools/sim/sensors/sim_labels.h"
#include "tools/sim/sensors/sim_lidar.h"
#include "tools/sim/world/named_worlds.h"

// The same bytes on every machine and compiler: what the sensors send is held to a number here. It
// changes when the worlds or the sensors do, never with the machine.

namespace hardpack::sim {
namespace {

uint64_t Hashed(uint64_t hash, std::span<const std::vector<uint8_t>> datagrams) {
  for (const std::vector<uint8_t>& datagram : datagrams) {
    for (const uint8_t byte : datagram) hash = (hash ^ byte) * 1099511628211u;  // FNV-1a
  }
  return hash;
}

constexpr uint64_t kStart = 14695981039346656037u;

// One revolution while the vehicle drives and sways: lidar, labels and INS.
uint64_t HashOf(const char* name, uint32_t seed) {
  world::Scenario scenario;
  EXPECT_TRUE(world::MakeScenario(name, seed, scenario).ok());
  LidarSettings lidar_settings = NoisyLidar();
  lidar_settings.seed = seed;
  SimLidar lidar(lidar_settings, 0);
  SimLabels labels({.accuracy = 0.9, .delay_s = 0.0, .columns = 16, .seed = seed});
  InsSettings ins_settings;
  ins_settings.with_acceleration = true;
  ins_settings.errors = Vn300Errors();
  ins_settings.seed = seed;
  SimIns ins(ins_settings, 0);
  uint64_t hash = kStart;
  for (uint64_t ms = 0; ms <= 100; ++ms) {
    const double share = static_cast<double>(ms) / 100.0;
    BodyMotion motion;
    motion.pose = scenario.start;
    motion.pose.position.x_m += 0.4 * share;
    motion.pose.roll_rad += 0.03 * share * (1.0 - share);
    motion.pose.pitch_rad -= 0.02 * share;
    motion.pose.yaw_rad += 0.1 * share;
    motion.velocity_mps = {4.0, 0.2 * share, 0.0};
    motion.rate_radps = {0.0, -0.2, 1.0};
    std::vector<std::vector<uint8_t>> datagrams;
    std::vector<CastColumn> truth;
    lidar.Advance(ms * 1'000'000, motion.pose, scenario.world, datagrams, &truth);
    labels.Advance(ms * 1'000'000, truth, datagrams);
    ins.Advance(ms * 1'000'000, motion, datagrams);
    hash = Hashed(hash, datagrams);
  }
  return hash;
}

// 60 ms of a Velodyne while the vehicle drives and turns.
uint64_t HashOf(LidarModel model, const char* name) {
  world::Scenario scenario;
  EXPECT_TRUE(world::MakeScenario(name, 1, scenario).ok());
  SimLidar lidar(NoisyLidar(model), 0);
  lidar.weather().rain_permille = 10;
  uint64_t hash = kStart;
  for (uint64_t ms = 0; ms <= 60; ++ms) {
    const double share = static_cast<double>(ms) / 60.0;
    world::BodyPose pose = scenario.start;
    pose.position.x_m += 0.3 * share;
    pose.pitch_rad -= 0.02 * share;
    pose.yaw_rad += 0.1 * share;
    std::vector<std::vector<uint8_t>> datagrams;
    lidar.Advance(ms * 1'000'000, pose, scenario.world, datagrams);
    hash = Hashed(hash, datagrams);
  }
  return hash;
}

TEST(SimBits, OfAVelodyneAreTheSameOnEveryMachine) {
  EXPECT_EQ(HashOf(LidarModel::kVlp16, "forest"), 11028594225550297830u);
  EXPECT_EQ(HashOf(LidarModel::kVlp32c, "hill"), 231130064753643744u);
}

TEST(SimBits, AreTheSameOnEveryMachine) {
  EXPECT_EQ(HashOf("forest", 1), 9302842113543023245u);
  EXPECT_EQ(HashOf("gap", 2), 3694951145479844742u);
  EXPECT_EQ(HashOf("crossing", 3), 1946096730223027970u);
  EXPECT_EQ(HashOf("rock_pile", 1), 12273944175577073590u);
  EXPECT_EQ(HashOf("hill", 2), 4713211732490903930u);
  EXPECT_EQ(HashOf("corridor", 3), 18420040026808793177u);
  EXPECT_EQ(HashOf("dead_end", 1), 9752348642682940224u);
  EXPECT_EQ(HashOf("ditch", 2), 10829831396801452475u);
  EXPECT_EQ(HashOf("open", 3), 18044740347768466294u);
}

TEST(SimBits, DifferBySeed) {
  EXPECT_EQ(HashOf("rock_pile", 1), HashOf("rock_pile", 1));
  EXPECT_NE(HashOf("rock_pile", 1), HashOf("rock_pile", 2));
}

}  // namespace
}  // namespace hardpack::sim
