// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <span>
#include <vector>

#include "hal/datagram_socket.h"

// What every DatagramSocket has to do (hal/datagram_socket.h). A Harness has one socket and its
// senders; what they send is there to be received when the call returns:
//
//   DatagramSocket& socket()
//   void Send(bytes)            from the configured sender
//   void SendForeign(bytes)     from another one
//   bool SendOversized()        from the configured sender, more than kMaxDatagram_bytes; false:
//                               that cannot be sent here
//   uint32_t sender_address(), uint16_t sender_port()

namespace hardpack {

inline std::vector<uint8_t> Bytes(size_t size, uint8_t first) {
  std::vector<uint8_t> bytes(size);
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<uint8_t>(first + 31 * i);
  return bytes;
}

inline std::vector<uint8_t> BytesOf(const Datagram& datagram) {
  return {datagram.bytes.begin(), datagram.bytes.end()};
}

template <typename Harness>
class DatagramSocketConformance : public testing::Test {
 protected:
  DatagramSocket& socket() { return harness_.socket(); }
  const DatagramCounters& counters() { return socket().counters(); }

  Harness harness_;
};

TYPED_TEST_SUITE_P(DatagramSocketConformance);

TYPED_TEST_P(DatagramSocketConformance, GivesNothingWhenNothingHasCome) {
  EXPECT_TRUE(this->socket().Receive(DatagramSocket::kMaxBatch).empty());
  EXPECT_EQ(this->counters().received, 0u);
  EXPECT_EQ(this->counters().system_errors, 0u);
}

TYPED_TEST_P(DatagramSocketConformance, GivesWhatHasComeInOrder) {
  std::vector<std::vector<uint8_t>> sent;
  uint64_t bytes = 0;
  for (uint8_t i = 0; i < 10; ++i) {
    sent.push_back(Bytes(100u * i + 1, i));
    bytes += sent.back().size();
    this->harness_.Send(sent.back());
  }
  const std::span<const Datagram> got = this->socket().Receive(DatagramSocket::kMaxBatch);
  ASSERT_EQ(got.size(), sent.size());
  for (size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(BytesOf(got[i]), sent[i]);
    EXPECT_EQ(got[i].sender_address, this->harness_.sender_address());
    EXPECT_EQ(got[i].sender_port, this->harness_.sender_port());
  }
  EXPECT_EQ(this->counters().received, 10u);
  EXPECT_EQ(this->counters().received_bytes, bytes);
  EXPECT_TRUE(this->socket().Receive(DatagramSocket::kMaxBatch).empty());
}

TYPED_TEST_P(DatagramSocketConformance, GivesAFullBatchAndKeepsTheRest) {
  for (uint8_t i = 0; i < 40; ++i) this->harness_.Send(Bytes(8, i));
  std::span<const Datagram> got = this->socket().Receive(DatagramSocket::kMaxBatch);
  ASSERT_EQ(got.size(), size_t{DatagramSocket::kMaxBatch});
  EXPECT_EQ(BytesOf(got[31]), Bytes(8, 31));
  got = this->socket().Receive(DatagramSocket::kMaxBatch);
  ASSERT_EQ(got.size(), 8u);
  EXPECT_EQ(BytesOf(got[0]), Bytes(8, 32));
}

TYPED_TEST_P(DatagramSocketConformance, GivesNoMoreThanIsAskedFor) {
  for (uint8_t i = 0; i < 40; ++i) this->harness_.Send(Bytes(8, i));
  EXPECT_TRUE(this->socket().Receive(0).empty());
  EXPECT_TRUE(this->socket().Receive(-1).empty());
  EXPECT_EQ(this->socket().Receive(1).size(), 1u);
  EXPECT_EQ(this->socket().Receive(3).size(), 3u);
  EXPECT_EQ(this->socket().Receive(1000).size(), size_t{DatagramSocket::kMaxBatch});
  EXPECT_EQ(this->socket().Receive(1000).size(), 4u);
}

TYPED_TEST_P(DatagramSocketConformance, GivesTheLargestAndTheEmptyDatagram) {
  this->harness_.Send(Bytes(kMaxDatagram_bytes, 7));
  this->harness_.Send({});
  this->harness_.Send(Bytes(1, 9));
  const std::span<const Datagram> got = this->socket().Receive(DatagramSocket::kMaxBatch);
  ASSERT_EQ(got.size(), 3u);
  EXPECT_EQ(BytesOf(got[0]), Bytes(kMaxDatagram_bytes, 7));
  EXPECT_TRUE(got[1].bytes.empty());
  EXPECT_EQ(BytesOf(got[2]), Bytes(1, 9));
  EXPECT_EQ(this->counters().oversized, 0u);
}

TYPED_TEST_P(DatagramSocketConformance, DropsAndCountsWhatIsTooLarge) {
  if (!this->harness_.SendOversized()) GTEST_SKIP() << "cannot be sent here";
  this->harness_.Send(Bytes(4, 1));
  const std::span<const Datagram> got = this->socket().Receive(DatagramSocket::kMaxBatch);
  ASSERT_EQ(got.size(), 1u);
  EXPECT_EQ(BytesOf(got[0]), Bytes(4, 1));
  EXPECT_EQ(this->counters().oversized, 1u);
  EXPECT_EQ(this->counters().received, 1u);
}

// SR-INP05
TYPED_TEST_P(DatagramSocketConformance, DropsAndCountsWhatOthersSend) {
  this->harness_.SendForeign(Bytes(20, 1));
  this->harness_.Send(Bytes(21, 2));
  this->harness_.SendForeign(Bytes(22, 3));
  this->harness_.SendForeign({});
  this->harness_.Send(Bytes(23, 4));
  const std::span<const Datagram> got = this->socket().Receive(DatagramSocket::kMaxBatch);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(BytesOf(got[0]), Bytes(21, 2));
  EXPECT_EQ(BytesOf(got[1]), Bytes(23, 4));
  EXPECT_EQ(this->counters().foreign, 3u);
  EXPECT_EQ(this->counters().received_bytes, 44u);
}

// A flood costs its share of a batch, and no more.
TYPED_TEST_P(DatagramSocketConformance, CountsForeignOnesAmongTheBatch) {
  for (int i = 0; i < 5; ++i) this->harness_.SendForeign(Bytes(8, 1));
  this->harness_.Send(Bytes(8, 2));
  EXPECT_TRUE(this->socket().Receive(5).empty());
  EXPECT_EQ(this->counters().foreign, 5u);
  EXPECT_EQ(this->socket().Receive(5).size(), 1u);
}

TYPED_TEST_P(DatagramSocketConformance, CountsWhatIsLostForWantOfRoom) {
  const uint64_t sent = 4000;
  for (uint64_t i = 0; i < sent; ++i) this->harness_.Send(Bytes(12600, 5));
  uint64_t got = 0;
  for (size_t size = 1; size > 0;) {
    size = this->socket().Receive(DatagramSocket::kMaxBatch).size();
    got += size;
  }
  this->harness_.Send(Bytes(4, 1));  // some learn of the loss by what comes after it
  got += this->socket().Receive(DatagramSocket::kMaxBatch).size();
  EXPECT_GT(this->counters().lost_in_kernel, 0u) << "this many are to be more than anything holds";
  EXPECT_EQ(got + this->counters().lost_in_kernel, sent + 1);
  EXPECT_EQ(this->counters().received, got);
}

TYPED_TEST_P(DatagramSocketConformance, SaysHowLargeItsBufferIs) {
  EXPECT_GE(this->counters().receive_buffer_bytes, 16u * 1024);
}

TYPED_TEST_P(DatagramSocketConformance, GivesTheSameThroughAnyBatches) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::vector<std::vector<uint8_t>> sent;
    std::vector<std::vector<uint8_t>> got;
    for (int round = 0; round < 40; ++round) {
      for (size_t i = random() % 6; i > 0; --i) {
        std::vector<uint8_t> bytes = Bytes(random() % 3000, static_cast<uint8_t>(random()));
        if (random() % 4 == 0) {
          this->harness_.SendForeign(bytes);
        } else {
          this->harness_.Send(bytes);
          sent.push_back(std::move(bytes));
        }
      }
      const int max = static_cast<int>(random() % 8);
      for (const Datagram& one : this->socket().Receive(max)) got.push_back(BytesOf(one));
    }
    for (int i = 0; i < 20; ++i) {
      for (const Datagram& one : this->socket().Receive(32)) got.push_back(BytesOf(one));
    }
    EXPECT_EQ(got, sent);
  }
}

REGISTER_TYPED_TEST_SUITE_P(DatagramSocketConformance, GivesNothingWhenNothingHasCome,
                            GivesWhatHasComeInOrder, GivesAFullBatchAndKeepsTheRest,
                            GivesNoMoreThanIsAskedFor, GivesTheLargestAndTheEmptyDatagram,
                            DropsAndCountsWhatIsTooLarge, DropsAndCountsWhatOthersSend,
                            CountsForeignOnesAmongTheBatch, CountsWhatIsLostForWantOfRoom,
                            SaysHowLargeItsBufferIs, GivesTheSameThroughAnyBatches);

}  // namespace hardpack
