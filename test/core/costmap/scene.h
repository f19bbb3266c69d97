// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>

#include "core/costmap/costmap.h"

// What the tests of this folder build maps with.

namespace hardpack {

inline int IndexOf(int column, int row) {
  return row * kMapSize_cells + column;
}

// Owns a grid of heights and a builder; each is far too big for the stack.
class Scene {
 public:
  HeightGrid& heights() { return *heights_; }
  CostmapBuilder& builder() { return *builder_; }

  // One return in the middle of a cell given by its place in the window.
  void Add(int column, int row, float z_m, ReturnClass return_class) {
    const Cell origin = heights_->window().origin;
    const Vec2 center = CellCenter({origin.x + column, origin.y + row});
    ASSERT_EQ(heights_->Insert({center.x_m, center.y_m, z_m}, return_class), Status::kOk);
  }

  const Costmap& Build(const CostmapParams& params = {}) {
    EXPECT_EQ(builder_->Begin(*heights_, params), Status::kOk);
    EXPECT_EQ(builder_->Step(*heights_, CostmapBuilder::kUnits), Progress::kDone);
    return builder_->result();
  }

  // A map from cells: set(column, row) gives each cell's flags. The ground of all was observed.
  template <typename Set>
  const Costmap& BuildCells(const CostmapParams& params, Set set) {
    EXPECT_EQ(builder_->BeginCells(GridWindow::CenteredAt({}), params), Status::kOk);
    for (int row = 0; row < kMapSize_cells; ++row) {
      for (int column = 0; column < kMapSize_cells; ++column) {
        const int flags = set(column, row) | Costmap::kObserved;
        builder_->SetCell(IndexOf(column, row), static_cast<uint8_t>(flags));
      }
    }
    EXPECT_EQ(builder_->StepCells(CostmapBuilder::kCellUnits), Progress::kDone);
    return builder_->result();
  }

 private:
  std::unique_ptr<HeightGrid> heights_ = std::make_unique<HeightGrid>();
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

}  // namespace hardpack
