// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/quality_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

class Quality : public testing::Test {
 protected:
  // Open ground, and a way of 20 m along x.
  void SetUp() override {
    ASSERT_EQ(builder_->BeginCells(GridWindow::CenteredAt({}), CostmapParams{}), Status::kOk);
    while (builder_->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
    }
    picture_.map = &builder_->result();
    picture_.params = &params_;
    picture_.start.pose = {-10.0f, 0.0f, 0.0f};
    picture_.goal_odom = {10.0f, 0.0f};
    picture_.goal_heading_rad = 0.5f;
  }

  // 81 points that end where they are to end.
  static WorldPath Straight() {
    WorldPath path;
    path.Resize(81);
    for (int k = 0; k < path.size(); ++k) {
      path[k] = {-10.0f + 0.25f * static_cast<float>(k), 0.0f, 0.0f};
    }
    return path;
  }

  // How many pixels are of that colour, but for the rounding to bytes.
  int PixelsOf(const Colour& colour) {
    Canvas canvas = DrawQuality(picture_);
    cairo_surface_t* surface = cairo_get_target(canvas.context());
    cairo_surface_flush(surface);
    const uint8_t* bytes = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    int pixels = 0;
    for (int y = 0; y < canvas.height_px(); ++y) {
      for (int x = 0; x < canvas.width_px(); ++x) {
        uint32_t word = 0;
        std::memcpy(&word, bytes + y * stride + 4 * x, sizeof(word));
        const auto near = [word](int shift, double share) {
          return std::abs(static_cast<double>(word >> shift & 255) - 255.0 * share) < 1.0;
        };
        pixels += near(16, colour.red) && near(8, colour.green) && near(0, colour.blue) ? 1 : 0;
      }
    }
    return pixels;
  }

  PlannerParams params_;
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  QualityPicture picture_;
};

TEST_F(Quality, DrawsEachCurveOnTheMapAndInItsPlots) {
  const int without = PixelsOf(kOptimizedPath);
  for (const char* name : {"first", "second", "third", "fourth"}) {
    picture_.curves.push_back({.name = name, .path = Straight(), .figures = {}});
  }
  // On the map and in two plots: more than a thousand pixels' length of a line of four.
  EXPECT_GT(PixelsOf(kOptimizedPath), without + 4000);
}

TEST_F(Quality, ShowsTheGoal) {
  EXPECT_GT(PixelsOf(kGoal), 300);
}

TEST_F(Quality, BearsNoCurvesEmptyOnesAndTooMany) {
  EXPECT_GT(PixelsOf(kFree), 0);
  for (int i = 0; i < 9; ++i)
    picture_.curves.push_back({.name = "empty", .path = {}, .figures = {}});
  EXPECT_GT(PixelsOf(kFree), 0);
}

}  // namespace
}  // namespace hardpack::picture
