// SPDX-License-Identifier: Apache-2.0
#include "hal/sevcon/canopen.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

#include "hal/sevcon/power_states.h"
#include "hal/sevcon/process_data.h"

namespace hardpack::sevcon {
namespace {

std::vector<int> BytesOf(const CanFrame& frame) {
  return {frame.data, frame.data + frame.size};
}
CanFrame Answer(const std::vector<int>& bytes) {
  CanFrame frame;
  frame.id = 0x582;
  frame.size = 8;
  for (size_t i = 0; i < bytes.size() && i < 8; ++i) frame.data[i] = static_cast<uint8_t>(bytes[i]);
  return frame;
}

TEST(Canopen, MakesTheFramesOfTheStandard) {
  EXPECT_EQ(NmtFrame(NmtCommand::kStart, 2).id, 0x000u);
  EXPECT_EQ(BytesOf(NmtFrame(NmtCommand::kStart, 2)), (std::vector<int>{0x01, 0x02}));
  EXPECT_EQ(BytesOf(NmtFrame(NmtCommand::kEnterPreOperational, 3)), (std::vector<int>{0x80, 0x03}));
  EXPECT_EQ(HeartbeatFrame(1, NmtState::kOperational).id, 0x701u);
  EXPECT_EQ(BytesOf(HeartbeatFrame(1, NmtState::kOperational)), (std::vector<int>{0x05}));
  EXPECT_EQ(SyncFrame().id, 0x080u);
  EXPECT_EQ(SyncFrame().size, 0);
  const CanFrame read = SdoQuestionFrame(2, {0x1018, 1, 4, false, 0});
  EXPECT_EQ(read.id, 0x602u);
  EXPECT_EQ(BytesOf(read), (std::vector<int>{0x40, 0x18, 0x10, 0x01, 0, 0, 0, 0}));
  EXPECT_EQ(BytesOf(SdoQuestionFrame(2, {0x1017, 0, 2, true, 0x1f4})),
            (std::vector<int>{0x2b, 0x17, 0x10, 0x00, 0xf4, 0x01, 0, 0}));
  EXPECT_EQ(BytesOf(SdoQuestionFrame(2, {0x5902, 0, 1, true, 2})),
            (std::vector<int>{0x2f, 0x02, 0x59, 0x00, 0x02, 0, 0, 0}));
  EXPECT_EQ(BytesOf(SdoQuestionFrame(3, {0x1016, 1, 4, true, 0x0001012c})),
            (std::vector<int>{0x23, 0x16, 0x10, 0x01, 0x2c, 0x01, 0x01, 0x00}));
  // Bits beyond the object's size do not go out.
  EXPECT_EQ(BytesOf(SdoQuestionFrame(2, {0x5902, 0, 1, true, 0x0302})),
            (std::vector<int>{0x2f, 0x02, 0x59, 0x00, 0x02, 0, 0, 0}));
}

TEST(Canopen, DecodesAnswersOfEverySize) {
  const std::vector<int> address = {0x00, 0x51, 0x02};
  const std::map<int, std::pair<int, uint32_t>> sizes = {{0x4f, {1, 0x44u}},
                                                         {0x4b, {2, 0x3344u}},
                                                         {0x47, {3, 0x223344u}},
                                                         {0x43, {4, 0x11223344u}},
                                                         {0x42, {0, 0x11223344u}}};
  for (const auto& [command, expected] : sizes) {
    const SdoAnswer answer =
        DecodeSdoAnswer(Answer({command, 0x00, 0x51, 0x02, 0x44, 0x33, 0x22, 0x11}));
    EXPECT_EQ(answer.kind, SdoAnswerKind::kValue);
    EXPECT_EQ(answer.index, 0x5100);
    EXPECT_EQ(answer.subindex, 2);
    EXPECT_EQ(answer.size, expected.first);
    EXPECT_EQ(answer.value, expected.second);
  }
  EXPECT_EQ(DecodeSdoAnswer(Answer({0x60, 0x17, 0x10, 0})).kind, SdoAnswerKind::kWritten);
  const SdoAnswer abort = DecodeSdoAnswer(Answer({0x80, 0x17, 0x10, 0, 0x30, 0x00, 0x09, 0x06}));
  EXPECT_EQ(abort.kind, SdoAnswerKind::kAbort);
  EXPECT_EQ(abort.value, 0x06090030u);
}

TEST(Canopen, TakesNothingElseForAnAnswer) {
  int values = 0;
  for (int command = 0; command < 256; ++command) {
    const SdoAnswerKind kind = DecodeSdoAnswer(Answer({command, 0, 0, 0})).kind;
    if (command == 0x80) {
      EXPECT_EQ(kind, SdoAnswerKind::kAbort);
    } else if (command == 0x60) {
      EXPECT_EQ(kind, SdoAnswerKind::kWritten);
    } else if (command >= 0x40 && command < 0x60 && (command & 0x02) != 0) {
      // Upload response, expedited; bit 4 is reserved and decides nothing.
      EXPECT_EQ(kind, SdoAnswerKind::kValue) << command;
      ++values;
    } else {
      EXPECT_EQ(kind, SdoAnswerKind::kOther) << command;
    }
  }
  EXPECT_EQ(values, 16);
}

TEST(Canopen, DecodesTheEmergencyMessage) {
  // Recorded on a Gen4: "00 31 04 C3 4D 00 00 00" (REFERENCES.md).
  const Emergency emergency =
      DecodeEmergency(Answer({0x00, 0x31, 0x04, 0xc3, 0x4d, 0x00, 0x00, 0x00}));
  EXPECT_EQ(emergency.code, 0x3100);
  EXPECT_EQ(emergency.error_register, 0x04);
  EXPECT_EQ(emergency.fault_id, 0x4dc3);
}

// The list of the Gen4's EDS (6041h, bits 0x6f), over all statuswords.
TEST(PowerStates, AreThoseOfTheStandardForEveryStatusword) {
  const std::map<uint32_t, PowerState> listed = {{0x20, PowerState::kNotReadyToSwitchOn},
                                                 {0x00, PowerState::kNotReadyToSwitchOn},
                                                 {0x40, PowerState::kSwitchOnDisabled},
                                                 {0x60, PowerState::kSwitchOnDisabled},
                                                 {0x21, PowerState::kReadyToSwitchOn},
                                                 {0x23, PowerState::kSwitchedOn},
                                                 {0x27, PowerState::kOperationEnabled},
                                                 {0x07, PowerState::kQuickStopActive},
                                                 {0x0f, PowerState::kFaultReactionActive},
                                                 {0x2f, PowerState::kFaultReactionActive},
                                                 {0x08, PowerState::kFault},
                                                 {0x28, PowerState::kFault}};
  for (uint32_t word = 0; word <= 0xffff; ++word) {
    const auto found = listed.find(word & 0x6fu);
    const PowerState expected = found == listed.end() ? PowerState::kUnknown : found->second;
    ASSERT_EQ(PowerStateOf(word), expected) << std::hex << word;
  }
}

TEST(ProcessData, IsPackedLittleEndian) {
  const CanFrame frame = Pack(2, {0x000f, -1500, 1000});
  EXPECT_EQ(frame.id, 0x202u);
  EXPECT_EQ(BytesOf(frame), (std::vector<int>{0x0f, 0x00, 0x24, 0xfa, 0xff, 0xff, 0xe8, 0x03}));
  MotorFeedback feedback;
  CanFrame report = Answer({0x37, 0x02, 0x24, 0xfa, 0xff, 0xff, 0x85, 0xff});
  ASSERT_TRUE(Unpack(report, feedback));
  EXPECT_EQ(feedback.statusword, 0x0237);
  EXPECT_EQ(feedback.speed_rpm, -1500);
  EXPECT_EQ(feedback.torque_permille, -123);
  for (uint8_t size = 0; size < 8; ++size) {
    report.size = size;
    EXPECT_FALSE(Unpack(report, feedback));
  }
}

// SR-INP04
TEST(ProcessData, HoldsSpeedsToTheirRange) {
  for (const int32_t rpm : {20000, -20000, 20001, -20001, INT32_MAX, INT32_MIN}) {
    CanFrame frame = Answer({});
    PutLittleEndian(frame, 2, 4, static_cast<uint32_t>(rpm));
    MotorFeedback feedback;
    EXPECT_EQ(Unpack(frame, feedback), std::abs(static_cast<int64_t>(rpm)) <= 20000) << rpm;
  }
}

TEST(ProcessData, TurnsWheelSpeedsIntoMotorSpeedsAndBack) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> wheel(-30.0f, 30.0f);
  std::uniform_real_distribution<float> gear(1.0f, 100.0f);
  for (int i = 0; i < 10000; ++i) {
    const float wheel_radps = wheel(random);
    const float ratio = gear(random);
    const int32_t sign = i % 2 == 0 ? 1 : -1;
    const int32_t rpm = MotorSpeed_rpm(wheel_radps, sign, ratio, 100000);
    const double exact = sign * static_cast<double>(wheel_radps) * ratio * 60.0 / 6.283185307179586;
    ASSERT_NEAR(rpm, exact, 0.51 + std::abs(exact) * 1e-6);
    ASSERT_NEAR(WheelSpeed_radps(rpm, sign, ratio), wheel_radps, 0.06f / ratio + 1e-4f);
  }
  EXPECT_EQ(MotorSpeed_rpm(1e30f, 1, 30.0f, 500), 500);
  EXPECT_EQ(MotorSpeed_rpm(1e30f, -1, 30.0f, 500), -500);
  EXPECT_EQ(MotorSpeed_rpm(std::numeric_limits<float>::quiet_NaN(), 1, 30.0f, 500), 0);
}

}  // namespace
}  // namespace hardpack::sevcon
