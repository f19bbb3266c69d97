// SPDX-License-Identifier: Apache-2.0
#include "core/manoeuvre/manoeuvre.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <queue>
#include <random>
#include <tuple>
#include <vector>

#include "core/kinematics/kinematics.h"
#include "core/safety/outline.h"
#include "core/safety/path_check.h"
#include "test/core/base/rounds.h"

// Ways out in several moves: by a plain search over the same graph, and by the check that every
// path passes.

namespace hardpack {
namespace {

constexpr GridWindow kWindow{{-256, -256}};

struct Box {
  Cell low;
  Cell high;  // included
};

struct Space {
  std::unique_ptr<CostmapBuilder> builder = std::make_unique<CostmapBuilder>();
  std::unique_ptr<AstarSearch> from_goal = std::make_unique<AstarSearch>();
  std::unique_ptr<Manoeuvre> moves = std::make_unique<Manoeuvre>();
  VehicleParams vehicle;
  PathParams params;
  float curvature_per_m = 0.5f;
  float radius_m = 0.0f;  // of the search, if that is more than the vehicle needs

  const Costmap& map() const { return builder->result(); }

  void Build(const std::vector<Box>& boxes) {
    CostmapParams costmap;
    costmap.planning_radius_m = radius_m;
    costmap.planning_radius_m = PlanningRadius(costmap, vehicle, params);
    ASSERT_EQ(builder->BeginCells(kWindow, costmap), Status::kOk);
    for (const Box& box : boxes) {
      for (int y = box.low.y; y <= box.high.y; ++y) {
        for (int x = box.low.x; x <= box.high.x; ++x) {
          builder->SetCell(kWindow.Index({x, y}), Costmap::kHard);
        }
      }
    }
    ASSERT_EQ(builder->StepCells(CostmapBuilder::kUnits), Progress::kDone);
  }

  void Begin(const Pose2& start, const WorldPath& way) {
    ASSERT_EQ(moves->Begin(map(), vehicle, params, curvature_per_m, start, way), Status::kOk);
  }

