// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/autonomy/mapper.h"
#include "core/costmap/costmap.h"
#include "hal/ouster/ouster.h"
#include "tools/bench/bench_row.h"
#include "tools/sim/scene/recording.h"

namespace hardpack::command {

// The stages before planning, on one synthetic revolution of 1024 columns of 64 beams, repeated,
// for a standing vehicle.
class RevolutionBench {
 public:
  RevolutionBench();

  BenchRow Decode();            // the revolution's 64 packets into columns
  BenchRow ColumnByGeometry();  // one column through the mapper, no labels
  BenchRow ColumnWithLabels();  // the same, with the labels of the column one revolution earlier
  BenchRow Costmap();           // a build from the map that the last of them left, pending columns
                                // included

 private:
  void DecodeRevolution();
  void StartMapper(bool use_labels);
  void Prepare();
  void TakeColumn();
  void TakeLabels();
  BenchRow Column(const char* scene, bool use_labels);

  scene::Recording recording_;
  ouster::Metadata metadata_;
  ouster::PacketLayout layout_;
  BeamModel model_;
  std::vector<LidarColumn> columns_;
  ColumnLabels labels_;
  uint64_t taken_ = 0;  // columns
  std::unique_ptr<Mapper> mapper_ = std::make_unique<Mapper>();
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  Status status_ = Status::kOk;
};

}  // namespace hardpack::command
