// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/ouster.h"

#include <type_traits>

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"
#include "core/base/math.h"
#include "core/base/units.h"
#include "hal/ouster/crc64.h"

namespace hardpack::ouster {
namespace {

static_assert(std::is_trivially_copyable_v<Metadata>);
static_assert(std::is_trivially_copyable_v<PacketLayout>);
static_assert(kMaxPacketBytes <= static_cast<int32_t>(kMaxCrcBytes));

constexpr uint16_t kLidarPacketType = 1;

// Offsets in the packet header of the profiles that have one.
constexpr size_t kPacketTypeOffset = 0;
constexpr size_t kInitIdOffset = 4;
constexpr size_t kSerialNumberOffset = 7;
constexpr size_t kCrcBytes = 8;  // the last of the footer

// Sizes of a profile's parts; no profile has pixels of 0 bytes.
struct ProfileFormat {
  int32_t packet_header_bytes = 0;
  int32_t column_header_bytes = 0;
  int32_t pixel_bytes = 0;
  int32_t column_footer_bytes = 0;
  int32_t packet_footer_bytes = 0;
};

constexpr ProfileFormat FormatOf(Profile profile) {
  switch (profile) {
    case Profile::kLegacy:
      return {0, 16, 12, 4, 0};
    case Profile::kRng19Rfl8Sig16Nir16:
      return {32, 12, 12, 0, 32};
    case Profile::kRng15Rfl8Nir8:
      return {32, 12, 4, 0, 32};
    case Profile::kRng19Rfl8Sig16Nir16Dual:
      return {32, 12, 16, 0, 32};
  }
  return {};
}

// Where the bits of a pixel's first word belong.
struct WordFormat {
  uint32_t range_mask = 0;
  uint32_t flags_shift = 0;
  uint32_t flags_mask = 0;
  uint32_t reflectivity_mask = 0;  // of the u16 at byte 4
};

constexpr WordFormat kLegacyWord{0xfffffu, 28, 0xfu, 0xffffu};
constexpr WordFormat kRng19Word{0x7ffffu, 19, 0x1fu, 0xffu};

// The pixel of one row, of a size known to the compiler, which so sees that no read leaves it.
// `pixels` holds at least row + 1 of them.
template <size_t kBytes>
ByteReader PixelOf(std::span<const uint8_t> pixels, int32_t row) {
  return ByteReader(pixels.subspan(static_cast<size_t>(row) * kBytes).first<kBytes>());
}

// The following fill `column` from `pixels`, which are those of layout.beams rows.

void DecodeSinglePixels(const WordFormat& format, int32_t beams, std::span<const uint8_t> pixels,
                        LidarColumn& column) {
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int32_t row = 0; row < beams; ++row) {
    ByteReader pixel = PixelOf<12>(pixels, row);
    const uint32_t word = pixel.U32(0);
    column.range_mm[row] = word & format.range_mask;
    column.flags[row] = static_cast<uint8_t>((word >> format.flags_shift) & format.flags_mask);
    column.reflectivity[row] = static_cast<uint16_t>(pixel.U16(4) & format.reflectivity_mask);
    column.signal[row] = pixel.U16(6);
    column.near_ir[row] = pixel.U16(8);
  }
}

void DecodeRng15Pixels(int32_t beams, std::span<const uint8_t> pixels, LidarColumn& column) {
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int32_t row = 0; row < beams; ++row) {
    const uint32_t word = PixelOf<4>(pixels, row).U32(0);
    column.range_mm[row] = (word & 0x7fffu) * 8;
    column.flags[row] = static_cast<uint8_t>((word >> 15) & 1u);
    column.reflectivity[row] = static_cast<uint16_t>((word >> 16) & 0xffu);
    column.signal[row] = 0;
    column.near_ir[row] = static_cast<uint16_t>((word >> 24) * 16);
  }
}

// One of the two returns of a DUAL pixel.
template <size_t kReturn>
void DecodeDualReturn(int32_t beams, std::span<const uint8_t> pixels,
                      uint32_t (&range_mm)[kMaxBeams], uint8_t (&flags)[kMaxBeams],
                      uint16_t (&reflectivity)[kMaxBeams], uint16_t (&signal)[kMaxBeams]) {
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int32_t row = 0; row < beams; ++row) {
    ByteReader pixel = PixelOf<16>(pixels, row);
    const uint32_t word = pixel.U32(4 * kReturn);
    range_mm[row] = word & 0x7ffffu;
    flags[row] = static_cast<uint8_t>((word >> 19) & 0x1fu);
    reflectivity[row] = static_cast<uint16_t>(word >> 24);
    signal[row] = pixel.U16(8 + 2 * kReturn);
  }
}

