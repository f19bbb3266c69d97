// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/scan_loader.h"

#include <memory>
#include <utility>

#include "core/base/math.h"
#include "port_linux/files/ouster_metadata.h"
#include "tools/capture/pcap_reader.h"
#include "tools/capture/rellis_labels.h"

namespace hardpack::capture {
namespace {

ReadOutcome ScanFailure(const std::string& file, const std::string& what, Status status) {
  return {status, file + ": " + what + " (" + StatusName(status) + ")"};
}

// One turn of the sensor, [measurement id]; a column is there when it is valid.
struct Revolution {
  uint16_t frame_id = 0;
  int64_t received = 0;
  std::vector<LidarColumn> columns;
};

// Sorts columns into revolutions and picks one. Packets may come out of order around the change of
// revolutions, so a few of them are open at a time.
class RevolutionPicker {
 public:
  RevolutionPicker(size_t columns, int64_t window_columns)
      : columns_(columns), window_columns_(window_columns) {}

  // True when this column completed a revolution.
  bool Add(const LidarColumn& column) {
    Revolution& revolution = Of(column.frame_id);
    LidarColumn& slot = revolution.columns[column.measurement_id];
    if (slot.valid) return false;
    slot = column;
    ++revolution.received;
    return revolution.received == window_columns_;
  }

  // The complete one, otherwise the fullest (the first of equals); nullptr without any.
  const Revolution* best() const {
    const Revolution* best = fullest_.received > 0 ? &fullest_ : nullptr;
    for (const Revolution& revolution : open_) {
      if (best == nullptr || revolution.received > best->received) best = &revolution;
    }
    return best;
  }

 private:
  static constexpr size_t kMaxOpen = 3;

  Revolution& Of(uint16_t frame_id) {
    for (Revolution& revolution : open_) {
      if (revolution.frame_id == frame_id) return revolution;
    }
    if (open_.size() == kMaxOpen) {
      if (open_.front().received > fullest_.received) fullest_ = std::move(open_.front());
      open_.erase(open_.begin());
    }
    open_.push_back({frame_id, 0, std::vector<LidarColumn>(columns_)});
    return open_.back();
  }

