// SPDX-License-Identifier: Apache-2.0
// On a real vcan0 (with_vcan.sh beside this file makes it ready); skipped where there is none.
#include "port_linux/socket_can_bus.h"

#include <net/if.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "port_linux/monotonic_clock.h"
#include "test/hal/conformance/can_bus_conformance.h"
#include "test/hal/conformance/can_peer.h"
#include "test/hal/conformance/delivery_barrier.h"
#include "test/hal/conformance/without_net_admin.h"
#include "tools/allocation_counter/allocation_counter.h"

namespace hardpack {
namespace {

constexpr char kInterface[] = "vcan0";
// with_vcan.sh: class 1 of the queueing discipline can be plugged, class 2 is the peer's.
constexpr int kPeerClass = 0x10002;

bool Shell(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

bool Plug(const char* how) {
  return Shell(std::string("tc qdisc change dev vcan0 parent 1:1 handle 2: plug ") + how);
}

class SocketCanHarness {
 public:
  static constexpr int kMalformedKinds = 3;

  SocketCanHarness() {
    if (if_nametoindex(kInterface) == 0) return;
    Shell("ip link set vcan0 up");
    Plug("release_indefinite");
    peer_ = std::make_unique<CanPeer>(kInterface, kPeerClass);
    bus_ = std::make_unique<SocketCanBus>();
    outcome_ = bus_->Open(kInterface, {});
  }

  const char* unavailable() const {
    if (bus_ == nullptr) return "there is no vcan0 here: run it by tools/vcan.sh";
    return outcome_.ok() ? nullptr : outcome_.message.c_str();
  }
  SocketCanBus& bus() { return *bus_; }
  CanPeer& peer() { return *peer_; }
  const OpenOutcome& outcome() const { return outcome_; }

  void PeerSend(const CanFrame& frame) { EXPECT_TRUE(peer_->Send(frame)); }
  void PeerSendMalformed() {
    can_frame wide{};  // standard, but 13 bits
    wide.can_id = 0x1abc;
    EXPECT_TRUE(peer_->Write(wide));
    canfd_frame flexible{};
    flexible.can_id = 0x123;
    for (const uint8_t size : {uint8_t{8}, uint8_t{64}}) {
      flexible.len = size;
      EXPECT_TRUE(peer_->Write(flexible));
    }
  }
  bool PeerReceive(CanFrame& frame) { return peer_->Receive(frame); }
  void TakeDown() { EXPECT_TRUE(Shell("ip link set vcan0 down")); }
  void BringUp() { EXPECT_TRUE(Shell("ip link set vcan0 up")); }
  void InjectBusOff() { (void)peer_->SendError(CAN_ERR_BUSOFF); }
  void InjectErrorState(CanBusState state) {
    const uint8_t bits = state == CanBusState::kPassive   ? CAN_ERR_CRTL_TX_PASSIVE
                         : state == CanBusState::kWarning ? CAN_ERR_CRTL_RX_WARNING
                                                          : CAN_ERR_CRTL_ACTIVE;
    EXPECT_TRUE(peer_->SendError(CAN_ERR_CRTL, bits));
  }
  bool CanStall() const { return std::getenv("HARDPACK_VCAN_CAN_STALL") != nullptr; }
  void Stall() { EXPECT_TRUE(Plug("block")); }
  void Resume() { EXPECT_TRUE(Plug("release_indefinite")); }
  bool Busy() const { return bus_->restarting(); }
  void Settle() {
    usleep(1000);
    EXPECT_TRUE(barrier_.Wait()) << "what was sent has not arrived for ten seconds";
  }

 private:
  DeliveryBarrier barrier_;
  std::unique_ptr<CanPeer> peer_;
  std::unique_ptr<SocketCanBus> bus_;
  OpenOutcome outcome_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Socket, CanBusConformance, SocketCanHarness);

class SocketCanBusTest : public CanBusConformance<SocketCanHarness> {
 protected:
  // Of a second bus: advances without time passing until it is so.
  bool Follows(SocketCanBus& other, const std::function<bool()>& is_true) {
    for (int i = 0; i < 2000 && !is_true(); ++i) {
      harness_.Settle();
      other.Advance(now_ns_);
    }
    return is_true();
  }
  bool Follows(SocketCanBus& other, CanBusState state) {
    return Follows(other, [&other, state] { return other.state() == state; });
  }
};

TEST(SocketCanBusOpening, SaysThatThereIsNoSuchInterface) {
  SocketCanBus bus;
  const OpenOutcome outcome = bus.Open("nosuch0", {});
  EXPECT_EQ(outcome.status, Status::kInterfaceDown);
  EXPECT_EQ(outcome.message, "nosuch0: no such interface");
  EXPECT_EQ(bus.Open("much_too_long_a_name", {}).status, Status::kInterfaceDown);
}

TEST(SocketCanBusOpening, SaysThatItIsNoCanInterface) {
  SocketCanBus bus;
  const OpenOutcome outcome = bus.Open("lo", {});
  EXPECT_EQ(outcome.status, Status::kUnsupported);
  EXPECT_EQ(outcome.message, "lo: not a CAN interface");
}

TEST(SocketCanBusOpening, IsDownUntilItSucceeds) {
  SocketCanBus bus;
  bus.Advance(1);
  CanFrame frame;
  EXPECT_EQ(bus.state(), CanBusState::kDown);
  EXPECT_EQ(bus.Send(frame, 2), Status::kInterfaceDown);
  EXPECT_EQ(bus.Receive(frame), Status::kEmpty);
}

TEST_F(SocketCanBusTest, SaysWhatItOpened) {
  EXPECT_EQ(harness_.outcome().message, "vcan0: no bit rate reported (a virtual bus?)");
  EXPECT_TRUE(harness_.outcome().warnings.empty()) << harness_.outcome().warnings.front();
  EXPECT_TRUE(harness_.bus().may_restart());
}

// SR-TIM03: a frame has the time at which the kernel took it off the bus, by the ticks' clock,
// however long it waits to be read.
TEST(SocketCanBusStamps, AreOfTheFramesArrival) {
  SocketCanHarness harness;
  if (const char* why = harness.unavailable()) GTEST_SKIP() << why;
  MonotonicClock clock;
  CanFrame frame;
  frame.id = 0x182;
  frame.size = 8;
  harness.bus().Advance(clock.Now_ns());
  while (IsUsable(harness.bus().Receive(frame))) {
  }
  const uint64_t before_ns = clock.Now_ns();
  harness.PeerSend(frame);
  const uint64_t after_ns = clock.Now_ns();
  CanFrame received;
  Status status = Status::kEmpty;
  for (int i = 0; i < 100 && !IsUsable(status); ++i) {
    clock.SleepUntil(clock.Now_ns() + 50'000'000);
    harness.bus().Advance(clock.Now_ns());
    status = harness.bus().Receive(received);
  }
  ASSERT_EQ(status, Status::kOk);
  EXPECT_EQ(received, frame);
  constexpr uint64_t kSlack_ns =
      20'000'000;  // of the kernel's delivery, and of two clocks' reading
  EXPECT_GE(received.received_ns + kSlack_ns, before_ns);
  EXPECT_LE(received.received_ns, after_ns + kSlack_ns);
}

TEST_F(SocketCanBusTest, OpensAnInterfaceThatIsDownAndSaysSo) {
  harness_.TakeDown();
  SocketCanBus other;
  const OpenOutcome outcome = other.Open(kInterface, {});
  ASSERT_TRUE(outcome.ok());
  ASSERT_EQ(outcome.warnings.size(), 1u);
  EXPECT_EQ(outcome.warnings[0], "vcan0: is down (ip link set vcan0 up)");
  other.Advance(1);
  EXPECT_EQ(other.state(), CanBusState::kDown);
  harness_.BringUp();
  EXPECT_TRUE(Follows(other, CanBusState::kActive));
  EXPECT_EQ(other.counters().went_down, 0u);
}

TEST_F(SocketCanBusTest, CountsABusOffOnceHoweverOftenItIsTold) {
  Tick();
  for (int i = 0; i < 3; ++i) harness_.InjectBusOff();
  ASSERT_TRUE(Until([this] { return counters().error_frames == 3; }));
  ASSERT_TRUE(Recover());
  EXPECT_EQ(counters().bus_offs, 1u);
  EXPECT_EQ(counters().error_frames, 3u);
  EXPECT_EQ(counters().restarts, 1u);
}

// 0.1 s, 0.2 s, ... 1.6 s, and 0.1 s again once a frame went through.
TEST_F(SocketCanBusTest, WaitsLongerWhenTheBusFailsAgain) {
  Tick();
  const auto silence_ns = [this] {
    harness_.InjectBusOff();
    const uint64_t began_ns = now_ns_;
    EXPECT_TRUE(Until([this] { return bus().state() == CanBusState::kBusOff; }));
    EXPECT_TRUE(Until([this] { return !harness_.Busy(); }));
    EXPECT_TRUE(Recover());
    EXPECT_EQ(counters().restarts, counters().bus_offs);
    return now_ns_ - began_ns;
  };
  for (const uint64_t expected_ms : {100u, 200u, 400u, 800u, 1600u, 1600u}) {
    EXPECT_EQ(silence_ns(), expected_ms * kMillisecond_ns);
  }
  ASSERT_EQ(bus().Send(NumberedFrame(1), now_ns_ + kTick_ns), Status::kOk);
  Tick();
  ASSERT_EQ(counters().confirmed, 1u);
  EXPECT_EQ(silence_ns(), 100 * kMillisecond_ns);
}

TEST_F(SocketCanBusTest, SaysThatItMayNotRestartAndWaitsForOthersToDoIt) {
  WithoutNetAdmin without;
  SocketCanBus other;
  const OpenOutcome outcome = other.Open(kInterface, {.receive_buffer_bytes = 4096});
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  ASSERT_EQ(outcome.warnings.size(), 1u);
  EXPECT_EQ(outcome.warnings[0],
            "vcan0: may not be restarted after bus-off, and up to 16 old frames may go out after "
            "it (needs CAP_NET_ADMIN)");
  EXPECT_FALSE(other.may_restart());
  harness_.InjectBusOff();
  ASSERT_TRUE(Follows(other, CanBusState::kBusOff));
  for (int i = 0; i < 500; ++i) other.Advance(now_ns_ += kTick_ns);
  EXPECT_EQ(other.state(), CanBusState::kBusOff);
  EXPECT_EQ(other.counters().restarts, 0u);
  EXPECT_EQ(other.counters().system_errors, 1u);

  ASSERT_TRUE(harness_.peer().SendError(CAN_ERR_RESTARTED));
  EXPECT_TRUE(Follows(other, CanBusState::kActive));
  EXPECT_EQ(other.Send(NumberedFrame(1), now_ns_ + kTick_ns), Status::kOk);
}

TEST_F(SocketCanBusTest, DoesNotRestartWhenItIsNotToBeRestarted) {
  SocketCanBus other;
  ASSERT_TRUE(other.Open(kInterface, {.restart = false}).ok());
  EXPECT_FALSE(other.may_restart());
  harness_.InjectBusOff();
  ASSERT_TRUE(Follows(other, CanBusState::kBusOff));
  for (int i = 0; i < 50; ++i) other.Advance(now_ns_ += kTick_ns);
  EXPECT_EQ(other.state(), CanBusState::kBusOff);
}

TEST_F(SocketCanBusTest, CountsThatItMayNotDropWhatHasGrownOld) {
  if (!harness_.CanStall()) GTEST_SKIP() << "this bus cannot be made to stall";
  SocketCanBus other;
  ASSERT_TRUE(other.Open(kInterface, {.restart = false}).ok());
  harness_.Stall();
  other.Advance(now_ns_);
  ASSERT_EQ(other.Send(NumberedFrame(1), now_ns_ + kTick_ns), Status::kOk);
  for (int i = 0; i < 50; ++i) other.Advance(now_ns_ += kTick_ns);
  EXPECT_EQ(other.counters().system_errors, 1u);
  harness_.Resume();
  EXPECT_TRUE(Follows(other, [&other] { return other.counters().confirmed == 1; }));
}

TEST_F(SocketCanBusTest, CountsWhatTheControllerLost) {
  ASSERT_TRUE(harness_.peer().SendError(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW));
  Tick();
  EXPECT_EQ(counters().lost, 1u);
  EXPECT_EQ(bus().state(), CanBusState::kActive);
}

TEST_F(SocketCanBusTest, TakesErrorFramesOfEveryKindAndNoDataFromThem) {
  std::mt19937 random(4);
  for (int i = 0; i < 300; ++i) {
    const uint32_t classes =
        static_cast<uint32_t>(random()) & CAN_ERR_MASK & ~(CAN_ERR_BUSOFF | CAN_ERR_RESTARTED);
    ASSERT_TRUE(harness_.peer().SendError(classes, static_cast<uint8_t>(random())));
  }
  for (int i = 0; i < 3; ++i) {
    Tick();
    EXPECT_TRUE(ReceiveAll().empty());
  }
  EXPECT_EQ(counters().error_frames, 300u);
}

// As when a USB adapter is pulled and put back.
TEST_F(SocketCanBusTest, FindsAnInterfaceThatWasTakenAwayAndPutBack) {
  if (!Shell("ip link add vcan8 type vcan") || !Shell("ip link set vcan8 up")) {
    GTEST_SKIP() << "no second vcan can be made";
  }
  SocketCanBus other;
  ASSERT_TRUE(other.Open("vcan8", {}).ok());
  ASSERT_TRUE(Follows(other, CanBusState::kActive));
  ASSERT_TRUE(Shell("ip link del vcan8"));
  ASSERT_TRUE(Follows(other, CanBusState::kDown));
  EXPECT_EQ(other.Send(NumberedFrame(1), now_ns_ + kTick_ns), Status::kInterfaceDown);
  EXPECT_EQ(other.counters().went_down, 1u);
  ASSERT_TRUE(Shell("ip link add vcan9 type vcan"));  // takes the next index
  ASSERT_TRUE(Shell("ip link add vcan8 type vcan"));
  ASSERT_TRUE(Shell("ip link set vcan8 up"));
  ASSERT_TRUE(Follows(other, CanBusState::kActive));

  CanPeer peer("vcan8");
  ASSERT_TRUE(peer.ready());
  ASSERT_TRUE(peer.Send(NumberedFrame(2)));
  EXPECT_EQ(other.Send(NumberedFrame(3), now_ns_ + kTick_ns), Status::kOk);
  EXPECT_TRUE(Follows(other, [&other] { return other.counters().confirmed == 1; }));
  CanFrame frame;
  EXPECT_EQ(other.Receive(frame), Status::kOk);
  EXPECT_EQ(NumberOf(frame), 2u);
  ASSERT_TRUE(peer.Receive(frame));
  EXPECT_EQ(NumberOf(frame), 3u);
  EXPECT_TRUE(Shell("ip link del vcan8") && Shell("ip link del vcan9"));
}

TEST_F(SocketCanBusTest, IsNotIrritatedByOtherInterfaces) {
  Tick();
  ASSERT_TRUE(Shell("ip link add vcan9 type vcan"));
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(Shell("ip link set vcan9 up && ip link set vcan9 down"));
    Tick();
  }
  ASSERT_TRUE(Shell("ip link del vcan9"));
  Tick();
  EXPECT_EQ(bus().state(), CanBusState::kActive);
  EXPECT_EQ(counters().went_down, 0u);
}

// SR-DET01
TEST_F(SocketCanBusTest, AllocatesNothingOnceItIsOpen) {
  if (!command::AllocationsAreCounted()) GTEST_SKIP() << "allocations are not counted here";
  Tick();
  const int64_t before = command::AllocationCount();
  CanFrame frame = NumberedFrame(1);
  for (int i = 0; i < 100; ++i) {
    now_ns_ += kTick_ns;
    bus().Advance(now_ns_);
    while (IsUsable(bus().Receive(frame))) {
    }
    (void)bus().Send(frame, now_ns_ + kTick_ns);
    (void)harness_.peer().Send(frame);
    if (i == 50) (void)harness_.peer().SendError(CAN_ERR_BUSOFF);
    usleep(2000);
  }
  EXPECT_EQ(command::AllocationCount(), before);
  EXPECT_EQ(counters().bus_offs, 1u);
  EXPECT_EQ(counters().restarts, 1u);
}

}  // namespace
}  // namespace hardpack
