// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <span>

#include "core/base/assert.h"
#include "core/base/math.h"
#include "core/costmap/height_grid.h"
#include "core/scan/scan.h"
#include "hal/ouster/ouster.h"
#include "test/decision/lidar.h"
#include "test/decision/plan.h"
#include "test/decision/report.h"
#include "test/decision/storage.h"
#include "test/decision/world.h"

// From the bytes of lidar packets to a plan: the whole chain, one revolution a scene.

namespace hardpack::decision {
namespace {

struct Scene {
  const char* packets;  // names of the scenario's lines
  const char* heights;
  const char* costmap;
  const char* plan;
  Pose2 vehicle;
  Vec2 goal;
  World world;
  uint32_t seed = 1;
};

// A fence and a boat leave a gap; the goal lies behind it ([OS], the third experiment).
//            | fence
//    o ->         gap      x goal
//            [boat]
constexpr Box kGapBoxes[] = {
    {{14.0f, 2.0f, 0.0f}, {14.3f, 14.0f, 1.4f}},
    {{13.0f, -9.0f, 0.0f}, {17.0f, -3.0f, 1.9f}},
};

// Rocks with a skirt of bushes, a tree and a low branch that may be driven under.
constexpr Cylinder kRocks[] = {
    {{10.0f, 1.0f}, 1.5f, 1.2f},
    {{11.5f, -0.5f}, 1.2f, 0.9f},
    {{9.0f, 0.0f}, 2.6f, 0.6f, ReturnClass::kSoft},
    {{12.5f, -1.0f}, 2.4f, 0.7f, ReturnClass::kSoft},
    {{4.0f, 7.0f}, 0.25f, 6.0f},
};
constexpr Box kBranch[] = {{{5.0f, -4.0f, 2.4f}, {5.4f, 4.0f, 2.9f}}};

// The goal is behind the vehicle: a turn on the spot comes first. A person stands near the way.
constexpr Cylinder kPerson[] = {{{-2.0f, -4.5f}, 0.3f, 1.7f, ReturnClass::kPerson}};
constexpr Box kShed[] = {{{2.5f, -3.0f, 0.0f}, {6.0f, 3.0f, 2.5f}}};

// Walled in on all sides: there is no way.
constexpr Box kYard[] = {
    {{-9.0f, -9.0f, 0.0f}, {9.0f, -8.5f, 2.0f}},
    {{-9.0f, 8.5f, 0.0f}, {9.0f, 9.0f, 2.0f}},
    {{-9.0f, -9.0f, 0.0f}, {-8.5f, 9.0f, 2.0f}},
    {{8.5f, -9.0f, 0.0f}, {9.0f, 9.0f, 2.0f}},
};

const Scene kScenes[] = {
    {"gap.packets",
     "gap.heights",
     "gap.costmap",
     "gap.plan",
     {1.3f, -0.4f, 0.2f},
     {26.0f, 1.0f},
     {kGapBoxes, {}},
     0x5eed0010u},
    {"rocks.packets",
     "rocks.heights",
     "rocks.costmap",
     "rocks.plan",
     {-1.7f, 0.9f, -0.1f},
     {20.0f, -1.0f},
     {kBranch, kRocks},
     0x5eed0011u},
    {"behind.packets",
     "behind.heights",
     "behind.costmap",
     "behind.plan",
     {0.1f, 0.2f, 0.5f},
     {-12.0f, -6.0f},
     {kShed, kPerson},
     0x5eed0012u},
    {"yard.packets",
     "yard.heights",
     "yard.costmap",
     "yard.plan",
     {0.5f, -0.5f, 3.0f},
     {20.0f, 10.0f},
     {kYard, {}},
     0x5eed0013u},
};

using SensorPoses = std::array<Transform3, kColumns>;

HP_BIG_MEMORY Storage<SyntheticLidar> g_lidar;
HP_BIG_MEMORY Storage<ScanRing> g_ring;
HP_BIG_MEMORY Storage<HeightGrid> g_heights;
HP_BIG_MEMORY Storage<LidarColumn> g_column;
HP_BIG_MEMORY Storage<SensorPoses> g_odom_from_sensor;

void AddStatus(Status status, DecisionHash& hash) {
  hash.AddU8(static_cast<uint8_t>(status));
}

void AddColumn(const LidarColumn& column, DecisionHash& hash) {
  hash.AddU64(column.timestamp_ns);
  hash.AddU32(column.measurement_id);
  hash.AddU32(column.frame_id);
  hash.AddU32(column.encoder_ticks);
  hash.AddU32(column.status);
  hash.AddU8(column.valid);
  for (int row = 0; row < column.beams; ++row) {
    hash.AddU32(column.range_mm[row]);
    hash.AddU32(column.signal[row]);
    hash.AddU32(column.reflectivity[row]);
    hash.AddU32(column.near_ir[row]);
    hash.AddU8(column.flags[row]);
  }
}

// The vehicle drives 0.5 m straight on and turns a little during the revolution.
void PlaceSensor(const Pose2& vehicle, const LidarMountParams& mount,
                 SensorPoses& odom_from_sensor) {
  const Transform3 body_from_sensor = BodyFromSensor(mount);
  for (int column = 0; column < kColumns; ++column) {
    const float share = static_cast<float>(column - kColumns) / static_cast<float>(kColumns);
    const SinCosPair heading = SinCos(vehicle.theta_rad);
    const Pose2 pose{vehicle.x_m + heading.cos * 0.5f * share,
                     vehicle.y_m + heading.sin * 0.5f * share,
                     WrapAngle(vehicle.theta_rad + 0.02f * share)};
    odom_from_sensor[static_cast<size_t>(column)] =
        TransformFromPose(pose, 0.0f) * body_from_sensor;
  }
}

// Bytes to ring. What is wrong with a packet or column is part of what is decided.
void ReceivePackets(const Scene& scene, const SensorPoses& odom_from_sensor, SyntheticLidar& lidar,
                    ScanRing& ring, DecisionHash& hash) {
  ouster::PacketLayout layout;
  ouster::PacketHeader header;
  AddStatus(ouster::MakeLayout(lidar.metadata(), layout), hash);
  LidarColumn& column = g_column.Construct();
  for (int packet = 0; packet < kPackets; ++packet) {
    lidar.MakePacket(scene.world, odom_from_sensor, packet);
    const std::span<const uint8_t> bytes = lidar.packet();
    AddStatus(ouster::CheckPacket(layout, lidar.metadata(), bytes.first(bytes.size() - 1), header),
              hash);
    AddStatus(ouster::CheckPacket(layout, lidar.metadata(), bytes, header), hash);
    for (int index = 0; index < kColumnsPerPacket; ++index) {
      AddStatus(ouster::DecodeColumn(layout, bytes, index, column), hash);
      AddColumn(column, hash);
      AddStatus(ring.Push(column, odom_from_sensor[column.measurement_id], ReturnClass::kHard),
                hash);
      AddStatus(ring.Label(lidar.labels()[static_cast<size_t>(index)]), hash);
    }
  }
}

// Ring to heights, the vehicle's own returns left out.
void FileReturns(const BeamModel& model, const LidarMountParams& mount, const ScanRing& ring,
                 HeightGrid& heights, DecisionHash& hash) {
  const Transform3 body_from_sensor = BodyFromSensor(mount);
  for (int slot = 0; slot < ring.columns(); ++slot) {
    if (!ring.column(slot).present) continue;
    const SinCosPair encoder = EncoderSinCos(model, slot);
    for (int row = 0; row < ring.beams(); ++row) {
      const PackedReturn point = ring.at(slot, row);
      if (point.range_mm() == 0) continue;
      const Vec3 in_sensor = PointInSensor(model, encoder, row, point.range_mm());
      const float range_m = static_cast<float>(point.range_mm()) * 0.001f;
      if (IsSelfReturn(mount, body_from_sensor.Apply(in_sensor), range_m)) continue;
      const Vec3 in_odom = ring.column(slot).odom_from_sensor.Apply(in_sensor);
      AddStatus(heights.Insert(in_odom, point.return_class()), hash);
    }
  }
}

void AddHeights(const HeightGrid& heights, DecisionHash& hash) {
  for (int index = 0; index < kMapCells; ++index) {
    const HeightGrid::CellHeights cell = heights.At(heights.window().FromIndex(index));
    if (cell.lowest_cm == HeightGrid::kNone) continue;
    hash.AddI32(index);
    hash.AddI32(cell.lowest_cm);
    hash.AddI32(cell.lowest_hard_cm);
    hash.AddI32(cell.highest_hard_cm);
    hash.AddI32(cell.highest_soft_cm);
    hash.AddU8(cell.person);
  }
}

void RunScene(const Scene& scene, Report& report) {
  const LidarMountParams mount;
  SensorPoses& odom_from_sensor = g_odom_from_sensor.Construct();
  PlaceSensor(scene.vehicle, mount, odom_from_sensor);

  SyntheticLidar& lidar = g_lidar.Construct();
  ScanRing& ring = g_ring.Construct();
  DecisionHash packets;
  AddStatus(lidar.Configure(scene.seed), packets);
  AddStatus(ring.Configure(kBeams, kColumns), packets);
  ReceivePackets(scene, odom_from_sensor, lidar, ring, packets);
  report.Add(scene.packets, packets);

  HeightGrid& heights = g_heights.Construct();
  DecisionHash filed;
  AddStatus(heights.Reset({scene.vehicle.x_m, scene.vehicle.y_m}), filed);
  FileReturns(lidar.model(), mount, ring, heights, filed);
  AddHeights(heights, filed);
  report.Add(scene.heights, filed);

  PlanRequest request;
  request.start = {scene.vehicle, 0.05f, 1.5f};
  request.goal_odom = scene.goal;
  PlanOnHeights(heights, request, {scene.costmap, scene.plan}, report);
}

}  // namespace

void RunScenes(Report& report) {
  for (const Scene& scene : kScenes) RunScene(scene, report);
}

}  // namespace hardpack::decision
