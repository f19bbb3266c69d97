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

// Writes a run into a Recorder as a capture of what went over the wires, in and out, with records
// of our own between (records.h): everything that a tick was given, so that the run can
// be done again, and what it decided, to be compared. docs/flight_log.md is for those who read such
// files. Around every tick:
//
//   log.BeginTick(input, arrivals, state);   // state: AnyVehicle::state()
//   status = vehicle.Tick(input, output);
//   log.EndTick({index, status, vehicle.pilot().decision_hash(), duration_ns, refused}, output);
//
// A file:  Version  Configuration...  LidarMetadata...  [State image...]  tick  tick  ...  [End]
// A tick:  TickBegin  frames in  datagrams in  [Command]  frames out  [part of the image]  TickEnd
//
// Where a file is not the first of its run, the state before its first tick is copied at once and
// given out in parts with the ticks that follow, kImagePartsPerTick each, so that no tick carries
// the whole of it. Nothing here can fail the tick: what the recorder cannot take is its counters'.

namespace hardpack::flight_log {

struct FlightLogSetup {
  // Of the program and of its vehicle; state_bytes, file and next_tick are filled in here.
  VersionRecord version;
  // The texts that the VehicleConfig was made from. They must outlive the log.
  std::span<const uint8_t> configuration;   // TOML, at most kMaxTextBytes
  std::span<const uint8_t> lidar_metadata;  // JSON, at most kMaxTextBytes
  // Of a datagram by its source where BeginTick is not told, and where it went.
  Endpoint sender[kInputSources] = {};
  Endpoint receiver[kInputSources] = {};
  int32_t can_interface = 0;  // its index, as the operating system counts; 0: not known
  // Wall clock [ns since 1970] less our clock, taken once: what is added to a tick's time for its
  // packets' stamps.
  int64_t wall_clock_offset_ns = 0;
};

// Where one datagram of a tick came from.
struct Arrival {
  int64_t kernel_time_ns = 0;  // wall clock; 0: not known
  Endpoint sender;
};

struct TickArrivals {
  std::span<const Arrival> datagrams;  // as TickInput::datagrams; empty: as the setup says
  uint32_t command_user = 0;           // who sent the command
};

struct TickResult {
  uint64_t index = 0;
  Status status = Status::kOk;
  uint64_t decision_hash = 0;
  uint64_t duration_ns = 0;
  int32_t refused_frames = 0;  // that the bus did not accept
};

class FlightLog {
 public:
  static constexpr size_t kMaxTextBytes = size_t{1} << 20u;
  static constexpr size_t kMaxStateBytes = size_t{1} << 24u;
  static constexpr int kImagePartsPerTick = 4;
  // A kernel's stamp is taken for a packet's when it is no farther before the tick.
  static constexpr int64_t kMaxStampAge_ns = 1'000'000'000;

  // Nothing is recorded before Start. `snapshot` is the log's own room for a copy of the state; one
  // that is too small, or empty: files that are not the first of a run cannot be replayed alone.
  // Both must outlive the log.
  FlightLog(Recorder& recorder, std::span<uint8_t> snapshot);

  // kOversized: a text is longer than kMaxTextBytes; then nothing will be recorded.
  Status Start(const FlightLogSetup& setup);

  // Before Tick. Opens a file when the recorder wants it; `state` is then copied, if a tick has
  // been logged before. Cost: a copy of the input; at a new file, of the state and the texts.
  void BeginTick(const TickInput& input, const TickArrivals& arrivals,
                 std::span<const std::byte> state);

  // After it. Cost: the frames, and the parts of an image that are due.
  void EndTick(const TickResult& result, const TickOutput& output);

  // The run ends as it should.
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
  uint64_t last_index_ = 0;   // of the last tick that was logged
  int64_t tick_time_ns_ = 0;  // wall clock
  size_t image_bytes_ = 0;    // of the snapshot that is being given out; 0: none is
  size_t image_done_bytes_ = 0;
  uint32_t image_crc_ = 0;
  uint64_t image_index_ = 0;
};

}  // namespace hardpack::flight_log
