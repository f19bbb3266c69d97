// SPDX-License-Identifier: Apache-2.0
// Costmap, search, optimizers, check and speeds on any map with any request and parameters. The
// script sets parameters (as a rule within their ranges, some beyond), draws shapes into the map,
// and says where from and to, and in which portions the units come.
//
// Required: a status for everything that is refused; within kMaxUnits units an end, and the same
// plan in other portions; and of a usable plan, looked at anew (plan_checks.h): finite poses on the
// map and finite steps that join them, a footprint that is clear of every obstacle or drives out of
// the one that it stands in, a cost that is the path's and no higher than the base path's,
// curvatures within the limits but where the status says otherwise, speeds that can be had and end
// at rest unless the start is too fast for it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "config/parameter_tables.h"
#include "core/autonomy/planner.h"
#include "core/base/decision_hash.h"
#include "core/base/validate.h"
#include "port_linux/files/set_parameter.h"
#include "test/fuzz/accepted.h"
#include "test/fuzz/mapper_script.h"
#include "test/fuzz/plan_checks.h"

namespace hardpack {
namespace {

constexpr int kMostShapes = 24;

// What a cell of a shape becomes.
constexpr uint8_t kFlags[] = {
    Costmap::kHard | Costmap::kObserved,
    Costmap::kSoft | Costmap::kObserved,
    Costmap::kObserved,
    0,
    Costmap::kHard | Costmap::kPerson | Costmap::kObserved,
};

class Problem {
 public:
  Problem(const uint8_t* data, size_t size) : script_(data, size) {}

  void Run() {
    Request();
    Parameters();
    Draw();
    const int portion = script_.Byte() % 64u + 1;
    Vias();
    const bool begun = Plan(*planner_, 64);
    Require(Plan(*twin_, portion) == begun);
    DecisionHash one;
    DecisionHash other;
    AddToHash(planner_->result(), one);
    AddToHash(twin_->result(), other);
    Require(one.value() == other.value());
    if (begun && IsUsable(planner_->result().status)) Check(planner_->result());
  }

 private:
  void Request() {
    const bool wild = script_.Byte() % 16u == 0;
    const auto number = [&](float range) {
      return wild ? script_.Any() : (static_cast<float>(script_.Two()) / 32768.0f - 1.0f) * range;
    };
    request_.start.pose = {number(40.0f), number(40.0f), number(3.2f)};
    request_.start.curvature_per_m = number(0.4f);
    request_.start.speed_mps = std::abs(number(6.0f));
    if (script_.Byte() % 2u == 0) request_.start.speed_mps = 0.0f;
    request_.goal_odom = {number(70.0f), number(70.0f)};
    request_.has_goal_heading = script_.Byte() % 4u == 0;
    request_.goal_heading_rad = number(3.2f);
  }

  // None at the end of the script.
  void Vias() {
    const int vias = script_.Byte() % (kMaxVias + 1);
    const auto number = [&] { return static_cast<float>(script_.Two()) / 32768.0f - 1.0f; };
    for (int i = 0; i < vias; ++i) {
      const float x_m = 70.0f * number();
      const float y_m = 70.0f * number();
      static_cast<void>(request_.route.vias.PushBack({{x_m, y_m}, 0.0f}));
    }
    for (Via& via : request_.route.vias) {
      if (script_.Byte() % 2u == 1) via.speed_mps = script_.Any();
    }
  }

  // Those of the planning tables, any of them.
  void Parameters() {
    const uint8_t changes = script_.Byte() % 8u;
    for (uint8_t i = 0; i < changes; ++i) {
      Change(kCostmapTable, params_.costmap);
      Change(kAstarTable, params_.astar);
      Change(kPathTable, params_.path);
      Change(kOptimizerTable, params_.optimizer);
      Change(kSpeedTable, params_.speed);
    }
    if (script_.Byte() % 2u == 0) params_.optimizer.method = 0;
  }

  template <typename Table, typename Params>
  void Change(const Table& table, Params& params) {
    if (script_.Byte() % 5u != 0) return;
    const auto& entry = table[script_.Byte() % table.size()];
    const float share = static_cast<float>(script_.Byte()) / 255.0f;
    const float value = entry.low + share * (entry.high - entry.low);
    static_cast<void>(SetParameter(entry, static_cast<double>(std::round(value)), params));
    if (entry.number != nullptr) params.*entry.number = value;
    if (entry.number != nullptr && script_.Byte() % 32u == 0) params.*entry.number = script_.Any();
  }

