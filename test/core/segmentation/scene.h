// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/segmentation/segmentation.h"

// A small world that a lidar of 64 beams looks at from the vehicle's standing place: a profile of
// the ground (level distance, height), the same or another in each direction, and things on it.

namespace hardpack {

struct ProfilePoint {
  double level_m;
  double height_m;
};
using Profile = std::vector<ProfilePoint>;  // from the vehicle outward; vertical faces are allowed

inline Profile FlatGround() {
  return {{0.0, 0.0}, {100.0, 0.0}};
}

// Where a ray meets something, as level distance; infinity: nowhere. side_m: how far left of the
// middle direction the ray is, per metre of level distance.
using Thing = std::function<double(double side, double slope)>;

constexpr double kSensorHeight_m = 1.32;
constexpr double kNowhere_m = std::numeric_limits<double>::infinity();

// First crossing of the ray z = kSensorHeight_m + slope * d with the profile.
inline double MeetProfile(const Profile& profile, double slope) {
  for (size_t i = 1; i < profile.size(); ++i) {
    const ProfilePoint& a = profile[i - 1];
    const ProfilePoint& b = profile[i];
    const double above_a = kSensorHeight_m + slope * a.level_m - a.height_m;
    const double above_b = kSensorHeight_m + slope * b.level_m - b.height_m;
    if (above_a <= 0.0 || above_b > 0.0) continue;
    return a.level_m + (b.level_m - a.level_m) * above_a / (above_a - above_b);
  }
  return kNowhere_m;
}

// An upright cylinder at level distance d ahead and y to the left.
inline Thing Cylinder(double d_m, double y_m, double radius_m, double bottom_m, double top_m) {
  return [=](double side, double slope) {
    // |(t, side t) - (d, y)| = radius
    const double a = 1.0 + side * side;
    const double b = d_m + side * y_m;
    const double c = d_m * d_m + y_m * y_m - radius_m * radius_m;
    const double root = b * b - a * c;
    if (root < 0.0) return kNowhere_m;
    const double level_m = (b - std::sqrt(root)) / std::sqrt(a);
    const double z_m = kSensorHeight_m + slope * level_m;
    return z_m >= bottom_m && z_m <= top_m ? level_m : kNowhere_m;
  };
}

// Leaves in an upright cylinder: of the rays through it a share meets one, anywhere on their way.
inline Thing Leaves(double d_m, double y_m, double radius_m, double bottom_m, double top_m,
                    double share, std::mt19937& random) {
  const Thing hull = Cylinder(d_m, y_m, radius_m, -100.0, 100.0);
  return [=, &random](double side, double slope) {
    const double near_m = hull(side, slope);
    if (near_m == kNowhere_m || std::uniform_real_distribution(0.0, 1.0)(random) > share) {
      return kNowhere_m;
    }
    const double half_m =
        std::sqrt(std::max(radius_m * radius_m - std::pow(side * d_m - y_m, 2), 0.0));
    const double level_m = near_m + std::uniform_real_distribution(0.0, 2.0 * half_m)(random);
    const double z_m = kSensorHeight_m + slope * level_m;
    return z_m >= bottom_m && z_m <= top_m ? level_m : kNowhere_m;
  };
}

struct Seen {
  int direction;
  int beam;
  double level_m;
  double height_m;
  int thing;  // -1: the ground
  ReturnClass what;
  bool ground_known;
  float above_ground_m;
  int observed_from;
};

class World {
 public:
  static constexpr int kBeams = 64;
  static constexpr int kDirections = 81;
  static constexpr double kSpacing_rad = 2.0 * M_PI / 2048.0;

  explicit World(uint32_t seed = 1) : random_(seed) {}

  std::function<Profile(int direction)> ground = [](int) { return FlatGround(); };
  std::vector<Thing> things;
  double pitch_rad = 0.0;
  double noise_m = 0.015;     // of the range
  double roughness_m = 0.01;  // of the ground
  double rain_share = 0.0;    // of the beams that meet a drop
  SegmentationParams params;
  std::mt19937& random() { return random_; }

