// SPDX-License-Identifier: Apache-2.0
#include "core/safety/supervisor.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;

// A vehicle with which everything is well, until a test says otherwise.
struct Vehicle {
  Supervisor supervisor;
  SupervisorInput input;
  Permission permission;
  bool lidar_comes = true;
  bool look_comes = true;
  bool odometry_comes = true;
  bool ins_comes = true;
  bool plan_is_checked = true;

  // Without somebody who has to be there: what a test says is all that is said.
  static SafetyParams Unwatched() {
    SafetyParams params;
    params.operator_timeout_s = 0.0f;
    return params;
  }

  explicit Vehicle(const SafetyParams& params = Unwatched()) {
    EXPECT_EQ(supervisor.Configure(params), Status::kOk);
    input.now_ns = 5'000'000'000;
    input.bus_active = true;
    input.drives_ready = true;
    input.at_rest = true;
  }

  Permission Tick(const OperatorWishes& wishes = {}) {
    input.now_ns += kTick_ns;
    if (lidar_comes) input.lidar_ns = input.now_ns;
    if (look_comes) input.look_ns = input.now_ns;
    if (odometry_comes) input.odometry_ns = input.now_ns;
    if (ins_comes) input.ins_ns = input.now_ns;
    if (plan_is_checked) input.plan_checked_ns = input.now_ns;
    input.wishes = wishes;
    permission = supervisor.Judge(input);
    if (permission.drop_goal) {
      input.has_goal = false;
      input.has_plan = false;
      input.has_path = false;
    }
    return permission;
  }
  Permission Ticks(int count) {
    for (int i = 0; i < count; ++i) Tick();
    return permission;
  }
  void Arm() {
    EXPECT_EQ(Tick({.arm = true}).mode, Mode::kArmed);
    input.drives_enabled = true;
  }
  void Drive() {
    Arm();
    Tick({.go = true});
    input.has_goal = true;
    input.has_plan = true;
    input.has_path = true;
    EXPECT_EQ(Tick().mode, Mode::kDriving);
    input.at_rest = false;
    EXPECT_EQ(Tick().motion, Motion::kFollow);
  }
};

// SR-SUP01
TEST(Supervisor, BeginsInStandbyWithoutTorque) {
  Vehicle vehicle;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kStandby);
  EXPECT_EQ(vehicle.permission.motion, Motion::kOff);
}

TEST(Supervisor, ArmsWhenAllIsFreshAndHoldsStill) {
  Vehicle vehicle;
  const Permission armed = vehicle.Tick({.arm = true});
  EXPECT_EQ(armed.mode, Mode::kArmed);
  EXPECT_EQ(armed.motion, Motion::kHold);
  EXPECT_TRUE(armed.reset_faults);
  EXPECT_FALSE(vehicle.Tick().reset_faults);
  EXPECT_EQ(vehicle.Ticks(100).motion, Motion::kHold);
}

// SR-SUP02
TEST(Supervisor, SaysWhyItDoesNotArm) {
  struct Case {
    StopReason reason;
    void (*spoil)(Vehicle&);
  };
  const Case cases[] = {
      {StopReason::kLidarOld, [](Vehicle& v) { v.lidar_comes = false; }},
      {StopReason::kBlindAhead, [](Vehicle& v) { v.look_comes = false; }},
      {StopReason::kLidarCovered,
       [](Vehicle& v) {
         v.look_comes = false;
         v.input.blind_by = StopReason::kLidarCovered;
       }},
      {StopReason::kOdometryOld, [](Vehicle& v) { v.odometry_comes = false; }},
      {StopReason::kInsOld, [](Vehicle& v) { v.ins_comes = false; }},
      {StopReason::kBus, [](Vehicle& v) { v.input.bus_active = false; }},
      {StopReason::kDrives, [](Vehicle& v) { v.input.drives_ready = false; }},
      {StopReason::kDrives,  // a silent one: its fault may be reset, but it says nothing
       [](Vehicle& v) {
         v.input.drives_ready = v.odometry_comes = false;
         v.input.drives_faulty = true;
       }},
      {StopReason::kForeignSender, [](Vehicle& v) { v.input.foreign_sender = true; }},
      {StopReason::kMoving, [](Vehicle& v) { v.input.at_rest = false; }},
  };
  for (const Case& one : cases) {
    Vehicle vehicle;
    one.spoil(vehicle);
    const Permission permission = vehicle.Tick({.arm = true});
    EXPECT_EQ(permission.mode, Mode::kStandby);
    EXPECT_EQ(permission.wish_status, Status::kNotPermitted);
    EXPECT_EQ(permission.reason, one.reason);
    EXPECT_EQ(permission.motion, Motion::kOff);
  }
}