  size_t columns_;
  int64_t window_columns_;
  Revolution fullest_;
  std::vector<Revolution> open_;  // in the order of their first column
};

// The source and destination of a sensor's packets.
struct Connection {
  uint32_t source_address = 0;
  uint16_t destination_port = 0;
  bool operator==(const Connection&) const = default;
};

// Reads the capture up to the first complete revolution. `ring` knows the sensor's window.
ReadOutcome ReadRevolution(const std::string& path, const ouster::PacketLayout& layout,
                           const ScanRing& ring, RevolutionPicker& picker,
                           LidarScanReport& report) {
  PcapReader reader;
  if (ReadOutcome outcome = reader.Open(path); !outcome.ok()) return outcome;
  const auto column = std::make_unique<LidarColumn>();
  Connection sensor;
  UdpDatagram datagram;
  bool complete = false;
  while (!complete && reader.Next(datagram)) {
    ++report.datagrams;
    const Connection connection{datagram.source_address, datagram.destination_port};
    ouster::PacketHeader header;
    const Status status = ouster::CheckPacket(layout, report.metadata, datagram.payload, header);
    if (!IsUsable(status) || (report.packets > 0 && connection != sensor)) {
      ++report.foreign_packets;
      continue;
    }
    sensor = connection;
    ++report.packets;
    for (int index = 0; index < layout.columns_per_packet; ++index) {
      const Status decoded = ouster::DecodeColumn(layout, datagram.payload, index, *column);
      if (IsUsable(decoded) && ring.InWindow(column->measurement_id)) {
        complete = picker.Add(*column) || complete;
      }
    }
  }
  report.damaged_datagrams = reader.counters().cut_frames + reader.counters().malformed_frames +
                             reader.reassembly().incomplete + reader.reassembly().conflicts;
  return reader.outcome();
}

int64_t LabelledReturns(const Revolution& revolution, const ScanLabels& labels) {
  int64_t labelled = 0;
  for (const LidarColumn& column : revolution.columns) {
    for (int row = 0; column.valid && row < column.beams; ++row) {
      const bool named = labels.At(column.measurement_id, row).has_value();
      labelled += named && column.range_mm[row] != 0 ? 1 : 0;
    }
  }
  return labelled;
}

// The data required to read a revolution.
struct Preparation {
  ouster::PacketLayout layout;
  BeamModel model;
  ScanLabels labels;
};

// Reads the metadata and sizes everything by them.
ReadOutcome Prepare(const LidarScanRequest& request, Mapper& mapper, ouster::Metadata& metadata,
                    Preparation& ready) {
  const std::string& file = request.metadata_path;
  if (ReadOutcome outcome = ouster::ReadMetadata(file, metadata); !outcome.ok()) return outcome;
  Status status = ouster::MakeLayout(metadata, ready.layout);
  if (status == Status::kUnsupported) {
    return ScanFailure(file, "udp_profile_lidar: packets of this profile are not decoded", status);
  }
  if (!IsUsable(status)) {
    return ScanFailure(file, "columns_per_frame: more columns than a scan ring holds", status);
  }
  const size_t beams = static_cast<size_t>(metadata.beams);
  status = MakeBeamModel({metadata.beam_altitude_deg, beams}, {metadata.beam_azimuth_deg, beams},
                         metadata.columns_per_frame, metadata.lidar_origin_to_beam_origin_m,
                         metadata.sensor_from_lidar, ready.model);
  if (!IsUsable(status)) return ScanFailure(file, "beam geometry", status);
  PerceptionParams perception = request.perception;
  perception.mapping.use_labels = request.labels_path.empty() ? 0 : 1;
  status = mapper.Configure(perception, request.costmap, request.labels, ready.model,
                            metadata.column_window_first, metadata.column_window_last);
  if (status == Status::kParameterOutOfRange) return {status, "parameters: out of range"};
  if (!IsUsable(status))
    return ScanFailure(file, "a revolution does not fit the scan ring", status);
  if (request.labels_path.empty()) return {};
  return ReadLabels(request.labels_path, metadata.beams, metadata.columns_per_frame, ready.labels);
}

}  // namespace

ReadOutcome LoadLidarScan(const LidarScanRequest& request, Mapper& mapper,
                          LidarScanReport& report) {
  report = LidarScanReport{};
  const auto ready = std::make_unique<Preparation>();
  if (ReadOutcome outcome = Prepare(request, mapper, report.metadata, *ready); !outcome.ok()) {
    return outcome;
  }
  const ScanRing& ring = mapper.ring();
  RevolutionPicker picker(static_cast<size_t>(ring.columns()), ring.window_columns());
  ReadOutcome outcome = ReadRevolution(request.capture_path, ready->layout, ring, picker, report);
  if (!outcome.ok()) return outcome;
  const Revolution* const revolution = picker.best();
  if (revolution == nullptr) {
    return {Status::kWrongSensor, request.capture_path + ": no lidar packet of this sensor (" +
                                      std::to_string(report.datagrams) + " datagrams; expected " +
                                      std::to_string(ready->layout.packet_bytes) + " bytes each)"};
  }
  const ScanLabels* const labels = request.labels_path.empty() ? nullptr : &ready->labels;
  const Status status = MapRevolution(revolution->columns, request.pose, labels, mapper);
  if (!IsUsable(status)) return ScanFailure(request.capture_path, "cannot be placed", status);
  report.filed = ReturnsIn(mapper);
  if (labels != nullptr) report.labelled_returns = LabelledReturns(*revolution, *labels);
  report.frame_id = revolution->frame_id;
  report.columns = revolution->received;
  report.missing_columns = ring.window_columns() - revolution->received;
  return {};
}

}  // namespace hardpack::capture
