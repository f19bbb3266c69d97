// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include "core/autonomy/mapper.h"
#include "core/costmap/costmap.h"
#include "gtest/gtest.h"
#include "hal/labels/labels.h"
#include "hal/ouster/ouster.h"
#include "port_linux/files/ouster_metadata.h"
#include "tools/sim/sensors/sim_labels.h"
#include "tools/sim/sensors/sim_lidar.h"
#include "tools/sim/world/named_worlds.h"

// A simulated lidar's packets through codec and mapper: the costmap shows what the world is made
// of.

namespace hardpack::world {
namespace {

constexpr int kBeams = sim::SimLidar::kBeams;
constexpr uint64_t kStart_ns = 1'000'000'000;

class MappedWorld {
 public:
  MappedWorld(const char* name, uint64_t seed, bool use_labels)
      : lidar_(sim::NoisyLidar(), kStart_ns) {
    EXPECT_TRUE(MakeScenario(name, seed, scenario).ok());
    EXPECT_TRUE(ouster::ParseMetadata(lidar_.MetadataJson(), "simulated", metadata_).ok());
    EXPECT_EQ(ouster::MakeLayout(metadata_, layout_), Status::kOk);
    const auto model = std::make_unique<BeamModel>();
    EXPECT_EQ(
        MakeBeamModel({metadata_.beam_altitude_deg, kBeams}, {metadata_.beam_azimuth_deg, kBeams},
                      metadata_.columns_per_frame, metadata_.lidar_origin_to_beam_origin_m,
                      metadata_.sensor_from_lidar, *model),
        Status::kOk);
    PerceptionParams params;
    params.mapping.use_labels = use_labels ? 1 : 0;
    EXPECT_EQ(mapper_->Configure(params, CostmapParams{}, RellisLabelTable(), *model, 0,
                                 metadata_.columns_per_frame - 1),
              Status::kOk);
  }

  // Drives along +x on the ground, in ticks of 10 ms. Columns that still wait for their labels at
  // the end are left out.
  void Drive(double seconds, double speed_mps) {
    for (int tick = 0; tick < static_cast<int>(seconds * 100.0); ++tick) {
      const double x_m = speed_mps * 0.01 * tick;
      Tick(kStart_ns + 10'000'000 * static_cast<uint64_t>(tick),
           StandingPose(scenario.world, x_m, 0.0, 0.0));
    }
    EXPECT_EQ(builder_->Begin(mapper_->heights(), CostmapParams{}), Status::kOk);
    while (builder_->Step(mapper_->heights(), CostmapBuilder::kUnits) == Progress::kBusy) {
    }
  }

  uint8_t FlagsAt(double x_m, double y_m) const {
    const Costmap& map = builder_->result();
    const Cell cell = CellAt({static_cast<float>(x_m), static_cast<float>(y_m)});
    return map.window.Contains(cell) ? map.flags[map.window.Index(cell)] : uint8_t{0};
  }
  const Costmap& map() const { return builder_->result(); }

  Scenario scenario;

 private:
  void Tick(uint64_t now_ns, const BodyPose& pose) {
    StampedPose stamped;
    stamped.time_ns = now_ns;
    const auto narrow = [](double value) { return static_cast<float>(value); };
    stamped.position = {narrow(pose.position.x_m), narrow(pose.position.y_m),
                        narrow(pose.position.z_m)};
    stamped.roll_rad = narrow(pose.roll_rad);
    stamped.pitch_rad = narrow(pose.pitch_rad);
    stamped.yaw_rad = narrow(pose.yaw_rad);
    ASSERT_EQ(mapper_->AddPose(stamped), Status::kOk);
    std::vector<std::vector<uint8_t>> packets;
    std::vector<sim::CastColumn> truth;
    lidar_.Advance(now_ns, pose, scenario.world, packets, &truth);
    for (const auto& packet : packets) TakePacket(packet);
    std::vector<std::vector<uint8_t>> datagrams;
    labels_.Advance(now_ns, truth, datagrams);
    for (const auto& datagram : datagrams) TakeLabels(datagram);
    mapper_->Advance(now_ns);
  }
  void TakePacket(const std::vector<uint8_t>& packet) {
    for (int i = 0; i < sim::SimLidar::kColumnsPerPacket; ++i) {
      ASSERT_EQ(ouster::DecodeColumn(layout_, packet, i, column_), Status::kOk);
      const uint64_t time_ns = column_.timestamp_ns - lidar_.settings().clock_start_ns + kStart_ns;
      ASSERT_EQ(mapper_->AddColumn(column_, time_ns), Status::kOk);
    }
  }
  void TakeLabels(const std::vector<uint8_t>& datagram) {
    labels::Header header;
    ASSERT_EQ(labels::CheckDatagram(datagram, kBeams, 1024, header), Status::kOk);
    for (int i = 0; i < header.columns; ++i) {
      ColumnLabels said;
      ASSERT_EQ(labels::DecodeColumn(header, datagram, i, said), Status::kOk);
      static_cast<void>(mapper_->AddLabels(said));  // unused where labels are
    }
  }

