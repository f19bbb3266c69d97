// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sensors/sim_lidar.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>

#include "core/scan/scan.h"
#include "gtest/gtest.h"
#include "hal/ouster/ouster.h"
#include "port_linux/files/ouster_metadata.h"

// The packets read with the library's own codec and geometry, and what they show held against rays
// that are cast the slow way: against planes, in three dimensions.

namespace hardpack::sim {
namespace {

//        y
//        |   [A] box 2 x 2 x 1.2 m at (8, 3)
//   -----+------> x
//        |  (B) post of 0.3 m radius at (5, -2);  [C] a beam across the way, 1.8 .. 2.4 m high, x =
//        6
constexpr world::Material kThing = {world::Label::kObject, world::Matter::kSolid, 1.0};

world::World TestWorld() {
  world::World made;
  made.AddBox({8.0, 3.0}, 0.0, 2.0, 2.0, -0.5, 1.2, kThing);
  made.AddBox({6.2, 0.0}, 0.0, 0.4, 2.0, 1.8, 2.4, kThing);
  made.AddCylinder({5.0, -2.0}, 0.3, -0.5, 3.0, kThing);
  return made;
}

// The nearest of what the ray from `origin` meets: points along it, tried one by one.
double SlowRange_m(const Vec3& origin, const Vec3& direction) {
  constexpr double kStep_m = 0.002;
  for (double t = 0.0; t < 60.0; t += kStep_m) {
    const double x_m = origin.x_m + t * direction.x_m;
    const double y_m = origin.y_m + t * direction.y_m;
    const double z_m = origin.z_m + t * direction.z_m;
    const auto in_box = [&](double middle_x_m, double middle_y_m, double half_x_m, double half_y_m,
                            double low_m, double high_m) {
      return std::abs(x_m - middle_x_m) <= half_x_m && std::abs(y_m - middle_y_m) <= half_y_m &&
             z_m >= low_m && z_m <= high_m;
    };
    if (z_m <= 0.0 || in_box(8.0, 3.0, 1.0, 1.0, -0.5, 1.2) ||
        in_box(6.2, 0.0, 0.2, 1.0, 1.8, 2.4) ||
        (std::hypot(x_m - 5.0, y_m + 2.0) <= 0.3 && z_m <= 3.0)) {
      return t;
    }
  }
  return -1.0;
}

// On level ground.
world::BodyPose At(double x_m, double y_m, double yaw_rad) {
  return {{x_m, y_m, 0.0}, 0.0, 0.0, yaw_rad};
}

struct Decoder {
  ouster::Metadata metadata;
  ouster::PacketLayout layout;
  std::unique_ptr<BeamModel> model = std::make_unique<BeamModel>();

  explicit Decoder(const SimLidar& lidar) {
    EXPECT_TRUE(ouster::ParseMetadata(lidar.MetadataJson(), "simulated", metadata).ok());
    EXPECT_EQ(ouster::MakeLayout(metadata, layout), hardpack::Status::kOk);
    EXPECT_EQ(MakeBeamModel({metadata.beam_altitude_deg, 64}, {metadata.beam_azimuth_deg, 64},
                            metadata.columns_per_frame, metadata.lidar_origin_to_beam_origin_m,
                            metadata.sensor_from_lidar, *model),
              hardpack::Status::kOk);
  }

