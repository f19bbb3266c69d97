// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/vehicle/sevcon_drive.h"

#include <cmath>

#include "gtest/gtest.h"
#include "test/tools/sim/vehicle/bus.h"

// The simulated drive against the standards' own rules, by frames made by hand.

namespace hardpack::sim {
namespace {

using test::Bus;
using test::MakeFrame;

int16_t Status(const CanFrame& tpdo) {
  return static_cast<int16_t>(tpdo.data[0] | tpdo.data[1] << 8);
}
int32_t Speed_rpm(const CanFrame& tpdo) {
  uint32_t bits = 0;
  for (int i = 5; i >= 2; --i) bits = bits << 8 | tpdo.data[i];
  return static_cast<int32_t>(bits);
}

TEST(SevconDriveNmt, SaysThatItBootedAndIsPreOperational) {
  Bus bus;
  bus.RunMs(299);
  EXPECT_TRUE(bus.log().empty());
  bus.RunMs(2);
  ASSERT_EQ(bus.log().size(), 1u);
  EXPECT_EQ(bus.log()[0], MakeFrame(0x702, {0}));
  bus.Run(1.0);  // heartbeats every 500 ms unless told otherwise
  EXPECT_EQ(bus.Count(0x702), 3);
  EXPECT_EQ(*bus.Newest(0x702), MakeFrame(0x702, {0x7f}));
}

TEST(SevconDriveNmt, ObeysCommandsToItsNodeAndToAll) {
  Bus bus;
  bus.Run(0.4);
  bus.Send(MakeFrame(0x000, {1, 3}));  // another's
  EXPECT_EQ(bus.drive().nmt_state(), NmtState::kPreOperational);
  bus.Send(MakeFrame(0x000, {1, 2}));
  EXPECT_EQ(bus.drive().nmt_state(), NmtState::kOperational);
  bus.Send(MakeFrame(0x000, {2, 0}));
  EXPECT_EQ(bus.drive().nmt_state(), NmtState::kStopped);
  EXPECT_FALSE(bus.AskRead(0x1000, 0)) << "no SDO in the state stopped";
  bus.Send(MakeFrame(0x000, {128, 2}));
  EXPECT_EQ(bus.drive().nmt_state(), NmtState::kPreOperational);
  const size_t from = bus.log().size();
  bus.Send(MakeFrame(0x000, {129, 2}));
  bus.Run(0.4);
  EXPECT_EQ(*bus.Newest(0x702, from), MakeFrame(0x702, {0}));
}

TEST(SevconDriveSdo, TellsItsIdentity) {
  Bus bus;
  bus.Run(0.4);
  EXPECT_EQ(bus.Read(0x1018, 0), 4u);
  EXPECT_EQ(bus.Read(0x1018, 1), 0x1eu);
  EXPECT_EQ(bus.Read(0x1018, 2), 0x07055037u);
  EXPECT_EQ(bus.Read(0x1000, 0) & 0xffff, 402u);
  const auto answer = bus.AskRead(0x1001, 0);
  ASSERT_TRUE(answer);
  EXPECT_EQ(*answer, MakeFrame(0x582, {0x4f, 0x01, 0x10, 0, 0, 0, 0, 0})) << "one byte, expedited";
}

TEST(SevconDriveSdo, SendsALongStringInSegments) {
  Bus bus;
  bus.Run(0.4);
  const auto first = bus.AskRead(0x1008, 0);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->data[0], 0x41);
  const uint32_t size = Bus::Word(*first);
  std::string text;
  int toggle = 0;
  for (bool last = false; !last; toggle ^= 0x10) {
    const auto segment = bus.Ask(MakeFrame(0x602, {0x60 | toggle, 0, 0, 0, 0, 0, 0, 0}));
    ASSERT_TRUE(segment);
    ASSERT_EQ(segment->data[0] & 0xf0, toggle);
    last = (segment->data[0] & 1) != 0;
    const int used = 7 - (segment->data[0] >> 1 & 7);
    text.append(segment->data + 1, segment->data + 1 + used);
  }
  EXPECT_EQ(text, "Gen4 (simulated)");
  EXPECT_EQ(size, text.size());
}

TEST(SevconDriveSdo, RefusesASegmentWithTheWrongToggleBit) {
  Bus bus;
  bus.Run(0.4);
  bus.AskRead(0x1008, 0);
  const auto answer = bus.Ask(MakeFrame(0x602, {0x70, 0, 0, 0, 0, 0, 0, 0}));
  ASSERT_TRUE(answer);
  EXPECT_EQ(Bus::Abort(*answer), 0x05030000u);
}

TEST(SevconDriveSdo, AbortsWithTheStandardsCodes) {
  Bus bus;
  bus.Run(0.4);
  EXPECT_EQ(Bus::Abort(*bus.AskRead(0x3fff, 0)), 0x06020000u);
  EXPECT_EQ(Bus::Abort(*bus.AskRead(0x1018, 9)), 0x06090011u);
  EXPECT_EQ(Bus::Abort(*bus.AskRead(0x5000, 2)), 0x06010001u) << "the password is not told";
  EXPECT_EQ(bus.Write(0x6041, 0, 0, 2), 0x06010002u);
  EXPECT_EQ(bus.Write(0x1017, 0, 100, 4), 0x06070010u);
  EXPECT_EQ(bus.Write(0x1400, 5, 100, 2), 0x06090011u) << "the EDS has no event timer there";
  const auto block = bus.Ask(MakeFrame(0x602, {0xa0, 0x18, 0x10, 1, 0, 0, 0, 0}));
  EXPECT_EQ(Bus::Abort(*block), 0x05040001u);
  EXPECT_FALSE(bus.Ask(MakeFrame(0x602, {0x40, 0x18, 0x10, 1}))) << "SDO has eight bytes";
}

TEST(SevconDriveSdo, WantsALoginForSettingsAndSaysSoAt5310) {
  DriveSettings settings;
  settings.login_user = 7;
  settings.login_password = 0x4321;
  Bus bus(settings);
  bus.Run(0.4);
  EXPECT_EQ(bus.Read(0x5000, 1), 0u);
  EXPECT_EQ(bus.Write(0x1017, 0, 100, 2), 0x08000000u);
  EXPECT_EQ(bus.Read(0x5310, 0), 8u) << "access level too low";
  EXPECT_EQ(bus.Write(0x5000, 2, 0x4321, 2), 0x08000000u) << "user 0 has another";
  EXPECT_EQ(bus.Read(0x5310, 0), 9u) << "login failed";
  EXPECT_EQ(bus.Write(0x5000, 3, 7, 2), 0u);
  EXPECT_EQ(bus.Write(0x5000, 2, 0x4321, 2), 0u);
  EXPECT_EQ(bus.Read(0x5000, 1), 4u);
  EXPECT_EQ(bus.Write(0x1017, 0, 100, 2), 0u);
  EXPECT_EQ(bus.Read(0x1017, 0), 100u);
}

TEST(SevconDriveSdo, TakesSomeSettingsOnlyWhilePreOperational) {
  Bus bus;
  bus.Start();
  EXPECT_EQ(bus.Read(0x5110, 0), 5u);
  EXPECT_EQ(bus.Write(0x6060, 0, 4, 1), 0x08000000u);
  EXPECT_EQ(bus.Read(0x5310, 0), 4u) << "not in pre-operational";
  EXPECT_EQ(bus.Write(0x2800, 0, 1, 1), 0u);
  EXPECT_EQ(bus.Read(0x5110, 0), 0x7fu);
  EXPECT_EQ(bus.Write(0x6060, 0, 4, 1), 0u);
  EXPECT_EQ(bus.Read(0x6061, 0), 4u);
  EXPECT_EQ(bus.Write(0x2800, 0, 0, 1), 0u);
  EXPECT_EQ(bus.Read(0x5110, 0), 5u);
}

TEST(SevconDriveSdo, DoesNotGoPreOperationalWhileItsWheelsTurn) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 100, 2.0);
  EXPECT_EQ(bus.Write(0x2800, 0, 1, 1), 0x08000000u);
  EXPECT_EQ(bus.Read(0x5310, 0), 6u);
  EXPECT_EQ(bus.drive().nmt_state(), NmtState::kOperational);
}

