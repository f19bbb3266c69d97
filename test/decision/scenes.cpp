// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdint>
#include <span>

#include "core/autonomy/mapper.h"
#include "core/base/assert.h"
#include "core/base/math.h"
#include "core/timebase/timebase.h"
#include "hal/labels/labels.h"
#include "hal/ouster/ouster.h"
#include "test/decision/lidar.h"
#include "test/decision/map_hash.h"
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
  bool labelled = false;  // by a segmentation computer, which loses a datagram now and then
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
     0x5eed0011u,
     true},
    {"behind.packets",
     "behind.heights",
     "behind.costmap",
     "behind.plan",
     {0.1f, 0.2f, 0.5f},
     {-12.0f, -6.0f},
     {kShed, kPerson},
     0x5eed0012u,
     true},
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
HP_BIG_MEMORY Storage<Mapper> g_mapper;
HP_BIG_MEMORY Storage<Timebase> g_timebase;
HP_BIG_MEMORY Storage<LidarColumn> g_column;
HP_BIG_MEMORY Storage<ColumnLabels> g_labels;
HP_BIG_MEMORY Storage<SensorPoses> g_odom_from_sensor;

constexpr LabelTable kLabels = RellisLabelTable();

// A packet's labels, and their datagram.
using Codes = std::array<uint8_t, kColumnsPerPacket * kBeams>;
using LabelDatagram =
    std::array<uint8_t, labels::kHeaderBytes + std::tuple_size_v<Codes> + labels::kFooterBytes>;
HP_BIG_MEMORY Storage<Codes> g_codes;
HP_BIG_MEMORY Storage<LabelDatagram> g_label_datagram;

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

// Our clock when the revolution begins, and how far the vehicle is through its revolution: 0 at its
// end, -1 at its beginning.
constexpr uint64_t kHostStart_ns = 5'000'000'000u;
constexpr uint64_t kRevolution_ns = 100'000'000u;

// The vehicle drives 0.5 m straight on and turns a little during the revolution.
Pose2 PoseAt(const Pose2& vehicle, float share) {
  const SinCosPair heading = SinCos(vehicle.theta_rad);
  return {vehicle.x_m + heading.cos * 0.5f * share, vehicle.y_m + heading.sin * 0.5f * share,
          WrapAngle(vehicle.theta_rad + 0.02f * share)};
}

void PlaceSensor(const Pose2& vehicle, const LidarMountParams& mount,
                 SensorPoses& odom_from_sensor) {
  const Transform3 body_from_sensor = BodyFromSensor(mount);
  for (int column = 0; column < kColumns; ++column) {
    const float share = static_cast<float>(column - kColumns) / static_cast<float>(kColumns);
    odom_from_sensor[static_cast<size_t>(column)] =
        TransformFromPose(PoseAt(vehicle, share), 0.0f) * body_from_sensor;
  }
}

// Odometry at 100 Hz, from the beginning of the revolution to a tick after its end.
void AddPoses(const Pose2& vehicle, Mapper& mapper, DecisionHash& hash) {
  constexpr int kTicks = 11;
  for (int tick = 0; tick <= kTicks; ++tick) {
    const Pose2 at = PoseAt(vehicle, static_cast<float>(tick) * 0.1f - 1.0f);
    StampedPose pose;
    pose.time_ns = kHostStart_ns + static_cast<uint64_t>(tick) * (kRevolution_ns / 10);
    pose.position = {at.x_m, at.y_m, 0.0f};
    pose.yaw_rad = at.theta_rad;
    AddStatus(mapper.AddPose(pose), hash);
  }
}

