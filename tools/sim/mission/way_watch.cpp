// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/way_watch.h"

#include <algorithm>
#include <cmath>

namespace hardpack::mission {
namespace {

using world::Point2;

// The part of a line that counts, from 0 at its first point to 1 at its last.
struct Range {
  double begin = 0.0;
  double end = 1.0;
};

// Distance from a point to a chord.
double ToChord_m(Point2 p, Point2 from, Point2 to, Range range = {}) {
  const double dx = to.x_m - from.x_m;
  const double dy = to.y_m - from.y_m;
  const double length2 = dx * dx + dy * dy;
  const double along = (p.x_m - from.x_m) * dx + (p.y_m - from.y_m) * dy;
  const double share = length2 > 0.0 ? std::clamp(along / length2, range.begin, range.end) : 0.0;
  const double off_x = p.x_m - from.x_m - share * dx;
  const double off_y = p.y_m - from.y_m - share * dy;
  return std::sqrt(off_x * off_x + off_y * off_y);
}

std::vector<Point2> PointsOf(const WorldPath& path) {
  std::vector<Point2> points;
  for (const Pose2& pose : path) points.push_back({double{pose.x_m}, double{pose.y_m}});
  return points;
}

}  // namespace

double DistanceToPath_m(Point2 point, std::span<const Point2> path) {
  double least_m = INFINITY;
  for (size_t i = 0; i + 1 < path.size(); ++i) {
    least_m = std::min(least_m, ToChord_m(point, path[i], path[i + 1]));
  }
  return least_m;
}

double CrossTrack_m(Point2 point, std::span<const Point2> path) {
  double least_m = INFINITY;
  for (size_t i = 0; i + 1 < path.size(); ++i) {
    const Range range = {i == 0 ? -INFINITY : 0.0, i + 2 == path.size() ? INFINITY : 1.0};
    least_m = std::min(least_m, ToChord_m(point, path[i], path[i + 1], range));
  }
  return least_m;
}

double OffBase_m(const Plan& plan) {
  const std::vector<Point2> base = PointsOf(plan.base);
  if (base.size() < 2) return 0.0;
  double most_m = 0.0;
  for (const Point2& point : PointsOf(plan.path)) {
    most_m = std::max(most_m, DistanceToPath_m(point, base));
  }
  return most_m;
}

WayWatch::WayWatch(const world::Scenario& scenario, experiment::WayResult& result)
    : scenario_(scenario), result_(result) {
  const double dx_m = scenario.goal.x_m - scenario.start.position.x_m;
  const double dy_m = scenario.goal.y_m - scenario.start.position.y_m;
  const double length_m = std::sqrt(dx_m * dx_m + dy_m * dy_m);
  if (length_m > 0.0) {
    forward_x_ = dx_m / length_m;
    forward_y_ = dy_m / length_m;
  }
  if (scenario.corridor_half_width_m > 0.0) result_.off_middle_m = 0.0;
}

// Precondition: there is a landmark.
WayWatch::Place WayWatch::PlaceOf(Point2 point) const {
  const double dx_m = point.x_m - scenario_.around->middle.x_m;
  const double dy_m = point.y_m - scenario_.around->middle.y_m;
  return {forward_x_ * dx_m + forward_y_ * dy_m, forward_x_ * dy_m - forward_y_ * dx_m};
}

// Where the path first passes the landmark's middle; kNone: it does not get there.
WayWatch::PassingSide WayWatch::SideOf(std::span<const Point2> path) const {
  for (size_t i = 0; i + 1 < path.size(); ++i) {
    const Place from = PlaceOf(path[i]);
    const Place to = PlaceOf(path[i + 1]);
    if (from.along_m >= 0.0 || to.along_m < 0.0) continue;
    const double share = from.along_m / (from.along_m - to.along_m);
    const double left_m = from.left_m + share * (to.left_m - from.left_m);
    return left_m > 0.0 ? PassingSide::kLeft : PassingSide::kRight;
  }
  return PassingSide::kNone;
}

void WayWatch::Committed(std::span<const Point2> path, Point2 here, bool is_replan) {
  if (!scenario_.around) return;
  const auto [along_m, left_m] = PlaceOf(here);
  const bool is_in_view = std::fabs(along_m) <= scenario_.around->radius_m ||
                          (along_m < 0.0 && std::fabs(left_m) >= scenario_.around->seen_past_m);
  if (is_replan && is_in_view) ++result_.replans_beside;
  if (along_m >= 0.0) return;
  const PassingSide side = SideOf(path);
  if (side == PassingSide::kNone) return;
  if (side_ != PassingSide::kNone && side != side_) ++result_.side_switches;
  side_ = side;
}

// Along the corridor its middle; beside the pillar the middle between pillar and wall. In between
// the vehicle may drive anywhere.
void WayWatch::Moved(Point2 here) {
  if (!result_.off_middle_m) return;
  const double half_m = scenario_.corridor_half_width_m;
  double off_m = std::fabs(here.y_m);
  if (scenario_.around) {
    const double pillar_m = scenario_.around->radius_m;
    const double to_pillar_m = std::fabs(here.x_m - scenario_.around->middle.x_m);
    if (to_pillar_m <= pillar_m) {
      off_m = std::fabs(off_m - (half_m + pillar_m) / 2.0);
    } else if (to_pillar_m <= 2.0 * half_m) {
      return;
    }
  }
  result_.off_middle_m = std::max(*result_.off_middle_m, off_m);
}

void WayWatch::Followed(double t_s, double cross_track_m) {
  result_.cross_track_m = std::max(result_.cross_track_m, cross_track_m);
  if (result_.recovered && cross_track_m > kOvershoot_m) {
    result_.recovered = false;
    ++result_.overshoots;
    overshot_since_s_ = t_s;
  }
  if (result_.recovered) return;
  result_.recovery_s = std::max(result_.recovery_s, t_s - overshot_since_s_);
  result_.recovered = cross_track_m < kRecovered_m;
}

}  // namespace hardpack::mission
