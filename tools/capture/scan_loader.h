// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/parameters.h"
#include "core/autonomy/mapper.h"
#include "core/base/pose.h"
#include "core/measurements/measurements.h"
#include "core/segmentation/label_table.h"
#include "hal/ouster/ouster.h"
#include "port_linux/files/read_outcome.h"
#include "tools/capture/standing_scan.h"

// Passes one revolution of a recorded lidar through the mapper: a capture (pcap), the sensor's
// metadata (JSON) and, if available, the labels of its returns (CSV). Connects the readers of this
// folder to hal/ouster and core/autonomy; decides nothing about obstacles. Everything is measured
// from one pose: the vehicle is assumed to stand still meanwhile.

namespace hardpack::capture {

struct LidarScanRequest {
  std::string capture_path;
  std::string metadata_path;
  std::string labels_path;      // empty: no labels
  PerceptionParams perception;  // use_labels is set if there are any
  CostmapParams costmap;        // the heights that matter
  LabelTable labels = RellisLabelTable();
  StampedPose pose;  // of the vehicle while the revolution was taken; its time has no effect
};

// What was read. Reading ends with the revolution taken, and so do the counts.
struct LidarScanReport {
  ouster::Metadata metadata;
  uint16_t frame_id = 0;          // the revolution that was taken
  int64_t datagrams = 0;          // UDP datagrams in the capture, whole ones
  int64_t packets = 0;            // of these, lidar packets of this sensor
  int64_t foreign_packets = 0;    // the others: of another size, type, sensor or connection
  int64_t damaged_datagrams = 0;  // cut by the capture, or fragments that never became whole
  int64_t columns = 0;            // valid columns of the revolution taken
  int64_t missing_columns = 0;    // of the sensor's column window, not received as valid
  int64_t labelled_returns = 0;   // returns that the label file names
  FiledReturns filed;
};

// Reads one revolution: the first complete one (all columns of the sensor's window), otherwise the
// fullest. The sender and destination port of the first lidar packet are the sensor's; packets from
// elsewhere are foreign. Configures the mapper, which empties it.
// With labels, a return has the class of its label, and a return that is not in the file has code
// 255: hard, when in doubt. Without labels geometry decides (core/segmentation). A return labelled
// as a person is never taken for the vehicle itself. On failure the status and a one-line message
// that names the file.
ReadOutcome LoadLidarScan(const LidarScanRequest& request, Mapper& mapper, LidarScanReport& report);

}  // namespace hardpack::capture
