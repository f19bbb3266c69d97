// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "hal/can_bus.h"

// What every CanBus has to do (hal/can_bus.h). A Harness has one bus and the rest of the wire:
//
//   const char* unavailable()       why there is nothing to be tested here; nullptr: there is
//   CanBus& bus()
//   void PeerSend(CanFrame)         from another node
//   void PeerSendMalformed()        what no bus can carry, kMalformedKinds frames
//   bool PeerReceive(CanFrame&)     what the bus under test put on the wire, in order
//   void TakeDown(), BringUp()
//   void InjectBusOff(), InjectErrorState(CanBusState)
//   bool CanStall(), Stall(), Resume()   nobody acknowledges: what is handed over stays unconfirmed
//   bool Busy()                     a restart is under way in the real world, where there is one
//   void Settle()                   lets that world catch up
//
// Time is injected: it passes only in these tests' calls of Advance.

namespace hardpack {

constexpr uint64_t kMillisecond_ns = 1'000'000;
constexpr uint64_t kTick_ns = 10 * kMillisecond_ns;

inline CanFrame NumberedFrame(uint32_t number, uint32_t id = 0x202) {
  CanFrame frame;
  frame.id = id;
  frame.size = 8;
  for (int i = 0; i < 4; ++i) frame.data[i] = static_cast<uint8_t>(number >> (8 * i));
  return frame;
}

inline uint32_t NumberOf(const CanFrame& frame) {
  uint32_t number = 0;
  for (int i = 0; i < 4; ++i) number |= uint32_t{frame.data[i]} << (8 * i);
  return number;
}

template <typename Harness>
class CanBusConformance : public testing::Test {
 protected:
  void SetUp() override {
    if (harness_.unavailable() != nullptr) GTEST_SKIP() << harness_.unavailable();
    ASSERT_TRUE(Until([this] { return bus().state() == CanBusState::kActive; }));
  }

  CanBus& bus() { return harness_.bus(); }
  const CanBusCounters& counters() { return bus().counters(); }

  // Whatever is done in the real world is done within the tick that began it.
  void Tick() {
    harness_.Settle();
    now_ns_ += kTick_ns;
    bus().Advance(now_ns_);
    EXPECT_TRUE(Until([this] { return !harness_.Busy(); }));
  }

  // Advances without time passing until it is true, or for two seconds where those are real.
  bool Until(const std::function<bool()>& is_true) {
    for (int i = 0; i < 2000; ++i) {
      if (is_true()) return true;
      harness_.Settle();
      bus().Advance(now_ns_);
    }
    return is_true();
  }

  std::vector<CanFrame> ReceiveAll() {
    std::vector<CanFrame> frames;
    CanFrame frame;
    for (int i = 0; i < CanBus::kMaxFramesPerTick && IsUsable(bus().Receive(frame)); ++i) {
      frames.push_back(frame);
    }
    return frames;
  }

  // All that others sent, in however many ticks.
  std::vector<CanFrame> ReceiveInTicks(int ticks) {
    std::vector<CanFrame> frames;
    for (int i = 0; i < ticks; ++i) {
      Tick();
      for (const CanFrame& frame : ReceiveAll()) frames.push_back(frame);
    }
    return frames;
  }

  std::vector<uint32_t> NumbersOnTheBus() {
    std::vector<uint32_t> numbers;
    CanFrame frame;
    while (harness_.PeerReceive(frame)) numbers.push_back(NumberOf(frame));
    return numbers;
  }

  bool Recover() {
    for (int i = 0; i < 400 && bus().state() != CanBusState::kActive; ++i) Tick();
    return bus().state() == CanBusState::kActive;
  }

