// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/autonomy/mapper.h"
#include "test/core/autonomy/perception_scene.h"
#include "test/loop_count/counted_beams.h"

// The mapper, column by column: what the tests of its statuses, counters and order feed it with.

namespace hardpack::perception {

// Column `index` since the start: its time, frame and measurement follow from it.
inline uint64_t TimeOf_ns(int index) {
  return Chain::Nanoseconds(index * kRevolution_s / kColumns);
}
inline uint16_t FrameOf(int index) {
  return static_cast<uint16_t>(index / kColumns);
}
inline uint16_t MeasurementOf(int index) {
  return static_cast<uint16_t>(index % kColumns);
}

inline StampedPose StandingAt(uint64_t time_ns, float x_m = 0.0f) {
  StampedPose pose;
  pose.time_ns = time_ns;
  pose.position.x_m = x_m;
  return pose;
}

// A standing vehicle with a box 6 m ahead, and every column of a few revolutions.
class MapperBench {
 public:
  static constexpr Area kBox = {6.0, -0.4, 6.2, 0.4};

  explicit MapperBench(bool use_labels) {
    world.bodies = {Box({6.05, -0.5, 0.0}, {6.6, 0.5, 1.0})};
    params.mapping.use_labels = use_labels ? 1 : 0;
    Configure();
  }

  void Configure() {
    const Status status =
        mapper->Configure(params, CostmapParams{}, RellisLabelTable(), TheModel(), 0, kColumns - 1);
    EXPECT_EQ(status, Status::kOk) << StatusName(status);
  }

  // Poses each 10 ms up to 20 ms past a column's time.
  void PosesFor(int index) {
    while (next_pose_ns_ <= TimeOf_ns(index) + 20'000'000u) {
      EXPECT_EQ(mapper->AddPose(StandingAt(next_pose_ns_)), Status::kOk);
      next_pose_ns_ += 10'000'000u;
    }
  }

  // A column and what it shows, always the same for the same index.
  std::pair<LidarColumn, ColumnLabels> Cast(int index) const {
    Lidar lidar(static_cast<uint64_t>(index) + 1);
    return lidar.Cast(world, Pose{}, 0.0, FrameOf(index), MeasurementOf(index));
  }

  Status Give(int index) {
    PosesFor(index);
    return mapper->AddColumn(Cast(index).first, TimeOf_ns(index));
  }
  void GiveAll(int first, int last) {
    for (int index = first; index <= last; ++index) {
      const Status status = Give(index);
      EXPECT_EQ(status, Status::kOk) << StatusName(status) << ", column " << index;
    }
  }

  ColumnLabels LabelsOf(int index, uint8_t code) const {
    ColumnLabels labels;
    labels.frame_id = FrameOf(index);
    labels.measurement_id = MeasurementOf(index);
    labels.beams = kBeams;
    for (int row = 0; row < kBeams; ++row) labels.label[row] = code;
    return labels;
  }

  const ScanColumn& ColumnOf(int index) const {
    const ScanRing& ring = mapper->ring();
    for (int slot = 0; slot < ring.slots(); ++slot) {
      const ScanColumn& column = ring.column(slot);
      if (column.state == ColumnState::kAbsent || column.frame_id != FrameOf(index)) continue;
      if (column.measurement_id == MeasurementOf(index)) return column;
    }
    static constexpr ScanColumn kNone;
    return kNone;
  }

  // Columns of the ring that are to be folded yet.
  int Pending() const {
    int pending = 0;
    for (int slot = 0; slot < mapper->ring().slots(); ++slot) {
      const ColumnState state = mapper->ring().column(slot).state;
      pending += state == ColumnState::kRaw || state == ColumnState::kClassed ? 1 : 0;
    }
    return pending;
  }

  uint32_t Folded() const {
    const MapperCounters& counters = mapper->counters();
    return counters.folded_with_labels + counters.folded_without_labels;
  }

  // What the grid itself knows of an area: cells with a hard return.
  int HardInGrid(const Area& area) const {
    int count = 0;
    area.ForEach([&](Cell cell) {
      count += mapper->heights().At(cell).highest_hard_cm != HeightGrid::kNone ? 1 : 0;
    });
    return count;
  }

  // And of a map built now.
  int Count(const Area& area, uint8_t flags) {
    const Costmap& map = BuildMap(*mapper, *builder_);
    int count = 0;
    area.ForEach(
        [&](Cell cell) { count += (map.flags[map.window.Index(cell)] & flags) != 0 ? 1 : 0; });
    return count;
  }

  World world;
  PerceptionParams params;
  std::unique_ptr<Mapper> mapper = std::make_unique<Mapper>();

 private:
  CountedBeams counted_{kBeams};
  uint64_t next_pose_ns_ = Chain::Nanoseconds(0.0);
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

// Everything that a grid says, cell by cell.
inline uint64_t DigestOf(const HeightGrid& heights) {
  uint64_t digest = 14695981039346656037u;
  const auto mix = [&](int64_t value) {
    digest = (digest ^ static_cast<uint64_t>(value)) * 1099511628211u;
  };
  mix(heights.window().origin.x);
  mix(heights.window().origin.y);
  for (int index = 0; index < kMapCells; ++index) {
    const HeightGrid::CellHeights cell = heights.At(heights.window().FromIndex(index));
    mix(cell.lowest_cm);
    mix(cell.lowest_hard_cm);
    mix(cell.highest_hard_cm);
    mix(cell.highest_soft_cm);
    mix((cell.ground ? 1 : 0) + (cell.person ? 2 : 0));
  }
  return digest;
}

}  // namespace hardpack::perception
