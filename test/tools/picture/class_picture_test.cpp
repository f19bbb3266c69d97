// SPDX-License-Identifier: Apache-2.0
#include "tools/picture/class_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>

#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

constexpr int kBeams = 4;
constexpr int kColumns = 64;
constexpr float kPi = std::numbers::pi_v<float>;

class Classes : public testing::Test {
 protected:
  // Ground observed where x > 0 alone; the vehicle at (2, 1).
  void SetUp() override {
    const GridWindow window = GridWindow::CenteredAt({});
    ASSERT_EQ(builder_->BeginCells(window, CostmapParams{}), Status::kOk);
    for (int i = 0; i < kMapCells; ++i) {
      const bool observed = window.origin.x + i % kMapSize_cells >= 0;
      if (observed) builder_->SetCell(i, Costmap::kObserved);
      if (!observed) builder_->SetCell(i, 0);
    }
    while (builder_->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
    }
    picture_.map = &builder_->result();
    picture_.pose = {2.0f, 1.0f, 0.0f};
    picture_.beams = kBeams;
    picture_.columns = kColumns;
  }

  void Add(Vec2 place, ReturnClass what, float azimuth_rad = 0.0f, int beam = 0,
           bool self = false) {
    picture_.returns.push_back({place, azimuth_rad, beam, what, self});
  }

  // The colour differs from the one wanted by rounding to bytes at most.
  static bool Near(double byte, double share) { return std::abs(byte - share * 255.0) < 1.0; }

  testing::AssertionResult Is(double x_px, double y_px, const Colour& colour) {
    Canvas canvas = DrawClasses(picture_);
    cairo_surface_t* surface = cairo_get_target(canvas.context());
    cairo_surface_flush(surface);
    uint32_t word = 0;
    std::memcpy(&word,
                cairo_image_surface_get_data(surface) +
                    static_cast<int>(y_px) * cairo_image_surface_get_stride(surface) +
                    4 * static_cast<int>(x_px),
                4);
    const uint32_t red = word >> 16 & 255;
    const uint32_t green = word >> 8 & 255;
    const uint32_t blue = word & 255;
    if (Near(red, colour.red) && Near(green, colour.green) && Near(blue, colour.blue)) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure()
           << "(" << red << "," << green << "," << blue << ") at " << x_px << "," << y_px;
  }

  testing::AssertionResult IsFromAbove(Vec2 place, const Colour& colour) {
    const Rectangle& area = kClassesFromAbove;
    const double per_m = area.width_px / (2.0 * kClassesReach_m);
    return Is(area.left_px + (double{place.x_m - picture_.pose.x_m} + kClassesReach_m) * per_m,
              area.top_px + (kClassesReach_m - double{place.y_m - picture_.pose.y_m}) * per_m,
              colour);
  }

  // share: 0 at the left edge (behind, to the left), 1 at the right edge.
  testing::AssertionResult IsInRangeImage(double share, int beam, const Colour& colour) {
    const Rectangle area = RangeImageArea(kBeams);
    return Is(area.left_px + share * area.width_px,
              area.bottom_px() - (beam + 0.5) * area.height_px / kBeams, colour);
  }

  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  ClassPicture picture_;
};

//   y ^  P     G ground, S soft, H hard, I ignored, V the vehicle's own
//     |  I  V
//   --+--G--S--H--> x
TEST_F(Classes, ShowsEachReturnFromAboveInItsColour) {
  Add({7.3f, 0.3f}, ReturnClass::kGround);
  Add({10.3f, 0.3f}, ReturnClass::kSoft);
  Add({13.3f, 0.3f}, ReturnClass::kHard);
  Add({7.3f, 3.3f}, ReturnClass::kIgnored);
  Add({10.3f, 3.3f}, ReturnClass::kIgnored, 0.0f, 0, true);
  Add({7.3f, 6.3f}, ReturnClass::kPerson);
  EXPECT_TRUE(IsFromAbove({7.3f, 0.3f}, kFree));
  EXPECT_TRUE(IsFromAbove({10.3f, 0.3f}, kSoft));
  EXPECT_TRUE(IsFromAbove({13.3f, 0.3f}, kHard));
  EXPECT_TRUE(IsFromAbove({7.3f, 3.3f}, kIgnoredReturn));
  EXPECT_TRUE(IsFromAbove({10.3f, 3.3f}, kSelfReturn));
  EXPECT_TRUE(IsFromAbove({7.3f, 6.3f}, kPerson));
}

TEST_F(Classes, ShowsWhereGroundWasObserved) {
  EXPECT_TRUE(IsFromAbove({7.3f, -6.3f}, kObservedGround));
  EXPECT_TRUE(IsFromAbove({-7.3f, -6.3f}, kNotObserved));
}

//   beam 3 |        |          |     H right
//        0 |   S left          |
//           behind left  ahead  right
TEST_F(Classes, ShowsTheRangeImageWithLeftOnTheLeftAndHighOnTop) {
  Add({2.0f, 9.0f}, ReturnClass::kSoft, kPi / 2.0f, 0);
  Add({2.0f, -9.0f}, ReturnClass::kHard, -kPi / 2.0f, 3);
  EXPECT_TRUE(IsInRangeImage(0.25, 0, kSoft));
  EXPECT_TRUE(IsInRangeImage(0.75, 3, kHard));
  EXPECT_TRUE(IsInRangeImage(0.25, 3, kNoReturn));
  EXPECT_TRUE(IsInRangeImage(0.75, 0, kNoReturn));
}

TEST_F(Classes, HidesNoPersonBehindAnotherReturn) {
  Add({9.3f, 1.3f}, ReturnClass::kPerson, 0.0f, 2, true);
  Add({9.3f, 1.3f}, ReturnClass::kHard, 0.0f, 2);
  EXPECT_TRUE(IsFromAbove({9.3f, 1.3f}, kPerson));
  EXPECT_TRUE(IsInRangeImage(0.5, 2, kPerson));
}

}  // namespace
}  // namespace hardpack::picture
