// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "hal/onboard/control/operator_link.h"

// What every OperatorLink has to do (hal/onboard/control/operator_link.h). A Harness has one, open:
//
//   OperatorLink& link()
//   size_t Connect()                   a client that may command
//   void Say(size_t client, bytes)
//   bytes Read(size_t client)          the oldest answer; empty: none
//   void Leave(size_t client)

namespace hardpack {

template <typename Harness>
class OperatorLinkConformance : public testing::Test {
 protected:
  using Bytes = std::vector<uint8_t>;

  static Bytes Encoded(control::Kind kind, uint32_t sequence) {
    Bytes bytes(control::kMaxMessageBytes);
    int size_bytes = 0;
    if (control::IsQuestion(kind)) {
      EXPECT_TRUE(
          IsUsable(control::Encode(control::Question{kind, sequence, 0}, bytes, size_bytes)));
    } else {
      control::OperatorCommand command;
      command.kind = kind;
      command.sequence = sequence;
      EXPECT_TRUE(IsUsable(control::Encode(command, bytes, size_bytes)));
    }
    bytes.resize(static_cast<size_t>(size_bytes));
    return bytes;
  }
  static Bytes Done(uint32_t sequence) {
    Bytes bytes(control::kMaxMessageBytes);
    int size_bytes = 0;
    EXPECT_TRUE(
        IsUsable(control::Encode(control::Done{sequence, Status::kOk, 0}, bytes, size_bytes)));
    bytes.resize(static_cast<size_t>(size_bytes));
    return bytes;
  }
  Status AnswerTo(size_t client) {
    control::Done done;
    const Bytes bytes = harness_.Read(client);
    if (bytes.empty() || !IsUsable(control::Decode(bytes, done))) return Status::kEmpty;
    return done.status;
  }
  OperatorLink& link() { return harness_.link(); }

  Harness harness_;
};
TYPED_TEST_SUITE_P(OperatorLinkConformance);

TYPED_TEST_P(OperatorLinkConformance, GivesNothingWhereNothingWasSaid) {
  this->harness_.Connect();
  ControlMessage message;
  message.user = 77;
  EXPECT_FALSE(this->link().Receive(message));
  EXPECT_EQ(message.user, 77u);
  EXPECT_EQ(message.client.place, -1);
}

TYPED_TEST_P(OperatorLinkConformance, GivesMessagesWholeAndInOrderAndAnswersWhoAsked) {
  const size_t other = this->harness_.Connect();
  const size_t client = this->harness_.Connect();
  const auto arm = this->Encoded(control::Kind::kArm, 5);
  const auto question = this->Encoded(control::Kind::kGetStatus, 6);
  this->harness_.Say(client, arm);
  this->harness_.Say(client, question);
  for (const auto& [said, sequence] : {std::pair(arm, 5u), std::pair(question, 6u)}) {
    ControlMessage message;
    ASSERT_TRUE(this->link().Receive(message));
    EXPECT_EQ(std::vector<uint8_t>(message.bytes.begin(), message.bytes.end()), said);
    EXPECT_EQ(message.header.sequence, sequence);
    const auto answer = this->Done(sequence);
    this->link().Answer(message.client, answer);
    EXPECT_EQ(this->harness_.Read(client), answer);
  }
  EXPECT_TRUE(this->harness_.Read(other).empty());
  EXPECT_EQ(this->link().counters().messages, 2u);
}

TYPED_TEST_P(OperatorLinkConformance, TakesClientsInTurn) {
  const size_t first = this->harness_.Connect();
  const size_t second = this->harness_.Connect();
  for (uint32_t i = 0; i < 3; ++i) {
    this->harness_.Say(first, this->Encoded(control::Kind::kAlive, 10 + i));
    this->harness_.Say(second, this->Encoded(control::Kind::kAlive, 20 + i));
  }
  std::vector<uint32_t> given;
  ControlMessage message;
  while (this->link().Receive(message)) given.push_back(message.header.sequence);
  EXPECT_EQ(given, (std::vector<uint32_t>{10, 20, 11, 21, 12, 22}));
}

// None of them is given; the next one is.
TYPED_TEST_P(OperatorLinkConformance, AnswersWhatIsNoMessageAndGoesOn) {
  const size_t client = this->harness_.Connect();
  const auto good = this->Encoded(control::Kind::kStop, 9);
  auto foreign = good;
  foreign[0] = 'X';
  auto short_one = good;
  short_one.pop_back();
  ControlMessage message;
  for (const auto& bytes : {foreign, short_one, this->Done(3)}) {
    this->harness_.Say(client, bytes);
    EXPECT_FALSE(this->link().Receive(message));
    const Status answer = this->AnswerTo(client);
    EXPECT_FALSE(IsUsable(answer));
    EXPECT_NE(answer, Status::kEmpty);
  }
  EXPECT_EQ(this->link().counters().malformed, 3u);
  this->harness_.Say(client, good);
  ASSERT_TRUE(this->link().Receive(message));
  EXPECT_EQ(message.header.kind, control::Kind::kStop);
}

// Nor does who comes after it, even in its place.
TYPED_TEST_P(OperatorLinkConformance, WhoHasGoneGetsNoAnswer) {
  const size_t client = this->harness_.Connect();
  this->harness_.Say(client, this->Encoded(control::Kind::kArm, 1));
  ControlMessage message;
  ASSERT_TRUE(this->link().Receive(message));
  const ControlClient asked = message.client;
  this->harness_.Leave(client);
  EXPECT_FALSE(this->link().Receive(message));
  const size_t successor = this->harness_.Connect();
  EXPECT_FALSE(this->link().Receive(message));
  this->link().Answer(asked, this->Done(1));
  this->link().Answer(ControlClient{}, this->Done(1));
  EXPECT_TRUE(this->harness_.Read(successor).empty());
}

REGISTER_TYPED_TEST_SUITE_P(OperatorLinkConformance, GivesNothingWhereNothingWasSaid,
                            GivesMessagesWholeAndInOrderAndAnswersWhoAsked, TakesClientsInTurn,
                            AnswersWhatIsNoMessageAndGoesOn, WhoHasGoneGetsNoAnswer);

}  // namespace hardpack
