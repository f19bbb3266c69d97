// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "core/optimizer/optimizer.h"

// Maps given by a formula, seeds as a search would give them, and measures of a path.

namespace hardpack {

inline constexpr int kAllUnits = 1 << 30;

// A map around the odom origin whose cost at a cell's centre is cost(x, y).
template <typename CostFunction>
std::unique_ptr<Costmap> MapOf(CostFunction cost) {
  auto map = std::make_unique<Costmap>();
  map->window = GridWindow::CenteredAt({0.0f, 0.0f});
  for (int index = 0; index < kMapCells; ++index) {
    const Vec2 center = CellCenter(map->window.FromIndex(index));
    map->cost_q8[index] = static_cast<uint16_t>(256.0f * cost(center.x_m, center.y_m));
  }
  return map;
}

inline std::unique_ptr<Costmap> EmptyMap() {
  return MapOf([](float, float) { return 0.0f; });
}

struct Disc {
  float x_m;
  float y_m;
  float radius_m;
};

// Grows with the depth inside each disc, and falls to zero over 2 m outside.
inline float CostOfDiscs(const std::vector<Disc>& discs, float x_m, float y_m) {
  float cost = 0.0f;
  for (const Disc& disc : discs) {
    const float out_m = std::hypot(x_m - disc.x_m, y_m - disc.y_m) - disc.radius_m;
    if (out_m < 0.0f) cost += 6.0f - 6.0f * out_m;
    if (out_m >= 0.0f && out_m < 2.0f) cost += 1.5f * (2.0f - out_m) * (2.0f - out_m);
  }
  return std::min(cost, 39.0f);
}

// Points every step_m along a polyline.
inline WorldPath Along(const std::vector<Vec2>& corners, float step_m = 0.275f) {
  WorldPath path;
  float carry_m = 0.0f;
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    const float dx = corners[i + 1].x_m - corners[i].x_m;
    const float dy = corners[i + 1].y_m - corners[i].y_m;
    const float length_m = std::hypot(dx, dy);
    for (; carry_m < length_m && !path.full(); carry_m += step_m) {
      const float share = carry_m / length_m;
      EXPECT_EQ(path.PushBack({corners[i].x_m + share * dx, corners[i].y_m + share * dy, 0.0f}),
                Status::kOk);
    }
    carry_m -= length_m;
  }
  SetHeadingsFromChords(path);
  return path;
}

// A path that wanders as a search's does: runs in three directions, with corners of 45 degrees.
inline WorldPath Staircase(unsigned seed, int points, Vec2 start) {
  std::mt19937 random(seed);
  std::vector<Vec2> corners = {start};
  float length_m = 0.0f;
  int direction = 1;
  while (length_m < 0.275f * static_cast<float>(points)) {
    direction = direction != 0 ? 0 : random() % 2 == 0 ? 1 : -1;
    const float run_m = 1.6f + 0.2f * static_cast<float>(random() % 25);
    const Vec2 at = corners.back();
    corners.push_back({at.x_m + run_m, at.y_m + run_m * static_cast<float>(direction)});
    length_m += run_m;
  }
  WorldPath path = Along(corners);
  if (path.size() > points) path.Resize(points);
  SetHeadingsFromChords(path);
  return path;
}

struct Shape {
  float largest_curvature_per_m = 0.0f;
  float largest_rate_per_m2 = 0.0f;
  float longest_step_m = 0.0f;
  float shortest_step_m = 1e9f;
};

inline Shape ShapeOf(const WorldPath& path, float start_curvature_per_m) {
  Shape shape;
  double before = start_curvature_per_m;
  for (int k = 0; k + 1 < path.size(); ++k) {
    const double dx = double{path[k + 1].x_m} - path[k].x_m;
    const double dy = double{path[k + 1].y_m} - path[k].y_m;
    const double step_m = std::hypot(dx, dy);
    shape.longest_step_m = std::max(shape.longest_step_m, static_cast<float>(step_m));
    shape.shortest_step_m = std::min(shape.shortest_step_m, static_cast<float>(step_m));
    if (k == 0) continue;
    const double ax = double{path[k].x_m} - path[k - 1].x_m;
    const double ay = double{path[k].y_m} - path[k - 1].y_m;
    const double ds_m = (std::hypot(ax, ay) + step_m) / 2;
    const double curvature = std::atan2(ax * dy - ay * dx, ax * dx + ay * dy) / ds_m;
    const double rate = (curvature - before) / ds_m;
    before = curvature;
    shape.largest_curvature_per_m =
        std::max(shape.largest_curvature_per_m, static_cast<float>(std::abs(curvature)));
    shape.largest_rate_per_m2 =
        std::max(shape.largest_rate_per_m2, static_cast<float>(std::abs(rate)));
  }
  return shape;
}

inline bool SamePoints(const WorldPath& a, const WorldPath& b) {
  if (a.size() != b.size()) return false;
  for (int k = 0; k < a.size(); ++k) {
    if (a[k].x_m != b[k].x_m || a[k].y_m != b[k].y_m || a[k].theta_rad != b[k].theta_rad) {
      return false;
    }
  }
  return true;
}

}  // namespace hardpack
