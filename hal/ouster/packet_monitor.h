// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "hal/ouster/ouster.h"

// Follows the lidar packets of one sensor: lets through the ones that are whole, its own and new,
// says when the sensor has started anew, and counts what was lost or refused on the way. Decodes no
// column (hal/ouster/ouster.h) and keeps no account of columns (core/scan).

namespace hardpack::ouster {

// Packets since Configure. All but `restarts`, `jumps`, `out_of_order`, `missing` and `unplaced`
// exclude each other and add up to what was given to Check.
struct PacketCounters {
  uint64_t accepted = 0;      // kOk
  uint64_t wrong_size = 0;    // not of the layout's size
  uint64_t wrong_type = 0;    // not a lidar packet, by its header
  uint64_t bad_crc = 0;       // damaged on the way
  uint64_t wrong_sensor = 0;  // another serial number
  uint64_t not_resumed = 0;   // of the sensor's new start, before Resume
  uint64_t before_start = 0;  // of its last start, after Resume
  uint64_t duplicates = 0;    // the same place of the same revolution as one of the last 64

  uint64_t restarts = 0;  // new init ids seen

  // From the frame id and the first measurement id; only where the packets of a revolution can be
  // numbered, that is when columns_per_packet divides columns_per_frame.
  uint64_t out_of_order = 0;  // accepted after a later one, at most 64 places late
  uint64_t missing = 0;       // places skipped between two accepted packets, and not filled since
  uint64_t jumps = 0;         // the count of revolutions went on elsewhere: nothing is missing
  uint64_t unplaced = 0;      // accepted, but outside the window or not at a packet's first column
};

// Trivially copyable, no pointers; the caller's.
class PacketMonitor {
 public:
  // Frames that may be lost at once and still be counted as missing; beyond, or further back than
  // 64 places, it is a jump.
  static constexpr int kMaxFrameGap = 100;

  // Begins to follow the sensor that the metadata describe; what they do not state of its identity
  // is learnt from the first packet that is accepted. Forgets everything before. The statuses of
  // MakeLayout; on failure no packet is accepted.
  Status Configure(const Metadata& metadata);

  // Of the packets that Check accepts; for DecodeColumn.
  const PacketLayout& layout() const { return layout_; }

  // Judges one datagram. kOk: its columns can be decoded. Otherwise they are not to be:
  // kNotStarted: Configure has not succeeded; nothing is counted. kTruncated, kOversized,
  // kWrongPacketType, kBadCrc, kWrongSensor: as CheckPacket. kDuplicate: it was accepted before.
  // kSensorRestarted: it is of a new start of the sensor, and so are all that follow, until Resume.
  // kLate: it is of the start before the present one. A LEGACY packet carries no identity: a
  // restart of such a sensor shows only as a jump.
  // Cost: that of CheckPacket.
  Status Check(std::span<const uint8_t> packet, PacketHeader& header);

  // Accepts the sensor's new start. For the caller to call when what it knows of the sensor is true
  // of the new start too (its metadata: a sensor starts anew also when it is configured anew, maybe
  // to other columns at the same packet size), and what it keeps from the old one is forgotten.
  // Nothing when no restart has been seen.
  void Resume();
  // A restart has been seen and Resume not been called.
  bool restarted() const { return new_init_id_ != kNone; }

  // What is held to: stated or learnt.
  const SensorIdentity& identity() const { return identity_; }
  const PacketCounters& counters() const { return counters_; }

 private:
  // Init ids are 24 bits wide.
  static constexpr uint32_t kNone = 0xffffffffu;
  static constexpr int32_t kHistory = 64;  // bits of accepted_

  Status CheckOrder(std::span<const uint8_t> packet);
  void CountRefused(Status status, const PacketHeader& header);
  int32_t PlaceInFrame(uint32_t first_measurement_id) const;
  void Anchor(uint16_t frame_id, int32_t place);

  bool configured_ = false;
  PacketLayout layout_;
  SensorIdentity identity_;
  uint32_t old_init_id_ = kNone;  // of the start before
  uint32_t new_init_id_ = kNone;  // of the start that waits for Resume
  PacketCounters counters_;

  // Packets of a revolution, numbered 0 .. packets_per_frame_ - 1 in the order of their columns;
  // sent are those that hold a column of the window. 0: they cannot be numbered.
  int32_t packets_per_frame_ = 0;
  int32_t first_sent_ = 0;
  int32_t last_sent_ = 0;  // inclusive; first_sent_ > last_sent_ wraps past zero
  int32_t sent_per_frame_ = 0;

  // The packet furthest on, and which of the kHistory places up to it were accepted: bit k for the
  // place k before.
  bool anchored_ = false;
  uint16_t newest_frame_id_ = 0;
  int32_t newest_place_ = 0;  // among those sent in a revolution
  uint64_t accepted_ = 0;
  int32_t places_ = 0;  // from the first accepted up to it, at most kHistory
};
static_assert(std::is_trivially_copyable_v<PacketMonitor>);

}  // namespace hardpack::ouster
