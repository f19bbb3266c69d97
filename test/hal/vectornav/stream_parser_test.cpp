// SPDX-License-Identifier: Apache-2.0
#include "hal/vectornav/stream_parser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "hal/vectornav/encode.h"
#include "test/hal/vectornav/vectornav_messages.h"

namespace hardpack::vectornav {
namespace {

using test::Bits;
using test::BitsOfAll;
using test::Bytes;
using test::Give;
using test::Line;
using test::MessageBuilder;
using test::NumberedMessage;

void Append(std::vector<uint8_t>& stream, const std::vector<uint8_t>& bytes) {
  stream.insert(stream.end(), bytes.begin(), bytes.end());
}

std::vector<uint8_t> InsLine(int n) {
  return Bytes(Line("VNINS,333811.902862,1694,0306,+0" + std::to_string(10 + n % 90) +
                    ".500,-004.750,-000.250,+32.95602815,-096.71424297,+00171.195,-000.840,"
                    "-000.396,-000.109,07.8,01.6,0.23"));
}

// After this many zeros nothing is waited for any more.
const std::vector<uint8_t> kSilence(kMaxMessageBytes, 0);

struct Outcome {
  std::vector<InsSample> samples;
  StreamCounters counters;
};

// The stream in datagrams of 1 .. largest bytes.
Outcome RunCut(std::span<const uint8_t> stream, size_t largest, std::mt19937& random) {
  Outcome outcome;
  const auto parser = std::make_unique<StreamParser>();
  while (!stream.empty()) {
    const size_t size = std::min<size_t>(stream.size(), 1 + random() % largest);
    Give(*parser, stream.first(size), outcome.samples);
    stream = stream.subspan(size);
  }
  outcome.counters = parser->counters();
  return outcome;
}

Outcome RunWhole(std::span<const uint8_t> stream) {
  Outcome outcome;
  const auto parser = std::make_unique<StreamParser>();
  Give(*parser, stream, outcome.samples);
  outcome.counters = parser->counters();
  return outcome;
}

// What the header says a message is, straight from there, on the whole stream.
std::vector<InsSample> Reference(std::span<const uint8_t> stream) {
  std::vector<InsSample> samples;
  while (!stream.empty()) {
    InsSample sample;
    size_t size = 0;
    Status status = Status::kUnsupported;
    if (stream[0] == 0xfa) status = BinaryMessageSize(stream, size);
    if (stream[0] == '$') status = AsciiMessageSize(stream, size);
    if (status == Status::kOk && size > stream.size()) status = Status::kTruncated;
    if (status == Status::kTruncated) break;
    if (status == Status::kOk) {
      const std::span<const uint8_t> message = stream.first(size);
      status = stream[0] == '$' ? DecodeAscii(message, sample) : DecodeBinary(message, sample);
      if (status == Status::kBadCrc) size = 1;
    }
    if (status == Status::kOk) samples.push_back(sample);
    stream = stream.subspan(std::max<size_t>(size, 1));
  }
  return samples;
}

// Counts add up, whatever came.
void CheckCounters(const Outcome& outcome, size_t fed) {
  const StreamCounters& c = outcome.counters;
  EXPECT_EQ(c.bytes, fed);
  EXPECT_EQ(c.samples, outcome.samples.size());
  EXPECT_EQ(c.samples + c.unused + c.not_finite + c.out_of_range,
            c.binary_messages + c.ascii_messages);
}

TEST(VectorNavStream, FindsMessagesOneAfterAnother) {
  std::vector<uint8_t> stream;
  for (uint32_t n = 0; n < 100; ++n) Append(stream, NumberedMessage(n));
  Append(stream, InsLine(1));
  const Outcome outcome = RunWhole(stream);
  ASSERT_EQ(outcome.samples.size(), 101u);
  for (uint32_t n = 0; n < 100; ++n) {
    InsSample alone;
    ASSERT_EQ(DecodeBinary(NumberedMessage(n), alone), Status::kOk);
    EXPECT_EQ(Bits(outcome.samples[n]), Bits(alone));
  }
  EXPECT_TRUE(outcome.samples[100].has_attitude_uncertainty);
  EXPECT_EQ(outcome.counters.skipped_bytes, 0u);
  EXPECT_EQ(outcome.counters.binary_messages, 100u);
  EXPECT_EQ(outcome.counters.ascii_messages, 1u);
  CheckCounters(outcome, stream.size());
}

TEST(VectorNavStream, TellsAMessageWithItsLastByte) {
  const std::vector<uint8_t> message = NumberedMessage(3);
  const auto parser = std::make_unique<StreamParser>();
  InsSample sample;
  for (size_t i = 0; i < message.size(); ++i) {
    ASSERT_EQ(parser->Next(sample), Status::kTruncated) << i;
    ASSERT_EQ(parser->Feed(std::span(message).subspan(i, 1)), 1u);
  }
  EXPECT_EQ(parser->Next(sample), Status::kOk);
  EXPECT_EQ(parser->Next(sample), Status::kTruncated);
}

// 0xFA 0x01 0xEB 0x10 and then, 20 bytes on, a message: the first four bytes promise 84.
TEST(VectorNavStream, FindsTheMessageThatBeginsInsideAFalseOne) {
  std::vector<uint8_t> stream = {0xfa, 0x01, 0xeb, 0x10};
  stream.resize(24, 0x33);
  Append(stream, NumberedMessage(1));
  Append(stream, NumberedMessage(2));
  const Outcome outcome = RunWhole(stream);
  ASSERT_EQ(outcome.samples.size(), 2u);
  EXPECT_EQ(outcome.samples[0].timestamp_ns, 5'000'000u);
  EXPECT_EQ(outcome.counters.bad_checksum, 1u);
  EXPECT_EQ(outcome.counters.skipped_bytes, 24u);
}

// $ of a text that was cut, and 0xFA right before the true one.
// SR-INP02
TEST(VectorNavStream, FindsTheMessageBehindHalfAMessage) {
  std::vector<uint8_t> stream = {'$', 'V', 'N', 'I', 'N', 'S', ',', '1', '2', 0xfa};
  Append(stream, NumberedMessage(1));
  Append(stream, {0xfa, 0x01});
  Append(stream, InsLine(5));
  Append(stream, {'$', 'V', 'N'});
  Append(stream, InsLine(6));
  Append(stream, kSilence);
  EXPECT_EQ(RunWhole(stream).samples.size(), 3u);
}

TEST(VectorNavStream, ALostDatagramCostsOnlyTheMessagesThatItTouched) {
  std::vector<uint8_t> stream;
  for (uint32_t n = 0; n < 40; ++n) Append(stream, NumberedMessage(n));
  // Bytes 1000 .. 1099 are of messages 11, 12 and 13 (of 84 bytes each).
  stream.erase(stream.begin() + 1000, stream.begin() + 1100);
  Append(stream, kSilence);
  const Outcome outcome = RunWhole(stream);
  ASSERT_EQ(outcome.samples.size(), 37u);
  EXPECT_EQ(outcome.samples[10].timestamp_ns, 10 * 5'000'000u);
  EXPECT_EQ(outcome.samples[11].timestamp_ns, 14 * 5'000'000u);
}

// SR-INP02
TEST(VectorNavStream, MessagesInNoiseAreAllFoundHoweverTheyAreCut) {
  for (uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<uint8_t> stream;
    std::string expected;
    // Noise with many beginnings: of every eight bytes one is 0xFA, one $ and one a group byte.
    const auto noise = [&random, &stream] {
      for (size_t i = random() % 200; i > 0; --i) {
        const uint32_t kind = static_cast<uint32_t>(random()) % 8;
        const auto byte = static_cast<uint8_t>(random());
        stream.push_back(kind == 0 ? 0xfa : kind == 1 ? '$' : kind == 2 ? byte & 0x7f : byte);
      }
    };
    for (uint32_t n = 0; n < 200; ++n) {
      noise();
      const std::vector<uint8_t> message =
          random() % 3 == 0 ? InsLine(static_cast<int>(n)) : NumberedMessage(n);
      InsSample sample;
      ASSERT_TRUE(IsUsable(DecodeBinary(message, sample)) ||
                  IsUsable(DecodeAscii(message, sample)));
      expected += Bits(sample) + "\n";
      Append(stream, message);
    }
    Append(stream, kSilence);
    const Outcome whole = RunWhole(stream);
    EXPECT_EQ(BitsOfAll(whole.samples), expected) << "seed " << seed;
    EXPECT_EQ(BitsOfAll(Reference(stream)), expected) << "seed " << seed;
    CheckCounters(whole, stream.size());
    for (const size_t largest : {1u, 3u, 90u, 700u, 20000u}) {
      const Outcome cut = RunCut(stream, largest, random);
      ASSERT_EQ(BitsOfAll(cut.samples), expected) << "seed " << seed << ", up to " << largest;
      ASSERT_EQ(test::Text(cut.counters), test::Text(whole.counters)) << "seed " << seed;
    }
  }
}

// Damage of every kind: what is found is what the definition says, however it is cut.
TEST(VectorNavStream, DamagedStreamsGiveWhatTheDefinitionSays) {
  for (uint32_t seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    std::vector<uint8_t> stream;
    for (uint32_t n = 0; n < 40; ++n) {
      Append(stream, n % 4 == 0 ? InsLine(static_cast<int>(n)) : NumberedMessage(n));
    }
    for (int i = 0; i < 10; ++i) {
      const auto place = static_cast<ptrdiff_t>(random() % (stream.size() - 100));
      const auto length = static_cast<ptrdiff_t>(random() % 100);
      const auto begin = stream.begin() + place;
      switch (random() % 3) {
        case 0:
          stream[static_cast<size_t>(place)] ^= static_cast<uint8_t>(1u << random() % 8);
          break;
        case 1:
          stream.erase(begin, begin + length);
          break;
        default: {
          const std::vector<uint8_t> again(begin, begin + length);
          stream.insert(begin, again.begin(), again.end());
        }
      }
    }
    const Outcome whole = RunWhole(stream);
    EXPECT_GT(whole.samples.size(), 10u);
    EXPECT_EQ(BitsOfAll(whole.samples), BitsOfAll(Reference(stream))) << "seed " << seed;
    const Outcome cut = RunCut(stream, 120, random);
    EXPECT_EQ(BitsOfAll(cut.samples), BitsOfAll(whole.samples)) << "seed " << seed;
    EXPECT_EQ(test::Text(cut.counters), test::Text(whole.counters)) << "seed " << seed;
  }
}

// SR-INP02
TEST(VectorNavStream, NoTruncationGivesASample) {
  for (const std::vector<uint8_t>& message : {NumberedMessage(9), InsLine(9)}) {
    for (size_t size = 0; size < message.size(); ++size) {
      std::vector<uint8_t> stream(message.begin(), message.begin() + static_cast<ptrdiff_t>(size));
      ASSERT_EQ(RunWhole(stream).samples.size(), 0u) << size;
      Append(stream, kSilence);
      ASSERT_EQ(RunWhole(stream).samples.size(), 0u) << size;
    }
  }
}

// SR-INP02
TEST(VectorNavStream, NoFlippedBitGivesASample) {
  for (const std::vector<uint8_t>& message : {NumberedMessage(9), InsLine(9)}) {
    for (size_t bit = 0; bit < 8 * message.size(); ++bit) {
      std::vector<uint8_t> stream = message;
      stream[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
      Append(stream, kSilence);
      ASSERT_EQ(RunWhole(stream).samples.size(), 0u) << bit;
    }
  }
}

TEST(VectorNavStream, CountsWhatItDoesNotTell) {
  std::vector<uint8_t> stream;
  test::Common bad;
  bad.rate_radps[0] = std::numeric_limits<float>::quiet_NaN();
  Append(stream, test::CommonMessage(bad));
  bad.rate_radps[0] = 0.0f;
  bad.latitude_deg = 91.0;
  Append(stream, test::CommonMessage(bad));
  Append(stream, MessageBuilder(0x01, {0x0010}).Filler(16, 0).Build());  // a quaternion
  Append(stream, Bytes(Line("VNYPR,+010.000,+001.000,-002.000")));
  Append(stream, Bytes("$VNYPR,+010.000,+001.000,-002.000*00\r\n"));
  Append(stream, {0xfa, 0x81, 0x01});
  Append(stream, Bytes("\r\n"));
  const StreamCounters counters = RunWhole(stream).counters;
  EXPECT_EQ(counters.samples, 0u);
  EXPECT_EQ(counters.not_finite, 1u);
  EXPECT_EQ(counters.out_of_range, 1u);
  EXPECT_EQ(counters.unused, 2u);
  EXPECT_EQ(counters.binary_messages, 3u);
  EXPECT_EQ(counters.ascii_messages, 1u);
  EXPECT_EQ(counters.bad_checksum, 1u);
  EXPECT_EQ(counters.unsupported, 1u);
  EXPECT_EQ(counters.skipped_bytes, 38u + 3u + 2u);
}

TEST(VectorNavStream, TheLongestMessageGoesThroughInAnyPieces) {
  const size_t payload = kMaxBinaryBytes - 2 - 14 - 2;
  const std::vector<uint8_t> message =
      MessageBuilder(0x7f, {0x7fff, 0x03ff, 0x1fff, 0x3fff, 0x1fff, 0x1fff, 0x3fff})
          .Filler(payload, 0)
          .Build();
  std::vector<uint8_t> stream;
  for (int i = 0; i < 10; ++i) Append(stream, message);
  std::mt19937 random(4);
  for (const size_t largest : {1u, 100u, 1472u, 65507u}) {
    EXPECT_EQ(RunCut(stream, largest, random).samples.size(), 10u) << largest;
  }
}

// A beginning that promises 1175 bytes at every place where one can stand.
TEST(VectorNavStream, TakesAnEthernetDatagramWholeWhateverWaits) {
  const std::vector<uint8_t> header = {0xfa, 0x7f, 0xff, 0x7f, 0xff, 0x03, 0xff, 0x1f,
                                       0xff, 0x3f, 0xff, 0x1f, 0xff, 0x1f, 0xff, 0x3f};
  std::vector<uint8_t> stream;
  for (int i = 0; i < 1000; ++i) Append(stream, header);
  const auto parser = std::make_unique<StreamParser>();
  InsSample sample;
  for (size_t at = 0; at + StreamParser::kFeedBytes <= stream.size();) {
    ASSERT_EQ(parser->Next(sample), Status::kTruncated);
    ASSERT_EQ(parser->Feed(std::span(stream).subspan(at, StreamParser::kFeedBytes)),
              StreamParser::kFeedBytes);
    at += StreamParser::kFeedBytes;
  }
}

TEST(VectorNavStream, FeedTakesNoMoreThanThereIsRoomFor) {
  std::vector<uint8_t> stream;
  for (uint32_t n = 0; n < 100; ++n) Append(stream, NumberedMessage(n));
  const auto parser = std::make_unique<StreamParser>();
  InsSample sample;
  std::span<const uint8_t> rest(stream);
  rest = rest.subspan(parser->Feed(rest));
  EXPECT_EQ(parser->Feed(rest), 0u);
  ASSERT_EQ(parser->Next(sample), Status::kOk);
  EXPECT_EQ(parser->Feed(rest), 84u);
  rest = rest.subspan(84);
  size_t found = 1;
  while (IsUsable(parser->Next(sample))) ++found;
  std::vector<InsSample> others;
  Give(*parser, rest, others);
  EXPECT_EQ(found + others.size(), 100u);
}

TEST(VectorNavStream, ResetForgetsTheHalfMessage) {
  const std::vector<uint8_t> message = NumberedMessage(1);
  const auto parser = std::make_unique<StreamParser>();
  std::vector<InsSample> samples;
  Give(*parser, std::span(message).first(50), samples);
  parser->Reset();
  EXPECT_EQ(parser->counters().skipped_bytes, 50u);
  Give(*parser, std::span(message).subspan(50), samples);
  EXPECT_EQ(samples.size(), 0u);
  Give(*parser, message, samples);
  EXPECT_EQ(samples.size(), 1u);
}

}  // namespace
}  // namespace hardpack::vectornav