// SR-SUP01
TEST(Supervisor, RefusesAGoalUnlessArmed) {
  Vehicle vehicle;
  EXPECT_EQ(vehicle.Tick({.go = true}).wish_status, Status::kNotPermitted);
  EXPECT_TRUE(vehicle.permission.drop_goal);
  EXPECT_EQ(vehicle.permission.mode, Mode::kStandby);
}

// SR-SUP03
TEST(Supervisor, DrivesOnlyWithAPlanAndEnabledDrives) {
  Vehicle vehicle;
  vehicle.Arm();
  vehicle.input.drives_enabled = false;
  vehicle.Tick({.go = true});
  vehicle.input.has_goal = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kNoPlan);
  vehicle.input.has_plan = true;
  vehicle.input.has_path = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
  vehicle.input.drives_enabled = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);
}

TEST(Supervisor, WaitsArmedAfterArriving) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.arrived = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);  // still rolls
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
  EXPECT_TRUE(vehicle.permission.drop_goal);
  EXPECT_EQ(vehicle.permission.motion, Motion::kHold);
}

//   [>]------x
// SR-COR01
TEST(Supervisor, BrakesForAReturnInTheWayAndGoesOnWhenAPlanIsClearOfIt) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.ahead = WayAhead::kObstacle;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kStopAlong);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kObstacle);
  EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
  EXPECT_FALSE(vehicle.permission.drop_goal);
  vehicle.input.ahead_is_person = true;
  EXPECT_EQ(vehicle.Tick().reason, StopReason::kPerson);
  vehicle.input.ahead = WayAhead::kClear;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kNone);
}

// SR-MOV02 what would be touched before rest is braked for
TEST(Supervisor, BrakesWhereTheMotionItselfWouldTouch) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.sweep = WayAhead::kObstacle;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kStopAlong);
  EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kObstacle);
  vehicle.input.sweep = WayAhead::kClear;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
  vehicle.input.sweep = WayAhead::kTooNear;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  vehicle.input.sweep = WayAhead::kClear;
  EXPECT_EQ(vehicle.Ticks(10).motion, Motion::kZero) << "until it is at rest";
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
}

// SR-SUP10
TEST(Supervisor, ZeroAtOnceForAReturnTooNearAndStandsBeforeItFollowsAgain) {
  for (const bool is_person : {true, false}) {
    const StopReason reason = is_person ? StopReason::kPerson : StopReason::kObstacle;
    Vehicle vehicle;
    vehicle.Drive();
    vehicle.input.ahead = WayAhead::kTooNear;
    vehicle.input.ahead_is_person = is_person;
    EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
    EXPECT_EQ(vehicle.permission.reason, reason);
    vehicle.input.ahead = WayAhead::kClear;
    EXPECT_EQ(vehicle.Ticks(10).motion, Motion::kZero);
    EXPECT_EQ(vehicle.permission.reason, reason);
    vehicle.input.at_rest = true;
    EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
    EXPECT_EQ(vehicle.permission.reason, StopReason::kNone);
  }
  Vehicle stopping;
  stopping.Drive();
  EXPECT_EQ(stopping.Tick({.stop = true}).motion, Motion::kStopAlong);
  stopping.input.ahead = WayAhead::kTooNear;
  EXPECT_EQ(stopping.Tick().motion, Motion::kZero);
}

// SR-SPD03, SR-SUP10
TEST(Supervisor, APlanThatHoldsForAPersonStopsAtOnceAndUntilAtRest) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.at_rest = false;
  vehicle.input.held_by = StopReason::kUnseenGround;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kStopAlong);
  vehicle.input.held_by = StopReason::kPerson;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
  vehicle.input.held_by = StopReason::kNone;  // gone by, and the vehicle still rolls
  EXPECT_EQ(vehicle.Ticks(20).motion, Motion::kZero);
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
}

// Nor is there less of a hurry where there is no plan at all: the path that is cut to a stop leads
// towards the person.
// SR-SPD03, SR-SUP10
TEST(Supervisor, APersonForWhomThereIsNoPlanStopsAtOnceToo) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.at_rest = false;
  vehicle.input.has_plan = false;
  vehicle.input.held_by = StopReason::kNoWay;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kStopAlong);
  vehicle.input.held_by = StopReason::kPerson;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kPerson);
  vehicle.input.held_by = StopReason::kNone;
  vehicle.input.has_plan = true;
  EXPECT_EQ(vehicle.Ticks(20).motion, Motion::kZero);
}

