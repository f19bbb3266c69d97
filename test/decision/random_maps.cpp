// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>
#include <span>

#include "core/autonomy/mapper.h"
#include "core/base/assert.h"
#include "core/base/math.h"
#include "hal/ouster/ouster.h"
#include "test/decision/lidar.h"
#include "test/decision/map_hash.h"
#include "test/decision/random.h"
#include "test/decision/random_scenes.h"
#include "test/decision/storage.h"
#include "test/decision/vary.h"

// Maps of random worlds, from the bytes of a few revolutions of a lidar that drives through them
// and of what a segmentation computer says of some, with random parameters. Solids move and vanish,
// poses jump, the sensor restarts, and a tick may class few directions.

namespace hardpack::decision {
namespace {

constexpr int kGroups = 8;
constexpr int kScenes = 10;  // of a group
constexpr int kRevolutions = 4;
constexpr int kMostSolids = 10;
constexpr uint64_t kStart_ns = 5'000'000'000u;
constexpr uint64_t kPose_ns = 10'000'000u;
constexpr uint64_t kRevolution_ns = 100'000'000u;

using SensorPoses = std::array<Transform3, kColumns>;

HP_BIG_MEMORY Storage<SyntheticLidar> g_lidar;
HP_BIG_MEMORY Storage<Mapper> g_mapper;
HP_BIG_MEMORY Storage<CostmapBuilder> g_builder;
HP_BIG_MEMORY Storage<LidarColumn> g_column;
HP_BIG_MEMORY Storage<SensorPoses> g_odom_from_sensor;

uint64_t TimeOf_ns(int revolution, int column) {
  const auto since = static_cast<uint64_t>(revolution * kColumns + column);
  return kStart_ns + since * kRevolution_ns / kColumns;
}

void AddStatus(Status status, DecisionHash& hash) {
  hash.AddU8(static_cast<uint8_t>(status));
}

ReturnClass AnyClass(Random& random) {
  constexpr ReturnClass kClasses[] = {ReturnClass::kHard, ReturnClass::kHard, ReturnClass::kSoft,
                                      ReturnClass::kPerson, ReturnClass::kIgnored};
  return kClasses[random.Between(0, 4)];
}

class RandomScene {
 public:
  explicit RandomScene(uint32_t seed) : random_(seed) {
    boxes_ = random_.Between(0, kMostSolids);
    cylinders_ = random_.Between(1, kMostSolids);
    for (Box& box : box_) box = AnyBox();
    for (Cylinder& cylinder : cylinder_) cylinder = AnyCylinder();
    speed_mps_ = random_.RealBetween(-1.0f, 5.0f);
    yaw_rate_radps_ = random_.RealBetween(-0.8f, 0.8f);
    tilt_rad_ = random_.Between(0, 1) == 0 ? 0.0f : random_.RealBetween(-0.15f, 0.15f);
    Vary(random_, 12, params_);
    Vary(random_, 12, rule_);
    params_.mapping.use_labels = random_.Between(0, 1);
    directions_ = random_.Between(0, 3) == 0 ? random_.Between(Mapper::kMaxDirections, 200) : 0;
    jumps_ = random_.Between(0, 5);
    restarts_ = random_.Between(0, 7) == 0;
  }

  // Whether the mapper took the parameters.
  bool Run(DecisionHash& hash) {
    SyntheticLidar& lidar = g_lidar.Construct();
    AddStatus(lidar.Configure(random_.Next() | 1u), hash);
    Mapper& mapper = g_mapper.Construct();
    const Status taken =
        mapper.Configure(params_, rule_, RellisLabelTable(), lidar.model(), 0, kColumns - 1);
    AddStatus(taken, hash);
    if (!IsUsable(taken)) return false;
    for (int revolution = 0; revolution < kRevolutions; ++revolution) {
      Revolve(lidar, mapper, revolution, hash);
      AddMaps(mapper, hash);
      MoveSolids();
    }
    mapper.Advance(TimeOf_ns(kRevolutions, 0) + 2 * kRevolution_ns);  // the sensor is silent
    AddMaps(mapper, hash);
    return true;
  }

 private:
  Vec2 AnyPlace() {
    return {random_.RealBetween(-25.0f, 25.0f), random_.RealBetween(-25.0f, 25.0f)};
  }
  Box AnyBox() {
    const Vec2 at = AnyPlace();
    const float low_m = random_.Between(0, 4) == 0 ? random_.RealBetween(0.3f, 2.5f) : 0.0f;
    return {{at.x_m, at.y_m, low_m},
            {at.x_m + random_.RealBetween(0.1f, 8.0f), at.y_m + random_.RealBetween(0.1f, 8.0f),
             low_m + random_.RealBetween(0.05f, 2.5f)},
            AnyClass(random_)};
  }
  Cylinder AnyCylinder() {
    return {AnyPlace(), random_.RealBetween(0.05f, 1.5f), random_.RealBetween(0.1f, 3.0f),
            AnyClass(random_)};
  }

  // Some of them go a step, one is gone and another one comes.
  void MoveSolids() {
    for (Cylinder& cylinder : cylinder_) {
      if (random_.Between(0, 2) != 0) continue;
      cylinder.center.x_m += random_.RealBetween(-0.5f, 0.5f);
      cylinder.center.y_m += random_.RealBetween(-0.5f, 0.5f);
    }
    cylinder_[random_.Between(0, kMostSolids - 1)] = AnyCylinder();
    box_[random_.Between(0, kMostSolids - 1)] = AnyBox();
  }

