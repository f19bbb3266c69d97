// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "hal/velodyne/velodyne.h"

// A Velodyne VLP-16 or VLP-32C as the lidar of a vehicle (hal/onboard/vehicle_loop/devices.h). It
// follows the packets of one sensor, accepts those that are whole, from this sensor and new,
// detects a restart of the sensor's clock, and gives each firing a place among the columns.
//
// Frames. `lidar` and `sensor` are the same: x at the sensor's azimuth 0 (the manufacturer's y,
// away from the cable), y to the left, z up, the origin on the axis at the height of the optics. So
// an azimuth a is the angle -a, and measurement ids grow with the azimuth as the head turns,
// clockwise.
//
// Columns. A revolution has a grid of 1.03 times as many columns as firings (2048 at 540 rpm), so
// that each firing gets its own place even if the head turns a little slower: the nearest one not
// used by the previous firing. The firing is at most 1.5 columns away from its place, and reports
// the offset (LidarColumn::azimuth_offset_rad). 3 places in 100 stay empty, and nothing is lost.
//
// Azimuths. A packet has one azimuth per block. For a firing within a block, it is interpolated
// from the next block's azimuth; in the last block, from the previous block's. The azimuths are
// rounded to 0.01 degree.
//
// Clock. Microseconds past the hour are extended beyond the hour. Two packets are apart by a
// multiple of one packet's duration. A stamp that goes back in any other way, or by more than 64
// packets, or ahead by more than kMostAhead_us, means that the sensor has restarted.

namespace hardpack::velodyne {

// Packets since Configure. All but `restarts`, `jumps`, `out_of_order` and `missing` are mutually
// exclusive and add up to the number of calls of Check.
struct PacketCounters {
  uint64_t accepted = 0;      // kOk
  uint64_t wrong_size = 0;    // not kPacket_bytes
  uint64_t wrong_type = 0;    // not a data packet, by its flags
  uint64_t wrong_sensor = 0;  // another product
  uint64_t wrong_mode = 0;    // another return mode
  uint64_t bad_azimuth = 0;   // out of range
  uint64_t bad_time = 0;      // an hour or more
  uint64_t wrong_rate = 0;    // the head does not turn at the configured rate, or is starting up
  uint64_t not_resumed = 0;   // after a restart of the sensor, before Resume; or much too late
  uint64_t duplicates = 0;    // one of the last 64

  uint64_t restarts = 0;      // begun
  uint64_t out_of_order = 0;  // accepted after a later one, at most 63 packets late
  uint64_t missing = 0;       // by the stamps, between two accepted packets, and not arrived since
  uint64_t jumps = 0;         // the clock was set: nothing is missing
};

class Lidar {
 public:
  using Config = velodyne::Config;
  static constexpr int kMaxColumns = kMaxFirings;
  // A sensor that is silent for longer counts as restarted.
  static constexpr int32_t kMostAhead_us = 5'000'000;

  // Empty for a configuration that CheckConfig refuses.
  static LidarLayout LayoutOf(const Config& config);
  // Places in the grid, including those left empty, at the fastest rate accepted.
  static int32_t MostColumnsPerSecond(const Config& config);

  // Resets everything. The statuses of CheckConfig; on failure no packet is accepted.
  Status Configure(const Config& config);

  // Checks one datagram. kOk: its columns can be decoded. Otherwise they must not be:
  // kNotStarted: Configure has not succeeded; nothing is counted. kDuplicate: it was accepted
  // before. kSensorRestarted: the sensor has restarted; returned for all following packets until
  // Resume, but a packet that continues the earlier sequence is still accepted. Otherwise as
  // ReadHeader.
  // Cost: the blocks and the firings.
  Status Check(std::span<const uint8_t> packet);

  // Accepts the restart of the sensor; does nothing if none has been seen.
  void Resume();

  int columns() const { return format_.firings; }
  // A column of the packet that Check accepted last. kNotStarted: there is none; kInvalidArgument:
  // no such index; kTruncated: not a packet's size. On failure the column is untouched. Cost: the
  // beams.
  Status Decode(std::span<const uint8_t> packet, int index, LidarColumn& column) const;

  const PacketCounters& counters() const { return counters_; }

 private:
  static constexpr int32_t kHistory = 64;  // bits of accepted_

  // The place of a firing.
  struct Place {
    uint16_t frame_id = 0;
    uint16_t measurement_id = 0;
    float offset_rad = 0.0f;
  };
  // What is kept of a packet to order the following ones.
  struct Stamp {
    uint32_t time_us = 0;  // past the hour
    uint64_t time_ns = 0;  // extended beyond the hour
    int32_t azimuth_cdeg = 0;
    uint16_t frame_id = 0;
  };

  Status Follow(const PacketHeader& header);
  Status NoteRestart();
  void Anchor(const PacketHeader& header);
  bool IsOnGrid(int32_t ahead_us, int32_t packets) const;
  Stamp StampOf(const PacketHeader& header, int32_t ahead_us) const;
  void Lay(const PacketHeader& header, uint16_t frame_id, bool follows);
  float AzimuthOf_cdeg(const PacketHeader& header, int32_t firing) const;
  void Count(Status status);

  bool configured_ = false;
  bool anchored_ = false;
  bool restarted_ = false;   // and Resume has not been called
  bool has_packet_ = false;  // one was accepted since Configure
  Config config_;
  Format format_;
  int32_t columns_ = 0;       // per revolution
  float packet_us_ = 0.0f;    // duration of a packet
  float cdeg_per_us_ = 0.0f;  // as configured
  Stamp newest_;
  // Which of the last kHistory packets were accepted: bit k for the one k before the newest.
  uint64_t accepted_ = 0;
  int32_t packets_ = 0;        // from the first accepted to the newest, at most kHistory
  Place last_;                 // of the newest packet
  uint64_t packet_ns_ = 0;     // of the packet accepted last ...
  Place places_[kMaxFirings];  // ... and where its firings lie
  PacketCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Lidar>);

}  // namespace hardpack::velodyne
