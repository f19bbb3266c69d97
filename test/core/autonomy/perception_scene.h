// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/autonomy/mapper.h"
#include "test/core/autonomy/perception_world.h"

// A lidar that looks at a world, and the whole perception chain behind it: columns, poses and
// labels into the mapper as they would come on board, and the cells of the map that comes out.

namespace hardpack::perception {

inline constexpr int kBeams = 64;
inline constexpr int kColumns = 1024;
inline constexpr double kRevolution_s = 0.1;
inline constexpr double kTick_s = 0.01;
inline constexpr double kMount_m = 1.284;         // of the sensor frame above the ground
inline constexpr double kOrigin_m = 0.012163;     // lidar origin to beam origin
inline constexpr double kLidarAbove_m = 0.03618;  // lidar frame above the sensor frame
inline constexpr double kPi_rad = 3.14159265358979323846;
inline constexpr double kDegree_rad = kPi_rad / 180.0;
// The encoder's zero looks backward.
inline constexpr int kAhead = kColumns / 2;

struct Pose {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
  double roll = 0.0;
  double pitch = 0.0;
  double yaw = 0.0;

  Point Turned(const Point& p) const {
    const double cr = std::cos(roll), sr = std::sin(roll);
    const double cp = std::cos(pitch), sp = std::sin(pitch);
    const double cy = std::cos(yaw), sy = std::sin(yaw);
    const Point rolled = {p.x, cr * p.y - sr * p.z, sr * p.y + cr * p.z};
    const Point pitched = {cp * rolled.x + sp * rolled.z, rolled.y, cp * rolled.z - sp * rolled.x};
    return {cy * pitched.x - sy * pitched.y, sy * pitched.x + cy * pitched.y, pitched.z};
  }
  Point Apply(const Point& p) const { return Turned(p) + Point{x, y, z}; }
};

using Motion = std::function<Pose(double)>;  // of the time [s]

inline double AltitudeOf(int row) {
  return (16.6 - 33.2 * row / (kBeams - 1)) * kDegree_rad;
}
inline double AzimuthOf(int row) {
  constexpr double kOffsets_deg[] = {3.1, 1.03, -1.03, -3.1};
  return kOffsets_deg[row % 4] * kDegree_rad;
}

inline BeamModel TheModel() {
  float altitude_deg[kBeams];
  float azimuth_deg[kBeams];
  for (int row = 0; row < kBeams; ++row) {
    altitude_deg[row] = static_cast<float>(AltitudeOf(row) / kDegree_rad);
    azimuth_deg[row] = static_cast<float>(AzimuthOf(row) / kDegree_rad);
  }
  const Transform3 sensor_from_lidar = {{-1, 0, 0, 0, -1, 0, 0, 0, 1},
                                        {0.0f, 0.0f, static_cast<float>(kLidarAbove_m)}};
  BeamModel model;
  const Status status = MakeBeamModel(altitude_deg, azimuth_deg, kColumns,
                                      static_cast<float>(kOrigin_m), sensor_from_lidar, model);
  EXPECT_EQ(status, Status::kOk) << StatusName(status);
  return model;
}

// An OS1-64: 64 beams, 1024 columns, ten revolutions a second.
class Lidar {
 public:
  explicit Lidar(uint64_t seed) : random_(seed) {}

  // One column with the codes of its returns, taken from where the vehicle is then, and so far from
  // the column's place.
  std::pair<LidarColumn, ColumnLabels> Cast(const World& world, const Pose& vehicle, double time_s,
                                            uint16_t frame_id, uint16_t measurement_id,
                                            double offset_rad = 0.0) {
    LidarColumn column;
    ColumnLabels labels;
    column.frame_id = labels.frame_id = frame_id;
    column.measurement_id = labels.measurement_id = measurement_id;
    column.beams = labels.beams = kBeams;
    column.status = UINT32_MAX;
    column.valid = true;
    column.azimuth_offset_rad = static_cast<float>(offset_rad);
    const double encoder =
        2.0 * kPi_rad * (1.0 - measurement_id / static_cast<double>(kColumns)) + offset_rad;
    for (int row = 0; row < kBeams; ++row) {
      const Ray ray = RayOf(vehicle, encoder, row);
      const Hit hit = world.Look(ray, time_s, random_);
      labels.label[row] = hit.code;
      const double range_m = kOrigin_m + hit.distance_m + noise_(random_);
      const bool dropped = share_(random_) < kDropped;
      if (dropped || !(range_m > 0.0 && range_m < kReach_m)) continue;
      column.range_mm[row] = static_cast<uint32_t>(std::lround(1000.0 * range_m));
    }
    return {column, labels};
  }

