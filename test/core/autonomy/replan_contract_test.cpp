// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "test/core/autonomy/replan_drive.h"
#include "test/not_finite.h"

// What a Replanner and a committed plan promise, one by one.

namespace hardpack {
namespace {

using testing::kNaN;

uint64_t HashOfCommitted() {
  DecisionHash hash;
  AddToHash(TheReplanner().committed(), hash);
  return hash.value();
}

uint64_t HashOfAll() {
  DecisionHash hash;
  AddToHash(TheReplanner(), hash);
  return hash.value();
}

// The committed plan of one round from the origin, in a scene that has a bend.
const CommittedPlan& OnePlan() {
  Drive drive({30.1f, 12.1f});
  drive.world.Add(60, 10, 66, 40);
  drive.units = 1 << 20;
  drive.Start();
  drive.Tick();
  return TheReplanner().committed();
}

TEST(Replanner, SaysThatItHasNoStateOrParameters) {
  Replanner& replanner = TheReplanner();
  replanner = Replanner{};
  EXPECT_EQ(replanner.BeginCells(kWindow), Status::kNotStarted);
  EXPECT_EQ(replanner.outcome().status, Status::kNotStarted);
  EXPECT_EQ(replanner.outcome().decision, ReplanDecision::kNone);
  PlannerParams params;
  params.replan.cheaper_share = 2.0f;
  EXPECT_EQ(replanner.Configure(params), Status::kParameterOutOfRange);
  params = PlannerParams{};
  params.costmap.hard_slope_per_m = 100.0f;
  EXPECT_EQ(replanner.Configure(params), Status::kParameterOutOfRange);
  EXPECT_EQ(replanner.Configure(PlannerParams{}), Status::kOk);
  EXPECT_EQ(replanner.BeginCells(kWindow), Status::kNotStarted);
  EXPECT_EQ(replanner.StepCells(1000), Progress::kDone);
  EXPECT_EQ(replanner.committed().number, 0u);
}

// SR-PLN03
TEST(Replanner, RefusesUnusableStatesAndChangesNothing) {
  static_cast<void>(OnePlan());
  Replanner& replanner = TheReplanner();
  const uint64_t before = HashOfCommitted();
  const PathPlace place = replanner.place();
  const VehicleState good{{0.2f, 0.1f, 0.0f}, 0.0f, 1.0f};
  const PlanGoal goal{{30.1f, 12.1f}};
  const uint64_t now_ns = 2'000'000'000u;
  const auto update = [&](auto change) {
    VehicleState state = good;
    PlanGoal to = goal;
    change(state, to);
    return replanner.Update(now_ns, state, to);
  };
  EXPECT_EQ(update([](auto& s, auto&) { s.pose.x_m = kNaN; }), Status::kNotFinite);
  EXPECT_EQ(update([](auto& s, auto&) { s.pose.theta_rad = kNaN; }), Status::kNotFinite);
  EXPECT_EQ(update([](auto& s, auto&) { s.curvature_per_m = 1.0f / 0.0f; }), Status::kNotFinite);
  EXPECT_EQ(update([](auto& s, auto&) { s.speed_mps = kNaN; }), Status::kNotFinite);
  EXPECT_EQ(update([](auto& s, auto&) { s.turn_quickness = kNaN; }), Status::kNotFinite);
  EXPECT_EQ(update([](auto&, auto& g) { g.position_odom.y_m = kNaN; }), Status::kNotFinite);
  EXPECT_EQ(update([](auto&, auto& g) {
              g.has_heading = true;
              g.heading_rad = kNaN;
            }),
            Status::kNotFinite);
  EXPECT_EQ(update([](auto& s, auto&) { s.speed_mps = -1.0f; }), Status::kInvalidArgument);
  EXPECT_EQ(update([](auto& s, auto&) { s.speed_mps = 1.0e6f; }), Status::kInvalidArgument);
  EXPECT_EQ(update([](auto& s, auto&) { s.pose.y_m = 1.0e7f; }), Status::kInvalidArgument);
  EXPECT_EQ(update([](auto& s, auto&) { s.pose.theta_rad = 1.0e5f; }), Status::kInvalidArgument);
  EXPECT_EQ(update([](auto& s, auto&) { s.curvature_per_m = 1.0e7f; }), Status::kInvalidArgument);
  EXPECT_EQ(replanner.Update(5u, good, goal), Status::kInvalidArgument) << "time runs backwards";
  EXPECT_EQ(HashOfCommitted(), before);
  EXPECT_EQ(replanner.place().along_m, place.along_m);
  EXPECT_EQ(replanner.counters().refused, 13u);
  EXPECT_EQ(update([](auto&, auto&) {}), Status::kOk);
  EXPECT_EQ(update([](auto&, auto&) {}), Status::kOk) << "the same time twice";
}

TEST(Replanner, TakesStatesAndGoalsAtTheEdgeOfWhatItTakes) {
  static_cast<void>(OnePlan());
  const float speed_mps = kMaxRequestSpeed_mps;
  const float curvature_per_m = kCurvatureCeiling_per_m;
  const float place_m = kMaxRequestPosition_m;
  const float angle_rad = kSinCosMaxAngle_rad;
  uint64_t now_ns = 2'000'000'000u;
  for (const float side : {1.0f, -1.0f}) {
    const VehicleState state = {
        {side * place_m, side * place_m, side * angle_rad}, side * curvature_per_m, speed_mps};
    const PlanGoal goal = {
        .position_odom = {0.0f, 0.0f}, .has_heading = true, .heading_rad = side * angle_rad};
    EXPECT_EQ(TheReplanner().Update(++now_ns, state, goal), Status::kOk) << side;
    PlanGoal beyond = goal;
    beyond.heading_rad = std::nextafter(goal.heading_rad, 2.0f * goal.heading_rad);
    EXPECT_EQ(TheReplanner().Update(++now_ns, state, beyond), Status::kInvalidArgument) << side;
  }
  const VehicleState rolls_back = {{0.1f, 0.1f, 0.0f}, 0.0f, -Replanner::kStanding_mps};
  EXPECT_EQ(TheReplanner().Update(++now_ns, rolls_back, {{10.1f, 0.1f}}), Status::kOk);
}

// Whatever the units of a Step, with the state at rest during a round.
// SR-PLN03
TEST(Replanner, DecidesTheSameInAnySplitOfUnits) {
  uint64_t expected = 0;
  for (const int units : {1 << 20, 64, 97, 7}) {
    Drive drive({60.1f, 0.1f});
    drive.world.Add(60, -10, 66, 12);
    drive.units = 1 << 20;
    drive.Start();
    std::mt19937 random(3);
    for (int round = 0; round < 4; ++round) {
      drive.Tick();  // one round, and a little way
      for (int move = 0; move < 30; ++move) drive.Move();
      if (round == 2) drive.world.Add(150, -6, 156, 6);  // far away, on the path
      ASSERT_EQ(TheReplanner().Update(drive.now_ns, drive.state, drive.goal), Status::kOk);
      ASSERT_EQ(TheReplanner().BeginCells(GridWindow::CenteredAt({drive.truth.x_m, 0.0f})),
                Status::kOk);
      drive.SetWorld(GridWindow::CenteredAt({drive.truth.x_m, 0.0f}));
      while (TheReplanner().StepCells(1 + static_cast<int>(random() % unsigned(units))) ==
             Progress::kBusy) {
      }
    }
    if (expected == 0) expected = HashOfAll();
    EXPECT_EQ(HashOfAll(), expected) << units;
  }
}

TEST(Replanner, DrivesTheSameTwice) {
  uint64_t hash[2] = {};
  for (uint64_t& value : hash) {
    Drive drive({30.1f, 0.1f});
    drive.world.Add(60, -10, 66, 10);
    drive.jitter_m = 0.03f;
    drive.map_flickers = true;
    drive.Start();
    for (int tick = 0; tick < 150; ++tick) drive.Tick();
    value = HashOfAll();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(Replanner, ForgetsOnRequest) {
  EXPECT_EQ(OnePlan().number, 1u);
  TheReplanner().Forget();
  EXPECT_EQ(TheReplanner().committed().number, 0u);
  EXPECT_FALSE(TheReplanner().busy());
  EXPECT_EQ(TheReplanner().outcome().decision, ReplanDecision::kNone);
  // The state too, and its time: the clock may have begun anew.
  EXPECT_EQ(TheReplanner().BeginCells(kWindow), Status::kNotStarted);
  EXPECT_EQ(TheReplanner().Update(1, {{0.1f, 0.1f, 0.0f}, 0.0f, 0.0f}, {{10.1f, 0.1f}}),
            Status::kOk);
}

TEST(Replanner, DoesNotTakeAPauseOfItsOwnerForItsPace) {
  Replanner& replanner = TheReplanner();
  replanner = Replanner{};
  ASSERT_EQ(replanner.Configure(PlannerParams{}), Status::kOk);
  const VehicleState state = {{0.1f, 0.1f, 0.0f}, 0.0f, 0.0f};
  ASSERT_EQ(replanner.Update(1, state, {{10.1f, 0.1f}}), Status::kOk);
  ASSERT_EQ(replanner.BeginCells(kWindow), Status::kOk);
  ASSERT_EQ(replanner.Update(60'000'000'000u, state, {{10.1f, 0.1f}}), Status::kOk);
  while (replanner.StepCells(1000) == Progress::kBusy) {
  }
  ASSERT_TRUE(IsUsable(replanner.outcome().status));
  EXPECT_LE(replanner.latency_s(), 5.0f);
}

TEST(Replanner, PlansOnHeights) {
  static const std::unique_ptr<HeightGrid> heights = std::make_unique<HeightGrid>();
  Replanner& replanner = TheReplanner();
  replanner = Replanner{};
  ASSERT_EQ(replanner.Configure(PlannerParams{}), Status::kOk);
  ASSERT_EQ(replanner.Update(1, {{0.1f, 0.1f, 0.0f}, 0.0f, 0.0f}, {{10.1f, 0.1f}}), Status::kOk);
  while (replanner.Step(*heights, 1000) == Progress::kBusy) {
  }
  EXPECT_EQ(replanner.outcome().decision, ReplanDecision::kReplaced);
  EXPECT_EQ(replanner.outcome().reason, ReplanReason::kFirst);
  EXPECT_TRUE(replanner.committed().reaches_goal);
}

// The goal lies outside the world's walls: there is no plan, and none is made up.
// SR-PLN02
TEST(Replanner, CommitsNothingWithoutAWay) {
  Drive drive({30.1f, 0.1f});
  drive.world.Add(40, -600, 42, 600);
  drive.units = 1 << 21;
  drive.Start();
  drive.Tick();
  EXPECT_EQ(drive.outcome().decision, ReplanDecision::kNone);
  EXPECT_EQ(drive.outcome().status, Status::kNoPath);
  EXPECT_EQ(drive.committed().number, 0u);
  EXPECT_EQ(drive.replanner().counters().failed, 1u);
}

TEST(Replanner, PredictsAlongAnArc) {
  const VehicleState state{{1.0f, 2.0f, 0.3f}, 0.4f, 5.0f};
  const VehicleState ahead = PredictAhead(state, 0.5f);
  double x = 1.0, y = 2.0, theta = 0.3;
  for (int i = 0; i < 10000; ++i) {
    x += std::cos(theta + 0.5e-4 * 0.5 * 2.0) * 5.0 * 0.5e-4;
    y += std::sin(theta + 0.5e-4 * 0.5 * 2.0) * 5.0 * 0.5e-4;
    theta += 0.4 * 5.0 * 0.5e-4;
  }
  EXPECT_NEAR(ahead.pose.x_m, x, 1e-3);
  EXPECT_NEAR(ahead.pose.y_m, y, 1e-3);
  EXPECT_NEAR(ahead.pose.theta_rad, theta, 1e-4);
  EXPECT_EQ(ahead.speed_mps, 5.0f);
  const VehicleState straight = PredictAhead({{0.0f, 0.0f, 0.0f}, 0.0f, 2.0f}, 0.25f);
  EXPECT_FLOAT_EQ(straight.pose.x_m, 0.5f);
  EXPECT_FLOAT_EQ(straight.pose.y_m, 0.0f);
}

TEST(CommittedPlan, HasNoStepsAlongItself) {
  const CommittedPlan& plan = OnePlan();
  ASSERT_GE(plan.path.size(), 50);
  PathState before = StateAt(plan, 0.0f);
  float turned_rad = 0.0f;
  const float length_m = LengthOf(plan.path);
  for (float along_m = 0.01f; along_m < length_m; along_m += 0.01f) {
    const PathState now = StateAt(plan, along_m);
    const float step_m = std::hypot(now.pose.x_m - before.pose.x_m, now.pose.y_m - before.pose.y_m);
    EXPECT_NEAR(step_m, 0.01f, 0.001f);
    const float turn_rad = WrapAngle(now.pose.theta_rad - before.pose.theta_rad);
    turned_rad += std::abs(turn_rad);
    EXPECT_LE(std::abs(turn_rad), 0.012f);
    EXPECT_LE(std::abs(now.curvature_per_m - before.curvature_per_m), 0.04f);
    EXPECT_LE(std::abs(now.speed_mps * now.speed_mps - before.speed_mps * before.speed_mps), 0.06f);
    before = now;
  }
  EXPECT_GT(turned_rad, 0.5f) << "a straight line shows nothing";
  const PathState behind = StateAt(plan, length_m + 5.0f);
  EXPECT_EQ(behind.speed_mps, 0.0f);
  EXPECT_NEAR(behind.pose.x_m, plan.path.back().x_m, 1e-4f);
  EXPECT_NEAR(behind.pose.y_m, plan.path.back().y_m, 1e-4f);
  const PathState ahead = StateAt(plan, -5.0f);
  EXPECT_EQ(ahead.pose.x_m, plan.path[0].x_m);
  EXPECT_EQ(ahead.pose.y_m, plan.path[0].y_m);
}

TEST(CommittedPlan, IsProjectedOnWhereItWasDriven) {
  const CommittedPlan& plan = OnePlan();
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  for (int trial = 0; trial < 300; ++trial) {
    const float along_m = 15.0f + 14.0f * uniform(random);
    const float off_m = 0.4f * uniform(random);
    const PathState at = StateAt(plan, along_m);
    const Pose2 pose = {at.pose.x_m - off_m * std::sin(at.pose.theta_rad),
                        at.pose.y_m + off_m * std::cos(at.pose.theta_rad), at.pose.theta_rad};
    const PathPlace place = Project(plan.path, pose, false, along_m + 1.0f);
    EXPECT_NEAR(place.along_m, along_m, 0.06f) << trial;
    EXPECT_NEAR(place.cross_track_m, std::abs(off_m), 0.02f) << trial;
    const PathPlace too_early = Project(plan.path, pose, false, along_m - 5.0f);
    EXPECT_LE(too_early.along_m, std::max(0.0f, along_m - 4.0f)) << trial;
  }
}

//   0 ---- 1,2 (turn) ---- 3
TEST(CommittedPlan, IsNotProjectedBeyondATurnThatIsStillToBeMade) {
  WorldPath path;
  path.Resize(4);
  path[0] = {0.0f, 0.0f, 0.0f};
  path[1] = {1.0f, 0.0f, 0.0f};
  path[2] = {1.0f, 0.0f, kHalfPi};
  path[3] = {1.0f, 1.0f, kHalfPi};
  EXPECT_EQ(StandingPoint(path, 0), 1);
  EXPECT_EQ(StandingPoint(path, 2), 3);
  const Pose2 there = {0.95f, 0.02f, 0.0f};
  EXPECT_EQ(Project(path, there, false, 10.0f).point, 0) << "it does not stand";
  EXPECT_EQ(Project(path, there, true, 10.0f).point, 1);
  EXPECT_EQ(Project(path, {1.0f, 0.0f, 1.5f}, true, 10.0f).point, 2) << "it has turned";
  EXPECT_EQ(Project(path, {1.0f, 0.0f, 1.5f}, false, 10.0f).point, 0) << "it moves";
  EXPECT_EQ(FirstKept(path, 0), 0);
  EXPECT_EQ(FirstKept(path, 2), 2);
  EXPECT_EQ(FirstKept(path, 1), 1);
}

}  // namespace
}  // namespace hardpack
