// SPDX-License-Identifier: Apache-2.0
#include "hal/ouster/ouster.h"

#include <type_traits>

#include "core/base/byte_reader.h"
#include "core/base/loop_bound.h"

namespace hardpack::ouster {
namespace {

static_assert(std::is_trivially_copyable_v<Metadata>);
static_assert(std::is_trivially_copyable_v<PacketLayout>);

constexpr int32_t kMaxColumnsPerPacket = 64;
constexpr size_t kPixelBytes = 12;  // of both profiles
constexpr uint16_t kLidarPacketType = 1;

// Offsets in the packet header of the profiles that have one.
constexpr size_t kPacketTypeOffset = 0;
constexpr size_t kFrameIdOffset = 2;
constexpr size_t kInitIdOffset = 4;
constexpr size_t kSerialNumberOffset = 7;

// What the two profiles place differently in a pixel: range below, flags above some bit, and how
// wide reflectivity is.
struct PixelFormat {
  uint32_t range_mask = 0;
  uint32_t flags_shift = 0;
  uint32_t flags_mask = 0;
  uint32_t reflectivity_mask = 0;
};

constexpr PixelFormat kLegacyPixel{0xfffffu, 28, 0xfu, 0xffffu};
constexpr PixelFormat kRng19Pixel{0x7ffffu, 19, 0x1fu, 0xffu};

// `column` receives what the rows of `bytes` (the whole column) say.
void DecodePixels(const PixelFormat& format, const PacketLayout& layout, ByteReader& bytes,
                  LidarColumn& column) {
  size_t pixel = static_cast<size_t>(layout.column_header_bytes);
  HP_LOOP_BOUND(kMaxBeams)
  for (int32_t row = 0; row < layout.beams; ++row) {
    const uint32_t word = bytes.U32(pixel);
    column.range_mm[row] = word & format.range_mask;
    column.flags[row] = static_cast<uint8_t>((word >> format.flags_shift) & format.flags_mask);
    column.reflectivity[row] =
        static_cast<uint16_t>(bytes.U16(pixel + 4) & format.reflectivity_mask);
    column.signal[row] = bytes.U16(pixel + 6);
    column.near_ir[row] = bytes.U16(pixel + 8);
    pixel += kPixelBytes;
  }
}

// Whether MakeLayout filled it; what the arithmetic below relies on.
bool IsMade(const PacketLayout& layout) {
  return layout.beams >= 1 && layout.beams <= kMaxBeams && layout.columns_per_packet >= 1 &&
         layout.columns_per_packet <= kMaxColumnsPerPacket &&
         layout.pixel_bytes == static_cast<int32_t>(kPixelBytes) &&
         layout.column_bytes == layout.column_header_bytes + layout.beams * layout.pixel_bytes +
                                    layout.column_footer_bytes;
}

}  // namespace

Status MakeLayout(const Metadata& metadata, PacketLayout& layout) {
  layout = PacketLayout{};
  if (metadata.beams < 1 || metadata.beams > kMaxBeams || metadata.columns_per_packet < 1 ||
      metadata.columns_per_packet > kMaxColumnsPerPacket || metadata.columns_per_frame < 1) {
    return Status::kInvalidArgument;
  }
  if (metadata.columns_per_frame > kMaxColumnsPerRevolution) return Status::kCapacityExceeded;

  PacketLayout made;
  int32_t packet_footer_bytes = 0;
  switch (metadata.profile) {
    case Profile::kLegacy:
      made.column_header_bytes = 16;
      made.column_footer_bytes = 4;
      break;
    case Profile::kRng19Rfl8Sig16Nir16:
      made.packet_header_bytes = 32;
      made.column_header_bytes = 12;
      packet_footer_bytes = 32;
      break;
    default:
      return Status::kUnsupported;
  }
  made.profile = metadata.profile;
  made.beams = metadata.beams;
  made.columns_per_packet = metadata.columns_per_packet;
  made.columns_per_frame = metadata.columns_per_frame;
  made.pixel_bytes = static_cast<int32_t>(kPixelBytes);
  made.column_bytes =
      made.column_header_bytes + made.beams * made.pixel_bytes + made.column_footer_bytes;
  made.packet_bytes =
      made.packet_header_bytes + made.columns_per_packet * made.column_bytes + packet_footer_bytes;
  layout = made;
  return Status::kOk;
}

Status CheckPacket(const PacketLayout& layout, const Metadata& metadata,
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
  if (metadata.init_id != 0 && header.init_id != metadata.init_id) return Status::kWrongSensor;
  if (metadata.serial_number != 0 && header.serial_number != metadata.serial_number) {
    return Status::kWrongSensor;
  }
  return Status::kOk;
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
  column.beams = layout.beams;
  if (layout.profile == Profile::kLegacy) {
    column.frame_id = bytes.U16(10);
    column.encoder_ticks = bytes.U32(12);
    column.status =
        bytes.U32(static_cast<size_t>(layout.column_bytes - layout.column_footer_bytes));
    column.valid = column.status == 0xffffffffu;
    DecodePixels(kLegacyPixel, layout, bytes, column);
  } else {
    column.frame_id = whole.U16(kFrameIdOffset);
    column.encoder_ticks = 0;
    column.status = bytes.U16(10);
    column.valid = (column.status & 1u) != 0;
    DecodePixels(kRng19Pixel, layout, bytes, column);
  }
  if (!column.valid) return Status::kColumnInvalid;
  return column.measurement_id < layout.columns_per_frame ? Status::kOk : Status::kBadColumn;
}

}  // namespace hardpack::ouster