  Harness harness_;
  uint64_t now_ns_ = 1'000'000'000;
};

TYPED_TEST_SUITE_P(CanBusConformance);

TYPED_TEST_P(CanBusConformance, GivesFramesOfOthersAsTheyAreAndInOrder) {
  std::vector<CanFrame> sent;
  for (int size = 0; size <= kMaxCanData_bytes; ++size) {
    for (const bool extended : {false, true}) {
      for (const bool remote : {false, true}) {
        CanFrame frame;
        frame.id = extended ? 0x1ffffff0u + static_cast<uint32_t>(size)
                            : 0x7f0u + static_cast<uint32_t>(size);
        frame.extended = extended;
        frame.remote = remote;
        frame.size = static_cast<uint8_t>(size);
        for (int i = 0; !remote && i < size; ++i) frame.data[i] = static_cast<uint8_t>(200 + i);
        sent.push_back(frame);
        this->harness_.PeerSend(frame);
      }
    }
  }
  this->Tick();
  EXPECT_EQ(this->ReceiveAll(), sent);
  EXPECT_EQ(this->counters().received, sent.size());
  EXPECT_EQ(this->counters().lost, 0u);
}

TYPED_TEST_P(CanBusConformance, LeavesTheFrameAloneWhenThereIsNone) {
  this->Tick();
  CanFrame frame = NumberedFrame(77);
  EXPECT_EQ(this->bus().Receive(frame), Status::kEmpty);
  EXPECT_EQ(frame, NumberedFrame(77));
}

TYPED_TEST_P(CanBusConformance, PutsFramesOnTheBusAsTheyAreAndInOrder) {
  this->Tick();
  std::vector<CanFrame> sent;
  for (uint32_t i = 0; i < 12; ++i) {
    CanFrame frame = NumberedFrame(i);
    frame.extended = i % 3 == 1;
    frame.remote = i % 4 == 3;
    frame.size = static_cast<uint8_t>(i % 9);
    std::fill(frame.data + (frame.remote ? 0 : frame.size), frame.data + 8, uint8_t{0});
    sent.push_back(frame);
    ASSERT_EQ(this->bus().Send(frame, this->now_ns_ + kTick_ns), Status::kOk);
  }
  this->Tick();
  std::vector<CanFrame> seen;
  CanFrame frame;
  while (this->harness_.PeerReceive(frame)) seen.push_back(frame);
  EXPECT_EQ(seen, sent);
}

TYPED_TEST_P(CanBusConformance, CountsOwnFramesAndDoesNotGiveThem) {
  this->Tick();
  for (uint32_t i = 0; i < 10; ++i) {
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + kTick_ns), Status::kOk);
  }
  EXPECT_TRUE(this->Until([this] { return this->counters().confirmed == 10; }));
  EXPECT_TRUE(this->ReceiveAll().empty());
  EXPECT_EQ(this->counters().accepted, 10u);
  EXPECT_EQ(this->counters().received, 0u);
}

// The data behind a frame's size do not matter to a bus, nor those of a remote frame.
TYPED_TEST_P(CanBusConformance, ConfirmsFramesWithRubbishBehindTheirData) {
  this->Tick();
  CanFrame frame = NumberedFrame(0x01020304);
  frame.size = 2;
  ASSERT_EQ(this->bus().Send(frame, this->now_ns_ + kTick_ns), Status::kOk);
  frame.remote = true;
  ASSERT_EQ(this->bus().Send(frame, this->now_ns_ + kTick_ns), Status::kOk);
  EXPECT_TRUE(this->Until([this] { return this->counters().confirmed == 2; }));
}

TYPED_TEST_P(CanBusConformance, GivesAnothersFrameThatLooksLikeOurs) {
  this->Tick();
  ASSERT_EQ(this->bus().Send(NumberedFrame(5), this->now_ns_ + kTick_ns), Status::kOk);
  this->harness_.PeerSend(NumberedFrame(5));
  this->Tick();
  EXPECT_EQ(this->ReceiveAll(), std::vector<CanFrame>{NumberedFrame(5)});
  EXPECT_EQ(this->counters().confirmed, 1u);
}

TYPED_TEST_P(CanBusConformance, RefusesWhatNoBusCarries) {
  this->Tick();
  CanFrame standard = NumberedFrame(1, kMaxStandardCanId + 1);
  CanFrame extended = NumberedFrame(1, kMaxExtendedCanId + 1);
  extended.extended = true;
  CanFrame large = NumberedFrame(1);
  large.size = kMaxCanData_bytes + 1;
  for (const CanFrame& frame : {standard, extended, large}) {
    EXPECT_EQ(this->bus().Send(frame, this->now_ns_ + kTick_ns), Status::kInvalidArgument);
  }
  this->Tick();
  EXPECT_TRUE(this->NumbersOnTheBus().empty());
  EXPECT_EQ(this->counters().refused, 3u);
  EXPECT_EQ(this->counters().accepted, 0u);
}