// A safe stop along the path would let the vehicle roll on further.
//   driving, zero at once ---> safe stop, still zero ---> at rest
// SR-SUP10
TEST(Supervisor, ASafeStopDoesNotEndZeroAtOnce) {
  void (*const stops[])(Vehicle&) = {
      [](Vehicle& v) { v.Tick({.stop = true}); },    [](Vehicle& v) { v.Tick({.disarm = true}); },
      [](Vehicle& v) { v.lidar_comes = false; },     [](Vehicle& v) { v.ins_comes = false; },
      [](Vehicle& v) { v.plan_is_checked = false; },
  };
  void (*const causes[])(SupervisorInput&) = {
      [](SupervisorInput& input) { input.held_by = StopReason::kPerson; },
      [](SupervisorInput& input) { input.ahead = WayAhead::kTooNear; },
      [](SupervisorInput& input) { input.has_plan = input.has_path = false; },
  };
  for (const auto& cause : causes) {
    for (const auto& stop : stops) {
      Vehicle vehicle;
      vehicle.Drive();
      cause(vehicle.input);
      EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
      vehicle.input.held_by = StopReason::kNone;
      vehicle.input.ahead = WayAhead::kClear;
      vehicle.input.has_plan = vehicle.input.has_path = true;
      stop(vehicle);
      for (int i = 0; i < 150; ++i) ASSERT_EQ(vehicle.Tick().motion, Motion::kZero) << i;
      EXPECT_EQ(vehicle.permission.mode, Mode::kSafeStop);
      vehicle.input.at_rest = true;
      EXPECT_NE(vehicle.Tick().mode, Mode::kSafeStop);
    }
  }
}

// SR-SUP10
TEST(Supervisor, ZeroAtOnceForWhatComesInASafeStop) {
  Vehicle vehicle;
  vehicle.Drive();
  EXPECT_EQ(vehicle.Tick({.stop = true}).motion, Motion::kStopAlong);
  vehicle.input.held_by = StopReason::kPerson;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  vehicle.input.held_by = StopReason::kNone;
  EXPECT_EQ(vehicle.Ticks(20).motion, Motion::kZero);

  Vehicle same_tick;
  same_tick.Drive();
  same_tick.input.ahead = WayAhead::kTooNear;
  EXPECT_EQ(same_tick.Tick({.stop = true}).motion, Motion::kZero);
}

// SR-SUP11
TEST(Supervisor, SaysWhyItWaitsAndSinceWhen) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.at_rest = true;
  for (const StopReason reason : {StopReason::kNoWay, StopReason::kUnseenGround,
                                  StopReason::kPerson, StopReason::kGoalInObstacle}) {
    vehicle.input.has_plan = reason == StopReason::kUnseenGround;
    vehicle.input.held_by = reason;
    EXPECT_EQ(vehicle.Tick().reason, reason);
    EXPECT_EQ(vehicle.permission.motion, Motion::kStopAlong);
    const uint64_t since_ns = vehicle.input.now_ns;
    EXPECT_EQ(vehicle.Ticks(50).reason, reason);
    EXPECT_EQ(vehicle.permission.reason_since_ns, since_ns);
    EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
    vehicle.input.held_by = StopReason::kNone;
    vehicle.input.has_plan = true;
    EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
    EXPECT_EQ(vehicle.permission.reason_since_ns, vehicle.input.now_ns);
  }
}

// SR-CMD03, SR-SUP09
TEST(Supervisor, MotionAgainstCommandsIsAFaultInEveryModeWithTorque) {
  for (const StopReason reason : {StopReason::kRunaway, StopReason::kWrongTurn, StopReason::kStuck,
                                  StopReason::kBadCommand}) {
    Vehicle driving;
    driving.Drive();
    driving.input.misbehaves = reason;
    EXPECT_EQ(driving.Tick().mode, Mode::kFault);
    EXPECT_EQ(driving.permission.reason, reason);
    EXPECT_EQ(driving.permission.motion, Motion::kOff);
    EXPECT_TRUE(driving.permission.drop_goal);
    Vehicle armed;
    armed.Arm();
    armed.input.misbehaves = reason;
    EXPECT_EQ(armed.Tick().mode, Mode::kFault);
    Vehicle stopping;
    stopping.Drive();
    stopping.Tick({.stop = true});
    stopping.input.misbehaves = reason;
    EXPECT_EQ(stopping.Tick().mode, Mode::kFault);
  }
}

