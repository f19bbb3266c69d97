// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "port_linux/files/read_outcome.h"
#include "tools/sim/vehicle/wheel_dynamics.h"

// A recording of a driven vehicle at a fixed rate, in segments: the commands, the wheels' encoder
// speeds, and the poses determined with a lidar. The format is that of config/vehicles' source, a
// CSV with the header kDriveRecordHeader.
//
// Values are held between updates: wheel speeds arrive at 4 Hz, poses at about 10 Hz. Only a sample
// whose value differs from the previous one is fresh, and only fresh ones are compared with a
// model.

namespace hardpack::fit {

inline constexpr std::string_view kDriveRecordHeader =
    "seg,step,t_s,cmd_left_radps,cmd_right_radps,meas_left_radps,meas_right_radps,"
    "icp_x,icp_y,icp_z,icp_roll,icp_pitch,icp_yaw";

struct DriveSample {
  double t_s = 0.0;  // since the start of the segment
  sim::WheelSpeeds command;
  sim::WheelSpeeds measured;
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  // not wrapped
  bool fresh_left = false;
  bool fresh_right = false;
  bool fresh_pose = false;
};

// Segments whose numbers share all but the last digit were driven without a break: a run.
struct DriveSegment {
  int number = 0;
  bool has_history = false;  // the previous segment exists, and this one continues it
  sim::WheelSpeeds history;  // the setpoints before its start; otherwise the wheel speeds then
  std::vector<DriveSample> samples;

  int run() const { return number / 10; }
};

// kInvalidArgument, with file and line: not readable, another header, a row with a value that is
// not a finite number, segments out of order, time steps that are not positive, fewer than 4
// samples in a segment. kOversized: above 64 MiB. The lengths of segments may differ.
ReadOutcome ReadDriveRecord(const std::string& path, std::vector<DriveSegment>& segments);
ReadOutcome ParseDriveRecord(std::string_view text, const std::string& name,
                             std::vector<DriveSegment>& segments);

}  // namespace hardpack::fit