TYPED_TEST_P(CanBusConformance, DoesNotGiveWhatNoBusCarries) {
  this->harness_.PeerSendMalformed();
  this->harness_.PeerSend(NumberedFrame(3));
  this->Tick();
  EXPECT_EQ(this->ReceiveAll(), std::vector<CanFrame>{NumberedFrame(3)});
  EXPECT_EQ(this->counters().malformed, uint64_t{TypeParam::kMalformedKinds});
}

// SR-DRV08
TYPED_TEST_P(CanBusConformance, RefusesWhatIsTooLate) {
  this->Tick();
  EXPECT_EQ(this->bus().Send(NumberedFrame(1), this->now_ns_ - 1), Status::kExpired);
  EXPECT_EQ(this->bus().Send(NumberedFrame(2), this->now_ns_), Status::kExpired);
  EXPECT_EQ(this->bus().Send(NumberedFrame(3), this->now_ns_ + 1), Status::kOk);
  this->Tick();
  EXPECT_EQ(this->NumbersOnTheBus(), std::vector<uint32_t>{3});
  EXPECT_EQ(this->counters().refused, 2u);
}

TYPED_TEST_P(CanBusConformance, DoesNotLetTimeRunBackwards) {
  this->Tick();
  this->bus().Advance(this->now_ns_ - 500 * kMillisecond_ns);
  EXPECT_EQ(this->bus().Send(NumberedFrame(1), this->now_ns_), Status::kExpired);
}

TYPED_TEST_P(CanBusConformance, TakesABurstInOneTick) {
  for (uint32_t i = 0; i < CanBus::kMaxFramesPerTick; ++i) {
    this->harness_.PeerSend(NumberedFrame(i));
  }
  this->Tick();
  const std::vector<CanFrame> frames = this->ReceiveAll();
  ASSERT_EQ(frames.size(), size_t{CanBus::kMaxFramesPerTick});
  for (uint32_t i = 0; i < frames.size(); ++i) EXPECT_EQ(NumberOf(frames[i]), i);
}

TYPED_TEST_P(CanBusConformance, KeepsWhatIsMoreThanATickTakes) {
  const uint32_t sent = 5 * CanBus::kMaxFramesPerTick / 2;
  for (uint32_t i = 0; i < sent; ++i) this->harness_.PeerSend(NumberedFrame(i));
  const std::vector<CanFrame> frames = this->ReceiveInTicks(3);
  ASSERT_EQ(frames.size(), sent);
  for (uint32_t i = 0; i < sent; ++i) EXPECT_EQ(NumberOf(frames[i]), i);
  EXPECT_EQ(this->counters().lost, 0u);
}

TYPED_TEST_P(CanBusConformance, CountsWhatIsLostForWantOfRoom) {
  const uint64_t sent = 6000;
  for (uint32_t i = 0; i < sent; ++i) this->harness_.PeerSend(NumberedFrame(i));
  size_t got = this->ReceiveInTicks(200).size();
  this->harness_.PeerSend(NumberedFrame(0));  // some learn of the loss by what comes after it
  got += this->ReceiveInTicks(1).size();
  EXPECT_GT(this->counters().lost, 0u) << "this many are to be more than anything holds";
  EXPECT_EQ(got + this->counters().lost, sent + 1);
  EXPECT_EQ(this->counters().received, got);
}

TYPED_TEST_P(CanBusConformance, SendsAgainAfterALoss) {
  for (uint32_t i = 0; i < 6000; ++i) this->harness_.PeerSend(NumberedFrame(i));
  this->NumbersOnTheBus();
  for (uint32_t i = 0; i < 300; ++i) {
    this->Tick();
    this->ReceiveAll();
    this->harness_.PeerSend(NumberedFrame(i));
  }
  for (uint32_t i = 0; i < 40; ++i) {
    this->Tick();
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + kTick_ns), Status::kOk);
  }
  this->Tick();
  EXPECT_EQ(this->NumbersOnTheBus().size(), 40u);
}

