// SPDX-License-Identifier: Apache-2.0
// Any bytes as the stream of a VectorNav sensor, once in pieces and once whole: both must tell the
// same samples and counts, and each sample must keep what InsSample promises and come back from the
// encoder.
//   pieces of the stream: a byte that says how long the piece is and what is to be done with it
//   (kSeal), then its bytes

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/math.h"
#include "hal/vectornav/crc16.h"
#include "hal/vectornav/encode.h"
#include "hal/vectornav/stream_parser.h"
#include "test/fuzz/accepted.h"
#include "test/hal/vectornav/vectornav_messages.h"

using hardpack::Abs;
using hardpack::InsSample;
using hardpack::IsFinite;
using hardpack::Status;
using hardpack::vectornav::StreamParser;

namespace vn = hardpack::vectornav;
namespace messages = hardpack::vectornav::test;

namespace {

// Puts the checksum at the end of what looks like a message, so that there are whole ones.
constexpr uint8_t kSeal = 0x80;

void Require(bool condition) {
  if (!condition) std::abort();
}

void CheckSample(const InsSample& s) {
  Require(IsFinite(s.angular_rate) && IsFinite(s.acceleration) && IsFinite(s.velocity_ned) &&
          IsFinite(s.altitude_m));
  Require(Abs(s.yaw_rad) <= hardpack::kPi && Abs(s.roll_rad) <= hardpack::kPi &&
          Abs(s.pitch_rad) <= hardpack::kHalfPi);
  Require(std::abs(s.latitude_ndeg) <= 90'000'000'000 &&
          std::abs(s.longitude_ndeg) <= 180'000'000'000);
  Require(s.attitude_uncertainty_rad >= 0 && s.position_uncertainty_m >= 0 &&
          s.velocity_uncertainty_mps >= 0);
  Require(!s.has_gps_time || s.gps_time_ns >= 604'800'000'000'000u);
}

// What the message carries beside angles comes back bit by bit, angles to their rounding.
void CheckRoundTrip(InsSample sent) {
  uint8_t message[vn::kMaxBinaryBytes];
  size_t size = 0;
  if (!IsUsable(vn::EncodeBinary(sent, message, size))) return;
  InsSample back;
  Require(vn::DecodeBinary(std::span(message).first(size), back) == Status::kOk);
  Require(Abs(back.pitch_rad - sent.pitch_rad) < 1e-6f);
  back.yaw_rad = sent.yaw_rad;
  back.pitch_rad = sent.pitch_rad;
  back.roll_rad = sent.roll_rad;
  sent.has_attitude_uncertainty = sent.has_position_uncertainty = false;
  sent.has_velocity_uncertainty = false;
  sent.attitude_uncertainty_rad = sent.position_uncertainty_m = 0.0f;
  sent.velocity_uncertainty_mps = 0.0f;
  Require(messages::Bits(back) == messages::Bits(sent));
}

void Seal(std::vector<uint8_t>& piece) {
  size_t size = 0;
  if (IsUsable(vn::BinaryMessageSize(piece, size))) {
    piece.resize(size);
    const uint32_t crc = vn::Crc16(std::span(piece).subspan(1, size - 3));
    piece[size - 2] = static_cast<uint8_t>(crc >> 8);
    piece[size - 1] = static_cast<uint8_t>(crc & 0xff);
  } else if (!piece.empty() && piece[0] == '$') {
    const std::string body(piece.begin() + 1, std::find(piece.begin(), piece.end(), '*'));
    piece = messages::Bytes(messages::Line(body));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto cut = std::make_unique<StreamParser>();
  static const auto whole = std::make_unique<StreamParser>();
  *cut = StreamParser{};
  *whole = StreamParser{};

  std::vector<uint8_t> stream;
  std::vector<InsSample> in_pieces;
  for (std::span<const uint8_t> rest(data, size); rest.size() >= 2;) {
    const size_t length = std::min<size_t>(1 + (rest[0] & 0x7f), rest.size() - 1);
    std::vector<uint8_t> piece(rest.begin() + 1, rest.begin() + 1 + static_cast<ptrdiff_t>(length));
    if ((rest[0] & kSeal) != 0) Seal(piece);
    messages::Give(*cut, piece, in_pieces);
    stream.insert(stream.end(), piece.begin(), piece.end());
    rest = rest.subspan(1 + length);
  }
  std::vector<InsSample> at_once;
  messages::Give(*whole, stream, at_once);

  using messages::BitsOfAll;
  using messages::Text;
  Require(BitsOfAll(in_pieces) == BitsOfAll(at_once));
  Require(Text(cut->counters()) == Text(whole->counters()));
  const auto& c = whole->counters();
  Require(c.bytes == stream.size() && c.samples == at_once.size());
  Require(c.samples + c.unused + c.not_finite + c.out_of_range ==
          c.binary_messages + c.ascii_messages);
  if (c.samples > 0 && c.ascii_messages > 0) hardpack::Accepted("ascii");
  if (c.samples > 0 && c.binary_messages > 0) hardpack::Accepted("binary");
  for (const InsSample& sample : at_once) {
    CheckSample(sample);
    CheckRoundTrip(sample);
    // Any sample can be written as a line, unless a number is too long for it.
    uint8_t line[vn::kMaxAsciiBytes];
    size_t line_bytes = 0;
    InsSample back;
    if (IsUsable(vn::EncodeAscii(sample, line, line_bytes))) {
      Require(vn::DecodeAscii(std::span(line).first(line_bytes), back) == Status::kOk);
    }
  }
  return 0;
}
