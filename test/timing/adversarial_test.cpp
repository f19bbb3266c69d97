// SPDX-License-Identifier: Apache-2.0
// Maps that make planning work as hard as it can, and a random search for harder ones, in the
// counting build: a loop that runs more often than its record says stops the test.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "core/autonomy/planner.h"
#include "test/timing/adversarial_maps.h"

namespace hardpack::timing {
namespace {

class Adversarial : public ::testing::Test {
 protected:
  template <typename FlagsOf>
  void PlanOn(const PlannerParams& params, const PlanRequest& request, FlagsOf&& flags_of) {
    const GridWindow window = GridWindow::CenteredAt({0.1f, 0.1f});
    if (!IsUsable(planner_->BeginCells(window, params, request))) return;
    for (int32_t y = 0; y < kMapSize_cells; ++y) {
      for (int32_t x = 0; x < kMapSize_cells; ++x) {
        planner_->costmap_builder().SetCell(y * kMapSize_cells + x, flags_of(x, y));
      }
    }
    int units = 0;
    while (planner_->StepCells(Planner::kPortion_units) == Progress::kBusy) {
      ASSERT_LE(units += Planner::kPortion_units, Planner::kMaxUnits);
    }
    ++planned_;
  }

  std::unique_ptr<Planner> planner_ = std::make_unique<Planner>();
  int planned_ = 0;
};

PlanRequest RequestTo(Vec2 goal) {
  PlanRequest request;
  request.start.pose = {0.1f, 0.1f, 0.3f};
  request.goal_odom = goal;
  return request;
}

// SR-DET02
TEST_F(Adversarial, MapsStayWithinEveryRecord) {
  for (const AdversarialMap& map : kAdversarialMaps) {
    for (int method = 0; method < 2; ++method) {
      PlannerParams params;
      params.optimizer.method = method;
      PlanOn(params, RequestTo({45.0f, 44.0f}), map.flags);
      params.astar.max_expansions = 1;  // the least path, and the search's own end
      PlanOn(params, RequestTo({-48.0f, 20.0f}), map.flags);
    }
  }
  EXPECT_EQ(planned_, 4 * static_cast<int>(std::size(kAdversarialMaps)));
}

// Costs that change with every row of blocks, so that labels are moved, and the dearest there are.
TEST_F(Adversarial, DearCostsStayWithinEveryRecord) {
  PlannerParams params;
  params.costmap.soft_edge_cost = 18.0f;
  params.costmap.hard_edge_cost = 5.0f;
  for (const int period : {2, 3, 7, 40}) {
    PlanOn(params, RequestTo({50.0f, 50.0f}), [period](int32_t x, int32_t y) {
      const bool is_soft = (x / period + y / period) % 2 == 0 && !IsAtStart(x, y);
      return static_cast<uint8_t>(is_soft ? Costmap::kSoft | Costmap::kObserved
                                          : Costmap::kObserved);
    });
  }
  EXPECT_EQ(planned_, 4);
}

TEST_F(Adversarial, NoRandomMapExceedsARecord) {
  std::mt19937 random(20261123);
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<uint32_t>(high - low + 1));
  };
  for (int trial = 0; trial < 24; ++trial) {
    const int period = between(2, 90);
    const int wall = between(1, 6);
    const int share = between(0, 60);
    const int shift = between(0, 512);
    const auto one = static_cast<uint8_t>(between(0, 1) == 0 ? Costmap::kHard : Costmap::kSoft);
    PlannerParams params;
    params.optimizer.method = between(0, 1);
    params.path.smoothing_passes = between(0, 1) == 0 ? 0 : 64;
    PlanRequest request = RequestTo({static_cast<float>(between(-500, 500)) * 0.1f,
                                     static_cast<float>(between(-500, 500)) * 0.1f});
    request.start.speed_mps = static_cast<float>(between(0, 5));
    PlanOn(params, request, [=](int32_t x, int32_t y) {
      const bool is_wall = (x * (trial % 3) + y + shift) % period < wall && (x + shift) % 97 > 12;
      const bool is_any = static_cast<int>(Mixed(x + trial, y) % 1000u) < share;
      const bool stands = (is_wall || is_any) && !IsAtStart(x, y);
      return static_cast<uint8_t>(stands ? one | Costmap::kObserved : Costmap::kObserved);
    });
  }
  EXPECT_EQ(planned_, 24);
}

}  // namespace
}  // namespace hardpack::timing
