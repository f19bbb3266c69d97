// SPDX-License-Identifier: Apache-2.0
#include "port_linux/can_send_queue.h"

#include <gtest/gtest.h>

namespace hardpack {
namespace {

CanFrame Frame(uint8_t number) {
  CanFrame frame;
  frame.id = 0x202;
  frame.size = 1;
  frame.data[0] = number;
  return frame;
}

TEST(CanSendQueue, ConfirmsTheOldestOfLikeFrames) {
  CanSendQueue queue;
  ASSERT_EQ(queue.Add(Frame(1), 10), Status::kOk);
  ASSERT_EQ(queue.Add(Frame(1), 1000), Status::kOk);
  queue.HandedOver();
  queue.HandedOver();
  EXPECT_TRUE(queue.Confirm(Frame(1)));
  EXPECT_FALSE(queue.IsStale(11 + CanSendQueue::kStaleAfter_ns));
  EXPECT_TRUE(queue.IsStale(1001 + CanSendQueue::kStaleAfter_ns));
  EXPECT_TRUE(queue.Confirm(Frame(1)));
  EXPECT_FALSE(queue.Confirm(Frame(1)));
}

TEST(CanSendQueue, ConfirmsInAnyOrder) {
  CanSendQueue queue;
  for (uint8_t i = 0; i < 3; ++i) {
    ASSERT_EQ(queue.Add(Frame(i), 10), Status::kOk);
    queue.HandedOver();
  }
  EXPECT_TRUE(queue.Confirm(Frame(1)));
  EXPECT_FALSE(queue.Confirm(Frame(7)));
  EXPECT_TRUE(queue.Confirm(Frame(2)));
  EXPECT_TRUE(queue.Confirm(Frame(0)));
  EXPECT_EQ(queue.unconfirmed(), 0);
}

TEST(CanSendQueue, DoesNotCallAFrameWithoutDeadlineStale) {
  CanSendQueue queue;
  ASSERT_EQ(queue.Add(Frame(1), UINT64_MAX), Status::kOk);
  queue.HandedOver();
  EXPECT_FALSE(queue.IsStale(UINT64_MAX - 1));
}

// SR-DRV08
TEST(CanSendQueue, KeepsTheOrderOfWhatHasNotExpired) {
  CanSendQueue queue;
  for (uint8_t i = 0; i < 6; ++i) {
    ASSERT_EQ(queue.Add(Frame(i), i % 2 == 0 ? 10 : 20), Status::kOk);
  }
  EXPECT_EQ(queue.DropExpired(10), 3);
  EXPECT_EQ(queue.waiting(), 3);
  for (const uint8_t expected : {uint8_t{1}, uint8_t{3}, uint8_t{5}}) {
    EXPECT_EQ(queue.next(), Frame(expected));
    queue.DropNext();
  }
}

}  // namespace
}  // namespace hardpack
