// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/texture.h"

#include <gtest/gtest.h>

#include <memory>

namespace hardpack {
namespace {

// One return with neighbours on one side only: below it and in the directions before it, or above
// it and in the directions behind it.
//
//   o o . . .
//   o o . . .
//   o o X . .      X: 10 m, o: further by as much as the test says, .: nothing
//   o o o . .
//   o o o . .
class Corner {
 public:
  static constexpr int kBeams = 16;
  static constexpr int kBeam = 8;
  static constexpr float kRoughness_m = 0.125f;  // numbers of binary fractions meet it exactly

  Texture LookAt(float further_m, bool before) {
    constexpr int kReach = RangeColumn::kReach_beams;
    constexpr int kMiddle = TextureFinder::kReach_directions;
    for (int across = -kMiddle; across <= kMiddle; ++across) {
      RangeColumn& column = columns_[across + kMiddle];
      column.Clear();
      for (int up = -kReach; up <= kReach; ++up) {
        const bool is_before = across < 0 || (across == 0 && up < 0);
        const bool is_middle = across == 0 && up == 0;
        if (is_middle || is_before != before) continue;
        column.range_m[kBeam + up + kReach] = 10.0f + further_m;
      }
    }
    columns_[kMiddle].range_m[kBeam + kReach] = 10.0f;
    SegmentationParams params;
    params.roughness_m = kRoughness_m;
    Texture texture;
    const RangeColumn* const columns[TextureFinder::kColumns] = {
        &columns_[0], &columns_[1], &columns_[2], &columns_[3], &columns_[4]};
    finder_->Find(columns, kBeams, params, texture);
    return texture;
  }

 private:
  RangeColumn columns_[TextureFinder::kColumns];
  std::unique_ptr<TextureFinder> finder_ = std::make_unique<TextureFinder>();
};

TEST(Texture, NeighboursAsFarOffAsTheRoughnessAreOnTheSameSurface) {
  Corner corner;
  for (const bool before : {true, false}) {
    for (const float further_m : {Corner::kRoughness_m, -Corner::kRoughness_m}) {
      EXPECT_TRUE(corner.LookAt(further_m, before).Is(Texture::kSmooth, Corner::kBeam))
          << further_m << before;
      EXPECT_FALSE(corner.LookAt(1.01f * further_m, before).Is(Texture::kSmooth, Corner::kBeam))
          << further_m << before;
    }
  }
}

}  // namespace
}  // namespace hardpack
