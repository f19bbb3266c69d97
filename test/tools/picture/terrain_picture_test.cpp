// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/terrain_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "core/costmap/costmap.h"
#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

// Level ground left of x = 0, a slope of 0.3 beyond it and one of 1 from x = 5 m on; nothing was
// seen where y > 5 m, and the map ends at 51 m.
class TerrainPicture : public testing::Test {
 protected:
  void SetUp() override {
    auto heights = std::make_unique<HeightGrid>();
    for (float x_m = -10.1f; x_m < 10.0f; x_m += 0.2f) {
      for (float y_m = -10.1f; y_m < 5.0f; y_m += 0.2f) {
        const float z_m = x_m < 0.0f ? 0.0f : x_m < 5.0f ? 0.3f * x_m : 1.5f + (x_m - 5.0f);
        ASSERT_EQ(heights->Insert({x_m, y_m, z_m}, ReturnClass::kGround), Status::kOk);
      }
    }
    ASSERT_EQ(builder_->Begin(*heights, {}), Status::kOk);
    while (builder_->Step(*heights, CostmapBuilder::kUnits) == Progress::kBusy) {
    }
  }

  // The pixel of a place in a panel that shows 20 m square about a middle.
  testing::AssertionResult Is(int panel, Vec2 middle, Vec2 place, const Colour& wanted) {
    const Range x = Range{double{middle.x_m}, double{middle.x_m}}.WidenedBy(10.0);
    const Range y = Range{double{middle.y_m}, double{middle.y_m}}.WidenedBy(10.0);
    Canvas canvas = DrawTerrain(builder_->terrain(), builder_->result().window, x, y, "The ground");
    const Rectangle area = TerrainPanel(panel);
    const double x_px = area.left_px + (double{place.x_m} - x.low) / 20.0 * area.width_px;
    const double y_px = area.bottom_px() - (double{place.y_m} - y.low) / 20.0 * area.height_px;
    cairo_surface_t* surface = cairo_get_target(canvas.context());
    cairo_surface_flush(surface);
    uint32_t word = 0;
    std::memcpy(&word,
                cairo_image_surface_get_data(surface) +
                    static_cast<int>(y_px) * cairo_image_surface_get_stride(surface) +
                    4 * static_cast<int>(x_px),
                4);
    const auto is = [&](unsigned shift, double share) {
      return std::abs(static_cast<double>(word >> shift & 255u) - 255.0 * share) < 12.0;
    };
    if (is(16, wanted.red) && is(8, wanted.green) && is(0, wanted.blue)) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << std::hex << word;
  }

  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
};

TEST_F(TerrainPicture, ShowsTheGradeAndWhatIsTooSteep) {
  EXPECT_TRUE(Is(0, {}, {-6.0f, 0.0f}, CostColour(0.0)));
  EXPECT_TRUE(Is(0, {}, {2.5f, 0.0f}, CostColour(0.6)));
  EXPECT_TRUE(Is(0, {}, {8.0f, 0.0f}, kHard));
  EXPECT_TRUE(Is(0, {}, {2.5f, 8.0f}, kNotObserved));
  EXPECT_TRUE(Is(0, {51.0f, 0.0f}, {55.0f, 0.0f}, kOffMap));
}

TEST_F(TerrainPicture, ShowsTheRoughness) {
  EXPECT_TRUE(Is(1, {}, {2.5f, 0.0f}, CostColour(0.02)));
  EXPECT_TRUE(Is(1, {}, {8.0f, 0.0f}, kHard));
  EXPECT_TRUE(Is(1, {}, {2.5f, 8.0f}, kNotObserved));
}

}  // namespace
}  // namespace hardpack::picture
