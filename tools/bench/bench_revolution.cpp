// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_revolution.h"

#include <algorithm>
#include <iterator>

#include "core/base/math.h"
#include "port_linux/command_line/command.h"
#include "port_linux/files/ouster_metadata.h"
#include "tools/bench/bench_stages.h"
#include "tools/bench/bench_timing.h"

namespace hardpack::command {
namespace {

constexpr uint32_t kSeed = 1;
constexpr uint16_t kLidarPort = 7502;
constexpr uint64_t kStart_ns = 1'000'000'000;
constexpr uint64_t kColumnPeriod_ns = 97'656;  // 1024 columns in 0.1 s

// Keeps the worse of two statuses, so that one look at the end is enough.
void Worsen(Status status, Status& worst) {
  if (!IsUsable(status)) worst = status;
}

}  // namespace

RevolutionBench::RevolutionBench() : recording_(scene::Record(scene::DemoWorld(), kSeed)) {
  Require(ouster::ParseMetadata(recording_.metadata_json, "made-up metadata", metadata_));
  Worsen(ouster::MakeLayout(metadata_, layout_), status_);
  const auto beams = static_cast<size_t>(metadata_.beams);
  Worsen(MakeBeamModel({metadata_.beam_altitude_deg, beams}, {metadata_.beam_azimuth_deg, beams},
                       metadata_.columns_per_frame, metadata_.lidar_origin_to_beam_origin_m,
                       metadata_.sensor_from_lidar, model_),
         status_);
  if (!IsUsable(status_)) throw CommandFailure(kWorkFailed, "the synthetic metadata is refused");
  std::erase_if(recording_.datagrams,
                [](const auto& datagram) { return datagram.port != kLidarPort; });
  // The recording holds a bit of the revolutions before and after.
  const auto packets = metadata_.columns_per_frame / layout_.columns_per_packet;
  const auto around = (std::ssize(recording_.datagrams) - packets) / 2;
  recording_.datagrams.erase(recording_.datagrams.begin() + around + packets,
                             recording_.datagrams.end());
  recording_.datagrams.erase(recording_.datagrams.begin(), recording_.datagrams.begin() + around);
  columns_.resize(recording_.datagrams.size() * static_cast<size_t>(layout_.columns_per_packet));
  DecodeRevolution();
}

void RevolutionBench::DecodeRevolution() {
  auto column = columns_.begin();
  for (const scene::Datagram& datagram : recording_.datagrams) {
    ouster::PacketHeader header;
    Worsen(ouster::CheckPacket(layout_, metadata_, datagram.payload, header), status_);
    for (int i = 0; i < layout_.columns_per_packet; ++i, ++column) {
      Worsen(ouster::DecodeColumn(layout_, datagram.payload, i, *column), status_);
    }
  }
}

BenchRow RevolutionBench::Decode() {
  BenchRow row = {
      .stage = "decode", .scene = kRevolutionScene, .object_bytes = sizeof(LidarColumn)};
  MeasureRow({.run = [this] { DecodeRevolution(); }}, row);
  row.status = status_;
  return row;
}

void RevolutionBench::StartMapper(bool use_labels) {
  PerceptionParams params;
  params.mapping.use_labels = use_labels ? 1 : 0;
  Worsen(mapper_->Configure(params, CostmapParams{}, RellisLabelTable(), model_,
                            metadata_.column_window_first, metadata_.column_window_last),
         status_);
  taken_ = 0;
}

// The data that accompanies a column on board: its number, its time, and sometimes a pose and a
// tick.
void RevolutionBench::Prepare() {
  constexpr uint64_t kColumnsATick = 102;
  const uint64_t now_ns = kStart_ns + taken_ * kColumnPeriod_ns;
  if (taken_ % kColumnsATick == 0) {
    StampedPose standing;
    standing.time_ns = now_ns;
    Worsen(mapper_->AddPose(standing), status_);
    mapper_->Advance(now_ns);
  }
  LidarColumn& column = columns_[taken_ % columns_.size()];
  column.frame_id = static_cast<uint16_t>(taken_ / columns_.size());
}

void RevolutionBench::TakeColumn() {
  const LidarColumn& column = columns_[taken_ % columns_.size()];
  Worsen(mapper_->AddColumn(column, kStart_ns + taken_ * kColumnPeriod_ns), status_);
  ++taken_;
}

// Of the column a revolution before the last one: trees everywhere.
void RevolutionBench::TakeLabels() {
  if (taken_ <= columns_.size()) return;
  constexpr uint8_t kTree = 4;
  const uint64_t labelled = taken_ - 1 - columns_.size();
  labels_.frame_id = static_cast<uint16_t>(labelled / columns_.size());
  labels_.measurement_id = static_cast<uint16_t>(labelled % columns_.size());
  labels_.beams = model_.beams;
  std::fill(std::begin(labels_.label), std::end(labels_.label), kTree);
  Worsen(mapper_->AddLabels(labels_), status_);
}

BenchRow RevolutionBench::Column(const char* scene, bool use_labels) {
  BenchRow row = {.stage = "column", .scene = scene, .object_bytes = sizeof(Mapper)};
  StartMapper(use_labels);
  const auto take = [this, use_labels] {
    TakeColumn();
    if (use_labels) TakeLabels();
  };
  for (size_t i = 0; i < 2 * columns_.size(); ++i) {  // until it runs steadily
    Prepare();
    take();
  }
  MeasureRow({.prepare = [this] { Prepare(); }, .run = take}, row);
  row.status = status_;
  return row;
}

BenchRow RevolutionBench::ColumnByGeometry() {
  return Column("geometry", false);
}

BenchRow RevolutionBench::ColumnWithLabels() {
  return Column("labels", true);
}

BenchRow RevolutionBench::Costmap() {
  BenchRow row = {
      .stage = "costmap", .scene = kRevolutionScene, .object_bytes = sizeof(CostmapBuilder)};
  constexpr int kAllUnits = 1'000'000;
  if (taken_ == 0) (void)ColumnWithLabels();
  const auto build = [this] {
    Worsen(builder_->Begin(mapper_->heights(), CostmapParams{}), status_);
    const uint32_t since = mapper_->fold_count();
    while (builder_->StepHeights(mapper_->heights(), kAllUnits) == Progress::kBusy) {
    }
    for (int slot = 0; slot < mapper_->ring().slots(); ++slot) {
      mapper_->MarkPending(slot, since, *builder_);
    }
    while (builder_->StepCells(kAllUnits) == Progress::kBusy) {
    }
  };
  MeasureRow({.run = build}, row);
  row.status = status_;
  return row;
}

}  // namespace hardpack::command
