// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/autonomy/lead_out.h"
#include "core/kinematics/kinematics.h"
#include "test/core/autonomy/random_outlines.h"
#include "test/core/autonomy/replan_drive.h"
#include "test/core/base/rounds.h"

// Ways out in reverse: where there is none ahead.

namespace hardpack {
namespace {

//   ###############
//   [ > ]         #     a blind alley 2.4 m wide, from x = -14 m to 2 m, and the goal behind
//   ###############
Scene BlindAlley() {
  Scene scene = SceneTo({-20.1f, 3.1f});
  scene.Add(-70, 6, 12, 7);
  scene.Add(-70, -7, 12, -6);
  scene.Add(10, -6, 12, 6);
  return scene;
}

// The first stretch is driven in reverse, slowly, and ends where the vehicle stands; nothing behind
// it is driven in reverse.
void ExpectBacksOut(const Scene& scene, const Plan& plan) {
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  ASSERT_GT(plan.lead_points, 0);
  for (int k = 0; k < plan.lead_points; ++k) {
    EXPECT_TRUE(IsReversed(plan.path, k)) << k;
    EXPECT_LE(plan.speed[k], scene.params.speed.max_reverse_mps + 1e-4f) << k;
  }
  EXPECT_TRUE(TurnsOnTheSpotAt(plan.path, plan.lead_points)) << "it changes direction at speed";
  EXPECT_EQ(plan.speed[plan.lead_points], 0.0f);
  EXPECT_EQ(plan.speed[plan.lead_points + 1], 0.0f);
  for (int k = plan.lead_points; k < plan.path.size(); ++k) {
    EXPECT_FALSE(IsReversed(plan.path, k)) << k;
  }
  EXPECT_GE(SweptOutline(scene, plan).Clearance_m(), -double{PathCheck::kAcross_m} - 1e-4);
}

// SR-STA04
TEST(ReverseLeadOut, LeadsOutOfABlindAlley) {
  const Scene scene = BlindAlley();
  const Plan& plan = PlanIn(scene);
  ExpectBacksOut(scene, plan);
  const Pose2& out = plan.path[plan.lead_points];
  EXPECT_LT(out.x_m, -14.0f);
  EXPECT_TRUE(PivotIsFree(ThePlanner().costmap(), scene.params.vehicle, scene.params.path,
                          {out.x_m, out.y_m}));
  EXPECT_TRUE(plan.pivots_first);
  EXPECT_NEAR(plan.path.back().x_m, -20.1f, 0.3f);
}

//   [ > ]  #      0.3 m from a wall, no room to turn: back by no more than it takes
// SR-STA04
TEST(ReverseLeadOut, BacksOffAWallAheadByWhatATurnTakes) {
  Scene scene = SceneTo({0.1f, 15.1f});
  scene.Add(5, -40, 7, 40);
  const Plan& plan = PlanIn(scene);
  ExpectBacksOut(scene, plan);
  EXPECT_GT(plan.path[plan.lead_points].x_m, -0.7f);
  // At the map's first place by as much as it would drive ahead there.
  scene.request.has_unseen_start = true;
  scene.request.unseen_start = scene.request.start.pose;
  const Plan& first = PlanIn(scene);
  ExpectBacksOut(scene, first);
  EXPECT_NEAR(first.path[first.lead_points].x_m, 0.1f - scene.params.path.unseen_start_m, 0.21f);
}

TEST(ReverseLeadOut, IsNotLookedForWhereOneLeadsAhead) {
  Scene scene = BlindAlley();
  scene.blocks.pop_back();  // not blind
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status)) << StatusName(plan.status);
  for (int k = 0; k < plan.path.size(); ++k) EXPECT_FALSE(IsReversed(plan.path, k)) << k;
}

//   ######   ########
//         ###       #      ahead is room to turn, but the search finds no way back through the door
//   [ > ]             #
//         ###       #
//   ######   ########
// SR-STA04
TEST(ReverseLeadOut, IsLookedForWhereTheOneAheadLeadsNowhere) {
  Scene scene = BlindAlley();
  scene.blocks.pop_back();
  scene.params.costmap.planning_radius_m = 1.1f;
  scene.Add(8, 5, 12, 30);
  scene.Add(8, -30, 12, -5);
  scene.Add(12, 16, 40, 18);
  scene.Add(12, -18, 40, -16);
  scene.Add(38, -16, 40, 16);
  ExpectBacksOut(scene, PlanIn(scene));
  // Such a way is there.
  LeadOut ahead;
  ahead.Begin(scene.params.vehicle, scene.params.path, scene.request.start.pose, {-20.1f, 3.1f},
              {.longest_m = 10.0f});
  ASSERT_EQ(ahead.Step(ThePlanner().costmap(), LeadOut::kMaxUnits), Progress::kDone);
  EXPECT_TRUE(ahead.found());
}