TYPED_TEST_P(CanBusConformance, SaysThatTheInterfaceIsDownAndComesBackWithIt) {
  this->harness_.TakeDown();
  ASSERT_TRUE(this->Until([this] { return this->bus().state() == CanBusState::kDown; }));
  EXPECT_EQ(this->bus().Send(NumberedFrame(1), this->now_ns_ + kTick_ns), Status::kInterfaceDown);
  CanFrame frame;
  EXPECT_EQ(this->bus().Receive(frame), Status::kEmpty);
  for (int i = 0; i < 10; ++i) this->Tick();
  EXPECT_EQ(this->bus().state(), CanBusState::kDown) << "it is not ours to bring up";

  this->harness_.BringUp();
  ASSERT_TRUE(this->Until([this] { return this->bus().state() == CanBusState::kActive; }));
  EXPECT_EQ(this->bus().Send(NumberedFrame(2), this->now_ns_ + kTick_ns), Status::kOk);
  this->harness_.PeerSend(NumberedFrame(3));
  this->Tick();
  EXPECT_EQ(this->NumbersOnTheBus(), std::vector<uint32_t>{2});
  EXPECT_EQ(this->ReceiveAll(), std::vector<CanFrame>{NumberedFrame(3)});
  EXPECT_EQ(this->counters().went_down, 1u);
  EXPECT_EQ(this->counters().restarts, 0u);
  EXPECT_EQ(this->counters().system_errors, 0u);
}

// SR-DRV07
TYPED_TEST_P(CanBusConformance, RecoversFromBusOff) {
  this->Tick();
  this->harness_.InjectBusOff();
  ASSERT_TRUE(this->Until([this] { return this->bus().state() == CanBusState::kBusOff; }));
  EXPECT_EQ(this->bus().Send(NumberedFrame(1), this->now_ns_ + kTick_ns), Status::kBusOff);
  EXPECT_EQ(this->counters().bus_offs, 1u);
  EXPECT_EQ(this->counters().error_frames, 1u);

  const uint64_t began_ns = this->now_ns_;
  ASSERT_TRUE(this->Recover());
  EXPECT_GE(this->now_ns_ - began_ns, 100 * kMillisecond_ns) << "the bus is not to be hammered";
  EXPECT_EQ(this->counters().restarts, 1u);
  EXPECT_EQ(this->counters().went_down, 0u);
  EXPECT_EQ(this->bus().Send(NumberedFrame(2), this->now_ns_ + kTick_ns), Status::kOk);
  this->harness_.PeerSend(NumberedFrame(3));
  this->Tick();
  EXPECT_EQ(this->NumbersOnTheBus(), std::vector<uint32_t>{2});
  EXPECT_EQ(this->ReceiveAll(), std::vector<CanFrame>{NumberedFrame(3)});
  EXPECT_EQ(this->counters().refused, 1u);
}

TYPED_TEST_P(CanBusConformance, FollowsTheErrorStates) {
  uint64_t told = 0;
  for (const CanBusState state : {CanBusState::kWarning, CanBusState::kPassive,
                                  CanBusState::kWarning, CanBusState::kActive}) {
    this->harness_.InjectErrorState(state);
    this->Tick();
    EXPECT_EQ(this->bus().state(), state);
    EXPECT_EQ(this->counters().error_frames, ++told);
    EXPECT_EQ(this->bus().Send(NumberedFrame(1), this->now_ns_ + kTick_ns), Status::kOk);
  }
  EXPECT_TRUE(this->ReceiveAll().empty()) << "an error frame is no node's";
}

// handed over, unconfirmed | waiting                     | refused
//      0 .. 15             | 16 .. 79                    | 80
TYPED_TEST_P(CanBusConformance, HandsOverFewAndLetsTheRestWait) {
  if (!this->harness_.CanStall()) GTEST_SKIP() << "this bus cannot be made to stall";
  this->Tick();
  this->harness_.Stall();
  const uint32_t room = CanBus::kMaxUnconfirmed + CanBus::kMaxWaiting;
  const uint64_t deadline_ns = this->now_ns_ + 2 * kTick_ns;
  for (uint32_t i = 0; i < room; ++i) {
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), deadline_ns), Status::kOk) << i;
  }
  EXPECT_EQ(this->bus().Send(NumberedFrame(room), deadline_ns), Status::kCapacityExceeded);
  EXPECT_TRUE(this->NumbersOnTheBus().empty());
  EXPECT_EQ(this->counters().confirmed, 0u);

  this->harness_.Resume();
  EXPECT_TRUE(this->Until([this] { return this->counters().confirmed == room; }));
  const std::vector<uint32_t> numbers = this->NumbersOnTheBus();
  ASSERT_EQ(numbers.size(), room);
  for (uint32_t i = 0; i < room; ++i) EXPECT_EQ(numbers[i], i);
  EXPECT_EQ(this->counters().refused, 1u);
  EXPECT_EQ(this->counters().expired, 0u);
}