  Status Run(int units = 1 << 30) {
    while (moves->Step(map(), *from_goal, units) == Progress::kBusy) {
    }
    return moves->status();
  }
};

// 2.0 x 1.5 m, least radius 2.4 m.
VehicleParams Steered() {
  VehicleParams vehicle;
  vehicle.kinematics = VehicleParams::kAckermann;
  vehicle.length_m = 2.0f;
  vehicle.width_m = 1.5f;
  vehicle.axle_offset_m = -0.6f;
  vehicle.wheelbase_m = 1.2f;
  vehicle.max_steering_rad = 0.46f;
  return vehicle;
}

Space SteeredSpace() {
  Space space;
  space.vehicle = Steered();
  space.curvature_per_m = 0.99f * MostCurvature(space.vehicle);
  return space;
}

WorldPath Straight(Vec2 from, float heading_rad, int points) {
  WorldPath way;
  for (int k = 0; k < points; ++k) {
    const float along_m = 0.275f * static_cast<float>(k);
    way.Resize(k + 1);
    way[k] = {from.x_m + along_m * std::cos(heading_rad),
              from.y_m + along_m * std::sin(heading_rad), heading_rad};
  }
  return way;
}

int ChangesOf(const WorldPath& path) {
  int changes = 0;
  for (int k = 0; k + 1 < path.size(); ++k) {
    changes += path[k].x_m == path[k + 1].x_m && path[k].y_m == path[k + 1].y_m ? 1 : 0;
  }
  return changes;
}

// The check says that it can be driven: the margin, the curvature, no turn on the spot.
void ExpectDrivable(const Space& space, const WorldPath& path, const Pose2& start) {
  ASSERT_GE(path.size(), 2);
  EXPECT_EQ(path[0].x_m, start.x_m);
  EXPECT_EQ(path[0].y_m, start.y_m);
  EXPECT_NEAR(path[0].theta_rad, start.theta_rad, 1e-6f);
  const auto check = std::make_unique<PathCheck>();
  ASSERT_EQ(check->Begin(space.vehicle, OptimizerParams{}, path, 0.0f, space.params.margin_m),
            Status::kOk);
  while (check->Step(space.map(), path, 1000) == Progress::kBusy) {
  }
  EXPECT_TRUE(IsUsable(check->result().status)) << StatusName(check->result().status);
  EXPECT_LE(check->result().largest_curvature_per_m, space.curvature_per_m * 1.002f);
  for (int k = 0; k + 1 < path.size(); ++k) {
    const ActuatorStep step = PlanarModel::Inverse(path[k], path[k + 1]);
    const bool turns = !HasLength(step.dr_m) && std::abs(step.phi_rad) > 1e-4f;
    EXPECT_FALSE(turns) << "turns where it stands";
  }
}

// A lane 5 m wide, and the way leads back: in three moves.
//   #####################
//   <- - - - - - [ > ]
//   #####################
// SR-PLN08
TEST(Manoeuvre, TurnsAroundInThreeMoves) {
  Space space = SteeredSpace();
  space.Build({{{-100, 12}, {100, 20}}, {{-100, -20}, {100, -13}}});
  const Pose2 start = {0.1f, 0.1f, 0.0f};
  space.Begin(start, Straight({0.1f, 0.1f}, kPi, 60));
  ASSERT_EQ(space.Run(), Status::kOk) << space.moves->states();
  WorldPath path;
  space.moves->Poses(path);
  ExpectDrivable(space, path, start);
  EXPECT_GE(ChangesOf(path), 2);
  EXPECT_LE(ChangesOf(path), 4);
  EXPECT_LE(std::abs(WrapAngle(path.back().theta_rad - kPi)), Manoeuvre::kAligned_rad);
}

// Parked between two boxes, 0.9 m to each: a vehicle that could turn on the spot has no room to.
//   [====]  [ > ]  [====]
// SR-PLN08
TEST(Manoeuvre, LeavesAParkingSpaceToWhereItCanTurn) {
  Space space;
  const Pose2 start = {0.1f, 0.1f, 0.0f};
  space.Build({{{-20, -4}, {-10, 4}}, {{9, -4}, {20, 4}}, {{-40, -12}, {40, -6}}});
  ASSERT_FALSE(PivotIsFree(space.map(), space.vehicle, space.params, PlaceOf(start)));
  space.Begin(start, Straight({0.1f, 0.1f}, kHalfPi, 60));
  ASSERT_EQ(space.Run(), Status::kOk) << space.moves->states();
  WorldPath path;
  space.moves->Poses(path);
  ExpectDrivable(space, path, start);
  const bool is_aligned =
      std::abs(WrapAngle(path.back().theta_rad - kHalfPi)) <= Manoeuvre::kAligned_rad;
  EXPECT_TRUE(is_aligned ||
              PivotIsFree(space.map(), space.vehicle, space.params, PlaceOf(path.back())));
}

// SR-PLN08
TEST(Manoeuvre, SaysThatAllHasBeenSearched) {
  Space space = SteeredSpace();
  space.Build(
      {{{-12, -12}, {12, -8}}, {{-12, 8}, {12, 12}}, {{-12, -8}, {-8, 8}}, {{12, -8}, {14, 8}}});
  space.Begin({0.1f, 0.1f, 0.0f}, Straight({0.1f, 0.1f}, kPi, 60));
  EXPECT_EQ(space.Run(), Status::kNoPath);
  WorldPath path;
  space.moves->Poses(path);
  EXPECT_TRUE(path.empty());
}

TEST(Manoeuvre, SaysThatItsStatesWereNotEnough) {
  Space space = SteeredSpace();
  space.Build({});
  // Beyond the square that it searches, and at no heading that it could not have.
  space.Begin({0.1f, 0.1f, 0.0f}, Straight({30.1f, 0.1f}, kPi, 60));
  const Status status = space.Run();
  EXPECT_TRUE(status == Status::kCapacityExceeded || status == Status::kNoPath);
  EXPECT_LE(space.moves->states(), Manoeuvre::kMaxStates);
}

TEST(Manoeuvre, RefusesWhereItCannotBegin) {
  Space space = SteeredSpace();
  space.Build({{{0, 0}, {3, 3}}});
  const WorldPath way = Straight({0.1f, 0.1f}, kPi, 60);
  Manoeuvre& moves = *space.moves;
  EXPECT_EQ(moves.Begin(space.map(), space.vehicle, space.params, 0.4f, {0.1f, 0.1f, 0.0f}, way),
            Status::kStartInObstacle);
  EXPECT_EQ(moves.status(), Status::kStartInObstacle);
  EXPECT_EQ(moves.Step(space.map(), *space.from_goal, 100), Progress::kDone);
  EXPECT_EQ(moves.Begin(space.map(), space.vehicle, space.params, 0.4f, {90.1f, 0.1f, 0.0f}, way),
            Status::kStartOutsideMap);
  EXPECT_EQ(moves.Begin(space.map(), space.vehicle, space.params, 0.1f, {20.1f, 0.1f, 0.0f}, way),
            Status::kParameterOutOfRange)
      << "chords longer than the outline covers";
}

// Without a way it ends where a search from the goal gets to, which is not this side of the wall.
// SR-PLN08
TEST(Manoeuvre, WithoutAWayEndsWhereOneFromTheGoalGetsTo) {
  Space space = SteeredSpace();
  // A gap of 1.8 m: too narrow for the search, not for the outline.
  space.radius_m = 1.3f;
  space.Build({{{15, -256}, {16, -5}}, {{15, 5}, {16, 255}}});
  const Pose2 start = {0.1f, 0.1f, 0.0f};
  ASSERT_EQ(space.from_goal->Begin(space.map(), AstarParams{}, {20.1f, 0.1f}, PlaceOf(start)),
            Status::kOk);
  while (space.from_goal->Step(space.map(), 1 << 20) == Progress::kBusy) {
  }
  ASSERT_FALSE(IsUsable(space.from_goal->result().status));
  space.Begin(start, WorldPath{});
  ASSERT_EQ(space.Run(), Status::kOk);
  WorldPath path;
  space.moves->Poses(path);
  ExpectDrivable(space, path, start);
  EXPECT_GT(path.back().x_m, 3.2f);
  EXPECT_TRUE(space.from_goal->HasReached(CellAt(PlaceOf(path.back()))));
}

// SR-PLN08
TEST(Manoeuvre, GoesOnElsewhereOnceAnEndIsRefused) {
  Space space = SteeredSpace();
  space.Build({{{-100, 12}, {100, 20}}, {{-100, -20}, {100, -13}}});
  space.Begin({0.1f, 0.1f, 0.0f}, Straight({0.1f, 0.1f}, kPi, 60));
  std::vector<Pose2> ends;
  int states = 0;
  while (space.Run() == Status::kOk) {
    WorldPath path;
    space.moves->Poses(path);
    ExpectDrivable(space, path, {0.1f, 0.1f, 0.0f});
    const Pose2 end = path.back();
    const float apart_m = 0.99f * static_cast<float>(Manoeuvre::kRefused_chords) *
                          (kTwoPi / 64.0f / space.curvature_per_m);
    for (const Pose2& other : ends) {
      const bool is_near = std::abs(end.x_m - other.x_m) < apart_m &&
                           std::abs(end.y_m - other.y_m) < apart_m &&
                           std::abs(WrapAngle(end.theta_rad - other.theta_rad)) < 0.29f;
      EXPECT_FALSE(is_near) << "where an end was refused";
    }
    ends.push_back(end);
    EXPECT_GE(space.moves->states(), states) << "it began anew";
    states = space.moves->states();
    space.moves->RefuseFound();
  }
  EXPECT_EQ(ends.size(), size_t{Manoeuvre::kMaxRefused} + 1);
}

// SR-PLN08
TEST(Manoeuvre, LeadsBeyondAPlace) {
  Space space = SteeredSpace();
  space.Build({});
  space.Begin({0.1f, 0.1f, 0.0f}, Straight({0.1f, 0.1f}, 0.0f, 60));
  space.moves->LeadBeyond({3.1f, 0.4f}, 1.0f);
  ASSERT_EQ(space.Run(), Status::kOk);
  WorldPath path;
  space.moves->Poses(path);
  EXPECT_GE(path.back().x_m, 4.0f - 0.28f);
  EXPECT_EQ(ChangesOf(path), 0);
  // Of no effect: behind that, and away from the way.
  space.Begin({0.1f, 0.1f, 0.0f}, Straight({0.1f, 0.1f}, 0.0f, 60));
  space.moves->LeadBeyond({3.1f, 0.4f}, 1.0f);
  space.moves->LeadBeyond({1.1f, 0.4f}, 1.0f);
  space.moves->LeadBeyond({9.1f, 9.4f}, 1.0f);
  ASSERT_EQ(space.Run(), Status::kOk);
  WorldPath same;
  space.moves->Poses(same);
  EXPECT_EQ(same.size(), path.size());
}

std::vector<Box> RandomBoxes(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> place(-32, 32);
  std::uniform_int_distribution<int> side(0, 5);
  std::vector<Box> boxes;
  for (uint32_t i = 0; i < 40 + 3 * seed; ++i) {
    const int x = place(random);
    const int y = place(random);
    const int width = side(random);
    const int height = side(random);
    const bool is_near = x - 9 < 0 && x + width + 6 > 0 && y - 7 < 0 && y + height + 7 > 0;
    if (!is_near) boxes.push_back({{x, y}, {x + width, y + height}});
  }
  return boxes;
}

// A plain Dijkstra search over the same graph, in containers that grow: the same chords, bins and
// ends, no heuristic.
class PlainSearch {
 public:
  PlainSearch(const Space& space, const Pose2& start, const WorldPath& way)
      : space_(space), start_(start), way_(way), footprint_(FootprintOf(space.vehicle)) {
    chord_m_ = std::max(double{kTwoPi} / 64.0 / double{space.curvature_per_m}, 0.2);
  }

