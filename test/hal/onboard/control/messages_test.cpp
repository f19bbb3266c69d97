// SPDX-License-Identifier: Apache-2.0
#include "hal/onboard/control/messages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>

#include "test/hal/onboard/control/random_messages.h"
#include "test/not_finite.h"

namespace hardpack::control {
namespace {

using testing::kInfinity;
using testing::kNaN;

// docs/control.md's example.
OperatorCommand ExampleGoal() {
  OperatorCommand command;
  command.kind = Kind::kGoal;
  command.sequence = 7;
  command.waypoints = 1;
  command.waypoint[0].position_m = {12.5f, -3.0f};
  command.has_heading = true;
  command.heading_rad = 0.5f;
  return command;
}

OperatorCommand GeodeticGoal() {
  OperatorCommand command;
  command.kind = Kind::kGoal;
  command.sequence = 0x01020304u;
  command.waypoints = 1;
  command.waypoint[0].frame = GoalFrame::kGeodetic;
  command.waypoint[0].latitude_ndeg = 30'617'512'345;
  command.waypoint[0].longitude_ndeg = -96'338'912'345;
  return command;
}

template <typename Message>
Bytes Encoded(const Message& message) {
  Bytes bytes;
  EXPECT_EQ(TryEncode(message, bytes), Status::kOk);
  return bytes;
}

Status DecodeCommand(const Bytes& bytes) {
  OperatorCommand command;
  return Decode(bytes, command);
}

// Sets the size that a message says to the one that it has.
Bytes Resized(Bytes bytes, size_t size) {
  bytes.resize(size);
  if (size >= kHeaderBytes) {
    bytes[6] = static_cast<uint8_t>(size);
    bytes[7] = static_cast<uint8_t>(size >> 8);
  }
  return bytes;
}

Bytes ExampleOfTheDocs() {
  std::ifstream file(HARDPACK_SOURCE "/docs/control.md");
  EXPECT_TRUE(file) << "the document is not beside the sources";
  std::ostringstream text;
  text << file.rdbuf();
  const std::string fence = "```hex\n";
  const size_t begin = text.str().find(fence) + fence.size();
  std::istringstream hex(text.str().substr(begin, text.str().find("```", begin) - begin));
  Bytes bytes;
  for (unsigned byte = 0; hex >> std::hex >> byte;) bytes.push_back(static_cast<uint8_t>(byte));
  return bytes;
}

TEST(ControlMessages, AGoalHasTheBytesOfTheDocs) {
  const Bytes expected = {0x48, 0x50, 0x43, 0x54, 1, 3, 0x28, 0,     //
                          7,    0,    0,    0,                       //
                          1,    1,    0,    0,    0, 0, 0,    0x3f,  //
                          0,    0,    0,    0,                       //
                          0,    0,    0x48, 0x41, 0, 0, 0x40, 0xc0,  //
                          0,    0,    0,    0,    0, 0, 0,    0};
  EXPECT_EQ(Encoded(ExampleGoal()), expected);
  EXPECT_EQ(ExampleOfTheDocs(), expected);
}

TEST(ControlMessages, AGeodeticGoalHasItsDegreesInBillionths) {
  const Bytes expected = {0x48, 0x50, 0x43, 0x54, 1,    3,    0x28, 0,  //
                          4,    3,    2,    1,                          //
                          1,    0,    0,    0,    0,    0,    0,    0,  //
                          2,    0,    0,    0,                          //
                          0x99, 0x29, 0xf2, 0x20, 7,    0,    0,    0,  //
                          0xa7, 0xdb, 0xc0, 0x91, 0xe9, 0xff, 0xff, 0xff};
  EXPECT_EQ(Encoded(GeodeticGoal()), expected);
}

TEST(ControlMessages, OtherCommandsAreAHeader) {
  OperatorCommand command;
  command.kind = Kind::kEmergencyStop;
  command.sequence = 0xfffffffeu;
  EXPECT_EQ(Encoded(command), (Bytes{0x48, 0x50, 0x43, 0x54, 1, 5, 12, 0, 0xfe, 0xff, 0xff, 0xff}));
}

TEST(ControlMessages, QuestionsAndAnswersHaveTheBytesOfTheDocs) {
  EXPECT_EQ(Encoded(Question{Kind::kGetStatus, 1, 0}),
            (Bytes{0x48, 0x50, 0x43, 0x54, 1, 64, 12, 0, 1, 0, 0, 0}));
  EXPECT_EQ(Encoded(Question{Kind::kGetParameters, 2, 0x1234}),
            (Bytes{0x48, 0x50, 0x43, 0x54, 1, 65, 16, 0, 2, 0, 0, 0, 0x34, 0x12, 0, 0}));
  const auto status = static_cast<uint8_t>(Status::kNotPermitted);
  EXPECT_EQ(Encoded(Done{3, Status::kNotPermitted, 2}),
            (Bytes{0x48, 0x50, 0x43, 0x54, 1, 128, 14, 0, 3, 0, 0, 0, status, 2}));
  const Bytes text = {'a', '='};
  EXPECT_EQ(
      Encoded(ParametersPart{4, 5, 7, text}),
      (Bytes{0x48, 0x50, 0x43, 0x54, 1, 130, 22, 0, 4, 0, 0, 0, 5, 0, 0, 0, 7, 0, 0, 0, 'a', '='}));
}

OperatorCommand Arm(uint32_t sequence = 0) {
  OperatorCommand command;
  command.kind = Kind::kArm;
  command.sequence = sequence;
  return command;
}

void ExpectSame(const OperatorCommand& a, const OperatorCommand& b) {
  EXPECT_EQ(a.kind, b.kind);
  if (a.kind == Kind::kArea) {
    EXPECT_EQ(a.area_index, b.area_index);
    EXPECT_EQ(a.area_count, b.area_count);
    EXPECT_EQ(a.area.kind, b.area.kind);
    EXPECT_EQ(a.area.frame, b.area.frame);
    EXPECT_EQ(a.area.speed_mps, b.area.speed_mps);
    ASSERT_EQ(a.area.corners, b.area.corners);
    for (int i = 0; i < a.area.corners; ++i) EXPECT_EQ(a.area.corner[i], b.area.corner[i]);
    for (int i = b.area.corners; i < kMaxAreaCorners; ++i) {
      EXPECT_EQ(b.area.corner[i], AreaCorner{}) << "nothing is left of the one before";
    }
  }
  EXPECT_EQ(a.sequence, b.sequence);
  ASSERT_EQ(a.waypoints, b.waypoints);
  EXPECT_EQ(a.has_heading, b.has_heading);
  EXPECT_EQ(a.heading_frame, b.heading_frame);
  EXPECT_EQ(a.heading_rad, b.heading_rad);
  for (int i = 0; i < a.waypoints; ++i) {
    EXPECT_EQ(a.waypoint[i].frame, b.waypoint[i].frame);
    EXPECT_EQ(a.waypoint[i].position_m.x_m, b.waypoint[i].position_m.x_m);
    EXPECT_EQ(a.waypoint[i].position_m.y_m, b.waypoint[i].position_m.y_m);
    EXPECT_EQ(a.waypoint[i].latitude_ndeg, b.waypoint[i].latitude_ndeg);
    EXPECT_EQ(a.waypoint[i].longitude_ndeg, b.waypoint[i].longitude_ndeg);
    EXPECT_EQ(a.waypoint[i].stops, b.waypoint[i].stops);
    EXPECT_EQ(a.waypoint[i].hold_s, b.waypoint[i].hold_s);
    EXPECT_EQ(a.waypoint[i].speed_dmps, b.waypoint[i].speed_dmps);
  }
}

// SR-MIS01
TEST(ControlMessages, AWaypointSaysWhetherItIsStoppedAtForHowLongAndHowFastOneMayDriveThere) {
  OperatorCommand command = GeodeticGoal();
  command.waypoints = 2;
  command.waypoint[0].stops = true;
  command.waypoint[0].hold_s = 250;
  command.waypoint[0].speed_dmps = 15;
  command.waypoint[1].stops = true;
  command.waypoint[1].speed_dmps = 255;
  const Bytes bytes = Encoded(command);
  EXPECT_EQ(Bytes(bytes.begin() + 20, bytes.begin() + 24), (Bytes{2, 1, 250, 15}));
  EXPECT_EQ(Bytes(bytes.begin() + 40, bytes.begin() + 44), (Bytes{0, 1, 0, 255}));
  OperatorCommand decoded;
  ASSERT_EQ(Decode(bytes, decoded), Status::kOk);
  ExpectSame(command, decoded);
}

TEST(ControlMessages, CommandsComeBackAsTheyWere) {
  const uint32_t seed = 51;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  OperatorCommand decoded = RandomCommand(random);  // of which nothing may be left
  for (int i = 0; i < 2000; ++i) {
    const OperatorCommand command = RandomCommand(random);
    const Bytes bytes = Encoded(command);
    Header header;
    ASSERT_EQ(ReadHeader(bytes, header), Status::kOk);
    EXPECT_EQ(header.kind, command.kind);
    EXPECT_EQ(header.sequence, command.sequence);
    ASSERT_EQ(Decode(bytes, decoded), Status::kOk);
    ExpectSame(command, decoded);
  }
}

TEST(ControlMessages, QuestionsAndAnswersComeBackAsTheyWere) {
  std::mt19937 random(52);
  for (int i = 0; i < 500; ++i) {
    const auto sequence = static_cast<uint32_t>(random());
    const uint32_t offset = static_cast<uint32_t>(random() % (kMaxParametersBytes + 1));
    Question question;
    ASSERT_EQ(Decode(Encoded(Question{Kind::kGetParameters, sequence, offset}), question),
              Status::kOk);
    EXPECT_EQ(question.kind, Kind::kGetParameters);
    EXPECT_EQ(question.sequence, sequence);
    EXPECT_EQ(question.offset, offset);

    const Done done = {sequence, static_cast<Status>(random() % 256),
                       static_cast<uint8_t>(random() % 256)};
    Done again;
    ASSERT_EQ(Decode(Encoded(done), again), Status::kOk);
    EXPECT_EQ(again.sequence, sequence);
    EXPECT_EQ(again.status, done.status);
    EXPECT_EQ(again.reason, done.reason);

    const Bytes text(1 + random() % kMaxPartBytes, static_cast<uint8_t>(i));
    const uint32_t whole = 100000;
    const ParametersPart part = {sequence, whole - static_cast<uint32_t>(text.size()), whole, text};
    const Bytes bytes = Encoded(part);
    ParametersPart part_again;
    ASSERT_EQ(Decode(bytes, part_again), Status::kOk);
    EXPECT_EQ(part_again.offset, part.offset);
    EXPECT_EQ(part_again.whole_bytes, whole);
    EXPECT_EQ(Bytes(part_again.bytes.begin(), part_again.bytes.end()), text);
  }
}

OperatorCommand ExampleArea() {
  OperatorCommand command;
  command.kind = Kind::kArea;
  command.sequence = 7;
  command.area_index = 1;
  command.area_count = 2;
  command.area.kind = AreaKind::kSpeedZone;
  command.area.speed_mps = 1.5f;
  command.area.corners = 3;
  command.area.corner[0] = {.x_mm = 12'500, .y_mm = -3000};
  command.area.corner[1] = {.x_mm = 16'000, .y_mm = -3000};
  command.area.corner[2] = {.x_mm = 16'000, .y_mm = 2000};
  return command;
}

TEST(ControlMessages, AnAreaHasTheBytesOfTheDocs) {
  const Bytes expected = {0x48, 0x50, 0x43, 0x54, 1,    10,   0x48, 0,     //
                          7,    0,    0,    0,                             //
                          1,    2,    2,    0,    3,    0,    0,    0,     //
                          0,    0,    0xc0, 0x3f,                          //
                          0xd4, 0x30, 0,    0,    0x48, 0xf4, 0xff, 0xff,  //
                          0,    0,    0,    0,    0,    0,    0,    0,     //
                          0x80, 0x3e, 0,    0,    0x48, 0xf4, 0xff, 0xff,  //
                          0,    0,    0,    0,    0,    0,    0,    0,     //
                          0x80, 0x3e, 0,    0,    0xd0, 0x07, 0,    0,     //
                          0,    0,    0,    0,    0,    0,    0,    0};
  EXPECT_EQ(Encoded(ExampleArea()), expected);
  for (size_t size = 0; size < expected.size(); ++size) {
    EXPECT_EQ(DecodeCommand(Resized(expected, size)), Status::kTruncated) << size;
  }
  EXPECT_EQ(DecodeCommand(Resized(expected, expected.size() + 1)), Status::kOversized);
  for (const size_t zero : {17u, 18u, 19u, 32u, 39u, 71u}) {
    Bytes bytes = expected;
    bytes[zero] = 1;
    EXPECT_EQ(DecodeCommand(bytes), Status::kInvalidArgument) << zero;
  }
}

struct BadArea {
  const char* what;
  void (*spoil)(OperatorCommand&);
  Status status;
};

// SR-ARE01
TEST(ControlMessages, AnAreaWithANumberOutOfRangeIsRefusedBothWays) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const BadArea cases[] = {
      {"index", [](OperatorCommand& c) { c.area_index = 2; }, Status::kInvalidArgument},
      {"no count", [](OperatorCommand& c) { c.area_count = 0; }, Status::kInvalidArgument},
      {"65th", [](OperatorCommand& c) { c.area_count = 65; }, Status::kInvalidArgument},
      {"kind", [](OperatorCommand& c) { c.area.kind = static_cast<AreaKind>(3); },
       Status::kInvalidArgument},
      {"frame", [](OperatorCommand& c) { c.area.frame = static_cast<AreaFrame>(2); },
       Status::kInvalidArgument},
      {"few corners", [](OperatorCommand& c) { c.area.corners = 2; }, Status::kInvalidArgument},
      {"33rd corner", [](OperatorCommand& c) { c.area.corners = 33; }, Status::kInvalidArgument},
      {"far", [](OperatorCommand& c) { c.area.corner[1].x_mm = INT32_MIN; },
       Status::kInvalidArgument},
      {"farther", [](OperatorCommand& c) { c.area.corner[2].y_mm = kMaxAreaPosition_mm + 1; },
       Status::kInvalidArgument},
      {"NaN", [](OperatorCommand& c) { c.area.speed_mps = kNaN; }, Status::kNotFinite},
  };
  for (const BadArea& bad : cases) {
    SCOPED_TRACE(bad.what);
    OperatorCommand command = ExampleArea();
    bad.spoil(command);
    Bytes bytes;
    EXPECT_EQ(TryEncode(command, bytes), bad.status);
    EXPECT_TRUE(bytes.empty());
  }
  const Bytes good = Encoded(ExampleArea());
  for (const auto& [offset, value] : {std::pair{12u, 2},
                                      {13u, 65},
                                      {13u, 1},
                                      {14u, 3},
                                      {15u, 2},
                                      {16u, 2},
                                      {16u, 33},
                                      {27u, 0x7f}}) {
    Bytes bytes = good;
    bytes[offset] = static_cast<uint8_t>(value);
    EXPECT_EQ(DecodeCommand(bytes), Status::kInvalidArgument) << offset;
  }
  Bytes nan = good;
  nan[22] = 0xc0;
  nan[23] = 0x7f;
  EXPECT_EQ(DecodeCommand(nan), Status::kNotFinite);
}

// What a cut message says of its size is not what it has; and where it is, the body's.
// SR-OPR02
TEST(ControlMessages, EveryTruncationIsTold) {
  OperatorCommand two = GeodeticGoal();
  two.waypoints = 2;
  const Bytes goal = Encoded(two);
  for (size_t size = 0; size < goal.size(); ++size) {
    SCOPED_TRACE(size);
    OperatorCommand command = ExampleGoal();
    EXPECT_EQ(Decode(std::span(goal).first(size), command), Status::kTruncated);
    ExpectSame(command, ExampleGoal());
    EXPECT_EQ(DecodeCommand(Resized(goal, size)), Status::kTruncated);
  }
  EXPECT_EQ(DecodeCommand(Resized(goal, goal.size() + 1)), Status::kOversized);
  Bytes longer = goal;
  longer.push_back(0);
  EXPECT_EQ(DecodeCommand(longer), Status::kOversized);
  longer.resize(kMaxMessageBytes + 1);
  EXPECT_EQ(DecodeCommand(longer), Status::kOversized);

  const Bytes arm = Encoded(Arm());
  EXPECT_EQ(DecodeCommand(Resized(arm, 13)), Status::kOversized);
  Question question;
  const Bytes asked = Encoded(Question{Kind::kGetParameters, 1, 0});
  EXPECT_EQ(Decode(Resized(asked, 15), question), Status::kTruncated);
  EXPECT_EQ(Decode(Resized(asked, 17), question), Status::kOversized);
  Done done;
  const Bytes answered = Encoded(Done{});
  EXPECT_EQ(Decode(Resized(answered, 13), done), Status::kTruncated);
  EXPECT_EQ(Decode(Resized(answered, 15), done), Status::kOversized);
  ParametersPart part;
  EXPECT_EQ(Decode(Resized(Encoded(ParametersPart{}), 19), part), Status::kTruncated);
}

TEST(ControlMessages, MagicVersionAndKindAreToldApart) {
  const Bytes arm = Encoded(Arm(9));
  for (size_t i = 0; i < 4; ++i) {
    Bytes bytes = arm;
    bytes[i] ^= 0x20;
    EXPECT_EQ(DecodeCommand(bytes), Status::kWrongPacketType);
  }
  Bytes bytes = arm;
  bytes[4] = 2;
  EXPECT_EQ(DecodeCommand(bytes), Status::kUnsupported);
  for (int kind = 0; kind < 256; ++kind) {
    SCOPED_TRACE(kind);
    bytes = arm;
    bytes[5] = static_cast<uint8_t>(kind);
    const bool known =
        (kind >= 1 && kind <= 11) || kind == 64 || kind == 65 || (kind >= 128 && kind <= 130);
    Header header;
    EXPECT_EQ(ReadHeader(bytes, header), known ? Status::kOk : Status::kInvalidArgument);
    EXPECT_EQ(header.sequence, 9u) << "so that it can be answered";
    EXPECT_EQ(IsUsable(DecodeCommand(bytes)), kind >= 1 && kind <= 11 && kind != 3 && kind != 10);
  }
}

TEST(ControlMessages, WhatIsOfAnotherSortIsNotDecoded) {
  OperatorCommand command;
  Question question;
  Done done;
  ParametersPart part;
  const Bytes arm = Encoded(Arm());
  const Bytes asked = Encoded(Question{});
  EXPECT_EQ(Decode(asked, command), Status::kWrongPacketType);
  EXPECT_EQ(Decode(arm, question), Status::kWrongPacketType);
  EXPECT_EQ(Decode(arm, done), Status::kWrongPacketType);
  EXPECT_EQ(Decode(Encoded(Done{}), part), Status::kWrongPacketType);
  EXPECT_EQ(Decode(Encoded(ParametersPart{}), done), Status::kWrongPacketType);
}

struct BadGoal {
  const char* what;
  void (*spoil)(OperatorCommand&);
  Status status;
};

const BadGoal kBadGoals[] = {
    {"no waypoint", [](OperatorCommand& c) { c.waypoints = 0; }, Status::kInvalidArgument},
    {"fewer than none", [](OperatorCommand& c) { c.waypoints = -1; }, Status::kInvalidArgument},
    {"too many", [](OperatorCommand& c) { c.waypoints = 65; }, Status::kInvalidArgument},
    {"frame", [](OperatorCommand& c) { c.waypoint[1].frame = static_cast<GoalFrame>(3); },
     Status::kInvalidArgument},
    {"x nan", [](OperatorCommand& c) { c.waypoint[1].position_m.x_m = kNaN; }, Status::kNotFinite},
    {"y inf", [](OperatorCommand& c) { c.waypoint[1].position_m.y_m = -kInfinity; },
     Status::kNotFinite},
    {"x far", [](OperatorCommand& c) { c.waypoint[1].position_m.x_m = 1.0001e6f; },
     Status::kInvalidArgument},
    {"y far", [](OperatorCommand& c) { c.waypoint[1].position_m.y_m = -1.0001e6f; },
     Status::kInvalidArgument},
    {"latitude", [](OperatorCommand& c) { c.waypoint[0].latitude_ndeg = 90'000'000'001; },
     Status::kInvalidArgument},
    {"latitude least", [](OperatorCommand& c) { c.waypoint[0].latitude_ndeg = INT64_MIN; },
     Status::kInvalidArgument},
    {"longitude", [](OperatorCommand& c) { c.waypoint[0].longitude_ndeg = -180'000'000'001; },
     Status::kInvalidArgument},
    {"heading nan", [](OperatorCommand& c) { c.heading_rad = kNaN; }, Status::kNotFinite},
    {"heading far", [](OperatorCommand& c) { c.heading_rad = 3.15f; }, Status::kInvalidArgument},
    {"heading frame", [](OperatorCommand& c) { c.heading_frame = GoalFrame::kGeodetic; },
     Status::kInvalidArgument},
    {"a hold without a stop", [](OperatorCommand& c) { c.waypoint[0].hold_s = 1; },
     Status::kInvalidArgument},
    {"a hold at the last",
     [](OperatorCommand& c) {
       c.waypoint[1].stops = true;
       c.waypoint[1].hold_s = 1;
     },
     Status::kInvalidArgument},
    {"kind 0", [](OperatorCommand& c) { c.kind = static_cast<Kind>(0); }, Status::kInvalidArgument},
    {"a question", [](OperatorCommand& c) { c.kind = Kind::kGetStatus; }, Status::kInvalidArgument},
};

OperatorCommand TwoWaypoints() {
  OperatorCommand command = GeodeticGoal();
  command.waypoints = 2;
  command.waypoint[1].position_m = {1.0f, 2.0f};
  command.has_heading = true;
  return command;
}

TEST(ControlMessages, NothingOutOfItsRangeIsEncoded) {
  Bytes bytes;
  ASSERT_EQ(TryEncode(TwoWaypoints(), bytes), Status::kOk);
  for (const BadGoal& bad : kBadGoals) {
    SCOPED_TRACE(bad.what);
    OperatorCommand command = TwoWaypoints();
    bad.spoil(command);
    EXPECT_EQ(TryEncode(command, bytes), bad.status);
    EXPECT_TRUE(bytes.empty());
  }
  EXPECT_EQ(TryEncode(Question{Kind::kArm, 1, 0}, bytes), Status::kInvalidArgument);
  EXPECT_EQ(TryEncode(Question{Kind::kGetStatus, 1, 1}, bytes), Status::kInvalidArgument);
  EXPECT_EQ(TryEncode(Question{Kind::kGetParameters, 1, kMaxParametersBytes + 1}, bytes),
            Status::kInvalidArgument);
  Question question;
  EXPECT_EQ(Decode(Encoded(Question{Kind::kGetParameters, 1, kMaxParametersBytes}), question),
            Status::kOk);
  const Bytes text(3, 'x');
  EXPECT_EQ(TryEncode(ParametersPart{1, 0, 2, text}, bytes), Status::kInvalidArgument);
  EXPECT_EQ(TryEncode(ParametersPart{1, 3, 2, {}}, bytes), Status::kInvalidArgument);
  EXPECT_EQ(TryEncode(ParametersPart{1, 1, 2, {}}, bytes), Status::kInvalidArgument);
  const Bytes too_long(kMaxPartBytes + 1, 'x');
  EXPECT_EQ(TryEncode(ParametersPart{1, 0, 8192, too_long}, bytes), Status::kInvalidArgument);
}

struct BadByte {
  const char* what;
  size_t offset;
  Bytes bytes;
  Status status;
};

// Offsets in the message of TwoWaypoints: the first waypoint, geodetic, at 20, the second at 40.
const BadByte kBadBytes[] = {
    {"no waypoint", 12, {0}, Status::kInvalidArgument},
    {"too many", 12, {65}, Status::kInvalidArgument},
    {"one too few for the size", 12, {1}, Status::kOversized},
    {"one too many for the size", 12, {3}, Status::kTruncated},
    {"has_heading", 13, {2}, Status::kInvalidArgument},
    {"a heading's frame", 14, {2}, Status::kInvalidArgument},
    {"not zero", 15, {1}, Status::kInvalidArgument},
    {"heading that is not there", 13, {0, 0, 0, 0, 0, 0, 0x3f}, Status::kInvalidArgument},
    {"frame of a heading that is not there", 13, {0, 1}, Status::kInvalidArgument},
    {"heading nan", 16, {0, 0, 0xc0, 0x7f}, Status::kNotFinite},
    {"heading 4", 16, {0, 0, 0x80, 0x40}, Status::kInvalidArgument},
    {"frame", 20, {3}, Status::kInvalidArgument},
    {"frame", 40, {255}, Status::kInvalidArgument},
    {"stop 2", 21, {2}, Status::kInvalidArgument},
    {"stop 255", 41, {255}, Status::kInvalidArgument},
    {"a hold without a stop", 22, {1}, Status::kInvalidArgument},
    {"a hold at the last", 41, {1, 1}, Status::kInvalidArgument},
    {"latitude 2^62", 31, {0x40}, Status::kInvalidArgument},
    {"longitude least", 32, {0, 0, 0, 0, 0, 0, 0, 0x80}, Status::kInvalidArgument},
    {"x inf", 44, {0, 0, 0x80, 0x7f}, Status::kNotFinite},
    {"y -inf", 48, {0, 0, 0x80, 0xff}, Status::kNotFinite},
    {"x 1e30", 44, {0xca, 0xf2, 0x49, 0x71}, Status::kInvalidArgument},
    {"behind y", 52, {1}, Status::kInvalidArgument},
    {"behind y", 59, {1}, Status::kInvalidArgument},
};

// SR-OPR02
TEST(ControlMessages, EveryByteOfAGoalIsChecked) {
  const Bytes good = Encoded(TwoWaypoints());
  ASSERT_EQ(good.size(), 60u);
  ASSERT_EQ(DecodeCommand(good), Status::kOk);
  for (const BadByte& bad : kBadBytes) {
    SCOPED_TRACE(bad.what);
    Bytes bytes = good;
    std::copy(bad.bytes.begin(), bad.bytes.end(),
              bytes.begin() + static_cast<std::ptrdiff_t>(bad.offset));
    OperatorCommand command = ExampleGoal();
    EXPECT_EQ(Decode(bytes, command), bad.status);
    ExpectSame(command, ExampleGoal());
  }
}

// Whatever the bytes: what is taken is encoded to the same ones again.
// SR-OPR02
TEST(ControlMessages, DamagedMessagesAreRefusedOrMeanWhatTheySay) {
  const uint32_t seed = 53;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  int taken = 0;
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = Encoded(RandomCommand(random));
    for (size_t hits = random() % 3; hits > 0; --hits) {
      bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
    }
    OperatorCommand command;
    if (!IsUsable(Decode(bytes, command))) continue;
    ++taken;
    EXPECT_EQ(Encoded(command), bytes);
  }
  EXPECT_GT(taken, 1000);
}

TEST(ControlMessages, ABufferThatIsTooSmallIsNotWritten) {
  const Bytes goal = Encoded(ExampleGoal());
  for (size_t size = 0; size < goal.size(); ++size) {
    Bytes buffer(size, 0xa5);
    int size_bytes = -1;
    EXPECT_EQ(Encode(ExampleGoal(), buffer, size_bytes), Status::kCapacityExceeded);
    EXPECT_EQ(size_bytes, 0);
    EXPECT_EQ(buffer, Bytes(size, 0xa5));
  }
}

template <typename Message>
void ExpectOnlyInItsOwnSize(const Message& message) {
  const Bytes whole = Encoded(message);
  for (size_t size = 0; size <= whole.size(); ++size) {
    SCOPED_TRACE(size);
    const bool fits = size == whole.size();
    Bytes buffer(size, 0xa5);
    int size_bytes = -1;
    EXPECT_EQ(Encode(message, buffer, size_bytes), fits ? Status::kOk : Status::kCapacityExceeded);
    EXPECT_EQ(size_bytes, fits ? static_cast<int>(size) : 0);
    EXPECT_EQ(buffer, fits ? whole : Bytes(size, 0xa5));
  }
}

TEST(ControlMessages, QuestionsAndAnswersNeedABufferOfTheirOwnSizeAndNoMore) {
  ExpectOnlyInItsOwnSize(Question{Kind::kGetStatus, 1, 0});
  ExpectOnlyInItsOwnSize(Question{Kind::kGetParameters, 2, 3});
  ExpectOnlyInItsOwnSize(Done{4, Status::kNotPermitted, 5});
  const Bytes text = {'a', '='};
  ExpectOnlyInItsOwnSize(ParametersPart{6, 0, 2, text});
}

TEST(ControlMessages, AnAliveCarriesAPressOrNone) {
  for (const uint32_t press : {0u, 1u, 0xffffffffu}) {
    OperatorCommand command;
    command.kind = Kind::kAlive;
    command.sequence = 5;
    command.press = press;
    uint8_t bytes[kMaxMessageBytes];
    int size_bytes = 0;
    ASSERT_EQ(Encode(command, bytes, size_bytes), Status::kOk);
    EXPECT_EQ(size_bytes, press == 0 ? 12 : 16);
    OperatorCommand read;
    read.press = 99;
    ASSERT_EQ(Decode({bytes, static_cast<size_t>(size_bytes)}, read), Status::kOk);
    EXPECT_EQ(read.press, press);
  }
  // A press of 0 is written as none.
  const uint8_t zero[] = {0x48, 0x50, 0x43, 0x54, 1, 6, 16, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  OperatorCommand command;
  EXPECT_EQ(Decode(zero, command), Status::kInvalidArgument);
}

}  // namespace
}  // namespace hardpack::control
