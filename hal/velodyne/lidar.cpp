// SPDX-License-Identifier: Apache-2.0
#include "hal/velodyne/lidar.h"

#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/saturate.h"
#include "hal/velodyne/beams.h"

namespace hardpack::velodyne {
namespace {

constexpr int32_t kFiringsPerMinute = 1'085'069;  // 60 s / 55.296 us
// 1.03 times as many.
constexpr int32_t kPlacesPerMinute = 1'117'622;
// Faster than it is set up to by a twenty-fifth.
constexpr int32_t kFastest_percent = 104;
// A firing goes so far ahead of itself to have a place of its own.
constexpr float kMaxLead_columns = 1.5f;
constexpr int32_t kNoPlace = -kMaxColumnsPerRevolution;
// What two stamps that are a whole number of packets apart may be off by: their rounding, and what
// the sensor's clock is set by against the one that it fires by.
constexpr float kStampRounding_us = 10.0f;
constexpr float kStampShare = 2.5e-4f;
// The clock begins in the second hour, so that nothing that comes late is before it.
constexpr uint64_t kFirstHour_ns = uint64_t{kHour_us} * 1000u;

int32_t ColumnsOf(const Config& config) {
  const int32_t columns = (kPlacesPerMinute + config.rpm - 1) / config.rpm;
  return columns < kMaxColumnsPerRevolution ? columns : kMaxColumnsPerRevolution;
}

// Those of a revolution that are whole.
int32_t FiringsOf(const Config& config) {
  return kFiringsPerMinute / config.rpm;
}

size_t RateOf(const Config& config) {
  return static_cast<size_t>((config.rpm - kLeastRpm) / kRpmStep);
}

// From one stamp on to another, the nearer way round the hour.
int32_t AheadOf_us(uint32_t from_us, uint32_t to_us) {
  const uint32_t ahead_us = to_us >= from_us ? to_us - from_us : to_us + (kHour_us - from_us);
  if (ahead_us < kHour_us / 2) return static_cast<int32_t>(ahead_us);
  return -static_cast<int32_t>(kHour_us - ahead_us);
}

}  // namespace

LidarLayout Lidar::LayoutOf(const Config& config) {
  if (!IsUsable(CheckConfig(config))) return {};
  const bool is_vlp16 = config.model == Model::kVlp16;
  const size_t rate = RateOf(config);
  const int32_t columns = ColumnsOf(config);
  LidarLayout layout;
  if (is_vlp16) {
    layout.altitude_deg = kVlp16Altitude_deg;
    layout.azimuth_deg = kVlp16Azimuths_deg[rate];
    layout.origin_to_beam_m = kVlp16Origin_m;
  } else {
    layout.altitude_deg = kVlp32cAltitude_deg;
    layout.azimuth_deg = kVlp32cAzimuths_deg[rate];
  }
  layout.columns_per_revolution = columns;
  layout.fired_per_revolution = FiringsOf(config);
  layout.window = {
      .columns_per_datagram = FormatOf(config).firings, .first = 0, .last = columns - 1};
  return layout;
}

int32_t Lidar::MostColumnsPerSecond(const Config& config) {
  if (!IsUsable(CheckConfig(config))) return 0;
  return ColumnsOf(config) * (config.rpm / kRpmStep) * kFastest_percent / 100 + 1;
}

Status Lidar::Configure(const Config& config) {
  *this = Lidar{};
  const Status status = CheckConfig(config);
  if (!IsUsable(status)) return status;
  config_ = config;
  format_ = FormatOf(config);
  columns_ = ColumnsOf(config);
  packet_us_ = static_cast<float>(format_.firings * kFiring_ns) * 1.0e-3f;
  cdeg_per_us_ = TurnOfFiring_cdeg(config) / (static_cast<float>(kFiring_ns) * 1.0e-3f);
  configured_ = true;
  return Status::kOk;
}

Status Lidar::Check(std::span<const uint8_t> packet) {
  if (!configured_) return Status::kNotStarted;
  PacketHeader header;
  Status status = ReadHeader(config_, packet, header);
  if (IsUsable(status)) status = Follow(header);
  Count(status);
  return status;
}

void Lidar::Resume() {
  if (!restarted_) return;
  restarted_ = false;
  anchored_ = false;
}

Status Lidar::NoteRestart() {
  if (!restarted_) ++counters_.restarts;
  restarted_ = true;
  return Status::kSensorRestarted;
}

// Revolutions are counted on, so that no column has the name of one from before.
void Lidar::Anchor(const PacketHeader& header) {
  anchored_ = true;
  newest_.time_us = header.time_us;
  newest_.time_ns = kFirstHour_ns + uint64_t{header.time_us} * 1000u;
  newest_.azimuth_cdeg = header.azimuth_cdeg[0];
  newest_.frame_id = static_cast<uint16_t>(newest_.frame_id + 2u);
  accepted_ = 1;
  packets_ = 1;
}

bool Lidar::IsOnGrid(int32_t ahead_us, int32_t packets) const {
  const float ahead = static_cast<float>(ahead_us);
  const float off_us = Abs(ahead - static_cast<float>(packets) * packet_us_);
  return off_us <= kStampRounding_us + kStampShare * Abs(ahead);
}

// The revolutions in between by how far the head has turned since, as near as the azimuth says.
Lidar::Stamp Lidar::StampOf(const PacketHeader& header, int32_t ahead_us) const {
  Stamp stamp;
  stamp.time_us = header.time_us;
  stamp.time_ns = newest_.time_ns + static_cast<uint64_t>(int64_t{ahead_us} * 1000);
  stamp.azimuth_cdeg = header.azimuth_cdeg[0];
  const float turned_cdeg = cdeg_per_us_ * static_cast<float>(ahead_us);
  const auto seen_cdeg = static_cast<float>(stamp.azimuth_cdeg - newest_.azimuth_cdeg);
  const int32_t turns = RoundToInt((turned_cdeg - seen_cdeg) / static_cast<float>(kTurn_cdeg));
  stamp.frame_id = static_cast<uint16_t>(newest_.frame_id + static_cast<uint32_t>(turns));
  return stamp;
}

// kOk, kDuplicate or kSensorRestarted. The sliding window of receipts is that of the anti-replay
// service of IPsec (RFC 4303, 3.4.3).
Status Lidar::Follow(const PacketHeader& header) {
  if (!anchored_) {
    Anchor(header);
    packet_ns_ = newest_.time_ns;
    Lay(header, newest_.frame_id, false);
    last_ = places_[format_.firings - 1];
    return Status::kOk;
  }
  const int32_t ahead_us = AheadOf_us(newest_.time_us, header.time_us);
  if (ahead_us > kMostAhead_us || ahead_us < -kMostAhead_us) return NoteRestart();
  const int32_t packets = RoundToInt(static_cast<float>(ahead_us) / packet_us_);
  const bool is_on_grid = IsOnGrid(ahead_us, packets);
  const Stamp stamp = StampOf(header, ahead_us);
  if (ahead_us <= 0) {
    if (!is_on_grid || packets <= -kHistory) return NoteRestart();
    const uint64_t bit = uint64_t{1} << static_cast<uint32_t>(-packets);
    if ((accepted_ & bit) != 0) return Status::kDuplicate;
    accepted_ |= bit;
    ++counters_.out_of_order;
    // What was sent before the first packet that came was not counted as missing.
    if (-packets < packets_) --counters_.missing;
    packet_ns_ = stamp.time_ns;
    Lay(header, stamp.frame_id, false);
    return Status::kOk;
  }
  const int32_t moved = packets < 1 ? 1 : packets;
  if (is_on_grid) {
    counters_.missing += static_cast<uint64_t>(moved - 1);
  } else {
    ++counters_.jumps;
  }
  accepted_ = moved < kHistory ? (accepted_ << static_cast<uint32_t>(moved)) | 1u : 1u;
  packets_ = moved < kHistory - packets_ ? packets_ + moved : kHistory;
  newest_ = stamp;
  packet_ns_ = stamp.time_ns;
  Lay(header, stamp.frame_id, moved == 1);
  last_ = places_[format_.firings - 1];
  return Status::kOk;
}

// In the middle of its slots, from the first block's revolution on.
float Lidar::AzimuthOf_cdeg(const PacketHeader& header, int32_t firing) const {
  constexpr float kMiddle = static_cast<float>(kMiddle_ns) / static_cast<float>(kFiring_ns);
  const int32_t blocks = kBlocks / format_.blocks_per_firing;
  const int32_t block = firing / format_.firings_per_block;
  const int32_t from = block + 1 < blocks ? block : block - 1;
  const int32_t step_cdeg =
      TurnedBetween_cdeg(header.azimuth_cdeg[from], header.azimuth_cdeg[from + 1]);
  const int32_t begun_cdeg = TurnedBetween_cdeg(header.azimuth_cdeg[0], header.azimuth_cdeg[block]);
  const auto within = static_cast<float>(firing % format_.firings_per_block) + kMiddle;
  return static_cast<float>(header.azimuth_cdeg[0] + begun_cdeg) +
         static_cast<float>(step_cdeg) * within / static_cast<float>(format_.firings_per_block);
}

// Gives each firing its place. follows: the packet is the one behind that of last_.
void Lidar::Lay(const PacketHeader& header, uint16_t frame_id, bool follows) {
  const float columns_per_cdeg = static_cast<float>(columns_) / static_cast<float>(kTurn_cdeg);
  const float rad_per_column = kTwoPi / static_cast<float>(columns_);
  const auto behind = static_cast<int16_t>(static_cast<uint16_t>(last_.frame_id - frame_id));
  const bool is_near = follows && behind >= -1 && behind <= 1;
  int32_t before = is_near ? behind * columns_ + last_.measurement_id : kNoPlace;
  HP_LOOP_BOUND(kMaxFirings)
  for (int32_t firing = 0; firing < format_.firings; ++firing) {
    const float position = AzimuthOf_cdeg(header, firing) * columns_per_cdeg;
    const int32_t nearest = RoundToInt(position);
    const bool is_taken =
        nearest <= before && static_cast<float>(before + 1) - position <= kMaxLead_columns;
    const int32_t place = is_taken ? before + 1 : nearest;
    before = place;
    const bool is_next = place >= columns_;
    places_[firing] = {.frame_id = static_cast<uint16_t>(frame_id + (is_next ? 1u : 0u)),
                       .measurement_id = static_cast<uint16_t>(is_next ? place - columns_ : place),
                       .offset_rad = (static_cast<float>(place) - position) * rad_per_column};
  }
}

void Lidar::Count(Status status) {
  switch (status) {
    case Status::kOk:
      ++counters_.accepted;
      restarted_ = false;
      has_packet_ = true;
      return;
    case Status::kWrongPacketType:
      ++counters_.wrong_type;
      return;
    case Status::kWrongSensor:
      ++counters_.wrong_sensor;
      return;
    case Status::kUnsupported:
      ++counters_.wrong_mode;
      return;
    case Status::kBadColumn:
      ++counters_.bad_azimuth;
      return;
    case Status::kInvalidArgument:
      ++counters_.bad_time;
      return;
    case Status::kDeviceFault:
      ++counters_.wrong_rate;
      return;
    case Status::kSensorRestarted:
      ++counters_.not_resumed;
      return;
    case Status::kDuplicate:
      ++counters_.duplicates;
      return;
    default:  // kTruncated, kOversized
      ++counters_.wrong_size;
  }
}

Status Lidar::Decode(std::span<const uint8_t> packet, int index, LidarColumn& column) const {
  if (!has_packet_) return Status::kNotStarted;
  if (index < 0 || index >= format_.firings) return Status::kInvalidArgument;
  if (packet.size() != static_cast<size_t>(kPacket_bytes)) return Status::kTruncated;
  const Place& place = places_[index];
  column.timestamp_ns = packet_ns_ + static_cast<uint64_t>(index * kFiring_ns + kMiddle_ns);
  column.frame_id = place.frame_id;
  column.measurement_id = place.measurement_id;
  column.azimuth_offset_rad = place.offset_rad;
  column.encoder_ticks = 0;
  column.status = static_cast<uint32_t>(config_.return_mode);
  column.valid = true;
  DecodeReturns(format_, packet.first<kPacket_bytes>(), index, column);
  return Status::kOk;
}

}  // namespace hardpack::velodyne