  // -1: none.
  int Cost() {
    using Entry = std::tuple<int, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    states_.push_back({0.0, 0.0, 0, 0, 0, true});
    open.emplace(0, 0);
    while (!open.empty()) {
      const auto [cost, index] = open.top();
      open.pop();
      const State from = states_[static_cast<size_t>(index)];
      if (cost > best_[BinOf(from)] && !from.is_start) continue;
      if (!from.is_start && MayEnd(from)) return cost;
      for (int motion = 0; motion < 4; ++motion) {
        if (from.is_start && (motion == 1 || motion == 2)) continue;
        State to = from;
        to.is_start = false;
        if (motion == 3) to.reverse = 1 - from.reverse;
        to.heading = (from.heading + (motion == 1 ? 1 : motion == 2 ? 63 : 0)) % 64;
        const double angle = 2.0 * M_PI * to.heading / 64.0;
        const double sign = to.reverse != 0 ? -1.0 : 1.0;
        to.x += sign * std::cos(angle);
        to.y += sign * std::sin(angle);
        to.cost = cost + (to.reverse != 0 ? 6 : 4) + (motion == 3 && !from.is_start ? 12 : 0);
        if (std::max(std::abs(to.x), std::abs(to.y)) > 28.0 || to.cost > 480) continue;
        const auto bin = BinOf(to);
        const auto known = best_.find(bin);
        if (known != best_.end() && known->second <= to.cost) continue;
        if (!IsFree(from, to)) continue;
        best_[bin] = to.cost;
        states_.push_back(to);
        open.emplace(to.cost, static_cast<int>(states_.size()) - 1);
      }
    }
    return -1;
  }