  double Slope(int beam) const {
    return std::tan((-16.6 + 33.2 * beam / (kBeams - 1)) * M_PI / 180.0 + pitch_rad);
  }
  static double Side(int direction) {
    return std::tan((direction - kDirections / 2) * kSpacing_rad);
  }

  // What the segmenter says of every return.
  std::vector<Seen> Look() {
    auto segmenter = std::make_unique<Segmenter>();
    EXPECT_EQ(segmenter->Configure(params, kBeams), Status::kOk);
    std::vector<Seen> seen;
    std::vector<std::vector<Seen>> waiting;
    for (int direction = 0; direction < kDirections + Segmenter::kLag; ++direction) {
      DirectionView view;
      waiting.push_back(Fill(direction, view));
      EXPECT_EQ(segmenter->Push(view), Status::kOk);
      if (!segmenter->ready()) continue;
      const DirectionClasses& classes = segmenter->result();
      for (Seen item : waiting[static_cast<size_t>(direction - Segmenter::kLag)]) {
        item.what = classes.what[item.beam];
        item.ground_known = classes.ground_known[item.beam];
        item.above_ground_m = classes.above_ground_m[item.beam];
        item.observed_from = classes.observed_from[item.beam];
        seen.push_back(item);
      }
    }
    return seen;
  }

 private:
  std::vector<Seen> Fill(int direction, DirectionView& view) {
    std::vector<Seen> returns;
    view.beams = kBeams;
    view.sensor_height_m = static_cast<float>(kSensorHeight_m);
    const Profile profile = ground(direction);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int beam = 0; beam < kBeams; ++beam) {
      const double slope = Slope(beam);
      view.slope[beam] = static_cast<float>(slope);
      const double bump_m = noise(random_) * roughness_m;
      Seen item{direction, beam, MeetProfile(Shifted(profile, bump_m), slope), 0.0, -1, {}, {},
                {},        {}};
      for (size_t i = 0; i < things.size(); ++i) {
        const double level_m = things[i](Side(direction), slope);
        if (level_m >= item.level_m) continue;
        item.level_m = level_m;
        item.thing = static_cast<int>(i);
      }
      std::uniform_real_distribution<double> share(0.0, 1.0);
      if (share(random_) < rain_share) {
        item.level_m = std::min(item.level_m, 1.5 + 20.0 * share(random_));
        item.thing = kRain;
      }
      const double length = std::sqrt(1.0 + slope * slope);
      const double range_m = item.level_m * length + noise(random_) * noise_m;
      if (!(range_m < 100.0)) continue;
      item.level_m = range_m / length;
      item.height_m = kSensorHeight_m + slope * item.level_m;
      view.seen[beam] = true;
      view.range_m[beam] = static_cast<float>(range_m);
      view.level_m[beam] = static_cast<float>(item.level_m);
      view.height_m[beam] = static_cast<float>(item.height_m);
      returns.push_back(item);
    }
    return returns;
  }

  static Profile Shifted(Profile profile, double by_m) {
    for (ProfilePoint& point : profile) point.height_m += by_m;
    return profile;
  }

 public:
  static constexpr int kRain = 1000;

 private:
  std::mt19937 random_;
};

// Share of the returns that `which` picks of which `holds` is true; NaN when it picks none, so that
// every comparison with it fails.
template <typename Which, typename Holds>
double Share(const std::vector<Seen>& seen, Which which, Holds holds) {
  double all = 0.0;
  double those = 0.0;
  for (const Seen& item : seen) {
    if (!which(item)) continue;
    all += 1.0;
    if (holds(item)) those += 1.0;
  }
  return those / all;
}

// What the map takes for an obstacle: neither ground nor ignored, and high enough above the ground,
// or its ground not known.
inline bool IsObstacle(const Seen& item) {
  const bool stands = item.what == ReturnClass::kHard || item.what == ReturnClass::kSoft;
  return stands && (!item.ground_known || item.above_ground_m > 0.5f);
}

}  // namespace hardpack
