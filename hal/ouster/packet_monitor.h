// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/status.h"
#include "hal/ouster/ouster.h"

// Follows the lidar packets of one sensor: passes those that are complete, its own and new, reports
// when the sensor has restarted, and counts lost and refused ones. Decodes no columns
// (hal/ouster/ouster.h) and keeps no account of columns (core/scan).

namespace hardpack::ouster {

// Packets since Configure. All except `restarts`, `jumps`, `out_of_order`, `missing` and `unplaced`
// are mutually exclusive and add up to the number of calls of Check.
struct PacketCounters {
  uint64_t accepted = 0;      // kOk
  uint64_t wrong_size = 0;    // not the layout's size
  uint64_t wrong_type = 0;    // not a lidar packet, by its header
  uint64_t bad_crc = 0;       // damaged in transit
  uint64_t wrong_sensor = 0;  // another serial number
  uint64_t not_resumed = 0;   // from the sensor's new start, before Resume
  uint64_t before_start = 0;  // from its previous start, after Resume
  uint64_t duplicates = 0;    // the same place in the same revolution as one of the last 64

  uint64_t restarts = 0;  // new init ids seen

  // From the frame id and the first measurement id; only if the packets of a revolution can be
  // numbered, i.e. if columns_per_packet divides columns_per_frame.
  uint64_t out_of_order = 0;  // accepted after a later one, at most 64 places late
  uint64_t missing = 0;       // places skipped between two accepted packets, and not filled since
  uint64_t jumps = 0;         // the revolution count jumped: nothing counts as missing
  uint64_t unplaced = 0;      // accepted, but outside the window or not at a packet's first column
};

// Trivially copyable, no pointers; the caller's.
class PacketMonitor {
 public:
  // Frames that may be lost at once and still count as missing; beyond that, or more than 64 places
  // back, it is a jump.
  static constexpr int kMaxFrameGap = 100;

  // Begins to follow the sensor that the metadata describe; any missing part of its identity is
  // learned from the first accepted packet. Clears everything before. The statuses of MakeLayout;
  // on failure no packet is accepted.
  Status Configure(const Metadata& metadata);

  // Layout of the packets that Check accepts; for DecodeColumn.
  const PacketLayout& layout() const { return layout_; }

  // Checks one datagram. kOk: its columns can be decoded. Otherwise they must not be: kNotStarted:
  // Configure has not succeeded; nothing is counted. kTruncated, kOversized, kWrongPacketType,
  // kBadCrc, kWrongSensor: as CheckPacket. kDuplicate: it was accepted before. kSensorRestarted: it
  // is from a new start of the sensor, as are all that follow, until Resume. kLate: it is from the
  // previous start. A LEGACY packet carries no identity: a restart of such a sensor shows only as a
  // jump. Cost: that of CheckPacket.
  Status Check(std::span<const uint8_t> packet, PacketHeader& header);

  // Accepts the sensor's new start. The caller must do this once its knowledge of the sensor holds
  // for the new start too (its metadata: a sensor also restarts when it is reconfigured, possibly
  // to other columns at the same packet size), and it has dropped its data from the old one. No
  // effect if no restart has been seen.
  void Resume();
  // A restart has been seen, and Resume has not been called.
  bool restarted() const { return new_init_id_ != kNone; }

  // The identity in use: stated or learned.
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
  uint32_t old_init_id_ = kNone;  // of the previous start
  uint32_t new_init_id_ = kNone;  // of the start waiting for Resume
  PacketCounters counters_;

  // Packets of a revolution, numbered 0 .. packets_per_frame_ - 1 in the order of their columns;
  // sent are those with a column of the window. 0: they cannot be numbered.
  int32_t packets_per_frame_ = 0;
  int32_t first_sent_ = 0;
  int32_t last_sent_ = 0;  // inclusive; first_sent_ > last_sent_ wraps past zero
  int32_t sent_per_frame_ = 0;

  // The most advanced packet, and which of the kHistory places up to it were accepted: bit k for
  // the place k before.
  bool anchored_ = false;
  uint16_t newest_frame_id_ = 0;
  int32_t newest_place_ = 0;  // among those sent in a revolution
  uint64_t accepted_ = 0;
  int32_t places_ = 0;  // from the first accepted up to it, at most kHistory
};
static_assert(std::is_trivially_copyable_v<PacketMonitor>);

}  // namespace hardpack::ouster
