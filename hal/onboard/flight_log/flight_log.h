// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/status.h"
#include "hal/onboard/flight_log/packets.h"
#include "hal/onboard/flight_log/records.h"
#include "hal/onboard/vehicle_loop/tick.h"
#include "hal/recorder.h"

// Writes a run into a Recorder as a capture of the traffic on the wires, in and out, interleaved
// with records of our own (records.h): all input of every tick, so that the run can be repeated,
// and its decisions, for comparison. docs/flight_log.md is for readers of such files. Around every
// tick:
//
//   log.BeginTick(input, arrivals, state);   // state: AnyVehicle::state()
//   status = vehicle.Tick(input, output);
//   log.EndTick({index, status, vehicle.pilot().decision_hash(), duration_ns, refused}, output);
//
// A file:  Version  Configuration...  LidarMetadata...  [State image...]  tick  tick  ...  [End]
// A tick:  TickBegin  frames in  datagrams in  [Command]  frames out  [part of the image]  TickEnd
//
// Unless a file is the first of its run, the state before its first tick is copied at once and
// written in parts with the following ticks, kImagePartsPerTick each, so that no tick carries all
// of it. Nothing here can fail the tick: what the recorder cannot accept shows in its counters.

namespace hardpack::flight_log {

struct FlightLogSetup {
  // For the program and its vehicle; state_bytes, file and next_tick are filled in here.
  VersionRecord version;
  // The texts from which the VehicleConfig was made. They must outlive the log.
  std::span<const uint8_t> configuration;   // TOML, at most kMaxTextBytes
  std::span<const uint8_t> lidar_metadata;  // JSON, at most kMaxTextBytes
  // Default endpoints of a datagram by its source, if BeginTick gets none.
  Endpoint sender[kInputSources] = {};
  Endpoint receiver[kInputSources] = {};
  int32_t can_interface = 0;  // its index in the operating system; 0: unknown
  // Wall clock [ns since 1970] minus our clock, taken once: added to a tick's time for the stamps
  // of its packets.
  int64_t wall_clock_offset_ns = 0;
};

// Origin of one datagram of a tick.
struct Arrival {
  int64_t kernel_time_ns = 0;  // wall clock; 0: unknown
  Endpoint sender;
};

struct TickArrivals {
  std::span<const Arrival> datagrams;  // parallel to TickInput::datagrams; empty: use the setup
  uint32_t command_user = 0;           // who sent the command
};

struct TickResult {
  uint64_t index = 0;
  Status status = Status::kOk;
  uint64_t decision_hash = 0;
  uint64_t duration_ns = 0;
  int32_t refused_frames = 0;  // refused by the bus
};

class FlightLog {
 public:
  static constexpr size_t kMaxTextBytes = size_t{1} << 20u;
  static constexpr size_t kMaxStateBytes = size_t{1} << 24u;
  static constexpr int kImagePartsPerTick = 4;
  // A kernel's stamp is used for a packet if it is at most this long before the tick.
  static constexpr int64_t kMaxStampAge_ns = 1'000'000'000;

  // Nothing is recorded before Start. `snapshot` is the log's buffer for a copy of the state; if it
  // is too small or empty, files other than the first of a run cannot be replayed alone. Both must
  // outlive the log.
  FlightLog(Recorder& recorder, std::span<uint8_t> snapshot);

  // kOversized: a text is longer than kMaxTextBytes; nothing will be recorded then.
  Status Start(const FlightLogSetup& setup);

  // Before Tick. Opens a file if the recorder wants one; `state` is then copied, if a tick has been
  // logged before. Cost: a copy of the input; at a new file, of the state and the texts.
  void BeginTick(const TickInput& input, const TickArrivals& arrivals,
                 std::span<const std::byte> state);

  // After Tick. Cost: the frames, and the image parts that are due.
  void EndTick(const TickResult& result, const TickOutput& output);

  // The run ends normally.
  void End();

 private:
  void Open(std::span<const std::byte> state);
  void TakeSnapshot(std::span<const std::byte> state);
  void RecordVersion(size_t state_bytes);
  void RecordTick(const TickInput& input);
  void RecordCommand(uint32_t user, std::span<const uint8_t> command);
  void RecordText(RecordKind kind, std::span<const uint8_t> text);
  void RecordPart(RecordKind kind, const PartRecord& part, std::span<const uint8_t> bytes);
  void RecordDatagram(const TickDatagram& datagram, const Arrival* arrival);
  void RecordFrame(const CanFrame& frame, Direction direction, int64_t time_ns);
  void RecordImageParts();
  void RecordOwn(const RecordHead& head, std::span<const uint8_t> bytes);

  Recorder& recorder_;
  std::span<uint8_t> snapshot_;
  FlightLogSetup setup_;
  bool started_ = false;
  uint32_t files_ = 0;
  bool any_tick_ = false;
  uint64_t last_index_ = 0;   // of the last logged tick
  int64_t tick_time_ns_ = 0;  // wall clock
  size_t image_bytes_ = 0;    // of the snapshot being written; 0: none
  size_t image_done_bytes_ = 0;
  uint32_t image_crc_ = 0;
  uint64_t image_index_ = 0;
};

}  // namespace hardpack::flight_log
