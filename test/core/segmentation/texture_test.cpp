// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/texture.h"

#include <gtest/gtest.h>

#include <memory>

namespace hardpack {
namespace {

// One return and the 24 around it, each of which lies opposite to one of the other half.
//
//   o o x x x
//   o o x x x
//   o o R x x      R: 10 m; o: before it, x: behind it, further by as much as the test says
//   o o o x x
//   o o o x x
class Patch {
 public:
  static constexpr int kBeams = 16;
  static constexpr int kBeam = 8;
  static constexpr float kRoughness_m = 0.125f;  // numbers of binary fractions meet it exactly
  static constexpr float kNothing = RangeColumn::kNoReturn_m;

  bool IsSmooth(float before_m, float behind_m) {
    constexpr int kReach = RangeColumn::kReach_beams;
    constexpr int kMiddle = TextureFinder::kReach_directions;
    for (int across = -kMiddle; across <= kMiddle; ++across) {
      RangeColumn& column = columns_[across + kMiddle];
      column.Clear();
      for (int up = -kReach; up <= kReach; ++up) {
        const bool is_before = across < 0 || (across == 0 && up < 0);
        column.range_m[kBeam + up + kReach] = 10.0f + (is_before ? before_m : behind_m);
      }
    }
    columns_[kMiddle].range_m[kBeam + kReach] = 10.0f;
    SegmentationParams params;
    params.roughness_m = kRoughness_m;
    Texture texture;
    const RangeColumn* const columns[TextureFinder::kColumns] = {
        &columns_[0], &columns_[1], &columns_[2], &columns_[3], &columns_[4]};
    finder_->Find(columns, kBeams, params, texture);
    return texture.Is(Texture::kSmooth, kBeam);
  }

 private:
  RangeColumn columns_[TextureFinder::kColumns];
  std::unique_ptr<TextureFinder> finder_ = std::make_unique<TextureFinder>();
};

TEST(Texture, NeighboursAsFarOffAsTheRoughnessAreOnTheSameSurface) {
  Patch patch;
  for (const float off_m : {Patch::kRoughness_m, -Patch::kRoughness_m}) {
    EXPECT_TRUE(patch.IsSmooth(off_m, Patch::kNothing)) << off_m;
    EXPECT_TRUE(patch.IsSmooth(Patch::kNothing, off_m)) << off_m;
    EXPECT_FALSE(patch.IsSmooth(1.01f * off_m, Patch::kNothing)) << off_m;
    EXPECT_FALSE(patch.IsSmooth(Patch::kNothing, 1.01f * off_m)) << off_m;
  }
}

// A slanted surface: the return is off the middle of two that lie opposite by the roughness.
TEST(Texture, ASurfaceMaySlantAndBendByTheRoughness) {
  Patch patch;
  const float step_m = 4.0f * Patch::kRoughness_m;
  for (const float side : {1.0f, -1.0f}) {
    const float before_m = side * step_m;
    const float behind_m = side * (2.0f * Patch::kRoughness_m - step_m);
    EXPECT_TRUE(patch.IsSmooth(before_m, behind_m)) << side;
    EXPECT_TRUE(patch.IsSmooth(behind_m, before_m)) << side;
    EXPECT_FALSE(patch.IsSmooth(1.01f * before_m, behind_m)) << side;
    EXPECT_FALSE(patch.IsSmooth(behind_m, 1.01f * before_m)) << side;
  }
}

}  // namespace
}  // namespace hardpack