  StampedPose PoseAt(uint64_t time_ns) const {
    const float time_s = static_cast<float>(time_ns - kStart_ns) * 1.0e-9f;
    StampedPose pose;
    pose.time_ns = time_ns;
    pose.yaw_rad = WrapAngle(0.3f + yaw_rate_radps_ * time_s);
    pose.pitch_rad = tilt_rad_;
    pose.roll_rad = tilt_rad_ * 0.5f;
    pose.position = {0.1f + speed_mps_ * time_s, 0.1f, 0.0f};
    const bool has_jumped = time_s > 0.25f;
    if (has_jumped && jumps_ == 1) pose.position.y_m += 6.0f;
    if (has_jumped && jumps_ == 2) pose.position.z_m += 0.8f;
    return pose;
  }

  void PlaceSensor(int revolution, SensorPoses& odom_from_sensor) const {
    const Transform3 body_from_sensor = BodyFromSensor(params_.mount);
    for (int column = 0; column < kColumns; ++column) {
      const StampedPose pose = PoseAt(TimeOf_ns(revolution, column));
      odom_from_sensor[static_cast<size_t>(column)] =
          TransformFromPose({pose.position.x_m, pose.position.y_m, pose.yaw_rad}, 0.0f) *
          body_from_sensor;
    }
  }

  void Revolve(SyntheticLidar& lidar, Mapper& mapper, int revolution, DecisionHash& hash) {
    SensorPoses& odom_from_sensor = g_odom_from_sensor.Construct();
    PlaceSensor(revolution, odom_from_sensor);
    const World world{{box_, static_cast<size_t>(boxes_)},
                      {cylinder_, static_cast<size_t>(cylinders_)}};
    const int frames = restarts_ && revolution == 2 ? 100 : 0;
    for (int packet = 0; packet < kPackets; ++packet) {
      lidar.MakePacket(world, odom_from_sensor, packet, revolution + frames);
      const int end = (packet + 1) * kColumnsPerPacket;
      while (next_pose_ns_ <= TimeOf_ns(revolution, end) + kPose_ns) {
        AddStatus(mapper.AddPose(PoseAt(next_pose_ns_)), hash);
        next_pose_ns_ += kPose_ns;
      }
      if (directions_ > 0) mapper.BeginTick(directions_);
      Receive(lidar, mapper, revolution, packet, hash);
      mapper.Advance(TimeOf_ns(revolution, end));
    }
  }

  // Its columns, unless it is lost, the labels of the one before, and some labels of its own.
  void Receive(const SyntheticLidar& lidar, Mapper& mapper, int revolution, int packet,
               DecisionHash& hash) {
    ouster::PacketLayout layout;
    AddStatus(ouster::MakeLayout(lidar.metadata(), layout), hash);
    const bool is_lost = random_.Between(0, 15) == 0;
    for (int index = 0; index < kColumnsPerPacket && !is_lost; ++index) {
      LidarColumn& column = g_column.Construct();
      AddStatus(ouster::DecodeColumn(layout, lidar.packet(), index, column), hash);
      const int at = packet * kColumnsPerPacket + index;
      AddStatus(mapper.AddColumn(column, TimeOf_ns(revolution, at)), hash);
    }
    for (const ColumnLabels& labels : waiting_) {
      if (labels.beams > 0) AddStatus(mapper.AddLabels(labels), hash);
    }
    for (size_t i = 0; i < waiting_.size(); ++i) {
      waiting_[i] = lidar.labels()[i];
      if (random_.Between(0, 20) == 0) waiting_[i].beams = 0;  // lost
      if (random_.Between(0, 9) == 0) waiting_[i].label[random_.Between(0, kBeams - 1)] = 17;
    }
  }

  void AddMaps(const Mapper& mapper, DecisionHash& hash) {
    AddHeights(mapper.heights(), hash);
    CostmapBuilder& builder = g_builder.Construct();
    AddStatus(builder.Begin(mapper.heights(), rule_), hash);
    const uint32_t since = mapper.fold_count();
    while (builder.StepHeights(mapper.heights(), 1000) == Progress::kBusy) {
    }
    for (int slot = 0; slot < mapper.ring().slots(); ++slot) {
      mapper.MarkPending(slot, since, builder);
    }
    while (builder.StepCells(1000) == Progress::kBusy) {
    }
    AddCostmap(builder.result(), hash);
    const MapperCounters& counters = mapper.counters();
    for (const uint32_t count :
         {counters.columns_without_pose, counters.columns_over_limit, counters.folded_with_labels,
          counters.folded_without_labels, counters.folded_early, counters.late_unclassed_columns,
          counters.returns_off_map, counters.overhead_returns, counters.height_jumps,
          counters.position_jumps, counters.sensor_restarts}) {
      hash.AddU32(count);
    }
  }

  Random random_;
  PerceptionParams params_;
  CostmapParams rule_;
  int boxes_ = 0;
  int cylinders_ = 0;
  Box box_[kMostSolids];
  Cylinder cylinder_[kMostSolids];
  float speed_mps_ = 0.0f;
  float yaw_rate_radps_ = 0.0f;
  float tilt_rad_ = 0.0f;
  int directions_ = 0;  // that a tick may class; 0: any
  int jumps_ = 0;       // 1: the place, 2: the height
  bool restarts_ = false;
  uint64_t next_pose_ns_ = kStart_ns;
  std::array<ColumnLabels, kColumnsPerPacket> waiting_ = {};
};

}  // namespace

void RunRandomMaps(Report& report) {
  uint32_t taken = 0;
  uint32_t seed = 0x5eed0200u;
  for (int group = 0; group < kGroups; ++group) {
    DecisionHash hash;
    for (int scene = 0; scene < kScenes; ++scene) taken += RandomScene(seed++).Run(hash) ? 1 : 0;
    report.Add("random.maps", hash);
  }
  PrintNumber("random.maps taken", taken);
}

}  // namespace hardpack::decision
