// SPDX-License-Identifier: Apache-2.0
#include "hal/labels/labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/crc32.h"
#include "core/segmentation/label_table.h"

namespace hardpack::labels {
namespace {

constexpr int kBeams = 64;
constexpr int kColumns = 1024;

Header HeaderOf(int beams, int columns, int first_measurement) {
  Header header;
  header.version = kVersion;
  header.beams = static_cast<uint8_t>(beams);
  header.columns = static_cast<uint16_t>(columns);
  header.first_measurement = static_cast<uint16_t>(first_measurement);
  header.frame_id = 0xbeef;
  header.sequence = 0x89abcdefu;
  header.timestamp_ns = 0x0123456789abcdefu;
  return header;
}

std::vector<uint8_t> RandomCodes(std::mt19937& random, int columns, int beams) {
  std::vector<uint8_t> codes(static_cast<size_t>(columns * beams));
  for (uint8_t& code : codes) code = static_cast<uint8_t>(random() % 256);
  return codes;
}

std::vector<uint8_t> Encoded(const Header& header, const std::vector<uint8_t>& codes) {
  std::vector<uint8_t> datagram(kMaxDatagramBytes);
  int size_bytes = -1;
  EXPECT_EQ(Encode(header, codes, datagram, size_bytes), Status::kOk);
  datagram.resize(static_cast<size_t>(std::max(size_bytes, 0)));
  return datagram;
}

// A datagram of 16 columns of zeros.
std::vector<uint8_t> Plain() {
  return Encoded(HeaderOf(kBeams, 16, 32), std::vector<uint8_t>(16 * kBeams));
}

void FixCrc(std::vector<uint8_t>& datagram) {
  const size_t checked = datagram.size() - kFooterBytes;
  const uint32_t crc = Crc32<kMaxDatagramBytes>(std::span(datagram).first(checked));
  for (size_t i = 0; i < 4; ++i) datagram[checked + i] = static_cast<uint8_t>(crc >> (8 * i));
}

Status Check(const std::vector<uint8_t>& datagram) {
  Header header;
  return CheckDatagram(datagram, kBeams, kColumns, header);
}

void ExpectSameHeader(const Header& a, const Header& b) {
  EXPECT_EQ(a.version, b.version);
  EXPECT_EQ(a.beams, b.beams);
  EXPECT_EQ(a.frame_id, b.frame_id);
  EXPECT_EQ(a.first_measurement, b.first_measurement);
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.timestamp_ns, b.timestamp_ns);
}

std::string DocumentText() {
  std::ifstream file(HARDPACK_SOURCE "/docs/label_datagram.md");
  EXPECT_TRUE(file) << "the document is not beside the sources";
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<uint8_t> BytesOfDocument(const std::string& text) {
  const std::string fence = "```hex\n";
  const size_t begin = text.find(fence) + fence.size();
  std::istringstream hex(text.substr(begin, text.find("```", begin) - begin));
  std::vector<uint8_t> bytes;
  for (unsigned byte = 0; hex >> std::hex >> byte;) bytes.push_back(static_cast<uint8_t>(byte));
  return bytes;
}

TEST(LabelDatagram, IsWhatTheDocumentSays) {
  const std::string text = DocumentText();
  const std::vector<uint8_t> bytes = BytesOfDocument(text);
  ASSERT_EQ(bytes.size(), 36u);
  Header header;
  ASSERT_EQ(CheckDatagram(bytes, 4, 1024, header), Status::kOk);
  EXPECT_EQ(header.frame_id, 258);
  EXPECT_EQ(header.first_measurement, 1022);
  EXPECT_EQ(header.columns, 2);
  EXPECT_EQ(header.sequence, 7u);
  EXPECT_EQ(header.timestamp_ns, 1234567890123456789u);
  ColumnLabels column;
  ASSERT_EQ(DecodeColumn(header, bytes, 0, column), Status::kOk);
  EXPECT_EQ(column.frame_id, 258);
  EXPECT_EQ(column.measurement_id, 1022);
  ASSERT_EQ(column.beams, 4);
  EXPECT_EQ(std::vector<uint8_t>(column.label, column.label + 4),
            (std::vector<uint8_t>{3, 3, 19, 0}));
  ASSERT_EQ(DecodeColumn(header, bytes, 1, column), Status::kOk);
  EXPECT_EQ(column.measurement_id, 1023);
  EXPECT_EQ(std::vector<uint8_t>(column.label, column.label + 4),
            (std::vector<uint8_t>{1, 17, 4, 255}));
  EXPECT_EQ(Encoded(header, {3, 3, 19, 0, 1, 17, 4, 255}), bytes);
  EXPECT_NE(text.find("CRC 0x16e44a2c"), std::string::npos);
}

// The codes of one row of the document's table of classes.
std::vector<int> CodesOfRow(const std::string& text, const std::string& row) {
  const size_t begin = text.find("\n| " + row);
  EXPECT_NE(begin, std::string::npos) << row;
  const size_t codes = text.find('|', begin + 3);
  std::istringstream words(text.substr(codes + 1, text.find('\n', codes) - codes - 1));
  std::vector<int> found;
  for (std::string word; words >> word;) {
    if (std::isdigit(static_cast<unsigned char>(word[0])) != 0) found.push_back(std::stoi(word));
  }
  return found;
}

TEST(LabelDatagram, HasTheCodesThatTheDocumentSays) {
  const std::string text = DocumentText();
  const LabelTable table = RellisLabelTable();
  std::vector<ReturnClass> said(kLabelCodes, ReturnClass::kHard);
  size_t named = 0;
  const auto say = [&](const std::string& row, ReturnClass meaning) {
    for (const int code : CodesOfRow(text, row)) {
      said[static_cast<size_t>(code)] = meaning;
      ++named;
    }
  };
  say("hard:", ReturnClass::kHard);
  say("person:", ReturnClass::kPerson);
  say("soft:", ReturnClass::kSoft);
  say("ground ", ReturnClass::kGround);
  say("ignored ", ReturnClass::kIgnored);
  EXPECT_EQ(named, 20u);
  for (size_t code = 0; code < kLabelCodes; ++code) {
    EXPECT_EQ(table.class_of[code], said[code]) << code;
  }
}

TEST(LabelDatagram, DecodesWhatWasEncoded) {
  const unsigned seed = 4711;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 400; ++run) {
    const int beams = run == 0 ? kMaxBeams : 1 + static_cast<int>(random() % kMaxBeams);
    const int columns = run == 0 ? kMaxColumns : 1 + static_cast<int>(random() % kMaxColumns);
    const int revolution = 512 << random() % 3;
    // The last column of the revolution is reached now and then.
    const int room = revolution - columns;
    const int first =
        run % 4 == 0 ? room : static_cast<int>(random() % static_cast<unsigned>(room));
    Header sent = HeaderOf(beams, columns, first);
    sent.frame_id = static_cast<uint16_t>(random());
    sent.sequence = static_cast<uint32_t>(random());
    sent.timestamp_ns = uint64_t{random()} << 32 | random();
    const std::vector<uint8_t> codes = RandomCodes(random, columns, beams);
    const std::vector<uint8_t> datagram = Encoded(sent, codes);
    ASSERT_EQ(datagram.size(), codes.size() + kHeaderBytes + kFooterBytes);

    Header header;
    ASSERT_EQ(CheckDatagram(datagram, beams, revolution, header), Status::kOk);
    ExpectSameHeader(header, sent);
    for (int index = 0; index < columns; ++index) {
      ColumnLabels column;
      ASSERT_EQ(DecodeColumn(header, datagram, index, column), Status::kOk);
      ASSERT_EQ(column.frame_id, sent.frame_id);
      ASSERT_EQ(column.measurement_id, first + index);
      ASSERT_EQ(column.beams, beams);
      ASSERT_TRUE(std::equal(column.label, column.label + beams, codes.begin() + index * beams));
    }
  }
}

// SR-INP03
TEST(LabelDatagram, IsRefusedAtEveryOtherLength) {
  const std::vector<uint8_t> datagram = Plain();
  for (size_t size = 0; size < datagram.size(); ++size) {
    Header header = HeaderOf(1, 1, 1);
    ASSERT_EQ(CheckDatagram(std::span(datagram).first(size), kBeams, kColumns, header),
              Status::kTruncated);
    if (size < kHeaderBytes + kFooterBytes) ExpectSameHeader(header, Header{});
  }
  for (const size_t more : {1u, 64u, 60000u}) {
    std::vector<uint8_t> longer(datagram.size() + more);
    std::copy(datagram.begin(), datagram.end(), longer.begin());
    EXPECT_EQ(Check(longer), Status::kOversized);
  }
}

// SR-INP03
TEST(LabelDatagram, IsRefusedWithAnyBitChanged) {
  const std::vector<uint8_t> datagram = Plain();
  ASSERT_EQ(Check(datagram), Status::kOk);
  for (size_t bit = 0; bit < 8 * datagram.size(); ++bit) {
    std::vector<uint8_t> changed = datagram;
    changed[bit / 8] = static_cast<uint8_t>(changed[bit / 8] ^ 1u << bit % 8);
    ASSERT_FALSE(IsUsable(Check(changed))) << bit;
  }
}

// SR-INP03
TEST(LabelDatagram, IsRefusedForWhatItSaysOfItself) {
  const auto checked = [](size_t offset, uint8_t value) {
    std::vector<uint8_t> datagram = Plain();
    datagram[offset] = value;
    FixCrc(datagram);
    return Check(datagram);
  };
  EXPECT_EQ(checked(0, 0x49), Status::kWrongPacketType);
  EXPECT_EQ(checked(3, 0x00), Status::kWrongPacketType);
  EXPECT_EQ(checked(4, 0), Status::kUnsupported);
  EXPECT_EQ(checked(4, 2), Status::kUnsupported);
  EXPECT_EQ(checked(5, 0), Status::kInvalidArgument);
  EXPECT_EQ(checked(5, 129), Status::kInvalidArgument);
  EXPECT_EQ(checked(5, 255), Status::kInvalidArgument);
  EXPECT_EQ(checked(10, 0), Status::kInvalidArgument);
  EXPECT_EQ(checked(10, 65), Status::kInvalidArgument);
  EXPECT_EQ(checked(11, 0xff), Status::kInvalidArgument);
  EXPECT_EQ(checked(10, 64), Status::kTruncated);
  EXPECT_EQ(checked(10, 15), Status::kOversized);
  EXPECT_EQ(checked(5, 63), Status::kOversized);
  EXPECT_EQ(checked(9, 0xff), Status::kBadColumn);
  // Nothing else about it matters.
  for (size_t offset = 12; offset < kHeaderBytes; ++offset) {
    EXPECT_EQ(checked(offset, 0xff), Status::kOk);
  }
}

//   ... 1007 | 1008 ... 1023 | 1024
//            the last 16     | of the next revolution
// SR-INP03
TEST(LabelDatagram, StaysWithinTheRevolutionOfTheSensor) {
  const std::vector<uint8_t> codes(16 * kBeams);
  EXPECT_EQ(Check(Encoded(HeaderOf(kBeams, 16, 1008), codes)), Status::kOk);
  EXPECT_EQ(Check(Encoded(HeaderOf(kBeams, 16, 1009), codes)), Status::kBadColumn);
  EXPECT_EQ(Check(Encoded(HeaderOf(kBeams, 16, 1024), codes)), Status::kBadColumn);
  EXPECT_EQ(Check(Encoded(HeaderOf(kBeams, 16, 2032), codes)), Status::kBadColumn);
  EXPECT_EQ(Check(Encoded(HeaderOf(32, 32, 0), codes)), Status::kWrongSensor);
  Header header;
  const std::vector<uint8_t> datagram = Plain();
  for (const int nonsense : {-1, 0, INT32_MIN}) {
    EXPECT_EQ(CheckDatagram(datagram, nonsense, kColumns, header), Status::kWrongSensor);
    EXPECT_EQ(CheckDatagram(datagram, kBeams, nonsense, header), Status::kBadColumn);
  }
  ExpectSameHeader(header, HeaderOf(kBeams, 16, 32));
}

TEST(DecodeColumn, LeavesTheColumnAloneWhenThereIsNone) {
  const std::vector<uint8_t> datagram = Plain();
  const Header header = HeaderOf(kBeams, 16, 32);
  ColumnLabels column;
  column.frame_id = 5;
  column.measurement_id = 6;
  column.beams = 7;
  column.label[0] = 8;
  for (const int index : {-1, 16, INT32_MAX, INT32_MIN}) {
    EXPECT_EQ(DecodeColumn(header, datagram, index, column), Status::kInvalidArgument);
  }
  EXPECT_EQ(DecodeColumn(Header{}, datagram, 0, column), Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(HeaderOf(129, 16, 32), datagram, 0, column), Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(HeaderOf(kBeams, 65, 32), datagram, 0, column), Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(HeaderOf(kBeams, 16, 65535), datagram, 1, column),
            Status::kInvalidArgument);
  EXPECT_EQ(DecodeColumn(HeaderOf(kBeams, 17, 32), datagram, 0, column), Status::kTruncated);
  EXPECT_EQ(DecodeColumn(HeaderOf(kBeams, 15, 32), datagram, 0, column), Status::kTruncated);
  EXPECT_EQ(DecodeColumn(header, {}, 0, column), Status::kTruncated);
  EXPECT_EQ(column.frame_id, 5);
  EXPECT_EQ(column.measurement_id, 6);
  EXPECT_EQ(column.beams, 7);
  EXPECT_EQ(column.label[0], 8);
}

TEST(Encode, WritesNothingThatDoesNotFit) {
  std::vector<uint8_t> datagram(kHeaderBytes + 16 * kBeams + kFooterBytes, 0xaa);
  const std::vector<uint8_t> codes(16 * kBeams);
  int size_bytes = 99;
  const auto encode = [&](const Header& header, std::span<const uint8_t> given) {
    size_bytes = 99;
    return Encode(header, given, datagram, size_bytes);
  };
  EXPECT_EQ(encode(HeaderOf(0, 16, 0), {}), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(kBeams, 0, 0), {}), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(129, 1, 0), std::vector<uint8_t>(129)), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(1, 65, 0), std::vector<uint8_t>(65)), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(kBeams, 16, 2033), codes), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(kBeams, 16, 65535), codes), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(kBeams, 15, 0), codes), Status::kInvalidArgument);
  EXPECT_EQ(encode(HeaderOf(kBeams, 17, 0), codes), Status::kInvalidArgument);
  EXPECT_EQ(size_bytes, 0);
  size_bytes = 99;
  EXPECT_EQ(Encode(HeaderOf(kBeams, 16, 0), codes, std::span(datagram).first(1051), size_bytes),
            Status::kCapacityExceeded);
  EXPECT_EQ(size_bytes, 0);
  EXPECT_EQ(std::count(datagram.begin(), datagram.end(), 0xaa), 1052);
  EXPECT_EQ(encode(HeaderOf(kBeams, 16, 2032), codes), Status::kOk);
  EXPECT_EQ(size_bytes, 1052);
}

TEST(LabelDatagram, IsSafeToCheckWhateverTheBytes) {
  const unsigned seed = 12;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int run = 0; run < 20'000; ++run) {
    std::vector<uint8_t> bytes = RandomCodes(random, static_cast<int>(random() % 200), 1);
    // Half of them with a header that comes further.
    const std::vector<uint8_t> start = {0x48, 0x50, 0x4c, 0x42, 1};
    if (run % 2 == 0)
      std::copy_n(start.begin(), std::min(start.size(), bytes.size()), bytes.begin());
    Header header;
    ASSERT_FALSE(IsUsable(CheckDatagram(bytes, kBeams, kColumns, header)));
    ColumnLabels column;
    const Status decoded = DecodeColumn(header, bytes, static_cast<int>(random() % 70), column);
    ASSERT_TRUE(decoded == Status::kOk || decoded == Status::kInvalidArgument ||
                decoded == Status::kTruncated);
  }
}

}  // namespace
}  // namespace hardpack::labels