TEST(Supervisor, StopsAlongThePathAndGoesOnWhenBlocked) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.has_plan = false;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kStopAlong);
  EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kNoPlan);
  EXPECT_FALSE(vehicle.permission.drop_goal);
  vehicle.input.at_rest = true;
  vehicle.Ticks(1000);
  EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
  vehicle.input.has_path = false;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  vehicle.input.has_plan = vehicle.input.has_path = true;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
}

// SR-SUP04, SR-SUP05
TEST(Supervisor, StopsSafelyWhenAnInputGrowsOldAndForgetsTheGoal) {
  struct Case {
    StopReason reason;
    bool Vehicle::*comes;
    float age_s;
  };
  const SafetyParams params;
  const Case cases[] = {
      {StopReason::kLidarOld, &Vehicle::lidar_comes, params.max_lidar_age_s},
      {StopReason::kBlindAhead, &Vehicle::look_comes, params.max_look_age_s},
      {StopReason::kOdometryOld, &Vehicle::odometry_comes, params.max_odometry_age_s},
      {StopReason::kInsOld, &Vehicle::ins_comes, params.max_ins_age_s},
      {StopReason::kPlanOld, &Vehicle::plan_is_checked, params.max_plan_age_s},
  };
  for (const Case& one : cases) {
    Vehicle vehicle;
    vehicle.Drive();
    vehicle.*one.comes = false;
    const int ticks = static_cast<int>(one.age_s * 100.0f) - 1;
    EXPECT_EQ(vehicle.Ticks(ticks).mode, Mode::kDriving);
    EXPECT_EQ(vehicle.Ticks(3).mode, Mode::kSafeStop);
    EXPECT_EQ(vehicle.permission.reason, one.reason);
    EXPECT_EQ(vehicle.permission.motion, Motion::kStopAlong);
    EXPECT_FALSE(vehicle.permission.drop_goal);  // its path is followed
    vehicle.*one.comes = true;                   // comes back: the vehicle stops all the same
    EXPECT_EQ(vehicle.Tick().mode, Mode::kSafeStop);
    vehicle.input.at_rest = true;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
    EXPECT_TRUE(vehicle.permission.drop_goal);
    EXPECT_EQ(vehicle.supervisor.last_stop(), one.reason);
    EXPECT_EQ(vehicle.Ticks(100).motion, Motion::kHold);  // and waits for a new goal
  }
}

// SR-SUP06
TEST(Supervisor, ZeroSpeedWhenAnInputIsFarTooOld) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.lidar_comes = false;
  EXPECT_EQ(vehicle.Ticks(40).motion, Motion::kStopAlong);
  EXPECT_EQ(vehicle.Ticks(55).motion, Motion::kZero);  // 0.9 s
}

// SR-SEE01: along a way that was not looked along for 3 x 0.42 s nothing is followed.
TEST(Supervisor, ZeroSpeedWhereTheWayWasNotLookedAlongForFarTooLong) {
  for (const StopReason by : {StopReason::kBlindAhead, StopReason::kLidarCovered,
                              StopReason::kLidarFrozen, StopReason::kLidarTurned}) {
    Vehicle vehicle;
    vehicle.Drive();
    vehicle.look_comes = false;
    vehicle.input.blind_by = by;
    EXPECT_EQ(vehicle.Ticks(42).mode, Mode::kDriving);
    EXPECT_EQ(vehicle.Ticks(2).mode, Mode::kSafeStop);
    EXPECT_EQ(vehicle.permission.reason, by);
    EXPECT_EQ(vehicle.permission.motion, Motion::kStopAlong);
    EXPECT_EQ(vehicle.Ticks(85).motion, Motion::kZero);  // 1.29 s
    vehicle.input.at_rest = true;
    vehicle.Ticks(2);
    EXPECT_EQ(vehicle.supervisor.last_stop(), by);
  }
}

// SR-SEE01: never looked is infinite: zero at once.
TEST(Supervisor, ZeroSpeedWhereTheWayWasNeverLookedAlong) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.look_comes = false;
  vehicle.input.look_ns = 0;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  EXPECT_EQ(vehicle.permission.mode, Mode::kSafeStop);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kBlindAhead);
}

// After ticks that were missed: in the tick in which the stop begins.
// SR-SUP06
TEST(Supervisor, ZeroSpeedAtOnceWhenAnInputHasBecomeFarTooOldBetweenTwoTicks) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.lidar_comes = false;
  vehicle.input.now_ns += 2'000'000'000;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  EXPECT_EQ(vehicle.permission.mode, Mode::kSafeStop);
}

