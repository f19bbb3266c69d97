// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "hal/sevcon/sevcon.h"
#include "tools/sim/vehicle/sim_vehicle.h"

// The onboard program's CANopen master and the simulated drives, written apart from each other, on
// one bus: what each made of the standards has to fit the other's.

namespace hardpack::sim {
namespace {

class MasterAndDrives {
 public:
  explicit MasterAndDrives(const VehicleSettings& settings = WithGears()) : vehicle_(settings, 0) {
    params_.gear_ratio = 20.0f;
    params_.right_sign = -1;
    params_.login_user = settings.left.login_user;
    params_.login_password = settings.left.login_password;
  }

  static VehicleSettings WithGears() {
    VehicleSettings settings = DefaultVehicle();
    settings.left.gear_ratio = settings.right.gear_ratio = 20.0;
    settings.right.sign = -1;
    return settings;
  }

  DriveParams& params() { return params_; }
  SimVehicle& vehicle() { return vehicle_; }
  sevcon::DrivePair& master() { return master_; }

  void Start() { ASSERT_EQ(master_.Configure(params_), hardpack::Status::kOk); }

  // For messages of failed tests: what the master makes of each drive.
  std::string Reports() const {
    std::string text;
    for (const sevcon::Side side : {sevcon::Side::kLeft, sevcon::Side::kRight}) {
      const sevcon::DriveReport& report = master_.report(side);
      text += "state " + std::to_string(static_cast<int>(report.state)) + " fault " +
              std::to_string(static_cast<int>(report.fault)) + " object " +
              std::to_string(report.sdo_index) + " abort " + std::to_string(report.sdo_abort_code) +
              "; ";
    }
    return text;
  }

  void Run(double seconds, const DriveDemand& demand = {}) {
    for (int i = 0; i < static_cast<int>(std::lround(100.0 * seconds)); ++i) {
      now_ns_ += 10'000'000;
      std::vector<CanFrame> of_drives;
      vehicle_.Advance(now_ns_, of_drives);
      for (const CanFrame& frame : of_drives) master_.TakeFrame(frame, now_ns_);
      CanBatch of_master;
      master_.Tick(now_ns_, demand, of_master);
      for (const CanFrame& frame : of_master) vehicle_.TakeFrame(frame, now_ns_);
    }
  }

  static DriveDemand Speed(float left_radps, float right_radps) {
    DriveDemand demand;
    demand.enable = true;
    demand.wheels = {left_radps, right_radps};
    return demand;
  }