// SR-DRV08
TYPED_TEST_P(CanBusConformance, DropsWhatWaitedPastItsDeadline) {
  if (!this->harness_.CanStall()) GTEST_SKIP() << "this bus cannot be made to stall";
  this->Tick();
  this->harness_.Stall();
  for (uint32_t i = 0; i < CanBus::kMaxUnconfirmed; ++i) {
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + kTick_ns), Status::kOk);
  }
  // Every other one may wait for longer.
  for (uint32_t i = 100; i < 110; ++i) {
    const uint64_t wait_ns = (i % 2 == 0 ? 1 : 3) * kTick_ns;
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + wait_ns), Status::kOk);
  }
  this->Tick();
  EXPECT_EQ(this->counters().expired, 5u);
  this->harness_.Resume();
  EXPECT_TRUE(
      this->Until([this] { return this->counters().confirmed == CanBus::kMaxUnconfirmed + 5; }));
  std::vector<uint32_t> numbers = this->NumbersOnTheBus();
  ASSERT_EQ(numbers.size(), size_t{CanBus::kMaxUnconfirmed + 5});
  numbers.erase(numbers.begin(), numbers.begin() + CanBus::kMaxUnconfirmed);
  EXPECT_EQ(numbers, (std::vector<uint32_t>{101, 103, 105, 107, 109}));
}

// SR-DRV08
TYPED_TEST_P(CanBusConformance, DropsWhatWasHandedOverAndHasGrownOld) {
  if (!this->harness_.CanStall()) GTEST_SKIP() << "this bus cannot be made to stall";
  this->Tick();
  this->harness_.Stall();
  for (uint32_t i = 0; i < 5; ++i) {
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + 2 * kTick_ns), Status::kOk);
  }
  for (int i = 0; i < 13; ++i) this->Tick();
  EXPECT_TRUE(this->Until([this] { return this->counters().restarts == 1; }));
  EXPECT_EQ(this->counters().expired, 5u);
  EXPECT_EQ(this->counters().went_down, 0u);
  this->harness_.Resume();
  this->Tick();
  EXPECT_TRUE(this->NumbersOnTheBus().empty());

  for (uint32_t i = 10; i < 60; ++i) {
    this->Tick();
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + kTick_ns), Status::kOk);
  }
  this->Tick();
  const std::vector<uint32_t> numbers = this->NumbersOnTheBus();
  ASSERT_FALSE(numbers.empty());
  EXPECT_GE(numbers.front(), 10u);
  EXPECT_EQ(numbers.back(), 59u);
}

// SR-DRV08
TYPED_TEST_P(CanBusConformance, SendsNothingOldAfterTheInterfaceWasDown) {
  if (!this->harness_.CanStall()) GTEST_SKIP() << "this bus cannot be made to stall";
  this->Tick();
  this->harness_.Stall();
  for (uint32_t i = 0; i < 40; ++i) {
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + 1000 * kTick_ns), Status::kOk);
  }
  this->harness_.TakeDown();
  ASSERT_TRUE(this->Until([this] { return this->bus().state() == CanBusState::kDown; }));
  EXPECT_EQ(this->counters().expired, 40u);
  this->harness_.BringUp();
  ASSERT_TRUE(this->Until([this] { return this->bus().state() == CanBusState::kActive; }));
  this->harness_.Resume();
  ASSERT_EQ(this->bus().Send(NumberedFrame(99), this->now_ns_ + kTick_ns), Status::kOk);
  this->Tick();
  EXPECT_EQ(this->NumbersOnTheBus(), std::vector<uint32_t>{99});
}