// SR-SUP07
TEST(Supervisor, ZeroSpeedWhenASafeStopTakesTooLong) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.Tick({.stop = true});
  EXPECT_EQ(vehicle.Ticks(790).motion, Motion::kStopAlong);
  EXPECT_EQ(vehicle.Ticks(20).motion, Motion::kZero);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kStopTooLong);
}

// SR-SUP04
TEST(Supervisor, AStopDropsAGoalThatWaitsForItsPlan) {
  Vehicle vehicle;
  vehicle.Arm();
  vehicle.Tick({.go = true});
  vehicle.input.has_goal = true;
  EXPECT_FALSE(vehicle.Ticks(5).drop_goal);
  vehicle.input.has_plan = true;  // in the very tick
  vehicle.input.has_path = true;
  EXPECT_TRUE(vehicle.Tick({.stop = true}).drop_goal);
  EXPECT_EQ(vehicle.permission.mode, Mode::kArmed);
  EXPECT_EQ(vehicle.permission.motion, Motion::kHold);
  EXPECT_EQ(vehicle.permission.wish_status, Status::kOk);
  EXPECT_EQ(vehicle.Ticks(100).motion, Motion::kHold);
}

// SR-SUP10
TEST(Supervisor, FollowsNoNewPathBeforeItStandsOnceItHadNone) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.has_plan = false;
  vehicle.input.has_path = false;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kZero);
  vehicle.input.has_plan = true;
  vehicle.input.has_path = true;
  EXPECT_EQ(vehicle.Ticks(30).motion, Motion::kZero);
  EXPECT_EQ(vehicle.permission.mode, Mode::kDriving);
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().motion, Motion::kFollow);
}

// SR-SUP03
TEST(Supervisor, DoesNotSetOutOnAPlanThatNobodyHasCheckedLately) {
  Vehicle vehicle;
  vehicle.Arm();
  vehicle.Tick({.go = true});
  vehicle.input.has_goal = true;
  vehicle.input.has_plan = true;
  vehicle.input.has_path = true;
  vehicle.plan_is_checked = false;
  vehicle.input.plan_checked_ns = vehicle.input.now_ns - 2'000'000'000;
  EXPECT_EQ(vehicle.Ticks(50).mode, Mode::kArmed);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kPlanOld);
  vehicle.plan_is_checked = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);
}

// SR-SUP11
TEST(Supervisor, TellsTheLastStopUntilTheNextGoal) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.Tick({.stop = true});
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Ticks(3).mode, Mode::kArmed);
  EXPECT_EQ(vehicle.supervisor.last_stop(), StopReason::kOperator);
  vehicle.Tick({.go = true});
  EXPECT_EQ(vehicle.supervisor.last_stop(), StopReason::kNone);
}

// SR-OPR04
TEST(Supervisor, SilentOperatorStopsOnlyWhereItHasToSpeak) {
  Vehicle free;
  free.Drive();
  EXPECT_EQ(free.Ticks(1000).mode, Mode::kDriving);
  SafetyParams params;
  params.operator_timeout_s = 0.5f;
  Vehicle watched(params);
  watched.input.operator_ns = watched.input.now_ns;
  watched.Drive();
  EXPECT_EQ(watched.Ticks(60).mode, Mode::kSafeStop);
  EXPECT_EQ(watched.permission.reason, StopReason::kOperatorSilent);
}

// SR-SUP04, SR-SUP09
TEST(Supervisor, AFaultIsZeroInTheSameTickAndIsLeftByDisarmAlone) {
  struct Case {
    StopReason reason;
    void (*spoil)(SupervisorInput&);
    void (*mend)(SupervisorInput&);
  };
  const Case cases[] = {
      {StopReason::kDrives, [](SupervisorInput& i) { i.drives_faulty = true; },
       [](SupervisorInput& i) { i.drives_faulty = false; }},
      {StopReason::kDrives, [](SupervisorInput& i) { i.drives_enabled = false; },
       [](SupervisorInput& i) { i.drives_enabled = true; }},
      {StopReason::kBus, [](SupervisorInput& i) { i.bus_active = false; },
       [](SupervisorInput& i) { i.bus_active = true; }},
      {StopReason::kForeignSender, [](SupervisorInput& i) { i.foreign_sender = true; },
       [](SupervisorInput& i) { i.foreign_sender = false; }},
  };
  for (const Case& one : cases) {
    Vehicle vehicle;
    vehicle.Drive();
    one.spoil(vehicle.input);
    EXPECT_EQ(vehicle.Tick().mode, Mode::kFault);
    EXPECT_EQ(vehicle.permission.motion, Motion::kOff);
    EXPECT_EQ(vehicle.permission.reason, one.reason);
    EXPECT_TRUE(vehicle.permission.drop_goal);
    one.mend(vehicle.input);
    vehicle.input.at_rest = true;
    EXPECT_EQ(vehicle.Ticks(100).mode, Mode::kFault);
    EXPECT_EQ(vehicle.Tick({.arm = true}).wish_status, Status::kNotPermitted);
    EXPECT_EQ(vehicle.Tick({.disarm = true}).mode, Mode::kStandby);
    EXPECT_EQ(vehicle.Tick({.arm = true}).mode, Mode::kArmed);
  }
}

