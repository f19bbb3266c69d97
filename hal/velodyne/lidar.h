// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "core/measurements/measurements.h"
#include "hal/velodyne/velodyne.h"

// A Velodyne VLP-16 or VLP-32C as the lidar of a vehicle (hal/onboard/vehicle_loop/devices.h):
// follows the packets of one sensor, lets through the ones that are whole, its own and new, says
// when its clock has begun anew, and gives each firing a place among the columns.
//
// Frames. `lidar` and `sensor` are one: x where the sensor's azimuth is 0 (what its maker calls y,
// away from the cable), y to the left, z up, the origin on the axis at the height of the optics. So
// an azimuth a is the angle -a, and measurement ids grow with it as the head turns, clockwise.
//
// Columns. A revolution has a grid of 1.03 times as many columns as firings (2048 at 540 rpm), so
// that each firing has a place of its own also where the head turns a little slower: the nearest
// one that the firing before does not have. It is at most 1.5 columns off; where it is, is told
// (LidarColumn::azimuth_offset_rad). 3 places of 100 are left out, and nothing is lost.
//
// Azimuths. A packet tells one for each block; that of a firing within it is interpolated from the
// next block's, and in the last one from the block before. They are rounded to 0.01 degree.
//
// Clock. Microseconds past the hour are told on beyond it. Two packets are apart by a multiple of
// what one takes; a stamp that goes back otherwise, or by more than 64 packets, or on by more than
// kMostAhead_us, is of a sensor that has started anew.

namespace hardpack::velodyne {

// Packets since Configure. All but `restarts`, `jumps`, `out_of_order` and `missing` exclude each
// other and add up to what was given to Check.
struct PacketCounters {
  uint64_t accepted = 0;      // kOk
  uint64_t wrong_size = 0;    // not kPacket_bytes
  uint64_t wrong_type = 0;    // no data packet, by its flags
  uint64_t wrong_sensor = 0;  // another product
  uint64_t wrong_mode = 0;    // another return mode
  uint64_t bad_azimuth = 0;   // that cannot be
  uint64_t bad_time = 0;      // of an hour and more
  uint64_t wrong_rate = 0;    // turns otherwise than it is set up to, or begins to turn
  uint64_t not_resumed = 0;   // of the sensor's new start, before Resume; or much too late
  uint64_t duplicates = 0;    // one of the last 64

  uint64_t restarts = 0;      // begun
  uint64_t out_of_order = 0;  // accepted after a later one, at most 63 packets late
  uint64_t missing = 0;       // by the stamps, between two accepted packets, and not come since
  uint64_t jumps = 0;         // the clock was set: nothing is missing
};

class Lidar {
 public:
  using Config = velodyne::Config;
  static constexpr int kMaxColumns = kMaxFirings;
  // A sensor that is silent for longer counts as started anew.
  static constexpr int32_t kMostAhead_us = 5'000'000;

  // Of a configuration that CheckConfig refuses: an empty one.
  static LidarLayout LayoutOf(const Config& config);
  // Places in the grid, those that are left out included, at the fastest that is accepted.
  static int32_t MostColumnsPerSecond(const Config& config);

  // Forgets everything before. The statuses of CheckConfig; on failure no packet is accepted.
  Status Configure(const Config& config);

  // Judges one datagram. kOk: its columns can be decoded. Otherwise they are not to be:
  // kNotStarted: Configure has not succeeded; nothing is counted. kDuplicate: it was accepted
  // before. kSensorRestarted: it is of a new start of the sensor, and so are all that follow, until
  // Resume; one that goes on from before is accepted all the same. All else as ReadHeader.
  // Cost: the blocks and the firings.
  Status Check(std::span<const uint8_t> packet);

  // Accepts the sensor's new start; nothing when none has been seen.
  void Resume();

  int columns() const { return format_.firings; }
  // Of the packet that Check accepted last. kNotStarted: there is none; kInvalidArgument: no such
  // index; kTruncated: not a packet's size; then the column is untouched. Cost: the beams.
  Status Decode(std::span<const uint8_t> packet, int index, LidarColumn& column) const;

  const PacketCounters& counters() const { return counters_; }

 private:
  static constexpr int32_t kHistory = 64;  // bits of accepted_

  // Of a firing.
  struct Place {
    uint16_t frame_id = 0;
    uint16_t measurement_id = 0;
    float offset_rad = 0.0f;
  };
  // A packet, as the order of the next ones is found.
  struct Stamp {
    uint32_t time_us = 0;  // past the hour
    uint64_t time_ns = 0;  // on beyond it
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
  int32_t columns_ = 0;       // of a revolution
  float packet_us_ = 0.0f;    // what one takes
  float cdeg_per_us_ = 0.0f;  // as it is set up
  Stamp newest_;
  // Which of the kHistory packets up to the newest were accepted: bit k for the one k before.
  uint64_t accepted_ = 0;
  int32_t packets_ = 0;        // from the first accepted up to it, at most kHistory
  Place last_;                 // of the newest packet
  uint64_t packet_ns_ = 0;     // of the packet accepted last ...
  Place places_[kMaxFirings];  // ... and where its firings lie
  PacketCounters counters_;
};
static_assert(std::is_trivially_copyable_v<Lidar>);

}  // namespace hardpack::velodyne