TEST(SevconDriveSdo, RefusesValuesOutOfTheirRange) {
  Bus bus;
  bus.Start();
  bus.Write(0x2800, 0, 1, 1);
  EXPECT_EQ(bus.Write(0x5902, 0, 200, 1), 0x08000000u) << "a severity, no time";
  EXPECT_EQ(bus.Read(0x5310, 0), 11u);
  EXPECT_EQ(bus.Write(0x6060, 0, 1, 1), 0x08000000u);
  EXPECT_EQ(bus.Read(0x5310, 0), 10u);
}

TEST(SevconDriveSdo, ChangesAMappingOnlyWhileThePdoDoesNotExist) {
  Bus bus;
  bus.Start();
  bus.Write(0x2800, 0, 1, 1);
  EXPECT_EQ(bus.Write(0x1a00, 0, 0, 1), 0x08000022u);
  EXPECT_EQ(bus.Write(0x1800, 1, 0x80000182, 4), 0u);
  EXPECT_EQ(bus.Write(0x1a00, 1, 0x606c0020, 4), 0x08000022u) << "it still maps";
  EXPECT_EQ(bus.Write(0x1a00, 0, 0, 1), 0u);
  EXPECT_EQ(bus.Write(0x1a00, 1, 0x606c0020, 4), 0u);
  EXPECT_EQ(bus.Write(0x1a00, 2, 0x10180120, 4), 0u);
  EXPECT_EQ(bus.Write(0x1a00, 0, 2, 1), 0x06040041u) << "the identity cannot be mapped";
  EXPECT_EQ(bus.Write(0x1a00, 2, 0x606c0020, 4), 0u);
  EXPECT_EQ(bus.Write(0x1a00, 3, 0x60410010, 4), 0u);
  EXPECT_EQ(bus.Write(0x1a00, 0, 3, 1), 0x06040042u) << "80 bits";
  EXPECT_EQ(bus.Write(0x1a00, 0, 1, 1), 0u);
  EXPECT_EQ(bus.Write(0x1800, 1, 0x182, 4), 0u);
  bus.Write(0x2800, 0, 0, 1);
  const size_t from = bus.log().size();
  bus.Send(MakeFrame(0x080, {}));
  ASSERT_TRUE(bus.Newest(0x182, from));
  EXPECT_EQ(bus.Newest(0x182, from)->size, 4);
}

