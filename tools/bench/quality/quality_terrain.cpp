// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/quality/quality_terrain.h"

#include <algorithm>
#include <cmath>

#include "core/base/math.h"
#include "core/costmap/costmap.h"

namespace hardpack::command {
namespace {

constexpr uint8_t kHard = Costmap::kHard;
constexpr uint8_t kSoft = Costmap::kSoft;

constexpr float kBeside_m = 16.0f;  // farthest obstacle to either side of the way
constexpr float kBeyond_m = 8.0f;   // and before the start and behind the goal

// One obstacle per each_m2 square metres, anywhere along the way.
template <typename DrawOne>
void Scatter(Draw& random, const Terrain& terrain, float each_m2, DrawOne&& draw_one) {
  const float length_m = terrain.way().length_m + 2.0f * kBeyond_m;
  const int count = static_cast<int>(length_m * 2.0f * kBeside_m / each_m2);
  for (int i = 0; i < count; ++i) {
    const float x_m = random.Uniform(-kBeyond_m, length_m - kBeyond_m);
    const float y_m = random.Uniform(-kBeside_m, kBeside_m);
    draw_one(Vec2{x_m, y_m});
  }
}

void Bushes(Draw& random, Terrain& terrain, float each_m2) {
  Scatter(random, terrain, each_m2,
          [&](Vec2 place) { terrain.Disc(place, random.Uniform(0.3f, 1.0f), kSoft); });
}

void Trunks(Draw& random, Terrain& terrain, float each_m2) {
  Scatter(random, terrain, each_m2,
          [&](Vec2 place) { terrain.Disc(place, random.Uniform(0.1f, 0.35f), kHard); });
}

void Boxes(Draw& random, Terrain& terrain, float each_m2) {
  Scatter(random, terrain, each_m2, [&](Vec2 place) {
    const float half_length_m = random.Uniform(0.5f, 2.5f);
    const float half_width_m = random.Uniform(0.5f, 2.5f);
    terrain.Box(place, half_length_m, half_width_m, random.Uniform(0.0f, kPi), kHard);
  });
}

void Hills(Draw& random, Terrain& terrain, float each_m2) {
  Scatter(random, terrain, each_m2,
          [&](Vec2 place) { terrain.Disc(place, random.Uniform(1.5f, 5.0f), kSoft); });
}

Vec2 StraightAhead(const Terrain& terrain) {
  return {terrain.way().length_m, 0.0f};
}

// The same among scattered obstacles: with room for the vehicle at both ends.
Vec2 StraightAheadBetweenFreeEnds(Terrain& terrain) {
  constexpr float kRoom_m = 3.0f;
  const Vec2 goal = StraightAhead(terrain);
  terrain.Disc({}, kRoom_m, 0);
  terrain.Disc(goal, kRoom_m, 0);
  return goal;
}

Vec2 DrawSparseForest(Draw& random, Terrain& terrain) {
  Bushes(random, terrain, 80.0f);
  Trunks(random, terrain, 80.0f);
  return StraightAheadBetweenFreeEnds(terrain);
}

Vec2 DrawForest(Draw& random, Terrain& terrain) {
  Bushes(random, terrain, 80.0f);
  Trunks(random, terrain, 40.0f);
  return StraightAheadBetweenFreeEnds(terrain);
}

Vec2 DrawDenseForest(Draw& random, Terrain& terrain) {
  Bushes(random, terrain, 60.0f);
  Trunks(random, terrain, 24.0f);
  return StraightAheadBetweenFreeEnds(terrain);
}

Vec2 DrawBoxes(Draw& random, Terrain& terrain) {
  Boxes(random, terrain, 90.0f);
  return StraightAheadBetweenFreeEnds(terrain);
}

// Walls across the way, each with one opening.
Vec2 DrawGaps(Draw& random, Terrain& terrain) {
  constexpr float kWall_m = 30.0f;  // to either side: no way around
  float x_m = random.Uniform(7.0f, 12.0f);
  while (x_m < terrain.way().length_m - 6.0f) {
    const float middle_m = random.Uniform(-5.0f, 5.0f);
    const float half_gap_m = random.Uniform(1.6f, 2.4f);
    const float lean_m = random.Uniform(-2.0f, 2.0f);
    terrain.Stroke({x_m, middle_m + half_gap_m}, {x_m + lean_m, kWall_m}, 0.2f, kHard);
    terrain.Stroke({x_m, middle_m - half_gap_m}, {x_m - lean_m, -kWall_m}, 0.2f, kHard);
    x_m += random.Uniform(9.0f, 14.0f);
  }
  return StraightAhead(terrain);
}

// Rows of posts, too close to pass between, from the left and from the right in turn, each reaching
// past the middle.
Vec2 DrawSlalom(Draw& random, Terrain& terrain) {
  constexpr float kPostsEvery_m = 1.6f;
  float side = random.OneIn(2) ? 1.0f : -1.0f;
  float x_m = random.Uniform(6.0f, 9.0f);
  while (x_m < terrain.way().length_m - 5.0f) {
    const float past_m = random.Uniform(0.3f, 2.0f);
    for (float y_m = -past_m; y_m < 30.0f; y_m += kPostsEvery_m) {
      terrain.Disc({x_m, side * y_m}, 0.12f, kHard);
    }
    side = -side;
    x_m += random.Uniform(8.0f, 12.0f);
  }
  return StraightAhead(terrain);
}

// Two walls along a wave: y = A (sin(k x + phase) - sin(phase)).
Vec2 DrawCorridor(Draw& random, Terrain& terrain) {
  constexpr float kSharpest_per_m = 0.28f;
  constexpr float kEvery_m = 0.25f;
  const float k_per_m = kTwoPi / random.Uniform(18.0f, 36.0f);
  const float height_m = Min(random.Uniform(1.5f, 6.0f), kSharpest_per_m / (k_per_m * k_per_m));
  const float phase_rad = random.Uniform(0.0f, kTwoPi);
  const float half_width_m = random.Uniform(1.9f, 3.2f);
  const auto middle_m = [&](float x_m) {
    return height_m * (Sin(k_per_m * x_m + phase_rad) - Sin(phase_rad));
  };
  for (float x_m = -kBeyond_m; x_m < terrain.way().length_m + kBeyond_m; x_m += kEvery_m) {
    const float slope = height_m * k_per_m * Cos(k_per_m * x_m + phase_rad);
    const float share = half_width_m / Sqrt(1.0f + slope * slope);
    const float y_m = middle_m(x_m);
    terrain.Disc({x_m - slope * share, y_m + share}, 0.25f, kHard);
    terrain.Disc({x_m + slope * share, y_m - share}, 0.25f, kHard);
  }
  return {terrain.way().length_m, middle_m(terrain.way().length_m)};
}

Vec2 DrawHills(Draw& random, Terrain& terrain) {
  Hills(random, terrain, 70.0f);
  return StraightAheadBetweenFreeEnds(terrain);
}

Vec2 DrawMeadow(Draw& random, Terrain& terrain) {
  Bushes(random, terrain, 16.0f);
  return StraightAheadBetweenFreeEnds(terrain);
}

// Some of everything, and places that nothing is known of.
Vec2 DrawMixed(Draw& random, Terrain& terrain) {
  Hills(random, terrain, 250.0f);
  Trunks(random, terrain, 70.0f);
  Boxes(random, terrain, 250.0f);
  Scatter(random, terrain, 250.0f,
          [&](Vec2 place) { terrain.Unobserved(place, random.Uniform(1.5f, 4.0f)); });
  return StraightAheadBetweenFreeEnds(terrain);
}

}  // namespace

Draw::Draw(uint32_t seed, uint32_t stream) {
  std::seed_seq sequence = {seed, stream};
  engine_.seed(sequence);
}

float Draw::Uniform(float low, float high) {
  const auto share = static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f);
  return low + share * (high - low);
}

