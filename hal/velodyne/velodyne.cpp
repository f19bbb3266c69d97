// SPDX-License-Identifier: Apache-2.0
#include "hal/velodyne/velodyne.h"

#include <type_traits>

#include "core/base/assert.h"
#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"

namespace hardpack::velodyne {
namespace {

static_assert(std::is_trivially_copyable_v<Config>);

constexpr size_t kBlock_bytes = 100;
constexpr size_t kAzimuthAt = 2;  // in a block
constexpr size_t kReturnsAt = 4;
constexpr size_t kReturn_bytes = 3;
constexpr size_t kTimeAt = 1200;
constexpr size_t kModeAt = 1204;
constexpr size_t kProductAt = 1205;
static_assert(kBlocks * kBlock_bytes == kTimeAt);
static_assert(kProductAt + 1 == kPacket_bytes);

constexpr uint16_t kFlag = 0xeeffu;  // FF EE
constexpr uint8_t kVlp16Product = 0x22;
constexpr uint8_t kVlp32cProduct = 0x28;

// How far off the head may turn: over a packet and in a step, each beside the azimuths' rounding.
constexpr float kPacketShare = 0.04f;
constexpr float kPacketRounding_cdeg = 3.0f;
constexpr float kStepShare = 0.5f;
constexpr float kStepRounding_cdeg = 2.0f;

Status ReadAzimuths(const Format& format, ByteReader& reader, PacketHeader& header) {
  HP_LOOP_BOUND(kBlocks)
  for (int32_t block = 0; block < kBlocks; ++block) {
    const uint16_t azimuth_cdeg =
        reader.U16(static_cast<size_t>(block) * kBlock_bytes + kAzimuthAt);
    if (azimuth_cdeg >= kTurn_cdeg) return Status::kBadColumn;
    const int32_t place = block / format.blocks_per_firing;
    const bool is_first = block % format.blocks_per_firing == 0;
    if (!is_first && header.azimuth_cdeg[place] != azimuth_cdeg) return Status::kBadColumn;
    header.azimuth_cdeg[place] = azimuth_cdeg;
  }
  return Status::kOk;
}

bool TurnsAsConfigured(const Config& config, const Format& format, const PacketHeader& header) {
  const int32_t steps = kBlocks / format.blocks_per_firing - 1;
  const float step_cdeg = TurnOfFiring_cdeg(config) * static_cast<float>(format.firings_per_block);
  bool turns = true;
  int32_t whole_cdeg = 0;
  HP_LOOP_BOUND(kBlocks - 1)
  for (int32_t step = 0; step < steps; ++step) {
    const int32_t turned_cdeg =
        TurnedBetween_cdeg(header.azimuth_cdeg[step], header.azimuth_cdeg[step + 1]);
    whole_cdeg += turned_cdeg;
    turns = turns && Abs(static_cast<float>(turned_cdeg) - step_cdeg) <=
                         kStepShare * step_cdeg + kStepRounding_cdeg;
  }
  const float expected_cdeg = step_cdeg * static_cast<float>(steps);
  return turns && Abs(static_cast<float>(whole_cdeg) - expected_cdeg) <=
                      kPacketShare * expected_cdeg + kPacketRounding_cdeg;
}

// The returns of one block's firing.
void DecodeBlock(const Format& format, std::span<const uint8_t> returns,
                 uint32_t (&range_mm)[kMaxBeams], uint16_t (&reflectivity)[kMaxBeams]) {
  ByteReader reader(returns);
  const auto unit_mm = static_cast<uint32_t>(format.unit_mm);
  HP_LOOP_BOUND(kMostBeams)
  for (int32_t row = 0; row < format.beams; ++row) {
    const size_t at = static_cast<size_t>(row) * kReturn_bytes;
    range_mm[row] = reader.U16(at) * unit_mm;
    reflectivity[row] = reader.U8(at + 2);
  }
}

}  // namespace

Status CheckConfig(const Config& config) {
  const bool is_model = config.model == Model::kVlp16 || config.model == Model::kVlp32c;
  const bool is_mode = config.return_mode == ReturnMode::kStrongest ||
                       config.return_mode == ReturnMode::kLast ||
                       config.return_mode == ReturnMode::kDual;
  if (!is_model || !is_mode) return Status::kUnsupported;
  const bool is_rate =
      config.rpm >= kLeastRpm && config.rpm <= kMostRpm && config.rpm % kRpmStep == 0;
  return is_rate ? Status::kOk : Status::kInvalidArgument;
}

Format FormatOf(const Config& config) {
  Format format;
  const bool is_vlp16 = config.model == Model::kVlp16;
  format.beams = is_vlp16 ? 16 : 32;
  format.firings_per_block = is_vlp16 ? 2 : 1;
  format.blocks_per_firing = config.return_mode == ReturnMode::kDual ? 2 : 1;
  format.firings = kBlocks / format.blocks_per_firing * format.firings_per_block;
  format.unit_mm = is_vlp16 ? 2 : 4;
  format.product = is_vlp16 ? kVlp16Product : kVlp32cProduct;
  return format;
}

float TurnOfFiring_cdeg(const Config& config) {
  constexpr float kOfOneRpm_cdeg = static_cast<float>(kTurn_cdeg) / 60.0f * 1.0e-9f * kFiring_ns;
  return static_cast<float>(config.rpm) * kOfOneRpm_cdeg;
}

Status ReadHeader(const Config& config, std::span<const uint8_t> packet, PacketHeader& header) {
  if (packet.size() < static_cast<size_t>(kPacket_bytes)) return Status::kTruncated;
  if (packet.size() > static_cast<size_t>(kPacket_bytes)) return Status::kOversized;
  const Format format = FormatOf(config);
  ByteReader reader(packet);
  bool flags = true;
  HP_LOOP_BOUND(kBlocks)
  for (size_t block = 0; block < kBlocks; ++block) {
    flags = flags && reader.U16(block * kBlock_bytes) == kFlag;
  }
  if (!flags) return Status::kWrongPacketType;
  if (reader.U8(kProductAt) != format.product) return Status::kWrongSensor;
  if (reader.U8(kModeAt) != static_cast<uint8_t>(config.return_mode)) return Status::kUnsupported;
  const Status status = ReadAzimuths(format, reader, header);
  if (!IsUsable(status)) return status;
  header.time_us = reader.U32(kTimeAt);
  if (header.time_us >= kHour_us) return Status::kInvalidArgument;
  return TurnsAsConfigured(config, format, header) ? Status::kOk : Status::kDeviceFault;
}

void DecodeReturns(const Format& format, std::span<const uint8_t, kPacket_bytes> packet, int firing,
                   LidarColumn& column) {
  HP_ASSERT(firing >= 0 && firing < format.firings);
  const int32_t block = firing / format.firings_per_block * format.blocks_per_firing;
  const auto size = static_cast<size_t>(format.beams) * kReturn_bytes;
  const size_t at = static_cast<size_t>(block) * kBlock_bytes + kReturnsAt +
                    static_cast<size_t>(firing % format.firings_per_block) * size;
  const bool is_dual = format.blocks_per_firing == 2;
  column.beams = format.beams;
  column.returns = is_dual ? 2 : 1;
  const size_t first_at = is_dual ? at + kBlock_bytes : at;
  DecodeBlock(format, packet.subspan(first_at, size), column.range_mm, column.reflectivity);
  if (is_dual) {
    DecodeBlock(format, packet.subspan(at, size), column.second_range_mm,
                column.second_reflectivity);
  }
  HP_LOOP_BOUND(kMostBeams)
  for (int32_t row = 0; row < format.beams; ++row) {
    column.signal[row] = 0;
    column.near_ir[row] = 0;
    column.flags[row] = 0;
    if (!is_dual) continue;
    column.second_signal[row] = 0;
    column.second_flags[row] = 0;
    const bool is_same = column.second_range_mm[row] == column.range_mm[row] &&
                         column.second_reflectivity[row] == column.reflectivity[row];
    if (!is_same) continue;
    column.second_range_mm[row] = 0;
    column.second_reflectivity[row] = 0;
  }
}

}  // namespace hardpack::velodyne
