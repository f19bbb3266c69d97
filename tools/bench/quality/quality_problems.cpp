// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_problems.h"

#include "core/base/math.h"
#include "tools/bench/quality/quality_terrain.h"

namespace hardpack::command {
namespace {

constexpr int kAllUnits = 1'000'000;
constexpr int kMostDraws = 200;

template <typename StepAll>
void ToEnd(StepAll&& step_all) {
  while (step_all() == Progress::kBusy) {
  }
}

Vec2 PlaceOf(const PathStart& start) {
  return {start.pose.x_m, start.pose.y_m};
}

bool IsLong(int number) {
  return (number - 1) / static_cast<int>(TerrainKinds().size()) % 5 < 3;
}

// About 200 points, or about 100, whatever detours there are.
bool IsOfLength(int number, int points) {
  return IsLong(number) ? points >= 170 && points <= 230 : points >= 80 && points <= 125;
}

Way DrawWay(Draw& random, int number) {
  Way way;
  way.length_m = IsLong(number) ? random.Uniform(45.0f, 53.0f) : random.Uniform(22.0f, 27.0f);
  way.direction_rad = random.Uniform(-kPi, kPi);
  const SinCosPair direction = SinCos(way.direction_rad);
  way.start_odom = {random.Uniform(-6.0f, 6.0f) - 0.5f * way.length_m * direction.cos,
                    random.Uniform(-6.0f, 6.0f) - 0.5f * way.length_m * direction.sin};
  return way;
}

QualityProblem DrawProblem(Draw& random, int number) {
  constexpr float kMostOff_rad = 60.0f * kRadPerDeg;
  constexpr float kMostBend_per_m = 0.3f;
  const auto kinds = static_cast<int>(TerrainKinds().size());
  const TerrainKind& kind = TerrainKinds()[static_cast<size_t>((number - 1) % kinds)];
  Terrain terrain(DrawWay(random, number));
  const Vec2 goal = kind.draw(random, terrain);

  QualityProblem problem;
  problem.number = number;
  problem.kind = kind.name;
  problem.flags = terrain.flags();
  const Way& way = terrain.way();
  const float heading_rad = way.direction_rad + random.Uniform(-kMostOff_rad, kMostOff_rad);
  problem.start.pose = {way.start_odom.x_m, way.start_odom.y_m, WrapAngle(heading_rad)};
  // A whole turn of the kinds later it is another kind's turn.
  const int turn = number + number / kinds;
  if (turn % 4 == 0) {
    problem.start.curvature_per_m = random.Uniform(-kMostBend_per_m, kMostBend_per_m);
  }
  problem.goal_odom = way.ToOdom(goal);
  problem.has_goal_heading = turn % 5 == 2;
  problem.goal_heading_rad =
      WrapAngle(way.direction_rad + random.Uniform(-kMostOff_rad, kMostOff_rad));
  return problem;
}

}  // namespace

void SeedMaker::BuildMap(const QualityProblem& problem) {
  static_cast<void>(builder_->BeginCells(GridWindow::CenteredAt({}), params_.costmap));
  for (int i = 0; i < kMapCells; ++i) builder_->SetCell(i, problem.flags[static_cast<size_t>(i)]);
  ToEnd([this] { return builder_->StepCells(kAllUnits); });
}

Status SeedMaker::FindBase(const QualityProblem& problem) {
  const Vec2 start = PlaceOf(problem.start);
  Status status = search_->Begin(map(), params_.astar, start, problem.goal_odom);
  if (IsUsable(status)) {
    ToEnd([this] { return search_->Step(map(), kAllUnits); });
    status = search_->result().status;
  }
  if (status != Status::kOk) return status;
  status = sampler_->Begin(*search_, params_.path, start, problem.goal_odom);
  if (!IsUsable(status)) return status;
  ToEnd([this] { return sampler_->Step(*search_, kAllUnits); });
  return sampler_->status();
}

// The end first, then the start, as in the planner.
bool SeedMaker::Join(const QualityProblem& problem, const WorldPath& base, WorldPath& seed,
                     bool& keeps_end_heading) const {
  const float heading_rad = problem.start.pose.theta_rad;
  keeps_end_heading = false;
  if (problem.has_goal_heading) {
    const Status end =
        JoinEnd(base, params_.path, params_.optimizer, problem.goal_heading_rad, seed);
    keeps_end_heading = IsUsable(end) && IsUsable(JoinStart(seed, params_.path, params_.optimizer,
                                                            heading_rad, seed));
    if (keeps_end_heading) return true;
  }
  return IsUsable(JoinStart(base, params_.path, params_.optimizer, heading_rad, seed));
}

Status SeedMaker::Make(const QualityProblem& problem) {
  BuildMap(problem);
  Status status = FindBase(problem);
  if (status != Status::kOk) return status;
  status = smoother_->Begin(sampler_->result(), params_.path.smoothing_passes);
  if (!IsUsable(status)) return status;
  ToEnd([this] { return smoother_->Step(kAllUnits); });

  bool base_keeps_end = false;
  bool smooth_keeps_end = false;
  WorldPath smooth;
  if (!Join(problem, sampler_->result(), result_.base, base_keeps_end) ||
      !Join(problem, smoother_->result(), smooth, smooth_keeps_end)) {
    return Status::kPivotBlocked;
  }
  if (problem.has_goal_heading && !(base_keeps_end && smooth_keeps_end)) {
    return Status::kPivotBlocked;
  }
  const float curvature_per_m = problem.start.curvature_per_m;
  const float base_cost = CostOf(map(), params_.optimizer, result_.base, curvature_per_m).total();
  const float smooth_cost = CostOf(map(), params_.optimizer, smooth, curvature_per_m).total();
  result_.seed = smooth_cost <= base_cost ? smooth : result_.base;
  result_.keeps_end_heading = problem.has_goal_heading;
  return Status::kOk;
}

void SeedMaker::RepeatBase(const QualityProblem& problem) {
  bool keeps_end_heading = false;
  if (FindBase(problem) == Status::kOk) {
    static_cast<void>(Join(problem, sampler_->result(), result_.base, keeps_end_heading));
  }
}

std::optional<QualityProblem> MakeQualityProblem(uint32_t seed, int number, SeedMaker& maker) {
  Draw random(seed, static_cast<uint32_t>(number));
  for (int draw = 0; draw < kMostDraws; ++draw) {
    QualityProblem problem = DrawProblem(random, number);
    if (maker.Make(problem) == Status::kOk && IsOfLength(number, maker.result().base.size())) {
      return problem;
    }
  }
  return std::nullopt;
}

}  // namespace hardpack::command
