// SPDX-License-Identifier: Apache-2.0
#include "core/base/byte_reader.h"

#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "gtest/gtest.h"

namespace hardpack {
namespace {

constexpr size_t kNumberSizes[] = {1, 2, 3, 4, 5, 8};

uint64_t Read(ByteReader& reader, size_t offset, size_t size) {
  switch (size) {
    case 1:
      return reader.U8(offset);
    case 2:
      return reader.U16(offset);
    case 3:
      return reader.U24(offset);
    case 4:
      return reader.U32(offset);
    case 5:
      return reader.U40(offset);
    default:
      return reader.U64(offset);
  }
}

uint64_t Reference(std::span<const uint8_t> bytes, size_t offset, size_t size) {
  uint64_t value = 0;
  for (size_t i = size; i > 0; --i) value = value * 256 + bytes[offset + i - 1];
  return value;
}

// In a heap block of exactly that size, so that the sanitizer sees a read beside it.
struct Block {
  explicit Block(size_t size) : memory(new uint8_t[size]), bytes(memory.get(), size) {
    for (size_t i = 0; i < size; ++i) memory[i] = static_cast<uint8_t>(37 * i + 129);
  }
  std::unique_ptr<uint8_t[]> memory;
  std::span<const uint8_t> bytes;
};

TEST(ByteReader, ReadsLittleEndian) {
  const uint8_t bytes[] = {0x01, 0x23, 0x45, 0x67, 0x89, 0xab, 0xcd, 0xef};
  ByteReader reader(bytes);
  EXPECT_EQ(reader.U8(0), 0x01u);
  EXPECT_EQ(reader.U16(0), 0x2301u);
  EXPECT_EQ(reader.U24(0), 0x452301u);
  EXPECT_EQ(reader.U32(0), 0x67452301u);
  EXPECT_EQ(reader.U40(0), 0x8967452301u);
  EXPECT_EQ(reader.U64(0), 0xefcdab8967452301u);
  EXPECT_EQ(reader.status(), Status::kOk);
}

TEST(ByteReader, ReadsFloatsByTheirBits) {
  const uint8_t bytes[] = {0x00, 0x00, 0x20, 0xc1, 0x00, 0x00, 0x80, 0x7f};
  ByteReader reader(bytes);
  EXPECT_EQ(reader.F32(0), -10.0f);
  EXPECT_EQ(reader.F32(4), std::numeric_limits<float>::infinity());
  EXPECT_EQ(reader.F32(5), 0.0f);
  EXPECT_EQ(reader.status(), Status::kTruncated);
}

// Every length up to 12 with every offset around it: all that can go wrong is at the end.
TEST(ByteReader, ReadsInsideAndRefusesOutside) {
  for (size_t length = 0; length <= 12; ++length) {
    const Block block(length);
    for (const size_t size : kNumberSizes) {
      for (size_t offset = 0; offset <= length + 9; ++offset) {
        ByteReader reader(block.bytes);
        const uint64_t value = Read(reader, offset, size);
        const bool inside = offset + size <= length;
        EXPECT_EQ(value, inside ? Reference(block.bytes, offset, size) : 0u)
            << size << " bytes at " << offset << " of " << length;
        EXPECT_EQ(reader.status(), inside ? Status::kOk : Status::kTruncated);
      }
    }
  }
}

TEST(ByteReader, RefusesOffsetsWhoseSumWouldWrapAround) {
  const Block block(16);
  for (size_t below = 0; below < 20; ++below) {
    const size_t offset = std::numeric_limits<size_t>::max() - below;
    for (const size_t size : kNumberSizes) {
      ByteReader reader(block.bytes);
      EXPECT_EQ(Read(reader, offset, size), 0u);
      EXPECT_EQ(reader.status(), Status::kTruncated);
    }
    ByteReader reader(block.bytes);
    EXPECT_TRUE(reader.Sub(8, offset).empty());
    EXPECT_TRUE(reader.Sub(offset, 8).empty());
    EXPECT_EQ(reader.status(), Status::kTruncated);
  }
}

TEST(ByteReader, AgreesWithAReferenceAtRandomOffsets) {
  constexpr uint32_t kSeed = 4711;
  std::mt19937 random(kSeed);
  const Block block(1999);
  ByteReader reader(block.bytes);
  for (int i = 0; i < 100000; ++i) {
    const size_t size = kNumberSizes[random() % 6];
    const size_t offset = random() % (block.bytes.size() - size + 1);
    ASSERT_EQ(Read(reader, offset, size), Reference(block.bytes, offset, size))
        << "seed " << kSeed << ": " << size << " bytes at " << offset;
  }
  EXPECT_EQ(reader.status(), Status::kOk);
}

TEST(ByteReader, StaysTruncatedAfterAGoodRead) {
  const Block block(4);
  ByteReader reader(block.bytes);
  EXPECT_EQ(reader.U32(1), 0u);
  EXPECT_EQ(reader.U32(0), Reference(block.bytes, 0, 4));
  EXPECT_EQ(reader.status(), Status::kTruncated);
}

TEST(ByteReader, GivesParts) {
  const Block block(10);
  ByteReader reader(block.bytes);
  EXPECT_EQ(reader.Sub(2, 3).data(), block.bytes.data() + 2);
  EXPECT_EQ(reader.Sub(2, 3).size(), 3u);
  EXPECT_EQ(reader.Sub(0, 10).size(), 10u);
  EXPECT_TRUE(reader.Sub(10, 0).empty());
  EXPECT_EQ(reader.status(), Status::kOk);
  EXPECT_TRUE(reader.Sub(2, 9).empty());
  EXPECT_EQ(reader.status(), Status::kTruncated);
}

TEST(ByteReader, OfNothingReadsNothing) {
  ByteReader reader({});
  EXPECT_EQ(reader.size(), 0u);
  EXPECT_TRUE(reader.Sub(0, 0).empty());
  EXPECT_EQ(reader.status(), Status::kOk);
  EXPECT_EQ(reader.U8(0), 0u);
  EXPECT_EQ(reader.status(), Status::kTruncated);
}

}  // namespace
}  // namespace hardpack