bool Draw::OneIn(int count) {
  return engine_() % static_cast<uint32_t>(count) == 0;
}

Vec2 Way::ToOdom(Vec2 point_way) const {
  const SinCosPair turn = SinCos(direction_rad);
  return {start_odom.x_m + turn.cos * point_way.x_m - turn.sin * point_way.y_m,
          start_odom.y_m + turn.sin * point_way.x_m + turn.cos * point_way.y_m};
}

Terrain::Terrain(const Way& way)
    : way_(way),
      window_(GridWindow::CenteredAt({})),
      flags_(static_cast<size_t>(kMapCells), uint8_t{Costmap::kObserved}) {}

// change(flags, offset): of each cell of the map near enough, with its centre's offset in odom.
template <typename Change>
void Terrain::ForCellsWithin(Vec2 centre_odom, float reach_m, Change&& change) {
  const Cell low = CellAt({centre_odom.x_m - reach_m, centre_odom.y_m - reach_m});
  const Cell high = CellAt({centre_odom.x_m + reach_m, centre_odom.y_m + reach_m});
  for (int32_t y = low.y; y <= high.y; ++y) {
    for (int32_t x = low.x; x <= high.x; ++x) {
      if (!window_.Contains({x, y})) continue;
      const Vec2 cell = CellCenter({x, y});
      change(flags_[static_cast<size_t>(window_.Index({x, y}))],
             Vec2{cell.x_m - centre_odom.x_m, cell.y_m - centre_odom.y_m});
    }
  }
}