 private:
  static constexpr double kReach_m = 100.0;
  static constexpr double kDropped = 0.005;  // share of the returns

  static Ray RayOf(const Pose& vehicle, double encoder, int row) {
    const double turned = encoder - AzimuthOf(row);
    const double rises = AltitudeOf(row);
    // From the lidar's frame to the body's: half a turn, and up to the mounting height.
    const Point origin = {-kOrigin_m * std::cos(encoder), -kOrigin_m * std::sin(encoder),
                          kLidarAbove_m + kMount_m};
    const Point direction = {-std::cos(turned) * std::cos(rises),
                             -std::sin(turned) * std::cos(rises), std::sin(rises)};
    return {vehicle.Apply(origin), vehicle.Turned(direction)};
  }

  Random random_;
  std::normal_distribution<double> noise_{0.0, 0.015};
  std::uniform_real_distribution<double> share_{0.0, 1.0};
};

// A rectangle of the odom frame; it stands for the cells whose middles lie in it.
struct Area {
  double low_x;
  double low_y;
  double high_x;
  double high_y;

  template <typename Visit>
  void ForEach(Visit visit) const {
    const Cell low = {static_cast<int32_t>(std::ceil(low_x * 5.0 - 0.5)),
                      static_cast<int32_t>(std::ceil(low_y * 5.0 - 0.5))};
    for (int32_t y = low.y; y * 0.2 + 0.1 <= high_y; ++y) {
      for (int32_t x = low.x; x * 0.2 + 0.1 <= high_x; ++x) visit(Cell{x, y});
    }
  }
};

// Which measurements are cast and sent: those within so many degrees of straight ahead.
struct Sector {
  double half_deg = 180.0;
  int first() const { return half_deg >= 180.0 ? 0 : kAhead - Half(); }
  int last() const { return half_deg >= 180.0 ? kColumns - 1 : kAhead + Half(); }

 private:
  int Half() const { return static_cast<int>(half_deg / 360.0 * kColumns); }
};

// A build as the planner makes it: what was not folded when it began is marked.
inline const Costmap& BuildMap(const Mapper& mapper, CostmapBuilder& builder) {
  const Status status = builder.Begin(mapper.heights(), CostmapParams{});
  EXPECT_EQ(status, Status::kOk) << StatusName(status);
  const uint32_t since = mapper.fold_count();
  while (builder.StepHeights(mapper.heights(), 1 << 20) == Progress::kBusy) {
  }
  for (int slot = 0; slot < mapper.ring().slots(); ++slot) mapper.MarkPending(slot, since, builder);
  while (builder.StepCells(1 << 20) == Progress::kBusy) {
  }
  return builder.result();
}

// The chain at work in a world.
class Chain {
 public:
  World world;
  Motion truth = [](double) { return Pose{}; };
  Motion odometry;  // what the mapper is told; the truth where it is not set
  double label_delay_s = 0.1;
  bool poses_may_lack = false;  // for a column: after a jump
  bool lidar_on = true;

  Chain(bool with_labels, Sector sector, uint64_t seed = 1)
      : with_labels_(with_labels), sector_(sector), lidar_(seed) {
    PerceptionParams params;
    params.mapping.use_labels = with_labels ? 1 : 0;
    const Status status = mapper_->Configure(params, CostmapParams{}, RellisLabelTable(),
                                             TheModel(), sector.first(), sector.last());
    EXPECT_EQ(status, Status::kOk) << StatusName(status);
  }

  Mapper& mapper() { return *mapper_; }

  // Ticks of 10 ms: the pose, the columns since the last tick, the labels that are due, Advance.
  void RunUntil(double end_s) {
    while (ticks_ * kTick_s < end_s - 1e-9) {
      const double now_s = ticks_ * kTick_s;
      GivePose(now_s);
      while (next_column_ * kRevolution_s / kColumns <= now_s) GiveColumn(next_column_++);
      while (!waiting_.empty() && waiting_.front().first <= now_s) {
        const Status status = mapper_->AddLabels(waiting_.front().second);
        EXPECT_EQ(status, Status::kOk) << StatusName(status);
        waiting_.pop_front();
      }
      mapper_->Advance(Nanoseconds(now_s));
      ++ticks_;
    }
  }

