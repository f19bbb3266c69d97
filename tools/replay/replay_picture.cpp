// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay_picture.h"

#include <algorithm>
#include <string>
#include <vector>

#include "tools/picture/axes.h"
#include "tools/picture/cell_image.h"
#include "tools/picture/palette.h"
#include "tools/picture/plan_picture.h"

namespace hardpack::replay {
namespace {

constexpr int kWidth_px = 1100;
constexpr int kHeight_px = 1080;
constexpr picture::Rectangle kMapArea = {78.0, 62.0, 1000.0, 930.0};
constexpr double kAround_m = 4.0;
constexpr double kSmallestView_m = 16.0;

std::vector<picture::DataPoint> PointsOf(std::span<const Pose2> poses) {
  std::vector<picture::DataPoint> points;
  for (const Pose2& pose : poses) points.push_back({double{pose.x_m}, double{pose.y_m}});
  return points;
}

picture::Range Grown(const picture::Range& range) {
  return range.WidenedBy(kAround_m + std::max(kSmallestView_m - range.span(), 0.0) / 2.0);
}

}  // namespace

picture::Canvas DrawReplay(const Report& report, const Pilot& pilot, const VehicleParams& vehicle) {
  const StampedPose& end = pilot.odometry().pose();
  const Pose2 pose = {end.position.x_m, end.position.y_m, end.yaw_rad};
  const CommittedPlan& committed = pilot.replanner().committed();
  std::vector<Pose2> path;
  if (committed.number != 0) path.assign(committed.path.begin(), committed.path.end());
  picture::Range x = {double{pose.x_m}, double{pose.x_m}};
  picture::Range y = {double{pose.y_m}, double{pose.y_m}};
  for (const std::vector<Pose2>* const poses : {&report.driven, &std::as_const(path)}) {
    for (const Pose2& at : *poses) {
      x.Include(double{at.x_m});
      y.Include(double{at.y_m});
    }
  }
  picture::Canvas canvas(kWidth_px, kHeight_px);
  picture::Axes axes = picture::Axes::OfMap(canvas, kMapArea, Grown(x), Grown(y));
  picture::DrawCostmap(canvas, axes, pilot.replanner().planner().costmap());
  axes.ClipBegin();
  axes.Line(PointsOf(report.driven), {.colour = picture::kVehicle, .line_px = 2.6});
  axes.Line(PointsOf(path), {.colour = picture::kOptimizedPath, .line_px = 3.2});
  picture::DrawVehicle(canvas, axes, vehicle, pose, {1.0, 1.0, 1.0, 0.75}, picture::kVehicle);
  axes.ClipEnd();
  picture::DrawScaleBar(canvas, axes);
  axes.Frame("", "x [m]", "y [m]");
  canvas.Text(kMapArea.left_px, 36.0,
              "Ticks " + std::to_string(report.first_index) + " to " +
                  std::to_string(report.last_index) + ": driven (black), committed path (blue)",
              {.size_px = 21.0, .bold = true});
  return canvas;
}

}  // namespace hardpack::replay