// SR-DRV08
TYPED_TEST_P(CanBusConformance, SendsNothingOldAfterBusOff) {
  if (!this->harness_.CanStall()) GTEST_SKIP() << "this bus cannot be made to stall";
  this->Tick();
  this->harness_.Stall();
  for (uint32_t i = 0; i < 40; ++i) {
    ASSERT_EQ(this->bus().Send(NumberedFrame(i), this->now_ns_ + 1000 * kTick_ns), Status::kOk);
  }
  this->harness_.InjectBusOff();
  ASSERT_TRUE(this->Until([this] { return this->bus().state() == CanBusState::kBusOff; }));
  EXPECT_EQ(this->counters().expired, 40u);
  ASSERT_TRUE(this->Recover());
  this->harness_.Resume();
  ASSERT_EQ(this->bus().Send(NumberedFrame(99), this->now_ns_ + kTick_ns), Status::kOk);
  this->Tick();
  EXPECT_EQ(this->NumbersOnTheBus(), std::vector<uint32_t>{99});
}

// Whatever happens: no frame is on the bus long after its deadline, they are in order, and the
// counters add up.
TYPED_TEST_P(CanBusConformance, KeepsItsPromisesThroughRandomFaults) {
  const bool can_stall = this->harness_.CanStall();
  for (const uint32_t seed : {1u, 2u}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const auto below = [&random](uint32_t n) { return static_cast<uint32_t>(random() % n); };
    const auto one_in = [&below](uint32_t n) { return below(n) == 0; };
    std::map<uint32_t, uint64_t> deadlines_ns;
    bool stalled = false;
    bool is_down = false;
    uint32_t last = 0;
    const auto judge = [&] {
      for (const uint32_t number : this->NumbersOnTheBus()) {
        ASSERT_TRUE(deadlines_ns.contains(number));
        EXPECT_LE(this->now_ns_, deadlines_ns[number] + 100 * kMillisecond_ns + 2 * kTick_ns);
        EXPECT_GT(number, last);
        last = number;
      }
    };
    for (uint32_t step = 1; step <= 300; ++step) {
      if (can_stall && one_in(30)) {
        stalled ? this->harness_.Resume() : this->harness_.Stall();
        stalled = !stalled;
      }
      if (one_in(100)) {
        is_down ? this->harness_.BringUp() : this->harness_.TakeDown();
        is_down = !is_down;
        this->Until([&] { return (this->bus().state() == CanBusState::kDown) == is_down; });
      }
      if (!is_down && one_in(100)) this->harness_.InjectBusOff();
      this->Tick();
      this->ReceiveAll();
      const uint32_t frames = below(6);
      for (uint32_t i = 0; i < frames; ++i) {
        const uint32_t number = seed * 10000 + step * 10 + i;
        deadlines_ns[number] = this->now_ns_ + (1 + below(3)) * kTick_ns;
        (void)this->bus().Send(NumberedFrame(number), deadlines_ns[number]);
      }
      judge();
    }
    if (stalled) this->harness_.Resume();
    if (is_down) this->harness_.BringUp();
    for (int i = 0; i < 30; ++i) {  // past every deadline, and every restart that it may take
      this->Tick();
      judge();
    }
    ASSERT_TRUE(this->Recover());
    EXPECT_TRUE(this->Until([this] {
      return this->counters().accepted == this->counters().confirmed + this->counters().expired;
    })) << this->counters().accepted
        << " " << this->counters().confirmed << " " << this->counters().expired;
  }
}

REGISTER_TYPED_TEST_SUITE_P(
    CanBusConformance, GivesFramesOfOthersAsTheyAreAndInOrder, LeavesTheFrameAloneWhenThereIsNone,
    PutsFramesOnTheBusAsTheyAreAndInOrder, CountsOwnFramesAndDoesNotGiveThem,
    ConfirmsFramesWithRubbishBehindTheirData, GivesAnothersFrameThatLooksLikeOurs,
    RefusesWhatNoBusCarries, DoesNotGiveWhatNoBusCarries, RefusesWhatIsTooLate,
    DoesNotLetTimeRunBackwards, TakesABurstInOneTick, KeepsWhatIsMoreThanATickTakes,
    CountsWhatIsLostForWantOfRoom, SendsAgainAfterALoss,
    SaysThatTheInterfaceIsDownAndComesBackWithIt, RecoversFromBusOff, FollowsTheErrorStates,
    HandsOverFewAndLetsTheRestWait, DropsWhatWaitedPastItsDeadline,
    DropsWhatWasHandedOverAndHasGrownOld, SendsNothingOldAfterTheInterfaceWasDown,
    SendsNothingOldAfterBusOff, KeepsItsPromisesThroughRandomFaults);

}  // namespace hardpack
