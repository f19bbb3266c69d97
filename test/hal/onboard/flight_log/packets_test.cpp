// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/flight_log/packets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace hardpack::flight_log {
namespace {

using Bytes = std::vector<uint8_t>;

CanFrame FrameOf(uint32_t id, std::initializer_list<uint8_t> data) {
  CanFrame frame;
  frame.id = id;
  for (const uint8_t byte : data) frame.data[frame.size++] = byte;
  return frame;
}

// The pcap format: magic number of stamps in nanoseconds, version 2.4, no correction of time, no
// accuracy, the longest packet, the link type.
TEST(Packets, BeginAFileAsPcapDoes) {
  std::array<uint8_t, kPcapFileHeaderBytes> bytes;
  bytes.fill(0xee);
  EncodeFileHeader(bytes);
  const Bytes expected = {0x4d, 0x3c, 0xb2, 0xa1, 2, 0, 4, 0, 0,    0, 0, 0,
                          0,    0,    0,    0,    0, 0, 4, 0, 0x14, 1, 0, 0};
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), expected);
}

// What tcpdump 4.99.3 with libpcap 1.10.3 wrote of `cansend vcan0 181#1122334455667788`, but for
// the packet type: it calls every CAN frame a broadcast (1).
TEST(Packets, WriteACanFrameAsTcpdumpDoes) {
  const Bytes captured = {0x00, 0x0c, 0, 0, 0,    0,    0,    2,    0x01, 0x18, 4,    0,
                          0,    0,    0, 0, 0,    0,    0,    0,    0x81, 0x01, 0,    0,
                          8,    0,    0, 0, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88};
  std::array<uint8_t, kCanPacketBytes> bytes;
  EncodeCan(FrameOf(0x181, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}), Direction::kOut, 2,
            bytes);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), captured);
}

// The head of `hello` from 127.0.0.1:56744 to 127.0.0.1:7502 as the kernel sent it has checksum
// 0x5dec with identification 0xdedd; with identification 0 the sum is larger by that.
TEST(Packets, GiveIpv4HeadersTheirChecksum) {
  std::array<uint8_t, kDatagramHeadBytes> head;
  EncodeDatagramHead({0x7f000001u, 56744}, {0x7f000001u, 7502}, 5, head);
  const Bytes expected = {0x08, 0, 0,    0, 0,    0,    0,    1,    0x03, 0x04, 0, 0,
                          0,    0, 0,    0, 0,    0,    0,    0,    0x45, 0,    0, 0x21,
                          0,    0, 0x40, 0, 0x40, 0x11, 0x3c, 0xca, 0x7f, 0,    0, 1,
                          0x7f, 0, 0,    1, 0xdd, 0xa8, 0x1d, 0x4e, 0,    0x0d, 0, 0};
  EXPECT_EQ(Bytes(head.begin(), head.end()), expected);
}

// Over a whole header, checksum included: all ones.
uint32_t OnesSumOfHeader(const std::array<uint8_t, kDatagramHeadBytes>& head) {
  uint32_t sum = 0;
  for (size_t i = 20; i < 40; i += 2) sum += static_cast<uint32_t>(head[i] << 8 | head[i + 1]);
  while (sum > 0xffffu) sum = (sum & 0xffffu) + (sum >> 16);
  return sum;
}

// Also of those few whose carry carries again.
TEST(Packets, SumUpToAllOnesWhateverTheAddresses) {
  std::mt19937 random(2);
  for (size_t i = 0; i < 300000; ++i) {
    std::array<uint8_t, kDatagramHeadBytes> head;
    EncodeDatagramHead({static_cast<uint32_t>(random()), 7502},
                       {static_cast<uint32_t>(random()), 7502}, i % 1400, head);
    ASSERT_EQ(OnesSumOfHeader(head), 0xffffu) << i;
  }
}

TEST(Packets, HoldTheLargestLidarPacket) {
  std::array<uint8_t, kDatagramHeadBytes> head;
  EncodeDatagramHead({0x0a000005u, 7502}, {0x0a000001u, 7502}, 33280, head);
  EXPECT_EQ(head[22] << 8 | head[23], 33280 + 28);
  EXPECT_EQ(head[44] << 8 | head[45], 33280 + 8);
  EXPECT_EQ(OnesSumOfHeader(head), 0xffffu);
}

TEST(Packets, GiveEveryCanFrameBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 10000; ++i) {
    CanFrame frame;
    frame.extended = random() % 2 == 0;
    frame.remote = random() % 4 == 0;
    frame.id =
        static_cast<uint32_t>(random()) & (frame.extended ? kMaxExtendedCanId : kMaxStandardCanId);
    frame.size = static_cast<uint8_t>(random() % 9);
    for (int byte = 0; byte < frame.size && !frame.remote; ++byte) {
      frame.data[byte] = static_cast<uint8_t>(random());
    }
    std::array<uint8_t, kCanPacketBytes> bytes;
    EncodeCan(frame, Direction::kIn, 1, bytes);
    CanFrame read;
    ASSERT_EQ(DecodeCan(std::span(bytes).subspan(kCookedHeaderBytes), IdOrder::kLowestFirst, read),
              Status::kOk);
    ASSERT_EQ(read, frame);
    // And where the identifier's highest byte comes first.
    const std::span<uint8_t> id = std::span(bytes).subspan(kCookedHeaderBytes, 4);
    std::reverse(id.begin(), id.end());
    ASSERT_EQ(DecodeCan(std::span(bytes).subspan(kCookedHeaderBytes), IdOrder::kHighestFirst, read),
              Status::kOk);
    ASSERT_EQ(read, frame);
  }
}

TEST(Packets, TellWhatIsNoClassicCanFrame) {
  const Bytes good = {0x81, 1, 0, 0, 8, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  const auto status = [](Bytes bytes, IdOrder order = IdOrder::kLowestFirst) {
    CanFrame frame;
    frame.id = 77;
    const Status read = DecodeCan(bytes, order, frame);
    if (!IsUsable(read)) {
      EXPECT_EQ(frame.id, 77u);
    }
    return read;
  };
  EXPECT_EQ(status(good), Status::kOk);
  for (size_t size = 0; size < good.size(); ++size) {
    EXPECT_EQ(status({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}),
              Status::kTruncated);
  }
  Bytes bad = good;
  bad[3] = 0x20;
  EXPECT_EQ(status(bad), Status::kUnsupported);  // an error report
  bad = good;
  bad[5] = 0x04;
  EXPECT_EQ(status(bad), Status::kUnsupported);  // an FD frame
  bad = good;
  bad[4] = 9;
  EXPECT_EQ(status(bad), Status::kInvalidArgument);
  bad = good;
  bad[1] = 0x08;
  EXPECT_EQ(status(bad), Status::kInvalidArgument);  // 12 bits of a standard identifier
  EXPECT_EQ(status({0, 0, 1, 0x81, 0, 0, 0, 0}, IdOrder::kHighestFirst), Status::kOk);
  EXPECT_EQ(status(Bytes(72, 0)), Status::kUnsupported);
}

}  // namespace
}  // namespace hardpack::flight_log
