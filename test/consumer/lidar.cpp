// SPDX-License-Identifier: Apache-2.0
// Lidar datagrams in, a plan out, as on board; the vehicle stands. Standard input, of each datagram
// and little-endian: when it came [ns since start] (u64), its size (u32), its bytes (datagrams.py).
#include "core/autonomy/mapper.h"
#include "core/autonomy/planner.h"
#include "core/base/byte_reader.h"
#include "core/timebase/timebase.h"
#include "hal/ouster/packet_monitor.h"

#include <cstdio>

using namespace hardpack;

// The sensor of `hardpack scene`: OS1-64, first generation, LEGACY (all that is not set is as it is
// by default). ouster::ReadMetadata of port_linux reads the same from the sensor's JSON.
static ouster::Metadata DescribeSensor() {
  ouster::Metadata sensor;
  sensor.beams = 64;
  sensor.columns_per_frame = 1024;
  sensor.columns_per_packet = 16;
  sensor.column_window_last = 1023;
  sensor.lidar_origin_to_beam_origin_m = 0.012163f;
  sensor.sensor_from_lidar = {{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0.0f, 0.0f, 0.03618f}};
  constexpr float kAzimuth_deg[] = {3.1f, 1.03f, -1.03f, -3.1f};
  for (int beam = 0; beam < 64; ++beam) {
    sensor.beam_altitude_deg[beam] = 16.6f - 33.2f * static_cast<float>(beam) / 63.0f;
    sensor.beam_azimuth_deg[beam] = kAzimuth_deg[beam % 4];
  }
  return sensor;
}

// docs/your_lidar.md: from here
static ouster::PacketMonitor monitor;
static Timebase timebase;
static Mapper mapper;    // 4.3 MiB
static Planner planner;  // 3.6 MiB

static bool SetUp(const ouster::Metadata& sensor) {
  static BeamModel model;
  const auto beams = static_cast<size_t>(sensor.beams);
  return monitor.Configure(sensor) == Status::kOk &&
         MakeBeamModel({sensor.beam_altitude_deg, beams}, {sensor.beam_azimuth_deg, beams},
                       sensor.columns_per_frame, sensor.lidar_origin_to_beam_origin_m,
                       sensor.sensor_from_lidar, model) == Status::kOk &&
         mapper.Configure(PerceptionParams{}, CostmapParams{}, RellisLabelTable(), model,
                          sensor.column_window_first, sensor.column_window_last) == Status::kOk;
}

static void TakeDatagram(std::span<const uint8_t> packet, uint64_t came_ns) {
  static LidarColumn column;
  ouster::PacketHeader header;
  // After kSensorRestarted: read the metadata again, set up anew, monitor.Resume().
  if (!IsUsable(monitor.Check(packet, header))) return;  // counted, as all that is refused
  const ouster::PacketLayout& layout = monitor.layout();
  const int last = layout.columns_per_packet - 1;  // its stamp was delayed the least
  if (IsUsable(ouster::DecodeColumn(layout, packet, last, column))) {
    if (!IsUsable(timebase.Observe(column.timestamp_ns, came_ns))) return;
  }
  for (int i = 0; i <= last && !timebase.suspect(); ++i) {
    if (!IsUsable(ouster::DecodeColumn(layout, packet, i, column))) continue;
    const Result<uint64_t> time_ns = timebase.ToHost(column.timestamp_ns);
    if (time_ns.ok()) static_cast<void>(mapper.AddColumn(column, time_ns.value()));
  }
}

// 100 times a second, ahead of the columns of that time.
static bool Tick(uint64_t now_ns) {
  StampedPose pose;  // of your odometry; this vehicle stands
  pose.time_ns = now_ns;
  mapper.Advance(now_ns);
  return IsUsable(mapper.AddPose(pose));
}

static const Plan& PlanTo(const Vec2& goal_odom) {
  PlanRequest request;  // from where the vehicle is: here the origin
  request.goal_odom = goal_odom;
  if (IsUsable(planner.Begin(mapper, PlannerParams{}, request))) {
    while (planner.Step(mapper, 1000) == Progress::kBusy) {  // on board: a few units in every tick
    }
  }
  return planner.result();
}
// docs/your_lidar.md: to here

// Empty at the end, or where a record is damaged.
static std::span<const uint8_t> ReadDatagram(uint64_t& came_ns) {
  constexpr uint64_t kHour_ns = 3'600'000'000'000;
  static uint8_t bytes[ouster::kMaxPacketBytes];
  uint8_t head[12];
  if (std::fread(head, 1, sizeof(head), stdin) != sizeof(head)) return {};
  came_ns = ByteReader(head).U64(0);
  const size_t size = ByteReader(head).U32(8);
  if (came_ns > kHour_ns || size > sizeof(bytes)) return {};
  return {bytes, std::fread(bytes, 1, size, stdin)};
}

int main() {
  if (!SetUp(DescribeSensor())) return 1;
  uint64_t came_ns = 0;
  uint64_t tick_ns = 0;
  for (auto packet = ReadDatagram(came_ns); !packet.empty(); packet = ReadDatagram(came_ns)) {
    for (; tick_ns <= came_ns; tick_ns += 10'000'000) {
      if (!Tick(tick_ns)) return 1;
    }
    TakeDatagram(packet, came_ns);
  }
  const Plan& plan = PlanTo({22.0f, 4.0f});
  const ScanCounters& counters = mapper.ring().counters();
  std::printf("%u columns, %u missing; %s, %d points, %.1f m, %.2f m clear\n", counters.columns,
              counters.missing_columns, StatusName(plan.status), plan.path.size(),
              LengthOf(plan.path), plan.check.smallest_clearance_m);
  return IsUsable(plan.status) ? 0 : 1;
}