// SR-STA04
TEST(ReverseLeadOut, StaysWhereItIsTurnedOffOrClosedBehind) {
  Scene scene = BlindAlley();
  scene.params.path.reverse_out_m = 0.0f;
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
  scene.params.path.reverse_out_m = 10.0f;  // too short
  EXPECT_EQ(PlanIn(scene).status, Status::kPivotBlocked);
  scene.params.path.reverse_out_m = 24.0f;
  scene.Add(-60, -6, -58, 6);
  EXPECT_FALSE(IsUsable(PlanIn(scene).status));
}

// By each of the ways that may be tried in turn.
TEST(ReverseLeadOut, IsOneOfThoseThatAreTriedInTurn) {
  Scene scene = SceneTo({15.1f, 0.1f});
  scene.request.lead_out = LeadOut::kBends + 1;
  const Plan& plan = PlanIn(scene);
  ASSERT_TRUE(IsUsable(plan.status));
  EXPECT_TRUE(IsReversed(plan.path, 0));
  for (int way = 1; way <= kLeadOuts; ++way) {
    scene.request.lead_out = way;
    const Plan& tried = PlanIn(scene);
    ASSERT_TRUE(IsUsable(tried.status)) << way;
    EXPECT_EQ(IsReversed(tried.path, 0), way > LeadOut::kBends) << way;
  }
}

// Its headings are those that the vehicle has, also on an arc.
// SR-STA04
TEST(ReverseLeadOut, DrivesABendAgainstTheHeadingsThatItSays) {
  Scene scene = SceneTo({15.1f, 0.1f});
  for (int way = LeadOut::kBends + 1; way <= kLeadOuts; ++way) {
    scene.request.lead_out = way;
    const Plan& plan = PlanIn(scene);
    ASSERT_TRUE(IsUsable(plan.status)) << way;
    const float bend_per_m = LeadOut::kBends_per_m[way - LeadOut::kBends - 1];
    float way_m = 0.0f;
    for (int k = 0; k < plan.lead_points; ++k) {
      const Pose2& from = plan.path[k];
      const Pose2& to = plan.path[k + 1];
      const float along_rad = std::atan2(from.y_m - to.y_m, from.x_m - to.x_m);
      EXPECT_NEAR(WrapAngle(along_rad - from.theta_rad), 0.0f, 1e-3f) << way << ", " << k;
      way_m += std::hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    }
    const float turned_rad = plan.path[plan.lead_points].theta_rad - plan.path[0].theta_rad;
    EXPECT_NEAR(turned_rad, -bend_per_m * way_m, 0.1f * std::abs(bend_per_m) + 1e-3f) << way;
  }
}

// A vehicle that cannot turn on the spot turns in three moves: steered wheels may be turned where
// it stands.
//
//   ############
//   [ > ]            a lane 5 m wide; the least circle is 6.9 m wide
//   ############
// SR-PLN05, SR-PLN06
TEST(ReverseLeadOut, TurnsSteeredWheelsWhereItStands) {
  Scene scene = SceneTo({-15.0f, 0.1f});
  MakeAckermann(scene);
  scene.Add(8, -60, 9, 60);  // and a wall 1.6 m from the axle
  const Plan& plan = PlanIn(scene);
  ExpectBacksOut(scene, plan);
  const int stands = plan.lead_points;
  EXPECT_NEAR(plan.path[stands].theta_rad, plan.path[stands + 1].theta_rad, 1e-4f);
  const float most_per_m = MostCurvature(scene.params.vehicle) * 1.011f;
  for (int k = 1; k + 1 < plan.path.size(); ++k) {
    if (TurnsOnTheSpotAt(plan.path, k) || TurnsOnTheSpotAt(plan.path, k - 1)) continue;
    const float bend_per_m =
        plan.actuator.steps[k - 1].phi_rad /
        MeanChord(std::abs(plan.actuator.steps[k - 1].dr_m), std::abs(plan.actuator.steps[k].dr_m));
    EXPECT_LE(std::abs(bend_per_m), most_per_m) << k;
  }
}

