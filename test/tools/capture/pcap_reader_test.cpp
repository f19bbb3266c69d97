// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/pcap_reader.h"

#include <gtest/gtest.h>

#include <random>

#include "test/tools/capture/capture_files.h"

namespace hardpack::capture {
namespace {

using test::AppendBig;
using test::AppendLittle;
using test::Bytes;
using test::CaptureFile;
using test::Counting;
using test::Ethernet;
using test::Fragments;
using test::IpOptions;
using test::Ipv4;
using test::Udp;

struct Read {
  std::vector<Bytes> payloads;
  std::vector<int64_t> times_ns;
  UdpDatagram last;
  ReadOutcome outcome;
  CaptureCounters counters;
  ReassemblyCounters reassembly;
};

Read ReadAll(const std::string& path) {
  Read read;
  PcapReader reader;
  read.outcome = reader.Open(path);
  if (!read.outcome.ok()) return read;
  UdpDatagram datagram;
  while (reader.Next(datagram)) {
    read.payloads.emplace_back(datagram.payload.begin(), datagram.payload.end());
    read.times_ns.push_back(datagram.time_ns);
    read.last = datagram;
  }
  read.outcome = reader.outcome();
  read.counters = reader.counters();
  read.reassembly = reader.reassembly();
  return read;
}

TEST(PcapReader, TellsWhoSentADatagramAndWhen) {
  CaptureFile file;
  file.Add(Ethernet(Ipv4(Udp(Counting(100), 7503))), 1'700'000'000'123'456'789);
  const Read read = ReadAll(file.Write());
  ASSERT_TRUE(read.outcome.ok()) << read.outcome.message;
  ASSERT_EQ(read.payloads.size(), 1u);
  EXPECT_EQ(read.payloads[0], Counting(100));
  EXPECT_EQ(read.times_ns[0], 1'700'000'000'123'456'789);
  EXPECT_EQ(read.last.source_address, test::kSensorAddress);
  EXPECT_EQ(read.last.destination_address, test::kHostAddress);
  EXPECT_EQ(read.last.source_port, 40000);
  EXPECT_EQ(read.last.destination_port, 7503);
}

TEST(PcapReader, ReadsEveryLinkTypeItNames) {
  const Bytes packet = Ipv4(Udp(Counting(64)));
  Bytes cooked(14, 0);
  AppendBig(cooked, 0x0800, 2);
  Bytes cooked2;
  AppendBig(cooked2, 0x0800, 2);
  cooked2.resize(20);
  Bytes null_little;
  AppendLittle(null_little, 2, 4);
  Bytes null_big;
  AppendBig(null_big, 2, 4);
  const std::pair<int, Bytes> heads[] = {{1, Ethernet({})}, {113, cooked},  {276, cooked2},
                                         {101, {}},         {228, {}},      {0, null_little},
                                         {0, null_big},     {108, null_big}};
  for (const auto& [link_type, head] : heads) {
    SCOPED_TRACE(link_type);
    CaptureFile file(link_type);
    Bytes frame = head;
    test::Append(frame, packet);
    file.Add(frame);
    // Too short to hold its own link header, let alone a packet.
    for (size_t size = 0; size < head.size(); ++size) {
      file.Add(Bytes(head.begin(), head.begin() + static_cast<std::ptrdiff_t>(size)));
    }
    const Read read = ReadAll(file.Write());
    ASSERT_TRUE(read.outcome.ok()) << read.outcome.message;
    ASSERT_EQ(read.payloads.size(), 1u);
    EXPECT_EQ(read.payloads[0], Counting(64));
    EXPECT_EQ(read.counters.malformed_frames, static_cast<int64_t>(head.size()));
  }
}

TEST(PcapReader, StepsOverVlanTags) {
  const Bytes packet = Ipv4(Udp(Counting(64)));
  Bytes inner;
  AppendBig(inner, 5, 2);  // tag of VLAN 5
  AppendBig(inner, 0x0800, 2);
  test::Append(inner, packet);
  Bytes outer;
  AppendBig(outer, 6, 2);
  AppendBig(outer, 0x8100, 2);
  test::Append(outer, inner);
  CaptureFile file;
  file.Add(Ethernet(inner, 0x8100));
  file.Add(Ethernet(outer, 0x88a8));
  const Read read = ReadAll(file.Write());
  EXPECT_EQ(read.payloads, std::vector<Bytes>(2, Counting(64)));
}

TEST(PcapReader, PassesOverWhatIsNotUdpOverIpv4) {
  CaptureFile file;
  file.Add(Ethernet(Counting(46), 0x0806));  // ARP
  file.Add(Ethernet(Counting(60), 0x86dd));  // IPv6
  IpOptions tcp;
  tcp.protocol = 6;
  file.Add(Ethernet(Ipv4(Counting(40), tcp)));
  const Read read = ReadAll(file.Write());
  EXPECT_TRUE(read.outcome.ok());
  EXPECT_TRUE(read.payloads.empty());
  EXPECT_EQ(read.counters.other_frames, 3);
}

TEST(PcapReader, IgnoresPaddingAndOptions) {
  IpOptions options;
  options.option_words = 3;
  Bytes frame = Ethernet(Ipv4(Udp(Counting(5)), options));
  test::Append(frame, Bytes(13, 0x99));
  CaptureFile file;
  file.Add(frame);
  EXPECT_EQ(ReadAll(file.Write()).payloads, std::vector<Bytes>(1, Counting(5)));
}

TEST(PcapReader, CountsFramesThatTheCaptureCut) {
  CaptureFile file;
  const Bytes frame = Ethernet(Ipv4(Udp(Counting(500))));
  for (size_t kept = 0; kept < frame.size(); ++kept) file.Add(frame, 0, kept);
  file.Add(frame);
  const Read read = ReadAll(file.Write());
  EXPECT_TRUE(read.outcome.ok());
  EXPECT_EQ(read.payloads.size(), 1u);
  EXPECT_EQ(read.counters.cut_frames, static_cast<int64_t>(frame.size()));
  EXPECT_EQ(read.counters.malformed_frames, 0);
}

TEST(PcapReader, CountsLengthsThatContradictEachOther) {
  CaptureFile file;
  Bytes udp = Udp(Counting(50));
  udp[5] = 200;  // says more than there is
  file.Add(Ethernet(Ipv4(udp)));
  udp[5] = 7;  // less than its own header
  file.Add(Ethernet(Ipv4(udp)));
  Bytes packet = Ipv4(Udp(Counting(50)));
  packet[3] = 200;  // longer than the frame
  file.Add(Ethernet(packet));
  packet = Ipv4(Udp(Counting(50)));
  packet[0] = 0x44;  // header of 16 bytes
  file.Add(Ethernet(packet));
  packet[0] = 0x4f;  // header of 60 bytes, more than total length
  packet[3] = 50;
  file.Add(Ethernet(packet));
  packet = Ipv4(Udp(Counting(50)));
  packet[0] = 0x65;  // version 6
  file.Add(Ethernet(packet));
  const Read read = ReadAll(file.Write());
  EXPECT_TRUE(read.payloads.empty());
  EXPECT_EQ(read.counters.malformed_frames, 6);
}

TEST(PcapReader, PutsFragmentsTogetherInAnyOrder) {
  const Bytes payload = Counting(12608);
  std::vector<Bytes> frames = Fragments(Udp(payload), 77);
  ASSERT_EQ(frames.size(), 9u);
  const unsigned seed = 5;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 50; ++round) {
    CaptureFile file;
    for (const Bytes& frame : frames) file.Add(frame);
    const Read read = ReadAll(file.Write());
    ASSERT_EQ(read.payloads, std::vector<Bytes>(1, payload));
    EXPECT_EQ(read.reassembly.incomplete, 0);
    std::shuffle(frames.begin(), frames.end(), random);
  }
}

TEST(PcapReader, TakesRepeatedAndOverlappingFragments) {
  const Bytes payload = Counting(5000);
  const std::vector<Bytes> wide = Fragments(Udp(payload), 77, 1480);
  const std::vector<Bytes> narrow = Fragments(Udp(payload), 77, 1000);
  CaptureFile file;
  file.Add(wide[0]);
  file.Add(wide[0]);
  file.Add(narrow[1]);
  file.Add(wide[3]);
  file.Add(wide[2]);
  file.Add(narrow[2]);
  file.Add(wide[1]);
  const Read read = ReadAll(file.Write());
  EXPECT_EQ(read.payloads, std::vector<Bytes>(1, payload));
  EXPECT_EQ(read.reassembly.conflicts, 0);
}

TEST(PcapReader, KeepsInterleavedDatagramsApart) {
  const Bytes a = Counting(4000, 1);
  const Bytes b = Counting(4000, 2);
  const std::vector<Bytes> of_a = Fragments(Udp(a), 1);
  const std::vector<Bytes> of_b = Fragments(Udp(b), 2);
  CaptureFile file;
  for (size_t i = 0; i < of_a.size(); ++i) {
    file.Add(of_a[i]);
    file.Add(of_b[i]);
  }
  EXPECT_EQ(ReadAll(file.Write()).payloads, (std::vector<Bytes>{a, b}));
}

TEST(PcapReader, CountsDatagramsThatNeverBecameWhole) {
  const std::vector<Bytes> frames = Fragments(Udp(Counting(12608)), 77);
  for (size_t lost = 0; lost < frames.size(); ++lost) {
    CaptureFile file;
    for (size_t i = 0; i < frames.size(); ++i) {
      if (i != lost) file.Add(frames[i]);
    }
    const Read read = ReadAll(file.Write());
    EXPECT_TRUE(read.payloads.empty());
    EXPECT_EQ(read.reassembly.incomplete, 1);
  }
}

TEST(PcapReader, DoesNotMixDatagramsOfTheSameIdentification) {
  const std::vector<Bytes> old = Fragments(Udp(Counting(4000, 1)), 77);
  const Bytes payload = Counting(4000, 2);
  const std::vector<Bytes> young = Fragments(Udp(payload), 77);
  CaptureFile file;
  file.Add(old[0], 0);
  for (const Bytes& frame : young) file.Add(frame, 50'000'000'000);
  const Read read = ReadAll(file.Write());
  EXPECT_EQ(read.payloads, std::vector<Bytes>(1, payload));
  EXPECT_EQ(read.reassembly.incomplete, 1);
}

TEST(PcapReader, GivesUpFragmentsThatContradictEachOther) {
  const std::vector<Bytes> one = Fragments(Udp(Counting(4000, 1)), 77);
  const std::vector<Bytes> other = Fragments(Udp(Counting(4000, 9)), 77);
  const std::vector<Bytes> shorter = Fragments(Udp(Counting(2000, 1)), 77);
  CaptureFile file;
  file.Add(one[0]);
  file.Add(other[0]);    // other bytes at the same place
  file.Add(one[2]);      // the end ...
  file.Add(shorter[1]);  // ... and another end
  file.Add(shorter[1]);  // an end ...
  file.Add(one[1]);      // ... and something behind it
  IpOptions options;
  options.more = true;
  file.Add(Ethernet(Ipv4(Counting(13), options)));  // no multiple of 8
  options.offset = 65528;
  options.more = false;
  file.Add(Ethernet(Ipv4(Counting(100), options)));  // beyond 64 KiB
  const Read read = ReadAll(file.Write());
  EXPECT_TRUE(read.payloads.empty());
  EXPECT_EQ(read.reassembly.conflicts, 5);
  EXPECT_EQ(read.reassembly.incomplete, 0);
}

TEST(PcapReader, IsBoundedUnderAFloodOfFragments) {
  CaptureFile file;
  constexpr int kFlood = 1000;
  for (int i = 0; i < kFlood; ++i) {
    file.Add(Fragments(Udp(Counting(4000)), static_cast<uint16_t>(i))[0], i);
  }
  const Bytes payload = Counting(12608);
  for (const Bytes& frame : Fragments(Udp(payload), 5000)) file.Add(frame, kFlood);
  const Read read = ReadAll(file.Write());
  EXPECT_EQ(read.payloads, std::vector<Bytes>(1, payload));
  EXPECT_EQ(read.reassembly.incomplete, kFlood);
}

TEST(PcapReader, SaysWhatIsWrongWithAFile) {
  PcapReader reader;
  EXPECT_EQ(reader.Open("/nowhere/run.pcap").message, "/nowhere/run.pcap: cannot be opened");
  UdpDatagram datagram;
  EXPECT_FALSE(reader.Next(datagram));

  const test::TextFile text("this is not a capture at all, and long enough to tell");
  ReadOutcome outcome = reader.Open(text.path());
  EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  EXPECT_EQ(outcome.message.find(text.path() + ": not a capture file"), 0u) << outcome.message;

  const test::TextFile empty("");
  EXPECT_EQ(reader.Open(empty.path()).message.find(empty.path() + ": not a capture file"), 0u);

  CaptureFile usb(189);
  outcome = reader.Open(usb.Write());
  EXPECT_EQ(outcome.status, Status::kUnsupported);
  EXPECT_NE(outcome.message.find("link type 189 (USB_LINUX) is not handled"), std::string::npos)
      << outcome.message;
  EXPECT_FALSE(reader.Next(datagram));
}

TEST(PcapReader, SaysWhereAFileEndsTooEarly) {
  CaptureFile file;
  file.Add(Ethernet(Ipv4(Udp(Counting(100)))));
  const size_t first_end = file.bytes().size();
  file.Add(Ethernet(Ipv4(Udp(Counting(100)))));
  const Bytes whole = file.bytes();
  for (size_t size = first_end + 1; size < whole.size(); ++size) {
    file.bytes().assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const Read read = ReadAll(file.Write());
    EXPECT_EQ(read.payloads.size(), 1u);
    ASSERT_EQ(read.outcome.status, Status::kTruncated) << size;
    EXPECT_NE(read.outcome.message.find("cannot be read beyond packet 1"), std::string::npos)
        << read.outcome.message;
  }
}

TEST(PcapReader, WithstandsDamage) {
  CaptureFile file;
  for (const Bytes& frame : Fragments(Udp(Counting(9000)), 3)) file.Add(frame);
  for (int i = 0; i < 5; ++i) file.Add(Ethernet(Ipv4(Udp(Counting(300)))));
  const Bytes whole = file.bytes();
  const unsigned seed = 31;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  for (int round = 0; round < 400; ++round) {
    file.bytes() = whole;
    for (int i = 0; i < 4; ++i) {
      file.bytes()[random() % whole.size()] = static_cast<uint8_t>(random());
    }
    const Read read = ReadAll(file.Write());
    EXPECT_EQ(read.outcome.ok(), read.outcome.message.empty());
    EXPECT_EQ(read.counters.datagrams, static_cast<int64_t>(read.payloads.size()));
    EXPECT_LE(read.counters.datagrams, read.counters.frames);
  }
}

}  // namespace
}  // namespace hardpack::capture
