// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/sdo_client.h"

#include <gtest/gtest.h>

#include <vector>

namespace hardpack::sevcon {
namespace {

constexpr uint64_t kTimeout_ns = 100;
constexpr SdoQuestion kRead = {0x1017, 0, 2, false, 0};
constexpr SdoQuestion kWrite = {0x1017, 0, 2, true, 100};

CanFrame Answer(int command, int index, int subindex, uint32_t value) {
  CanFrame frame;
  frame.id = 0x582;
  frame.size = 8;
  frame.data[0] = static_cast<uint8_t>(command);
  PutLittleEndian(frame, 1, 2, static_cast<uint32_t>(index));
  frame.data[3] = static_cast<uint8_t>(subindex);
  PutLittleEndian(frame, 4, 4, value);
  return frame;
}

class Client : public ::testing::Test {
 protected:
  bool Send(uint64_t now_ns) { return client.Send(now_ns, 2, kTimeout_ns, frame); }

  SdoClient client;
  CanFrame frame;
};

TEST_F(Client, AsksOnceAndTakesTheAnswer) {
  EXPECT_FALSE(Send(0));
  client.Ask(kRead, 3);
  ASSERT_TRUE(Send(10));
  EXPECT_EQ(frame, SdoQuestionFrame(2, kRead));
  EXPECT_FALSE(Send(20));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kNone);
  EXPECT_TRUE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 500)));
  EXPECT_TRUE(client.busy());
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kDone);
  EXPECT_EQ(client.value(), 500u);
  EXPECT_FALSE(client.busy());
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kNone);
}

TEST_F(Client, AsksAgainSoOftenAndGivesUp) {
  client.Ask(kRead, 2);
  std::vector<uint64_t> sent;
  for (uint64_t now_ns = 0; now_ns < 1000; now_ns += 10) {
    if (Send(now_ns)) sent.push_back(now_ns);
  }
  EXPECT_EQ(sent, (std::vector<uint64_t>{0, 100, 200}));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kTimedOut);
  EXPECT_EQ(client.timeouts(), 3u);
}

TEST_F(Client, KeepsItsTimeAcrossEveryWrapOf32Bits) {
  for (const uint64_t start_ns : {0xffff'ffb0ull, 0xffff'ffff'ffff'ffb0ull}) {
    SdoClient other;
    other.Ask(kRead, 0);
    EXPECT_TRUE(other.Send(start_ns, 2, kTimeout_ns, frame));
    EXPECT_FALSE(other.Send(start_ns + 99, 2, kTimeout_ns, frame));
    EXPECT_EQ(other.TakeOutcome(), SdoOutcome::kNone);
    EXPECT_FALSE(other.Send(start_ns + 100, 2, kTimeout_ns, frame));
    EXPECT_EQ(other.TakeOutcome(), SdoOutcome::kTimedOut);
  }
}

TEST_F(Client, CountsWhatItDoesNotWaitForAndIgnoresIt) {
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 1)));  // nothing asked
  client.Ask(kRead, 0);
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 1)));  // not sent yet
  ASSERT_TRUE(Send(0));
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1018, 0, 1)));  // another object
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1017, 1, 1)));
  EXPECT_FALSE(client.TakeAnswer(Answer(0x43, 0x1017, 0, 1)));  // of another size
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4f, 0x1017, 0, 1)));
  EXPECT_FALSE(client.TakeAnswer(Answer(0x60, 0x1017, 0, 1)));  // to a writing
  EXPECT_FALSE(client.TakeAnswer(Answer(0x41, 0x1017, 0, 1)));  // in segments
  EXPECT_FALSE(client.TakeAnswer(Answer(0x80, 0x1018, 0, 1)));  // refuses another
  EXPECT_TRUE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 7)));
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 8)));  // twice
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kDone);
  EXPECT_EQ(client.value(), 7u);
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 8)));  // late
  EXPECT_EQ(client.ignored(), 11u);
}

TEST_F(Client, TakesAnAnswerThatDoesNotTellItsSize) {
  client.Ask(kRead, 0);
  ASSERT_TRUE(Send(0));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x42, 0x1017, 0, 0x123401f4)));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kDone);
  EXPECT_EQ(client.value(), 0x01f4u);
}

TEST_F(Client, WritesAndTakesItsReceipt) {
  client.Ask(kWrite, 0);
  ASSERT_TRUE(Send(0));
  EXPECT_EQ(frame, SdoQuestionFrame(2, kWrite));
  EXPECT_FALSE(client.TakeAnswer(Answer(0x4b, 0x1017, 0, 100)));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x60, 0x1017, 0, 0)));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kDone);
}

TEST_F(Client, AsksForTheReasonOfAGenericAbort) {
  client.Ask(kWrite, 1);
  ASSERT_TRUE(Send(0));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x80, 0x1017, 0, 0x08000000)));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kNone);
  ASSERT_TRUE(Send(10));
  EXPECT_EQ(frame, SdoQuestionFrame(2, {0x5310, 0, 2, false, 0}));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x4b, 0x5310, 0, 4)));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kAborted);
  EXPECT_EQ(client.abort_code(), 0x08000000u);
  EXPECT_EQ(client.abort_reason(), 4);
  EXPECT_EQ(client.question().index, 0x1017);
  EXPECT_EQ(client.aborts(), 1u);
}

TEST_F(Client, EndsTooWhereTheReasonIsNotToBeHad) {
  client.Ask(kWrite, 1);
  ASSERT_TRUE(Send(0));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x80, 0x1017, 0, 0x08000000)));
  ASSERT_TRUE(Send(10));
  ASSERT_TRUE(Send(110));
  EXPECT_FALSE(Send(210));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kAborted);
  EXPECT_EQ(client.abort_reason(), 0);

  client.Ask(kWrite, 1);
  ASSERT_TRUE(Send(300));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x80, 0x1017, 0, 0x08000000)));
  ASSERT_TRUE(Send(310));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x80, 0x5310, 0, 0x08000000)));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kAborted);
}

TEST_F(Client, AnyOtherAbortEndsItAtOnce) {
  client.Ask(kRead, 3);
  ASSERT_TRUE(Send(0));
  EXPECT_TRUE(client.TakeAnswer(Answer(0x80, 0x1017, 0, 0x06020000)));
  EXPECT_EQ(client.TakeOutcome(), SdoOutcome::kAborted);
  EXPECT_EQ(client.abort_code(), 0x06020000u);
}

}  // namespace
}  // namespace hardpack::sevcon
