// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "core/costmap/costmap.h"

namespace hardpack::testing {

using Height = std::function<double(double x_m, double y_m)>;

// Ground about the middle of the map, where `height` is a number, one return in each cell.
class GroundOfHeights {
 public:
  static constexpr double kHalf_m = 20.0;

  explicit GroundOfHeights(const Height& height, const CostmapParams& params = {})
      : params_(params) {
    for (double x_m = -kHalf_m + 0.1; x_m < kHalf_m; x_m += 0.2) {
      for (double y_m = -kHalf_m + 0.1; y_m < kHalf_m; y_m += 0.2) {
        const double z_m = height(x_m, y_m);
        if (!std::isfinite(z_m)) continue;
        EXPECT_EQ(heights_->Insert(
                      {static_cast<float>(x_m), static_cast<float>(y_m), static_cast<float>(z_m)},
                      ReturnClass::kGround),
                  Status::kOk);
      }
    }
    EXPECT_EQ(builder_->Begin(*heights_, params_), Status::kOk);
    EXPECT_EQ(builder_->Step(*heights_, CostmapBuilder::kUnits), Progress::kDone);
  }

  static int IndexAt(double x_m, double y_m, const GridWindow& window) {
    return window.Index(CellAt({static_cast<float>(x_m), static_cast<float>(y_m)}));
  }
  Terrain::Ground At(double x_m, double y_m) const {
    return builder_->terrain().At(IndexAt(x_m, y_m, heights_->window()));
  }
  bool IsHard(double x_m, double y_m) const {
    return (map().flags[IndexAt(x_m, y_m, map().window)] & Costmap::kHard) != 0;
  }
  double Cost(double x_m, double y_m) const {
    return map().cost_q8[IndexAt(x_m, y_m, map().window)] / 256.0;
  }
  const Costmap& map() const { return builder_->result(); }
  const Terrain& terrain() const { return builder_->terrain(); }
  const HeightGrid& heights() const { return *heights_; }
  const CostmapParams& params() const { return params_; }

 private:
  CostmapParams params_;
  std::unique_ptr<HeightGrid> heights_ = std::make_unique<HeightGrid>();
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

}  // namespace hardpack::testing