 private:
  struct State {
    double x = 0.0;  // in chords
    double y = 0.0;
    int heading = 0;
    int reverse = 0;
    int cost = 0;
    bool is_start = false;
  };

  static std::tuple<int, int, int, int> BinOf(const State& state) {
    return {static_cast<int>(std::floor(state.x / 0.4004)),
            static_cast<int>(std::floor(state.y / 0.4004)), state.heading, state.reverse};
  }

  Pose2 PoseOf(const State& state, double heading) const {
    const double cos = std::cos(double{start_.theta_rad});
    const double sin = std::sin(double{start_.theta_rad});
    const double x_m = state.x * chord_m_;
    const double y_m = state.y * chord_m_;
    return {static_cast<float>(double{start_.x_m} + cos * x_m - sin * y_m),
            static_cast<float>(double{start_.y_m} + sin * x_m + cos * y_m),
            WrapAngle(start_.theta_rad + static_cast<float>(2.0 * M_PI * heading / 64.0))};
  }

  bool Clear(const Pose2& pose, float margin_m) const {
    return space_.map().window.Contains(CellAt(PlaceOf(pose))) &&
           IsClear(space_.map(), footprint_, pose, margin_m);
  }

  bool IsFree(const State& from, const State& to) const {
    const float margin_m = space_.params.margin_m + 0.001f;
    if (!Clear(PoseOf(to, to.heading), margin_m)) return false;
    if (from.heading == to.heading) return true;
    const int turn = (to.heading - from.heading + 64) % 64 == 1 ? 1 : -1;
    return Clear(PoseOf(from, from.heading + 0.5 * turn), margin_m + Manoeuvre::kTurnMargin_m) &&
           Clear(PoseOf(from, from.heading + turn), margin_m + Manoeuvre::kTurnMargin_m);
  }