 private:
  DriveParams params_;
  SimVehicle vehicle_;
  sevcon::DrivePair master_;
  uint64_t now_ns_ = 0;
};

TEST(MasterAndDrives, BringUpDriveAndStop) {
  MasterAndDrives both;
  both.Start();
  both.Run(5.0);
  ASSERT_TRUE(both.master().ready()) << both.Reports();
  for (const Side side : kBothSides) {
    EXPECT_EQ(both.vehicle().drive(side).object(0x5902, 0), 2);
    EXPECT_EQ(both.vehicle().drive(side).object(0x6061, 0), 3);
  }
  both.Run(4.0, MasterAndDrives::Speed(5.0f, 6.0f));
  EXPECT_TRUE(both.master().enabled());
  EXPECT_NEAR(both.vehicle().drive(Side::kLeft).wheel_radps(), 5.0, 0.1);
  EXPECT_NEAR(both.vehicle().drive(Side::kRight).wheel_radps(), 6.0, 0.1);
  const WheelFeedback feedback = both.master().feedback(9'000'000'000);
  EXPECT_TRUE(feedback.valid);
  EXPECT_NEAR(feedback.right_radps, 6.0f, 0.2f);
  both.Run(6.0);
  EXPECT_TRUE(both.vehicle().drive(Side::kLeft).braked());
  EXPECT_EQ(both.vehicle().speed_mps(), 0.0);
}

TEST(MasterAndDrives, DriveAModelledVehicleToo) {
  VehicleSettings settings = MasterAndDrives::WithGears();
  settings.model.emplace();
  MasterAndDrives both(settings);
  both.Start();
  both.Run(5.0);
  ASSERT_TRUE(both.master().ready()) << both.Reports();
  both.Run(20.0, MasterAndDrives::Speed(5.0f, 8.0f));
  EXPECT_TRUE(both.master().enabled()) << both.Reports();
  const WheelFeedback feedback = both.master().feedback(25'000'000'000);
  EXPECT_TRUE(feedback.valid);
  // The differential one as commanded in the end, the common one less what the turn takes.
  EXPECT_NEAR(feedback.right_radps - feedback.left_radps, 3.0f, 0.2f);
  EXPECT_NEAR(feedback.left_radps, both.vehicle().drive(Side::kLeft).wheel_radps(), 0.1);
  EXPECT_NEAR(both.vehicle().yaw_rate_radps(), 2.0 * 0.3 * 1.5 / settings.model->skid_baseline_m,
              0.03);
  both.Run(6.0);
  EXPECT_TRUE(both.vehicle().drive(Side::kLeft).braked());
  EXPECT_EQ(both.vehicle().drive(Side::kLeft).wheel_radps(), 0.0);
  EXPECT_NEAR(both.vehicle().speed_mps(), 0.0, 1.0e-6);
  EXPECT_GT(both.vehicle().driven_m(), 20.0);
}

TEST(MasterAndDrives, HearOfABlockedWheelOfAModelledVehicle) {
  VehicleSettings settings = MasterAndDrives::WithGears();
  settings.model.emplace();
  MasterAndDrives both(settings);
  both.Start();
  both.Run(5.0);
  both.vehicle().drive(Side::kLeft).faults().blocked = true;
  both.Run(3.0, MasterAndDrives::Speed(5.0f, 5.0f));
  EXPECT_EQ(both.vehicle().drive(Side::kLeft).wheel_radps(), 0.0);
  EXPECT_GT(both.vehicle().drive(Side::kRight).wheel_radps(), 1.0);
}

TEST(MasterAndDrives, FindTheirWayThroughEveryWayOfConfiguration) {
  VehicleSettings settings = MasterAndDrives::WithGears();
  for (DriveSettings* drive : {&settings.left, &settings.right}) {
    drive->login_user = 4;
    drive->login_password = 0x4321;
    drive->has_rpdo_event_timer = true;
  }
  MasterAndDrives both(settings);
  both.params().motor_acceleration_rpmps = 3000.0f;
  // Somebody else watches others already.
  for (const Side side : kBothSides) {
    both.vehicle().drive(side).SetObject(0x1016, 1, 0x7f << 16 | 1000);
  }
  both.Start();
  both.Run(6.0);
  ASSERT_TRUE(both.master().ready()) << both.Reports();
  EXPECT_EQ(both.vehicle().drive(Side::kLeft).object(0x1400, 5), both.params().command_timeout_ms);
  EXPECT_EQ(both.vehicle().drive(Side::kLeft).object(0x6083, 0), 3000);
  EXPECT_EQ(both.vehicle().drive(Side::kLeft).object(0x1016, 1), 0x7f << 16 | 1000);
  EXPECT_EQ(both.vehicle().drive(Side::kLeft).object(0x1016, 2), 1 << 16 | 300);
}

// As the EDS has 1005h by default: each sends SYNC until it is told not to.
TEST(MasterAndDrives, TakeSyncFromDrivesThatWereNotConfiguredYet) {
  MasterAndDrives both;
  for (const Side side : kBothSides) {
    both.vehicle().drive(side).SetObject(0x1005, 0, 0x40000080);
  }
  both.Start();
  both.Run(5.0);
  ASSERT_TRUE(both.master().ready()) << both.Reports();
  EXPECT_FALSE(both.master().foreign_sender());
  for (const Side side : kBothSides) {
    EXPECT_EQ(both.vehicle().drive(side).object(0x1005, 0) & 0x40000000, 0);
  }
}

// SR-DRV01
TEST(MasterAndDrives, StopBothWhenOneFaults) {
  MasterAndDrives both;
  both.Start();
  both.Run(5.0);
  both.Run(3.0, MasterAndDrives::Speed(6.0f, 6.0f));
  both.vehicle().drive(Side::kLeft).RaiseFault({0x2310, 3, 0x4e01});
  both.Run(4.0, MasterAndDrives::Speed(6.0f, 6.0f));
  EXPECT_EQ(both.master().report(sevcon::Side::kLeft).emergency_code, 0x2310);
  EXPECT_EQ(both.master().report(sevcon::Side::kLeft).sevcon_fault_id, 0x4e01);
  for (const Side side : kBothSides) {
    EXPECT_NEAR(both.vehicle().drive(side).wheel_radps(), 0.0, 0.1);
  }
}

TEST(MasterAndDrives, DriveAgainWhenTheFaultWasReset) {
  MasterAndDrives both;
  both.Start();
  both.Run(5.0);
  both.vehicle().drive(Side::kLeft).RaiseFault({0x2310, 3, 0x4e01});
  both.Run(1.0);
  EXPECT_FALSE(both.master().ready());
  DriveDemand reset;
  reset.reset_faults = true;
  both.Run(1.0, reset);
  both.Run(4.0);
  ASSERT_TRUE(both.master().ready()) << both.Reports();
  both.Run(4.0, MasterAndDrives::Speed(3.0f, 3.0f));
  EXPECT_NEAR(both.vehicle().drive(Side::kLeft).wheel_radps(), 3.0, 0.1);
}

// SR-DRV03
TEST(MasterAndDrives, StopByThemselvesWhenTheMasterDies) {
  MasterAndDrives both;
  both.Start();
  both.Run(5.0);
  both.Run(3.0, MasterAndDrives::Speed(6.0f, 6.0f));
  std::vector<CanFrame> sent;
  both.vehicle().Advance(13'000'000'000, sent);  // nobody speaks
  for (const Side side : kBothSides) {
    EXPECT_NEAR(both.vehicle().drive(side).wheel_radps(), 0.0, 0.1);
    EXPECT_EQ(both.vehicle().drive(side).power_state(), PowerState::kFault);
  }
}

}  // namespace
}  // namespace hardpack::sim