  // Checked and decoded, or nothing.
  std::vector<LidarColumn> Columns(const std::vector<uint8_t>& packet) const {
    ouster::PacketHeader header;
    EXPECT_EQ(ouster::CheckPacket(layout, metadata, packet, header), hardpack::Status::kOk);
    std::vector<LidarColumn> columns(SimLidar::kColumnsPerPacket);
    for (int i = 0; i < SimLidar::kColumnsPerPacket; ++i) {
      EXPECT_EQ(ouster::DecodeColumn(layout, packet, i, columns[static_cast<size_t>(i)]),
                hardpack::Status::kOk);
    }
    return columns;
  }
};

std::vector<std::vector<uint8_t>> Revolution(SimLidar& lidar, const world::BodyPose& pose,
                                             const world::World& world, uint64_t start_ns = 0) {
  std::vector<std::vector<uint8_t>> packets;
  const auto period_ns = 1'000'000'000u / static_cast<uint64_t>(lidar.settings().revolutions_per_s);
  for (uint64_t ns = 0; ns < period_ns; ns += 1'000'000) {
    lidar.Advance(start_ns + ns, pose, world, packets);
  }
  return packets;
}

Transform3 WorldFromSensor(const LidarSettings& settings, const world::BodyPose& pose) {
  const auto place = [](double value) { return static_cast<float>(value); };
  const Transform3 world_from_body = TransformFromRollPitchYaw(
      place(pose.roll_rad), place(pose.pitch_rad), place(pose.yaw_rad),
      {place(pose.position.x_m), place(pose.position.y_m), place(pose.position.z_m)});
  const Transform3 body_from_sensor =
      TransformFromRollPitchYaw(0.0f, 0.0f, static_cast<float>(settings.yaw_rad),
                                {static_cast<float>(settings.x_m), static_cast<float>(settings.y_m),
                                 static_cast<float>(settings.z_m)});
  return world_from_body * body_from_sensor;
}

void ExpectRangesOf(const LidarSettings& settings, const world::BodyPose& pose) {
  SimLidar lidar(settings, 0);
  const Decoder decoder(lidar);
  const world::World world = TestWorld();
  const Transform3 to_world = WorldFromSensor(settings, pose);
  int returns = 0;
  for (const auto& packet : Revolution(lidar, pose, world)) {
    for (const LidarColumn& column : decoder.Columns(packet)) {
      const SinCosPair encoder = EncoderSinCos(*decoder.model, column.measurement_id);
      for (int row = column.measurement_id % 7; row < SimLidar::kBeams; row += 7) {
        // A ray through two points of the beam.
        const Vec3 near = to_world.Apply(PointInSensor(*decoder.model, encoder, row, 12));
        const Vec3 far = to_world.Apply(PointInSensor(*decoder.model, encoder, row, 100'012));
        const Vec3 direction = {(far.x_m - near.x_m) / 100.0f, (far.y_m - near.y_m) / 100.0f,
                                (far.z_m - near.z_m) / 100.0f};
        const double expected_m = SlowRange_m(near, direction);
        const double range_m = 0.001 * column.range_mm[row] - 0.012;
        if (column.range_mm[row] == 0 || range_m > 50.0) {
          ASSERT_TRUE(expected_m < 0.0 || expected_m > 49.0) << column.measurement_id << " " << row;
          continue;
        }
        ++returns;
        // Grazing an edge, or the ground at the end of its reach, a step decides.
        const bool agrees = std::abs(range_m - expected_m) < 0.01;
        const bool beside =
            std::abs(SlowRange_m({near.x_m, near.y_m + 0.004f, near.z_m + 0.004f}, direction) -
                     range_m) < 0.25 ||
            std::abs(SlowRange_m({near.x_m, near.y_m - 0.004f, near.z_m - 0.004f}, direction) -
                     range_m) < 0.25;
        ASSERT_TRUE(agrees || beside) << "column " << column.measurement_id << " row " << row
                                      << ": " << range_m << " m, expected " << expected_m;
      }
    }
  }
  EXPECT_GT(returns, 1000);
}

LidarSettings Coarse() {
  LidarSettings settings;
  settings.columns = 512;
  settings.noise_m = 0.0;
  return settings;
}

TEST(SimLidar, ShowsTheWorldAsRaysInSpaceDo) {
  ExpectRangesOf(Coarse(), {});
}

TEST(SimLidar, ShowsItFromWhereTheVehicleIsAndTheSensorLooks) {
  LidarSettings settings = Coarse();
  settings.profile = LidarProfile::kRng19;
  settings.yaw_rad = M_PI;
  settings.x_m = 0.4;
  settings.z_m = 1.0;
  ExpectRangesOf(settings, {{2.0, -0.7, 0.1}, 0.05, -0.08, 0.8});
}

TEST(SimLidar, SendsWholeRevolutionsAtItsRate) {
  for (const auto& [columns, rate] : {std::pair{512, 10}, {1024, 10}, {1024, 20}, {2048, 10}}) {
    LidarSettings settings;
    settings.columns = columns;
    settings.revolutions_per_s = rate;
    SimLidar lidar(settings, 0);
    const Decoder decoder(lidar);
    std::vector<std::vector<uint8_t>> packets;
    for (uint64_t ns = 0; ns <= 500'000'000; ns += 1'000'000) {
      lidar.Advance(ns, {}, {}, packets);
    }
    const int expected = columns / 16 * rate / 2;
    EXPECT_NEAR(static_cast<double>(packets.size()), expected, 1.0);
    int id = 0;
    for (const auto& packet : packets) {
      for (const LidarColumn& column : decoder.Columns(packet)) {
        ASSERT_EQ(column.measurement_id, id % columns);
        ASSERT_EQ(column.frame_id, id / columns);
        const auto time_ns = static_cast<double>(column.timestamp_ns - settings.clock_start_ns);
        ASSERT_NEAR(time_ns, 1.0e9 * id / (columns * rate), 1.0);
        ++id;
      }
    }
  }
}

TEST(SimLidar, SmearsARevolutionAlongTheWay) {
  LidarSettings settings = Coarse();
  SimLidar lidar(settings, 0);
  const Decoder decoder(lidar);
  world::World wall;  // 20 m behind; the lidar frame's m = 0 looks backward
  wall.AddBox({-20.5, 0.0}, 0.0, 1.0, 60.0, -0.5, 5.0, kThing);
  std::vector<std::vector<uint8_t>> packets;
  for (uint64_t ms = 0; ms <= 110; ++ms) {
    lidar.Advance(ms * 1'000'000, At(0.005 * static_cast<double>(ms), 0.0, 0.0), wall, packets);
  }
  const int row = 31;  // nearly level
  const LidarColumn first = decoder.Columns(packets[0])[0];
  const LidarColumn next = decoder.Columns(packets[32])[0];
  ASSERT_EQ(next.measurement_id, 0);
  EXPECT_NEAR(next.range_mm[row] - static_cast<double>(first.range_mm[row]), 500.0, 6.0);
}

TEST(SimLidar, BeginsANewAfterARestart) {
  LidarSettings settings = Coarse();
  settings.profile = LidarProfile::kRng19;
  SimLidar lidar(settings, 0);
  const Decoder decoder(lidar);
  Revolution(lidar, {}, {});
  lidar.Restart(100'000'000);
  const auto packets = Revolution(lidar, {}, {}, 100'000'000);
  ouster::PacketHeader header;
  EXPECT_EQ(ouster::CheckPacket(decoder.layout, decoder.metadata, packets[0], header),
            hardpack::Status::kSensorRestarted);
  EXPECT_EQ(header.frame_id, 0);
}

// A wall 10 m to the front: what a level beam says of it, again and again.
std::vector<double> RangesOfAWall(const LidarSettings& settings, double wall_m) {
  SimLidar lidar(settings, 0);
  const Decoder decoder(lidar);
  world::World wall;
  wall.AddBox({wall_m + 0.5, 0.0}, 0.0, 1.0, 200.0, -0.5, 30.0, kThing);
  std::vector<double> errors_m;
  for (const auto& packet : Revolution(lidar, {}, wall)) {
    for (const LidarColumn& column : decoder.Columns(packet)) {
      const SinCosPair encoder = EncoderSinCos(*decoder.model, column.measurement_id);
      for (int row = 0; row < SimLidar::kBeams; ++row) {
        const Vec3 near = PointInSensor(*decoder.model, encoder, row, 100'000);
        if (near.x_m < 99.0f || near.z_m < 0.0f) continue;  // square on, and no ground
        const float share = static_cast<float>(wall_m) / near.x_m;
        const double range_m = 0.001 * column.range_mm[row];
        errors_m.push_back(column.range_mm[row] == 0 ? -1.0 : range_m - 100.0 * double{share});
      }
    }
  }
  return errors_m;
}

TEST(SimLidar, ErrsByRangeAsItIsToldTo) {
  for (const double wall_m : {5.0, 50.0}) {
    LidarSettings settings = NoisyLidar();
    settings.drop_out_share = 0.0;
    const std::vector<double> errors_m = RangesOfAWall(settings, wall_m);
    ASSERT_GT(errors_m.size(), 200u);
    double squares_m2 = 0.0;
    for (const double error_m : errors_m) squares_m2 += error_m * error_m;
    const double expected_m = settings.noise_m + settings.noise_per_m * wall_m;
    EXPECT_NEAR(std::sqrt(squares_m2 / static_cast<double>(errors_m.size())), expected_m,
                0.2 * expected_m);
  }
}

TEST(SimLidar, DropsAsManyAsItIsToldTo) {
  LidarSettings settings;
  settings.drop_out_share = 0.2;
  const std::vector<double> errors_m = RangesOfAWall(settings, 10.0);
  const auto lost = std::count(errors_m.begin(), errors_m.end(), -1.0);
  const auto all = static_cast<double>(errors_m.size());
  EXPECT_NEAR(static_cast<double>(lost) / all, 0.2, 4.0 * std::sqrt(0.16 / all));
}

// The beams of a real sensor, through its metadata and back.
TEST(SimLidar, TakesTheBeamsOfARealSensor) {
  const char* data = std::getenv("HARDPACK_DATA");
  const std::string path = std::string(data != nullptr ? data : "") +
                           "/rellis/rellis_000104_os1-64_2048x10_legacy_reencoded.json";
  ouster::Metadata metadata;
  if (data == nullptr || !ouster::ReadMetadata(path, metadata).ok()) {
    GTEST_SKIP() << "no real metadata at " << path;
  }
  LidarSettings settings = Coarse();
  settings.beams = LidarBeams::Of(metadata);
  const SimLidar lidar(settings, 0);
  const Decoder decoder(lidar);
  for (size_t beam = 0; beam < 64; ++beam) {
    EXPECT_EQ(decoder.metadata.beam_altitude_deg[beam], metadata.beam_altitude_deg[beam]);
    EXPECT_EQ(decoder.metadata.beam_azimuth_deg[beam], metadata.beam_azimuth_deg[beam]);
  }
  EXPECT_EQ(decoder.metadata.lidar_origin_to_beam_origin_m, metadata.lidar_origin_to_beam_origin_m);
  ExpectRangesOf(settings, At(0.0, 0.0, 0.0));
}

}  // namespace
}  // namespace hardpack::sim
