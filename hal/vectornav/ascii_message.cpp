// SPDX-License-Identifier: Apache-2.0
#include "core/base/loop_bound.h"
#include "hal/vectornav/crc16.h"
#include "hal/vectornav/fields.h"
#include "hal/vectornav/vectornav.h"

// The ASCII half of hal/vectornav/vectornav.h.

namespace hardpack::vectornav {
namespace {

constexpr size_t kMaxDigits = 9;
constexpr uint32_t kNoDigit = 16;
constexpr uint32_t kMaxWeek = 9999;
constexpr int64_t kBillionths = 1'000'000'000;
constexpr size_t kXorDigits = 2;
constexpr size_t kCrcDigits = 4;
constexpr size_t kLineEndBytes = 2;
constexpr size_t kMaxBodyBytes = kMaxAsciiBytes - 2 - kXorDigits - kLineEndBytes;  // and $ and *
constexpr char kHeader[] = {'$', 'V', 'N', 'I', 'N', 'S', ','};

// The value of a hex digit as the sensor writes it, in capitals; kNoDigit of anything else.
constexpr uint32_t HexDigit(uint8_t character) {
  if (character >= '0' && character <= '9') return uint32_t{character} - '0';
  if (character >= 'A' && character <= 'F') return uint32_t{character} - 'A' + 10;
  return kNoDigit;
}

constexpr bool IsDigit(uint8_t character) {
  return HexDigit(character) < 10;
}

// Of up to four digits. Precondition: they are hex digits.
uint32_t HexValue(std::span<const uint8_t> digits) {
  uint32_t value = 0;
  HP_LOOP_BOUND(kCrcDigits)
  for (const uint8_t digit : digits) value = value << 4u | HexDigit(digit);
  return value;
}

// Where the body ends: the place of *. Precondition: a line that AsciiMessageSize measured.
size_t BodyEnd(std::span<const uint8_t> line) {
  const size_t place = line.size() - kLineEndBytes - kXorDigits - 1;
  return line[place] == '*' ? place : place - (kCrcDigits - kXorDigits);
}

bool ChecksumMatches(std::span<const uint8_t> line) {
  const size_t end = BodyEnd(line);
  const std::span<const uint8_t> body = line.subspan(1, end - 1);
  const auto digits = line.subspan(end + 1, line.size() - kLineEndBytes - end - 1);
  if (digits.size() == kCrcDigits) return Crc16(body) == HexValue(digits);
  uint32_t sum = 0;
  HP_LOOP_BOUND(kMaxBodyBytes)
  for (const uint8_t character : body) sum ^= character;
  return sum == HexValue(digits);
}

// A number as it is written, without loss.
struct Decimal {
  bool negative = false;
  uint32_t whole = 0;       // below 10^9
  uint32_t billionths = 0;  // below 10^9
};

constexpr int64_t Billionths(const Decimal& decimal) {
  const int64_t magnitude = int64_t{decimal.whole} * kBillionths + decimal.billionths;
  return decimal.negative ? -magnitude : magnitude;
}

// To two roundings of a float.
constexpr float Value(const Decimal& decimal) {
  const float magnitude =
      static_cast<float>(decimal.whole) + static_cast<float>(decimal.billionths) * 1.0e-9f;
  return decimal.negative ? -magnitude : magnitude;
}

// Takes one field after another from a line's body. A field that is not what is asked for gives
// zero, and so do all behind it; whether one was is asked once, at the end.
class FieldReader {
 public:
  explicit FieldReader(std::span<const uint8_t> fields) : fields_(fields) {}

  // [+-] digits [. digits]
  Decimal Number() {
    Decimal decimal;
    decimal.negative = Peek() == '-';
    if (decimal.negative || Peek() == '+') ++at_;
    size_t digits = 0;
    decimal.whole = Digits(digits);
    if (digits == 0) valid_ = false;
    if (Peek() == '.') {
      ++at_;
      decimal.billionths = Digits(digits);
      if (digits == 0) valid_ = false;
      HP_LOOP_BOUND(kMaxDigits)
      for (; digits < kMaxDigits; ++digits) decimal.billionths *= 10;
    }
    End();
    return valid_ ? decimal : Decimal{};
  }
  float Float() { return Value(Number()); }

  // Digits only.
  uint32_t Whole() {
    size_t digits = 0;
    const uint32_t value = Digits(digits);
    if (digits == 0) valid_ = false;
    End();
    return valid_ ? value : 0;
  }

  // One to four hex digits.
  uint16_t Hex() {
    uint32_t value = 0;
    size_t digits = 0;
    HP_LOOP_BOUND(kCrcDigits)
    for (; digits < kCrcDigits && HexDigit(Peek()) != kNoDigit; ++digits) {
      value = value << 4u | HexDigit(Peek());
      ++at_;
    }
    if (digits == 0) valid_ = false;
    End();
    return static_cast<uint16_t>(valid_ ? value : 0);
  }

  // All fields were valid, and none is left.
  bool Finished() const { return valid_ && ended_; }

 private:
  // 0 behind the end, which is no character of a field.
  uint8_t Peek() const { return at_ < fields_.size() ? fields_[at_] : uint8_t{0}; }

  // The digits that stand next, at most kMaxDigits of them, and how many.
  uint32_t Digits(size_t& count) {
    uint32_t value = 0;
    count = 0;
    HP_LOOP_BOUND(kMaxDigits)
    for (; count < kMaxDigits && IsDigit(Peek()); ++count) {
      value = value * 10 + HexDigit(Peek());
      ++at_;
    }
    return value;
  }

  // A field ends at a comma or with the line; behind its last one the line has no digits left.
  void End() {
    ended_ = at_ >= fields_.size();
    if (!ended_ && Peek() != ',') valid_ = false;
    ++at_;
  }

