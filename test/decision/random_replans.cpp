// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/autonomy/replanner.h"
#include "core/base/assert.h"
#include "core/base/math.h"
#include "test/decision/random.h"
#include "test/decision/random_scenes.h"
#include "test/decision/storage.h"
#include "test/decision/vary.h"

// Drives of random vehicles among shapes that come and go, to goals that change, held to their
// paths more or less well.

namespace hardpack::decision {
namespace {

HP_BIG_MEMORY Storage<Replanner> g_replanner;

constexpr int kGroups = 8;
constexpr int kDrives = 6;  // of a group
constexpr int kRounds = 14;
constexpr int kMostShapes = 40;
constexpr int kUnits = 4099;
constexpr int kMaxCalls = 100000;

struct Shape {
  Cell low;
  Cell size;
  uint8_t flags = 0;
  int from = 0;  // rounds in which it is there
  int to = 0;
};

class RandomDrive {
 public:
  explicit RandomDrive(uint32_t seed) : random_(seed) {
    Vary(random_, 16, params_);
    shapes_ = random_.Between(0, kMostShapes);
    for (Shape& shape : shape_) shape = AnyShape();
    NewGoal();
    state_.pose = {0.1f, 0.1f, random_.RealBetween(-3.2f, 3.2f)};
    looseness_ = random_.Between(0, 3) == 0 ? 0.4f : 0.05f;
  }

  // Rounds whose outcome was something to drive.
  uint32_t Run(DecisionHash& hash) {
    Replanner& replanner = g_replanner.Construct();
    const Status taken = replanner.Configure(params_);
    hash.AddU8(static_cast<uint8_t>(taken));
    if (!IsUsable(taken)) return 0;
    uint32_t usable = 0;
    uint64_t now_ns = 1'000'000'000u;
    for (round_ = 0; round_ < kRounds; ++round_) {
      now_ns += static_cast<uint64_t>(random_.Between(20, 250)) * 1'000'000u;
      if (random_.Between(0, 7) == 0) NewGoal();
      if (random_.Between(0, 7) == 0) NudgeGoal();
      hash.AddU8(static_cast<uint8_t>(replanner.Update(now_ns, state_, goal_)));
      Plan(replanner);
      AddToHash(replanner, hash);
      AddToHash(replanner.committed(), hash);
      hash.AddU8(static_cast<uint8_t>(replanner.outcome().reason));
      if (IsUsable(replanner.outcome().status)) ++usable;
      GoOn(replanner);
    }
    return usable;
  }

 private:
  Shape AnyShape() {
    constexpr uint8_t kFlags[] = {Costmap::kHard | Costmap::kObserved,
                                  Costmap::kHard | Costmap::kObserved,
                                  Costmap::kSoft | Costmap::kObserved,
                                  Costmap::kHard | Costmap::kPerson | Costmap::kObserved, 0};
    Shape shape;
    shape.low = {random_.Between(-180, 180), random_.Between(-180, 180)};
    shape.size = {random_.Between(1, 40), random_.Between(1, 40)};
    shape.flags = kFlags[random_.Between(0, 4)];
    shape.from = std::max(random_.Between(-6, kRounds), 0);
    shape.to = shape.from + random_.Between(1, kRounds);
    return shape;
  }

  void NewGoal() {
    goal_.position_odom = {state_.pose.x_m + random_.RealBetween(-40.0f, 40.0f),
                           state_.pose.y_m + random_.RealBetween(-40.0f, 40.0f)};
    goal_.has_heading = random_.Between(0, 3) == 0;
    goal_.heading_rad = random_.RealBetween(-3.2f, 3.2f);
  }

  // By what is a change of the goal, or just not.
  void NudgeGoal() {
    goal_.position_odom.x_m += random_.RealBetween(-1.0f, 1.0f);
    if (random_.Between(0, 1) == 0) goal_.position_odom.y_m += random_.RealBetween(-4.0f, 4.0f);
    goal_.heading_rad += random_.RealBetween(-0.2f, 0.2f);
    if (random_.Between(0, 3) == 0) goal_.has_heading = !goal_.has_heading;
  }

  void Plan(Replanner& replanner) {
    const GridWindow window = GridWindow::CenteredAt({state_.pose.x_m, state_.pose.y_m});
    if (!IsUsable(replanner.BeginCells(window))) return;
    CostmapBuilder& builder = replanner.costmap_builder();
    for (int index = 0; index < kMapCells; ++index) builder.SetCell(index, Costmap::kObserved);
    for (int i = 0; i < shapes_; ++i) {
      if (round_ >= shape_[i].from && round_ < shape_[i].to) Draw(shape_[i], window, builder);
    }
    int calls = 0;
    while (replanner.StepCells(kUnits) == Progress::kBusy) HP_ASSERT(++calls < kMaxCalls);
  }

  static void Draw(const Shape& shape, const GridWindow& window, CostmapBuilder& builder) {
    for (int cell = 0; cell < shape.size.x * shape.size.y; ++cell) {
      const Cell at{shape.low.x + cell % shape.size.x, shape.low.y + cell / shape.size.x};
      if (window.Contains(at)) builder.SetCell(window.Index(at), shape.flags);
    }
  }

  // Some way along what it is to drive, and some way beside it.
  void GoOn(const Replanner& replanner) {
    const bool drives = IsUsable(replanner.outcome().status) && !replanner.outcome().held;
    if (!drives) {
      state_.speed_mps = 0.0f;
      state_.driven_mps = 0.0f;
      return;
    }
    const float way_m = random_.RealBetween(0.0f, 2.0f);
    const PathState at = StateAt(replanner.committed(), replanner.place().along_m + way_m);
    state_.pose = {at.pose.x_m + random_.RealBetween(-looseness_, looseness_),
                   at.pose.y_m + random_.RealBetween(-looseness_, looseness_),
                   WrapAngle(at.pose.theta_rad + random_.RealBetween(-looseness_, looseness_))};
    state_.curvature_per_m = at.curvature_per_m;
    state_.speed_mps = at.speed_mps;
    state_.driven_mps = at.speed_mps * random_.RealBetween(0.5f, 1.0f);
    state_.reaction_s = random_.RealBetween(0.0f, 0.8f);
  }

  Random random_;
  PlannerParams params_;
  int shapes_ = 0;
  Shape shape_[kMostShapes];
  VehicleState state_;
  PlanGoal goal_;
  float looseness_ = 0.0f;  // [m], [rad]
  int round_ = 0;
};

}  // namespace

void RunRandomReplans(Report& report) {
  uint32_t usable = 0;
  uint32_t seed = 0x5eed0300u;
  for (int group = 0; group < kGroups; ++group) {
    DecisionHash hash;
    for (int drive = 0; drive < kDrives; ++drive) usable += RandomDrive(seed++).Run(hash);
    report.Add("random.replans", hash);
  }
  PrintNumber("random.replans usable", usable);
}

}  // namespace hardpack::decision