TEST(Supervisor, GivesDrivesTimeToResetTheirFaultsWhenArming) {
  Vehicle vehicle;
  vehicle.input.drives_faulty = true;
  vehicle.input.drives_ready = false;
  EXPECT_EQ(vehicle.Tick({.arm = true}).mode, Mode::kArmed);
  EXPECT_EQ(vehicle.Ticks(200).mode, Mode::kArmed);
  EXPECT_EQ(vehicle.Ticks(200).mode, Mode::kFault);
}

// Nobody resets faults then.
// SR-SUP09
TEST(Supervisor, ADriveThatFailsAfterArrivingOrStoppingIsAFaultAtOnce) {
  for (const bool arrives : {true, false}) {
    Vehicle vehicle;
    vehicle.Drive();
    vehicle.input.arrived = arrives;
    if (!arrives) vehicle.Tick({.stop = true});
    vehicle.input.at_rest = true;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
    vehicle.input.drives_faulty = true;
    vehicle.input.drives_ready = vehicle.input.drives_enabled = false;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kFault);
    EXPECT_EQ(vehicle.permission.reason, StopReason::kDrives);
  }
}

// SR-SUP08
TEST(Supervisor, EmergencyStopWorksInEveryModeAndBeatsEveryOtherWish) {
  for (int mode = 0; mode < 4; ++mode) {
    Vehicle vehicle;
    if (mode == 1) vehicle.Arm();
    if (mode >= 2) vehicle.Drive();
    if (mode == 3) vehicle.Tick({.stop = true});
    const Permission permission =
        vehicle.Tick({.arm = true, .disarm = true, .go = true, .emergency_stop = true});
    EXPECT_EQ(permission.mode, Mode::kEmergencyStop);
    EXPECT_EQ(permission.motion, Motion::kOff);
    EXPECT_TRUE(permission.drop_goal);
    EXPECT_EQ(vehicle.Ticks(1000).mode, Mode::kEmergencyStop);
    EXPECT_EQ(vehicle.Tick({.arm = true}).mode, Mode::kEmergencyStop);
    EXPECT_EQ(vehicle.Tick({.disarm = true}).mode, Mode::kStandby);
  }
}

// SR-SUP08
TEST(Supervisor, DisarmingWhileDrivingStopsFirst) {
  Vehicle vehicle;
  vehicle.Drive();
  EXPECT_EQ(vehicle.Tick({.disarm = true}).mode, Mode::kSafeStop);
  EXPECT_EQ(vehicle.Ticks(50).motion, Motion::kStopAlong);
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kStandby);
  EXPECT_EQ(vehicle.permission.motion, Motion::kOff);
}