TEST(SevconDrivePower, WalksTheStatesOfCia402) {
  Bus bus;
  bus.Start();
  bus.Command(0x0f, 0, 0.1);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kSwitchOnDisabled) << "shutdown comes first";
  EXPECT_EQ(Status(*bus.Newest(0x182)) & 0x6f, 0x40);
  bus.Command(0x06, 0, 0.1);
  EXPECT_EQ(Status(*bus.Newest(0x182)) & 0x6f, 0x21);
  bus.Command(0x07, 0, 0.1);
  EXPECT_EQ(Status(*bus.Newest(0x182)) & 0x6f, 0x23);
  EXPECT_TRUE(bus.drive().braked());
  bus.Command(0x0f, 0, 0.1);
  EXPECT_EQ(Status(*bus.Newest(0x182)) & 0x6f, 0x27);
  EXPECT_FALSE(bus.drive().braked());
  bus.Command(0x07, 0, 0.1);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kSwitchedOn);
  bus.Command(0x00, 0, 0.1);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kSwitchOnDisabled);
}

TEST(SevconDrivePower, StopsQuicklyAndDisablesItself) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 60, 3.0);
  EXPECT_GT(bus.drive().wheel_radps(), 5.0);
  bus.Command(0x0b, 60, 0.1);
  EXPECT_EQ(Status(*bus.Newest(0x182)) & 0x6f, 0x07);
  bus.Command(0x0b, 60, 5.0);
  EXPECT_NEAR(bus.drive().wheel_radps(), 0.0, 0.05);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kSwitchOnDisabled);
}

TEST(SevconDrivePower, LeavesAFaultOnARisingEdgeOfFaultReset) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.drive().RaiseFault({0x2310, 0x03, 0x4e01});
  bus.Command(0x0f, 0, 0.2);
  EXPECT_EQ(Status(*bus.Newest(0x182)) & 0x4f, 0x08);
  bus.Command(0x8f, 0, 0.1);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kSwitchOnDisabled);
  EXPECT_EQ(*bus.Newest(0x082), MakeFrame(0x082, {0, 0, 0, 0, 0, 0, 0, 0})) << "error reset";
  EXPECT_EQ(bus.Read(0x1001, 0), 0u);
  bus.drive().RaiseFault({0x2310, 0x03, 0x4e01});
  bus.Command(0x8f, 0, 0.2);  // held, not rising
  EXPECT_EQ(bus.drive().power_state(), PowerState::kFault);
}

