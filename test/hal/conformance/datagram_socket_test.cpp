// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <time.h>

#include <memory>
#include <string>

#include "port_linux/udp_socket.h"
#include "test/fakes/memory_datagram_socket.h"
#include "test/hal/conformance/datagram_socket_conformance.h"
#include "test/hal/conformance/without_net_admin.h"
#include "tools/allocation_counter/allocation_counter.h"

namespace hardpack {
namespace {

constexpr uint32_t kLoopback = 0x7f000001;  // 127.0.0.1
constexpr uint32_t kOther = 0x7f000002;     // 127.0.0.2

class MemoryDatagramHarness {
 public:
  DatagramSocket& socket() { return socket_; }
  void Send(std::span<const uint8_t> bytes) { socket_.Deliver(bytes); }
  void SendForeign(std::span<const uint8_t> bytes) { socket_.Deliver(bytes, 0x0a000009, 7502); }
  bool SendOversized() {
    Send(Bytes(kMaxDatagram_bytes + 1, 3));
    return true;
  }
  uint32_t sender_address() const { return 0x0a000001; }
  uint16_t sender_port() const { return 49152; }

 private:
  fakes::MemoryDatagramSocket socket_{0x0a000001, 0};
};

// A program that sends datagrams from an address and a port of its own.
class UdpSender {
 public:
  explicit UdpSender(uint32_t address) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in own = Address(address, 0);
    socklen_t size = sizeof(own);
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<const sockaddr*>(&own), size), 0);
    EXPECT_EQ(getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&own), &size), 0);
    port_ = ntohs(own.sin_port);
  }

  uint16_t port() const { return port_; }
  bool Send(std::span<const uint8_t> bytes, uint32_t address, uint16_t port) {
    const sockaddr_in to = Address(address, port);
    return sendto(socket_.get(), bytes.data(), bytes.size(), 0,
                  reinterpret_cast<const sockaddr*>(&to),
                  sizeof(to)) == static_cast<ssize_t>(bytes.size());
  }

 private:
  static sockaddr_in Address(uint32_t address, uint16_t port) {
    sockaddr_in result{};
    result.sin_family = AF_INET;
    result.sin_port = htons(port);
    result.sin_addr.s_addr = htonl(address);
    return result;
  }

  FileDescriptor socket_;
  uint16_t port_ = 0;
};

UdpSocketOptions Loopback() {
  UdpSocketOptions options;
  options.bind_address = kLoopback;
  options.sender_address = kLoopback;
  options.require_receive_buffer = false;  // as the tests' user may have
  return options;
}

class UdpHarness {
 public:
  UdpHarness() {
    const OpenOutcome outcome = socket_->Open(Loopback());
    EXPECT_TRUE(outcome.ok()) << outcome.message;
  }

  UdpSocket& socket() { return *socket_; }
  void Send(std::span<const uint8_t> bytes) {
    EXPECT_TRUE(sender_.Send(bytes, kLoopback, socket_->port()));
  }
  void SendForeign(std::span<const uint8_t> bytes) {
    EXPECT_TRUE(foreign_.Send(bytes, kLoopback, socket_->port()));
  }
  bool SendOversized() {
    return sender_.Send(Bytes(kMaxDatagram_bytes + 1, 3), kLoopback, socket_->port());
  }
  uint32_t sender_address() const { return kLoopback; }
  uint16_t sender_port() const { return sender_.port(); }

 private:
  std::unique_ptr<UdpSocket> socket_ = std::make_unique<UdpSocket>();
  UdpSender sender_{kLoopback};
  UdpSender foreign_{kOther};
};

INSTANTIATE_TYPED_TEST_SUITE_P(Memory, DatagramSocketConformance, MemoryDatagramHarness);
INSTANTIATE_TYPED_TEST_SUITE_P(Udp, DatagramSocketConformance, UdpHarness);

TEST(MemoryDatagramSocket, ShowsTheUseOfStaleBytes) {
  MemoryDatagramHarness harness;
  harness.Send(Bytes(4, 1));
  const Datagram datagram = harness.socket().Receive(1)[0];
  harness.socket().Receive(1);
  EXPECT_EQ(BytesOf(datagram), std::vector<uint8_t>(4, 0xdd));
}