void Terrain::Stroke(Vec2 from_way, Vec2 to_way, float radius_m, uint8_t flag) {
  const Vec2 from = way_.ToOdom(from_way);
  const Vec2 to = way_.ToOdom(to_way);
  const Vec2 along = {to.x_m - from.x_m, to.y_m - from.y_m};
  const float length2_m2 = along.x_m * along.x_m + along.y_m * along.y_m;
  const auto set = [flag](uint8_t& cell) {
    cell = static_cast<uint8_t>(flag == 0 ? Costmap::kObserved : cell | flag);
  };
  ForCellsWithin(from, Sqrt(length2_m2) + radius_m, [&](uint8_t& cell, Vec2 offset) {
    const float dot = offset.x_m * along.x_m + offset.y_m * along.y_m;
    const float share = length2_m2 > 0.0f ? Clamp(dot / length2_m2, 0.0f, 1.0f) : 0.0f;
    const float dx_m = offset.x_m - share * along.x_m;
    const float dy_m = offset.y_m - share * along.y_m;
    if (dx_m * dx_m + dy_m * dy_m <= radius_m * radius_m) set(cell);
  });
  for (const Vec2& end : {from, to}) {
    if (window_.Contains(CellAt(end))) {
      set(flags_[static_cast<size_t>(window_.Index(CellAt(end)))]);
    }
  }
}

void Terrain::Box(Vec2 centre_way, float half_length_m, float half_width_m, float angle_rad,
                  uint8_t flag) {
  const SinCosPair turn = SinCos(way_.direction_rad + angle_rad);
  ForCellsWithin(way_.ToOdom(centre_way), half_length_m + half_width_m,
                 [&](uint8_t& cell, Vec2 offset) {
                   const float u_m = turn.cos * offset.x_m + turn.sin * offset.y_m;
                   const float v_m = turn.cos * offset.y_m - turn.sin * offset.x_m;
                   if (Abs(u_m) > half_length_m || Abs(v_m) > half_width_m) return;
                   cell = static_cast<uint8_t>(cell | flag);
                 });
}

void Terrain::Unobserved(Vec2 centre_way, float radius_m) {
  ForCellsWithin(way_.ToOdom(centre_way), radius_m, [&](uint8_t& cell, Vec2 offset) {
    const bool is_free = (cell & (kHard | kSoft)) == 0;
    const float distance2_m2 = offset.x_m * offset.x_m + offset.y_m * offset.y_m;
    if (is_free && distance2_m2 <= radius_m * radius_m) cell = 0;
  });
}

const std::vector<TerrainKind>& TerrainKinds() {
  static const std::vector<TerrainKind> kinds = {{"sparse forest", DrawSparseForest},
                                                 {"forest", DrawForest},
                                                 {"dense forest", DrawDenseForest},
                                                 {"boxes", DrawBoxes},
                                                 {"gaps", DrawGaps},
                                                 {"slalom", DrawSlalom},
                                                 {"corridor", DrawCorridor},
                                                 {"hills", DrawHills},
                                                 {"meadow", DrawMeadow},
                                                 {"mixed", DrawMixed}};
  return kinds;
}

}  // namespace hardpack::command
