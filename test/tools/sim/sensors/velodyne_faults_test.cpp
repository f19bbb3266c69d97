// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "test/tools/sim/sensors/velodyne_reader.h"
#include "tools/sim/script/script.h"
#include "tools/sim/script/scripted_vehicle.h"

// What the script's events make of a Velodyne's datagrams: the same as of an Ouster's
// (lidar_faults_test.cpp), but that its columns cannot be marked.

namespace hardpack::sim::velodyne {
namespace {

class VelodyneFaultsTest : public ::testing::TestWithParam<LidarModel> {
 protected:
  void SetUp() override {
    ScriptedVehicleSettings settings;
    settings.world = LaneWorld();
    settings.lidar = NoisyLidar(GetParam());
    settings.lidar.drop_out_share = 0.0;
    vehicle_ = std::make_unique<ScriptedVehicle>(settings, std::vector<ScriptEvent>(), 0);
    dry_ = std::make_unique<ScriptedVehicle>(settings, std::vector<ScriptEvent>(), 0);
  }

  void Act(const std::string& line) {
    std::vector<ScriptEvent> events;
    ASSERT_TRUE(ParseScript("at 0 " + line, "test", events).ok()) << line;
    for (const ScriptEvent& event : events) event.act(*vehicle_);
  }

  // What is said in a tenth of a second, less the first packet, which was begun before.
  static std::vector<Bytes> Packets(ScriptedVehicle& vehicle, uint64_t now_ns) {
    Outgoing out;
    vehicle.Advance(now_ns, out);
    std::vector<Bytes> packets;
    for (const SensorDatagram& datagram : out.datagrams) {
      if (datagram.sensor == Sensor::kLidar) packets.push_back(datagram.bytes);
    }
    EXPECT_GT(packets.size(), 20u);
    packets.erase(packets.begin());
    return packets;
  }

  std::vector<Sequence> Revolution() {
    now_ns_ += 100'000'000;
    dry_said_ = SequencesOf(Packets(*dry_, now_ns_), facts_);
    return SequencesOf(Packets(*vehicle_, now_ns_), facts_);
  }

  double Range_m(const Sequence& sequence, size_t laser) const {
    return 0.001 * facts_.unit_mm * sequence.distances[laser];
  }

  // Nearest of what a laser that looks nearly level says within 5 deg of ahead.
  double Ahead_m(const std::vector<Sequence>& said) const {
    double nearest_m = 1000.0;
    const size_t laser = facts_.lasers == 16 ? 14 : 10;  // -1 deg, or -0.333 deg
    for (const Sequence& sequence : said) {
      if (std::fabs(sequence.Ahead_deg()) > 5.0 || sequence.distances[laser] == 0) continue;
      nearest_m = std::min(nearest_m, Range_m(sequence, laser));
    }
    return nearest_m;
  }

