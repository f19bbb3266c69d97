// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "core/autonomy/planner.h"
#include "test/core/autonomy/scene.h"
#include "test/core/safety/rectangle.h"

// Vehicles of any outline on random maps, and whether what a usable plan sweeps touches a hard
// cell: by the rectangle itself against each square, in double (test/core/safety/rectangle.h).

namespace hardpack {

class SweptOutline {
 public:
  SweptOutline(const Scene& scene, const Plan& plan) : scene_(scene), plan_(plan) {
    for (const Block& block : scene.blocks) {
      if ((block.flags & (Costmap::kHard | Costmap::kPerson)) == 0) continue;
      boxes_.push_back(BoxQuad(0.2 * block.low.x, 0.2 * block.low.y, 0.2 * (block.high.x + 1),
                               0.2 * (block.high.y + 1)));
    }
  }

  // The least distance of all that is swept to any hard square [m]; a lower bound within kStep_m.
  double Clearance_m() const {
    double nearest = 1e9;
    for (int k = 0; k + 1 < plan_.path.size(); ++k) {
      nearest = std::min({nearest, OfChord(k), OfTurn(k + 1)});
    }
    return nearest;
  }

  static constexpr double kStep_m = 0.004;

 private:
  double Nearest(const Quad& outline) const {
    double nearest = 1e9;
    for (const Quad& box : boxes_) {
      const double dx = std::max({0.0, box[0].x - outline[0].x, outline[0].x - box[2].x});
      const double dy = std::max({0.0, box[0].y - outline[0].y, outline[0].y - box[2].y});
      // A corner of the outline is no further than this from all of it.
      if (std::hypot(dx, dy) > reach_m_) continue;
      nearest = std::min(nearest, DistanceBetween(outline, box));
    }
    return nearest;
  }

  // A rectangle that moves along its own length sweeps a longer one. What it moves aside on a chord
  // that is not along its heading is cut into pieces.
  double OfChord(int k) const {
    const Pose2& from = plan_.path[k];
    const double x_m = double{plan_.path[k + 1].x_m} - double{from.x_m};
    const double y_m = double{plan_.path[k + 1].y_m} - double{from.y_m};
    const double cos = std::cos(double{from.theta_rad});
    const double sin = std::sin(double{from.theta_rad});
    const double aside_m = std::abs(y_m * cos - x_m * sin);
    const int pieces = 1 + static_cast<int>(aside_m / kStep_m);
    VehicleParams swept = scene_.params.vehicle;
    swept.length_m += static_cast<float>(std::abs(x_m * cos + y_m * sin) / pieces);
    double nearest = 1e9;
    for (int i = 0; i < pieces; ++i) {
      const double share = (i + 0.5) / pieces;
      nearest = std::min(
          nearest, Nearest(OutlineQuad(swept, double{from.x_m} + share * x_m,
                                       double{from.y_m} + share * y_m, double{from.theta_rad})));
    }
    return nearest - 0.5 * aside_m / pieces - 1e-5;
  }

  double OfTurn(int k) const {
    const Pose2& before = plan_.path[k - 1];
    const Pose2& at = plan_.path[k];
    const double turn_rad =
        std::remainder(double{at.theta_rad} - double{before.theta_rad}, 2.0 * M_PI);
    const double arc_m = std::abs(turn_rad) * double{PivotRadiusOf(scene_.params.vehicle)};
    const int pieces = 1 + static_cast<int>(arc_m / kStep_m);
    double nearest = 1e9;
    for (int i = 0; i <= pieces; ++i) {
      const double theta_rad = double{before.theta_rad} + turn_rad * i / pieces;
      nearest = std::min(nearest, Nearest(OutlineQuad(scene_.params.vehicle, double{at.x_m},
                                                      double{at.y_m}, theta_rad)));
    }
    return nearest - 0.5 * arc_m / pieces;
  }

  const Scene& scene_;
  const Plan& plan_;
  std::vector<Quad> boxes_;
  const double reach_m_ = 9.0;
};

// 0.5-6 m long, 0.4-2.6 m wide, the axle anywhere along the length; blocks of up to 2 m within 24
// m, from few to many, and a goal 12-24 m away.
inline Scene RandomOutline(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Scene scene = SceneTo({0.0f, 0.0f}, {0.1f, 0.1f, kTwoPi * (unit(random) - 0.5f)});
  VehicleParams& vehicle = scene.params.vehicle;
  vehicle.length_m = 0.5f + 5.5f * unit(random);
  vehicle.width_m = 0.4f + 2.2f * unit(random);
  vehicle.axle_offset_m = vehicle.length_m * (unit(random) - 0.5f);
  // A narrow vehicle may plan as narrowly as it is.
  scene.params.costmap.planning_radius_m = 0.0f;
  const float way_rad = kTwoPi * unit(random);
  const float way_m = 12.0f + 12.0f * unit(random);
  scene.request.goal_odom = {way_m * std::cos(way_rad), way_m * std::sin(way_rad)};
  const int blocks = 5 + static_cast<int>(unit(random) * unit(random) * 120.0f);
  for (int i = 0; i < blocks; ++i) {
    const auto x = static_cast<int32_t>(240.0f * (unit(random) - 0.5f));
    const auto y = static_cast<int32_t>(240.0f * (unit(random) - 0.5f));
    const auto right = x + static_cast<int32_t>(10.0f * unit(random) * unit(random));
    const auto high = y + static_cast<int32_t>(10.0f * unit(random) * unit(random));
    if (std::hypot(static_cast<float>(x), static_cast<float>(y)) < 8.0f) continue;
    scene.Add(x, y, right, high);
  }
  return scene;
}

struct OutlineCounts {
  int plans = 0;     // that are usable and began clear
  int in_start = 0;  // that began in something
  int refused = 0;
  double least_m = 1e9;
};

inline void JudgeOutlines(uint32_t first, uint32_t last, OutlineCounts& counts) {
  for (uint32_t seed = first; seed <= last; ++seed) {
    const Scene scene = RandomOutline(seed);
    const Plan& plan = PlanIn(scene);
    if (!IsUsable(plan.status)) {
      ++counts.refused;
      continue;
    }
    if (plan.check.start_overlaps) {
      ++counts.in_start;
      continue;
    }
    ++counts.plans;
    const VehicleParams& vehicle = scene.params.vehicle;
    const double clearance_m = SweptOutline(scene, plan).Clearance_m();
    // A way out may have cells across its flanks, and is not called ok then.
    const bool may_lie_across = plan.lead_points > 0 && plan.status != Status::kOk;
    if (!may_lie_across) counts.least_m = std::min(counts.least_m, clearance_m);
    const double least_m = may_lie_across ? -double{PathCheck::kAcross_m} - 1e-4 : 0.0;
    EXPECT_GT(clearance_m, least_m)
        << "seed " << seed << ": " << vehicle.length_m << " x " << vehicle.width_m << " m, axle "
        << vehicle.axle_offset_m << ", " << StatusName(plan.status);
    // What the check says is never more than there is.
    EXPECT_LE(double{plan.check.smallest_clearance_m}, clearance_m + SweptOutline::kStep_m)
        << "seed " << seed;
  }
}

}  // namespace hardpack