  std::span<const uint8_t> fields_;
  size_t at_ = 0;
  bool valid_ = true;
  bool ended_ = false;  // the field read last was the last one
};

// The 15 fields, read and not yet judged.
struct InsFields {
  Decimal time_of_week_s;
  uint32_t week = 0;
  uint16_t status = 0;
  float yaw_deg = 0.0f;
  float pitch_deg = 0.0f;
  float roll_deg = 0.0f;
  Decimal latitude_deg;
  Decimal longitude_deg;
  float altitude_m = 0.0f;
  VelocityNed velocity_ned;
  float attitude_uncertainty_deg = 0.0f;
  float position_uncertainty_m = 0.0f;
  float velocity_uncertainty_mps = 0.0f;
};

// One statement a field: their order is that of the line.
bool ReadFields(std::span<const uint8_t> text, InsFields& fields) {
  FieldReader reader(text);
  fields.time_of_week_s = reader.Number();
  fields.week = reader.Whole();
  fields.status = reader.Hex();
  fields.yaw_deg = reader.Float();
  fields.pitch_deg = reader.Float();
  fields.roll_deg = reader.Float();
  fields.latitude_deg = reader.Number();
  fields.longitude_deg = reader.Number();
  fields.altitude_m = reader.Float();
  fields.velocity_ned.north_mps = reader.Float();
  fields.velocity_ned.east_mps = reader.Float();
  fields.velocity_ned.down_mps = reader.Float();
  fields.attitude_uncertainty_deg = reader.Float();
  fields.position_uncertainty_m = reader.Float();
  fields.velocity_uncertainty_mps = reader.Float();
  return reader.Finished();
}

Status JudgeFields(const InsFields& fields, InsSample& sample) {
  const Decimal& time = fields.time_of_week_s;
  if (fields.week > kMaxWeek || Billionths(time) < 0 ||
      time.whole >= static_cast<uint32_t>(kSecondsPerWeek)) {
    return Status::kInvalidArgument;
  }
  SetGpsTime(fields.week * kNanosecondsPerWeek + static_cast<uint64_t>(Billionths(time)), sample);
  SetStatus(fields.status, sample);
  Status set = SetAttitude(fields.yaw_deg, fields.pitch_deg, fields.roll_deg, sample);
  if (!IsUsable(set)) return set;
  set = SetPosition(Billionths(fields.latitude_deg), Billionths(fields.longitude_deg),
                    fields.altitude_m, sample);
  if (!IsUsable(set)) return set;
  set = SetVelocity(fields.velocity_ned, sample);
  if (!IsUsable(set)) return set;
  set = SetAttitudeUncertainty(fields.attitude_uncertainty_deg, sample);
  if (!IsUsable(set)) return set;
  set = SetPositionUncertainty(fields.position_uncertainty_m, sample);
  if (!IsUsable(set)) return set;
  return SetVelocityUncertainty(fields.velocity_uncertainty_mps, sample);
}

bool IsInsLine(std::span<const uint8_t> line) {
  if (line.size() < sizeof(kHeader)) return false;
  HP_LOOP_BOUND(sizeof(kHeader))
  for (size_t i = 0; i < sizeof(kHeader); ++i) {
    if (line[i] != static_cast<uint8_t>(kHeader[i])) return false;
  }
  return true;
}

}  // namespace

Status AsciiMessageSize(std::span<const uint8_t> bytes, size_t& message_bytes) {
  if (bytes.empty()) return Status::kTruncated;
  if (bytes[0] != kAsciiStart) return Status::kWrongPacketType;
  size_t at = 1;
  HP_LOOP_BOUND(kMaxAsciiBytes - 1)
  for (; at < bytes.size() && at < kMaxAsciiBytes && bytes[at] != '*'; ++at) {
    const uint8_t character = bytes[at];
    if (character < ' ' || character > '~' || character == kAsciiStart) {
      return Status::kWrongPacketType;
    }
  }
  // Bytes that end before the line does pass every check of its form below.
  if (at < bytes.size()) ++at;
  size_t digits = 0;
  HP_LOOP_BOUND(kCrcDigits)
  for (; digits < kCrcDigits && at < bytes.size() && HexDigit(bytes[at]) != kNoDigit; ++at) {
    ++digits;
  }
  if (at < bytes.size() && (bytes[at] != '\r' || (digits != kXorDigits && digits != kCrcDigits))) {
    return Status::kWrongPacketType;
  }
  if (at + 1 < bytes.size() && bytes[at + 1] != '\n') return Status::kWrongPacketType;
  if (at + kLineEndBytes > kMaxAsciiBytes) return Status::kWrongPacketType;
  if (at + kLineEndBytes > bytes.size()) return Status::kTruncated;
  message_bytes = at + kLineEndBytes;
  return Status::kOk;
}

Status DecodeAscii(std::span<const uint8_t> message, InsSample& sample) {
  size_t message_bytes = 0;
  const Status sized = AsciiMessageSize(message, message_bytes);
  if (!IsUsable(sized)) return sized;
  if (message.size() > message_bytes) return Status::kOversized;
  if (!ChecksumMatches(message)) return Status::kBadCrc;
  if (!IsInsLine(message)) return Status::kWrongPacketType;

  const size_t body_end = BodyEnd(message);
  InsFields fields;
  InsSample read;
  if (!ReadFields(message.subspan(sizeof(kHeader), body_end - sizeof(kHeader)), fields)) {
    return Status::kInvalidArgument;
  }
  const Status judged = JudgeFields(fields, read);
  if (IsUsable(judged)) sample = read;
  return judged;
}

}  // namespace hardpack::vectornav