void DecodeDualPixels(int32_t beams, std::span<const uint8_t> pixels, LidarColumn& column) {
  DecodeDualReturn<0>(beams, pixels, column.range_mm, column.flags, column.reflectivity,
                      column.signal);
  DecodeDualReturn<1>(beams, pixels, column.second_range_mm, column.second_flags,
                      column.second_reflectivity, column.second_signal);
  HP_LOOP_BOUND_BEAMS(kMaxBeams)
  for (int32_t row = 0; row < beams; ++row) column.near_ir[row] = PixelOf<16>(pixels, row).U16(12);
}

void DecodePixels(const PacketLayout& layout, std::span<const uint8_t> pixels,
                  LidarColumn& column) {
  switch (layout.profile) {
    case Profile::kLegacy:
      return DecodeSinglePixels(kLegacyWord, layout.beams, pixels, column);
    case Profile::kRng19Rfl8Sig16Nir16:
      return DecodeSinglePixels(kRng19Word, layout.beams, pixels, column);
    case Profile::kRng15Rfl8Nir8:
      return DecodeRng15Pixels(layout.beams, pixels, column);
    case Profile::kRng19Rfl8Sig16Nir16Dual:
      return DecodeDualPixels(layout.beams, pixels, column);
  }
}

// Whether MakeLayout filled it; what the arithmetic below relies on.
bool IsMade(const PacketLayout& layout) {
  const ProfileFormat format = FormatOf(layout.profile);
  return layout.beams >= 1 && layout.beams <= kMaxBeams && layout.columns_per_packet >= 1 &&
         layout.columns_per_packet <= kMaxColumnsPerPacket &&
         layout.packet_header_bytes == format.packet_header_bytes &&
         layout.column_header_bytes == format.column_header_bytes &&
         layout.pixel_bytes == format.pixel_bytes && format.pixel_bytes != 0 &&
         layout.column_footer_bytes == format.column_footer_bytes &&
         layout.column_bytes == format.column_header_bytes + layout.beams * format.pixel_bytes +
                                    format.column_footer_bytes &&
         layout.packet_bytes <= kMaxPacketBytes &&
         layout.packet_bytes == format.packet_header_bytes +
                                    layout.columns_per_packet * layout.column_bytes +
                                    format.packet_footer_bytes;
}

Status CheckIdentity(const SensorIdentity& expected, const PacketHeader& header) {
  if (expected.serial_number != 0 && header.serial_number != expected.serial_number) {
    return Status::kWrongSensor;
  }
  if (expected.init_id != 0 && header.init_id != expected.init_id) return Status::kSensorRestarted;
  return Status::kOk;
}

}  // namespace

Status MakeLayout(const Metadata& metadata, PacketLayout& layout) {
  layout = PacketLayout{};
  if (metadata.beams < 1 || metadata.beams > kMaxBeams || metadata.columns_per_packet < 1 ||
      metadata.columns_per_packet > kMaxColumnsPerPacket || metadata.columns_per_frame < 1) {
    return Status::kInvalidArgument;
  }
  if (metadata.columns_per_frame > kMaxColumnsPerRevolution) return Status::kCapacityExceeded;
  const ProfileFormat format = FormatOf(metadata.profile);
  if (format.pixel_bytes == 0) return Status::kUnsupported;

  PacketLayout made;
  made.profile = metadata.profile;
  made.crc_in_footer = metadata.crc_in_footer && format.packet_footer_bytes != 0;
  made.beams = metadata.beams;
  made.columns_per_packet = metadata.columns_per_packet;
  made.columns_per_frame = metadata.columns_per_frame;
  made.packet_header_bytes = format.packet_header_bytes;
  made.column_header_bytes = format.column_header_bytes;
  made.pixel_bytes = format.pixel_bytes;
  made.column_footer_bytes = format.column_footer_bytes;
  made.packet_footer_bytes = format.packet_footer_bytes;
  made.column_bytes =
      made.column_header_bytes + made.beams * made.pixel_bytes + made.column_footer_bytes;
  made.packet_bytes = made.packet_header_bytes + made.columns_per_packet * made.column_bytes +
                      made.packet_footer_bytes;
  if (made.packet_bytes > kMaxPacketBytes) return Status::kCapacityExceeded;
  layout = made;
  return Status::kOk;
}

