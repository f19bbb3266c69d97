// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/packet_monitor.h"

#include "core/base/byte_reader.h"

namespace hardpack::ouster {
namespace {

constexpr size_t kMeasurementIdOffset = 8;  // in a column, in every profile
constexpr size_t kLegacyFrameIdOffset = 10;

}  // namespace

Status PacketMonitor::Configure(const Metadata& metadata) {
  *this = PacketMonitor{};
  const Status made = MakeLayout(metadata, layout_);
  if (!IsUsable(made)) return made;
  const int32_t columns = metadata.columns_per_frame;
  if (metadata.column_window_first < 0 || metadata.column_window_first >= columns ||
      metadata.column_window_last < 0 || metadata.column_window_last >= columns) {
    layout_ = PacketLayout{};
    return Status::kInvalidArgument;
  }
  configured_ = true;
  identity_ = {metadata.init_id, metadata.serial_number};
  if (columns % metadata.columns_per_packet != 0) return Status::kOk;

  packets_per_frame_ = columns / metadata.columns_per_packet;
  first_sent_ = metadata.column_window_first / metadata.columns_per_packet;
  last_sent_ = metadata.column_window_last / metadata.columns_per_packet;
  // A window that wraps within one packet leaves no packet out.
  if (metadata.column_window_first > metadata.column_window_last && first_sent_ == last_sent_) {
    first_sent_ = 0;
    last_sent_ = packets_per_frame_ - 1;
  }
  sent_per_frame_ = last_sent_ - first_sent_ + 1;
  if (first_sent_ > last_sent_) sent_per_frame_ += packets_per_frame_;
  return Status::kOk;
}

Status PacketMonitor::Check(std::span<const uint8_t> packet, PacketHeader& header) {
  header = PacketHeader{};
  if (!configured_) return Status::kNotStarted;
  Status status = CheckPacket(layout_, identity_, packet, header);
  if (status == Status::kSensorRestarted && header.init_id == old_init_id_) status = Status::kLate;
  if (!IsUsable(status)) {
    CountRefused(status, header);
    return status;
  }
  if (identity_.init_id == 0) identity_.init_id = header.init_id;
  if (identity_.serial_number == 0) identity_.serial_number = header.serial_number;
  status = CheckOrder(packet);
  ++(status == Status::kDuplicate ? counters_.duplicates : counters_.accepted);
  return status;
}

void PacketMonitor::CountRefused(Status status, const PacketHeader& header) {
  switch (status) {
    case Status::kWrongPacketType:
      ++counters_.wrong_type;
      return;
    case Status::kBadCrc:
      ++counters_.bad_crc;
      return;
    case Status::kWrongSensor:
      ++counters_.wrong_sensor;
      return;
    case Status::kLate:
      ++counters_.before_start;
      return;
    case Status::kSensorRestarted:
      ++counters_.not_resumed;
      if (header.init_id != new_init_id_) ++counters_.restarts;
      new_init_id_ = header.init_id;
      return;
    default:  // kTruncated, kOversized: the layout is a made one
      ++counters_.wrong_size;
  }
}

void PacketMonitor::Resume() {
  if (!restarted()) return;
  old_init_id_ = identity_.init_id;
  identity_.init_id = new_init_id_;
  new_init_id_ = kNone;
  anchored_ = false;
}

// Number of the packet among those sent in a revolution, in the order of their columns; -1 when it
// is none of them.
int32_t PacketMonitor::PlaceInFrame(uint32_t first_measurement_id) const {
  const uint32_t columns = static_cast<uint32_t>(layout_.columns_per_packet);
  if (packets_per_frame_ == 0 || first_measurement_id % columns != 0 ||
      first_measurement_id >= static_cast<uint32_t>(layout_.columns_per_frame)) {
    return -1;
  }
  const int32_t packet = static_cast<int32_t>(first_measurement_id / columns);
  if (first_sent_ <= last_sent_) {
    return packet >= first_sent_ && packet <= last_sent_ ? packet - first_sent_ : -1;
  }
  if (packet <= last_sent_) return packet;
  return packet >= first_sent_ ? packet - first_sent_ + last_sent_ + 1 : -1;
}

void PacketMonitor::Anchor(uint16_t frame_id, int32_t place) {
  anchored_ = true;
  newest_frame_id_ = frame_id;
  newest_place_ = place;
  accepted_ = 1;
  places_ = 1;
}

// kOk or kDuplicate. The sliding window of receipts is that of the anti-replay service of IPsec
// (RFC 4303, 3.4.3).
Status PacketMonitor::CheckOrder(std::span<const uint8_t> packet) {
  ByteReader reader(packet);
  const auto column = static_cast<size_t>(layout_.packet_header_bytes);
  const uint16_t frame_id =
      reader.U16(layout_.profile == Profile::kLegacy ? kLegacyFrameIdOffset : kFrameIdOffset);
  const int32_t place = PlaceInFrame(reader.U16(column + kMeasurementIdOffset));
  if (place < 0) {
    ++counters_.unplaced;
    return Status::kOk;
  }
  if (!anchored_) {
    Anchor(frame_id, place);
    return Status::kOk;
  }
  // Frame ids wrap: the nearer way round is meant.
  const auto frames = static_cast<int16_t>(static_cast<uint16_t>(frame_id - newest_frame_id_));
  const int32_t ahead = frames * sent_per_frame_ + place - newest_place_;
  if (frames > kMaxFrameGap || ahead <= -kHistory) {
    ++counters_.jumps;
    Anchor(frame_id, place);
    return Status::kOk;
  }
  if (ahead > 0) {
    counters_.missing += static_cast<uint64_t>(ahead - 1);
    accepted_ = ahead < kHistory ? (accepted_ << ahead) | 1u : 1u;
    places_ = ahead < kHistory - places_ ? places_ + ahead : kHistory;
    newest_frame_id_ = frame_id;
    newest_place_ = place;
    return Status::kOk;
  }
  const uint64_t bit = uint64_t{1} << -ahead;
  if ((accepted_ & bit) != 0) return Status::kDuplicate;
  accepted_ |= bit;
  ++counters_.out_of_order;
  // What was sent before the first packet that came was not counted as missing.
  if (-ahead < places_) --counters_.missing;
  return Status::kOk;
}

}  // namespace hardpack::ouster