TEST(SevconDriveMotion, FollowsTheCommandedSpeedThroughGearAndSign) {
  DriveSettings settings;
  settings.gear_ratio = 20.0;
  settings.sign = -1;
  Bus bus(settings);
  bus.Start();
  bus.Enable();
  const double wheel_radps = 6.0;
  const double rpm = -wheel_radps * 20.0 * 60.0 / (2.0 * M_PI);
  bus.Command(0x0f, static_cast<int32_t>(std::lround(rpm)), 4.0);
  EXPECT_NEAR(bus.drive().wheel_radps(), wheel_radps, 0.05);
  EXPECT_NEAR(Speed_rpm(*bus.Newest(0x182)), rpm, 10.0);
}

TEST(SevconDriveMotion, WaitsTheDeadTimeAndDoesNotExceedSlewOrLimit) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 1000, 0.14);
  EXPECT_EQ(bus.drive().wheel_radps(), 0.0);
  double before_radps = 0.0;
  for (int i = 0; i < 300; ++i) {
    bus.Command(0x0f, 1000, 0.01);
    EXPECT_LE(bus.drive().wheel_radps() - before_radps, 17.0 * 0.01 + 1.0e-9);
    before_radps = bus.drive().wheel_radps();
  }
  EXPECT_NEAR(before_radps, 13.4, 1.0e-9);
}

TEST(SevconDriveMotion, DoesNotExceedTheMaximumMotorSpeed) {
  Bus bus;
  bus.Start();
  bus.Write(0x6080, 0, 50, 4);
  bus.Enable();
  bus.Command(0x0f, 100, 4.0);
  EXPECT_NEAR(bus.drive().reported_rpm(), 50, 1);
}

TEST(SevconDriveMotion, IsHeldByItsBrakeUnlessEnabled) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 60, 3.0);
  bus.Command(0x07, 60, 1.0);
  EXPECT_TRUE(bus.drive().braked());
  EXPECT_EQ(bus.drive().wheel_radps(), 0.0);
}

TEST(SevconDriveMotion, FeedsTheBatteryWhileBraking) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 100, 3.0);
  bus.Command(0x0f, 0, 0.4);
  const auto current = static_cast<int16_t>(bus.Read(0x5100, 2));
  EXPECT_LT(current, 0);
  EXPECT_NEAR(static_cast<double>(bus.Read(0x5100, 1)) / 16.0, 48.0, 3.0);
}

TEST(SevconDriveWatches, StopsByItselfWhenNoCommandsCome) {
  Bus bus;
  bus.Start(2);
  bus.Enable();
  bus.Command(0x0f, 80, 3.0);
  const size_t from = bus.log().size();
  bus.Run(0.19);
  EXPECT_FALSE(bus.Newest(0x082, from));
  bus.Run(0.02);
  ASSERT_TRUE(bus.Newest(0x082, from));
  EXPECT_EQ(bus.Newest(0x082, from)->data[0], 0x50);
  EXPECT_EQ(bus.Newest(0x082, from)->data[1], 0x82);
  bus.Run(4.0);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kFault);
  EXPECT_NEAR(bus.drive().wheel_radps(), 0.0, 0.05);
}

TEST(SevconDriveWatches, GoesOnTurningWithoutTheTimeOut) {
  Bus bus;
  bus.Start(0);
  bus.Enable();
  bus.Command(0x0f, 80, 3.0);
  bus.Run(3.0);
  EXPECT_GT(bus.drive().wheel_radps(), 7.0) << "off unless switched on at 5902h";
}

TEST(SevconDriveWatches, SlowsDownAndComesBackWithSeverityOne) {
  Bus bus;
  bus.Start(1);
  bus.Enable();
  bus.Command(0x0f, 80, 3.0);
  bus.Run(4.0);
  EXPECT_NEAR(bus.drive().wheel_radps(), 0.0, 0.1);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kEnabled);
  EXPECT_NE(bus.drive().statusword() & 0x80, 0);
  bus.Command(0x0f, 80, 3.0);
  EXPECT_GT(bus.drive().wheel_radps(), 7.0);
}

