// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "hal/ouster/ouster.h"
#include "port_linux/files/ouster_metadata.h"
#include "tools/sim/script/script.h"
#include "tools/sim/script/scripted_vehicle.h"

// What the script's events make of the lidar's datagrams, as the library's own codec reads them.

namespace hardpack::sim {
namespace {

struct Said {
  int columns = 0;
  int invalid = 0;
  std::vector<LidarColumn> valid;  // of the last revolution
};

class LidarFaultsTest : public ::testing::TestWithParam<LidarProfile> {
 protected:
  void SetUp() override {
    ScriptedVehicleSettings settings;
    settings.lidar.columns = 512;
    settings.lidar.profile = GetParam();
    vehicle_ = std::make_unique<ScriptedVehicle>(settings, std::vector<ScriptEvent>(), 0);
    ASSERT_TRUE(
        ouster::ParseMetadata(vehicle_->lidar().MetadataJson(), "simulated", metadata_).ok());
    ASSERT_EQ(ouster::MakeLayout(metadata_, layout_), Status::kOk);
  }

  void Act(const std::string& line) {
    std::vector<ScriptEvent> events;
    ASSERT_TRUE(ParseScript("at 0 " + line, "test", events).ok()) << line;
    for (const ScriptEvent& event : events) event.act(*vehicle_);
  }

  // What a revolution says.
  Said Revolution() {
    now_ns_ += 100'000'000;
    Outgoing out;
    vehicle_->Advance(now_ns_, out);
    Said said;
    LidarColumn column;
    for (const SensorDatagram& datagram : out.datagrams) {
      if (datagram.sensor != Sensor::kLidar) continue;
      for (int i = 0; i < layout_.columns_per_packet; ++i) {
        ++said.columns;
        if (IsUsable(ouster::DecodeColumn(layout_, datagram.bytes, i, column))) {
          said.valid.push_back(column);
        } else {
          ++said.invalid;
        }
      }
    }
    return said;
  }

  // Degrees from ahead, anticlockwise.
  static double Angle_deg(const LidarColumn& column) {
    return 180.0 - 360.0 * column.measurement_id / 512.0;
  }

  std::unique_ptr<ScriptedVehicle> vehicle_;
  ouster::Metadata metadata_;
  ouster::PacketLayout layout_;
  uint64_t now_ns_ = 0;
};

TEST_P(LidarFaultsTest, LosesPacketsOfASector) {
  Revolution();
  Act("lidar-blind -46 46 lost");
  const Said said = Revolution();
  EXPECT_EQ(said.invalid, 0);
  EXPECT_LT(said.columns, 512 - 125);
  for (const LidarColumn& column : said.valid) {
    EXPECT_GT(std::fabs(Angle_deg(column)), 45.9) << column.measurement_id;
  }
  Act("lidar-blind 0 0 none");
  EXPECT_EQ(Revolution().columns, 512);
}

TEST_P(LidarFaultsTest, MarksColumnsInvalid) {
  Revolution();
  Act("lidar-blind 30 90 invalid");
  const Said said = Revolution();
  EXPECT_EQ(said.columns, 512);
  EXPECT_NEAR(said.invalid, 512 / 6, 2);
  for (const LidarColumn& column : said.valid) {
    EXPECT_GT(std::fabs(Angle_deg(column) - 60.0), 29.9);
  }
}

TEST_P(LidarFaultsTest, CoversTheWindow) {
  for (const std::string how : {"dark", "covered"}) {
    Revolution();
    Act("lidar-blind 170 -170 " + how);
    for (const LidarColumn& column : Revolution().valid) {
      if (column.measurement_id == 0) continue;  // cast at the moment before
      const bool is_behind = std::fabs(Angle_deg(column)) >= 170.0;
      const uint32_t most = *std::max_element(column.range_mm, column.range_mm + SimLidar::kBeams);
      EXPECT_EQ(is_behind, most < 100u) << Angle_deg(column);
      if (!is_behind) continue;
      EXPECT_EQ(most > 0u, how == "covered");
    }
  }
}

TEST_P(LidarFaultsTest, FreezesTheImage) {
  Revolution();
  const Said before = Revolution();
  Act("lidar-frozen on");
  const Said after = Revolution();
  ASSERT_EQ(before.valid.size(), after.valid.size());
  for (size_t i = 1; i < after.valid.size(); ++i) {  // the first was cast the moment before
    const LidarColumn& a = before.valid[i];
    const LidarColumn& b = after.valid[i];
    EXPECT_TRUE(std::equal(a.range_mm, a.range_mm + SimLidar::kBeams, b.range_mm));
    EXPECT_NE(a.frame_id, b.frame_id);
    EXPECT_LT(a.timestamp_ns, b.timestamp_ns);
  }
  Act("lidar-frozen off");
  const Said again = Revolution();
  EXPECT_FALSE(std::equal(after.valid[1].range_mm, after.valid[1].range_mm + SimLidar::kBeams,
                          again.valid[1].range_mm));
}

// The lowest beam ahead meets the ground nearer once the nose of the sensor is down.
TEST_P(LidarFaultsTest, TurnsTheMount) {
  const auto ahead_m = [&] {
    for (const LidarColumn& column : Revolution().valid) {
      if (std::fabs(Angle_deg(column)) < 0.4) return 0.001 * column.range_mm[SimLidar::kBeams - 1];
    }
    return 0.0;
  };
  Revolution();
  const double level_m = ahead_m();
  Act("lidar-turned 0 5 0");
  const double down_m = ahead_m();
  EXPECT_NEAR(down_m / level_m, std::sin(16.6 * M_PI / 180.0) / std::sin(21.6 * M_PI / 180.0),
              0.03);
  Act("lidar-turned 0 0 0");
  EXPECT_NEAR(ahead_m(), level_m, 0.05);
}

TEST_P(LidarFaultsTest, PutsABoxAhead) {
  Revolution();
  Act("box-ahead 5 0 2 2");
  double nearest_m = 100.0;
  for (const LidarColumn& column : Revolution().valid) {
    if (std::fabs(Angle_deg(column)) > 5.0) continue;
    nearest_m = std::min(nearest_m, 0.001 * column.range_mm[SimLidar::kBeams / 2]);
  }
  EXPECT_NEAR(nearest_m, 4.0, 0.1);
}

// Two vehicles at one place, so that each ray of one has the same truth as that of the other.
class LidarWeatherTest : public ::testing::TestWithParam<LidarProfile> {
 protected:
  void SetUp() override {
    ScriptedVehicleSettings settings;
    settings.world = LaneWorld();
    settings.lidar = NoisyLidar();
    settings.lidar.columns = 512;
    settings.lidar.profile = GetParam();
    dry_ = std::make_unique<ScriptedVehicle>(settings, std::vector<ScriptEvent>(), 0);
    wet_ = std::make_unique<ScriptedVehicle>(settings, std::vector<ScriptEvent>(), 0);
    ouster::Metadata metadata;
    ASSERT_TRUE(ouster::ParseMetadata(wet_->lidar().MetadataJson(), "simulated", metadata).ok());
    ASSERT_EQ(ouster::MakeLayout(metadata, layout_), Status::kOk);
  }

