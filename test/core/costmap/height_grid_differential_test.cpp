// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "core/base/math.h"
#include "core/costmap/height_grid.h"
#include "test/core/base/rounds.h"
#include "test/core/costmap/height_grid_reference.h"

namespace hardpack {
namespace {

// Everything happens within a few metres, so that each cell has many events.
class RandomLife {
 public:
  RandomLife(HeightGrid& grid, uint32_t seed) : grid_(grid), random_(seed), reference_({}) {
    center_ = {Between(-300.0f, 300.0f), Between(-300.0f, 300.0f)};
    middle_ = center_;
    EXPECT_EQ(grid_.Reset(center_), Status::kOk);
    reference_.Reset(center_);
    revolution_ = seed % 3 == 0 ? UINT32_MAX - 5 : Draw();
    ageing_revolutions_ = 1 + static_cast<int>(seed % HeightGrid::kMaxAgeingRevolutions);
  }

  void Step() {
    const uint32_t what = Draw() % 200;
    if (what < 20) Insert();
    if (what >= 20 && what < 25) Bridge();
    if (what == 25) Assume();
    if (what == 26) Move();
    if (what >= 27 && what < 30) Shift();
    if (what >= 30 && what < 70) ++revolution_;
    if (what >= 70) Age();
  }

  void Compare() {
    constexpr int kReach_cells = 18;  // some bridges go further
    const Cell about = CellAt(middle_);
    for (int dy = -kReach_cells; dy <= kReach_cells; ++dy) {
      for (int dx = -kReach_cells; dx <= kReach_cells; ++dx) {
        const Cell cell = {about.x + dx, about.y + dy};
        const HeightGrid::CellHeights is = grid_.At(cell);
        const HeightGrid::CellHeights should = reference_.At(cell);
        EXPECT_EQ(is.lowest_cm, should.lowest_cm) << dx << "," << dy;
        EXPECT_EQ(is.lowest_hard_cm, should.lowest_hard_cm) << dx << "," << dy;
        EXPECT_EQ(is.highest_hard_cm, should.highest_hard_cm) << dx << "," << dy;
        EXPECT_EQ(is.highest_soft_cm, should.highest_soft_cm) << dx << "," << dy;
        EXPECT_EQ(is.ground, should.ground) << dx << "," << dy;
        EXPECT_EQ(is.person, should.person) << dx << "," << dy;
        if (::testing::Test::HasFailure()) return;
      }
    }
  }

  int cut() const { return cut_; }
  int asked() const { return asked_; }
  int undecided() const { return undecided_; }

 private:
  uint32_t Draw() { return static_cast<uint32_t>(random_()); }

  float Between(float low, float high) {
    return low + (high - low) * static_cast<float>(Draw() % 1000003) / 1000003.0f;
  }

  Vec3 Point(float reach_m) {
    return {middle_.x_m + Between(-reach_m, reach_m), middle_.y_m + Between(-reach_m, reach_m),
            Between(-0.3f, 2.2f)};
  }

  void Insert() {
    // Into one cell or two: a body, a stone, a tuft.
    const Vec3 foot = Point(1.0f);
    const auto what = static_cast<ReturnClass>(Draw() % 5);
    const uint32_t revolution = revolution_ - Draw() % 4;
    for (int i = static_cast<int>(Draw() % 5); i >= 0; --i) {
      const Vec3 point = {foot.x_m + Between(-0.1f, 0.1f), foot.y_m, Between(-0.1f, 2.0f)};
      if (!reference_.Insert(point, what, revolution)) continue;
      const bool on_map = Window().Contains(CellAt({point.x_m, point.y_m}));
      EXPECT_EQ(grid_.Insert(point, what, revolution),
                on_map || what == ReturnClass::kIgnored ? Status::kOk : Status::kInvalidArgument);
    }
  }

  void Bridge() {
    const Vec3 from = Point(3.0f);
    const Vec3 to = Draw() % 8 == 0 ? from : Point(3.0f);
    if (!reference_.BridgeGround(from, to)) return;
    EXPECT_EQ(grid_.BridgeGround(from, to), Status::kOk);
  }

