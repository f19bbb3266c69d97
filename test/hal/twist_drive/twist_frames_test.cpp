// SPDX-License-Identifier: Apache-2.0
#include "hal/twist_drive/twist_frames.h"

#include <gtest/gtest.h>

#include <utility>

#include <limits>
#include <random>
#include <vector>

namespace hardpack::twist_drive {
namespace {

CanFrame FrameOf(uint32_t id, const std::vector<uint8_t>& bytes) {
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<uint8_t>(bytes.size());
  for (size_t i = 0; i < bytes.size(); ++i) frame.data[i] = bytes[i];
  return frame;
}

// The frames of docs/twist_drive.md, byte by byte.
TEST(TwistFrames, ACommandHasTheBytesOfTheDocs) {
  const Command command = {7, true, false, TurnKind::kYawRate, 1500, -200};
  const CanFrame golden = FrameOf(0x210, {7, 0x01, 0xdc, 0x05, 0x38, 0xff, 0, 0x32});
  EXPECT_EQ(Encode(0x210, command), golden);
  Command decoded;
  ASSERT_EQ(Decode(golden, decoded), Status::kOk);
  EXPECT_EQ(decoded.counter, 7);
  EXPECT_TRUE(decoded.enable);
  EXPECT_FALSE(decoded.reset_faults);
  EXPECT_EQ(decoded.turn_kind, TurnKind::kYawRate);
  EXPECT_EQ(decoded.speed, 1500);
  EXPECT_EQ(decoded.turn, -200);
}

TEST(TwistFrames, AFeedbackHasTheBytesOfTheDocs) {
  const CanFrame golden = FrameOf(0x211, {200, 0x02, 0x0c, 0xfe, 0x2c, 0x01, 7, 0x44});
  Feedback decoded;
  ASSERT_EQ(Decode(golden, decoded), Status::kOk);
  EXPECT_EQ(decoded.counter, 200);
  EXPECT_EQ(decoded.state, ControllerState::kFollowing);
  EXPECT_EQ(decoded.turn_kind, TurnKind::kYawRate);
  EXPECT_FALSE(decoded.timed_out);
  EXPECT_EQ(decoded.speed, -500);
  EXPECT_EQ(decoded.turn, 300);
  EXPECT_EQ(decoded.echo, 7);
  EXPECT_EQ(Encode(0x211, decoded), golden);
}

TEST(TwistFrames, AStatusHasTheBytesOfTheDocs) {
  const CanFrame golden = FrameOf(0x212, {3, 1, 0x01, 0x80, 0xb8, 0x0b, 0xfb, 0x32});
  ControllerStatus decoded;
  ASSERT_EQ(Decode(golden, decoded), Status::kOk);
  EXPECT_EQ(decoded.counter, 3);
  EXPECT_EQ(decoded.version, kVersion);
  EXPECT_EQ(decoded.faults, 0x8001);
  EXPECT_EQ(decoded.battery, 3000);
  EXPECT_EQ(decoded.temperature_degC, -5);
  EXPECT_EQ(Encode(0x212, decoded), golden);
}

TEST(TwistFrames, ATemperatureOutsideAByteIsTheNearestThatFits) {
  for (const auto& [said, sent] : {std::pair{-129, -128}, {-128, -128}, {127, 127}, {900, 127}}) {
    ControllerStatus status;
    status.temperature_degC = said;
    ControllerStatus decoded;
    ASSERT_EQ(Decode(Encode(0x212, status), decoded), Status::kOk);
    EXPECT_EQ(decoded.temperature_degC, sent);
  }
}

// Any single bit and any two: a CRC of 8 bits sees both in frames as short as these.
TEST(TwistFrames, NoOneOrTwoWrongBitsPass) {
  const CanFrame good = Encode(0x210, Command{99, true, false, TurnKind::kSteering, -1234, 4321});
  for (int first = 0; first < 64; ++first) {
    for (int second = first; second < 64; ++second) {
      CanFrame bad = good;
      bad.data[first / 8] ^= static_cast<uint8_t>(1 << first % 8);
      if (second != first) bad.data[second / 8] ^= static_cast<uint8_t>(1 << second % 8);
      Command decoded;
      EXPECT_EQ(Decode(bad, decoded), Status::kBadCrc) << first << ", " << second;
    }
  }
  CanFrame elsewhere = good;
  elsewhere.id = 0x211;
  Command decoded;
  EXPECT_EQ(Decode(elsewhere, decoded), Status::kBadCrc) << "of another identifier";
}

TEST(TwistFrames, RefusesFramesOfAnotherForm) {
  const CanFrame good = Encode(0x211, Feedback{});
  Feedback decoded;
  for (const int size : {0, 7}) {
    CanFrame bad = good;
    bad.size = static_cast<uint8_t>(size);
    EXPECT_EQ(Decode(bad, decoded), Status::kWrongPacketType);
  }
  CanFrame bad = good;
  bad.extended = true;
  EXPECT_EQ(Decode(bad, decoded), Status::kWrongPacketType);
  bad = good;
  bad.remote = true;
  EXPECT_EQ(Decode(bad, decoded), Status::kWrongPacketType);
}

TEST(TwistFrames, RefusesWhatNoFieldMayHold) {
  const auto with = [](uint32_t id, int at, uint8_t value) {
    CanFrame frame = FrameOf(id, {0, 0, 0, 0, 0, 0, 0, 0});
    frame.data[at] = value;
    frame.data[7] = CrcOf(frame);
    return frame;
  };
  Command command;
  Feedback feedback;
  EXPECT_EQ(Decode(with(0x210, 1, 0x08), command), Status::kInvalidArgument);
  EXPECT_EQ(Decode(with(0x210, 6, 1), command), Status::kInvalidArgument);
  EXPECT_EQ(Decode(with(0x211, 1, 5), feedback), Status::kInvalidArgument) << "no such state";
  EXPECT_EQ(Decode(with(0x211, 1, 0x20), feedback), Status::kInvalidArgument);
  EXPECT_EQ(Decode(with(0x210, 3, 0x80), command), Status::kInvalidArgument) << "-32768";
  EXPECT_EQ(Decode(with(0x211, 5, 0x80), feedback), Status::kInvalidArgument) << "-32768";
}

TEST(TwistFrames, WhatIsEncodedIsDecoded) {
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    const auto bits = random();
    const auto value = [&] {
      return static_cast<int16_t>(static_cast<int>(random() % 65535) - 32767);
    };
    const Command command = {static_cast<uint8_t>(bits),
                             (bits & 256) != 0,
                             (bits & 512) != 0,
                             (bits & 1024) != 0 ? TurnKind::kSteering : TurnKind::kYawRate,
                             value(),
                             value()};
    Command decoded;
    ASSERT_EQ(Decode(Encode(0x7ff, command), decoded), Status::kOk);
    EXPECT_EQ(Encode(0x7ff, decoded), Encode(0x7ff, command));
    EXPECT_EQ(decoded.speed, command.speed);
    EXPECT_EQ(decoded.turn, command.turn);
  }
}

TEST(TwistFrames, IntegersAreRoundedAndNeverBeyondTheirRange) {
  EXPECT_EQ(ToInteger(1.2344f, kPerMetre), 1234);
  EXPECT_EQ(ToInteger(-1.2346f, kPerMetre), -1235);
  EXPECT_EQ(ToInteger(1.0e9f, kPerMetre), 32767);
  EXPECT_EQ(ToInteger(-1.0e9f, kPerMetre), -32767);
  EXPECT_EQ(ToInteger(std::numeric_limits<float>::quiet_NaN(), kPerMetre), 0);
}

}  // namespace
}  // namespace hardpack::twist_drive