TEST(UdpSocket, StampsDatagramsByTheWallClock) {
  UdpHarness harness;
  harness.Send(Bytes(4, 1));
  const std::span<const Datagram> got = harness.socket().Receive(1);
  ASSERT_EQ(got.size(), 1u);
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  const int64_t now_ns = int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
  EXPECT_LE(got[0].kernel_time_ns, now_ns);
  EXPECT_GT(got[0].kernel_time_ns, now_ns - int64_t{60} * 1'000'000'000);
}

// SR-INP05
TEST(UdpSocket, HoldsTheSenderToItsPortWhereOneIsSet) {
  UdpSender right(kLoopback), wrong(kLoopback);
  UdpSocketOptions options = Loopback();
  options.sender_port = right.port();
  const auto socket = std::make_unique<UdpSocket>();
  ASSERT_TRUE(socket->Open(options).ok());
  ASSERT_TRUE(wrong.Send(Bytes(4, 1), kLoopback, socket->port()));
  ASSERT_TRUE(right.Send(Bytes(4, 2), kLoopback, socket->port()));
  const std::span<const Datagram> got = socket->Receive(4);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(BytesOf(got[0]), Bytes(4, 2));
  EXPECT_EQ(socket->counters().foreign, 1u);
}

TEST(UdpSocket, SaysHowMuchOfTheBufferItGot) {
  UdpSocketOptions options = Loopback();
  options.receive_buffer_bytes = 65536;
  auto socket = std::make_unique<UdpSocket>();
  OpenOutcome outcome = socket->Open(options);
  EXPECT_TRUE(outcome.ok());
  EXPECT_TRUE(outcome.warnings.empty());
  EXPECT_GE(socket->counters().receive_buffer_bytes, 65536u);

  const WithoutNetAdmin without;
  options.receive_buffer_bytes = 0x3fffffff;  // more than any computer grants an ordinary user
  socket = std::make_unique<UdpSocket>();
  outcome = socket->Open(options);
  const uint64_t granted = socket->counters().receive_buffer_bytes;
  if (granted >= 0x3fffffff) GTEST_SKIP() << "net.core.rmem_max permits any buffer";
  ASSERT_TRUE(outcome.ok());
  ASSERT_EQ(outcome.warnings.size(), 1u);
  EXPECT_EQ(outcome.warnings[0], "UDP 127.0.0.1:0: receive buffer " + std::to_string(granted) +
                                     " of 1073741823 bytes (sysctl net.core.rmem_max, or "
                                     "CAP_NET_ADMIN)");
  options.require_receive_buffer = true;
  socket = std::make_unique<UdpSocket>();
  EXPECT_EQ(socket->Open(options).status, Status::kCapacityExceeded);
}

TEST(UdpSocket, SaysWhyItCannotBeOpened) {
  const auto why = [](const UdpSocketOptions& options, Status status) {
    const auto socket = std::make_unique<UdpSocket>();
    const OpenOutcome outcome = socket->Open(options);
    EXPECT_EQ(outcome.status, status) << outcome.message;
    EXPECT_EQ(socket->port(), 0);
    EXPECT_TRUE(socket->Receive(1).empty());
    return outcome.message;
  };
  UdpSocketOptions options = Loopback();
  options.sender_address = 0;
  EXPECT_EQ(why(options, Status::kInvalidArgument),
            "UDP 127.0.0.1:0: the sender's address is not configured");
  options = Loopback();
  options.receive_buffer_bytes = 0;
  EXPECT_EQ(why(options, Status::kInvalidArgument),
            "UDP 127.0.0.1:0: the receive buffer is smaller than one byte");
  options = Loopback();
  options.bind_address = 0xc0000201;  // 192.0.2.1, nobody's (RFC 5737)
  EXPECT_EQ(why(options, Status::kInvalidArgument),
            "UDP 192.0.2.1:0: cannot be bound (Cannot assign requested address)");
  UdpHarness other;
  options = Loopback();
  options.port = other.socket().port();
  EXPECT_EQ(why(options, Status::kSystemError), "UDP 127.0.0.1:" + std::to_string(options.port) +
                                                    ": cannot be bound (Address already in use)");
}

// SR-DET01
TEST(UdpSocket, AllocatesNothingOnceItIsOpen) {
  if (!command::AllocationsAreCounted()) GTEST_SKIP() << "allocations are not counted here";
  UdpHarness harness;
  const std::vector<uint8_t> bytes = Bytes(12608, 1);
  const int64_t before = command::AllocationCount();
  size_t got = 0;
  for (int i = 0; i < 100; ++i) {
    harness.Send(bytes);
    harness.SendForeign(bytes);
    got += harness.socket().Receive(DatagramSocket::kMaxBatch).size();
  }
  const int64_t after = command::AllocationCount();
  EXPECT_EQ(after, before);
  EXPECT_EQ(got, 100u);
}

}  // namespace
}  // namespace hardpack