Status CheckPacket(const PacketLayout& layout, const SensorIdentity& expected,
                   std::span<const uint8_t> packet, PacketHeader& header) {
  header = PacketHeader{};
  if (!IsMade(layout)) return Status::kInvalidArgument;
  const size_t expected_bytes = static_cast<size_t>(layout.packet_bytes);
  if (packet.size() < expected_bytes) return Status::kTruncated;
  if (packet.size() > expected_bytes) return Status::kOversized;
  if (layout.profile == Profile::kLegacy) return Status::kOk;

  ByteReader reader(packet);
  header.packet_type = reader.U16(kPacketTypeOffset);
  header.frame_id = reader.U16(kFrameIdOffset);
  header.init_id = reader.U24(kInitIdOffset);
  header.serial_number = reader.U40(kSerialNumberOffset);
  if (header.packet_type != kLidarPacketType) return Status::kWrongPacketType;
  if (layout.crc_in_footer) {
    const size_t covered_bytes = expected_bytes - kCrcBytes;
    if (Crc64(packet.first(covered_bytes)) != reader.U64(covered_bytes)) return Status::kBadCrc;
  }
  return CheckIdentity(expected, header);
}

Status CheckPacket(const PacketLayout& layout, const Metadata& metadata,
                   std::span<const uint8_t> packet, PacketHeader& header) {
  return CheckPacket(layout, SensorIdentity{metadata.init_id, metadata.serial_number}, packet,
                     header);
}

Status DecodeColumn(const PacketLayout& layout, std::span<const uint8_t> packet, int index,
                    LidarColumn& column) {
  if (!IsMade(layout) || index < 0 || index >= layout.columns_per_packet) {
    return Status::kInvalidArgument;
  }
  ByteReader whole(packet);
  ByteReader bytes(
      whole.Sub(static_cast<size_t>(layout.packet_header_bytes + index * layout.column_bytes),
                static_cast<size_t>(layout.column_bytes)));
  if (!IsUsable(whole.status())) return Status::kTruncated;

  column.timestamp_ns = bytes.U64(0);
  column.measurement_id = bytes.U16(8);
  column.azimuth_offset_rad = 0.0f;
  column.beams = layout.beams;
  column.returns = layout.profile == Profile::kRng19Rfl8Sig16Nir16Dual ? 2 : 1;
  if (layout.profile == Profile::kLegacy) {
    column.frame_id = bytes.U16(10);
    column.encoder_ticks = bytes.U32(12);
    column.status =
        bytes.U32(static_cast<size_t>(layout.column_bytes - layout.column_footer_bytes));
    column.valid = column.status == 0xffffffffu;
  } else {
    column.frame_id = whole.U16(kFrameIdOffset);
    column.encoder_ticks = 0;
    column.status = bytes.U16(10);
    column.valid = (column.status & 1u) != 0;
  }
  DecodePixels(layout,
               bytes.Sub(static_cast<size_t>(layout.column_header_bytes),
                         static_cast<size_t>(layout.beams * layout.pixel_bytes)),
               column);
  if (!column.valid) return Status::kColumnInvalid;
  return column.measurement_id < layout.columns_per_frame ? Status::kOk : Status::kBadColumn;
}

Status DecodeImu(std::span<const uint8_t> packet, ImuSample& sample) {
  if (packet.size() < static_cast<size_t>(kImuPacketBytes)) return Status::kTruncated;
  if (packet.size() > static_cast<size_t>(kImuPacketBytes)) return Status::kOversized;
  // At 0 stands when the packet was put together: of no use beside the two below.
  ByteReader bytes(packet);
  ImuSample read;
  read.acceleration_time_ns = bytes.U64(8);
  read.angular_rate_time_ns = bytes.U64(16);
  read.acceleration = {bytes.F32(24) * kStandardGravity_mps2, bytes.F32(28) * kStandardGravity_mps2,
                       bytes.F32(32) * kStandardGravity_mps2};
  read.angular_rate = {bytes.F32(36) * kRadPerDeg, bytes.F32(40) * kRadPerDeg,
                       bytes.F32(44) * kRadPerDeg};
  if (!IsFinite(read.acceleration) || !IsFinite(read.angular_rate)) {
    return Status::kNotFinite;
  }
  sample = read;
  return Status::kOk;
}

}  // namespace hardpack::ouster