  void Assume() {
    const Vec3 center = Point(3.0f);
    const float radius_m = Between(0.0f, 1.0f);
    if (!reference_.AssumeGround(center, static_cast<double>(radius_m))) return;
    EXPECT_EQ(grid_.AssumeGround(center, radius_m), Status::kOk);
  }

  void Move() {
    center_.x_m = middle_.x_m + Between(-55.0f, 55.0f);
    center_.y_m = middle_.y_m + Between(-55.0f, 55.0f);
    reference_.Recenter(center_);
    EXPECT_EQ(grid_.Recenter(center_), Status::kOk);
  }

  void Shift() {
    const float dz_m = Between(-0.4f, 0.4f);
    if (!reference_.ShiftHeights(static_cast<double>(dz_m))) return;
    EXPECT_EQ(grid_.ShiftHeights(dz_m), Status::kOk);
  }

  void Age() {
    static constexpr int kBeams[] = {1, 2, 5, 16, 64, 128};
    SightFan fan;
    fan.sensor_odom = Point(4.0f);
    const Vec3 aim = Point(1.0f);
    const float x_m = aim.x_m - fan.sensor_odom.x_m;
    const float y_m = aim.y_m - fan.sensor_odom.y_m;
    const float length_m = Sqrt(x_m * x_m + y_m * y_m) * Between(0.995f, 1.005f);
    fan.direction_odom = {x_m / length_m, y_m / length_m};
    fan.beams = kBeams[Draw() % 6];
    fan.lowest_slope = Between(-0.6f, -0.1f);
    fan.highest_slope = Between(0.0f, 0.3f);
    const float wall_m = Between(0.2f, 4.0f) * length_m;
    const uint32_t blind_in_8 = Draw() % 4;
    for (int beam = 0; beam < fan.beams; ++beam) {
      const float share = static_cast<float>(beam) / static_cast<float>(fan.beams);
      fan.slope[beam] = fan.lowest_slope + (fan.highest_slope - fan.lowest_slope) * share;
      const uint32_t kind = Draw() % 8;
      fan.level_m[beam] = kind < blind_in_8 ? 0.0f : kind == 7 ? Between(0.1f, wall_m) : wall_m;
    }
    if (!Window().Contains(CellAt({fan.sensor_odom.x_m, fan.sensor_odom.y_m}))) return;
    ++asked_;
    const int before = Obstacles();
    if (!reference_.Age(fan, revolution_, ageing_revolutions_)) {
      ++undecided_;
      return;
    }
    EXPECT_EQ(grid_.Age(fan, revolution_, ageing_revolutions_), Status::kOk);
    cut_ += before - Obstacles();
  }

  const GridWindow& Window() const { return reference_.window(); }

  int Obstacles() const { return reference_.obstacles(); }

  HeightGrid& grid_;
  std::mt19937 random_;
  ReferenceGrid reference_;
  Vec2 middle_;  // of what happens
  Vec2 center_;  // of the window
  uint32_t revolution_ = 0;
  int ageing_revolutions_ = 1;
  int cut_ = 0;
  int asked_ = 0;
  int undecided_ = 0;
};

TEST(HeightGridDifferential, EqualsThePlainReferenceCellByCell) {
  const auto grid = std::make_unique<HeightGrid>();
  int cut = 0;
  int asked = 0;
  int undecided = 0;
  for (uint32_t seed = 1; seed <= Rounds(1000u, 200u); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    RandomLife life(*grid, seed);
    for (int step = 1; step <= 240; ++step) {
      life.Step();
      if (step % 40 == 0) life.Compare();
      if (HasFailure()) return;
    }
    cut += life.cut();
    asked += life.asked();
    undecided += life.undecided();
  }
  // The comparison means nothing when nothing goes, or when the reference shirks.
  EXPECT_GT(cut, Rounds(1000, 200));
  EXPECT_LT(undecided, asked / 10);
  RecordProperty("obstacles_gone", cut);
  RecordProperty("fans", asked);
  RecordProperty("fans_too_close_to_call", undecided);
}

}  // namespace
}  // namespace hardpack
