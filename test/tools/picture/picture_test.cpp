// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>

#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"

namespace hardpack::picture {
namespace {

// Three 8-bit channels.
struct Rgb {
  int red = 0;
  int green = 0;
  int blue = 0;
  bool operator==(const Rgb&) const = default;
};

std::ostream& operator<<(std::ostream& stream, const Rgb& rgb) {
  return stream << rgb.red << "," << rgb.green << "," << rgb.blue;
}

Rgb RgbOf(const Colour& colour) {
  const auto byte = [](double share) { return static_cast<int>(std::lround(share * 255.0)); };
  return {byte(colour.red), byte(colour.green), byte(colour.blue)};
}

Rgb PixelOf(const std::string& path, int x_px, int y_px) {
  cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
  const int stride = cairo_image_surface_get_stride(surface);
  uint32_t word = 0;
  std::memcpy(&word, cairo_image_surface_get_data(surface) + y_px * stride + 4 * x_px, 4);
  cairo_surface_destroy(surface);
  return {static_cast<int>(word >> 16 & 255), static_cast<int>(word >> 8 & 255),
          static_cast<int>(word & 255)};
}

class WrittenCostmap : public testing::Test {
 protected:
  // One hard cell at (0.1, 0.1) and one soft cell at (6.1, 0.1), observed everywhere.
  void SetUp() override {
    const GridWindow window = GridWindow::CenteredAt({});
    ASSERT_EQ(builder_->BeginCells(window, CostmapParams{}), Status::kOk);
    for (int i = 0; i < kMapCells; ++i) builder_->SetCell(i, Costmap::kObserved);
    builder_->SetCell(window.Index({0, 0}), Costmap::kHard | Costmap::kObserved);
    builder_->SetCell(window.Index({30, 0}), Costmap::kSoft | Costmap::kObserved);
    while (builder_->StepCells(CostmapBuilder::kUnits) == Progress::kBusy) {
    }
    // Another test of this fixture may run at the same time, in a process of its own.
    path_ = std::filesystem::temp_directory_path() /
            ("hardpack_written_costmap_" + std::to_string(getpid()) + ".png");
    Canvas canvas(kSize_px, kSize_px);
    const Axes axes(canvas, {0.0, 0.0, kSize_px, kSize_px}, {-10.0, 10.0}, {-10.0, 10.0});
    DrawCostmap(canvas, axes, builder_->result());
    ASSERT_TRUE(canvas.WritePng(path_.string()).ok());
  }
  void TearDown() override { std::filesystem::remove(path_); }

  Rgb At(double x_m, double y_m) const {
    return PixelOf(path_.string(), static_cast<int>((x_m + 10.0) / 20.0 * kSize_px),
                   static_cast<int>((10.0 - y_m) / 20.0 * kSize_px));
  }

  static constexpr int kSize_px = 400;
  std::unique_ptr<CostmapBuilder> builder_ = std::make_unique<CostmapBuilder>();
  std::filesystem::path path_;
};

//   y ^       H hard at (0.1, 0.1), S soft at (6.1, 0.1)
//     |
//  ---H-----S---> x
TEST_F(WrittenCostmap, HasThePapersColoursAtKnownPlaces) {
  EXPECT_EQ(At(0.1, 0.1), RgbOf(kHard));
  EXPECT_EQ(At(6.1, 0.1), RgbOf(kSoft));
  EXPECT_EQ(At(0.1, 0.9), RgbOf(kClosed));
  EXPECT_EQ(At(-8.0, 8.0), RgbOf(kFree));
}

TEST_F(WrittenCostmap, IsGreenWhereThereIsCostWithoutObstacle) {
  const Rgb rough = At(6.1, 0.9);
  EXPECT_GT(rough.green, rough.red + 5);
  EXPECT_GT(rough.green, rough.blue + 5);
}

TEST(Canvas, SaysWhichFileCannotBeWritten) {
  Canvas canvas(10, 10);
  const ReadOutcome outcome = canvas.WritePng("/dev/null/plan.png");
  EXPECT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.message.find("/dev/null/plan.png: cannot be written"), 0u) << outcome.message;
}

TEST(CellColour, TellsGroundOffTheMapFromObstacles) {
  EXPECT_EQ(RgbOf(CellColour(Costmap::kHard, 0)), RgbOf(kOffMap));
  EXPECT_EQ(RgbOf(CellColour(Costmap::kHard | Costmap::kObserved, 0)), RgbOf(kHard));
  EXPECT_EQ(RgbOf(CellColour(Costmap::kHard | Costmap::kPerson, 0)), RgbOf(kPerson));
  EXPECT_EQ(RgbOf(CellColour(0, 0)), RgbOf(kNotObserved));
}

}  // namespace
}  // namespace hardpack::picture
