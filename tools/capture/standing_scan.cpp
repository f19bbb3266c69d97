// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/standing_scan.h"

#include "core/scan/scan.h"

namespace hardpack::capture {
namespace {

// The revolution as the sensor would send it to a standing vehicle: its columns spread over a tenth
// of a second, the labels of each right after it.
class StandingDrive {
 public:
  StandingDrive(const StampedPose& pose, const ScanLabels* labels, Mapper& mapper)
      : pose_(pose), labels_(labels), mapper_(mapper) {}

  Status Take(const LidarColumn& column) {
    const int64_t columns = mapper_.ring().columns();
    const uint64_t time_ns =
        kStart_ns + static_cast<uint64_t>(kRevolution_ns * column.measurement_id / columns);
    if (const Status status = StandUntil(time_ns); !IsUsable(status)) return status;
    const Status filed = mapper_.AddColumn(column, time_ns);
    if (!IsUsable(filed) || labels_ == nullptr) return filed;
    return mapper_.AddLabels(LabelsOf(column));
  }

 private:
  static constexpr uint64_t kStart_ns = 1'000'000'000;
  static constexpr int64_t kRevolution_ns = 100'000'000;
  static constexpr uint64_t kPosePeriod_ns = 10'000'000;

  Status StandUntil(uint64_t time_ns) {
    for (; next_pose_ns_ <= time_ns; next_pose_ns_ += kPosePeriod_ns) {
      pose_.time_ns = next_pose_ns_;
      if (const Status status = mapper_.AddPose(pose_); !IsUsable(status)) return status;
    }
    return Status::kOk;
  }

  const ColumnLabels& LabelsOf(const LidarColumn& column) {
    constexpr uint8_t kNotNamed = 255;  // of no ontology: hard, when in doubt
    column_labels_.frame_id = column.frame_id;
    column_labels_.measurement_id = column.measurement_id;
    column_labels_.beams = column.beams;
    for (int row = 0; row < column.beams; ++row) {
      column_labels_.label[row] = labels_->At(column.measurement_id, row).value_or(kNotNamed);
    }
    return column_labels_;
  }

  StampedPose pose_;
  const ScanLabels* labels_;
  Mapper& mapper_;
  ColumnLabels column_labels_;
  uint64_t next_pose_ns_ = kStart_ns;
};

}  // namespace

Status MapRevolution(std::span<const LidarColumn> columns, const StampedPose& pose,
                     const ScanLabels* labels, Mapper& mapper) {
  StandingDrive drive(pose, labels, mapper);
  for (const LidarColumn& column : columns) {
    if (!column.valid) continue;
    if (const Status status = drive.Take(column); !IsUsable(status)) return status;
  }
  mapper.Finish();
  return Status::kOk;
}

FiledReturns ReturnsIn(const Mapper& mapper) {
  FiledReturns filed;
  const ScanRing& ring = mapper.ring();
  for (int slot = 0; slot < ring.slots(); ++slot) {
    const ScanColumn& column = ring.column(slot);
    if (column.state == ColumnState::kAbsent) continue;
    const SinCosPair encoder =
        EncoderSinCos(mapper.model(), column.measurement_id, column.azimuth_offset_rad);
    for (int row = 0; row < ring.beams(); ++row) {
      const PackedReturn packed = ring.at(slot, row);
      if (packed.range_mm() == 0) continue;
      ++filed.returns;
      if (packed.self() && packed.return_class() != ReturnClass::kPerson) {
        ++filed.self_returns;
        continue;
      }
      if (packed.return_class() == ReturnClass::kIgnored) {
        ++filed.ignored_returns;
        continue;
      }
      const Vec3 point_sensor = PointInSensor(mapper.model(), encoder, row, packed.range_mm());
      const Vec3 point_odom = column.odom_from_sensor.Apply(point_sensor);
      const bool on_grid =
          mapper.heights().window().Contains(CellAt({point_odom.x_m, point_odom.y_m}));
      filed.returns_off_grid += on_grid ? 0 : 1;
      filed.points.push_back({point_odom, packed.return_class()});
    }
  }
  return filed;
}

}  // namespace hardpack::capture