  bool MayEnd(const State& state) const {
    const Pose2 pose = PoseOf(state, state.heading);
    const Costmap& map = space_.map();
    if (map.Lethal(map.window.Index(CellAt(PlaceOf(pose))))) return false;
    double nearest_m = double{Manoeuvre::kReach_m};
    const Pose2* nearest = nullptr;
    for (int k = 0; k < way_.size() && k < Manoeuvre::kMaxWayPoints; ++k) {
      const double distance_m = std::hypot(double{way_[k].x_m} - double{pose.x_m},
                                           double{way_[k].y_m} - double{pose.y_m});
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      nearest = &way_[k];
    }
    if (nearest == nullptr) return false;
    return std::abs(WrapAngle(pose.theta_rad - nearest->theta_rad)) <= Manoeuvre::kAligned_rad;
  }

  const Space& space_;
  Pose2 start_;
  const WorldPath& way_;
  Footprint footprint_;
  double chord_m_ = 0.0;
  std::vector<State> states_;
  std::map<std::tuple<int, int, int, int>, int> best_;
};

// SR-PLN08
TEST(Manoeuvre, CostsLittleMoreThanAPlainSearchFinds) {
  int found = 0;
  int none = 0;
  double excess = 0.0;
  for (uint32_t seed = 1; seed <= Rounds(40u, 10u); ++seed) {
    SCOPED_TRACE(seed);
    Space space = SteeredSpace();
    space.Build(RandomBoxes(seed));
    const Pose2 start = {0.1f, 0.1f, 0.3f * static_cast<float>(seed % 9u)};
    const WorldPath way =
        Straight({0.1f, 0.1f}, start.theta_rad + 1.2f + 0.2f * static_cast<float>(seed % 10u), 20);
    if (!IsClear(space.map(), FootprintOf(space.vehicle), start, 0.2f)) continue;
    space.Begin(start, way);
    const Status status = space.Run();
    const int plain = PlainSearch(space, start, way).Cost();
    if (status != Status::kOk) {
      EXPECT_EQ(plain, -1) << StatusName(status);
      ++none;
      continue;
    }
    ++found;
    WorldPath path;
    space.moves->Poses(path);
    ExpectDrivable(space, path, start);
    ASSERT_GT(plain, 0);
    EXPECT_LE(space.moves->cost(), 2 * plain + 4);
    // What each of them loses in its bins differs.
    EXPECT_GE(space.moves->cost(), plain * 3 / 4);
    excess += static_cast<double>(space.moves->cost()) / plain - 1.0;
  }
  EXPECT_GE(found, Rounds(15, 3));
  EXPECT_GE(none, Rounds(2, 0));
  EXPECT_LE(excess / found, 0.5);
}

// Any split of the units, a map elsewhere and a search before it make no difference.
// SR-PLN03
TEST(Manoeuvre, IsTheSameForAnySplitOfItsUnits) {
  Space space = SteeredSpace();
  space.Build(RandomBoxes(7));
  const Pose2 start = {0.1f, 0.1f, 0.0f};
  const WorldPath way = Straight({0.1f, 0.1f}, 2.5f, 20);
  space.Begin(start, way);
  ASSERT_EQ(space.Run(), Status::kOk);
  WorldPath first;
  space.moves->Poses(first);
  const int states = space.moves->states();
  space.Begin(start, way);
  ASSERT_EQ(space.Run(3), Status::kOk);
  WorldPath again;
  space.moves->Poses(again);
  EXPECT_EQ(space.moves->states(), states);
  ASSERT_EQ(again.size(), first.size());
  for (int k = 0; k < first.size(); ++k) {
    EXPECT_EQ(again[k].x_m, first[k].x_m);
    EXPECT_EQ(again[k].y_m, first[k].y_m);
    EXPECT_EQ(again[k].theta_rad, first[k].theta_rad);
  }
  int units = 0;
  space.Begin(start, way);
  while (space.moves->Step(space.map(), *space.from_goal, 1) == Progress::kBusy) ++units;
  EXPECT_LE(units, Manoeuvre::kMaxUnits);
}

}  // namespace
}  // namespace hardpack
