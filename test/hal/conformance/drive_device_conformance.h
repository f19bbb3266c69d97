// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "hal/onboard/vehicle_loop/devices.h"

// What every DriveDevice has to do (hal/onboard/vehicle_loop/devices.h). A Harness has one, and
// what it talks to:
//
//   Device, device(), now_ns()
//   Step(demand)  a tick of 10 ms: what the drives send, device().Tick, what they take
//   Silence()     from now on they send nothing

namespace hardpack {

template <typename Harness>
class DriveDeviceConformance : public testing::Test {
 protected:
  static_assert(DriveDevice<typename Harness::Device>);
  static constexpr DriveDemand kTurn = {true, false, {4.0f, 4.0f}};

  DriveFeedback State() { return harness_.device().State(harness_.now_ns()); }
  template <typename Holds>
  bool Until(const Holds& holds, const DriveDemand& demand) {
    for (int tick = 0; tick < 1500; ++tick) {
      if (holds(State())) return true;
      harness_.Step(demand);
    }
    return holds(State());
  }
  bool Drives() {
    return Until([](const DriveFeedback& drives) { return drives.ready; }, {}) &&
           Until([](const DriveFeedback& drives) { return drives.enabled; }, {true, false, {}}) &&
           Until([](const DriveFeedback& drives) { return drives.wheels.left_radps > 1.0f; },
                 kTurn);
  }

  Harness harness_;
};
TYPED_TEST_SUITE_P(DriveDeviceConformance);

TYPED_TEST_P(DriveDeviceConformance, KnowsNothingOfDrivesThatSayNothing) {
  this->harness_.Silence();
  for (int tick = 0; tick < 300; ++tick) {
    this->harness_.Step(this->kTurn);
    const DriveFeedback drives = this->State();
    ASSERT_FALSE(drives.ready || drives.enabled || drives.standstill || drives.wheels.valid);
  }
}

TYPED_TEST_P(DriveDeviceConformance, BringsThemUpAndTurnsTheWheels) {
  EXPECT_TRUE(this->Drives());
  EXPECT_TRUE(this->State().ready);
  EXPECT_FALSE(this->State().standstill);
  EXPECT_GT(this->State().wheels.right_radps, 1.0f);
}

TYPED_TEST_P(DriveDeviceConformance, StopsThemWhereNothingIsWanted) {
  ASSERT_TRUE(this->Drives());
  EXPECT_TRUE(this->Until([](const DriveFeedback& drives) { return drives.standstill; }, {}));
  EXPECT_TRUE(this->Until([](const DriveFeedback& drives) { return !drives.enabled; }, {}));
}

TYPED_TEST_P(DriveDeviceConformance, TakesWhatIsNoNumberForZero) {
  ASSERT_TRUE(this->Drives());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(this->Until([](const DriveFeedback& drives) { return drives.standstill; },
                          {true, false, {nan, 4.0f}}));
}

TYPED_TEST_P(DriveDeviceConformance, TellsTheirSilence) {
  ASSERT_TRUE(this->Drives());
  this->harness_.Silence();
  for (int tick = 0; tick < 100; ++tick) this->harness_.Step(this->kTurn);
  EXPECT_TRUE(this->State().faulty);
  EXPECT_FALSE(this->State().enabled || this->State().standstill);
}

REGISTER_TYPED_TEST_SUITE_P(DriveDeviceConformance, KnowsNothingOfDrivesThatSayNothing,
                            BringsThemUpAndTurnsTheWheels, StopsThemWhereNothingIsWanted,
                            TakesWhatIsNoNumberForZero, TellsTheirSilence);

}  // namespace hardpack