  void Draw() {
    std::fill(flags_.get(), flags_.get() + kMapCells,
              script_.Byte() % 8u == 0 ? uint8_t{0} : uint8_t{Costmap::kObserved});
    const int shapes = script_.Byte() % kMostShapes;
    for (int i = 0; i < shapes; ++i) Shape();
  }

  void Shape() {
    const uint8_t kind = script_.Byte();
    const uint8_t flags = kFlags[script_.Byte() % std::size(kFlags)];
    const int x0 = script_.Two() % kMapSize_cells;
    const int y0 = script_.Two() % kMapSize_cells;
    const int width = script_.Byte() + 1;
    const int height = script_.Byte() + 1;
    const int period = script_.Byte() % 31u + 2;
    for (int y = y0; y < std::min(y0 + height, kMapSize_cells); ++y) {
      for (int x = x0; x < std::min(x0 + width, kMapSize_cells); ++x) {
        if (!IsIn(kind, x - x0, y - y0, width, height, period)) continue;
        flags_[static_cast<size_t>(y * kMapSize_cells + x)] = flags;
      }
    }
  }

  static bool IsIn(uint8_t kind, int x, int y, int width, int height, int period) {
    switch (kind % 6) {
      case 0:
        return true;
      case 1: {
        const int64_t dx = 2 * x - width;
        const int64_t dy = 2 * y - height;
        return dx * dx * height * height + dy * dy * width * width <=
               int64_t{width} * width * height * height;
      }
      case 2:
        return x == 0 || y == 0 || x == width - 1 || y == height - 1;  // a frame
      case 3:
        return (x / period + y / period) % 2 == 0;
      case 4:
        return x % period == 0;
      default:
        return static_cast<uint32_t>(x * 7919 + y * 104729) % static_cast<uint32_t>(period) == 0;
    }
  }

  bool Plan(Planner& planner, int portion) {
    const GridWindow window = GridWindow::CenteredAt({0.1f, 0.1f});
    const Status begun = planner.BeginCells(window, params_, request_);
    Require(IsUsable(begun) || planner.result().status == begun);
    if (!IsUsable(begun)) return false;
    for (int i = 0; i < kMapCells; ++i) {
      planner.costmap_builder().SetCell(i, flags_[static_cast<size_t>(i)]);
    }
    for (int units = 0; units <= Planner::kMaxUnits; units += portion) {
      if (planner.StepCells(portion) == Progress::kDone) return true;
    }
    Require(false);
    return false;
  }

  void Check(const hardpack::Plan& plan) const {
    Accepted("plan");
    PlanWitness(params_, request_, plan).CheckAll({planner_->costmap().window, flags_.get()});
    Require(plan.cost_after.total() <= plan.cost_before.total());
    // It is that of the path before turns on the spot, behind a lead-out, and before it was made to
    // end short.
    if (plan.pivots_first || plan.pivots_last || plan.ends_short) return;
    if (plan.lead_points > 0) return;
    // At the limits that it was optimized for.
    Require(HasCost(plan, params_.optimizer) || HasCost(plan, AtPreferredRate(params_.optimizer)));
  }

  bool HasCost(const hardpack::Plan& plan, const OptimizerParams& limits) const {
    const PathCost cost =
        CostOf(planner_->costmap(), limits, plan.path, request_.start.curvature_per_m);
    return cost.map == plan.cost_after.map && cost.path == plan.cost_after.path;
  }

  Script script_;
  PlanRequest request_;
  PlannerParams params_;
  std::unique_ptr<uint8_t[]> flags_ = std::make_unique<uint8_t[]>(kMapCells);
  static inline std::unique_ptr<Planner> planner_ = std::make_unique<Planner>();
  static inline std::unique_ptr<Planner> twin_ = std::make_unique<Planner>();
};

}  // namespace
}  // namespace hardpack

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 8) return 0;
  hardpack::Problem(data, size).Run();
  return 0;
}
