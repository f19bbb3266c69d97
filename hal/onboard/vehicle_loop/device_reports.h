// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "config/onboard_parameters.h"
#include "core/timebase/timebase.h"
#include "hal/onboard/control/status_report.h"
#include "hal/ouster/lidar.h"
#include "hal/pose_datagram/pose_datagram.h"
#include "hal/sevcon/sevcon.h"
#include "hal/twist_drive/twist_drive.h"
#include "hal/vectornav/stream_parser.h"
#include "hal/velodyne/lidar.h"

// What an operator sees of each device: its counters and states, copied into its part of the status
// report. A device of another vehicle has a function of the same form in its own namespace, where
// VehicleOf (any_vehicle.h) finds it by its argument.

namespace hardpack {

namespace ouster {
void AddToReport(const Lidar& lidar, control::StatusReport& report);
}
namespace velodyne {
void AddToReport(const Lidar& lidar, control::StatusReport& report);
}
namespace vectornav {
void AddToReport(const StreamParser& ins, control::StatusReport& report);
}
namespace sevcon {
void AddToReport(const DrivePair& drives, uint64_t now_ns, const OnboardParams& onboard,
                 control::StatusReport& report);
}
namespace pose_datagram {
void AddToReport(const Receiver& ins, control::StatusReport& report);
}
namespace twist_drive {
void AddToReport(const TwistDrive& drive, uint64_t now_ns, const OnboardParams& onboard,
                 control::StatusReport& report);
}
void AddToReport(const Timebase& clock, control::LidarClockPart& part);

}  // namespace hardpack