// The packet's labels as the segmentation computer sends them, through the codec.
void ReceiveLabels(const SyntheticLidar& lidar, int packet, Mapper& mapper, DecisionHash& hash) {
  Codes& codes = g_codes.Construct();
  LabelDatagram& datagram = g_label_datagram.Construct();
  for (size_t i = 0; i < codes.size(); ++i) {
    codes[i] = lidar.labels()[i / kBeams].label[i % kBeams];
  }
  labels::Header header;
  header.version = labels::kVersion;
  header.beams = kBeams;
  header.frame_id = lidar.labels()[0].frame_id;
  header.first_measurement = lidar.labels()[0].measurement_id;
  header.columns = kColumnsPerPacket;
  header.sequence = static_cast<uint32_t>(packet);
  int size_bytes = 0;
  AddStatus(labels::Encode(header, codes, datagram, size_bytes), hash);
  const std::span<const uint8_t> bytes(datagram.data(), static_cast<size_t>(size_bytes));
  AddStatus(labels::CheckDatagram(bytes, kBeams, kColumns, header), hash);
  ColumnLabels& column = g_labels.Construct();
  for (int index = 0; index < kColumnsPerPacket; ++index) {
    AddStatus(labels::DecodeColumn(header, bytes, index, column), hash);
    AddStatus(mapper.AddLabels(column), hash);
  }
}

// Bytes to map. What is wrong with a packet or column is part of what is decided.
void ReceivePackets(const Scene& scene, const SensorPoses& odom_from_sensor, SyntheticLidar& lidar,
                    Mapper& mapper, DecisionHash& hash) {
  ouster::PacketLayout layout;
  ouster::PacketHeader header;
  AddStatus(ouster::MakeLayout(lidar.metadata(), layout), hash);
  Timebase& timebase = g_timebase.Construct();
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
      const uint64_t since_ns =
          kRevolution_ns * static_cast<uint64_t>(packet * kColumnsPerPacket + index) / kColumns;
      // Every packet is under way for a little longer than the one before.
      const uint64_t delay_ns = 1000u * static_cast<uint64_t>(packet);
      AddStatus(timebase.Observe(column.timestamp_ns, kHostStart_ns + since_ns + delay_ns), hash);
      const Result<uint64_t> taken_ns = timebase.ToHost(column.timestamp_ns);
      AddStatus(taken_ns.ok() ? mapper.AddColumn(column, taken_ns.value()) : taken_ns.status(),
                hash);
    }
    constexpr int kLostEvery = 5;
    if (scene.labelled && packet % kLostEvery != 0) ReceiveLabels(lidar, packet, mapper, hash);
    mapper.Advance(kHostStart_ns + kRevolution_ns * static_cast<uint64_t>(packet + 1) / kPackets);
  }
}

// Not inlined: the parameters are large for one frame of the stack.
[[gnu::noinline]] void StartMapper(bool labelled, const BeamModel& model, Mapper& mapper,
                                   DecisionHash& hash) {
  PerceptionParams params;
  params.mapping.use_labels = labelled ? 1 : 0;
  AddStatus(mapper.Configure(params, CostmapParams{}, kLabels, model, 0, kColumns - 1), hash);
}

// Columns are pending here: the newest directions, and those whose labels were lost. Not inlined:
// as above.
[[gnu::noinline]] void PlanInScene(const Scene& scene, const Mapper& mapper, Report& report) {
  PlanRequest request;
  request.start = {scene.vehicle, 0.05f, 1.5f};
  request.goal_odom = scene.goal;
  PlanOnMap(mapper, request, {scene.costmap, scene.plan}, report);
}

[[gnu::noinline]] void RunScene(const Scene& scene, Report& report) {
  SensorPoses& odom_from_sensor = g_odom_from_sensor.Construct();
  PlaceSensor(scene.vehicle, LidarMountParams{}, odom_from_sensor);

  SyntheticLidar& lidar = g_lidar.Construct();
  Mapper& mapper = g_mapper.Construct();
  DecisionHash packets;
  AddStatus(lidar.Configure(scene.seed), packets);
  StartMapper(scene.labelled, lidar.model(), mapper, packets);
  AddPoses(scene.vehicle, mapper, packets);
  ReceivePackets(scene, odom_from_sensor, lidar, mapper, packets);
  report.Add(scene.packets, packets);

  DecisionHash heights;
  AddHeights(mapper.heights(), heights);
  report.Add(scene.heights, heights);

  PlanInScene(scene, mapper, report);
}

}  // namespace

void RunScenes(Report& report) {
  for (const Scene& scene : kScenes) RunScene(scene, report);
}

}  // namespace hardpack::decision