  void Act(const std::string& line) {
    std::vector<ScriptEvent> events;
    ASSERT_TRUE(ParseScript("at 0 " + line, "test", events).ok()) << line;
    for (const ScriptEvent& event : events) event.act(*wet_);
  }

  void Run() {
    now_ns_ += 100'000'000;
    dry_out_ = {};
    wet_out_ = {};
    dry_->Advance(now_ns_, dry_out_);
    wet_->Advance(now_ns_, wet_out_);
  }

  std::vector<LidarColumn> Columns(const Outgoing& out) const {
    std::vector<LidarColumn> columns;
    for (const SensorDatagram& datagram : out.datagrams) {
      if (datagram.sensor != Sensor::kLidar) continue;
      for (int i = 0; i < layout_.columns_per_packet; ++i) {
        columns.emplace_back();
        EXPECT_TRUE(IsUsable(ouster::DecodeColumn(layout_, datagram.bytes, i, columns.back())));
      }
    }
    return columns;
  }

  bool SaysTheSame() const {
    if (dry_out_.datagrams.size() != wet_out_.datagrams.size()) return false;
    for (size_t i = 0; i < dry_out_.datagrams.size(); ++i) {
      if (dry_out_.datagrams[i].bytes != wet_out_.datagrams[i].bytes) return false;
    }
    return true;
  }

  // Of the last revolution, the column that was cast the moment before left out.
  struct Counts {
    int rays = 0;
    int returns = 0;  // in truth
    int nearer = 0;   // seen in the air
    int lost = 0;
    double nearest_m = 1000.0;  // of what is seen in the air
    double farthest_m = 0.0;
    bool is_faint = true;  // each of them
  };

  Counts Count(double from_deg = -180.0, double to_deg = 180.0) const {
    Counts counts;
    const std::vector<LidarColumn> dry = Columns(dry_out_);
    const std::vector<LidarColumn> wet = Columns(wet_out_);
    EXPECT_EQ(dry.size(), wet.size());
    for (size_t i = 1; i < dry.size() && i < wet.size(); ++i) {
      const double angle_deg = 180.0 - 360.0 * dry[i].measurement_id / 512.0;
      if (angle_deg < from_deg || angle_deg > to_deg) continue;
      for (int beam = 0; beam < SimLidar::kBeams; ++beam) {
        Count(dry[i].range_mm[beam], wet[i].range_mm[beam],
              wet[i].signal[beam] < 1200 && wet[i].reflectivity[beam] < 5, counts);
      }
    }
    return counts;
  }

  static void Count(uint32_t truth_mm, uint32_t said_mm, bool is_faint, Counts& counts) {
    ++counts.rays;
    counts.returns += truth_mm > 0 ? 1 : 0;
    counts.lost += truth_mm > 0 && said_mm == 0 ? 1 : 0;
    if (said_mm == truth_mm || said_mm == 0) return;
    ++counts.nearer;
    EXPECT_TRUE(truth_mm == 0 || said_mm < truth_mm);
    counts.nearest_m = std::min(counts.nearest_m, 0.001 * said_mm);
    counts.farthest_m = std::max(counts.farthest_m, 0.001 * said_mm);
    counts.is_faint = counts.is_faint && is_faint;
  }

