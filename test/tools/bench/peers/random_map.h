// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>

#include "core/costmap/costmap.h"

namespace hardpack::peers {

// Boxes of 1 to 12 cells about the odom origin, two of three of them hard, the others soft.
inline std::unique_ptr<Costmap> RandomMap(uint32_t seed, int boxes) {
  std::mt19937 random(seed);
  const auto below = [&random](uint32_t limit) { return static_cast<int>(random() % limit); };
  auto builder = std::make_unique<CostmapBuilder>();
  EXPECT_EQ(builder->BeginCells(GridWindow::CenteredAt({0.0f, 0.0f}), CostmapParams{}),
            Status::kOk);
  for (int box = 0; box < boxes; ++box) {
    const int left = below(kMapSize_cells);
    const int low = below(kMapSize_cells);
    const int right = std::min(left + 1 + below(12), kMapSize_cells);
    const int high = std::min(low + 1 + below(12), kMapSize_cells);
    const uint8_t kind = box % 3 == 2 ? Costmap::kSoft : Costmap::kHard;
    for (int y = low; y < high; ++y) {
      for (int x = left; x < right; ++x) {
        builder->SetCell(y * kMapSize_cells + x, kind | Costmap::kObserved);
      }
    }
  }
  EXPECT_EQ(builder->StepCells(CostmapBuilder::kUnits), Progress::kDone);
  return std::make_unique<Costmap>(builder->result());
}

}  // namespace hardpack::peers