  const Facts facts_ = FactsOf(GetParam());
  std::unique_ptr<ScriptedVehicle> vehicle_;
  std::unique_ptr<ScriptedVehicle> dry_;  // the same, and nothing happens to it
  std::vector<Sequence> dry_said_;
  uint64_t now_ns_ = 0;
};

TEST_P(VelodyneFaultsTest, LosesPacketsOfASector) {
  Revolution();
  Act("lidar-blind -46 46 lost");
  const auto said = Revolution();
  EXPECT_LT(said.size(), dry_said_.size() * 270 / 360);
  EXPECT_GT(said.size(), dry_said_.size() * 240 / 360);
  for (const Sequence& sequence : said) EXPECT_GT(std::fabs(sequence.Ahead_deg()), 45.8);
  Act("lidar-blind 0 0 none");
  Revolution();
  const auto again = Revolution();
  EXPECT_EQ(again.size(), dry_said_.size());
}

TEST_P(VelodyneFaultsTest, CoversTheWindow) {
  for (const std::string how : {"dark", "invalid", "covered"}) {
    Revolution();
    Act("lidar-blind 30 90 " + how);
    int inside = 0;
    const auto said = Revolution();
    EXPECT_EQ(said.size(), dry_said_.size()) << how;
    for (const Sequence& sequence : said) {
      const double from_middle_deg = std::fabs(sequence.Ahead_deg() - 60.0);
      if (std::fabs(from_middle_deg - 30.0) < 0.1) continue;  // at the edge
      const uint32_t most = *std::max_element(sequence.distances.begin(), sequence.distances.end());
      const bool is_inside = from_middle_deg < 30.0;
      inside += is_inside ? 1 : 0;
      EXPECT_EQ(is_inside, most * facts_.unit_mm < 100) << how << sequence.Ahead_deg();
      EXPECT_TRUE(!is_inside || (most > 0) == (how == "covered")) << how << sequence.Ahead_deg();
    }
    EXPECT_NEAR(inside, 1808 / 6, 4);
  }
}

TEST_P(VelodyneFaultsTest, FreezesTheImage) {
  Revolution();
  auto before = Revolution();
  const auto last = Revolution();
  before.insert(before.end(), last.begin(), last.end());
  Act("lidar-frozen on");
  Act("box-ahead 5 0 2 2");
  for (int revolution = 0; revolution < 3; ++revolution) {
    const auto frozen = Revolution();
    EXPECT_GT(Ahead_m(frozen), 6.0);
    for (size_t k = 0; k < frozen.size(); ++k) {
      const bool was_said = std::any_of(before.begin(), before.end(), [&](const Sequence& one) {
        const double apart_deg = std::fabs(one.azimuth_deg - frozen[k].azimuth_deg);
        return one.distances == frozen[k].distances && std::min(apart_deg, 360.0 - apart_deg) < 0.6;
      });
      // One packet at each of the joins of what was kept is left out there.
      EXPECT_TRUE(was_said || k < 48 || k + 48 > frozen.size()) << k;
    }
  }
  Act("lidar-frozen off");
  Revolution();
  EXPECT_NEAR(Ahead_m(Revolution()), 4.0, 0.1);
}

TEST_P(VelodyneFaultsTest, TurnsTheMount) {
  // 15 deg to the right of ahead: a revolution's first packet is not looked at.
  const double aside_rad = 15.0 * M_PI / 180.0;
  const auto lowest_m = [&] {
    for (const Sequence& sequence : Revolution()) {
      if (std::fabs(sequence.azimuth_deg - 15.0) < 0.2) return Range_m(sequence, 0);
    }
    return 0.0;
  };
  Revolution();
  const double level_m = lowest_m();
  Act("lidar-turned 0 5 0");
  const double turned_rad = 5.0 * M_PI / 180.0;
  const double altitude_rad = facts_.altitude_deg[0] * M_PI / 180.0;
  const double down = -std::sin(altitude_rad) * std::cos(turned_rad) +
                      std::cos(altitude_rad) * std::cos(aside_rad) * std::sin(turned_rad);
  EXPECT_NEAR(lowest_m() / level_m, -std::sin(altitude_rad) / down, 0.03);
  // Turned to the left, it says of what is ahead that it is to the right.
  Act("lidar-turned 90 0 0");
  Act("box-ahead 5 0 2 2");
  Revolution();
  double nearest_m = 1000.0;
  const size_t laser = facts_.lasers == 16 ? 14 : 10;
  for (const Sequence& sequence : Revolution()) {
    if (std::fabs(sequence.azimuth_deg - 90.0) > 5.0) continue;
    if (sequence.distances[laser] > 0) nearest_m = std::min(nearest_m, Range_m(sequence, laser));
  }
  EXPECT_NEAR(nearest_m, 4.0, 0.1);
}

TEST_P(VelodyneFaultsTest, RestartsAndJumps) {
  Revolution();
  Act("lidar-clock 250");
  EXPECT_NEAR(Revolution()[0].time_us - dry_said_[0].time_us, 250'000.0, 2.0);
  Act("lidar-clock -300");
  EXPECT_NEAR(Revolution()[0].time_us - dry_said_[0].time_us, -50'000.0, 2.0);
  Act("lidar-restart");
  EXPECT_NEAR(Revolution()[0].time_us, facts_.packet_us, 2.0);
}

TEST_P(VelodyneFaultsTest, RainAndDustAreInTheAir) {
  Revolution();
  Act("lidar-rain 20");
  const auto count = [&](double from_deg, double to_deg, double farthest_m) {
    const auto said = Revolution();
    EXPECT_EQ(said.size(), dry_said_.size());
    int rays = 0;
    int nearer = 0;
    for (size_t k = 0; k < said.size(); ++k) {
      if (said[k].Ahead_deg() < from_deg || said[k].Ahead_deg() > to_deg) continue;
      for (size_t laser = 0; laser < facts_.lasers; ++laser) {
        ++rays;
        if (said[k].distances[laser] == dry_said_[k].distances[laser]) continue;
        if (said[k].distances[laser] == 0) continue;
        ++nearer;
        EXPECT_LE(Range_m(said[k], laser), farthest_m + 0.003);
        EXPECT_LT(said[k].reflectivities[laser], 5u);
      }
    }
    return 1.0 * nearer / rays;
  };
  EXPECT_NEAR(count(-180.0, 180.0, 12.0), 0.020, 0.003);
  Act("lidar-rain 0");
  Act("lidar-dust 120 -120 6 300");
  Revolution();
  EXPECT_EQ(count(-119.0, 119.0, 6.0), 0.0);
  EXPECT_NEAR(count(121.0, 179.0, 6.0), 0.3, 0.02);
  Act("lidar-dust 120 -120 6 0");
  Revolution();
  const auto said = Revolution();
  for (size_t k = 0; k < said.size(); ++k) {
    ASSERT_EQ(said[k].distances, dry_said_[k].distances);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, VelodyneFaultsTest,
                         ::testing::Values(LidarModel::kVlp16, LidarModel::kVlp32c));

}  // namespace
}  // namespace hardpack::sim::velodyne