  std::unique_ptr<ScriptedVehicle> dry_;
  std::unique_ptr<ScriptedVehicle> wet_;
  Outgoing dry_out_;
  Outgoing wet_out_;
  ouster::PacketLayout layout_;
  uint64_t now_ns_ = 0;
};

TEST_P(LidarWeatherTest, RainIsSeenInItsShareOfTheRays) {
  Run();
  Act("lidar-rain 20");
  Run();
  const Counts counts = Count();
  EXPECT_NEAR(1.0 * counts.nearer / counts.rays, 0.020, 0.003);
  EXPECT_NEAR(1.0 * counts.lost / counts.returns, LidarWeather::kRainLost, 0.004);
  EXPECT_GE(counts.nearest_m, 0.999);
  EXPECT_GT(counts.farthest_m, 10.0);
  EXPECT_LE(counts.farthest_m, 12.001);
  EXPECT_TRUE(counts.is_faint);
}

// A drop falls on: what a revolution sees of it the next one does not see again.
TEST_P(LidarWeatherTest, RainIsElsewhereInTheNextRevolution) {
  Run();
  Act("lidar-rain 100");
  std::vector<int> seen(512 * SimLidar::kBeams);
  for (int revolution = 0; revolution < 2; ++revolution) {
    Run();
    const std::vector<LidarColumn> dry = Columns(dry_out_);
    const std::vector<LidarColumn> wet = Columns(wet_out_);
    for (size_t i = 1; i < dry.size(); ++i) {
      for (size_t beam = 0; beam < SimLidar::kBeams; ++beam) {
        const uint32_t said_mm = wet[i].range_mm[beam];
        const bool drop = said_mm != dry[i].range_mm[beam] && said_mm != 0;
        seen[dry[i].measurement_id * SimLidar::kBeams + beam] += drop ? 1 : 0;
      }
    }
  }
  const auto twice = std::count(seen.begin(), seen.end(), 2);
  EXPECT_NEAR(static_cast<double>(twice) / static_cast<double>(seen.size()), 0.01, 0.003);
}

TEST_P(LidarWeatherTest, DustIsInItsSectorAndNoFurtherThanItsCloud) {
  Run();
  Act("lidar-dust 120 -120 6 300");  // behind
  Run();
  const Counts ahead = Count(-119.0, 119.0);
  EXPECT_EQ(ahead.nearer, 0);
  EXPECT_EQ(ahead.lost, 0);
  const Counts left = Count(121.0, 180.0);
  EXPECT_NEAR(1.0 * left.nearer / left.rays, 0.3, 0.02);
  EXPECT_GE(left.nearest_m, 1.499);
  EXPECT_LE(left.farthest_m, 6.001);
  EXPECT_TRUE(left.is_faint);
  EXPECT_EQ(left.lost, 0);
}

TEST_P(LidarWeatherTest, DustOfAWholeTurnIsAllAround) {
  Run();
  Act("lidar-dust -180 180 3 1000");
  Run();
  const Counts counts = Count();
  EXPECT_EQ(counts.nearer, counts.rays);
  EXPECT_LE(counts.farthest_m, 3.001);
}

TEST_P(LidarWeatherTest, WhenItIsOverTheBytesAreAsIfThereHadBeenNone) {
  Run();
  EXPECT_TRUE(SaysTheSame());
  Act("lidar-rain 50");
  Act("lidar-dust -30 30 5 200");
  Run();
  EXPECT_FALSE(SaysTheSame());
  Act("lidar-rain 0");
  Act("lidar-dust -30 30 5 0");
  Run();  // the first column of it was cast the moment before
  Run();
  EXPECT_TRUE(SaysTheSame());
}

TEST(LidarFaultsScript, RefusesWhatIsNone) {
  for (const char* line :
       {"lidar-blind 1 2", "lidar-blind 1 2 odd", "lidar-blind a 2 lost", "lidar-frozen 1",
        "lidar-rain 1001", "lidar-rain -1", "lidar-rain", "lidar-dust 0 10 5",
        "lidar-dust 0 10 1 100", "lidar-dust 0 10 5 1001", "lidar-turned 1 2",
        "lidar-turned 0 200 0", "labels-are 256", "labels-mistake 1", "box-ahead 1 0 0 1"}) {
    std::vector<ScriptEvent> events;
    EXPECT_FALSE(ParseScript(std::string("at 0 ") + line, "test", events).ok()) << line;
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, LidarWeatherTest,
                         ::testing::Values(LidarProfile::kLegacy, LidarProfile::kRng19));
INSTANTIATE_TEST_SUITE_P(Profiles, LidarFaultsTest,
                         ::testing::Values(LidarProfile::kLegacy, LidarProfile::kRng19));

}  // namespace
}  // namespace hardpack::sim
