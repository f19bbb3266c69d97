// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/costmap/height_grid.h"
#include "core/scan/scan.h"
#include "hal/ouster/ouster.h"
#include "tools/hardpack/bench_stages.h"
#include "tools/scene/recording.h"

namespace hardpack::command {

// The stages before planning, on one made-up revolution of 1024 columns of 64 beams.
class RevolutionBench {
 public:
  RevolutionBench();

  BenchRow Decode();  // the revolution's 64 packets into columns
  BenchRow Scan();    // its columns into the ring, and their returns as points into the heights

 private:
  void FileRevolution();
  Status FileColumn(const LidarColumn& column, const Transform3& odom_from_sensor);

  scene::Recording recording_;
  ouster::Metadata metadata_;
  ouster::PacketLayout layout_;
  BeamModel model_;
  LidarMountParams mount_;
  std::vector<LidarColumn> columns_;
  std::unique_ptr<ScanRing> ring_ = std::make_unique<ScanRing>();
  std::unique_ptr<HeightGrid> heights_ = std::make_unique<HeightGrid>();
  Status status_ = Status::kOk;
};

}  // namespace hardpack::command
