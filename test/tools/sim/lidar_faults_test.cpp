// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "hal/ouster/ouster.h"
#include "port_linux/ouster_metadata.h"
#include "tools/sim/script.h"
#include "tools/sim/scripted_vehicle.h"

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

TEST(LidarFaultsScript, RefusesWhatIsNone) {
  for (const char* line : {"lidar-blind 1 2", "lidar-blind 1 2 odd", "lidar-blind a 2 lost",
                           "lidar-frozen 1", "lidar-turned 1 2", "lidar-turned 0 200 0",
                           "labels-are 256", "labels-mistake 1", "box-ahead 1 0 0 1"}) {
    std::vector<ScriptEvent> events;
    EXPECT_FALSE(ParseScript(std::string("at 0 ") + line, "test", events).ok()) << line;
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, LidarFaultsTest,
                         ::testing::Values(LidarProfile::kLegacy, LidarProfile::kRng19));

}  // namespace
}  // namespace hardpack::sim