TEST(SevconDriveWatches, TakesTheTimeOutFromTheEventTimerWhereItHasOne) {
  DriveSettings settings;
  settings.has_rpdo_event_timer = true;
  Bus bus(settings);
  bus.Start(2);
  ASSERT_EQ(bus.Write(0x1400, 5, 50, 2), 0u);
  bus.Enable();
  bus.Run(0.1);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kFault);
}

TEST(SevconDriveWatches, FaultsWhenTheMastersHeartbeatEnds) {
  Bus bus;
  bus.Start();
  bus.Write(0x1016, 1, 1 << 16 | 100, 4);
  bus.Enable();
  EXPECT_EQ(bus.drive().power_state(), PowerState::kEnabled) << "not watched before the first";
  bus.Send(MakeFrame(0x701, {5}));
  bus.Command(0x0f, 50, 0.09);
  EXPECT_EQ(bus.drive().power_state(), PowerState::kEnabled);
  const size_t from = bus.log().size();
  bus.Command(0x0f, 50, 0.05);
  EXPECT_NE(bus.drive().power_state(), PowerState::kEnabled);
  EXPECT_EQ(bus.drive().nmt_state(), NmtState::kPreOperational);
  ASSERT_TRUE(bus.Newest(0x082, from));
  EXPECT_EQ(bus.Newest(0x082, from)->data[0], 0x30);
  EXPECT_EQ(bus.Newest(0x082, from)->data[1], 0x81);
}

TEST(SevconDrivePdo, AnswersEveryNthSync) {
  Bus bus;
  bus.Start();
  for (const int type : {1, 3, 240}) {
    bus.Write(0x1800, 2, type, 1);
    bus.Send(MakeFrame(0x000, {128, 2}));
    bus.Send(MakeFrame(0x000, {1, 2}));
    const size_t from = bus.log().size();
    for (int i = 0; i < 480; ++i) bus.Send(MakeFrame(0x080, {}));
    EXPECT_EQ(bus.Count(0x182, from), 480 / type) << type;
  }
}

TEST(SevconDrivePdo, SendsByItselfWithAnEventTimer) {
  Bus bus;
  bus.Start();
  bus.Write(0x1800, 2, 255, 1);
  bus.Write(0x1800, 5, 50, 2);
  bus.Run(0.1);
  const size_t from = bus.log().size();
  bus.Run(1.0);
  EXPECT_EQ(bus.Count(0x182, from), 20);
}

TEST(SevconDrivePdo, SendsNoneUnlessOperational) {
  Bus bus;
  bus.Start();
  bus.Send(MakeFrame(0x000, {128, 2}));
  const size_t from = bus.log().size();
  bus.Send(MakeFrame(0x080, {}));
  EXPECT_FALSE(bus.Newest(0x182, from));
  bus.Command(0x06, 0, 0.1);
  EXPECT_EQ(bus.drive().rpdos(), 0u);
}

TEST(SevconDrivePdo, WaitsForSyncWithASynchronousRpdo) {
  Bus bus;
  bus.Start();
  bus.Write(0x1400, 2, 1, 1);
  bus.Send(MakeFrame(0x202, {6, 0, 7, 0, 0, 0, 0xe8, 3}));
  EXPECT_EQ(bus.Read(0x60ff, 0), 0u);
  bus.Send(MakeFrame(0x080, {}));
  EXPECT_EQ(bus.Read(0x60ff, 0), 7u);
}

TEST(SevconDrivePdo, ReportsAShortOneAndDoesNotUseIt) {
  Bus bus;
  bus.Start();
  const size_t from = bus.log().size();
  bus.Send(MakeFrame(0x202, {6, 0, 7, 0, 0, 0, 0xe8}));
  ASSERT_TRUE(bus.Newest(0x082, from));
  EXPECT_EQ(bus.Newest(0x082, from)->data[0], 0x10);
  EXPECT_EQ(bus.Newest(0x082, from)->data[1], 0x82);
  EXPECT_EQ(bus.Read(0x60ff, 0), 0u);
}

