// SPDX-License-Identifier: Apache-2.0
// The messages are put together byte by byte as a little-endian kernel does (rtnetlink(7)).
#include "port_linux/link_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace hardpack {
namespace {

using Message = std::vector<uint8_t>;

void Put(Message& bytes, uint32_t value, size_t size = 4) {
  const size_t at = bytes.size();
  bytes.resize(at + size);
  for (size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<uint8_t>(value >> (8 * i));
}

Message operator+(const Message& a, const Message& b) {
  Message sum(a.size() + b.size());
  std::copy(b.begin(), b.end(), std::copy(a.begin(), a.end(), sum.begin()));
  return sum;
}

Message Attribute(uint32_t type, const Message& value) {
  Message header;
  Put(header, static_cast<uint32_t>(value.size()) + 4, 2);
  Put(header, type, 2);
  return header + value + Message((4 - value.size() % 4) % 4, 0);
}

Message Number(uint32_t value) {
  Message bytes;
  Put(bytes, value);
  return bytes;
}

Message Text(const std::string& text) {
  return Message(text.begin(), text.end()) + Message(1, 0);
}

// ifinfomsg: family, type (280: CAN), index, flags, change
Message Header(uint32_t flags) {
  Message bytes = {0, 0};
  Put(bytes, 280, 2);
  Put(bytes, 7);
  Put(bytes, flags);
  Put(bytes, 0);
  return bytes;
}

// can_bittiming: bit rate, sample point, and six that do not matter here
Message BitTiming() {
  return Number(500000) + Number(875) + Number(0) + Number(0) + Number(0) + Number(0) + Number(0) +
         Number(0);
}

Message Controller(uint32_t state, const std::string& kind = "can") {
  const Message data =
      Attribute(1, BitTiming()) + Attribute(4, Number(state)) + Attribute(6, Number(100));
  return Header(0x10041) + Attribute(3, Text("can0")) +
         Attribute(18, Attribute(1, Text(kind)) + Attribute(2, data));
}

TEST(LinkMessage, TellsOfAController) {
  LinkInfo link;
  ASSERT_TRUE(ParseLink(Controller(0), link));
  EXPECT_EQ(link.index, 7);
  EXPECT_STREQ(link.name, "can0");
  EXPECT_TRUE(link.is_can && link.up && link.carrier && link.has_controller);
  EXPECT_FALSE(link.bus_off);
  EXPECT_EQ(link.bit_rate_bps, 500000u);
  EXPECT_EQ(link.sample_point_permille, 875u);
  EXPECT_EQ(link.restart_ms, 100u);
  ASSERT_TRUE(ParseLink(Controller(3), link));
  EXPECT_TRUE(link.bus_off);
}

TEST(LinkMessage, DoesNotTakeAnothersDataForAControllers) {
  LinkInfo link;
  ASSERT_TRUE(ParseLink(Controller(3, "vxcan"), link));
  EXPECT_FALSE(link.has_controller || link.bus_off);
  EXPECT_EQ(link.bit_rate_bps, 0u);
}

TEST(LinkMessage, TellsFlags) {
  LinkInfo link;
  ASSERT_TRUE(ParseLink(Header(0), link));
  EXPECT_FALSE(link.up || link.carrier);
  ASSERT_TRUE(ParseLink(Header(1), link));
  EXPECT_TRUE(link.up);
  EXPECT_FALSE(link.carrier);
  EXPECT_STREQ(link.name, "");
}

TEST(LinkMessage, ReadsNothingBeyondItsEnd) {
  const Message whole = Controller(3);
  for (size_t size = 0; size < whole.size(); ++size) {
    const Message part(whole.begin(), whole.begin() + static_cast<long>(size));
    LinkInfo link;
    EXPECT_EQ(ParseLink(part, link), size >= 16) << size;
  }
  std::mt19937 random(5);
  for (int i = 0; i < 20000; ++i) {
    Message bytes = whole;
    for (int j = 0; j < 4; ++j) bytes[random() % bytes.size()] = static_cast<uint8_t>(random());
    LinkInfo link;
    EXPECT_TRUE(ParseLink(bytes, link));
    EXPECT_LE(std::string(link.name).size(), kMaxLinkName);
  }
}

TEST(LinkMessage, TakesMessagesOffOneByOne) {
  Message bytes;
  for (uint32_t i = 1; i <= 2; ++i) {
    Put(bytes, 16 + 5);  // length, of which three more bytes are padding
    Put(bytes, 16, 2);   // RTM_NEWLINK
    Put(bytes, 0, 2);
    Put(bytes, i);  // sequence
    Put(bytes, 0);
    bytes = bytes + Message(8, static_cast<uint8_t>(i));
  }
  std::span<const uint8_t> rest(bytes);
  NetlinkMessage message;
  for (uint32_t i = 1; i <= 2; ++i) {
    ASSERT_TRUE(NextNetlinkMessage(rest, message));
    EXPECT_EQ(message.type, 16);
    EXPECT_EQ(message.sequence, i);
    EXPECT_EQ(message.payload.size(), 5u);
    EXPECT_EQ(message.payload[0], i);
  }
  EXPECT_FALSE(NextNetlinkMessage(rest, message));
  for (const uint32_t length : {0u, 15u, 100u, 0xffffffffu}) {
    Message lying = Number(length) + Message(16, 0);
    rest = lying;
    EXPECT_FALSE(NextNetlinkMessage(rest, message)) << length;
  }
}

TEST(LinkMessage, ReadsAcknowledgements) {
  int code = -1;
  EXPECT_TRUE(ParseAcknowledgement(Number(static_cast<uint32_t>(-1)), code));
  EXPECT_EQ(code, 1);  // EPERM
  EXPECT_TRUE(ParseAcknowledgement(Number(0), code));
  EXPECT_EQ(code, 0);
  EXPECT_FALSE(ParseAcknowledgement(Message{0, 0, 0}, code));
}

TEST(LinkMessage, AsksInTheKernelsForm) {
  // RTM_NEWLINK 16, NLM_F_REQUEST | NLM_F_ACK, sequence 9, pid 0; ifinfomsg of index 7
  const LinkRequest request = SetLinkFlags(9, 7, 0, 1);
  Message expected = Number(32);
  Put(expected, 16, 2);
  Put(expected, 5, 2);
  expected = expected + Number(9) + Number(0) + Number(0) + Number(7) + Number(0) + Number(1);
  EXPECT_EQ(Message(request.bytes, request.bytes + sizeof(request.bytes)), expected);

  // RTM_GETLINK 18, NLM_F_REQUEST; IFLA_IFNAME 3
  expected = Number(16 + 16 + 12);
  Put(expected, 18, 2);
  Put(expected, 1, 2);
  expected = expected + Number(2) + Number(0) + Message(16, 0) + Attribute(3, Text("vcan0"));
  EXPECT_EQ(LinkQuery(2, "vcan0"), expected);
}

}  // namespace
}  // namespace hardpack
