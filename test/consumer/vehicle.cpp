// SPDX-License-Identifier: Apache-2.0
// A vehicle of one's own, outside of hardpack's sources: its devices as types, its loop made here.
// It has steered wheels and a motion controller that takes a speed and a turn; it is configured and
// ticks for a second in which nothing comes in.
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "hal/onboard/vehicle_loop/vehicle_loop_tick.h"
#include "hal/twist_drive/twist_drive.h"

#include <cstdio>

using namespace hardpack;

// docs/your_vehicle.md: from here
struct MyVehicle {
  static constexpr const char* kType = "my_vehicle";  // for vehicle.type
  using Lidar = ouster::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = twist_drive::TwistDrive;
};
static_assert(VehicleType<MyVehicle>);
template class hardpack::BasicVehicleLoop<MyVehicle>;

static BasicVehicleLoop<MyVehicle> loop;  // 8 MiB
static BasicVehicleConfig<MyVehicle> config;

static void DescribeBody() {
  VehicleParams& vehicle = config.planner.vehicle;
  vehicle.length_m = 2.0f;
  vehicle.width_m = 1.2f;
  vehicle.axle_offset_m = -0.6f;  // of the rear axle
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.wheelbase_m = 1.5f;
  vehicle.max_steering_rad = 0.45f;
  config.onboard.twist_drive.turn = TwistDriveParams::kSteering;
  config.onboard.odometry.ground_per_wheel = 1.0f;  // it measures the motion over ground
  LidarMountParams& mount = config.perception.mount;
  mount.x_m = 0.6f;
  mount.self_min_x_m = -0.7f;
  mount.self_max_x_m = 1.7f;
  mount.self_max_abs_y_m = 0.7f;
}
// docs/your_vehicle.md: to here

static void DescribeLidar() {
  ouster::Metadata& sensor = config.lidar;
  sensor.beams = 64;
  sensor.columns_per_frame = 1024;
  sensor.columns_per_packet = 16;
  sensor.column_window_last = 1023;
  for (int beam = 0; beam < 64; ++beam) {
    sensor.beam_altitude_deg[beam] = 16.6f - 33.2f * static_cast<float>(beam) / 63.0f;
  }
}

int main() {
  DescribeBody();
  DescribeLidar();
  const Status configured = loop.Configure(config);
  if (!IsUsable(configured)) {
    std::printf("%s\n", StatusName(configured));
    return 1;
  }
  static TickOutput output;
  TickInput input;
  input.bus = CanBusState::kActive;
  int frames = 0;
  for (input.index = 1; input.index <= 100; ++input.index) {
    input.now_ns = input.index * 10'000'000;
    if (!IsUsable(loop.Tick(input, output))) return 1;
    frames += output.frames.size();
  }
  const bool is_in_standby = loop.permission().mode == Mode::kStandby;
  std::printf("%s: %s, %s\n", MyVehicle::kType, is_in_standby ? "in standby" : "not in standby",
              frames > 0 ? "it calls its drives" : "nothing is sent");
  return is_in_standby ? 0 : 1;
}
