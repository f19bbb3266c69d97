// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "hal/vectornav/vectornav.h"
#include "test/hal/vectornav/vectornav_messages.h"

namespace hardpack::vectornav {
namespace {

using test::Bits;
using test::Bytes;
using test::Line;

constexpr char kBody[] =
    "VNINS,333811.902862,1694,0306,+009.500,-004.750,-000.250,+32.95602815,-096.71424297,"
    "+00171.195,-000.840,-000.396,-000.109,07.8,01.6,0.23";

Status Decode(const std::string& line, InsSample& sample) {
  return DecodeAscii(Bytes(line), sample);
}

// The line with one of its fields, 0 the time of week, written otherwise.
std::string With(size_t field, const std::string& text) {
  std::string body = "VNINS";
  std::string rest = kBody;
  rest = rest.substr(body.size());
  for (size_t i = 0; !rest.empty(); ++i) {
    const size_t end = rest.find(',', 1);
    body += i == field ? "," + text : rest.substr(0, end);
    rest = end == std::string::npos ? "" : rest.substr(end);
  }
  return Line(body);
}

Status StatusWith(size_t field, const std::string& text) {
  InsSample sample;
  const Status status = Decode(With(field, text), sample);
  EXPECT_EQ(sample.has_attitude, status == Status::kOk) << text;
  return status;
}

TEST(VectorNavAscii, InsLineFieldByField) {
  InsSample sample;
  ASSERT_EQ(Decode(Line(kBody), sample), Status::kOk);
  EXPECT_FALSE(sample.has_timestamp || sample.has_angular_rate || sample.has_acceleration);
  EXPECT_TRUE(sample.has_gps_time);
  EXPECT_EQ(sample.gps_time_ns, 1694u * 604'800'000'000'000u + 333'811'902'862'000u);
  EXPECT_TRUE(sample.has_status);
  EXPECT_EQ(sample.status.word, 0x0306);
  EXPECT_EQ(sample.status.mode, InsMode::kTracking);
  EXPECT_TRUE(sample.has_attitude);
  EXPECT_NEAR(sample.yaw_rad, 0.165806279f, 1e-7f);
  EXPECT_NEAR(sample.pitch_rad, -0.0829031395f, 1e-7f);
  EXPECT_NEAR(sample.roll_rad, -0.00436332313f, 1e-8f);
  EXPECT_TRUE(sample.has_position);
  EXPECT_EQ(sample.latitude_ndeg, 32'956'028'150);
  EXPECT_EQ(sample.longitude_ndeg, -96'714'242'970);
  EXPECT_FLOAT_EQ(sample.altitude_m, 171.195f);
  EXPECT_TRUE(sample.has_velocity);
  EXPECT_FLOAT_EQ(sample.velocity_ned.north_mps, -0.84f);
  EXPECT_FLOAT_EQ(sample.velocity_ned.east_mps, -0.396f);
  EXPECT_FLOAT_EQ(sample.velocity_ned.down_mps, -0.109f);
  EXPECT_TRUE(sample.has_attitude_uncertainty && sample.has_position_uncertainty &&
              sample.has_velocity_uncertainty);
  EXPECT_NEAR(sample.attitude_uncertainty_rad, 0.136135682f, 1e-7f);
  EXPECT_FLOAT_EQ(sample.position_uncertainty_m, 1.6f);
  EXPECT_FLOAT_EQ(sample.velocity_uncertainty_mps, 0.23f);
}

// The sensor can be set to four digits of CRC instead of two of exclusive or.
TEST(VectorNavAscii, TakesACrcAsTheChecksum) {
  char end[8];
  std::snprintf(end, sizeof(end), "*%04X\r\n", test::SlowCrc16(Bytes(kBody)));
  const std::string line = std::string("$") + kBody + end;
  InsSample with_crc;
  InsSample with_xor;
  ASSERT_EQ(Decode(line, with_crc), Status::kOk);
  ASSERT_EQ(Decode(Line(kBody), with_xor), Status::kOk);
  EXPECT_EQ(Bits(with_crc), Bits(with_xor));
  std::string wrong = line;
  wrong[wrong.size() - 3] = wrong[wrong.size() - 3] == '0' ? '1' : '0';
  EXPECT_EQ(Decode(wrong, with_crc), Status::kBadCrc);
}

TEST(VectorNavAscii, WeekZeroIsNoGpsTime) {
  InsSample sample;
  ASSERT_EQ(Decode(With(1, "0000"), sample), Status::kOk);
  EXPECT_FALSE(sample.has_gps_time);
  EXPECT_TRUE(sample.has_attitude);
}

TEST(VectorNavAscii, NumbersAreTakenAsTheyAreWritten) {
  InsSample sample;
  for (const char* text : {"32.95602815", "+32.956028150", "032.95602815", "+000032.95602815"}) {
    ASSERT_EQ(Decode(With(6, text), sample), Status::kOk) << text;
    EXPECT_EQ(sample.latitude_ndeg, 32'956'028'150) << text;
  }
  ASSERT_EQ(Decode(With(6, "-0.000000001"), sample), Status::kOk);
  EXPECT_EQ(sample.latitude_ndeg, -1);
  ASSERT_EQ(Decode(With(8, "7"), sample), Status::kOk);
  EXPECT_EQ(sample.altitude_m, 7.0f);
  ASSERT_EQ(Decode(With(8, "-999999999.999999999"), sample), Status::kOk);
  EXPECT_EQ(sample.altitude_m, -1e9f);
}

TEST(VectorNavAscii, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "+", "-", ".", "1.", ".5", "+-1", "1+", "1e3", "0x10", "nan", "inf",
                           "1 ", " 1", "1.2.3", "1234567890", "1.1234567890", "1;2", "--1"}) {
    EXPECT_EQ(StatusWith(8, text), Status::kInvalidArgument) << text;
  }
  for (const char* text : {"", "-1", "+1", "1.0", "16X4"}) {
    EXPECT_EQ(StatusWith(1, text), Status::kInvalidArgument) << text;
  }
  for (const char* text : {"", "00306", "03G6", "-306", "ab"}) {
    EXPECT_EQ(StatusWith(2, text), Status::kInvalidArgument) << text;
  }
}

TEST(VectorNavAscii, RefusesWhatCannotBe) {
  EXPECT_EQ(StatusWith(0, "604799.999999"), Status::kOk);
  EXPECT_EQ(StatusWith(0, "604800.000000"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(0, "-000000.000001"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(1, "9999"), Status::kOk);
  EXPECT_EQ(StatusWith(1, "10000"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(3, "+361.000"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(4, "-090.001"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(5, "+999999999"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(6, "+90.00000000"), Status::kOk);
  EXPECT_EQ(StatusWith(6, "+90.000000001"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(7, "-180.00000001"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(12, "-1.0"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(13, "-0.1"), Status::kInvalidArgument);
  EXPECT_EQ(StatusWith(14, "-9"), Status::kInvalidArgument);
}

TEST(VectorNavAscii, RefusesTooFewAndTooManyFields) {
  const std::string body = kBody;
  InsSample sample;
  EXPECT_EQ(Decode(Line(body.substr(0, body.rfind(','))), sample), Status::kInvalidArgument);
  EXPECT_EQ(Decode(Line(body + ",1"), sample), Status::kInvalidArgument);
  EXPECT_EQ(Decode(Line(body + ","), sample), Status::kInvalidArgument);
  EXPECT_EQ(Decode(Line("VNINS,"), sample), Status::kInvalidArgument);
  EXPECT_EQ(Bits(sample), Bits(InsSample{}));
}

TEST(VectorNavAscii, OtherLinesAreOfAnotherType) {
  InsSample sample;
  EXPECT_EQ(Decode(Line("VNYPR,+010.000,+001.000,-002.000"), sample), Status::kWrongPacketType);
  EXPECT_EQ(Decode(Line("VNINE,1,2"), sample), Status::kWrongPacketType);
  EXPECT_EQ(Decode(Line("VNINS"), sample), Status::kWrongPacketType);
  EXPECT_EQ(Decode(Line(""), sample), Status::kWrongPacketType);
  EXPECT_EQ(Decode(Line("VNERR,03"), sample), Status::kWrongPacketType);
}

TEST(VectorNavAscii, SizesAreExact) {
  const std::vector<uint8_t> line = Bytes(Line(kBody));
  InsSample sample;
  for (size_t size = 0; size < line.size(); ++size) {
    EXPECT_EQ(DecodeAscii(std::span(line).first(size), sample), Status::kTruncated) << size;
  }
  EXPECT_EQ(Decode(Line(kBody) + "x", sample), Status::kOversized);
}

TEST(VectorNavAscii, LinesHaveAForm) {
  const auto sized = [](const std::string& line) {
    size_t size = 0;
    const Status status = AsciiMessageSize(Bytes(line), size);
    EXPECT_EQ(size, status == Status::kOk ? line.size() : 0);
    return status;
  };
  EXPECT_EQ(sized("$A*41\r\n"), Status::kOk);
  EXPECT_EQ(sized("$A*0041\r\n"), Status::kOk);
  EXPECT_EQ(sized("A*41\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A$*41\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A\xfa*41\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A*4\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A*041\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A*00041\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A*4a\r\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A*41\n"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$A*41\r\r"), Status::kWrongPacketType);
  EXPECT_EQ(sized("$" + std::string(kMaxAsciiBytes - 6, 'A') + "*41\r\n"), Status::kOk);
  EXPECT_EQ(sized("$" + std::string(kMaxAsciiBytes - 5, 'A') + "*41\r\n"),
            Status::kWrongPacketType);
}

// A line that is cut is called wrong only when no end could make it right: else the cut would
// decide what is found.
TEST(VectorNavAscii, ACutLineIsWaitedForExactlyWhileItCanBecomeWhole) {
  for (const std::string& body : {std::string(kMaxAsciiBytes - 6, 'A'), std::string("A")}) {
    const std::string line = "$" + body + "*41\r\n";
    for (size_t size = 1; size < line.size(); ++size) {
      size_t bytes = 0;
      EXPECT_EQ(AsciiMessageSize(Bytes(line.substr(0, size)), bytes), Status::kTruncated) << size;
    }
  }
}

TEST(VectorNavAscii, EveryFlippedBitIsSeen) {
  const std::vector<uint8_t> line = Bytes(Line(kBody));
  InsSample sample;
  for (size_t bit = 0; bit < 8 * line.size(); ++bit) {
    std::vector<uint8_t> flipped = line;
    flipped[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    EXPECT_FALSE(IsUsable(DecodeAscii(flipped, sample))) << bit;
  }
  EXPECT_EQ(Bits(sample), Bits(InsSample{}));
}

}  // namespace
}  // namespace hardpack::vectornav