  sim::SimLidar lidar_;
  sim::SimLabels labels_{sim::LabelSettings{.delay_s = 0.05}};
  ouster::Metadata metadata_;
  ouster::PacketLayout layout_;
  LidarColumn column_;
  std::unique_ptr<Mapper> mapper_ = std::make_unique<Mapper>();
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

struct Flagged {
  int hard = 0;
  int soft = 0;
  int all = 0;
};

// Of the bodies' cells that face the vehicle: whose middle a solid body or only leaves cover, and
// which are seen: within 1.2 m of the outermost leaves or rocks, towards it.
Flagged CountAround(const MappedWorld& mapped, const Point2& middle, double from_m, double to_m) {
  Flagged flagged;
  for (double angle_deg = 150.0; angle_deg <= 210.0; angle_deg += 1.0) {
    const Turn turn = TurnOf(angle_deg * kPi / 180.0);
    for (double radius_m = from_m; radius_m <= to_m; radius_m += 0.1) {
      const uint8_t flags =
          mapped.FlagsAt(middle.x_m + radius_m * turn.cos, middle.y_m + radius_m * turn.sin);
      ++flagged.all;
      flagged.hard += (flags & Costmap::kHard) != 0 ? 1 : 0;
      flagged.soft += (flags & Costmap::kSoft) != 0 ? 1 : 0;
    }
  }
  return flagged;
}

// # hard, s soft, . nothing; the vehicle comes from below.
std::string PictureOf(const MappedWorld& mapped, const Point2& middle) {
  std::string picture;
  for (double x_m = middle.x_m + 8.0; x_m > middle.x_m - 8.0; x_m -= 0.2) {
    for (double y_m = middle.y_m + 8.0; y_m > middle.y_m - 8.0; y_m -= 0.2) {
      const uint8_t flags = mapped.FlagsAt(x_m, y_m);
      picture += (flags & Costmap::kHard) != 0 ? '#' : (flags & Costmap::kSoft) != 0 ? 's' : '.';
    }
    picture += '\n';
  }
  return picture;
}

// The middle of the pile: that of its largest rock; and how far its rocks reach.
void FindPile(const World& world, Point2& middle, double& core_m, double& skirt_m) {
  const Body* largest = nullptr;
  for (const Body& body : world.bodies()) {
    if (body.material.label != Label::kRubble) continue;
    if (largest == nullptr || body.radius_m > largest->radius_m) largest = &body;
  }
  ASSERT_NE(largest, nullptr);
  middle = {largest->x_m, largest->y_m};
  core_m = largest->radius_m / 0.65;
  skirt_m = core_m + 2.0;
}

TEST(MappedWorld, ShowsARockPileAsHardCoreAndSoftSkirt) {
  MappedWorld mapped("rock_pile", 1, true);
  Point2 middle;
  double core_m = 0.0;
  double skirt_m = 0.0;
  FindPile(mapped.scenario.world, middle, core_m, skirt_m);
  mapped.Drive(2.0, 3.0);
  const Flagged skirt = CountAround(mapped, middle, core_m + 0.7, skirt_m - 0.5);
  const Flagged core = CountAround(mapped, middle, core_m - 1.0, core_m - 0.2);
  SCOPED_TRACE(PictureOf(mapped, middle));
  EXPECT_GT(skirt.soft, skirt.all / 2);
  EXPECT_LT(skirt.hard, skirt.all / 20);
  EXPECT_GT(core.hard, core.all / 3);
  // And nothing where nothing is, half way to it.
  int false_alarms = 0;
  for (double x_m = 4.0; x_m < middle.x_m - skirt_m - 1.0; x_m += 0.2) {
    for (double y_m = -3.0; y_m < 3.0; y_m += 0.2) {
      false_alarms += (mapped.FlagsAt(x_m, y_m) & (Costmap::kHard | Costmap::kSoft)) != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(false_alarms, 0);
}

// The ditch is not bridged: the ground that was observed ends at it.
// SR-PER09
TEST(MappedWorld, EndsTheObservedGroundAtTheDitch) {
  MappedWorld mapped("ditch", 1, false);
  mapped.Drive(2.0, 3.0);
  const Ditch& ditch = mapped.scenario.world.ditches().front();
  int unseen = 0;
  int bottoms = 0;
  int seen_before = 0;
  for (double y_m = -3.0; y_m <= 3.0; y_m += 0.2) {
    const double share = (y_m - ditch.from.y_m) / (ditch.to.y_m - ditch.from.y_m);
    const double ditch_x_m = ditch.from.x_m + share * (ditch.to.x_m - ditch.from.x_m);
    const auto observed = [&](double x_m) {
      return (mapped.FlagsAt(x_m, y_m) & Costmap::kObserved) != 0;
    };
    ++bottoms;
    bool all = true;
    for (double x_m = ditch_x_m - ditch.half_width_m; x_m < ditch_x_m + 0.3; x_m += 0.1) {
      all &= observed(x_m);
    }
    unseen += all ? 0 : 1;
    seen_before += observed(ditch_x_m - ditch.half_width_m - 2.0) ? 1 : 0;
  }
  EXPECT_EQ(unseen, bottoms) << "no line leads across it over observed ground";
  EXPECT_GT(seen_before, bottoms * 8 / 10);
}

TEST(MappedWorld, ShowsPeople) {
  MappedWorld mapped("crossing", 1, true);
  mapped.Drive(0.5, 0.1);
  int shown = 0;
  int in_reach = 0;
  for (const Person& person : mapped.scenario.world.people()) {
    const Point2 place = person.At(0.45);
    if (place.x_m > 25.0) continue;
    ++in_reach;
    bool is_shown = false;
    for (double dx_m = -0.6; dx_m <= 0.6; dx_m += 0.2) {
      for (double dy_m = -0.6; dy_m <= 0.6; dy_m += 0.2) {
        is_shown |= (mapped.FlagsAt(place.x_m + dx_m, place.y_m + dy_m) & Costmap::kPerson) != 0;
      }
    }
    shown += is_shown ? 1 : 0;
  }
  EXPECT_GT(in_reach, 1);
  EXPECT_EQ(shown, in_reach);
}

}  // namespace
}  // namespace hardpack::world
