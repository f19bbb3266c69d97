// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/bench_chain.h"

#include <algorithm>

#include "core/path/path_smoother.h"
#include "port_linux/command_line/command.h"

namespace hardpack::command {
namespace {

constexpr int kAllUnits = 1'000'000;
constexpr uint8_t kCellFlags =
    Costmap::kHard | Costmap::kSoft | Costmap::kPerson | Costmap::kObserved;

template <typename StepAll>
void ToEnd(StepAll&& step_all) {
  while (step_all() == Progress::kBusy) {
  }
}

void Cut(WorldPath& path, int points) {
  if (path.size() > points) path.Resize(points);
  SetHeadingsFromChords(path);
}

}  // namespace

StageChain::StageChain(const BenchScene& scene) : mapper_(scene.mapper) {
  if (mapper_ == nullptr) FillHeights(scene);
  static_cast<void>(BuildCostmap());
  CheckCells(scene);
  ChooseQueries(scene);
  dilated_ = !queries_.empty();
  if (!dilated_) {
    params_.costmap.planning_radius_m = 0.0f;
    static_cast<void>(BuildCostmap());
    ChooseQueries(scene);
  }
  replan_queries_ = queries_;
  if (queries_.empty()) {
    dilated_ = true;
    params_ = PlannerParams{};
    static_cast<void>(BuildCostmap());
    replan_queries_ = {scene.queries.front()};
  } else {
    MakeSeed();
  }
}

// Ground at 0 m in each observed cell, and obstacles at 1 m: above the least height of an obstacle,
// below the clearance.
void StageChain::FillHeights(const BenchScene& scene) {
  heights_ = std::make_unique<HeightGrid>();
  for (int index = 0; index < kMapCells; ++index) {
    const uint8_t flags = scene.flags[static_cast<size_t>(index)];
    const Vec2 place = CellCenter(heights_->window().FromIndex(index));
    const auto file = [&](float height_m, ReturnClass return_class) {
      static_cast<void>(heights_->Insert({place.x_m, place.y_m, height_m}, return_class));
    };
    if ((flags & Costmap::kObserved) != 0) file(0.0f, ReturnClass::kGround);
    if ((flags & Costmap::kPerson) != 0) {
      file(1.0f, ReturnClass::kPerson);
    } else if ((flags & Costmap::kHard) != 0) {
      file(1.0f, ReturnClass::kHard);
    } else if ((flags & Costmap::kSoft) != 0) {
      file(1.0f, ReturnClass::kSoft);
    }
  }
}

void StageChain::CheckCells(const BenchScene& scene) const {
  for (size_t i = 0; i < scene.flags.size(); ++i) {
    if ((map().flags[i] & kCellFlags) == scene.flags[i]) continue;
    throw CommandFailure(kWorkFailed, "the heights do not reproduce the cells of " + scene.name);
  }
}

void StageChain::ChooseQueries(const BenchScene& scene) {
  const auto is_free = [this](Vec2 place) {
    const Cell cell = CellAt(place);
    return map().window.Contains(cell) && !map().Lethal(map().window.Index(cell));
  };
  int most_points = 0;
  for (const BenchQuery& wish : scene.queries) {
    if (queries_.size() == kMostQueries) break;
    if (!is_free(wish.start_m) || !is_free(wish.goal_m)) continue;
    if (Search(wish) != Status::kOk || !IsUsable(Sample())) continue;
    queries_.push_back(wish);
    queries_.back().heading_rad = BaseHeading(sampler_->result());
    const int points = std::min(sampler_->result().size(), kPathPoints);
    if (points > most_points) path_query_ = queries_.back();
    most_points = std::max(most_points, points);
  }
}

// As the planner makes it (docs/algorithm.md section 3): smoothed, and joined to the heading, which
// is off a little, so that there is something to optimize on open ground too.
void StageChain::MakeSeed() {
  static_cast<void>(Search(path_query_));
  static_cast<void>(Sample());
  const auto smoother = std::make_unique<PathSmoother>();
  static_cast<void>(smoother->Begin(sampler_->result(), params_.path.smoothing_passes));
  ToEnd([&] { return smoother->Step(kAllUnits); });
  WorldPath base = smoother->result();
  Cut(base, kPathPoints);
  constexpr float kHeadingError_rad = 0.3f;
  const float heading_rad = WrapAngle(path_query_.heading_rad + kHeadingError_rad);
  const Status joined = JoinStart(base, params_.path, params_.optimizer, heading_rad, seed_);
  if (!IsUsable(joined) || !IsUsable(Optimize(params_.optimizer))) return;
  path_ = optimizer_->path();
  if (ToActuator<PlanarModel>(path_, *actuator_) != Status::kOk) path_.Clear();
}

const HeightGrid& StageChain::heights() const {
  return mapper_ == nullptr ? *heights_ : mapper_->heights();
}

Status StageChain::BuildCostmap() {
  const Status begun = builder_->Begin(heights(), params_.costmap);
  if (!IsUsable(begun)) return begun;
  ToEnd([this] { return builder_->StepHeights(heights(), kAllUnits); });
  const int slots = mapper_ == nullptr ? 0 : mapper_->ring().slots();
  for (int slot = 0; slot < slots; ++slot) {
    mapper_->MarkPending(slot, mapper_->fold_count(), *builder_);
  }
  ToEnd([this] { return builder_->StepCells(kAllUnits); });
  return Status::kOk;
}

Status StageChain::Search(const BenchQuery& query) {
  searched_ = query;
  const Status begun = search_->Begin(map(), params_.astar, query.start_m, query.goal_m);
  if (IsUsable(begun)) ToEnd([this] { return search_->Step(map(), kAllUnits); });
  return search_->result().status;
}

Status StageChain::Sample() {
  const Status begun = sampler_->Begin(*search_, params_.path, searched_.start_m, searched_.goal_m);
  if (IsUsable(begun)) ToEnd([this] { return sampler_->Step(*search_, kAllUnits); });
  return sampler_->status();
}

Status StageChain::Optimize(const OptimizerParams& optimizer) {
  const Status begun = optimizer_->Begin(map(), optimizer, params_.path, seed_, 0.0f, false);
  if (IsUsable(begun)) ToEnd([this] { return optimizer_->Step(map(), kAllUnits); });
  return optimizer_->result().status;
}

Status StageChain::Speed() {
  return PlanSpeed(params_.speed, params_.vehicle, *actuator_, SpeedRequest{}, *speed_);
}

Status StageChain::Check() {
  const Status begun =
      check_->Begin(params_.vehicle, params_.optimizer, path_, 0.0f, params_.path.margin_m);
  if (IsUsable(begun)) ToEnd([this] { return check_->Step(map(), path_, kAllUnits); });
  return check_->result().status;
}

Status StageChain::Replan(const BenchQuery& query) {
  PlanRequest request;
  request.start.pose = {query.start_m.x_m, query.start_m.y_m, query.heading_rad};
  request.goal_odom = query.goal_m;
  const Status begun = mapper_ == nullptr ? planner_->Begin(*heights_, params_, request)
                                          : planner_->Begin(*mapper_, params_, request);
  if (!IsUsable(begun)) return begun;
  ToEnd([this] {
    return mapper_ == nullptr ? planner_->Step(*heights_, kAllUnits)
                              : planner_->Step(*mapper_, kAllUnits);
  });
  return planner_->result().status;
}

}  // namespace hardpack::command