// Boxes all around random outlines in random poses: whatever way out is found, the outline itself
// touches nothing on it.
// SR-STA04, SR-GEO04
TEST(ReverseLeadOut, TouchesNothingOnRandomMaps) {
  int backed_out = 0;
  for (uint32_t seed = 1; seed <= Rounds(400u, 50u); ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Scene scene = RandomOutline(seed);
    scene.request.goal_odom.x_m = -scene.request.goal_odom.x_m;
    const float heading_rad = scene.request.start.pose.theta_rad;
    // Something ahead of the nose and something beside, so that a turn has no room.
    const float front_m = FrontOf(scene.params.vehicle);
    const float half_m = 0.5f * scene.params.vehicle.width_m;
    for (int i = -6; i <= 6; ++i) {
      const float ahead_m = front_m + 0.3f + 0.4f * unit(random);
      const float left_m = half_m * static_cast<float>(i) / 3.0f;
      const Cell cell =
          CellAt({0.1f + ahead_m * std::cos(heading_rad) - left_m * std::sin(heading_rad),
                  0.1f + ahead_m * std::sin(heading_rad) + left_m * std::cos(heading_rad)});
      scene.Add(cell.x, cell.y, cell.x, cell.y);
    }
    const Plan& plan = PlanIn(scene);
    const bool is_out = IsUsable(plan.status) && plan.lead_points > 0 && IsReversed(plan.path, 0);
    if (!is_out || plan.check.start_overlaps) continue;
    ++backed_out;
    const double least_m = plan.status == Status::kOk ? 0.0 : -double{PathCheck::kAcross_m} - 1e-4;
    EXPECT_GT(SweptOutline(scene, plan).Clearance_m(), least_m) << StatusName(plan.status);
  }
  EXPECT_GT(backed_out, Rounds(60, 4));
}

// SR-STA04
TEST(ReplannerInReverse, BacksOutAndDrivesOn) {
  Drive drive({-20.1f, 3.1f});
  drive.world = BlindAlley();
  drive.Start();
  float fastest_back_mps = 0.0f;
  float back_m = 0.0f;
  int plans_from_there = 0;
  drive.on_round = [&] {
    const PathState here = StateAt(drive.committed(), drive.along_m);
    if (!here.reverse) return;
    // What is planned meanwhile begins where the vehicle stands next.
    const Plan& plan = drive.replanner().planner().result();
    const WorldPath& path = drive.committed().path;
    if (IsUsable(plan.status) && drive.speed_mps > 0.1f && drive.outcome().anchored) {
      const Pose2& turn = path[StandingPoint(path, drive.replanner().place().point)];
      EXPECT_NEAR(plan.path[0].x_m, turn.x_m, 1e-3f);
      ++plans_from_there;
    }
    fastest_back_mps = std::max(fastest_back_mps, drive.speed_mps);
    back_m = std::max(back_m, 0.1f - drive.truth.x_m);
  };
  EXPECT_GT(drive.DriveToGoal(90.0f), 0.3);
  EXPECT_TRUE(drive.Arrived());
  EXPECT_GT(back_m, 14.0f);
  EXPECT_GT(plans_from_there, 20);
  EXPECT_NEAR(fastest_back_mps, drive.world.params.speed.max_reverse_mps, 0.02f);
  EXPECT_EQ(drive.replanner().counters().stopped, 0u);
  EXPECT_EQ(drive.replanner().counters().reanchored, 0u);
}

// A vehicle that was pushed off its path while it drives in reverse gets no plan that starts
// forward from there: it stops first.
// SR-STA06
TEST(ReplannerInReverse, OffItsPathItStopsBeforeItDrivesForward) {
  Drive drive({20.1f, 0.1f});
  drive.state.lead_out = LeadOut::kBends + 1;
  drive.Start();
  for (int tick = 0; tick < 200 && drive.speed_mps < 0.3f; ++tick) drive.Tick();
  ASSERT_TRUE(StateAt(drive.committed(), drive.along_m).reverse);
  ASSERT_GT(drive.speed_mps, 0.2f);
  drive.truth.y_m += 0.8f;
  drive.follows = false;
  bool was_stopped = false;
  for (int tick = 0; tick < 300 && drive.speed_mps > 0.05f; ++tick) {
    drive.Tick();
    drive.state.driven_mps = -drive.speed_mps;
    was_stopped |= drive.outcome().decision == ReplanDecision::kStop;
    if (drive.speed_mps <= Replanner::kStanding_mps) break;
    EXPECT_NE(drive.outcome().decision, ReplanDecision::kReplaced) << tick;
  }
  EXPECT_TRUE(was_stopped);
}

}  // namespace
}  // namespace hardpack