// Whatever happens in whatever order: no motion but with everything that it needs.
// SR-SUP01, SR-SUP03, SR-SUP10
TEST(Supervisor, NeverLetsMoveWhatMayNot) {
  constexpr uint32_t kSeed = 20240611;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const auto chance = [&](double share) { return std::bernoulli_distribution(share)(random); };
  Vehicle vehicle;
  const SafetyParams params;
  int moved = 0;
  bool zero_went_out = false;
  for (int i = 0; i < 300'000; ++i) {
    if (chance(0.02)) vehicle.lidar_comes = chance(0.8);
    if (chance(0.02)) vehicle.odometry_comes = chance(0.8);
    if (chance(0.02)) vehicle.ins_comes = chance(0.8);
    if (chance(0.02)) vehicle.plan_is_checked = chance(0.9);
    if (chance(0.02)) vehicle.input.bus_active = chance(0.95);
    if (chance(0.02)) vehicle.input.drives_ready = chance(0.95);
    if (chance(0.02)) vehicle.input.drives_faulty = chance(0.05);
    if (chance(0.02)) vehicle.input.foreign_sender = chance(0.05);
    if (chance(0.05)) vehicle.input.drives_enabled = chance(0.9);
    if (chance(0.05)) vehicle.input.at_rest = chance(0.5);
    if (chance(0.05)) vehicle.input.arrived = chance(0.1);
    if (chance(0.05)) {
      const int ahead = std::uniform_int_distribution(0, 12)(random);
      vehicle.input.ahead = ahead == 0   ? WayAhead::kTooNear
                            : ahead == 1 ? WayAhead::kObstacle
                                         : WayAhead::kClear;
      vehicle.input.held_by = chance(0.1) ? StopReason::kPerson : StopReason::kNone;
    }
    if (vehicle.input.has_goal && chance(0.1)) {
      vehicle.input.has_plan = chance(0.8);
      vehicle.input.has_path = vehicle.input.has_plan || chance(0.5);
    }
    OperatorWishes wishes;
    const bool speaks = chance(0.1);
    const int wish = std::uniform_int_distribution(0, 4)(random);
    wishes.arm = speaks && wish == 0;
    wishes.go = speaks && wish == 1;
    wishes.disarm = speaks && wish == 2 && chance(0.3);
    wishes.stop = speaks && wish == 3 && chance(0.3);
    wishes.emergency_stop = speaks && wish == 4 && chance(0.1);
    const Mode before = vehicle.supervisor.mode();
    const SupervisorInput seen = [&] {
      vehicle.Tick(wishes);
      return vehicle.input;
    }();
    if (wishes.go && (before == Mode::kArmed || before == Mode::kDriving)) {
      vehicle.input.has_goal = !vehicle.permission.drop_goal;
    }
    const Permission& permission = vehicle.permission;
    if (permission.motion == Motion::kFollow) {
      ++moved;
      ASSERT_EQ(permission.mode, Mode::kDriving) << "step " << i;
      ASSERT_TRUE(seen.has_plan && seen.bus_active && seen.drives_enabled) << "step " << i;
      ASSERT_FALSE(seen.drives_faulty || seen.foreign_sender) << "step " << i;
      ASSERT_LE(static_cast<float>(seen.now_ns - seen.lidar_ns) * 1e-9f,
                params.max_lidar_age_s + 0.001f)
          << "step " << i;
      ASSERT_LE(static_cast<float>(seen.now_ns - seen.odometry_ns) * 1e-9f,
                params.max_odometry_age_s + 0.001f)
          << "step " << i;
    }
    if (permission.mode == Mode::kStandby || permission.mode == Mode::kFault ||
        permission.mode == Mode::kEmergencyStop) {
      ASSERT_EQ(permission.motion, Motion::kOff) << "step " << i;
    }
    if (permission.mode == Mode::kArmed) {
      ASSERT_EQ(permission.motion, Motion::kHold) << "step " << i;
    }
    // Once zero went out at once, nothing is followed before it stands.
    if (seen.at_rest) zero_went_out = false;
    if (zero_went_out) {
      ASSERT_NE(permission.motion, Motion::kFollow) << "step " << i;
      ASSERT_NE(permission.motion, Motion::kStopAlong) << "step " << i;
    }
    if (permission.motion == Motion::kZero && !seen.at_rest) zero_went_out = true;
    // Nothing but a wish to arm leaves standby.
    if (before == Mode::kStandby && permission.mode != Mode::kStandby) {
      ASSERT_TRUE(wishes.arm || wishes.emergency_stop) << "step " << i;
    }
  }
  EXPECT_GT(moved, 1000);
}

TEST(Supervisor, RefusesParametersOutOfRangeAndPermitsNothingWithout) {
  Supervisor supervisor;
  SupervisorInput input;
  input.wishes.arm = true;
  EXPECT_EQ(supervisor.Judge(input).motion, Motion::kOff);
  EXPECT_EQ(supervisor.Configure({.max_lidar_age_s = 100.0f}), Status::kParameterOutOfRange);
}

