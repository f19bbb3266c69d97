// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "test/port_linux/log_files.h"
#include "test/tools/capture/capture_files.h"
#include "tools/capture/pcap_reader.h"

namespace hardpack::capture {
namespace {

using test::AppendBig;
using test::AppendLittle;
using test::Bytes;

constexpr uint32_t kSll = 113;
constexpr uint32_t kSll2 = 276;
constexpr uint32_t kCan = 227;

// 0x181 with eight bytes, as a can_frame.
Bytes CanFrameBytes(bool highest_first, uint32_t id = 0x181, uint8_t last = 0x88) {
  Bytes bytes;
  highest_first ? AppendBig(bytes, id, 4) : AppendLittle(bytes, id, 4);
  test::Append(bytes, {8, 0, 0, 0, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, last});
  return bytes;
}

Bytes Cooked2(uint16_t protocol, uint32_t interface_index, const Bytes& content) {
  Bytes bytes;
  AppendBig(bytes, protocol, 2);
  AppendBig(bytes, 0, 2);
  AppendBig(bytes, interface_index, 4);
  AppendBig(bytes, protocol == 0x000c ? 280 : 1, 2);
  test::Append(bytes, {1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  test::Append(bytes, content);
  return bytes;
}

class CanCapture : public ::testing::Test {
 protected:
  struct Stamped {
    int64_t time_us = 0;
    Bytes bytes;
  };

  // Every packet of a file of these.
  std::vector<CapturedPacket> Read(uint32_t link_type, const std::vector<Stamped>& packets,
                                   bool drop_duplicates = false) {
    Bytes file;
    AppendLittle(file, 0xa1b2c3d4u, 4);
    AppendLittle(file, 2, 2);
    AppendLittle(file, 4, 2);
    AppendLittle(file, 0, 8);
    AppendLittle(file, 262144, 4);
    AppendLittle(file, link_type, 4);
    for (const Stamped& packet : packets) {
      AppendLittle(file, static_cast<uint64_t>(packet.time_us / 1'000'000), 4);
      AppendLittle(file, static_cast<uint64_t>(packet.time_us % 1'000'000), 4);
      AppendLittle(file, packet.bytes.size(), 4);
      AppendLittle(file, packet.bytes.size(), 4);
      test::Append(file, packet.bytes);
    }
    const std::string path = directory_.path() + "/capture.pcap";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()),
               static_cast<std::streamsize>(file.size()));
    EXPECT_TRUE(reader_.Open(path).ok());
    if (drop_duplicates) reader_.DropDuplicates();
    std::vector<CapturedPacket> read;
    CapturedPacket packet;
    while (reader_.Next(packet)) read.push_back(packet);
    EXPECT_TRUE(reader_.outcome().ok());
    return read;
  }

  fakes::LogDirectory directory_;
  PcapReader reader_;
};

TEST_F(CanCapture, GivesTheSameFrameOfEveryLinkType) {
  Bytes cooked1 = {0, 1, 1, 0x18, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x0c};
  test::Append(cooked1, CanFrameBytes(false));
  for (const auto& [link_type, bytes] :
       std::vector<std::pair<uint32_t, Bytes>>{{kSll, cooked1},
                                               {kSll2, Cooked2(0x000c, 2, CanFrameBytes(false))},
                                               {kCan, CanFrameBytes(true)}}) {
    const std::vector<CapturedPacket> packets = Read(link_type, {{1'000'001, bytes}});
    ASSERT_EQ(packets.size(), 1u) << link_type;
    EXPECT_EQ(packets[0].kind, CapturedPacket::Kind::kCanFrame);
    EXPECT_EQ(packets[0].time_ns, 1'000'001'000);
    EXPECT_EQ(packets[0].frame.id, 0x181u);
    EXPECT_EQ(packets[0].frame.size, 8);
    EXPECT_EQ(packets[0].frame.data[7], 0x88);
    EXPECT_EQ(reader_.counters().can_frames, 1);
  }
}

TEST_F(CanCapture, CountsErrorReportsAndFdFramesAsOther) {
  const std::vector<CapturedPacket> packets =
      Read(kSll2, {{1, Cooked2(0x000c, 2, CanFrameBytes(false, 0x20000004u))},
                   {2, Cooked2(0x000d, 2, Bytes(72, 0))},
                   {3, Cooked2(0x000c, 2, Bytes(7, 0))}});
  EXPECT_TRUE(packets.empty());
  EXPECT_EQ(reader_.counters().other_frames, 2);
  EXPECT_EQ(reader_.counters().malformed_frames, 1);
}

// A bridge br0 (4) and its port eth0 (2): each packet is seen on both.
TEST_F(CanCapture, DropsWhatAnotherInterfaceHasShown) {
  const Bytes first = test::Ipv4(test::Udp(test::Counting(84)));
  const Bytes second = test::Ipv4(test::Udp(test::Counting(84, 1)));
  const std::vector<Stamped> packets = {
      {1000, Cooked2(0x0800, 2, first)},   {1010, Cooked2(0x0800, 4, first)},
      {2000, Cooked2(0x0800, 4, second)},  {2010, Cooked2(0x0800, 2, second)},
      {3000, Cooked2(0x0800, 2, first)},   {3001, Cooked2(0x0800, 2, first)},  // sent thrice
      {3010, Cooked2(0x0800, 4, first)},   {3011, Cooked2(0x0800, 4, first)},
      {50'000, Cooked2(0x0800, 4, first)},  // too late to be the same
  };
  EXPECT_EQ(Read(kSll2, packets, true).size(), 5u);
  EXPECT_EQ(reader_.counters().duplicates, 4);
  EXPECT_EQ(Read(kSll2, packets, false).size(), 9u);
}

TEST_F(CanCapture, KeepsWhatIsSentAgainOnOneInterface) {
  std::vector<Stamped> packets;
  for (int i = 0; i < 100; ++i) {
    packets.push_back({1000 + i * 10'000, Cooked2(0x000c, 3, CanFrameBytes(false))});
  }
  EXPECT_EQ(Read(kSll2, packets, true).size(), 100u);
  EXPECT_EQ(reader_.counters().duplicates, 0);
}

TEST_F(CanCapture, PutsFragmentsTogetherThatTwoInterfacesShow) {
  const Bytes udp = test::Udp(test::Counting(4000));
  std::vector<Stamped> packets;
  for (size_t offset = 0; offset < udp.size(); offset += 1480) {
    const size_t end = std::min(udp.size(), offset + 1480);
    test::IpOptions options;
    options.offset = offset;
    options.more = end < udp.size();
    const Bytes part(udp.begin() + static_cast<std::ptrdiff_t>(offset),
                     udp.begin() + static_cast<std::ptrdiff_t>(end));
    const Bytes ip = test::Ipv4(part, options);
    packets.push_back({1000, Cooked2(0x0800, 2, ip)});
    packets.push_back({1001, Cooked2(0x0800, 4, ip)});
  }
  EXPECT_EQ(Read(kSll2, packets, true).size(), 1u);
  EXPECT_EQ(reader_.reassembly().incomplete, 0);
  EXPECT_EQ(reader_.reassembly().completed, 1);
}

}  // namespace
}  // namespace hardpack::capture
