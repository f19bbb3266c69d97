// SPDX-License-Identifier: Apache-2.0
#include "core/base/decision_hash.h"

#include <limits>
#include <string_view>

#include "gtest/gtest.h"
#include "test/core/base/broken_assumption.h"

namespace hardpack {
namespace {

uint64_t HashOf(std::string_view text) {
  DecisionHash hash;
  for (const char letter : text) hash.AddU8(static_cast<uint8_t>(letter));
  return hash.value();
}

// From the test vectors that the hash's author, L. C. Noll, publishes with it.
TEST(DecisionHash, IsFnv1a) {
  EXPECT_EQ(HashOf(""), 0xcbf29ce484222325u);
  EXPECT_EQ(HashOf("a"), 0xaf63dc4c8601ec8cu);
  EXPECT_EQ(HashOf("foobar"), 0x85944171f73967e8u);
}

TEST(DecisionHash, TakesNumbersInLittleEndianOrder) {
  DecisionHash numbers;
  numbers.AddU32(0x64636261u);
  numbers.AddU64(0x6c6b6a6968676665u);
  EXPECT_EQ(numbers.value(), HashOf("abcdefghijkl"));

  DecisionHash negative;
  negative.AddI32(-2);
  EXPECT_EQ(negative.value(), HashOf("\xfe\xff\xff\xff"));

  DecisionHash real;
  real.AddFloat(-10.0f);
  EXPECT_EQ(real.value(), HashOf(std::string_view("\x00\x00\x20\xc1", 4)));
}

TEST(DecisionHash, TakesBothZerosForOne) {
  DecisionHash positive;
  positive.AddFloat(0.0f);
  DecisionHash negative;
  negative.AddFloat(-0.0f);
  EXPECT_EQ(positive.value(), negative.value());
}

TEST(DecisionHash, TellsOrderApart) {
  DecisionHash one_two;
  one_two.AddU32(1);
  one_two.AddU32(2);
  DecisionHash two_one;
  two_one.AddU32(2);
  two_one.AddU32(1);
  EXPECT_NE(one_two.value(), two_one.value());
}

// AddFloat is compiled in core, but the hook leaves it before anything needs to be unwound there.
TEST(DecisionHash, IsAssertedToGetFiniteNumbers) {
  DecisionHash hash;
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(BrokenAssumption([&] { hash.AddFloat(bad); }).expression(), "IsFinite(value)");
  }
}

}  // namespace
}  // namespace hardpack