// SR-ARE03
TEST(Supervisor, WhereAnAreaForbidsItToBeItStopsAtOnceAndDoesNotSetOut) {
  for (const StopReason reason : {StopReason::kAreaBreached, StopReason::kAreaUnknown}) {
    Vehicle vehicle;
    vehicle.Drive();
    vehicle.input.area = reason;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kSafeStop);
    EXPECT_EQ(vehicle.permission.reason, reason);
    const bool is_breached = reason == StopReason::kAreaBreached;
    EXPECT_EQ(vehicle.permission.motion, is_breached ? Motion::kZero : Motion::kStopAlong);
    vehicle.input.at_rest = true;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
    EXPECT_FALSE(vehicle.input.has_goal);
    // A goal is taken, and waits.
    EXPECT_EQ(vehicle.Tick({.go = true}).wish_status, Status::kOk);
    vehicle.input.has_goal = true;
    vehicle.input.has_plan = true;
    vehicle.input.has_path = true;
    EXPECT_EQ(vehicle.Ticks(100).mode, Mode::kArmed);
    EXPECT_EQ(vehicle.permission.reason, reason);
    EXPECT_EQ(vehicle.permission.motion, Motion::kHold);
    vehicle.input.area = StopReason::kNone;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);
  }
}

// SR-SPD07
TEST(Supervisor, AWheelThatDropsStopsItAtOnceAndForGood) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.ground_drops = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kSafeStop);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kGroundDrops);
  EXPECT_EQ(vehicle.permission.motion, Motion::kZero);
  vehicle.input.ground_drops = false;
  EXPECT_EQ(vehicle.Ticks(3).motion, Motion::kZero) << "the path is not followed, not even to rest";
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
  EXPECT_FALSE(vehicle.input.has_goal);
  EXPECT_EQ(vehicle.supervisor.last_stop(), StopReason::kGroundDrops);
}

// SR-TLT01: along its path, and it does not set out before it leans less.
TEST(Supervisor, ABodyThatLeansTooFarStopsItAndKeepsItThere) {
  Vehicle vehicle;
  vehicle.Drive();
  vehicle.input.is_tilted = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kSafeStop);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kTilted);
  EXPECT_EQ(vehicle.permission.motion, Motion::kStopAlong);
  vehicle.input.at_rest = true;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
  EXPECT_EQ(vehicle.supervisor.last_stop(), StopReason::kTilted);
  EXPECT_EQ(vehicle.Tick({.go = true}).wish_status, Status::kOk);
  vehicle.input.has_goal = true;
  vehicle.input.has_plan = true;
  vehicle.input.has_path = true;
  EXPECT_EQ(vehicle.Ticks(100).mode, Mode::kArmed);
  EXPECT_EQ(vehicle.permission.reason, StopReason::kTilted);
  vehicle.input.is_tilted = false;
  EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);
}

// SR-ARE03
TEST(Supervisor, DoesNotArmWhereAnAreaForbidsItToBe) {
  for (const StopReason reason : {StopReason::kAreaBreached, StopReason::kAreaUnknown}) {
    Vehicle vehicle;
    vehicle.input.area = reason;
    EXPECT_EQ(vehicle.Tick({.arm = true}).mode, Mode::kStandby);
    EXPECT_EQ(vehicle.permission.wish_status, Status::kNotPermitted);
    EXPECT_EQ(vehicle.permission.reason, reason);
    vehicle.input.area = StopReason::kNone;
    EXPECT_EQ(vehicle.Tick({.arm = true}).mode, Mode::kArmed);
  }
}

// SR-ARE03, SR-MIS02
TEST(Supervisor, ToldOfAPauseAndAnAreaItSaysTheAreaAndWhenThatEndsItStillHolds) {
  for (const StopReason reason : {StopReason::kAreaBreached, StopReason::kAreaUnknown}) {
    Vehicle vehicle;
    vehicle.Drive();
    vehicle.input.held_by = StopReason::kPaused;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);
    EXPECT_EQ(vehicle.permission.reason, StopReason::kPaused);
    vehicle.input.area = reason;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kSafeStop);
    EXPECT_EQ(vehicle.permission.reason, reason);
    vehicle.input.at_rest = true;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kArmed);
    vehicle.input.has_goal = true;
    vehicle.input.has_plan = true;
    vehicle.input.has_path = true;
    EXPECT_EQ(vehicle.Ticks(10).mode, Mode::kArmed);
    EXPECT_EQ(vehicle.permission.reason, reason);
    vehicle.input.area = StopReason::kNone;
    EXPECT_EQ(vehicle.Ticks(10).mode, Mode::kArmed);
    EXPECT_EQ(vehicle.permission.reason, StopReason::kPaused);
    vehicle.input.held_by = StopReason::kNone;
    EXPECT_EQ(vehicle.Tick().mode, Mode::kDriving);
  }
}

}  // namespace
}  // namespace hardpack
