// SPDX-License-Identifier: Apache-2.0
// A vehicle of one's own, outside of hardpack's sources: its devices as types, its loop made here.
// It is configured and ticks for a second in which nothing comes in.
#include "hal/onboard/vehicle_loop/vehicle_loop.h"
#include "hal/onboard/vehicle_loop/vehicle_loop_tick.h"

#include <cstdio>

using namespace hardpack;

// docs/your_lidar.md, "A lidar of another maker": with your codec in the place of the Ouster.
struct MyVehicle {
  static constexpr const char* kType = "my_vehicle";  // for vehicle.type
  using Lidar = ouster::Lidar;
  using Ins = vectornav::StreamParser;
  using Drives = sevcon::DrivePair;
};
static_assert(VehicleType<MyVehicle>);
template class hardpack::BasicVehicleLoop<MyVehicle>;

static BasicVehicleLoop<MyVehicle> loop;  // 8 MiB
static BasicVehicleConfig<MyVehicle> config;

static void Describe() {
  config.onboard.drive.left_sign = 1;
  config.onboard.drive.right_sign = -1;
  config.onboard.drive.gear_ratio = 17.3f;
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
  Describe();
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