  const Costmap& Build() { return BuildMap(*mapper_, *builder_); }

  uint8_t FlagsOf(Cell cell) const {
    const Costmap& map = builder_->result();
    return map.window.Contains(cell) ? map.flags[map.window.Index(cell)] : 0;
  }
  bool Has(Cell cell, uint8_t flags) const { return (FlagsOf(cell) & flags) != 0; }

  // Of the last build: cells of the area with any of the flags.
  int Count(const Area& area, uint8_t flags) const {
    int count = 0;
    area.ForEach([&](Cell cell) { count += Has(cell, flags) ? 1 : 0; });
    return count;
  }
  static int Cells(const Area& area) {
    int count = 0;
    area.ForEach([&](Cell) { ++count; });
    return count;
  }

  // # hard, P person, s soft, . free, ? unknown; forward is up, left is left.
  std::string Picture(const Area& area) const {
    std::vector<std::string> lines;  // along x, the rightmost first
    int32_t y = 0;
    area.ForEach([&](Cell cell) {
      if (lines.empty() || cell.y != y) lines.emplace_back();
      y = cell.y;
      lines.back() += Symbol(cell);
    });
    std::string picture = "\n";
    for (size_t at = lines.empty() ? 0 : lines.front().size(); at-- > 0;) {
      for (size_t line = lines.size(); line-- > 0;) picture += lines[line][at];
      picture += '\n';
    }
    return picture;
  }

  static uint64_t Nanoseconds(double time_s) {
    return 1'000'000'000u + static_cast<uint64_t>(std::llround(1e9 * time_s));
  }

 private:
  char Symbol(Cell cell) const {
    if (Has(cell, Costmap::kPerson)) return 'P';
    if (Has(cell, Costmap::kHard)) return '#';
    if (Has(cell, Costmap::kSoft)) return 's';
    return Has(cell, Costmap::kObserved) ? '.' : '?';
  }

  void GivePose(double now_s) {
    const Pose pose = odometry ? odometry(now_s) : truth(now_s);
    StampedPose stamped;
    stamped.time_ns = Nanoseconds(now_s);
    stamped.position = {static_cast<float>(pose.x), static_cast<float>(pose.y),
                        static_cast<float>(pose.z)};
    stamped.roll_rad = static_cast<float>(pose.roll);
    stamped.pitch_rad = static_cast<float>(pose.pitch);
    stamped.yaw_rad = static_cast<float>(pose.yaw);
    const Status status = mapper_->AddPose(stamped);
    EXPECT_EQ(status, Status::kOk) << StatusName(status) << " at " << now_s << " s";
  }

  void GiveColumn(int index) {
    const int measurement_id = index % kColumns;
    const bool sent = measurement_id >= sector_.first() && measurement_id <= sector_.last();
    if (!lidar_on || !sent) return;
    const double time_s = index * kRevolution_s / kColumns;
    const auto [column, labels] =
        lidar_.Cast(world, truth(time_s), time_s, static_cast<uint16_t>(index / kColumns),
                    static_cast<uint16_t>(measurement_id));
    const Status status = mapper_->AddColumn(column, Nanoseconds(time_s));
    if (poses_may_lack && status == Status::kNoPose) return;
    EXPECT_EQ(status, Status::kOk) << StatusName(status) << " at " << time_s << " s";
    if (with_labels_) waiting_.emplace_back(time_s + label_delay_s, labels);
  }

  bool with_labels_;
  Sector sector_;
  Lidar lidar_;
  int ticks_ = 0;
  int next_column_ = 0;
  std::deque<std::pair<double, ColumnLabels>> waiting_;
  std::unique_ptr<Mapper> mapper_ = std::make_unique<Mapper>();
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

// The chain after the vehicle has stood at the origin for a while, looking along x; built.
inline std::unique_ptr<Chain> Standing(const World& world, bool with_labels, double seconds,
                                       Sector sector = {30.0}) {
  auto chain = std::make_unique<Chain>(with_labels, sector);
  chain->world = world;
  chain->RunUntil(seconds);
  chain->Build();
  return chain;
}

}  // namespace hardpack::perception