TEST(SevconDriveEmcy, HasCodeRegisterAndTheMakersFaultId) {
  Bus bus;
  bus.Start();
  bus.drive().SendEmergency({0x3220, 0x05, 0x45c1});
  bus.RunMs(1);
  EXPECT_EQ(*bus.Newest(0x082), MakeFrame(0x082, {0x20, 0x32, 0x05, 0xc1, 0x45, 0, 0, 0}));
  EXPECT_EQ(bus.Read(0x1001, 0), 5u);
  EXPECT_NE(bus.drive().power_state(), PowerState::kFault);
}

TEST(SevconDriveFault, SilentNeitherSendsNorHears) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 50, 1.0);
  bus.drive().faults().silent = true;
  const size_t from = bus.log().size();
  bus.Command(0x0f, 50, 4.0);
  EXPECT_EQ(bus.log().size(), from);
  EXPECT_NEAR(bus.drive().wheel_radps(), 0.0, 0.05) << "its own time-out";
}

TEST(SevconDriveFault, RebootForgetsWhatWasWritten) {
  Bus bus;
  bus.Start();
  bus.drive().SetObject(0x1018, 2, 0x1234);
  bus.drive().Reboot(false);
  const size_t from = bus.log().size();
  bus.Run(0.4);
  EXPECT_FALSE(bus.Newest(0x702, from)) << "quietly";
  EXPECT_EQ(bus.Read(0x6060, 0), 4u);
  EXPECT_EQ(bus.Read(0x5000, 1), 0u);
  EXPECT_EQ(bus.Read(0x1018, 2), 0x1234u) << "what it is stays";
}

TEST(SevconDriveFault, KeyOffIsUnderVoltageThenSilence) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.Command(0x0f, 80, 2.0);
  const size_t from = bus.log().size();
  bus.drive().SetKey(false);
  bus.Run(1.0);
  ASSERT_EQ(bus.log().size(), from + 1);
  EXPECT_EQ(bus.log()[from].id, 0x082u);
  EXPECT_EQ(bus.drive().wheel_radps(), 0.0) << "the brake is spring-applied";
  bus.drive().SetKey(true);
  bus.Run(0.4);
  EXPECT_EQ(*bus.Newest(0x702, from), MakeFrame(0x702, {0}));
}

TEST(SevconDriveFault, CanFailEachTransferOfAnObject) {
  Bus bus;
  bus.Start();
  bus.drive().faults().sdo_aborts[0x6061] = 0x06060000;
  EXPECT_EQ(Bus::Abort(*bus.AskRead(0x6061, 0)), 0x06060000u);
  bus.drive().faults().sdo_silent.insert(0x1018);
  EXPECT_FALSE(bus.AskRead(0x1018, 1));
  bus.drive().faults().sdo_kept.insert(0x1017);
  EXPECT_EQ(bus.Write(0x1017, 0, 77, 2), 0u);
  EXPECT_EQ(bus.Read(0x1017, 0), 500u);
}

TEST(SevconDriveFault, CanTurnAndReportWrongly) {
  Bus bus;
  bus.Start();
  bus.Enable();
  bus.drive().faults().opposite = true;
  bus.Command(0x0f, 50, 3.0);
  EXPECT_LT(bus.drive().wheel_radps(), -4.0);
  EXPECT_NEAR(Speed_rpm(*bus.Newest(0x182)), -50, 2);
  bus.drive().faults().opposite = false;
  bus.drive().faults().frozen = true;
  bus.Command(0x0f, 50, 3.0);
  EXPECT_NEAR(Speed_rpm(*bus.Newest(0x182)), -50, 2);
  bus.drive().faults().frozen = false;
  bus.drive().faults().speed_offset_rpm = 30;
  bus.Command(0x0f, 50, 3.0);
  EXPECT_NEAR(Speed_rpm(*bus.Newest(0x182)), 80, 2);
  bus.drive().LoseEnable();
  EXPECT_EQ(bus.drive().power_state(), PowerState::kSwitchOnDisabled);
}

TEST(SevconDrive, GivesTheSameFramesForTheSameCalls) {
  const auto run = [](int step_ms) {
    Bus bus;
    bus.Start();
    bus.Enable();
    for (int ms = 0; ms < 2000; ms += step_ms) bus.RunMs(step_ms);
    return bus.log();
  };
  EXPECT_EQ(run(1), run(10));
}

}  // namespace
}  // namespace hardpack::sim
